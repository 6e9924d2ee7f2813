# Bare-metal ARM with Debian's gcc-arm-none-eabi; the including file says which core in PEL_CPU.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_ASM_COMPILER arm-none-eabi-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
list(JOIN PEL_CPU " " CMAKE_C_FLAGS_INIT)
set(CMAKE_EXECUTABLE_SUFFIX_C .elf)

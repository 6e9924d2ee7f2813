# Bare-metal RV32 with Debian's gcc-riscv64-unknown-elf: single-precision FPU, doubles in software.
# No jump tables: every jump through a register is then a call that the stack bound must know.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR riscv32)
set(CMAKE_C_COMPILER riscv64-unknown-elf-gcc)
set(CMAKE_ASM_COMPILER riscv64-unknown-elf-gcc)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_C_FLAGS_INIT "-march=rv32imafc -mabi=ilp32f --specs=picolibc.specs -fno-jump-tables")
set(CMAKE_EXECUTABLE_SUFFIX_C .elf)

set(PEL_CPU -mcpu=cortex-m7 -mthumb -mfloat-abi=hard -mfpu=fpv5-d16)
include(${CMAKE_CURRENT_LIST_DIR}/arm-none-eabi.cmake)
set(PEL_HARD_DOUBLE ON)

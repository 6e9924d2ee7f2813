# STM32F405RG: Cortex-M4F, 1 MB flash, 128 KB + 64 KB RAM. Runs on QEMU's netduinoplus2.
set(PEL_BOARD_PRESET m4f)

# Sizes of config.h that differ here, so that it fits.
set(PEL_BOARD_DEFINITIONS PEL_MAX_OBS=64 PEL_MAX_SATS=32 PEL_MAX_EPH=40 PEL_MAX_AMB=32 PEL_MAX_STATES=40 PEL_MAX_TRACKED=48
    PEL_IMU_RING=128 PEL_POSE_RING=64 PEL_NAV_SLOTS=32)

set(PEL_BOARD_SOURCES stm32f405/startup.c stm32f405/clock.c common/semihost.c common/arm_double_add.c) # of every program
set(PEL_BOARD_DRIVERS stm32f405/ports.c stm32f405/pulses.c stm32f405/store.c common/no_time.c common/no_config.c) # of the firmware
set(PEL_BOARD_LINK_OPTIONS --specs=nano.specs -Wl,--wrap=__aeabi_dadd,--wrap=__aeabi_dsub)
set(PEL_BOARD_LINKER_SCRIPT stm32f405/stm32f405.ld)
set(PEL_BOARD_INCLUDES stm32f405)

# For make pil: the emulator's command, which port each of its UARTs is, and what programs need to run there: its core-coupled memory
# follows the RAM, its timers count at 1 GHz.
set(PEL_BOARD_EMULATOR qemu-system-arm -M netduinoplus2)
set(PEL_BOARD_SERIALS out imu rover base aux1)
set(PEL_BOARD_EMULATED_LINK_OPTIONS -Wl,--defsym=_ccm=0x20020000)
set(PEL_BOARD_EMULATED_DEFINITIONS STM32_INTERNAL_TIMER_HZ=1000000000u)

# MPS2 with FPGA image AN500: Cortex-M7. The whole difference to its sister board is the core.
set(PEL_BOARD_PRESET m7)

# Sizes of config.h that differ here, for example PEL_MAX_OBS=64. None: with the desktop's sizes a capture gives the
# desktop's bytes.
set(PEL_BOARD_DEFINITIONS)

set(PEL_BOARD_SOURCES mps2/startup.c mps2/clock.c common/semihost.c) # of every program
set(PEL_BOARD_DRIVERS mps2/board.c common/no_time.c common/no_pulses.c common/no_config.c common/no_store.c) # of the firmware
set(PEL_BOARD_LINK_OPTIONS --specs=nano.specs)
set(PEL_BOARD_LINKER_SCRIPT mps2/mps2.ld)
set(PEL_BOARD_INCLUDES mps2)

# For make pil: the emulator's command.
set(PEL_BOARD_EMULATOR qemu-system-arm -M mps2-an500)
set(PEL_BOARD_SERIALS out imu rover base aux1) # which port each of its UARTs is

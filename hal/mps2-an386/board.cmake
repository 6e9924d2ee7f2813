# MPS2 with FPGA image AN386: Cortex-M4F. The whole difference to its sister board is the core.
set(PEL_BOARD_PRESET m4f)

# Sizes of config.h that differ here, for example PEL_MAX_OBS=64. None: with the desktop's sizes a capture gives the
# desktop's bytes.
set(PEL_BOARD_DEFINITIONS)

set(PEL_BOARD_SOURCES mps2/startup.c mps2/board.c)
set(PEL_BOARD_LINKER_SCRIPT mps2/mps2.ld)
set(PEL_BOARD_INCLUDES mps2)

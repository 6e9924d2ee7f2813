# RV32IMAFC as QEMU's virt board: proof that nothing of the library knows ARM.
set(PEL_BOARD_PRESET rv32)

# Sizes of config.h that differ here: none.
set(PEL_BOARD_DEFINITIONS)

set(PEL_BOARD_SOURCES rv32-virt/startup.c rv32-virt/clock.c common/semihost.c) # of every program
set(PEL_BOARD_DRIVERS rv32-virt/ports.c rv32-virt/store.c common/no_time.c common/no_pulses.c common/no_config.c) # of the firmware
set(PEL_BOARD_LINK_OPTIONS)
set(PEL_BOARD_LINKER_SCRIPT rv32-virt/virt.ld)
set(PEL_BOARD_INCLUDES rv32-virt)

# For make pil: the emulator's command, which ports its one UART is.
set(PEL_BOARD_EMULATOR qemu-system-riscv32 -M virt -cpu rv32 -bios none)
set(PEL_BOARD_SERIALS out+rover)

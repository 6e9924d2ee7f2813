/* board.h - what the files of one board share with each other and with hal/pil/. */
#ifndef HAL_BOARD_H
#define HAL_BOARD_H

#include "hal.h"

/* Exit statuses an emulator reports. */
#define BOARD_EXIT_FAULT 99
#define BOARD_EXIT_INIT  98

/* Bytes of the stack, and the first address above it: from the linker script. */
extern uint32_t _estack;
extern char _stack_size[]; /* its address is the number */

/* Start what hal_clock_ns() reads. */
void board_clock_start(void);

/* Leave through semihosting; without anybody at its other end the core stops, and the watchdog resets it. */
__attribute__((noreturn)) void board_exit(int code);

#endif

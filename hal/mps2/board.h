/* board.h - what start-up code and drivers of the MPS2 boards share. */
#ifndef HAL_MPS2_BOARD_H
#define HAL_MPS2_BOARD_H

#include "hal.h"

/* Exit statuses an emulator reports. */
#define BOARD_EXIT_FAULT 99
#define BOARD_EXIT_INIT  98

/* Leave through semihosting. */
__attribute__((noreturn)) void board_exit(int code);

/* Interrupt handlers of the UARTs, by port. */
void uart_imu_irq(void);
void uart_rover_irq(void);
void uart_base_irq(void);
void uart_aux1_irq(void);
void uart_out_irq(void);

#endif

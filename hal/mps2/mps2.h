/* mps2.h - what start-up code and drivers of the MPS2 boards share. */
#ifndef HAL_MPS2_H
#define HAL_MPS2_H

#include "board.h"

void mps2_watchdog_start(void);

/* Wake the core ten times a second, so that the main loop keeps the watchdog quiet while no bytes arrive. */
void mps2_wake_start(void);

/* Interrupt handlers of the UARTs, by port. */
void uart_imu_irq(void);
void uart_rover_irq(void);
void uart_base_irq(void);
void uart_aux1_irq(void);
void uart_out_irq(void);

#endif

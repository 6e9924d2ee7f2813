/* virt.h - registers of QEMU's virt board as far as start-up and drivers use them. Source: RISC-V privileged architecture 1.12, SiFive
 * PLIC and CLINT, NS16550A data sheet; addresses: QEMU, hw/riscv/virt.c. */
#ifndef HAL_RV32_VIRT_H
#define HAL_RV32_VIRT_H

#include "board.h"

#define MTIME_HZ 10000000u
#define MTIME    ((volatile uint32_t *)0x0200BFF8u) /* low word, high word */
#define MTIMECMP ((volatile uint32_t *)0x02004000u)

#define UART_REGISTER(n) (*(volatile uint8_t *)(0x10000000u + (n)))
#define UART_DATA        UART_REGISTER(0)
#define UART_INT         UART_REGISTER(1)
#define UART_FIFO        UART_REGISTER(2)
#define UART_LINE        UART_REGISTER(3)
#define UART_STATUS      UART_REGISTER(5)
#define UART_INT_RX      0x01u
#define UART_INT_TX      0x02u
#define UART_8N1         0x03u
#define UART_DIVISOR     0x80u
#define UART_RX_READY    0x01u
#define UART_RX_OVERRUN  0x02u
#define UART_TX_EMPTY    0x20u
#define UART_IRQ         10u

#define PLIC_PRIORITY(irq) (*(volatile uint32_t *)(0x0C000000u + 4u * (irq)))
#define PLIC_ENABLE        (*(volatile uint32_t *)0x0C002000u)
#define PLIC_THRESHOLD     (*(volatile uint32_t *)0x0C200000u)
#define PLIC_CLAIM         (*(volatile uint32_t *)0x0C200004u)

#define MIE_TIMER  0x80u
#define MIE_EXTERN 0x800u

/* Ask for the next wake-up, a tenth of a second from now. */
void virt_wake(void);

/* The UART's interrupt handler. */
void uart_irq(void);

#endif

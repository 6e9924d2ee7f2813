/* cmsdk.h - registers of the ARM CMSDK peripherals on the MPS2 FPGA images AN386 and AN500, as far as the drivers use
 * them. Source: ARM DUI 0479 (CMSDK TRM), ARM DAI 0386 and DAI 0500 (memory and interrupt maps). */
#ifndef HAL_MPS2_CMSDK_H
#define HAL_MPS2_CMSDK_H

#include <stdint.h>

#define PCLK_HZ 25000000u

typedef struct {
    volatile uint32_t DATA;
    volatile uint32_t STATE;   /* bit 0 TX full, 1 RX full, 2 TX overrun, 3 RX overrun (write 1 to clear) */
    volatile uint32_t CTRL;    /* bit 0 TX on, 1 RX on, 2 TX interrupt, 3 RX interrupt, 5 RX overrun interrupt */
    volatile uint32_t INT;     /* bit 0 TX, 1 RX, 2 TX overrun, 3 RX overrun; write 1 to clear */
    volatile uint32_t BAUDDIV; /* PCLK / baud, >= 16 */
} cmsdk_uart_t;

#define UART_TX_FULL     0x1u
#define UART_RX_FULL     0x2u
#define UART_RX_OVERRUN  0x8u
#define UART_CTRL_TX     0x1u
#define UART_CTRL_RX     0x2u
#define UART_CTRL_TX_INT 0x4u
#define UART_CTRL_RX_INT 0x8u
#define UART_INT_TX      0x1u
#define UART_INT_RX      0x2u

#define UART0 ((cmsdk_uart_t *)0x40004000u)
#define UART1 ((cmsdk_uart_t *)0x40005000u)
#define UART2 ((cmsdk_uart_t *)0x40006000u)
#define UART3 ((cmsdk_uart_t *)0x40007000u)
#define UART4 ((cmsdk_uart_t *)0x40009000u)

/* Interrupt numbers: receive; transmit is the next one. */
#define UART0_RX_IRQ 0u
#define UART1_RX_IRQ 2u
#define UART2_RX_IRQ 4u
#define UART3_RX_IRQ 18u
#define UART4_RX_IRQ 20u

typedef struct {
    volatile uint32_t CTRL;
    volatile uint32_t VALUE; /* counts down */
    volatile uint32_t RELOAD;
    volatile uint32_t INT;
} cmsdk_timer_t;

#define TIMER0 ((cmsdk_timer_t *)0x40000000u)

typedef struct {
    volatile uint32_t LOAD;
    volatile uint32_t VALUE;
    volatile uint32_t CTRL; /* bit 0 count and interrupt, 1 reset at the second expiry */
    volatile uint32_t INTCLR;
    volatile uint32_t unused[764];
    volatile uint32_t LOCK;
} cmsdk_watchdog_t;

#define WATCHDOG        ((cmsdk_watchdog_t *)0x40008000u)
#define WATCHDOG_UNLOCK 0x1ACCE551u

/* Of the core. */
#define SYSTICK_CTRL (*(volatile uint32_t *)0xE000E010u)
#define SYSTICK_LOAD (*(volatile uint32_t *)0xE000E014u)
#define NVIC_ENABLE  (*(volatile uint32_t *)0xE000E100u)
#define SCB_CPACR    (*(volatile uint32_t *)0xE000ED88u)

#endif

/* startup.c - from reset to firmware_main(): vectors, FPU on, .data and .bss. Same for AN386 and AN500. */
#include <stdint.h>

#include "cmsdk.h"
#include "mps2.h"

/* Of the linker script. */
extern uint32_t _sidata, _sdata, _edata, _sbss, _ebss;

void reset_handler(void);

static void fault_handler(void)
{
    board_exit(BOARD_EXIT_FAULT);
}

/* The watchdog's first expiry: its second one resets. */
static void nmi_handler(void)
{
    for (;;) {}
}

static void systick_handler(void) {}

/* A program without the drivers of board.c enables none of these. */
#define UNUSED_IF_ABSENT __attribute__((weak, alias("systick_handler")))
UNUSED_IF_ABSENT void uart_imu_irq(void);
UNUSED_IF_ABSENT void uart_rover_irq(void);
UNUSED_IF_ABSENT void uart_base_irq(void);
UNUSED_IF_ABSENT void uart_aux1_irq(void);
UNUSED_IF_ABSENT void uart_out_irq(void);

typedef void (*vector_t)(void);

/* Initial stack pointer, then handlers; the order is the core's and the FPGA image's. */
static const struct {
    uint32_t *stack;
    vector_t core[15];
    vector_t irq[32];
} vectors __attribute__((section(".vectors"), used)) = {
    &_estack,
    {reset_handler, nmi_handler, fault_handler, fault_handler, fault_handler, fault_handler, 0, 0, 0, 0, fault_handler,
     fault_handler, 0, fault_handler, systick_handler},
    {[UART0_RX_IRQ + 1] = uart_out_irq,
     [UART1_RX_IRQ] = uart_imu_irq,
     [UART2_RX_IRQ] = uart_rover_irq,
     [UART3_RX_IRQ] = uart_base_irq,
     [UART4_RX_IRQ] = uart_aux1_irq},
};

void reset_handler(void)
{
    SCB_CPACR |= 0xFu << 20; /* the FPU, before anything may use it */
    __asm volatile("dsb\n\tisb" ::: "memory");
    const uint32_t *from = &_sidata;
    for (uint32_t *to = &_sdata; to < &_edata; to++) { *to = *from++; }
    for (uint32_t *to = &_sbss; to < &_ebss; to++) { *to = 0; }
    if (!hal_init()) { board_exit(BOARD_EXIT_INIT); }
    firmware_main();
    board_exit(0);
}

/* startup.c - from reset to firmware_main(): vectors, FPU on, .data and .bss. Same for AN386 and AN500. */
#include <stdint.h>

#include "board.h"
#include "cmsdk.h"

/* Of the linker script. */
extern uint32_t _estack, _sidata, _sdata, _edata, _sbss, _ebss;

void reset_handler(void);

static void fault_handler(void)
{
    board_exit(BOARD_EXIT_FAULT);
}

/* Wakes the main loop from its sleep ten times a second, so that it keeps the watchdog quiet while no bytes arrive. */
static void systick_handler(void) {}

typedef void (*vector_t)(void);

/* Initial stack pointer, then handlers; the order is the core's and the FPGA image's. */
static const struct {
    uint32_t *stack;
    vector_t core[15];
    vector_t irq[32];
} vectors __attribute__((section(".vectors"), used)) = {
    &_estack,
    {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, 0, 0, 0, 0,
     fault_handler, fault_handler, 0, fault_handler, systick_handler},
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

/* Semihosting: the emulator's, or a debugger's, exit status. Without either the breakpoint faults, and the watchdog resets. */
void board_exit(int code)
{
    const uint32_t block[2] = {0x20026u /* application exit */, (uint32_t)code};
    register uint32_t r0 __asm("r0") = 0x20u; /* SYS_EXIT_EXTENDED */
    register const uint32_t *r1 __asm("r1") = block;
    __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    for (;;) {}
}

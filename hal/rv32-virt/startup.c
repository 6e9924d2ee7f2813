/* startup.c - from reset to firmware_main(): stack, FPU on, traps, .data and .bss. */
#include "virt.h"

/* Of the linker script. */
extern uint32_t _sidata, _sdata, _edata, _sbss, _ebss;

void _start(void);
void reset_handler(void);

/* A program without the drivers of ports.c enables no interrupt. */
__attribute__((weak)) void uart_irq(void) {}

__attribute__((interrupt("machine"), aligned(4))) static void trap_handler(void)
{
    uint32_t cause;
    __asm volatile("csrr %0, mcause" : "=r"(cause));
    switch (cause) {
    case 0x80000007u: virt_wake(); break;
    case 0x8000000Bu: {
        const uint32_t irq = PLIC_CLAIM;
        if (irq == UART_IRQ) { uart_irq(); }
        PLIC_CLAIM = irq;
        break;
    }
    default: board_exit(BOARD_EXIT_FAULT);
    }
}

__attribute__((naked, section(".text._start"), used)) void _start(void)
{
    __asm volatile(".option push\n\t.option norelax\n\tla gp, __global_pointer$\n\t.option pop\n\t"
                   "la sp, _estack\n\t"
                   "j reset_handler");
}

void reset_handler(void)
{
    __asm volatile("csrs mstatus, %0\n\tfscsr zero" ::"r"(1u << 13)); /* the FPU, rounding to nearest */
    __asm volatile("csrw mtvec, %0" ::"r"(trap_handler));
    const uint32_t *from = &_sidata;
    for (uint32_t *to = &_sdata; to < &_edata; to++) { *to = *from++; }
    for (uint32_t *to = &_sbss; to < &_ebss; to++) { *to = 0; }
    if (!hal_init()) { board_exit(BOARD_EXIT_INIT); }
    firmware_main();
    board_exit(0);
}

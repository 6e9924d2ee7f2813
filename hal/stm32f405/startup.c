/* startup.c - from reset to firmware_main(): vectors, FPU on, .data and .bss. */
#include "stm32.h"

/* Of the linker script. */
extern uint32_t _sidata, _sdata, _edata, _sbss, _ebss, _sccm, _eccm;

void reset_handler(void);

static void fault_handler(void)
{
    board_exit(BOARD_EXIT_FAULT);
}

static void systick_handler(void) {}

/* A program without the drivers of ports.c enables none of these. */
#define UNUSED_IF_ABSENT __attribute__((weak, alias("systick_handler")))
UNUSED_IF_ABSENT void usart1_irq(void);
UNUSED_IF_ABSENT void usart2_irq(void);
UNUSED_IF_ABSENT void usart3_irq(void);
UNUSED_IF_ABSENT void uart4_irq(void);
UNUSED_IF_ABSENT void uart5_irq(void);

typedef void (*vector_t)(void);

/* Initial stack pointer, then handlers; the order is the core's and the chip's. */
static const struct {
    uint32_t *stack;
    vector_t core[15];
    vector_t irq[N_IRQS];
} vectors __attribute__((section(".vectors"), used)) = {
    &_estack,
    {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler, fault_handler, 0, 0, 0, 0,
     fault_handler, fault_handler, 0, fault_handler, systick_handler},
    {[USART1_IRQ] = usart1_irq,
     [USART2_IRQ] = usart2_irq,
     [USART3_IRQ] = usart3_irq,
     [UART4_IRQ] = uart4_irq,
     [UART5_IRQ] = uart5_irq},
};

static void clear(uint32_t *from, const uint32_t *end)
{
    while (from < end) { *from++ = 0; }
}

void reset_handler(void)
{
    SCB_CPACR |= 0xFu << 20; /* the FPU, before anything may use it */
    __asm volatile("dsb\n\tisb" ::: "memory");
    const uint32_t *from = &_sidata;
    for (uint32_t *to = &_sdata; to < &_edata; to++) { *to = *from++; }
    clear(&_sbss, &_ebss);
    clear(&_sccm, &_eccm);
    if (!hal_init()) { board_exit(BOARD_EXIT_INIT); }
    firmware_main();
    board_exit(0);
}

/* target.c - the cases on an emulated MPS2 board: instructions by its timer under -icount, printed through semihosting.
 *
 * With -icount shift=10 an instruction takes 1024 ns of virtual time and the timer ticks every 40 ns. */
#include <stdint.h>

#include "bench.h"
#include "integers.h"

extern uint32_t _estack, _sdata, _edata, _sidata, _sbss, _ebss;

#define TIMER_CTRL   (*(volatile uint32_t *)0x40000000u)
#define TIMER_VALUE  (*(volatile uint32_t *)0x40000004u)
#define TIMER_RELOAD (*(volatile uint32_t *)0x40000008u)

static void semihost(uint32_t op, const void *arg)
{
    register uint32_t r0 __asm__("r0") = op;
    register const void *r1 __asm__("r1") = arg;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}

static void finish(uint32_t code)
{
    const uint32_t block[2] = {0x20026u, code};
    semihost(0x20, block);
    for (;;) {}
}

static void print_number(uint32_t v)
{
    char s[12];
    int k = 11;
    s[k] = '\0';
    do {
        s[--k] = (char)('0' + v % 10u);
        v /= 10u;
    } while (v != 0u);
    semihost(4, &s[k]);
}

static uint32_t count(void (*body)(void))
{
    const uint32_t start = TIMER_VALUE;
    body();
    const uint32_t ticks = start - TIMER_VALUE;
    return (uint32_t)(((uint64_t)ticks * 40u + 512u) / 1024u);
}

static void nothing(void) {}

void reset_handler(void);
void fault_handler(void);

void fault_handler(void)
{
    finish(99);
}

void reset_handler(void)
{
    *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* floating-point unit on */
    __asm__ volatile("dsb\n isb");
    for (uint32_t *to = &_sdata, *from = &_sidata; to < &_edata;) { *to++ = *from++; }
    for (uint32_t *to = &_sbss; to < &_ebss;) { *to++ = 0; }
    TIMER_RELOAD = 0xFFFFFFFFu;
    TIMER_VALUE = 0xFFFFFFFFu;
    TIMER_CTRL = 1;
    const uint32_t empty = count(nothing);
    for (int i = 0; i < bench_n_cases; i++) {
        bench_cases[i].prepare();
        const uint32_t n = count(bench_cases[i].body) - empty;
        semihost(4, bench_cases[i].name);
        semihost(4, "\t");
        print_number(n / (uint32_t)bench_cases[i].per);
        semihost(4, "\n");
    }
    for (int size = 0; size < BENCH_SIZES; size++) {
        long counts[BENCH_PROBLEMS];
        for (int k = 0; k < BENCH_PROBLEMS; k++) {
            bench_integers_prepare(size, k);
            counts[k] = (long)(count(bench_integers) - empty);
        }
        semihost(4, "integers ");
        print_number((uint32_t)bench_sizes[size]);
        semihost(4, "\t");
        print_number((uint32_t)bench_median(counts, BENCH_PROBLEMS));
        semihost(4, "\n");
    }
    finish(0);
}

__attribute__((section(".vectors"), used)) static const void *const vectors[] = {&_estack, reset_handler, fault_handler,
                                                                                 fault_handler};

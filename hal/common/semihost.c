/* semihost.c - the call itself: both instruction sets want the arguments where a function has them. */
#include "semihost.h"

#include "board.h"

#if defined(__riscv)
/* Three instructions that may neither be compressed nor lie in two pages. */
__attribute__((naked, noinline, aligned(16))) int32_t semihost(uint32_t operation __attribute__((unused)),
                                                               const uint32_t *block __attribute__((unused)))
{
    __asm volatile(".option norvc\n\tslli x0, x0, 0x1f\n\tebreak\n\tsrai x0, x0, 7\n\tret");
}
#else
__attribute__((naked, noinline)) int32_t semihost(uint32_t operation __attribute__((unused)),
                                                  const uint32_t *block __attribute__((unused)))
{
    __asm volatile("bkpt 0xAB\n\tbx lr");
}
#endif

void board_exit(int code)
{
    const uint32_t block[2] = {SEMIHOST_EXITED, (uint32_t)code};
    (void)semihost(SEMIHOST_EXIT_EXTENDED, block);
    for (;;) {}
}

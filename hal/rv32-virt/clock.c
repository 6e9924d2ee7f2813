/* clock.c - time of QEMU's virt board: the core-local timer. It has no watchdog. */
#include "virt.h"

static uint64_t mtime(void)
{
    uint32_t high, low;
    do {
        high = MTIME[1];
        low = MTIME[0];
    } while (high != MTIME[1]);
    return (uint64_t)high << 32 | low;
}

void board_clock_start(void) {}

int64_t hal_clock_ns(void)
{
    return (int64_t)(mtime() * (1000000000u / MTIME_HZ));
}

void virt_wake(void)
{
    const uint64_t at = mtime() + MTIME_HZ / 10;
    MTIMECMP[1] = UINT32_MAX; /* no match between the two words */
    MTIMECMP[0] = (uint32_t)at;
    MTIMECMP[1] = (uint32_t)(at >> 32);
}

void hal_watchdog_kick(void) {}

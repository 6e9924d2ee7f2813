/* clock.c - time and watchdog of the MPS2 boards. */
#include "cmsdk.h"
#include "mps2.h"

#define WATCHDOG_S 4u
#define WAKE_HZ    10u

static uint64_t ticks;      /* of TIMER0 since board_clock_start() */
static uint32_t last_value; /* of TIMER0 when ticks was brought up to date */

void board_clock_start(void)
{
    TIMER0->RELOAD = UINT32_MAX;
    TIMER0->VALUE = UINT32_MAX;
    TIMER0->CTRL = 1;
    last_value = UINT32_MAX;
}

/* The 32-bit timer wraps every 171 s; the main loop's watchdog kicks keep the count whole. */
int64_t hal_clock_ns(void)
{
    const uint32_t value = TIMER0->VALUE;
    ticks += last_value - value; /* counts down */
    last_value = value;
    return (int64_t)(ticks * (1000000000u / PCLK_HZ));
}

void mps2_watchdog_start(void)
{
    WATCHDOG->LOCK = WATCHDOG_UNLOCK;
    WATCHDOG->LOAD = WATCHDOG_S * PCLK_HZ;
    WATCHDOG->CTRL = 3;
}

/* The first expiry only interrupts, the second resets: a loop that hangs restarts after twice WATCHDOG_S. */
void hal_watchdog_kick(void)
{
    WATCHDOG->INTCLR = 1; /* also reloads the counter */
    (void)hal_clock_ns();
}

void mps2_wake_start(void)
{
    SYSTICK_LOAD = PCLK_HZ / WAKE_HZ - 1;
    SYSTICK_CTRL = 7; /* count the core's clock, interrupt */
}

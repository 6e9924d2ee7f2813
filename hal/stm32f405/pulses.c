/* pulses.c - PPS and event input: TIM2 keeps the count of their rising edges, so no interrupt delays them. */
#include "stm32.h"

#define CAPTURED_PPS   (1u << 1)
#define CAPTURED_EVENT (1u << 2)

/* Of the last edge since the call before; right if that is less than half a turn of the timer ago, 536 s. */
static bool captured(uint32_t flag, const volatile uint32_t *at, int64_t *clock_ns)
{
    if ((TIM2->SR & flag) == 0) { return false; }
    *clock_ns = stm32_clock_at_ns(*at); /* reading the capture clears its flag */
    return true;
}

bool hal_pps(int64_t *clock_ns)
{
    return captured(CAPTURED_PPS, &TIM2->CCR1, clock_ns);
}

bool hal_event(int64_t *clock_ns, uint32_t *id)
{
    static uint32_t n;
    if (!captured(CAPTURED_EVENT, &TIM2->CCR2, clock_ns)) { return false; }
    *id = ++n;
    return true;
}

/* no_pulses.c - hal.h on a board that has neither PPS nor event input. */
#include "hal.h"

bool hal_pps(int64_t *clock_ns)
{
    (void)clock_ns;
    return false;
}

bool hal_event(int64_t *clock_ns, uint32_t *id)
{
    (void)clock_ns;
    (void)id;
    return false;
}

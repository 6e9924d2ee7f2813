/* no_time.c - hal.h on a board that does not know GPS time when it starts. */
#include "hal.h"

pel_time_t hal_gps_time(void)
{
    return 0;
}

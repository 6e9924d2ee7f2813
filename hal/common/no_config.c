/* no_config.c - hal.h on a board that keeps no configuration: the defaults. */
#include "hal.h"

bool hal_load_config(pel_nav_config_t *cfg)
{
    (void)cfg;
    return false;
}

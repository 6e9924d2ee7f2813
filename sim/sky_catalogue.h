/* sky_catalogue.h - which satellites the simulated sky holds. */
#ifndef PELORUS_SIM_SKY_CATALOGUE_H
#define PELORUS_SIM_SKY_CATALOGUE_H

#include "sky.h"

/* Fill the sky with elements at a time near t. The same for every seed. */
void sky_catalogue(sky_t *sky, const sky_config_t *cfg, pel_time_t t);

#endif

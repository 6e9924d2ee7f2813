/* group_delay.h - group delay of a carrier from the two broadcast numbers, in their unit. Private to src/gnss/. */
#ifndef PELORUS_GNSS_GROUP_DELAY_H
#define PELORUS_GNSS_GROUP_DELAY_H

#include "pelorus/gnss.h"

double pel_group_delay(uint8_t sys, uint8_t prn, uint8_t source, double tgd0, double tgd1, pel_carrier_t carrier);

#endif

/* glonass.h - orbits that are broadcast as a state vector. Private to src/gnss/. */
#ifndef PELORUS_GNSS_GLONASS_H
#define PELORUS_GNSS_GLONASS_H

#include "pelorus/gnss.h"

/* As pel_sat_state(), tk seconds after toe. PEL_E_RANGE beyond an hour, or when the satellite leaves its shell. */
pel_status_t pel_glo_state(const pel_ephemeris_t *eph, double tk, pel_sat_state_t *out);

#endif

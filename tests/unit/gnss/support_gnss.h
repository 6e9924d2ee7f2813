/* support_gnss.h - a sky with known satellites, and the observations a receiver would make under it. */
#ifndef SUPPORT_GNSS_H
#define SUPPORT_GNSS_H

#include "pelorus/gnss.h"

#define SKY_T0 (INT64_C(1300000000) * PEL_NS_PER_S) /* GPS time of the scenes */

/* A receiver's truth. */
typedef struct {
    double r_e[3], v_e[3];
    double clk_m, clk_rate_mps; /* c (tag - true time), at the true instant */
    bool atmosphere;
    double glo_slope_m; /* what a GLONASS phase is delayed by for each channel */
} scene_t;

/* 30 GPS, 12 Galileo and 8 BeiDou satellites (5 of them GEO), toe = SKY_T0, with clock offsets and eccentricities. */
void sky_init(pel_orbits_t *o);

/* 24 GLONASS satellites besides, channels -7..6: more than a store holds that has all of sky_init(). */
void sky_add_glonass(pel_orbits_t *o);

/* A receiver at rest near 35 N 136 E. */
scene_t scene_default(void);

/* What it observes at true time t_ns: tag = t_ns + clock; every satellite above 10 degrees, carriers L1 (B1I) and L2 (E5b, B2I; GLONASS G2),
 * codes, phases with integers of their own, Dopplers; no noise. n_sys: systems in use, one bit each. */
void scene_observe(const scene_t *s, const pel_orbits_t *o, pel_time_t t_ns, unsigned sys_mask, pel_epoch_t *e);

/* The integer scene_observe() gives a phase. */
double scene_integer(uint8_t sys, uint8_t prn, uint8_t carrier);

/* GPS satellites 11 to 20 become J01 to J10: numbers that GPS has as well. */
void gnss_hand_some_to_qzss(pel_orbits_t *orbits, pel_epoch_t *epoch);

#endif

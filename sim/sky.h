/* sky.h - satellites of the simulator: true Keplerian orbits and clocks, and the ephemerides they broadcast.
 *
 * Truth is each satellite's element set carried on by its own rates; what is broadcast is that set referred to a whole
 * number of two hours and rounded to the message's steps (0.04 m at most). The set in force when the scenario starts is
 * rounded before it becomes truth, so that during the first hours broadcast and truth are the same. */
#ifndef PELORUS_SIM_SKY_H
#define PELORUS_SIM_SKY_H

#include <stdint.h>

#include "pelorus/base.h"
#include "rng.h"

#define SKY_MAX_SATS 128

typedef struct {
    pel_ephemeris_t eph;  /* elements in force at the start of the scenario, rounded */
    bool geostationary;   /* BeiDou GEO: elements in the tilted frame of its interface document */
    double offset_e[3];   /* true minus broadcast position, m: orbit error, constant in e */
    double clock_error_s; /* true minus broadcast clock */
} sat_t;

typedef struct {
    int n;
    sat_t sats[SKY_MAX_SATS];
} sky_t;

typedef enum {
    SKY_IDEAL24, /* 24 GPS satellites in circular orbits: plane p = k/4, slot s = k%4, 26 560 km, 55 degrees (S1) */
    SKY_MULTI,   /* GPS 31, Galileo 24, BeiDou 24 MEO + 7 IGSO + 5 GEO, QZSS 4: plausible, not any day's real ones */
    SKY_GEO3     /* three BeiDou GEO at 80, 110.5 and 140 degrees east (S3) */
} sky_kind_t;

typedef struct {
    sky_kind_t kind;
    bool systems[PEL_N_SYS]; /* which take part */
    double orbit_error_m;    /* 1 sigma a component */
    double clock_error_m;
    bool clocks; /* satellite clocks have offsets, drifts and group delays */
} sky_config_t;

/* Sky in force at t. The constellation itself does not depend on the seed; its errors do. */
void sky_init(sky_t *sky, const sky_config_t *cfg, pel_time_t t, uint64_t seed);

/* True position and velocity (ECEF at its own time) and clock (satellite time minus GPS time, with relativity, for the
 * signal that the broadcast clock refers to) at t_ns + dt. */
typedef struct {
    double r_e[3], v_e[3], clock_s, clock_rate;
} sat_state_t;
void sky_state(const sat_t *s, pel_time_t t_ns, double dt_s, sat_state_t *out);

/* Group delay of a carrier with respect to the broadcast clock, s: the pseudorange is longer by that. */
double sky_group_delay(const sat_t *s, pel_carrier_t carrier);

/* What the satellite broadcasts at t. The issue changes every two hours, an hour before its reference time. */
void sky_ephemeris(const sat_t *s, pel_time_t t, pel_ephemeris_t *out);

#endif

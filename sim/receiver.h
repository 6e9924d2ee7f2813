/* receiver.h - a GNSS receiver: what it measures of the true sky from a true antenna.
 *
 *   P = rho + c (dt_r - dt_s) + T + I + group delay + multipath + noise
 *   L lambda = rho + c (dt_r - dt_s) + T - I + lambda N + multipath + noise
 * T with each satellite's own path drift, the same on code and phase.
 *   D = -d(L)/dt of the receiver's clock
 *
 * The receiver measures when its own clock shows a tag: at true time tag - dt_r. */
#ifndef PELORUS_SIM_RECEIVER_H
#define PELORUS_SIM_RECEIVER_H

#include <stdint.h>

#include "pelorus/base.h"
#include "rng.h"
#include "sky.h"

#define RECEIVER_MAX_SIGNALS 24
#define RECEIVER_MAX_EVENTS  64

typedef struct {
    uint8_t sys, carrier;
    char code;
} signal_t;

/* "G1C", "E7Q": RINEX letters. False: no such signal. */
bool signal_parse(const char *text, signal_t *out);

/* Which satellites: -1 or 0 stand for all. */
typedef struct {
    int sys, prn, carrier;
} selector_t;

/* "all", "G", "G05", "G05:2" (carrier by RINEX band). False: not understood. */
bool selector_parse(const char *text, selector_t *out);

typedef enum {
    HAPPENS_OUTAGE, /* no signal from..to */
    HAPPENS_SLIP    /* the phase jumps by `cycles` at `from` */
} happening_kind_t;

typedef struct {
    happening_kind_t kind;
    selector_t who;
    double from_s, to_s;
    double cycles;
    bool silent; /* slip: lock time does not tell */
} happening_t;

typedef struct {
    bool present;
    int64_t interval_ns;
    int64_t tag_offset_ns; /* tags at whole intervals plus this */
    double mask;           /* rad */
    int n_signals;
    signal_t signals[RECEIVER_MAX_SIGNALS];

    double code_m, phase_m, doppler_mps; /* 1 sigma at the zenith */
    bool elevation_law;                  /* variance grows as (1 + 1/sin^2 el)/2; else the same everywhere */
    double multipath_code_m, multipath_phase_m, multipath_tau_s; /* Gauss-Markov per signal, 1 sigma */
    double rdss_hz;       /* what it gives as BeiDou B1I is of this carrier; 0: it is B1I */
    double path_walk_m;   /* each satellite's path and transponder: random walk, m/sqrt(s) */
    double path_rate_mps; /* and drift and its rate, drawn once a satellite */
    double path_accel_mps2;
    double zenith_delay_error_m; /* troposphere beyond the standard one, at the zenith */

    double clock_bias_s, clock_drift; /* at the start; s, s/s */
    double clock_walk_m;              /* random walk of the offset, m/sqrt(s) */
    double clock_drift_walk;          /* of the rate, m/s/sqrt(s) */
    bool clock_steering;              /* whole-millisecond jumps keep the offset within half a millisecond */

    double slips_per_hour; /* of each signal */
    double half_cycle_s;   /* time from lock until the half cycle is known */
    double lock_s;         /* time from view until a signal is tracked */
    int n_happenings;
    happening_t happenings[RECEIVER_MAX_EVENTS];
} receiver_config_t;

typedef enum { IONO_NONE, IONO_SHELL, IONO_KLOBUCHAR } iono_kind_t;

typedef struct {
    bool troposphere;
    double humidity;
    iono_kind_t iono;
    double vertical_m;         /* shell: vertical delay on L1 above the origin */
    double gradient[2];        /* shell: growth to the east and north, m per km */
    double origin[2];          /* lat, lon of the origin, rad */
    pel_klobuchar_t klobuchar; /* as broadcast; valid: it is broadcast */
    double klobuchar_scale;    /* truth over broadcast */
} atmosphere_t;

/* Antenna at a time: place and velocity in e. */
typedef void (*antenna_t)(void *context, double t_s, double r_e[3], double v_e[3]);

typedef struct {
    bool seen, tracked;
    double since_s; /* when it came into view, then when its lock began */
    double N;       /* cycles */
    double half;    /* 0 or 0.5 while the half cycle is unknown */
    double mp_code, mp_phase;
} channel_t;

typedef struct {
    receiver_config_t cfg;
    const sky_t *sky;
    const atmosphere_t *air;
    antenna_t antenna;
    void *context;
    pel_time_t start_ns;            /* GPS time of t = 0 */
    int64_t k;                      /* next epoch */
    double clock_m, clock_rate_mps; /* offset and rate times c */
    bool jumped;
    rng_t noise, clock, multipath, lock, path;
    double path_m[SKY_MAX_SATS], path_rate_mps[SKY_MAX_SATS], path_accel_mps2[SKY_MAX_SATS];
    channel_t channel[SKY_MAX_SATS][RECEIVER_MAX_SIGNALS];
} receiver_t;

/* name: a number that tells its random streams from other receivers'. */
void receiver_init(receiver_t *r, const receiver_config_t *cfg, const sky_t *sky, const atmosphere_t *air,
                   antenna_t antenna, void *context, pel_time_t start_ns, uint64_t seed, uint64_t name);

/* Seconds since the start at which the next epoch is measured, true time. */
double receiver_next_s(const receiver_t *r);

/* Measure it. */
void receiver_epoch(receiver_t *r, pel_epoch_t *out);

#endif

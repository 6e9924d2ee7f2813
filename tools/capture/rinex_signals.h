/* rinex_signals.h - the columns of one satellite at one epoch, and the choice of one tracking code per carrier.
 * Part of rinex_obs.h, which is what others use. */
#ifndef PELORUS_TOOLS_CAPTURE_RINEX_SIGNALS_H
#define PELORUS_TOOLS_CAPTURE_RINEX_SIGNALS_H

#include "rinex_obs.h"

/* What one tracking code says. */
typedef struct {
    pel_obs_t obs;  /* sys, prn, glo_k and lock_ms not yet set; code '*' for what belongs to any code of the carrier */
    bool lost_lock; /* LLI bit 0 */
} rinex_signal_t;

#define RINEX_SATELLITE_SIGNALS 40

/* Read a satellite's columns, which start in line l and, in RINEX 2, go on in following ones. False: the lines ended. */
bool rinex_satellite_read(rinex_obs_t *r, line_t l, uint8_t sys, uint8_t prn,
                          rinex_signal_t sig[RINEX_SATELLITE_SIGNALS], int *n);

/* First walk: count how complete each code is. */
void rinex_signals_count(rinex_obs_t *r, uint8_t sys, uint8_t prn, const rinex_signal_t *sig, int n);

/* Between the walks: one code for each satellite and carrier. */
void rinex_signals_choose(rinex_obs_t *r);

/* Which codes were chosen for how many satellites, as text: "  G L1 C x12  G L2 L x2 W x10". */
void rinex_signals_describe(const rinex_obs_t *r, char *out, size_t cap);

/* Second walk: at most one observation a carrier, with its lock time. Returns how many went into out[room]. */
int rinex_signals_take(rinex_obs_t *r, pel_time_t t, uint8_t sys, uint8_t prn, const rinex_signal_t *sig, int n,
                       pel_obs_t *out, int room);

#endif

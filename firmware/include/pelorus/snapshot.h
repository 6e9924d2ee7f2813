/* snapshot.h - what a navigator keeps over a power cut, so that it starts warm: attitude at the first GNSS epoch.
 *
 * A snapshot is bytes in the board's non-volatile store: version, sequence, time, state, sensor errors, a mark of the configuration
 * it was made under, station, ephemerides, CRC-32. It is taken up only while standing, and only if it was taken standing: an
 * attitude holds over a power cut because nothing moved. The first motion makes it void in the store. Age, place, gravity and Earth rate are checked at the first epoch;
 * what speaks against it is told as one pel_snap_t. A turn about the plumb line at the same place is seen only by gyros that
 * feel the Earth's rate (docs/SURVIVAL.md).
 *
 * Use: encode when pel_snapshot_is_due() into the slot that does not hold the newest one, void both when pel_snapshot_is_outlived(); at
 * start check both slots, restore the newest right after pel_navigator_init() (hal/store.c). A write that was cut anywhere leaves the other slot whole. */
#ifndef PELORUS_SNAPSHOT_H
#define PELORUS_SNAPSHOT_H

#include "pelorus/base.h"
#include "pelorus/solution.h"

#ifdef __cplusplus
extern "C" {
#endif

struct pel_navigator_t;

#define PEL_SNAPSHOT_VERSION   1
#define PEL_SNAPSHOT_BYTES     292 /* without ephemerides */
#define PEL_SNAPSHOT_EPH_BYTES 193 /* each */

/* What is kept, apart from ephemerides. Sensor errors: gyro constant, gyro Markov, accelerometer Markov, b, rad/s and m/s^2. */
typedef struct {
    uint32_t sequence;
    uint32_t config_hash, mount_hash;
    pel_time_t t_ns;
    float still_s;       /* how long it had stood; 0: in motion */
    double r_ea_e[3];    /* antenna, m */
    double v_eb_e[3];    /* m/s */
    double theta_b_e[3]; /* rotation vector of C_b_e */
    float cov_r_e[6];    /* of the antenna, m^2: xx xy xz yy yz zz */
    float cov_psi_e[6];  /* rad^2, same order */
    double error[9];
    float sd_error[9];
    bool have_station;
    pel_station_t station;
} pel_snapshot_t;

/* The navigator's side of it. Private, but for the report. */
typedef struct {
    pel_warm_report_t report;
    pel_snapshot_t kept;       /* while report.verdict is PEL_SNAP_WAITING, and when it was used */
    bool errors_due;           /* its attitude was given out, its sensor errors are next */
    pel_time_t still_since_ns; /* 0: in motion */
} pel_warm_t;

/* The snapshot of nav as it is now, with as many ephemerides as cap has room for (newest first); Klobuchar is not kept.
 * Returns its length; 0 if cap is below PEL_SNAPSHOT_BYTES or nav is not worth keeping: INS with heading to 20 degrees, an epoch
 * not older than coast_after_s, healthy factors. */
size_t pel_snapshot_encode(const struct pel_navigator_t *nav, uint32_t sequence, uint8_t *out, size_t cap);

/* Is it time to store one? When nav has stood for three seconds, once a standstill and not oftener than once a minute; again each hour
 * that it lasts. last_ns: when the last one was stored; 0: none in this life. */
bool pel_snapshot_is_due(const struct pel_navigator_t *nav, pel_time_t last_ns);

/* Does nav move, so that no snapshot of a standstill holds any more? */
bool pel_snapshot_is_outlived(const struct pel_navigator_t *nav);

/* Are these bytes a whole snapshot? PEL_SNAP_WAITING with its sequence; PEL_SNAP_NONE (erased: all 0xFF, or n = 0), _DAMAGED, _NEWER with
 * sequence unchanged. Bytes behind the snapshot (the rest of the slot) do not matter. */
pel_snap_t pel_snapshot_check(const uint8_t *bytes, size_t n, uint32_t *sequence);

/* Take it in, right after pel_navigator_init(): ephemerides and station are known at once, the attitude waits for the first epoch.
 * Returns PEL_SNAP_WAITING or why it was refused; all of it is then refused, and nav knows nothing more than before but the verdict. */
pel_snap_t pel_snapshot_restore(struct pel_navigator_t *nav, const uint8_t *bytes, size_t n);

#ifdef __cplusplus
}
#endif
#endif

/* observe.h - measurements become rows (innovation, h, variance) for the filter.
 *
 * A row says z = h'x + noise, with z = computed - measured and x the error state (computed - true), so that the filter's x
 * is what the closed loop subtracts. Rows of one group (one system, one carrier) share the noise of their pivot and pass
 * through pel_whiten_row() of gnss.h before the filter sees them. */
#ifndef PELORUS_OBSERVE_H
#define PELORUS_OBSERVE_H

#include "pelorus/base.h"
#include "pelorus/gnss.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One scalar row. h below `first` is zero and need not be set. */
typedef struct {
    pel_real z;   /* computed - measured, m or m/s */
    pel_real var; /* > 0, the same unit squared */
    int first;    /* index of the first state the row touches */
    int n;        /* states in use */
    pel_real h[PEL_MAX_STATES];
} pel_row_t;

/* Where the antenna stands on the body, and where its states are: all a row needs to know of the navigator. */
typedef struct {
    double lever_e[3];      /* C_b_e l_ba_b: IMU to antenna, resolved in e, m */
    double lever_rate_e[3]; /* C_b_e (omega_eb_b x l_ba_b), m/s */
    int n_states;
    int i_psi; /* first of three attitude states, -1 if there are none */
    int i_v;
    int i_r;
} pel_antenna_t;

/* DD range row of a satellite against its pivot: code, or phase once its integer is known.
 *
 *  ant   in   antenna and state indices; with attitude states i_psi < i_v < i_r
 *  sat   in   the satellite's single difference (only u_e is read)
 *  pivot in   the group's pivot
 *  dd_m  in   (observed - predicted) of the satellite minus that of the pivot, m; phase: minus lambda N
 *  row   out  z and h; var is left to pel_whiten_row()
 *
 * h = [g x on r | (C l) x g on psi], g = -(u_sat - u_pivot): S5 section 5, H = [G, 0, -G [R l x]]. About 40 flops. */
void pel_observe_range(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double dd_m,
                       pel_row_t *row);

/* DD range-rate (Doppler) row; arguments as above with dd_mps in m/s.
 *
 * h = [g on v | (C (omega x l)) x g on psi]: S5 section 5. The partials on the gyro states (gyro error x lever: below
 * 1 mm/s for 500 deg/h on 3 m... 3 mm/s on a MEMS gyro not yet calibrated, against 30 mm/s noise) are left out on purpose,
 * because they would make every Doppler row dense. */
void pel_observe_rate(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double dd_mps,
                      pel_row_t *row);

#ifdef __cplusplus
}
#endif
#endif

/* support_s3_system.h - the inertial system of S3 under trial: model, rows, offsets and path fit of the library. paper: as published, with
 * 12 states and differences in time; else with the phases' offsets as states. */
#ifndef SUPPORT_S3_SYSTEM_H
#define SUPPORT_S3_SYSTEM_H

#include "pelorus/observe.h"
#include "support_s3_scene.h"

typedef struct {
    pel_model_t model;
    pel_ud_t ud;
    pel_strapdown_t s;
    pel_coning_t coning;
    pel_propagator_t prop;
    pel_drift_model_t drift;
    pel_antenna_t ant;
    pel_path_t path[PAIRS];
    double b_g[3], b_a[3];
    double B[PAIRS], B_rate[PAIRS], dh, h_ref;
    bool has_B;
    double nis_sum;
    int nis_n;
    /* reference mode */
    bool paper;
    double C_before[3][3], f_sum[3], residual[SATS];
} s3_system_t;

void s3_imu(pel_imu_model_t *imu);

/* Aligned, at the scene's beginning. */
void s3_start(s3_system_t *x, const scenario_t *sc, const motion_t *m, carried_imu_t *imu, const pel_path_t path[PAIRS],
              bool paper);

/* Rows of the phases and of the height at t seconds, and the loop closed. */
void s3_epoch(s3_system_t *x, const double phase_m[SATS], double t);

#endif

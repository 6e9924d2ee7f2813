/* support_world.h - an inertial sensor carried along a motion of the simulator, and the closed loop of a filter around it: what the filter-level
 * trials of S2 and S3 share. No receiver, no serial bytes: phases are made from exact ranges. */
#ifndef SUPPORT_WORLD_H
#define SUPPORT_WORLD_H

#include "motion.h"
#include "pelorus/filter.h"
#include "pelorus/inertial.h"
#include "rng.h"

/* Constant and Markov errors, white noise; axes b. */
typedef struct {
    pel_imu_model_t model;
    rng_t rng;
    double constant_g[3], markov_g[3], constant_a[3], markov_a[3];
    double step_s;
} carried_imu_t;

/* Draw the errors of one run. */
void carried_imu_init(carried_imu_t *imu, const pel_imu_model_t *model, double step_s, uint64_t seed);

/* True increments over [t0, t0 + step] with errors, less the estimates. */
void carried_imu_step(carried_imu_t *imu, const motion_t *m, double t0, const double b_g[3], const double b_a[3],
                      double alpha[3], double upsilon[3]);

/* C <- exp(-[psi x]) C */
void turn_back(double C[3][3], const double psi[3]);

/* Local axes at the truth: rows east, north, up; and the error of a position in them. */
void local_error(const state_t *truth, const double r_e[3], const double v_e[3], double dr_enu[3], double dv_enu[3]);

double range_to(const double sat[3], const double r_a[3], double u[3]);

#endif

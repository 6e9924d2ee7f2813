/* support_carried.h - the rover of a pair with an IMU beside its antenna: epochs and increments, fed to a navigator second by second. */
#ifndef SUPPORT_CARRIED_H
#define SUPPORT_CARRIED_H

#include "support_pair.h"

#define CARRIED_IMU_NS (10 * PEL_NS_PER_MS)

/* It moves along one line and never turns over ground: d(t) = speed t + sway (1 - cos(rate t)), t since begin_s after SKY_T0; before that it stands. */
typedef struct {
    pair_t pair;
    double start_e[3], along_e[3]; /* unit vector over ground */
    double begin_s, speed_mps, sway_m, sway_radps;
    double C_b_e[3][3];
    double gyro_error[3]; /* constant, rad/s */
    double noise;         /* of the sensor, 1: that of a good MEMS IMU, 0.1 deg/sqrt(h) and 3e-4 m/s/sqrt(s) */
    uint32_t seed;
    int sample; /* the next to be made: its end is at SKY_T0 + sample * CARRIED_IMU_NS */
} carried_t;

/* At rest, level and heading as told, GPS on L1 and L2. The navigator knows the heading if `told`. */
void carried_init(carried_t *c, pel_navigator_t *nav, double heading_rad, bool told);

/* Begin with another configuration. */
void carried_introduce(carried_t *c, pel_navigator_t *nav, const pel_nav_config_t *cfg);

/* Which way it moves; without this: forward. */
void carried_course(carried_t *c, double course_rad);

/* Heading of the navigator's attitude at the horizon, less the truth, in -pi..pi. */
double carried_heading_error(const carried_t *c, const pel_navigator_t *nav);

/* The next increment of the sensor, of a body level and with this heading. */
pel_imu_t carried_imu(carried_t *c);

/* Increments up to this time. */
void carried_imu_until(carried_t *c, pel_navigator_t *nav, pel_time_t t_ns);

/* What both receivers see in the next second. */
void carried_observe(carried_t *c, pel_epoch_t *base, pel_epoch_t *rover);

/* A second: increments, both epochs, and the increments that the epoch waits for. NULL instead of an epoch: it is lost. */
void carried_push(carried_t *c, pel_navigator_t *nav, const pel_epoch_t *base, const pel_epoch_t *rover);
void carried_step(carried_t *c, pel_navigator_t *nav);
void carried_run(carried_t *c, pel_navigator_t *nav, int seconds);

/* Distance of the state at the horizon from the truth, m. */
double carried_error_m(const carried_t *c, const pel_navigator_t *nav);

/* How much the variance of the first float phase grows when they wandered so long ago. */
double carried_wandered_by(pel_navigator_t *nav, void (*wander)(pel_navigator_t *), double dt_s);

#endif

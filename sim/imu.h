/* imu.h - a strapdown sensor triad: true increments in, what the sensor would report out.
 *
 * Order of errors: mounting, scale and misalignment, constant and Markov bias, white noise, saturation, quantization with the
 * residue carried to the next sample (an integrating sensor loses nothing). Error = measured - true. */
#ifndef PELORUS_SIM_IMU_H
#define PELORUS_SIM_IMU_H

#include <stdint.h>

#include "motion.h"
#include "pelorus/base.h"
#include "rng.h"

/* One triad. Numbers are 1 sigma of what is drawn once per axis and seed, except white, lsb and range. */
typedef struct {
    double white;        /* rad/sqrt(s) or m/s/sqrt(s) */
    double bias_sd;      /* constant, rad/s or m/s^2 */
    double markov_sd;    /* in-run */
    double markov_tau_s; /* <= 0: no Markov part */
    double scale_sd;     /* relative */
    double misalign_sd;  /* rad */
    double lsb;          /* increment of one count, rad or m/s; 0: not quantized */
    double range;        /* largest rate, rad/s or m/s^2; 0: no limit */
} triad_config_t;

typedef struct {
    bool present;
    int64_t interval_ns;
    triad_config_t gyro, accel;
    double mount[3];      /* roll, pitch, yaw of the sensor with respect to the body, rad */
    double time_offset_s; /* reported minus true time of validity, 1 sigma, drawn once */
} imu_config_t;

typedef struct {
    triad_config_t cfg;
    double M[3][3]; /* identity + scale + misalignment */
    double constant[3], markov[3], residue[3];
    double markov_phi, markov_kick, white_kick, dt_s;
    rng_t rng;
} triad_t;

typedef struct {
    imu_config_t cfg;
    triad_t gyro, accel;
    double C_s_b[3][3]; /* sensor axes to body axes */
    int64_t tag_error_ns;
    uint16_t seq;
} imu_sim_t;

void imu_sim_init(imu_sim_t *s, const imu_config_t *cfg, uint64_t seed);

/* The sample that ends at t_ns (true), from true increments in b. */
void imu_sim_step(imu_sim_t *s, pel_time_t t_ns, const double alpha_b[3], const double upsilon_b[3], pel_imu_t *out);

/* Constant plus Markov error at this moment, body axes. */
void imu_sim_errors(const imu_sim_t *s, double b_g[3], double b_a[3]);

#endif

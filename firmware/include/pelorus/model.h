/* model.h - error models of the filter as lists of blocks, and their transition matrices. Room: model/.
 *
 * A model says which error states there are, in what order, and what drives them. The order puts what measurements touch
 * last, so that their rows change only the last columns of the factors (filter.h). Error = computed - true;
 * C~_b_e = (I + [psi x]) C_b_e; sensor error = measured - true. */
#ifndef PELORUS_MODEL_H
#define PELORUS_MODEL_H

#include "pelorus/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- sensors ----------------------------------------------------------------------------------------------------- */

/* What an IMU's errors are, per axis. */
typedef struct {
    double arw_rad_rts;   /* gyro white noise (angle random walk), rad/sqrt(s) */
    double vrw_mps_rts;   /* accelerometer white noise (velocity random walk), m/s/sqrt(s) */
    double sd_bg_radps;   /* gyro constant, 1 sigma */
    double sd_gm_radps;   /* gyro Markov, stationary 1 sigma */
    double tau_gm_s;      /* and its time constant, >= 10 s */
    double sd_am_mps2;    /* accelerometer Markov, stationary 1 sigma */
    double tau_am_s;      /* >= 10 s */
    double sd_ba_mps2;    /* accelerometer constant, 1 sigma, in models that have one */
    double accel_psd_rts; /* model without IMU: white acceleration, m/s^2 sqrt(s) = m/s/sqrt(s) per axis */
} pel_imu_model_t;

typedef enum {
    PEL_IMU_GRADE_TACTICAL = 0, /* S5 reference: 0.01 deg/h, 0.001 deg/sqrt(h), 10 ug */
    PEL_IMU_GRADE_MEMS = 1      /* consumer MEMS: 0.3 deg/s switch-on, 0.3 deg/sqrt(h), 30 mg */
} pel_imu_grade_t;

void pel_imu_model_preset(pel_imu_grade_t grade, pel_imu_model_t *imu);

/* ---- blocks ------------------------------------------------------------------------------------------------------- */

typedef enum {
    PEL_BLOCK_GYRO_CONSTANT = 0,  /* rad/s, b */
    PEL_BLOCK_GYRO_MARKOV = 1,    /* rad/s, b */
    PEL_BLOCK_ACCEL_CONSTANT = 2, /* m/s^2, b */
    PEL_BLOCK_ACCEL_MARKOV = 3,   /* m/s^2, b */
    PEL_BLOCK_LEVER_ARM = 4,      /* m, b */
    PEL_BLOCK_CLONE = 5,          /* copies of earlier states */
    PEL_BLOCK_ATTITUDE = 6,       /* psi, rad, e (enu in the local model, also the next two) */
    PEL_BLOCK_VELOCITY = 7,       /* m/s, e */
    PEL_BLOCK_POSITION = 8,       /* m, e */
    PEL_BLOCK_AMBIGUITY = 9,      /* cycles */
    PEL_BLOCK_OFFSET = 10,        /* between-satellite phase offsets: ambiguity, clocks and path, m */
    PEL_BLOCK_OFFSET_RATE = 11,   /* their rates, m/s */
    PEL_BLOCK_HEIGHT = 12,        /* estimated minus true deviation of the height reference (terrain, barometer), m */
    PEL_N_BLOCK = 13
} pel_block_t;

/* Which states there are. 4 + 26 + 72 bytes. Read freely; change through the functions. */
typedef struct {
    int n;                      /* states in all */
    uint8_t first[PEL_N_BLOCK]; /* index of a block's first state */
    uint8_t size[PEL_N_BLOCK];  /* its states; 0: not in this model */
    pel_imu_model_t imu;
} pel_model_t;

/* The 18 states of S5: gyro constant 0..2, gyro Markov 3..5, accelerometer Markov 6..8, psi 9..11, v 12..14, r 15..17. */
void pel_model_ins_ecef(pel_model_t *m, const pel_imu_model_t *imu);

/* The 18 states of S2 in the same order, psi, v and r resolved in local axes. Ambiguities are appended (S2: 6, 24 states in all).
 * Position error in metres: r = ((R_N + h) cos(lat) dlon, (R_M + h) dlat, dh), which keeps factors near those of ECEF. */
void pel_model_ins_enu(pel_model_t *m, const pel_imu_model_t *imu);

/* Without IMU: v 0..2, r 3..5, driven by white acceleration imu->accel_psd_rts. */
void pel_model_gnss(pel_model_t *m, const pel_imu_model_t *imu);

/* S3: gyro constant 0..2, accelerometer constant 3..5, psi 6..8, v 9..11, r 12..14, offsets (n, 1 or more), their rates (n), height
 * deviation: 16 + 2 n states, 20 with three satellites. n is cut to what PEL_MAX_STATES holds. */
void pel_model_tdcp(pel_model_t *m, const pel_imu_model_t *imu, int n_offsets);

/* Reference mode only: the 12 states of S3's paper, gyro, accelerometer, psi, v. No position, no gravity gradient: for comparison with what was
 * published, and worse than pel_model_tdcp() by a factor of six (docs/PRESETS.md). */
void pel_model_tdcp_paper(pel_model_t *m, const pel_imu_model_t *imu);

/* What drives offsets, their rates and the height deviation. */
typedef struct {
    double path_m_rts;        /* random walk of one satellite's path and clock, m/sqrt(s) */
    double rate_walk_mps_rts; /* random walk of an offset's rate, m/s/sqrt(s) */
    double sd_height_m;       /* height deviation: first-order Markov, stationary 1 sigma */
    double tau_height_s;      /* and its time constant, s */
} pel_drift_model_t;

/* Append a block at the end. PEL_E_FULL beyond PEL_MAX_STATES, PEL_E_RANGE if the block is there already or size < 1. */
pel_status_t pel_model_append(pel_model_t *m, pel_block_t block, int size);

/* Index of a block's first state, -1 if the model has none. */
int pel_model_index(const pel_model_t *m, pel_block_t block);

/* A first-order Markov state of stationary sd and time constant tau_s over dt_s: x <- (1 + decay) x, and the variance q added then. */
void pel_model_markov(double sd, double tau_s, double dt_s, pel_real *decay, pel_real *q);

/* Initial standard deviation of every sensor state from m->imu; other states are left alone. sd has m->n elements. */
void pel_model_sensor_sd(const pel_model_t *m, pel_real sd[PEL_MAX_STATES]);

/* ---- transition ---------------------------------------------------------------------------------------------------- */

#define PEL_MAX_PHI_BLOCKS 17 /* 15 of the 18 states in local axes, 2 more with an accelerometer constant */

/* Phi = I + sum of 3x3 blocks, and diagonal noise. What Phi adds to I is stored, not Phi: the float digits go to what is small.
 * Blocks are sorted by row. 18 states: about 880 bytes. */
typedef struct {
    int n;
    int n_blocks;
    struct {
        uint8_t row, col; /* of the block's first element */
        pel_real m[3][3];
    } block[PEL_MAX_PHI_BLOCKS];
    pel_real q[PEL_MAX_STATES]; /* variance added to each state; 0 for most */
} pel_transition_t;

/* Append a block to Phi - I, its first element at (row, col): its elements are the caller's to write. */
pel_real (*pel_transition_add(pel_transition_t *t, int row, int col))[3];

/* Transition over dt_s (0 < dt_s <= 0.25; 0.05 is usual) to second order: I + F dt + F^2 dt^2/2 (terms below 1e-9 of their
 * row's error left out: see docs/FILTER.md). Markov decay and noise are not in it: pel_model_slow().
 *
 *  f_e    in  specific force resolved in e, mean over the interval (sum of dv_f_e / dt), m/s^2; NULL for a model without IMU
 *  C_b_e  in  mean over the interval (of start and end); NULL likewise
 *  r_e    in  position, m
 *
 * F (S5 section 4):  psi' = -W psi + C (bg + gm)   v' = -2 W v - [f x] psi + C am + G r   r' = v,  W = [omega_ie x],
 * G = gravity gradient. Noise: arw^2 dt on psi, vrw^2 dt (or accel_psd^2 dt) on v: equal on the three axes, so the same in e.
 * A model without position has neither G nor the last row. */
void pel_model_transition(const pel_model_t *m, const double f_e[3], const double C_b_e[3][3], const double r_e[3],
                          double dt_s, pel_transition_t *t);

/* The same for pel_model_ins_enu(): all vectors in local axes, v_enu in m/s, |lat| below 89 degrees (rad), h in m.
 *
 * F (S2 section 6 corrected, in the house's sign and metres: docs/PRESETS.md), w_en = (-vN/M, vE/N, vE tan/N), w_in = w_ie + w_en:
 *   psi' = -w_in x psi + C (bg + gm) - dw_in          v' = -[f x] psi + C am - (w_in + w_ie) x dv + v x (dw_in + dw_ie) + (0, 0, g' dh)
 *   r' = dv + ((vU - vN tan)/N rE + vE tan/N rN - vE/N rU,  vU/M rN - vN/M rU,  0)
 * with dw the changes of the rates with velocity and position. Left out: derivatives of R_M, R_N and g by latitude.
 * Noise as above. About 500 flops, one sine and cosine. */
void pel_model_transition_enu(const pel_model_t *m, const double f_enu[3], const double C_b_enu[3][3],
                              const double v_enu[3], double lat, double h, double dt_s, pel_transition_t *t);

/* Decay and noise of the Markov states over dt_s: call it every second or so. At 0.05 s the decay of an hour's Markov process,
 * 1 - 1.4e-5, keeps only 8 bits in float, at 1 s 13. decay[i] = exp(-dt/tau) - 1 (0 for other states), q[i] = sd^2 (1 - exp(-2 dt/tau)).
 * Both have m->n elements. The mean decays alike: b += decay b. */
void pel_model_slow(const pel_model_t *m, double dt_s, pel_real decay[PEL_MAX_STATES], pel_real q[PEL_MAX_STATES]);

#ifdef __cplusplus
}
#endif
#endif

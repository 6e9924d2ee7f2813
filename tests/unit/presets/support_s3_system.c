/* support_s3_system.c - see support_s3_system.h. */
#include "support_s3_system.h"

#include <math.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "unity.h"

#define DEG_PER_H (PEL_DEG / 3600.0)

void s3_imu(pel_imu_model_t *imu)
{
    memset(imu, 0, sizeof *imu);
    imu->arw_rad_rts = 0.001 * PEL_DEG / 60.0;
    imu->vrw_mps_rts = 5e-6 * 9.80665;
    imu->sd_bg_radps = 0.005 * DEG_PER_H;
    imu->sd_ba_mps2 = 5e-5 * 9.80665;
    imu->tau_gm_s = imu->tau_am_s = 3600.0;
}

static void index_states(s3_system_t *x)
{
    x->ant.n_states = x->model.n;
    x->ant.i_psi = pel_model_index(&x->model, PEL_BLOCK_ATTITUDE);
    x->ant.i_v = pel_model_index(&x->model, PEL_BLOCK_VELOCITY);
    x->ant.i_r = pel_model_index(&x->model, PEL_BLOCK_POSITION);
}

/* Static alignment as three rows: its attitude errors are those of the sensors (S3 section 10), and the filter must know it. */
static void align(s3_system_t *x, const double C_b_enu[3][3], const double C_e_enu[3][3], double lat)
{
    const double g = 9.79, w_n = PEL_OMEGA_IE * cos(lat), w_u = PEL_OMEGA_IE * sin(lat);
    const double noise[3] = {1e-6, 1e-6, 2e-4};
    const int psi = x->ant.i_psi, gyro = pel_model_index(&x->model, PEL_BLOCK_GYRO_CONSTANT);
    const int accel = pel_model_index(&x->model, PEL_BLOCK_ACCEL_CONSTANT);
    for (int row = 0; row < 3; row++) {
        pel_real h[PEL_MAX_STATES] = {PEL_R(0.0)};
        for (int k = 0; k < 3; k++) {
            if (row == 0) { h[accel + k] = (pel_real)(-C_b_enu[1][k] / g); } /* psi_E = b_N / g */
            if (row == 1) { h[accel + k] = (pel_real)(C_b_enu[0][k] / g); }  /* psi_N = -b_E / g */
            if (row == 2) { h[gyro + k] = (pel_real)(-C_b_enu[0][k] / w_n); }
            h[psi + k] = (pel_real)(C_e_enu[row][k] - ((row == 2) ? w_u / w_n * C_e_enu[1][k] : 0.0));
        }
        TEST_ASSERT_EQUAL(
            PEL_OK, pel_ud_update(&x->ud, h, 0, PEL_R(0.0), (pel_real)(noise[row] * noise[row]), PEL_R(0.0), NULL));
    }
}

void s3_start(s3_system_t *x, const scenario_t *sc, const motion_t *m, carried_imu_t *imu, const pel_path_t path[PAIRS],
              bool paper)
{
    state_t truth;
    double C_e_enu[3][3], C_b_enu[3][3], psi_enu[3], psi[3], e_a[3], e_g[3];
    pel_real sd[PEL_MAX_STATES] = {PEL_R(0.0)};
    memset(x, 0, sizeof *x);
    x->paper = paper;
    memcpy(x->path, path, sizeof x->path);
    if (paper) {
        pel_model_tdcp_paper(&x->model, &imu->model);
    } else {
        pel_model_tdcp(&x->model, &imu->model, PAIRS);
    }
    index_states(x);
    x->drift = (pel_drift_model_t){PATH, 1e-4 / 30.0 / 10.0, sc->sd_height_m, sc->tau_height_s};
    motion_at(m, 0.0, &truth);
    pel_earth_C_e_enu(truth.llh[0], truth.llh[1], C_e_enu);
    pel_mat3_mul(C_e_enu, truth.C_b_e, C_b_enu);

    pel_model_sensor_sd(&x->model, sd);
    for (int i = 0; i < 3; i++) {
        sd[x->ant.i_psi + i] = PEL_R(0.01);
        sd[x->ant.i_v + i] = PEL_R(1e-3);
        if (x->ant.i_r >= 0) { sd[x->ant.i_r + i] = PEL_R(0.01); }
    }
    if (!paper) {
        for (int k = 0; k < PAIRS; k++) {
            sd[pel_model_index(&x->model, PEL_BLOCK_OFFSET) + k] = PEL_R(100.0);
            sd[pel_model_index(&x->model, PEL_BLOCK_OFFSET_RATE) + k] = (pel_real)path[k].sd_rate_mps;
        }
        sd[pel_model_index(&x->model, PEL_BLOCK_HEIGHT)] = (pel_real)sc->sd_height_m;
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&x->ud, x->model.n, sd));
    align(x, C_b_enu, C_e_enu, truth.llh[0]);

    /* and the truth of it */
    pel_mat3_vec(C_b_enu, imu->constant_a, e_a);
    pel_mat3_vec(C_b_enu, imu->constant_g, e_g);
    psi_enu[0] = e_a[1] / 9.79 + 1e-6 * rng_normal(&imu->rng);
    psi_enu[1] = -e_a[0] / 9.79 + 1e-6 * rng_normal(&imu->rng);
    psi_enu[2] = (e_g[0] + PEL_OMEGA_IE * sin(truth.llh[0]) * psi_enu[1]) / (PEL_OMEGA_IE * cos(truth.llh[0])) +
                 2e-4 * rng_normal(&imu->rng);
    pel_mat3_tvec(C_e_enu, psi_enu, psi);
    for (int i = 0; i < 3; i++) { psi[i] = -psi[i]; }
    memcpy(x->s.C_b_e, truth.C_b_e, sizeof x->s.C_b_e);
    turn_back(x->s.C_b_e, psi);
    for (int i = 0; i < 3; i++) {
        x->s.v_eb_e[i] = 1e-3 * rng_normal(&imu->rng);
        x->s.r_eb_e[i] = truth.r_eb_e[i] + (paper ? 0.0 : 0.01 * rng_normal(&imu->rng));
    }
    x->h_ref = truth.llh[2];
    pel_coning_init(&x->coning);
    pel_propagator_init(&x->prop, x->s.C_b_e);
    memcpy(x->C_before, x->s.C_b_e, sizeof x->C_before);
}

static void feed_back(s3_system_t *x)
{
    const int gyro = pel_model_index(&x->model, PEL_BLOCK_GYRO_CONSTANT);
    const int accel = pel_model_index(&x->model, PEL_BLOCK_ACCEL_CONSTANT);
    double psi[3];
    for (int i = 0; i < 3; i++) {
        psi[i] = (double)x->ud.x[x->ant.i_psi + i];
        x->s.v_eb_e[i] -= (double)x->ud.x[x->ant.i_v + i];
        if (x->ant.i_r >= 0) { x->s.r_eb_e[i] -= (double)x->ud.x[x->ant.i_r + i]; }
        x->b_g[i] += (double)x->ud.x[gyro + i];
        x->b_a[i] += (double)x->ud.x[accel + i];
    }
    turn_back(x->s.C_b_e, psi);
    if (!x->paper) {
        for (int k = 0; k < PAIRS; k++) {
            x->B[k] -= (double)x->ud.x[pel_model_index(&x->model, PEL_BLOCK_OFFSET) + k];
            x->B_rate[k] -= (double)x->ud.x[pel_model_index(&x->model, PEL_BLOCK_OFFSET_RATE) + k];
        }
        x->dh -= (double)x->ud.x[pel_model_index(&x->model, PEL_BLOCK_HEIGHT)];
    }
    for (int i = 0; i < x->ud.n; i++) { x->ud.x[i] = PEL_R(0.0); }
    memcpy(x->prop.C_start, x->s.C_b_e, sizeof x->prop.C_start);
}

static void update(s3_system_t *x, const pel_row_t *row, bool counts)
{
    pel_real nis;
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_update(&x->ud, row->h, row->first, row->z, row->var, PEL_R(0.0), &nis));
    if (counts) {
        x->nis_sum += (double)nis;
        x->nis_n++;
    }
}

/* Observed minus predicted of each satellite. */
static void predict(const s3_system_t *x, const double phase_m[SATS], pel_sd_t sat[SATS])
{
    double r_a[3];
    for (int k = 0; k < 3; k++) { r_a[k] = x->s.r_eb_e[k] + x->ant.lever_e[k]; }
    memset(sat, 0, SATS * sizeof *sat);
    for (int i = 0; i < SATS; i++) { sat[i].phase_m = phase_m[i] - range_to(S3_SAT[i], r_a, sat[i].u_e); }
}

static double drift_of(const s3_system_t *x, int pair, double t)
{
    return pel_path_at(&x->path[pair], t) - pel_path_at(&x->path[pair], 0.0);
}

static void phase_rows(s3_system_t *x, const pel_sd_t sat[SATS], double t)
{
    const int i_B = pel_model_index(&x->model, PEL_BLOCK_OFFSET);
    pel_whiten_t w;
    TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_begin(&w, x->model.n, (pel_real)(SIGMA * SIGMA)));
    for (int k = 0; k < PAIRS; k++) {
        pel_row_t row;
        const double dd = sat[k + 1].phase_m - sat[0].phase_m - drift_of(x, k, t);
        if (!x->has_B) { x->B[k] = dd; }
        pel_observe_float(&x->ant, &sat[k + 1], &sat[0], dd - x->B[k], i_B + k, 1.0, &row);
        TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_row(&w, (pel_real)(SIGMA * SIGMA), &row.z, row.h, &row.var));
        update(x, &row, x->has_B && t > 300.0);
        pel_whiten_accept(&w, (pel_real)(SIGMA * SIGMA), row.z, row.h);
    }
    x->has_B = true;
}

/* The paper's: differences in time on 12 states, and no vertical velocity. */
static void delayed_rows(s3_system_t *x, const pel_sd_t sat[SATS], double t)
{
    pel_delay_t d = {.dt_s = EPOCH};
    pel_whiten_t w;
    const double var = 2.0 * SIGMA * SIGMA;
    memcpy(d.C_before, x->C_before, sizeof d.C_before);
    memcpy(d.C_now, x->s.C_b_e, sizeof d.C_now);
    for (int k = 0; k < 3; k++) {
        d.f_ib_b[k] = x->f_sum[k] / EPOCH;
        d.lever_b[k] = S3_LEVER[k];
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_begin(&w, x->model.n, (pel_real)var));
    for (int k = 0; k < PAIRS && x->has_B; k++) {
        pel_row_t row;
        const double change = sat[k + 1].phase_m - x->residual[k + 1] - (sat[0].phase_m - x->residual[0]) -
                              (drift_of(x, k, t) - drift_of(x, k, t - EPOCH));
        pel_observe_delayed(&x->model, &d, &sat[k + 1], &sat[0], change, &row);
        TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_row(&w, (pel_real)var, &row.z, row.h, &row.var));
        update(x, &row, false);
        pel_whiten_accept(&w, (pel_real)var, row.z, row.h);
    }
    x->has_B = true;
}

static void height_rows(s3_system_t *x)
{
    double lat, lon, h, C_e_enu[3][3];
    pel_row_t row;
    pel_antenna_t here = x->ant; /* the reference is that of the IMU's point */
    memset(here.lever_e, 0, sizeof here.lever_e);
    pel_earth_ecef_to_llh(x->s.r_eb_e, &lat, &lon, &h);
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    if (x->paper) {
        pel_observe_velocity(&here, C_e_enu[2], pel_dot3(C_e_enu[2], x->s.v_eb_e), &row);
        row.var = PEL_R(4e-4); /* 0.02 m/s */
    } else {
        pel_observe_height(&here, C_e_enu[2], h - x->h_ref - x->dh, pel_model_index(&x->model, PEL_BLOCK_HEIGHT), &row);
        row.var = PEL_R(1e-4);
    }
    update(x, &row, false);
}

void s3_epoch(s3_system_t *x, const double phase_m[SATS], double t)
{
    pel_sd_t sat[SATS];
    TEST_ASSERT_EQUAL(PEL_OK, pel_propagator_flush(&x->prop, &x->model, x->s.C_b_e, x->s.r_eb_e, &x->ud));
    if (x->has_B) {
        TEST_ASSERT_EQUAL(PEL_OK, pel_propagate_offsets(&x->model, &x->drift, EPOCH, &x->ud));
        for (int k = 0; k < PAIRS; k++) { x->B[k] += EPOCH * x->B_rate[k]; }
        x->dh *= exp(-EPOCH / x->drift.tau_height_s);
    }
    pel_mat3_vec(x->s.C_b_e, S3_LEVER, x->ant.lever_e);
    predict(x, phase_m, sat);
    if (x->paper) {
        delayed_rows(x, sat, t);
    } else {
        phase_rows(x, sat, t);
    }
    height_rows(x);
    feed_back(x);
    pel_mat3_vec(x->s.C_b_e, S3_LEVER, x->ant.lever_e);
    predict(x, phase_m, sat);
    for (int i = 0; i < SATS; i++) { x->residual[i] = sat[i].phase_m; }
    memcpy(x->C_before, x->s.C_b_e, sizeof x->C_before);
    memset(x->f_sum, 0, sizeof x->f_sum);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&x->ud));
}

/* Alignment at rest: gyrocompass against its own predicted covariance over many seeds, levelling, detection of motion. */
#include <math.h>
#include <stdio.h>

#include "pelorus/earth.h"
#include "pelorus/inertial.h"
#include "pelorus/math.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

#define LAT 0.53
#define LON 1.99
#define H   1500.0

static uint64_t seed;

static double uniform(void)
{
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return (double)((seed ^ (seed >> 29)) >> 11) * 0x1p-53;
}

static double normal(void)
{
    return sqrt(-2.0 * log(uniform() + 1e-300)) * cos(6.283185307179586 * uniform());
}

/* gyro 0.01 deg/h and 0.001 deg/sqrt(h), accelerometer 10 ug and 1e-5 m/s/sqrt(s): S5's IMU */
static const pel_align_config_t TACTICAL = {.arw_rad_rts = 2.909e-7,
                                            .vrw_mps_rts = 1e-5,
                                            .sd_bg_radps = 4.848e-8,
                                            .sd_ba_mps2 = 9.807e-5,
                                            .block_s = 0.25,
                                            .gyro_tol_radps = 2e-5,
                                            .accel_tol_mps2 = 5e-3};

/* What a resting IMU measures */
static void at_rest(const double C_b_e[3][3], double f_b[3], double w_b[3])
{
    double r[3];
    double g[3];
    const double w[3] = {0.0, 0.0, PEL_OMEGA_IE};
    pel_earth_llh_to_ecef(LAT, LON, H, r);
    pel_earth_gravity_e(r, g);
    pel_mat3_tvec(C_b_e, g, f_b);
    for (int i = 0; i < 3; i++) { f_b[i] = -f_b[i]; }
    pel_mat3_tvec(C_b_e, w, w_b);
}

static void push_static(pel_align_t *a, const double f[3], const double w[3], double T, double dt,
                        const pel_align_config_t *c)
{
    const int n = (int)lround(T / dt);
    for (int k = 0; k < n; k++) {
        pel_imu_t imu = {.t_ns = (pel_time_t)(k + 1) * (pel_time_t)(dt * 1e9), .dt_s = dt};
        for (int i = 0; i < 3; i++) {
            imu.alpha_ib_b[i] = w[i] * dt + c->arw_rad_rts * sqrt(dt) * normal();
            imu.upsilon_ib_b[i] = f[i] * dt + c->vrw_mps_rts * sqrt(dt) * normal();
        }
        TEST_ASSERT_TRUE(pel_align_push(a, &imu) != PEL_W_REJECTED);
    }
}

/* psi in east-north-up of an aligned attitude against the truth */
static void error_enu(const double C[3][3], const double truth[3][3], double psi[3])
{
    double M[3][3];
    double e[3];
    double C_e_enu[3][3];
    pel_mat3_mult(C, truth, M);
    pel_dcm_to_rotvec(M, e);
    pel_earth_C_e_enu(LAT, LON, C_e_enu);
    pel_mat3_vec(C_e_enu, e, psi);
}

static void gyrocompass_is_as_good_as_it_says(void)
{
    const int runs = 200;
    double sum2[3] = {0};
    double cross = 0.0;
    double nees = 0.0;
    double worst_units = 0.0;
    pel_alignment_t out = {0};
    for (int k = 0; k < runs; k++) {
        double truth[3][3];
        double f[3];
        double w[3];
        double psi[3];
        pel_align_t a;
        seed = (uint64_t)(1000 + k);
        (void)uniform();
        pel_attitude_to_C_b_e(1.5 * (uniform() - 0.5), 1.0 * (uniform() - 0.5), 6.28 * uniform(), LAT, LON, truth);
        at_rest(truth, f, w);
        for (int i = 0; i < 3; i++) {
            f[i] += TACTICAL.sd_ba_mps2 * normal();
            w[i] += TACTICAL.sd_bg_radps * normal();
        }
        pel_align_init(&a, &TACTICAL);
        push_static(&a, f, w, 60.0, 0.02, &TACTICAL);
        TEST_ASSERT_EQUAL(PEL_OK, pel_align_gyrocompass(&a, LAT, LON, H, 0.1, &out));
        TEST_ASSERT_EQUAL(0, a.restarts);
        error_enu(out.C_b_e, truth, psi);
        for (int i = 0; i < 3; i++) { sum2[i] += psi[i] * psi[i] / runs; }
        cross += psi[1] * psi[2] / runs;

        double inv[3][3];
        double psi_e[3];
        double y[3];
        double C_e_enu[3][3];
        pel_earth_C_e_enu(LAT, LON, C_e_enu);
        pel_mat3_tvec(C_e_enu, psi, psi_e);
        TEST_ASSERT_EQUAL(PEL_OK, pel_mat3_inverse(out.cov_psi_e, inv));
        pel_mat3_vec(inv, psi_e, y);
        nees += pel_dot3(psi_e, y) / runs;
        worst_units = fmax(worst_units, fabs(psi[2]) / out.sd_heading_rad);
    }
    const double ratio_level = sqrt(0.5 * (sum2[0] + sum2[1])) / out.sd_level_rad;
    const double ratio_heading = sqrt(sum2[2]) / out.sd_heading_rad;
    const double rho = cross / sqrt(sum2[1] * sum2[2]);
    const double rho_said = tan(LAT) * out.sd_level_rad / out.sd_heading_rad;
    printf("  gyrocompass, 60 s, %d seeds: tilt %.1f\" (said %.1f\"), heading %.0f\" (said %.0f\"); NEES %.2f of 3; "
           "tilt-heading correlation %.2f "
           "(said %.2f)\n",
           runs, out.sd_level_rad * ratio_level * 206265.0, out.sd_level_rad * 206265.0, sqrt(sum2[2]) * 206265.0,
           out.sd_heading_rad * 206265.0, nees, rho, rho_said);
    TEST_ASSERT_TRUE(ratio_level > 0.9 && ratio_level < 1.1);
    TEST_ASSERT_TRUE(ratio_heading > 0.87 && ratio_heading < 1.13); /* 99 % of 200 runs */
    TEST_ASSERT_TRUE(nees * runs > 520.0 && nees * runs < 684.0);   /* chi-square 600, 98 % */
    TEST_ASSERT_TRUE(worst_units < 4.5);
}

/* Against the attitude that a gyrocompass finds with that error and without. */
static void what_sensor_errors_make_of_attitude_is_told_to_first_order(void)
{
    static const pel_align_config_t QUIET = {.block_s = 0.25, .gyro_tol_radps = 1.0, .accel_tol_mps2 = 1.0};
    double truth[3][3], A_f[3][3], A_w[3][3], C_e_enu[3][3];
    pel_attitude_to_C_b_e(0.2, -0.1, 0.6, LAT, LON, truth);
    pel_align_sensor_part(truth, LAT, LON, H, A_f, A_w);
    pel_earth_C_e_enu(LAT, LON, C_e_enu);
    for (int k = 0; k < 6; k++) {
        const double size = (k < 3) ? 1e-3 : 1e-8;
        double f[3], w[3], psi[3], told[3];
        pel_align_t a;
        pel_alignment_t out;
        at_rest(truth, f, w);
        if (k < 3) { f[k] += size; }
        if (k >= 3) { w[k - 3] += size; }
        pel_align_init(&a, &QUIET);
        push_static(&a, f, w, 1.0, 0.25, &QUIET);
        TEST_ASSERT_EQUAL(PEL_OK, pel_align_gyrocompass(&a, LAT, LON, H, PEL_PI, &out));
        TEST_ASSERT_TRUE(out.leans_on_sensors);
        error_enu(out.C_b_e, truth, psi);
        for (int i = 0; i < 3; i++) {
            told[i] = 0.0;
            for (int j = 0; j < 3; j++) { told[i] += C_e_enu[i][j] * size * ((k < 3) ? A_f[j][k] : A_w[j][k - 3]); }
            TEST_ASSERT_DOUBLE_WITHIN(1e-3 * 1e-4, told[i], psi[i]);
        }
    }
}

/* An accelerometer error alone: it tilts, and the tilt about north turns the heading by tan(lat) of itself. */
static void tilt_couples_into_heading(void)
{
    double truth[3][3];
    double f[3];
    double w[3];
    double psi[3];
    pel_align_t a;
    pel_alignment_t out;
    pel_align_config_t cfg = TACTICAL;
    cfg.sd_ba_mps2 = 0.05;
    seed = 3;
    pel_attitude_to_C_b_e(0.0, 0.0, 0.6, LAT, LON, truth);
    at_rest(truth, f, w);
    f[0] += 0.05;
    f[1] -= 0.03;
    pel_align_init(&a, &cfg);
    push_static(&a, f, w, 600.0, 0.02, &cfg);
    TEST_ASSERT_EQUAL(PEL_OK, pel_align_gyrocompass(&a, LAT, LON, H, 0.1, &out));
    error_enu(out.C_b_e, truth, psi);
    TEST_ASSERT_TRUE(fabs(psi[1]) > 2e-3);
    TEST_ASSERT_DOUBLE_WITHIN(0.3 * fabs(psi[1] * tan(LAT)), tan(LAT) * psi[1], psi[2]);
    double C_e_enu[3][3];
    double P[3][3];
    pel_earth_C_e_enu(LAT, LON, C_e_enu);
    pel_mat3_congruence(C_e_enu, out.cov_psi_e, P);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, tan(LAT) * P[1][1], P[1][2]);
}

static void a_coarse_gyro_gives_level_only(void)
{
    pel_align_config_t mems = {.arw_rad_rts = 1e-4,
                               .vrw_mps_rts = 1e-3,
                               .sd_bg_radps = 5e-3,
                               .sd_ba_mps2 = 0.1,
                               .block_s = 0.25,
                               .gyro_tol_radps = 0.01,
                               .accel_tol_mps2 = 0.2};
    double truth[3][3];
    double f[3];
    double w[3];
    double psi[3];
    pel_align_t a;
    pel_alignment_t out;
    seed = 5;
    pel_attitude_to_C_b_e(0.3, -0.2, 0.0, LAT, LON, truth);
    at_rest(truth, f, w);
    w[0] += 4e-3;
    pel_align_init(&a, &mems);
    push_static(&a, f, w, 10.0, 0.01, &mems);
    TEST_ASSERT_EQUAL(PEL_W_REJECTED, pel_align_gyrocompass(&a, LAT, LON, H, 0.1, &out));
    error_enu(out.C_b_e, truth, psi); /* heading 0 is assumed and is true here */
    TEST_ASSERT_TRUE(pel_norm3(psi) < 1e-3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, PEL_PI, out.sd_heading_rad);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 0.1 / 9.79, out.sd_level_rad);
    double fm[3];
    double wm[3];
    TEST_ASSERT_EQUAL(PEL_OK, pel_align_mean(&a, fm, wm));
    TEST_ASSERT_DOUBLE_WITHIN(2e-4, w[0], wm[0]);
}

static void motion_restarts_the_average(void)
{
    double truth[3][3];
    double f[3];
    double w[3];
    pel_align_t a;
    seed = 9;
    pel_attitude_to_C_b_e(0.0, 0.0, 1.0, LAT, LON, truth);
    at_rest(truth, f, w);
    pel_align_init(&a, &TACTICAL);
    push_static(&a, f, w, 10.0, 0.02, &TACTICAL);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 10.0, a.t_static_s);
    TEST_ASSERT_TRUE(a.still);
    bool seen = false;
    for (int k = 0; k < 50; k++) { /* a quarter degree a second */
        pel_imu_t imu = {.dt_s = 0.02};
        for (int i = 0; i < 3; i++) {
            imu.alpha_ib_b[i] = (w[i] + ((i == 2) ? 0.0044 : 0.0)) * 0.02;
            imu.upsilon_ib_b[i] = f[i] * 0.02;
        }
        seen = seen || (pel_align_push(&a, &imu) == PEL_W_REJECTED);
    }
    TEST_ASSERT_TRUE(seen && a.restarts > 0 && a.t_static_s < 1.3);
}

static void nonsense_is_refused(void)
{
    pel_align_t a;
    pel_alignment_t out = {.sd_level_rad = 7.0};
    const double f[3] = {0.0, 0.0, 5.0};
    const double w[3] = {0.0, 5e-5, 5e-5};
    pel_align_init(&a, &TACTICAL);
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_align_gyrocompass(&a, LAT, LON, H, 0.1, &out));
    push_static(&a, f, w, 5.0, 0.02, &TACTICAL);
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_align_gyrocompass(&a, LAT, LON, H, 0.1, &out)); /* half of gravity */
    const double f_side[3] = {0.0, 9.79, 0.0};
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_align_level(f_side, NULL, 0.0, 0.1, 0.1, LAT, LON, H, &out));
    TEST_ASSERT_TRUE(out.sd_level_rad == 7.0);
    const double f_good[3] = {0.0, 0.0, 9.79};
    const double w_fast[3] = {0.0, 1e-3, 0.0};
    pel_align_init(&a, &TACTICAL);
    push_static(&a, f_good, w_fast, 5.0, 0.02, &TACTICAL);
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_align_gyrocompass(&a, LAT, LON, H, 0.1, &out)); /* turning table */
}

/* Any attitude short of standing on the nose, any acceleration: heading given, roll and pitch found. */
static void levelling_while_accelerating(void)
{
    double worst = 0.0;
    seed = 77;
    for (int k = 0; k < 2000; k++) {
        double C_b_enu[3][3];
        double C_e_enu[3][3];
        double r[3];
        double g_e[3];
        double f_enu[3];
        double f_b[3];
        pel_alignment_t out;
        const double roll = 2.0 * (uniform() - 0.5);
        const double pitch = 2.0 * (uniform() - 0.5);
        const double heading = 6.28 * uniform();
        const double a[3] = {4.0 * (uniform() - 0.5), 4.0 * (uniform() - 0.5), 2.0 * (uniform() - 0.5)};
        pel_attitude_to_C_b_enu(roll, pitch, heading, C_b_enu);
        pel_earth_llh_to_ecef(LAT, LON, H, r);
        pel_earth_gravity_e(r, g_e);
        pel_earth_C_e_enu(LAT, LON, C_e_enu);
        pel_mat3_vec(C_e_enu, g_e, f_enu);
        for (int i = 0; i < 3; i++) { f_enu[i] = a[i] - f_enu[i]; }
        pel_mat3_tvec(C_b_enu, f_enu, f_b);
        TEST_ASSERT_EQUAL(PEL_OK, pel_align_level(f_b, a, heading, 0.05, 0.01, LAT, LON, H, &out));
        double got[3];
        pel_attitude_from_C_b_e(out.C_b_e, LAT, LON, &got[0], &got[1], &got[2]);
        worst = fmax(worst, fmax(fabs(got[0] - roll), fabs(got[1] - pitch)));
        TEST_ASSERT_TRUE(fabs(pel_wrap_pi(got[2] - heading)) < 1e-12);
    }
    printf("  levelling with known acceleration: %.1e rad\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-13);
}

static void a_given_attitude_is_taken_with_its_uncertainty(void)
{
    pel_alignment_t out;
    double C[3][3];
    double C_e_enu[3][3];
    double P[3][3];
    pel_align_from_attitude(0.1, 0.2, 0.3, 1e-3, 1e-2, LAT, LON, &out);
    pel_attitude_to_C_b_e(0.1, 0.2, 0.3, LAT, LON, C);
    TEST_ASSERT_EQUAL_MEMORY(C, out.C_b_e, sizeof C);
    pel_earth_C_e_enu(LAT, LON, C_e_enu);
    pel_mat3_congruence(C_e_enu, out.cov_psi_e, P);
    const double want[3] = {1e-6, 1e-6, 1e-4};
    for (int i = 0; i < 9; i++) { TEST_ASSERT_DOUBLE_WITHIN(1e-18, (i % 4 == 0) ? want[i / 4] : 0.0, P[i / 3][i % 3]); }
}

static void a_body_at_the_pole_or_of_a_wrong_weight_gets_no_heading(void)
{
    pel_align_t a;
    pel_alignment_t out = {.sd_level_rad = 7.0};
    const double f[3] = {0.0, 0.0, 9.81};
    const double w[3] = {0.0, 1e-6, 7.29e-5};
    pel_align_config_t still = TACTICAL;
    still.arw_rad_rts = still.vrw_mps_rts = 0.0;
    pel_align_init(&a, &still);
    push_static(&a, f, w, 60.0, 0.02, &still);
    const double near_pole = 89.5 * PEL_DEG;
    TEST_ASSERT_EQUAL(PEL_W_REJECTED, pel_align_gyrocompass(&a, near_pole, LON, H, PEL_PI, &out));
    TEST_ASSERT_EQUAL_DOUBLE(PEL_PI, out.sd_heading_rad);
    TEST_ASSERT_TRUE(out.sd_level_rad < 1e-3);

    const double light[3] = {0.0, 0.0, 5.0}; /* neither heading nor level */
    out = (pel_alignment_t){.sd_level_rad = 7.0};
    pel_align_init(&a, &still);
    push_static(&a, light, w, 60.0, 0.02, &still);
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_align_gyrocompass(&a, near_pole, LON, H, PEL_PI, &out));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, out.sd_level_rad);
}

static void an_earth_rate_along_the_plumb_line_shows_no_north(void)
{
    pel_align_t a;
    pel_alignment_t out = {.sd_level_rad = 7.0};
    const double f[3] = {0.0, 0.0, 9.79};
    const double w[3] = {0.0, 0.0, PEL_OMEGA_IE};
    pel_align_config_t still = TACTICAL;
    still.arw_rad_rts = still.vrw_mps_rts = 0.0;
    pel_align_init(&a, &still);
    push_static(&a, f, w, 60.0, 0.02, &still);
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_align_gyrocompass(&a, LAT, LON, H, 0.1, &out));
    TEST_ASSERT_EQUAL_DOUBLE(7.0, out.sd_level_rad);
}

/* Specific force that no attitude turns into gravity and this acceleration. */
static void levelling_refuses_what_does_not_fit(void)
{
    pel_alignment_t out;
    const double heavy[3] = {0.0, 0.0, 13.0}, nose_up[3] = {0.0, 10.7, 2.0}, aside[3] = {5.0, 0.0, 0.0};
    const double good[3] = {0.0, 0.0, 9.79};
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_align_level(heavy, NULL, 0.0, 0.1, 0.1, LAT, LON, H, &out));
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_align_level(nose_up, aside, 0.0, 0.1, 0.1, LAT, LON, H, &out));
    TEST_ASSERT_EQUAL(PEL_OK, pel_align_level(good, NULL, 0.0, 0.1, 0.1, LAT, LON, H, &out));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(gyrocompass_is_as_good_as_it_says);
    RUN_TEST(what_sensor_errors_make_of_attitude_is_told_to_first_order);
    RUN_TEST(tilt_couples_into_heading);
    RUN_TEST(a_coarse_gyro_gives_level_only);
    RUN_TEST(motion_restarts_the_average);
    RUN_TEST(nonsense_is_refused);
    RUN_TEST(levelling_while_accelerating);
    RUN_TEST(a_given_attitude_is_taken_with_its_uncertainty);
    RUN_TEST(a_body_at_the_pole_or_of_a_wrong_weight_gets_no_heading);
    RUN_TEST(an_earth_rate_along_the_plumb_line_shows_no_north);
    RUN_TEST(levelling_refuses_what_does_not_fit);
    return UNITY_END();
}

/* build: f32 f64 */
/* S2's 24 states in local axes: errors grow as two ECEF mechanizations really drift apart, and the UD filter with float ambiguities equals Joseph's
 * form over a flight. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "support_dense.h"
#include "unity.h"

#define DEG_PER_H (PEL_DEG / 3600.0)
#define LAMBDA    0.190293672798

enum { PSI = 9, V = 12, R = 15, AMB = 18, N_AMB = 6, N = 24 };

void setUp(void) {}
void tearDown(void) {}

/* S2's IMU (section 10), with the small velocity noise of section 7. */
static void s2_imu(pel_imu_model_t *imu)
{
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, imu);
    imu->arw_rad_rts = 0.01 * DEG_PER_H;
    imu->vrw_mps_rts = 1e-6;
    imu->sd_bg_radps = 0.1 * DEG_PER_H;
    imu->sd_gm_radps = 0.1 * DEG_PER_H;
    imu->tau_gm_s = 3600.0;
    imu->sd_am_mps2 = 1e-4 * 9.80665;
    imu->tau_am_s = 1800.0;
}

static void start_at(pel_strapdown_enu_t *s)
{
    memset(s, 0, sizeof *s);
    pel_attitude_to_C_b_enu(0.05, 0.1, 0.9, s->C_b_enu);
    s->v_eb_enu[0] = 90.0;
    s->v_eb_enu[1] = 60.0;
    s->lat = 32.0 * PEL_DEG;
    s->lon = 118.0 * PEL_DEG;
    s->h = 1000.0;
}

/* What the pilot of a turning, climbing aeroplane makes its sensors feel. */
static void increments(double t, double dt, const double C[3][3], double alpha[3], double upsilon[3])
{
    const double a_enu[3] = {2.0 * sin(0.11 * t), 1.5 * cos(0.07 * t), 9.795 + 0.8 * sin(0.23 * t)};
    const double rate[3] = {0.03 * sin(0.31 * t), 0.05 * cos(0.17 * t), 0.06 * sin(0.05 * t) + 0.01};
    pel_mat3_tvec(C, a_enu, upsilon);
    for (int i = 0; i < 3; i++) {
        upsilon[i] *= dt;
        alpha[i] = rate[i] * dt;
    }
}

static void local_error(const pel_strapdown_t *wrong, const pel_strapdown_t *truth, double x[9])
{
    pel_strapdown_enu_t w, t;
    double M, N_radius, turned[3][3];
    TEST_ASSERT_EQUAL(PEL_OK, pel_strapdown_to_enu(wrong, &w));
    TEST_ASSERT_EQUAL(PEL_OK, pel_strapdown_to_enu(truth, &t));
    pel_earth_radii_at(pel_sin(t.lat), &M, &N_radius);
    pel_mat3_mult(w.C_b_enu, t.C_b_enu, turned);
    pel_dcm_to_rotvec(turned, x);
    for (int i = 0; i < 3; i++) { x[3 + i] = w.v_eb_enu[i] - t.v_eb_enu[i]; }
    x[6] = (N_radius + t.h) * cos(t.lat) * (w.lon - t.lon);
    x[7] = (M + t.h) * (w.lat - t.lat);
    x[8] = w.h - t.h;
}

/* Two ECEF mechanizations, one with errors; the local model, which never saw ECEF, must foretell how they part. */
static void errors_grow_as_two_ecef_mechanizations_part(void)
{
    const double dt = 0.01, b_g[3] = {3e-7, -2e-7, 4e-7}, b_a[3] = {3e-4, -2e-4, 1e-4};
    const double psi[3] = {2e-4, -3e-4, 5e-4};
    pel_strapdown_enu_t enu;
    pel_strapdown_t truth, wrong;
    pel_coning_t c_enu, c_truth, c_wrong;
    pel_propagator_t p;
    pel_imu_model_t imu;
    pel_model_t m;
    pel_ud_t ud;
    pel_real sd[PEL_MAX_STATES];
    double x[9], turned[3][3];
    start_at(&enu);
    pel_strapdown_from_enu(&enu, &truth);
    wrong = truth;
    pel_rotvec_to_dcm(psi, turned);
    pel_mat3_mul(turned, truth.C_b_e, wrong.C_b_e);
    for (int i = 0; i < 3; i++) {
        wrong.v_eb_e[i] += 0.05;
        wrong.r_eb_e[i] += 10.0 - 5.0 * i;
    }
    s2_imu(&imu);
    imu.tau_gm_s = imu.tau_am_s = 1e12; /* biases stay */
    pel_model_ins_enu(&m, &imu);
    for (int i = 0; i < m.n; i++) { sd[i] = PEL_R(1.0); }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, m.n, sd));
    local_error(&wrong, &truth, x);
    for (int i = 0; i < 9; i++) { ud.x[PSI + i] = (pel_real)x[i]; }
    for (int i = 0; i < 3; i++) {
        ud.x[i] = (pel_real)b_g[i];
        ud.x[6 + i] = (pel_real)b_a[i];
    }
    pel_coning_init(&c_enu);
    pel_coning_init(&c_truth);
    pel_coning_init(&c_wrong);
    pel_propagator_init(&p, enu.C_b_enu);
    for (int k = 0; k < 30000; k++) {
        double alpha[3], upsilon[3];
        increments(k * dt, dt, enu.C_b_enu, alpha, upsilon);
        TEST_ASSERT_EQUAL(PEL_OK, pel_strapdown_enu_step(&enu, &c_enu, alpha, upsilon, dt, k));
        pel_strapdown_step(&truth, &c_truth, alpha, upsilon, dt, k);
        for (int i = 0; i < 3; i++) {
            alpha[i] += b_g[i] * dt;
            upsilon[i] += b_a[i] * dt;
        }
        pel_strapdown_step(&wrong, &c_wrong, alpha, upsilon, dt, k);
        TEST_ASSERT_GREATER_OR_EQUAL_INT(0, (int)pel_propagator_add_enu(&p, &m, c_enu.dv_f_e, dt, &enu, &ud));
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_propagator_flush_enu(&p, &m, &enu, &ud));
    local_error(&wrong, &truth, x);
    double worst = 0.0;
    const double size[3] = {pel_norm3(&x[0]), pel_norm3(&x[3]), pel_norm3(&x[6])};
    for (int i = 0; i < 9; i++) { worst = fmax(worst, fabs((double)ud.x[PSI + i] - x[i]) / size[i / 3]); }
    printf("  300 s: %.0f m, %.2f m/s, %.0f arcsec apart, foretold to %.1e of that\n", size[2], size[1],
           size[0] * 206265.0, worst);
    TEST_ASSERT_GREATER_THAN_DOUBLE(100.0, size[2]);
    TEST_ASSERT_LESS_THAN_DOUBLE(5e-3, worst);
}

/* Directions to seven satellites that move across the sky. */
static void direction(int sat, double t, double u[3])
{
    const double az = 0.9 * sat + 1.1e-4 * t * ((sat % 2 == 0) ? 1.0 : -1.0);
    const double el = (sat == 0) ? 1.3 : 0.25 + 0.13 * sat + 5e-5 * t;
    u[0] = sin(az) * cos(el);
    u[1] = cos(az) * cos(el);
    u[2] = sin(el);
}

/* DD phase row: -(u_s - u_0) on position, its lever on attitude, lambda on the ambiguity. */
static void make_row(double t, int sat, pel_real h[PEL_MAX_STATES], double hd[N])
{
    double u[3], u0[3], g[3], on_psi[3];
    const double lever[3] = {1.0, -2.0, 2.0};
    direction(sat, t, u);
    direction(0, t, u0);
    for (int k = 0; k < 3; k++) { g[k] = u0[k] - u[k]; }
    pel_cross3(lever, g, on_psi);
    for (int i = 0; i < N; i++) { h[i] = PEL_R(0.0); }
    for (int k = 0; k < 3; k++) {
        h[PSI + k] = (pel_real)on_psi[k];
        h[R + k] = (pel_real)g[k];
    }
    h[AMB + sat - 1] = (pel_real)LAMBDA;
    for (int i = 0; i < N; i++) { hd[i] = (double)h[i]; }
}

/* 1000 s of S2's filter: sigma 4.99 cm phases each second, a slip now and then, a pivot change. The dense filter gets the same transitions. */
static void ud_equals_joseph_over_the_paper_s_flight(void)
{
    static pel_ud_t ud;
    static dense_t d;
    static double Phi[DENSE_MAX][DENSE_MAX];
    double q[DENSE_MAX], sd[N], worst = 0.0, worst_sd = 0.0;
    pel_real s[PEL_MAX_STATES] = {PEL_R(0.0)};
    pel_imu_model_t imu;
    pel_model_t m;
    pel_strapdown_enu_t enu;
    pel_coning_t coning;
    random_t rng = {5};
    s2_imu(&imu);
    pel_model_ins_enu(&m, &imu);
    TEST_ASSERT_EQUAL(PEL_OK, pel_model_append(&m, PEL_BLOCK_AMBIGUITY, N_AMB));
    TEST_ASSERT_EQUAL_INT(N, m.n);
    TEST_ASSERT_EQUAL_INT(AMB, pel_model_index(&m, PEL_BLOCK_AMBIGUITY));
    pel_model_sensor_sd(&m, s);
    for (int i = 0; i < 3; i++) {
        s[PSI + i] = (pel_real)((i < 2 ? 100.0 : 200.0) / 206265.0);
        s[V + i] = PEL_R(0.3);
        s[R + i] = PEL_R(20.0);
        s[AMB + i] = s[AMB + 3 + i] = PEL_R(160.0);
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, N, s));
    for (int i = 0; i < N; i++) { sd[i] = sqrt((double)ud.D[i]); }
    dense_init(&d, N, sd);
    start_at(&enu);
    pel_coning_init(&coning);
    for (int second = 0; second < 1000; second++) {
        for (int k = 0; k < 20; k++) {
            double alpha[3], upsilon[3], f[3];
            pel_transition_t t;
            increments(second + 0.05 * k, 0.05, enu.C_b_enu, alpha, upsilon);
            TEST_ASSERT_EQUAL(PEL_OK, pel_strapdown_enu_step(&enu, &coning, alpha, upsilon, 0.05, k));
            for (int i = 0; i < 3; i++) { f[i] = coning.dv_f_e[i] / 0.05; }
            pel_model_transition_enu(&m, f, enu.C_b_enu, enu.v_eb_enu, enu.lat, enu.h, 0.05, &t);
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&ud, &t));
            dense_transition(&t, Phi, q);
            dense_time_update(&d, Phi, q);
        }
        pel_real decay[PEL_MAX_STATES], noise[PEL_MAX_STATES];
        pel_model_slow(&m, 1.0, decay, noise);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_decay(&ud, decay, noise));
        memset(Phi, 0, sizeof Phi);
        for (int i = 0; i < N; i++) {
            Phi[i][i] = 1.0 + (double)decay[i];
            q[i] = (double)noise[i];
        }
        dense_time_update(&d, Phi, q);
        if (second % 150 == 149) { /* a slip */
            const int i = AMB + second % N_AMB;
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_set_variance(&ud, i, PEL_R(25600.0)));
            for (int j = 0; j < N; j++) { d.P[i][j] = d.P[j][i] = 0.0; }
            d.P[i][i] = 25600.0;
            d.x[i] = 0.0;
        }
        for (int sat = 1; sat <= N_AMB; sat++) { /* whitened noise: the filter sees independent rows */
            pel_real h[PEL_MAX_STATES];
            double hd[N];
            const pel_real var = PEL_R(0.005), z = (pel_real)(0.07 * random_normal(&rng));
            make_row(second, sat, h, hd);
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_update(&ud, h, PSI, z, var, PEL_R(0.0), NULL));
            dense_update(&d, hd, (double)z, (double)var);
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&ud));
        worst = fmax(worst, dense_compare(&d, &ud, NULL));
        worst_sd = fmax(worst_sd, dense_compare_sd(&d, &ud));
    }
    printf("  20 000 time updates, 6 000 rows, 24 states, %s against Joseph in double: covariance %.1e, sigma %.1e\n",
           PEL_REAL_DOUBLE ? "double" : "float", worst, worst_sd);
    TEST_ASSERT_TRUE(worst_sd < (PEL_REAL_DOUBLE ? 1e-7 : 0.02));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(errors_grow_as_two_ecef_mechanizations_part);
    RUN_TEST(ud_equals_joseph_over_the_paper_s_flight);
    return UNITY_END();
}

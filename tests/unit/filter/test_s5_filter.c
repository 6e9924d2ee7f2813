/* build: f32 f64 */
/* The 18-state filter as the navigator runs it: propagation from strapdown steps and S5-like rows, against a dense Joseph filter in double
 * over thousands of steps, and against what really happens to a random system that follows the model (NEES over seeds). */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "support_dense.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

/* A flight in circles: attitude, specific force and position at t, smooth and known. */
static void flight(double t, double C_b_e[3][3], double f_e[3], double r_e[3])
{
    const double lat = 0.53 + 1e-5 * t;
    const double turn = 0.05;
    const double heading = turn * t;
    const double roll = 0.5 * sin(0.02 * t);
    double f_b[3] = {1.0 * sin(0.3 * t), 0.5 * cos(0.21 * t), 9.8 + 2.0 * sin(0.1 * t)};
    pel_attitude_to_C_b_e(roll, 0.05, heading, lat, 1.99, C_b_e);
    pel_mat3_vec(C_b_e, f_b, f_e);
    pel_earth_llh_to_ecef(lat, 1.99, 1500.0, r_e);
}

static void initial_sd(const pel_model_t *m, double sd[18])
{
    pel_real s[PEL_MAX_STATES] = {0};
    pel_model_sensor_sd(m, s);
    for (int i = 0; i < 18; i++) { sd[i] = (double)s[i]; }
    for (int i = 0; i < 3; i++) {
        sd[9 + i] = 600.0 / 206265.0; /* 600 arc seconds */
        sd[12 + i] = 0.1;
        sd[15 + i] = 2.0;
    }
}

static void start(pel_model_t *m, pel_ud_t *ud, dense_t *d)
{
    pel_imu_model_t imu;
    double sd[18];
    pel_real s[PEL_MAX_STATES];
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    pel_model_ins_ecef(m, &imu);
    initial_sd(m, sd);
    for (int i = 0; i < 18; i++) { s[i] = (pel_real)sd[i]; }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(ud, 18, s));
    dense_init(d, 18, sd);
    for (int i = 0; i < 18; i++) { d->P[i][i] = (double)ud->D[i]; }
}

/* One row of an epoch: position along a direction, or velocity, with the lever arm's share of attitude. */
static int make_row(random_t *rng, bool rate, pel_real h[PEL_MAX_STATES], double hd[18])
{
    double u[3] = {random_normal(rng), random_normal(rng), random_normal(rng)};
    const double lever[3] = {2.0, -1.0, 2.0};
    double a[3];
    const int first = 9;
    (void)pel_unit3(u, u);
    pel_cross3(lever, u, a);
    memset(hd, 0, 18 * sizeof hd[0]);
    for (int i = 0; i < 3; i++) {
        hd[9 + i] = (double)(pel_real)(rate ? 0.1 * a[i] : a[i]);
        hd[(rate ? 12 : 15) + i] = (double)(pel_real)u[i];
    }
    for (int i = first; i < 18; i++) { h[i] = (pel_real)hd[i]; }
    return first;
}

/* 2000 s, a substep of 0.05 s, each second 12 range rows (3 mm) and 6 rate rows (3 cm/s), 60 s without any now and then. The dense filter gets
 * the same transitions and rows, so what differs is arithmetic alone. */
static void ud_equals_joseph_over_a_flight(void)
{
    static pel_ud_t ud;
    static dense_t d;
    static double Phi[DENSE_MAX][DENSE_MAX];
    double q[DENSE_MAX];
    pel_model_t m;
    random_t rng = {11};
    start(&m, &ud, &d);
    double worst = 0.0;
    double worst_x = 0.0;
    double worst_sd = 0.0;
    int rows = 0;
    int steps = 0;
    for (int second = 0; second < 2000; second++) {
        for (int k = 0; k < 20; k++) {
            double C[3][3];
            double f[3];
            double r[3];
            pel_transition_t t;
            flight((double)second + 0.05 * k + 0.025, C, f, r);
            pel_model_transition(&m, f, C, r, 0.05, &t);
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&ud, &t));
            dense_transition(&t, Phi, q);
            dense_time_update(&d, Phi, q);
            steps++;
        }
        pel_real decay[PEL_MAX_STATES];
        pel_real noise[PEL_MAX_STATES];
        pel_model_slow(&m, 1.0, decay, noise);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_decay(&ud, decay, noise));
        memset(Phi, 0, sizeof Phi);
        for (int i = 0; i < 18; i++) {
            Phi[i][i] = 1.0 + (double)decay[i];
            q[i] = (double)noise[i];
        }
        dense_time_update(&d, Phi, q);
        if (second % 500 < 60 && second > 100) { continue; } /* outage */
        for (int k = 0; k < 18; k++) {
            pel_real h[PEL_MAX_STATES];
            double hd[18];
            const bool rate = k >= 12;
            const int first = make_row(&rng, rate, h, hd);
            const pel_real var = rate ? PEL_R(9e-4) : PEL_R(9e-6);
            const pel_real z = (pel_real)(sqrt((double)var) * random_normal(&rng));
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_update(&ud, h, first, z, var, PEL_R(0.0), NULL));
            dense_update(&d, hd, (double)z, (double)var);
            rows++;
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&ud));
        double ex;
        worst = fmax(worst, dense_compare(&d, &ud, &ex));
        worst_x = fmax(worst_x, ex);
        worst_sd = fmax(worst_sd, dense_compare_sd(&d, &ud));
    }
    printf("  %d time updates, %d rows, %s against Joseph in double: covariance %.1e, sigma %.1e, x %.1e sigma\n",
           steps, rows, PEL_REAL_DOUBLE ? "double" : "float", worst, worst_sd, worst_x);
    TEST_ASSERT_TRUE(worst < (PEL_REAL_DOUBLE ? 1e-9 : 2e-3));
    TEST_ASSERT_TRUE(worst_sd < (PEL_REAL_DOUBLE ? 1e-9 : 1e-3));
    TEST_ASSERT_TRUE(worst_x < (PEL_REAL_DOUBLE ? 1e-8 : 3e-2));
}

/* What FIELD's lesson is about: an hour's Markov process decayed every 0.05 s in the same arithmetic, and every second. */
static void slow_decay_survives_float(void)
{
    static const double interval[2] = {0.05, 1.0};
    double error[2];
    for (int k = 0; k < 2; k++) {
        pel_model_t m;
        pel_imu_model_t imu;
        pel_ud_t ud;
        pel_real sd[PEL_MAX_STATES];
        pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
        pel_model_ins_ecef(&m, &imu);
        for (int i = 0; i < 18; i++) { sd[i] = PEL_R(1.0); }
        pel_model_sensor_sd(&m, sd);
        for (int i = 3; i < 9; i++) { sd[i] *= PEL_R(0.1); } /* known better than the process: it grows back */
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, 18, sd));
        const int n = (int)lround(1800.0 / interval[k]);
        for (int i = 0; i < n; i++) {
            pel_real decay[PEL_MAX_STATES];
            pel_real q[PEL_MAX_STATES];
            pel_model_slow(&m, interval[k], decay, q);
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_decay(&ud, decay, q));
        }
        const double s2 = imu.sd_am_mps2 * imu.sd_am_mps2;
        const double want = s2 * (1.0 + (0.01 - 1.0) * exp(-2.0 * 1800.0 / 3600.0));
        error[k] = fabs((double)pel_ud_cov(&ud, 7, 7) / want - 1.0);
    }
    printf("  variance of an hour's Markov process after 1800 s: %.1e wrong at 0.05 s, %.1e at 1 s\n", error[0],
           error[1]);
    TEST_ASSERT_TRUE(error[1] < (PEL_REAL_DOUBLE ? 1e-12 : 5e-5));
}

/* The propagator must do what its parts do: 500 Hz steps in 0.05 s substeps against one time update with exact means. */
static void the_propagator_collects_steps(void)
{
    pel_model_t m;
    pel_ud_t a;
    dense_t d;
    pel_propagator_t p;
    double C[3][3];
    double f[3];
    double r[3];
    start(&m, &a, &d);
    pel_ud_t b = a;
    flight(0.0, C, f, r);
    pel_propagator_init(&p, C);
    int updates = 0;
    for (int k = 0; k < 1000; k++) {
        const double t = 0.002 * k;
        double dv[3];
        flight(t + 0.001, C, f, r);
        for (int i = 0; i < 3; i++) { dv[i] = 0.002 * f[i]; }
        flight(t + 0.002, C, f, r);
        const pel_status_t s = pel_propagator_add(&p, &m, dv, 0.002, C, r, &a);
        TEST_ASSERT_TRUE(s == PEL_OK || s == PEL_W_RUNNING);
        updates += (s == PEL_OK) ? 1 : 0;
    }
    TEST_ASSERT_EQUAL(40, updates);
    TEST_ASSERT_EQUAL(PEL_OK, pel_propagator_flush(&p, &m, C, r, &a));
    TEST_ASSERT_TRUE(p.dt_s == 0.0);
    for (int second = 0; second < 2; second++) {
        for (int k = 0; k < 20; k++) {
            pel_transition_t t;
            double C1[3][3];
            double f1[3];
            const double t0 = (double)second + 0.05 * k;
            flight(t0 + 0.025, C1, f1, r);
            pel_model_transition(&m, f1, C1, r, 0.05, &t);
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&b, &t));
        }
        pel_real decay[PEL_MAX_STATES];
        pel_real q[PEL_MAX_STATES];
        pel_model_slow(&m, 1.0, decay, q);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_decay(&b, decay, q));
    }
    double worst = 0.0;
    for (int i = 0; i < 18; i++) {
        for (int j = 0; j < 18; j++) {
            const double scale = sqrt((double)pel_ud_cov(&b, i, i) * (double)pel_ud_cov(&b, j, j));
            worst = fmax(worst, fabs((double)pel_ud_cov(&a, i, j) - (double)pel_ud_cov(&b, i, j)) / scale);
        }
    }
    printf("  1000 steps collected into 40 substeps against midpoints: %.1e\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-4);
}

/* A cut substep must leave the same covariance as a whole one. */
static void flushing_early_changes_little(void)
{
    pel_model_t m;
    pel_ud_t a;
    dense_t d;
    double C[3][3];
    double f[3];
    double r[3];
    start(&m, &a, &d);
    pel_ud_t b = a;
    flight(3.0, C, f, r);
    for (int k = 0; k < 200; k++) {
        pel_transition_t t;
        pel_model_transition(&m, f, C, r, 0.05, &t);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&a, &t));
        pel_model_transition(&m, f, C, r, 0.013, &t);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&b, &t));
        pel_model_transition(&m, f, C, r, 0.037, &t);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&b, &t));
    }
    for (int i = 0; i < 18; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-4, 1.0, (double)(pel_ud_cov(&a, i, i) / pel_ud_cov(&b, i, i)));
    }
}

static void gnss_model_grows_as_integrated_white_noise(void)
{
    pel_model_t m;
    pel_imu_model_t imu;
    pel_ud_t ud;
    double r[3];
    const pel_real sd[6] = {PEL_R(0.1), PEL_R(0.1), PEL_R(0.1), PEL_R(1.0), PEL_R(1.0), PEL_R(1.0)};
    pel_imu_model_preset(PEL_IMU_GRADE_MEMS, &imu);
    imu.accel_psd_rts = 2.0;
    pel_model_gnss(&m, &imu);
    pel_earth_llh_to_ecef(0.6, 0.1, 0.0, r);
    for (double T = 0.2; T < 12.0; T *= 5.0) {
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, 6, sd));
        TEST_ASSERT_EQUAL(PEL_OK, pel_propagate_gnss(&m, r, T, &ud));
        const double vv = 0.01 + 4.0 * T;
        const double rr = 1.0 + 0.01 * T * T + 4.0 * T * T * T / 3.0;
        const double vr = 0.01 * T + 4.0 * T * T / 2.0;
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1.0, (double)pel_ud_cov(&ud, 1, 1) / vv);
        TEST_ASSERT_DOUBLE_WITHIN(3e-2, 1.0, (double)pel_ud_cov(&ud, 4, 4) / rr);
        TEST_ASSERT_DOUBLE_WITHIN(1e-2, 1.0, (double)pel_ud_cov(&ud, 1, 4) / vr);
    }
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_propagate_gnss(&m, r, 0.0, &ud));
}

/* A system that really follows the model, 40 seeds, 120 s, rows each second with the noise they claim: the error in units of the covariance
 * and the innovations in units of theirs must be chi-square. */
static void errors_are_as_large_as_the_covariance_says(void)
{
    const int seeds = 40;
    double nees_end = 0.0;
    double nis_sum = 0.0;
    int nis_n = 0;
    for (int seed = 0; seed < seeds; seed++) {
        static pel_ud_t ud;
        static dense_t d;
        static double Phi[DENSE_MAX][DENSE_MAX];
        double q[DENSE_MAX];
        double x[18]; /* the truth */
        double sd[18];
        pel_model_t m;
        random_t rng = {(uint64_t)(900 + seed)};
        start(&m, &ud, &d);
        initial_sd(&m, sd);
        for (int i = 0; i < 18; i++) { x[i] = sd[i] * random_normal(&rng); }
        for (int second = 0; second < 120; second++) {
            for (int k = 0; k <= 20; k++) {
                if (k < 20) {
                    double C[3][3];
                    double f[3];
                    double r[3];
                    pel_transition_t t;
                    flight((double)second + 0.05 * k + 0.025, C, f, r);
                    pel_model_transition(&m, f, C, r, 0.05, &t);
                    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&ud, &t));
                    dense_transition(&t, Phi, q);
                } else {
                    pel_real decay[PEL_MAX_STATES];
                    pel_real noise[PEL_MAX_STATES];
                    pel_model_slow(&m, 1.0, decay, noise);
                    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_decay(&ud, decay, noise));
                    memset(Phi, 0, sizeof Phi);
                    for (int i = 0; i < 18; i++) {
                        Phi[i][i] = 1.0 + (double)decay[i];
                        q[i] = (double)noise[i];
                    }
                }
                double y[18];
                for (int i = 0; i < 18; i++) {
                    y[i] = (q[i] > 0.0) ? sqrt(q[i]) * random_normal(&rng) : 0.0;
                    for (int j = 0; j < 18; j++) { y[i] += Phi[i][j] * x[j]; }
                }
                memcpy(x, y, sizeof x);
            }
            for (int k = 0; k < 12; k++) {
                pel_real h[PEL_MAX_STATES];
                double hd[18];
                const bool rate = k >= 8;
                const int first = make_row(&rng, rate, h, hd);
                const double var = rate ? 9e-4 : 9e-6;
                double z = sqrt(var) * random_normal(&rng);
                pel_real nis;
                for (int i = 0; i < 18; i++) { z += hd[i] * x[i]; }
                TEST_ASSERT_EQUAL(PEL_OK, pel_ud_update(&ud, h, first, (pel_real)z, (pel_real)var, PEL_R(0.0), &nis));
                nis_sum += (double)nis;
                nis_n++;
            }
            /* closed loop: what is estimated is taken off the system, so that numbers stay small as in the navigator */
            for (int i = 0; i < 18; i++) {
                x[i] -= (double)ud.x[i];
                ud.x[i] = PEL_R(0.0);
            }
        }
        /* x' P^-1 x = sum (U^-1 x)_j^2 / D_j, from the last state back */
        double e[18];
        memcpy(e, x, sizeof e);
        for (int j = 17; j >= 0; j--) {
            for (int i = 0; i < j; i++) { e[i] -= (double)ud.U[j * (j - 1) / 2 + i] * e[j]; }
            nees_end += e[j] * e[j] / (double)ud.D[j];
        }
    }
    const double dof = 18.0 * seeds;
    const double low = dof * pow(1.0 - 2.0 / (9.0 * dof) - 1.96 * sqrt(2.0 / (9.0 * dof)), 3.0);
    const double high = dof * pow(1.0 - 2.0 / (9.0 * dof) + 1.96 * sqrt(2.0 / (9.0 * dof)), 3.0);
    printf("  NEES %.2f of 18 (95 %%: %.2f to %.2f) over %d seeds; NIS %.4f over %d rows (95 %%: +-%.4f)\n",
           nees_end / seeds, low / seeds, high / seeds, seeds, nis_sum / nis_n, nis_n, 1.96 * sqrt(2.0 / nis_n));
    TEST_ASSERT_TRUE(nees_end > low && nees_end < high);
    TEST_ASSERT_TRUE(fabs(nis_sum / nis_n - 1.0) < 1.96 * sqrt(2.0 / nis_n));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(ud_equals_joseph_over_a_flight);
    RUN_TEST(slow_decay_survives_float);
    RUN_TEST(the_propagator_collects_steps);
    RUN_TEST(flushing_early_changes_little);
    RUN_TEST(gnss_model_grows_as_integrated_white_noise);
    RUN_TEST(errors_are_as_large_as_the_covariance_says);
    return UNITY_END();
}

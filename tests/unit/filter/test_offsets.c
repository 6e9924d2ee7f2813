/* build: f32 f64 */
/* Offsets, rates and the height deviation between epochs, against the same step of a dense covariance. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/math.h"
#include "support_dense.h"
#include "unity.h"

enum { B = 15, RATE = 17, HEIGHT = 19, N = 20 };

void setUp(void) {}
void tearDown(void) {}

static random_t rng = {3};
static const pel_drift_model_t DRIFT = {
    .path_m_rts = 2e-4, .rate_walk_mps_rts = 1e-5, .sd_height_m = 1.5, .tau_height_s = 60.0};

static void s3_model(pel_model_t *m)
{
    pel_imu_model_t imu;
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    pel_model_tdcp(m, &imu, 2);
    TEST_ASSERT_EQUAL_INT(N, m->n);
    TEST_ASSERT_EQUAL_INT(B, pel_model_index(m, PEL_BLOCK_OFFSET));
    TEST_ASSERT_EQUAL_INT(RATE, pel_model_index(m, PEL_BLOCK_OFFSET_RATE));
    TEST_ASSERT_EQUAL_INT(HEIGHT, pel_model_index(m, PEL_BLOCK_HEIGHT));
}

static void a_step_matches_the_dense_filter(void)
{
    static double Phi[DENSE_MAX][DENSE_MAX];
    static pel_ud_t ud;
    static dense_t d;
    double q[DENSE_MAX] = {0}, worst = 0.0;
    pel_model_t m;
    s3_model(&m);
    random_filter(&rng, N, &ud, &d);
    for (int k = 0; k < 500; k++) {
        const double dt = random_uniform(&rng, 0.05, 2.0), walk = DRIFT.path_m_rts * DRIFT.path_m_rts * dt;
        memset(Phi, 0, sizeof Phi);
        for (int i = 0; i < N; i++) { Phi[i][i] = 1.0; }
        Phi[B][RATE] = Phi[B + 1][RATE + 1] = dt;
        Phi[HEIGHT][HEIGHT] = exp(-dt / DRIFT.tau_height_s);
        q[B] = q[B + 1] = 2.0 * walk;
        q[RATE] = q[RATE + 1] = DRIFT.rate_walk_mps_rts * DRIFT.rate_walk_mps_rts * dt;
        q[HEIGHT] = DRIFT.sd_height_m * DRIFT.sd_height_m * (1.0 - exp(-2.0 * dt / DRIFT.tau_height_s));
        TEST_ASSERT_EQUAL(PEL_OK, pel_propagate_offsets(&m, &DRIFT, dt, &ud));
        dense_time_update(&d, Phi, q);
        d.P[B][B + 1] += walk; /* the reference's own path moves both */
        d.P[B + 1][B] += walk;
        double ex;
        worst = fmax(worst, fmax(dense_compare(&d, &ud, &ex), ex));
    }
    printf("  500 steps: %.1e sigma\n", worst);
    TEST_ASSERT_TRUE(worst < (PEL_REAL_DOUBLE ? 1e-11 : 1e-4));
}

static void blocks_a_model_lacks_are_passed_over(void)
{
    pel_imu_model_t imu;
    pel_model_t m;
    pel_ud_t ud;
    dense_t d;
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    pel_model_tdcp_paper(&m, &imu);
    random_filter(&rng, m.n, &ud, &d);
    const pel_ud_t before = ud;
    TEST_ASSERT_EQUAL(PEL_OK, pel_propagate_offsets(&m, &DRIFT, 0.1, &ud));
    TEST_ASSERT_EQUAL_MEMORY(&before, &ud, sizeof ud);
}

static void a_wrong_step_or_filter_is_refused(void)
{
    pel_model_t m;
    pel_ud_t ud;
    dense_t d;
    s3_model(&m);
    random_filter(&rng, N, &ud, &d);
    const pel_ud_t before = ud;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_propagate_offsets(&m, &DRIFT, 0.0, &ud));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_propagate_offsets(&m, &DRIFT, (double)NAN, &ud));
    TEST_ASSERT_EQUAL_MEMORY(&before, &ud, sizeof ud);
    ud.n = 12;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_propagate_offsets(&m, &DRIFT, 0.1, &ud));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_step_matches_the_dense_filter);
    RUN_TEST(blocks_a_model_lacks_are_passed_over);
    RUN_TEST(a_wrong_step_or_filter_is_refused);
    return UNITY_END();
}

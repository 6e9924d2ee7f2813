/* build: f32 f64 */
/* Substeps at their ends: nothing collected, factors lost, silences longer than the steps foreseen. */
#include <math.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/filter.h"
#include "pelorus/math.h"
#include "unity.h"

#define STEP_S        0.01
#define SCHULER_RADPS 1.24e-3

static const double R_E[3] = {4.1e6, 8.4e5, 4.8e6};
static const double C_B_E[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const double DV[3] = {6.3e-2, 1.3e-2, 7.4e-2};

static pel_model_t model;
static pel_propagator_t p;
static pel_ud_t ud, before;

static void begin(bool enu)
{
    pel_imu_model_t imu;
    pel_real sd[PEL_MAX_STATES];
    pel_imu_model_preset(PEL_IMU_GRADE_MEMS, &imu);
    if (enu) {
        pel_model_ins_enu(&model, &imu);
    } else {
        pel_model_ins_ecef(&model, &imu);
    }
    for (int i = 0; i < model.n; i++) { sd[i] = PEL_R(0.01); }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, model.n, sd));
    pel_propagator_init(&p, C_B_E);
    before = ud;
}

void setUp(void)
{
    begin(false);
}

void tearDown(void) {}

static const pel_strapdown_enu_t LOCAL = {.C_b_enu = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .lat = 0.8, .lon = 0.2};

static void nothing_collected_is_nothing_to_do(void)
{
    TEST_ASSERT_EQUAL(PEL_OK, pel_propagator_flush(&p, &model, C_B_E, R_E, &ud));
    TEST_ASSERT_EQUAL_MEMORY(&before, &ud, sizeof ud);
    begin(true);
    TEST_ASSERT_EQUAL(PEL_OK, pel_propagator_flush_enu(&p, &model, &LOCAL, &ud));
    TEST_ASSERT_EQUAL_MEMORY(&before, &ud, sizeof ud);
}

static void one_step_is_collected_until_it_is_asked_for(void)
{
    begin(true);
    TEST_ASSERT_EQUAL(PEL_W_RUNNING, pel_propagator_add_enu(&p, &model, DV, STEP_S, &LOCAL, &ud));
    TEST_ASSERT_EQUAL_MEMORY(&before, &ud, sizeof ud);
    TEST_ASSERT_EQUAL(PEL_OK, pel_propagator_flush_enu(&p, &model, &LOCAL, &ud));
    const int i_r = pel_model_index(&model, PEL_BLOCK_POSITION);
    TEST_ASSERT_TRUE(pel_ud_cov(&ud, i_r, i_r) > pel_ud_cov(&before, i_r, i_r));
}

/* Lost factors are told, and sensor errors are not decayed on top of them. */
static void lost_factors_are_told_by_the_substep(void)
{
    const int i_v = pel_model_index(&model, PEL_BLOCK_VELOCITY);
    p.slow_s = 2.0 * PEL_SLOW_S;
    ud.D[i_v] = PEL_R(-1.0);
    pel_status_t status = PEL_W_RUNNING;
    for (int i = 0; i < 10 && status == PEL_W_RUNNING; i++) {
        status = pel_propagator_add(&p, &model, DV, STEP_S, C_B_E, R_E, &ud);
    }
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, status);
    TEST_ASSERT_TRUE(p.slow_s > 2.0 * PEL_SLOW_S);
}

static void markov_states_decay_when_it_is_due_and_not_before(void)
{
    p.slow_s = PEL_SLOW_S - 1.5 * STEP_S;
    const int i_m = pel_model_index(&model, PEL_BLOCK_GYRO_MARKOV);
    ud.x[i_m] = PEL_R(1.0);
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL(PEL_W_RUNNING, pel_propagator_add(&p, &model, DV, STEP_S, C_B_E, R_E, &ud));
        TEST_ASSERT_EQUAL(PEL_OK, pel_propagator_flush(&p, &model, C_B_E, R_E, &ud));
        const double expected = (i == 0) ? 1.0 : exp(-(PEL_SLOW_S + 0.5 * STEP_S) / model.imu.tau_gm_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, expected, (double)ud.x[i_m]);
    }
}

/* Without IMU: velocity driven by white acceleration q: P_r = P_r0 + P_v0 t^2 + q t^3 / 3, whatever the number of steps. */
static void a_silence_of_any_length_grows_as_it_should(void)
{
    static const double SILENCES_S[] = {0.1, 1.0, 9.9, 25.0, 90.0};
    pel_imu_model_t imu;
    pel_imu_model_preset(PEL_IMU_GRADE_MEMS, &imu);
    pel_model_gnss(&model, &imu);
    for (int i = 0; i < 5; i++) {
        const double t = SILENCES_S[i], q = imu.accel_psd_rts * imu.accel_psd_rts;
        pel_real sd[6];
        for (int k = 0; k < 6; k++) { sd[k] = PEL_R(1.0); }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, 6, sd));
        TEST_ASSERT_EQUAL(PEL_OK, pel_propagate_gnss(&model, R_E, t, &ud));
        for (int k = 0; k < 3; k++) {
            const double var_v = 1.0 + q * t, var_r = 1.0 + t * t + q * t * t * t / 3.0;
            const double share =
                1e-3 + 2.0 * SCHULER_RADPS * t * SCHULER_RADPS * t; /* gravity's gradient is in the model too */
            TEST_ASSERT_DOUBLE_WITHIN(share * var_v, var_v, (double)pel_ud_cov(&ud, k, k));
            const double n =
                fmin(40.0, ceil(t / 0.25)); /* steps: noise half before and half after each is off by q t^3 / 6 n^2 */
            TEST_ASSERT_DOUBLE_WITHIN(share * var_r + q * t * t * t / (5.0 * n * n), var_r,
                                      (double)pel_ud_cov(&ud, 3 + k, 3 + k));
        }
    }
}

static void a_silence_that_is_none_or_of_a_broken_filter_is_refused(void)
{
    pel_imu_model_t imu;
    pel_real sd[6];
    for (int k = 0; k < 6; k++) { sd[k] = PEL_R(1.0); }
    pel_imu_model_preset(PEL_IMU_GRADE_MEMS, &imu);
    pel_model_gnss(&model, &imu);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, 6, sd));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_propagate_gnss(&model, R_E, 0.0, &ud));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_propagate_gnss(&model, R_E, NAN, &ud));
    ud.D[4] = PEL_R(-1e6);
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_propagate_gnss(&model, R_E, 1.0, &ud));
}

/* Offsets without rates: what a model with frequent epochs may leave out. */
static void offsets_without_rates_walk_alone(void)
{
    const pel_drift_model_t drift = {
        .path_m_rts = 0.1, .rate_walk_mps_rts = 1.0, .sd_height_m = 1.0, .tau_height_s = 9.0};
    TEST_ASSERT_EQUAL(PEL_OK, pel_model_append(&model, PEL_BLOCK_OFFSET, 2));
    const int b = pel_model_index(&model, PEL_BLOCK_OFFSET);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_insert(&ud, b, PEL_R(1.0)));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_insert(&ud, b + 1, PEL_R(1.0)));
    TEST_ASSERT_EQUAL(PEL_OK, pel_propagate_offsets(&model, &drift, 4.0, &ud));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0 + 2.0 * 0.01 * 4.0,
                              (double)pel_ud_cov(&ud, b, b)); /* own and the reference's path */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.01 * 4.0, (double)pel_ud_cov(&ud, b, b + 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, (double)pel_ud_cov(&before, 0, 0), (double)pel_ud_cov(&ud, 0, 0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nothing_collected_is_nothing_to_do);
    RUN_TEST(one_step_is_collected_until_it_is_asked_for);
    RUN_TEST(lost_factors_are_told_by_the_substep);
    RUN_TEST(markov_states_decay_when_it_is_due_and_not_before);
    RUN_TEST(a_silence_of_any_length_grows_as_it_should);
    RUN_TEST(a_silence_that_is_none_or_of_a_broken_filter_is_refused);
    RUN_TEST(offsets_without_rates_walk_alone);
    return UNITY_END();
}

/* link: pel_sim */
/* Sensor errors have the size that was asked for, and quantization loses nothing. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "imu.h"
#include "unity.h"
#include "world.h"

#define N 200000

static imu_config_t config;
static const double still[3] = {0.0, 0.0, 0.0};

void setUp(void)
{
    memset(&config, 0, sizeof config);
    config.present = true;
    config.interval_ns = 2000000;
}

void tearDown(void) {}

static void normal_deviates_are_normal(void)
{
    rng_t r;
    double m[5] = {0.0};
    rng_init(&r, 5, 1);
    for (int i = 0; i < 1000000; i++) {
        const double x = rng_normal(&r);
        double p = x;
        for (int k = 1; k <= 4; k++) {
            m[k] += p / 1e6;
            p *= x;
        }
    }
    printf("moments %.4f %.4f %.4f %.4f (0 1 0 3)\n", m[1], m[2], m[3], m[4]);
    TEST_ASSERT_DOUBLE_WITHIN(0.004, 0.0, m[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.006, 1.0, m[2]);
    TEST_ASSERT_DOUBLE_WITHIN(0.016, 0.0, m[3]);
    TEST_ASSERT_DOUBLE_WITHIN(0.04, 3.0, m[4]);
}

static void white_noise_grows_with_the_root_of_time(void)
{
    imu_sim_t s;
    double sum2 = 0.0;
    config.gyro.white = 1e-4;
    imu_sim_init(&s, &config, 3);
    for (int i = 0; i < N; i++) {
        pel_imu_t x;
        imu_sim_step(&s, 0, still, still, &x);
        sum2 += x.alpha_ib_b[0] * x.alpha_ib_b[0];
        TEST_ASSERT_EQUAL_DOUBLE(0.0, x.upsilon_ib_b[0]);
    }
    const double ratio = sqrt(sum2 / (N * 0.002)) / 1e-4;
    printf("white noise, measured over asked: %.4f\n", ratio);
    TEST_ASSERT_DOUBLE_WITHIN(0.006, 1.0, ratio);
}

static void the_markov_error_has_its_size_and_forgets_in_its_time(void)
{
    double product[2] = {0.0};
    config.accel.markov_sd = 1e-3;
    config.accel.markov_tau_s = 1.0;
    for (uint64_t seed = 0; seed < 400; seed++) { /* 3 axes each: 1 200 draws */
        imu_sim_t s;
        double b_g[3];
        double b_a[3];
        double first[3];
        imu_sim_init(&s, &config, seed);
        imu_sim_errors(&s, b_g, first);
        for (int i = 0; i < 500; i++) { /* one time constant */
            pel_imu_t x;
            imu_sim_step(&s, 0, still, still, &x);
        }
        imu_sim_errors(&s, b_g, b_a);
        for (int i = 0; i < 3; i++) {
            product[0] += b_a[i] * b_a[i] / 1200.0 / 1e-6;
            product[1] += b_a[i] * first[i] / 1200.0 / 1e-6;
        }
    }
    printf("variance %.3f (1), correlation after tau %.3f (0.368)\n", product[0], product[1]);
    TEST_ASSERT_DOUBLE_WITHIN(0.13, 1.0, product[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 0.368, product[1]);
}

static void quantization_carries_its_residue(void)
{
    imu_sim_t s;
    const double truth[3] = {1.7e-6, -3.1e-6, 0.9e-6};
    const double lsb = 0.0003 * WORLD_DEG;
    double sum[3] = {0.0};
    config.gyro.lsb = lsb;
    imu_sim_init(&s, &config, 1);
    for (int k = 1; k <= N; k++) {
        pel_imu_t x;
        imu_sim_step(&s, 0, truth, still, &x);
        for (int i = 0; i < 3; i++) {
            const double counts = x.alpha_ib_b[i] / lsb;
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, round(counts), counts);
            sum[i] += x.alpha_ib_b[i];
            TEST_ASSERT_DOUBLE_WITHIN(0.51 * lsb, k * truth[i], sum[i]);
        }
    }
}

static void a_rate_beyond_the_range_is_clipped_and_flagged(void)
{
    imu_sim_t s;
    pel_imu_t x;
    const double fast[3] = {0.02, 0.0, 0.0}; /* 10 rad/s */
    config.gyro.range = 5.0;
    imu_sim_init(&s, &config, 1);
    imu_sim_step(&s, 7, fast, still, &x);
    TEST_ASSERT_EQUAL_DOUBLE(0.01, x.alpha_ib_b[0]);
    TEST_ASSERT_EQUAL_HEX16(PEL_IMU_GYRO_SATURATED, x.flags);
}

static void the_mounting_turns_body_into_sensor_axes(void)
{
    imu_sim_t s;
    pel_imu_t x;
    const double up[3] = {0.0, 0.0, 0.0196};
    config.mount[2] = 90.0 * WORLD_DEG; /* the sensor's forward axis points right */
    imu_sim_init(&s, &config, 1);
    const double right[3] = {0.001, 0.0, 0.0};
    imu_sim_step(&s, 0, right, up, &x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.001, x.alpha_ib_b[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0196, x.upsilon_ib_b[2]);
}

static void samples_are_numbered_and_timed(void)
{
    imu_sim_t s;
    pel_imu_t x;
    imu_sim_init(&s, &config, 1);
    for (int i = 0; i < 3; i++) { imu_sim_step(&s, 1000 + i, still, still, &x); }
    TEST_ASSERT_EQUAL_UINT16(2, x.seq);
    TEST_ASSERT_EQUAL_INT64(1002, x.t_ns);
    TEST_ASSERT_EQUAL_DOUBLE(0.002, x.dt_s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(normal_deviates_are_normal);
    RUN_TEST(white_noise_grows_with_the_root_of_time);
    RUN_TEST(the_markov_error_has_its_size_and_forgets_in_its_time);
    RUN_TEST(quantization_carries_its_residue);
    RUN_TEST(a_rate_beyond_the_range_is_clipped_and_flagged);
    RUN_TEST(the_mounting_turns_body_into_sensor_axes);
    RUN_TEST(samples_are_numbered_and_timed);
    return UNITY_END();
}

/* What the fault campaign found, by its symptom. */
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "pelorus/math.h"
#include "pelorus/navigator.h"
#include "unity.h"

#define T0 (INT64_C(1300000000) * PEL_NS_PER_S)
#define MS PEL_NS_PER_MS

static pel_navigator_t nav;
static uint32_t dice;

static double noise(void)
{
    dice = dice * 1664525u + 1013904223u;
    return (double)(dice >> 8) / 16777216.0 - 0.5;
}

/* A calm noisy sensor, sample i of 100 a second. */
static pel_imu_t calm(int i)
{
    pel_imu_t imu = {.t_ns = T0 + i * 10 * MS, .dt_s = 0.01, .seq = (uint16_t)i};
    for (int k = 0; k < 3; k++) {
        imu.alpha_ib_b[k] = 1e-5 * noise();
        imu.upsilon_ib_b[k] = 1e-3 * noise() + ((k == 2) ? 0.098 : 0.0);
    }
    return imu;
}

static void push(pel_imu_t imu)
{
    pel_navigator_push_imu(&nav, &imu);
}

void setUp(void)
{
    pel_nav_config_t cfg;
    dice = 1;
    pel_nav_config_default(&cfg);
    pel_navigator_init(&nav, &cfg);
    for (int i = 1; i <= 200; i++) { push(calm(i)); }
}

void tearDown(void) {}

static void a_time_at_the_end_of_64_bits_never_enters(void)
{
    pel_imu_t imu = calm(201);
    imu.t_ns = INT64_MAX;
    push(imu);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_bad_value);
    TEST_ASSERT_EQUAL_INT64(T0 + 2000 * MS, nav.last_imu_ns);
}

static void epochs_of_impossible_times_never_enter(void)
{
    static pel_epoch_t e;
    const pel_time_t times[] = {INT64_MIN, -1, 0, INT64_MAX};
    for (int i = 0; i < 4; i++) {
        e.t_ns = times[i];
        pel_navigator_push_rover(&nav, &e);
        pel_navigator_push_base(&nav, &e);
    }
    TEST_ASSERT_EQUAL_UINT32(8, nav.counters.epochs_late);
    TEST_ASSERT_EQUAL_INT(0, nav.n_rover + nav.n_base);
}

static void a_spike_is_refused_and_bridged(void)
{
    pel_imu_t imu = calm(201);
    imu.alpha_ib_b[1] = 0.5;
    push(imu);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_bad_value);
    push(calm(202));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.02, pel_imu_ring_newest(&nav.ring)->dt_s);
}

static void what_lasts_is_no_spike(void)
{
    for (int i = 201; i <= 210; i++) {
        pel_imu_t imu = calm(i);
        imu.alpha_ib_b[1] += 0.2; /* 20 rad/s from one sample to the next */
        push(imu);
    }
    TEST_ASSERT_EQUAL_UINT32(3, nav.counters.imu_bad_value);
    TEST_ASSERT_EQUAL_INT64(T0 + 2100 * MS, nav.last_imu_ns);
}

static void a_sample_that_says_saturated_is_refused(void)
{
    pel_imu_t imu = calm(201);
    imu.flags = PEL_IMU_GYRO_SATURATED;
    push(imu);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_bad_value);
}

static void a_stuck_axis_of_a_noisy_sensor_is_refused_within_half_a_second(void)
{
    for (int i = 201; i <= 250; i++) {
        pel_imu_t imu = calm(i);
        imu.alpha_ib_b[2] = 1e-5;
        push(imu);
    }
    TEST_ASSERT_GREATER_THAN_UINT32(15, nav.counters.imu_bad_value);
    const uint32_t refused = nav.counters.imu_bad_value;
    push(calm(251)); /* it moves again */
    push(calm(252));
    TEST_ASSERT_EQUAL_UINT32(refused, nav.counters.imu_bad_value);
}

static void equal_numbers_of_a_coarse_sensor_are_usual(void)
{
    pel_nav_config_t cfg;
    pel_nav_config_default(&cfg);
    pel_navigator_init(&nav, &cfg);
    for (int i = 1; i <= 2000; i++) {
        pel_imu_t imu = calm(i);
        for (int k = 0; k < 3; k++) { imu.alpha_ib_b[k] = 0.0; }
        push(imu);
    }
    TEST_ASSERT_EQUAL_UINT32(2000, nav.counters.imu_used);
}

/* The tag goes back by a second and then on: sequence numbers say that a second of samples is missing, tags say that none is. */
static void a_clock_that_jumps_is_told_by_the_sequence(void)
{
    pel_imu_t imu;
    for (int i = 201; i <= 320; i++) {
        imu = calm(i);
        imu.t_ns -= 1000 * MS;
        push(imu);
    }
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_gap);
    TEST_ASSERT_LESS_THAN_INT(25, nav.ring.n); /* the ring began anew */
}

static void lost_samples_are_no_clock_jump(void)
{
    push(calm(206));
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_gap);
    TEST_ASSERT_EQUAL_INT(201, nav.ring.n);
}

static void a_blow_beyond_what_vehicles_feel_is_refused(void)
{
    pel_imu_t imu = calm(201);
    imu.upsilon_ib_b[0] = 2.5; /* 250 m/s^2 in one sample */
    push(imu);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_bad_value);
    imu = calm(202);
    imu.upsilon_ib_b[0] = 1.5; /* 150: it may be */
    push(imu);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_bad_value);
    TEST_ASSERT_TRUE((pel_imu_ring_newest(&nav.ring)->flags & PEL_NAV_IMU_JOLT) != 0);
    push(calm(203));
    push(calm(204));
    TEST_ASSERT_EQUAL_INT(0, pel_imu_ring_newest(&nav.ring)->flags);
}

/* Two axes stuck at once: the one that stood still for longer says how much is doubted. */
static void the_longest_run_of_equal_numbers_counts(void)
{
    for (int i = 201; i <= 260; i++) {
        pel_imu_t imu = calm(i);
        imu.upsilon_ib_b[1] = 2e-4;
        if (i > 210) { imu.alpha_ib_b[0] = imu.upsilon_ib_b[2] = 1e-5; }
        push(imu);
    }
    TEST_ASSERT_TRUE(nav.admit.stuck);
    const uint32_t refused = nav.counters.imu_bad_value;
    TEST_ASSERT_UINT_WITHIN(5, 30, refused);
    const pel_imu_t same = {.t_ns = T0 + 2610 * MS, .dt_s = 0.01, .upsilon_ib_b = {0, 2e-4, 1e-5}};
    bool jolt;
    for (int i = 0; i < UINT16_MAX + 10; i++) { TEST_ASSERT_FALSE(pel_nav_admit_imu(&nav, &same, &jolt)); }
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, nav.admit.run[4]); /* and does not run over */
}

/* What is doubted of a place in the ring where there is nothing, or nothing before it. */
static void there_is_no_doubt_of_what_is_not_there(void)
{
    double turn = 7.0, push_ = 7.0;
    TEST_ASSERT_FALSE(pel_nav_doubt_of(&nav, nav.ring.n, 0.01, &turn, &push_));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, turn + push_);
    TEST_ASSERT_FALSE(pel_nav_doubt_of(&nav, 0, 0.01, &turn, &push_));
    TEST_ASSERT_FALSE(pel_nav_doubt_of(&nav, 5, 0.01, &turn, &push_));
    push(calm(206)); /* five lost before it */
    TEST_ASSERT_TRUE(pel_nav_doubt_of(&nav, nav.ring.n - 1, 0.01, &turn, &push_));
}

/* ---- the IMU's clock --------------------------------------------------------------------------------------------------------- */

/* A sender that began to count anew has lost nothing, whatever the difference says. */
static void a_sequence_that_begins_anew_is_no_jump(void)
{
    for (int i = 201; i <= 210; i++) {
        pel_imu_t imu = calm(i);
        imu.seq = (uint16_t)(i - 201);
        push(imu);
    }
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.imu_gap);
    TEST_ASSERT_EQUAL_INT(210, nav.ring.n);
}

/* After a jump the INS waits until the IMU is as far ahead of the rover as it was, or has stayed where it is for a minute. */
static void a_clock_is_believed_again_when_it_fits_or_stays(void)
{
    for (int stays = 0; stays < 2; stays++) {
        setUp();
        for (int i = 0; i < 5; i++) { pel_nav_note_lead(&nav, nav.last_imu_ns - 100 * MS); }
        TEST_ASSERT_TRUE(nav.timing.have_lead);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.1, nav.timing.lead_s);
        pel_nav_doubt_imu_clock(&nav);
        TEST_ASSERT_TRUE(nav.timing.doubted);
        nav.timing.epoch_ns = nav.last_imu_ns - 2100 * MS;
        int seconds = 0;
        for (; seconds < 100 && nav.timing.doubted; seconds++) { /* two seconds behind, then as before */
            const pel_time_t lead_ns = (stays || seconds < 3) ? 2100 * MS : 150 * MS;
            pel_nav_note_lead(&nav, nav.last_imu_ns - lead_ns);
            nav.last_imu_ns += PEL_NS_PER_S;
        }
        TEST_ASSERT_INT_WITHIN(2, stays ? 61 : 4, seconds);
        TEST_ASSERT_FALSE(nav.timing.have_lead); /* learnt anew */
    }
}

static void a_jump_before_anything_is_known_is_not_doubted(void)
{
    pel_nav_doubt_imu_clock(&nav);
    TEST_ASSERT_FALSE(nav.timing.doubted);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_time_at_the_end_of_64_bits_never_enters);
    RUN_TEST(epochs_of_impossible_times_never_enter);
    RUN_TEST(a_spike_is_refused_and_bridged);
    RUN_TEST(what_lasts_is_no_spike);
    RUN_TEST(a_sample_that_says_saturated_is_refused);
    RUN_TEST(a_stuck_axis_of_a_noisy_sensor_is_refused_within_half_a_second);
    RUN_TEST(equal_numbers_of_a_coarse_sensor_are_usual);
    RUN_TEST(a_clock_that_jumps_is_told_by_the_sequence);
    RUN_TEST(lost_samples_are_no_clock_jump);
    RUN_TEST(a_blow_beyond_what_vehicles_feel_is_refused);
    RUN_TEST(the_longest_run_of_equal_numbers_counts);
    RUN_TEST(there_is_no_doubt_of_what_is_not_there);
    RUN_TEST(a_sequence_that_begins_anew_is_no_jump);
    RUN_TEST(a_clock_is_believed_again_when_it_fits_or_stays);
    RUN_TEST(a_jump_before_anything_is_known_is_not_doubted);
    return UNITY_END();
}

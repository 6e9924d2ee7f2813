/* The ring of increments: order, overwriting, search, cutting. */
#include <math.h>

#include "pelorus/inertial.h"
#include "unity.h"

static pel_imu_ring_t ring;

void setUp(void)
{
    pel_imu_ring_init(&ring);
}
void tearDown(void) {}

static pel_imu_t sample(int k)
{
    const pel_imu_t imu = {
        .t_ns = (pel_time_t)k * 2000000, .dt_s = 0.002, .alpha_ib_b = {0.001 * k, 0.0, 0.0}, .seq = (uint16_t)k};
    return imu;
}

static void empty_ring_has_nothing(void)
{
    TEST_ASSERT_NULL(pel_imu_ring_oldest(&ring));
    TEST_ASSERT_NULL(pel_imu_ring_newest(&ring));
    TEST_ASSERT_NULL(pel_imu_ring_at(&ring, 0));
    TEST_ASSERT_EQUAL(0, pel_imu_ring_after(&ring, 5));
}

static void oldest_are_overwritten_and_order_is_kept(void)
{
    for (int k = 1; k <= 3 * PEL_IMU_RING + 7; k++) {
        const pel_imu_t imu = sample(k);
        TEST_ASSERT_EQUAL(PEL_OK, pel_imu_ring_push(&ring, &imu));
        const int n = (k < PEL_IMU_RING) ? k : PEL_IMU_RING;
        TEST_ASSERT_EQUAL(n, ring.n);
        TEST_ASSERT_EQUAL(k, pel_imu_ring_newest(&ring)->seq);
        TEST_ASSERT_EQUAL(k - n + 1, pel_imu_ring_oldest(&ring)->seq);
        for (int i = 0; i < n; i += 17) { TEST_ASSERT_EQUAL(k - n + 1 + i, pel_imu_ring_at(&ring, i)->seq); }
        TEST_ASSERT_NULL(pel_imu_ring_at(&ring, n));
        TEST_ASSERT_NULL(pel_imu_ring_at(&ring, -1));
    }
}

static void time_must_advance(void)
{
    pel_imu_t imu = sample(5);
    TEST_ASSERT_EQUAL(PEL_OK, pel_imu_ring_push(&ring, &imu));
    TEST_ASSERT_EQUAL(PEL_E_STALE, pel_imu_ring_push(&ring, &imu));
    imu = sample(4);
    TEST_ASSERT_EQUAL(PEL_E_STALE, pel_imu_ring_push(&ring, &imu));
    imu = sample(6);
    imu.dt_s = 0.0;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_imu_ring_push(&ring, &imu));
    imu.dt_s = (double)NAN;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_imu_ring_push(&ring, &imu));
    TEST_ASSERT_EQUAL(1, ring.n);
}

static void search_finds_the_increment_that_contains_a_time(void)
{
    for (int k = 1; k <= PEL_IMU_RING + 50; k++) {
        const pel_imu_t imu = sample(k);
        (void)pel_imu_ring_push(&ring, &imu);
    }
    for (int i = 0; i < ring.n; i++) {
        const pel_time_t t = pel_imu_ring_at(&ring, i)->t_ns;
        TEST_ASSERT_EQUAL(i, pel_imu_ring_after(&ring, t - 1));
        TEST_ASSERT_EQUAL(i + 1, pel_imu_ring_after(&ring, t));
        const int behind = ring.n - (i + 1);
        TEST_ASSERT_TRUE(pel_imu_ring_has_after(&ring, t, behind));
        TEST_ASSERT_FALSE(pel_imu_ring_has_after(&ring, t, behind + 1));
    }
    TEST_ASSERT_FALSE(pel_imu_ring_has_after(&ring, 0, ring.n + 1));
    TEST_ASSERT_EQUAL(0, pel_imu_ring_after(&ring, 0));
}

static void pieces_add_up_to_the_whole(void)
{
    const pel_imu_t whole = {.t_ns = 1000000000,
                             .dt_s = 0.01,
                             .alpha_ib_b = {0.1, -0.2, 0.3},
                             .upsilon_ib_b = {1.1, -2.2, 3.3},
                             .seq = 9,
                             .flags = 2};
    pel_imu_t a;
    pel_imu_t b;
    TEST_ASSERT_EQUAL(PEL_OK, pel_imu_split(&whole, 992500000, &a, &b));
    TEST_ASSERT_TRUE(a.t_ns == 992500000 && b.t_ns == whole.t_ns);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0025, a.dt_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0075, b.dt_s);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.25 * whole.alpha_ib_b[i], a.alpha_ib_b[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-15, whole.upsilon_ib_b[i], a.upsilon_ib_b[i] + b.upsilon_ib_b[i]);
    }
    TEST_ASSERT_TRUE(a.seq == 9 && b.flags == 2);
    const pel_imu_t keep = a;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_imu_split(&whole, whole.t_ns, &a, &b));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_imu_split(&whole, 990000000, &a, &b));
    TEST_ASSERT_EQUAL_MEMORY(&keep, &a, sizeof a);
    pel_imu_t self = whole;
    TEST_ASSERT_EQUAL(PEL_OK, pel_imu_split(&self, 992500000, &self, &b));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.0025, self.dt_s);
}

static void the_check_of_an_increment_sees_its_last_member(void)
{
    pel_imu_ring_init(&ring);
    const pel_imu_t imu = {.t_ns = 1, .dt_s = 0.01};
    TEST_ASSERT_EQUAL(PEL_OK, pel_imu_ring_push(&ring, &imu));
    TEST_ASSERT_TRUE(pel_imu_ring_is_whole(&ring, 0));
    ring.imu[ring.head == 0 ? PEL_IMU_RING - 1 : ring.head - 1].flags ^= 0x8000u;
    TEST_ASSERT_FALSE(pel_imu_ring_is_whole(&ring, 0));
}

static void what_is_not_there_is_not_whole_and_what_is_too_long_does_not_enter(void)
{
    pel_imu_ring_init(&ring);
    TEST_ASSERT_FALSE(pel_imu_ring_is_whole(&ring, 0));
    static const double LENGTHS[] = {0.0, -0.01, 10.0000001, NAN, 10.0};
    for (int i = 0; i < 5; i++) {
        const pel_imu_t imu = {.t_ns = 1, .dt_s = LENGTHS[i]};
        TEST_ASSERT_EQUAL(i < 4 ? PEL_E_RANGE : PEL_OK, pel_imu_ring_push(&ring, &imu));
    }
    TEST_ASSERT_EQUAL_INT(1, ring.n);
    TEST_ASSERT_FALSE(pel_imu_ring_is_whole(&ring, 1));
    TEST_ASSERT_FALSE(pel_imu_ring_is_whole(&ring, -1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(empty_ring_has_nothing);
    RUN_TEST(oldest_are_overwritten_and_order_is_kept);
    RUN_TEST(time_must_advance);
    RUN_TEST(search_finds_the_increment_that_contains_a_time);
    RUN_TEST(pieces_add_up_to_the_whole);
    RUN_TEST(the_check_of_an_increment_sees_its_last_member);
    RUN_TEST(what_is_not_there_is_not_whole_and_what_is_too_long_does_not_enter);
    return UNITY_END();
}

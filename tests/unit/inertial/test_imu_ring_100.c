/* A ring whose size is no power of two wraps where it must. The source is compiled here with that size. */
#define PEL_IMU_RING 100
#include "../../../firmware/src/inertial/imu_ring.c"

#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void the_last_hundred_are_there_in_order(void)
{
    static pel_imu_ring_t ring;
    pel_imu_ring_init(&ring);
    for (int k = 1; k <= 357; k++) {
        const pel_imu_t imu = {.t_ns = k * PEL_NS_PER_MS, .dt_s = 1e-3};
        TEST_ASSERT_EQUAL(PEL_OK, pel_imu_ring_push(&ring, &imu));
        const int n = (k < 100) ? k : 100;
        TEST_ASSERT_EQUAL_INT(n, ring.n);
        for (int i = 0; i < n; i++) {
            TEST_ASSERT_EQUAL_INT64((k - n + 1 + i) * PEL_NS_PER_MS, pel_imu_ring_at(&ring, i)->t_ns);
            TEST_ASSERT_TRUE(pel_imu_ring_is_whole(&ring, i));
        }
        TEST_ASSERT_NULL(pel_imu_ring_at(&ring, n));
        TEST_ASSERT_EQUAL_INT(n - 1, pel_imu_ring_after(&ring, (k - 1) * PEL_NS_PER_MS));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_last_hundred_are_there_in_order);
    return UNITY_END();
}

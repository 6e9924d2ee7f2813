/* IMU frames: layout, round trip, order, gaps, damage; RAWIMUSX units. */
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/wire/framing.h"
#include "support_wire.h"
#include "unity.h"

static pel_imu_stream_t s;
static uint8_t frame[128];

void setUp(void)
{
    pel_imu_stream_init(&s);
}
void tearDown(void) {}

static pel_imu_t sample(int i)
{
    pel_imu_t m = {
        .t_ns = T0 + i * 2 * PEL_NS_PER_MS, .dt_s = 0.002, .seq = (uint16_t)i, .flags = PEL_IMU_TIME_UNSYNCED};
    for (int k = 0; k < 3; k++) {
        m.alpha_ib_b[k] = 1.23456789e-4 * (k - 1) + 1e-9 * i;
        m.upsilon_ib_b[k] = -0.0196 * (k - 1) + 1e-7 * i;
    }
    return m;
}

static int push(const uint8_t *p, size_t n, pel_imu_event_t kind)
{
    int count = 0;
    for (size_t i = 0; i < n; i++) { count += (pel_imu_stream_push(&s, p[i]) == kind) ? 1 : 0; }
    return count;
}

static int push_sample(int i)
{
    const pel_imu_t m = sample(i);
    return push(frame, pel_imu_encode(&m, frame, sizeof frame), PEL_IMU_SAMPLE);
}

static void every_byte_of_a_frame_is_where_the_documentation_says(void)
{
    pel_imu_t m = {.t_ns = INT64_C(0x0102030405060708), .dt_s = 0.002, .seq = 0x1122, .flags = 0x0003};
    m.alpha_ib_b[0] = pel_pow2(-31);
    m.upsilon_ib_b[2] = -2.0 * pel_pow2(-27);
    static const uint8_t EXPECTED[46] = {'P',  'L', 0x01, 1,    40, 0, 8, 7, 6, 5, 4,    3,    2,    1,   0x80, 0x84,
                                         0x1E, 0,   0x22, 0x11, 3,  0, 1, 0, 0, 0, 0,    0,    0,    0,   0,    0,
                                         0,    0,   0,    0,    0,  0, 0, 0, 0, 0, 0xFE, 0xFF, 0xFF, 0xFF};
    TEST_ASSERT_EQUAL_size_t(49, pel_imu_encode(&m, frame, sizeof frame));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(EXPECTED, frame, sizeof EXPECTED);
    TEST_ASSERT_EQUAL_HEX32(pel_crc24q(0, frame + 2, 44), (uint32_t)pel_bits_u(frame, 8 * 46, 24));
    TEST_ASSERT_EQUAL_size_t(21, pel_event_mark_encode(T0, 7, frame, sizeof frame));
}

static void samples_return_within_half_a_unit(void)
{
    for (int i = 0; i < 1000; i++) {
        const pel_imu_t m = sample(i);
        TEST_ASSERT_EQUAL_INT(1, push_sample(i));
        TEST_ASSERT_EQUAL_INT64(m.t_ns, s.imu.t_ns);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, m.dt_s, s.imu.dt_s);
        TEST_ASSERT_EQUAL_UINT16(m.seq, s.imu.seq);
        TEST_ASSERT_EQUAL_HEX16(m.flags, s.imu.flags);
        for (int k = 0; k < 3; k++) {
            TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-32) * 1.0001, m.alpha_ib_b[k], s.imu.alpha_ib_b[k]);
            TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-28) * 1.0001, m.upsilon_ib_b[k], s.imu.upsilon_ib_b[k]);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(0, s.counters.gap);
}

static void lost_doubled_and_late_samples_are_counted(void)
{
    TEST_ASSERT_EQUAL_INT(1, push_sample(1));
    TEST_ASSERT_EQUAL_INT(0, push_sample(1));
    TEST_ASSERT_EQUAL_INT(0, push_sample(0));
    TEST_ASSERT_EQUAL_INT(1, push_sample(2));
    TEST_ASSERT_EQUAL_INT(1, push_sample(5));
    TEST_ASSERT_EQUAL_UINT32(1, s.counters.duplicate);
    TEST_ASSERT_EQUAL_UINT32(1, s.counters.time_back);
    TEST_ASSERT_EQUAL_UINT32(1, s.counters.gap);
}

static void the_sequence_number_wraps_without_a_gap(void)
{
    for (int i = 65530; i < 65545; i++) { TEST_ASSERT_EQUAL_INT(1, push_sample(i)); }
    TEST_ASSERT_EQUAL_UINT32(0, s.counters.gap);
}

static void every_bit_flip_is_refused(void)
{
    const pel_imu_t m = sample(1);
    const size_t n = pel_imu_encode(&m, frame, sizeof frame);
    for (size_t bit = 0; bit < 8 * n; bit++) {
        setUp();
        frame[bit / 8] ^= (uint8_t)(1u << (bit % 8));
        TEST_ASSERT_EQUAL_INT(0, push(frame, n, PEL_IMU_SAMPLE));
        frame[bit / 8] ^= (uint8_t)(1u << (bit % 8));
    }
}

static void a_cut_frame_does_not_cost_the_next_ones(void)
{
    const pel_imu_t m = sample(0);
    for (size_t cut = 1; cut < 49; cut++) {
        setUp();
        (void)push(frame, pel_imu_encode(&m, frame, cut + 60) > 0 ? cut : 0, PEL_IMU_SAMPLE);
        int events = 0;
        for (int i = 1; i <= 4; i++) { events += push_sample(i); }
        TEST_ASSERT_GREATER_OR_EQUAL_INT(3, events); /* the last may wait behind the cut one's announced length */
    }
}

static void impossible_increments_are_refused_both_ways(void)
{
    const double zero = s.gyro_scale_rad;
    const double bad[] = {1.0, -1.0, 1e9, zero / zero};
    for (int i = 0; i < 4; i++) {
        pel_imu_t m = sample(1);
        m.alpha_ib_b[1] = bad[i];
        TEST_ASSERT_EQUAL_size_t(0, pel_imu_encode(&m, frame, sizeof frame));
    }
    pel_imu_t m = sample(1);
    (void)pel_imu_encode(&m, frame, sizeof frame);
    pel_le_put(frame + 14, 4, 0); /* dt = 0 */
    TEST_ASSERT_EQUAL_INT(0, push(frame, pel_out_seal(PEL_OUT_IMU, 40, frame, sizeof frame), PEL_IMU_SAMPLE));
    TEST_ASSERT_EQUAL_UINT32(1, s.counters.bad_value);
}

static void event_marks_pass_between_samples(void)
{
    TEST_ASSERT_EQUAL_INT(1, push_sample(1));
    TEST_ASSERT_EQUAL_INT(
        1, push(frame, pel_event_mark_encode(T0 + 123, 4000000001u, frame, sizeof frame), PEL_IMU_EVENT_MARK));
    TEST_ASSERT_EQUAL_INT64(T0 + 123, s.mark_t_ns);
    TEST_ASSERT_EQUAL_UINT32(4000000001u, s.mark_id);
    TEST_ASSERT_EQUAL_INT(1, push_sample(2));
    TEST_ASSERT_EQUAL_UINT32(0, s.counters.gap);
}

static void barometer_samples_pass_between_and_keep_their_millimetres(void)
{
    static const uint8_t EXPECTED[22] = {'P', 'L', 0x03, 1,    16,   0,    8,    7,    6,    5,    4,
                                         3,   2,   1,    0x85, 0xFF, 0xFF, 0xFF, 0xE8, 0x03, 0x22, 0x11};
    pel_baro_t b = {.t_ns = INT64_C(0x0102030405060708), .height_m = -0.1234, .sd_m = 1.0f, .seq = 0x1122};
    TEST_ASSERT_EQUAL_size_t(25, pel_baro_encode(&b, frame, sizeof frame));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(EXPECTED, frame, sizeof EXPECTED);
    TEST_ASSERT_EQUAL_INT(1, push_sample(1));
    TEST_ASSERT_EQUAL_INT(1, push(frame, pel_baro_encode(&b, frame, sizeof frame), PEL_IMU_BARO));
    TEST_ASSERT_EQUAL_INT64(b.t_ns, s.baro.t_ns);
    TEST_ASSERT_DOUBLE_WITHIN(5.01e-4, b.height_m, s.baro.height_m);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f, s.baro.sd_m);
    TEST_ASSERT_EQUAL_HEX16(0x1122, s.baro.seq);
    TEST_ASSERT_EQUAL_INT(1, push_sample(2));
    TEST_ASSERT_EQUAL_UINT32(0, s.counters.gap);
    const pel_baro_t before = s.baro;
    (void)pel_baro_encode(&b, frame, sizeof frame);
    pel_le_put(frame + 18, 2, 0); /* no noise */
    TEST_ASSERT_EQUAL_INT(0, push(frame, pel_out_seal(PEL_OUT_BARO, 16, frame, sizeof frame), PEL_IMU_BARO));
    TEST_ASSERT_EQUAL_INT(0, push(frame, pel_out_seal(PEL_OUT_BARO, 12, frame, sizeof frame), PEL_IMU_BARO));
    TEST_ASSERT_EQUAL_UINT32(1, s.counters.bad_value);
    TEST_ASSERT_EQUAL_UINT32(1, s.counters.bad_length);
    TEST_ASSERT_EQUAL_MEMORY(&before, &s.baro, sizeof before);
    const double zero = s.gyro_scale_rad;
    b.height_m = zero / zero;
    TEST_ASSERT_EQUAL_size_t(0, pel_baro_encode(&b, frame, sizeof frame));
    b.height_m = 1e5;
    TEST_ASSERT_EQUAL_size_t(0, pel_baro_encode(&b, frame, sizeof frame));
}

static int push_raw(int i, uint8_t type)
{
    pel_imu_t m = sample(5 * i);
    m.dt_s = 0.01;
    return push(frame, pel_rawimusx_encode(&m, type, 1e-9, 2e-8, frame, sizeof frame), PEL_IMU_SAMPLE);
}

static void rawimusx_takes_units_from_the_type_or_from_the_caller(void)
{
    TEST_ASSERT_EQUAL_INT(1, push_raw(1, 26)); /* ISA-100C: 1e-9 rad, 2e-8 m/s */
    TEST_ASSERT_DOUBLE_WITHIN(0.51e-9, sample(5).alpha_ib_b[2], s.imu.alpha_ib_b[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1.01e-8, sample(5).upsilon_ib_b[0], s.imu.upsilon_ib_b[0]);
    TEST_ASSERT_EQUAL_INT(0, push_raw(2, 200));
    TEST_ASSERT_EQUAL_UINT32(1, s.counters.bad_value);
    pel_imu_stream_set_rawimu(&s, 1e-9, 2e-8, 0.01);
    TEST_ASSERT_EQUAL_INT(1, push_raw(3, 200));
    TEST_ASSERT_EQUAL_DOUBLE(0.01, s.imu.dt_s);
    TEST_ASSERT_EQUAL_UINT32(1, s.counters.gap); /* the refused one is missing in time: 20 ms after 5 */
    frame[12] = 0x01;                            /* the IMU reports an error */
    pel_le_put(frame + 52, 4, pel_crc32_novatel(frame, 52));
    TEST_ASSERT_EQUAL_INT(0, push(frame, 56, PEL_IMU_SAMPLE));
    TEST_ASSERT_EQUAL_UINT32(2, s.counters.bad_value);
}

static void a_million_random_bytes_give_nothing(void)
{
    int events = 0;
    for (int i = 0; i < 1000000; i++) {
        events += (pel_imu_stream_push(&s, (uint8_t)(support_random() >> 7)) != PEL_IMU_NONE) ? 1 : 0;
    }
    TEST_ASSERT_EQUAL_INT(0, events);
    TEST_ASSERT_UINT32_WITHIN(sizeof s.buf, 1000000, s.counters.noise_bytes);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_byte_of_a_frame_is_where_the_documentation_says);
    RUN_TEST(samples_return_within_half_a_unit);
    RUN_TEST(lost_doubled_and_late_samples_are_counted);
    RUN_TEST(the_sequence_number_wraps_without_a_gap);
    RUN_TEST(every_bit_flip_is_refused);
    RUN_TEST(a_cut_frame_does_not_cost_the_next_ones);
    RUN_TEST(impossible_increments_are_refused_both_ways);
    RUN_TEST(event_marks_pass_between_samples);
    RUN_TEST(barometer_samples_pass_between_and_keep_their_millimetres);
    RUN_TEST(rawimusx_takes_units_from_the_type_or_from_the_caller);
    RUN_TEST(a_million_random_bytes_give_nothing);
    return UNITY_END();
}

/* Frames of the IMU stream at the limits of their numbers, both ways: increments, marks, barometer, RAWIMUSX. */
#include <math.h>
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

static int push(size_t n, pel_imu_event_t kind)
{
    int count = 0;
    for (size_t i = 0; i < n; i++) { count += (pel_imu_stream_push(&s, frame[i]) == kind) ? 1 : 0; }
    return count;
}

static int push_payload(uint8_t id, size_t n_payload, pel_imu_event_t kind)
{
    return push(pel_out_seal(id, n_payload, frame, sizeof frame), kind);
}

static pel_imu_t still(void)
{
    const pel_imu_t m = {.t_ns = T0, .dt_s = 0.01, .upsilon_ib_b = {0.0, 0.0, 0.098}};
    return m;
}

static pel_baro_t baro(void)
{
    const pel_baro_t b = {.t_ns = T0, .height_m = 100.0, .sd_m = 0.5f};
    return b;
}

/* What the encoder takes the decoder takes as well, and gives back. */
#define IN(type, make, encode, event, change)                                                                          \
    do {                                                                                                               \
        type v = make();                                                                                               \
        setUp();                                                                                                       \
        change;                                                                                                        \
        const size_t n = encode(&v, frame, sizeof frame);                                                              \
        TEST_ASSERT_GREATER_THAN_size_t_MESSAGE(0, n, #change);                                                        \
        TEST_ASSERT_EQUAL_INT_MESSAGE(1, push(n, event), #change);                                                     \
    } while (0)
#define OUT(type, make, encode, change)                                                                                \
    do {                                                                                                               \
        type v = make();                                                                                               \
        change;                                                                                                        \
        TEST_ASSERT_EQUAL_size_t_MESSAGE(0, encode(&v, frame, sizeof frame), #change);                                 \
    } while (0)
#define IMU_IN(change)   IN(pel_imu_t, still, pel_imu_encode, PEL_IMU_SAMPLE, change)
#define IMU_OUT(change)  OUT(pel_imu_t, still, pel_imu_encode, change)
#define BARO_IN(change)  IN(pel_baro_t, baro, pel_baro_encode, PEL_IMU_BARO, change)
#define BARO_OUT(change) OUT(pel_baro_t, baro, pel_baro_encode, change)

static void increments_are_taken_up_to_their_limits_and_not_beyond(void)
{
    const double nan = (double)NAN;
    for (int i = 0; i < 3; i++) {
        IMU_IN(v.alpha_ib_b[i] = nextafter(1.0, 0.0));
        TEST_ASSERT_DOUBLE_WITHIN(0x1p-31, 1.0, s.imu.alpha_ib_b[i]);
        IMU_IN(v.alpha_ib_b[i] = nextafter(-1.0, 0.0));
        TEST_ASSERT_DOUBLE_WITHIN(0x1p-31, -1.0, s.imu.alpha_ib_b[i]);
        IMU_OUT(v.alpha_ib_b[i] = 1.0);
        IMU_OUT(v.alpha_ib_b[i] = -1.0);
        IMU_OUT(v.alpha_ib_b[i] = nan);
        IMU_IN(v.upsilon_ib_b[i] = nextafter(16.0, 0.0));
        TEST_ASSERT_DOUBLE_WITHIN(0x1p-27, 16.0, s.imu.upsilon_ib_b[i]);
        IMU_IN(v.upsilon_ib_b[i] = nextafter(-16.0, 0.0));
        TEST_ASSERT_DOUBLE_WITHIN(0x1p-27, -16.0, s.imu.upsilon_ib_b[i]);
        IMU_OUT(v.upsilon_ib_b[i] = 16.0);
        IMU_OUT(v.upsilon_ib_b[i] = -16.0);
        IMU_OUT(v.upsilon_ib_b[i] = nan);
    }
    IMU_IN(v.dt_s = 1e-9);
    IMU_OUT(v.dt_s = 0.0);
    IMU_IN(v.dt_s = 4.289);
    IMU_OUT(v.dt_s = 4.29);
    IMU_OUT(v.dt_s = nan);
    IMU_IN(v.t_ns = 1);
    IMU_OUT(v.t_ns = 0);
    IMU_IN(v.t_ns = PEL_TIME_LAST - 1);
    IMU_OUT(v.t_ns = PEL_TIME_LAST);
    const pel_imu_t m = still();
    TEST_ASSERT_EQUAL_size_t(0, pel_imu_encode(&m, frame, 48));
    TEST_ASSERT_EQUAL_size_t(49, pel_imu_encode(&m, frame, 49));
}

static void marks_have_a_time(void)
{
    static const struct {
        pel_time_t t;
        bool good;
    } CASE[] = {{0, false}, {-1, false}, {1, true}, {PEL_TIME_LAST - 1, true}, {PEL_TIME_LAST, false}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        setUp();
        TEST_ASSERT_EQUAL_size_t(CASE[i].good ? 21 : 0, pel_event_mark_encode(CASE[i].t, 5, frame, 21));
        (void)pel_event_mark_encode(T0, 5, frame, sizeof frame);
        pel_le_put(frame + 6, 8, (uint64_t)CASE[i].t);
        TEST_ASSERT_EQUAL_INT(CASE[i].good ? 1 : 0, push_payload(PEL_OUT_EVENT_MARK, 12, PEL_IMU_EVENT_MARK));
        TEST_ASSERT_EQUAL_INT64(CASE[i].good ? CASE[i].t : 0, s.mark_t_ns);
        TEST_ASSERT_EQUAL_UINT32(CASE[i].good ? 0 : 1, s.counters.bad_value);
    }
    TEST_ASSERT_EQUAL_size_t(0, pel_event_mark_encode(T0, 5, frame, 20));
}

static void heights_are_taken_up_to_their_limits_and_not_beyond(void)
{
    const double nan = (double)NAN;
    BARO_IN(v.height_m = 99999.999);
    BARO_IN(v.height_m = -99999.999);
    BARO_OUT(v.height_m = 1e5);
    BARO_OUT(v.height_m = -1e5);
    BARO_OUT(v.height_m = nan);
    BARO_IN(v.sd_m = 0.001f);
    BARO_OUT(v.sd_m = 0.0009f);
    BARO_IN(v.sd_m = 65.534f);
    BARO_OUT(v.sd_m = 65.536f);
    BARO_OUT(v.sd_m = (float)nan);
    BARO_IN(v.t_ns = 1);
    BARO_OUT(v.t_ns = 0);
    BARO_IN(v.t_ns = PEL_TIME_LAST - 1);
    BARO_OUT(v.t_ns = PEL_TIME_LAST);
    pel_baro_t b = baro();
    TEST_ASSERT_EQUAL_size_t(0, pel_baro_encode(&b, frame, 24));
    TEST_ASSERT_EQUAL_size_t(25, pel_baro_encode(&b, frame, 25));

    static const struct {
        int at;
        unsigned bytes;
        int64_t value;
        bool good;
    } CASE[] = {{0, 8, 0, false},       {0, 8, 1, true},           {0, 8, PEL_TIME_LAST, false},
                {8, 4, 99999999, true}, {8, 4, 100000000, false},  {8, 4, -99999999, true},
                {12, 2, 0, false},      {8, 4, -100000000, false}, {12, 2, 1, true}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        setUp();
        (void)pel_baro_encode(&b, frame, sizeof frame);
        pel_le_put(frame + 6 + CASE[i].at, CASE[i].bytes, (uint64_t)CASE[i].value);
        TEST_ASSERT_EQUAL_INT(CASE[i].good ? 1 : 0, push_payload(PEL_OUT_BARO, 16, PEL_IMU_BARO));
        TEST_ASSERT_EQUAL_UINT32(CASE[i].good ? 0 : 1, s.counters.bad_value);
    }
}

static void frames_of_another_kind_version_or_length_are_refused(void)
{
    static const struct {
        uint8_t id, version;
        size_t n;
        uint32_t unknown, length;
    } CASE[] = {{PEL_OUT_SOLUTION, 1, 40, 1, 0}, {0, 1, 40, 1, 0},
                {PEL_OUT_IMU, 2, 40, 0, 1},      {PEL_OUT_IMU, 0, 40, 0, 1},
                {PEL_OUT_IMU, 1, 39, 0, 1},      {PEL_OUT_IMU, 1, 41, 0, 1},
                {PEL_OUT_BARO, 1, 15, 0, 1},     {PEL_OUT_EVENT_MARK, 1, 13, 0, 1}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        const pel_imu_t m = still();
        setUp();
        (void)pel_imu_encode(&m, frame, sizeof frame);
        const size_t n = pel_out_seal(CASE[i].id, CASE[i].n, frame, sizeof frame);
        frame[3] = CASE[i].version;
        pel_bits_put(frame, 8u * (CASE[i].n + 6u), 24, pel_crc24q(0, frame + 2, CASE[i].n + 4u));
        TEST_ASSERT_EQUAL_INT((int)n, push(n, PEL_IMU_NONE));
        TEST_ASSERT_EQUAL_UINT32(CASE[i].unknown, s.counters.unknown);
        TEST_ASSERT_EQUAL_UINT32(CASE[i].length, s.counters.bad_length);
        TEST_ASSERT_EQUAL_UINT32(0, s.counters.frames);
    }
}

/* ---- RAWIMUSX -------------------------------------------------------------------------------------------------------- */

static size_t raw_at(pel_time_t t, double gyro, double accel)
{
    pel_imu_t m = still();
    m.t_ns = t;
    return pel_rawimusx_encode(&m, 26, gyro, accel, frame, sizeof frame);
}

static int push_raw(size_t n)
{
    pel_le_put(frame + n - 4u, 4, pel_crc32_novatel(frame, n - 4u));
    return push(n, PEL_IMU_SAMPLE);
}

static void other_logs_of_the_same_header_are_unknown(void)
{
    for (int what = 0; what < 3; what++) {
        setUp();
        size_t n = raw_at(T0, 1e-9, 2e-8);
        if (what == 1) { pel_le_put(frame + 4, 2, 1461); }
        if (what == 2) {
            frame[3] = 36;
            n = 52;
        }
        TEST_ASSERT_EQUAL_INT((what == 0) ? 1 : 0, push_raw(n));
        TEST_ASSERT_EQUAL_UINT32((what == 0) ? 0 : 1, s.counters.unknown);
    }
}

static void raw_samples_of_impossible_time_size_or_health_are_refused(void)
{
    static const struct {
        unsigned week;
        double tow_s, gyro_scale;
        uint8_t error;
        bool good;
    } CASE[] = {
        {2300, 345600.0, 0.0, 0, true},  {999, 345600.0, 0.0, 0, false},   {6001, 345600.0, 0.0, 0, false},
        {2300, -1e-3, 0.0, 0, false},    {2300, 604801.0, 0.0, 0, false},  {2300, (double)NAN, 0.0, 0, false},
        {2300, 345600.0, 0.0, 1, false}, {2300, 345600.0, 0.0, 2, true},   /* bit 0 is the error of the whole IMU */
        {2300, 345600.0, 1e-3, 0, true}, {2300, 345600.0, 0.02, 0, false}, /* 100 counts of 20 mrad */
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        setUp();
        if (CASE[i].gyro_scale > 0.0) { pel_imu_stream_set_rawimu(&s, CASE[i].gyro_scale, 1e-8, 0.01); }
        const size_t n = raw_at(T0, 1e-9, 2e-8);
        frame[12] = CASE[i].error;
        pel_le_put(frame + 14, 2, CASE[i].week);
        pel_le_put_f64(frame + 16, CASE[i].tow_s);
        pel_le_put(frame + 12 + 28, 4, 100);
        TEST_ASSERT_EQUAL_INT(CASE[i].good ? 1 : 0, push_raw(n));
        TEST_ASSERT_EQUAL_UINT32(CASE[i].good ? 0 : 1, s.counters.bad_value);
    }
}

static void a_gap_without_numbers_is_told_by_the_time(void)
{
    static const struct {
        int64_t after_us;
        uint32_t gap;
    } CASE[] = {{5000, 0}, {7499, 0}, {7501, 1}}; /* type 26 samples at 200 Hz: a gap is more than 7.5 ms */
    for (size_t i = 0; i < 3; i++) {
        setUp();
        TEST_ASSERT_EQUAL_INT(1, push_raw(raw_at(T0, 1e-9, 2e-8)));
        TEST_ASSERT_EQUAL_INT(1, push_raw(raw_at(T0 + CASE[i].after_us * 1000, 1e-9, 2e-8)));
        TEST_ASSERT_EQUAL_UINT32(CASE[i].gap, s.counters.gap);
    }
}

static void counts_that_do_not_fit_are_not_sent(void)
{
    const double most = 2147483647.0;
    for (int axis = 0; axis < 3; axis++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            for (int gyro = 0; gyro < 2; gyro++) {
                pel_imu_t m = still();
                m.upsilon_ib_b[2] = 0.0;
                double *const v = (gyro != 0) ? &m.alpha_ib_b[axis] : &m.upsilon_ib_b[axis];
                *v = sign * 0.5;
                const double fits = 0.5 / most;
                const double too_small = 0.5 / (most + 2.0);
                TEST_ASSERT_EQUAL_size_t(56, pel_rawimusx_encode(&m, 26, fits, fits, frame, sizeof frame));
                TEST_ASSERT_EQUAL_size_t(0, pel_rawimusx_encode(&m, 26, too_small, too_small, frame, sizeof frame));
            }
        }
    }
    pel_imu_t m = still();
    TEST_ASSERT_EQUAL_size_t(0, pel_rawimusx_encode(&m, 26, 0.0, 2e-8, frame, sizeof frame));
    TEST_ASSERT_EQUAL_size_t(0, pel_rawimusx_encode(&m, 26, (double)NAN, 2e-8, frame, sizeof frame));
    TEST_ASSERT_EQUAL_size_t(0, pel_rawimusx_encode(&m, 26, 1e-9, 0.0, frame, sizeof frame));
    TEST_ASSERT_EQUAL_size_t(0, pel_rawimusx_encode(&m, 26, 1e-9, -1.0, frame, sizeof frame));
    TEST_ASSERT_EQUAL_size_t(0, pel_rawimusx_encode(&m, 26, 1e-9, 2e-8, frame, 55));
    TEST_ASSERT_EQUAL_size_t(56, pel_rawimusx_encode(&m, 26, 1e-9, 2e-8, frame, 56));
    m.dt_s = 0.0;
    TEST_ASSERT_EQUAL_size_t(0, pel_rawimusx_encode(&m, 26, 1e-9, 2e-8, frame, sizeof frame));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(increments_are_taken_up_to_their_limits_and_not_beyond);
    RUN_TEST(marks_have_a_time);
    RUN_TEST(heights_are_taken_up_to_their_limits_and_not_beyond);
    RUN_TEST(frames_of_another_kind_version_or_length_are_refused);
    RUN_TEST(other_logs_of_the_same_header_are_unknown);
    RUN_TEST(raw_samples_of_impossible_time_size_or_health_are_refused);
    RUN_TEST(a_gap_without_numbers_is_told_by_the_time);
    RUN_TEST(counts_that_do_not_fit_are_not_sent);
    return UNITY_END();
}

/* What made other decoders fail, and what the fuzz targets found in this one: named after the symptom. */
#include <string.h>

#include "pelorus/bits.h"
#include "support_wire.h"
#include "unity.h"

static pel_receiver_t rx;
static pel_imu_stream_t imu_stream;
static pel_epoch_t epoch;
static uint8_t frame[PEL_MAX_FRAME_BYTES];

void setUp(void)
{
    pel_receiver_init(&rx);
    pel_imu_stream_init(&imu_stream);
}
void tearDown(void) {}

/* An RTCM 3 frame around n bytes of message already at frame + 3. */
static size_t seal_rtcm3(size_t n)
{
    frame[0] = 0xD3;
    frame[1] = (uint8_t)(n >> 8);
    frame[2] = (uint8_t)n;
    pel_bits_put(frame, 8u * (n + 3u), 24, pel_crc24q(0, frame, n + 3u));
    return n + 6u;
}

static void seal_ubx(size_t n_payload)
{
    const uint16_t sum = pel_fletcher8(frame + 2, n_payload + 4u);
    frame[6u + n_payload] = (uint8_t)(sum >> 8);
    frame[7u + n_payload] = (uint8_t)sum;
}

static void seal_pelorus(size_t n_payload)
{
    pel_bits_put(frame, 8u * (n_payload + 6u), 24, pel_crc24q(0, frame + 2, n_payload + 4u));
}

static int push_imu(size_t n, pel_imu_event_t kind)
{
    int events = 0;
    for (size_t i = 0; i < n; i++) { events += (pel_imu_stream_push(&imu_stream, frame[i]) == kind) ? 1 : 0; }
    return events;
}

/* RTKLIB issues 798 and 799: five strings, each as long as its own length byte says, copied into 31 characters. */
static void descriptor_lengths_of_1033_beyond_the_message_do_no_harm(void)
{
    const pel_station_t station = {.id = 5, .r_ea_e = {4.0e6, 1.0e6, 4.8e6}};
    for (size_t n = 4; n <= 40; n++) {
        setUp();
        memset(frame, 0xFF, sizeof frame);
        pel_bits_put(frame + 3, 0, 12, 1033);
        const size_t sealed = seal_rtcm3(n);
        TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, sealed, PEL_RX_STATION));
        TEST_ASSERT_EQUAL_UINT32(1, rx.counters.unknown);
        const size_t next = pel_rtcm3_encode_station(&station, 1005, frame, sizeof frame);
        TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, next, PEL_RX_STATION));
        TEST_ASSERT_EQUAL_UINT32(0, rx.counters.noise_bytes);
    }
}

/* Motorola Oncore receivers have told a time of 62:28:15. */
static void a_clock_that_shows_62_28_15_tells_no_time(void)
{
    static const struct {
        int at;
        uint8_t value;
    } BAD[] = {{8, 62}, {9, 60}, {10, 61}, {7, 0}, {7, 32}, {6, 0}, {6, 13}};
    const pel_pvt_t pvt = {.t_ns = T0, .fix = 3};
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        setUp();
        const size_t n = pel_ubx_encode_pvt(&pvt, frame, sizeof frame);
        frame[6 + BAD[i].at] = BAD[i].value;
        seal_ubx(92);
        TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_PVT));
        TEST_ASSERT_EQUAL_UINT32(1, rx.counters.bad_value);
    }
}

/* The same of the other time fields: second of week, millisecond of the week and of the day. */
static void times_beyond_their_range_are_refused(void)
{
    pel_receiver_set_time(&rx, T0);
    support_epoch(&epoch, T0, PEL_SYS_GPS, 5);
    size_t n = pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame);
    pel_le_put_f64(frame + 6, 604801.0);
    seal_ubx(n - 8u);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPOCH));

    n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 5, false, frame, sizeof frame);
    pel_bits_put(frame + 3, 24, 30, 604800000);
    (void)seal_rtcm3(n - 6u);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPOCH));

    n = pel_rtcm3_encode_1004(&epoch, 5, false, frame, sizeof frame);
    pel_bits_put(frame + 3, 24, 30, 604800000);
    (void)seal_rtcm3(n - 6u);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT32(3, rx.counters.bad_value);
}

/* Receivers whose firmware counts 1024 weeks have jumped by them in the middle of a run. */
static void an_epoch_1024_weeks_ago_is_counted_and_the_stream_goes_on(void)
{
    for (int i = 0; i < 6; i++) {
        const pel_time_t t = T0 + i * PEL_NS_PER_S;
        support_epoch(&epoch, (i == 3) ? t - 1024 * PEL_NS_PER_WEEK : t, PEL_SYS_GPS, 5);
        const size_t n = pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame);
        TEST_ASSERT_EQUAL_INT((i == 3) ? 0 : 1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    }
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.time_back);
    TEST_ASSERT_EQUAL_INT64(T0 + 5 * PEL_NS_PER_S, rx.epoch.t_ns);
}

/* And orbits of ten bits of week belong to the time of the stream, on both sides of a roll-over. */
static void ten_bits_of_week_are_right_on_both_sides_of_every_roll_over(void)
{
    pel_ephemeris_t eph;
    for (int32_t week = 2047; week <= 3073; week += 1024) {
        for (int32_t w = week; w <= week + 1; w++) {
            setUp();
            const pel_time_t toe = pel_time_from_week(w, 7200.0);
            support_ephemeris(&eph, PEL_SYS_GPS, 3);
            eph.toe_ns = eph.toc_ns = toe;
            pel_receiver_set_time(&rx, toe + 1800 * PEL_NS_PER_S);
            const size_t n = pel_rtcm3_encode_ephemeris(&eph, frame, sizeof frame);
            TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPHEMERIS));
            TEST_ASSERT_EQUAL_INT64(toe, rx.ephemeris.toe_ns);
        }
    }
}

/* Found by fuzz_rtcm3_ephemeris: 13 bits of BeiDou week around an unknown time gave orbits of years before Christ, and they
 * became the stream's own time. */
static void an_orbit_of_a_week_that_cannot_be_does_not_become_the_time(void)
{
    pel_ephemeris_t eph;
    support_ephemeris(&eph, PEL_SYS_BDS, 20);
    const size_t n = pel_rtcm3_encode_ephemeris(&eph, frame, sizeof frame);
    pel_bits_put(frame + 3, 12 + 6, 13, 5400);
    (void)seal_rtcm3(n - 6u);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPHEMERIS));
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.bad_value);
    TEST_ASSERT_EQUAL_INT64(0, rx.t_approx_ns);
}

/* Found by the proof time_order: near the last nanosecond of 64 bits the sums that order samples overflowed. */
static void increments_and_marks_at_the_end_of_time_are_refused(void)
{
    const pel_imu_t imu = {.t_ns = T0, .dt_s = 0.01, .upsilon_ib_b = {0.0, 0.0, 0.098}};
    size_t n = pel_imu_encode(&imu, frame, sizeof frame);
    pel_le_put(frame + 6, 8, INT64_MAX - 1);
    seal_pelorus(n - PEL_OUT_OVERHEAD);
    TEST_ASSERT_EQUAL_INT(0, push_imu(n, PEL_IMU_SAMPLE));
    n = pel_event_mark_encode(T0, 1, frame, sizeof frame);
    pel_le_put(frame + 6, 8, INT64_MAX);
    seal_pelorus(n - PEL_OUT_OVERHEAD);
    TEST_ASSERT_EQUAL_INT(0, push_imu(n, PEL_IMU_EVENT_MARK));
    TEST_ASSERT_EQUAL_UINT32(2, imu_stream.counters.bad_value);
    TEST_ASSERT_EQUAL_size_t(0, pel_event_mark_encode(INT64_MAX, 1, frame, sizeof frame));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(descriptor_lengths_of_1033_beyond_the_message_do_no_harm);
    RUN_TEST(a_clock_that_shows_62_28_15_tells_no_time);
    RUN_TEST(times_beyond_their_range_are_refused);
    RUN_TEST(an_epoch_1024_weeks_ago_is_counted_and_the_stream_goes_on);
    RUN_TEST(ten_bits_of_week_are_right_on_both_sides_of_every_roll_over);
    RUN_TEST(an_orbit_of_a_week_that_cannot_be_does_not_become_the_time);
    RUN_TEST(increments_and_marks_at_the_end_of_time_are_refused);
    return UNITY_END();
}

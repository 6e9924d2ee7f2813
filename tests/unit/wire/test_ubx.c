/* UBX messages field by field: RXM-RAWX and NAV-PVT at their limits, and what goes to whom. */
#include <math.h>
#include <string.h>
#include <time.h>

#include "../../../firmware/src/wire/framing.h"
#include "support_wire.h"
#include "unity.h"

#define DEG (3.14159265358979323846 / 180.0)
#define S   PEL_NS_PER_S

static pel_receiver_t rx;
static pel_epoch_t epoch;
static uint8_t frame[PEL_MAX_FRAME_BYTES];
static uint8_t *const payload = frame + 6;

void setUp(void)
{
    pel_receiver_init(&rx);
    pel_receiver_set_time(&rx, T0);
}
void tearDown(void) {}

/* The frame again after its payload was changed. */
static int push_changed(size_t n, pel_rx_event_t kind)
{
    TEST_ASSERT_EQUAL_size_t(n, pel_ubx_seal(frame[2], frame[3], n - 8u, frame, sizeof frame));
    return support_push(&rx, frame, n, kind);
}

static size_t rawx(pel_time_t t)
{
    support_epoch(&epoch, t, PEL_SYS_GPS, 3);
    return pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame);
}

/* ---- dispatch -------------------------------------------------------------------------------------------------------- */

static void messages_of_other_classes_and_numbers_are_unknown(void)
{
    static const uint8_t OTHER[][2] = {{0x02, 0x14}, {0x02, 0x07}, {0x01, 0x15}, {0x01, 0x13},
                                       {0x01, 0x06}, {0x0A, 0x15}, {0x0A, 0x13}, {0x0A, 0x07}};
    for (size_t i = 0; i < sizeof OTHER / sizeof OTHER[0]; i++) {
        memset(frame, 0, 200);
        const size_t n = pel_ubx_seal(OTHER[i][0], OTHER[i][1], 92, frame, sizeof frame);
        (void)support_push(&rx, frame, n, PEL_RX_NONE);
        TEST_ASSERT_EQUAL_UINT32(i + 1, rx.counters.unknown);
    }
    TEST_ASSERT_EQUAL_UINT32(0, rx.counters.frames);
}

/* ---- RXM-RAWX -------------------------------------------------------------------------------------------------------- */

static void a_number_of_measurements_that_is_not_the_lengths_is_refused(void)
{
    for (int off = -1; off <= 1; off++) {
        setUp();
        const size_t n = rawx(T0);
        payload[11] = (uint8_t)(payload[11] + off);
        TEST_ASSERT_EQUAL_INT((off == 0) ? 1 : 0, push_changed(n, PEL_RX_EPOCH));
        TEST_ASSERT_EQUAL_UINT32((off == 0) ? 0 : 1, rx.counters.bad_length);
    }
}

/* The first signal of three satellites: which of its parts are valid, and why it may be left out. */
static void a_signals_status_says_what_of_it_is_valid(void)
{
    static const struct {
        uint8_t sv, track, cp_stdev;
        bool doppler;
        uint16_t n;
        uint8_t flags;
        uint32_t bad_value;
    } CASE[] = {
        {1, 0x07, 1, true, 6, PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER, 0},
        {1, 0x03, 1, true, 6, PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER | PEL_OBS_HALF_CYCLE, 0},
        {1, 0x07, 1, false, 6, PEL_OBS_CODE | PEL_OBS_PHASE, 0},
        {1, 0x06, 1, true, 6, PEL_OBS_PHASE | PEL_OBS_DOPPLER, 0},
        {1, 0x05, 1, true, 6, PEL_OBS_CODE | PEL_OBS_DOPPLER, 0},
        {1, 0x07, 15, true, 6, PEL_OBS_CODE | PEL_OBS_DOPPLER, 0},
        {1, 0x07, 0xF1, true, 6, PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER, 0}, /* the upper bits are others' */
        {1, 0x04, 1, true, 5, 0, 0},                                                 /* a Doppler alone is none */
        {0, 0x07, 1, true, 5, 0, 1},
        {33, 0x07, 1, true, 5, 0, 1},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        setUp();
        const size_t n = rawx(T0);
        uint8_t *const m = payload + 16;
        if (!CASE[i].doppler) { pel_le_put_f32(m + 16, -0.0f); }
        m[21] = CASE[i].sv;
        m[28] = CASE[i].cp_stdev;
        m[30] = CASE[i].track;
        TEST_ASSERT_EQUAL_INT(1, push_changed(n, PEL_RX_EPOCH));
        TEST_ASSERT_EQUAL_UINT16(CASE[i].n, rx.epoch.n);
        if (CASE[i].n == 6) { TEST_ASSERT_EQUAL_HEX8(CASE[i].flags, rx.epoch.obs[0].flags); }
        TEST_ASSERT_EQUAL_UINT32(CASE[i].bad_value, rx.counters.bad_value);
    }
}

static void parts_that_are_not_there_are_sent_as_none(void)
{
    static const uint8_t FLAGS[] = {PEL_OBS_CODE, PEL_OBS_PHASE, PEL_OBS_CODE | PEL_OBS_DOPPLER};
    for (size_t i = 0; i < 3; i++) {
        setUp();
        support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
        epoch.obs[0].flags = FLAGS[i];
        epoch.obs[0].lock_ms = (i == 0) ? 65534u : 65536u;
        const size_t n = pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame);
        TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
        TEST_ASSERT_EQUAL_HEX8(FLAGS[i], rx.epoch.obs[0].flags);
        TEST_ASSERT_EQUAL_UINT32((i == 0) ? 65534u : 65535u, rx.epoch.obs[0].lock_ms); /* saturates */
    }
}

static void satellites_of_sbas_are_numbered_from_120(void)
{
    support_epoch(&epoch, T0, PEL_SYS_SBS, 2);
    for (int i = 0; i < 4; i++) { epoch.obs[i].carrier = PEL_CARRIER_L1; }
    epoch.obs[1].prn = 39;
    epoch.obs[2].prn = 2;
    epoch.n = 3;
    size_t n = pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame);
    TEST_ASSERT_EQUAL_UINT8(120, payload[16 + 21]);
    TEST_ASSERT_EQUAL_UINT8(158, payload[16 + 32 + 21]);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT16(3, rx.epoch.n);
    TEST_ASSERT_EQUAL_UINT8(39, rx.epoch.obs[1].prn);
    setUp();
    payload[16 + 21] = 119;
    payload[16 + 32 + 21] = 159;
    TEST_ASSERT_EQUAL_INT(1, push_changed(n, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT16(1, rx.epoch.n);
    TEST_ASSERT_EQUAL_UINT32(2, rx.counters.bad_value);
}

/* B1I and B3I are D1 of most satellites and D2 of the geostationary ones; L1 has no such difference. */
static void signals_of_beidou_follow_the_satellites_orbit(void)
{
    static const struct {
        uint8_t prn, carrier;
        char code;
        uint8_t sig_id;
    } CASE[] = {{5, PEL_CARRIER_B1I, 'I', 1},  {6, PEL_CARRIER_B1I, 'I', 0},   {58, PEL_CARRIER_B1I, 'I', 0},
                {59, PEL_CARRIER_B1I, 'I', 1}, {63, PEL_CARRIER_B3I, 'I', 10}, {20, PEL_CARRIER_B3I, 'I', 4},
                {3, PEL_CARRIER_L1, 'P', 5},   {3, PEL_CARRIER_L1, 'D', 6},    {3, PEL_CARRIER_E5B, 'I', 3}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        support_epoch(&epoch, T0, PEL_SYS_BDS, 1);
        epoch.n = 1;
        epoch.obs[0].prn = CASE[i].prn;
        epoch.obs[0].carrier = CASE[i].carrier;
        epoch.obs[0].code = CASE[i].code;
        TEST_ASSERT_EQUAL_size_t(8 + 16 + 32, pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame));
        TEST_ASSERT_EQUAL_UINT8(CASE[i].sig_id, payload[16 + 22]);
    }
}

static void signals_without_a_number_and_impossible_ones_are_left_out(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 3);
    epoch.obs[1].carrier = PEL_CARRIER_B1I;
    epoch.obs[3].P_m = 1e9;
    TEST_ASSERT_EQUAL_size_t(8 + 16 + 4 * 32, pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame));
    TEST_ASSERT_EQUAL_UINT8(4, payload[11]);
    epoch.n = 1;
    TEST_ASSERT_EQUAL_size_t(8 + 16 + 32, pel_ubx_encode_rawx(&epoch, 18, frame, 8 + 16 + 32));
    epoch.n = PEL_MAX_OBS; /* the rest of the array is empty */
    TEST_ASSERT_EQUAL_size_t(8 + 16 + 4 * 32, pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame));
    epoch.n = PEL_MAX_OBS + 1;
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame));
    support_epoch(&epoch, -1, PEL_SYS_GPS, 3);
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame));
    support_epoch(&epoch, 0, PEL_SYS_GPS, 0);
    TEST_ASSERT_EQUAL_size_t(24, pel_ubx_encode_rawx(&epoch, 18, frame, 24));
}

static int push_msm(pel_time_t t, pel_sys_t sys, bool more)
{
    support_epoch(&epoch, t, sys, 2);
    const size_t n = pel_rtcm3_encode_msm(&epoch, sys, 7, 1, more, frame, sizeof frame);
    return support_push(&rx, frame, n, PEL_RX_EPOCH);
}

static void rawx_beside_an_msm_of_gps_is_not_used_for_a_minute(void)
{
    static const struct {
        int64_t after_ms;
        int events;
        uint32_t duplicate, back;
    } CASE[] = {{1000, 0, 1, 0}, {59999, 0, 1, 0}, {60000, 1, 0, 0}, {-59999, 0, 1, 0}, {-60000, 0, 0, 1}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        setUp();
        TEST_ASSERT_EQUAL_INT(1, push_msm(T0, PEL_SYS_GPS, false));
        const size_t n = rawx(T0 + CASE[i].after_ms * PEL_NS_PER_MS);
        TEST_ASSERT_EQUAL_INT(CASE[i].events, support_push(&rx, frame, n, PEL_RX_EPOCH));
        TEST_ASSERT_EQUAL_UINT32(CASE[i].duplicate, rx.counters.duplicate);
        TEST_ASSERT_EQUAL_UINT32(CASE[i].back, rx.counters.time_back);
    }
}

/* While the same epoch arrives as messages of other systems, RAWX is complete and takes its place; one of another time does not. */
static void rawx_replaces_the_epoch_being_collected_if_it_is_the_same(void)
{
    static const struct {
        int64_t after_ms;
        int events;
        uint16_t n; /* signals of the (first) epoch given */
        uint32_t duplicate, back;
    } CASE[] = {{0, 1, 6, 1, 0}, {5, 1, 6, 1, 0}, {-5, 1, 6, 1, 0}, {6, 1, 4, 0, 0}, {-6, 0, 4, 0, 1}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        setUp();
        TEST_ASSERT_EQUAL_INT(0, push_msm(T0, PEL_SYS_GAL, true));
        const size_t n = rawx(T0 + CASE[i].after_ms * PEL_NS_PER_MS);
        TEST_ASSERT_EQUAL_INT(CASE[i].events, support_push(&rx, frame, n, PEL_RX_EPOCH));
        TEST_ASSERT_EQUAL_UINT16(CASE[i].n, rx.epoch.n);
        TEST_ASSERT_EQUAL_UINT32(CASE[i].duplicate, rx.counters.duplicate);
        TEST_ASSERT_EQUAL_UINT32(CASE[i].back, rx.counters.time_back);
        if (CASE[i].after_ms == 6) { /* it waited: counted once, and given with the next byte */
            TEST_ASSERT_EQUAL_UINT32(1, rx.counters.frames);
            TEST_ASSERT_EQUAL_INT(PEL_RX_EPOCH, pel_receiver_push(&rx, 0));
            TEST_ASSERT_EQUAL_UINT16(6, rx.epoch.n);
            TEST_ASSERT_EQUAL_UINT32(2, rx.counters.frames);
        }
    }
}

/* ---- NAV-PVT --------------------------------------------------------------------------------------------------------- */

static pel_pvt_t fix_at(pel_time_t t)
{
    const pel_pvt_t p = {.t_ns = t, .fix = 3, .carrier_soln = 2, .n_sat = 17, .lat_rad = 0.5, .lon_rad = -2.0};
    return p;
}

#define IN(change)                                                                                                     \
    do {                                                                                                               \
        pel_pvt_t p = fix_at(T0);                                                                                      \
        change;                                                                                                        \
        const size_t n = pel_ubx_encode_pvt(&p, frame, sizeof frame);                                                  \
        TEST_ASSERT_EQUAL_size_t_MESSAGE(100, n, #change);                                                             \
        TEST_ASSERT_EQUAL_INT_MESSAGE(1, support_push(&rx, frame, n, PEL_RX_PVT), #change);                            \
    } while (0)
#define OUT(change)                                                                                                    \
    do {                                                                                                               \
        pel_pvt_t p = fix_at(T0);                                                                                      \
        change;                                                                                                        \
        TEST_ASSERT_EQUAL_size_t_MESSAGE(0, pel_ubx_encode_pvt(&p, frame, sizeof frame), #change);                     \
    } while (0)

static void positions_and_velocities_end_at_the_poles_and_at_ten_kilometres_a_second(void)
{
    const double nan = (double)NAN;
    IN(p.lat_rad = 90.0 * DEG);
    IN(p.lat_rad = -90.0 * DEG);
    IN(p.lon_rad = 180.0 * DEG);
    IN(p.lon_rad = -180.0 * DEG);
    OUT(p.lat_rad = 90.0000001 * DEG);
    OUT(p.lat_rad = -90.0000001 * DEG);
    OUT(p.lon_rad = 180.0000001 * DEG);
    OUT(p.lon_rad = -180.0000001 * DEG);
    OUT(p.lat_rad = nan);
    OUT(p.lon_rad = nan);
    for (int i = 0; i < 3; i++) {
        IN(p.v_ned[i] = 9999.999);
        IN(p.v_ned[i] = -9999.999);
        OUT(p.v_ned[i] = 1e4);
        OUT(p.v_ned[i] = -1e4);
        OUT(p.v_ned[i] = nan);
    }
    IN(p.height_m = -19999.999);
    OUT(p.height_m = -2e4);
    OUT(p.height_m = 1e7);
    OUT(p.height_m = nan);
    OUT(p.t_ns = -1);
    pel_pvt_t p = fix_at(0);
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_pvt(&p, frame, 99));
    p.fix = 1; /* dead reckoning only: the fix is not valid */
    TEST_ASSERT_EQUAL_size_t(100, pel_ubx_encode_pvt(&p, frame, 100));
    TEST_ASSERT_EQUAL_HEX8(0x80, payload[21]);
    p.fix = 2;
    TEST_ASSERT_EQUAL_size_t(100, pel_ubx_encode_pvt(&p, frame, 100));
    TEST_ASSERT_EQUAL_HEX8(0x81, payload[21]);
}

/* The same limits when the numbers come in. */
static void what_no_place_can_be_is_refused(void)
{
    static const struct {
        int at;
        int32_t value;
        bool good;
    } CASE[] = {
        {28, 900000000, true},  {28, 900000001, false},  {28, -900000000, true},  {28, -900000001, false},
        {24, 1800000000, true}, {24, 1800000001, false}, {24, -1800000000, true}, {24, -1800000001, false},
        {32, -19999999, true},  {32, -20000000, false},  {48, 10000000, false},   {52, -10000000, false},
        {56, 9999999, true},    {0, 604799999, true},    {0, 604800000, false},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        const pel_pvt_t p = fix_at(T0);
        setUp();
        const size_t n = pel_ubx_encode_pvt(&p, frame, sizeof frame);
        pel_le_put(payload + CASE[i].at, 4, (uint32_t)CASE[i].value);
        TEST_ASSERT_EQUAL_INT(CASE[i].good ? 1 : 0, push_changed(n, PEL_RX_PVT));
        TEST_ASSERT_EQUAL_UINT32(CASE[i].good ? 0 : 1, rx.counters.bad_value);
    }
}

static void a_date_is_taken_up_to_the_limits_of_its_fields(void)
{
    static const struct {
        int at;
        unsigned value;
        bool good;
    } CASE[] = {
        {4, 1998, false}, {4, 1999, true}, {4, 2094, true}, {4, 2095, false}, {6, 0, false},
        {6, 1, true},     {6, 12, true},   {6, 13, false},  {7, 0, false},    {7, 1, true},
        {7, 31, true},    {7, 32, false},  {8, 0, true},    {8, 23, true},    {8, 24, false},
        {9, 59, true},    {9, 60, false},  {10, 60, true},  {10, 61, false},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        for (int valid = 0; valid < 2; valid++) { /* a date said to be not valid is not looked at */
            const pel_pvt_t p = fix_at(T0);
            setUp();
            const size_t n = pel_ubx_encode_pvt(&p, frame, sizeof frame);
            pel_le_put(payload + CASE[i].at, (CASE[i].at == 4) ? 2 : 1, CASE[i].value);
            payload[11] = (uint8_t)(0x06 | valid);
            const bool good = CASE[i].good || valid == 0;
            TEST_ASSERT_EQUAL_INT(good ? 1 : 0, push_changed(n, PEL_RX_PVT));
            TEST_ASSERT_EQUAL_UINT32(good ? 0 : 1, rx.counters.bad_value);
        }
    }
}

/* Only the date tells the week: without it the stream's own time must. */
static void the_week_comes_from_the_date_or_from_the_stream(void)
{
    const pel_pvt_t p = fix_at(T0 + 5 * S);
    const size_t n = pel_ubx_encode_pvt(&p, frame, sizeof frame);
    payload[11] = 0x06;
    pel_receiver_init(&rx);
    TEST_ASSERT_EQUAL_INT(0, push_changed(n, PEL_RX_PVT));
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.unknown);
    pel_receiver_set_time(&rx, T0 - 2 * 86400 * S);
    TEST_ASSERT_EQUAL_INT(1, push_changed(n, PEL_RX_PVT));
    TEST_ASSERT_EQUAL_INT64(T0 + 5 * S, rx.pvt.t_ns);
    TEST_ASSERT_EQUAL_INT64(T0 - 2 * 86400 * S, rx.t_approx_ns); /* a time that is there stays */

    pel_receiver_init(&rx);
    payload[11] = 0x07;
    TEST_ASSERT_EQUAL_INT(1, push_changed(n, PEL_RX_PVT));
    TEST_ASSERT_EQUAL_INT64(T0 + 5 * S, rx.pvt.t_ns);
    TEST_ASSERT_EQUAL_INT64(T0 + 5 * S, rx.t_approx_ns);
}

/* Every day of 1999 to 2048 against the C library's calendar, and back. */
static void dates_are_those_of_the_calendar(void)
{
    for (int64_t day = 6995; day < 25200; day++) {
        const pel_pvt_t p = fix_at((day * 86400 + 86399) * S);
        const time_t unix_s = (time_t)(p.t_ns / S - pel_time_leap_s(p.t_ns) + 315964800);
        struct tm tm;
        const size_t n = pel_ubx_encode_pvt(&p, frame, sizeof frame);
        TEST_ASSERT_NOT_NULL(gmtime_r(&unix_s, &tm));
        TEST_ASSERT_EQUAL_UINT32(tm.tm_year + 1900, pel_le_u(payload + 4, 2));
        TEST_ASSERT_EQUAL_UINT8(tm.tm_mon + 1, payload[6]);
        TEST_ASSERT_EQUAL_UINT8(tm.tm_mday, payload[7]);
        TEST_ASSERT_EQUAL_UINT8(tm.tm_hour, payload[8]);
        TEST_ASSERT_EQUAL_UINT8(tm.tm_min, payload[9]);
        TEST_ASSERT_EQUAL_UINT8(tm.tm_sec, payload[10]);
        TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_PVT));
        TEST_ASSERT_EQUAL_INT64(p.t_ns, rx.pvt.t_ns);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(messages_of_other_classes_and_numbers_are_unknown);
    RUN_TEST(a_number_of_measurements_that_is_not_the_lengths_is_refused);
    RUN_TEST(a_signals_status_says_what_of_it_is_valid);
    RUN_TEST(parts_that_are_not_there_are_sent_as_none);
    RUN_TEST(satellites_of_sbas_are_numbered_from_120);
    RUN_TEST(signals_of_beidou_follow_the_satellites_orbit);
    RUN_TEST(signals_without_a_number_and_impossible_ones_are_left_out);
    RUN_TEST(rawx_beside_an_msm_of_gps_is_not_used_for_a_minute);
    RUN_TEST(rawx_replaces_the_epoch_being_collected_if_it_is_the_same);
    RUN_TEST(positions_and_velocities_end_at_the_poles_and_at_ten_kilometres_a_second);
    RUN_TEST(what_no_place_can_be_is_refused);
    RUN_TEST(a_date_is_taken_up_to_the_limits_of_its_fields);
    RUN_TEST(the_week_comes_from_the_date_or_from_the_stream);
    RUN_TEST(dates_are_those_of_the_calendar);
    return UNITY_END();
}

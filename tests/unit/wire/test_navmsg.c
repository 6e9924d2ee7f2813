/* From the numbers of a navigation message to an ephemeris and back: ranges, accuracies, weeks, Moscow's days. */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/wire/navmsg.h"
#include "support_wire.h"
#include "unity.h"

#define WEEK PEL_NS_PER_WEEK
#define S    PEL_NS_PER_S
#define DAY  (86400 * S)

static pel_receiver_t rx;
static uint8_t frame[256];

void setUp(void)
{
    pel_receiver_init(&rx);
    pel_receiver_set_time(&rx, T0);
}
void tearDown(void) {}

/* ---- Kepler elements -------------------------------------------------------------------------------------------------- */

#define CHECK(verdict, change)                                                                                         \
    do {                                                                                                               \
        pel_ephemeris_t e;                                                                                             \
        pel_nav_raw_t raw;                                                                                             \
        pel_time_t ref = T0;                                                                                           \
        support_ephemeris(&e, PEL_SYS_GPS, 9);                                                                         \
        TEST_ASSERT_TRUE(pel_eph_to_raw(&e, T0, &raw));                                                                \
        change;                                                                                                        \
        TEST_ASSERT_EQUAL_MESSAGE(verdict, pel_eph_from_raw(&e, &raw, true, ref), #change);                            \
    } while (0)
#define IN(change)  CHECK(true, change)
#define OUT(change) CHECK(false, change)

static void a_message_is_taken_up_to_its_limits_and_not_beyond(void)
{
    const double nan = (double)NAN;
    IN((void)ref);
    IN(e.e = 0.0);
    OUT(e.e = -1e-9);
    IN(e.e = nextafter(0.5, 0.0));
    OUT(e.e = 0.5);
    OUT(e.e = nan);
    IN(e.sqrt_a = nextafter(4500.0, 5000.0));
    OUT(e.sqrt_a = 4500.0);
    IN(e.sqrt_a = nextafter(7500.0, 0.0));
    OUT(e.sqrt_a = 7500.0);
    OUT(e.sqrt_a = nan);
    IN(raw.prn = 1);
    IN(raw.prn = 32);
    OUT(raw.prn = 0);
    OUT(raw.prn = 33);
    OUT(e.sys = PEL_SYS_GLO);
    OUT(e.sys = PEL_SYS_SBS);
    OUT(e.sys = PEL_N_SYS);
    IN(raw.toe = 37799); /* 16 s below a week */
    OUT(raw.toe = 37800);
    IN(raw.toc = 37799);
    OUT(raw.toc = 37800);
    OUT(raw.week = 999; ref = 999 * WEEK);
    IN(raw.week = 1000; ref = 1000 * WEEK);
    IN(raw.week = 6000 % 1024; ref = 6000 * WEEK);
    OUT(raw.week = 6001 % 1024; ref = 6001 * WEEK);
}

#undef CHECK
#define CHECK(verdict, change)                                                                                         \
    do {                                                                                                               \
        pel_ephemeris_t e;                                                                                             \
        pel_nav_raw_t raw;                                                                                             \
        pel_time_t t = T0;                                                                                             \
        support_ephemeris(&e, PEL_SYS_GPS, 9);                                                                         \
        change;                                                                                                        \
        TEST_ASSERT_EQUAL_MESSAGE(verdict, pel_eph_to_raw(&e, t, &raw), #change);                                      \
    } while (0)

static void what_has_no_representation_is_not_sent(void)
{
    IN((void)t);
    OUT(e.sys = PEL_SYS_SBS);
    OUT(e.e = 0.5);
    OUT(e.prn = 33);
    IN(e.toe_ns = 0);
    OUT(e.toe_ns = -16 * S);
    OUT(e.toe_ns += S);
    IN(e.toc_ns = 0);
    OUT(e.toc_ns = -16 * S);
    OUT(e.toc_ns += S);
    IN(t = 0);
    OUT(t = -1);
    /* the weeks of Galileo and BeiDou begin later */
    IN(e.sys = PEL_SYS_GAL; e.toe_ns = e.toc_ns = t = 1024 * WEEK);
    OUT(e.sys = PEL_SYS_GAL; e.toe_ns = e.toc_ns = 1024 * WEEK; t = 1024 * WEEK - 1);
    IN(e.sys = PEL_SYS_BDS; e.toe_ns = e.toc_ns = t = 1356 * WEEK + 14 * S);
    OUT(e.sys = PEL_SYS_BDS; e.toe_ns = e.toc_ns = 1356 * WEEK + 14 * S; t = 1356 * WEEK + 13 * S);
}

/* IS-GPS-200 20.3.3.3.1.3 and Galileo OS SIS ICD table 89. */
static void accuracies_are_those_of_the_tables(void)
{
    static const struct {
        pel_sys_t sys;
        uint32_t index;
        float sd_m;
    } CASE[] = {
        {PEL_SYS_GPS, 0, 2.0f},     {PEL_SYS_GPS, 6, 16.0f},     {PEL_SYS_GPS, 14, 4096.0f},
        {PEL_SYS_GPS, 15, 6144.0f}, {PEL_SYS_GPS, 16, 6144.0f},  {PEL_SYS_GAL, 0, 0.0f},
        {PEL_SYS_GAL, 49, 0.49f},   {PEL_SYS_GAL, 50, 0.5f},     {PEL_SYS_GAL, 74, 0.98f},
        {PEL_SYS_GAL, 75, 1.0f},    {PEL_SYS_GAL, 99, 1.96f},    {PEL_SYS_GAL, 100, 2.0f},
        {PEL_SYS_GAL, 125, 6.0f},   {PEL_SYS_GAL, 126, 6144.0f}, {PEL_SYS_GAL, 255, 6144.0f},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        pel_ephemeris_t e;
        pel_nav_raw_t raw;
        support_ephemeris(&e, CASE[i].sys, 9);
        TEST_ASSERT_TRUE(pel_eph_to_raw(&e, T0, &raw));
        raw.ura = CASE[i].index;
        TEST_ASSERT_TRUE(pel_eph_from_raw(&e, &raw, true, T0));
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, CASE[i].sd_m, e.sd_ura_m);
    }
}

static void an_accuracy_is_never_sent_better_than_it_is(void)
{
    static const struct {
        pel_sys_t sys;
        float sd_m;
        uint32_t index;
    } CASE[] = {
        {PEL_SYS_GPS, 0.0f, 0},     {PEL_SYS_GPS, 2.0f, 0},  {PEL_SYS_GPS, 2.1f, 1},    {PEL_SYS_GPS, 4096.0f, 14},
        {PEL_SYS_GPS, 4097.0f, 15}, {PEL_SYS_GAL, 0.0f, 0},  {PEL_SYS_GAL, 0.491f, 50}, {PEL_SYS_GAL, 6.0f, 125},
        {PEL_SYS_GAL, 6.1f, 255},   {PEL_SYS_QZS, 5e3f, 15}, {PEL_SYS_BDS, 5e3f, 15},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        pel_ephemeris_t e;
        pel_nav_raw_t raw;
        support_ephemeris(&e, CASE[i].sys, 9);
        e.sd_ura_m = CASE[i].sd_m;
        TEST_ASSERT_TRUE(pel_eph_to_raw(&e, T0, &raw));
        TEST_ASSERT_EQUAL_UINT32(CASE[i].index, raw.ura);
    }
}

static void the_fit_interval_is_gps_own(void)
{
    static const struct {
        pel_sys_t sys;
        float fit_s[2]; /* without and with the flag of a longer one */
    } CASE[] = {{PEL_SYS_GPS, {7200.0f, 10800.0f}},
                {PEL_SYS_QZS, {7200.0f, 7200.0f}},
                {PEL_SYS_GAL, {14400.0f, 14400.0f}},
                {PEL_SYS_BDS, {14400.0f, 14400.0f}}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        for (uint32_t flag = 0; flag < 2; flag++) {
            pel_ephemeris_t e;
            pel_nav_raw_t raw;
            support_ephemeris(&e, CASE[i].sys, 9);
            e.fit_s = (flag != 0) ? 7201.0f : 7200.0f;
            TEST_ASSERT_TRUE(pel_eph_to_raw(&e, T0, &raw));
            TEST_ASSERT_EQUAL_UINT32(flag, raw.fit);
            TEST_ASSERT_TRUE(pel_eph_from_raw(&e, &raw, true, T0));
            TEST_ASSERT_EQUAL_FLOAT(CASE[i].fit_s[flag], e.fit_s);
        }
    }
}

/* Without a time of transmission the week may be that of now, a toe on the other side of the edge. */
static void a_toe_across_the_edge_of_the_week_is_found_without_a_time_of_transmission(void)
{
    static const struct {
        int32_t week;                 /* as sent */
        int64_t toe_s, now_s, want_s; /* now and want from the start of week 2301 */
    } CASE[] = {
        {2301, 7200, 3600, 7200},
        {2300, 7200, -3600, 7200},             /* the week of transmission beside a toe of the next */
        {2301, 597600, 3600, 597600 - 604800}, /* and of one beside a toe of the one before */
        {2300, 597600, -3600, 597600 - 604800},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        pel_ephemeris_t e;
        pel_nav_raw_t raw;
        support_ephemeris(&e, PEL_SYS_GPS, 9);
        TEST_ASSERT_TRUE(pel_eph_to_raw(&e, T0, &raw));
        raw.week = (uint32_t)(CASE[i].week % 1024);
        raw.toe = raw.toc = (uint32_t)(CASE[i].toe_s / 16);
        TEST_ASSERT_TRUE(pel_eph_from_raw(&e, &raw, false, 2301 * WEEK + CASE[i].now_s * S));
        TEST_ASSERT_EQUAL_INT64(2301 * WEEK + CASE[i].want_s * S, e.toe_ns);
        TEST_ASSERT_EQUAL_INT64(e.toe_ns, e.toc_ns);
    }
}

static void health_bits_of_qzss_that_speak_of_other_signals_do_not_count(void)
{
    pel_ephemeris_t e;
    pel_nav_raw_t raw;
    for (int sys = 0; sys <= PEL_SYS_QZS; sys += PEL_SYS_QZS) {
        support_ephemeris(&e, (pel_sys_t)sys, 9);
        TEST_ASSERT_TRUE(pel_eph_to_raw(&e, T0, &raw));
        raw.health = 0x21;
        TEST_ASSERT_TRUE(pel_eph_from_raw(&e, &raw, true, T0));
        TEST_ASSERT_EQUAL_HEX8((sys == PEL_SYS_QZS) ? 0x20 : 0x21, e.health);
    }
}

/* ---- encoders --------------------------------------------------------------------------------------------------------- */

static size_t rtcm(const pel_ephemeris_t *e, size_t cap)
{
    return pel_rtcm3_encode_ephemeris(e, frame, cap);
}

static void fields_too_large_buffers_too_small_and_parts_that_are_none_give_no_frame(void)
{
    static const struct {
        pel_sys_t sys;
        uint8_t prn;
        int parts, with_crs; /* the part that holds crs */
    } CASE[] = {{PEL_SYS_GPS, 9, 3, 2},
                {PEL_SYS_QZS, 9, 3, 2},
                {PEL_SYS_GAL, 9, 5, 3},
                {PEL_SYS_BDS, 20, 3, 2},
                {PEL_SYS_BDS, 3, 10, 7}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        pel_ephemeris_t e;
        support_ephemeris(&e, CASE[i].sys, CASE[i].prn);
        TEST_ASSERT_EQUAL_INT(CASE[i].parts, pel_ubx_sfrbx_parts(&e));
        TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 0, T0, frame, sizeof frame));
        TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, CASE[i].parts + 1, T0, frame, sizeof frame));
        TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 1, T0, frame, 55));
        TEST_ASSERT_GREATER_THAN_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 1, T0, frame, 56));
        TEST_ASSERT_EQUAL_size_t(0, rtcm(&e, 69));
        TEST_ASSERT_GREATER_THAN_size_t(0, rtcm(&e, 70));
        e.crs = -5000.0;
        TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, CASE[i].with_crs, T0, frame, sizeof frame));
        TEST_ASSERT_EQUAL_size_t(0, rtcm(&e, sizeof frame));
        support_ephemeris(&e, CASE[i].sys, CASE[i].prn);
        e.M0 = (double)NAN; /* angles of 32 bits wrap, but not this one */
        TEST_ASSERT_EQUAL_size_t(0, rtcm(&e, sizeof frame));
    }
    pel_ephemeris_t e;
    support_ephemeris(&e, PEL_SYS_SBS, 9);
    TEST_ASSERT_EQUAL_INT(0, pel_ubx_sfrbx_parts(&e));
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 1, T0, frame, sizeof frame));
    TEST_ASSERT_EQUAL_size_t(0, rtcm(&e, sizeof frame));
}

/* A layout longer than its buffer, in both directions. */
static void a_message_that_ends_early_fails_as_a_whole(void)
{
    for (size_t n = PEL_LNAV_BYTES - 1; n <= PEL_LNAV_BYTES; n++) {
        pel_ephemeris_t e;
        pel_nav_raw_t raw;
        pel_bitio_t io;
        support_ephemeris(&e, PEL_SYS_GPS, 9);
        TEST_ASSERT_TRUE(pel_eph_to_raw(&e, T0, &raw));
        pel_bitio_write(&io, frame, n);
        pel_lnav_fields(&io, 2, &e, &raw);
        TEST_ASSERT_EQUAL(n < PEL_LNAV_BYTES, pel_bitio_failed(&io));
        TEST_ASSERT_FALSE(io.w.out_of_range);
        pel_bitio_read(&io, frame, n);
        pel_lnav_fields(&io, 2, &e, &raw);
        TEST_ASSERT_EQUAL(n < PEL_LNAV_BYTES, pel_bitio_failed(&io));
    }
}

static void an_angle_keeps_its_value_through_any_number_of_turns(void)
{
    pel_ephemeris_t e;
    support_ephemeris(&e, PEL_SYS_GPS, 9);
    const double M0 = e.M0;
    e.M0 += 2.0 * 3.1415926535898 * 5.0;
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, rtcm(&e, sizeof frame), PEL_RX_EPHEMERIS));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, M0, rx.ephemeris.M0);
}

static void an_ionosphere_needs_a_satellite_a_time_and_values_that_fit(void)
{
    const pel_klobuchar_t good = {.valid = true, .alpha = {1e-8f}, .beta = {1e5f}};
    pel_klobuchar_t k = good;
    TEST_ASSERT_EQUAL_size_t(56, pel_ubx_encode_sfrbx_klobuchar(&k, 1, 0, frame, 56));
    TEST_ASSERT_EQUAL_size_t(56, pel_ubx_encode_sfrbx_klobuchar(&k, 32, T0, frame, 56));
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_klobuchar(&k, 1, T0, frame, 55));
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_klobuchar(&k, 0, T0, frame, 56));
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_klobuchar(&k, 33, T0, frame, 56));
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_klobuchar(&k, 1, -1, frame, 56));
    k.valid = false;
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_klobuchar(&k, 1, T0, frame, 56));
    k = good;
    k.alpha[0] = 128.0f * 0x1p-30f; /* one more than 8 bits hold */
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_klobuchar(&k, 1, T0, frame, 56));
    k.alpha[0] = 127.0f * 0x1p-30f;
    TEST_ASSERT_EQUAL_size_t(56, pel_ubx_encode_sfrbx_klobuchar(&k, 1, T0, frame, 56));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_message_is_taken_up_to_its_limits_and_not_beyond);
    RUN_TEST(what_has_no_representation_is_not_sent);
    RUN_TEST(accuracies_are_those_of_the_tables);
    RUN_TEST(an_accuracy_is_never_sent_better_than_it_is);
    RUN_TEST(the_fit_interval_is_gps_own);
    RUN_TEST(a_toe_across_the_edge_of_the_week_is_found_without_a_time_of_transmission);
    RUN_TEST(health_bits_of_qzss_that_speak_of_other_signals_do_not_count);
    RUN_TEST(fields_too_large_buffers_too_small_and_parts_that_are_none_give_no_frame);
    RUN_TEST(a_message_that_ends_early_fails_as_a_whole);
    RUN_TEST(an_angle_keeps_its_value_through_any_number_of_turns);
    RUN_TEST(an_ionosphere_needs_a_satellite_a_time_and_values_that_fit);
    return UNITY_END();
}

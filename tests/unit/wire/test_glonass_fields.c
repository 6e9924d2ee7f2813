/* GLONASS numbers at their limits: orbits, channels, days of Moscow and their four years, accuracy and health. */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/wire/navmsg.h"
#include "support_wire.h"
#include "unity.h"

#define S    PEL_NS_PER_S
#define DAY  (86400 * S)
#define TB   (900 * S)
#define LEAP (18 * S)

static uint8_t frame[128];

void setUp(void) {}
void tearDown(void) {}

static pel_ephemeris_t orbit(void)
{
    const pel_ephemeris_t e = {.sys = PEL_SYS_GLO,
                               .prn = 9,
                               .sd_ura_m = 4.0f,
                               .toe_ns = T0 + LEAP, /* T0 begins a quarter of an hour of GPS time */
                               .glo = {.r_e = {2.5e7, 0.0, 0.0}, .v_e = {0.0, 3e3, 0.0}, .k = 1}};
    return e;
}

#define CHECK(verdict, change)                                                                                         \
    do {                                                                                                               \
        pel_ephemeris_t e = orbit();                                                                                   \
        pel_glo_raw_t raw;                                                                                             \
        TEST_ASSERT_TRUE(pel_glo_to_raw(&e, T0, &raw));                                                                \
        change;                                                                                                        \
        TEST_ASSERT_EQUAL_MESSAGE(verdict, pel_glo_from_raw(&e, &raw, T0), #change);                                   \
    } while (0)
#define IN(change)  CHECK(true, change)
#define OUT(change) CHECK(false, change)

static void a_message_is_taken_up_to_its_limits_and_not_beyond(void)
{
    const double nan = (double)NAN;
    IN((void)e);
    for (int i = 0; i < 3; i++) {
        IN(memset(e.glo.r_e, 0, sizeof e.glo.r_e); e.glo.r_e[i] = -24000001.0);
        OUT(memset(e.glo.r_e, 0, sizeof e.glo.r_e); e.glo.r_e[i] = -24000000.0);
        IN(memset(e.glo.r_e, 0, sizeof e.glo.r_e); e.glo.r_e[i] = 26999999.0);
        OUT(memset(e.glo.r_e, 0, sizeof e.glo.r_e); e.glo.r_e[i] = 27000000.0);
        OUT(e.glo.r_e[i] = nan);
        IN(memset(e.glo.v_e, 0, sizeof e.glo.v_e); e.glo.v_e[i] = -2001.0);
        OUT(memset(e.glo.v_e, 0, sizeof e.glo.v_e); e.glo.v_e[i] = -2000.0);
        IN(memset(e.glo.v_e, 0, sizeof e.glo.v_e); e.glo.v_e[i] = 4999.0);
        OUT(memset(e.glo.v_e, 0, sizeof e.glo.v_e); e.glo.v_e[i] = 5000.0);
        OUT(e.glo.v_e[i] = nan);
    }
    IN(e.glo.k = -7);
    OUT(e.glo.k = -8);
    IN(e.glo.k = 6);
    OUT(e.glo.k = 7);
    IN(raw.slot = 1);
    OUT(raw.slot = 0);
    IN(raw.slot = 32);
    OUT(raw.slot = 33);
    IN(raw.t_k = 86370);
    OUT(raw.t_k = 86400);
    IN(raw.t_b = 95);
    OUT(raw.t_b = 96);
    IN(raw.n_t = 1461);
    OUT(raw.n_t = 1462);
}

/* The day in its four years moves the time by at most four days; a number farther away is another week's, and ignored. */
static void a_day_is_believed_within_four_of_the_reference(void)
{
    for (int away = -6; away <= 6; away++) {
        pel_ephemeris_t e = orbit();
        pel_glo_raw_t raw;
        TEST_ASSERT_TRUE(pel_glo_to_raw(&e, T0, &raw));
        raw.n_t = (uint32_t)((int)raw.n_t + away);
        TEST_ASSERT_TRUE(pel_glo_from_raw(&e, &raw, T0));
        const int64_t moved = (away >= -4 && away <= 4) ? away : 0;
        TEST_ASSERT_EQUAL_INT64(orbit().toe_ns + moved * DAY, e.toe_ns);
    }
    pel_ephemeris_t e = orbit();
    pel_glo_raw_t raw;
    TEST_ASSERT_TRUE(pel_glo_to_raw(&e, T0, &raw));
    raw.n_t = 0; /* not told */
    TEST_ASSERT_TRUE(pel_glo_from_raw(&e, &raw, T0 + 10 * 3600 * S));
    TEST_ASSERT_EQUAL_INT64(orbit().toe_ns, e.toe_ns);
}

/* 31 December of the fourth year is day 1461, the next is day 1: near either end the shorter way round is taken. */
static void days_are_counted_across_the_end_of_the_four_years(void)
{
    const pel_time_t end = 7300 * INT64_C(86400) * S; /* 2000-01-01 is day 7300 since 6 January 1980 */
    for (int quarter = -200; quarter <= 200; quarter += 25) {
        for (int away = -3; away <= 3; away++) {
            pel_ephemeris_t e = orbit();
            pel_glo_raw_t raw;
            const pel_time_t t = end + quarter * TB;
            e.toe_ns = pel_gps_from_moscow(pel_moscow_from_gps(t) / TB * TB);
            const pel_time_t toe = e.toe_ns;
            TEST_ASSERT_TRUE(pel_glo_to_raw(&e, t, &raw));
            TEST_ASSERT_TRUE(pel_glo_from_raw(&e, &raw, t + away * DAY));
            TEST_ASSERT_EQUAL_INT64(toe, e.toe_ns);
        }
    }
}

static void a_time_of_day_is_taken_on_the_day_that_is_nearest(void)
{
    static const struct {
        int64_t ref_s, of_day_s, want_s; /* of Moscow, from midnight */
    } CASE[] = {{43200, 43200, 43200}, {600, 85800, 85800 - 86400}, {85800, 600, 86400 + 600},
                {0, 43200, 43200},     {0, 43201, 43201 - 86400},   {43200, 0, 0},
                {43201, 0, 86400}};
    const pel_time_t midnight = pel_moscow_from_gps(T0) / DAY * DAY;
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        const pel_time_t ref = pel_gps_from_moscow(midnight + CASE[i].ref_s * S);
        const pel_time_t want = pel_gps_from_moscow(midnight + CASE[i].want_s * S);
        TEST_ASSERT_EQUAL_INT64(want, pel_glo_epoch_near(7, (uint32_t)(1000 * CASE[i].of_day_s), ref));
    }
    const unsigned day = (unsigned)(midnight / DAY % 7);
    TEST_ASSERT_EQUAL_INT64(pel_gps_from_moscow(midnight + 5 * S), pel_glo_epoch_near(day, 5000, T0 + 2 * DAY));
}

static void health_and_accuracy_come_from_two_flags_and_a_table(void)
{
    static const struct {
        uint32_t unhealthy, l_n, m, f_t;
        uint8_t health;
        float sd_m;
    } CASE[] = {
        {0, 0, 1, 0, 0, 1.0f},     {1, 0, 1, 5, 1, 7.0f}, {0, 1, 1, 14, 1, 512.0f},
        {1, 1, 1, 15, 1, 6144.0f}, {0, 0, 0, 0, 0, 4.0f}, /* satellites of the first kind do not tell it */
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        pel_ephemeris_t e = orbit();
        pel_glo_raw_t raw;
        TEST_ASSERT_TRUE(pel_glo_to_raw(&e, T0, &raw));
        raw.unhealthy = CASE[i].unhealthy;
        raw.l_n = CASE[i].l_n;
        raw.m = CASE[i].m;
        raw.f_t = CASE[i].f_t;
        TEST_ASSERT_TRUE(pel_glo_from_raw(&e, &raw, T0));
        TEST_ASSERT_EQUAL_UINT8(CASE[i].health, e.health);
        TEST_ASSERT_EQUAL_FLOAT(CASE[i].sd_m, e.sd_ura_m);
    }
}

static void an_accuracy_is_never_sent_better_than_it_is(void)
{
    static const struct {
        float sd_m;
        uint32_t f_t;
    } CASE[] = {{0.5f, 0}, {1.0f, 0}, {1.1f, 1}, {512.0f, 14}, {513.0f, 15}, {1e6f, 15}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        pel_ephemeris_t e = orbit();
        pel_glo_raw_t raw;
        e.sd_ura_m = CASE[i].sd_m;
        TEST_ASSERT_TRUE(pel_glo_to_raw(&e, T0, &raw));
        TEST_ASSERT_EQUAL_UINT32(CASE[i].f_t, raw.f_t);
    }
}

/* ICD GLONASS, table 4.13: which checks a data bit takes part in, beside the one over all bits. */
static void parity_is_that_of_the_interface_document(void)
{
    static const struct {
        unsigned bit;
        uint8_t checks;
    } CASE[] = {{9, 0x83}, {10, 0x85}, {11, 0x86}, {12, 0x07}, {13, 0x89}, {15, 0x0B}, {85, 0x54}};
    uint8_t s[12] = {0};
    TEST_ASSERT_TRUE(pel_glo_string_good(s));
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        memset(s, 0, sizeof s);
        pel_bits_put(s, 85 - CASE[i].bit, 1, 1);
        TEST_ASSERT_FALSE(pel_glo_string_good(s));
        pel_glo_string_seal(s);
        TEST_ASSERT_EQUAL_HEX8(CASE[i].checks, (uint8_t)pel_bits_u(s, 77, 8));
        TEST_ASSERT_TRUE(pel_glo_string_good(s));
    }
}

/* Sign and magnitude have two zeros: the one without a sign is sent. */
static void zero_goes_out_without_a_sign(void)
{
    pel_ephemeris_t e = orbit();
    TEST_ASSERT_GREATER_THAN_size_t(0, pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame));
    TEST_ASSERT_EQUAL_HEX64(0, pel_bits_u(frame + 3, 12 + 6 + 5 + 4 + 12 + 1 + 1 + 7, 24)); /* v_x */
}

static void what_has_no_representation_is_not_sent(void)
{
    pel_ephemeris_t e = orbit();
    pel_glo_raw_t raw;
    const pel_time_t first = DAY - 10800 * S; /* Moscow's second day of GPS time */
    e.toe_ns = first;
    TEST_ASSERT_TRUE(pel_glo_to_raw(&e, first, &raw));
    TEST_ASSERT_FALSE(pel_glo_to_raw(&e, first - 1, &raw));
    e.toe_ns = first - TB;
    TEST_ASSERT_FALSE(pel_glo_to_raw(&e, first, &raw));
    e.toe_ns = first + TB + 1;
    TEST_ASSERT_FALSE(pel_glo_to_raw(&e, first, &raw));
    e = orbit();
    e.glo.k = 7;
    TEST_ASSERT_FALSE(pel_glo_to_raw(&e, T0, &raw));
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 1, T0, frame, sizeof frame));

    e = orbit();
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_ephemeris(&e, frame, 69));
    TEST_ASSERT_GREATER_THAN_size_t(0, pel_rtcm3_encode_ephemeris(&e, frame, 70));
    e.tgd_s[0] = 16.0 * 0x1p-30; /* sign and magnitude of five bits end at 15 */
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame));
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 4, T0, frame, sizeof frame));
    e.tgd_s[0] = -15.0 * 0x1p-30;
    TEST_ASSERT_GREATER_THAN_size_t(0, pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_message_is_taken_up_to_its_limits_and_not_beyond);
    RUN_TEST(a_day_is_believed_within_four_of_the_reference);
    RUN_TEST(days_are_counted_across_the_end_of_the_four_years);
    RUN_TEST(a_time_of_day_is_taken_on_the_day_that_is_nearest);
    RUN_TEST(health_and_accuracy_come_from_two_flags_and_a_table);
    RUN_TEST(an_accuracy_is_never_sent_better_than_it_is);
    RUN_TEST(parity_is_that_of_the_interface_document);
    RUN_TEST(zero_goes_out_without_a_sign);
    RUN_TEST(what_has_no_representation_is_not_sent);
    return UNITY_END();
}

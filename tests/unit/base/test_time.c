/* GPS time: weeks joined and split, roll-overs on both sides, leap seconds against the bulletin. */
#include <math.h>

#include "pelorus/base.h"
#include "unity.h"

#define WEEK PEL_NS_PER_WEEK
#define S    PEL_NS_PER_S

void setUp(void) {}
void tearDown(void) {}

static void seconds_of_week_are_rounded_to_the_nearest_nanosecond(void)
{
    static const struct {
        int32_t week;
        double tow_s;
        pel_time_t want;
    } CASE[] = {
        {0, 0.0, 0},
        {2300, 345600.1, 2300 * WEEK + 345600 * S + 100000000},
        {2300, 604799.999999999, 2301 * WEEK - 1},
        {2300, 604800.0, 2301 * WEEK},         /* beyond the week */
        {2300, -0.1, 2300 * WEEK - 100000000}, /* and before it */
        {2300, 1e-9 * 0.6, 2300 * WEEK + 1},
        {2300, -1e-9 * 0.6, 2300 * WEEK - 1},
        {2300, 1e-9 * 0.4, 2300 * WEEK},
        {2300, -1e-9 * 0.4, 2300 * WEEK},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        TEST_ASSERT_EQUAL_INT64(CASE[i].want, pel_time_from_week(CASE[i].week, CASE[i].tow_s));
    }
}

static void a_time_is_split_into_its_week_and_the_seconds_since_its_start(void)
{
    static const struct {
        pel_time_t t;
        int32_t week;
        double tow_s;
    } CASE[] = {
        {0, 0, 0.0},
        {1, 0, 1e-9},
        {WEEK - 1, 0, 604799.999999999},
        {WEEK, 1, 0.0},
        {-1, -1, 604799.999999999}, /* before 1980 the division must round down, not towards zero */
        {-WEEK, -1, 0.0},
        {-WEEK - 1, -2, 604799.999999999},
        {2300 * WEEK + 345600 * S + 250000000, 2300, 345600.25},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        TEST_ASSERT_EQUAL_INT32(CASE[i].week, pel_time_week(CASE[i].t));
        TEST_ASSERT_DOUBLE_WITHIN(1e-10, CASE[i].tow_s, pel_time_tow_s(CASE[i].t));
    }
}

static void differences_keep_their_nanoseconds_and_their_sign(void)
{
    const pel_time_t t = 2300 * WEEK;
    TEST_ASSERT_EQUAL_DOUBLE(1e-9, pel_time_diff_s(t + 1, t));
    TEST_ASSERT_EQUAL_DOUBLE(-1e-9, pel_time_diff_s(t, t + 1));
    TEST_ASSERT_EQUAL_DOUBLE(86400.000000001, pel_time_diff_s(t + 86400 * S + 1, t));
    TEST_ASSERT_EQUAL_DOUBLE(-86400.000000001, pel_time_diff_s(t, t + 86400 * S + 1));
    /* any two numbers have a difference: it wraps and does not trap */
    TEST_ASSERT_TRUE(isfinite(pel_time_diff_s(INT64_MAX, INT64_MIN)));
    TEST_ASSERT_TRUE(isfinite(pel_time_diff_s(INT64_MIN, INT64_MAX)));
}

static void a_second_of_week_is_taken_in_the_week_that_is_nearest(void)
{
    static const struct {
        double tow_s, ref_s;
        int64_t want_s;
    } CASE[] = {
        {10.0, 20.0, 10},
        {604790.0, 10.0, 604790 - 604800}, /* the end of the week before */
        {10.0, 604790.0, 604800 + 10},     /* the start of the next */
        {302400.0, 0.0, 302400},           /* just half a week away: this week's */
        {302401.0, 0.0, 302401 - 604800},
        {0.0, 302400.0, 0},
        {0.0, 302401.0, 604800},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        const pel_time_t ref = 2300 * WEEK + (pel_time_t)(CASE[i].ref_s * 1e9);
        TEST_ASSERT_EQUAL_INT64(2300 * WEEK + CASE[i].want_s * S, pel_time_from_tow_near(CASE[i].tow_s, ref));
    }
}

/* Every sent week of every modulus comes back, as far as half the modulus on both sides of the reference. */
static void truncated_weeks_are_completed_to_the_nearest(void)
{
    static const int32_t MODULO[] = {1024, 4096, 8192};
    for (size_t m = 0; m < 3; m++) {
        for (int32_t ref = 1000; ref <= 3100; ref += 300) {
            for (int32_t away = -MODULO[m] / 2; away < MODULO[m] / 2; away += 8) {
                const int32_t week = ref + away;
                const int32_t sent = ((week % MODULO[m]) + MODULO[m]) % MODULO[m];
                TEST_ASSERT_EQUAL_INT32(week, pel_time_full_week(sent, MODULO[m], ref * WEEK + 5));
            }
        }
    }
    /* Half the modulus away on either side is the same number: it is taken as the past. */
    TEST_ASSERT_EQUAL_INT32(2300 - 512, pel_time_full_week((2300 + 512) % 1024, 1024, 2300 * WEEK));
}

/* IERS Bulletin C: the first days of the months behind a leap second. The count changes at its second and not before. */
static void leap_seconds_begin_at_their_second(void)
{
    static const struct {
        int year, month;
    } BEGIN[] = {{1981, 7}, {1982, 7}, {1983, 7}, {1985, 7}, {1988, 1}, {1990, 1}, {1991, 1}, {1992, 7}, {1993, 7},
                 {1994, 7}, {1996, 1}, {1997, 7}, {1999, 1}, {2006, 1}, {2009, 1}, {2012, 7}, {2015, 7}, {2017, 1}};
    TEST_ASSERT_EQUAL_INT32(0, pel_time_leap_s(0));
    TEST_ASSERT_EQUAL_INT32(0, pel_time_leap_s(-WEEK));
    for (int i = 0; i < 18; i++) {
        int64_t days = -5; /* GPS time began on 6 January 1980 */
        for (int y = 1980; y < BEGIN[i].year; y++) { days += (y % 4 == 0) ? 366 : 365; }
        if (BEGIN[i].month == 7) { days += (BEGIN[i].year % 4 == 0) ? 182 : 181; }
        const pel_time_t at = (days * 86400 + i + 1) * S;
        TEST_ASSERT_EQUAL_INT32(i, pel_time_leap_s(at - 1));
        TEST_ASSERT_EQUAL_INT32(i + 1, pel_time_leap_s(at));
    }
    TEST_ASSERT_EQUAL_INT32(18, pel_time_leap_s(3000 * WEEK));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(seconds_of_week_are_rounded_to_the_nearest_nanosecond);
    RUN_TEST(a_time_is_split_into_its_week_and_the_seconds_since_its_start);
    RUN_TEST(differences_keep_their_nanoseconds_and_their_sign);
    RUN_TEST(a_second_of_week_is_taken_in_the_week_that_is_nearest);
    RUN_TEST(truncated_weeks_are_completed_to_the_nearest);
    RUN_TEST(leap_seconds_begin_at_their_second);
    return UNITY_END();
}

/* NMEA sentences against the C library's calendar and functions, for every kind of solution and for numbers that are none. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "support_wire.h"
#include "unity.h"

#define DEG (3.14159265358979323846 / 180.0)

static char text[256];
static char field[20][32];
static int n_fields;

void setUp(void) {}
void tearDown(void) {}

static pel_solution_t solution(uint8_t fix)
{
    const pel_solution_t s = {.t_ns = T0,
                              .fix = fix,
                              .lat_rad = 47.25 * DEG,
                              .lon_rad = -8.5 * DEG,
                              .height_m = 512.25,
                              .v_ned = {3.0f, -4.0f, 0.5f},
                              .base_age_s = 1.5f,
                              .n_sat = 7};
    return s;
}

/* The fields behind the address, between commas and up to the checksum. */
static void split(size_t n)
{
    TEST_ASSERT_GREATER_THAN_size_t(0, n);
    n_fields = 0;
    const char *p = strchr(text, ',');
    while (p != NULL && *p == ',') {
        const size_t length = strcspn(p + 1, ",*");
        TEST_ASSERT_LESS_THAN_size_t(sizeof field[0], length);
        memcpy(field[n_fields], p + 1, length);
        field[n_fields][length] = '\0';
        n_fields++;
        p += 1 + length;
    }
}

static void every_kind_of_solution_has_its_digit_and_its_letter(void)
{
    static const struct {
        uint8_t fix;
        const char *quality, *mode, *age;
    } CASE[] = {{PEL_FIX_NONE, "0", "N", ""},     {PEL_FIX_SPP, "1", "A", ""},   {PEL_FIX_FLOAT, "5", "F", "1.5"},
                {PEL_FIX_FIXED, "4", "R", "1.5"}, {PEL_FIX_COAST, "6", "E", ""}, {200, "0", "N", ""}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        pel_solution_t s = solution(CASE[i].fix);
        split(pel_nmea_gga(&s, text, sizeof text));
        TEST_ASSERT_EQUAL_INT(14, n_fields);
        TEST_ASSERT_EQUAL_STRING(CASE[i].quality, field[5]);
        TEST_ASSERT_EQUAL_STRING("07", field[6]);
        TEST_ASSERT_EQUAL_STRING(CASE[i].age, field[12]);
        TEST_ASSERT_EQUAL_STRING((CASE[i].age[0] != '\0') ? "0000" : "", field[13]);
        split(pel_nmea_rmc(&s, text, sizeof text));
        TEST_ASSERT_EQUAL_INT(13, n_fields);
        TEST_ASSERT_EQUAL_STRING((CASE[i].fix == PEL_FIX_NONE) ? "V" : "A", field[1]);
        TEST_ASSERT_EQUAL_STRING(CASE[i].mode, field[11]);
        s.base_age_s = 0.0f;
        split(pel_nmea_gga(&s, text, sizeof text));
        TEST_ASSERT_EQUAL_STRING((CASE[i].age[0] != '\0') ? "0.0" : "", field[12]);
        s.base_age_s = -1.0f; /* no base */
        split(pel_nmea_gga(&s, text, sizeof text));
        TEST_ASSERT_EQUAL_INT(14, n_fields);
        TEST_ASSERT_EQUAL_STRING("", field[12]);
    }
}

static void without_a_position_its_fields_are_empty(void)
{
    const pel_solution_t s = solution(PEL_FIX_NONE);
    split(pel_nmea_gga(&s, text, sizeof text));
    for (int i = 1; i <= 4; i++) { TEST_ASSERT_EQUAL_STRING("", field[i]); }
    for (int i = 7; i <= 13; i++) { TEST_ASSERT_EQUAL_STRING("", field[i]); }
    split(pel_nmea_rmc(&s, text, sizeof text));
    for (int i = 2; i <= 7; i++) { TEST_ASSERT_EQUAL_STRING("", field[i]); }
}

static double degrees(const char *s, int digits)
{
    char whole[4] = {0};
    memcpy(whole, s, (size_t)digits);
    return atof(whole) + atof(s + digits) / 60.0;
}

static void positions_keep_a_tenth_of_a_millimetre(void)
{
    static const double LAT[] = {0.0, 1e-9, -0.5, 47.285233, -89.99999999, 90.0};
    static const double LON[] = {0.0, -1e-9, 9.999999999, -99.5, 179.99999999, -180.0};
    for (int i = 0; i < 6; i++) {
        pel_solution_t s = solution(PEL_FIX_FIXED);
        s.lat_rad = LAT[i] * DEG;
        s.lon_rad = LON[i] * DEG;
        s.height_m = -0.00004 - 100.0 * i;
        split(pel_nmea_gga(&s, text, sizeof text));
        TEST_ASSERT_EQUAL_size_t(12, strlen(field[1]));
        TEST_ASSERT_EQUAL_size_t(13, strlen(field[3]));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, fabs(LAT[i]), degrees(field[1], 2));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, fabs(LON[i]), degrees(field[3], 3));
        TEST_ASSERT_EQUAL_STRING((LAT[i] < 0.0) ? "S" : "N", field[2]);
        TEST_ASSERT_EQUAL_STRING((LON[i] < 0.0) ? "W" : "E", field[4]);
        TEST_ASSERT_DOUBLE_WITHIN(0.51e-4, s.height_m, atof(field[8]));
    }
}

static void speed_and_course_are_those_of_the_velocity(void)
{
    pel_solution_t s = solution(PEL_FIX_FIXED);
    for (int degree = 0; degree < 720; degree++) {
        const double mps = pow(10.0, -2.0 + 0.0065 * degree);
        const double course = 0.5 * degree;
        s.v_ned[0] = (float)(mps * cos(course * DEG));
        s.v_ned[1] = (float)(mps * sin(course * DEG));
        split(pel_nmea_rmc(&s, text, sizeof text));
        TEST_ASSERT_DOUBLE_WITHIN(0.51e-3 + 1e-7 * mps, mps * 3600.0 / 1852.0, atof(field[6]));
        TEST_ASSERT_DOUBLE_WITHIN(0.00501, 0.0, remainder(atof(field[7]) - course, 360.0));
        TEST_ASSERT_TRUE(atof(field[7]) >= 0.0 && atof(field[7]) < 360.0);
    }
    static const struct {
        float north, east;
        const char *speed, *course;
    } CASE[] = {{0, 0, "0.000", "0.00"},     {1, 0, "1.944", "0.00"},    {-1, 0, "1.944", "180.00"},
                {0, 1, "1.944", "90.00"},    {0, -1, "1.944", "270.00"}, {1, 1, "2.749", "45.00"},
                {-1, -1, "2.749", "225.00"}, {-0.0f, 0, "0.000", "0.00"}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        s.v_ned[0] = CASE[i].north;
        s.v_ned[1] = CASE[i].east;
        split(pel_nmea_rmc(&s, text, sizeof text));
        TEST_ASSERT_EQUAL_STRING(CASE[i].speed, field[6]);
        TEST_ASSERT_EQUAL_STRING(CASE[i].course, field[7]);
    }
}

/* From the first day of GPS time to the last of 64 bits, leap years of 2000 and 2100 among them. */
static void times_and_dates_are_those_of_the_calendar(void)
{
    pel_solution_t s = solution(PEL_FIX_FIXED);
    int days = 0;
    for (int64_t day = 0; day < 106000; day += (day < 16000) ? 1 : 3) {
        s.t_ns = (day * 86400 + 86399 - 7 * (day % 12000)) * PEL_NS_PER_S + 987654321;
        if (s.t_ns < PEL_NS_PER_S) { continue; }
        const time_t unix_s = (time_t)(s.t_ns / PEL_NS_PER_S - pel_time_leap_s(s.t_ns) + 315964800);
        struct tm tm;
        char date[80];
        char clock[80];
        TEST_ASSERT_NOT_NULL(gmtime_r(&unix_s, &tm));
        (void)snprintf(date, sizeof date, "%02d%02d%02d", tm.tm_mday, tm.tm_mon + 1, tm.tm_year % 100);
        (void)snprintf(clock, sizeof clock, "%02d%02d%02d.98", tm.tm_hour, tm.tm_min, tm.tm_sec);
        split(pel_nmea_rmc(&s, text, sizeof text));
        TEST_ASSERT_EQUAL_STRING(clock, field[0]);
        TEST_ASSERT_EQUAL_STRING(date, field[8]);
        days++;
    }
    TEST_ASSERT_GREATER_THAN_INT(40000, days);
}

static void headings_are_given_when_there_is_one(void)
{
    pel_solution_t s = solution(PEL_FIX_FIXED);
    s.heading_rad = (float)(-90.0 * DEG);
    TEST_ASSERT_EQUAL_size_t(14, pel_nmea_hdt(&s, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("$GNHDT,,T*05\r\n", text);
    s.flags = PEL_SOL_HEADING;
    TEST_ASSERT_EQUAL_size_t(20, pel_nmea_hdt(&s, text, sizeof text));
    TEST_ASSERT_EQUAL_STRING("$GNHDT,270.00,T*1E\r\n", text);
}

static void numbers_that_are_none_give_no_sentence(void)
{
    const float nan = NAN;
    pel_solution_t s = solution(PEL_FIX_FIXED);
    s.lat_rad = (double)nan;
    TEST_ASSERT_EQUAL_size_t(0, pel_nmea_gga(&s, text, sizeof text));
    TEST_ASSERT_EQUAL_size_t(0, pel_nmea_rmc(&s, text, sizeof text));
    s = solution(PEL_FIX_FIXED);
    s.lon_rad = (double)INFINITY;
    TEST_ASSERT_EQUAL_size_t(0, pel_nmea_gga(&s, text, sizeof text));
    s = solution(PEL_FIX_FIXED);
    s.height_m = (double)nan;
    TEST_ASSERT_EQUAL_size_t(0, pel_nmea_gga(&s, text, sizeof text));
    s = solution(PEL_FIX_FIXED);
    s.v_ned[0] = INFINITY;
    TEST_ASSERT_EQUAL_size_t(0, pel_nmea_rmc(&s, text, sizeof text));
    s.flags = PEL_SOL_HEADING;
    s.heading_rad = nan;
    TEST_ASSERT_EQUAL_size_t(0, pel_nmea_hdt(&s, text, sizeof text));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_kind_of_solution_has_its_digit_and_its_letter);
    RUN_TEST(without_a_position_its_fields_are_empty);
    RUN_TEST(positions_keep_a_tenth_of_a_millimetre);
    RUN_TEST(speed_and_course_are_those_of_the_velocity);
    RUN_TEST(times_and_dates_are_those_of_the_calendar);
    RUN_TEST(headings_are_given_when_there_is_one);
    RUN_TEST(numbers_that_are_none_give_no_sentence);
    return UNITY_END();
}

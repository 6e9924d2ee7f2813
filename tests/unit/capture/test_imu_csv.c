/* test_imu_csv.c - text IMU recordings: layouts, units, clocks, increments. */
/* link: pel_capture */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "imu_csv.h"
#include "support_capture.h"
#include "unity.h"

#define G0  9.80665
#define DEG 0.017453292519943295

static text_t text;
static tally_t tally;
static imu_samples_t samples;
static imu_csv_options_t options;

void setUp(void)
{
    memset(&text, 0, sizeof text);
    memset(&tally, 0, sizeof tally);
    memset(&samples, 0, sizeof samples);
    memset(&options, 0, sizeof options);
    options.week = -1;
}
void tearDown(void)
{
    free(samples.imu);
}

static void read_text(void)
{
    const char *why = "";
    const input_t in = text_input(&text);
    TEST_ASSERT_TRUE_MESSAGE(imu_csv_read(&in, &options, &samples, &tally, &why), why);
}

static void increments_are_the_trapezoid_with_exact_time(void)
{
    options.week = 2130;
    text_add(&text, "tow_s,ax_mps2,ay_mps2,az_mps2,gx_radps,gy_radps,gz_radps\n");
    text_add(&text,
             "364514.000,0,1,9.0,0.1,0,-0.2\n364514.020,2,1,10.0,0.3,0,-0.2\n364514.0400000001,2,1,10.0,0.3,0,-0.2\n");
    read_text();
    TEST_ASSERT_EQUAL_size_t(2, samples.n);
    TEST_ASSERT_EQUAL_INT64((INT64_C(2130) * 604800 + 364514) * PEL_NS_PER_S + 20000000, samples.imu[0].t_ns);
    TEST_ASSERT_EQUAL_DOUBLE(0.02, samples.imu[0].dt_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.02 * 1.0, samples.imu[0].upsilon_ib_b[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.02 * 9.5, samples.imu[0].upsilon_ib_b[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.02 * 0.2, samples.imu[0].alpha_ib_b[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.02 * -0.2, samples.imu[0].alpha_ib_b[2]);
    TEST_ASSERT_EQUAL_INT64(20000000, samples.imu[1].t_ns - samples.imu[0].t_ns);
}

static void a_logger_without_header_is_g_and_degrees_and_milliseconds(void)
{
    options.has_offset = true;
    options.offset_ns = 1000 * PEL_NS_PER_S;
    text_add(&text, "011,0.038,-0.160,0.160,3326339\n"); /* cut off in front */
    for (int i = 0; i < 10; i++) { text_add(&text, "0.5,0,-1,90,0,-180,%d\n", 3326345 + 6 * i); }
    text_add(&text, "0.5,0,-1,9");
    read_text();
    TEST_ASSERT_EQUAL_size_t(9, samples.n);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.006 * 0.5 * G0, samples.imu[0].upsilon_ib_b[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.006 * -180.0 * DEG, samples.imu[0].alpha_ib_b[2]);
    TEST_ASSERT_EQUAL_INT64(INT64_C(4326351) * 1000000, samples.imu[0].t_ns);
    TEST_ASSERT_EQUAL_UINT64(0, tally_refused(&tally));
}

static void columns_and_units_can_be_named(void)
{
    options.columns = "ms,gz,gy,gx,temperature,az,ay,ax";
    TEST_ASSERT_TRUE(imu_csv_units("mg,mrad/s", &options.accel_unit, &options.gyro_unit));
    options.has_offset = true;
    text_add(&text, "0 3 2 1 25.5 1000 0 0\n10 3 2 1 25.5 1000 0 0\n20 3 2 1 25.5 1000 0 0\n");
    read_text();
    TEST_ASSERT_EQUAL_size_t(2, samples.n);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.01 * G0, samples.imu[0].upsilon_ib_b[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.01 * 1e-3, samples.imu[0].alpha_ib_b[0]);
    TEST_ASSERT_FALSE(imu_csv_units("furlong,deg/s", &options.accel_unit, &options.gyro_unit));
}

static void a_clock_of_its_own_needs_to_be_told_its_zero(void)
{
    const char *why = "";
    text_add(&text, "t_s,ax_g,ay_g,az_g,gx_dps,gy_dps,gz_dps\n-0.5,0,0,1,0,0,0\n-0.49,0,0,1,0,0,0\n");
    const input_t in = text_input(&text);
    TEST_ASSERT_FALSE(imu_csv_read(&in, &options, &samples, &tally, &why));
    TEST_ASSERT_NOT_NULL(strstr(why, "--imu-time-offset"));
    options.has_offset = true;
    options.offset_ns = PEL_NS_PER_S;
    read_text();
    TEST_ASSERT_EQUAL_INT64(510000000, samples.imu[0].t_ns);
}

static void a_gap_is_not_bridged_and_shows_in_the_sequence(void)
{
    options.has_offset = true;
    text_add(&text, "t_s,ax_mps2,ay_mps2,az_mps2,gx_radps,gy_radps,gz_radps\n");
    for (int i = 0; i < 20; i++) {
        if (i >= 10 && i < 14) { continue; }
        text_add(&text, "%.2f,0,0,%d,0,0,0\n", 1.0 + 0.01 * i, (i >= 14) ? 20 : 10);
    }
    text_add(&text, "1.15,0,0,10,0,0,0\n1.30,0,x,10,0,0,0\n");
    read_text();
    TEST_ASSERT_EQUAL_size_t(15, samples.n);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.01, samples.imu[9].dt_s); /* across the gap: sample 14's own interval */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.20, samples.imu[9].upsilon_ib_b[2]);
    TEST_ASSERT_EQUAL_UINT16(5, (uint16_t)(samples.imu[9].seq - samples.imu[8].seq));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "gaps"));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "sample not later than the one before"));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "line that is not a sample"));
}

/* A logger 40 ppm slow, tags of a computer that reads its port every 16 ms. */
static void time_tags_tie_a_logger_clock_to_gps_time(void)
{
    enum { N = 1500 };
    static tag_t tag[N];
    tagfile_t tags = {tag, 0};
    const pel_time_t start = INT64_C(1440437439) * PEL_NS_PER_S;
    for (int i = 0; i < N; i++) {
        const double true_s = 0.01 * i, arrival_s = ceil((true_s + 0.002) / 0.016) * 0.016;
        text_add(&text, "0,0,1,0,0,0,%d\n", 5000 + (int)lround(1000.0 * true_s * (1.0 - 40e-6)));
        tag[tags.n++] = (tag_t){start + (pel_time_t)(arrival_s * 1e9), text.n};
    }
    options.tags = &tags;
    read_text();
    TEST_ASSERT_EQUAL_size_t(N - 1, samples.n);
    double worst = 0.0;
    for (int i = 1; i < N; i++) {
        const double error_s = 1e-9 * (double)(samples.imu[i - 1].t_ns - start) - 0.01 * i;
        worst = fmax(worst, fabs(error_s - 0.002));
    }
    printf("time of samples from tags: worst %.1f ms beside the 2 ms the bytes travelled\n", 1e3 * worst);
    TEST_ASSERT_TRUE(worst < 0.003);
}

static void tags_of_a_text_that_lost_its_carriage_returns_are_put_right(void)
{
    static tag_t many[1000];
    tagfile_t t = {many, 1000};
    for (int i = 0; i < 1000; i++) {
        text_add(&text, "line %03d\n", i);
        many[i] = (tag_t){i, text.n + (size_t)i + 1};
    }
    const input_t in2 = text_input(&text);
    tagfile_fit_text(&t, &in2);
    for (int i = 0; i < 1000; i++) { TEST_ASSERT_EQUAL_size_t(9u * ((unsigned)i + 1u), many[i].end); }
    tagfile_fit_text(&t, &in2); /* tags that fit are left alone */
    TEST_ASSERT_EQUAL_size_t(9000, many[999].end);
}

static void no_truncation_and_no_damage_breaks_the_reader(void)
{
    static text_t whole;
    uint32_t state = 5;
    text_add(&text, "tow_s,ax_mps2,ay_mps2,az_mps2,gx_radps,gy_radps,gz_radps\n");
    for (int i = 0; i < 40; i++) { text_add(&text, "%.3f,-0.01,1e-3,9.8,1e-3,-2e-3,0.5\n", 100.0 + 0.02 * i); }
    whole = text;
    options.week = 2000;
    for (int run = 0; run < 3000; run++) {
        const char *why = "";
        text = whole;
        if (run < 1000) { text.n = (size_t)run * whole.n / 1000; }
        for (int i = 0; run >= 1000 && i < 6; i++) {
            state = state * 1664525u + 1013904223u;
            text.text[state / 7u % text.n] = (char)(state >> 24);
        }
        input_t in = text_input(&text);
        in.bytes = malloc(text.n + 1);
        TEST_ASSERT_NOT_NULL(in.bytes);
        memcpy(in.bytes, text.text, text.n);
        imu_samples_t s;
        if (imu_csv_read(&in, &options, &s, &tally, &why)) {
            for (size_t i = 0; i < s.n; i++) {
                TEST_ASSERT_TRUE(s.imu[i].dt_s > 0.0 && isfinite(s.imu[i].upsilon_ib_b[2]));
            }
            free(s.imu);
        }
        free(in.bytes);
    }
}

/* Both found by fuzz_imu_csv: sums of such times do not fit 64 bits. */
static void a_time_of_centuries_is_no_sample(void)
{
    options.has_offset = true;
    text_add(&text, "gpst_s,ax,ay,az,gx,gy,gz\n13000000001,0,0,9.8,0,0,0\n1300000000.00,0,0,9.8,0,0,0\n");
    text_add(&text, "1300000000.01,0,0,9.8,0,0,0\n1300000000.02,0,0,9.8,0,0,0\n");
    read_text();
    TEST_ASSERT_EQUAL_size_t(2, samples.n);
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "line that is not a sample"));
}

static void a_gap_of_decades_is_a_gap(void)
{
    options.has_offset = true;
    text_add(&text, "gpst_s,ax,ay,az,gx,gy,gz\n0.00,0,0,9.8,0,0,0\n0.01,0,0,9.8,0,0,0\n0.02,0,0,9.8,0,0,0\n");
    text_add(&text, "3999999999,0,0,9.8,0,0,0\n");
    read_text();
    TEST_ASSERT_EQUAL_size_t(3, samples.n);
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "gaps"));
    TEST_ASSERT_EQUAL_DOUBLE(0.01, samples.imu[2].dt_s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(increments_are_the_trapezoid_with_exact_time);
    RUN_TEST(a_logger_without_header_is_g_and_degrees_and_milliseconds);
    RUN_TEST(columns_and_units_can_be_named);
    RUN_TEST(a_clock_of_its_own_needs_to_be_told_its_zero);
    RUN_TEST(a_gap_is_not_bridged_and_shows_in_the_sequence);
    RUN_TEST(time_tags_tie_a_logger_clock_to_gps_time);
    RUN_TEST(tags_of_a_text_that_lost_its_carriage_returns_are_put_right);
    RUN_TEST(a_time_of_centuries_is_no_sample);
    RUN_TEST(a_gap_of_decades_is_a_gap);
    RUN_TEST(no_truncation_and_no_damage_breaks_the_reader);
    return UNITY_END();
}

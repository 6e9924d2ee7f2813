/* Where frames begin and end: every probe at the ends of its lengths, the shared buffer, order in time, seals. */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/wire/framing.h"
#include "support_wire.h"
#include "unity.h"

static uint8_t buf[70000];
static uint16_t fill;
static pel_wire_counters_t count;

void setUp(void)
{
    memset(buf, 0, sizeof buf);
    fill = 0;
    count = (pel_wire_counters_t){0};
}
void tearDown(void) {}

/* ---- probes ---------------------------------------------------------------------------------------------------------- */

static void ubx_lengths_follow_the_layout_where_it_is_known(void)
{
    static const struct {
        uint8_t cls, id;
        unsigned n;
        bool possible;
    } CASE[] = {
        {0x02, 0x15, 8, false},
        {0x02, 0x15, 15, false},
        {0x02, 0x15, 16, true},
        {0x02, 0x15, 17, false},
        {0x02, 0x15, 47, false},
        {0x02, 0x15, 48, true},
        {0x02, 0x13, 4, false},
        {0x02, 0x13, 7, false},
        {0x02, 0x13, 8, true},
        {0x02, 0x13, 9, false},
        {0x02, 0x13, 136, true},
        {0x02, 0x13, 137, false},
        {0x02, 0x13, 140, false},
        {0x01, 0x07, 83, false},
        {0x01, 0x07, 84, true},
        {0x01, 0x07, 92, true},
        {0x01, 0x07, 93, false},
        {0x02, 0x14, 3, true},
        {0x01, 0x35, 3, true},
        {0x0A, 0x15, 3, true},
        {0x0A, 0x13, 3, true},
        {0x06, 0x07, 3, true},
        {0x01, 0x15, 3, true},
        {0x01, 0x35, 0, true},
        {0x01, 0x35, PEL_MAX_FRAME_BYTES - 8, true},
        {0x01, 0x35, PEL_MAX_FRAME_BYTES - 7, false},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        const uint8_t p[6] = {0xB5, 0x62, CASE[i].cls, CASE[i].id, (uint8_t)CASE[i].n, (uint8_t)(CASE[i].n >> 8)};
        size_t length;
        TEST_ASSERT_EQUAL_INT(CASE[i].possible ? PEL_PROBE_MORE : PEL_PROBE_BAD_LENGTH,
                              pel_ubx_probe(p, sizeof p, &length));
    }
}

/* Each header byte at which the search may stop, with the byte that stops it. */
static void a_header_is_judged_byte_by_byte(void)
{
    static const struct {
        pel_probe_t (*probe)(const uint8_t *, size_t, size_t *);
        uint8_t p[6];
        size_t n;
        pel_probe_t want;
    } CASE[] = {
        {pel_ubx_probe, {0xB5}, 1, PEL_PROBE_MORE},
        {pel_ubx_probe, {0xB5, 0x63}, 2, PEL_PROBE_NOISE},
        {pel_ubx_probe, {0xB5, 0x62}, 2, PEL_PROBE_MORE},
        {pel_ubx_probe, {0xB5, 0x62, 0x00}, 3, PEL_PROBE_NOISE},
        {pel_ubx_probe, {0xB5, 0x62, 0xF2}, 3, PEL_PROBE_NOISE},
        {pel_ubx_probe, {0xB5, 0x62, 0xF1}, 3, PEL_PROBE_MORE},
        {pel_ubx_probe, {0xB5, 0x62, 0x01, 0x35, 1}, 5, PEL_PROBE_MORE},
        {pel_rtcm3_probe, {0xD3}, 1, PEL_PROBE_MORE},
        {pel_rtcm3_probe, {0xD3, 0x04}, 2, PEL_PROBE_NOISE},
        {pel_rtcm3_probe, {0xD3, 0x03}, 2, PEL_PROBE_MORE},
        {pel_rtcm3_probe, {0xD3, 0x00, 0x00}, 3, PEL_PROBE_MORE},
        {pel_rtcm3_probe, {0xD3, 0x00, 0x01}, 3, PEL_PROBE_BAD_LENGTH}, /* half a message number */
        {pel_rtcm3_probe, {0xD3, 0x00, 0x02}, 3, PEL_PROBE_MORE},
        {pel_rtcm3_probe, {0xD3, 0x00, 0x02, 0x3E, 0x80}, 5, PEL_PROBE_NOISE}, /* 1000 */
        {pel_rtcm3_probe, {0xD3, 0x00, 0x02, 0x3E, 0x90}, 5, PEL_PROBE_MORE},  /* 1001 */
        {pel_rtcm3_probe, {0xD3, 0x00, 0x02, 0x51, 0x80}, 5, PEL_PROBE_MORE},  /* 1304 */
        {pel_rtcm3_probe, {0xD3, 0x00, 0x02, 0x51, 0x90}, 5, PEL_PROBE_NOISE}, /* 1305 */
        {pel_rtcm3_probe, {0xD3, 0x00, 0x02, 0xFA, 0x00}, 5, PEL_PROBE_NOISE}, /* 4000 */
        {pel_rtcm3_probe, {0xD3, 0x00, 0x02, 0xFA, 0x10}, 5, PEL_PROBE_MORE},  /* 4001 */
        {pel_novatel_probe, {0xAA}, 1, PEL_PROBE_MORE},
        {pel_novatel_probe, {0xAA, 0x45}, 2, PEL_PROBE_NOISE},
        {pel_novatel_probe, {0xAA, 0x44}, 2, PEL_PROBE_MORE},
        {pel_novatel_probe, {0xAA, 0x44, 0x12}, 3, PEL_PROBE_NOISE}, /* a long header */
        {pel_novatel_probe, {0xAA, 0x44, 0x13}, 3, PEL_PROBE_MORE},
        {pel_novatel_probe, {0xAA, 0x44, 0x13, PEL_IMU_FRAME_MAX - 16}, 4, PEL_PROBE_MORE},
        {pel_novatel_probe, {0xAA, 0x44, 0x13, PEL_IMU_FRAME_MAX - 15}, 4, PEL_PROBE_BAD_LENGTH},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        size_t length;
        TEST_ASSERT_EQUAL_INT(CASE[i].want, CASE[i].probe(CASE[i].p, CASE[i].n, &length));
    }
    size_t length;
    static const uint8_t OWN[6] = {'P', 'L', 1, 1, 12, 0};
    TEST_ASSERT_EQUAL_INT(PEL_PROBE_MORE, pel_pelorus_probe(OWN, 1, 12, &length));
    TEST_ASSERT_EQUAL_INT(PEL_PROBE_NOISE, pel_pelorus_probe((const uint8_t *)"PP", 2, 12, &length));
    TEST_ASSERT_EQUAL_INT(PEL_PROBE_MORE, pel_pelorus_probe(OWN, 5, 12, &length));
    TEST_ASSERT_EQUAL_INT(PEL_PROBE_MORE, pel_pelorus_probe(OWN, 6, 12, &length));
    TEST_ASSERT_EQUAL_INT(PEL_PROBE_BAD_LENGTH, pel_pelorus_probe(OWN, 6, 11, &length));
}

static void a_novatel_frame_ends_in_its_checksum(void)
{
    size_t length = 0;
    memcpy(buf, (const uint8_t[]){0xAA, 0x44, 0x13, 4}, 4);
    pel_le_put(buf + 16, 4, pel_crc32_novatel(buf, 16));
    TEST_ASSERT_EQUAL_INT(PEL_PROBE_MORE, pel_novatel_probe(buf, 19, &length));
    TEST_ASSERT_EQUAL_INT(PEL_PROBE_FRAME, pel_novatel_probe(buf, 20, &length));
    TEST_ASSERT_EQUAL_size_t(20, length);
    buf[13] ^= 0x10;
    TEST_ASSERT_EQUAL_INT(PEL_PROBE_BAD_CHECKSUM, pel_novatel_probe(buf, 20, &length));
}

static void a_sentence_ends_in_two_digits_and_a_new_line(void)
{
    static const struct {
        const char *text;
        pel_probe_t want;
    } CASE[] = {
        {"$A", PEL_PROBE_MORE},
        {"$A*", PEL_PROBE_MORE},
        {"$A*41\r", PEL_PROBE_MORE},
        {"$A*41\r\n", PEL_PROBE_FRAME},
        {"$A*4x\r\n", PEL_PROBE_NOISE},
        {"$A*x1\r\n", PEL_PROBE_NOISE},
        {"$A*41\n\n", PEL_PROBE_NOISE},
        {"$A*41\r\r", PEL_PROBE_NOISE},
        {"$J*4A\r\n", PEL_PROBE_FRAME},
        {"$J*4a\r\n", PEL_PROBE_FRAME},
        {"$J*4G\r\n", PEL_PROBE_NOISE},
        {"$J*4g\r\n", PEL_PROBE_NOISE},
        {"$J*4:\r\n", PEL_PROBE_NOISE},
        {"$J*4@\r\n", PEL_PROBE_NOISE},
        {"$J*4`\r\n", PEL_PROBE_NOISE},
        {"$J*4/\r\n", PEL_PROBE_NOISE},
        {"$A*42\r\n", PEL_PROBE_BAD_CHECKSUM},
        {"$I*49\r\n", PEL_PROBE_FRAME},
        {"$O*4F\r\n", PEL_PROBE_FRAME},
        {"$O*4f\r\n", PEL_PROBE_FRAME},
        {"$p*70\r\n", PEL_PROBE_FRAME},
        {"$A\x1F", PEL_PROBE_NOISE},
        {"$A\x7F", PEL_PROBE_NOISE},
        {"$A ~", PEL_PROBE_MORE},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        size_t length = 0;
        TEST_ASSERT_EQUAL_INT_MESSAGE(
            CASE[i].want, pel_nmea_probe((const uint8_t *)CASE[i].text, strlen(CASE[i].text), &length), CASE[i].text);
        if (CASE[i].want == PEL_PROBE_FRAME) { TEST_ASSERT_EQUAL_size_t(7, length); }
    }
    size_t length;
    memset(buf, 'A', 200); /* text without an end is given up where the longest sentence ends */
    buf[0] = '$';
    TEST_ASSERT_EQUAL_INT(PEL_PROBE_MORE, pel_nmea_probe(buf, 128, &length));
    TEST_ASSERT_EQUAL_INT(PEL_PROBE_NOISE, pel_nmea_probe(buf, 129, &length));
}

/* ---- the buffer ------------------------------------------------------------------------------------------------------ */

static void a_full_buffer_gives_up_its_oldest_byte(void)
{
    for (int i = 0; i < 10; i++) { pel_frame_append(buf, 8, &fill, &count, (uint8_t)i); }
    TEST_ASSERT_EQUAL_UINT16(8, fill);
    TEST_ASSERT_EQUAL_UINT32(2, count.noise_bytes);
    for (int i = 0; i < 8; i++) { TEST_ASSERT_EQUAL_UINT8(i + 2, buf[i]); }
    TEST_ASSERT_EQUAL_UINT8(0, buf[8]);
}

/* A flipped bit in the fill must not write past the buffer. */
static void a_fill_beyond_the_buffer_starts_anew(void)
{
    fill = 9;
    pel_frame_append(buf, 8, &fill, &count, 0x5A);
    TEST_ASSERT_EQUAL_UINT16(1, fill);
    TEST_ASSERT_EQUAL_HEX8(0x5A, buf[0]);
    TEST_ASSERT_EQUAL_HEX8(0, buf[9]);
}

static void dropping_more_than_there_is_empties_the_buffer(void)
{
    fill = 5;
    pel_frame_drop(buf, &fill, 0);
    TEST_ASSERT_EQUAL_UINT16(5, fill);
    pel_frame_drop(buf, &fill, 6);
    TEST_ASSERT_EQUAL_UINT16(0, fill);
}

/* 'b' begins a frame with a bad checksum, 'l' one of bad length, 'm' one that wants more, 'F' is one of one byte. */
static pel_probe_t letters(const uint8_t *p, size_t n, size_t *length)
{
    (void)n;
    *length = 1;
    switch (p[0]) {
    case 'b': return PEL_PROBE_BAD_CHECKSUM;
    case 'l': return PEL_PROBE_BAD_LENGTH;
    case 'm': return PEL_PROBE_MORE;
    case 'F': return PEL_PROBE_FRAME;
    default: return PEL_PROBE_NOISE;
    }
}

static void a_search_stops_at_one_verdict_or_at_the_end_goes_through(void)
{
    static const struct {
        const char *text;
        bool final, found;
        uint16_t fill;
        uint32_t noise, checksum, length;
    } CASE[] = {
        {"..F.", false, true, 2, 2, 0, 0},   {"..m.F", false, false, 3, 2, 0, 0}, {"..b.F", false, false, 2, 3, 1, 0},
        {"..l.F", false, false, 2, 3, 0, 1}, {"....", false, false, 0, 4, 0, 0},  {"..F.", true, true, 2, 2, 0, 0},
        {"..m.F", true, true, 1, 4, 0, 1},   {"..b.F", true, true, 1, 4, 1, 0},   {"..l.F", true, true, 1, 4, 0, 1},
        {"blm.", true, false, 0, 4, 1, 2},   {"", true, false, 0, 0, 0, 0},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        size_t length = 0;
        setUp();
        fill = (uint16_t)strlen(CASE[i].text);
        memcpy(buf, CASE[i].text, fill);
        TEST_ASSERT_EQUAL(CASE[i].found, pel_frame_next(buf, &fill, &count, letters, CASE[i].final, &length));
        TEST_ASSERT_EQUAL_UINT16(CASE[i].fill, fill);
        TEST_ASSERT_EQUAL_UINT32(CASE[i].noise, count.noise_bytes);
        TEST_ASSERT_EQUAL_UINT32(CASE[i].checksum, count.bad_checksum);
        TEST_ASSERT_EQUAL_UINT32(CASE[i].length, count.bad_length);
        if (CASE[i].found) { TEST_ASSERT_EQUAL_CHAR('F', (char)buf[0]); }
    }
}

/* ---- time ------------------------------------------------------------------------------------------------------------ */

static void only_times_in_order_among_themselves_count_towards_a_restart(void)
{
    pel_time_t back = 0;
    uint8_t n_back = 0;
    const pel_time_t given = 1000;
    const pel_time_t tol = 5;
    static const struct {
        pel_time_t t;
        pel_order_t want;
        uint8_t n_back;
    } CASE[] = {
        {994, PEL_ORDER_BACK, 1}, {995, PEL_ORDER_SAME, 1}, {1005, PEL_ORDER_SAME, 1},
        {900, PEL_ORDER_BACK, 1},                           /* before the last: the count begins again */
        {906, PEL_ORDER_BACK, 2}, {911, PEL_ORDER_BACK, 2}, /* within the tolerance it is neither */
        {917, PEL_ORDER_BACK, 3}, {912, PEL_ORDER_BACK, 3}, {906, PEL_ORDER_BACK, 1},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        TEST_ASSERT_EQUAL_INT(CASE[i].want, pel_time_order(CASE[i].t, tol, given, &back, &n_back, &count));
        TEST_ASSERT_EQUAL_UINT8(CASE[i].n_back, n_back);
    }
    TEST_ASSERT_EQUAL_UINT32(2, count.duplicate);
    TEST_ASSERT_EQUAL_UINT32(7, count.time_back);
    TEST_ASSERT_EQUAL_INT(PEL_ORDER_NEW, pel_time_order(1006, tol, given, &back, &n_back, &count));
    TEST_ASSERT_EQUAL_UINT8(0, n_back);
    TEST_ASSERT_EQUAL_INT(PEL_ORDER_NEW, pel_time_order(3, tol, 0, &back, &n_back, &count)); /* the first of all */
}

static void a_millisecond_of_week_is_taken_in_the_week_that_is_nearest(void)
{
    static const struct {
        uint32_t tow_ms;
        int64_t ref_ms, want_ms;
    } CASE[] = {{0, 302400000, 0},
                {0, 302400001, 604800000},
                {302400000, 0, 302400000},
                {302400001, 0, 302400001 - 604800000},
                {604800999, 0, 999}}; /* a leap second behind the week */
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        const pel_time_t week = 2300 * PEL_NS_PER_WEEK;
        TEST_ASSERT_EQUAL_INT64(week + CASE[i].want_ms * PEL_NS_PER_MS,
                                pel_tow_ms_near(CASE[i].tow_ms, week + CASE[i].ref_ms * PEL_NS_PER_MS));
    }
}

static void a_week_is_possible_between_1999_and_2094(void)
{
    static const struct {
        int32_t week;
        double tow_s;
        bool want;
    } CASE[] = {
        {999, 0.0, false},    {1000, 0.0, true},       {6000, 604800.999, true},   {6001, 0.0, false},
        {2300, -1e-9, false}, {2300, 604801.0, false}, {2300, (double)NAN, false},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        TEST_ASSERT_EQUAL(CASE[i].want, pel_week_possible(CASE[i].week, CASE[i].tow_s));
    }
}

/* ---- seals ----------------------------------------------------------------------------------------------------------- */

static void a_seal_refuses_what_its_length_field_or_the_buffer_cannot_hold(void)
{
    TEST_ASSERT_EQUAL_size_t(65535 + 8, pel_ubx_seal(1, 2, 65535, buf, sizeof buf));
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_seal(1, 2, 65536, buf, sizeof buf));
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_seal(1, 2, 10, buf, 17));
    TEST_ASSERT_EQUAL_size_t(18, pel_ubx_seal(1, 2, 10, buf, 18));
    TEST_ASSERT_EQUAL_size_t(65535 + 9, pel_out_seal(1, 65535, buf, sizeof buf));
    TEST_ASSERT_EQUAL_size_t(0, pel_out_seal(1, 65536, buf, sizeof buf));
    TEST_ASSERT_EQUAL_size_t(0, pel_out_seal(1, 10, buf, 18));
    TEST_ASSERT_EQUAL_size_t(19, pel_out_seal(1, 10, buf, 19));
    TEST_ASSERT_EQUAL_size_t(1023 + 6, pel_rtcm3_seal(8 * 1023, buf, sizeof buf));
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_seal(8 * 1023 + 1, buf, sizeof buf));
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_seal(73, buf, 15)); /* ten bytes begun */
    TEST_ASSERT_EQUAL_size_t(16, pel_rtcm3_seal(73, buf, 16));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(ubx_lengths_follow_the_layout_where_it_is_known);
    RUN_TEST(a_header_is_judged_byte_by_byte);
    RUN_TEST(a_novatel_frame_ends_in_its_checksum);
    RUN_TEST(a_sentence_ends_in_two_digits_and_a_new_line);
    RUN_TEST(a_full_buffer_gives_up_its_oldest_byte);
    RUN_TEST(a_fill_beyond_the_buffer_starts_anew);
    RUN_TEST(dropping_more_than_there_is_empties_the_buffer);
    RUN_TEST(a_search_stops_at_one_verdict_or_at_the_end_goes_through);
    RUN_TEST(only_times_in_order_among_themselves_count_towards_a_restart);
    RUN_TEST(a_millisecond_of_week_is_taken_in_the_week_that_is_nearest);
    RUN_TEST(a_week_is_possible_between_1999_and_2094);
    RUN_TEST(a_seal_refuses_what_its_length_field_or_the_buffer_cannot_hold);
    return UNITY_END();
}

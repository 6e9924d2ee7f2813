/* Output frames: every field of every type returns, at the offsets of docs/FORMATS.md; the reader finds them among text. */
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/wire/framing.h"
#include "support_wire.h"
#include "unity.h"

static uint8_t frame[PEL_OUT_MAX_PAYLOAD + PEL_OUT_OVERHEAD];
static uint8_t other[PEL_OUT_MAX_PAYLOAD + PEL_OUT_OVERHEAD];
static pel_out_reader_t reader;
static pel_sat_report_t sats[PEL_MAX_OBS];
static pel_sat_report_t sats_back[PEL_MAX_OBS];

void setUp(void)
{
    pel_out_reader_init(&reader);
}
void tearDown(void) {}

/* Random payload -> struct -> payload: equal bytes mean that every field is read and written at the same place and width. */
static void random_payload(size_t n)
{
    for (size_t i = 0; i < n; i++) { frame[6 + i] = (uint8_t)(support_random() >> 13); }
    for (size_t i = 0; i < n; i++) {
        frame[6 + i] &= 0x7F;
    } /* no signalling NaN, which a copy through a register may quiet */
}

static void expect_payload(size_t n, size_t n_frame)
{
    TEST_ASSERT_EQUAL_size_t(n + PEL_OUT_OVERHEAD, n_frame);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(frame + 6, other + 6, n);
}

#define SOLUTION_BYTES 252u
#define USED_BYTES     89u
#define COUNTERS_BYTES 272u
#define EVENT_BYTES    97u
#define WARM_BYTES     (13u + 4u * PEL_N_SNAP)

static void solutions_return(void)
{
    pel_solution_t s;
    random_payload(SOLUTION_BYTES);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_out_decode_solution(frame + 6, SOLUTION_BYTES, &s));
    expect_payload(SOLUTION_BYTES, pel_out_encode_solution(&s, other, sizeof other));
    TEST_ASSERT_EQUAL_INT(PEL_E_FORMAT, pel_out_decode_solution(frame + 6, SOLUTION_BYTES - 1, &s));
    TEST_ASSERT_EQUAL_INT(PEL_E_FORMAT, pel_out_decode_solution(frame + 6, SOLUTION_BYTES + 1, &s));
    for (size_t cap = 0; cap < SOLUTION_BYTES + PEL_OUT_OVERHEAD; cap++) {
        TEST_ASSERT_EQUAL_size_t(0, pel_out_encode_solution(&s, other, cap));
    }
}

static void solution_offsets(void)
{
    pel_solution_t s = {.t_ns = T0,
                        .fix = 3,
                        .flags = 0x1234,
                        .lat_rad = 0.5,
                        .v_ned = {1.0f, 2.0f, 3.0f},
                        .ratio = 4.5f,
                        .n_sat = 17,
                        .state_hash = 0xCAFEBABE,
                        .sd_b_a = {0, 0, 7.0f}};
    (void)pel_out_encode_solution(&s, frame, sizeof frame);
    const uint8_t *p = frame + 6;
    TEST_ASSERT_EQUAL_INT64(T0, pel_le_s(p, 8));
    TEST_ASSERT_EQUAL_UINT8(3, p[8]);
    TEST_ASSERT_EQUAL_HEX16(0x1234, (uint16_t)pel_le_u(p + 10, 2));
    TEST_ASSERT_EQUAL_DOUBLE(0.5, pel_le_f64(p + 36));
    TEST_ASSERT_EQUAL_FLOAT(2.0f, pel_le_f32(p + 64));
    TEST_ASSERT_EQUAL_FLOAT(4.5f, pel_le_f32(p + 180));
    TEST_ASSERT_EQUAL_UINT8(17, p[196]);
    TEST_ASSERT_EQUAL_HEX32(0xCAFEBABE, (uint32_t)pel_le_u(p + 200, 4));
    TEST_ASSERT_EQUAL_FLOAT(7.0f, pel_le_f32(p + SOLUTION_BYTES - 4));
}

static void used_counters_and_events_return(void)
{
    pel_used_t u;
    pel_event_t e;
    pel_nav_counters_t nav;
    pel_wire_counters_t w[3];
    pel_time_t t;
    random_payload(USED_BYTES);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_out_decode_used(frame + 6, USED_BYTES, &u));
    expect_payload(USED_BYTES, pel_out_encode_used(&u, other, sizeof other));
    random_payload(EVENT_BYTES);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_out_decode_event(frame + 6, EVENT_BYTES, &e));
    expect_payload(EVENT_BYTES, pel_out_encode_event(&e, other, sizeof other));
    random_payload(COUNTERS_BYTES);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_out_decode_counters(frame + 6, COUNTERS_BYTES, &nav, &w[0], &w[1], &w[2], &t));
    expect_payload(COUNTERS_BYTES, pel_out_encode_counters(&nav, &w[0], &w[1], &w[2], t, other, sizeof other));
}

static void satellites_return(void)
{
    pel_time_t t;
    int n;
    for (int count = 0; count <= PEL_MAX_OBS; count += 32) {
        const size_t bytes = 10u + (size_t)PEL_OUT_SAT_BYTES * (size_t)count;
        random_payload(bytes);
        pel_le_put(frame + 14, 2, (uint64_t)count);
        TEST_ASSERT_EQUAL_INT(PEL_OK, pel_out_decode_sats(frame + 6, bytes, &t, sats, &n));
        TEST_ASSERT_EQUAL_INT(count, n);
        expect_payload(bytes, pel_out_encode_sats(t, sats, n, other, sizeof other));
    }
    pel_le_put(frame + 14, 2, PEL_MAX_OBS + 1);
    TEST_ASSERT_EQUAL_INT(PEL_E_FORMAT, pel_out_decode_sats(frame + 6, sizeof frame - 9, &t, sats_back, &n));
    TEST_ASSERT_EQUAL_size_t(0, pel_out_encode_sats(t, sats, PEL_MAX_OBS + 1, other, sizeof other));
    TEST_ASSERT_EQUAL_size_t(0, pel_out_encode_sats(t, sats, -1, other, sizeof other));
}

static void the_reader_finds_frames_among_text(void)
{
    const pel_solution_t s = {.t_ns = T0, .fix = 2};
    char text[160];
    const size_t n_text = pel_nmea_gga(&s, text, sizeof text);
    const size_t n = pel_out_encode_solution(&s, frame, sizeof frame);
    int found = 0;
    for (int round = 0; round < 10; round++) {
        for (size_t i = 0; i < n_text; i++) { found += pel_out_reader_push(&reader, (uint8_t)text[i]) ? 1 : 0; }
        for (size_t i = 0; i < n; i++) { found += pel_out_reader_push(&reader, frame[i]) ? 1 : 0; }
        TEST_ASSERT_EQUAL_INT(round + 1, found);
        TEST_ASSERT_EQUAL_HEX8(PEL_OUT_SOLUTION, reader.id);
        pel_solution_t back;
        TEST_ASSERT_EQUAL_INT(PEL_OK, pel_out_decode_solution(reader.payload, reader.n, &back));
        TEST_ASSERT_EQUAL_INT64(T0, back.t_ns);
    }
    TEST_ASSERT_EQUAL_UINT32(10, reader.counters.frames);
    TEST_ASSERT_EQUAL_UINT32(10 * (uint32_t)n_text, reader.counters.noise_bytes);
    TEST_ASSERT_EQUAL_UINT32(0, reader.counters.bad_checksum);
}

static void sentences_fit_or_are_refused(void)
{
    const pel_solution_t s = {.t_ns = T0,
                              .fix = 3,
                              .flags = PEL_SOL_HEADING,
                              .lat_rad = -1.5,
                              .lon_rad = -3.1,
                              .height_m = -12345.6789,
                              .v_ned = {-300.0f, 400.0f, 0},
                              .heading_rad = -0.00001f,
                              .base_age_s = 99.9f,
                              .n_sat = 200};
    char text[256];
    size_t (*const make[])(const pel_solution_t *, char *, size_t) = {pel_nmea_gga, pel_nmea_rmc, pel_nmea_hdt};
    for (int i = 0; i < 3; i++) {
        const size_t n = make[i](&s, text, sizeof text);
        TEST_ASSERT_GREATER_THAN_size_t(10, n);
        TEST_ASSERT_LESS_THAN_size_t(128, n);
        TEST_ASSERT_EQUAL_size_t(n, strlen(text));
        TEST_ASSERT_EQUAL_STRING("\r\n", text + n - 2);
        for (size_t cap = 0; cap <= n; cap++) { TEST_ASSERT_EQUAL_size_t(0, make[i](&s, text, cap)); }
        TEST_ASSERT_EQUAL_size_t(n, make[i](&s, text, n + 1));
    }
    TEST_ASSERT_EQUAL_STRING_LEN("$GNHDT,0.00,T", text, 13); /* 359.9994 rounds to the circle's start */
}

static void a_snapshot_verdict_returns(void)
{
    pel_warm_report_t w = {.t_ns = 5, .verdict = PEL_SNAP_MOVED, .age_s = 60.5f, .count = {0, 1}}, back;
    w.count[PEL_SNAP_MOVED] = 1;
    const size_t n = pel_out_encode_warm(&w, frame, sizeof frame);
    TEST_ASSERT_EQUAL_UINT(13 + 4 * PEL_N_SNAP + PEL_OUT_OVERHEAD, n);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_out_decode_warm(frame + 6, n - PEL_OUT_OVERHEAD, &back));
    TEST_ASSERT_EQUAL_INT64(5, back.t_ns);
    TEST_ASSERT_EQUAL_UINT8(PEL_SNAP_MOVED, back.verdict);
    TEST_ASSERT_EQUAL_FLOAT(60.5f, back.age_s);
    TEST_ASSERT_EQUAL_UINT32_ARRAY(w.count, back.count, PEL_N_SNAP);
    TEST_ASSERT_EQUAL_INT(PEL_E_FORMAT, pel_out_decode_warm(frame + 6, n - PEL_OUT_OVERHEAD - 1, &back));
}

/* A payload of another length than its own is refused and leaves what was there; a buffer one byte too short takes nothing. */
static void lengths_are_exact(void)
{
    const pel_nav_counters_t nav = {.epochs_used = 7};
    const pel_wire_counters_t w = {.frames = 3};
    const pel_used_t used = {.t_ns = T0};
    const pel_event_t event = {.t_ns = T0};
    const pel_warm_report_t warm = {.t_ns = T0};
    for (int off = -1; off <= 1; off++) {
        pel_nav_counters_t nav_back = {.epochs_used = 99};
        pel_wire_counters_t w_back[3] = {{.frames = 99}, {0}, {0}};
        pel_used_t used_back = {.t_ns = 99};
        pel_event_t event_back = {.t_ns = 99};
        pel_warm_report_t warm_back = {.t_ns = 99};
        pel_time_t t = 99;
        const size_t more = (size_t)(off + 1);
        const pel_status_t want = (off == 0) ? PEL_OK : PEL_E_FORMAT;
        const int64_t time = (off == 0) ? T0 : 99;

        TEST_ASSERT_EQUAL_INT(COUNTERS_BYTES + 9, pel_out_encode_counters(&nav, &w, &w, &w, T0, frame, sizeof frame));
        TEST_ASSERT_EQUAL_INT(want, pel_out_decode_counters(frame + 6, COUNTERS_BYTES - 1 + more, &nav_back, &w_back[0],
                                                            &w_back[1], &w_back[2], &t));
        TEST_ASSERT_EQUAL_INT64(time, t);
        TEST_ASSERT_EQUAL_UINT32((off == 0) ? 7 : 99, nav_back.epochs_used);
        TEST_ASSERT_EQUAL_UINT32((off == 0) ? 3 : 99, w_back[0].frames);
        TEST_ASSERT_EQUAL_INT(USED_BYTES + 9, pel_out_encode_used(&used, frame, sizeof frame));
        TEST_ASSERT_EQUAL_INT(want, pel_out_decode_used(frame + 6, USED_BYTES - 1 + more, &used_back));
        TEST_ASSERT_EQUAL_INT64(time, used_back.t_ns);
        TEST_ASSERT_EQUAL_INT(EVENT_BYTES + 9, pel_out_encode_event(&event, frame, sizeof frame));
        TEST_ASSERT_EQUAL_INT(want, pel_out_decode_event(frame + 6, EVENT_BYTES - 1 + more, &event_back));
        TEST_ASSERT_EQUAL_INT64(time, event_back.t_ns);
        TEST_ASSERT_EQUAL_INT(WARM_BYTES + 9, pel_out_encode_warm(&warm, frame, sizeof frame));
        TEST_ASSERT_EQUAL_INT(want, pel_out_decode_warm(frame + 6, WARM_BYTES - 1 + more, &warm_back));
        TEST_ASSERT_EQUAL_INT64(time, warm_back.t_ns);
    }
    for (size_t cap = 0; cap < COUNTERS_BYTES + 9; cap++) {
        TEST_ASSERT_EQUAL_size_t(0, pel_out_encode_counters(&nav, &w, &w, &w, T0, frame, cap));
        TEST_ASSERT_EQUAL((cap < USED_BYTES + 9) ? 0 : USED_BYTES + 9, pel_out_encode_used(&used, frame, cap));
        TEST_ASSERT_EQUAL((cap < EVENT_BYTES + 9) ? 0 : EVENT_BYTES + 9, pel_out_encode_event(&event, frame, cap));
        TEST_ASSERT_EQUAL((cap < WARM_BYTES + 9) ? 0 : WARM_BYTES + 9, pel_out_encode_warm(&warm, frame, cap));
    }
}

static void a_report_of_satellites_is_as_long_as_its_count_says(void)
{
    const size_t bytes = 10u + 2u * PEL_OUT_SAT_BYTES;
    pel_time_t t = 99;
    int n = 99;
    memset(sats, 0, sizeof sats);
    for (size_t cap = 0; cap < bytes + PEL_OUT_OVERHEAD; cap++) {
        TEST_ASSERT_EQUAL_size_t(0, pel_out_encode_sats(T0, sats, 2, frame, cap));
    }
    TEST_ASSERT_EQUAL_size_t(bytes + PEL_OUT_OVERHEAD, pel_out_encode_sats(T0, sats, 2, frame, sizeof frame));
    for (size_t length = 0; length <= bytes + PEL_OUT_SAT_BYTES; length++) {
        if (length == bytes) { continue; }
        TEST_ASSERT_EQUAL_INT(PEL_E_FORMAT, pel_out_decode_sats(frame + 6, length, &t, sats_back, &n));
        TEST_ASSERT_EQUAL_INT64(99, t);
        TEST_ASSERT_EQUAL_INT(99, n);
    }
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_out_decode_sats(frame + 6, bytes, &t, sats_back, &n));
    TEST_ASSERT_EQUAL_INT(2, n);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(solutions_return);
    RUN_TEST(solution_offsets);
    RUN_TEST(used_counters_and_events_return);
    RUN_TEST(a_snapshot_verdict_returns);
    RUN_TEST(satellites_return);
    RUN_TEST(lengths_are_exact);
    RUN_TEST(a_report_of_satellites_is_as_long_as_its_count_says);
    RUN_TEST(the_reader_finds_frames_among_text);
    RUN_TEST(sentences_fit_or_are_refused);
    return UNITY_END();
}

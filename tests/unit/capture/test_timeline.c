/* test_timeline.c - lines in order of arrival; frames put between frames; raw streams stamped and unchanged. */
/* link: pel_capture */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelorus/wire.h"
#include "raw.h"
#include "support_capture.h"
#include "unity.h"

static tally_t tally;

void setUp(void)
{
    memset(&tally, 0, sizeof tally);
}
void tearDown(void) {}

static bool add(timeline_t *t, int64_t at, const char *s, bool ended)
{
    return timeline_add(t, at, (const uint8_t *)s, strlen(s), ended);
}

typedef struct {
    char text[256];
    int64_t last;
} sink_t;

static bool to_text(void *user, int line, pel_time_t t, const uint8_t *data, size_t n, double fraction)
{
    sink_t *s = user;
    const size_t used = strlen(s->text);
    snprintf(s->text + used, sizeof s->text - used, "%d%.*s ", line, (int)n, (const char *)data);
    TEST_ASSERT_TRUE(t >= s->last && fraction >= 0.0 && fraction <= 1.0);
    s->last = t;
    return true;
}

static void lines_merge_by_arrival_and_the_first_goes_first_at_equal_times(void)
{
    timeline_t line[2] = {{0}, {0}};
    sink_t s = {"", INT64_MIN};
    TEST_ASSERT_TRUE(add(&line[0], 5, "a", true) && add(&line[0], 7, "b", true) && add(&line[0], 6, "c", true));
    TEST_ASSERT_TRUE(add(&line[1], 4, "x", true) && add(&line[1], 7, "y", true) && add(&line[1], 8, "z", true));
    TEST_ASSERT_TRUE(timeline_merge(line, 2, to_text, &s));
    TEST_ASSERT_EQUAL_STRING("1x 0a 0b 0c 1y 1z ", s.text); /* c cannot arrive before b did */
    timeline_free(&line[0]);
    timeline_free(&line[1]);
}

static void a_frame_never_lands_inside_another(void)
{
    timeline_t line = {0}, extra = {0};
    sink_t s = {"", INT64_MIN};
    TEST_ASSERT_TRUE(add(&line, 5, "open", false) && add(&line, 6, "close", true) && add(&line, 9, "next", true));
    TEST_ASSERT_TRUE(add(&extra, 1, "E1", true) && add(&extra, 6, "E2", true) && add(&extra, 20, "E3", true));
    TEST_ASSERT_TRUE(timeline_inject(&line, &extra));
    TEST_ASSERT_TRUE(timeline_merge(&line, 1, to_text, &s));
    TEST_ASSERT_EQUAL_STRING("0E1 0open 0close 0E2 0next 0E3 ", s.text);
    timeline_free(&line);
    timeline_free(&extra);
}

/* A stream of RAWX frames with noise and a cut end, as a serial port recorded it. */
static size_t make_stream(uint8_t *out, size_t cap, pel_time_t t0, int n_epochs)
{
    static pel_epoch_t e;
    size_t n = 0;
    for (int i = 0; i < n_epochs; i++) {
        memset(&e, 0, sizeof e);
        e.t_ns = t0 + (pel_time_t)i * PEL_NS_PER_S;
        e.n = 1;
        e.obs[0].sys = PEL_SYS_GPS;
        e.obs[0].prn = 7;
        e.obs[0].code = 'C';
        e.obs[0].P_m = 2.2e7;
        e.obs[0].flags = PEL_OBS_CODE;
        memcpy(out + n, "$GNTXT,between*00\r\n", 19);
        n += 19;
        n += pel_ubx_encode_rawx(&e, 18, out + n, cap - n);
    }
    out[n++] = 0xB5;
    return n;
}

static void raw_bytes_pass_unchanged_and_arrive_with_their_epoch(void)
{
    static uint8_t bytes[8192];
    const pel_time_t t0 = INT64_C(1400000000) * PEL_NS_PER_S, latency = 50 * PEL_NS_PER_MS;
    input_t in = {bytes, make_stream(bytes, sizeof bytes, t0, 20), false};
    timeline_t line = {0};
    raw_times_t times;
    const char *why = "";
    TEST_ASSERT_TRUE(raw_receiver(&in, 0, latency, NULL, &tally, &line, &times, &why));
    TEST_ASSERT_EQUAL_UINT64(20, times.n);
    TEST_ASSERT_EQUAL_INT64(t0, times.first_ns);
    TEST_ASSERT_EQUAL_size_t(in.n, line.n_bytes);
    TEST_ASSERT_EQUAL_MEMORY(bytes, line.bytes, in.n);
    TEST_ASSERT_EQUAL_size_t(21, line.n);
    for (size_t i = 0; i < 20; i++) {
        TEST_ASSERT_EQUAL_INT64(t0 + (pel_time_t)i * PEL_NS_PER_S + latency, line.event[i].t_ns);
        TEST_ASSERT_TRUE(line.event[i].frame_ended);
    }
    timeline_free(&line);
}

static void tags_of_a_wrong_clock_are_moved_to_the_epochs(void)
{
    static uint8_t bytes[8192];
    const pel_time_t t0 = INT64_C(1400000000) * PEL_NS_PER_S, off = 3600 * PEL_NS_PER_S;
    input_t in = {bytes, make_stream(bytes, sizeof bytes, t0, 20), false};
    tag_t tag[21];
    tagfile_t tags = {tag, 20};
    timeline_t line = {0};
    raw_times_t times;
    const char *why = "";
    for (int i = 0; i < 20; i++) {
        tag[i] =
            (tag_t){t0 + off + (pel_time_t)i * PEL_NS_PER_S + 30 * PEL_NS_PER_MS, (in.n - 1) / 20 * (size_t)(i + 1)};
    }
    TEST_ASSERT_TRUE(raw_receiver(&in, 0, 50 * PEL_NS_PER_MS, &tags, &tally, &line, &times, &why));
    TEST_ASSERT_EQUAL_INT64(off - 20 * PEL_NS_PER_MS, times.tag_late_ns);
    TEST_ASSERT_EQUAL_INT64(t0 + 50 * PEL_NS_PER_MS, line.event[0].t_ns);
    TEST_ASSERT_EQUAL_size_t(in.n, line.n_bytes);
    timeline_free(&line);

    for (int i = 0; i < 20; i++) { tag[i].t_ns -= off; } /* a clock that is right is left alone */
    TEST_ASSERT_TRUE(raw_receiver(&in, 0, 50 * PEL_NS_PER_MS, &tags, &tally, &line, &times, &why));
    TEST_ASSERT_EQUAL_INT64(0, times.tag_late_ns);
    TEST_ASSERT_EQUAL_INT64(t0 + 30 * PEL_NS_PER_MS, line.event[0].t_ns);
    timeline_free(&line);
}

static void a_stream_without_time_is_refused_and_says_why(void)
{
    uint8_t bytes[] = "$GPGGA,no,observations*00\r\n";
    input_t in = {bytes, sizeof bytes - 1, false};
    timeline_t line = {0};
    raw_times_t times;
    const char *why = "";
    TEST_ASSERT_FALSE(raw_receiver(&in, 0, 0, NULL, &tally, &line, &times, &why));
    TEST_ASSERT_EQUAL_STRING("no epoch in it tells a time", why);
    timeline_free(&line);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(lines_merge_by_arrival_and_the_first_goes_first_at_equal_times);
    RUN_TEST(a_frame_never_lands_inside_another);
    RUN_TEST(raw_bytes_pass_unchanged_and_arrive_with_their_epoch);
    RUN_TEST(tags_of_a_wrong_clock_are_moved_to_the_epochs);
    RUN_TEST(a_stream_without_time_is_refused_and_says_why);
    return UNITY_END();
}

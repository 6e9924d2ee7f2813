/* test_rinex_nav.c - navigation files to ephemerides, and when each is sent. */
/* link: pel_capture */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calendar.h"
#include "pelorus/wire.h"
#include "rinex_header.h"
#include "rinex_nav.h"
#include "support_capture.h"
#include "unity.h"

static text_t text;
static tally_t tally;
static nav_set_t set;

void setUp(void)
{
    memset(&text, 0, sizeof text);
    memset(&tally, 0, sizeof tally);
    nav_set_init(&set);
}
void tearDown(void)
{
    nav_set_free(&set);
}

static pel_time_t at(int day, int hour, int minute, int64_t s)
{
    pel_time_t t = 0;
    TEST_ASSERT_TRUE(calendar_to_gps(2021, 9, day, hour, minute, s * PEL_NS_PER_S, CLOCK_GPS, &t));
    return t;
}

static void header(const char *version, const char *type)
{
    char line[64];
    snprintf(line, sizeof line, "%9s%11s%-40s", version, "", type);
    text_header(&text, line, "RINEX VERSION / TYPE");
}

/* A RINEX 3 record of day 22 (Wednesday, seconds of week from 259200) with toe and transmission in hours of that day. */
static void record(const char *sat, double toe_h, double tx_h, double source, double week)
{
    const double day = 3.0 * 86400.0;
    text_add(&text, "%s 2021 09 22 %02d %02d 00%19.12E%19.12E%19.12E\n", sat, (int)toe_h,
             (int)(60.0 * (toe_h - floor(toe_h))), 1e-5, 1e-12, 0.0);
    const double orbit[7][4] = {{56.0, 66.3125, 3.8e-9, -2.847},
                                {3.4e-6, 2.18e-3, 1.0e-5, 5153.58},
                                {day + 3600.0 * toe_h, 3.5e-8, 0.709, -3.2e-8},
                                {0.985, 197.1, -1.01, -7.66e-9},
                                {3.48e-10, source, week, 0.0},
                                {2.0, 0.0, 3.7e-9, 56.0},
                                {day + 3600.0 * tx_h, 4.0, 0.0, 0.0}};
    for (int i = 0; i < 7; i++) {
        text_add(&text, "    %19.12E%19.12E%19.12E%19.12E\n", orbit[i][0], orbit[i][1], orbit[i][2], orbit[i][3]);
    }
}

static void read_text(void)
{
    const char *why = "";
    const input_t in = text_input(&text);
    TEST_ASSERT_TRUE_MESSAGE(rinex_nav_read(&set, &in, &tally, &why), why);
}

static void times_of_each_system_are_gps_time(void)
{
    header("3.04", "N: GNSS NAV DATA    M: MIXED");
    text_header(&text, "", "END OF HEADER");
    record("G06", 2.0, 0.01, 1.0, 2176.0);
    record("E11", 2.0, 2.1, 517.0, 2176.0);
    record("C12", 2.0, 2.0, 0.0, 820.0);
    read_text();
    TEST_ASSERT_EQUAL_size_t(3, set.n);
    TEST_ASSERT_EQUAL_INT64(at(22, 2, 0, 0), set.record[0].eph.toe_ns);
    TEST_ASSERT_EQUAL_INT64(at(22, 0, 0, 36), set.record[0].t_tx_ns);
    TEST_ASSERT_EQUAL_INT64(at(22, 2, 0, 0), set.record[1].eph.toe_ns);
    TEST_ASSERT_EQUAL_INT64(at(22, 2, 0, 14), set.record[2].eph.toe_ns); /* BeiDou time + 14 s */
    TEST_ASSERT_EQUAL_INT64(at(22, 2, 0, 14), set.record[2].eph.toc_ns);
    TEST_ASSERT_EQUAL_UINT8(0, set.record[1].eph.source);
}

static void glonass_gives_orbits_and_channels_and_unknown_systems_are_counted(void)
{
    header("3.04", "N: GNSS NAV DATA    M: MIXED");
    text_header(&text, "", "END OF HEADER");
    text_add(&text, "R07 2021 09 22 00 15 00%19.12E%19.12E%19.12E\n", 1e-5, 0.0, 0.0);
    for (int i = 0; i < 3; i++) {
        text_add(&text, "    %19.12E%19.12E%19.12E%19.12E\n", 1.5e4 - i, 2.0 + i, 1e-9, (i == 1) ? -5.0 : 0.0);
    }
    text_add(&text, "R08 2021 09 22 00 15 00%19.12E%19.12E%19.12E\n", 1e-5, 0.0,
             0.0); /* without the line of the channel */
    text_add(&text, "    %19.12E%19.12E%19.12E%19.12E\n", 1.5e4, 2.0, 0.0, 0.0);
    text_add(&text, "I03 2021 09 22 00 15 00%19.12E%19.12E%19.12E\n", 1e-5, 0.0, 0.0);
    record("G06", 2.0, 0.01, 1.0, 2176.0);
    record("G06", 2.0, 0.01, 1.0, 2176.0);
    text.n -= 30; /* the last line is cut: still there but for fields that may be absent */
    read_text();
    TEST_ASSERT_EQUAL_size_t(2, set.n);
    const pel_ephemeris_t *e = &set.record[0].eph;
    TEST_ASSERT_EQUAL_UINT8(PEL_SYS_GLO, e->sys);
    TEST_ASSERT_EQUAL_UINT8(7, e->prn);
    TEST_ASSERT_EQUAL_INT64(at(22, 0, 15, 18), e->toe_ns); /* UTC + 18 s */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 14999e3, e->glo.r_e[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4000.0, e->glo.v_e[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1e-6, e->glo.a_e[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-18, 1e-5, e->af0);
    TEST_ASSERT_EQUAL_INT8(-5, e->glo.k);
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "ephemeris cut short"));
    TEST_ASSERT_EQUAL_INT8(-5, set.glo_k[7]);
    TEST_ASSERT_EQUAL_INT8(GLO_K_UNKNOWN, set.glo_k[8]);
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "SBAS, IRNSS and other orbits"));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "ephemeris that is there already"));
}

static void records_are_sent_when_a_running_receiver_would_have_them(void)
{
    nav_sent_t *sent = NULL;
    header("3.04", "N: GNSS NAV DATA    M: MIXED");
    text_header(&text, "", "END OF HEADER");
    record("G01", 2.0, 1.0, 1.0, 2176.0);   /* replaced before the start: not sent */
    record("G01", 6.0, 5.0, 1.0, 2176.0);   /* known at the start */
    record("G01", 8.0, 6.75, 1.0, 2176.0);  /* comes during the recording */
    record("G02", 8.0, 7.5, 1.0, 2176.0);   /* transmitted after the end of the recording, but valid and the only one */
    record("G03", 12.0, 10.0, 1.0, 2176.0); /* not valid before the end */
    record("E04", 6.0, 6.3, 258.0, 2176.0); /* F/NAV of a satellite with I/NAV */
    record("E04", 6.0, 6.3, 517.0, 2176.0);
    record("E05", 6.0, 6.3, 258.0, 2176.0); /* F/NAV alone */
    read_text();
    const size_t n = nav_set_schedule(&set, at(22, 6, 30, 0), at(22, 7, 0, 0), &tally, &sent);
    TEST_ASSERT_EQUAL_size_t(5, n);
    for (size_t i = 0; i < 4; i++) { TEST_ASSERT_EQUAL_INT64(at(22, 6, 30, 0), sent[i].t_ns); }
    TEST_ASSERT_EQUAL_INT64(at(22, 6, 0, 0), sent[0].eph->toe_ns);
    TEST_ASSERT_EQUAL_UINT8(2, sent[1].eph->prn);
    TEST_ASSERT_EQUAL_UINT8(4, sent[2].eph->prn);
    TEST_ASSERT_EQUAL_UINT8(0, sent[2].eph->source);
    TEST_ASSERT_EQUAL_UINT8(5, sent[3].eph->prn);
    TEST_ASSERT_EQUAL_INT64(at(22, 6, 45, 0), sent[4].t_ns);
    TEST_ASSERT_EQUAL_INT64(at(22, 8, 0, 0), sent[4].eph->toe_ns);
    free(sent);
}

/* GPSA, GPSB through subframe 4 page 18, whose steps are 2^-30 .. 2^-24 and 2^11 .. 2^16. */
static void ionosphere_of_the_header_reaches_the_firmware(void)
{
    static const double STEP[8] = {9.4e-10, 7.5e-9, 6.0e-8, 6.0e-8, 2048.0, 16384.0, 65536.0, 65536.0};
    static pel_receiver_t rx;
    uint8_t frame[128];
    pel_rx_event_t event = PEL_RX_NONE;
    header("3.04", "N: GNSS NAV DATA    M: MIXED");
    text_header(&text, "GPSA   8.3819E-09  1.4901E-08 -5.9605E-08 -5.9605E-08", "IONOSPHERIC CORR");
    text_header(&text, "GPSB   8.3968E+04  1.6384E+04 -1.3107E+05 -6.5536E+04", "IONOSPHERIC CORR");
    text_header(&text, "", "END OF HEADER");
    read_text();
    TEST_ASSERT_TRUE(set.klobuchar.valid);
    const size_t n = pel_ubx_encode_sfrbx_klobuchar(&set.klobuchar, 1, at(22, 6, 30, 0), frame, sizeof frame);
    pel_receiver_init(&rx);
    for (size_t i = 0; i < n; i++) { event = pel_receiver_push(&rx, frame[i]); }
    TEST_ASSERT_EQUAL_INT(PEL_RX_KLOBUCHAR, event);
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * STEP[i], (double)set.klobuchar.alpha[i], (double)rx.klobuchar.alpha[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * STEP[4 + i], (double)set.klobuchar.beta[i], (double)rx.klobuchar.beta[i]);
    }
}

static void no_truncation_and_no_damage_breaks_the_reader(void)
{
    static text_t whole;
    uint32_t state = 7;
    header("3.04", "N: GNSS NAV DATA    M: MIXED");
    text_header(&text, "GPSA   8.3819E-09  1.4901E-08 -5.9605E-08 -5.9605E-08", "IONOSPHERIC CORR");
    text_header(&text, "", "END OF HEADER");
    record("G06", 2.0, 0.01, 1.0, 2176.0);
    record("C12", 2.0, 2.0, 0.0, 820.0);
    whole = text;
    for (int run = 0; run < 4000; run++) {
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
        nav_set_t s;
        nav_sent_t *sent = NULL;
        nav_set_init(&s);
        if (rinex_nav_read(&s, &in, &tally, &why)) {
            (void)nav_set_schedule(&s, at(22, 1, 0, 0), at(22, 3, 0, 0), &tally, &sent);
        }
        free(sent);
        nav_set_free(&s);
        free(in.bytes);
    }
}

/* Every orbit of a recording, through its RTCM 3 frame and the firmware's decoder, is the broadcast one: its numbers are on the
 * grid of the message, so they come back to the last digit of the file. */
static void recordings_survive_the_frame(void)
{
    static const struct {
        const char *name;
        size_t n;
    } FILES[] = {{"geonet-0759-3040/07590920.05n", 162},
                 {"fujisawa-car-2021265/SEPT2650.21P.gz", 321},
                 {"attitude-static-099m-2024/base.nav.gz", 128},
                 {"hongkong-urban-2019/hksc1180.19n.gz", 203}};
    for (size_t f = 0; f < sizeof FILES / sizeof FILES[0]; f++) {
        char path[512];
        const char *why = "";
        input_t in;
        static pel_receiver_t rx;
        double worst_af0 = 0.0, worst_m0 = 0.0, worst_a = 0.0;
        if (!recording(FILES[f].name, path, sizeof path)) { TEST_IGNORE_MESSAGE("no recordings"); }
        nav_set_free(&set);
        nav_set_init(&set);
        TEST_ASSERT_EQUAL_INT(0, input_load(path, &in));
        const bool ok = rinex_nav_read(&set, &in, &tally, &why);
        input_free(&in);
        TEST_ASSERT_TRUE_MESSAGE(ok, why);
        TEST_ASSERT_EQUAL_size_t(FILES[f].n, set.n);
        TEST_ASSERT_TRUE(set.klobuchar.valid);
        for (size_t i = 0; i < set.n; i++) {
            const pel_ephemeris_t *a = &set.record[i].eph, *b = &rx.ephemeris;
            uint8_t frame[256];
            pel_rx_event_t event = PEL_RX_NONE;
            pel_receiver_init(&rx);
            pel_receiver_set_time(&rx, a->toe_ns);
            const size_t n = pel_rtcm3_encode_ephemeris(a, frame, sizeof frame);
            for (size_t k = 0; k < n; k++) { event = pel_receiver_push(&rx, frame[k]); }
            TEST_ASSERT_EQUAL_INT(PEL_RX_EPHEMERIS, event);
            TEST_ASSERT_TRUE(a->sys == b->sys && a->prn == b->prn && a->toe_ns == b->toe_ns && a->toc_ns == b->toc_ns);
            TEST_ASSERT_EQUAL_UINT16(a->iode, b->iode);
            if (a->sys != PEL_SYS_QZS) {
                TEST_ASSERT_EQUAL_INT(a->health != 0, b->health != 0);
            } /* QZSS: other signals too */
            worst_af0 = fmax(worst_af0, fabs(a->af0 - b->af0));
            if (a->sys == PEL_SYS_GLO) { /* twelve digits of km */
                for (int k = 0; k < 3; k++) { TEST_ASSERT_DOUBLE_WITHIN(6e-5, a->glo.r_e[k], b->glo.r_e[k]); }
                TEST_ASSERT_EQUAL_INT8(a->glo.k, b->glo.k);
                continue;
            }
            worst_m0 = fmax(worst_m0, fabs(a->M0 - b->M0));
            worst_a = fmax(worst_a, fabs(a->sqrt_a - b->sqrt_a));
        }
        printf("%-44s %3zu ephemerides, worst af0 %.1e s, M0 %.1e rad, sqrt(a) %.1e\n", FILES[f].name, set.n, worst_af0,
               worst_m0, worst_a);
        TEST_ASSERT_TRUE(worst_af0 < 1e-14 && worst_m0 < 1e-10 && worst_a < 1e-8);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(times_of_each_system_are_gps_time);
    RUN_TEST(glonass_gives_orbits_and_channels_and_unknown_systems_are_counted);
    RUN_TEST(records_are_sent_when_a_running_receiver_would_have_them);
    RUN_TEST(ionosphere_of_the_header_reaches_the_firmware);
    RUN_TEST(no_truncation_and_no_damage_breaks_the_reader);
    RUN_TEST(recordings_survive_the_frame);
    return UNITY_END();
}

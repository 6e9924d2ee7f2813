/* test_rinex_obs.c - what RINEX 2 and 3 observation files may say, one claim a test; and no bytes that break the reader. */
/* link: pel_capture */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelorus/wire.h"
#include "rinex_obs.h"
#include "support_capture.h"
#include "unity.h"

static text_t text;
static rinex_obs_t reader;
static tally_t tally;
static pel_epoch_t epoch;

void setUp(void)
{
    memset(&text, 0, sizeof text);
    memset(&tally, 0, sizeof tally);
}
void tearDown(void)
{
    rinex_obs_close(&reader);
}

static void open_text(void)
{
    const char *why = "";
    const input_t in = text_input(&text);
    TEST_ASSERT_TRUE_MESSAGE(rinex_obs_open(&reader, &in, &tally, &why), why);
}

static const pel_obs_t *find(uint8_t sys, uint8_t prn, uint8_t carrier)
{
    for (int i = 0; i < epoch.n; i++) {
        const pel_obs_t *o = &epoch.obs[i];
        if (o->sys == sys && o->prn == prn && o->carrier == carrier) { return o; }
    }
    return NULL;
}

static void header_v2(const char *types)
{
    text_header(&text, "     2.11           OBSERVATION DATA    M (MIXED)", "RINEX VERSION / TYPE");
    text_header(&text, types, "# / TYPES OF OBSERV");
}

static void header_v3(void)
{
    text_header(&text, "     3.04           OBSERVATION DATA    M", "RINEX VERSION / TYPE");
}
static void end_header(void)
{
    text_header(&text, "", "END OF HEADER");
}

/* ---- time ---------------------------------------------------------------------------------------------------------- */

static void time_tags_are_exact_to_the_last_digit_and_clock_offsets_are_not_applied(void)
{
    header_v2("     1    C1");
    end_header();
    text_add(&text, " 05  4  2  0 59 29.9960001  0  1G 3%33s 0.000123456\n", "");
    text_add(&text, "  24767686.375\n");
    open_text();
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    /* 2005-04-02 is day 9218 since 1980-01-06 */
    TEST_ASSERT_EQUAL_INT64(INT64_C(9218) * 86400000000000 + 3569996000100, epoch.t_ns);
}

static void glonass_and_beidou_time_become_gps_time(void)
{
    static const char *const NAME[] = {"GPS", "GLO", "BDT"};
    static const int64_t LATER_S[] = {0, 18, 14};
    for (int i = 0; i < 3; i++) {
        char first[64];
        setUp();
        header_v3();
        text_header(&text, "G    1 C1C", "SYS / # / OBS TYPES");
        snprintf(first, sizeof first, "  2020     1     2     0     0    0.0000000     %s", NAME[i]);
        text_header(&text, first, "TIME OF FIRST OBS");
        end_header();
        text_add(&text, "> 2020  1  2  0  0  0.0000000  0  1\nG03  24767686.375\n");
        open_text();
        TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
        TEST_ASSERT_EQUAL_INT64((INT64_C(14606) * 86400 + LATER_S[i]) * PEL_NS_PER_S, epoch.t_ns);
        rinex_obs_close(&reader);
    }
}

/* ---- RINEX 2 layout ------------------------------------------------------------------------------------------------ */

static void thirteen_satellites_and_six_types_continue_on_further_lines(void)
{
    header_v2("     6    C1    L1    D1    S1    P2    L2");
    end_header();
    text_add(&text, " 20  1  2  0  0  0.0000000  0 13");
    for (int i = 1; i <= 12; i++) { text_add(&text, "G%2d", i); }
    text_add(&text, "\n%32sG13\n", "");
    for (int i = 1; i <= 13; i++) {
        text_add(&text, "%14.3f 7%14.3f 6%14.3f  %14.3f  %14.3f 5\n%14.3f 4\n", 2e7 + i, 1e8 + i, -123.456, 44.0,
                 2e7 + i + 0.5, 8e7 + i + 0.25);
    }
    open_text();
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    TEST_ASSERT_EQUAL_INT(26, epoch.n);
    for (uint8_t i = 1; i <= 13; i++) {
        const pel_obs_t *l1 = find(PEL_SYS_GPS, i, PEL_CARRIER_L1), *l2 = find(PEL_SYS_GPS, i, PEL_CARRIER_L2);
        TEST_ASSERT_NOT_NULL(l1);
        TEST_ASSERT_NOT_NULL(l2);
        TEST_ASSERT_TRUE(l1->P_m == 2e7 + i && l1->L_cyc == 1e8 + i && l1->D_hz == -123.456f && l1->cn0_dbhz == 44.0f);
        TEST_ASSERT_TRUE(l2->P_m == 2e7 + i + 0.5 && l2->L_cyc == 8e7 + i + 0.25);
        TEST_ASSERT_EQUAL_CHAR('C', l1->code);
        TEST_ASSERT_EQUAL_CHAR('W', l2->code);
        TEST_ASSERT_FALSE(l2->flags & PEL_OBS_DOPPLER);
        TEST_ASSERT_EQUAL_FLOAT(27.0f, l2->cn0_dbhz); /* digit 4: 24..29 dB-Hz */
    }
}

static void p1_stands_in_where_c1_is_missing(void)
{
    header_v2("     3    C1    P1    L1");
    end_header();
    for (int i = 0; i < 30; i++) {
        text_add(&text, " 20  1  2  0  0 %2d.0000000  0  1G 3\n", i);
        if (i == 4) {
            text_add(&text, "%16s", "");
        } else {
            text_add(&text, "%14.3f  ", 2e7);
        }
        text_add(&text, "%14.3f  %14.3f\n", 2e7 + 1.0, 1e8 + i);
    }
    open_text();
    for (int i = 0; i < 30; i++) {
        TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
        TEST_ASSERT_EQUAL_INT(1, epoch.n);
        TEST_ASSERT_EQUAL_DOUBLE((i == 4) ? 2e7 + 1.0 : 2e7, epoch.obs[0].P_m);
        TEST_ASSERT_EQUAL_CHAR((i == 4) ? 'W' : 'C', epoch.obs[0].code);
        TEST_ASSERT_EQUAL_UINT32(1000u * (unsigned)i, epoch.obs[0].lock_ms); /* the phase is the same one: no slip */
    }
}

static void wavelength_factor_two_opens_the_half_cycle_of_the_satellites_named(void)
{
    header_v2("     2    C1    L1");
    text_header(&text, "     1     1", "WAVELENGTH FACT L1/2");
    text_header(&text, "     2     1     1   G07", "WAVELENGTH FACT L1/2");
    end_header();
    text_add(&text, " 20  1  2  0  0  0.0000000  0  2G 3G07\n");
    for (int i = 0; i < 2; i++) { text_add(&text, "%14.3f  %14.3f\n", 2e7, 1e8); }
    open_text();
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    TEST_ASSERT_FALSE(find(PEL_SYS_GPS, 3, PEL_CARRIER_L1)->flags & PEL_OBS_HALF_CYCLE);
    TEST_ASSERT_TRUE(find(PEL_SYS_GPS, 7, PEL_CARRIER_L1)->flags & PEL_OBS_HALF_CYCLE);
}

static void events_are_stepped_over_and_their_header_records_take_effect(void)
{
    header_v2("     1    C1");
    end_header();
    text_add(&text, " 20  1  2  0  0  0.0000000  0  1G 3\n%14.3f\n", 2.0e7);
    text_add(&text, "                            4  2\n");
    text_header(&text, "     2    L1    C1", "# / TYPES OF OBSERV");
    text_header(&text, "the antenna was moved", "COMMENT");
    text_add(&text, " 20  1  2  0  0  1.0000000  6  1G 3\n%14.3f  %14.3f\n", 1.0, 0.0);
    text_add(&text, " 20  1  2  0  0  1.0000000  5  0\n");
    text_add(&text, " 20  1  2  0  0  2.0000000  0  1G 3\n%14.3f  %14.3f\n", 1.1e8, 2.1e7);
    open_text();
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    TEST_ASSERT_EQUAL_DOUBLE(2.0e7, epoch.obs[0].P_m);
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    TEST_ASSERT_EQUAL_DOUBLE(2.1e7, epoch.obs[0].P_m);
    TEST_ASSERT_EQUAL_DOUBLE(1.1e8, epoch.obs[0].L_cyc);
    TEST_ASSERT_FALSE(rinex_obs_next(&reader, &epoch));
    TEST_ASSERT_EQUAL_UINT64(3, tally_get(&tally, "event records (epoch flags 2 to 6)"));
    TEST_ASSERT_EQUAL_UINT64(0, tally_refused(&tally));
}

/* ---- lock ---------------------------------------------------------------------------------------------------------- */

static void lock_time_restarts_at_lli_power_failure_and_gaps(void)
{
    static const int LLI[] = {0, 0, 1, 0, 0, 0, 0, 0}, FLAG[] = {0, 0, 0, 0, 1, 0, 0, 0};
    static const bool HERE[] = {true, true, true, true, true, true, false, true};
    static const unsigned LOCK_S[] = {0, 1, 0, 1, 0, 1, 0, 0};
    header_v3();
    text_header(&text, "G    2 C1C L1C", "SYS / # / OBS TYPES");
    end_header();
    for (int i = 0; i < 8; i++) {
        text_add(&text, "> 2020 01 02 00 00 %02d.0000000  %d  2\n", i, FLAG[i]);
        if (HERE[i]) {
            text_add(&text, "G03%14.3f  %14.3f%d\n", 2e7, 1e8 + i, LLI[i]);
        } else {
            text_add(&text, "G03%14.3f\n", 2e7);
        }
        text_add(&text, "E11%14.3f\n", 2e7);
    }
    open_text();
    for (int i = 0; i < 8; i++) {
        TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
        const pel_obs_t *o = find(PEL_SYS_GPS, 3, PEL_CARRIER_L1);
        TEST_ASSERT_NOT_NULL(o);
        if (HERE[i]) { TEST_ASSERT_EQUAL_UINT32(1000u * LOCK_S[i], o->lock_ms); }
        TEST_ASSERT_EQUAL_INT(HERE[i] && LOCK_S[i] == 0, (o->flags & PEL_OBS_SLIP) != 0);
        TEST_ASSERT_NULL(find(PEL_SYS_GAL, 11, PEL_CARRIER_L1)); /* no columns named for E */
    }
}

static void lli_bit_one_is_the_half_cycle(void)
{
    header_v3();
    text_header(&text, "G    2 C1C L1C", "SYS / # / OBS TYPES");
    end_header();
    text_add(&text, "> 2020 01 02 00 00  0.0000000  0  1\nG03%14.3f  %14.3f2\n", 2e7, 1e8);
    text_add(&text, "> 2020 01 02 00 00  1.0000000  0  1\nG03%14.3f  %14.3f \n", 2e7, 1e8);
    open_text();
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    TEST_ASSERT_TRUE(epoch.obs[0].flags & PEL_OBS_HALF_CYCLE);
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    TEST_ASSERT_FALSE(epoch.obs[0].flags & PEL_OBS_HALF_CYCLE);
}

/* ---- RINEX 3 columns ----------------------------------------------------------------------------------------------- */

static void types_continue_scale_is_divided_out_and_unknown_columns_are_skipped(void)
{
    header_v3();
    text_header(&text, "G   15 X1  C1C L1C D1C S1C C1W S1W C2W L2W S2W C2L L2L S2L", "SYS / # / OBS TYPES");
    text_header(&text, "       C5Q L5Q", "SYS / # / OBS TYPES");
    text_header(&text, "R    2 C3X L3X", "SYS / # / OBS TYPES");
    text_header(&text, "G  100   2 L5Q D1C", "SYS / SCALE FACTOR");
    end_header();
    text_add(&text, "> 2020 01 02 00 00  0.0000000  0  2\nG03%14.3f  ", 9.0);
    text_add(&text, "%14.3f  %14.3f  %14.3f  %14.3f  ", 2.0e7, 1.1e8, -50000.0, 40.0);
    text_add(&text, "%14.3f  %14.3f  %14.3f  %14.3f  %14.3f  ", 2.1e7, 30.0, 2.2e7, 8.0e7, 31.0);
    text_add(&text, "%14.3f  %14.3f  %14.3f  %14.3f  %14.3f\n", 2.3e7, 8.1e7, 45.0, 2.4e7, 7.7e9);
    text_add(&text, "R03%14.3f  %14.3f\n", 2.0e7, 1.0e8);
    open_text();
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    TEST_ASSERT_EQUAL_INT(3, epoch.n);
    const pel_obs_t *l1 = find(PEL_SYS_GPS, 3, PEL_CARRIER_L1), *l2 = find(PEL_SYS_GPS, 3, PEL_CARRIER_L2),
                    *l5 = find(PEL_SYS_GPS, 3, PEL_CARRIER_L5);
    TEST_ASSERT_EQUAL_DOUBLE(2.0e7, l1->P_m);
    TEST_ASSERT_EQUAL_FLOAT(-500.0f, l1->D_hz);
    TEST_ASSERT_EQUAL_FLOAT(40.0f, l1->cn0_dbhz);
    TEST_ASSERT_EQUAL_DOUBLE(2.2e7, l2->P_m); /* W before L where both are complete */
    TEST_ASSERT_EQUAL_CHAR('W', l2->code);
    TEST_ASSERT_EQUAL_DOUBLE(7.7e7, l5->L_cyc);
}

static void the_more_complete_code_is_taken_and_kept(void)
{
    header_v3();
    text_header(&text, "G    4 C2W L2W C2L L2L", "SYS / # / OBS TYPES");
    end_header();
    for (int i = 0; i < 20; i++) {
        text_add(&text, "> 2020 01 02 00 00 %02d.0000000  0  2\n", i);
        /* G03: W misses half the phases. G05: one, which is within 5 %. */
        text_add(&text, "G03%14.3f  %14.*f  %14.3f  %14.3f\n", 2.1e7, (i % 2) ? 3 : 0, (i % 2) ? 8e7 : 0.0, 2.2e7,
                 8.1e7);
        text_add(&text, "G05%14.3f  %14.*f  %14.3f  %14.3f\n", 2.1e7, (i != 7) ? 3 : 0, (i != 7) ? 8e7 : 0.0, 2.2e7,
                 8.1e7);
    }
    open_text();
    for (int i = 0; i < 20; i++) {
        TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
        TEST_ASSERT_EQUAL_CHAR('L', find(PEL_SYS_GPS, 3, PEL_CARRIER_L2)->code);
        TEST_ASSERT_EQUAL_CHAR('W', find(PEL_SYS_GPS, 5, PEL_CARRIER_L2)->code);
    }
}

static void more_signals_than_fit_lose_glonass_and_third_carriers_first(void)
{
    header_v3();
    text_header(&text, "G    3 C1C C2W C5Q", "SYS / # / OBS TYPES");
    text_header(&text, "R    1 C1C", "SYS / # / OBS TYPES");
    text_header(&text, "C    3 C2I C7I C6I", "SYS / # / OBS TYPES");
    text_header(&text, "  1 R05 -3", "GLONASS SLOT / FRQ #");
    end_header();
    text_add(&text, "> 2020 01 02 00 00  0.0000000  0 %d\n", 32 + 1 + 20);
    text_add(&text, "R05%14.3f\n", 2e7);
    for (int i = 1; i <= 32; i++) { text_add(&text, "G%02d%14.3f  %14.3f  %14.3f\n", i, 2e7, 2e7, 2e7); }
    for (int i = 1; i <= 20; i++) { text_add(&text, "C%02d%14.3f  %14.3f  %14.3f\n", i, 2e7, 2e7, 2e7); }
    open_text();
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    const int total = 3 * 32 + 1 + 3 * 20;
    TEST_ASSERT_EQUAL_INT(PEL_MAX_OBS, epoch.n);
    TEST_ASSERT_EQUAL_INT(total - PEL_MAX_OBS, epoch.dropped);
    TEST_ASSERT_NULL(find(PEL_SYS_GLO, 5, PEL_CARRIER_L1));
    for (uint8_t i = 1; i <= 32; i++) { TEST_ASSERT_NOT_NULL(find(PEL_SYS_GPS, i, PEL_CARRIER_L2)); }
    for (uint8_t i = 1; i <= 20; i++) { TEST_ASSERT_NOT_NULL(find(PEL_SYS_BDS, i, PEL_CARRIER_B3I)); }
}

/* ---- damage -------------------------------------------------------------------------------------------------------- */

static void a_damaged_date_costs_one_epoch(void)
{
    header_v3();
    text_header(&text, "G    1 C1C", "SYS / # / OBS TYPES");
    end_header();
    for (int i = 0; i < 10; i++) {
        text_add(&text, "> 20%d 01 02 00 00 %02d.0000000  0  1\nG03%14.3f\n", (i == 4) ? 29 : 20, i, 2e7);
    }
    open_text();
    int n = 0;
    while (rinex_obs_next(&reader, &epoch)) { n++; }
    TEST_ASSERT_EQUAL_INT(9, n);
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "epoch out of order"));
}

static void missing_satellites_and_bad_numbers_are_counted_and_the_rest_read(void)
{
    header_v3();
    text_header(&text, "G    2 C1C L1C", "SYS / # / OBS TYPES");
    end_header();
    text_add(&text, "> 2020 01 02 00 00  0.0000000  0  3\nG03  20000000.0x0  %14.3f\n", 1e8);
    text_add(&text, "> 2020 01 02 00 00  1.0000000  0  1\nG03%14.3f\n", 2e7);
    open_text();
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    TEST_ASSERT_EQUAL_UINT8(PEL_OBS_PHASE | PEL_OBS_SLIP, epoch.obs[0].flags);
    TEST_ASSERT_TRUE(rinex_obs_next(&reader, &epoch));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "value is not a number"));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "epoch with fewer satellites than it says"));
}

/* Small deterministic noise. */
static uint32_t noise_state = 1;
static uint32_t noise(void)
{
    noise_state ^= noise_state << 13;
    noise_state ^= noise_state >> 17;
    noise_state ^= noise_state << 5;
    return noise_state;
}

static void no_truncation_and_no_damage_breaks_the_reader(void)
{
    static text_t whole;
    thirteen_satellites_and_six_types_continue_on_further_lines();
    rinex_obs_close(&reader);
    text_add(&text, "                            4  1\n");
    text_header(&text, "    99    L1    C1    P1", "# / TYPES OF OBSERV");
    text_add(&text, " 20  1  2  0  0  2.0000000  0  1G 3\n%14.3f  %14.3f\n", 1.1e8, 2.1e7);
    whole = text;
    for (int run = 0; run < 6000; run++) {
        const char *why = "";
        text = whole;
        if (run < 1500) {
            text.n = (size_t)run * whole.n / 1500;
        } else {
            for (int i = 0; i < 8; i++) { text.text[noise() % text.n] = (char)noise(); }
        }
        input_t in = text_input(&text);
        in.bytes = malloc(text.n + 1); /* exactly as long as it is, for the sanitizer */
        TEST_ASSERT_NOT_NULL(in.bytes);
        memcpy(in.bytes, text.text, text.n);
        memset(&tally, 0, sizeof tally);
        if (rinex_obs_open(&reader, &in, &tally, &why)) {
            while (rinex_obs_next(&reader, &epoch)) { TEST_ASSERT_TRUE(epoch.n <= PEL_MAX_OBS); }
        }
        rinex_obs_close(&reader);
        free(in.bytes);
    }
}

/* ---- recordings ---------------------------------------------------------------------------------------------------- */

/* What the reader says, through a RAWX frame and the firmware's decoder, is what it said: but for C/N0, which a frame holds in
 * whole dB-Hz, Doppler where the file has none, and lock times beyond 65.5 s. */
static int half_cycles; /* epochs whose first signal has its half cycle open */

static void every_epoch_survives_the_frame(const char *name, int expected_epochs)
{
    char path[512];
    if (!recording(name, path, sizeof path)) { TEST_IGNORE_MESSAGE("no recordings"); }
    input_t in;
    const char *why = "";
    static pel_receiver_t rx;
    static uint8_t frame[PEL_RAWX_FRAME_BYTES];
    int n_epochs = 0, n_signals = 0;
    half_cycles = 0;
    TEST_ASSERT_EQUAL_INT(0, input_load(path, &in));
    TEST_ASSERT_TRUE_MESSAGE(rinex_obs_open(&reader, &in, &tally, &why), why);
    pel_receiver_init(&rx);
    while (rinex_obs_next(&reader, &epoch)) {
        const size_t n = pel_ubx_encode_rawx(&epoch, pel_time_leap_s(epoch.t_ns), frame, sizeof frame);
        pel_rx_event_t event = PEL_RX_NONE;
        for (size_t i = 0; i < n; i++) { event = pel_receiver_push(&rx, frame[i]); }
        TEST_ASSERT_EQUAL_INT(PEL_RX_EPOCH, event);
        TEST_ASSERT_EQUAL_INT64(epoch.t_ns, rx.epoch.t_ns);
        TEST_ASSERT_EQUAL_INT(epoch.n, rx.epoch.n);
        for (int i = 0; i < epoch.n; i++) {
            const pel_obs_t *a = &epoch.obs[i], *b = NULL;
            for (int k = 0; k < rx.epoch.n; k++) {
                const pel_obs_t *o = &rx.epoch.obs[k];
                if (o->sys == a->sys && o->prn == a->prn && o->carrier == a->carrier) { b = o; }
            }
            const uint8_t flags = PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER;
            TEST_ASSERT_NOT_NULL(b);
            TEST_ASSERT_EQUAL_HEX8(a->flags & flags, b->flags & flags);
            if (a->flags & PEL_OBS_CODE) { TEST_ASSERT_TRUE(a->P_m == b->P_m); }
            if (a->flags & PEL_OBS_PHASE) {
                TEST_ASSERT_TRUE(a->L_cyc == b->L_cyc);
                TEST_ASSERT_EQUAL_HEX8(a->flags & PEL_OBS_HALF_CYCLE, b->flags & PEL_OBS_HALF_CYCLE);
                TEST_ASSERT_EQUAL_UINT32((a->lock_ms > 65535) ? 65535 : a->lock_ms, b->lock_ms);
            }
            if (a->flags & PEL_OBS_DOPPLER) { TEST_ASSERT_TRUE(a->D_hz == b->D_hz); }
            n_signals++;
        }
        n_epochs++;
        half_cycles += (epoch.n > 0) ? (epoch.obs[0].flags & PEL_OBS_HALF_CYCLE) != 0 : 0;
    }
    input_free(&in);
    TEST_ASSERT_EQUAL_INT(expected_epochs, n_epochs);
    printf("%-48s %5d epochs %6d signals bit-identical through RXM-RAWX\n", name, n_epochs, n_signals);
}

static void geonet_rinex_2(void)
{
    every_epoch_survives_the_frame("geonet-0759-3040/07590920.05o", 120);
}
static void yamatogawa_half_cycles(void)
{
    every_epoch_survives_the_frame("yamatogawa-kinematic-2010/yamatogawa_rover.obs", 203);
    TEST_ASSERT_EQUAL_INT(203, half_cycles); /* its header says wavelength factor 2 */
}
static void fujisawa_rinex_3(void)
{
    every_epoch_survives_the_frame("fujisawa-car-2021265/SEPT265G.21O.gz", 360);
}
static void attitude_five_systems(void)
{
    every_epoch_survives_the_frame("attitude-static-099m-2024/ant2_rover.obs.gz", 301);
}
static void hongkong_urban(void)
{
    every_epoch_survives_the_frame("hongkong-urban-2019/rover.obs.gz", 1760);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(time_tags_are_exact_to_the_last_digit_and_clock_offsets_are_not_applied);
    RUN_TEST(glonass_and_beidou_time_become_gps_time);
    RUN_TEST(thirteen_satellites_and_six_types_continue_on_further_lines);
    RUN_TEST(p1_stands_in_where_c1_is_missing);
    RUN_TEST(wavelength_factor_two_opens_the_half_cycle_of_the_satellites_named);
    RUN_TEST(events_are_stepped_over_and_their_header_records_take_effect);
    RUN_TEST(lock_time_restarts_at_lli_power_failure_and_gaps);
    RUN_TEST(lli_bit_one_is_the_half_cycle);
    RUN_TEST(types_continue_scale_is_divided_out_and_unknown_columns_are_skipped);
    RUN_TEST(the_more_complete_code_is_taken_and_kept);
    RUN_TEST(more_signals_than_fit_lose_glonass_and_third_carriers_first);
    RUN_TEST(a_damaged_date_costs_one_epoch);
    RUN_TEST(missing_satellites_and_bad_numbers_are_counted_and_the_rest_read);
    RUN_TEST(no_truncation_and_no_damage_breaks_the_reader);
    RUN_TEST(geonet_rinex_2);
    RUN_TEST(yamatogawa_half_cycles);
    RUN_TEST(fujisawa_rinex_3);
    RUN_TEST(attitude_five_systems);
    RUN_TEST(hongkong_urban);
    return UNITY_END();
}

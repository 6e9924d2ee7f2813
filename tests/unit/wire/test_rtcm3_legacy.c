/* RTCM 3 messages 1004 and 1012 bit by bit: marks that mean "none", foreign satellites, senders of MSM as well, the encoder's limits. */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/wire/navmsg.h"
#include "support_wire.h"
#include "unity.h"

#define S        PEL_NS_PER_S
#define MS_M     (PEL_SPEED_OF_LIGHT * 1e-3)
#define NO_PHASE (-524288)

static pel_receiver_t rx;
static pel_epoch_t epoch;
static uint8_t frame[PEL_MAX_FRAME_BYTES];
static uint8_t *const message = frame + 3;

void setUp(void)
{
    pel_receiver_init(&rx);
    pel_receiver_set_time(&rx, T0);
}
void tearDown(void) {}

/* One satellite as it is sent. Range: 21 000 km, of which whole milliseconds apart. */
typedef struct {
    unsigned sv, code_1, code_2, channel;
    uint32_t range;
    int32_t phase_1, range_2, phase_2;
} sat_t;

static const sat_t GPS_SAT = {.sv = 9, .code_2 = 3, .range = 1000, .phase_1 = 100, .range_2 = 50, .phase_2 = -100};
static const sat_t GLO_SAT = {.sv = 5, .channel = 10, .range = 1000, .phase_1 = 100, .range_2 = 50, .phase_2 = -100};

static size_t message_of(bool glonass, pel_time_t t, const sat_t *s, int n, bool more)
{
    pel_bit_writer_t w;
    pel_bit_writer_init(&w, message, 1000);
    pel_write_u(&w, 12, glonass ? 1012 : 1004);
    pel_write_u(&w, 12, 77);
    if (glonass) {
        pel_write_u(&w, 27, (uint64_t)(pel_moscow_from_gps(t) % (86400 * S) / PEL_NS_PER_MS));
    } else {
        pel_write_u(&w, 30, (uint64_t)(t % PEL_NS_PER_WEEK / PEL_NS_PER_MS));
    }
    pel_write_u(&w, 1, more ? 1 : 0);
    pel_write_u(&w, 5, (uint64_t)n);
    pel_write_u(&w, 4, 0);
    for (int i = 0; i < n; i++) {
        pel_write_u(&w, 6, s[i].sv);
        pel_write_u(&w, 1, s[i].code_1);
        if (glonass) { pel_write_u(&w, 5, s[i].channel); }
        pel_write_u(&w, glonass ? 25 : 24, s[i].range);
        pel_write_s(&w, 20, s[i].phase_1);
        pel_write_u(&w, 7, 30);
        pel_write_u(&w, glonass ? 7 : 8, glonass ? 35 : 70);
        pel_write_u(&w, 8, 160);
        pel_write_u(&w, 2, s[i].code_2);
        pel_write_s(&w, 14, s[i].range_2);
        pel_write_s(&w, 20, s[i].phase_2);
        pel_write_u(&w, 7, 127);
        pel_write_u(&w, 8, 120);
    }
    TEST_ASSERT_FALSE(w.overrun || w.out_of_range);
    return w.pos;
}

static int push_sat(sat_t s, bool glonass)
{
    return support_push_rtcm3(&rx, frame, message_of(glonass, T0, &s, 1, false), PEL_RX_EPOCH);
}

/* 1012 needs a day: an epoch of Galileo a second before. */
static void tell_the_day(void)
{
    setUp();
    support_push_msm7(&rx, T0 - S, PEL_SYS_GAL, false);
}

static void a_satellite_gives_two_signals_with_their_lock_and_strength(void)
{
    TEST_ASSERT_EQUAL_INT(1, push_sat(GPS_SAT, false));
    TEST_ASSERT_EQUAL_UINT16(2, rx.epoch.n);
    const pel_obs_t *o = rx.epoch.obs;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 70 * MS_M + 20.0, o[0].P_m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 70 * MS_M + 21.0, o[1].P_m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 70 * MS_M + 20.05, o[0].L_cyc * PEL_SPEED_OF_LIGHT / 1575.42e6);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 70 * MS_M + 19.95, o[1].L_cyc * PEL_SPEED_OF_LIGHT / 1227.60e6);
    TEST_ASSERT_EQUAL_UINT32(36000, o[0].lock_ms); /* DF013: 30 is in the second block, 24 + 2 (30 - 24) */
    TEST_ASSERT_EQUAL_UINT32(937000, o[1].lock_ms);
    TEST_ASSERT_EQUAL_FLOAT(40.0f, o[0].cn0_dbhz);
    TEST_ASSERT_EQUAL_FLOAT(30.0f, o[1].cn0_dbhz);
}

static void marks_for_none_leave_parts_out_or_all_of_them(void)
{
    for (int glonass = 0; glonass < 2; glonass++) {
        static const struct {
            bool range, phase_1, range_2, phase_2; /* there */
            uint16_t n;
            uint8_t flags[2];
        } CASE[] = {
            {true, true, true, true, 2, {PEL_OBS_CODE | PEL_OBS_PHASE, PEL_OBS_CODE | PEL_OBS_PHASE}},
            {true, false, true, true, 2, {PEL_OBS_CODE, PEL_OBS_CODE | PEL_OBS_PHASE}},
            {true, true, false, true, 2, {PEL_OBS_CODE | PEL_OBS_PHASE, PEL_OBS_PHASE}},
            {true, true, true, false, 2, {PEL_OBS_CODE | PEL_OBS_PHASE, PEL_OBS_CODE}},
            {true, true, false, false, 1, {PEL_OBS_CODE | PEL_OBS_PHASE, 0}},
            {false, true, true, true, 0, {0, 0}}, /* everything else is relative to it */
        };
        for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
            sat_t s = (glonass != 0) ? GLO_SAT : GPS_SAT;
            tell_the_day();
            if (!CASE[i].range) { s.range = (glonass != 0) ? 0x1FFFFFFu : 0xFFFFFFu; }
            if (!CASE[i].phase_1) { s.phase_1 = NO_PHASE; }
            if (!CASE[i].range_2) { s.range_2 = -8192; }
            if (!CASE[i].phase_2) { s.phase_2 = NO_PHASE; }
            TEST_ASSERT_EQUAL_INT((CASE[i].n > 0) ? 1 : 0, push_sat(s, glonass != 0));
            TEST_ASSERT_EQUAL_UINT16(CASE[i].n, rx.epoch.n);
            TEST_ASSERT_EQUAL_UINT32(0, rx.counters.bad_value);
            for (int k = 0; k < (int)CASE[i].n; k++) {
                TEST_ASSERT_EQUAL_HEX8(CASE[i].flags[k], rx.epoch.obs[k].flags);
            }
        }
    }
}

/* 40 to 58 are SBAS with one carrier; between GPS's 32 and them, and beyond, is nobody. */
static void satellites_of_1004_are_gps_or_sbas(void)
{
    static const struct {
        unsigned sv;
        uint16_t n;
        uint8_t sys, prn;
    } CASE[] = {{1, 2, PEL_SYS_GPS, 1},  {32, 2, PEL_SYS_GPS, 32}, {33, 0, 0, 0}, {39, 0, 0, 0}, {0, 0, 0, 0},
                {40, 1, PEL_SYS_SBS, 1}, {58, 1, PEL_SYS_SBS, 19}, {59, 0, 0, 0}, {63, 0, 0, 0}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        sat_t s = GPS_SAT;
        setUp();
        s.sv = CASE[i].sv;
        (void)push_sat(s, false);
        TEST_ASSERT_EQUAL_UINT16(CASE[i].n, rx.epoch.n);
        TEST_ASSERT_EQUAL_UINT32((CASE[i].n > 0) ? 0 : 2, rx.counters.bad_value);
        if (CASE[i].n == 0) { continue; }
        TEST_ASSERT_EQUAL_UINT8(CASE[i].sys, rx.epoch.obs[0].sys);
        TEST_ASSERT_EQUAL_UINT8(CASE[i].prn, rx.epoch.obs[0].prn);
    }
}

static void codes_are_those_of_the_indicators(void)
{
    static const char L2[4] = {'X', 'P', 'W', 'W'};
    for (unsigned i = 0; i < 4; i++) {
        sat_t s = GPS_SAT;
        setUp();
        s.code_1 = i % 2;
        s.code_2 = i;
        TEST_ASSERT_EQUAL_INT(1, push_sat(s, false));
        TEST_ASSERT_EQUAL_CHAR((i % 2 == 0) ? 'C' : 'W', rx.epoch.obs[0].code);
        TEST_ASSERT_EQUAL_CHAR(L2[i], rx.epoch.obs[1].code);
        s = GLO_SAT;
        tell_the_day();
        s.code_1 = i % 2;
        s.code_2 = i;
        TEST_ASSERT_EQUAL_INT(1, push_sat(s, true));
        TEST_ASSERT_EQUAL_CHAR((i % 2 == 0) ? 'C' : 'P', rx.epoch.obs[0].code);
        TEST_ASSERT_EQUAL_CHAR((i == 0) ? 'C' : 'P', rx.epoch.obs[1].code);
    }
}

/* Beside an MSM of the same system the satellites are left out for a minute; those of other systems are not. */
static void what_an_msm_tells_is_not_taken_again(void)
{
    const sat_t sats[2] = {GPS_SAT, {.sv = 40, .range = 1000}};
    for (int after_s = 59; after_s <= 60; after_s++) {
        setUp();
        support_push_msm7(&rx, T0, PEL_SYS_GPS, false);
        TEST_ASSERT_EQUAL_INT(
            1, support_push_rtcm3(&rx, frame, message_of(false, T0 + after_s * S, sats, 2, false), PEL_RX_EPOCH));
        TEST_ASSERT_EQUAL_UINT16((after_s < 60) ? 1 : 3, rx.epoch.n);
        TEST_ASSERT_EQUAL_UINT8((after_s < 60) ? PEL_SYS_SBS : PEL_SYS_GPS, rx.epoch.obs[0].sys);
        TEST_ASSERT_EQUAL_UINT32((after_s < 60) ? 1 : 0, rx.counters.duplicate);
        setUp();
        support_push_msm7(&rx, T0, PEL_SYS_GLO, false);
        const size_t n = message_of(true, T0 + after_s * S, &GLO_SAT, 1, false);
        TEST_ASSERT_EQUAL_INT((after_s < 60) ? 0 : 1, support_push_rtcm3(&rx, frame, n, PEL_RX_EPOCH));
    }
}

static void a_message_shorter_than_its_satellites_is_refused(void)
{
    sat_t sats[8];
    for (int i = 0; i < 8; i++) { sats[i] = GPS_SAT; }
    TEST_ASSERT_EQUAL_size_t(8 * 133, message_of(false, T0, sats, 8, false)); /* eight end with a byte */
    TEST_ASSERT_EQUAL_INT(1, support_push_rtcm3(&rx, frame, 8 * 133, PEL_RX_EPOCH));
    for (int glonass = 0; glonass < 2; glonass++) {
        for (size_t cut = 0; cut < 2; cut++) {
            tell_the_day();
            const size_t n = (message_of(glonass != 0, T0, sats, 2, false) + 7) / 8;
            (void)support_push_rtcm3(&rx, frame, 8 * (n - cut), PEL_RX_EPOCH);
            TEST_ASSERT_EQUAL_UINT32((cut == 0) ? 0 : 1, rx.counters.bad_length);
            (void)message_of(glonass != 0, T0, sats, 0, false);
            (void)support_push_rtcm3(&rx, frame, 56, PEL_RX_EPOCH); /* not even a header */
            TEST_ASSERT_EQUAL_UINT32((cut == 0) ? 1 : 2, rx.counters.bad_length);
        }
    }
}

static void without_a_week_or_a_day_there_is_no_time(void)
{
    pel_receiver_init(&rx);
    TEST_ASSERT_EQUAL_INT(0, push_sat(GPS_SAT, false));
    TEST_ASSERT_EQUAL_INT(0, push_sat(GLO_SAT, true));
    TEST_ASSERT_EQUAL_UINT32(2, rx.counters.unknown);
    /* the epoch that is being collected tells the day as well as one that was given */
    setUp();
    support_push_msm7(&rx, T0, PEL_SYS_GAL, true);
    TEST_ASSERT_EQUAL_INT(1, push_sat(GLO_SAT, true));
    TEST_ASSERT_EQUAL_UINT16(6, rx.epoch.n);
}

static void a_day_may_have_a_leap_second_and_no_more(void)
{
    for (uint32_t extra = 0; extra < 2; extra++) {
        tell_the_day();
        const size_t n = message_of(true, T0, &GLO_SAT, 1, false);
        pel_bits_put(message, 24, 27, 86400999u + extra);
        (void)support_push_rtcm3(&rx, frame, n, PEL_RX_EPOCH);
        TEST_ASSERT_EQUAL_UINT32(extra, rx.counters.bad_value);
    }
}

static void more_of_the_same_epoch_may_follow(void)
{
    tell_the_day();
    TEST_ASSERT_EQUAL_INT(0, support_push_rtcm3(&rx, frame, message_of(false, T0, &GPS_SAT, 1, true), PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_INT(0, support_push_rtcm3(&rx, frame, message_of(true, T0, &GLO_SAT, 1, true), PEL_RX_EPOCH));
    support_push_msm7(&rx, T0, PEL_SYS_GAL, false);
    TEST_ASSERT_EQUAL_UINT16(8, rx.epoch.n);
    TEST_ASSERT_FALSE(rx.collecting);
}

/* ---- encoder --------------------------------------------------------------------------------------------------------- */

static int round_trip(bool more)
{
    setUp();
    return support_push(&rx, frame, pel_rtcm3_encode_1004(&epoch, 77, more, frame, sizeof frame), PEL_RX_EPOCH);
}

static void what_a_satellite_lacks_is_sent_as_none(void)
{
    for (int what = 0; what < 8; what++) {
        support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
        pel_obs_t *const o = epoch.obs;
        uint16_t n = 2;
        uint8_t flags[2] = {PEL_OBS_CODE | PEL_OBS_PHASE, PEL_OBS_CODE | PEL_OBS_PHASE};
        switch (what) {
        case 0: break;
        case 1: o[0].flags = flags[0] = PEL_OBS_CODE; break;
        case 2: o[1].flags = flags[1] = PEL_OBS_PHASE; break;
        case 3:
            o[1].P_m = o[0].P_m + 163.86;
            flags[1] = PEL_OBS_PHASE;
            break; /* 14 bits of 2 cm */
        case 4:
            o[1].P_m = o[0].P_m - 163.86;
            flags[1] = PEL_OBS_PHASE;
            break;
        case 5:
            o[1].P_m = 1e9;
            n = 1;
            break; /* cannot be */
        case 6:
            o[1].sys = PEL_SYS_GAL;
            n = 1;
            break;
        default: epoch.n = n = 1; break;
        }
        TEST_ASSERT_EQUAL_INT(1, round_trip(false));
        TEST_ASSERT_EQUAL_UINT16(n, rx.epoch.n);
        for (int i = 0; i < (int)n; i++) { TEST_ASSERT_EQUAL_HEX8(flags[i], rx.epoch.obs[i].flags); }
    }
    support_epoch(&epoch, T0, PEL_SYS_GPS, 2);
    epoch.obs[0].flags = PEL_OBS_PHASE; /* without a code on L1 there is no satellite */
    TEST_ASSERT_EQUAL_INT(1, round_trip(false));
    TEST_ASSERT_EQUAL_UINT16(2, rx.epoch.n);
    TEST_ASSERT_EQUAL_UINT8(2, rx.epoch.obs[0].prn);
}

/* DF013 holds 24 seconds one by one, then steps that double; what it says has been tracked at least. */
static void lock_times_are_rounded_down_to_their_steps(void)
{
    static const uint32_t CASE_MS[][2] = {{0, 0},         {999, 0},         {1000, 1000},     {23999, 23000},
                                          {24000, 24000}, {25999, 24000},   {26000, 26000},   {72000, 72000},
                                          {75999, 72000}, {936999, 936000}, {937000, 937000}, {4000000, 937000}};
    for (size_t i = 0; i < sizeof CASE_MS / sizeof CASE_MS[0]; i++) {
        support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
        epoch.obs[0].lock_ms = CASE_MS[i][0];
        TEST_ASSERT_EQUAL_INT(1, round_trip(false));
        TEST_ASSERT_EQUAL_UINT32(CASE_MS[i][1], rx.epoch.obs[0].lock_ms);
        TEST_ASSERT_EQUAL_UINT32(1000, rx.epoch.obs[1].lock_ms);
    }
}

static void a_code_of_l2_just_too_far_from_that_of_l1_is_sent_as_none(void)
{
    static const double AWAY_M[] = {163.82, 163.84, -163.82, -163.84};
    for (size_t i = 0; i < 4; i++) {
        support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
        epoch.obs[0].P_m = 70.0 * MS_M + 1000.0;
        epoch.obs[1].P_m = epoch.obs[0].P_m + AWAY_M[i];
        TEST_ASSERT_EQUAL_INT(1, round_trip(false));
        TEST_ASSERT_EQUAL_HEX8((i % 2 == 0) ? PEL_OBS_CODE | PEL_OBS_PHASE : PEL_OBS_PHASE, rx.epoch.obs[1].flags);
    }
}

static void codes_and_strengths_go_out_as_indicators(void)
{
    static const struct {
        char code[2], back[2];
        float cn0, cn0_back;
    } CASE[] = {{{'C', 'L'}, {'C', 'X'}, 45.0f, 45.0f},
                {{'W', 'W'}, {'W', 'W'}, 63.5f, 63.5f},
                {{'P', 'P'}, {'W', 'P'}, 64.0f, 63.75f}}; /* eight bits of a quarter */
    for (size_t i = 0; i < 3; i++) {
        support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
        for (int k = 0; k < 2; k++) {
            epoch.obs[k].code = CASE[i].code[k];
            epoch.obs[k].cn0_dbhz = CASE[i].cn0;
        }
        TEST_ASSERT_EQUAL_INT(1, round_trip(false));
        for (int k = 0; k < 2; k++) {
            TEST_ASSERT_EQUAL_CHAR(CASE[i].back[k], rx.epoch.obs[k].code);
            TEST_ASSERT_EQUAL_FLOAT(CASE[i].cn0_back, rx.epoch.obs[k].cn0_dbhz);
        }
    }
}

/* Phases at any distance from their code come back less a whole number of 1500 cycles. */
static void phases_far_from_their_code_come_back_by_whole_blocks(void)
{
    static const double AWAY_CYC[] = {0.25, 749.75, 750.25, -749.75, -750.25, 1e7, -1e9};
    for (size_t i = 0; i < sizeof AWAY_CYC / sizeof AWAY_CYC[0]; i++) {
        support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
        for (int k = 0; k < 2; k++) { epoch.obs[k].L_cyc += AWAY_CYC[i]; }
        TEST_ASSERT_EQUAL_INT(1, round_trip(false));
        for (int k = 0; k < 2; k++) {
            const double blocks = (epoch.obs[k].L_cyc - rx.epoch.obs[k].L_cyc) / 1500.0;
            TEST_ASSERT_DOUBLE_WITHIN(2e-6, round(blocks), blocks);
            const double lambda = PEL_SPEED_OF_LIGHT / ((k == 0) ? 1575.42e6 : 1227.60e6);
            TEST_ASSERT_DOUBLE_WITHIN(750.0 * lambda + 4.0, rx.epoch.obs[k].P_m, rx.epoch.obs[k].L_cyc * lambda);
        }
    }
}

static void the_encoder_refuses_what_no_message_holds(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 32);
    TEST_ASSERT_EQUAL_INT(1, round_trip(false));
    TEST_ASSERT_EQUAL_UINT16(2 * 31, rx.epoch.n); /* five bits of satellites */
    TEST_ASSERT_EQUAL_INT(0, round_trip(true));
    TEST_ASSERT_TRUE(rx.collecting);
    TEST_ASSERT_GREATER_THAN_size_t(0, pel_rtcm3_encode_1004(&epoch, 4095, false, frame, sizeof frame));
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_1004(&epoch, 4096, false, frame, sizeof frame));
    epoch.obs[0].prn = epoch.obs[1].prn = 32; /* alone, the last is there */
    epoch.n = 2;
    TEST_ASSERT_EQUAL_INT(1, round_trip(false));
    TEST_ASSERT_EQUAL_UINT8(32, rx.epoch.obs[0].prn);
    epoch.n = PEL_MAX_OBS;
    TEST_ASSERT_GREATER_THAN_size_t(0, pel_rtcm3_encode_1004(&epoch, 77, false, frame, sizeof frame));
    epoch.n = PEL_MAX_OBS + 1;
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_1004(&epoch, 77, false, frame, sizeof frame));
    epoch.n = 2;
    epoch.t_ns = 0;
    TEST_ASSERT_GREATER_THAN_size_t(0, pel_rtcm3_encode_1004(&epoch, 77, false, frame, sizeof frame));
    support_epoch(&epoch, -1, PEL_SYS_GPS, 1);
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_1004(&epoch, 77, false, frame, sizeof frame));
    support_epoch(&epoch, T0, PEL_SYS_GPS, 0);
    TEST_ASSERT_EQUAL_size_t(14, pel_rtcm3_encode_1004(&epoch, 77, false, frame, 14));
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_1004(&epoch, 77, false, frame, 13));
    support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
    epoch.obs[0].P_m = 256.0 * MS_M; /* eight bits of milliseconds */
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_1004(&epoch, 77, false, frame, sizeof frame));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_satellite_gives_two_signals_with_their_lock_and_strength);
    RUN_TEST(marks_for_none_leave_parts_out_or_all_of_them);
    RUN_TEST(satellites_of_1004_are_gps_or_sbas);
    RUN_TEST(codes_are_those_of_the_indicators);
    RUN_TEST(what_an_msm_tells_is_not_taken_again);
    RUN_TEST(a_message_shorter_than_its_satellites_is_refused);
    RUN_TEST(without_a_week_or_a_day_there_is_no_time);
    RUN_TEST(a_day_may_have_a_leap_second_and_no_more);
    RUN_TEST(more_of_the_same_epoch_may_follow);
    RUN_TEST(what_a_satellite_lacks_is_sent_as_none);
    RUN_TEST(lock_times_are_rounded_down_to_their_steps);
    RUN_TEST(a_code_of_l2_just_too_far_from_that_of_l1_is_sent_as_none);
    RUN_TEST(codes_and_strengths_go_out_as_indicators);
    RUN_TEST(phases_far_from_their_code_come_back_by_whole_blocks);
    RUN_TEST(the_encoder_refuses_what_no_message_holds);
    return UNITY_END();
}

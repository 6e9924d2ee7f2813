/* Multiple Signal Messages: marks for none, what does not fit, unknown signals, masks longer than the message, time scales. */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/wire/msm.h"
#include "support_wire.h"
#include "unity.h"

#define S        PEL_NS_PER_S
#define MASKS_AT (12 + 12 + 30 + 1 + 18) /* bits before the satellite mask */
#define CELLS_AT (MASKS_AT + 64 + 32)

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

static size_t encode(pel_sys_t sys, int msm)
{
    return pel_rtcm3_encode_msm(&epoch, sys, msm, 77, false, frame, sizeof frame);
}

/* Epochs given by this frame, whose message has been changed. */
static int push_changed(size_t n)
{
    TEST_ASSERT_EQUAL_size_t(n, pel_rtcm3_seal(8u * (n - 6u), frame, sizeof frame));
    return support_push(&rx, frame, n, PEL_RX_EPOCH);
}

static int round_trip(pel_sys_t sys, int msm)
{
    setUp();
    const size_t n = encode(sys, msm);
    TEST_ASSERT_GREATER_THAN_size_t(0, n);
    return support_push(&rx, frame, n, PEL_RX_EPOCH);
}

/* ---- decoder --------------------------------------------------------------------------------------------------------- */

/* MSM7 of one satellite with one signal: the fields behind the masks, and what is left when one of them says "none". */
static void marks_for_none_leave_parts_out_or_all_of_them(void)
{
    enum { SATS = CELLS_AT + 1, RATE = SATS + 8 + 4 + 10, CODE = RATE + 14, PHASE = CODE + 20, HALF = PHASE + 24 + 10 };
    static const struct {
        struct {
            size_t at;
            unsigned bits;
            uint32_t value;
        } change[3];
        uint8_t flags;
    } CASE[] = {
        {{{0, 0, 0}}, PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER},
        {{{SATS, 8, 255}}, 0},
        {{{RATE, 14, 0x2000}}, PEL_OBS_CODE | PEL_OBS_PHASE},
        {{{HALF + 11, 15, 0x4000}}, PEL_OBS_CODE | PEL_OBS_PHASE},
        {{{CODE, 20, 0x80000}}, PEL_OBS_PHASE | PEL_OBS_DOPPLER},
        {{{PHASE, 24, 0x800000}}, PEL_OBS_CODE | PEL_OBS_DOPPLER},
        {{{CODE, 20, 0x80000}, {PHASE, 24, 0x800000}}, 0},
        {{{HALF, 1, 1}}, PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER | PEL_OBS_HALF_CYCLE},
        {{{HALF, 1, 1}, {PHASE, 24, 0x800000}}, PEL_OBS_CODE | PEL_OBS_DOPPLER}, /* half of no phase */
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        setUp();
        support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
        epoch.n = 1;
        const size_t n = encode(PEL_SYS_GPS, 7);
        for (int k = 0; k < 3 && CASE[i].change[k].bits > 0; k++) {
            pel_bits_put(message, CASE[i].change[k].at, CASE[i].change[k].bits, CASE[i].change[k].value);
        }
        TEST_ASSERT_EQUAL_INT((CASE[i].flags != 0) ? 1 : 0, push_changed(n));
        TEST_ASSERT_EQUAL_UINT16((CASE[i].flags != 0) ? 1 : 0, rx.epoch.n);
        if (CASE[i].flags != 0) { TEST_ASSERT_EQUAL_HEX8(CASE[i].flags, rx.epoch.obs[0].flags); }
        TEST_ASSERT_EQUAL_UINT32(0, rx.counters.bad_value);
    }
}

static void signals_without_a_carrier_are_counted_and_the_others_kept(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 3);
    const size_t n = encode(PEL_SYS_GPS, 4);
    pel_bits_put(message, MASKS_AT + 64 + 2 - 1, 1, 0); /* L1 C/A, number 2 of GPS, */
    pel_bits_put(message, MASKS_AT + 64 + 5 - 1, 1, 1); /* becomes 5, which is none */
    TEST_ASSERT_EQUAL_INT(1, push_changed(n));
    TEST_ASSERT_EQUAL_UINT16(3, rx.epoch.n);
    TEST_ASSERT_EQUAL_UINT32(3, rx.counters.bad_value);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_UINT8(PEL_CARRIER_L2, rx.epoch.obs[i].carrier);
        TEST_ASSERT_DOUBLE_WITHIN(0.01, epoch.obs[2 * i + 1].P_m, rx.epoch.obs[i].P_m);
    }
}

/* The lengths that masks announce: more cells than a message may have, cells or satellites beyond its end. */
static void masks_longer_than_the_message_are_refused(void)
{
    static const struct {
        int n_sat, n_sig;
        size_t bits; /* of the message */
        bool good;
    } CASE[] = {
        {0, 0, CELLS_AT, true},
        {0, 0, CELLS_AT - 1, false},
        {1, 32, CELLS_AT + 32 + 18, true},
        {1, 32, CELLS_AT + 32 + 17, false},
        {2, 32, CELLS_AT + 64 + 36, true},
        {2, 32, CELLS_AT + 63, false}, /* the satellites would fit, the cell mask does not */
        {1, 5, 192, true},             /* ends with a byte */
        {3, 22, 8 * 200, false},       /* 66 cells */
        {64, 1, CELLS_AT + 64 + 64 * 18, true},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        setUp();
        memset(message, 0, 400);
        pel_bits_put(message, 0, 12, 1074);
        for (int k = 0; k < CASE[i].n_sat; k++) { pel_bits_put(message, MASKS_AT + (size_t)k, 1, 1); }
        for (int k = 0; k < CASE[i].n_sig; k++) { pel_bits_put(message, MASKS_AT + 64 + (size_t)k, 1, 1); }
        /* whole bytes only: what is cut by less than a byte is cut to the byte before */
        const size_t bytes = CASE[i].good ? (CASE[i].bits + 7) / 8 : CASE[i].bits / 8;
        (void)push_changed(bytes + 6u);
        TEST_ASSERT_EQUAL_UINT32(CASE[i].good ? 0 : 1, rx.counters.bad_length);
    }
    setUp(); /* one cell that is there needs its 48 bits */
    pel_bits_put(message, 0, 12, 1074);
    pel_bits_put(message, MASKS_AT, 64, 1);
    pel_bits_put(message, MASKS_AT + 64, 32, 1);
    pel_bits_put(message, CELLS_AT, 1, 1);
    (void)push_changed((CELLS_AT + 1 + 18 + 48) / 8 + 6u);
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.bad_length);
    (void)push_changed((CELLS_AT + 1 + 18 + 48 + 7) / 8 + 6u);
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.bad_length);
}

/* Some senders put GPS time into messages of BeiDou: then it is that of the epoch they belong to. */
static void beidou_time_may_be_that_of_gps_beside_a_message_of_gps(void)
{
    for (int what = 0; what < 3; what++) {
        setUp();
        if (what < 2) {
            support_epoch(&epoch, T0, PEL_SYS_GPS, 2);
            const size_t n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 77, true, frame, sizeof frame);
            (void)support_push(&rx, frame, n, PEL_RX_EPOCH);
        }
        support_epoch(&epoch, T0, PEL_SYS_BDS, 2);
        const size_t n = encode(PEL_SYS_BDS, 7);
        const uint32_t tow_ms = (uint32_t)pel_bits_u(message, 24, 30);
        if (what > 0) { pel_bits_put(message, 24, 30, tow_ms + 14000u); }
        TEST_ASSERT_EQUAL_INT(1, push_changed(n));
        TEST_ASSERT_EQUAL_INT64((what < 2) ? T0 : T0 + 14 * S, rx.epoch.t_ns); /* alone there is no telling */
        TEST_ASSERT_EQUAL_UINT16((what < 2) ? 8 : 4, rx.epoch.n);
    }
}

static void tables_answer_only_for_what_is_in_them(void)
{
    uint8_t carrier = 77;
    char code = '?';
    TEST_ASSERT_NULL(pel_msm_kind(3));
    TEST_ASSERT_NOT_NULL(pel_msm_kind(4));
    TEST_ASSERT_NOT_NULL(pel_msm_kind(7));
    TEST_ASSERT_NULL(pel_msm_kind(8));
    TEST_ASSERT_TRUE(pel_msm_signal(PEL_SYS_BDS, 31, &carrier, &code));
    TEST_ASSERT_EQUAL_UINT8(PEL_CARRIER_L1, carrier);
    TEST_ASSERT_EQUAL_CHAR('P', code);
    TEST_ASSERT_FALSE(pel_msm_signal(PEL_SYS_GPS, 1, &carrier, &code));
    TEST_ASSERT_FALSE(pel_msm_signal(PEL_N_SYS, 2, &carrier, &code));
    TEST_ASSERT_EQUAL_CHAR('P', code);
    TEST_ASSERT_EQUAL_INT(10, pel_msm_id(PEL_SYS_GPS, PEL_CARRIER_L2, 'W'));
    TEST_ASSERT_EQUAL_INT(8, pel_msm_id(PEL_SYS_GPS, PEL_CARRIER_L2, 'N')); /* another of that carrier */
    TEST_ASSERT_EQUAL_INT(0, pel_msm_id(PEL_SYS_GPS, PEL_CARRIER_B1I, 'I'));
    TEST_ASSERT_EQUAL_UINT32(UINT32_C(1) << 26, pel_msm_lock_ms(10, 704));
    TEST_ASSERT_EQUAL_UINT32(0, pel_msm_lock_ms(10, 705)); /* reserved */
}

/* ---- encoder --------------------------------------------------------------------------------------------------------- */

static void a_code_or_phase_too_far_from_the_first_is_sent_as_none(void)
{
    static const struct {
        double away_m;
        uint8_t flags; /* of the second signal, MSM4 */
    } CASE[] = {{200.0, PEL_OBS_CODE | PEL_OBS_PHASE},
                {-200.0, PEL_OBS_CODE | PEL_OBS_PHASE}, /* 2^-10 ms are 293 m */
                {600.0, PEL_OBS_PHASE},
                {-600.0, PEL_OBS_PHASE},
                {1500.0, 0},
                {-1500.0, 0}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
        epoch.obs[1].P_m = epoch.obs[0].P_m + CASE[i].away_m;
        epoch.obs[1].L_cyc = epoch.obs[1].P_m * 1227.60e6 / PEL_SPEED_OF_LIGHT;
        TEST_ASSERT_EQUAL_INT(1, round_trip(PEL_SYS_GPS, 4));
        TEST_ASSERT_EQUAL_UINT16((CASE[i].flags != 0) ? 2 : 1, rx.epoch.n);
        if (CASE[i].flags != 0) { TEST_ASSERT_EQUAL_HEX8(CASE[i].flags, rx.epoch.obs[1].flags); }
    }
}

/* Rough rates end at 8191 m/s, fine ones at 1.6383 m/s from them. */
static void a_doppler_that_does_not_fit_is_sent_as_none(void)
{
    static const struct {
        double rate_mps[2];
        bool there[2];
    } CASE[] = {
        {{8191.0, 8191.0}, {true, true}},     {{-8191.0, -8191.0}, {true, true}}, {{8192.0, 8192.0}, {false, false}},
        {{-8192.0, -8192.0}, {false, false}}, {{9000.0, 100.0}, {false, true}}, /* the second gives the satellite's */
        {{100.0, 101.638}, {true, true}},     {{100.0, 101.6384}, {true, false}}, {{100.0, 98.362}, {true, true}},
        {{100.0, 98.3616}, {true, false}},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
        for (int k = 0; k < 2; k++) {
            const double f_hz = (k == 0) ? 1575.42e6 : 1227.60e6;
            epoch.obs[k].D_hz = (float)(-CASE[i].rate_mps[k] * f_hz / PEL_SPEED_OF_LIGHT);
        }
        TEST_ASSERT_EQUAL_INT(1, round_trip(PEL_SYS_GPS, 5));
        for (int k = 0; k < 2; k++) {
            TEST_ASSERT_EQUAL(CASE[i].there[k], (rx.epoch.obs[k].flags & PEL_OBS_DOPPLER) != 0);
        }
    }
}

static void what_the_first_signal_lacks_the_second_gives(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
    epoch.obs[0].flags = PEL_OBS_PHASE; /* neither code nor Doppler */
    TEST_ASSERT_EQUAL_INT(1, round_trip(PEL_SYS_GPS, 7));
    TEST_ASSERT_EQUAL_HEX8(PEL_OBS_PHASE, rx.epoch.obs[0].flags);
    TEST_ASSERT_EQUAL_HEX8(PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER, rx.epoch.obs[1].flags);
    support_epoch(&epoch, T0, PEL_SYS_GPS, 2);
    for (int i = 0; i < 4; i++) { epoch.obs[i].flags = PEL_OBS_CODE; }
    TEST_ASSERT_EQUAL_INT(1, round_trip(PEL_SYS_GPS, 7));
    for (int i = 0; i < 4; i++) { TEST_ASSERT_EQUAL_HEX8(PEL_OBS_CODE, rx.epoch.obs[i].flags); }
}

static void strengths_saturate_at_their_bits(void)
{
    static const struct {
        int msm;
        float sent, back;
    } CASE[] = {
        {4, 62.0f, 62.0f}, {4, 63.0f, 63.0f}, {4, 64.0f, 63.0f}, {6, 63.9375f, 63.9375f}, {6, 100.0f, 63.9375f}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
        epoch.obs[0].cn0_dbhz = CASE[i].sent;
        TEST_ASSERT_EQUAL_INT(1, round_trip(PEL_SYS_GPS, CASE[i].msm));
        TEST_ASSERT_EQUAL_FLOAT(CASE[i].back, rx.epoch.obs[0].cn0_dbhz);
    }
}

/* 20 satellites of four signals: as many as 64 cells hold, and the rest is left out whole. */
static void signals_beyond_64_cells_are_left_out(void)
{
    static const uint8_t CARRIER[4] = {PEL_CARRIER_L1, PEL_CARRIER_L5, PEL_CARRIER_E5B, PEL_CARRIER_E6};
    support_epoch(&epoch, T0, PEL_SYS_GAL, 20);
    support_append(&epoch, PEL_SYS_GAL, 20);
    for (int i = 0; i < 80; i++) {
        epoch.obs[i].prn = (uint8_t)(i / 4 + 1);
        epoch.obs[i].carrier = CARRIER[i % 4];
        epoch.obs[i].code = 'X';
        epoch.obs[i].P_m = 2.2e7 + 1e4 * (i / 4);
        epoch.obs[i].flags = PEL_OBS_CODE;
    }
    TEST_ASSERT_EQUAL_INT(1, round_trip(PEL_SYS_GAL, 4));
    TEST_ASSERT_EQUAL_UINT16(64, rx.epoch.n);
    for (int i = 0; i < 64; i++) { TEST_ASSERT_EQUAL_UINT8(i / 4 + 1, rx.epoch.obs[i].prn); }
}

static void signals_that_cannot_be_are_left_out(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 3);
    epoch.obs[0].P_m = (double)NAN;
    epoch.obs[1].prn = 33;
    TEST_ASSERT_EQUAL_INT(1, round_trip(PEL_SYS_GPS, 7));
    TEST_ASSERT_EQUAL_UINT16(4, rx.epoch.n);
    TEST_ASSERT_EQUAL_UINT8(2, rx.epoch.obs[0].prn);
    TEST_ASSERT_EQUAL_UINT32(0, rx.counters.bad_value);
}

/* Of an epoch of two systems, and of an array that holds more than the epoch, nothing else goes out. */
static void only_signals_of_the_system_and_of_the_epoch_go_out(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 2);
    support_append(&epoch, PEL_SYS_GAL, 4);
    TEST_ASSERT_EQUAL_INT(1, round_trip(PEL_SYS_GPS, 7));
    TEST_ASSERT_EQUAL_UINT16(4, rx.epoch.n);
    support_epoch(&epoch, T0, PEL_SYS_GPS, 3); /* 1: L1, 2: L1 and L2, 3: L1 without code; behind them L2 of 1 and 3 */
    epoch.obs[0].code = 'X';                   /* the last number of the mask */
    const pel_obs_t behind = epoch.obs[1];
    for (int i = 1; i < 4; i++) { epoch.obs[i] = epoch.obs[i + 1]; }
    epoch.obs[3].flags = PEL_OBS_PHASE;
    epoch.n = 4;
    for (int i = 0; i < 2; i++) {
        epoch.obs[4] = (i == 0) ? behind : epoch.obs[5];
        TEST_ASSERT_EQUAL_INT(1, round_trip(PEL_SYS_GPS, 7));
        TEST_ASSERT_EQUAL_UINT16(3, rx.epoch.n);
        TEST_ASSERT_EQUAL_CHAR('X', rx.epoch.obs[0].code);
    }
}

static void moscows_day_may_have_a_leap_second_and_no_more(void)
{
    for (uint32_t extra = 0; extra < 2; extra++) {
        setUp();
        support_epoch(&epoch, T0, PEL_SYS_GLO, 2);
        const size_t n = encode(PEL_SYS_GLO, 7);
        pel_bits_put(message, 24 + 3, 27, 86400999u + extra);
        (void)push_changed(n);
        TEST_ASSERT_EQUAL_UINT32(extra, rx.counters.bad_value);
    }
}

static void a_code_just_too_far_from_the_first_is_sent_as_none(void)
{
    for (int units = 16383; units <= 16384; units++) { /* of 2^-24 ms */
        for (int sign = -1; sign <= 1; sign += 2) {
            support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
            epoch.obs[0].P_m = PEL_RANGE_MS_M * 70.5;
            epoch.obs[1].P_m = PEL_RANGE_MS_M * (70.5 + sign * units * 0x1p-24);
            TEST_ASSERT_EQUAL_INT(1, round_trip(PEL_SYS_GPS, 4));
            TEST_ASSERT_EQUAL(units < 16384, (rx.epoch.obs[1].flags & PEL_OBS_CODE) != 0);
        }
    }
}

static void the_encoder_refuses_what_no_message_holds(void)
{
    support_epoch(&epoch, 14 * S, PEL_SYS_GPS, 2);
    TEST_ASSERT_GREATER_THAN_size_t(0, encode(PEL_SYS_GPS, 7));
    epoch.t_ns--; /* BeiDou time would be negative */
    TEST_ASSERT_EQUAL_size_t(0, encode(PEL_SYS_GPS, 7));
    support_epoch(&epoch, T0, PEL_SYS_GPS, 0);
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 4095, false, frame, 31));
    TEST_ASSERT_EQUAL_size_t(28, pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 4095, false, frame, 32));
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 4096, false, frame, 32));
    TEST_ASSERT_EQUAL_size_t(0, encode((pel_sys_t)-1, 7));
    TEST_ASSERT_EQUAL_size_t(0, encode(PEL_SYS_GPS, 8));
    epoch.n = PEL_MAX_OBS;
    TEST_ASSERT_GREATER_THAN_size_t(0, encode(PEL_SYS_GPS, 7));
    epoch.n = PEL_MAX_OBS + 1;
    TEST_ASSERT_EQUAL_size_t(0, encode(PEL_SYS_GPS, 7));
    support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
    for (int i = 0; i < 2; i++) { epoch.obs[i].P_m = 256e-3 * PEL_SPEED_OF_LIGHT; } /* eight bits of milliseconds */
    TEST_ASSERT_EQUAL_size_t(0, encode(PEL_SYS_GPS, 7));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(marks_for_none_leave_parts_out_or_all_of_them);
    RUN_TEST(signals_without_a_carrier_are_counted_and_the_others_kept);
    RUN_TEST(masks_longer_than_the_message_are_refused);
    RUN_TEST(beidou_time_may_be_that_of_gps_beside_a_message_of_gps);
    RUN_TEST(tables_answer_only_for_what_is_in_them);
    RUN_TEST(a_code_or_phase_too_far_from_the_first_is_sent_as_none);
    RUN_TEST(a_doppler_that_does_not_fit_is_sent_as_none);
    RUN_TEST(what_the_first_signal_lacks_the_second_gives);
    RUN_TEST(strengths_saturate_at_their_bits);
    RUN_TEST(signals_beyond_64_cells_are_left_out);
    RUN_TEST(signals_that_cannot_be_are_left_out);
    RUN_TEST(only_signals_of_the_system_and_of_the_epoch_go_out);
    RUN_TEST(moscows_day_may_have_a_leap_second_and_no_more);
    RUN_TEST(a_code_just_too_far_from_the_first_is_sent_as_none);
    RUN_TEST(the_encoder_refuses_what_no_message_holds);
    return UNITY_END();
}

/* Observations: round trips, epochs of several messages, order in time, values that cannot be. */
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/wire/msm.h"
#include "support_wire.h"
#include "unity.h"

static pel_receiver_t rx;
static pel_epoch_t epoch;
static uint8_t frame[PEL_MAX_FRAME_BYTES];

void setUp(void)
{
    pel_receiver_init(&rx);
    pel_receiver_set_time(&rx, T0 + 86400 * PEL_NS_PER_S);
}
void tearDown(void) {}

static void rawx_returns_every_bit(void)
{
    support_epoch(&epoch, T0 + 123456789, PEL_SYS_GPS, 8);
    for (int sys = 1; sys < PEL_N_SYS - 1; sys++) { support_append(&epoch, (pel_sys_t)sys, 8); }
    epoch.obs[3].flags = PEL_OBS_CODE | PEL_OBS_DOPPLER;
    epoch.obs[3].L_cyc = 0.0;
    epoch.obs[4].flags |= PEL_OBS_HALF_CYCLE;
    epoch.clock_reset = true;
    const size_t n = pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame);
    TEST_ASSERT_EQUAL_size_t(8 + 16 + 32 * (size_t)epoch.n, n);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT16(epoch.n, rx.epoch.n);
    TEST_ASSERT_TRUE(rx.epoch.clock_reset);
    TEST_ASSERT_INT64_WITHIN(1, epoch.t_ns, rx.epoch.t_ns);
    for (int i = 0; i < (int)epoch.n; i++) {
        const pel_obs_t *a = &epoch.obs[i];
        const pel_obs_t *b = &rx.epoch.obs[i];
        TEST_ASSERT_TRUE(a->P_m == b->P_m && a->L_cyc == b->L_cyc && a->D_hz == b->D_hz && a->cn0_dbhz == b->cn0_dbhz);
        TEST_ASSERT_TRUE(a->sys == b->sys && a->prn == b->prn && a->carrier == b->carrier && a->code == b->code);
        TEST_ASSERT_TRUE(a->glo_k == b->glo_k && a->flags == b->flags);
        TEST_ASSERT_EQUAL_UINT32((a->lock_ms < 65535u) ? a->lock_ms : 65535u, b->lock_ms);
    }
}

static void rinex_codes_go_out_as_the_carriers_own_signal(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 1);
    epoch.obs[0].code = 'W';
    epoch.obs[1].code = 'W';
    const size_t n = pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT8(0, frame[6 + 16 + 22]);      /* L1 C/A */
    TEST_ASSERT_EQUAL_UINT8(3, frame[6 + 16 + 32 + 22]); /* L2 CL */
}

static void values_that_cannot_be_are_counted_and_left_out(void)
{
    const double zero = 0.0;
    support_epoch(&epoch, T0, PEL_SYS_GPS, 5);
    const size_t n = pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame);
    uint8_t *m = frame + 6 + 16;
    pel_le_put_f64(m, zero / zero);         /* NaN code */
    pel_le_put_f64(m + 32, 5e5);            /* code too short */
    pel_le_put_f64(m + 64, 2e8);            /* too long */
    pel_le_put_f64(m + 96 + 8, 1.0 / zero); /* infinite phase */
    m[128 + 21] = 33;                       /* no such satellite */
    m[160 + 22] = 5;                        /* no such signal */
    m[192 + 20] = 9;                        /* no such system */
    pel_le_put_f32(m + 224 + 16, (float)(zero / zero));
    TEST_ASSERT_GREATER_THAN_size_t(0, pel_ubx_seal(2, 0x15, n - 8, frame, sizeof frame));
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT16(2, rx.epoch.n);
    TEST_ASSERT_EQUAL_UINT32(8, rx.counters.bad_value);
}

static void a_time_that_cannot_be_refuses_the_epoch(void)
{
    const double tows[] = {-1.0, 604802.0, 0.0 / (double)(frame[0] * 0), 1e300};
    support_epoch(&epoch, T0, PEL_SYS_GPS, 2);
    for (int i = 0; i < 4; i++) {
        const size_t n = pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame);
        pel_le_put_f64(frame + 6, tows[i]);
        (void)pel_ubx_seal(2, 0x15, n - 8, frame, sizeof frame);
        TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPOCH));
    }
    TEST_ASSERT_EQUAL_UINT32(4, rx.counters.bad_value);
}

static void push_rawx(pel_time_t t, int *events)
{
    support_epoch(&epoch, t, PEL_SYS_GPS, 4);
    const size_t n = pel_ubx_encode_rawx(&epoch, 18, frame, sizeof frame);
    *events += support_push(&rx, frame, n, PEL_RX_EPOCH);
}

static void duplicates_and_epochs_of_the_past_are_counted_not_given(void)
{
    int events = 0;
    push_rawx(T0, &events);
    push_rawx(T0, &events);
    push_rawx(T0 - PEL_NS_PER_S, &events);
    TEST_ASSERT_EQUAL_INT(1, events);
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.duplicate);
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.time_back);
    push_rawx(T0 + PEL_NS_PER_S, &events);
    TEST_ASSERT_EQUAL_INT(2, events);
}

static void a_receiver_that_restarted_in_the_past_is_believed_in_the_end(void)
{
    int events = 0;
    push_rawx(T0, &events);
    for (int i = 0; i < PEL_WIRE_RESTART + 5; i++) { push_rawx(T0 - 86400 * PEL_NS_PER_S + i * PEL_NS_PER_S, &events); }
    TEST_ASSERT_EQUAL_INT(1 + 6, events);
    TEST_ASSERT_EQUAL_UINT32(PEL_WIRE_RESTART, rx.counters.time_back);
}

/* ---- RTCM ------------------------------------------------------------------------------------------------------------ */

static void expect_near(const pel_epoch_t *a, const pel_epoch_t *b, double code_m, double phase_m, double rate_mps)
{
    TEST_ASSERT_EQUAL_UINT16(a->n, b->n);
    for (int i = 0; i < (int)a->n; i++) {
        const pel_obs_t *x = &a->obs[i];
        const pel_obs_t *y = NULL;
        for (int k = 0; k < (int)b->n; k++) {
            if (b->obs[k].sys == x->sys && b->obs[k].prn == x->prn && b->obs[k].carrier == x->carrier) {
                y = &b->obs[k];
            }
        }
        TEST_ASSERT_NOT_NULL(y);
        const double lambda = PEL_SPEED_OF_LIGHT / pel_carrier_hz((pel_sys_t)x->sys, (pel_carrier_t)x->carrier, 0);
        TEST_ASSERT_DOUBLE_WITHIN(code_m, x->P_m, y->P_m);
        TEST_ASSERT_DOUBLE_WITHIN(phase_m, x->L_cyc * lambda, y->L_cyc * lambda);
        if (rate_mps > 0.0) { TEST_ASSERT_DOUBLE_WITHIN(rate_mps, (double)x->D_hz * lambda, (double)y->D_hz * lambda); }
        TEST_ASSERT_TRUE(y->code == x->code);
        TEST_ASSERT_TRUE(y->lock_ms <= x->lock_ms);
    }
}

static void msm_returns_what_its_resolution_holds(void)
{
    static const pel_sys_t SYS[] = {PEL_SYS_GPS, PEL_SYS_GAL, PEL_SYS_BDS, PEL_SYS_QZS, PEL_SYS_SBS};
    for (int s = 0; s < 5; s++) {
        for (int msm = 4; msm <= 7; msm++) {
            setUp();
            support_epoch(&epoch, T0, SYS[s], (SYS[s] == PEL_SYS_QZS) ? 10 : 20);
            const size_t n = pel_rtcm3_encode_msm(&epoch, SYS[s], msm, 77, false, frame, sizeof frame);
            TEST_ASSERT_GREATER_THAN_size_t(0, n);
            TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
            TEST_ASSERT_EQUAL_INT64(T0, rx.epoch.t_ns);
            const double ms = PEL_SPEED_OF_LIGHT * 1e-3;
            expect_near(&epoch, &rx.epoch, ms * pel_pow2((msm < 6) ? -25 : -30) + 1e-6,
                        ms * pel_pow2((msm < 6) ? -30 : -32) + 1e-6, (msm % 2 == 1) ? 0.51e-4 : 0.0);
        }
    }
}

static void msm_holds_half_cycles_missing_codes_and_missing_phases(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 3);
    epoch.obs[0].flags |= PEL_OBS_HALF_CYCLE;
    epoch.obs[1].flags = PEL_OBS_CODE;
    epoch.obs[3].flags = PEL_OBS_PHASE;
    epoch.obs[4].flags = PEL_OBS_PHASE; /* satellite 3: no code at all, nothing to anchor a range to */
    epoch.obs[5].flags = PEL_OBS_PHASE;
    const size_t n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 77, false, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT16(4, rx.epoch.n);
    TEST_ASSERT_EQUAL_HEX8(PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER | PEL_OBS_HALF_CYCLE, rx.epoch.obs[0].flags);
    TEST_ASSERT_EQUAL_HEX8(PEL_OBS_CODE, rx.epoch.obs[1].flags);
    TEST_ASSERT_EQUAL_HEX8(PEL_OBS_PHASE, rx.epoch.obs[3].flags);
}

static void legacy_1004_returns_what_its_resolution_holds(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 12);
    for (int i = 1; i < (int)epoch.n; i += 2) { epoch.obs[i].code = 'W'; }
    const size_t n = pel_rtcm3_encode_1004(&epoch, 77, false, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    expect_near(&epoch, &rx.epoch, 0.0201, 0.0003, 0.0);
}

static size_t msm_of(pel_time_t t, pel_sys_t sys, bool more)
{
    support_epoch(&epoch, t, sys, 4);
    return pel_rtcm3_encode_msm(&epoch, sys, 5, 77, more, frame, sizeof frame);
}

static void messages_of_one_epoch_are_one_epoch(void)
{
    static const pel_sys_t SYS[] = {PEL_SYS_GPS, PEL_SYS_GAL, PEL_SYS_QZS, PEL_SYS_BDS};
    int events = 0;
    for (int s = 0; s < 4; s++) { events += support_push(&rx, frame, msm_of(T0, SYS[s], s < 3), PEL_RX_EPOCH); }
    TEST_ASSERT_EQUAL_INT(1, events);
    TEST_ASSERT_EQUAL_UINT16(4 * 8, rx.epoch.n);
    TEST_ASSERT_EQUAL_INT64(T0, rx.epoch.t_ns); /* BeiDou time is 14 s behind on the wire only */
}

static void an_epoch_whose_last_message_is_lost_goes_out_when_the_next_begins(void)
{
    int events = support_push(&rx, frame, msm_of(T0, PEL_SYS_GPS, true), PEL_RX_EPOCH);
    TEST_ASSERT_EQUAL_INT(0, events);
    const size_t n = msm_of(T0 + PEL_NS_PER_S, PEL_SYS_GPS, false);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_INT64(T0, rx.epoch.t_ns);
    TEST_ASSERT_EQUAL_INT(PEL_RX_EPOCH, pel_receiver_push(&rx, 0)); /* and the next itself with the byte after */
    TEST_ASSERT_EQUAL_INT64(T0 + PEL_NS_PER_S, rx.epoch.t_ns);
    TEST_ASSERT_EQUAL_UINT32(2, rx.counters.frames);
}

static void glonass_is_skipped_but_closes_the_epoch(void)
{
    uint8_t glonass[40] = {0xD3, 0, 30};
    pel_bits_put(glonass, 24, 12, 1087);
    pel_bits_put(glonass, 24 + 54, 1, 0);
    pel_bits_put(glonass, 8 * 33, 24, pel_crc24q(0, glonass, 33));
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, msm_of(T0, PEL_SYS_GPS, true), PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, glonass, 36, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT16(8, rx.epoch.n);

    setUp(); /* 1010: its time has 27 bits, so its flag is three bits earlier */
    pel_bits_put(glonass, 24, 12, 1010);
    pel_bits_put(glonass, 24 + 51, 1, 1);
    pel_bits_put(glonass, 8 * 33, 24, pel_crc24q(0, glonass, 33));
    (void)support_push(&rx, frame, msm_of(T0, PEL_SYS_GPS, true), PEL_RX_EPOCH);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, glonass, 36, PEL_RX_EPOCH));
    pel_bits_put(glonass, 24 + 51, 1, 0);
    pel_bits_put(glonass, 8 * 33, 24, pel_crc24q(0, glonass, 33));
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, glonass, 36, PEL_RX_EPOCH));
}

static void a_second_message_of_an_epoch_already_given_is_a_duplicate(void)
{
    (void)support_push(&rx, frame, msm_of(T0, PEL_SYS_GPS, false), PEL_RX_EPOCH);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, msm_of(T0, PEL_SYS_GAL, false), PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.duplicate);
}

static void of_two_codes_on_one_carrier_the_preferred_stays(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 2);
    for (int i = 0; i < 4; i++) { epoch.obs[i].carrier = PEL_CARRIER_L2; }
    epoch.obs[0].code = 'W';
    epoch.obs[1].code = 'L';
    epoch.obs[1].prn = epoch.obs[0].prn;
    const size_t n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 1, false, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_CHAR('L', rx.epoch.obs[0].code);
    TEST_ASSERT_GREATER_THAN_UINT32(0, rx.counters.duplicate);
}

static void signals_that_do_not_fit_are_counted(void)
{
    static const pel_sys_t SYS[] = {PEL_SYS_GPS, PEL_SYS_GAL, PEL_SYS_QZS, PEL_SYS_BDS, PEL_SYS_SBS};
    int sent = 0;
    for (int s = 0; s < 5; s++) {
        support_epoch(&epoch, T0, SYS[s], (SYS[s] == PEL_SYS_QZS) ? 10 : 31);
        sent += epoch.n;
        const size_t n = pel_rtcm3_encode_msm(&epoch, SYS[s], 4, 1, s < 4, frame, sizeof frame);
        (void)support_push(&rx, frame, n, PEL_RX_EPOCH);
    }
    TEST_ASSERT_EQUAL_UINT16(PEL_MAX_OBS, rx.epoch.n);
    TEST_ASSERT_EQUAL_UINT16(sent - PEL_MAX_OBS, rx.epoch.dropped);
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(sent - PEL_MAX_OBS), rx.counters.overflow);
}

static void without_a_week_observations_wait_for_an_ephemeris(void)
{
    pel_ephemeris_t eph;
    pel_receiver_init(&rx);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, msm_of(T0, PEL_SYS_GPS, false), PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.unknown);
    support_ephemeris(&eph, PEL_SYS_GPS, 3);
    TEST_ASSERT_EQUAL_INT(
        1, support_push(&rx, frame, pel_rtcm3_encode_ephemeris(&eph, frame, sizeof frame), PEL_RX_EPHEMERIS));
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, msm_of(T0, PEL_SYS_GPS, false), PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_INT64(T0, rx.epoch.t_ns);
}

static void epochs_run_on_across_the_week(void)
{
    const pel_time_t edge = INT64_C(2301) * PEL_NS_PER_WEEK;
    static const pel_sys_t SYS[] = {PEL_SYS_GPS, PEL_SYS_BDS};
    pel_receiver_set_time(&rx, edge - 3 * 86400 * PEL_NS_PER_S);
    for (int i = -20; i < 20; i++) {
        for (int s = 0; s < 2; s++) {
            const int events = support_push(&rx, frame, msm_of(edge + i * PEL_NS_PER_S, SYS[s], s == 0), PEL_RX_EPOCH);
            TEST_ASSERT_EQUAL_INT(s, events);
        }
        TEST_ASSERT_EQUAL_INT64(edge + i * PEL_NS_PER_S, rx.epoch.t_ns);
    }
}

/* RTCM 10403 table 3.5-74 and 3.5-75, rows as printed there. */
static void lock_time_indicators(void)
{
    static const uint32_t DF402[][2] = {{0, 0}, {1, 32}, {2, 64}, {5, 512}, {10, 16384}, {15, 524288}};
    static const uint32_t DF407[][2] = {{0, 0},       {63, 63},        {64, 64},        {65, 66},
                                        {95, 126},    {96, 128},       {128, 256},      {160, 512},
                                        {320, 16384}, {640, 16777216}, {703, 66060288}, {704, 67108864}};
    for (size_t i = 0; i < 6; i++) { TEST_ASSERT_EQUAL_UINT32(DF402[i][1], pel_msm_lock_ms(4, DF402[i][0])); }
    for (size_t i = 0; i < 12; i++) { TEST_ASSERT_EQUAL_UINT32(DF407[i][1], pel_msm_lock_ms(10, DF407[i][0])); }
    for (uint32_t i = 1; i <= 704; i++) {
        TEST_ASSERT_TRUE(pel_msm_lock_ms(10, i) > pel_msm_lock_ms(10, i - 1));
        TEST_ASSERT_EQUAL_UINT32(i, pel_msm_lock_indicator(10, pel_msm_lock_ms(10, i)));
        TEST_ASSERT_EQUAL_UINT32(i - 1, pel_msm_lock_indicator(10, pel_msm_lock_ms(10, i) - 1));
    }
}

/* The worked example of the standard (RTCM 10403, 4.2): 1005 of station 2003. */
static void the_standards_own_example(void)
{
    static const uint8_t P[] = {0xD3, 0x00, 0x13, 0x3E, 0xD7, 0xD3, 0x02, 0x02, 0x98, 0x0E, 0xDE, 0xEF, 0x34,
                                0xB4, 0xBD, 0x62, 0xAC, 0x09, 0x41, 0x98, 0x6F, 0x33, 0x36, 0x0B, 0x98};
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, P, sizeof P, PEL_RX_STATION));
    TEST_ASSERT_EQUAL_UINT16(2003, rx.station.id);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1114104.5999, rx.station.r_ea_e[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -4850729.7108, rx.station.r_ea_e[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 3975521.4643, rx.station.r_ea_e[2]);
}

static void encoders_refuse_what_does_not_fit(void)
{
    support_epoch(&epoch, T0, PEL_SYS_GPS, 10);
    for (size_t cap = 0; cap < 8 + 16 + 32 * 20; cap++) {
        TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_rawx(&epoch, 18, frame, cap));
    }
    const size_t n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 1, false, frame, sizeof frame);
    for (size_t cap = 0; cap < n; cap++) {
        TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 1, false, frame, cap));
    }
    const size_t m = pel_rtcm3_encode_1004(&epoch, 1, false, frame, sizeof frame);
    for (size_t cap = 0; cap < m; cap++) {
        TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_1004(&epoch, 1, false, frame, cap));
    }
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_msm(&epoch, PEL_N_SYS, 7, 1, false, frame, sizeof frame));
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 3, 1, false, frame, sizeof frame));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rawx_returns_every_bit);
    RUN_TEST(rinex_codes_go_out_as_the_carriers_own_signal);
    RUN_TEST(values_that_cannot_be_are_counted_and_left_out);
    RUN_TEST(a_time_that_cannot_be_refuses_the_epoch);
    RUN_TEST(duplicates_and_epochs_of_the_past_are_counted_not_given);
    RUN_TEST(a_receiver_that_restarted_in_the_past_is_believed_in_the_end);
    RUN_TEST(msm_returns_what_its_resolution_holds);
    RUN_TEST(msm_holds_half_cycles_missing_codes_and_missing_phases);
    RUN_TEST(legacy_1004_returns_what_its_resolution_holds);
    RUN_TEST(messages_of_one_epoch_are_one_epoch);
    RUN_TEST(an_epoch_whose_last_message_is_lost_goes_out_when_the_next_begins);
    RUN_TEST(glonass_is_skipped_but_closes_the_epoch);
    RUN_TEST(a_second_message_of_an_epoch_already_given_is_a_duplicate);
    RUN_TEST(of_two_codes_on_one_carrier_the_preferred_stays);
    RUN_TEST(signals_that_do_not_fit_are_counted);
    RUN_TEST(without_a_week_observations_wait_for_an_ephemeris);
    RUN_TEST(epochs_run_on_across_the_week);
    RUN_TEST(lock_time_indicators);
    RUN_TEST(the_standards_own_example);
    RUN_TEST(encoders_refuse_what_does_not_fit);
    return UNITY_END();
}

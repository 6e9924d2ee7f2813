/* GLONASS on the wire: strings and 1020, Moscow's days, MSM with and without channels, 1012. */
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/wire/navmsg.h"
#include "support_wire.h"
#include "unity.h"

#define DAY  (86400 * PEL_NS_PER_S)
#define TB   (900 * PEL_NS_PER_S)
#define LEAP (18 * PEL_NS_PER_S)

static pel_receiver_t rx;
static pel_epoch_t epoch;
static uint8_t frame[PEL_MAX_FRAME_BYTES];

void setUp(void)
{
    pel_receiver_init(&rx);
    pel_receiver_set_time(&rx, T0);
}
void tearDown(void) {}

/* toe: the quarter of an hour of UTC at or before t. */
static pel_ephemeris_t glonass(int prn, pel_time_t t)
{
    const pel_ephemeris_t e = {
        .sys = PEL_SYS_GLO,
        .prn = (uint8_t)prn,
        .iode = 0,
        .sd_ura_m = 4.0f,
        .toe_ns = t - (t - LEAP) % TB,
        .af0 = -3.21e-5,
        .af1 = 1.82e-12,
        .tgd_s = {-3.7e-9, 0.0},
        .glo = {.r_e = {-11111111.0, 9876543.5, 20654321.25},
                .v_e = {1234.5, 2345.6, -456.7},
                .a_e = {1.86e-6, -2.79e-6, 0.0},
                .k = (int8_t)(prn % 14 - 7)},
    };
    return e;
}

static void expect_equal(const pel_ephemeris_t *a, const pel_ephemeris_t *b)
{
    TEST_ASSERT_EQUAL_UINT8(PEL_SYS_GLO, b->sys);
    TEST_ASSERT_EQUAL_UINT8(a->prn, b->prn);
    TEST_ASSERT_EQUAL_UINT8(a->health, b->health);
    TEST_ASSERT_EQUAL_INT64(a->toe_ns, b->toe_ns);
    TEST_ASSERT_EQUAL_INT64(a->toe_ns, b->toc_ns);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-31), a->af0, b->af0);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-41), a->af1, b->af1);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-31), a->tgd_s[0], b->tgd_s[0]);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e3 * pel_pow2(-12), a->glo.r_e[i], b->glo.r_e[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e3 * pel_pow2(-21), a->glo.v_e[i], b->glo.v_e[i]);
        TEST_ASSERT_DOUBLE_WITHIN(1e3 * pel_pow2(-31), a->glo.a_e[i], b->glo.a_e[i]);
    }
    TEST_ASSERT_EQUAL_INT8(a->glo.k, b->glo.k);
    TEST_ASSERT_EQUAL_FLOAT(a->sd_ura_m, b->sd_ura_m);
}

static int push_string(const pel_ephemeris_t *e, int part, pel_time_t t)
{
    const size_t n = pel_ubx_encode_sfrbx_eph(e, part, t, frame, sizeof frame);
    TEST_ASSERT_GREATER_THAN_size_t(0, n);
    return support_push(&rx, frame, n, PEL_RX_EPHEMERIS);
}

static void message_1020_returns_every_field(void)
{
    for (int prn = 1; prn <= 32; prn++) {
        pel_ephemeris_t e = glonass(prn, T0);
        e.health = (uint8_t)(prn % 2);
        const size_t n = pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame);
        TEST_ASSERT_EQUAL_size_t(45 + 6, n);
        TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPHEMERIS));
        expect_equal(&e, &rx.ephemeris);
    }
}

static void strings_return_every_field_in_any_order(void)
{
    static const int ORDER[][4] = {{1, 2, 3, 4}, {4, 3, 2, 1}, {3, 4, 1, 2}};
    for (int i = 0; i < 3; i++) {
        const pel_ephemeris_t e = glonass(7 + i, T0);
        int events = 0;
        for (int k = 0; k < 4; k++) { events += push_string(&e, ORDER[i][k], T0); }
        TEST_ASSERT_EQUAL_INT(1, events);
        expect_equal(&e, &rx.ephemeris);
    }
}

static void strings_of_two_frames_do_not_mix(void)
{
    const pel_ephemeris_t old = glonass(9, T0);
    pel_ephemeris_t new = glonass(9, T0 + TB);
    new.glo.r_e[0] += 1e6;
    int events = push_string(&old, 1, T0) + push_string(&old, 2, T0);
    for (int part = 3; part <= 4; part++) { events += push_string(&new, part, T0 + 30 * PEL_NS_PER_S); }
    TEST_ASSERT_EQUAL_INT(0, events);
    for (int part = 1; part <= 2; part++) { events += push_string(&new, part, T0 + 30 * PEL_NS_PER_S); }
    TEST_ASSERT_EQUAL_INT(1, events);
    expect_equal(&new, &rx.ephemeris);
}

/* Across midnight of Moscow, the end of the four years (2019-12-31), of the week and of the leap second of 2016; with an
 * approximate time days off, since N_T tells the day. */
static void days_are_found(void)
{
    static const int64_t AT_S[] = {1261861218, 1230595218, 1253404818, 1167264017, 1167264018 - 10800, 1577750418};
    for (size_t i = 0; i < sizeof AT_S / sizeof AT_S[0]; i++) {
        for (int quarter = -3; quarter <= 3; quarter++) {
            const pel_time_t leap = pel_time_leap_s(AT_S[i] * PEL_NS_PER_S) * PEL_NS_PER_S;
            pel_time_t t = AT_S[i] * PEL_NS_PER_S + quarter * TB;
            pel_ephemeris_t e = glonass(3, t);
            e.toe_ns = t - (t - leap) % TB;
            if (pel_time_leap_s(e.toe_ns) * PEL_NS_PER_S != leap) { continue; }
            const size_t n = pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame);
            TEST_ASSERT_GREATER_THAN_size_t(0, n);
            for (int away_d = -3; away_d <= 3; away_d++) {
                pel_receiver_init(&rx);
                pel_receiver_set_time(&rx, t + away_d * DAY);
                /* over a leap second the reference's own second counts differently: that is not asked for */
                if (pel_time_leap_s(t + away_d * DAY) * PEL_NS_PER_S != leap) { continue; }
                TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPHEMERIS));
                TEST_ASSERT_EQUAL_INT64(e.toe_ns, rx.ephemeris.toe_ns);
            }
        }
    }
}

static void parity_finds_every_one_and_two_flipped_bits(void)
{
    const pel_ephemeris_t e = glonass(11, T0);
    int missed = 0;
    for (int part = 1; part <= 4; part++) {
        uint8_t s[12] = {0};
        (void)pel_ubx_encode_sfrbx_eph(&e, part, T0, frame, sizeof frame);
        for (unsigned i = 0; i < 3u; i++) { pel_bits_put(s, 32u * i, 32, pel_le_u(frame + 14 + 4u * i, 4)); }
        TEST_ASSERT_TRUE(pel_glo_string_good(s));
        for (unsigned i = 0; i < 85u; i++) {
            s[i / 8u] ^= (uint8_t)(0x80u >> (i % 8u));
            missed += pel_glo_string_good(s) ? 1 : 0;
            for (unsigned k = 0; k < i; k++) {
                s[k / 8u] ^= (uint8_t)(0x80u >> (k % 8u));
                missed += pel_glo_string_good(s) ? 1 : 0;
                s[k / 8u] ^= (uint8_t)(0x80u >> (k % 8u));
            }
            s[i / 8u] ^= (uint8_t)(0x80u >> (i % 8u));
        }
    }
    TEST_ASSERT_EQUAL_INT(0, missed);
}

static void what_cannot_be_is_refused(void)
{
    pel_ephemeris_t e = glonass(11, T0);
    e.glo.r_e[0] = 0.0;
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame));
    e = glonass(11, T0);
    e.toe_ns += PEL_NS_PER_S;
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 1, T0, frame, sizeof frame));
    e = glonass(11, T0);
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 5, T0, frame, sizeof frame));
    size_t n = pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame);
    pel_bits_put(frame + 3, 12 + 6, 5, 20); /* channel 13 */
    (void)pel_rtcm3_seal(8u * (n - 6u), frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPHEMERIS));
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.bad_value);
    /* A receiver that does not know the date cannot know the day. */
    pel_receiver_init(&rx);
    n = pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPHEMERIS));
}

static void expect_signals(double code_m, double phase_m)
{
    TEST_ASSERT_EQUAL_UINT16(epoch.n, rx.epoch.n);
    for (int i = 0; i < (int)epoch.n; i++) {
        const pel_obs_t *a = &epoch.obs[i];
        const pel_obs_t *b = &rx.epoch.obs[i];
        const double lambda = PEL_SPEED_OF_LIGHT / pel_carrier_hz(PEL_SYS_GLO, (pel_carrier_t)a->carrier, a->glo_k);
        TEST_ASSERT_TRUE(a->prn == b->prn && a->carrier == b->carrier && a->glo_k == b->glo_k && a->code == b->code);
        TEST_ASSERT_DOUBLE_WITHIN(code_m, a->P_m, b->P_m);
        TEST_ASSERT_DOUBLE_WITHIN(phase_m / lambda, a->L_cyc, b->L_cyc);
    }
}

static void msm_carries_channels_or_learns_them(void)
{
    const double ms = PEL_SPEED_OF_LIGHT * 1e-3;
    for (int msm = 4; msm <= 7; msm++) {
        setUp();
        support_epoch(&epoch, T0, PEL_SYS_GLO, 14);
        size_t n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GLO, msm, 77, false, frame, sizeof frame);
        if (msm % 2 == 0) { /* not told yet: left out */
            TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPOCH));
            TEST_ASSERT_EQUAL_UINT32(28, rx.counters.unknown);
            for (int prn = 1; prn <= 14; prn++) {
                pel_ephemeris_t e = glonass(prn, T0);
                e.glo.k = (int8_t)((prn - 1) % 14 - 7);
                const size_t m = pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame);
                TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, m, PEL_RX_EPHEMERIS));
            }
            n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GLO, msm, 77, false, frame, sizeof frame);
        }
        TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
        TEST_ASSERT_EQUAL_INT64(T0, rx.epoch.t_ns);
        expect_signals(ms * pel_pow2((msm < 6) ? -25 : -30) + 1e-6, ms * pel_pow2((msm < 6) ? -30 : -32) + 1e-6);
    }
}

/* Three hours before and after midnight of Sunday, where the days of the week of GPS and Moscow differ. */
static void gps_and_glonass_messages_are_one_epoch_all_week(void)
{
    for (int quarter = 0; quarter < 7 * 96; quarter++) {
        const pel_time_t t = pel_time_from_week(2310, 0.0) + quarter * TB;
        setUp();
        pel_receiver_set_time(&rx, t - 2 * DAY);
        support_epoch(&epoch, t, PEL_SYS_GPS, 4);
        support_append(&epoch, PEL_SYS_GLO, 4);
        int events = 0;
        size_t n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 77, true, frame, sizeof frame);
        events += support_push(&rx, frame, n, PEL_RX_EPOCH);
        n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GLO, 7, 77, false, frame, sizeof frame);
        events += support_push(&rx, frame, n, PEL_RX_EPOCH);
        TEST_ASSERT_EQUAL_INT(1, events);
        TEST_ASSERT_EQUAL_INT64(t, rx.epoch.t_ns);
        TEST_ASSERT_EQUAL_UINT16(16, rx.epoch.n);
    }
}

/* One satellite by hand: slot 5, channel 3, 21 000 000.00 m, phase 10 m longer; G2 2 m longer, without phase. */
static size_t message_1012(pel_time_t t, uint8_t *out, size_t cap)
{
    const double two_ms_m = 2e-3 * PEL_SPEED_OF_LIGHT;
    const uint64_t whole = (uint64_t)(21e6 / two_ms_m);
    pel_bit_writer_t w;
    pel_bit_writer_init(&w, out + 3, cap - 6);
    pel_write_u(&w, 12, 1012);
    pel_write_u(&w, 12, 77);
    pel_write_u(&w, 27, (uint64_t)(pel_moscow_from_gps(t) % DAY / PEL_NS_PER_MS));
    pel_write_u(&w, 1, 0);
    pel_write_u(&w, 5, 1);
    pel_write_u(&w, 4, 0);
    pel_write_u(&w, 6, 5);
    pel_write_u(&w, 1, 0);
    pel_write_u(&w, 5, 3 + 7);
    pel_write_u(&w, 25, (uint64_t)pel_round_i64((21e6 - (double)whole * two_ms_m) / 0.02));
    pel_write_s(&w, 20, 20000);
    pel_write_u(&w, 7, 30);
    pel_write_u(&w, 7, whole);
    pel_write_u(&w, 8, 160);
    pel_write_u(&w, 2, 1);
    pel_write_s(&w, 14, 100);
    pel_write_s(&w, 20, -524288);
    pel_write_u(&w, 7, 0);
    pel_write_u(&w, 8, 120);
    return pel_rtcm3_seal(w.pos, out, cap);
}

static void legacy_1012_needs_the_day_and_yields_to_msm(void)
{
    size_t n = message_1012(T0, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPOCH)); /* nothing told the day */
    support_epoch(&epoch, T0 - PEL_NS_PER_S, PEL_SYS_GPS, 4);
    n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 77, false, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    n = message_1012(T0, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    const pel_obs_t *o = rx.epoch.obs;
    TEST_ASSERT_EQUAL_INT64(T0, rx.epoch.t_ns);
    TEST_ASSERT_EQUAL_UINT16(2, rx.epoch.n);
    TEST_ASSERT_TRUE(o[0].prn == 5 && o[0].glo_k == 3 && o[0].code == 'C' && o[1].code == 'P');
    TEST_ASSERT_DOUBLE_WITHIN(0.0101, 21e6, o[0].P_m);
    TEST_ASSERT_DOUBLE_WITHIN(0.0101, 21e6 + 2.0, o[1].P_m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, o[0].P_m + 10.0,
                              o[0].L_cyc * PEL_SPEED_OF_LIGHT / pel_carrier_hz(PEL_SYS_GLO, PEL_CARRIER_L1, 3));
    TEST_ASSERT_EQUAL_HEX8(PEL_OBS_CODE, o[1].flags);

    support_epoch(&epoch, T0 + PEL_NS_PER_S, PEL_SYS_GLO, 4);
    n = pel_rtcm3_encode_msm(&epoch, PEL_SYS_GLO, 7, 77, false, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    n = message_1012(T0 + 2 * PEL_NS_PER_S, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPOCH));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(message_1020_returns_every_field);
    RUN_TEST(strings_return_every_field_in_any_order);
    RUN_TEST(strings_of_two_frames_do_not_mix);
    RUN_TEST(days_are_found);
    RUN_TEST(parity_finds_every_one_and_two_flipped_bits);
    RUN_TEST(what_cannot_be_is_refused);
    RUN_TEST(msm_carries_channels_or_learns_them);
    RUN_TEST(gps_and_glonass_messages_are_one_epoch_all_week);
    RUN_TEST(legacy_1012_needs_the_day_and_yields_to_msm);
    return UNITY_END();
}

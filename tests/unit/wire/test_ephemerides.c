/* Broadcast ephemerides through RTCM 3 and through SFRBX: every field of every system, order, mixture, week edges. */
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/wire/framing.h"
#include "support_wire.h"
#include "unity.h"

#define HOUR (3600 * PEL_NS_PER_S)

static pel_receiver_t rx;
static uint8_t frame[256];

void setUp(void)
{
    pel_receiver_init(&rx);
    pel_receiver_set_time(&rx, T0);
}
void tearDown(void) {}

/* Half a unit of each field's last bit, or half that of the coarser of two formats. */
static void expect_equal(const pel_ephemeris_t *a, const pel_ephemeris_t *b)
{
    const double pi = 3.1415926535898;
    TEST_ASSERT_EQUAL_UINT8(a->sys, b->sys);
    TEST_ASSERT_EQUAL_UINT8(a->prn, b->prn);
    TEST_ASSERT_EQUAL_UINT8(a->health, b->health);
    TEST_ASSERT_EQUAL_UINT16(a->iode, b->iode);
    TEST_ASSERT_EQUAL_INT64(a->toe_ns, b->toe_ns);
    TEST_ASSERT_EQUAL_INT64(a->toc_ns, b->toc_ns);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-32), a->af0, b->af0);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-44), a->af1, b->af1);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-56), a->af2, b->af2);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-20), a->sqrt_a, b->sqrt_a);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-34), a->e, b->e);
    TEST_ASSERT_DOUBLE_WITHIN(pi * pel_pow2(-32) + 1e-12, a->i0, b->i0);
    TEST_ASSERT_DOUBLE_WITHIN(pi * pel_pow2(-32) + 1e-12, a->Omega0, b->Omega0);
    TEST_ASSERT_DOUBLE_WITHIN(pi * pel_pow2(-32) + 1e-12, a->omega, b->omega);
    TEST_ASSERT_DOUBLE_WITHIN(pi * pel_pow2(-32) + 1e-12, a->M0, b->M0);
    TEST_ASSERT_DOUBLE_WITHIN(pi * pel_pow2(-44), a->dn, b->dn);
    TEST_ASSERT_DOUBLE_WITHIN(pi * pel_pow2(-44), a->Omega_dot, b->Omega_dot);
    TEST_ASSERT_DOUBLE_WITHIN(pi * pel_pow2(-44), a->idot, b->idot);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-30), a->cuc, b->cuc);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-30), a->cus, b->cus);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-30), a->cic, b->cic);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-30), a->cis, b->cis);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-6), a->crc, b->crc);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-6), a->crs, b->crs);
    TEST_ASSERT_DOUBLE_WITHIN(pel_pow2(-32), a->tgd_s[0], b->tgd_s[0]);
    TEST_ASSERT_FLOAT_WITHIN(0.25f * a->sd_ura_m, a->sd_ura_m, b->sd_ura_m);
}

static void rtcm_returns_every_field(void)
{
    static const uint8_t SYS[][2] = {
        {PEL_SYS_GPS, 31}, {PEL_SYS_GAL, 36}, {PEL_SYS_GAL, 5}, {PEL_SYS_BDS, 63}, {PEL_SYS_QZS, 10}};
    for (int i = 0; i < 5; i++) {
        pel_ephemeris_t e;
        support_ephemeris(&e, (pel_sys_t)SYS[i][0], SYS[i][1]);
        e.source = (i == 2) ? 1 : 0;
        e.health = (e.sys == PEL_SYS_BDS) ? 1 : (i == 2) ? 3 : (e.sys == PEL_SYS_GAL) ? 0x35 : 0x3E;
        const size_t n = pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame);
        TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPHEMERIS));
        TEST_ASSERT_EQUAL_UINT8(e.source, rx.ephemeris.source);
        expect_equal(&e, &rx.ephemeris);
    }
}

static int push_part(const pel_ephemeris_t *e, int part, pel_time_t t)
{
    const size_t n = pel_ubx_encode_sfrbx_eph(e, part, t, frame, sizeof frame);
    TEST_ASSERT_GREATER_THAN_size_t(0, n);
    return support_push(&rx, frame, n, PEL_RX_EPHEMERIS);
}

static const uint8_t SATELLITE[][2] = {{PEL_SYS_GPS, 32}, {PEL_SYS_QZS, 3}, {PEL_SYS_GAL, 11},
                                       {PEL_SYS_BDS, 20}, {PEL_SYS_BDS, 3}, {PEL_SYS_BDS, 60}};

static void sfrbx_returns_every_field_in_any_order(void)
{
    for (int i = 0; i < 6; i++) {
        for (int order = 0; order < 3; order++) {
            pel_ephemeris_t e;
            setUp();
            support_ephemeris(&e, (pel_sys_t)SATELLITE[i][0], SATELLITE[i][1]);
            const int n = pel_ubx_sfrbx_parts(&e);
            int events = 0;
            for (int k = 0; k < n; k++) {
                const int part = (order == 0) ? k + 1 : (order == 1) ? n - k : (k + n / 2) % n + 1;
                events += push_part(&e, part, T0 + HOUR);
            }
            TEST_ASSERT_EQUAL_INT(1, events);
            expect_equal(&e, &rx.ephemeris);
        }
    }
}

/* A new set begins while the old one is being collected: nothing is given until one of them is whole. */
static void parts_of_two_sets_do_not_mix(void)
{
    for (int i = 0; i < 6; i++) {
        pel_ephemeris_t old;
        pel_ephemeris_t new;
        setUp();
        support_ephemeris(&old, (pel_sys_t)SATELLITE[i][0], SATELLITE[i][1]);
        new = old;
        new.iode++;
        new.iodc++;
        new.toe_ns += 2 * HOUR;
        new.toc_ns += 2 * HOUR;
        new.M0 += 0.5;
        const int n = pel_ubx_sfrbx_parts(&old);
        int events = push_part(&old, 1, T0);
        for (int part = 2; part <= n; part++) { events += push_part(&new, part, T0 + 30 * PEL_NS_PER_S); }
        TEST_ASSERT_EQUAL_INT(0, events);
        events += push_part(&new, 1, T0 + 30 * PEL_NS_PER_S);
        TEST_ASSERT_EQUAL_INT(1, events);
        expect_equal(&new, &rx.ephemeris);
    }
}

static void satellites_interleave(void)
{
    int events = 0;
    for (int part = 1; part <= 10; part++) {
        for (int i = 0; i < 6; i++) {
            pel_ephemeris_t e;
            support_ephemeris(&e, (pel_sys_t)SATELLITE[i][0], SATELLITE[i][1]);
            if (part <= pel_ubx_sfrbx_parts(&e)) { events += push_part(&e, part, T0); }
        }
    }
    TEST_ASSERT_EQUAL_INT(6, events);
}

/* A slot is free again once its set is whole, so satellites without one get their turn in the next frames. */
static void more_satellites_than_slots_are_all_served_in_time(void)
{
    bool served[2][64] = {{false}};
    int n_served = 0;
    int round = 0;
    for (; n_served < 64 && round < 10; round++) {
        for (int part = 1; part <= 3; part++) {
            for (int i = 0; i < 64; i++) {
                pel_ephemeris_t e;
                support_ephemeris(&e, (i % 2 == 0) ? PEL_SYS_GPS : PEL_SYS_BDS, (i % 2 == 0) ? i / 2 + 1 : i / 2 + 20);
                if (push_part(&e, part, T0 + 30 * round * PEL_NS_PER_S) == 1 && !served[i % 2][i / 2]) {
                    served[i % 2][i / 2] = true;
                    n_served++;
                }
            }
        }
    }
    printf("64 satellites, %d slots: all served after %d frames of 30 s, %u parts refused\n", PEL_NAV_SLOTS, round,
           rx.counters.overflow);
    TEST_ASSERT_EQUAL_INT(64, n_served);
    TEST_ASSERT_GREATER_THAN_UINT32(0, rx.counters.overflow);
}

/* toe in the first hours of the next week, sent in the last of this one, and the reverse. */
static void toe_across_the_week_edge(void)
{
    static const int64_t LAG_S[] = {-7200, 7200};
    for (int i = 0; i < 6; i++) {
        for (int k = 0; k < 2; k++) {
            pel_ephemeris_t e;
            const pel_time_t edge = INT64_C(2301) * PEL_NS_PER_WEEK;
            setUp();
            support_ephemeris(&e, (pel_sys_t)SATELLITE[i][0], SATELLITE[i][1]);
            e.toe_ns = edge - LAG_S[k] / 2 * PEL_NS_PER_S + ((e.sys == PEL_SYS_BDS) ? 14 * PEL_NS_PER_S : 0);
            e.toc_ns = e.toe_ns;
            const pel_time_t sent = edge + LAG_S[k] / 2 * PEL_NS_PER_S;
            pel_receiver_set_time(&rx, sent + 2 * 86400 * PEL_NS_PER_S);
            int events = 0;
            for (int part = 1; part <= pel_ubx_sfrbx_parts(&e); part++) { events += push_part(&e, part, sent); }
            TEST_ASSERT_EQUAL_INT(1, events);
            TEST_ASSERT_EQUAL_INT64(e.toe_ns, rx.ephemeris.toe_ns);
            TEST_ASSERT_EQUAL_INT64(e.toc_ns, rx.ephemeris.toc_ns);
        }
    }
}

/* Some senders of 1019 give the week of transmission beside a toe of the next. */
static void rtcm_week_of_transmission_beside_a_toe_of_the_next(void)
{
    pel_ephemeris_t e;
    const pel_time_t edge = INT64_C(2301) * PEL_NS_PER_WEEK;
    support_ephemeris(&e, PEL_SYS_GPS, 9);
    e.toe_ns = edge + 7200 * PEL_NS_PER_S;
    e.toc_ns = e.toe_ns;
    const size_t n = pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame);
    pel_bits_put(frame, 24 + 18, 10, 2300 % 1024);
    pel_bits_put(frame, 8 * (n - 3), 24, pel_crc24q(0, frame, n - 3));
    pel_receiver_set_time(&rx, edge - HOUR);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPHEMERIS));
    TEST_ASSERT_EQUAL_INT64(e.toe_ns, rx.ephemeris.toe_ns);
}

static void ten_bits_of_week_follow_the_given_time(void)
{
    for (int32_t week = 1300; week < 3300; week += 333) {
        pel_ephemeris_t e;
        support_ephemeris(&e, PEL_SYS_GPS, 9);
        e.toe_ns = (pel_time_t)week * PEL_NS_PER_WEEK + 7200 * PEL_NS_PER_S;
        e.toc_ns = e.toe_ns;
        pel_receiver_init(&rx);
        pel_receiver_set_time(&rx, e.toe_ns + 3 * 86400 * PEL_NS_PER_S);
        TEST_ASSERT_EQUAL_INT(
            1, support_push(&rx, frame, pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame), PEL_RX_EPHEMERIS));
        TEST_ASSERT_EQUAL_INT64(e.toe_ns, rx.ephemeris.toe_ns);
    }
}

static void orbits_that_cannot_be_are_refused(void)
{
    pel_ephemeris_t e;
    support_ephemeris(&e, PEL_SYS_GPS, 9);
    size_t n = pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame);
    pel_bits_put(frame, 24 + 12, 6, 40); /* prn 40 */
    pel_bits_put(frame, 8 * (n - 3), 24, pel_crc24q(0, frame, n - 3));
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPHEMERIS));
    n = pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame);
    for (size_t i = 6; i < n - 3; i++) { frame[i] = 0xFF; }
    pel_bits_put(frame, 8 * (n - 3), 24, pel_crc24q(0, frame, n - 3));
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, n, PEL_RX_EPHEMERIS));
    TEST_ASSERT_EQUAL_UINT32(2, rx.counters.bad_value);
}

static void encoders_refuse_fields_that_overflow(void)
{
    pel_ephemeris_t e;
    for (int i = 0; i < 6; i++) {
        support_ephemeris(&e, (pel_sys_t)SATELLITE[i][0], SATELLITE[i][1]);
        e.crs = 5000.0;
        TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame));
        support_ephemeris(&e, (pel_sys_t)SATELLITE[i][0], SATELLITE[i][1]);
        e.toe_ns += PEL_NS_PER_S; /* not a multiple of the unit */
        TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame));
        TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 1, T0, frame, sizeof frame));
    }
    support_ephemeris(&e, PEL_SYS_GPS, 1);
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 4, T0, frame, sizeof frame));
    TEST_ASSERT_EQUAL_size_t(0, pel_ubx_encode_sfrbx_eph(&e, 1, T0, frame, 20));
    e.sys = PEL_SYS_GLO;
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_ephemeris(&e, frame, sizeof frame));
}

static void words_that_are_no_subframe_are_refused(void)
{
    pel_ephemeris_t e;
    support_ephemeris(&e, PEL_SYS_GPS, 9);
    size_t n = pel_ubx_encode_sfrbx_eph(&e, 1, T0, frame, sizeof frame);
    frame[6 + 8 + 3] ^= 0x20; /* preamble */
    (void)pel_ubx_seal(2, 0x13, n - 8, frame, sizeof frame);
    (void)support_push(&rx, frame, n, PEL_RX_NONE);
    support_ephemeris(&e, PEL_SYS_GAL, 9);
    n = pel_ubx_encode_sfrbx_eph(&e, 1, T0, frame, sizeof frame);
    frame[6 + 8 + 5] ^= 0x01; /* breaks the page's own CRC */
    (void)pel_ubx_seal(2, 0x13, n - 8, frame, sizeof frame);
    (void)support_push(&rx, frame, n, PEL_RX_NONE);
    TEST_ASSERT_EQUAL_UINT32(2, rx.counters.bad_value);
    TEST_ASSERT_EQUAL_UINT32(2, rx.counters.frames);
}

static void klobuchar_returns(void)
{
    const pel_klobuchar_t k = {.valid = true,
                               .alpha = {1.1175871e-8f, 7.4505806e-9f, -5.9604645e-8f, -1.1920929e-7f},
                               .beta = {90112.0f, -16384.0f, -196608.0f, 65536.0f}};
    const size_t n = pel_ubx_encode_sfrbx_klobuchar(&k, 12, T0, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_KLOBUCHAR));
    TEST_ASSERT_TRUE(rx.klobuchar.valid);
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_FLOAT_WITHIN(1e-15f, k.alpha[i], rx.klobuchar.alpha[i]);
        TEST_ASSERT_FLOAT_WITHIN(0.01f, k.beta[i], rx.klobuchar.beta[i]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rtcm_returns_every_field);
    RUN_TEST(sfrbx_returns_every_field_in_any_order);
    RUN_TEST(parts_of_two_sets_do_not_mix);
    RUN_TEST(satellites_interleave);
    RUN_TEST(more_satellites_than_slots_are_all_served_in_time);
    RUN_TEST(toe_across_the_week_edge);
    RUN_TEST(rtcm_week_of_transmission_beside_a_toe_of_the_next);
    RUN_TEST(ten_bits_of_week_follow_the_given_time);
    RUN_TEST(orbits_that_cannot_be_are_refused);
    RUN_TEST(encoders_refuse_fields_that_overflow);
    RUN_TEST(words_that_are_no_subframe_are_refused);
    RUN_TEST(klobuchar_returns);
    return UNITY_END();
}

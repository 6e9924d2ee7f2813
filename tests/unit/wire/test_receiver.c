/* What a receiver stream keeps and refuses of single signals, and how it collects the messages of an epoch. */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/wire/framing.h"
#include "support_wire.h"
#include "unity.h"

static pel_receiver_t rx;
static pel_epoch_t epoch;
static uint8_t frame[PEL_MAX_FRAME_BYTES];

void setUp(void)
{
    pel_receiver_init(&rx);
    pel_receiver_set_time(&rx, T0);
}
void tearDown(void) {}

static pel_obs_t good(void)
{
    const pel_obs_t o = {.P_m = 2.1e7,
                         .L_cyc = 1.1e8,
                         .D_hz = -1234.5f,
                         .cn0_dbhz = 45.0f,
                         .prn = 7,
                         .code = 'C',
                         .flags = PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER};
    return o;
}

#define CHECK(verdict, change)                                                                                         \
    do {                                                                                                               \
        pel_obs_t o = good();                                                                                          \
        change;                                                                                                        \
        TEST_ASSERT_EQUAL_MESSAGE(verdict, pel_obs_plausible(&o), #change);                                            \
    } while (0)
#define IN(change)  CHECK(true, change)
#define OUT(change) CHECK(false, change)

static void a_signal_is_taken_up_to_its_limits_and_not_beyond(void)
{
    const double nan = (double)NAN;
    IN((void)o);
    IN(o.P_m = 1e6);
    IN(o.P_m = 1e8);
    OUT(o.P_m = nextafter(1e6, 0.0));
    OUT(o.P_m = nextafter(1e8, 1e9));
    OUT(o.P_m = nan);
    IN(o.P_m = nan; o.flags = PEL_OBS_PHASE); /* what no flag calls valid is not looked at */
    IN(o.L_cyc = -1e10);
    IN(o.L_cyc = 1e10);
    OUT(o.L_cyc = nextafter(-1e10, -1e11));
    OUT(o.L_cyc = nextafter(1e10, 1e11));
    OUT(o.L_cyc = nan);
    IN(o.L_cyc = nan; o.flags = PEL_OBS_CODE);
    IN(o.D_hz = -1e5f);
    IN(o.D_hz = 1e5f);
    OUT(o.D_hz = nextafterf(-1e5f, -1e6f));
    OUT(o.D_hz = nextafterf(1e5f, 1e6f));
    OUT(o.D_hz = (float)nan);
    IN(o.D_hz = (float)nan; o.flags = PEL_OBS_CODE);
    IN(o.cn0_dbhz = 0.0f);
    IN(o.cn0_dbhz = 100.0f);
    OUT(o.cn0_dbhz = -0.25f);
    OUT(o.cn0_dbhz = 100.25f);
    OUT(o.cn0_dbhz = (float)nan);
    IN(o.prn = 1);
    IN(o.prn = 32);
    OUT(o.prn = 0);
    OUT(o.prn = 33);
    OUT(o.sys = PEL_N_SYS);
    OUT(o.carrier = PEL_N_CARRIER);
    IN(o.sys = PEL_SYS_GLO; o.glo_k = -7);
    OUT(o.sys = PEL_SYS_GLO; o.glo_k = -8);
    OUT(o.sys = PEL_SYS_GLO; o.carrier = PEL_CARRIER_L5);
}

/* The codes of two signals on one carrier, in the order they come, and which of them stays. */
static void of_two_codes_the_one_ranked_first_stays(void)
{
    static const struct {
        char first, second, stays;
    } CASE[] = {{'C', 'W', 'C'}, {'W', 'C', 'C'}, {'X', 'X', 'X'}, {'?', 'N', 'N'}, {'N', '?', 'N'}, {'!', '?', '!'}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        pel_obs_t o = good();
        setUp();
        o.code = CASE[i].first;
        pel_rx_add(&rx, &o);
        o.code = CASE[i].second;
        pel_rx_add(&rx, &o);
        TEST_ASSERT_EQUAL_UINT16(1, rx.epoch.n);
        TEST_ASSERT_EQUAL_CHAR(CASE[i].stays, rx.epoch.obs[0].code);
        TEST_ASSERT_EQUAL_UINT32(1, rx.counters.duplicate);
    }
}

static void another_satellite_system_or_carrier_is_another_signal(void)
{
    pel_obs_t o = good();
    pel_rx_add(&rx, &o);
    o.prn++;
    pel_rx_add(&rx, &o);
    o.sys = PEL_SYS_GAL;
    pel_rx_add(&rx, &o);
    o.carrier = PEL_CARRIER_L5;
    pel_rx_add(&rx, &o);
    TEST_ASSERT_EQUAL_UINT16(4, rx.epoch.n);
    TEST_ASSERT_EQUAL_UINT32(0, rx.counters.duplicate);
}

static void channels_are_remembered_by_slot(void)
{
    static const struct {
        unsigned slot;
        int k;
        bool known;
    } CASE[] = {{1, -7, true}, {32, 6, true}, {2, -8, false}, {3, 7, false}, {0, 0, false}, {33, 0, false}};
    rx.n_back = 5; /* lies behind the channels */
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        int8_t k = 99;
        pel_rx_learn_channel(&rx, CASE[i].slot, CASE[i].k);
        TEST_ASSERT_EQUAL_UINT8(5, rx.n_back);
        TEST_ASSERT_EQUAL(CASE[i].known, pel_rx_channel(&rx, CASE[i].slot, &k));
        TEST_ASSERT_EQUAL_INT8(CASE[i].known ? CASE[i].k : 99, k);
    }
}

/* ---- epochs ---------------------------------------------------------------------------------------------------------- */

static size_t msm(pel_time_t t, pel_sys_t sys, int n_sat, bool more)
{
    support_epoch(&epoch, t, sys, n_sat);
    return pel_rtcm3_encode_msm(&epoch, sys, 7, 1, more, frame, sizeof frame);
}

static void the_end_of_input_gives_an_epoch_that_waits_for_more(void)
{
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, msm(T0, PEL_SYS_GPS, 3, true), PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_INT(PEL_RX_EPOCH, pel_receiver_flush(&rx));
    TEST_ASSERT_EQUAL_UINT16(6, rx.epoch.n);
    TEST_ASSERT_EQUAL_INT(PEL_RX_NONE, pel_receiver_flush(&rx));
}

static void an_epoch_that_holds_nothing_is_none(void)
{
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, msm(T0, PEL_SYS_GPS, 0, true), PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_INT(PEL_RX_NONE, pel_receiver_flush(&rx));
    /* nor does it hold up the next */
    TEST_ASSERT_EQUAL_INT(0, support_push(&rx, frame, msm(T0 + PEL_NS_PER_S, PEL_SYS_GPS, 0, true), PEL_RX_EPOCH));
    const size_t n = msm(T0 + 2 * PEL_NS_PER_S, PEL_SYS_GPS, 3, false);
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_INT64(T0 + 2 * PEL_NS_PER_S, rx.epoch.t_ns);
    TEST_ASSERT_EQUAL_UINT32(3, rx.counters.frames);
}

/* Messages of one epoch may differ by a few milliseconds. */
static void a_message_of_the_past_does_not_join_the_epoch_being_collected(void)
{
    (void)support_push(&rx, frame, msm(T0, PEL_SYS_GPS, 3, true), PEL_RX_EPOCH);
    (void)support_push(&rx, frame, msm(T0 - 5 * PEL_NS_PER_MS, PEL_SYS_QZS, 3, true), PEL_RX_EPOCH);
    TEST_ASSERT_EQUAL_UINT16(12, rx.epoch.n);
    TEST_ASSERT_EQUAL_INT(0,
                          support_push(&rx, frame, msm(T0 - 6 * PEL_NS_PER_MS, PEL_SYS_GAL, 3, false), PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT16(12, rx.epoch.n);
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.time_back);
    TEST_ASSERT_EQUAL_INT(1,
                          support_push(&rx, frame, msm(T0 + 5 * PEL_NS_PER_MS, PEL_SYS_SBS, 3, false), PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT16(18, rx.epoch.n);
    TEST_ASSERT_EQUAL_INT64(T0, rx.epoch.t_ns);
}

/* A flipped bit in the number of signals must not lead past their array. */
static void a_number_of_signals_beyond_the_array_starts_anew(void)
{
    (void)support_push(&rx, frame, msm(T0, PEL_SYS_GPS, 3, true), PEL_RX_EPOCH);
    rx.epoch.n = PEL_MAX_OBS + 1;
    TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, msm(T0, PEL_SYS_GAL, 3, false), PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT16(6, rx.epoch.n);
    TEST_ASSERT_EQUAL_UINT8(PEL_SYS_GAL, rx.epoch.obs[0].sys);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_signal_is_taken_up_to_its_limits_and_not_beyond);
    RUN_TEST(of_two_codes_the_one_ranked_first_stays);
    RUN_TEST(another_satellite_system_or_carrier_is_another_signal);
    RUN_TEST(channels_are_remembered_by_slot);
    RUN_TEST(the_end_of_input_gives_an_epoch_that_waits_for_more);
    RUN_TEST(an_epoch_that_holds_nothing_is_none);
    RUN_TEST(a_message_of_the_past_does_not_join_the_epoch_being_collected);
    RUN_TEST(a_number_of_signals_beyond_the_array_starts_anew);
    return UNITY_END();
}

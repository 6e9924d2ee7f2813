/* The history of time differences: what it differences, what it refuses, and that the slip detectors' history and this one cannot hide a slip
 * from each other. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/math.h"
#include "pelorus/observe.h"
#include "unity.h"

#define LAMBDA (PEL_SPEED_OF_LIGHT / 1575.42e6)
#define STEP_S 0.1
#define MAX    8

/* A sky of n satellites whose ranges change steadily, one receiver with a clock. */
typedef struct {
    int n;
    double slip_cyc[MAX]; /* so far */
    uint32_t lock_ms[MAX];
    bool half[MAX], warned[MAX];
    double clock_m;
    double predicted_error_m; /* what the computed antenna is off by, along all lines of sight alike to satellite 0 */
} sky_t;

static sky_t sky;
static pel_epoch_t epoch;
static pel_sd_set_t set;
static pel_tdcp_t history;
static pel_slip_t detectors;
static pel_tdcp_change_t change[PEL_MAX_OBS];

void setUp(void)
{
    memset(&sky, 0, sizeof sky);
    sky.n = 5;
    for (int i = 0; i < MAX; i++) { sky.lock_ms[i] = 10000; }
    pel_tdcp_init(&history);
    pel_slip_init(&detectors);
}

void tearDown(void) {}

static double range_at(int i, double t)
{
    return 2.1e7 + 3e5 * i + (150.0 - 90.0 * i) * t;
}

/* What the receiver says at t, and its rows: observed minus predicted, prediction being right but for the receiver's clock. */
static void observe(double t)
{
    memset(&epoch, 0, sizeof epoch);
    memset(&set, 0, sizeof set);
    epoch.t_ns = (pel_time_t)llround(1e9 * t) + PEL_NS_PER_WEEK;
    epoch.n = (uint16_t)sky.n;
    set.n = sky.n;
    set.n_groups = 1;
    for (int i = 0; i < sky.n; i++) {
        pel_obs_t *o = &epoch.obs[i];
        const double residual = LAMBDA * (1000.0 * i + sky.slip_cyc[i]) + sky.clock_m;
        o->sys = PEL_SYS_GPS;
        o->prn = (uint8_t)(i + 1);
        o->carrier = PEL_CARRIER_L1;
        o->code = 'C';
        o->P_m = range_at(i, t) + sky.clock_m;
        o->L_cyc = (range_at(i, t) + residual) / LAMBDA;
        o->D_hz = (float)(-(150.0 - 90.0 * i) / LAMBDA);
        o->cn0_dbhz = 45.0F;
        o->lock_ms = sky.lock_ms[i];
        o->flags = PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER;
        if (sky.half[i]) { o->flags |= PEL_OBS_HALF_CYCLE; }
        if (sky.warned[i]) { o->flags |= PEL_OBS_SLIP; }
        set.sd[i] = (pel_sd_t){.sys = o->sys,
                               .prn = o->prn,
                               .carrier = o->carrier,
                               .pivot = i == 0,
                               .has_phase = true,
                               .slip = sky.warned[i],
                               .lambda_m = LAMBDA,
                               .phase_m = residual + ((i == 0) ? sky.predicted_error_m : 0.0),
                               .var_phase = 9e-6,
                               .u_e = {0.0, 0.0, (i == 0) ? 1.0 : 0.0}};
        sky.lock_ms[i] += (uint32_t)(1000.0 * STEP_S);
    }
}

static pel_status_t step(double t)
{
    observe(t);
    return pel_tdcp_step(&history, &epoch, &set, 1e-3, change);
}

static bool detector_saw(int i)
{
    return (epoch.obs[i].flags & PEL_OBS_SLIP) != 0;
}

static void the_first_epoch_is_new_and_the_second_a_difference(void)
{
    TEST_ASSERT_EQUAL(PEL_OK, step(0.0));
    for (int i = 0; i < sky.n; i++) { TEST_ASSERT_EQUAL_INT(PEL_TDCP_NEW, change[i].kind); }
    sky.clock_m = 12.5;
    TEST_ASSERT_EQUAL(PEL_OK, step(0.1));
    for (int i = 0; i < sky.n; i++) {
        TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[i].kind);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 12.5, change[i].change_m); /* the receiver's clock, common to all */
    }
}

static void one_cycle_is_found_on_whichever_satellite_also_the_reference(void)
{
    double t = 0.0;
    TEST_ASSERT_EQUAL(PEL_OK, step(t));
    for (int i = 0; i < sky.n; i++) {
        sky.slip_cyc[i] += (i % 2 == 0) ? 1.0 : -1.0;
        sky.clock_m += 300000.0 * (i % 2); /* also while the clock jumps by a millisecond */
        TEST_ASSERT_EQUAL(PEL_OK, step(t += STEP_S));
        for (int k = 0; k < sky.n; k++) {
            TEST_ASSERT_EQUAL_INT((k == i) ? PEL_TDCP_SLIPPED : PEL_TDCP_CONTINUOUS, change[k].kind);
        }
    }
    TEST_ASSERT_EQUAL_UINT32(5, history.slips);
}

static void of_three_the_odd_one_is_found_of_two_neither_is_trusted_and_one_alone_is_new(void)
{
    sky.n = 3;
    (void)step(0.0);
    sky.slip_cyc[0] = 1.0;
    (void)step(0.1);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_SLIPPED, change[0].kind);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[1].kind);
    sky.n = 2;
    sky.slip_cyc[0] = 2.0;
    (void)step(0.2);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_SLIPPED, change[0].kind);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_SLIPPED, change[1].kind);
    sky.n = 1;
    (void)step(0.3);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_NEW, change[0].kind);
    TEST_ASSERT_TRUE(change[0].change_m == 0.0);
}

/* The detectors without a model of motion see nothing of a silent slip, and then remember the slipped phase as good. */
static void a_slip_the_detectors_have_digested_is_still_news_here(void)
{
    for (int order = 0; order < 2; order++) {
        setUp();
        for (int k = 0; k < 3; k++) {
            if (k == 2) { sky.slip_cyc[3] = 1.0; }
            observe(STEP_S * k);
            for (int i = 0; i < sky.n; i++) { epoch.obs[i].flags &= (uint8_t)~PEL_OBS_DOPPLER; }
            if (order == 0) {
                pel_slip_check(&detectors, &epoch, NULL, NULL, NULL);
                if (k > 0) { TEST_ASSERT_FALSE(detector_saw(3)); } /* hidden from them */
                for (int i = 0; i < sky.n; i++) { set.sd[i].slip = detector_saw(i); }
            }
            TEST_ASSERT_EQUAL(PEL_OK, pel_tdcp_step(&history, &epoch, &set, 1e-3, change));
            if (order == 1) { pel_slip_check(&detectors, &epoch, NULL, NULL, NULL); }
        }
        TEST_ASSERT_EQUAL_INT(PEL_TDCP_SLIPPED, change[3].kind);
        TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[2].kind);
    }
}

/* A computed motion nobody trusts hides the slip from the history, which then remembers the slipped phase as good. */
static void a_slip_this_history_has_digested_is_still_news_to_the_detectors(void)
{
    for (int order = 0; order < 2; order++) {
        setUp();
        for (int k = 0; k < 3; k++) {
            if (k == 2) { sky.slip_cyc[3] = 5.0; }
            observe(STEP_S * k);
            if (order == 0) { TEST_ASSERT_EQUAL(PEL_OK, pel_tdcp_step(&history, &epoch, &set, 100.0, change)); }
            pel_slip_check(&detectors, &epoch, NULL, NULL, NULL);
            if (order == 1) { TEST_ASSERT_EQUAL(PEL_OK, pel_tdcp_step(&history, &epoch, &set, 100.0, change)); }
        }
        TEST_ASSERT_TRUE(detector_saw(3));
        TEST_ASSERT_FALSE(detector_saw(2));
    }
}

/* What the receiver's lock time tells is read by each from the epoch, not from the other's memory. */
static void a_lost_lock_is_seen_by_both_in_either_order(void)
{
    for (int order = 0; order < 2; order++) {
        setUp();
        for (int k = 0; k < 3; k++) {
            if (k == 2) { sky.lock_ms[1] = 20; }
            observe(STEP_S * k);
            if (order == 0) { (void)pel_tdcp_step(&history, &epoch, &set, 1e-3, change); }
            pel_slip_check(&detectors, &epoch, NULL, NULL, NULL);
            if (order == 1) { (void)pel_tdcp_step(&history, &epoch, &set, 1e-3, change); }
        }
        TEST_ASSERT_EQUAL_INT(PEL_TDCP_NEW, change[1].kind);
        TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[2].kind);
        TEST_ASSERT_TRUE(detector_saw(1));
        TEST_ASSERT_FALSE(detector_saw(2));
    }
}

static void gaps_warnings_and_half_cycles_start_anew(void)
{
    (void)step(0.0);
    sky.warned[0] = true;
    sky.half[1] = true;
    (void)step(0.1);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_NEW, change[0].kind);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_NEW, change[1].kind);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[2].kind);
    sky.warned[0] = false;
    for (int i = 0; i < 2; i++) { sky.lock_ms[i] += 3000; } /* these were tracked through the gap */
    (void)step(3.1);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[0].kind);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[1].kind);
    for (int i = 2; i < 5; i++) { TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[i].kind); }
    for (int i = 0; i < 5; i++) { sky.lock_ms[i] = 200 + 1000 * (uint32_t)i; }
    (void)step(6.1);
    for (int i = 0; i < 5; i++) { TEST_ASSERT_EQUAL_INT(PEL_TDCP_NEW, change[i].kind); } /* lock began within the gap */
}

/* Lock times of messages that saturate or are rounded down to powers of two do not grow with every epoch: then the gap itself decides. */
static void a_lock_time_that_stands_still_is_believed_for_a_second(void)
{
    static const struct {
        double gap_s;
        uint32_t more_ms;
        int kind;
    } CASE[] = {
        {1.0, 0, PEL_TDCP_CONTINUOUS},
        {1.001, 0, PEL_TDCP_NEW},
        {2.0, 1999, PEL_TDCP_NEW}, /* grew, but not so long as the gap */
        {2.0, 2000, PEL_TDCP_CONTINUOUS},
    };
    for (size_t c = 0; c < sizeof CASE / sizeof CASE[0]; c++) {
        setUp();
        for (int i = 0; i < sky.n; i++) { sky.lock_ms[i] = 0; }
        (void)step(0.0);
        for (int i = 0; i < sky.n; i++) { sky.lock_ms[i] = CASE[c].more_ms; }
        (void)step(CASE[c].gap_s);
        for (int i = 0; i < sky.n; i++) { TEST_ASSERT_EQUAL_INT(CASE[c].kind, change[i].kind); }
    }
    setUp(); /* a long lock that does not grow spans nothing, however long */
    (void)step(0.0);
    for (int i = 0; i < sky.n; i++) { sky.lock_ms[i] = 10000; }
    (void)step(2.0);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_NEW, change[0].kind);
}

/* What is differenced must be the same satellite, carrier and code. */
static void another_signal_is_never_differenced(void)
{
    for (int what = 0; what < 4; what++) {
        setUp();
        (void)step(0.0);
        observe(0.1);
        switch (what) {
        case 0: epoch.obs[2].sys = set.sd[2].sys = PEL_SYS_GAL; break;
        case 1: epoch.obs[2].prn = set.sd[2].prn = 17; break;
        case 2: epoch.obs[2].carrier = set.sd[2].carrier = PEL_CARRIER_L5; break;
        default: epoch.obs[2].code = 'W'; break;
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_tdcp_step(&history, &epoch, &set, 1e-3, change));
        for (int i = 0; i < sky.n; i++) {
            TEST_ASSERT_EQUAL_INT((i == 2) ? PEL_TDCP_NEW : PEL_TDCP_CONTINUOUS, change[i].kind);
        }
    }
}

/* A row without a phase, or whose phase the epoch does not hold (any more), is none and is forgotten. */
static void a_row_without_its_phase_is_none_and_begins_anew(void)
{
    for (int what = 0; what < 5; what++) {
        setUp();
        (void)step(0.0);
        observe(0.1);
        switch (what) {
        case 0: set.sd[4].has_phase = false; break;
        case 1: epoch.obs[4].flags = PEL_OBS_CODE; break;
        case 2: epoch.obs[4].sys = PEL_SYS_QZS; break;
        case 3: epoch.obs[4].carrier = PEL_CARRIER_L2; break;
        default: epoch.n--; break;
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_tdcp_step(&history, &epoch, &set, 1e-3, change));
        TEST_ASSERT_EQUAL_INT(PEL_TDCP_NONE, change[4].kind);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, change[4].change_m);
        TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[3].kind);
        (void)step(0.2);
        TEST_ASSERT_EQUAL_INT(PEL_TDCP_NEW, change[4].kind);
        TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[3].kind);
    }
}

static void an_epoch_out_of_order_changes_nothing(void)
{
    (void)step(0.0);
    (void)step(0.1);
    const pel_tdcp_t before = history;
    TEST_ASSERT_EQUAL(PEL_E_STALE, step(0.1));
    TEST_ASSERT_EQUAL(PEL_E_STALE, step(0.05));
    TEST_ASSERT_EQUAL_MEMORY(&before, &history, sizeof history);
}

static void a_corrected_antenna_corrects_what_is_remembered(void)
{
    const double da[3] = {0.0, 0.0, 0.3};
    (void)step(0.0);
    pel_tdcp_move(&history, da); /* along the line of sight of satellite 0: its predicted range was 0.3 m too long */
    sky.predicted_error_m = 0.3;
    (void)step(0.1);
    TEST_ASSERT_EQUAL_INT(PEL_TDCP_CONTINUOUS, change[0].kind);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, change[1].change_m, change[0].change_m);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_first_epoch_is_new_and_the_second_a_difference);
    RUN_TEST(one_cycle_is_found_on_whichever_satellite_also_the_reference);
    RUN_TEST(of_three_the_odd_one_is_found_of_two_neither_is_trusted_and_one_alone_is_new);
    RUN_TEST(a_slip_the_detectors_have_digested_is_still_news_here);
    RUN_TEST(a_slip_this_history_has_digested_is_still_news_to_the_detectors);
    RUN_TEST(a_lost_lock_is_seen_by_both_in_either_order);
    RUN_TEST(gaps_warnings_and_half_cycles_start_anew);
    RUN_TEST(a_lock_time_that_stands_still_is_believed_for_a_second);
    RUN_TEST(another_signal_is_never_differenced);
    RUN_TEST(a_row_without_its_phase_is_none_and_begins_anew);
    RUN_TEST(an_epoch_out_of_order_changes_nothing);
    RUN_TEST(a_corrected_antenna_corrects_what_is_remembered);
    return UNITY_END();
}

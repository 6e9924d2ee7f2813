/* build: f32 f64 */
/* What the slip detectors remember, and what they make of epochs that are short of something: lock times at their end, no prediction yet, three
 * carriers, time that goes back, a full memory. No noise. */
#include <math.h>
#include <string.h>

#include "support_gnss.h"
#include "unity.h"

#define GPS (1u << PEL_SYS_GPS)

static pel_orbits_t o;
static pel_slip_t slip;
static pel_epoch_t e;
static pel_view_t view;
static pel_nav_counters_t count;
static scene_t s;
static int step;

static const pel_slip_aid_t AID = {{0.0, 0.0, 0.0}, 0.01};

static void at(double t_s)
{
    for (int k = 0; k < 3; k++) { s.r_e[k] = scene_default().r_e[k] + s.v_e[k] * t_s; }
    scene_observe(&s, &o, SKY_T0 + (int64_t)(t_s * 1e9), GPS, &e);
    (void)pel_view_compute(&e, &o, SKY_T0, s.r_e, s.v_e, 0.1, NULL, &view);
}

static void advance(void)
{
    at((double)step++);
}

static void check(const pel_slip_aid_t *aid)
{
    memset(&count, 0, sizeof count);
    pel_slip_check(&slip, &e, &view, aid, &count);
}

static int marked(void)
{
    int n = 0;
    for (int i = 0; i < e.n; i++) { n += (e.obs[i].flags & PEL_OBS_SLIP) != 0; }
    return n;
}

void setUp(void)
{
    sky_init(&o);
    pel_slip_init(&slip);
    s = scene_default();
    s.v_e[0] = 60.0;
    s.v_e[1] = 40.0;
    step = 0;
    advance();
    check(&AID);
    advance();
    check(&AID);
    TEST_ASSERT_EQUAL(0, marked());
    advance();
}

void tearDown(void) {}

/* A counter that has reached its end may begin anywhere: an hour is as good as any longer time. */
static void lock_times_of_hours_may_fall(void)
{
    for (int i = 0; i < slip.n; i++) { slip.entry[i].lock_ms = 4200000; }
    for (int i = 0; i < e.n; i++) { e.obs[i].lock_ms = 3600000; }
    check(&AID);
    TEST_ASSERT_EQUAL(0, marked());
    advance();
    for (int i = 0; i < e.n; i++) { e.obs[i].lock_ms = 3599999; } /* that is below it */
    check(&AID);
    TEST_ASSERT_EQUAL(e.n, marked());
    TEST_ASSERT_EQUAL_UINT32(e.n, count.slip_lock);
}

static void a_signal_of_unknown_strength_is_taken_as_a_strong_one(void)
{
    for (int i = 0; i < e.n; i++) { e.obs[i].cn0_dbhz = 0.0f; }
    e.obs[2].L_cyc += 1.0;
    check(&AID);
    TEST_ASSERT_EQUAL(2, marked()); /* both carriers: either may be the one */
}

/* A change common to all that is no whole millisecond is no jump of the clock, and no slip either. */
static void a_change_common_to_all_codes_is_a_jump_only_in_milliseconds(void)
{
    for (int i = 0; i < e.n; i++) { e.obs[i].P_m += 0.4e-3 * PEL_SPEED_OF_LIGHT; }
    check(&AID);
    TEST_ASSERT_EQUAL_UINT32(0, count.clock_jumps);
    TEST_ASSERT_EQUAL(0, marked());
    advance();
    for (int i = 0; i < e.n; i++) { e.obs[i].P_m += 1.4e-3 * PEL_SPEED_OF_LIGHT; } /* by one more */
    check(&AID);
    TEST_ASSERT_EQUAL_UINT32(1, count.clock_jumps);
}

static void a_jump_that_the_receiver_tells_is_counted(void)
{
    e.clock_reset = true;
    check(&AID);
    TEST_ASSERT_EQUAL_UINT32(1, count.clock_jumps);
    TEST_ASSERT_EQUAL(0, marked());
}

/* A third carrier beside L1 and L2, as a copy of L2. */
static void add_third(void)
{
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < e.n; k++) {
            if (e.obs[k].carrier != PEL_CARRIER_L2) { continue; }
            e.obs[e.n] = e.obs[k];
            e.obs[e.n].code = 'L';
            e.obs[e.n++].carrier = PEL_CARRIER_L5;
            break;
        }
    }
    e.n--; /* one of them */
    e.obs[e.n - 1].L_cyc *= pel_obs_lambda_m(&e.obs[1]) / pel_obs_lambda_m(&e.obs[e.n - 1]);
}

/* Of three carriers each is held against the first: a slip of the first accuses all, one of another only itself and the first. */
static void of_three_carriers_the_first_is_the_measure(void)
{
    for (int which = 0; which < 3; which++) {
        setUp();
        add_third();
        check(NULL);
        advance();
        add_third();
        TEST_ASSERT_EQUAL(e.obs[0].prn, e.obs[e.n - 1].prn);
        pel_obs_t *of[3] = {&e.obs[0], &e.obs[1], &e.obs[e.n - 1]};
        of[which]->L_cyc += 1.0;
        for (int i = 0; i < e.n; i++) { e.obs[i].flags &= (uint8_t)~PEL_OBS_DOPPLER; } /* they alone */
        check(NULL);
        const int expected[3] = {3, 2, 2};
        TEST_ASSERT_EQUAL(expected[which], marked());
        TEST_ASSERT_TRUE((of[0]->flags & PEL_OBS_SLIP) != 0);
        TEST_ASSERT_TRUE((of[which]->flags & PEL_OBS_SLIP) != 0);
    }
}

/* ---- prediction -------------------------------------------------------------------------------------------------------------------- */

/* One cycle on L1 of a receiver with one carrier and no Doppler: the prediction alone finds it, where there is one. */
static int found_by_prediction(const pel_view_t *v, const pel_slip_aid_t *aid)
{
    int kept = 0;
    for (int i = 0; i < e.n; i++) {
        if (e.obs[i].carrier == PEL_CARRIER_L1) { e.obs[kept++] = e.obs[i]; }
    }
    e.n = (uint16_t)kept;
    for (int i = 0; i < e.n; i++) { e.obs[i].flags &= (uint8_t)~PEL_OBS_DOPPLER; }
    e.obs[1].L_cyc += 1.0;
    memset(&count, 0, sizeof count);
    pel_slip_check(&slip, &e, v, aid, &count);
    return (int)count.slip_ins;
}

static void a_prediction_needs_views_now_and_before_and_a_sigma(void)
{
    TEST_ASSERT_EQUAL(1, found_by_prediction(&view, &AID));
    setUp();
    TEST_ASSERT_EQUAL(0, found_by_prediction(NULL, &AID)); /* no view now */
    setUp();
    TEST_ASSERT_EQUAL(0, found_by_prediction(&view, NULL));
    setUp();
    const pel_slip_aid_t unknown = {{0.0, 0.0, 0.0}, 0.0}, broken = {{0.0, 0.0, 0.0}, NAN};
    TEST_ASSERT_EQUAL(0, found_by_prediction(&view, &unknown));
    setUp();
    TEST_ASSERT_EQUAL(0, found_by_prediction(&view, &broken));
    setUp();
    view.n = 0; /* the epoch before had no view, as one of a receiver without orbits */
    check(&AID);
    advance();
    TEST_ASSERT_EQUAL(0, found_by_prediction(&view, &AID));
}

/* ---- Doppler of the wrong sign ------------------------------------------------------------------------------------------------------- */

static int turned(int reversed_of_fast)
{
    int fast = 0;
    const bool all = reversed_of_fast > e.n;
    for (int i = 0; i < e.n; i++) {
        if (!all && fabs((double)e.obs[i].D_hz) * pel_obs_lambda_m(&e.obs[i]) < 150.0) { continue; }
        if (fast++ < reversed_of_fast) { e.obs[i].D_hz = -e.obs[i].D_hz; }
    }
    const float before = e.obs[0].D_hz;
    check(&AID);
    return e.obs[0].D_hz == -before;
}

static void doppler_is_turned_round_if_most_of_it_is_reversed(void)
{
    TEST_ASSERT_EQUAL(0, turned(0));
    setUp();
    TEST_ASSERT_EQUAL(0, turned(2)); /* two are no majority of anything */
    setUp();
    TEST_ASSERT_EQUAL(0, turned(3)); /* three against many that are right */
    setUp();
    TEST_ASSERT_EQUAL(1, turned(PEL_MAX_OBS));
    TEST_ASSERT_EQUAL(0, marked());
}

/* ---- memory --------------------------------------------------------------------------------------------------------------------------- */

static void time_that_goes_back_leaves_nothing_to_compare_with(void)
{
    at(0.5);
    check(&AID);
    TEST_ASSERT_EQUAL(e.n, marked());
    TEST_ASSERT_EQUAL_INT(e.n, slip.n);
    for (int i = 0; i < slip.n; i++) { TEST_ASSERT_EQUAL_INT64(e.t_ns, slip.entry[i].t_ns); }
    at(1.5);
    check(&AID);
    TEST_ASSERT_EQUAL(0, marked());
}

/* Signals that are away keep their place for a minute, as long as nobody needs it. */
static void a_full_memory_keeps_what_is_there_now(void)
{
    for (int i = slip.n; i < PEL_MAX_OBS; i++) { /* seen half a minute ago */
        slip.entry[i] = slip.entry[0];
        slip.entry[i].sys = PEL_SYS_GAL;
        slip.entry[i].prn = (uint8_t)i;
        slip.entry[i].t_ns = e.t_ns - 30 * PEL_NS_PER_S;
    }
    slip.n = PEL_MAX_OBS;
    const pel_slip_t full = slip;
    const pel_epoch_t now = e;
    check(&AID); /* nothing new: all stay */
    TEST_ASSERT_EQUAL_INT(PEL_MAX_OBS, slip.n);
    slip = full;
    e = now;
    e.obs[e.n] = e.obs[0];
    e.obs[e.n].sys = PEL_SYS_BDS;
    e.obs[e.n].carrier = PEL_CARRIER_B1I;
    e.n++;
    check(&AID); /* one that is new: those that are away go */
    TEST_ASSERT_EQUAL_INT(e.n, slip.n);
    slip = full;
    e = now;
    e.n = PEL_MAX_OBS + 1; /* an epoch that cannot be changes nothing */
    check(&AID);
    TEST_ASSERT_EQUAL_MEMORY(&full, &slip, sizeof full);
}

static void a_signal_away_for_more_than_a_minute_is_forgotten(void)
{
    slip.entry[3].t_ns = e.t_ns - 61 * PEL_NS_PER_S;
    const uint8_t prn = slip.entry[3].prn, carrier = slip.entry[3].carrier;
    check(&AID);
    for (int i = 0; i < e.n; i++) {
        const bool old = e.obs[i].prn == prn && e.obs[i].carrier == carrier;
        TEST_ASSERT_EQUAL_INT(old, (e.obs[i].flags & PEL_OBS_SLIP) != 0);
    }
    TEST_ASSERT_EQUAL_INT(e.n, slip.n);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(lock_times_of_hours_may_fall);
    RUN_TEST(a_signal_of_unknown_strength_is_taken_as_a_strong_one);
    RUN_TEST(a_change_common_to_all_codes_is_a_jump_only_in_milliseconds);
    RUN_TEST(a_jump_that_the_receiver_tells_is_counted);
    RUN_TEST(of_three_carriers_the_first_is_the_measure);
    RUN_TEST(a_prediction_needs_views_now_and_before_and_a_sigma);
    RUN_TEST(doppler_is_turned_round_if_most_of_it_is_reversed);
    RUN_TEST(time_that_goes_back_leaves_nothing_to_compare_with);
    RUN_TEST(a_full_memory_keeps_what_is_there_now);
    RUN_TEST(a_signal_away_for_more_than_a_minute_is_forgotten);
    return UNITY_END();
}

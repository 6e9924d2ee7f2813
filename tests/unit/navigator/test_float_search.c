/* Integers from the filter's own float states: who may be searched, what ends a search, when epochs agree, what begins anew. */
/* with: carried pair gnss */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_pair.h"
#include "unity.h"

#define GPS (1u << PEL_SYS_GPS)

static pair_t pair;
static pel_navigator_t good, nav;

/* Epochs whose own integers are never enough, until the float states are about to be searched. */
static void floats(int epochs)
{
    pair_init(&pair, &good, GPS, 1u << PEL_CARRIER_L1);
    pel_nav_config_t cfg = good.cfg;
    cfg.integers = false;
    pair_introduce(&pair, &good, &cfg);
    for (int i = 0; i < epochs; i++) { (void)pair_step(&pair, &good); }
    nav = good;
}

void setUp(void)
{
    floats(30);
}

void tearDown(void) {}

/* All of one epoch's search; false: there was nothing to search. */
static bool search(bool beside_held)
{
    memset(&nav.update.later, 0, sizeof nav.update.later);
    if (!pel_nav_track_search_begin(&nav, beside_held)) { return false; }
    while (!pel_nav_track_search_step(&nav, 1000)) {}
    return true;
}

static pel_tracked_t *a_float(void)
{
    int i = 0;
    while (nav.track.entry[i].state < 0) { i++; }
    return &nav.track.entry[i];
}

static int held(void)
{
    int n = 0;
    for (int i = 0; i < nav.track.n; i++) { n += nav.track.entry[i].held; }
    return n;
}

/* The float states as if they were known to this, uncorrelated: n of them off their integers, the others on them. */
static void make_floats(double sd_cyc, int n, double off_cyc)
{
    int k = 0;
    for (int i = 0; i < nav.track.n; i++) {
        pel_tracked_t *t = &nav.track.entry[i];
        if (t->state < 0) { continue; }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_set_variance(&nav.ud, t->state, (pel_real)(sd_cyc * sd_cyc)));
        t->N = pel_round(t->N) + ((k++ < n) ? off_cyc : 0.0);
    }
}

static void who_is_young_or_half_or_without_a_datum_is_not_searched(void)
{
    TEST_ASSERT_TRUE(pel_nav_track_search_begin(&nav, false));
    const int n = nav.update.chosen.n;
    TEST_ASSERT_GREATER_OR_EQUAL_INT(5, n);
    a_float()->half = true;
    (void)pel_nav_track_search_begin(&nav, true);
    TEST_ASSERT_EQUAL_INT(n - 1, nav.update.chosen.n);
    a_float()->half = false;
    a_float()->epochs = 1;
    (void)pel_nav_track_search_begin(&nav, true);
    TEST_ASSERT_EQUAL_INT(n - 1, nav.update.chosen.n);
    a_float()->epochs = 2;
    a_float()->since_ns = nav.at_horizon.t_ns - 800 * PEL_NS_PER_MS;
    (void)pel_nav_track_search_begin(&nav, true);
    TEST_ASSERT_EQUAL_INT(n - 1, nav.update.chosen.n);
    nav = good;
    pel_nav_track_datum(&nav, PEL_SYS_GPS, PEL_CARRIER_L1)->half = true;
    TEST_ASSERT_FALSE(pel_nav_track_search_begin(&nav, true));
    TEST_ASSERT_EQUAL_INT(0, nav.update.chosen.n);
}

/* Alone, fewer than five are no check on each other; beside held phases one is enough. */
static void few_are_searched_beside_held_phases_only(void)
{
    int kept = 0;
    for (int i = 0; i < nav.track.n; i++) {
        if (nav.track.entry[i].state >= 0 && ++kept > 4) { nav.track.entry[i].half = true; }
    }
    TEST_ASSERT_FALSE(pel_nav_track_search_begin(&nav, false));
    TEST_ASSERT_TRUE(pel_nav_track_search_begin(&nav, true));
    TEST_ASSERT_EQUAL_INT(4, nav.update.chosen.n);
}

/* More than the engine has room for: the first of them; a covariance that is none is not searched. */
static void the_engines_room_and_its_refusals_bound_it(void)
{
    const pel_tracked_t model = *a_float();
    for (int i = nav.track.n; i < PEL_MAX_TRACKED; i++) {
        nav.track.entry[i] = model; /* the same state again and again: singular */
        nav.track.entry[i].prn = (uint8_t)(100 + i);
    }
    nav.track.n = PEL_MAX_TRACKED;
    TEST_ASSERT_FALSE(pel_nav_track_search_begin(&nav, false));
    TEST_ASSERT_EQUAL_INT(PEL_MAX_AMB, nav.update.chosen.n);
}

static void epochs_that_agree_make_integers_and_one_does_not(void)
{
    make_floats(0.03, 1, 0.02);
    const int n = nav.track.n;
    TEST_ASSERT_TRUE(search(false));
    TEST_ASSERT_EQUAL_INT(PEL_INT_OK, nav.update.later.reason);
    TEST_ASSERT_EQUAL_INT(0, held());
    TEST_ASSERT_TRUE(search(false));
    TEST_ASSERT_EQUAL_INT(0, held());
    TEST_ASSERT_TRUE(search(false)); /* the third */
    TEST_ASSERT_EQUAL_INT(n, held());
    TEST_ASSERT_EQUAL_INT(n - 1, nav.update.later.n_fixed);
    TEST_ASSERT_EQUAL_INT(6, nav.ud.n);
    for (int i = 0; i < n; i++) { TEST_ASSERT_EQUAL_INT(-1, nav.track.entry[i].state); }
}

static void two_epochs_far_apart_are_enough(void)
{
    make_floats(0.03, 0, 0.0);
    TEST_ASSERT_TRUE(search(false));
    nav.at_horizon.t_ns += 10 * PEL_NS_PER_S;
    TEST_ASSERT_TRUE(search(false));
    TEST_ASSERT_EQUAL_INT(nav.track.n, held());
}

static void another_candidate_begins_to_count_anew(void)
{
    make_floats(0.03, 0, 0.0);
    TEST_ASSERT_TRUE(search(false));
    TEST_ASSERT_TRUE(search(false));
    TEST_ASSERT_EQUAL_INT(2, a_float()->agreed);
    a_float()->N += 1.0;
    TEST_ASSERT_TRUE(search(false));
    TEST_ASSERT_EQUAL_INT(0, held());
    TEST_ASSERT_EQUAL_INT(1, a_float()->agreed);
}

static void agreement_does_not_run_over(void)
{
    make_floats(0.03, 0, 0.0);
    TEST_ASSERT_TRUE(search(false));
    for (int i = 0; i < nav.track.n; i++) { nav.track.entry[i].agreed = UINT8_MAX; }
    TEST_ASSERT_TRUE(search(false));
    for (int i = 0; i < nav.track.n; i++) { TEST_ASSERT_EQUAL_INT(UINT8_MAX, nav.track.entry[i].agreed); }
    TEST_ASSERT_EQUAL_INT(nav.track.n, held());
}

static void what_is_weak_or_does_not_fit_is_told_by_its_reason(void)
{
    make_floats(0.5, 9, 0.35);
    nav.cfg.failure_max = 1e-9f;
    TEST_ASSERT_TRUE(search(false));
    TEST_ASSERT_EQUAL_INT(PEL_INT_SUCCESS, nav.update.later.reason);
    nav = good;
    make_floats(0.02, 4, 0.3); /* fifteen sigma from any integer, and one may be left out */
    TEST_ASSERT_TRUE(search(false));
    TEST_ASSERT_EQUAL_INT(PEL_INT_CHI2, nav.update.later.reason);
    TEST_ASSERT_EQUAL_INT(0, held());
    nav = good;
    make_floats(0.15, 0, 0.0); /* sure of itself by its success rate, but 0.45 lies near another integer */
    a_float()->N += 0.4;
    for (int i = 0; i < nav.track.n; i++) {
        if (nav.track.entry[i].state >= 0 && &nav.track.entry[i] != a_float()) { nav.track.entry[i].half = true; }
    }
    nav.cfg.failure_max = 0.5f;
    TEST_ASSERT_TRUE(search(true));
    TEST_ASSERT_EQUAL_INT(PEL_INT_RATIO, nav.update.later.reason);
}

/* Beside held phases the one that does not fit is left out, and the rest is tried again. */
static void the_one_that_does_not_fit_is_left_out_beside_held_phases(void)
{
    make_floats(0.02, 1, 0.3);
    const int floats_before = nav.ud.n - 6;
    TEST_ASSERT_TRUE(search(true));
    TEST_ASSERT_TRUE(search(true));
    TEST_ASSERT_EQUAL_INT(PEL_INT_OK, nav.update.later.reason);
    TEST_ASSERT_EQUAL_INT(floats_before - 1, nav.update.later.n_fixed);
    TEST_ASSERT_EQUAL_INT(7, nav.ud.n); /* it stays a float */
}

static void floats_that_fit_no_integers_five_times_begin_anew(void)
{
    for (int i = 1; i <= 5; i++) {
        make_floats(0.02, 4, 0.3);
        const int n = nav.track.n;
        TEST_ASSERT_TRUE(search(false));
        TEST_ASSERT_EQUAL_INT(PEL_INT_CHI2, nav.update.later.reason);
        TEST_ASSERT_EQUAL_INT((i < 5) ? n : 1, nav.track.n); /* the datum stays */
        TEST_ASSERT_EQUAL_INT(i % 5, nav.track.misfit_floats);
    }
    TEST_ASSERT_EQUAL_INT(6, nav.ud.n);
}

/* Out of nodes: with a candidate that is not proved, or with none. */
static void a_budget_that_is_spent_proves_nothing(void)
{
    int without = 0, unproved = 0;
    for (int budget = 1; budget < 60; budget++) {
        nav = good;
        make_floats(0.4, 1, 0.45);
        nav.cfg.node_budget = budget;
        memset(&nav.update.later, 0, sizeof nav.update.later);
        TEST_ASSERT_TRUE(pel_nav_track_search_begin(&nav, false));
        while (!pel_nav_track_search_step(&nav, 1000)) {}
        TEST_ASSERT_EQUAL_INT(0, held());
        without += nav.update.later.n == 0;
        unproved += nav.update.later.reason == PEL_INT_BUDGET;
    }
    TEST_ASSERT_GREATER_THAN_INT(0, without);
    TEST_ASSERT_GREATER_THAN_INT(0, unproved);
}

static void a_search_goes_on_in_steps_and_one_of_nothing_ends(void)
{
    make_floats(0.4, 1, 0.45);
    TEST_ASSERT_TRUE(pel_nav_track_search_begin(&nav, false));
    int steps = 1;
    while (!pel_nav_track_search_step(&nav, 1)) { steps++; }
    TEST_ASSERT_GREATER_THAN_INT(10, steps);
    nav = good;
    nav.ils.stage = PEL_ILS_EMPTY;
    TEST_ASSERT_TRUE(pel_nav_track_search_step(&nav, 1));
    TEST_ASSERT_EQUAL_INT(0, held());
}

/* A datum that was lost while the search waited: its floats are fixed all the same, against nothing that could be marked as held. */
static void a_datum_that_is_gone_is_not_marked(void)
{
    make_floats(0.03, 0, 0.0);
    TEST_ASSERT_TRUE(search(false));
    TEST_ASSERT_TRUE(search(false));
    TEST_ASSERT_TRUE(pel_nav_track_search_begin(&nav, false));
    pel_tracked_t *datum = pel_nav_track_datum(&nav, PEL_SYS_GPS, PEL_CARRIER_L1);
    datum->carrier = PEL_CARRIER_L2;
    while (!pel_nav_track_search_step(&nav, 1000)) {}
    TEST_ASSERT_FALSE(datum->held);
    TEST_ASSERT_EQUAL_INT(nav.track.n - 1, held());
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&nav.ud));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(who_is_young_or_half_or_without_a_datum_is_not_searched);
    RUN_TEST(few_are_searched_beside_held_phases_only);
    RUN_TEST(the_engines_room_and_its_refusals_bound_it);
    RUN_TEST(epochs_that_agree_make_integers_and_one_does_not);
    RUN_TEST(two_epochs_far_apart_are_enough);
    RUN_TEST(another_candidate_begins_to_count_anew);
    RUN_TEST(agreement_does_not_run_over);
    RUN_TEST(what_is_weak_or_does_not_fit_is_told_by_its_reason);
    RUN_TEST(the_one_that_does_not_fit_is_left_out_beside_held_phases);
    RUN_TEST(floats_that_fit_no_integers_five_times_begin_anew);
    RUN_TEST(a_budget_that_is_spent_proves_nothing);
    RUN_TEST(a_search_goes_on_in_steps_and_one_of_nothing_ends);
    RUN_TEST(a_datum_that_is_gone_is_not_marked);
    return UNITY_END();
}

/* Ambiguities from epoch to epoch: more than there is room for, slips of the datum, whose number is known from whom. */
/* with: carried pair gnss */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

#define GPS (1u << PEL_SYS_GPS)
#define L1  (1u << PEL_CARRIER_L1)
#define ALL (GPS | (1u << PEL_SYS_GAL) | (1u << PEL_SYS_BDS) | (1u << PEL_SYS_GLO))

static pair_t pair;
static pel_navigator_t nav;
static pel_epoch_t base, rover;

/* Epochs of GNSS alone; without integers every phase stays a state. */
static void observed(unsigned systems, uint8_t carriers, bool integers, int epochs)
{
    pair_init(&pair, &nav, systems, carriers);
    pel_nav_config_t cfg = nav.cfg;
    cfg.integers = integers;
    pair_introduce(&pair, &nav, &cfg);
    for (int i = 0; i < epochs; i++) { (void)pair_step(&pair, &nav); }
}

static void push(void)
{
    pel_navigator_push_base(&nav, &base);
    pel_navigator_push_rover(&nav, &rover);
    while (pel_navigator_flush(&nav)) {}
}

static pel_tracked_t *entry_of(const pel_sd_t *sd)
{
    for (int i = 0; i < nav.track.n; i++) {
        pel_tracked_t *t = &nav.track.entry[i];
        if (t->sys == sd->sys && t->prn == sd->prn && t->carrier == sd->carrier) { return t; }
    }
    return NULL;
}

static int states_in_use(void)
{
    int n = 0;
    for (int i = 0; i < nav.track.n; i++) { n += nav.track.entry[i].state >= 0; }
    for (int i = 0; i < PEL_GLO_CARRIERS; i++) { n += nav.track.channels[i].state >= 0; }
    return n;
}

void setUp(void)
{
    observed(GPS, L1, false, 4);
}

void tearDown(void) {}

/* ---- room ------------------------------------------------------------------------------------------------------------------------ */

static void more_phases_than_states_leave_some_without(void)
{
    static carried_t world;
    carried_init(&world, &nav, 1.0, true);
    pel_nav_config_t cfg = nav.cfg;
    pair_init(&world.pair, &nav, ALL, 0xFF);
    cfg.integers = false;
    cfg.carriers = 0xFF;
    cfg.slice_nodes = 0;
    carried_introduce(&world, &nav, &cfg);
    for (int i = 0; i < 8; i++) {
        carried_step(&world, &nav);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&nav.ud));
    }
    printf("%d signals of %d groups, %d tracked, %d states\n", nav.sd.n, nav.sd.n_groups, nav.track.n, nav.ud.n);
    TEST_ASSERT_TRUE(nav.ins);
    TEST_ASSERT_GREATER_THAN_INT(PEL_MAX_STATES - 18, nav.sd.n - nav.sd.n_groups);
    TEST_ASSERT_EQUAL_INT(PEL_MAX_STATES, nav.ud.n);
    TEST_ASSERT_EQUAL_INT(PEL_MAX_STATES - 18, states_in_use());
    TEST_ASSERT_LESS_THAN_DOUBLE(1.0, carried_error_m(&world, &nav));
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts);
}

/* Satellites that have set make room when it is needed, and not before. */
static void satellites_that_have_set_keep_their_place_until_it_is_needed(void)
{
    const int tracked = nav.track.n;
    pair_observe(&pair, &base, &rover);
    rover.n = (uint16_t)(rover.n - 4); /* two satellites are gone */
    push();
    TEST_ASSERT_EQUAL_INT(tracked, nav.track.n);
    while (nav.ud.n < PEL_MAX_STATES) { TEST_ASSERT_EQUAL(PEL_OK, pel_ud_insert(&nav.ud, nav.ud.n, PEL_R(1.0))); }
    nav.model.n = nav.ud.n;
    pel_nav_track_begin(&nav);
    TEST_ASSERT_EQUAL_INT(tracked - 2, nav.track.n);
    TEST_ASSERT_EQUAL_INT(PEL_MAX_STATES - 2, nav.ud.n);
}

static void a_full_list_takes_no_more(void)
{
    const pel_sd_t first = nav.sd.sd[0];
    for (int i = 0; i < PEL_MAX_TRACKED; i++) { /* all seen, all of another system */
        nav.track.entry[i] = (pel_tracked_t){.sys = PEL_SYS_GAL, .prn = (uint8_t)(i + 1), .state = -1};
        nav.sd.sd[i] = (pel_sd_t){.sys = PEL_SYS_GAL, .prn = (uint8_t)(i + 1)};
    }
    nav.track.n = PEL_MAX_TRACKED;
    nav.sd.sd[PEL_MAX_TRACKED] = first;
    nav.sd.sd[PEL_MAX_TRACKED].group = 1;
    nav.sd.n = PEL_MAX_TRACKED + 1;
    pel_nav_integers_t ints;
    memset(&ints, 0, sizeof ints);
    ints.fixed[PEL_MAX_TRACKED] = true;
    const pel_track_t before = nav.track;
    TEST_ASSERT_TRUE(pel_nav_track_hold(&nav, &ints));
    pel_nav_track_begin(&nav);
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.track, sizeof before);
}

/* One place left: the datum has it, the others wait. */
static void the_last_place_is_the_datums(void)
{
    const pel_sd_set_t set = nav.sd;
    for (int i = 0; i < PEL_MAX_TRACKED - 1; i++) {
        nav.track.entry[i] = (pel_tracked_t){.sys = PEL_SYS_GAL, .prn = (uint8_t)(i + 1), .state = -1};
        nav.sd.sd[i] = (pel_sd_t){.sys = PEL_SYS_GAL, .prn = (uint8_t)(i + 1)};
    }
    nav.track.n = PEL_MAX_TRACKED - 1;
    nav.sd.n = PEL_MAX_TRACKED - 1;
    for (int i = 0; i < 3; i++) {
        nav.sd.sd[nav.sd.n] = set.sd[i];
        nav.sd.sd[nav.sd.n++].group = 1;
    }
    pel_nav_track_begin(&nav);
    TEST_ASSERT_EQUAL_INT(PEL_MAX_TRACKED, nav.track.n);
    TEST_ASSERT_NOT_NULL(entry_of(&set.sd[0]));
    TEST_ASSERT_NULL(entry_of(&set.sd[1]));
    TEST_ASSERT_EQUAL_INT(-1, entry_of(&set.sd[0])->state);
}

/* ---- what goes --------------------------------------------------------------------------------------------------------------------- */

static void a_slip_of_the_datum_takes_the_floats_that_refer_to_it(void)
{
    pel_tracked_t *datum = pel_nav_track_datum(&nav, PEL_SYS_GPS, PEL_CARRIER_L1);
    TEST_ASSERT_NOT_NULL(datum);
    const uint8_t prn = datum->prn;
    const pel_time_t before_ns = nav.at_horizon.t_ns;
    pair_observe(&pair, &base, &rover);
    for (int i = 0; i < rover.n; i++) {
        if (rover.obs[i].prn == prn) { rover.obs[i].flags |= PEL_OBS_SLIP; }
    }
    push();
    for (int i = 0; i < nav.track.n; i++) {
        const pel_tracked_t *t = &nav.track.entry[i];
        TEST_ASSERT_TRUE(t->state < 0 || t->since_ns > before_ns);
    }
    TEST_ASSERT_EQUAL_INT(nav.sd.n, nav.track.n); /* all of them begun anew at once */
}

static void dropping_what_is_not_tracked_changes_nothing(void)
{
    const pel_sd_t stranger = {.sys = PEL_SYS_GAL, .prn = 3};
    const pel_track_t before = nav.track;
    pel_nav_track_drop(&nav, &stranger);
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.track, sizeof before);
    pel_nav_track_drop(&nav, &nav.sd.sd[1]);
    TEST_ASSERT_EQUAL_INT(before.n - 1, nav.track.n);
}

/* ---- whose number is known from whom -------------------------------------------------------------------------------------------------- */

/* Integers of this epoch: rows 1 and 2 fixed against the pivot, row 0. */
static pel_nav_integers_t three_fixed(void)
{
    pel_nav_integers_t ints;
    memset(&ints, 0, sizeof ints);
    ints.fixed[1] = ints.fixed[2] = true;
    ints.N[1] = 11;
    ints.N[2] = -7;
    ints.n_fixed = 2;
    return ints;
}

static void held(const pel_sd_t *sd, double N)
{
    nav.track.entry[nav.track.n++] =
        (pel_tracked_t){.sys = sd->sys, .prn = sd->prn, .carrier = sd->carrier, .state = -1, .N = N, .held = true};
}

static void hold_three(double N_pivot)
{
    const pel_nav_integers_t ints = three_fixed();
    TEST_ASSERT_TRUE(pel_nav_track_hold(&nav, &ints));
    TEST_ASSERT_EQUAL_DOUBLE(N_pivot, entry_of(&nav.sd.sd[0])->N);
    TEST_ASSERT_EQUAL_DOUBLE(N_pivot + 11.0, entry_of(&nav.sd.sd[1])->N);
    TEST_ASSERT_EQUAL_DOUBLE(N_pivot - 7.0, entry_of(&nav.sd.sd[2])->N);
    for (int i = 0; i < 3; i++) { TEST_ASSERT_TRUE(entry_of(&nav.sd.sd[i])->held); }
    TEST_ASSERT_NULL(entry_of(&nav.sd.sd[3]));
}

static void the_pivots_number_is_its_own_or_told_by_another_or_a_new_datum(void)
{
    pel_nav_track_clear(&nav);
    hold_three(0.0); /* nothing is known */
    pel_nav_track_clear(&nav);
    held(&nav.sd.sd[0], 40.0);
    hold_three(40.0); /* its own */
    pel_nav_track_clear(&nav);
    held(&nav.sd.sd[2], 93.0);
    hold_three(100.0); /* told by one that is held and fixed now */
    pel_nav_track_clear(&nav);
    held(&nav.sd.sd[1], 61.0);
    nav.track.entry[0].held = false; /* a datum that is no integer yet serves as well */
    hold_three(50.0);
}

static void who_is_not_fixed_now_tells_nothing(void)
{
    pel_nav_track_clear(&nav);
    held(&nav.sd.sd[3], 5.0);
    const pel_nav_integers_t ints = three_fixed();
    TEST_ASSERT_TRUE(pel_nav_track_hold(&nav, &ints));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, entry_of(&nav.sd.sd[0])->N);
}

/* The pivot is a float state: its number comes from the datum, which is fixed against it. */
static void a_pivot_that_was_a_state_is_told_by_the_datum(void)
{
    const double N_datum = entry_of(&nav.sd.sd[0])->N;
    TEST_ASSERT_TRUE(entry_of(&nav.sd.sd[0])->state < 0 && entry_of(&nav.sd.sd[1])->state >= 0);
    nav.sd.sd[0].pivot = false;
    nav.sd.sd[1].pivot = true;
    pel_nav_integers_t ints;
    memset(&ints, 0, sizeof ints);
    ints.fixed[0] = ints.fixed[2] = true;
    ints.N[0] = 4;
    ints.N[2] = 9;
    TEST_ASSERT_TRUE(pel_nav_track_hold(&nav, &ints));
    const double expected[3] = {N_datum, N_datum - 4.0, N_datum + 5.0};
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(expected[i], entry_of(&nav.sd.sd[i])->N);
        TEST_ASSERT_EQUAL_INT(-1, entry_of(&nav.sd.sd[i])->state);
    }
}

/* Without a pivot integers are against nobody. */
static void a_group_without_a_pivot_is_not_held(void)
{
    pel_nav_track_clear(&nav);
    nav.sd.sd[0].pivot = false;
    const pel_nav_integers_t ints = three_fixed();
    TEST_ASSERT_TRUE(pel_nav_track_hold(&nav, &ints));
    TEST_ASSERT_EQUAL_INT(0, nav.track.n);
}

/* Integers of one epoch that say something else than those held must say it three times, or twice ten seconds apart. */
static void one_epoch_does_not_overrule_what_is_held(void)
{
    for (int far = 0; far < 2; far++) {
        setUp();
        pel_nav_track_clear(&nav);
        hold_three(0.0);
        pel_nav_integers_t other = three_fixed();
        other.N[2] = -8;
        TEST_ASSERT_FALSE(pel_nav_track_hold(&nav, &other));
        TEST_ASSERT_EQUAL_DOUBLE(-7.0, entry_of(&nav.sd.sd[2])->N);
        nav.at_horizon.t_ns += (far ? 10 : 1) * PEL_NS_PER_S;
        TEST_ASSERT_EQUAL_INT(far, pel_nav_track_hold(&nav, &other));
        if (!far) { TEST_ASSERT_TRUE(pel_nav_track_hold(&nav, &other)); }
        TEST_ASSERT_EQUAL_DOUBLE(-8.0, entry_of(&nav.sd.sd[2])->N);
        TEST_ASSERT_EQUAL_INT(0, nav.track.contradictions);
    }
}

static void another_datum_is_no_contradiction(void)
{
    pel_nav_track_clear(&nav);
    held(&nav.sd.sd[0], 100.0);
    hold_three(100.0);
    hold_three(100.0);
    TEST_ASSERT_EQUAL_INT(0, nav.track.contradictions);
}

/* ---- new phases ------------------------------------------------------------------------------------------------------------------------ */

static void a_new_datum_has_no_half_cycle_open_if_another_can_be_it(void)
{
    pel_nav_track_clear(&nav);
    nav.sd.sd[0].half = nav.sd.sd[1].half = true;
    pel_nav_track_begin(&nav);
    TEST_ASSERT_EQUAL_INT(-1, entry_of(&nav.sd.sd[2])->state);
    TEST_ASSERT_TRUE(entry_of(&nav.sd.sd[0])->state >= 0 && entry_of(&nav.sd.sd[0])->half);
    TEST_ASSERT_FALSE(entry_of(&nav.sd.sd[2])->half);
    pel_nav_track_clear(&nav);
    for (int i = 0; i < nav.sd.n; i++) { nav.sd.sd[i].half = true; }
    pel_nav_track_begin(&nav);
    TEST_ASSERT_EQUAL_INT(-1, entry_of(&nav.sd.sd[0])->state); /* none can: the first has to */
    TEST_ASSERT_TRUE(entry_of(&nav.sd.sd[0])->half);
}

/* Of the known satellites of a group one with an integer is the better reference for new ones. */
static void new_phases_refer_to_an_integer_rather_than_to_a_state(void)
{
    const pel_sd_t *late = &nav.sd.sd[nav.sd.n - 1];
    pel_nav_track_drop(&nav, late);
    pel_tracked_t *datum = pel_nav_track_datum(&nav, PEL_SYS_GPS, PEL_CARRIER_L1);
    int at = 0;
    while (nav.sd.sd[at].prn != datum->prn) { at++; }
    const pel_sd_t row = nav.sd.sd[at]; /* the datum comes behind two floats in the epoch */
    nav.sd.sd[at] = nav.sd.sd[at + 1];
    nav.sd.sd[at + 1] = nav.sd.sd[at + 2];
    nav.sd.sd[at + 2] = row;
    datum->N = 12345.0;
    pel_nav_track_begin(&nav);
    const double dd_m = (late->phase_m - row.phase_m) - (late->code_m - row.code_m);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 12345.0 + dd_m / row.lambda_m, entry_of(late)->N);
}

/* The datum is not in this epoch, nor is anyone who refers to it: what is new would refer to nothing. */
static void where_no_one_known_is_seen_nothing_new_begins(void)
{
    for (int i = 0; i < nav.sd.n; i++) { nav.sd.sd[i].prn = (uint8_t)(nav.sd.sd[i].prn + 40); }
    const pel_track_t before = nav.track;
    pel_nav_track_begin(&nav);
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.track, sizeof before);
}

static void glonass_phases_wait_for_the_slope_of_their_channels(void)
{
    observed(GPS | (1u << PEL_SYS_GLO), L1, true, 4);
    pel_nav_phases_t phases;
    int known[2] = {0, 0};
    for (int pass = 0; pass < 2; pass++) {
        pel_nav_track_lookup(&nav, &phases);
        for (int i = 0; i < nav.sd.n; i++) { known[pass] += nav.sd.sd[i].sys == PEL_SYS_GLO && phases.known[i]; }
        nav.track.channels[0].state = -1;
    }
    TEST_ASSERT_GREATER_THAN_INT(4, known[0]);
    TEST_ASSERT_EQUAL_INT(0, known[1]);
    pel_row_t row;
    memset(&row, 0, sizeof row);
    int first = 0;
    while (nav.sd.sd[first].sys != PEL_SYS_GLO) { first++; }
    pel_nav_channels_put(&nav, &nav.sd.sd[first + 1], &nav.sd.sd[first], &row);
    for (int i = 0; i < PEL_MAX_STATES; i++) { TEST_ASSERT_TRUE(row.h[i] == PEL_R(0.0)); }
    /* and of a filter that is full no slope is learnt */
    while (nav.ud.n < PEL_MAX_STATES) { TEST_ASSERT_EQUAL(PEL_OK, pel_ud_insert(&nav.ud, nav.ud.n, PEL_R(1.0))); }
    pel_nav_channels_new_datum(&nav, &nav.sd.sd[first]);
    TEST_ASSERT_EQUAL_INT(-1, nav.track.channels[0].state);
}

static void the_age_of_a_phase_stops_at_its_largest_number(void)
{
    pel_nav_phases_t phases;
    nav.track.entry[1].epochs = UINT16_MAX;
    pel_nav_track_lookup(&nav, &phases);
    TEST_ASSERT_EQUAL_UINT16(UINT16_MAX, nav.track.entry[1].epochs);
}

/* ---- wandering --------------------------------------------------------------------------------------------------------------------------- */

static void float_ambiguities_wander_with_time_and_not_back(void)
{
    const double one = carried_wandered_by(&nav, pel_nav_track_wander, 1.0);
    TEST_ASSERT_GREATER_THAN_DOUBLE(1e-6, one);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * one, 2.0 * one, carried_wandered_by(&nav, pel_nav_track_wander, 2.0));
    TEST_ASSERT_EQUAL_DOUBLE(0.0, carried_wandered_by(&nav, pel_nav_track_wander, 0.5)); /* with the next epoch */
    TEST_ASSERT_EQUAL_DOUBLE(0.0, carried_wandered_by(&nav, pel_nav_track_wander, -3.0));
    TEST_ASSERT_EQUAL_INT64(nav.at_horizon.t_ns, nav.track.wandered_ns);
    nav.cfg.phase_tau_s = 0.0; /* white: they do not */
    TEST_ASSERT_EQUAL_DOUBLE(0.0, carried_wandered_by(&nav, pel_nav_track_wander, 1.0));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(more_phases_than_states_leave_some_without);
    RUN_TEST(satellites_that_have_set_keep_their_place_until_it_is_needed);
    RUN_TEST(a_full_list_takes_no_more);
    RUN_TEST(the_last_place_is_the_datums);
    RUN_TEST(a_slip_of_the_datum_takes_the_floats_that_refer_to_it);
    RUN_TEST(dropping_what_is_not_tracked_changes_nothing);
    RUN_TEST(the_pivots_number_is_its_own_or_told_by_another_or_a_new_datum);
    RUN_TEST(who_is_not_fixed_now_tells_nothing);
    RUN_TEST(a_pivot_that_was_a_state_is_told_by_the_datum);
    RUN_TEST(a_group_without_a_pivot_is_not_held);
    RUN_TEST(one_epoch_does_not_overrule_what_is_held);
    RUN_TEST(another_datum_is_no_contradiction);
    RUN_TEST(a_new_datum_has_no_half_cycle_open_if_another_can_be_it);
    RUN_TEST(new_phases_refer_to_an_integer_rather_than_to_a_state);
    RUN_TEST(where_no_one_known_is_seen_nothing_new_begins);
    RUN_TEST(glonass_phases_wait_for_the_slope_of_their_channels);
    RUN_TEST(the_age_of_a_phase_stops_at_its_largest_number);
    RUN_TEST(float_ambiguities_wander_with_time_and_not_back);
    return UNITY_END();
}

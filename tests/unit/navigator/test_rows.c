/* Rows of one epoch: which satellite the others are held against, what is refused before the filter, what is reported. */
/* with: carried pair gnss */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

static carried_t world;
static pel_navigator_t good, nav;
static pel_nav_update_t *u;

/* The rows of an epoch that was used, to be used again with something changed. The first group is GPS on L1. */
void setUp(void)
{
    carried_init(&world, &good, 1.0, true);
    pel_nav_config_t cfg = good.cfg;
    cfg.slice_nodes = 0;
    carried_introduce(&world, &good, &cfg);
    carried_run(&world, &good, 6);
    pair_see_again(&good);
    nav = good;
    u = &nav.update;
    u->used = u->code_used = u->code_refused = u->held_used = u->held_refused = 0;
    pel_nav_start_reports(&nav);
}

void tearDown(void) {}

static int group_size(void)
{
    int n = 0;
    while (n < nav.sd.n && nav.sd.sd[n].group == nav.sd.sd[0].group) { n++; }
    return n;
}

/* Only the first group, and of it only what is asked for. */
static void only(bool code, bool phase)
{
    nav.sd.n = group_size();
    nav.sd.n_groups = 1;
    for (int i = 0; i < nav.sd.n; i++) {
        nav.sd.sd[i].has_code = nav.sd.sd[i].has_code && code;
        nav.sd.sd[i].has_phase = nav.sd.sd[i].has_phase && phase;
        nav.sd.sd[i].has_rate = false;
    }
    nav.n_sats = nav.sd.n;
}

static int pivot_of_the_report(void)
{
    for (int i = 0; i < nav.n_sats; i++) {
        if ((nav.sats[i].flags & PEL_SAT_PIVOT) != 0) { return i; }
    }
    return -1;
}

static void the_pivot_is_the_groups_own_or_the_first_that_agrees(void)
{
    only(true, false);
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(0, pivot_of_the_report());
    setUp();
    only(true, false);
    nav.sd.sd[0].pivot = false;
    nav.sd.sd[2].pivot = true;
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(2, pivot_of_the_report());
    setUp();
    only(true, false);
    nav.sd.sd[0].code_m += 300.0; /* a coarse error: no one is held against it */
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(1, pivot_of_the_report());
    TEST_ASSERT_EQUAL_INT(1, u->code_refused);
    TEST_ASSERT_TRUE((nav.sats[0].flags & PEL_SAT_EXCLUDED) != 0);
    TEST_ASSERT_EQUAL_INT(nav.sd.n - 2, u->code_used);
}

/* A phase whose number is an integer serves better than one whose number is a state. */
static void the_pivot_of_phases_has_an_integer(void)
{
    only(false, true);
    TEST_ASSERT_EQUAL_INT(0, nav.track.entry[0].state < 0 ? 0 : 1);
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(0, pivot_of_the_report());
    TEST_ASSERT_EQUAL_INT(nav.sd.n - 1, u->held_used);

    setUp();
    only(false, true);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_insert(&nav.ud, nav.ud.n, PEL_R(1.0)));
    nav.model.n = nav.ud.n;
    u->phases.state[0] = u->phases.state[1] = (int16_t)(nav.ud.n - 1);
    u->phases.held[0] = u->phases.held[1] = false;
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(2, pivot_of_the_report());

    setUp(); /* the group's own before another, whoever comes first */
    only(false, true);
    nav.sd.sd[0].pivot = false;
    nav.sd.sd[3].pivot = true;
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(3, pivot_of_the_report());

    setUp(); /* but not if its number is a state */
    only(false, true);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_insert(&nav.ud, nav.ud.n, PEL_R(1.0)));
    nav.model.n = nav.ud.n;
    nav.sd.sd[0].pivot = false;
    nav.sd.sd[3].pivot = true;
    u->phases.state[3] = (int16_t)(nav.ud.n - 1);
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(0, pivot_of_the_report());
}

/* All states, the pivot's too: then its own number is part of each row. */
static void floats_against_a_float(void)
{
    only(false, true);
    for (int i = 0; i < nav.sd.n; i++) {
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_insert(&nav.ud, nav.ud.n, PEL_R(100.0)));
        u->phases.state[i] = (int16_t)(nav.ud.n - 1);
        u->phases.held[i] = false;
        u->phases.N[i] += 2.0; /* all alike: no double difference sees it */
    }
    nav.model.n = u->ant.n_states = nav.ud.n;
    const pel_real before = pel_ud_cov(&nav.ud, u->phases.state[1], u->phases.state[1]);
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(nav.sd.n - 1, u->used);
    TEST_ASSERT_EQUAL_INT(0, u->held_used);
    const int a = u->phases.state[0], b = u->phases.state[1];
    TEST_ASSERT_TRUE(pel_ud_cov(&nav.ud, b, b) >
                     PEL_R(0.05) * before); /* each alone is as unknown as their common part */
    const double difference =
        (double)(pel_ud_cov(&nav.ud, a, a) + pel_ud_cov(&nav.ud, b, b) - PEL_R(2.0) * pel_ud_cov(&nav.ud, a, b));
    TEST_ASSERT_LESS_THAN_DOUBLE(0.05, difference); /* cycles^2 */
    for (int i = 1; i < nav.sd.n; i++) { TEST_ASSERT_EQUAL_INT(0, nav.sats[i].flags & PEL_SAT_FIXED); }
}

static void a_fix_needs_both_ends_held(void)
{
    only(false, true);
    u->phases.held[0] = false; /* the datum, known but not validated */
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(PEL_SAT_PHASE_USED, nav.sats[1].flags & (PEL_SAT_PHASE_USED | PEL_SAT_FIXED));
    TEST_ASSERT_EQUAL_INT(0, nav.sats[1].n_fixed);
}

static void a_measurement_alone_is_neither_used_nor_refused(void)
{
    only(true, false);
    for (int i = 1; i < nav.sd.n; i++) { nav.sd.sd[i].has_code = false; }
    const pel_nav_counters_t before = nav.counters;
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(0, u->code_used + u->code_refused);
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.counters, sizeof before);
    TEST_ASSERT_EQUAL_INT(-1, pivot_of_the_report());
}

static void codes_that_all_disagree_are_all_refused(void)
{
    only(true, false);
    const int n = nav.sd.n - nav.sd.n % 2; /* an even number has no one in the middle */
    nav.sd.n = nav.n_sats = n;
    nav.sd.sd[n - 1].has_code = nav.sd.sd[n - 2].has_code = false;
    for (int i = 0; i < n; i++) { nav.sd.sd[i].code_m += 400.0 * i; }
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(0, u->code_used);
    TEST_ASSERT_EQUAL_INT(n - 2, u->code_refused);
    TEST_ASSERT_EQUAL_UINT32(good.counters.rows_gated + (uint32_t)(n - 2), nav.counters.rows_gated);
    for (int i = 0; i < n; i++) { TEST_ASSERT_EQUAL_INT(i < n - 2, (nav.sats[i].flags & PEL_SAT_EXCLUDED) != 0); }
}

static void variances_that_are_no_numbers_stop_at_the_row(void)
{
    only(true, false);
    nav.sd.sd[0].var_code = NAN;
    const pel_ud_t before = nav.ud;
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.ud, sizeof before); /* the pivot's: no row at all */
    TEST_ASSERT_EQUAL_INT(0, u->used);
    setUp();
    only(true, false);
    nav.sd.sd[1].var_code = NAN; /* one satellite's: its row alone */
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(1, u->code_refused);
    TEST_ASSERT_EQUAL_INT(nav.sd.n - 2, u->code_used);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&nav.ud));
}

/* More rows in one group than there can be satellites: the median is of the first, and nothing is written beyond them. */
static void a_group_larger_than_a_view_is_bounded(void)
{
    only(true, false);
    const pel_sd_t model = nav.sd.sd[1];
    nav.sd.n = nav.n_sats = PEL_MAX_SATS + 8;
    for (int i = 1; i < nav.sd.n; i++) { nav.sd.sd[i] = model; }
    pel_nav_start_reports(&nav);
    pel_nav_update_rows(&nav, u);
    TEST_ASSERT_EQUAL_INT(nav.sd.n - 1, u->code_used + u->code_refused);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&nav.ud));
}

static void reports_begin_with_what_is_known(void)
{
    nav.sd.sd[1].slip = true;
    nav.view_rover.n = 0;
    memset(nav.sats, 0xFF, sizeof nav.sats);
    pel_nav_start_reports(&nav);
    TEST_ASSERT_EQUAL_INT(nav.sd.n, nav.n_sats);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, nav.sats[1].az_rad); /* not in view any more */
    TEST_ASSERT_EQUAL_FLOAT(good.sats[1].el_rad, nav.sats[1].el_rad);
    TEST_ASSERT_EQUAL_INT(PEL_SAT_SLIP, nav.sats[1].flags);
    TEST_ASSERT_EQUAL_INT(0, nav.sats[0].flags);
}

static void a_satellite_counts_once_and_if_any_of_its_signals_was_used(void)
{
    static const struct {
        uint8_t sys, prn, flags;
    } of[] = {{PEL_SYS_GPS, 5, PEL_SAT_EXCLUDED},     {PEL_SYS_GPS, 5, PEL_SAT_PHASE_USED},
              {PEL_SYS_GPS, 5, PEL_SAT_CODE_USED},    {PEL_SYS_GAL, 5, PEL_SAT_PIVOT},
              {PEL_SYS_GPS, 6, PEL_SAT_DOPPLER_USED}, {PEL_SYS_GPS, 7, 0}};
    nav.n_sats = 6;
    for (int i = 0; i < 6; i++) {
        nav.sats[i].sys = of[i].sys;
        nav.sats[i].prn = of[i].prn;
        nav.sats[i].flags = of[i].flags;
    }
    TEST_ASSERT_EQUAL_INT(3, pel_nav_satellites_used(&nav));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_pivot_is_the_groups_own_or_the_first_that_agrees);
    RUN_TEST(the_pivot_of_phases_has_an_integer);
    RUN_TEST(floats_against_a_float);
    RUN_TEST(a_fix_needs_both_ends_held);
    RUN_TEST(a_measurement_alone_is_neither_used_nor_refused);
    RUN_TEST(codes_that_all_disagree_are_all_refused);
    RUN_TEST(variances_that_are_no_numbers_stop_at_the_row);
    RUN_TEST(a_group_larger_than_a_view_is_bounded);
    RUN_TEST(reports_begin_with_what_is_known);
    RUN_TEST(a_satellite_counts_once_and_if_any_of_its_signals_was_used);
    return UNITY_END();
}

/* What an epoch leaves behind is watched: refused codes and phases, Doppler against the INS, factors, codes against held integers. */
/* with: carried pair gnss */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

static carried_t world;
static pel_navigator_t good, nav;
static pel_nav_config_t cfg;

void setUp(void)
{
    carried_init(&world, &good, 1.0, true);
    cfg = good.cfg;
    cfg.slice_nodes = 0;
    carried_introduce(&world, &good, &cfg);
    carried_run(&world, &good, 6);
    TEST_ASSERT_TRUE(good.ins && good.relative);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, good.last_fix);
    nav = good;
}

void tearDown(void) {}

/* ---- one epoch's end, with what it may find ------------------------------------------------------------------------------------ */

typedef struct {
    const char *name;
    int code_used, code_refused, held_used, held_refused;
    int misfits, doubts, restless; /* before it */
    bool doppler_refused, lost_level, contradicting_codes, broken;
    int restarts, released; /* what it must say */
} end_t;

/* As the last search of the epoch ends, without a result. */
static void end_the_epoch(const end_t *e)
{
    nav = good;
    pel_nav_update_t *u = &nav.update;
    u->code_used = e->code_used;
    u->code_refused = e->code_refused;
    u->held_used = e->held_used;
    u->held_refused = e->held_refused;
    nav.track.misfits = (uint8_t)e->misfits;
    nav.doubts = (uint8_t)e->doubts;
    nav.restless = (uint8_t)e->restless;
    for (int i = 0; i < nav.n_sats && e->doppler_refused; i++) {
        nav.sats[i].flags &= (uint8_t)~PEL_SAT_DOPPLER_USED;
        nav.sats[i].sd_doppler_mps = 0.1f;
    }
    nav.noise_level.of[PEL_NAV_LEVEL_PHASE][PEL_SYS_GPS][PEL_CARRIER_L2].factor = e->lost_level ? 3.81f : 3.79f;
    memset(&nav.hold_watch, 0, sizeof nav.hold_watch);
    for (int k = 0; k < 3; k++) { nav.hold_watch.M[k][k] = 4.0; }
    nav.hold_watch.s[1] = 2.0 * (e->contradicting_codes ? 5.49 : 5.47); /* chi-square 30.1 and 29.9 */
    if (e->broken) { nav.ud.x[4] = (pel_real)NAN; }
    nav.search = PEL_NAV_SEARCH_FLOATS;
    nav.ils.n = 0;
    nav.ils.stage = 0;
    u->later.n_fixed = 0;
    u->ints.nodes = 70000;
    pel_nav_go_on(&nav, 100);
    TEST_ASSERT_EQUAL_INT_MESSAGE(PEL_NAV_SEARCH_NONE, nav.search, e->name);
}

static void limits_of_doubt(void)
{
    static const end_t ENDS[] = {
        {"nothing", 10, 0, 6, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
        {"as many codes refused as used", 5, 5, 6, 0, 0, 7, 0, 0, 0, 0, 0, 0, 0},
        {"more refused than used, the eighth time", 5, 6, 6, 0, 0, 7, 0, 0, 0, 0, 0, 1, 0},
        {"the seventh", 5, 6, 6, 0, 0, 6, 0, 0, 0, 0, 0, 0, 0},
        {"held phases do not fit, the third time", 10, 0, 2, 3, 2, 0, 0, 0, 0, 0, 0, 0, 1},
        {"the second", 10, 0, 2, 3, 1, 0, 0, 0, 0, 0, 0, 0, 0},
        {"as many fit", 10, 0, 3, 3, 2, 0, 0, 0, 0, 0, 0, 0, 0},
        {"Doppler against the INS, the third time", 10, 0, 6, 0, 0, 0, 2, 1, 0, 0, 0, 1, 0},
        {"the second", 10, 0, 6, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0},
        {"a phase level at its limit", 10, 0, 6, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1},
        {"the same with nothing held", 10, 0, 2, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0},
        {"codes against what is held", 10, 0, 3, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1},
        {"and with too little held", 10, 0, 2, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0},
        {"factors", 10, 0, 6, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0},
    };
    for (size_t i = 0; i < sizeof ENDS / sizeof ENDS[0]; i++) {
        const end_t *e = &ENDS[i];
        end_the_epoch(e);
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(good.counters.restarts + (uint32_t)e->restarts, nav.counters.restarts,
                                         e->name);
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(good.counters.fix_released + (uint32_t)e->released, nav.counters.fix_released,
                                         e->name);
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(good.counters.numeric_faults + (e->broken ? 1u : 0u),
                                         nav.counters.numeric_faults, e->name);
        TEST_ASSERT_EQUAL_INT_MESSAGE(e->restarts == 0, nav.ins, e->name);
        TEST_ASSERT_EQUAL_INT_MESSAGE(e->restarts != 0, (nav.epoch_solution.flags & PEL_SOL_RESTARTED) != 0, e->name);
        TEST_ASSERT_TRUE_MESSAGE(nav.have_state, e->name); /* the epoch's own single-point solution is fresh */
        if (e->released) { TEST_ASSERT_EQUAL_INT_MESSAGE(0, nav.track.n, e->name); }
        if (e->lost_level) {
            TEST_ASSERT_EQUAL_FLOAT(1.0f, nav.noise_level.of[PEL_NAV_LEVEL_PHASE][PEL_SYS_GPS][PEL_CARRIER_L2].factor);
        }
        TEST_ASSERT_EQUAL_UINT16(65535, nav.epoch_solution.search_nodes); /* of 70 000 */
        carried_t after = world;
        carried_run(&after, &nav, 5);
        TEST_ASSERT_LESS_THAN_DOUBLE_MESSAGE(0.05, carried_error_m(&after, &nav), e->name);
    }
}

/* A level at its limit says nothing where nothing is differenced. */
static void without_a_base_phase_levels_are_not_looked_at(void)
{
    static const end_t LOST = {"", 10, 0, 6, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0};
    good.relative = false;
    end_the_epoch(&LOST);
    TEST_ASSERT_EQUAL_UINT32(good.counters.fix_released, nav.counters.fix_released);
    TEST_ASSERT_EQUAL_FLOAT(3.81f, nav.noise_level.of[PEL_NAV_LEVEL_PHASE][PEL_SYS_GPS][PEL_CARRIER_L2].factor);
}

/* A restart needs a position of this epoch: it never goes back in time. */
static void without_a_fresh_position_there_is_none_until_the_next(void)
{
    static const end_t BROKEN = {"", 10, 0, 6, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0};
    for (int i = 0; i < 2; i++) {
        const pel_navigator_t keep = good;
        good.have_spp = i == 0;
        good.spp.t_ns -= (i == 0) ? PEL_NS_PER_S : 0;
        end_the_epoch(&BROKEN);
        TEST_ASSERT_FALSE(nav.have_state || nav.ins || nav.relative);
        TEST_ASSERT_TRUE((nav.epoch_solution.flags & PEL_SOL_RESTARTED) != 0);
        TEST_ASSERT_EQUAL_UINT32(keep.counters.epochs_used, nav.counters.epochs_used);
        carried_t after = world;
        carried_step(&after, &nav);
        TEST_ASSERT_TRUE(nav.have_state);
        good = keep;
    }
}

static void nothing_under_way_is_nothing_to_go_on_with(void)
{
    pel_nav_go_on(&nav, 100);
    TEST_ASSERT_EQUAL_MEMORY(&good, &nav, sizeof nav);
}

/* ---- the same from outside -------------------------------------------------------------------------------------------------------- */

static void an_ins_whose_velocity_is_wrong_is_given_up_within_three_epochs(void)
{
    for (int k = 0; k < 3; k++) { nav.at_horizon.v_eb_e[k] += 4.0; }
    pel_nav_predict_now(&nav);
    pel_nav_seal_state(&nav);
    int epochs = 0;
    for (; epochs < 6 && nav.counters.restarts == good.counters.restarts; epochs++) { carried_step(&world, &nav); }
    TEST_ASSERT_EQUAL_INT(3, epochs);
    TEST_ASSERT_FALSE(nav.ins);
    carried_run(&world, &nav, 5);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.05, carried_error_m(&world, &nav));
}

/* Also where no two codes agree any more and none is left to be held against another. */
static void a_position_that_no_code_agrees_with_is_given_up_after_eight_epochs(void)
{
    static const double OFF_M[] = {200.0, 500.0, 2000.0};
    const carried_t before = world;
    for (int i = 0; i < 3; i++) {
        world = before;
        nav = good;
        nav.at_horizon.r_eb_e[1] += OFF_M[i];
        pel_nav_predict_now(&nav);
        pel_nav_seal_state(&nav);
        int epochs = 0;
        for (; epochs < 12 && nav.counters.restarts == good.counters.restarts; epochs++) { carried_step(&world, &nav); }
        TEST_ASSERT_EQUAL_INT(8, epochs);
        TEST_ASSERT_LESS_THAN_DOUBLE(10.0, carried_error_m(&world, &nav));
        carried_run(&world, &nav, 5);
        TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
        TEST_ASSERT_LESS_THAN_DOUBLE(0.05, carried_error_m(&world, &nav));
    }
}

/* Factors that lost a number while a search waits for its next slice. */
static void factors_lost_during_a_search_are_found_at_its_end(void)
{
    cfg.slice_nodes = 1;
    carried_introduce(&world, &nav, &cfg);
    carried_run(&world, &nav, 4);
    static pel_epoch_t base, rover;
    carried_observe(&world, &base, &rover);
    carried_imu_until(&world, &nav, SKY_T0 + (world.pair.epoch - 1) * PEL_NS_PER_S);
    pel_navigator_push_base(&nav, &base);
    pel_navigator_push_rover(&nav, &rover);
    for (int i = 0; i < 30 && nav.search == PEL_NAV_SEARCH_NONE; i++) {
        const pel_imu_t imu = carried_imu(&world);
        pel_navigator_push_imu(&nav, &imu);
    }
    TEST_ASSERT_NOT_EQUAL(PEL_NAV_SEARCH_NONE, nav.search);
    nav.ud.U[0] = (pel_real)NAN;
    const pel_nav_counters_t before = nav.counters;
    carried_run(&world, &nav, 1);
    TEST_ASSERT_EQUAL_UINT32(before.numeric_faults + 1, nav.counters.numeric_faults);
    TEST_ASSERT_EQUAL_UINT32(before.restarts + 1, nav.counters.restarts);
    carried_run(&world, &nav, 5);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
}

static void without_integers_it_stays_float(void)
{
    cfg.integers = false;
    carried_introduce(&world, &nav, &cfg);
    carried_run(&world, &nav, 20);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FLOAT, nav.last_fix);
    TEST_ASSERT_EQUAL_INT(PEL_INT_NOT_TRIED, nav.epoch_solution.int_reason);
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.fix_tried);
    TEST_ASSERT_LESS_THAN_DOUBLE(1.0, carried_error_m(&world, &nav));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(limits_of_doubt);
    RUN_TEST(without_a_base_phase_levels_are_not_looked_at);
    RUN_TEST(without_a_fresh_position_there_is_none_until_the_next);
    RUN_TEST(nothing_under_way_is_nothing_to_go_on_with);
    RUN_TEST(an_ins_whose_velocity_is_wrong_is_given_up_within_three_epochs);
    RUN_TEST(a_position_that_no_code_agrees_with_is_given_up_after_eight_epochs);
    RUN_TEST(factors_lost_during_a_search_are_found_at_its_end);
    RUN_TEST(without_integers_it_stays_float);
    return UNITY_END();
}

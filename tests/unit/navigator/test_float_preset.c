/* The preset with float ambiguities in local axes, and phases of a receiver whose base went silent, on a vehicle in motion. */
/* with: carried pair gnss */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

static carried_t world;
static pel_navigator_t nav;
static pel_nav_config_t cfg;
static pel_epoch_t base, rover;

static void begin(pel_preset_t preset)
{
    carried_init(&world, &nav, 1.0, true);
    world.sway_m = 3.0;
    world.sway_radps = 0.4;
    cfg = nav.cfg;
    cfg.preset = preset;
    cfg.slice_nodes = 0;
    carried_introduce(&world, &nav, &cfg);
}

void setUp(void)
{
    begin(PEL_PRESET_INS_FLOAT);
}

void tearDown(void) {}

static int satellites_with(unsigned flag)
{
    int n = 0;
    for (int i = 0; i < nav.n_sats; i++) { n += (nav.sats[i].flags & flag) != 0; }
    return n;
}

static void floats_are_carried_in_local_axes(void)
{
    for (int code = 0; code < 2; code++) {
        cfg.float_code = code != 0;
        carried_introduce(&world, &nav, &cfg);
        carried_run(&world, &nav, 30);
        TEST_ASSERT_TRUE(nav.ins && nav.local && nav.relative);
        TEST_ASSERT_EQUAL_INT(PEL_PRESET_INS_FLOAT, nav.used.preset_used);
        TEST_ASSERT_EQUAL_INT(0, satellites_with(PEL_SAT_DOPPLER_USED));
        TEST_ASSERT_EQUAL_INT(code, satellites_with(PEL_SAT_CODE_USED) > 0);
        TEST_ASSERT_GREATER_THAN_INT(5, satellites_with(PEL_SAT_PHASE_USED));
        TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts + nav.counters.numeric_faults);
        const float *P = nav.epoch_solution.cov_r_ned;
        const double off = carried_error_m(&world, &nav), sd = sqrt((double)(P[0] + P[3] + P[5]));
        printf("float preset %s codes: off by %.3f m of sigma %.3f\n", code ? "with" : "without", off, sd);
        TEST_ASSERT_LESS_THAN_DOUBLE(4.0 * sd, off);
        TEST_ASSERT_LESS_THAN_DOUBLE(1.5, off);
    }
}

/* Found by the substep that comes due, in local axes as in e: the INS ends, GNSS starts again. */
static void lost_factors_end_the_ins_in_local_axes_too(void)
{
    carried_run(&world, &nav, 6);
    TEST_ASSERT_TRUE(nav.ins && nav.local);
    nav.ud.D[pel_model_index(&nav.model, PEL_BLOCK_VELOCITY)] = PEL_R(-1.0);
    carried_step(&world, &nav);
    TEST_ASSERT_FALSE(nav.ins);
    TEST_ASSERT_GREATER_OR_EQUAL_UINT32(1, nav.counters.restarts);
    carried_run(&world, &nav, 3);
    TEST_ASSERT_TRUE(nav.have_state);
    TEST_ASSERT_LESS_THAN_DOUBLE(10.0, carried_error_m(&world, &nav));
}

static void rows_that_are_switched_off_are_not_used(void)
{
    static const struct {
        uint8_t observe;
        bool code, phase, rate;
    } of[] = {{PEL_OBS_PHASE | PEL_OBS_DOPPLER, false, false, true}, /* against a base a phase begins at its code */

              {PEL_OBS_CODE | PEL_OBS_PHASE, true, true, false},
              {PEL_OBS_CODE | PEL_OBS_DOPPLER, true, false, true}};
    for (int i = 0; i < 3; i++) {
        begin(PEL_PRESET_INS_RTK);
        cfg.observe = of[i].observe;
        carried_introduce(&world, &nav, &cfg);
        carried_run(&world, &nav, 8);
        TEST_ASSERT_TRUE(nav.ins);
        TEST_ASSERT_EQUAL_INT(of[i].code, satellites_with(PEL_SAT_CODE_USED) > 0);
        TEST_ASSERT_EQUAL_INT(of[i].phase, satellites_with(PEL_SAT_PHASE_USED) > 0);
        TEST_ASSERT_EQUAL_INT(of[i].rate, satellites_with(PEL_SAT_DOPPLER_USED) > 0);
    }
}

/* Integers against a base that has gone silent are kept for two minutes; then the rover's own phases take their place. */
static void a_silent_base_keeps_its_integers_for_two_minutes(void)
{
    begin(PEL_PRESET_AUTO);
    carried_run(&world, &nav, 6);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
    const int tracked = nav.track.n;
    for (int s = 0; s < 150; s++) {
        carried_observe(&world, &base, &rover);
        carried_push(&world, &nav, NULL, &rover);
        if (s == 100) {
            TEST_ASSERT_FALSE(nav.relative || nav.update.phased);
            TEST_ASSERT_FALSE(nav.track.of_rover);
            TEST_ASSERT_EQUAL_INT(tracked, nav.track.n);
        }
    }
    TEST_ASSERT_TRUE(nav.ins && nav.update.phased && nav.track.of_rover);
    TEST_ASSERT_EQUAL_INT(PEL_PRESET_INS_TDCP, nav.used.preset_used);
    TEST_ASSERT_GREATER_THAN_INT(4, satellites_with(PEL_SAT_PHASE_USED));
    TEST_ASSERT_LESS_THAN_DOUBLE(5.0, carried_error_m(&world, &nav));
    carried_run(&world, &nav, 6); /* and the base comes back */
    TEST_ASSERT_TRUE(nav.relative && !nav.track.of_rover);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.1, carried_error_m(&world, &nav));
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts);
}

/* Without a base: slips of the datum, of another, and of all at once do not move the position. */
static void slips_of_a_receiver_alone_begin_those_phases_anew(void)
{
    begin(PEL_PRESET_INS_TDCP);
    carried_run(&world, &nav, 20);
    TEST_ASSERT_TRUE(nav.ins && nav.update.phased);
    for (int who = 0; who < 3; who++) {
        const double before = carried_error_m(&world, &nav);
        const pel_tracked_t *datum = NULL;
        for (int i = 0; i < nav.track.n; i++) {
            if (nav.track.entry[i].state < 0) { datum = &nav.track.entry[i]; }
        }
        TEST_ASSERT_NOT_NULL(datum);
        const uint8_t prn = datum->prn;
        carried_observe(&world, &base, &rover);
        for (int i = 0; i < rover.n; i++) {
            const bool slips = who == 2 || (rover.obs[i].prn == prn) == (who == 0);
            if (!slips || (who == 1 && i > 4)) { continue; }
            rover.obs[i].L_cyc += 7.0;
            rover.obs[i].flags |= PEL_OBS_SLIP;
        }
        carried_push(&world, &nav, NULL, &rover);
        carried_run(&world, &nav, 3);
        TEST_ASSERT_TRUE(nav.update.phased);
        TEST_ASSERT_DOUBLE_WITHIN(0.7, before, carried_error_m(&world, &nav));
    }
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(floats_are_carried_in_local_axes);
    RUN_TEST(lost_factors_end_the_ins_in_local_axes_too);
    RUN_TEST(rows_that_are_switched_off_are_not_used);
    RUN_TEST(a_silent_base_keeps_its_integers_for_two_minutes);
    RUN_TEST(slips_of_a_receiver_alone_begin_those_phases_anew);
    return UNITY_END();
}

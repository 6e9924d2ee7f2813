/* Phases of a receiver without a base: how far the antenna came, slips that one memory knows and the other does not, the datum's heirs, rates. */
/* with: carried pair gnss */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

static carried_t world;
static pel_navigator_t nav;
static pel_epoch_t base, rover;

static void begin(pel_preset_t preset, double rate_mps)
{
    carried_init(&world, &nav, 1.0, true);
    pel_nav_config_t cfg = nav.cfg;
    cfg.preset = preset;
    cfg.single_rate_mps = rate_mps;
    cfg.no_ionosphere = true;
    world.sway_m = 3.0;
    world.sway_radps = 0.6;
    world.begin_s = 8.0;
    carried_introduce(&world, &nav, &cfg);
}

static void step(void)
{
    carried_observe(&world, &base, &rover);
    carried_push(&world, &nav, NULL, &rover);
}

static void run(int seconds)
{
    for (int i = 0; i < seconds; i++) { step(); }
}

/* The IMU's own arm is zero: state minus truth. */
static void error_of(double e[3])
{
    for (int k = 0; k < 3; k++) { e[k] = nav.at_horizon.r_eb_e[k] - world.pair.rover.r_e[k]; }
}

/* How far the navigator is off in what the antenna came since e0. */
static double astray_m(const double e0[3])
{
    double e[3];
    error_of(e);
    for (int k = 0; k < 3; k++) { e[k] -= e0[k]; }
    return pel_norm3(e);
}

static double farthest_astray_m(int seconds)
{
    double e0[3], most = 0.0;
    error_of(e0);
    for (int i = 0; i < seconds; i++) {
        step();
        most = fmax(most, astray_m(e0));
    }
    return most;
}

static pel_tracked_t *datum(void)
{
    for (int i = 0; i < nav.track.n; i++) {
        if (nav.track.entry[i].state < 0) { return &nav.track.entry[i]; }
    }
    return NULL;
}

static pel_obs_t *phase_of(pel_epoch_t *e, const pel_tracked_t *t)
{
    for (int i = 0; i < e->n; i++) {
        if (e->obs[i].sys == t->sys && e->obs[i].prn == t->prn && e->obs[i].carrier == t->carrier) {
            return &e->obs[i];
        }
    }
    return NULL;
}

void setUp(void)
{
    begin(PEL_PRESET_INS_TDCP, 0.0);
    run(15);
}

void tearDown(void) {}

static void phases_know_how_far_it_came_to_a_centimetre(void)
{
    TEST_ASSERT_TRUE(nav.ins);
    TEST_ASSERT_EQUAL(PEL_PRESET_INS_TDCP, pel_nav_preset_in_use(&nav));
    TEST_ASSERT_EQUAL_INT(1, nav.track.n - (nav.ud.n - 18));
    const double with_phases_m = farthest_astray_m(20);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.015, with_phases_m);
    begin(PEL_PRESET_INS_SINGLE, 0.0);
    run(15);
    TEST_ASSERT_EQUAL(PEL_PRESET_INS_SINGLE, pel_nav_preset_in_use(&nav));
    TEST_ASSERT_GREATER_THAN_DOUBLE(3.0 * with_phases_m, farthest_astray_m(20));
}

static void auto_takes_them_where_there_is_an_imu_and_no_base(void)
{
    begin(PEL_PRESET_AUTO, 0.0);
    run(10);
    TEST_ASSERT_EQUAL(PEL_PRESET_INS_TDCP, pel_nav_preset_in_use(&nav));
    TEST_ASSERT_TRUE(nav.track.of_rover && nav.track.n > 5);
    carried_run(&world, &nav, 3); /* a base appears: other numbers */
    TEST_ASSERT_TRUE(nav.relative && !nav.track.of_rover);
    const int n = nav.track.n;
    run(3); /* and goes: they are kept for when it returns */
    run(12);
    TEST_ASSERT_FALSE(nav.relative);
    TEST_ASSERT_FALSE(nav.track.of_rover);
    TEST_ASSERT_EQUAL_INT(n, nav.track.n);
}

static void a_slip_of_any_phase_or_of_the_datum_costs_a_centimetre_at_most(void)
{
    double e0[3];
    const pel_tracked_t was = *datum();
    error_of(e0);
    carried_observe(&world, &base, &rover);
    phase_of(&rover, &was)->L_cyc += 1.0;
    carried_push(&world, &nav, NULL, &rover);
    TEST_ASSERT_GREATER_THAN_UINT32(0, nav.counters.slip_ins + nav.counters.slip_geometry_free);
    TEST_ASSERT_NOT_NULL(datum());
    TEST_ASSERT_FALSE(datum()->sys == was.sys && datum()->prn == was.prn && datum()->carrier == was.carrier);
    run(4);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.015, astray_m(e0));
}

/* The detectors have digested it already: only the phase's own state can tell. */
static void a_slip_that_the_detectors_do_not_tell_is_found_by_its_own_state(void)
{
    double e0[3];
    error_of(e0);
    const pel_tracked_t was = nav.track.entry[3];
    TEST_ASSERT_TRUE(was.state >= 0);
    world.pair.seed += 1;
    for (int second = 0; second < 3; second++) {
        carried_observe(&world, &base, &rover);
        phase_of(&rover, &was)->L_cyc += 2.0; /* from now on */
        for (int i = 0; i < nav.slip_rover.n && second == 0; i++) {
            pel_slip_entry_t *k = &nav.slip_rover.entry[i];
            if (k->sys == was.sys && k->prn == was.prn && k->carrier == was.carrier) {
                const double slip_m = 2.0 * pel_obs_lambda_m(phase_of(&rover, &was));
                k->y_m += slip_m;
                k->code_m -= slip_m;
            }
        }
        const uint32_t gated = nav.counters.rows_gated;
        carried_push(&world, &nav, NULL, &rover);
        if (second == 0) { TEST_ASSERT_GREATER_THAN_UINT32(gated, nav.counters.rows_gated); }
    }
    const pel_tracked_t *now = pel_nav_track_find(&nav, was.sys, was.prn, was.carrier);
    TEST_ASSERT_NOT_NULL(now);
    TEST_ASSERT_TRUE(now->since_ns > was.since_ns || fabs(now->N - was.N) > 0.3);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.015, astray_m(e0));
}

/* And the other way round: what the receiver tells in an epoch is news to the states although the phase itself fits. */
static void a_slip_that_fits_is_believed_when_the_receiver_tells_it(void)
{
    const pel_tracked_t was = nav.track.entry[3];
    const double sd_before = sqrt((double)pel_ud_cov(&nav.ud, was.state, was.state));
    carried_observe(&world, &base, &rover);
    phase_of(&rover, &was)->lock_ms = 0;
    phase_of(&rover, &was)->flags |= PEL_OBS_SLIP;
    carried_push(&world, &nav, NULL, &rover);
    const pel_tracked_t *now = pel_nav_track_find(&nav, was.sys, was.prn, was.carrier);
    TEST_ASSERT_NOT_NULL(now);
    TEST_ASSERT_EQUAL_INT(nav.ud.n - 1, now->state); /* a new state at the end */
    TEST_ASSERT_TRUE(sd_before > 0.0);
}

static void rates_survive_slips_of_their_phases(void)
{
    begin(PEL_PRESET_INS_TDCP, 1e-4);
    nav.cfg.single_phase_tau_s = 0.0;
    pel_nav_seal_config(&nav);
    run(40);
    TEST_ASSERT_EQUAL_INT(2 * (nav.track.n - 1), nav.ud.n - 18);
    const pel_tracked_t other = nav.track.entry[2], was = *datum();
    const double sd_before = sqrt((double)pel_ud_cov(&nav.ud, other.rate, other.rate));
    double e0[3];
    error_of(e0);
    carried_observe(&world, &base, &rover);
    phase_of(&rover, &was)->L_cyc += 5.0; /* the datum: changes places with its heir */
    carried_push(&world, &nav, NULL, &rover);
    const pel_tracked_t *now = pel_nav_track_find(&nav, was.sys, was.prn, was.carrier);
    TEST_ASSERT_TRUE(now->state >= 0 && now->rate >= 0);
    TEST_ASSERT_EQUAL_INT(2 * (nav.track.n - 1), nav.ud.n - 18);
    TEST_ASSERT_LESS_THAN_DOUBLE(1.5 * sd_before, sqrt((double)pel_ud_cov(&nav.ud, now->rate, now->rate)));
    run(5);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.015, astray_m(e0));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&nav.ud));
}

static void a_phase_whose_satellite_has_moved_on_begins_anew_one_an_epoch(void)
{
    for (int i = 0; i < nav.track.n; i++) { /* as after six minutes */
        nav.track.entry[i].u_e[0] += 0.1f;
    }
    double e0[3];
    error_of(e0);
    const int n = nav.track.n;
    run(n + 1);
    for (int i = 0; i < nav.track.n; i++) {
        const pel_tracked_t *t = &nav.track.entry[i];
        const pel_sight_t *s = pel_view_find(&nav.view_rover, t->sys, t->prn);
        TEST_ASSERT_NOT_NULL(s);
        for (int k = 0; k < 3; k++) { TEST_ASSERT_DOUBLE_WITHIN(0.02, s->u_e[k], (double)t->u_e[k]); }
    }
    TEST_ASSERT_LESS_THAN_DOUBLE(0.02, astray_m(e0));
}

/* White phases, told so: paths and multipath that are not there would be paid for with sigma. */
static void innovations_are_as_large_as_foretold(void)
{
    nav.cfg.single_phase_tau_s = 0.0;
    nav.cfg.single_path_m_rts = 1e-4;
    nav.cfg.learn_noise = false;
    nav.cfg.noise_single.cn0_ref_dbhz = 0.0;
    nav.cfg.noise_single.phase_a_m = 0.003;
    nav.cfg.noise_single.phase_b_m = 0.0;
    pel_nav_seal_config(&nav);
    pel_nav_noise_level_init(&nav);
    run(30);
    double sum = 0.0;
    int rows = 0;
    for (int second = 0; second < 60; second++) {
        step();
        for (int i = 0; i < nav.n_sats; i++) {
            const pel_sat_report_t *r = &nav.sats[i];
            if ((r->flags & PEL_SAT_PHASE_USED) == 0 || !(r->sd_phase_m > 0.0f)) { continue; }
            sum += (double)(r->innov_phase_m * r->innov_phase_m / (r->sd_phase_m * r->sd_phase_m));
            rows++;
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(500, rows);
    TEST_ASSERT_DOUBLE_WITHIN(0.3, 1.0, sum / rows);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(phases_know_how_far_it_came_to_a_centimetre);
    RUN_TEST(auto_takes_them_where_there_is_an_imu_and_no_base);
    RUN_TEST(a_slip_of_any_phase_or_of_the_datum_costs_a_centimetre_at_most);
    RUN_TEST(a_slip_that_the_detectors_do_not_tell_is_found_by_its_own_state);
    RUN_TEST(a_slip_that_fits_is_believed_when_the_receiver_tells_it);
    RUN_TEST(rates_survive_slips_of_their_phases);
    RUN_TEST(a_phase_whose_satellite_has_moved_on_begins_anew_one_an_epoch);
    RUN_TEST(innovations_are_as_large_as_foretold);
    return UNITY_END();
}

/* What is missing for a while: epochs, satellites, the IMU; and a filter that lost its factors. */
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

void setUp(void)
{
    carried_init(&world, &nav, 1.0, true);
    cfg = nav.cfg;
    cfg.slice_nodes = 0;
    cfg.output_period_ns = 100 * PEL_NS_PER_MS;
    carried_introduce(&world, &nav, &cfg);
}

void tearDown(void) {}

static void with_ins(void)
{
    carried_run(&world, &nav, 6);
    TEST_ASSERT_TRUE(nav.ins);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
}

static void gnss_alone(int epochs)
{
    cfg.preset = PEL_PRESET_RTK;
    carried_introduce(&world, &nav, &cfg);
    for (int i = 0; i < epochs; i++) { (void)pair_step(&world.pair, &nav); }
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
}

static void push_epochs(void)
{
    pel_navigator_push_base(&nav, &base);
    pel_navigator_push_rover(&nav, &rover);
    while (pel_navigator_flush(&nav)) {}
}

/* Satellites of the rover's epoch; the base sees all. */
static void keep_satellites(int n)
{
    int kept = 0;
    uint8_t prn[PEL_MAX_OBS];
    int n_prn = 0;
    for (int i = 0; i < rover.n; i++) {
        int j = 0;
        while (j < n_prn && prn[j] != rover.obs[i].prn) { j++; }
        if (j == n_prn) { prn[n_prn++] = rover.obs[i].prn; }
        if (j < n) { rover.obs[kept++] = rover.obs[i]; }
    }
    rover.n = (uint16_t)kept;
}

/* ---- silences of the receiver --------------------------------------------------------------------------------------------------- */

static void after_a_minute_and_a_half_the_epochs_own_code_draws_the_position(void)
{
    gnss_alone(5);
    world.pair.epoch += 90;
    nav.at_horizon.v_eb_e[1] += 3.0; /* what it did in the meantime nobody knows: 270 m */
    pel_nav_seal_state(&nav);
    (void)pair_step(&world.pair, &nav);
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts);
    TEST_ASSERT_LESS_THAN_DOUBLE(3.0, pair_error_m(&world.pair, &nav));
    for (int i = 0; i < 5; i++) { (void)pair_step(&world.pair, &nav); }
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.05, pair_error_m(&world.pair, &nav));
}

static void after_a_longer_silence_it_starts_again(void)
{
    gnss_alone(5);
    world.pair.epoch += 150;
    (void)pair_step(&world.pair, &nav);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.restarts);
    TEST_ASSERT_LESS_THAN_DOUBLE(5.0, pair_error_m(&world.pair, &nav));
    for (int i = 0; i < 5; i++) { (void)pair_step(&world.pair, &nav); }
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
}

static void an_ins_without_epochs_coasts_and_its_bounds_grow(void)
{
    with_ins();
    float hpl_m = nav.solution.hpl_m;
    for (int s = 1; s <= 8; s++) {
        const pel_time_t t_ns = SKY_T0 + (world.pair.epoch - 1 + s) * PEL_NS_PER_S;
        carried_imu_until(&world, &nav, t_ns);
        TEST_ASSERT_EQUAL_INT(s <= 1 ? PEL_FIX_FIXED : PEL_FIX_COAST, nav.solution.fix);
        TEST_ASSERT_GREATER_THAN_FLOAT(hpl_m, nav.solution.hpl_m);
        hpl_m = nav.solution.hpl_m;
    }
    TEST_ASSERT_UINT_WITHIN(2, 65, nav.counters.coast_epochs);
    TEST_ASSERT_TRUE(nav.ins);
    TEST_ASSERT_LESS_THAN_DOUBLE((double)hpl_m, carried_error_m(&world, &nav));
    world.pair.epoch += 8;
    carried_run(&world, &nav, 3);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.solution.fix);
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts);
}

/* ---- silence of the IMU ------------------------------------------------------------------------------------------------------------- */

static void an_imu_that_goes_leaves_gnss_alone(void)
{
    with_ins();
    for (int i = 0; i < 3; i++) {
        carried_observe(&world, &base, &rover);
        push_epochs();
    }
    TEST_ASSERT_FALSE(nav.ins);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.restarts);
    TEST_ASSERT_TRUE(nav.have_state);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.05, carried_error_m(&world, &nav));
}

/* The ring was emptied by a gap too long to bridge, and the epoch lies before what it holds now. */
static void an_epoch_before_the_rings_content_drops_the_ins(void)
{
    with_ins();
    pel_navigator_t copy = nav;
    copy.ring.n = 0;
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_nav_advance(&copy, copy.at_horizon.t_ns + 1));
    copy = nav;
    copy.ring.n = 3;
    const pel_imu_t *oldest = pel_imu_ring_oldest(&copy.ring);
    copy.at_horizon.t_ns = oldest->t_ns - 2 * CARRIED_IMU_NS;
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_nav_advance(&copy, oldest->t_ns));
    copy.at_horizon.t_ns = oldest->t_ns - CARRIED_IMU_NS; /* the oldest begins here: that is enough */
    TEST_ASSERT_EQUAL(PEL_OK, pel_nav_advance(&copy, oldest->t_ns));
    TEST_ASSERT_EQUAL_INT64(oldest->t_ns, copy.at_horizon.t_ns);
    TEST_ASSERT_EQUAL(PEL_E_STALE, pel_nav_advance(&copy, oldest->t_ns - 1));
}

static void gnss_alone_stays_where_it_is_for_no_time(void)
{
    gnss_alone(2);
    const pel_ud_t before = nav.ud;
    TEST_ASSERT_EQUAL(PEL_OK, pel_nav_advance(&nav, nav.at_horizon.t_ns));
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.ud, sizeof before);
    TEST_ASSERT_EQUAL(PEL_E_STALE, pel_nav_advance(&nav, nav.at_horizon.t_ns - 1));
    TEST_ASSERT_EQUAL(PEL_E_STALE, pel_nav_advance(&nav, nav.at_horizon.t_ns + 101 * PEL_NS_PER_S));
}

/* ---- few satellites ------------------------------------------------------------------------------------------------------------------ */

/* Three satellites give no position, but rows for one that is known; the receiver's clock is that of the last solution. */
static void three_satellites_hold_a_position_that_is_known(void)
{
    with_ins();
    for (int i = 0; i < 10; i++) {
        carried_observe(&world, &base, &rover);
        keep_satellites(3);
        const uint32_t used = nav.counters.epochs_used;
        carried_push(&world, &nav, &base, &rover);
        TEST_ASSERT_EQUAL_UINT32(used + 1, nav.counters.epochs_used);
    }
    TEST_ASSERT_EQUAL_UINT32(10, nav.counters.epochs_spp_failed);
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts);
    const float *P = nav.epoch_solution.cov_r_ned;
    const double off = carried_error_m(&world, &nav), sd = sqrt((double)(P[0] + P[3] + P[5]));
    printf("ten seconds with three satellites: off by %.2f m of sigma %.2f\n", off, sd);
    TEST_ASSERT_LESS_THAN_DOUBLE(3.0 * sd, off);
    TEST_ASSERT_LESS_THAN_DOUBLE(2.0, sd); /* the sensor alone: 20 m */
}

static void a_receiver_clock_a_minute_old_is_found_again_from_the_place_the_ins_knows(void)
{
    with_ins();
    nav.spp.t_ns -= 60 * PEL_NS_PER_S;
    carried_observe(&world, &base, &rover);
    keep_satellites(3);
    const uint32_t used = nav.counters.epochs_used;
    carried_push(&world, &nav, &base, &rover);
    TEST_ASSERT_EQUAL_UINT32(used + 1, nav.counters.epochs_used);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.epochs_spp_failed);
    TEST_ASSERT_TRUE(nav.ins);
}

static void codes_that_disagree_at_that_place_tell_no_clock(void)
{
    with_ins();
    nav.spp.t_ns -= 60 * PEL_NS_PER_S;
    carried_observe(&world, &base, &rover);
    keep_satellites(3);
    for (int i = 0; i < rover.n; i++) { rover.obs[i].P_m += 1e5 * rover.obs[i].prn; } /* orbits of another hour */
    const uint32_t used = nav.counters.epochs_used;
    carried_push(&world, &nav, &base, &rover);
    TEST_ASSERT_EQUAL_UINT32(used, nav.counters.epochs_used);
    TEST_ASSERT_TRUE(nav.ins);
}

static void three_satellites_start_nothing(void)
{
    carried_observe(&world, &base, &rover);
    keep_satellites(3);
    carried_push(&world, &nav, &base, &rover);
    TEST_ASSERT_FALSE(nav.have_state);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.epochs_spp_failed);
    carried_observe(&world, &base, &rover);
    keep_satellites(5);
    carried_push(&world, &nav, &base, &rover);
    TEST_ASSERT_TRUE(nav.have_state);
}

/* Phases alone, once there is a state: nothing that a receiver without a base can use. */
static void phases_without_a_base_are_no_epoch(void)
{
    with_ins();
    carried_observe(&world, &base, &rover);
    for (int i = 0; i < rover.n; i++) { rover.obs[i].flags = PEL_OBS_PHASE; }
    nav.have_station = false;
    const uint32_t few = nav.counters.epochs_few_sats;
    carried_push(&world, &nav, NULL, &rover);
    TEST_ASSERT_EQUAL_UINT32(few + 1, nav.counters.epochs_few_sats);
    TEST_ASSERT_TRUE(nav.ins);
}

/* A base that sees no satellite with a known orbit, in its newest epoch: the one before it serves. */
static void a_base_epoch_of_unknown_satellites_is_passed_over(void)
{
    with_ins();
    carried_observe(&world, &base, &rover);
    base.n = 2;
    for (int i = 0; i < 2; i++) { base.obs[i].prn = 31; }
    carried_push(&world, &nav, &base, &rover);
    TEST_ASSERT_TRUE(nav.relative);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.05, carried_error_m(&world, &nav));
}

/* ---- factors ------------------------------------------------------------------------------------------------------------------------- */

/* A variance that turned negative is found by the next time update: by the one that keeps the horizon near, or by that of an epoch, to which the
 * last increment is but a part. */
static void lost_factors_end_the_ins_and_gnss_starts_again(void)
{
    for (int i = 0; i < 3; i++) {
        carried_introduce(&world, &nav, &cfg);
        with_ins();
        carried_observe(&world, &base, &rover);
        const pel_time_t t_ns = SKY_T0 + (world.pair.epoch - 1) * PEL_NS_PER_S;
        carried_imu_until(&world, &nav, t_ns + ((i == 0) ? 0 : 100) * PEL_NS_PER_MS);
        pel_navigator_push_base(&nav, &base);
        pel_navigator_push_rover(&nav, &rover);
        nav.ud.D[pel_model_index(&nav.model, PEL_BLOCK_VELOCITY)] = PEL_R(-1.0);
        if (i == 2) { keep_satellites(3); }
        if (i == 2) { memcpy(&nav.rover[0], &rover, sizeof rover); }
        carried_imu_until(&world, &nav, t_ns + 250 * PEL_NS_PER_MS);
        TEST_ASSERT_FALSE(nav.ins);
        TEST_ASSERT_GREATER_OR_EQUAL_UINT32(1, nav.counters.restarts);
        TEST_ASSERT_EQUAL_INT(i != 2, nav.have_state); /* without a single-point solution there is none to start from */
        carried_run(&world, &nav, 4);
        TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
        TEST_ASSERT_LESS_THAN_DOUBLE(0.05, carried_error_m(&world, &nav));
    }
}

/* ---- what is doubted -------------------------------------------------------------------------------------------------------------------- */

/* A tenth of a second of samples that the line lost, or one that struck: bridged, and sigma tells it, now and after the horizon has passed. */
static void a_gap_or_a_jolt_costs_sigma(void)
{
    float now_mps[3], later_mps[3];
    for (int kind = 0; kind < 3; kind++) {
        carried_introduce(&world, &nav, &cfg);
        with_ins();
        const pel_time_t t_ns = nav.last_imu_ns;
        for (int k = 0; k < 30; k++) {
            pel_imu_t imu = carried_imu(&world);
            if (kind == 1 && k >= 5 && k < 15) { continue; }
            if (kind == 2 && k == 5) { imu.upsilon_ib_b[0] += 0.5; } /* 50 m/s^2 for a hundredth */
            pel_navigator_push_imu(&nav, &imu);
        }
        now_mps[kind] = nav.solution.cov_v_ned[0];
        carried_imu_until(&world, &nav, t_ns + 750 * PEL_NS_PER_MS);
        later_mps[kind] = nav.solution.cov_v_ned[0];
        TEST_ASSERT_EQUAL_UINT32(kind == 1, nav.counters.imu_gap);
        TEST_ASSERT_EQUAL_UINT32(0, nav.counters.imu_bad_value + nav.counters.restarts);
    }
    printf("variance of velocity: %.1e, gap %.1e, jolt %.1e (m/s)^2\n", (double)now_mps[0], (double)now_mps[1],
           (double)now_mps[2]);
    for (int kind = 1; kind < 3; kind++) {
        TEST_ASSERT_GREATER_THAN_FLOAT(1.2f * now_mps[0], now_mps[kind]);
        TEST_ASSERT_GREATER_THAN_FLOAT(1.2f * later_mps[0], later_mps[kind]);
    }
}

/* Doubts behind the time that is asked for do not count. */
static void a_doubt_counts_from_its_own_time_on(void)
{
    with_ins();
    carried_imu_until(&world, &nav, nav.last_imu_ns + 100 * PEL_NS_PER_MS);
    pel_imu_t imu = carried_imu(&world);
    imu.upsilon_ib_b[1] -= 0.6;
    pel_navigator_push_imu(&nav, &imu);
    pel_nav_cov_t P_before, P_after;
    pel_strapdown_t at = nav.now;
    at.t_ns = imu.t_ns - CARRIED_IMU_NS;
    pel_nav_predicted_cov(&nav, &at, &P_before);
    at.t_ns = imu.t_ns;
    pel_nav_predicted_cov(&nav, &at, &P_after);
    TEST_ASSERT_GREATER_THAN_DOUBLE(P_before.v[0][0] + 0.25, P_after.v[0][0]); /* 0.6 m/s, once */
    TEST_ASSERT_LESS_THAN_DOUBLE(P_before.v[0][0] + 0.5, P_after.v[0][0]);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.01, P_before.v[0][0]);
}

/* One satellite in common with the base is no double difference: the epoch is that of a receiver alone, and the next is not. */
static void a_base_that_shares_too_little_is_none_for_this_epoch(void)
{
    carried_run(&world, &nav, 5);
    nav.n_base = 0;
    carried_observe(&world, &base, &rover);
    base.n = 2; /* both carriers of one satellite */
    carried_push(&world, &nav, &base, &rover);
    TEST_ASSERT_FALSE(nav.relative);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_SPP, nav.last_fix);
    TEST_ASSERT_EQUAL_FLOAT(-1.0f, nav.epoch_solution.base_age_s);
    carried_step(&world, &nav);
    TEST_ASSERT_TRUE(nav.relative);
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts);
}

static void factors_lost_since_the_last_substep_are_found_by_its_rest(void)
{
    with_ins();
    TEST_ASSERT_EQUAL(PEL_OK, pel_nav_advance(&nav, nav.at_horizon.t_ns + 20 * PEL_NS_PER_MS));
    nav.ud.D[pel_model_index(&nav.model, PEL_BLOCK_POSITION)] = PEL_R(-1.0);
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_nav_advance(&nav, nav.at_horizon.t_ns + 20 * PEL_NS_PER_MS));
}

/* Codes that contradict each other by kilometres: no position can be had from them, and no time. */
static void an_epoch_of_codes_that_contradict_each_other_is_not_used(void)
{
    with_ins();
    carried_observe(&world, &base, &rover);
    for (int i = 0; i < rover.n; i++) { rover.obs[i].P_m += 5000.0 * sin(2.0 * rover.obs[i].prn * rover.obs[i].prn); }
    const uint32_t used = nav.counters.epochs_used, failed = nav.counters.epochs_spp_failed;
    carried_push(&world, &nav, &base, &rover);
    TEST_ASSERT_EQUAL_UINT32(used, nav.counters.epochs_used);
    TEST_ASSERT_EQUAL_UINT32(failed + 1, nav.counters.epochs_spp_failed);
    TEST_ASSERT_TRUE(nav.ins);
    carried_run(&world, &nav, 2);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
}

/* An epoch of satellites that nobody knows, and one of which some lack their code. */
static void a_clock_at_a_known_place_needs_a_code_of_a_known_satellite(void)
{
    with_ins();
    nav.have_spp = false;
    carried_observe(&world, &base, &rover);
    keep_satellites(3);
    pel_epoch_t strange = rover;
    for (int i = 0; i < strange.n; i++) { strange.obs[i].prn = (uint8_t)(31 + i % 2); }
    const uint32_t used = nav.counters.epochs_used;
    carried_push(&world, &nav, &base, &strange);
    TEST_ASSERT_EQUAL_UINT32(used, nav.counters.epochs_used);
    rover.t_ns += 1;
    rover.obs[1].flags &= (uint8_t)~PEL_OBS_CODE;
    rover.obs[rover.n] = strange.obs[0];
    rover.n++;
    pel_navigator_push_rover(&nav, &rover);
    carried_imu_until(&world, &nav, nav.last_imu_ns + 200 * PEL_NS_PER_MS);
    TEST_ASSERT_EQUAL_UINT32(used + 1, nav.counters.epochs_used);
    TEST_ASSERT_TRUE(nav.ins);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(after_a_minute_and_a_half_the_epochs_own_code_draws_the_position);
    RUN_TEST(after_a_longer_silence_it_starts_again);
    RUN_TEST(an_ins_without_epochs_coasts_and_its_bounds_grow);
    RUN_TEST(an_imu_that_goes_leaves_gnss_alone);
    RUN_TEST(an_epoch_before_the_rings_content_drops_the_ins);
    RUN_TEST(gnss_alone_stays_where_it_is_for_no_time);
    RUN_TEST(three_satellites_hold_a_position_that_is_known);
    RUN_TEST(a_receiver_clock_a_minute_old_is_found_again_from_the_place_the_ins_knows);
    RUN_TEST(codes_that_disagree_at_that_place_tell_no_clock);
    RUN_TEST(three_satellites_start_nothing);
    RUN_TEST(phases_without_a_base_are_no_epoch);
    RUN_TEST(a_base_epoch_of_unknown_satellites_is_passed_over);
    RUN_TEST(lost_factors_end_the_ins_and_gnss_starts_again);
    RUN_TEST(a_gap_or_a_jolt_costs_sigma);
    RUN_TEST(a_doubt_counts_from_its_own_time_on);
    RUN_TEST(a_base_that_shares_too_little_is_none_for_this_epoch);
    RUN_TEST(factors_lost_since_the_last_substep_are_found_by_its_rest);
    RUN_TEST(an_epoch_of_codes_that_contradict_each_other_is_not_used);
    RUN_TEST(a_clock_at_a_known_place_needs_a_code_of_a_known_satellite);
    return UNITY_END();
}

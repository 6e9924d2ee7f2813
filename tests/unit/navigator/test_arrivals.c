/* When an epoch is due: what it waits for and what it does not, in which order things may arrive, and what of them is kept. */
/* with: carried pair gnss */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

#define MS PEL_NS_PER_MS

static carried_t world;
static pel_navigator_t nav;
static pel_nav_config_t cfg;
static pel_epoch_t base, rover;

void setUp(void)
{
    carried_init(&world, &nav, 1.0, true);
    cfg = nav.cfg;
}

void tearDown(void) {}

static void push_imu(pel_imu_t imu)
{
    pel_navigator_push_imu(&nav, &imu);
}

static pel_time_t now_of_the_epoch(void)
{
    return SKY_T0 + (world.pair.epoch - 1) * PEL_NS_PER_S;
}

/* ---- waiting for the IMU and for the base ------------------------------------------------------------------------------------ */

/* Milliseconds of increments behind the epoch until it was used. */
static int used_after_ms(void)
{
    carried_run(&world, &nav, 2);
    carried_observe(&world, &base, &rover);
    carried_imu_until(&world, &nav, now_of_the_epoch());
    pel_navigator_push_base(&nav, &base);
    pel_navigator_push_rover(&nav, &rover);
    const uint32_t before = nav.counters.epochs_used;
    for (int ms = 10; ms <= 500; ms += 10) {
        push_imu(carried_imu(&world));
        if (nav.counters.epochs_used > before) { return ms; }
    }
    return -1;
}

static void an_epoch_waits_for_the_imu_as_long_as_was_asked_for(void)
{
    cfg.slice_nodes = 0;
    carried_introduce(&world, &nav, &cfg);
    TEST_ASSERT_INT_WITHIN(10, 110, used_after_ms());
    cfg.apply_delay_s = 0.0f;
    carried_introduce(&world, &nav, &cfg);
    TEST_ASSERT_INT_WITHIN(10, 30, used_after_ms()); /* but for what receiver clocks may be off by */
    cfg.apply_delay_s = 0.25f;
    carried_introduce(&world, &nav, &cfg);
    TEST_ASSERT_INT_WITHIN(10, 260, used_after_ms());
}

/* GNSS alone: at each push, how many epochs have been used. */
static void rovers_alone(int n, const int used[])
{
    for (int i = 0; i < n; i++) {
        carried_observe(&world, &base, &rover);
        pel_navigator_push_rover(&nav, &rover);
        TEST_ASSERT_EQUAL_UINT32(used[i], nav.counters.epochs_used);
    }
}

static void a_base_that_never_comes_is_waited_for_once(void)
{
    static const int USED[] = {0, 1, 2, 3}; /* the first waits for the second; one a push */
    rovers_alone(4, USED);
    while (pel_navigator_flush(&nav)) {}
    TEST_ASSERT_EQUAL_UINT32(4, nav.counters.epochs_used);
    TEST_ASSERT_EQUAL_INT(PEL_WHY_NO_DATA, nav.used.base_why);
}

static void nor_is_one_whose_place_nobody_tells(void)
{
    nav.have_station = false;
    for (int i = 0; i < 4; i++) {
        carried_observe(&world, &base, &rover);
        pel_navigator_push_base(&nav, &base);
        pel_navigator_push_rover(&nav, &rover);
    }
    while (pel_navigator_flush(&nav)) {}
    TEST_ASSERT_EQUAL_UINT32(4, nav.counters.epochs_used);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_SPP, nav.last_fix);
    TEST_ASSERT_EQUAL_INT(PEL_WHY_NO_STATION, nav.used.base_why);
}

static void a_slower_base_is_not_waited_for_between_its_epochs(void)
{
    uint32_t at_once = 0;
    for (int i = 0; i < 14; i++) {
        carried_observe(&world, &base, &rover);
        if (i % 5 == 0) { pel_navigator_push_base(&nav, &base); }
        const uint32_t before = nav.counters.epochs_used;
        pel_navigator_push_rover(&nav, &rover);
        at_once += (i > 5 && i % 5 != 0 && nav.counters.epochs_used == before + 1 && nav.n_rover == 0);
    }
    TEST_ASSERT_EQUAL_UINT32(7, at_once); /* 6 to 9 and 11 to 13 */
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 3.0f, nav.epoch_solution.base_age_s);
}

static void a_base_epoch_on_its_way_is_waited_for_until_it_is_late(void)
{
    cfg.slice_nodes = 0;
    carried_introduce(&world, &nav, &cfg);
    carried_run(&world, &nav, 3);
    carried_observe(&world, &base, &rover);
    carried_imu_until(&world, &nav, now_of_the_epoch() + 200 * MS);
    const uint32_t before = nav.counters.epochs_used;
    pel_navigator_push_rover(&nav, &rover);
    TEST_ASSERT_EQUAL_UINT32(before, nav.counters.epochs_used);
    carried_imu_until(&world, &nav, now_of_the_epoch() + 290 * MS);
    TEST_ASSERT_EQUAL_UINT32(before, nav.counters.epochs_used);
    carried_imu_until(&world, &nav, now_of_the_epoch() + 310 * MS);
    TEST_ASSERT_EQUAL_UINT32(before + 1, nav.counters.epochs_used);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 1.0f, nav.epoch_solution.base_age_s);
}

/* ---- searches between increments ------------------------------------------------------------------------------------------------ */

static void without_slices_an_epoch_is_done_in_its_push(void)
{
    cfg.slice_nodes = 0;
    carried_introduce(&world, &nav, &cfg);
    for (int i = 0; i < 5; i++) {
        carried_observe(&world, &base, &rover);
        carried_imu_until(&world, &nav, now_of_the_epoch());
        pel_navigator_push_base(&nav, &base);
        pel_navigator_push_rover(&nav, &rover);
        for (int k = 0; k < 20; k++) {
            push_imu(carried_imu(&world));
            TEST_ASSERT_EQUAL_INT(PEL_NAV_SEARCH_NONE, nav.search);
        }
        TEST_ASSERT_EQUAL_INT(0, nav.n_rover);
    }
    TEST_ASSERT_TRUE(nav.ins);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
}

/* A thousand samples a second fill the ring in a quarter of one: a search that takes its time is ended before it runs over its epoch. */
static void a_search_ends_before_the_ring_runs_over_its_epoch(void)
{
    cfg.slice_nodes = 1;
    cfg.apply_delay_s = 0.17f; /* most of the ring waits already */
    carried_introduce(&world, &nav, &cfg);
    int longest = 0, slices = 0;
    for (int i = 0; i < 4; i++) {
        carried_observe(&world, &base, &rover);
        pel_navigator_push_base(&nav, &base);
        for (int k = 0; k < 100; k++) {
            pel_imu_t whole = carried_imu(&world), part;
            if (k == 2) { pel_navigator_push_rover(&nav, &rover); } /* of the second that begins */
            for (int j = 9; j >= 0; j--) {
                part = whole;
                if (j > 0) { TEST_ASSERT_EQUAL(PEL_OK, pel_imu_split(&whole, whole.t_ns - j * MS, &part, &whole)); }
                part.seq = (uint16_t)(10 * whole.seq - j);
                push_imu(part);
                if (nav.search == PEL_NAV_SEARCH_NONE) { continue; }
                slices++;
                const int waiting = nav.ring.n - pel_imu_ring_after(&nav.ring, nav.at_horizon.t_ns);
                longest = (waiting > longest) ? waiting : longest;
            }
        }
    }
    TEST_ASSERT_TRUE(nav.ins);
    TEST_ASSERT_GREATER_THAN_INT(20, slices);
    TEST_ASSERT_INT_WITHIN(2, PEL_IMU_RING * 3 / 4, longest);
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts + nav.counters.numeric_faults);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
}

/* ---- what is kept --------------------------------------------------------------------------------------------------------------- */

static void signals_and_orbits_that_are_not_wanted_are_left_out(void)
{
    cfg.systems = 1u << PEL_SYS_GPS;
    cfg.carriers = 1u << PEL_CARRIER_L1;
    pel_navigator_init(&nav, &cfg);
    static const struct {
        uint8_t sys, carrier;
    } signals[] = {{PEL_SYS_GPS, PEL_CARRIER_L1}, {PEL_SYS_GAL, PEL_CARRIER_L1}, {PEL_SYS_GPS, PEL_CARRIER_L2},
                   {PEL_N_SYS, PEL_CARRIER_L1},   {PEL_SYS_GPS, PEL_N_CARRIER},  {255, 255}};
    memset(&rover, 0, sizeof rover);
    rover.t_ns = SKY_T0;
    for (int i = 0; i < 6; i++) {
        rover.obs[rover.n++] = (pel_obs_t){.sys = signals[i].sys, .carrier = signals[i].carrier, .prn = 1};
    }
    pel_navigator_push_rover(&nav, &rover);
    TEST_ASSERT_EQUAL_INT(1, nav.n_rover);
    TEST_ASSERT_EQUAL_INT(1, nav.rover[0].n);
    pel_navigator_push_base(&nav, &rover);
    TEST_ASSERT_EQUAL_INT(1, nav.base[0].n);

    rover.t_ns += PEL_NS_PER_S;
    memmove(&rover.obs[0], &rover.obs[1], sizeof rover.obs[0] * 5);
    rover.n = 5;
    pel_navigator_push_base(&nav, &rover); /* of nothing that is wanted */
    TEST_ASSERT_EQUAL_INT(1, nav.n_base);

    pel_ephemeris_t eph = world.pair.orbits.eph[0];
    eph.sys = PEL_SYS_GAL;
    pel_navigator_push_ephemeris(&nav, &eph);
    eph.sys = PEL_N_SYS;
    pel_navigator_push_ephemeris(&nav, &eph);
    TEST_ASSERT_EQUAL_INT(0, nav.orbits.n);
    eph.sys = PEL_SYS_GPS;
    pel_navigator_push_ephemeris(&nav, &eph);
    TEST_ASSERT_EQUAL_INT(1, nav.orbits.n);
}

static void an_epoch_that_says_it_is_longer_than_it_can_be_is_cut(void)
{
    static pel_epoch_t e;
    e.t_ns = SKY_T0;
    e.n = UINT16_MAX;
    for (int i = 0; i < PEL_MAX_OBS; i++) { e.obs[i].sys = PEL_N_SYS; }
    pel_navigator_push_base(&nav, &e);
    TEST_ASSERT_EQUAL_INT(0, nav.n_base); /* nothing in it is wanted */
    for (int i = 0; i < PEL_MAX_OBS; i++) { e.obs[i].sys = PEL_SYS_GPS; }
    pel_navigator_push_base(&nav, &e);
    TEST_ASSERT_EQUAL_INT(1, nav.n_base);
    TEST_ASSERT_EQUAL_INT(PEL_MAX_OBS, nav.base[0].n);
    pel_navigator_push_rover(&nav, &e);
    TEST_ASSERT_EQUAL_INT(PEL_MAX_OBS, nav.rover[0].n);
}

static void the_oldest_of_a_full_queue_is_used_at_once(void)
{
    carried_observe(&world, &base, &rover);
    push_imu(carried_imu(&world));
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL_UINT32(0, nav.counters.epochs_used);
        pel_navigator_push_rover(&nav, &rover);
        rover.t_ns += 100 * MS;
    }
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.epochs_used);
    TEST_ASSERT_EQUAL_INT(PEL_ROVER_QUEUE, nav.n_rover);
}

static void slips_of_base_epochs_that_no_rover_epoch_used_are_not_lost(void)
{
    carried_run(&world, &nav, 3);
    static pel_epoch_t later;
    carried_observe(&world, &base, &rover);
    base.obs[2].flags |= PEL_OBS_SLIP;
    pel_navigator_push_base(&nav, &base);
    carried_observe(&world, &later, &rover);
    pel_navigator_push_base(&nav, &later);
    const pel_epoch_t *kept = &nav.base[nav.n_base - 1];
    for (int i = 0; i < kept->n; i++) {
        const bool same = kept->obs[i].prn == base.obs[2].prn && kept->obs[i].carrier == base.obs[2].carrier;
        TEST_ASSERT_EQUAL_INT(same, (kept->obs[i].flags & PEL_OBS_SLIP) != 0);
    }
}

/* ---- places and times ------------------------------------------------------------------------------------------------------------ */

static void another_base_has_other_integers(void)
{
    carried_run(&world, &nav, 5);
    TEST_ASSERT_GREATER_THAN_INT(4, nav.track.n);
    pel_station_t s = nav.station;
    s.r_ea_e[0] += 0.02; /* a rounding of the same */
    pel_navigator_push_station(&nav, &s);
    TEST_ASSERT_GREATER_THAN_INT(4, nav.track.n);
    TEST_ASSERT_EQUAL_DOUBLE(s.r_ea_e[0], nav.station.r_ea_e[0]);
    s.r_ea_e[1] += 0.2;
    pel_navigator_push_station(&nav, &s);
    TEST_ASSERT_EQUAL_INT(0, nav.track.n);
    TEST_ASSERT_EQUAL_DOUBLE(s.r_ea_e[1], nav.station.r_ea_e[1]);
    const pel_station_t before = nav.station;
    for (int k = 0; k < 3; k++) { s.r_ea_e[k] *= 1.2; } /* beyond any antenna */
    pel_navigator_push_station(&nav, &s);
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.station, sizeof before);
}

/* One rover epoch of the future shuts out what follows, until that has come ten times. */
static void a_rover_whose_time_began_anew_starts_again(void)
{
    for (int searching = 0; searching < 2; searching++) {
        cfg.slice_nodes = searching ? 1 : 200;
        carried_introduce(&world, &nav, &cfg);
        carried_run(&world, &nav, 4);
        TEST_ASSERT_TRUE(nav.ins);
        nav.last_tag_ns += 3600 * PEL_NS_PER_S; /* as if one had been used */
        const uint32_t restarts = nav.counters.restarts;
        for (int i = 0; i < 9; i++) { carried_step(&world, &nav); }
        TEST_ASSERT_EQUAL_UINT32(9, nav.counters.epochs_late);
        TEST_ASSERT_EQUAL_UINT32(restarts, nav.counters.restarts);
        carried_step(&world, &nav);
        TEST_ASSERT_EQUAL_UINT32(restarts + 1, nav.counters.restarts);
        TEST_ASSERT_FALSE(nav.have_state || nav.ins);
        carried_run(&world, &nav, 3);
        TEST_ASSERT_TRUE(nav.have_state);
        TEST_ASSERT_LESS_THAN_DOUBLE(10.0, carried_error_m(&world, &nav));
    }
}

/* Later than the horizon has waited: it cannot be used any more; a little late it is used at its own time. */
static void an_epoch_later_than_the_horizon_waits_is_refused(void)
{
    cfg.slice_nodes = 0;
    carried_introduce(&world, &nav, &cfg);
    carried_run(&world, &nav, 4);
    for (int i = 0; i < 2; i++) {
        carried_observe(&world, &base, &rover);
        carried_imu_until(&world, &nav, now_of_the_epoch() + ((i == 0) ? 400 : 900) * MS);
        const uint32_t used = nav.counters.epochs_used, late = nav.counters.epochs_late;
        pel_navigator_push_base(&nav, &base);
        pel_navigator_push_rover(&nav, &rover);
        TEST_ASSERT_EQUAL_UINT32(used + (i == 0), nav.counters.epochs_used);
        TEST_ASSERT_EQUAL_UINT32(late + (i == 1), nav.counters.epochs_late);
        TEST_ASSERT_TRUE(nav.ins);
    }
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_epoch_waits_for_the_imu_as_long_as_was_asked_for);
    RUN_TEST(a_base_that_never_comes_is_waited_for_once);
    RUN_TEST(nor_is_one_whose_place_nobody_tells);
    RUN_TEST(a_slower_base_is_not_waited_for_between_its_epochs);
    RUN_TEST(a_base_epoch_on_its_way_is_waited_for_until_it_is_late);
    RUN_TEST(without_slices_an_epoch_is_done_in_its_push);
    RUN_TEST(a_search_ends_before_the_ring_runs_over_its_epoch);
    RUN_TEST(signals_and_orbits_that_are_not_wanted_are_left_out);
    RUN_TEST(an_epoch_that_says_it_is_longer_than_it_can_be_is_cut);
    RUN_TEST(the_oldest_of_a_full_queue_is_used_at_once);
    RUN_TEST(slips_of_base_epochs_that_no_rover_epoch_used_are_not_lost);
    RUN_TEST(another_base_has_other_integers);
    RUN_TEST(a_rover_whose_time_began_anew_starts_again);
    RUN_TEST(an_epoch_later_than_the_horizon_waits_is_refused);
    return UNITY_END();
}

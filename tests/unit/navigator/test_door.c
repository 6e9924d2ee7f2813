/* What arrives broken, late or twice is counted and changes nothing. */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "pelorus/math.h"
#include "pelorus/navigator.h"
#include "unity.h"

#define T0 (INT64_C(1300000000) * PEL_NS_PER_S)

static pel_navigator_t nav, before;

static pel_imu_t still(pel_time_t t_ns)
{
    return (pel_imu_t){.t_ns = t_ns, .dt_s = 0.01, .upsilon_ib_b = {0.0, 0.0, 0.098}};
}

void setUp(void)
{
    pel_nav_config_t cfg;
    pel_nav_config_default(&cfg);
    pel_navigator_init(&nav, &cfg);
    for (int i = 1; i <= 20; i++) {
        const pel_imu_t imu = still(T0 + i * 10 * PEL_NS_PER_MS);
        pel_navigator_push_imu(&nav, &imu);
    }
    before = nav;
}

void tearDown(void) {}

static void all_but_the_counters_are_as_before(void)
{
    pel_navigator_t now = nav;
    now.counters = before.counters;
    now.late_rover = now.late_base = now.late_imu = 0;
    TEST_ASSERT_EQUAL_MEMORY(&before, &now, sizeof now);
}

static void refused(pel_imu_t imu)
{
    pel_navigator_push_imu(&nav, &imu);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_bad_value);
    all_but_the_counters_are_as_before();
}

static void nan_increments_never_enter(void)
{
    pel_imu_t imu = still(T0 + PEL_NS_PER_S);
    imu.alpha_ib_b[1] = NAN;
    refused(imu);
}

static void infinite_specific_force_never_enters(void)
{
    pel_imu_t imu = still(T0 + PEL_NS_PER_S);
    imu.upsilon_ib_b[2] = INFINITY;
    refused(imu);
}

static void an_interval_of_no_length_never_enters(void)
{
    pel_imu_t imu = still(T0 + PEL_NS_PER_S);
    imu.dt_s = 0.0;
    refused(imu);
}

static void a_sample_from_the_past_is_counted(void)
{
    const pel_imu_t imu = still(T0 + 100 * PEL_NS_PER_MS);
    pel_navigator_push_imu(&nav, &imu);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_out_of_order);
    all_but_the_counters_are_as_before();
}

static void a_lost_sample_is_bridged_and_counted(void)
{
    const pel_imu_t imu = still(T0 + 220 * PEL_NS_PER_MS);
    pel_navigator_push_imu(&nav, &imu);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_gap);
    const pel_imu_t *newest = pel_imu_ring_newest(&nav.ring);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.02, newest->dt_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.196, newest->upsilon_ib_b[2]);
}

static void a_long_gap_starts_alignment_again(void)
{
    const pel_imu_t imu = still(T0 + 5 * PEL_NS_PER_S);
    pel_navigator_push_imu(&nav, &imu);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_gap);
    TEST_ASSERT_EQUAL_INT(1, nav.ring.n);
}

static void a_base_that_does_not_know_its_place_is_no_base(void)
{
    const pel_station_t nowhere = {.id = 1, .r_ea_e = {0.0, 0.0, 0.0}};
    const pel_station_t broken = {.id = 1, .r_ea_e = {NAN, 6.4e6, 0.0}};
    pel_navigator_push_station(&nav, &nowhere);
    pel_navigator_push_station(&nav, &broken);
    TEST_ASSERT_FALSE(nav.have_station);
}

static void base_epochs_go_forward_only(void)
{
    static pel_epoch_t e;
    e.t_ns = T0 + PEL_NS_PER_S;
    pel_navigator_push_base(&nav, &e);
    e.t_ns = T0;
    pel_navigator_push_base(&nav, &e);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.epochs_late);
    TEST_ASSERT_EQUAL_INT(1, nav.n_base);
}

static void one_base_epoch_from_the_future_does_not_shut_out_all_others(void)
{
    static pel_epoch_t e;
    e.t_ns = T0 + 3600 * PEL_NS_PER_S;
    pel_navigator_push_base(&nav, &e);
    for (int i = 0; i < 20; i++) {
        e.t_ns = T0 + i * PEL_NS_PER_S;
        pel_navigator_push_base(&nav, &e);
    }
    TEST_ASSERT_EQUAL_INT64(e.t_ns, nav.base[nav.n_base - 1].t_ns);
}

static void nor_does_one_increment(void)
{
    pel_imu_t imu = still(T0 + 3600 * PEL_NS_PER_S);
    pel_navigator_push_imu(&nav, &imu);
    for (int i = 0; i < 300; i++) {
        imu = still(T0 + PEL_NS_PER_S + i * 10 * PEL_NS_PER_MS);
        pel_navigator_push_imu(&nav, &imu);
    }
    TEST_ASSERT_EQUAL_INT64(imu.t_ns, nav.last_imu_ns);
}

static void rover_epochs_out_of_order_are_put_in_order(void)
{
    static pel_epoch_t e;
    e.t_ns = T0 + 300 * PEL_NS_PER_MS;
    pel_navigator_push_rover(&nav, &e);
    e.t_ns = T0 + 200 * PEL_NS_PER_MS;
    pel_navigator_push_rover(&nav, &e);
    TEST_ASSERT_EQUAL_INT(2, nav.n_rover);
    TEST_ASSERT_TRUE(nav.rover[0].t_ns < nav.rover[1].t_ns);
    pel_navigator_push_rover(&nav, &e); /* and a duplicate is one epoch */
    TEST_ASSERT_EQUAL_INT(2, nav.n_rover);
}

static void an_epoch_without_orbits_gives_no_solution(void)
{
    static pel_epoch_t e;
    e.t_ns = T0 + 100 * PEL_NS_PER_MS;
    e.n = 1;
    e.obs[0] = (pel_obs_t){.P_m = 2.2e7, .sys = PEL_SYS_GPS, .prn = 5, .flags = PEL_OBS_CODE};
    pel_navigator_push_rover(&nav, &e);
    while (pel_navigator_flush(&nav)) {}
    TEST_ASSERT_EQUAL_INT(PEL_NAV_NONE, pel_navigator_poll(&nav));
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.epochs_spp_failed);
}

static void samples_that_overlap_are_shortened_and_counted(void)
{
    const pel_imu_t imu = still(T0 + 204 * PEL_NS_PER_MS); /* ten milliseconds long, four behind the last */
    pel_navigator_push_imu(&nav, &imu);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.imu_gap);
    const pel_imu_t *newest = pel_imu_ring_newest(&nav.ring);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.004, newest->dt_s);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0392, newest->upsilon_ib_b[2]);
    TEST_ASSERT_EQUAL_UINT16(0, newest->flags); /* nothing was missing */
}

static void a_time_or_a_length_that_cannot_be_never_enters(void)
{
    pel_imu_t imu = still(T0 + PEL_NS_PER_S);
    imu.dt_s = 1.0001;
    refused(imu);
    nav = before;
    imu = still(0);
    refused(imu);
    nav = before;
    imu = still(-T0);
    refused(imu);
}

static void heights_that_cannot_be_never_enter(void)
{
    static const struct {
        pel_time_t t_ns;
        double height_m;
        float sd_m;
        bool good;
    } of[] = {{0, 50.0, 0.1f, false},  {T0, 1e5, 0.1f, false},  {T0, -1e5, 0.1f, false}, {T0, NAN, 0.1f, false},
              {T0, 50.0, 0.0f, false}, {T0, 50.0, 1e4f, false}, {T0, 50.0, NAN, false},  {T0, 50.0, 0.1f, true}};
    uint32_t refused_so_far = 0;
    for (int i = 0; i < 8; i++) {
        const pel_baro_t baro = {.t_ns = of[i].t_ns, .height_m = of[i].height_m, .sd_m = of[i].sd_m};
        pel_navigator_push_baro(&nav, &baro);
        refused_so_far += !of[i].good;
        TEST_ASSERT_EQUAL_UINT32(refused_so_far, nav.counters.imu_bad_value);
    }
}

/* Kept until the IMU has passed it; of the carrier that the configuration tells, cycles become those of B1I and a float. */
static void phases_of_another_carrier_on_b1i_keep_their_metres(void)
{
    static const struct {
        uint8_t sys, carrier;
        bool other;
    } of[] = {{PEL_SYS_BDS, PEL_CARRIER_B1I, true},
              {PEL_SYS_BDS, PEL_CARRIER_B3I, false},
              {PEL_SYS_GPS, PEL_CARRIER_L1, false}};
    static pel_epoch_t epoch;
    nav.cfg.rdss_hz = 2491.75e6;
    nav.cfg.systems = nav.cfg.carriers = 0xFF;
    pel_nav_seal_config(&nav);
    epoch = (pel_epoch_t){.t_ns = T0 + PEL_NS_PER_S, .n = 3};
    for (int i = 0; i < 3; i++) {
        epoch.obs[i] = (pel_obs_t){.sys = of[i].sys, .carrier = of[i].carrier, .prn = 3, .L_cyc = 3e8, .D_hz = 100.0f};
    }
    pel_navigator_push_rover(&nav, &epoch);
    TEST_ASSERT_EQUAL_INT(1, nav.n_rover);
    for (int i = 0; i < 3; i++) {
        const pel_obs_t *o = &nav.rover[0].obs[i];
        const double f = of[i].other ? 2491.75e6 : pel_carrier_hz(of[i].sys, of[i].carrier, 0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 3e8 * PEL_SPEED_OF_LIGHT / f, o->L_cyc * pel_obs_lambda_m(o));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 100.0 * PEL_SPEED_OF_LIGHT / f, (double)o->D_hz * pel_obs_lambda_m(o));
        TEST_ASSERT_EQUAL_INT(of[i].other, (o->flags & PEL_OBS_HALF_CYCLE) != 0);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nan_increments_never_enter);
    RUN_TEST(infinite_specific_force_never_enters);
    RUN_TEST(an_interval_of_no_length_never_enters);
    RUN_TEST(a_sample_from_the_past_is_counted);
    RUN_TEST(a_lost_sample_is_bridged_and_counted);
    RUN_TEST(a_long_gap_starts_alignment_again);
    RUN_TEST(a_base_that_does_not_know_its_place_is_no_base);
    RUN_TEST(base_epochs_go_forward_only);
    RUN_TEST(one_base_epoch_from_the_future_does_not_shut_out_all_others);
    RUN_TEST(nor_does_one_increment);
    RUN_TEST(rover_epochs_out_of_order_are_put_in_order);
    RUN_TEST(an_epoch_without_orbits_gives_no_solution);
    RUN_TEST(samples_that_overlap_are_shortened_and_counted);
    RUN_TEST(a_time_or_a_length_that_cannot_be_never_enters);
    RUN_TEST(heights_that_cannot_be_never_enter);
    RUN_TEST(phases_of_another_carrier_on_b1i_keep_their_metres);
    return UNITY_END();
}

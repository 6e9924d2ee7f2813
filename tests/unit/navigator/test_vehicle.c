/* What is known without a satellite: a place to start from, standing, heights. */
/* with: carried pair gnss */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "pelorus/earth.h"
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
    cfg.preset = PEL_PRESET_INS_TDCP;
    world.sway_m = 3.0;
    world.sway_radps = 0.6;
    world.begin_s = 10.0;
}

void tearDown(void) {}

/* The first n satellites alone; 0: all. */
static void step(int n_satellites)
{
    carried_observe(&world, &base, &rover);
    int kept = 0, satellites = 0;
    for (int i = 0; i < rover.n; i++) {
        satellites += (i == 0 || rover.obs[i].prn != rover.obs[i - 1].prn);
        if (n_satellites == 0 || satellites <= n_satellites) { rover.obs[kept++] = rover.obs[i]; }
    }
    rover.n = (uint16_t)kept;
    carried_push(&world, &nav, NULL, &rover);
}

static void run(int seconds, int n_satellites)
{
    for (int i = 0; i < seconds; i++) { step(n_satellites); }
}

static void tell_place(void)
{
    cfg.vehicle.place_known = true;
    pel_earth_ecef_to_llh(world.start_e, &cfg.vehicle.lat_rad, &cfg.vehicle.lon_rad, &cfg.vehicle.height_m);
}

static double height_of(const double r_e[3])
{
    double lat, lon, h;
    pel_earth_ecef_to_llh(r_e, &lat, &lon, &h);
    return h;
}

static void three_satellites_are_enough_from_a_known_place(void)
{
    carried_introduce(&world, &nav, &cfg);
    run(12, 3);
    TEST_ASSERT_FALSE(nav.have_state); /* nobody knows where it is */

    tell_place();
    cfg.observe = PEL_OBS_PHASE;
    cfg.vehicle.standing_s = 9.0;
    cfg.vehicle.height = PEL_HEIGHT_CONSTANT;
    cfg.vehicle.sd_height_m = 0.05;
    carried_introduce(&world, &nav, &cfg);
    run(9, 3);
    TEST_ASSERT_TRUE(nav.ins && !nav.have_spp);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.02, carried_error_m(&world, &nav));
    TEST_ASSERT_LESS_THAN_DOUBLE(0.006, sqrt((double)pel_ud_cov(&nav.ud, 12, 12)));
    run(40, 3);
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.restarts);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.5, carried_error_m(&world, &nav));
}

static void the_clock_is_found_from_codes_at_the_place(void)
{
    tell_place();
    world.pair.rover.clk_m = 60000.0; /* 0.2 ms */
    carried_introduce(&world, &nav, &cfg);
    run(3, 2);
    const double clk_m = 1e-9 * (double)(rover.t_ns - nav.at_horizon.t_ns) * PEL_SPEED_OF_LIGHT;
    TEST_ASSERT_DOUBLE_WITHIN(10.0, 60000.0, clk_m);
}

static void a_barometer_that_is_off_is_found_out_and_each_sample_counts_once(void)
{
    cfg.vehicle.height = PEL_HEIGHT_BARO;
    cfg.vehicle.sd_height_m = 5.0;
    cfg.vehicle.tau_height_s = 1000.0;
    world.pair.code_sd_m = 0.01;
    cfg.noise_single.code_a_m = cfg.noise_single.code_b_m = 0.05;
    cfg.noise.code_a_m = cfg.noise.code_b_m = 0.05;
    carried_introduce(&world, &nav, &cfg);
    for (int second = 0; second < 30; second++) {
        const pel_time_t t_ns = SKY_T0 + second * PEL_NS_PER_S;
        const pel_baro_t baro = {.t_ns = t_ns, .height_m = height_of(world.start_e) + 3.0, .sd_m = 0.1f};
        pel_navigator_push_baro(&nav, &baro);
        step(0);
    }
    TEST_ASSERT_TRUE(nav.ins);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, -3.0, nav.vehicle.deviation_m); /* truth less what it says */
    TEST_ASSERT_FALSE(nav.vehicle.baro_waits);
    const uint32_t rows = nav.counters.rows_used;
    step(0);
    TEST_ASSERT_EQUAL_UINT32(rows + (uint32_t)nav.update.used, nav.counters.rows_used);
}

static void absurd_heights_are_refused_and_counted(void)
{
    static const pel_baro_t BAD[] = {{.t_ns = SKY_T0, .height_m = NAN, .sd_m = 1.0f},
                                     {.t_ns = SKY_T0, .height_m = 1e6, .sd_m = 1.0f},
                                     {.t_ns = SKY_T0, .height_m = 10.0, .sd_m = 0.0f},
                                     {.t_ns = SKY_T0, .height_m = 10.0, .sd_m = NAN},
                                     {.t_ns = -1, .height_m = 10.0, .sd_m = 1.0f}};
    carried_introduce(&world, &nav, &cfg);
    for (uint32_t i = 0; i < 5; i++) {
        pel_navigator_push_baro(&nav, &BAD[i]);
        TEST_ASSERT_EQUAL_UINT32(i + 1, nav.counters.imu_bad_value);
        TEST_ASSERT_FALSE(nav.vehicle.baro_waits);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(three_satellites_are_enough_from_a_known_place);
    RUN_TEST(the_clock_is_found_from_codes_at_the_place);
    RUN_TEST(a_barometer_that_is_off_is_found_out_and_each_sample_counts_once);
    RUN_TEST(absurd_heights_are_refused_and_counted);
    return UNITY_END();
}

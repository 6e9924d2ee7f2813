/* A vehicle on wheels: which way it points is learnt, and then it does not slide; where it stands it stays, until it sets off. */
/* with: carried pair gnss */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

#define HEADING 1.0

static carried_t world;
static pel_navigator_t nav;
static pel_nav_config_t cfg;

void setUp(void)
{
    carried_init(&world, &nav, HEADING, true);
    cfg = nav.cfg;
    cfg.wheels = true;
}

void tearDown(void) {}

static void begin(double speed_mps)
{
    world.speed_mps = speed_mps;
    carried_introduce(&world, &nav, &cfg);
}

static void without_epochs(int seconds)
{
    for (int i = 0; i < seconds; i++) {
        static pel_epoch_t base, rover;
        carried_observe(&world, &base, &rover);
        carried_push(&world, &nav, NULL, NULL);
    }
}

static double sd_along(double x, double y)
{
    const int i_v = pel_model_index(&nav.model, PEL_BLOCK_VELOCITY);
    double P[3][3], a_e[3];
    const double a_b[3] = {x, y, 0.0};
    pel_ud_block3(&nav.ud, i_v, i_v, P);
    pel_mat3_vec(nav.at_horizon.C_b_e, a_b, a_e);
    return sqrt(pel_nav_along(P, a_e));
}

static void the_direction_is_that_of_the_velocity_on_the_body(void)
{
    for (double off = -0.4; off < 0.5; off += 0.4) {
        setUp();
        carried_course(&world, HEADING + off);
        begin(12.0);
        carried_run(&world, &nav, 25);
        TEST_ASSERT_TRUE(nav.ins && nav.wheels.direction_s >= 10.0f);
        TEST_ASSERT_DOUBLE_WITHIN(0.03, sin(off), (double)nav.wheels.d_b[0]);
        TEST_ASSERT_DOUBLE_WITHIN(0.03, cos(off), (double)nav.wheels.d_b[1]);
        TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.0, (double)nav.wheels.d_b[2]);
    }
}

static void too_slow_to_tell_it_tells_nothing(void)
{
    begin(3.0);
    carried_run(&world, &nav, 25);
    TEST_ASSERT_TRUE(nav.ins);
    TEST_ASSERT_EQUAL_FLOAT(0.0f, nav.wheels.direction_s);
}

static void beside_epochs_it_is_as_if_there_were_none(void)
{
    begin(12.0);
    carried_run(&world, &nav, 25);
    const pel_strapdown_t with = nav.at_horizon;
    setUp();
    cfg.wheels = false;
    begin(12.0);
    carried_run(&world, &nav, 25);
    TEST_ASSERT_EQUAL_MEMORY(&with, &nav.at_horizon, sizeof with);
}

static void without_epochs_it_does_not_slide(void)
{
    double across[2], along[2];
    for (int wheels = 0; wheels < 2; wheels++) {
        setUp();
        cfg.wheels = wheels == 1;
        begin(12.0);
        carried_run(&world, &nav, 25);
        without_epochs(40);
        TEST_ASSERT_TRUE(nav.ins);
        across[wheels] = sd_along(1.0, 0.0);
        along[wheels] = sd_along(0.0, 1.0);
    }
    TEST_ASSERT_TRUE(across[1] < 0.5 * across[0]);
    TEST_ASSERT_TRUE(along[1] > 0.8 * along[0]); /* of how fast, rolling says nothing */
}

static void where_it_stands_it_stays(void)
{
    begin(0.0);
    carried_run(&world, &nav, 12);
    without_epochs(30);
    TEST_ASSERT_TRUE(nav.ins && nav.wheels.quiet);
    TEST_ASSERT_TRUE(sd_along(1.0, 0.0) < 0.05 && sd_along(0.0, 1.0) < 0.05);
    TEST_ASSERT_TRUE(pel_norm3(nav.at_horizon.v_eb_e) < 0.05);
    TEST_ASSERT_TRUE(carried_error_m(&world, &nav) < 0.5);
}

static void setting_off_without_epochs_is_seen(void)
{
    world.begin_s = 28.0;
    world.sway_m = 20.0;
    world.sway_radps = 0.3; /* 1.8 m/s^2 at first */
    begin(0.0);
    carried_run(&world, &nav, 12);
    without_epochs(15);
    TEST_ASSERT_TRUE(nav.wheels.quiet);
    without_epochs(6);
    TEST_ASSERT_FALSE(nav.wheels.quiet);
    const double t_s = pel_time_diff_s(nav.at_horizon.t_ns, SKY_T0) - world.begin_s;
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 6.0 * sin(0.3 * t_s), pel_norm3(nav.at_horizon.v_eb_e));
}

static void a_direction_that_memory_lost_is_learnt_anew(void)
{
    begin(12.0);
    carried_run(&world, &nav, 25);
    nav.wheels.d_b[1] = NAN;
    without_epochs(5);
    TEST_ASSERT_TRUE(isfinite(nav.at_horizon.v_eb_e[0]));
    carried_run(&world, &nav, 3);
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 1.0, (double)nav.wheels.d_b[1]);
    TEST_ASSERT_TRUE(nav.wheels.direction_s < 10.0f);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_direction_is_that_of_the_velocity_on_the_body);
    RUN_TEST(too_slow_to_tell_it_tells_nothing);
    RUN_TEST(beside_epochs_it_is_as_if_there_were_none);
    RUN_TEST(without_epochs_it_does_not_slide);
    RUN_TEST(where_it_stands_it_stays);
    RUN_TEST(setting_off_without_epochs_is_seen);
    RUN_TEST(a_direction_that_memory_lost_is_learnt_anew);
    return UNITY_END();
}

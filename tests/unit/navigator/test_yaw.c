/* Heading of an IMU mounted anyhow, from velocity changes: found when there are some, and not before. */
/* with: carried pair gnss */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

#define HEADING 0.7
#define COURSE  2.4 /* the IMU looks another way */

static carried_t world;
static pel_navigator_t nav;
static pel_epoch_t base, rover;

/* It stands for three seconds, so that gravity shows the vertical, then it sways along its course. */
static void swaying(void)
{
    carried_init(&world, &nav, HEADING, false);
    carried_course(&world, COURSE);
    world.begin_s = 3.0;
    world.sway_m = 6.0;
    world.sway_radps = 0.5;
}

void setUp(void)
{
    swaying();
}

void tearDown(void) {}

static void velocity_changes_show_the_heading(void)
{
    int after = 0;
    for (int i = 0; i < 40 && !nav.ins; i++, after++) { carried_step(&world, &nav); }
    TEST_ASSERT_TRUE(nav.ins);
    const double off = carried_heading_error(&world, &nav), sd = (double)nav.epoch_solution.sd_heading_rad;
    printf("after %d s: heading off by %.2f deg of sigma %.2f\n", after, off / PEL_DEG, sd / PEL_DEG);
    TEST_ASSERT_LESS_THAN_DOUBLE(3.0 * sd, fabs(off));
    TEST_ASSERT_LESS_THAN_DOUBLE(12.0 * PEL_DEG, sd);
    carried_run(&world, &nav, 20);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
    TEST_ASSERT_LESS_THAN_DOUBLE(2.0 * PEL_DEG, fabs(carried_heading_error(&world, &nav)));
}

/* Nothing to see: a coarse gyro shows no north, and noise is no velocity change. */
static void who_stands_has_no_heading(void)
{
    world.sway_m = 0.0;
    carried_run(&world, &nav, 40);
    TEST_ASSERT_FALSE(nav.ins);
    TEST_ASSERT_GREATER_THAN_DOUBLE(6.0, nav.yaw.n);
    TEST_ASSERT_GREATER_THAN_DOUBLE(20.0, nav.align.t_static_s);
    TEST_ASSERT_EQUAL_INT(PEL_WHY_NOT_ALIGNED, nav.used.imu_why);
}

static void a_receiver_without_doppler_shows_none_either(void)
{
    for (int i = 0; i < 25; i++) {
        carried_observe(&world, &base, &rover);
        for (int k = 0; k < rover.n; k++) { rover.obs[k].flags &= (uint8_t)~PEL_OBS_DOPPLER; }
        carried_push(&world, &nav, &base, &rover);
    }
    TEST_ASSERT_EQUAL_DOUBLE(0.0, nav.yaw.n);
    TEST_ASSERT_FALSE(nav.ins);
}

/* A start in motion: what is felt is not gravity alone, so levelling waits for an interval that is calm. */
static void levelling_waits_for_calm(void)
{
    world.begin_s = 0.0;
    world.sway_radps = 0.3;
    world.sway_m = 20.0; /* 1.8 m/s^2 at first */
    for (int i = 0; i < 4; i++) {
        carried_step(&world, &nav);
        TEST_ASSERT_FALSE(nav.yaw.levelled);
    }
    int i = 4;
    for (; i < 12 && !nav.yaw.levelled; i++) { carried_step(&world, &nav); }
    TEST_ASSERT_TRUE(nav.yaw.levelled); /* where the sway turns, about five seconds in */
    double z[3], up[3];
    (void)pel_unit3(world.start_e, up);
    pel_mat3_tvec(world.C_b_e, up, z);
    TEST_ASSERT_GREATER_THAN_DOUBLE(cos(5.0 * PEL_DEG), pel_dot3(nav.yaw.C_b_l[2], z));
}

/* In a lasting turn specific force leans, and gyros alone carry the vertical: until their drift may be as large as what is asked for. */
static void a_vertical_carried_too_long_begins_anew(void)
{
    world.begin_s = 3.2;
    world.sway_radps = 1e-3; /* no calm interval for longer than that: 1 m/s^2 for minutes */
    world.sway_m = 1e6;
    carried_run(&world, &nav, 5);
    TEST_ASSERT_TRUE(nav.yaw.levelled && !nav.yaw.calm);
    nav.yaw.leaning_s = 4.0 * PEL_DEG / nav.cfg.imu.sd_bg_radps - 2.5;
    carried_step(&world, &nav);
    TEST_ASSERT_TRUE(nav.yaw.levelled);
    carried_run(&world, &nav, 3);
    TEST_ASSERT_FALSE(nav.yaw.levelled);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, nav.yaw.n);
}

/* Epochs a quarter of a second apart are taken together, epochs after an outage are not compared. */
static void intervals_are_neither_short_nor_long(void)
{
    carried_run(&world, &nav, 6);
    const double n = nav.yaw.n;
    TEST_ASSERT_GREATER_THAN_DOUBLE(0.0, n);
    const pel_yaw_t before = nav.yaw;
    nav.spp.t_ns = nav.at_horizon.t_ns = before.since_ns + 250 * PEL_NS_PER_MS;
    pel_nav_yaw_epoch(&nav);
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.yaw, sizeof before);
    nav.spp.t_ns = nav.at_horizon.t_ns = before.since_ns + 450 * PEL_NS_PER_MS;
    pel_nav_yaw_epoch(&nav);
    TEST_ASSERT_GREATER_THAN_DOUBLE(n, nav.yaw.n);

    nav.yaw = before;
    nav.spp.t_ns = nav.at_horizon.t_ns = before.since_ns + 2600 * PEL_NS_PER_MS;
    pel_nav_yaw_epoch(&nav);
    TEST_ASSERT_EQUAL_DOUBLE(n, nav.yaw.n); /* not remembered, but the start of the next */
    TEST_ASSERT_EQUAL_INT64(nav.spp.t_ns, nav.yaw.since_ns);
    TEST_ASSERT_FALSE(nav.yaw.calm);
}

static void a_velocity_of_another_time_or_of_none_is_not_used(void)
{
    carried_run(&world, &nav, 6);
    const pel_yaw_t before = nav.yaw;
    for (int i = 0; i < 3; i++) {
        nav.spp.t_ns = nav.at_horizon.t_ns = before.since_ns + PEL_NS_PER_S;
        nav.have_spp = i != 0;
        nav.spp.has_velocity = i != 1;
        nav.at_horizon.t_ns += (i == 2) ? 1 : 0;
        pel_nav_yaw_epoch(&nav);
        TEST_ASSERT_EQUAL_MEMORY(&before, &nav.yaw, sizeof before);
    }
}

/* ---- the sums themselves -------------------------------------------------------------------------------------------------- */

/* n pairs of accelerations, the second turned by `turn` against the first, each with noise of its own. */
static void sums_of(int n, double size, double turn, double noise)
{
    static uint32_t dice = 5;
    pel_yaw_t *y = &nav.yaw;
    memset(y, 0, sizeof *y);
    for (int k = 0; k < 3; k++) { y->C_b_l[k][k] = 1.0; }
    for (int i = 0; i < n; i++) {
        double v[4];
        for (int k = 0; k < 4; k++) {
            dice = dice * 1664525u + 1013904223u;
            v[k] = (double)(dice >> 8) / 8388608.0 - 1.0;
        }
        const double a[2] = {size * cos(2.0 * i), size * sin(2.0 * i)};
        const double b[2] = {cos(turn) * a[0] - sin(turn) * a[1] + noise * v[0],
                             sin(turn) * a[0] + cos(turn) * a[1] + noise * v[1]};
        y->n += 1.0;
        for (int k = 0; k < 2; k++) {
            y->a[k] += a[k];
            y->b[k] += b[k];
        }
        y->aa += a[0] * a[0] + a[1] * a[1];
        y->bb += b[0] * b[0] + b[1] * b[1];
        y->dot += a[0] * b[0] + a[1] * b[1];
        y->cross += a[0] * b[1] - a[1] * b[0];
    }
}

static bool solved(double *turn, double *sd)
{
    double C[3][3];
    const bool ok = pel_nav_yaw_solve(&nav, C, sd);
    *turn = atan2(C[1][0], C[0][0]);
    return ok;
}

static void the_answer_waits_for_enough_that_agrees(void)
{
    double turn, sd;
    sums_of(5, 1.0, 0.4, 0.0);
    TEST_ASSERT_FALSE(solved(&turn, &sd)); /* too few */
    sums_of(6, 1.0, 0.4, 0.0);
    TEST_ASSERT_TRUE(solved(&turn, &sd));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.4, turn);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4.0 * PEL_DEG, sd); /* the floor: what a forward axis and lags are good for */
    sums_of(30, 1.0, -2.8, 0.3);
    TEST_ASSERT_TRUE(solved(&turn, &sd));
    TEST_ASSERT_LESS_THAN_DOUBLE(3.0 * sd, fabs(turn + 2.8));
    sums_of(30, 1.0, 0.4, 6.0);
    TEST_ASSERT_FALSE(solved(&turn, &sd)); /* no correlation */
    sums_of(8, 1.0, 0.4, 1.0);
    TEST_ASSERT_FALSE(solved(&turn, &sd)); /* correlated, but eight such pairs leave more than 12 degrees */
    TEST_ASSERT_GREATER_THAN_DOUBLE(12.0 * PEL_DEG, sd);
    sums_of(10, 0.0, 0.4, 1.0);
    TEST_ASSERT_FALSE(solved(&turn, &sd)); /* the IMU felt nothing at all */
    sums_of(10, 1.0, 0.4, 0.0);
    nav.yaw.bb = nav.yaw.dot = nav.yaw.cross = nav.yaw.b[0] = nav.yaw.b[1] = 0.0;
    TEST_ASSERT_FALSE(solved(&turn, &sd)); /* or GNSS saw nothing at all */
}

/* An IMU with any axis up has a level frame. */
static void any_axis_may_point_up(void)
{
    for (int axis = 0; axis < 3; axis++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            pel_yaw_t y = {.calm = true};
            pel_imu_t imu = {.dt_s = 0.1};
            imu.upsilon_ib_b[axis] = sign * 0.98;
            for (int i = 0; i < 11; i++) { pel_nav_yaw_increment(&y, &imu); }
            TEST_ASSERT_TRUE(y.levelled);
            double C[3][3];
            pel_mat3_mult(y.C_b_l, y.C_b_l, C);
            for (int i = 0; i < 3; i++) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-12, (i == axis) ? sign : 0.0, y.C_b_l[2][i]);
                for (int j = 0; j < 3; j++) { TEST_ASSERT_DOUBLE_WITHIN(1e-12, i == j, C[i][j]); }
            }
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(velocity_changes_show_the_heading);
    RUN_TEST(who_stands_has_no_heading);
    RUN_TEST(a_receiver_without_doppler_shows_none_either);
    RUN_TEST(levelling_waits_for_calm);
    RUN_TEST(a_vertical_carried_too_long_begins_anew);
    RUN_TEST(intervals_are_neither_short_nor_long);
    RUN_TEST(a_velocity_of_another_time_or_of_none_is_not_used);
    RUN_TEST(the_answer_waits_for_enough_that_agrees);
    RUN_TEST(any_axis_may_point_up);
    return UNITY_END();
}

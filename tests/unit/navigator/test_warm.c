/* A second life with the attitude of the first: taken up where everything agrees, refused with its reason where one thing does not. */
/* with: carried pair gnss */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "pelorus/snapshot.h"
#include "support_carried.h"
#include "unity.h"

#define HEADING 4.0

static carried_t world;
static pel_navigator_t first, second;
static uint8_t bytes[PEL_SNAPSHOT_BYTES + 12 * PEL_SNAPSHOT_EPH_BYTES];
static size_t length;

/* A life of a quarter of a minute, standing, with an attitude that was told; then its snapshot. */
static void live(pel_imu_grade_t grade, double speed_mps)
{
    carried_init(&world, &first, HEADING, true);
    pel_nav_config_t cfg = first.cfg;
    pel_imu_model_preset(grade, &cfg.imu);
    world.noise = (grade == PEL_IMU_GRADE_TACTICAL) ? 1e-2 : 1.0;
    world.speed_mps = speed_mps;
    carried_introduce(&world, &first, &cfg);
    carried_run(&world, &first, 15);
    TEST_ASSERT_TRUE(first.ins);
    length = pel_snapshot_encode(&first, 3, bytes, sizeof bytes);
    TEST_ASSERT_EQUAL_UINT(sizeof bytes, length); /* there are more orbits than have room */
}

/* The next life begins at once, and is told nothing but the snapshot and the orbits that had no room in it. */
static void wake(void)
{
    pel_nav_config_t cfg = first.cfg;
    cfg.have_attitude = false;
    pel_navigator_init(&second, &cfg);
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_WAITING, pel_snapshot_restore(&second, bytes, length));
    TEST_ASSERT_TRUE(second.have_station);
    for (int i = 0; i < world.pair.orbits.n; i++) { pel_navigator_push_ephemeris(&second, &world.pair.orbits.eph[i]); }
}

static void two_epochs_say(pel_snap_t verdict)
{
    carried_run(&world, &second, 2);
    TEST_ASSERT_EQUAL_INT(verdict, second.warm.report.verdict);
    TEST_ASSERT_EQUAL_UINT32(1, second.warm.report.count[verdict]);
    TEST_ASSERT_EQUAL_INT(verdict == PEL_SNAP_USED, second.ins);
    TEST_ASSERT_EQUAL_INT(PEL_NAV_WARM, pel_navigator_poll(&second));
    TEST_ASSERT_NOT_EQUAL(PEL_NAV_WARM, pel_navigator_poll(&second)); /* told once */
}

void setUp(void)
{
    live(PEL_IMU_GRADE_TACTICAL, 0.0);
    wake();
}

void tearDown(void) {}

static void an_attitude_that_still_holds_is_taken_up(void)
{
    two_epochs_say(PEL_SNAP_USED);
    const double off = carried_heading_error(&world, &second), sd = (double)second.epoch_solution.sd_heading_rad;
    printf("heading off by %.4f deg of sigma %.4f, age %.0f s\n", off / PEL_DEG, sd / PEL_DEG,
           (double)second.warm.report.age_s);
    TEST_ASSERT_LESS_THAN_DOUBLE(3.0 * sd, fabs(off));
    TEST_ASSERT_LESS_THAN_DOUBLE(0.6 * PEL_DEG, sd); /* the first life's half degree, not a course's fifteen */
    TEST_ASSERT_FLOAT_WITHIN(3.0f, 2.0f, second.warm.report.age_s);
    TEST_ASSERT_FALSE(second.warm.errors_due);
    carried_run(&world, &second, 4);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, second.last_fix);
    TEST_ASSERT_EQUAL_UINT32(1, second.warm.report.count[PEL_SNAP_USED]);
}

/* Errors of a tactical gyro come from the first life: at a standstill they hide below the Earth's rate. */
static void sensor_errors_come_with_it(void)
{
    for (int k = 0; k < 3; k++) {
        second.warm.kept.error[k] = 2e-8 * (k + 1);
        second.warm.kept.error[3 + k] = 1e-8;
        second.warm.kept.error[6 + k] = 1e-5;
        second.warm.kept.sd_error[k] = second.warm.kept.sd_error[3 + k] = 1e-9f;
    }
    pel_real sd[PEL_MAX_STATES];
    second.warm.errors_due = true;
    second.at_horizon.t_ns = second.warm.kept.t_ns + 3600 * PEL_NS_PER_S;
    pel_model_ins_ecef(&second.model, &second.cfg.imu);
    for (int i = 0; i < 18; i++) { sd[i] = PEL_R(1.0); }
    pel_nav_warm_errors(&second, sd);
    const double keep = exp(-3600.0 / second.cfg.imu.tau_gm_s), half = 0.5 * second.cfg.imu.sd_bg_radps;
    for (int k = 0; k < 3; k++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2e-8 * (k + 1), second.errors.gyro_constant[k]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, keep * 1e-8, second.errors.gyro_markov[k]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-3 * half, half, (double)sd[k]); /* half of its spread: it was switched on anew */
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * second.cfg.imu.sd_gm_radps,
                                  sqrt(1.0 - keep * keep) * second.cfg.imu.sd_gm_radps, (double)sd[3 + k]);
    }
    second.errors.gyro_constant[0] = 7.0; /* and only once */
    pel_nav_warm_errors(&second, sd);
    TEST_ASSERT_EQUAL_DOUBLE(7.0, second.errors.gyro_constant[0]);
}

/* Those of a coarse gyro show themselves while it stands, better than half of its spread. */
static void what_this_standstill_has_shown_of_the_gyros_is_better(void)
{
    live(PEL_IMU_GRADE_MEMS, 0.0);
    wake();
    for (int k = 0; k < 3; k++) { second.warm.kept.error[k] = 1e-3; }
    carried_imu_until(&world, &second, SKY_T0 + (world.pair.epoch + 2) * PEL_NS_PER_S);
    static pel_epoch_t base, rover;
    for (int i = 0; i < 4; i++) { carried_observe(&world, &base, &rover); }
    carried_push(&world, &second, &base, &rover);
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_USED, second.warm.report.verdict);
    for (int k = 0; k < 3; k++) { TEST_ASSERT_LESS_THAN_DOUBLE(3e-4, fabs(second.errors.gyro_constant[k])); }
}

static void an_old_one_or_one_of_the_future_is_stale(void)
{
    static const double AGES_S[] = {86400.0 + 60.0, -3600.0};
    for (int i = 0; i < 2; i++) {
        wake();
        second.warm.kept.t_ns -= (int64_t)(AGES_S[i] * 1e9);
        two_epochs_say(PEL_SNAP_STALE);
    }
}

static void one_taken_in_motion_is_of_no_use(void)
{
    live(PEL_IMU_GRADE_TACTICAL, 5.0);
    TEST_ASSERT_FALSE(pel_snapshot_is_due(&first, 0));
    world.speed_mps = 0.0;
    wake();
    TEST_ASSERT_EQUAL_FLOAT(0.0f, second.warm.kept.still_s);
    two_epochs_say(PEL_SNAP_UNDER_WAY);
}

static void another_place_says_moved(void)
{
    second.warm.kept.r_ea_e[1] += 200.0;
    two_epochs_say(PEL_SNAP_MOVED);
    wake();
    second.warm.kept.r_ea_e[1] = NAN; /* no number agrees with nothing */
    two_epochs_say(PEL_SNAP_MOVED);
}

static void a_vehicle_that_moves_is_not_still(void)
{
    world.begin_s = 14.5;
    world.speed_mps = 1.5;
    two_epochs_say(PEL_SNAP_NOT_STILL);
}

static void a_vehicle_that_rocks_is_not_still(void)
{
    static pel_epoch_t base, rover;
    for (int i = 0; i < 2; i++) {
        carried_observe(&world, &base, &rover);
        for (int k = 0; k < 99; k++) {
            pel_imu_t imu = carried_imu(&world);
            imu.alpha_ib_b[1] += 5e-4 * sin(0.1 * k);
            pel_navigator_push_imu(&second, &imu);
        }
        carried_push(&world, &second, &base, &rover);
    }
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_NOT_STILL, second.warm.report.verdict);
    TEST_ASSERT_FALSE(second.ins);
}

/* Turned by this about an axis of the Earth's frame while nobody looked. */
static void turned_by(const double v[3])
{
    double C[3][3], turn[3][3], turned[3][3];
    wake();
    pel_rotvec_to_dcm(second.warm.kept.theta_b_e, C);
    pel_rotvec_to_dcm(v, turn);
    pel_mat3_mul(turn, C, turned);
    pel_dcm_to_rotvec(turned, second.warm.kept.theta_b_e);
    two_epochs_say(PEL_SNAP_TURNED);
}

static void gravity_and_the_earths_rate_tell_a_turn(void)
{
    double up[3], level[3];
    const double polar[3] = {0.0, 0.0, 1.0};
    (void)pel_unit3(first.at_horizon.r_eb_e, up);
    pel_cross3(polar, up, level);
    (void)pel_unit3(level, level);
    const double tilted[3] = {0.1 * level[0], 0.1 * level[1], 0.1 * level[2]};
    const double upside_down[3] = {PEL_PI * level[0], PEL_PI * level[1], PEL_PI * level[2]};
    const double turned[3] = {0.5 * up[0], 0.5 * up[1], 0.5 * up[2]}; /* gravity does not see it */
    turned_by(tilted);
    turned_by(upside_down);
    turned_by(turned);
}

static void an_attitude_that_was_told_comes_first(void)
{
    pel_nav_config_t cfg = first.cfg; /* told, as in the first life */
    pel_navigator_init(&second, &cfg);
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_WAITING, pel_snapshot_restore(&second, bytes, length));
    for (int i = 0; i < world.pair.orbits.n; i++) { pel_navigator_push_ephemeris(&second, &world.pair.orbits.eph[i]); }
    carried_run(&world, &second, 2);
    TEST_ASSERT_TRUE(second.ins);
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_WAITING, second.warm.report.verdict);
}

/* ---- does it stand? -------------------------------------------------------------------------------------------------------------- */

static void standing_is_no_speed_and_no_turn(void)
{
    TEST_ASSERT_TRUE(pel_snapshot_is_due(&first, 0));
    const pel_time_t since_ns = first.warm.still_since_ns;
    pel_nav_warm_epoch(&first);
    TEST_ASSERT_EQUAL_INT64(since_ns, first.warm.still_since_ns); /* goes on */
    first.omega_ib_b[2] += 2.0 * PEL_DEG;
    pel_nav_warm_epoch(&first);
    TEST_ASSERT_EQUAL_INT64(0, first.warm.still_since_ns);
    first.omega_ib_b[2] -= 2.0 * PEL_DEG;
    pel_nav_warm_epoch(&first);
    TEST_ASSERT_EQUAL_INT64(first.at_horizon.t_ns, first.warm.still_since_ns); /* begins again */
    TEST_ASSERT_FALSE(pel_snapshot_is_due(&first, 0));
    first.at_horizon.v_eb_e[0] += 1.0;
    pel_nav_warm_epoch(&first);
    TEST_ASSERT_EQUAL_INT64(0, first.warm.still_since_ns);
    first.at_horizon.v_eb_e[0] -= 1.0;
    pel_nav_warm_epoch(&first);
    first.ins = false;
    pel_nav_warm_epoch(&first);
    TEST_ASSERT_EQUAL_INT64(0, first.warm.still_since_ns);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_attitude_that_still_holds_is_taken_up);
    RUN_TEST(sensor_errors_come_with_it);
    RUN_TEST(what_this_standstill_has_shown_of_the_gyros_is_better);
    RUN_TEST(an_old_one_or_one_of_the_future_is_stale);
    RUN_TEST(one_taken_in_motion_is_of_no_use);
    RUN_TEST(another_place_says_moved);
    RUN_TEST(a_vehicle_that_moves_is_not_still);
    RUN_TEST(a_vehicle_that_rocks_is_not_still);
    RUN_TEST(gravity_and_the_earths_rate_tell_a_turn);
    RUN_TEST(an_attitude_that_was_told_comes_first);
    RUN_TEST(standing_is_no_speed_and_no_turn);
    return UNITY_END();
}

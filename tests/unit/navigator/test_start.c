/* From GNSS alone to the INS with each kind of help, and what must not start it. */
/* with: carried pair gnss */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

#define HEADING 2.1

static carried_t world;
static pel_navigator_t nav;
static pel_nav_config_t cfg;

void setUp(void)
{
    carried_init(&world, &nav, HEADING, false);
    cfg = nav.cfg;
}

void tearDown(void) {}

static void again(void)
{
    carried_introduce(&world, &nav, &cfg);
}

/* Seconds until the INS runs, -1: not within n. */
static int ins_after(int n)
{
    for (int i = 0; i < n; i++) {
        carried_step(&world, &nav);
        if (nav.ins) { return i + 1; }
    }
    return -1;
}

static void heading_is_within(double limit_rad)
{
    const double off = carried_heading_error(&world, &nav);
    const double sd = (double)nav.epoch_solution.sd_heading_rad;
    printf("heading off by %.2f deg of sigma %.2f\n", off / PEL_DEG, sd / PEL_DEG);
    TEST_ASSERT_DOUBLE_WITHIN(limit_rad, 0.0, off);
    TEST_ASSERT_LESS_THAN_DOUBLE(4.0 * sd, fabs(off));
}

/* ---- an attitude that was told -------------------------------------------------------------------------------------------- */

static void a_told_attitude_starts_at_the_second_epoch_and_is_used_once(void)
{
    cfg.have_attitude = true;
    again();
    TEST_ASSERT_EQUAL_INT(2, ins_after(5)); /* the first has no increments before it */
    TEST_ASSERT_FALSE(nav.attitude_given);
    heading_is_within(1.5 * PEL_DEG);
    carried_run(&world, &nav, 5);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.03, carried_error_m(&world, &nav));
}

/* The told attitude is that of the first increment: gyros and the Earth's turn carry it through half a minute without epochs. */
static void a_told_attitude_is_carried_to_the_first_epoch(void)
{
    cfg.have_attitude = true;
    again();
    static pel_epoch_t base, rover;
    double C_turned[3][3], turn[3][3];
    const double half_turn[3] = {0.0, 0.0, -0.5 * PEL_PI};
    pel_rotvec_to_dcm(half_turn, turn);
    pel_mat3_mul(world.C_b_e, turn, C_turned);
    for (int i = 0; i < 30; i++) { carried_observe(&world, &base, &rover); }
    for (int i = 0; i < 3000; i++) { /* in the first ten seconds it turns to the right by a quarter */
        if (i == 1000) { memcpy(world.C_b_e, C_turned, sizeof C_turned); }
        pel_imu_t imu = carried_imu(&world);
        if (i < 1000) { imu.alpha_ib_b[2] += half_turn[2] / 1000.0; }
        pel_navigator_push_imu(&nav, &imu);
    }
    carried_step(&world, &nav);
    TEST_ASSERT_TRUE(nav.ins);
    heading_is_within(1.5 * PEL_DEG);
}

static void presets_without_an_imu_start_none(void)
{
    static const struct {
        pel_preset_t preset;
        int ins, why_imu, why_base;
    } of[] = {{PEL_PRESET_SINGLE, 0, PEL_WHY_CONFIG, PEL_WHY_CONFIG},
              {PEL_PRESET_RTK, 0, PEL_WHY_CONFIG, PEL_WHY_NONE},
              {PEL_PRESET_INS_SINGLE, 1, PEL_WHY_NONE, PEL_WHY_CONFIG},
              {PEL_PRESET_INS_RTK, 1, PEL_WHY_NONE, PEL_WHY_NONE}};
    for (int i = 0; i < 4; i++) {
        cfg.preset = of[i].preset;
        cfg.have_attitude = true;
        again();
        carried_run(&world, &nav, 4);
        TEST_ASSERT_EQUAL_INT(of[i].ins, nav.ins);
        TEST_ASSERT_EQUAL_INT(of[i].why_imu, nav.used.imu_why);
        TEST_ASSERT_EQUAL_INT(of[i].why_base, nav.used.base_why);
        TEST_ASSERT_EQUAL_INT(of[i].preset, nav.used.preset_used);
        TEST_ASSERT_EQUAL_INT(PEL_WHY_NONE, nav.used.preset_why);
    }
}

/* Settings that give no filter: said, counted, and GNSS alone goes on. */
static void an_attitude_or_a_sensor_without_any_doubt_is_no_start(void)
{
    for (int i = 0; i < 2; i++) {
        cfg = (pel_nav_config_t)nav.cfg;
        cfg.have_attitude = true;
        cfg.sd_tilt_rad = (i == 0) ? 0.0 : 0.01;
        cfg.sd_heading_rad = (i == 0) ? 0.0 : 0.01;
        cfg.imu.sd_gm_radps = (i == 0) ? cfg.imu.sd_gm_radps : 0.0;
        again();
        carried_run(&world, &nav, 2);
        TEST_ASSERT_EQUAL_UINT32(1, nav.counters.numeric_faults);
        TEST_ASSERT_FALSE(nav.ins || nav.have_state);
        carried_run(&world, &nav, 2);
        TEST_ASSERT_TRUE(nav.have_state);
        TEST_ASSERT_FALSE(nav.ins);
    }
}

/* ---- standing still ----------------------------------------------------------------------------------------------------------- */

static void tactical(void)
{
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &cfg.imu);
    world.noise = 1e-2;
    again();
}

static void a_tactical_imu_finds_north_by_itself(void)
{
    tactical();
    const int after = ins_after(60);
    TEST_ASSERT_INT_WITHIN(2, 21, after); /* twenty seconds of averages */
    heading_is_within(3.0 * PEL_DEG);
}

/* Straight and level flight looks still to an IMU; GNSS knows better. */
static void a_steady_flight_is_no_standstill(void)
{
    world.speed_mps = 30.0;
    tactical();
    TEST_ASSERT_EQUAL_INT(-1, ins_after(40));
    TEST_ASSERT_GREATER_THAN_DOUBLE(20.0, nav.align.t_static_s);
    TEST_ASSERT_TRUE(nav.have_state);
}

static void a_jolt_at_the_end_makes_it_wait(void)
{
    tactical();
    TEST_ASSERT_EQUAL_INT(-1, ins_after(19));
    static pel_epoch_t base, rover;
    carried_observe(&world, &base, &rover);
    for (int i = 0; i < 20; i++) { /* rocked for a fifth of a second before the epoch that would have started it */
        carried_imu_until(&world, &nav, SKY_T0 + (world.pair.epoch - 2) * PEL_NS_PER_S + (80 + i) * CARRIED_IMU_NS);
        pel_imu_t imu = carried_imu(&world);
        imu.alpha_ib_b[0] += (i % 2 == 0) ? 1e-3 : -1e-3;
        imu.upsilon_ib_b[1] += 2e-3;
        pel_navigator_push_imu(&nav, &imu);
    }
    carried_push(&world, &nav, &base, &rover);
    TEST_ASSERT_FALSE(nav.ins);
    TEST_ASSERT_GREATER_THAN_UINT32(0, nav.align.restarts);
    TEST_ASSERT_EQUAL_INT(-1, ins_after(15));
    TEST_ASSERT_GREATER_THAN_INT(0, ins_after(15));
    heading_is_within(3.0 * PEL_DEG);
}

/* Gyro errors of a coarse sensor show themselves while it stands; better than its data sheet, worse than the Earth's rate. */
static void gyros_are_calibrated_at_a_standstill_before_the_start(void)
{
    world.gyro_error[0] = 0.2 * PEL_DEG;
    world.gyro_error[2] = -0.25 * PEL_DEG;
    cfg.have_attitude = true;
    again();
    static pel_epoch_t base, rover;
    for (int i = 0; i < 8; i++) { carried_observe(&world, &base, &rover); }
    carried_push(&world, &nav, &base, &rover); /* seven seconds of increments before the first epoch */
    TEST_ASSERT_TRUE(nav.ins);
    for (int k = 0; k < 3; k++) { TEST_ASSERT_DOUBLE_WITHIN(2e-4, world.gyro_error[k], nav.errors.gyro_constant[k]); }
    /* and of one that stood too shortly, or flies, nothing is taken for an error */
    for (int flies = 0; flies < 2; flies++) {
        world.speed_mps = flies ? 30.0 : 0.0;
        again();
        for (int i = 0; i < (flies ? 8 : 1); i++) { carried_observe(&world, &base, &rover); }
        world.sample = flies ? 0 : -50;
        carried_push(&world, &nav, &base, &rover);
        TEST_ASSERT_TRUE(nav.ins);
        TEST_ASSERT_LESS_THAN_DOUBLE(1e-3, fabs(nav.errors.gyro_constant[2])); /* but what the first row makes of it */
    }
}

/* ---- moving, forward axis known --------------------------------------------------------------------------------------------- */

static void the_course_starts_a_vehicle_whose_mounting_is_known(void)
{
    cfg.mount_known = true;
    world.speed_mps = 10.0;
    again();
    TEST_ASSERT_EQUAL_INT(2, ins_after(5));
    heading_is_within(3.0 * PEL_DEG);
    TEST_ASSERT_GREATER_THAN_FLOAT(5.0 * PEL_DEG, nav.epoch_solution.sd_heading_rad); /* a mounting by hand and crab */
    carried_run(&world, &nav, 4);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
}

static void a_course_below_the_speed_that_was_asked_for_tells_nothing(void)
{
    cfg.mount_known = true;
    cfg.align_speed_mps = 10.5;
    world.speed_mps = 10.0;
    again();
    TEST_ASSERT_EQUAL_INT(-1, ins_after(6));
    TEST_ASSERT_EQUAL_INT(PEL_WHY_NOT_ALIGNED, nav.used.imu_why);
}

/* An epoch of a receiver that starts before its IMU: there is too little to level with. */
static void level_needs_a_quarter_of_a_second(void)
{
    static pel_epoch_t base, rover;
    cfg.mount_known = true;
    world.speed_mps = 10.0;
    for (int ms = 150; ms <= 400; ms += 250) {
        again();
        carried_observe(&world, &base, &rover);
        world.sample = 1 - ms / 10;
        carried_push(&world, &nav, &base, &rover);
        TEST_ASSERT_TRUE(nav.have_state);
        TEST_ASSERT_EQUAL_INT(ms > 250, nav.ins);
    }
}

/* The acceleration of the interval before turns level; without one, as at the first epoch or after a silence, its place is taken by none. */
static void level_allows_for_the_acceleration_that_gnss_saw(void)
{
    static pel_epoch_t base, rover;
    double off[2];
    for (int silent = 0; silent < 2; silent++) {
        carried_init(&world, &nav, HEADING, false);
        cfg = nav.cfg;
        cfg.mount_known = true;
        cfg.align_speed_mps = 4.0;
        world.speed_mps = 2.0;
        world.sway_m = 8.0; /* 2 m/s^2 at first, for a second or two */
        world.sway_radps = 0.5;
        again();
        carried_step(&world, &nav);
        carried_step(&world, &nav);
        if (silent) { carried_observe(&world, &base, &rover); }
        if (silent) { carried_push(&world, &nav, NULL, NULL); }
        TEST_ASSERT_FALSE(nav.ins);
        carried_step(&world, &nav);
        TEST_ASSERT_TRUE(nav.ins);
        double up[3], forward[3];
        (void)pel_unit3(world.start_e, up);
        for (int k = 0; k < 3; k++) { forward[k] = nav.at_horizon.C_b_e[k][1]; }
        off[silent] = fabs(pel_dot3(up, forward)); /* the sphere's plumb line: 3e-3 off */
    }
    printf("pitch at the start: %.2f deg with acceleration, %.2f deg without\n", off[0] / PEL_DEG, off[1] / PEL_DEG);
    TEST_ASSERT_LESS_THAN_DOUBLE(2.0 * PEL_DEG, off[0]);
    TEST_ASSERT_GREATER_THAN_DOUBLE(off[0], off[1]);
}

static void a_specific_force_that_is_not_gravity_starts_nothing(void)
{
    static pel_epoch_t base, rover;
    cfg.mount_known = true;
    world.speed_mps = 10.0;
    again();
    for (int i = 0; i < 4; i++) {
        carried_observe(&world, &base, &rover);
        for (int k = 0; k < 100; k++) {
            pel_imu_t imu = carried_imu(&world);
            imu.upsilon_ib_b[2] *= 1.5; /* a scale factor set wrong */
            pel_navigator_push_imu(&nav, &imu);
        }
        pel_navigator_push_base(&nav, &base);
        pel_navigator_push_rover(&nav, &rover);
    }
    TEST_ASSERT_TRUE(nav.have_state);
    TEST_ASSERT_FALSE(nav.ins);
    TEST_ASSERT_EQUAL_UINT32(0, nav.counters.numeric_faults);
}

/* ---- receivers -------------------------------------------------------------------------------------------------------------------- */

static void without_doppler_the_velocity_is_unknown_at_the_start(void)
{
    static pel_epoch_t base, rover;
    cfg.preset = PEL_PRESET_SINGLE;
    again();
    carried_observe(&world, &base, &rover);
    for (int i = 0; i < rover.n; i++) { rover.obs[i].flags &= (uint8_t)~PEL_OBS_DOPPLER; }
    carried_push(&world, &nav, &base, &rover);
    TEST_ASSERT_TRUE(nav.have_state);
    TEST_ASSERT_GREATER_THAN_DOUBLE(90.0, (double)pel_ud_cov(&nav.ud, 0, 0));
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-6, pel_norm3(nav.at_horizon.v_eb_e));
    again();
    carried_step(&world, &nav);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.3, (double)pel_ud_cov(&nav.ud, 0, 0));
}

static void a_single_point_solution_without_numbers_is_no_start(void)
{
    pel_spp_t spp = {.t_ns = SKY_T0, .r_ea_e = {4.1e6, 8.4e5, 4.8e6}, .cov_r_e = {{NAN, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    pel_nav_start_gnss(&nav, &spp);
    TEST_ASSERT_FALSE(nav.have_state);
    spp.cov_r_e[0][0] = 1.0;
    pel_nav_start_gnss(&nav, &spp);
    TEST_ASSERT_TRUE(nav.have_state);
}

static void there_is_no_ins_to_drop_without_one(void)
{
    carried_run(&world, &nav, 2);
    const pel_navigator_t before = nav;
    pel_nav_drop_ins(&nav);
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav, sizeof nav);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_told_attitude_starts_at_the_second_epoch_and_is_used_once);
    RUN_TEST(a_told_attitude_is_carried_to_the_first_epoch);
    RUN_TEST(presets_without_an_imu_start_none);
    RUN_TEST(an_attitude_or_a_sensor_without_any_doubt_is_no_start);
    RUN_TEST(a_tactical_imu_finds_north_by_itself);
    RUN_TEST(a_steady_flight_is_no_standstill);
    RUN_TEST(a_jolt_at_the_end_makes_it_wait);
    RUN_TEST(gyros_are_calibrated_at_a_standstill_before_the_start);
    RUN_TEST(the_course_starts_a_vehicle_whose_mounting_is_known);
    RUN_TEST(a_course_below_the_speed_that_was_asked_for_tells_nothing);
    RUN_TEST(level_needs_a_quarter_of_a_second);
    RUN_TEST(level_allows_for_the_acceleration_that_gnss_saw);
    RUN_TEST(a_specific_force_that_is_not_gravity_starts_nothing);
    RUN_TEST(without_doppler_the_velocity_is_unknown_at_the_start);
    RUN_TEST(a_single_point_solution_without_numbers_is_no_start);
    RUN_TEST(there_is_no_ins_to_drop_without_one);
    return UNITY_END();
}

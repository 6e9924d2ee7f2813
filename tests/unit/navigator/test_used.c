/* What was asked for and what is used, with the reason of each difference; and what a solution tells of attitude. */
/* with: carried pair gnss */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

static carried_t world;
static pel_navigator_t good, nav;
static pel_nav_config_t cfg;
static pel_epoch_t base, rover;

static void begin(double heading_rad)
{
    carried_init(&world, &good, heading_rad, true);
    cfg = good.cfg;
    cfg.slice_nodes = 0;
    carried_introduce(&world, &good, &cfg);
}

void setUp(void)
{
    begin(1.0);
    carried_run(&world, &good, 4);
    while (pel_navigator_poll(&good) != PEL_NAV_NONE) {}
    nav = good;
}

void tearDown(void) {}

static bool told(void)
{
    const bool is_told = (nav.ready & PEL_NAV_BIT(PEL_NAV_USED)) != 0;
    nav.ready = 0;
    return is_told;
}

/* ---- told when it changes, and only then ----------------------------------------------------------------------------------------- */

static void every_change_is_told_once(void)
{
    static const size_t MEMBERS[] = {
        offsetof(pel_used_t, preset_used),      offsetof(pel_used_t, preset_why),
        offsetof(pel_used_t, imu_seen),         offsetof(pel_used_t, imu_used),
        offsetof(pel_used_t, imu_why),          offsetof(pel_used_t, base_seen),
        offsetof(pel_used_t, base_used),        offsetof(pel_used_t, base_why),
        offsetof(pel_used_t, rover_seen[0]),    offsetof(pel_used_t, rover_seen[5]),
        offsetof(pel_used_t, base_carriers[1]), offsetof(pel_used_t, carriers_used[0]),
        offsetof(pel_used_t, sys_why[4]),
    };
    pel_nav_note_used(&nav);
    TEST_ASSERT_FALSE(told());
    for (size_t i = 0; i < sizeof MEMBERS / sizeof MEMBERS[0]; i++) {
        nav.used = good.used;
        ((uint8_t *)&nav.used)[MEMBERS[i]] ^= 1;
        if (MEMBERS[i] == offsetof(pel_used_t, carriers_used[0])) {
            nav.used.carriers_used[0] = 0; /* of what was used before nothing is forgotten */
        }
        pel_nav_note_used(&nav);
        TEST_ASSERT_TRUE(told());
        TEST_ASSERT_EQUAL_MEMORY(&good.used.preset_asked, &nav.used.preset_asked,
                                 offsetof(pel_used_t, imu_rate_hz) - offsetof(pel_used_t, preset_asked));
        pel_nav_note_used(&nav);
        TEST_ASSERT_FALSE(told());
    }
    for (int k = 0; k < 3; k++) {
        nav.station.r_ea_e[k] += 5e-5;
        pel_nav_note_used(&nav);
        TEST_ASSERT_FALSE(told()); /* a rounding */
        nav.station.r_ea_e[k] += 2e-4;
        pel_nav_note_used(&nav);
        TEST_ASSERT_TRUE(told());
    }
}

/* ---- reasons -------------------------------------------------------------------------------------------------------------------------- */

static void each_system_has_its_reason(void)
{
    begin(1.0);
    cfg.systems =
        (1u << PEL_SYS_GPS) | (1u << PEL_SYS_GAL) | (1u << PEL_SYS_BDS) | (1u << PEL_SYS_SBS) | (1u << PEL_SYS_QZS);
    carried_introduce(&world, &good, &cfg);
    nav = good;
    for (int i = 0; i < 3; i++) {
        carried_observe(&world, &base, &rover);
        const pel_obs_t model = rover.obs[0];
        static const uint8_t MORE[] = {PEL_SYS_GAL, PEL_SYS_SBS, PEL_SYS_GLO, PEL_SYS_BDS};
        for (int k = 0; k < 4; k++) {
            rover.obs[rover.n] = model;
            rover.obs[rover.n].sys = MORE[k];
            rover.obs[rover.n++].prn = 20;
        }
        base.obs[base.n] = model; /* of those it sees Galileo, of which no orbit is known */
        base.obs[base.n].sys = PEL_SYS_GAL;
        base.obs[base.n++].prn = 20;
        carried_push(&world, &nav, &base, &rover);
    }
    TEST_ASSERT_TRUE(nav.relative);
    TEST_ASSERT_EQUAL_INT(PEL_WHY_NONE, nav.used.sys_why[PEL_SYS_GPS]);
    TEST_ASSERT_EQUAL_INT(PEL_WHY_NO_ORBIT, nav.used.sys_why[PEL_SYS_GAL]);
    TEST_ASSERT_EQUAL_INT(PEL_WHY_NO_DATA, nav.used.sys_why[PEL_SYS_BDS]); /* of the base */
    TEST_ASSERT_EQUAL_INT(PEL_WHY_NO_DATA, nav.used.sys_why[PEL_SYS_QZS]); /* of anyone */
    TEST_ASSERT_EQUAL_INT(PEL_WHY_UNSUPPORTED, nav.used.sys_why[PEL_SYS_SBS]);
    TEST_ASSERT_EQUAL_INT(PEL_WHY_CONFIG, nav.used.sys_why[PEL_SYS_GLO]);
    TEST_ASSERT_EQUAL_INT(0, nav.used.rover_seen[PEL_SYS_GLO]);
    nav.relative = false; /* alone, an orbit is all that BeiDou lacks */
    pel_nav_note_used(&nav);
    TEST_ASSERT_EQUAL_INT(PEL_WHY_NO_ORBIT, nav.used.sys_why[PEL_SYS_BDS]);
}

static void a_preset_that_is_not_reached_says_why(void)
{
    static const struct {
        pel_preset_t asked;
        bool imu, with_base, station;
        int used, why;
    } of[] = {
        {PEL_PRESET_INS_RTK, true, true, true, PEL_PRESET_INS_RTK, PEL_WHY_NONE},
        {PEL_PRESET_INS_RTK, false, true, true, PEL_PRESET_RTK, PEL_WHY_NO_DATA},        /* no IMU */
        {PEL_PRESET_INS_RTK, true, false, true, PEL_PRESET_INS_SINGLE, PEL_WHY_NO_DATA}, /* no base */
        {PEL_PRESET_INS_RTK, true, true, false, PEL_PRESET_INS_SINGLE, PEL_WHY_NO_STATION},
        {PEL_PRESET_INS_SINGLE, false, false, true, PEL_PRESET_SINGLE, PEL_WHY_NO_DATA},
        {PEL_PRESET_RTK, false, false, true, PEL_PRESET_SINGLE, PEL_WHY_NO_DATA},
        {PEL_PRESET_RTK, true, true, false, PEL_PRESET_SINGLE, PEL_WHY_NO_STATION},
        {PEL_PRESET_AUTO, false, false, true, PEL_PRESET_SINGLE, PEL_WHY_NONE}, /* takes what there is */
    };
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        begin(1.0);
        cfg.preset = of[i].asked;
        carried_introduce(&world, &good, &cfg);
        nav = good;
        nav.have_station = of[i].station;
        for (int k = 0; k < 4; k++) {
            carried_observe(&world, &base, &rover);
            if (of[i].imu) {
                carried_push(&world, &nav, of[i].with_base ? &base : NULL, &rover);
                continue;
            }
            if (of[i].with_base) { pel_navigator_push_base(&nav, &base); }
            pel_navigator_push_rover(&nav, &rover);
        }
        while (pel_navigator_flush(&nav)) {}
        TEST_ASSERT_EQUAL_INT(of[i].asked, nav.used.preset_asked);
        TEST_ASSERT_EQUAL_INT(of[i].used, nav.used.preset_used);
        TEST_ASSERT_EQUAL_INT(of[i].why, nav.used.preset_why);
    }
}

/* ---- attitude as told --------------------------------------------------------------------------------------------------------------------- */

static void heading_is_told_from_north_clockwise(void)
{
    static const double HEADINGS[] = {0.3, 2.0, 3.5, 6.0};
    for (int i = 0; i < 4; i++) {
        begin(HEADINGS[i]);
        carried_run(&world, &good, 3);
        TEST_ASSERT_TRUE((good.epoch_solution.flags & PEL_SOL_HEADING) != 0);
        TEST_ASSERT_FLOAT_WITHIN(0.03f, (float)HEADINGS[i], good.epoch_solution.heading_rad);
        TEST_ASSERT_FLOAT_WITHIN(0.02f, 0.0f, good.epoch_solution.roll_rad);
        TEST_ASSERT_FLOAT_WITHIN(0.02f, 0.0f, good.epoch_solution.pitch_rad);
    }
}

static void a_heading_hardly_known_is_not_called_one(void)
{
    cfg.sd_heading_rad = 30.0 * PEL_DEG;
    carried_introduce(&world, &good, &cfg);
    carried_run(&world, &good, 3);
    TEST_ASSERT_TRUE(good.ins);
    TEST_ASSERT_EQUAL_INT(PEL_SOL_ATTITUDE, good.epoch_solution.flags & (PEL_SOL_ATTITUDE | PEL_SOL_HEADING));
    TEST_ASSERT_FLOAT_WITHIN(0.1f, 0.52f, good.epoch_solution.sd_heading_rad);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_change_is_told_once);
    RUN_TEST(each_system_has_its_reason);
    RUN_TEST(a_preset_that_is_not_reached_says_why);
    RUN_TEST(heading_is_told_from_north_clockwise);
    RUN_TEST(a_heading_hardly_known_is_not_called_one);
    return UNITY_END();
}

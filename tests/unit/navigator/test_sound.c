/* Memory that changed by itself: every count and index that is looked at, spoiled one by one, ends in a start from nothing that is counted. */
/* with: carried pair gnss */
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

static carried_t world;
static pel_navigator_t good, nav;
static pel_epoch_t base, rover;

/* One member and a value that it must not have; ESCAPES where more than one must change together. */
typedef struct {
    const char *name;
    size_t at, size;
    int64_t value;
} spoil_t;

#define SPOIL(member, v)                                                                                               \
    {                                                                                                                  \
#member, offsetof(pel_navigator_t, member), sizeof(((pel_navigator_t *)0)->member), v                          \
    }

static void spoil(const spoil_t *s)
{
    uint8_t *to = (uint8_t *)&nav + s->at;
    const int8_t v8 = (int8_t)s->value;
    const int16_t v16 = (int16_t)s->value;
    const int32_t v32 = (int32_t)s->value;
    switch (s->size) {
    case 1: memcpy(to, &v8, 1); break;
    case 2: memcpy(to, &v16, 2); break;
    case 4: memcpy(to, &v32, 4); break;
    default: TEST_FAIL_MESSAGE(s->name);
    }
}

/* Everything that was known is gone, what was asked for is not, and once told again the navigator works. */
static void begun_anew(const char *name)
{
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(good.counters.numeric_faults + 1, nav.counters.numeric_faults, name);
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(good.counters.restarts + 1, nav.counters.restarts, name);
    TEST_ASSERT_EQUAL_UINT32_MESSAGE(good.counters.imu_used, nav.counters.imu_used, name);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&good.cfg, &nav.cfg, sizeof good.cfg, name);
    TEST_ASSERT_FALSE_MESSAGE(nav.have_state || nav.ins || nav.attitude_given || nav.have_station, name);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, nav.orbits.n, name);
    for (int i = 0; i < world.pair.orbits.n; i++) { pel_navigator_push_ephemeris(&nav, &world.pair.orbits.eph[i]); }
    rover.t_ns += PEL_NS_PER_MS;
    pel_navigator_push_rover(&nav, &rover);
    while (pel_navigator_flush(&nav)) {}
    TEST_ASSERT_TRUE_MESSAGE(nav.have_state, name);
    rover.t_ns -= PEL_NS_PER_MS;
}

/* Found before the next epoch is used; what bounds an increment's work, also before the next increment. */
static void each_is_found(const spoil_t list[], size_t n, bool by_increments)
{
    TEST_ASSERT_TRUE(pel_nav_is_sound(&good));
    for (size_t i = 0; i < n; i++) {
        nav = good;
        spoil(&list[i]);
        TEST_ASSERT_FALSE_MESSAGE(pel_nav_is_sound(&nav), list[i].name);
        pel_navigator_push_rover(&nav, &rover);
        begun_anew(list[i].name);
        if (!by_increments) { continue; }
        nav = good;
        spoil(&list[i]);
        pel_imu_t imu = good.admit.last;
        imu.t_ns += CARRIED_IMU_NS;
        TEST_ASSERT_FALSE_MESSAGE(pel_nav_counts_are_sound(&nav), list[i].name);
        pel_navigator_push_imu(&nav, &imu);
        TEST_ASSERT_EQUAL_UINT32_MESSAGE(good.counters.numeric_faults + 1, nav.counters.numeric_faults, list[i].name);
        TEST_ASSERT_FALSE_MESSAGE(nav.have_state, list[i].name);
    }
}

#define EACH_IS_FOUND(list, by_increments) each_is_found(list, sizeof(list) / sizeof((list)[0]), by_increments)

/* Held integers, INS, a ring of increments, queues with epochs; no search under way. */
static void at_work(void)
{
    carried_init(&world, &good, 0.5, true);
    carried_run(&world, &good, 6);
    TEST_ASSERT_TRUE(good.ins);
    TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, good.last_fix);
    TEST_ASSERT_EQUAL_INT(PEL_NAV_SEARCH_NONE, good.search);
    carried_observe(&world, &base, &rover);
}

/* The same with a search that waits for its next slice. */
static void in_a_search(pel_nav_search_t which)
{
    carried_init(&world, &good, 0.5, true);
    good.cfg.slice_nodes = (which == PEL_NAV_SEARCH_FLOATS) ? 200 : 1;
    good.cfg.ratio_min = (which == PEL_NAV_SEARCH_FLOATS) ? 1e9f : good.cfg.ratio_min; /* no epoch alone is enough */
    pel_nav_seal_config(&good);
    for (int i = 0; i < 8; i++) {
        carried_observe(&world, &base, &rover);
        carried_imu_until(&world, &good, SKY_T0 + (world.pair.epoch - 1) * PEL_NS_PER_S);
        pel_navigator_push_base(&good, &base);
        pel_navigator_push_rover(&good, &rover);
        for (int k = 0; k < 40; k++) {
            const pel_imu_t imu = carried_imu(&world);
            pel_navigator_push_imu(&good, &imu);
            if (i > 1 && good.search == which) { return; }
        }
    }
    TEST_FAIL_MESSAGE("no search");
}

void setUp(void)
{
    at_work();
}

void tearDown(void) {}

static void counts_and_heads_of_what_waits(void)
{
    static const spoil_t LIST[] = {
        SPOIL(ring.head, PEL_IMU_RING),
        SPOIL(ring.n, PEL_IMU_RING + 1),
        SPOIL(poses.head, PEL_POSE_RING),
        SPOIL(poses.n, PEL_POSE_RING + 1),
        SPOIL(n_rover, -1),
        SPOIL(n_rover, PEL_ROVER_QUEUE + 1),
        SPOIL(n_base, -1),
        SPOIL(n_base, PEL_BASE_QUEUE + 1),
        SPOIL(n_sats, -1),
        SPOIL(n_sats, PEL_MAX_OBS + 1),
        SPOIL(orbits.n, -1),
        SPOIL(orbits.n, PEL_MAX_EPH + 1),
        SPOIL(track.n, -1),
        SPOIL(track.n, PEL_MAX_TRACKED + 1),
        SPOIL(search, 3),
        SPOIL(search, PEL_NAV_SEARCH_EPOCH), /* of no epoch */
        SPOIL(ud.n, 17),
        SPOIL(model.n, 17),
    };
    EACH_IS_FOUND(LIST, true);
}

static void what_an_epoch_reads(void)
{
    static const spoil_t LIST[] = {
        SPOIL(slip_rover.n, -1),
        SPOIL(slip_rover.n, PEL_MAX_OBS + 1),
        SPOIL(slip_base.n, PEL_MAX_OBS + 1),
        SPOIL(sd.n, PEL_MAX_OBS + 1),
        SPOIL(base[0].n, PEL_MAX_OBS + 1),
        SPOIL(base[1].obs[3].sys, PEL_N_SYS),
        SPOIL(base[2].obs[0].carrier, PEL_N_CARRIER),
        SPOIL(model.first[PEL_BLOCK_VELOCITY], 40),
        SPOIL(model.size[PEL_BLOCK_GYRO_CONSTANT], 0),
        SPOIL(ud.x[0], 1),
        SPOIL(ud.x[17], 0x3F800000),
        SPOIL(track.entry[0].state, -2),
        SPOIL(track.entry[0].state, PEL_MAX_STATES),
        SPOIL(vehicle.height_state, -2),
        SPOIL(vehicle.height_state, PEL_MAX_STATES),
        SPOIL(track.entry[0].rate, -2),
        SPOIL(track.entry[0].rate, PEL_MAX_STATES),
        SPOIL(track.entry[1].sys, PEL_N_SYS),
        SPOIL(track.entry[1].carrier, PEL_N_CARRIER),
        SPOIL(track.channels[0].state, -2),
        SPOIL(track.channels[1].state, PEL_MAX_STATES),
    };
    EACH_IS_FOUND(LIST, false);
}

static void epochs_that_wait(void)
{
    pel_epoch_t early = rover;
    early.t_ns -= 500 * PEL_NS_PER_MS;
    good.rover[0] = early;
    good.n_rover = 1;
    static const spoil_t LIST[] = {
        SPOIL(rover[0].n, PEL_MAX_OBS + 1),
        SPOIL(rover[0].obs[0].sys, 0xFF),
        SPOIL(rover[0].obs[1].carrier, PEL_N_CARRIER),
    };
    EACH_IS_FOUND(LIST, false);
}

static void states_fewer_than_the_model_or_more_than_there_is_room_for(void)
{
    static const int BAD[] = {17, 5, 0, -1, PEL_MAX_STATES + 1};
    for (int i = 0; i < 5; i++) {
        nav = good;
        nav.ud.n = nav.model.n = BAD[i];
        pel_navigator_push_rover(&nav, &rover);
        begun_anew("both counts");
    }
    nav = good;
    nav.ins = false; /* then the model is another */
    TEST_ASSERT_FALSE(pel_nav_is_sound(&nav));
}

/* Counts are looked at before each increment, the rest before the epoch that one makes due. */
static void an_increment_that_makes_an_epoch_due_finds_it_too(void)
{
    carried_imu_until(&world, &good, SKY_T0 + (world.pair.epoch - 1) * PEL_NS_PER_S);
    pel_navigator_push_base(&good, &base);
    pel_navigator_push_rover(&good, &rover);
    TEST_ASSERT_EQUAL_INT(1, good.n_rover);
    nav = good;
    nav.track.entry[0].state = -2;
    TEST_ASSERT_TRUE(pel_nav_counts_are_sound(&nav));
    for (int i = 0; i < 20; i++) {
        const pel_imu_t imu = carried_imu(&world);
        pel_navigator_push_imu(&nav, &imu);
    }
    TEST_ASSERT_EQUAL_UINT32(good.counters.numeric_faults + 1, nav.counters.numeric_faults);
    TEST_ASSERT_EQUAL_INT(0, nav.n_rover);
    TEST_ASSERT_FALSE(nav.have_state);
}

/* Without a state nothing is asked of a filter that is not used. */
static void before_the_start_a_filter_does_not_matter(void)
{
    nav = good;
    nav.have_state = nav.ins = false;
    nav.ud.n = -1;
    nav.track.entry[0].state = -2;
    TEST_ASSERT_TRUE(pel_nav_is_sound(&nav));
}

static const spoil_t SEARCH[] = {
    SPOIL(problem.n_rows, -1),
    SPOIL(problem.n_rows, PEL_MAX_AMB + 1),
    SPOIL(update.chosen.n, PEL_MAX_AMB + 1),
    SPOIL(problem.n_groups, PEL_AMB_GROUPS + 1),
    SPOIL(sd.n, -1),
    SPOIL(sd.n, PEL_MAX_OBS + 1),
    SPOIL(update.row_of[0], -1),
    SPOIL(update.row_of[1], PEL_MAX_OBS),
    SPOIL(problem.row[2].group, PEL_AMB_GROUPS),
    SPOIL(update.ant.i_psi, -2),
    SPOIL(update.ant.i_psi, PEL_MAX_STATES),
    SPOIL(update.ant.i_v, -1),
    SPOIL(update.ant.i_r, PEL_MAX_STATES - 2),
    SPOIL(search, 3),
    SPOIL(n_rover, 0),
    SPOIL(ils.n, PEL_MAX_AMB + 1),
    SPOIL(ils.level, PEL_MAX_AMB + 1),
    SPOIL(ils.n_notes, -1),
    SPOIL(ils.n_notes, PEL_ILS_NOTES + 1),
    SPOIL(ils.n_held, PEL_ILS_HELD + 1),
    SPOIL(ils.n_best, PEL_ILS_BEST + 1),
    SPOIL(ils.n_found, PEL_ILS_BEST + 1),
};

static void a_search_of_the_epoch_under_way(void)
{
    in_a_search(PEL_NAV_SEARCH_EPOCH);
    TEST_ASSERT_EQUAL_INT(1, good.n_rover);
    carried_observe(&world, &base, &rover);
    EACH_IS_FOUND(SEARCH, true);
}

static void a_search_of_the_floats_under_way(void)
{
    in_a_search(PEL_NAV_SEARCH_FLOATS);
    TEST_ASSERT_GREATER_THAN(4, good.update.chosen.n);
    carried_observe(&world, &base, &rover);
    EACH_IS_FOUND(SEARCH, true);
    nav = good;
    nav.update.chosen.entry[1] = (uint8_t)nav.track.n; /* beyond those that are there */
    TEST_ASSERT_FALSE(pel_nav_counts_are_sound(&nav));
    nav = good;
    nav.track.entry[nav.update.chosen.entry[0]].state = -1; /* no float any more */
    TEST_ASSERT_FALSE(pel_nav_counts_are_sound(&nav));
}

/* ---- what is sealed between two pushes ---------------------------------------------------------------------------------- */

static void a_state_that_changed_is_no_state(void)
{
    static const size_t MEMBERS[] = {
        offsetof(pel_navigator_t, at_horizon.r_eb_e[0]), offsetof(pel_navigator_t, at_horizon.C_b_e[2][2]),
        offsetof(pel_navigator_t, at_horizon.t_ns), offsetof(pel_navigator_t, now.v_eb_e[1])};
    for (int i = 0; i < 8; i++) {
        nav = good;
        ((uint8_t *)&nav)[MEMBERS[i % 4]] ^= 0x10;
        if (i < 4) {
            pel_navigator_push_rover(&nav, &rover);
        } else {
            pel_navigator_push_base(&nav, &base);
        }
        TEST_ASSERT_EQUAL_UINT32(good.counters.numeric_faults + 1, nav.counters.numeric_faults);
        TEST_ASSERT_EQUAL_UINT32(good.counters.restarts + 1, nav.counters.restarts);
        TEST_ASSERT_FALSE(nav.ins || nav.have_state);
        TEST_ASSERT_TRUE(nav.have_station); /* what did not change is still known */
        carried_imu_until(&world, &nav, good.last_imu_ns + CARRIED_IMU_NS);
        TEST_ASSERT_EQUAL_UINT32(good.counters.numeric_faults + 1, nav.counters.numeric_faults); /* told once */
    }
}

static void a_station_that_changed_is_unknown_until_it_is_told_again(void)
{
    nav = good;
    ((uint8_t *)&nav.station.r_ea_e[1])[6] ^= 1;
    pel_navigator_push_base(&nav, &base);
    TEST_ASSERT_EQUAL_UINT32(good.counters.numeric_faults + 1, nav.counters.numeric_faults);
    TEST_ASSERT_FALSE(nav.have_station);
    TEST_ASSERT_TRUE(nav.have_state);
    pel_navigator_push_station(&nav, &good.station);
    TEST_ASSERT_TRUE(nav.have_station);
    TEST_ASSERT_EQUAL_UINT32(good.counters.numeric_faults + 1, nav.counters.numeric_faults);
}

/* Settings cannot be asked for again: nothing is used until a product starts the navigator anew. */
static void settings_that_changed_stop_everything(void)
{
    pel_station_t moved = good.station;
    pel_ephemeris_t eph = world.pair.orbits.eph[0];
    moved.r_ea_e[0] += 100.0;
    eph.iode++;
    good.rover[0] = rover;
    good.n_rover = 1;
    nav = good;
    nav.cfg.mask_rad += 1e-9;
    TEST_ASSERT_TRUE(pel_navigator_is_broken(&nav));
    const pel_navigator_t before = nav;
    pel_navigator_push_rover(&nav, &rover);
    pel_navigator_push_base(&nav, &base);
    pel_navigator_push_station(&nav, &moved);
    pel_navigator_push_ephemeris(&nav, &eph);
    const pel_baro_t baro = {.t_ns = good.last_imu_ns, .height_m = 50.0, .sd_m = 0.1f};
    pel_navigator_push_baro(&nav, &baro);
    TEST_ASSERT_FALSE(pel_navigator_flush(&nav));
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav, sizeof nav);
    pel_navigator_t *const n = &nav; /* increments go on, epochs that wait for them do not */
    for (int i = 0; i < 120; i++) {
        const pel_imu_t imu = carried_imu(&world);
        pel_navigator_push_imu(n, &imu);
    }
    TEST_ASSERT_EQUAL_INT(1, nav.n_rover);
    TEST_ASSERT_EQUAL_UINT32(good.counters.epochs_used, nav.counters.epochs_used);
}

/* An increment that changed in the ring: nobody knows which others did. It is found by the epoch that needs it, or before that by what keeps the
 * horizon near to now. */
static void an_increment_that_changed_ends_the_ins(void)
{
    const pel_time_t epoch_ns = SKY_T0 + (world.pair.epoch - 1) * PEL_NS_PER_S;
    const carried_t before = world;
    for (int late = 0; late < 2; late++) {
        nav = good;
        world = before;
        carried_imu_until(&world, &nav, epoch_ns + (late ? 0 : 100) * PEL_NS_PER_MS);
        pel_navigator_push_base(&nav, &base);
        pel_navigator_push_rover(&nav, &rover);
        const pel_imu_t *newest = pel_imu_ring_newest(&nav.ring);
        nav.ring.imu[newest - nav.ring.imu].upsilon_ib_b[0] += 1e-9;
        carried_imu_until(&world, &nav, epoch_ns + 200 * PEL_NS_PER_MS);
        TEST_ASSERT_GREATER_THAN_UINT32(good.counters.numeric_faults, nav.counters.numeric_faults);
        TEST_ASSERT_EQUAL_UINT32(good.counters.restarts + 1, nav.counters.restarts);
        TEST_ASSERT_FALSE(nav.ins);
        TEST_ASSERT_TRUE(nav.have_state);
        TEST_ASSERT_LESS_THAN_DOUBLE(20.0, carried_error_m(&world, &nav));
        carried_run(&world, &nav, 3);
        TEST_ASSERT_EQUAL_INT(PEL_FIX_FIXED, nav.last_fix);
        TEST_ASSERT_LESS_THAN_DOUBLE(0.05, carried_error_m(&world, &nav));
    }
}

/* Found while the output is carried to now: the epoch's own result stays, as that of GNSS alone. */
static void an_increment_that_changed_behind_an_epoch_ends_the_ins(void)
{
    pel_navigator_t *const n = &nav;
    nav = good;
    const pel_imu_t *newest = pel_imu_ring_newest(&nav.ring);
    nav.ring.imu[newest - nav.ring.imu].alpha_ib_b[2] += 1e-9;
    pel_nav_predict_now(n);
    TEST_ASSERT_FALSE(nav.ins);
    TEST_ASSERT_EQUAL_INT(0, nav.ring.n);
    TEST_ASSERT_EQUAL_UINT32(good.counters.numeric_faults + 1, nav.counters.numeric_faults);
    TEST_ASSERT_EQUAL_UINT32(good.counters.restarts + 1, nav.counters.restarts);
    TEST_ASSERT_EQUAL_MEMORY(&good.at_horizon.r_eb_e, &nav.at_horizon.r_eb_e, sizeof nav.at_horizon.r_eb_e);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(counts_and_heads_of_what_waits);
    RUN_TEST(what_an_epoch_reads);
    RUN_TEST(epochs_that_wait);
    RUN_TEST(states_fewer_than_the_model_or_more_than_there_is_room_for);
    RUN_TEST(an_increment_that_makes_an_epoch_due_finds_it_too);
    RUN_TEST(before_the_start_a_filter_does_not_matter);
    RUN_TEST(a_search_of_the_epoch_under_way);
    RUN_TEST(a_search_of_the_floats_under_way);
    RUN_TEST(a_state_that_changed_is_no_state);
    RUN_TEST(a_station_that_changed_is_unknown_until_it_is_told_again);
    RUN_TEST(settings_that_changed_stop_everything);
    RUN_TEST(an_increment_that_changed_ends_the_ins);
    RUN_TEST(an_increment_that_changed_behind_an_epoch_ends_the_ins);
    return UNITY_END();
}

/* Phases of a receiver without a base, piece by piece: whom new ones refer to, no room, heirs without rates, what is not seen. */
/* with: carried pair gnss */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

static carried_t world;
static pel_navigator_t good, nav;
static pel_epoch_t base, rover;

static void begin(double rate_mps)
{
    carried_init(&world, &good, 1.0, true);
    pel_nav_config_t cfg = good.cfg;
    cfg.preset = PEL_PRESET_INS_TDCP;
    cfg.single_rate_mps = rate_mps;
    cfg.slice_nodes = 0;
    carried_introduce(&world, &good, &cfg);
    for (int i = 0; i < 8; i++) {
        carried_observe(&world, &base, &rover);
        carried_push(&world, &good, NULL, &rover);
    }
    TEST_ASSERT_TRUE(good.ins && good.update.phased && good.track.of_rover);
    nav = good;
}

void setUp(void)
{
    begin(0.0);
}

void tearDown(void) {}

static pel_tracked_t *datum(void)
{
    for (int i = 0; i < nav.track.n; i++) {
        if (nav.track.entry[i].state < 0) { return &nav.track.entry[i]; }
    }
    return NULL;
}

static pel_tracked_t *tracked(const pel_sd_t *sd)
{
    return pel_nav_track_find(&nav, sd->sys, sd->prn, sd->carrier);
}

static pel_sd_t *row_of(const pel_tracked_t *t)
{
    int i = 0;
    while (nav.sd.sd[i].prn != t->prn || nav.sd.sd[i].carrier != t->carrier) { i++; }
    return &nav.sd.sd[i];
}

/* A row of a satellite that has just risen. */
static pel_sd_t *new_row(void)
{
    pel_sd_t *sd = &nav.sd.sd[nav.sd.n++];
    *sd = nav.sd.sd[1];
    sd->prn = 32;
    sd->pivot = false;
    return sd;
}

static void nothing_begins_without_a_phase_that_is_known(void)
{
    const pel_track_t before = nav.track;
    for (int i = 0; i < nav.sd.n; i++) { nav.sd.sd[i].has_phase = false; }
    pel_nav_rover_phase_begin(&nav);
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.track, sizeof before);
    nav = good;
    for (int i = 0; i < nav.sd.n; i++) { nav.sd.sd[i].prn = (uint8_t)(nav.sd.sd[i].prn + 40); } /* others alone */
    pel_nav_rover_phase_begin(&nav);
    TEST_ASSERT_EQUAL_INT(before.n, nav.track.n);
}

static void a_new_phase_refers_to_the_datum_or_to_another_that_is_there(void)
{
    for (int without = 0; without < 2; without++) {
        nav = good;
        pel_sd_t *sd = new_row();
        sd->phase_m += 50.0;
        if (without) { row_of(datum())->has_phase = false; }
        pel_nav_rover_phase_begin(&nav);
        const pel_tracked_t *t = tracked(sd), *d = datum();
        TEST_ASSERT_NOT_NULL(t);
        TEST_ASSERT_TRUE(t->state >= 0);
        /* its offset against the datum, to what the float one between is off */
        TEST_ASSERT_DOUBLE_WITHIN(without ? 0.5 : 1e-9, sd->phase_m - row_of(d)->phase_m, t->N);
    }
    nav = good;
    pel_sd_t *sd = new_row();
    sd->has_phase = false;
    pel_nav_rover_phase_begin(&nav);
    TEST_ASSERT_NULL(tracked(sd));
}

/* No state left for it, or none for its rate, or no place in the list: it is not begun by halves. */
static void a_phase_without_room_is_not_begun(void)
{
    for (int full = 0; full < 3; full++) {
        begin(full == 1 ? 1e-3 : 0.0);
        pel_sd_t *sd = new_row();
        const int states = PEL_MAX_STATES - (full == 1 ? 1 : 0);
        while (full < 2 && nav.ud.n < states) {
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_insert(&nav.ud, nav.ud.n, PEL_R(1.0)));
        }
        nav.model.n = nav.ud.n;
        for (; full == 2 && nav.track.n < PEL_MAX_TRACKED;
             nav.track.n++) { /* all seen, of signals that are no carriers */
            nav.track.entry[nav.track.n] = nav.track.entry[0];
        }
        const int n = nav.track.n;
        pel_nav_rover_phase_begin(&nav);
        TEST_ASSERT_NULL(tracked(sd));
        TEST_ASSERT_EQUAL_INT(n, nav.track.n);
        TEST_ASSERT_EQUAL_INT(nav.ud.n, nav.model.n);
    }
}

static void a_datum_that_slipped_is_no_state_to_be_widened(void)
{
    const double N = datum()->N;
    datum()->slipped = true;
    const pel_ud_t before = nav.ud;
    pel_nav_rover_phase_begin(&nav);
    TEST_ASSERT_EQUAL_DOUBLE(N, datum()->N);
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.ud, sizeof before);
}

static void a_datum_alone_has_no_heir(void)
{
    for (int i = nav.track.n - 1; i >= 0; i--) {
        if (nav.track.entry[i].state >= 0) { pel_nav_track_drop_entry(&nav, i); }
    }
    TEST_ASSERT_EQUAL_INT(1, nav.track.n);
    const pel_ud_t before = nav.ud;
    pel_nav_rover_phase_slip(&nav, datum());
    TEST_ASSERT_TRUE(datum()->slipped);
    nav.track.wandered_ns = nav.at_horizon.t_ns - PEL_NS_PER_S;
    pel_nav_rover_phase_walk(&nav); /* and its walk moves nobody */
    TEST_ASSERT_EQUAL_MEMORY(&before, &nav.ud, sizeof before);
}

/* Rates are handed over where both have one. */
static void an_heir_without_a_rate_takes_the_number_alone(void)
{
    begin(1e-3);
    int last = 0;
    for (int i = 0; i < nav.track.n; i++) {
        if (nav.track.entry[i].state > nav.track.entry[last].state) { last = i; }
    }
    pel_tracked_t *heir = &nav.track.entry[last], *old = datum();
    const double N = heir->N;
    heir->rate = -1;
    pel_nav_rover_phase_slip(&nav, old);
    TEST_ASSERT_EQUAL_INT(-1, heir->state);
    TEST_ASSERT_EQUAL_DOUBLE(-N, old->N);
    TEST_ASSERT_EQUAL_INT(-1, old->rate);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&nav.ud));
}

static void offsets_walk_with_time_and_not_back_seen_or_not(void)
{
    const double seen = carried_wandered_by(&nav, pel_nav_rover_phase_walk, 1.0);
    TEST_ASSERT_TRUE(seen > 0.0);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, carried_wandered_by(&nav, pel_nav_rover_phase_walk, 0.3)); /* with the next epoch */
    TEST_ASSERT_EQUAL_DOUBLE(0.0, carried_wandered_by(&nav, pel_nav_rover_phase_walk, -2.0));
    nav = good;
    for (int i = 0; i < nav.sd.n; i++) {
        nav.sd.sd[i].sys = PEL_SYS_GAL;
    } /* no one is seen: paths walk, phases make no noise */
    const double unseen = carried_wandered_by(&nav, pel_nav_rover_phase_walk, 1.0);
    TEST_ASSERT_TRUE(unseen > 0.0);
    TEST_ASSERT_TRUE(unseen < seen);
}

/* Lines of sight of a phase's beginning, where both have one. */
static void rows_of_unknown_phases_have_their_own_lines_of_sight(void)
{
    pel_row_t old, own;
    pel_antenna_t ant;
    double r[3], v[3];
    pel_nav_antenna(&nav, &ant, r, v);
    const pel_sd_t a = *row_of(datum()), b = nav.sd.sd[1].prn == a.prn ? nav.sd.sd[2] : nav.sd.sd[1];
    pel_observe_range(&ant, &b, &a, 1.0, &own);
    tracked(&b)->u_e[0] += 0.01f;
    pel_nav_rover_phase_row(&nav, &ant, &b, &a, 1.0, &old);
    const int i_r = pel_model_index(&nav.model, PEL_BLOCK_POSITION);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.01, fabs((double)(old.h[i_r] - own.h[i_r])));
    for (int who = 0; who < 2; who++) {
        pel_sd_t stranger = (who == 0) ? a : b;
        stranger.prn = 32;
        pel_nav_rover_phase_row(&nav, &ant, (who == 0) ? &b : &stranger, (who == 0) ? &stranger : &a, 1.0, &old);
        TEST_ASSERT_TRUE(old.h[i_r] == own.h[i_r]);
    }
}

/* Numbers belong to a base or to the rover alone; who comes next clears those of the other, unless a base may return. */
static void numbers_have_one_owner(void)
{
    TEST_ASSERT_TRUE(pel_nav_track_claim(&nav, true));
    TEST_ASSERT_EQUAL_INT(0, nav.track.n);
    TEST_ASSERT_FALSE(nav.track.of_rover);
    nav = good;
    nav.track.of_rover = false; /* as if they were against a base: of which there is none any more */
    TEST_ASSERT_TRUE(pel_nav_track_claim(&nav, false));
    TEST_ASSERT_EQUAL_INT(0, nav.track.n);
    nav = good;
    nav.track.of_rover = false;
    nav.n_base = 1; /* one that was here a minute ago */
    nav.base[0].t_ns = nav.at_horizon.t_ns - 60 * PEL_NS_PER_S;
    TEST_ASSERT_FALSE(pel_nav_track_claim(&nav, false));
    TEST_ASSERT_EQUAL_INT(good.track.n, nav.track.n);
    nav.base[0].t_ns = nav.at_horizon.t_ns - 121 * PEL_NS_PER_S;
    TEST_ASSERT_TRUE(pel_nav_track_claim(&nav, false));
    TEST_ASSERT_TRUE(nav.track.of_rover);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nothing_begins_without_a_phase_that_is_known);
    RUN_TEST(a_new_phase_refers_to_the_datum_or_to_another_that_is_there);
    RUN_TEST(a_phase_without_room_is_not_begun);
    RUN_TEST(a_datum_that_slipped_is_no_state_to_be_widened);
    RUN_TEST(a_datum_alone_has_no_heir);
    RUN_TEST(an_heir_without_a_rate_takes_the_number_alone);
    RUN_TEST(offsets_walk_with_time_and_not_back_seen_or_not);
    RUN_TEST(rows_of_unknown_phases_have_their_own_lines_of_sight);
    RUN_TEST(numbers_have_one_owner);
    return UNITY_END();
}

/* sound.c - memory that changed by itself: a flipped index must not become a write elsewhere, a flipped setting not a confident error.
 * What is looked at, and what it costs, is in docs/SURVIVAL.md. */
#include <string.h>

#include "internal.h"

#include "pelorus/bits.h"

#define SEED UINT32_C(0x50454C31)

_Static_assert(sizeof(pel_nav_config_t) % 4 == 0 && sizeof(pel_strapdown_t) % 4 == 0, "checked by words");

void pel_nav_seal_config(pel_navigator_t *nav)
{
    nav->cfg_check = pel_word_check(&nav->cfg, sizeof nav->cfg, SEED);
}

static uint32_t state_check(const pel_navigator_t *nav)
{
    const uint32_t axes = (uint32_t)nav->local * UINT32_C(0x9E3779B9);
    return pel_word_check(&nav->at_horizon, sizeof nav->at_horizon, SEED) ^
           ~pel_word_check(&nav->now, sizeof nav->now, SEED) ^ axes;
}

void pel_nav_seal_state(pel_navigator_t *nav)
{
    nav->state_check = state_check(nav);
}

void pel_nav_check_state(pel_navigator_t *nav)
{
    if (nav->state_check == state_check(nav)) { return; }
    nav->counters.numeric_faults++;
    nav->counters.restarts++;
    nav->search = PEL_NAV_SEARCH_NONE; /* of an epoch that belonged to it */
    nav->n_rover = 0;
    pel_nav_stop(nav);
}

void pel_nav_seal_station(pel_navigator_t *nav)
{
    nav->station_check = pel_word_check(nav->station.r_ea_e, sizeof nav->station.r_ea_e, SEED);
}

void pel_nav_check_station(pel_navigator_t *nav)
{
    if (!nav->have_station) { return; }
    if (nav->station_check == pel_word_check(nav->station.r_ea_e, sizeof nav->station.r_ea_e, SEED)) { return; }
    nav->counters.numeric_faults++;
    nav->have_station = false;
}

bool pel_navigator_is_broken(const pel_navigator_t *nav)
{
    return nav->cfg_check != pel_word_check(&nav->cfg, sizeof nav->cfg, SEED);
}

static bool within(int n, int most)
{
    return n >= 0 && n <= most;
}

static bool epoch_is_sound(const pel_epoch_t *e)
{
    if (e->n > PEL_MAX_OBS) { return false; }
    for (int i = 0; i < e->n; i++) {
        if (e->obs[i].sys >= PEL_N_SYS || e->obs[i].carrier >= PEL_N_CARRIER) { return false; }
    }
    return true;
}

/* The blocks that are read without asking whether they are there, at their places; the counts are sound. */
static bool model_is_sound(const pel_navigator_t *nav)
{
    pel_model_t expected;
    if (nav->ins) {
        pel_nav_preset(nav->cfg.preset)->model(&expected, &nav->cfg.imu);
    } else {
        pel_model_gnss(&expected, &nav->cfg.imu);
    }
    return nav->model.n >= expected.n && memcmp(nav->model.first, expected.first, sizeof expected.first) == 0 &&
           memcmp(nav->model.size, expected.size, sizeof expected.size) == 0;
}

/* Every push ends with the loop closed: what is in x between two of them is nobody's. */
static bool loop_is_closed(const pel_navigator_t *nav)
{
    for (int i = 0; i < nav->ud.n; i++) {
        if (nav->ud.x[i] != PEL_R(0.0)) { return false; }
    }
    return true;
}

static bool track_is_sound(const pel_navigator_t *nav)
{
    for (int i = 0; i < nav->track.n; i++) {
        const pel_tracked_t *t = &nav->track.entry[i];
        if (t->state < -1 || t->state >= nav->ud.n || t->rate < -1 || t->rate >= nav->ud.n || t->sys >= PEL_N_SYS ||
            t->carrier >= PEL_N_CARRIER) {
            return false;
        }
    }
    for (int i = 0; i < PEL_GLO_CARRIERS; i++) {
        const int state = nav->track.channels[i].state;
        if (state < -1 || state >= nav->ud.n) { return false; }
    }
    return nav->vehicle.height_state >= -1 && nav->vehicle.height_state < nav->ud.n;
}

/* A search that goes on in the next push. */
static bool search_is_sound(const pel_navigator_t *nav)
{
    const pel_ils_t *ils = &nav->ils;
    if (nav->search == PEL_NAV_SEARCH_NONE) { return true; }
    if (!within(nav->problem.n_rows, PEL_MAX_AMB) || !within(nav->update.chosen.n, PEL_MAX_AMB) ||
        !within(nav->problem.n_groups, PEL_AMB_GROUPS) || !within(nav->sd.n, PEL_MAX_OBS)) {
        return false;
    }
    for (int i = 0; i < nav->problem.n_rows; i++) {
        if (nav->update.row_of[i] >= PEL_MAX_OBS || nav->problem.row[i].group >= PEL_AMB_GROUPS) { return false; }
    }
    for (int i = 0; i < nav->update.chosen.n; i++) {
        const uint8_t entry = nav->update.chosen.entry[i];
        if (entry >= nav->track.n || nav->track.entry[entry].state < 0) { return false; }
    }
    /* Its n_states may be of before ambiguities were dropped; rows that come take the model's. */
    const pel_antenna_t *ant = &nav->update.ant;
    const int last = nav->ud.n - 3;
    if (ant->i_psi < -1 || ant->i_psi > last || !within(ant->i_v, last) || !within(ant->i_r, last)) { return false; }
    return (nav->search == PEL_NAV_SEARCH_EPOCH || nav->search == PEL_NAV_SEARCH_FLOATS) && nav->n_rover > 0 &&
           within(ils->n, PEL_MAX_AMB) && within(ils->level, PEL_MAX_AMB) && within(ils->n_notes, PEL_ILS_NOTES) &&
           within(ils->n_held, PEL_ILS_HELD) && within(ils->n_best, PEL_ILS_BEST) && within(ils->n_found, PEL_ILS_BEST);
}

bool pel_nav_counts_are_sound(const pel_navigator_t *nav)
{
    return nav->ring.head < PEL_IMU_RING && nav->ring.n <= PEL_IMU_RING && nav->poses.head < PEL_POSE_RING &&
           nav->poses.n <= PEL_POSE_RING && within(nav->n_rover, PEL_ROVER_QUEUE) &&
           within(nav->n_base, PEL_BASE_QUEUE) && within(nav->n_sats, PEL_MAX_OBS) &&
           within(nav->orbits.n, PEL_MAX_EPH) && within(nav->track.n, PEL_MAX_TRACKED) && search_is_sound(nav) &&
           (!nav->have_state || (nav->ud.n == nav->model.n && within(nav->ud.n, PEL_MAX_STATES)));
}

bool pel_nav_is_sound(const pel_navigator_t *nav)
{
    bool sound = pel_nav_counts_are_sound(nav) && within(nav->slip_rover.n, PEL_MAX_OBS) &&
                 within(nav->slip_base.n, PEL_MAX_OBS) && within(nav->sd.n, PEL_MAX_OBS);
    for (int i = 0; sound && i < nav->n_rover; i++) { sound = epoch_is_sound(&nav->rover[i]); }
    for (int i = 0; sound && i < nav->n_base; i++) { sound = epoch_is_sound(&nav->base[i]); }
    return sound && (!nav->have_state || (model_is_sound(nav) && track_is_sound(nav) && loop_is_closed(nav)));
}

void pel_nav_begin_anew(pel_navigator_t *nav)
{
    const pel_nav_config_t cfg = nav->cfg;
    const uint32_t check = nav->cfg_check;
    const pel_nav_counters_t counters = nav->counters;
    pel_navigator_init(nav, &cfg);
    nav->cfg_check = check; /* of what was given, not of what is there now */
    nav->attitude_given = false;
    nav->counters = counters;
    nav->counters.numeric_faults++;
    nav->counters.restarts++;
}

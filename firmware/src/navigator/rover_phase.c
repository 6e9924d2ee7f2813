/* rover_phase.c - the phases of a receiver without a base: S3's float form (6.2b) of time-differenced phases.
 *
 * Nothing is differenced in time. Each phase's offset against one datum (ambiguity, satellite clock, path) is a filter state of track.c
 * that begins free and walks; the geometry of every later epoch is then known against that of the first. This equals all time
 * differences of the pass with their correlation, as long as the offsets do what they are said to. What a base would take away walks here:
 * satellite clocks and orbits, ionosphere, troposphere. */
#include "internal.h"

#include "pelorus/math.h"

#define BASE_RETURNS_NS (120 * PEL_NS_PER_S) /* numbers against a base that is silent are kept so long */
#define WANDER_EVERY_S  0.4
#define RATE_WALK       (1.0 / 45.0) /* of a rate, in a second, of its 1 sigma: another one in half an hour */
#define FEWEST_ROWS     3
#define CARRIED_S       1.0
#define TURNED_RAD      0.05  /* six minutes of a satellite's way */
#define FLOAT_SD_M      100.0 /* of a new offset */

bool pel_nav_track_claim(pel_navigator_t *nav, bool relative)
{
    if (!relative && (nav->cfg.observe & PEL_OBS_PHASE) == 0) { return false; }
    if (!relative && !nav->ins && (nav->cfg.observe & PEL_OBS_CODE) == 0) { return false; } /* nothing else holds it */
    if (!relative && !(nav->last_imu_ns != 0 && pel_nav_preset(nav->cfg.preset)->rover_phase)) { return false; }
    if (nav->track.n > 0 && nav->track.of_rover == relative) {
        const bool base_may_return =
            !relative && nav->n_base > 0 && nav->base[nav->n_base - 1].t_ns > nav->at_horizon.t_ns - BASE_RETURNS_NS;
        if (base_may_return) { return false; }
        pel_nav_track_clear(nav);
    }
    nav->track.of_rover = !relative;
    return true;
}

/* ---- begin ------------------------------------------------------------------------------------------------------------ */

static bool is_usable(const pel_sd_t *sd)
{
    return sd->has_phase;
}

static bool has_phase_of(const pel_navigator_t *nav, const pel_sd_t *sd)
{
    for (int i = 0; i < nav->track.n; i++) {
        const pel_tracked_t *t = &nav->track.entry[i];
        if (t->sys == sd->sys && t->prn == sd->prn) { return true; }
    }
    return false;
}

/* A phase of this epoch that has an N, the datum's if it is there; else the highest becomes the datum. NULL: no phase. */
static const pel_sd_t *reference(pel_navigator_t *nav)
{
    const pel_sd_t *ref = NULL, *highest = NULL;
    for (int i = 0; i < nav->sd.n; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        if (!is_usable(sd)) { continue; }
        const pel_tracked_t *t = pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier);
        if (t != NULL && t->state < 0) { return sd; }
        if (t != NULL && !t->slipped) { ref = sd; }
        if (highest == NULL || sd->el_rad > highest->el_rad) { highest = sd; }
    }
    if (ref != NULL || highest == NULL || nav->track.n > 0) { return ref; }
    (void)pel_nav_track_get_or_add(nav, highest);
    return highest;
}

/* It begins where its row says nothing: what its code knows is told by the code's row. */
static void begin_at(pel_tracked_t *t, const pel_sd_t *sd, const pel_sd_t *ref, double N_ref)
{
    t->N = sd->phase_m - ref->phase_m + N_ref;
    t->half = sd->half;
    for (int k = 0; k < 3; k++) { t->u_e[k] = (float)sd->u_e[k]; }
}

static bool add_rate(pel_navigator_t *nav, pel_tracked_t *t)
{
    const double sd_mps = nav->cfg.single_rate_mps;
    if (!(sd_mps > 0.0)) { return true; }
    if (pel_ud_insert(&nav->ud, nav->ud.n, (pel_real)(sd_mps * sd_mps)) != PEL_OK) { return false; }
    t->rate = (int16_t)(nav->ud.n - 1);
    nav->model.n = nav->ud.n;
    return true;
}

static void begin_float(pel_navigator_t *nav, const pel_sd_t *sd, const pel_sd_t *ref)
{
    const pel_tracked_t *t_ref = pel_nav_track_find(nav, ref->sys, ref->prn, ref->carrier);
    const double N_ref = (t_ref != NULL) ? t_ref->N : 0.0;
    pel_tracked_t *t = pel_nav_track_get_or_add(nav, sd);
    if (t == NULL) { return; }
    begin_at(t, sd, ref, N_ref);
    if (!pel_nav_track_add_state(nav, t, FLOAT_SD_M) || !add_rate(nav, t)) {
        pel_nav_track_drop_entry(nav, (int)(t - nav->track.entry));
    }
}

/* Those that slipped, where they are. */
static void restart_slipped(pel_navigator_t *nav, const pel_sd_t *ref)
{
    const pel_tracked_t *t_ref = pel_nav_track_find(nav, ref->sys, ref->prn, ref->carrier);
    for (int i = 0; i < nav->sd.n; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        pel_tracked_t *t = is_usable(sd) ? pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier) : NULL;
        if (t == NULL || t_ref == NULL || !t->slipped || t->state < 0) { continue; }
        begin_at(t, sd, ref, t_ref->N);
        t->slipped = pel_ud_set_variance(&nav->ud, t->state, (pel_real)(FLOAT_SD_M * FLOAT_SD_M)) != PEL_OK;
    }
}

/* x_i := x_i - x_heir for all others costs nothing while they stand before it. */
static pel_tracked_t *make_heir(pel_navigator_t *nav)
{
    pel_tracked_t *heir = NULL;
    for (int i = 0; i < nav->track.n; i++) {
        pel_tracked_t *t = &nav->track.entry[i];
        if (t->state >= 0 && (heir == NULL || t->state > heir->state)) { heir = t; }
    }
    for (int i = 0; heir != NULL && i < nav->track.n; i++) {
        pel_tracked_t *t = &nav->track.entry[i];
        if (t == heir || t->state < 0) { continue; }
        (void)pel_ud_combine(&nav->ud, t->state, heir->state, PEL_R(-1.0));
        t->N -= heir->N;
        if (t->rate < 0 || heir->rate < 0) { continue; }
        (void)pel_ud_combine(&nav->ud, t->rate, heir->rate, PEL_R(-1.0));
        t->rate_mps -= heir->rate_mps;
    }
    return heir;
}

void pel_nav_rover_phase_hand_over(pel_navigator_t *nav)
{
    for (int i = 0; i < nav->track.n; i++) {
        if (nav->track.entry[i].state < 0) { return; }
    }
    pel_tracked_t *heir = make_heir(nav);
    if (heir == NULL) { return; }
    pel_nav_track_remove_state(nav, heir);
    heir->N = heir->rate_mps = 0.0;
}

/* The datum's rate is known against the others': it changes places with its heir. */
void pel_nav_rover_phase_slip(pel_navigator_t *nav, pel_tracked_t *t)
{
    t->slipped = true;
    if (t->state >= 0) { return; }
    pel_tracked_t *heir = make_heir(nav);
    if (heir == NULL) { return; }
    (void)pel_ud_negate(&nav->ud, heir->state);
    if (heir->rate >= 0) { (void)pel_ud_negate(&nav->ud, heir->rate); }
    t->state = heir->state;
    t->rate = heir->rate;
    t->N = -heir->N;
    t->rate_mps = -heir->rate_mps;
    heir->state = heir->rate = -1;
    heir->N = heir->rate_mps = 0.0;
}

/* A row's line of sight is that of its phase's beginning (pel_nav_rover_phase_row): one that has turned away is begun anew, one an epoch
 * so that the others carry on. */
static void renew_turned(pel_navigator_t *nav)
{
    const pel_sd_t *farthest = NULL;
    double most = TURNED_RAD * TURNED_RAD;
    for (int i = 0; i < nav->sd.n; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        const pel_tracked_t *t = pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier);
        if (t == NULL) { continue; }
        double d[3];
        for (int k = 0; k < 3; k++) { d[k] = sd->u_e[k] - (double)t->u_e[k]; }
        if (pel_dot3(d, d) <= most) { continue; }
        most = pel_dot3(d, d);
        farthest = sd;
    }
    if (farthest != NULL) { pel_nav_track_drop(nav, farthest); }
}

/* One phase of each satellite first, then their other carriers while there is room. */
void pel_nav_rover_phase_begin(pel_navigator_t *nav)
{
    renew_turned(nav);
    pel_nav_track_make_room(nav);
    const pel_sd_t *ref = reference(nav);
    if (ref != NULL) { restart_slipped(nav, ref); }
    for (int pass = 0; pass < 2 && ref != NULL; pass++) {
        for (int i = 0; i < nav->sd.n; i++) {
            const pel_sd_t *sd = &nav->sd.sd[i];
            if (!is_usable(sd) || pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier) != NULL) { continue; }
            if (pass > 0 || !has_phase_of(nav, sd)) { begin_float(nav, sd, ref); }
        }
    }
}

/* ---- time and rows ------------------------------------------------------------------------------------------------------ */

static const pel_sd_t *seen(const pel_navigator_t *nav, const pel_tracked_t *t)
{
    for (int i = 0; i < nav->sd.n; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        if (t->sys == sd->sys && t->prn == sd->prn && t->carrier == sd->carrier) { return sd; }
    }
    return NULL;
}

/* Its own walk moves an offset alone, that of the datum all of them. var: m^2. */
static void walk(pel_navigator_t *nav, const pel_tracked_t *moved, double var)
{
    pel_real c[PEL_MAX_STATES] = {0};
    int last = -1;
    for (int i = 0; i < nav->track.n; i++) {
        const pel_tracked_t *t = &nav->track.entry[i];
        if (t->state < 0 || (t != moved && moved->state >= 0)) { continue; }
        c[t->state] = PEL_R(1.0);
        last = (t->state > last) ? t->state : last;
    }
    if (last >= 0) { pel_ud_rank_one(&nav->ud, last + 1, c, (pel_real)var); }
}

static void add_walks(pel_navigator_t *nav, double dt_s)
{
    const pel_nav_config_t *cfg = &nav->cfg;
    const double path = cfg->single_path_m_rts * cfg->single_path_m_rts * dt_s;
    const double rate = cfg->single_rate_mps * RATE_WALK * cfg->single_rate_mps * RATE_WALK * dt_s;
    const double share = (cfg->single_phase_tau_s > 0.0) ? pel_min(2.0 * dt_s / cfg->single_phase_tau_s, 2.0) : 0.0;
    for (int i = 0; i < nav->track.n; i++) {
        const pel_tracked_t *t = &nav->track.entry[i];
        const pel_sd_t *sd = seen(nav, t);
        walk(nav, t, path + ((sd != NULL) ? share * sd->var_phase : 0.0));
        if (t->rate >= 0) { pel_ud_add_noise(&nav->ud, t->rate, (pel_real)rate); }
    }
}

void pel_nav_rover_phase_walk(pel_navigator_t *nav)
{
    const double dt_s = pel_time_diff_s(nav->at_horizon.t_ns, nav->epoch_before_ns);
    for (int i = 0; i < nav->track.n; i++) {
        pel_tracked_t *t = &nav->track.entry[i];
        if (t->rate < 0) { continue; }
        (void)pel_ud_combine(&nav->ud, t->state, t->rate, (pel_real)dt_s);
        t->N += dt_s * t->rate_mps;
    }
    const double since_s = pel_time_diff_s(nav->at_horizon.t_ns, nav->track.wandered_ns);
    const bool first = nav->track.wandered_ns == 0 || since_s < 0.0;
    if (!first && since_s < WANDER_EVERY_S) { return; }
    nav->track.wandered_ns = nav->at_horizon.t_ns;
    if (!first) { add_walks(nav, since_s); }
}

/* With lines of sight as they were when the phases began. That they turn would tell the place itself, were the paths known to a millimetre
 * in minutes: they are not, and a drift of 0.3 mm/s taken for it is metres. What the turn leaves out, 1e-4 rad/s times the error of
 * the place, is less than paths walk. */
void pel_nav_rover_phase_row(pel_navigator_t *nav, const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot,
                             double dd_m, pel_row_t *row)
{
    pel_sd_t a = *sat, b = *pivot;
    const pel_tracked_t *ta = pel_nav_track_find(nav, sat->sys, sat->prn, sat->carrier);
    const pel_tracked_t *tb = pel_nav_track_find(nav, pivot->sys, pivot->prn, pivot->carrier);
    for (int k = 0; k < 3 && ta != NULL && tb != NULL; k++) {
        a.u_e[k] = (double)ta->u_e[k];
        b.u_e[k] = (double)tb->u_e[k];
    }
    pel_observe_range(ant, &a, &b, dd_m, row);
}

/* Three double differences hold the antenna from epoch to epoch. */
void pel_nav_rover_phase_note(pel_navigator_t *nav)
{
    if (nav->update.phase_used < FEWEST_ROWS) { nav->track.carried_from_ns = nav->at_horizon.t_ns; }
}

/* Errors that last longer than an epoch: taking each code with 2 tau / dt of its variance gives the information per second of a process
 * correlated over tau. What the receiver makes itself lasts a minute. Orbit, clock and atmosphere last an hour, and phases carry the position
 * as long: each satellite's code tells them once, at once when phases begin and over a minute when it rises later, lest the
 * position jump, and hardly again. Where no phases carry, what was is soon forgotten, and all of it lasts a minute. */
void pel_nav_rover_weigh_codes(pel_navigator_t *nav, double gap_s, bool phased)
{
    const double dt_s = pel_max(gap_s, 0.01);
    const double rising = pel_min(pel_max(1.0, nav->cfg.single_code_tau_s / dt_s), (double)UINT16_MAX);
    const double brief = pel_max(1.0, 2.0 * nav->cfg.single_code_tau_s / dt_s);
    const double lasting = pel_max(brief, 2.0 * nav->cfg.single_lasting_tau_s / dt_s);
    const bool carried = phased && pel_time_diff_s(nav->at_horizon.t_ns, nav->track.carried_from_ns) > CARRIED_S;
    const bool begins = phased && nav->track.n == 0;
    if (nav->epoch_before_ns == 0) { return; } /* one epoch alone: nothing to correlate */
    if (!begins) { nav->update.code_inflated_by = brief; }
    for (int i = 0; i < nav->sd.n; i++) {
        pel_sd_t *sd = &nav->sd.sd[i];
        uint16_t *told = &nav->track.codes_told[sd->sys][sd->prn % PEL_NAV_PRNS];
        const double own = pel_noise_var(&nav->cfg.noise, PEL_OBS_CODE, (double)sd->el_rad, (double)sd->cn0_dbhz);
        if (begins) {
            *told = UINT16_MAX;
        } else if (!carried) {
            sd->var_code *= brief;
        } else if ((double)*told < rising) {
            sd->var_code *= rising;
            (*told)++;
        } else {
            sd->var_code = lasting * sd->var_code - (lasting - brief) * pel_min(own, sd->var_code);
        }
    }
}

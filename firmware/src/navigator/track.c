/* track.c - ambiguities from epoch to epoch: held integers, and float ones as filter states until they can be resolved.
 *
 * Every phase that is tracked without a slip keeps one number N, rover minus base, in cycles: an integer where it is held, a
 * filter state (appended behind position) where it is float. All N of a group (system, carrier) are relative to one arbitrary
 * datum, the first satellite held, so that differences within the group are double-difference ambiguities whoever the pivot is. */
#include <string.h>

#include "internal.h"

#include "pelorus/math.h"

#define FLOAT_SD_M          30.0 /* of a new ambiguity, as range */
#define MOST_CONTRADICTIONS 3 /* epochs in a row whose own integers are others than those held: then they are right */
#define FAR_APART_S         10.0 /* epochs with errors of their own: two are enough */
#define WANDER_EVERY_S      0.9

pel_tracked_t *pel_nav_track_find(pel_navigator_t *nav, uint8_t sys, uint8_t prn, uint8_t carrier)
{
    for (int i = 0; i < nav->track.n; i++) {
        pel_tracked_t *t = &nav->track.entry[i];
        if (t->sys == sys && t->prn == prn && t->carrier == carrier) { return t; }
    }
    return NULL;
}

bool pel_nav_track_number(const pel_navigator_t *nav, const pel_sd_t *sd, double *N)
{
    for (int i = 0; i < nav->track.n; i++) {
        const pel_tracked_t *t = &nav->track.entry[i];
        if (t->state < 0 && t->sys == sd->sys && t->prn == sd->prn && t->carrier == sd->carrier) {
            *N = t->N;
            return true;
        }
    }
    return false;
}

/* Phases of the rover alone have one datum: its clock is the same to all. */
static bool same_group(const pel_navigator_t *nav, const pel_tracked_t *t, uint8_t sys, uint8_t carrier)
{
    return nav->track.of_rover || (t->sys == sys && t->carrier == carrier);
}

pel_tracked_t *pel_nav_track_datum(pel_navigator_t *nav, uint8_t sys, uint8_t carrier)
{
    for (int i = 0; i < nav->track.n; i++) {
        pel_tracked_t *t = &nav->track.entry[i];
        if (t->state < 0 && same_group(nav, t, sys, carrier)) { return t; }
    }
    return NULL;
}

/* ---- states behind the model's own -------------------------------------------------------------------------------------- */

bool pel_nav_track_add_state(pel_navigator_t *nav, pel_tracked_t *t, double sd_cyc)
{
    if (pel_ud_insert(&nav->ud, nav->ud.n, (pel_real)(sd_cyc * sd_cyc)) != PEL_OK) { return false; }
    t->state = (int16_t)(nav->ud.n - 1);
    nav->model.n = nav->ud.n;
    return true;
}

/* State `removed` of the filter goes: those behind it move up. */
static void remove_state(pel_navigator_t *nav, int16_t removed)
{
    if (removed < 0) { return; }
    (void)pel_ud_remove(&nav->ud, removed);
    nav->model.n = nav->ud.n;
    for (int i = 0; i < nav->track.n; i++) {
        pel_tracked_t *t = &nav->track.entry[i];
        t->state = (int16_t)(t->state - (t->state > removed));
        t->rate = (int16_t)(t->rate - (t->rate > removed));
    }
    pel_nav_channels_shift(nav, removed);
}

void pel_nav_track_remove_state(pel_navigator_t *nav, pel_tracked_t *t)
{
    const int16_t rate = t->rate;
    t->rate = -1;
    remove_state(nav, rate); /* behind its offset */
    const int16_t state = t->state;
    t->state = -1;
    remove_state(nav, state);
}

void pel_nav_track_drop_entry(pel_navigator_t *nav, int i)
{
    pel_nav_track_remove_state(nav, &nav->track.entry[i]);
    nav->track.n--;
    if (i < nav->track.n) { nav->track.entry[i] = nav->track.entry[nav->track.n]; }
}

/* Float ambiguities of a group without a datum refer to nothing. */
static void drop_orphans(pel_navigator_t *nav)
{
    if (nav->track.of_rover) { pel_nav_rover_phase_hand_over(nav); }
    for (int i = nav->track.n - 1; i >= 0; i--) {
        const pel_tracked_t *t = &nav->track.entry[i];
        if (t->state >= 0 && pel_nav_track_datum(nav, t->sys, t->carrier) == NULL) { pel_nav_track_drop_entry(nav, i); }
    }
}

void pel_nav_track_clear(pel_navigator_t *nav)
{
    while (nav->track.n > 0) { pel_nav_track_drop_entry(nav, nav->track.n - 1); }
    nav->track.misfits = 0;
}

void pel_nav_track_forget(pel_navigator_t *nav)
{
    nav->track.n = 0;
    nav->track.carried_from_ns = nav->at_horizon.t_ns;
    nav->track.misfits = 0;
    pel_nav_channels_forget(nav);
}

/* Nothing is known of its number any more. */
static void slip(pel_navigator_t *nav, pel_tracked_t *t)
{
    if (nav->track.of_rover && nav->cfg.single_rate_mps > 0.0) {
        pel_nav_rover_phase_slip(nav, t);
    } else {
        pel_nav_track_drop_entry(nav, (int)(t - nav->track.entry));
    }
}

void pel_nav_track_drop_slipped(pel_navigator_t *nav, const pel_epoch_t *e)
{
    for (int k = 0; k < e->n; k++) {
        const pel_obs_t *o = &e->obs[k];
        if ((o->flags & PEL_OBS_SLIP) == 0) { continue; }
        pel_tracked_t *t = pel_nav_track_find(nav, o->sys, o->prn, o->carrier);
        if (t != NULL) { slip(nav, t); }
    }
    drop_orphans(nav);
}

void pel_nav_track_drop(pel_navigator_t *nav, const pel_sd_t *sd)
{
    pel_tracked_t *t = pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier);
    if (t != NULL) { slip(nav, t); }
    drop_orphans(nav);
}

/* ---- after a search: what was validated is held --------------------------------------------------------------------------- */

static bool is_seen(const pel_navigator_t *nav, const pel_tracked_t *t)
{
    for (int i = 0; i < nav->sd.n; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        if (t->sys == sd->sys && t->prn == sd->prn && t->carrier == sd->carrier) { return true; }
    }
    return false;
}

/* Satellites that have set keep their place until it is needed. */
void pel_nav_track_make_room(pel_navigator_t *nav)
{
    if (nav->track.n < PEL_MAX_TRACKED && nav->ud.n < PEL_MAX_STATES) { return; }
    for (int i = nav->track.n - 1; i >= 0; i--) {
        if (!is_seen(nav, &nav->track.entry[i])) { pel_nav_track_drop_entry(nav, i); }
    }
    drop_orphans(nav);
}

pel_tracked_t *pel_nav_track_get_or_add(pel_navigator_t *nav, const pel_sd_t *sd)
{
    pel_tracked_t *t = pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier);
    if (t != NULL) { return t; }
    if (nav->track.n == PEL_MAX_TRACKED) { return NULL; }
    t = &nav->track.entry[nav->track.n++];
    *t = (pel_tracked_t){.sys = sd->sys,
                         .prn = sd->prn,
                         .carrier = sd->carrier,
                         .state = -1,
                         .rate = -1,
                         .u_e = {(float)sd->u_e[0], (float)sd->u_e[1], (float)sd->u_e[2]}};
    return t;
}

static void hold(pel_navigator_t *nav, const pel_sd_t *sd, double N)
{
    pel_tracked_t *t = pel_nav_track_get_or_add(nav, sd);
    if (t == NULL) { return; }
    pel_nav_track_remove_state(nav, t);
    t->N = N;
    t->held = true;
    t->half = false;
}

/* The integer of a group's pivot on the group's datum: known, or told by another satellite held and fixed, or a new datum. */
static double pivot_integer(pel_navigator_t *nav, const pel_nav_integers_t *ints, int first, int last, int pivot)
{
    for (int pass = 0; pass < 2; pass++) {
        for (int i = first; i < last; i++) {
            const pel_sd_t *sd = &nav->sd.sd[i];
            const pel_tracked_t *t = pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier);
            if (t == NULL || t->state >= 0) { continue; }
            if (pass == 0 && i == pivot) { return t->N; }
            if (pass == 1 && ints->fixed[i]) { return t->N - (double)ints->N[i]; }
        }
    }
    pel_nav_channels_new_datum(nav, &nav->sd.sd[pivot]);
    return (nav->sd.sd[pivot].sys == PEL_SYS_GLO) ? pel_nav_channels_number(&nav->sd.sd[pivot]) : 0.0;
}

/* One group of nav->sd, first..last-1. */
typedef struct {
    int first, last, pivot; /* pivot -1: none */
    bool any_fixed;
} group_t;

static group_t group_from(const pel_navigator_t *nav, const pel_nav_integers_t *ints, int first)
{
    group_t g = {.first = first, .last = first, .pivot = -1};
    for (; g.last < nav->sd.n && nav->sd.sd[g.last].group == nav->sd.sd[first].group; g.last++) {
        g.any_fixed = g.any_fixed || ints->fixed[g.last];
        if (nav->sd.sd[g.last].pivot) { g.pivot = g.last; }
    }
    return g;
}

/* Do integers of this epoch alone say anything else than those held? */
static bool contradicts(pel_navigator_t *nav, const pel_nav_integers_t *ints)
{
    for (group_t g = group_from(nav, ints, 0); g.first < nav->sd.n; g = group_from(nav, ints, g.last)) {
        bool known = false;
        double offset = 0.0; /* of held numbers against those of this epoch: one for the whole group */
        for (int i = g.first; i < g.last && g.pivot >= 0; i++) {
            const pel_sd_t *sd = &nav->sd.sd[i];
            const pel_tracked_t *t = pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier);
            if (t == NULL || !t->held || !(ints->fixed[i] || (i == g.pivot && g.any_fixed))) { continue; }
            const double here = t->N - (double)((i == g.pivot) ? 0 : ints->N[i]);
            if (known && here != offset) { return true; }
            known = true;
            offset = here;
        }
    }
    return false;
}

bool pel_nav_track_hold(pel_navigator_t *nav, const pel_nav_integers_t *ints)
{
    const bool other = contradicts(nav, ints);
    if (other && nav->track.contradictions == 0) { nav->track.contradicted_ns = nav->at_horizon.t_ns; }
    nav->track.contradictions = (uint8_t)(other ? nav->track.contradictions + 1 : 0);
    const double span_s = pel_time_diff_s(nav->at_horizon.t_ns, nav->track.contradicted_ns);
    const int enough = (span_s >= FAR_APART_S) ? 2 : MOST_CONTRADICTIONS;
    if (other && nav->track.contradictions < enough) { return false; }
    nav->track.contradictions = 0;
    if (other) { pel_nav_track_clear(nav); }
    pel_nav_track_make_room(nav);
    for (group_t g = group_from(nav, ints, 0); g.first < nav->sd.n; g = group_from(nav, ints, g.last)) {
        if (!g.any_fixed || g.pivot < 0) { continue; }
        const double N_pivot = pivot_integer(nav, ints, g.first, g.last, g.pivot);
        hold(nav, &nav->sd.sd[g.pivot], N_pivot);
        for (int i = g.first; i < g.last; i++) {
            if (i != g.pivot && ints->fixed[i]) { hold(nav, &nav->sd.sd[i], N_pivot + (double)ints->N[i]); }
        }
    }
    return true;
}

/* ---- every relative epoch: each phase gets its N ------------------------------------------------------------------------------ */

static bool phase_is_usable(const pel_sd_t *sd)
{
    return sd->has_phase && sd->has_code;
}

/* A new float ambiguity from code minus phase; the receivers' clocks cancel against the group's reference. */
static void begin_float(pel_navigator_t *nav, const pel_sd_t *sd, const pel_sd_t *ref, double N_ref)
{
    pel_tracked_t *t = pel_nav_track_get_or_add(nav, sd);
    if (t == NULL) { return; }
    const double dd_m = (sd->phase_m - ref->phase_m) - (sd->code_m - ref->code_m);
    t->N = (ref->lambda_m * N_ref + dd_m - pel_nav_channels_offset_m(nav, sd, ref)) / sd->lambda_m;
    t->held = false;
    t->half = sd->half;
    t->epochs = 0;
    t->since_ns = nav->at_horizon.t_ns;
    if (!pel_nav_track_add_state(nav, t, FLOAT_SD_M / sd->lambda_m)) {
        pel_nav_track_drop_entry(nav, (int)(t - nav->track.entry));
    }
}

/* The pivot becomes the datum, or another satellite if the pivot has half a cycle that is not resolved. NULL: none can. */
static const pel_sd_t *new_datum(pel_navigator_t *nav, int first, int last, double *N_ref)
{
    const pel_sd_t *datum = NULL;
    for (int i = first; i < last; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        if (phase_is_usable(sd) && (datum == NULL || (datum->half && !sd->half))) { datum = sd; }
    }
    if (datum == NULL || pel_nav_track_datum(nav, datum->sys, datum->carrier) != NULL) { return NULL; }
    pel_tracked_t *t = pel_nav_track_get_or_add(nav, datum);
    if (t == NULL) { return NULL; }
    t->N = pel_nav_channels_number(datum);
    t->held = false;
    t->half = datum->half;
    pel_nav_channels_new_datum(nav, datum);
    *N_ref = t->N;
    return datum;
}

static void begin_group(pel_navigator_t *nav, int first, int last)
{
    const pel_sd_t *ref = NULL;
    double N_ref = 0.0;
    for (int i = first; i < last; i++) { /* a satellite of this epoch whose N is known */
        const pel_sd_t *sd = &nav->sd.sd[i];
        const pel_tracked_t *t = phase_is_usable(sd) ? pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier) : NULL;
        if (t != NULL && (ref == NULL || t->state < 0)) {
            ref = sd;
            N_ref = t->N;
            if (t->state < 0) { break; }
        }
    }
    if (ref == NULL) {
        ref = new_datum(nav, first, last, &N_ref);
        if (ref == NULL) { return; }
    }
    for (int i = first; i < last; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        if (phase_is_usable(sd) && pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier) == NULL) {
            begin_float(nav, sd, ref, N_ref);
        }
    }
}

void pel_nav_track_begin(pel_navigator_t *nav)
{
    pel_nav_track_make_room(nav);
    for (int first = 0; first < nav->sd.n;) {
        int last = first + 1;
        while (last < nav->sd.n && nav->sd.sd[last].group == nav->sd.sd[first].group) { last++; }
        begin_group(nav, first, last);
        first = last;
    }
}

/* A phase's multipath lasts for seconds: taken as white it would make float ambiguities surer than they are. What it adds to one is a
 * random walk. */
void pel_nav_track_wander(pel_navigator_t *nav)
{
    const double dt_s = pel_time_diff_s(nav->at_horizon.t_ns, nav->track.wandered_ns);
    if (!(nav->cfg.phase_tau_s > 0.0)) { return; }
    if (nav->track.wandered_ns != 0 && dt_s >= 0.0 && dt_s < WANDER_EVERY_S) { return; }
    const double share = pel_min(2.0 * dt_s / nav->cfg.phase_tau_s, 2.0);
    const bool first = nav->track.wandered_ns == 0 || dt_s < 0.0;
    nav->track.wandered_ns = nav->at_horizon.t_ns;
    for (int i = 0; !first && i < nav->sd.n; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        const pel_tracked_t *t = phase_is_usable(sd) ? pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier) : NULL;
        if (t == NULL || t->state < 0) { continue; }
        pel_real unit[PEL_MAX_STATES] = {0};
        unit[t->state] = PEL_R(1.0);
        const double var = share * sd->var_phase / (sd->lambda_m * sd->lambda_m);
        pel_ud_rank_one(&nav->ud, t->state + 1, unit, (pel_real)var);
    }
}

void pel_nav_track_lookup(pel_navigator_t *nav, pel_nav_phases_t *out)
{
    for (int i = 0; i < nav->sd.n; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        const bool ready = nav->track.of_rover ? sd->has_phase : phase_is_usable(sd) && pel_nav_channels_ready(nav, sd);
        pel_tracked_t *t = ready ? pel_nav_track_find(nav, sd->sys, sd->prn, sd->carrier) : NULL;
        out->known[i] = t != NULL;
        out->held[i] = t != NULL && t->held;
        out->state[i] = (int16_t)((t != NULL) ? t->state : -1);
        out->N[i] = (t != NULL) ? t->N : 0.0;
        if (t != NULL && t->epochs < UINT16_MAX) { t->epochs++; }
    }
}

void pel_nav_track_close_loop(pel_navigator_t *nav)
{
    for (int i = 0; i < nav->track.n; i++) {
        pel_tracked_t *t = &nav->track.entry[i];
        if (t->state >= 0) { t->N -= (double)nav->ud.x[t->state]; }
        if (t->rate >= 0) { t->rate_mps -= (double)nav->ud.x[t->rate]; }
    }
    pel_nav_channels_close_loop(nav);
}

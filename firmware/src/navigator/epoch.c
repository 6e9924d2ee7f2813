/* epoch.c - one GNSS epoch: true instant, geometry, differences, integers, rows, closed loop. */
#include "internal.h"

#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"

#define MAX_DOUBTS       8   /* epochs in a row that refuse most of their code: the state is wrong, not the code */
#define MAX_MISFITS      3   /* epochs in a row whose held integers do not fit: all are released */
#define MODE_CHANGE_SD_M 3.0 /* a base's coordinates and a single receiver's position differ by this much */
#define COARSE_RAD       (1.0 * PEL_DEG) /* attitude known worse than this: what the error model leaves out is not small */
#define GRAVITY_MPS2     9.8
#define RELEASE_SD_M     1.0
#define SHELL            0.94 /* radius of the Earth over that of the ionosphere's shell */
#define FIXED_SD_M       0.1  /* 3-D, of a position that is called fixed */

typedef pel_nav_update_t update_t;

/* ---- the epoch ----------------------------------------------------------------------------------------------------------- */

/* A single receiver's code errors (orbit, clock, atmosphere, multipath) last for minutes: epochs are not independent. Taking
 * each with 2 tau / dt of its variance gives the information per second of a process correlated over tau. */
static double allow_for_correlation(pel_navigator_t *nav, double tau_s, double gap_s)
{
    const double factor = pel_max(1.0, 2.0 * tau_s / pel_max(gap_s, 0.01));
    if (nav->epoch_before_ns == 0) { return 1.0; }
    for (int i = 0; i < nav->sd.n; i++) { nav->sd.sd[i].var_code *= factor; }
    return factor;
}

/* The search knows the ionosphere of each satellite; rows take it as noise, longer paths through the shell as more of it. */
static void allow_for_ionosphere(pel_navigator_t *nav)
{
    const double sd_L1_m = pel_nav_iono_sd_m(nav);
    const double per_lambda = PEL_L1_HZ / PEL_SPEED_OF_LIGHT;
    for (int i = 0; i < nav->sd.n; i++) {
        pel_sd_t *sd = &nav->sd.sd[i];
        const double k = sd->lambda_m * per_lambda;
        const double shell = SHELL * pel_cos((double)sd->el_rad);
        const double var = sd_L1_m * sd_L1_m * k * k * k * k / (1.0 - shell * shell);
        sd->var_phase += var;
        sd->var_code += var;
    }
}

static void add_noise(pel_navigator_t *nav, int first, double var)
{
    for (int k = 0; k < 3; k++) { pel_ud_add_noise(&nav->ud, first + k, (pel_real)var); }
}

/* Double differences carry no ionosphere model, as everywhere in RTK: over kilometres the broadcast one is no better than none,
 * and what is left is in the variances (iono_mm_per_km). */
static void forget_ionosphere(pel_view_t *view)
{
    for (int i = 0; i < view->n; i++) { view->sight[i].iono_L1_m = 0.0; }
}

static bool view_rover(pel_navigator_t *nav, const pel_epoch_t *rover, const double r_ea_e[3], const double v_ea_e[3],
                       pel_nav_counters_t *count)
{
    return pel_view_compute(rover, &nav->orbits, rover->t_ns, r_ea_e, v_ea_e, nav->cfg.mask_rad, count,
                            &nav->view_rover) == PEL_OK;
}

/* The base as seen at the rover's instant; its slips are told once. */
static bool view_base(pel_navigator_t *nav, const pel_epoch_t *rover, pel_epoch_t *base)
{
    pel_nav_track_drop_slipped(nav, base);
    for (int i = 0; i < base->n; i++) { base->obs[i].flags &= (uint8_t)~PEL_OBS_SLIP; }
    if (pel_view_compute(base, &nav->orbits, rover->t_ns, nav->station.r_ea_e, NULL, 0.0, NULL, &nav->view_base) !=
        PEL_OK) {
        return false;
    }
    if (!pel_nav_base_is_plausible(nav, base)) { return false; }
    forget_ionosphere(&nav->view_base);
    return true;
}

/* Has this base epoch a system that nav->sd lacks? */
static bool has_more(const pel_navigator_t *nav, const pel_epoch_t *base)
{
    unsigned have = 0;
    for (int i = 0; i < nav->sd.n; i++) { have |= 1u << nav->sd.sd[i].sys; }
    for (int i = 0; i < base->n; i++) {
        if ((have & (1u << base->obs[i].sys)) == 0) { return true; }
    }
    return false;
}

/* Single differences against the base; systems whose message the base's line has lost come from the base epoch before it that has
 * them. False if too little is common. */
static bool difference(pel_navigator_t *nav, const pel_epoch_t *rover, pel_epoch_t *base)
{
    const pel_noise_config_t *noise = &nav->cfg.noise;
    const double age_s = pel_time_diff_s(rover->t_ns, base->t_ns);
    nav->update.base_age_s = (float)pel_max(age_s, 0.0);
    forget_ionosphere(&nav->view_rover);
    nav->sd.n = nav->sd.n_groups = 0;
    if (view_base(nav, rover, base)) {
        (void)pel_sd_form(rover, &nav->view_rover, base, &nav->view_base, noise, age_s, &nav->sd);
    }
    for (int i = nav->n_base - 1; i >= 0; i--) {
        pel_epoch_t *other = &nav->base[i];
        const double other_age_s = pel_time_diff_s(rover->t_ns, other->t_ns);
        if (other == base || pel_fabs(other_age_s) > (double)nav->cfg.base_max_age_s) { continue; }
        if (has_more(nav, other) && view_base(nav, rover, other)) {
            (void)pel_sd_add_missing(rover, &nav->view_rover, other, &nav->view_base, noise, other_age_s, &nav->sd);
        }
    }
    return nav->sd.n - nav->sd.n_groups >= 3;
}

/* What moved between the epochs, against what the phases say. */
static void look_for_slips(pel_navigator_t *nav, pel_epoch_t *rover, double gap_s)
{
    const int i_v = pel_model_index(&nav->model, PEL_BLOCK_VELOCITY);
    pel_slip_aid_t aid = {.sd_m = 0.005 + pel_sqrt((double)pel_ud_cov(&nav->ud, i_v, i_v)) * 2.0 * gap_s};
    for (int k = 0; k < 3; k++) {
        aid.dr_e[k] = nav->corrected_e[k];
        nav->corrected_e[k] = 0.0;
    }
    pel_slip_check(&nav->slip_rover, rover, &nav->view_rover, nav->ins ? &aid : NULL, &nav->counters);
    pel_nav_track_drop_slipped(nav, rover);
}

/* What the configuration leaves of the rows. */
static void keep_observed(pel_navigator_t *nav)
{
    for (int i = 0; i < nav->sd.n; i++) {
        pel_sd_t *sd = &nav->sd.sd[i];
        sd->has_code = sd->has_code && (nav->cfg.observe & PEL_OBS_CODE) != 0;
        sd->has_phase = sd->has_phase && (nav->cfg.observe & PEL_OBS_PHASE) != 0;
        sd->has_rate = sd->has_rate && (nav->cfg.observe & PEL_OBS_DOPPLER) != 0;
    }
}

/* Differences against the base where there is one, else of the rover alone. */
static bool form_rows(pel_navigator_t *nav, pel_epoch_t *rover, pel_epoch_t *base, double r_ea_e[3], double v_ea_e[3])
{
    if (!view_rover(nav, rover, r_ea_e, v_ea_e, &nav->counters)) {
        nav->counters.epochs_no_eph++;
        return false;
    }
    const double gap_s = pel_time_diff_s(nav->at_horizon.t_ns, nav->epoch_before_ns);
    look_for_slips(nav, rover, gap_s);
    const bool tried = base != NULL && nav->have_station;
    const bool relative = tried && difference(nav, rover, base);
    if (!relative) {
        nav->update.base_age_s = -1.0f;
        if (tried) { (void)view_rover(nav, rover, r_ea_e, v_ea_e, NULL); } /* with the ionosphere again */
        (void)pel_sd_undifferenced(rover, &nav->view_rover, &nav->cfg.noise_single, &nav->sd); /* of at least a code */
    }
    if (relative != nav->relative && nav->last_epoch_ns != 0) {
        add_noise(nav, pel_model_index(&nav->model, PEL_BLOCK_POSITION), MODE_CHANGE_SD_M * MODE_CHANGE_SD_M);
    }
    keep_observed(nav);
    nav->relative = relative;
    nav->update.phased = pel_nav_track_claim(nav, relative);
    pel_nav_noise_level_apply(nav);
    if (!relative) { pel_nav_rover_weigh_codes(nav, gap_s, nav->update.phased); }
    return true;
}

/* The rows are linear in attitude. While it is coarse, the lever arm's second-order error (3 cm of 2 m at 10 degrees) and that
 * of gravity felt through it since the epoch before would be taken for centimetres of truth. */
static void allow_for_coarse_attitude(pel_navigator_t *nav, const pel_antenna_t *ant)
{
    if (ant->i_psi < 0) { return; }
    double P[3][3], up[3];
    pel_nav_axes_t axes;
    pel_nav_axes(nav, &axes);
    pel_nav_block_e(nav, &axes, ant->i_psi, ant->i_psi, P);
    const double var = P[0][0] + P[1][1] + P[2][2];
    if (var < COARSE_RAD * COARSE_RAD) { return; }
    (void)pel_unit3(nav->at_horizon.r_eb_e, up);
    const double var_heading = pel_nav_along(P, up);
    const double var_tilt = pel_max(var - var_heading, 0.0);
    const double gap_s = pel_min(1.0, pel_time_diff_s(nav->at_horizon.t_ns, nav->epoch_before_ns));
    const double felt = (0.5 * var_tilt + pel_sqrt(var_tilt * var_heading)) * GRAVITY_MPS2 * gap_s;
    const double arm = 0.5 * var * pel_norm3(ant->lever_e), arm_rate = 0.5 * var * pel_norm3(ant->lever_rate_e);
    add_noise(nav, ant->i_r, arm * arm);
    add_noise(nav, ant->i_v, arm_rate * arm_rate + felt * felt);
}

/* Validated phases that hold the position: three of them in a row would not. */
static bool is_fixed(const pel_navigator_t *nav, const update_t *u)
{
    double P_r[3][3];
    pel_nav_antenna_cov(nav, &u->ant, false, P_r);
    return u->held_used >= 3 && P_r[0][0] + P_r[1][1] + P_r[2][2] < FIXED_SD_M * FIXED_SD_M;
}

void pel_nav_stop(pel_navigator_t *nav)
{
    if (nav->ins) { pel_nav_reset_alignment(nav); }
    nav->ins = false;
    nav->have_state = false;
}

/* Held integers that are not believed any more take with them what the filter made of them. */
static void release(pel_navigator_t *nav)
{
    nav->counters.fix_released++;
    pel_nav_track_clear(nav);
    pel_nav_hold_watch_reset(nav);
    add_noise(nav, pel_model_index(&nav->model, PEL_BLOCK_POSITION), RELEASE_SD_M * RELEASE_SD_M);
}

/* A filter that refuses its measurements for many epochs, or lost its factors, starts again and says so. */
static void watch_health(pel_navigator_t *nav, update_t *u)
{
    const bool doubtful = u->code_refused > u->code_used;
    nav->doubts = (uint8_t)(doubtful ? nav->doubts + 1 : 0);
    const bool broken = pel_ud_check(&nav->ud) != PEL_OK;
    if (broken) { nav->counters.numeric_faults++; }
    const bool phases_misfit = u->held_refused > u->held_used;
    nav->track.misfits = (uint8_t)(phases_misfit ? nav->track.misfits + 1 : 0);
    const bool lost = nav->relative && pel_nav_noise_level_phase_is_lost(nav);
    const bool codes_contradict = u->held_used >= 3 && pel_nav_hold_watch_contradicts(nav);
    if (nav->track.misfits >= MAX_MISFITS || codes_contradict || (lost && u->held_used >= 3)) { release(nav); }
    const bool contradicted = pel_nav_ins_is_contradicted(nav);
    if (!broken && nav->doubts < MAX_DOUBTS && !contradicted) { return; }
    nav->restless = 0;
    nav->counters.restarts++;
    u->flags |= PEL_SOL_RESTARTED;
    nav->epoch_solution.flags |= PEL_SOL_RESTARTED;                            /* told also if no start follows */
    const bool fresh = nav->have_spp && nav->spp.t_ns == nav->at_horizon.t_ns; /* never back in time */
    pel_nav_stop(nav);
    nav->relative = false; /* a single-point solution says so */
    if (fresh) { pel_nav_start_gnss(nav, &nav->spp); }
}

static void finish(pel_navigator_t *nav, update_t *u)
{
    pel_solution_t *out = &nav->epoch_solution;
    memset(out, 0, sizeof *out);
    out->flags = u->flags;
    out->base_age_s = u->base_age_s;
    out->nis = u->nis;
    out->nis_dof = u->nis_dof;
    nav->last_fix = !nav->relative ? PEL_FIX_SPP : is_fixed(nav, u) ? PEL_FIX_FIXED : PEL_FIX_FLOAT;
    if (nav->last_fix == PEL_FIX_FIXED) { u->ints.reason = PEL_INT_OK; }
    nav->counters.epochs_used++;
    nav->last_epoch_ns = nav->at_horizon.t_ns;
    out->int_reason = (uint8_t)u->ints.reason;
    out->ratio = (float)u->ints.ratio;
    out->success_rate = (float)u->ints.success;
    out->search_nodes = (uint16_t)((u->ints.nodes > 65535) ? 65535 : u->ints.nodes);
    out->n_amb = (uint8_t)u->ints.n;
    out->n_fixed = (uint8_t)u->held_used;
    out->n_sat = (uint8_t)pel_nav_satellites_used(nav);
    pel_nav_note_used(nav);
    pel_nav_wheels_epoch(nav);
    pel_nav_try_start_ins(nav);
    pel_nav_warm_epoch(nav);
    nav->epoch_before_ns = nav->at_horizon.t_ns;
    memcpy(nav->v_before_e, nav->at_horizon.v_eb_e, sizeof nav->v_before_e);
    pel_nav_fill_solution(nav, &nav->at_horizon, out);
    out->flags |= PEL_SOL_AT_EPOCH;
    nav->ready |= PEL_NAV_BIT(PEL_NAV_EPOCH);
    pel_nav_predict_now(nav);
}

/* ---- in slices ------------------------------------------------------------------------------------------------------------ */

/* Everything is done but to tell. */
static void end_epoch(pel_navigator_t *nav)
{
    nav->search = PEL_NAV_SEARCH_NONE;
    watch_health(nav, &nav->update);
    if (nav->have_state) { finish(nav, &nav->update); }
}

/* The search may last; the covariance is already that of after the rows, so the output goes on from there too. */
static bool begin_float_search(pel_navigator_t *nav)
{
    const bool ins = nav->ins;
    if (!nav->relative || !nav->cfg.integers) { return false; }
    if (!pel_nav_track_search_begin(nav, is_fixed(nav, &nav->update))) { return false; }
    pel_nav_predict_now(nav);
    if (nav->ins != ins) { return false; } /* a damaged ring has ended the INS and with it the floats */
    nav->search = PEL_NAV_SEARCH_FLOATS;
    return true;
}

/* Rows with every N that is known; then integers of the float ones. */
static void use_rows(pel_navigator_t *nav)
{
    update_t *u = &nav->update;
    double inflated_by = 1.0;
    const double gap_s = pel_time_diff_s(nav->at_horizon.t_ns, nav->epoch_before_ns);
    if (u->ints.reason == PEL_INT_OK && !pel_nav_track_hold(nav, &u->ints)) { u->ints.reason = PEL_INT_PRIOR; }
    if (u->phased) {
        if (nav->relative) {
            pel_nav_track_begin(nav);
        } else {
            pel_nav_rover_phase_begin(nav);
        }
        pel_nav_track_lookup(nav, &u->phases);
        u->ant.n_states = nav->model.n;
    }
    if (nav->relative) {
        inflated_by =
            allow_for_correlation(nav, nav->cfg.code_tau_s, gap_s); /* one epoch alone: nothing to correlate */
        allow_for_ionosphere(nav);
    }
    pel_nav_noise_level_begin(nav, inflated_by);
    pel_nav_hold_watch_age(nav, gap_s);
    pel_nav_update_rows(nav, u);
    pel_nav_vehicle_rows(nav);
    if (!nav->relative) { pel_nav_rover_phase_note(nav); }
    pel_nav_close_loop(nav);
    for (int i = 0; u->phased && i < nav->sd.n; i++) {
        if (u->misfit[i]) { pel_nav_track_drop(nav, &nav->sd.sd[i]); }
    }
    if (!begin_float_search(nav)) { end_epoch(nav); }
}

static bool searches_each_epoch(const pel_navigator_t *nav)
{
    return pel_nav_preset(pel_nav_preset_in_use(nav))->each_epoch;
}

/* The verdict on the floats is the epoch's where there is no other. */
static void tell_floats(pel_navigator_t *nav)
{
    nav->update.ints = nav->update.later;
    pel_nav_count_verdict(&nav->counters, nav->update.ints.reason);
}

void pel_nav_begin_epoch(pel_navigator_t *nav, pel_epoch_t *rover, pel_epoch_t *base)
{
    update_t *u = &nav->update;
    memset(u, 0, sizeof *u);
    nav->last_tag_ns = rover->t_ns;
    if (!pel_nav_reach_epoch(nav, rover)) { return; }

    double r_ea_e[3], v_ea_e[3];
    pel_nav_antenna(nav, &u->ant, r_ea_e, v_ea_e);
    if (!form_rows(nav, rover, base, r_ea_e, v_ea_e)) {
        nav->counters.epochs_few_sats++;
        return;
    }
    pel_nav_start_reports(nav);
    pel_nav_note_seen(nav, rover, base);
    allow_for_coarse_attitude(nav, &u->ant);
    pel_nav_antenna_cov(nav, &u->ant, false, u->P_r);
    pel_nav_antenna_cov(nav, &u->ant, true, u->P_v);
    u->ints.reason = PEL_INT_NOT_TRIED;
    if (nav->relative) { pel_nav_track_wander(nav); }
    if (!nav->relative && u->phased) { pel_nav_rover_phase_walk(nav); }
    const bool searches = nav->relative && nav->cfg.integers && searches_each_epoch(nav);
    if (searches && pel_nav_resolve_begin(nav, u->P_r, &u->ints)) {
        nav->search = PEL_NAV_SEARCH_EPOCH;
    } else {
        use_rows(nav);
    }
}

void pel_nav_go_on(pel_navigator_t *nav, int32_t max_nodes)
{
    update_t *u = &nav->update;
    switch (nav->search) {
    case PEL_NAV_SEARCH_NONE: break;
    case PEL_NAV_SEARCH_EPOCH:
        if (!pel_nav_resolve_step(nav, max_nodes, &u->ints)) { break; }
        nav->search = PEL_NAV_SEARCH_NONE;
        use_rows(nav);
        break;
    case PEL_NAV_SEARCH_FLOATS:
        if (!pel_nav_track_search_step(nav, max_nodes)) { break; }
        u->held_used += u->later.n_fixed;
        if (!searches_each_epoch(nav)) { tell_floats(nav); }
        end_epoch(nav);
        break;
    }
}

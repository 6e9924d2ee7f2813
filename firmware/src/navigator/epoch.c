/* epoch.c - one GNSS epoch: true instant, geometry, differences, integers, rows, closed loop. */
#include "internal.h"

#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"

#define GATE_SIGMA       PEL_R(6.0) /* last gate on a whitened row; coarse errors are screened before */
#define MAX_DOUBTS       8   /* epochs in a row that refuse most of their code: the state is wrong, not the code */
#define MAX_MISFITS      3   /* epochs in a row whose held integers do not fit: all are released */
#define MODE_CHANGE_SD_M 3.0 /* a base's coordinates and a single receiver's position differ by this much */
#define STALE_CLOCK_S    60.0
#define LOST_SD_M        20.0
#define COARSE_RAD       (1.0 * PEL_DEG) /* attitude known worse than this: what the error model leaves out is not small */
#define GRAVITY_MPS2     9.8

/* ---- when was the epoch ----------------------------------------------------------------------------------------------- */

static double zenith_sd(double a, double b)
{
    return pel_sqrt(a * a + b * b);
}

/* True receive time of the epoch. Single-point solution if there is one, else the receiver clock of the last one. */
static bool true_time(pel_navigator_t *nav, const pel_epoch_t *rover, bool *solved, pel_time_t *t_ns)
{
    pel_spp_config_t cfg;
    pel_spp_default(&cfg);
    cfg.mask_rad = nav->cfg.mask_rad;
    cfg.code_sd_m = zenith_sd(nav->cfg.noise_single.code_a_m, nav->cfg.noise_single.code_b_m);
    cfg.doppler_sd_mps = zenith_sd(nav->cfg.noise_single.doppler_a_mps, nav->cfg.noise_single.doppler_b_mps);
    pel_spp_t spp;
    const pel_status_t status =
        pel_spp_solve(rover, &nav->orbits, &cfg, nav->have_spp ? &nav->spp : NULL, NULL, &nav->view_rover, &spp);
    *solved = status >= 0;
    if (*solved) {
        nav->spp = spp;
        nav->have_spp = true;
        *t_ns = spp.t_ns;
        return true;
    }
    nav->counters.epochs_spp_failed++;
    const double age_s = pel_time_diff_s(rover->t_ns, nav->spp.t_ns);
    if (!nav->have_spp || age_s > STALE_CLOCK_S) { return false; }
    const double clk_s = (nav->spp.clk_m + nav->spp.clk_rate_mps * age_s) / PEL_SPEED_OF_LIGHT;
    *t_ns = rover->t_ns - (int64_t)pel_round(clk_s * 1e9);
    return true;
}

/* ---- rows --------------------------------------------------------------------------------------------------------------- */

typedef enum { CODE = 0, PHASE = 1, RATE = 2 } kind_t;

static bool has_value(const pel_sd_t *sd, kind_t kind)
{
    return (kind == CODE) ? sd->has_code : (kind == PHASE) ? sd->has_phase : sd->has_rate;
}

static double value(const pel_sd_t *sd, kind_t kind)
{
    return (kind == CODE) ? sd->code_m : (kind == PHASE) ? sd->phase_m : sd->rate_mps;
}

static double variance(const pel_sd_t *sd, kind_t kind)
{
    return (kind == CODE) ? sd->var_code : (kind == PHASE) ? sd->var_phase : sd->var_rate;
}

typedef pel_nav_update_t update_t;

static double along(const double P[3][3], const double g[3])
{
    double Pg[3];
    pel_mat3_vec(P, g, Pg);
    return pel_dot3(g, Pg);
}

/* Median of n <= PEL_MAX_SATS values; sorts in place. */
static double median(double *x, int n)
{
    for (int i = 1; i < n; i++) {
        const double v = x[i];
        int j = i;
        for (; j > 0 && x[j - 1] > v; j--) { x[j] = x[j - 1]; }
        x[j] = v;
    }
    return (n % 2 != 0) ? x[n / 2] : 0.5 * (x[n / 2 - 1] + x[n / 2]);
}

/* Phases have their own pivot: one whose N is an integer rather than a state, the group's own if possible. -1: none. */
static int phase_pivot(const pel_navigator_t *nav, const update_t *u, int first, int last)
{
    int pivot = -1;
    for (int i = first; i < last; i++) {
        if (!u->phases.known[i]) { continue; }
        const bool better = pivot < 0 || (u->phases.state[pivot] >= 0 && u->phases.state[i] < 0) ||
                            (nav->sd.sd[i].pivot && u->phases.state[i] < 0);
        if (better) { pivot = i; }
    }
    return pivot;
}

/* Coarse errors stand out from the median of their group, whoever the pivot is. Marks what to keep; picks the pivot. -1: none. */
static int screen(const pel_navigator_t *nav, const update_t *u, int first, int last, kind_t kind,
                  bool keep[PEL_MAX_OBS])
{
    const pel_sd_set_t *set = &nav->sd;
    double x[PEL_MAX_SATS];
    int n = 0;
    for (int i = first; i < last; i++) {
        keep[i] = has_value(&set->sd[i], kind) && (kind != PHASE || u->phases.known[i]);
        if (keep[i] && n < PEL_MAX_SATS) { x[n++] = value(&set->sd[i], kind); }
    }
    if (n < 2) { return -1; }
    if (kind == PHASE) { return phase_pivot(nav, u, first, last); } /* judged by the integers' own tests and the gate */
    const double middle = median(x, n);
    int pivot = -1;
    for (int i = first; i < last; i++) {
        const pel_sd_t *sd = &set->sd[i];
        if (!keep[i]) { continue; }
        const double var = variance(sd, kind) + 2.0 * along((kind == RATE) ? u->P_v : u->P_r, sd->u_e);
        const double off = value(sd, kind) - middle;
        const bool coarse = n > 2 && off * off > 25.0 * var;
        keep[i] = !coarse;
        if (keep[i] && (pivot < 0 || sd->pivot)) { pivot = i; }
    }
    return pivot;
}

static pel_sat_report_t *report_of(pel_navigator_t *nav, int i)
{
    return &nav->sats[i];
}

static void note_row(pel_navigator_t *nav, const update_t *u, int i, int pivot, kind_t kind, double dd, bool used)
{
    const pel_sd_t *sd = &nav->sd.sd[i], *p = &nav->sd.sd[pivot];
    pel_sat_report_t *r = report_of(nav, i);
    const double g[3] = {p->u_e[0] - sd->u_e[0], p->u_e[1] - sd->u_e[1], p->u_e[2] - sd->u_e[2]};
    const double var = along((kind == RATE) ? u->P_v : u->P_r, g) + variance(sd, kind) + variance(p, kind);
    const float innov = (float)-dd;
    const float s = (float)pel_sqrt(var);
    report_of(nav, pivot)->flags |= PEL_SAT_PIVOT;
    if (kind == CODE) {
        r->innov_code_m = innov;
        r->sd_code_m = s;
        r->flags |= used ? PEL_SAT_CODE_USED : PEL_SAT_EXCLUDED;
    } else if (kind == PHASE) {
        r->innov_phase_m = innov;
        r->sd_phase_m = s;
        const bool fixed = u->phases.held[i] && u->phases.held[pivot];
        r->n_fixed = fixed ? (int32_t)(u->phases.N[i] - u->phases.N[pivot]) : 0;
        r->flags |= (uint8_t)(!used   ? PEL_SAT_EXCLUDED
                              : fixed ? (PEL_SAT_PHASE_USED | PEL_SAT_FIXED)
                                      : PEL_SAT_PHASE_USED);
    } else {
        r->innov_doppler_mps = innov;
        r->sd_doppler_mps = s;
        r->flags |= used ? PEL_SAT_DOPPLER_USED : PEL_SAT_EXCLUDED;
    }
}

static void count_row(pel_navigator_t *nav, update_t *u, int i, kind_t kind, bool used)
{
    const bool held = kind == PHASE && u->phases.held[i];
    if (used) {
        nav->counters.rows_used++;
        u->used++;
        u->code_used += (kind == CODE);
        u->held_used += held;
    } else {
        nav->counters.rows_gated++;
        u->code_refused += (kind == CODE);
        u->held_refused += held;
        u->misfit[i] = kind == PHASE;
    }
}

/* The double difference of satellite i against the pivot as a row; phases carry their N, integer or state. */
static double make_row(const pel_navigator_t *nav, const update_t *u, int i, int pivot, kind_t kind, pel_row_t *row)
{
    const pel_sd_t *sd = &nav->sd.sd[i], *p = &nav->sd.sd[pivot];
    double dd = value(sd, kind) - value(p, kind);
    if (kind == PHASE) { dd -= sd->lambda_m * (u->phases.N[i] - u->phases.N[pivot]); }
    if (kind == RATE) {
        pel_observe_rate(&u->ant, sd, p, dd, row);
        return dd;
    }
    pel_observe_range(&u->ant, sd, p, dd, row);
    if (kind == PHASE && u->phases.state[i] >= 0) { row->h[u->phases.state[i]] = (pel_real)sd->lambda_m; }
    if (kind == PHASE && u->phases.state[pivot] >= 0) { row->h[u->phases.state[pivot]] = (pel_real)-sd->lambda_m; }
    return dd;
}

/* One kind of measurement of one group: double differences against the pivot, whitened, into the filter. */
static void update_group(pel_navigator_t *nav, update_t *u, int first, int last, kind_t kind)
{
    bool keep[PEL_MAX_OBS];
    const int pivot = screen(nav, u, first, last, kind, keep);
    pel_whiten_t w;
    pel_row_t row;
    if (pivot < 0) { return; }
    if (pel_whiten_begin(&w, nav->model.n, (pel_real)variance(&nav->sd.sd[pivot], kind)) != PEL_OK) { return; }
    for (int i = first; i < last; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        if (i == pivot || !has_value(sd, kind) || (kind == PHASE && !u->phases.known[i])) { continue; }
        const double dd = make_row(nav, u, i, pivot, kind, &row);
        const pel_real r_i = (pel_real)variance(sd, kind);
        pel_real nis = 0;
        const bool used = keep[i] && pel_whiten_row(&w, r_i, &row.z, row.h, &row.var) == PEL_OK &&
                          pel_ud_update(&nav->ud, row.h, row.first, row.z, row.var, GATE_SIGMA, &nis) == PEL_OK;
        if (used) {
            pel_whiten_accept(&w, r_i, row.z, row.h);
            nav->epoch_solution.nis += (float)nis;
            nav->epoch_solution.nis_dof++;
        }
        note_row(nav, u, i, pivot, kind, dd, used);
        count_row(nav, u, i, kind, used);
    }
}

static void update_all(pel_navigator_t *nav, update_t *u)
{
    const pel_sd_set_t *set = &nav->sd;
    nav->epoch_solution.nis = 0.0f;
    nav->epoch_solution.nis_dof = 0;
    for (int first = 0; first < set->n;) {
        int last = first + 1;
        while (last < set->n && set->sd[last].group == set->sd[first].group) { last++; }
        update_group(nav, u, first, last, PHASE);
        update_group(nav, u, first, last, CODE);
        update_group(nav, u, first, last, RATE);
        first = last;
    }
}

/* ---- the epoch ----------------------------------------------------------------------------------------------------------- */

static void start_reports(pel_navigator_t *nav)
{
    nav->n_sats = nav->sd.n;
    for (int i = 0; i < nav->sd.n; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        pel_sat_report_t *r = report_of(nav, i);
        memset(r, 0, sizeof *r);
        r->sys = sd->sys;
        r->prn = sd->prn;
        r->carrier = sd->carrier;
        r->el_rad = sd->el_rad;
        r->cn0_dbhz = sd->cn0_dbhz;
        r->flags = (uint8_t)(sd->slip ? PEL_SAT_SLIP : 0u);
        const pel_sight_t *s = pel_view_find(&nav->view_rover, sd->sys, sd->prn);
        if (s != NULL) { r->az_rad = s->az_rad; }
    }
}

/* A single receiver's code errors (orbit, clock, atmosphere, multipath) last for minutes: epochs are not independent. Taking
 * each with 2 tau / dt of its variance gives the information per second of a process correlated over tau. */
static void allow_for_correlation(pel_navigator_t *nav, double gap_s)
{
    const double factor = pel_max(1.0, 2.0 * nav->cfg.single_code_tau_s / pel_max(gap_s, 0.01));
    if (nav->epoch_before_ns == 0) { return; }
    for (int i = 0; i < nav->sd.n; i++) { nav->sd.sd[i].var_code *= factor; }
}

static void add_noise(pel_navigator_t *nav, int first, double var)
{
    for (int k = 0; k < 3; k++) {
        pel_real c[PEL_MAX_STATES] = {0};
        c[first + k] = PEL_R(1.0);
        pel_ud_rank_one(&nav->ud, first + k + 1, c, (pel_real)var);
    }
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

/* Single differences against the base; false if too little is common. */
static bool difference(pel_navigator_t *nav, const pel_epoch_t *rover, pel_epoch_t *base)
{
    const double age_s = pel_time_diff_s(rover->t_ns, base->t_ns);
    nav->epoch_solution.base_age_s = (float)age_s;
    pel_nav_track_drop_slipped(nav, base);
    for (int i = 0; i < base->n; i++) { base->obs[i].flags &= (uint8_t)~PEL_OBS_SLIP; } /* told once */
    if (pel_view_compute(base, &nav->orbits, rover->t_ns, nav->station.r_ea_e, NULL, 0.0, NULL, &nav->view_base) !=
        PEL_OK) {
        return false;
    }
    forget_ionosphere(&nav->view_rover);
    forget_ionosphere(&nav->view_base);
    return pel_sd_form(rover, &nav->view_rover, base, &nav->view_base, &nav->cfg.noise, age_s, &nav->sd) == PEL_OK &&
           nav->sd.n - nav->sd.n_groups >= 3;
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
        nav->epoch_solution.base_age_s = -1.0f;
        if (tried && !view_rover(nav, rover, r_ea_e, v_ea_e, NULL)) { return false; } /* with the ionosphere again */
        if (pel_sd_undifferenced(rover, &nav->view_rover, &nav->cfg.noise_single, &nav->sd) != PEL_OK) { return false; }
        allow_for_correlation(nav, gap_s);
    }
    if (relative != nav->relative && nav->last_epoch_ns != 0) {
        add_noise(nav, pel_model_index(&nav->model, PEL_BLOCK_POSITION), MODE_CHANGE_SD_M * MODE_CHANGE_SD_M);
    }
    nav->relative = relative;
    return true;
}

/* The rows are linear in attitude. While it is coarse, the lever arm's second-order error (3 cm of 2 m at 10 degrees) and that
 * of gravity felt through it since the epoch before would be taken for centimetres of truth. */
static void allow_for_coarse_attitude(pel_navigator_t *nav, const pel_antenna_t *ant)
{
    if (ant->i_psi < 0) { return; }
    double P[3][3], up[3];
    pel_ud_block3(&nav->ud, ant->i_psi, ant->i_psi, P);
    const double var = P[0][0] + P[1][1] + P[2][2];
    if (var < COARSE_RAD * COARSE_RAD) { return; }
    (void)pel_unit3(nav->at_horizon.r_eb_e, up);
    const double var_heading = along(P, up);
    const double var_tilt = pel_max(var - var_heading, 0.0);
    const double gap_s = pel_min(1.0, pel_time_diff_s(nav->at_horizon.t_ns, nav->epoch_before_ns));
    const double felt = (0.5 * var_tilt + pel_sqrt(var_tilt * var_heading)) * GRAVITY_MPS2 * gap_s;
    const double arm = 0.5 * var * pel_norm3(ant->lever_e), arm_rate = 0.5 * var * pel_norm3(ant->lever_rate_e);
    add_noise(nav, ant->i_r, arm * arm);
    add_noise(nav, ant->i_v, arm_rate * arm_rate + felt * felt);
}

static int satellites_used(const pel_navigator_t *nav)
{
    int n = 0;
    for (int i = 0; i < nav->n_sats; i++) {
        const pel_sat_report_t *r = &nav->sats[i];
        const uint8_t any = PEL_SAT_CODE_USED | PEL_SAT_PHASE_USED | PEL_SAT_DOPPLER_USED | PEL_SAT_PIVOT;
        bool first = (r->flags & any) != 0;
        for (int j = 0; j < i && first; j++) {
            const pel_sat_report_t *other = &nav->sats[j];
            first = !(other->sys == r->sys && other->prn == r->prn && (other->flags & any) != 0);
        }
        n += first ? 1 : 0;
    }
    return n;
}

void pel_nav_stop(pel_navigator_t *nav)
{
    if (nav->ins) { pel_nav_reset_alignment(nav); }
    nav->ins = false;
    nav->have_state = false;
}

/* A filter that refuses its measurements for many epochs, or lost its factors, starts again and says so. */
static void watch_health(pel_navigator_t *nav, const update_t *u)
{
    const bool doubtful = u->code_refused > u->code_used;
    nav->doubts = (uint8_t)(doubtful ? nav->doubts + 1 : 0);
    const bool broken = pel_ud_check(&nav->ud) != PEL_OK;
    if (broken) { nav->counters.numeric_faults++; }
    const bool phases_misfit = u->held_refused > u->held_used;
    nav->track.misfits = (uint8_t)(phases_misfit ? nav->track.misfits + 1 : 0);
    if (nav->track.misfits >= MAX_MISFITS) { pel_nav_track_clear(nav); }
    if (!broken && nav->doubts < MAX_DOUBTS) { return; }
    nav->counters.restarts++;
    nav->epoch_solution.flags |= PEL_SOL_RESTARTED;
    const bool fresh = nav->have_spp && nav->spp.t_ns == nav->at_horizon.t_ns; /* never back in time */
    pel_nav_stop(nav);
    nav->relative = false; /* a single-point solution says so */
    if (fresh) { pel_nav_start_gnss(nav, &nav->spp); }
}

static void finish(pel_navigator_t *nav, const pel_epoch_t *rover, const pel_epoch_t *base, update_t *u)
{
    pel_solution_t *out = &nav->epoch_solution;
    nav->last_fix = !nav->relative ? PEL_FIX_SPP : (u->held_used >= 3) ? PEL_FIX_FIXED : PEL_FIX_FLOAT;
    if (nav->last_fix == PEL_FIX_FIXED) { u->ints.reason = PEL_INT_OK; }
    nav->counters.epochs_used++;
    nav->last_epoch_ns = nav->at_horizon.t_ns;
    out->int_reason = (uint8_t)u->ints.reason;
    out->ratio = (float)u->ints.ratio;
    out->success_rate = (float)u->ints.success;
    out->search_nodes = (uint16_t)((u->ints.nodes > 65535) ? 65535 : u->ints.nodes);
    out->n_amb = (uint8_t)u->ints.n;
    out->n_fixed = (uint8_t)u->held_used;
    out->n_sat = (uint8_t)satellites_used(nav);
    pel_nav_note_used(nav, rover, base);
    pel_nav_try_start_ins(nav);
    nav->epoch_before_ns = nav->at_horizon.t_ns;
    for (int k = 0; k < 3; k++) { nav->v_before_e[k] = nav->at_horizon.v_eb_e[k]; }
    pel_nav_fill_solution(nav, &nav->at_horizon, out);
    out->flags |= PEL_SOL_AT_EPOCH;
    nav->ready |= PEL_NAV_BIT(PEL_NAV_EPOCH);
    pel_nav_predict_now(nav);
}

/* GNSS alone over a long silence knows its place worse than the epoch's own code does. Rows are linear and the troposphere right
 * only near the truth: begin from the single-point solution, keeping what is known of velocity. */
static void replace_lost_position(pel_navigator_t *nav)
{
    const int i_r = pel_model_index(&nav->model, PEL_BLOCK_POSITION);
    double P[3][3];
    pel_ud_block3(&nav->ud, i_r, i_r, P);
    if (nav->ins || P[0][0] + P[1][1] + P[2][2] < LOST_SD_M * LOST_SD_M) { return; }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { P[i][j] = 4.0 * nav->spp.cov_r_e[i][j] + ((i == j) ? LOST_SD_M : 0.0); }
    }
    if (pel_ud_set_block3(&nav->ud, i_r, P) != PEL_OK) { return; }
    memcpy(nav->at_horizon.r_eb_e, nav->spp.r_ea_e, sizeof nav->at_horizon.r_eb_e);
}

/* Bring the state to the epoch's instant, starting it if there is none. */
static bool reach(pel_navigator_t *nav, bool solved, pel_time_t t_ns)
{
    if (nav->have_state) {
        pel_status_t status = pel_nav_advance(nav, t_ns);
        if (status == PEL_E_STALE && t_ns < nav->at_horizon.t_ns) {
            nav->counters.epochs_late++;
            return false;
        }
        if (status == PEL_E_MISSING && nav->ins) { /* the IMU has gone */
            pel_nav_drop_ins(nav);
            status = pel_nav_advance(nav, t_ns);
        }
        if (status == PEL_OK) {
            if (solved) { replace_lost_position(nav); }
            return true;
        }
        nav->counters.restarts++;
        pel_nav_stop(nav); /* also where no start follows: an INS without its factors must not go on telling */
    }
    if (!solved) { return false; }
    pel_nav_start_gnss(nav, &nav->spp);
    return nav->have_state;
}

/* Integers of this epoch alone if they can be told; every other phase keeps the N it has, or begins a float one. */
static void prepare_phases(pel_navigator_t *nav, update_t *u)
{
    if (nav->cfg.integers) { pel_nav_resolve(nav, u->P_r, &u->ints); }
    if (u->ints.reason == PEL_INT_OK) {
        pel_nav_track_hold(nav, &u->ints);
    } else {
        pel_nav_track_begin(nav);
    }
    pel_nav_track_lookup(nav, &u->phases);
    u->ant.n_states = nav->model.n;
}

/* Refused phases begin anew; float ones that have settled are resolved. */
static void judge_phases(pel_navigator_t *nav, const update_t *u)
{
    for (int i = 0; i < nav->sd.n; i++) {
        if (u->misfit[i]) { pel_nav_track_drop(nav, &nav->sd.sd[i]); }
    }
    pel_nav_integers_t later;
    memset(&later, 0, sizeof later);
    if (nav->cfg.integers && u->ints.reason != PEL_INT_OK) { (void)pel_nav_track_resolve(nav, &later); }
}

void pel_nav_apply_epoch(pel_navigator_t *nav, pel_epoch_t *rover, pel_epoch_t *base)
{
    bool solved = false;
    pel_time_t t_ns = 0;
    update_t *u = &nav->update;
    memset(u, 0, sizeof *u);
    nav->last_tag_ns = rover->t_ns;
    if (!true_time(nav, rover, &solved, &t_ns) || !reach(nav, solved, t_ns)) { return; }

    double r_ea_e[3], v_ea_e[3];
    memset(&nav->epoch_solution, 0, sizeof nav->epoch_solution);
    pel_nav_antenna(nav, &u->ant, r_ea_e, v_ea_e);
    if (!form_rows(nav, rover, base, r_ea_e, v_ea_e)) {
        nav->counters.epochs_few_sats++;
        return;
    }
    start_reports(nav);
    allow_for_coarse_attitude(nav, &u->ant);
    pel_nav_antenna_cov(nav, &u->ant, false, u->P_r);
    pel_nav_antenna_cov(nav, &u->ant, true, u->P_v);
    u->ints.reason = PEL_INT_NOT_TRIED;
    if (nav->relative) { prepare_phases(nav, u); }
    update_all(nav, u);
    pel_nav_close_loop(nav);
    if (nav->relative) { judge_phases(nav, u); }
    watch_health(nav, u);
    if (nav->have_state) { finish(nav, rover, base, u); }
}

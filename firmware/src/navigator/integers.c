/* integers.c - the integers of one epoch: problem from the single differences, engine, verdict. */
#include <string.h>

#include "internal.h"

#include "pelorus/math.h"

#define MASK_STEP_RAD (5.0 * PEL_DEG)
#define MAX_TRIES     8 /* half a cycle on one of seven satellites is found with as many */
#define PRIOR_SIGMAS  5.0
/* As long as the slope of GLONASS channels is not known, two receivers of one make are supposed: if they are not, the misfit tells. */
#define CHANNEL_SD_MAX_M 0.001

static double baseline_km(const pel_navigator_t *nav)
{
    const double d[3] = {nav->at_horizon.r_eb_e[0] - nav->station.r_ea_e[0],
                         nav->at_horizon.r_eb_e[1] - nav->station.r_ea_e[1],
                         nav->at_horizon.r_eb_e[2] - nav->station.r_ea_e[2]};
    return pel_norm3(d) * 1e-3;
}

double pel_nav_iono_sd_m(const pel_navigator_t *nav)
{
    return nav->cfg.noise.iono_mm_per_km * 1e-3 * baseline_km(nav);
}

static int satellite_index(const pel_navigator_t *nav, const pel_sd_t *sd)
{
    const pel_sight_t *s = pel_view_find(&nav->view_rover, sd->sys, sd->prn);
    return (s == NULL) ? -1 : (int)(s - nav->view_rover.sight);
}

static bool can_fix(const pel_sd_t *sd, double mask_rad)
{
    if (!sd->has_phase || sd->half || (double)sd->el_rad < mask_rad) { return false; }
    return sd->sys != PEL_SYS_GLO || sd->has_code;
}

/* What a double difference of GLONASS phases holds beside its integer: the pivot's own number on another wavelength, and the
 * slope of the channels. Both are known to their variance. */
static double channel_offset_m(const pel_navigator_t *nav, const pel_sd_t *sd, const pel_sd_t *pivot)
{
    if (sd->sys != PEL_SYS_GLO) { return 0.0; }
    double N_pivot;
    if (!pel_nav_track_number(nav, pivot, &N_pivot)) { N_pivot = pel_nav_channels_number(pivot); }
    return (sd->lambda_m - pivot->lambda_m) * N_pivot + pel_nav_channels_offset_m(nav, sd, pivot);
}

static double channel_sd_m(const pel_navigator_t *nav, const pel_sd_t *sd, const pel_sd_t *pivot)
{
    if (sd->sys != PEL_SYS_GLO) { return 0.0; }
    double N_pivot;
    const double code_m = pel_nav_track_number(nav, pivot, &N_pivot) ? 0.0 : PEL_NAV_DATUM_CODE_M;
    const double slope_m =
        pel_min(pel_nav_channels_sd_m(nav, sd->carrier), CHANNEL_SD_MAX_M) * (double)(sd->glo_k - pivot->glo_k);
    const double number_m = code_m * (sd->lambda_m / pivot->lambda_m - 1.0);
    return pel_sqrt(slope_m * slope_m + number_m * number_m);
}

static void add_group(const pel_navigator_t *nav, const pel_sd_t *pivot, pel_amb_problem_t *p)
{
    pel_amb_group_t *g = &p->group[p->n_groups++];
    const double k = pivot->lambda_m * PEL_L1_HZ / PEL_SPEED_OF_LIGHT;
    g->sat = (uint8_t)satellite_index(nav, pivot);
    g->mu = k * k;
    g->var_phase = pivot->var_phase;
    g->var_code = pivot->var_code;
}

static void add_row(const pel_navigator_t *nav, const pel_sd_t *sd, const pel_sd_t *pivot, pel_amb_problem_t *p)
{
    pel_amb_row_t *r = &p->row[p->n_rows++];
    r->group = (uint8_t)(p->n_groups - 1);
    r->sat = (uint8_t)satellite_index(nav, sd);
    r->integer = true;
    r->code = sd->has_code && pivot->has_code;
    for (int k = 0; k < 3; k++) { r->g[k] = pivot->u_e[k] - sd->u_e[k]; }
    r->lambda_m = sd->lambda_m;
    r->phase_m = sd->phase_m - pivot->phase_m - channel_offset_m(nav, sd, pivot);
    r->code_m = sd->code_m - pivot->code_m;
    const double channel_m = channel_sd_m(nav, sd, pivot);
    r->var_phase = sd->var_phase + channel_m * channel_m;
    r->var_code = sd->var_code;
}

/* All double differences above a mask; index[] tells which single difference each row is. False: they do not fit. */
static bool fill_problem(const pel_navigator_t *nav, double mask_rad, pel_amb_problem_t *p, uint8_t index[PEL_MAX_AMB])
{
    const pel_sd_set_t *set = &nav->sd;
    p->n_rows = 0;
    p->n_groups = 0;
    const pel_sd_t *pivot = NULL;
    bool open = false;
    for (int i = 0; i < set->n; i++) {
        const pel_sd_t *sd = &set->sd[i];
        if (sd->pivot) {
            pivot = can_fix(sd, 0.0) ? sd : NULL;
            open = false;
            continue;
        }
        if (pivot == NULL || pivot->group != sd->group || !can_fix(sd, mask_rad)) { continue; }
        if (p->n_rows == PEL_MAX_AMB || (!open && p->n_groups == PEL_AMB_GROUPS)) { return false; }
        if (!open) { add_group(nav, pivot, p); }
        open = true;
        index[p->n_rows] = (uint8_t)i;
        add_row(nav, sd, pivot, p);
    }
    return true;
}

void pel_nav_count_verdict(pel_nav_counters_t *c, pel_int_reason_t reason)
{
    c->fix_tried++;
    switch (reason) {
    case PEL_INT_OK: c->fix_ok++; break;
    case PEL_INT_RATIO: c->fix_ratio++; break;
    case PEL_INT_CHI2: c->fix_chi2++; break;
    case PEL_INT_BAND: c->fix_band++; break;
    case PEL_INT_PRIOR: c->fix_prior++; break;
    case PEL_INT_SUCCESS: c->fix_success++; break;
    case PEL_INT_BUDGET: c->fix_budget++; break;
    case PEL_INT_NOT_TRIED:
    case PEL_INT_FEW:
    case PEL_INT_BASE_AGE: break;
    }
}

bool pel_nav_resolve_begin(pel_navigator_t *nav, const double P_a[3][3], pel_nav_integers_t *out)
{
    pel_amb_problem_t *p = &nav->problem; /* every member of what its counts say is set below */
    double mask_rad = nav->cfg.integer_mask_rad;
    while (!fill_problem(nav, mask_rad, p, nav->update.row_of) && mask_rad < PEL_PI / 2.0) {
        mask_rad += MASK_STEP_RAD;
    }
    out->n = p->n_rows;
    out->reason = PEL_INT_FEW;
    if (p->n_rows < 4) { return false; }
    const double sd_iono_m = pel_nav_iono_sd_m(nav);
    p->var_iono = sd_iono_m * sd_iono_m;
    p->have_prior = true;
    memcpy(p->P_r, P_a, sizeof p->P_r);

    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    limits.ratio_min = (double)nav->cfg.ratio_min;
    limits.success_min = (double)nav->cfg.success_min;
    limits.prior_sigma = PRIOR_SIGMAS;
    limits.failure_max = (double)nav->cfg.failure_max;
    memset(&nav->ils, 0, offsetof(pel_ils_t, w)); /* its memory held the views: no counts, hence nothing behind them */
    return pel_amb_resolve_begin(&nav->resolver, p, &limits, nav->cfg.node_budget, MAX_TRIES) == PEL_OK;
}

bool pel_nav_resolve_step(pel_navigator_t *nav, int32_t max_nodes, pel_nav_integers_t *out)
{
    const pel_amb_problem_t *p = &nav->problem;
    int64_t N[PEL_MAX_AMB];
    pel_int_verdict_t verdict;
    memset(&verdict, 0, sizeof verdict);
    const pel_status_t status = pel_amb_resolve_step(&nav->resolver, &nav->problem, &nav->ils, max_nodes, N, &verdict);
    if (status == PEL_W_RUNNING) { return false; }
    out->ratio = verdict.ratio;
    out->success = verdict.success;
    out->nodes = nav->cfg.node_budget - nav->resolver.budget;
    out->reason = (status < 0) ? PEL_INT_FEW : verdict.reason;
    for (int r = 0; status == PEL_OK && r < p->n_rows; r++) {
        if (!p->row[r].integer || N[r] > INT32_MAX || N[r] < INT32_MIN) { continue; }
        const int i = nav->update.row_of[r];
        out->reason = PEL_INT_OK;
        out->fixed[i] = true;
        out->N[i] = (int32_t)N[r];
        out->n_fixed++;
    }
    pel_nav_count_verdict(&nav->counters, out->reason);
    return true;
}

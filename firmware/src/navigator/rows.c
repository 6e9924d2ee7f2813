/* rows.c - double differences of one epoch become filter updates: screening, whitening, gate, reports. */
#include <string.h>

#include "internal.h"

#include "pelorus/math.h"

#define GATE_SIGMA  PEL_R(6.0) /* last gate on a whitened row; coarse errors are screened before */
#define HUBER_SIGMA PEL_R(3.0)

typedef pel_nav_update_t update_t;
typedef enum { CODE = PEL_NAV_LEVEL_CODE, PHASE = PEL_NAV_LEVEL_PHASE, RATE = 2 } kind_t;

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
        const double var = variance(sd, kind) + 2.0 * pel_nav_along((kind == RATE) ? u->P_v : u->P_r, sd->u_e);
        const double off = value(sd, kind) - middle;
        const bool coarse = n > 2 && off * off > 25.0 * var;
        keep[i] = !coarse;
        const bool better =
            pivot < 0 || ((kind == RATE) ? variance(sd, kind) < variance(&set->sd[pivot], kind) : sd->pivot);
        if (keep[i] && better) { pivot = i; }
    }
    return pivot;
}

/* An innovation and its 1 sigma as reported. */
typedef struct {
    float innov, sd;
} seen_t;

/* That of the double difference by what was known of the antenna before the update. */
static seen_t before_update(const pel_navigator_t *nav, const update_t *u, int i, int pivot, kind_t kind, double dd)
{
    const pel_sd_t *sd = &nav->sd.sd[i], *p = &nav->sd.sd[pivot];
    const double g[3] = {p->u_e[0] - sd->u_e[0], p->u_e[1] - sd->u_e[1], p->u_e[2] - sd->u_e[2]};
    const double var = pel_nav_along((kind == RATE) ? u->P_v : u->P_r, g) + variance(sd, kind) + variance(p, kind);
    return (seen_t){.innov = (float)-dd, .sd = (float)pel_sqrt(var)};
}

/* That of the row as the filter met it: a float phase's sigma is in its state. */
static seen_t by_filter(double z, pel_real nis)
{
    return (seen_t){.innov = (float)z, .sd = (nis > 0) ? (float)(pel_fabs(z) / pel_sqrt((double)nis)) : 0.0f};
}

static void note_row(pel_navigator_t *nav, const update_t *u, int i, int pivot, kind_t kind, seen_t seen, bool used)
{
    pel_sat_report_t *r = &nav->sats[i];
    const float innov = seen.innov, s = seen.sd;
    nav->sats[pivot].flags |= PEL_SAT_PIVOT;
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
        u->phase_used += (kind == PHASE);
        u->held_used += held;
    } else {
        nav->counters.rows_gated++;
        u->code_refused += (kind == CODE);
        u->held_refused += held;
        u->misfit[i] = kind == PHASE;
    }
}

/* No two of several are near their median: all are refused, or a position that is wrong by far would go uncontradicted. */
static void refuse_coarse(pel_navigator_t *nav, update_t *u, int first, int last, kind_t kind, const bool keep[])
{
    for (int i = first; i < last && kind != PHASE; i++) {
        if (keep[i] || !has_value(&nav->sd.sd[i], kind)) { continue; }
        nav->sats[i].flags |= PEL_SAT_EXCLUDED;
        count_row(nav, u, i, kind, false);
    }
}

/* The double difference of satellite i against the pivot as a row; phases carry their N, integer or state. */
static double make_row(pel_navigator_t *nav, const update_t *u, int i, int pivot, kind_t kind, pel_row_t *row)
{
    const pel_sd_t *sd = &nav->sd.sd[i], *p = &nav->sd.sd[pivot];
    const double unit_i = nav->relative ? sd->lambda_m : 1.0, unit_p = nav->relative ? p->lambda_m : 1.0; /* of N */
    double dd = value(sd, kind) - value(p, kind);
    if (kind == PHASE) {
        dd -= unit_i * u->phases.N[i] - unit_p * u->phases.N[pivot];
        if (nav->relative) { dd -= pel_nav_channels_offset_m(nav, sd, p); }
    }
    if (kind == RATE) {
        pel_observe_rate(&u->ant, sd, p, dd, row);
        return dd;
    }
    if (kind == PHASE && !nav->relative) {
        pel_nav_rover_phase_row(nav, &u->ant, sd, p, dd, row);
    } else {
        pel_observe_range(&u->ant, sd, p, dd, row);
    }
    if (kind == PHASE && u->phases.state[i] >= 0) { row->h[u->phases.state[i]] = (pel_real)unit_i; }
    if (kind == PHASE && u->phases.state[pivot] >= 0) { row->h[u->phases.state[pivot]] = (pel_real)-unit_p; }
    if (kind == PHASE && nav->relative) { pel_nav_channels_put(nav, sd, p, row); }
    return dd;
}

/* Beyond a few sigma an error is rather a reflection than noise: its row counts less (Huber 1964), beyond the gate nothing. nis is that
 * of the row as it was. */
static bool update_robustly(pel_navigator_t *nav, pel_row_t *row, pel_real *nis)
{
    const pel_status_t status = pel_ud_update(&nav->ud, row->h, row->first, row->z, row->var, HUBER_SIGMA, nis);
    if (status != PEL_W_REJECTED) { return status == PEL_OK; }
    if (!(*nis <= GATE_SIGMA * GATE_SIGMA)) { return false; }
    row->var *= (pel_real)pel_sqrt((double)*nis) / HUBER_SIGMA;
    return pel_ud_update(&nav->ud, row->h, row->first, row->z, row->var, 0, NULL) == PEL_OK;
}

/* A row whose variance was inflated, because its error will be the same in many epochs, passes every gate. How likely one error of its size
 * is goes by the variance before that; the farther out, the less it moves the state. Only an INS knows where it is well enough to judge. */
static void weaken_reflection(const pel_navigator_t *nav, double inflated_by, pel_row_t *row)
{
    if (!nav->ins || !(inflated_by > 1.0)) { return; }
    const double var = (double)pel_ud_hph(&nav->ud, row->h, row->first) + (double)row->var / inflated_by;
    const double nis = (double)row->z * (double)row->z / var;
    const double huber_sq = (double)HUBER_SIGMA * (double)HUBER_SIGMA;
    if (nis > huber_sq) { row->var *= (pel_real)(nis / huber_sq); }
}

/* One kind of measurement of one group: double differences against the pivot, whitened, into the filter. */
static void update_group(pel_navigator_t *nav, update_t *u, const pel_nav_axes_t *axes, int first, int last,
                         kind_t kind)
{
    bool keep[PEL_MAX_OBS];
    const int pivot = screen(nav, u, first, last, kind, keep);
    pel_whiten_t w;
    pel_row_t row;
    if (pivot < 0) {
        refuse_coarse(nav, u, first, last, kind, keep);
        return;
    }
    const int lead = (u->ant.i_psi > 0) ? u->ant.i_psi : 0; /* sensor states, which no row has */
    if (pel_whiten_begin(&w, nav->model.n - lead, (pel_real)variance(&nav->sd.sd[pivot], kind)) != PEL_OK) { return; }
    for (int i = first; i < last; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        if (i == pivot || !has_value(sd, kind) || (kind == PHASE && !u->phases.known[i])) { continue; }
        const double dd = make_row(nav, u, i, pivot, kind, &row);
        pel_nav_turn_row(axes, &u->ant, &row);
        const pel_real r_i = (pel_real)variance(sd, kind);
        pel_real nis = 0;
        const bool whitened = keep[i] && pel_whiten_row(&w, r_i, &row.z, &row.h[lead], &row.var) == PEL_OK;
        if (whitened && kind == CODE && u->held_used >= 3) { pel_nav_hold_watch_row(nav, &row, u->ant.i_r); }
        const double z = (double)row.z;
        const bool learns = whitened && nav->noise_level.learning && kind != RATE && (nav->relative || kind == PHASE);
        const double var_state = learns ? (double)pel_ud_hph(&nav->ud, row.h, row.first) : 0.0;
        if (whitened && kind == CODE) { weaken_reflection(nav, u->code_inflated_by, &row); }
        const bool used = whitened && update_robustly(nav, &row, &nis);
        if (used && learns) {
            const int level = (kind == PHASE && !nav->relative) ? PEL_NAV_LEVEL_ROVER : (int)kind;
            /* With the variance that the row was used with: one far out is the measurement's error rather than the state's. */
            pel_nav_noise_level_learn(nav, sd, level, (double)nis, var_state, (double)row.var);
        }
        if (used) {
            pel_whiten_accept(&w, r_i, row.z, &row.h[lead]);
            u->nis += (float)nis;
            u->nis_dof++;
        }
        const bool floats = kind == PHASE && !nav->relative;
        note_row(nav, u, i, pivot, kind, floats ? by_filter(z, nis) : before_update(nav, u, i, pivot, kind, dd), used);
        count_row(nav, u, i, kind, used);
    }
}

void pel_nav_update_rows(pel_navigator_t *nav, update_t *u)
{
    const pel_sd_set_t *set = &nav->sd;
    const pel_preset_t preset = pel_nav_preset_in_use(nav);
    const bool code = preset != PEL_PRESET_INS_FLOAT || nav->cfg.float_code;
    const bool rates = pel_nav_preset(preset)->rates;
    pel_nav_axes_t axes;
    pel_nav_axes(nav, &axes);
    u->nis = 0.0f;
    u->nis_dof = 0;
    if (u->phased && !nav->relative) { update_group(nav, u, &axes, 0, set->n, PHASE); } /* one clock, one datum */
    for (int first = 0; first < set->n;) {
        int last = first + 1;
        while (last < set->n && set->sd[last].group == set->sd[first].group) { last++; }
        if (nav->relative) { update_group(nav, u, &axes, first, last, PHASE); }
        if (code) { update_group(nav, u, &axes, first, last, CODE); }
        first = last;
    }
    /* One oscillator: the rate of the receiver's clock is common to all systems and carriers. */
    if (rates) { update_group(nav, u, &axes, 0, set->n, RATE); }
}

void pel_nav_start_reports(pel_navigator_t *nav)
{
    nav->n_sats = nav->sd.n;
    for (int i = 0; i < nav->sd.n; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        pel_sat_report_t *r = &nav->sats[i];
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

int pel_nav_satellites_used(const pel_navigator_t *nav)
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

/* amb_float.c - float ambiguities of one epoch and their covariance, from code, phase and a position prior.
 *
 * With integers free a phase says nothing about anything else, so the estimate splits exactly: code and prior give
 * x = [b, I_1..I_k] with covariance P, then a = (phase - H x) / lambda and Q = (R + H P H') / lambda lambda'.
 * The joint system of 2 m + 3 unknowns is never formed. Derivation: docs/INTEGERS.md. */
#include <string.h>

#include "ambiguity_internal.h"
#include "pelorus/math.h"

#define NO_PRIOR_SD_M 1e3 /* wide beside any code solution, small enough to leave 1e-10 m^2 of its square's digits */
#define STATES_MAX    (3 + PEL_AMB_IONO_SATS)
#define NO_STATE      0xFF

_Static_assert(PEL_TRI(STATES_MAX) + STATES_MAX <= PEL_TRI(PEL_MAX_AMB), "x and P share the memory of the search");

/* x and P of the epoch inside the engine's scratch, and where a satellite's ionosphere is among them. */
typedef struct {
    int k;
    double *P; /* packed lower triangle */
    double *x;
    uint8_t of_sat[PEL_MAX_SATS];
} epoch_t;

/* A row's partials: three of position, and the ionosphere of its satellite and of the pivot. */
typedef struct {
    int n;
    int index[5];
    double h[5];
} sparse_t;

static bool positive(double var)
{
    return var > 0.0 && var < 1e12;
}

static pel_status_t check(const pel_amb_problem_t *p)
{
    if (p->n_rows < 1 || p->n_rows > PEL_MAX_AMB || p->n_groups < 1 || p->n_groups > PEL_AMB_GROUPS) {
        return PEL_E_RANGE;
    }
    if (!(p->var_iono >= 0.0 && p->var_iono < 1e6)) { return PEL_E_RANGE; }
    int n_code = 0;
    for (int i = 0; i < p->n_rows; i++) {
        const pel_amb_row_t *row = &p->row[i];
        if (row->group >= p->n_groups || row->sat >= PEL_MAX_SATS) { return PEL_E_RANGE; }
        if (i > 0 && row->group < p->row[i - 1].group) { return PEL_E_RANGE; }
        const pel_amb_group_t *g = &p->group[row->group];
        if (g->sat >= PEL_MAX_SATS || !(g->mu >= 0.0 && g->mu < 100.0)) { return PEL_E_RANGE; }
        if (!pel_isfinite(row->g[0] + row->g[1] + row->g[2])) { return PEL_E_RANGE; }
        if (row->integer && !(positive(row->var_phase) && positive(g->var_phase) && pel_isfinite(row->phase_m) &&
                              row->lambda_m > 1e-3 && row->lambda_m < 1e3)) {
            return PEL_E_RANGE;
        }
        if (row->code && !(positive(row->var_code) && positive(g->var_code) && pel_isfinite(row->code_m))) {
            return PEL_E_RANGE;
        }
        n_code += row->code;
    }
    if (pel_amb_count(p) == 0) { return PEL_E_MISSING; }
    if (!p->have_prior && n_code < 3) { return PEL_E_GEOMETRY; }
    return PEL_OK;
}

/* Satellites that find no room have their ionosphere taken as noise, which forgets only that carriers and code share it. */
static void add_satellite(epoch_t *e, uint8_t sat)
{
    if (e->of_sat[sat] == NO_STATE && e->k < STATES_MAX) { e->of_sat[sat] = (uint8_t)e->k++; }
}

static double iono_noise(const pel_amb_problem_t *p, const epoch_t *e, const pel_amb_group_t *g, uint8_t sat)
{
    return (e->of_sat[sat] == NO_STATE) ? g->mu * g->mu * p->var_iono : 0.0;
}

/* Prior x = 0 and P. */
static void start(const pel_amb_problem_t *p, epoch_t *e)
{
    memset(e->of_sat, NO_STATE, sizeof e->of_sat);
    e->k = 3;
    for (int i = 0; p->var_iono > 0.0 && i < p->n_rows; i++) {
        add_satellite(e, p->group[p->row[i].group].sat);
        add_satellite(e, p->row[i].sat);
    }
    for (int i = 0; i < e->k; i++) {
        e->x[i] = 0.0;
        double *row = tri_row(e->P, i);
        for (int j = 0; j <= i; j++) {
            row[j] = 0.0;
            if (i < 3 && p->have_prior) { row[j] = p->P_r[i][j]; }
        }
        if (i >= 3) { row[i] = p->var_iono; }
        if (i < 3 && !p->have_prior) { row[i] = NO_PRIOR_SD_M * NO_PRIOR_SD_M; }
    }
}

/* Partials of a row; the ionosphere delays code (sign +1) and advances phase (sign -1). */
static sparse_t partials(const pel_amb_problem_t *p, const epoch_t *e, const pel_amb_row_t *row, double sign)
{
    const pel_amb_group_t *g = &p->group[row->group];
    sparse_t s = {3, {0, 1, 2, 0, 0}, {row->g[0], row->g[1], row->g[2], 0.0, 0.0}};
    if (e->of_sat[row->sat] != NO_STATE) {
        s.index[s.n] = e->of_sat[row->sat];
        s.h[s.n++] = sign * g->mu;
    }
    if (e->of_sat[g->sat] != NO_STATE) {
        s.index[s.n] = e->of_sat[g->sat];
        s.h[s.n++] = -sign * g->mu;
    }
    return s;
}

/* out = P h, h dense. */
static void covariance_times(const epoch_t *e, const double *h, double *out)
{
    for (int i = 0; i < e->k; i++) { out[i] = 0.0; }
    for (int i = 0; i < e->k; i++) {
        const double *row = tri_row(e->P, i);
        for (int j = 0; j < i; j++) {
            out[i] += row[j] * h[j];
            out[j] += row[j] * h[i];
        }
        out[i] += row[i] * h[i];
    }
}

/* Fold in y = h x + noise of variance r; returns its share of the misfit. */
static double update(epoch_t *e, const double *h, double y, double r)
{
    double Ph[STATES_MAX];
    covariance_times(e, h, Ph);
    double var = r;
    double innov = y;
    for (int i = 0; i < e->k; i++) {
        var += h[i] * Ph[i];
        innov -= h[i] * e->x[i];
    }
    for (int i = 0; i < e->k; i++) {
        const double gain = Ph[i] / var;
        double *row = tri_row(e->P, i);
        e->x[i] += gain * innov;
        for (int j = 0; j <= i; j++) { row[j] -= gain * Ph[j]; }
    }
    return innov * innov / var;
}

/* All codes, group by group: the noise of the pivot is whitened in closed form (S1 section 3). Returns the misfit. */
static double use_codes(const pel_amb_problem_t *p, epoch_t *e, int *n_code)
{
    double sum_h[STATES_MAX] = {0.0};
    double sum_y = 0.0;
    double q = 0.0;
    double sq = 0.0;
    int group = -1;
    *n_code = 0;
    for (int i = 0; i < p->n_rows; i++) {
        const pel_amb_row_t *row = &p->row[i];
        if (!row->code) { continue; }
        if (row->group != group) {
            group = row->group;
            const pel_amb_group_t *g = &p->group[group];
            q = g->var_code + iono_noise(p, e, g, g->sat);
            sum_y = 0.0;
            memset(sum_h, 0, sizeof sum_h);
        }
        double h[STATES_MAX] = {0.0};
        for (int j = 0; j < e->k; j++) { h[j] = -sum_h[j]; }
        const sparse_t s = partials(p, e, row, 1.0);
        for (int j = 0; j < s.n; j++) { h[s.index[j]] += s.h[j]; }
        const double y = row->code_m - sum_y;
        const double r = row->var_code + iono_noise(p, e, &p->group[group], row->sat);
        const double d = r + q;
        const double l = q / d;
        for (int j = 0; j < e->k; j++) { sum_h[j] += l * h[j]; }
        sum_y += l * y;
        q *= r / d;
        sq += update(e, h, y, d);
        (*n_code)++;
    }
    return sq;
}

/* a and Q of the phases into the engine. */
static void form_ambiguities(const pel_amb_problem_t *p, const epoch_t *e, pel_ils_t *s)
{
    int ni = 0;
    for (int i = 0; i < p->n_rows; i++) {
        const pel_amb_row_t *ri = &p->row[i];
        if (!ri->integer) { continue; }
        const pel_amb_group_t *g = &p->group[ri->group];
        const sparse_t hi = partials(p, e, ri, -1.0);
        double h[STATES_MAX] = {0};
        double Ph[STATES_MAX] = {0.0};
        for (int k = 0; k < hi.n; k++) { h[hi.index[k]] += hi.h[k]; }
        covariance_times(e, h, Ph);
        double rest = ri->phase_m;
        for (int k = 0; k < hi.n; k++) { rest -= hi.h[k] * e->x[hi.index[k]]; }
        s->a[ni] = rest / ri->lambda_m;

        double *row = tri_row(s->Q, ni);
        int nj = 0;
        for (int j = 0; j <= i; j++) {
            const pel_amb_row_t *rj = &p->row[j];
            if (!rj->integer) { continue; }
            const sparse_t hj = partials(p, e, rj, -1.0);
            double q = 0.0;
            for (int k = 0; k < hj.n; k++) { q += hj.h[k] * Ph[hj.index[k]]; }
            if (ri->group == rj->group) { q += g->var_phase + iono_noise(p, e, g, g->sat); }
            if (i == j) { q += ri->var_phase + iono_noise(p, e, g, ri->sat); }
            row[nj++] = q / (ri->lambda_m * rj->lambda_m);
        }
        ni++;
    }
}

int pel_amb_count(const pel_amb_problem_t *p)
{
    int n = 0;
    for (int i = 0; i < p->n_rows; i++) { n += p->row[i].integer; }
    return n;
}

pel_status_t pel_amb_float(const pel_amb_problem_t *p, pel_ils_t *s, int n_best, int32_t budget)
{
    s->n = 0;
    s->stage = PEL_ILS_EMPTY;
    pel_status_t status = check(p);
    if (status != PEL_OK) { return status; }
    epoch_t e = {.P = s->scratch, .x = s->scratch + PEL_TRI(STATES_MAX)};
    start(p, &e);
    int n_code = 0;
    const double sq = use_codes(p, &e, &n_code);
    form_ambiguities(p, &e, s);
    status = pel_ils_init_as(s, PEL_ILS_LAMBDA, pel_amb_count(p), s->a, s->Q, n_best, budget);
    if (status != PEL_OK) { return status; }
    pel_ils_decorrelate_to_the_end(s);
    s->float_sq = sq;
    s->float_dof = p->have_prior ? n_code : n_code - 3;
    return PEL_OK;
}

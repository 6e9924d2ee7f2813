/* cascade.c - wide-lane integers first, then those of both carriers given them. Combinations: docs/INTEGERS.md. */
#include <string.h>

#include "ambiguity_internal.h"
#include "pelorus/ambiguity_methods.h"
#include "pelorus/math.h"

enum { WIDE, NARROW, ENDED };

_Static_assert(PEL_MAX_AMB <= 64, "rows are remembered by the bits of a word");

/* y = c1 y1 + c2 y2 of two carriers. */
typedef struct {
    double c1, c2;
} mix_t;

static double variance(mix_t m, double var1, double var2)
{
    return m.c1 * m.c1 * var1 + m.c2 * m.c2 * var2;
}

/* Ionosphere of a mix, in units of that on L1: of a code (delayed) the mean of mu, of a phase its negative. */
static double mix_mu(mix_t m, const pel_amb_group_t *g1, const pel_amb_group_t *g2)
{
    return m.c1 * g1->mu + m.c2 * g2->mu;
}

/* The difference in cycles, as range. */
static mix_t wide_lane(double lambda1, double lambda2)
{
    return (mix_t){lambda2 / (lambda2 - lambda1), -lambda1 / (lambda2 - lambda1)};
}

/* Of sum 1, and uncorrelated with the wide lane for the noise of the pivot. */
static mix_t narrow_lane(double lambda1, double lambda2, const pel_amb_group_t *g1, const pel_amb_group_t *g2)
{
    const double w1 = lambda2 * g1->var_phase;
    const double w2 = lambda1 * g2->var_phase;
    return (mix_t){w2 / (w1 + w2), w1 / (w1 + w2)};
}

/* Of sum 1 and least variance, noise and ionosphere together. */
static mix_t best_range(const pel_amb_group_t *g1, const pel_amb_group_t *g2, double var1, double var2, double var_iono)
{
    const double d1 = var1 + g1->mu * g1->mu * var_iono;
    const double d2 = var2 + g2->mu * g2->mu * var_iono;
    const double d12 = g1->mu * g2->mu * var_iono;
    const double c1 = (d2 - d12) / (d1 + d2 - 2.0 * d12);
    return (mix_t){c1, 1.0 - c1};
}

/* ---- pairs -------------------------------------------------------------------------------------------------------- */

static int partner(const pel_amb_problem_t *p, int i)
{
    const pel_amb_row_t *a = &p->row[i];
    for (int j = 0; j < p->n_rows; j++) {
        const pel_amb_row_t *b = &p->row[j];
        if (b->integer && b->sat == a->sat && b->group != a->group && b->lambda_m > 1.001 * a->lambda_m &&
            p->group[a->group].sat == p->group[b->group].sat) {
            return j;
        }
    }
    return -1;
}

/* Pairs in the order of the rows of the higher frequency; all of one group have the same second group. */
static void list_pairs(pel_amb_cascade_t *c, const pel_amb_problem_t *p)
{
    uint64_t taken = 0;
    int group = -1;
    int second = -1;
    int room = PEL_AMB_GROUPS / 2;        /* each pair of groups becomes two groups of the narrow-lane problem */
    for (int i = 0; i < p->n_rows; i++) { /* no row is in two pairs */
        const pel_amb_row_t *row = &p->row[i];
        if (!row->integer || ((taken >> i) & 1u) != 0) { continue; }
        const int j = partner(p, i);
        if (j < 0 || ((taken >> j) & 1u) != 0) { continue; }
        if (row->group != group) {
            if (room-- == 0) { return; }
            group = row->group;
            second = p->row[j].group;
        }
        if (p->row[j].group != second) { continue; }
        taken |= (UINT64_C(1) << i) | (UINT64_C(1) << j);
        c->row1[c->n_pairs] = (uint8_t)i;
        c->row2[c->n_pairs++] = (uint8_t)j;
    }
}

/* The two rows and groups of a pair. */
typedef struct {
    const pel_amb_row_t *r1, *r2;
    const pel_amb_group_t *g1, *g2;
} pair_t;

static pair_t pair_of(const pel_amb_cascade_t *c, const pel_amb_problem_t *p, int k)
{
    const pel_amb_row_t *r1 = &p->row[c->row1[k]];
    const pel_amb_row_t *r2 = &p->row[c->row2[k]];
    return (pair_t){r1, r2, &p->group[r1->group], &p->group[r2->group]};
}

static bool starts_group(const pel_amb_cascade_t *c, const pel_amb_problem_t *p, int k)
{
    return k == 0 || p->row[c->row1[k]].group != p->row[c->row1[k - 1]].group;
}

/* An empty problem with the same prior. */
static pel_amb_problem_t *clear_work(pel_amb_cascade_t *c, const pel_amb_problem_t *p, double var_iono)
{
    pel_amb_problem_t *w = &c->work;
    memset(w, 0, sizeof *w);
    w->have_prior = p->have_prior;
    memcpy(w->P_r, p->P_r, sizeof w->P_r);
    w->var_iono = var_iono;
    return w;
}

static pel_amb_row_t *add_row(pel_amb_problem_t *w, const pel_amb_row_t *like)
{
    pel_amb_row_t *row = &w->row[w->n_rows++];
    row->group = (uint8_t)(w->n_groups - 1);
    row->sat = like->sat;
    row->lambda_m = 1.0;
    memcpy(row->g, like->g, sizeof row->g);
    return row;
}

/* ---- wide lane --------------------------------------------------------------------------------------------------------- */

/* Which codes the pairs of a group have in common decides what code they get: both mixed, or one carrier's. */
static mix_t code_mix(const pel_amb_cascade_t *c, const pel_amb_problem_t *p, int first)
{
    int n1 = 0;
    int both = 0;
    int n = 0;
    for (int k = first; k < c->n_pairs && (k == first || !starts_group(c, p, k)); k++) {
        const pair_t q = pair_of(c, p, k);
        n++;
        n1 += q.r1->code;
        both += q.r1->code && q.r2->code;
    }
    const pair_t q = pair_of(c, p, first);
    if (both == n) { return best_range(q.g1, q.g2, q.g1->var_code, q.g2->var_code, p->var_iono); }
    return (mix_t){(n1 > 0) ? 1.0 : 0.0, (n1 > 0) ? 0.0 : 1.0};
}

/* One row a pair. The ionosphere delays wide lanes as it does codes, but is noise here: 0.1 cycle at 60 km. */
static void build_wide(pel_amb_cascade_t *c, const pel_amb_problem_t *p)
{
    pel_amb_problem_t *w = clear_work(c, p, 0.0);
    mix_t code = {0.0, 0.0};
    for (int k = 0; k < c->n_pairs; k++) {
        const pair_t q = pair_of(c, p, k);
        const mix_t wide = wide_lane(q.r1->lambda_m, q.r2->lambda_m);
        const double mu = mix_mu(wide, q.g1, q.g2);
        const double iono = mu * mu * p->var_iono;
        if (starts_group(c, p, k)) {
            code = code_mix(c, p, k);
            w->group[w->n_groups++].sat = q.g1->sat;
        }
        const double mu_code = mix_mu(code, q.g1, q.g2);
        const double iono_code = mu_code * mu_code * p->var_iono;
        pel_amb_group_t *g = &w->group[w->n_groups - 1];
        g->var_phase = variance(wide, q.g1->var_phase, q.g2->var_phase) + iono;
        g->var_code = variance(code, q.g1->var_code, q.g2->var_code) + iono_code;
        pel_amb_row_t *row = add_row(w, q.r1);
        row->integer = true;
        row->lambda_m = wide.c1 * q.r1->lambda_m;
        row->phase_m = wide.c1 * q.r1->phase_m + wide.c2 * q.r2->phase_m;
        row->var_phase = variance(wide, q.r1->var_phase, q.r2->var_phase) + iono;
        row->code = (code.c1 == 0.0 || q.r1->code) && (code.c2 == 0.0 || q.r2->code);
        if (!row->code) { continue; }
        row->code_m = code.c1 * q.r1->code_m + code.c2 * q.r2->code_m;
        row->var_code = variance(code, q.r1->var_code, q.r2->var_code) + iono_code;
    }
}

/* ---- narrow lane ---------------------------------------------------------------------------------------------------- */

/* Wide lanes as codes of their group, then the other phases with their integers. */
static void build_narrow(pel_amb_cascade_t *c, const pel_amb_problem_t *p)
{
    pel_amb_problem_t *w = clear_work(c, p, p->var_iono);
    for (int first = 0, next; first < c->n_pairs; first = next) {
        for (next = first + 1; next < c->n_pairs && !starts_group(c, p, next);) { next++; }
        for (int is_narrow = 0; is_narrow < 2; is_narrow++) {
            const pair_t f = pair_of(c, p, first);
            const mix_t wide = wide_lane(f.r1->lambda_m, f.r2->lambda_m);
            const mix_t m = is_narrow ? narrow_lane(f.r1->lambda_m, f.r2->lambda_m, f.g1, f.g2) : wide;
            const double var = variance(m, f.g1->var_phase, f.g2->var_phase);
            w->group[w->n_groups++] = (pel_amb_group_t){
                .sat = f.g1->sat, .mu = pel_fabs(mix_mu(m, f.g1, f.g2)), .var_phase = var, .var_code = var};
            for (int k = first; k < next; k++) {
                if (!c->is_wide[k]) { continue; }
                const pair_t q = pair_of(c, p, k);
                const double y = m.c1 * q.r1->phase_m + m.c2 * (q.r2->phase_m + q.r2->lambda_m * (double)c->N_wide[k]);
                pel_amb_row_t *row = add_row(w, q.r1);
                row->integer = is_narrow;
                row->code = !is_narrow;
                row->lambda_m = is_narrow ? m.c1 * q.r1->lambda_m + m.c2 * q.r2->lambda_m : 1.0;
                row->phase_m = y;
                row->code_m = y;
                row->var_phase = variance(m, q.r1->var_phase, q.r2->var_phase);
                row->var_code = row->var_phase;
            }
        }
    }
}

/* Phases of both carriers without their integers, mixed for the least variance of each range. */
static void build_ranges(pel_amb_cascade_t *c, const pel_amb_problem_t *p, const int64_t *N)
{
    pel_amb_problem_t *w = clear_work(c, p, 0.0);
    for (int k = 0; k < c->n_pairs; k++) {
        const pair_t q = pair_of(c, p, k);
        const mix_t m = best_range(q.g1, q.g2, q.g1->var_phase, q.g2->var_phase, p->var_iono);
        const double mu = mix_mu(m, q.g1, q.g2);
        const double iono = mu * mu * p->var_iono;
        if (starts_group(c, p, k)) {
            w->group[w->n_groups++] =
                (pel_amb_group_t){.sat = q.g1->sat, .var_phase = variance(m, q.g1->var_phase, q.g2->var_phase) + iono};
        }
        if (((c->fixed >> c->row1[k]) & 1u) == 0) { continue; }
        pel_amb_row_t *row = add_row(w, q.r1);
        row->integer = true;
        row->phase_m = m.c1 * (q.r1->phase_m - q.r1->lambda_m * (double)N[c->row1[k]]) +
                       m.c2 * (q.r2->phase_m - q.r2->lambda_m * (double)N[c->row2[k]]);
        row->var_phase = variance(m, q.r1->var_phase, q.r2->var_phase) + iono;
    }
}

static double trace(const double P[3][3])
{
    return P[0][0] + P[1][1] + P[2][2];
}

/* Position from the work problem and integers by its rows, if it is better than the one there is. */
static void take_position(pel_amb_cascade_t *c, int64_t *N)
{
    double b[3], P_b[3][3], sq;
    int dof;
    int n = 0;
    for (int i = 0; i < c->work.n_rows; i++) {
        if (c->work.row[i].integer) { N[n++] = N[i]; }
    }
    if (pel_amb_fixed(&c->work, N, b, P_b, &sq, &dof) != PEL_OK) { return; }
    const double before = trace(c->P_b);
    if (before > 0.0 && before <= trace(P_b)) { return; }
    memcpy(c->b, b, sizeof b);
    memcpy(c->P_b, P_b, sizeof P_b);
}

/* ---- steps -------------------------------------------------------------------------------------------------------- */

static pel_status_t begin_step(pel_amb_cascade_t *c, uint8_t stage)
{
    c->stage = stage;
    return pel_amb_resolve_begin(&c->resolver, &c->work, &c->limits, c->budget, c->max_tries);
}

pel_status_t pel_amb_cascade_begin(pel_amb_cascade_t *c, const pel_amb_problem_t *p, const pel_int_limits_t *limits,
                                   int32_t budget, int max_tries)
{
    memset(c, 0, sizeof *c);
    c->wide = (pel_int_verdict_t){.reason = PEL_INT_NOT_TRIED, .worst_row = -1};
    c->narrow = c->wide;
    c->stage = ENDED;
    if (p->n_rows < 0 || p->n_rows > PEL_MAX_AMB || p->n_groups > PEL_AMB_GROUPS || max_tries < 1 || max_tries > 63) {
        return PEL_E_RANGE;
    }
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].group >= p->n_groups) { return PEL_E_RANGE; }
    }
    list_pairs(c, p);
    if (c->n_pairs == 0) { return PEL_E_MISSING; }
    c->limits = *limits;
    c->limits.failure_max *= 0.5;
    c->budget = budget;
    c->max_tries = (int8_t)max_tries;
    build_wide(c, p);
    const pel_status_t status = begin_step(c, WIDE);
    if (status != PEL_OK) { c->stage = ENDED; }
    return status;
}

/* Wide lanes are fixed: note them, and on to the narrow ones. N by row of the work problem. */
static pel_status_t to_narrow(pel_amb_cascade_t *c, const pel_amb_problem_t *p, int64_t *N)
{
    c->level = PEL_CASCADE_WIDE;
    for (int k = 0; k < c->n_pairs; k++) {
        c->is_wide[k] = c->work.row[k].integer;
        c->N_wide[k] = N[k];
        c->n_wide += c->is_wide[k];
    }
    take_position(c, N);
    c->budget = c->resolver.budget;
    build_narrow(c, p);
    if (c->budget < 1 || begin_step(c, NARROW) != PEL_OK) {
        c->stage = ENDED;
        c->narrow.reason = PEL_INT_BUDGET;
        return PEL_W_REJECTED;
    }
    return PEL_W_RUNNING;
}

/* Narrow lanes are fixed: M's integers are those of the higher frequency. N_work by row of the work problem. */
static pel_status_t deliver(pel_amb_cascade_t *c, const pel_amb_problem_t *p, int64_t *N_work, int64_t *N)
{
    c->level = PEL_CASCADE_NARROW;
    c->stage = ENDED;
    for (int i = 0; i < PEL_MAX_AMB; i++) { N[i] = 0; }
    for (int k = 0; k < c->n_pairs; k++) {
        for (int i = 0; i < c->work.n_rows; i++) {
            const pel_amb_row_t *row = &c->work.row[i];
            if (!row->integer || row->sat != p->row[c->row1[k]].sat || !c->is_wide[k]) { continue; }
            c->fixed |= (UINT64_C(1) << c->row1[k]) | (UINT64_C(1) << c->row2[k]);
            N[c->row1[k]] = N_work[i];
            N[c->row2[k]] = N_work[i] - c->N_wide[k];
            c->n_narrow++;
        }
    }
    build_ranges(c, p, N);
    for (int i = 0; i < PEL_MAX_AMB; i++) { N_work[i] = 0; }
    take_position(c, N_work);
    return PEL_OK;
}

pel_status_t pel_amb_cascade_step(pel_amb_cascade_t *c, const pel_amb_problem_t *p, pel_ils_t *s, int32_t max_nodes,
                                  int64_t *N)
{
    int64_t N_work[PEL_MAX_AMB];
    if (c->stage == ENDED) { return PEL_E_MISSING; }
    pel_int_verdict_t *v = (c->stage == WIDE) ? &c->wide : &c->narrow;
    const pel_status_t status = pel_amb_resolve_step(&c->resolver, &c->work, s, max_nodes, N_work, v);
    if (status == PEL_W_RUNNING) { return status; }
    if (status == PEL_OK) { return (c->stage == WIDE) ? to_narrow(c, p, N_work) : deliver(c, p, N_work, N); }
    const bool was_wide = c->stage == WIDE;
    c->stage = ENDED;
    return (status < 0 && !was_wide) ? PEL_W_REJECTED : status;
}

pel_status_t pel_amb_cascade(pel_amb_cascade_t *c, const pel_amb_problem_t *p, pel_ils_t *s,
                             const pel_int_limits_t *limits, int32_t budget, int max_tries, int64_t *N)
{
    pel_status_t status = pel_amb_cascade_begin(c, p, limits, budget, max_tries);
    if (status != PEL_OK) { return status; }
    do {
        status = pel_amb_cascade_step(c, p, s, INT32_MAX, N);
    } while (status == PEL_W_RUNNING);
    return status;
}

/* ils.c - life of an integer least-squares problem: taking it in, and what is known of it. */
#include <string.h>

#include "ambiguity_internal.h"
#include "pelorus/math.h"

#define FLOAT_MAX_CYC 1e15 /* a double still resolves an eighth of a cycle */
#define VARIANCE_MAX  1e12
#define RATIO_MAX     1e9
#define SURE_VARIANCE (1.0 / 324.0) /* half a cycle is nine sigmas: wrong once in 1e18 */

/* Take the integer part out of every float ambiguity: what is left is small, whatever the receiver counted before. */
static pel_status_t remove_integers(pel_ils_t *s, int n)
{
    for (int i = 0; i < n; i++) {
        if (!(pel_fabs(s->zhat[i]) <= FLOAT_MAX_CYC)) { return PEL_E_RANGE; }
        const double whole = pel_round(s->zhat[i]);
        s->origin[i] = (int64_t)whole;
        s->zhat[i] -= whole;
    }
    return PEL_OK;
}

static pel_status_t check_variances(const pel_ils_t *s, int n)
{
    for (int i = 0; i < n; i++) {
        const double *row = tri_row_const(s->LD, i);
        for (int j = 0; j <= i; j++) {
            if (!(pel_fabs(row[j]) <= VARIANCE_MAX)) { return PEL_E_RANGE; }
        }
    }
    return PEL_OK;
}

double pel_ils_success(const pel_ils_t *s)
{
    double success = (s->stage == PEL_ILS_EMPTY) ? 0.0 : 1.0;
    for (int p = 0; p < s->n; p++) {
        const double d = tri_row_const(s->LD, p)[p];
        if (d > SURE_VARIANCE) { success *= 1.0 - 2.0 * pel_normal_cdf(-0.5 / pel_sqrt(d)); }
    }
    return success;
}

double pel_ils_adop(const pel_ils_t *s)
{
    if (s->stage == PEL_ILS_EMPTY) { return 0.0; }
    double product = 1.0;
    double log_sum = 0.0;
    for (int p = 0; p < s->n; p++) {
        product *= tri_row_const(s->LD, p)[p];
        if (product < 1e-200 || product > 1e200) { /* one logarithm for many factors */
            log_sum += pel_log(product);
            product = 1.0;
        }
    }
    return pel_exp(0.5 * (log_sum + pel_log(product)) / s->n);
}

pel_status_t pel_ils_start(pel_ils_t *s, pel_ils_method_t method, int n, int n_best, int32_t budget)
{
    s->n = 0;
    s->stage = PEL_ILS_EMPTY;
    if (n_best < 1 || n_best > PEL_ILS_BEST || budget < 1) { return PEL_E_RANGE; }
    pel_status_t status = check_variances(s, n);
    if (status == PEL_OK) { status = remove_integers(s, n); }
    if (status != PEL_OK) { return status; }

    s->n = (int16_t)n;
    s->n_best = (int16_t)n_best;
    s->n_found = 0;
    s->nodes = 0;
    s->budget = budget;
    s->swaps = 0;
    s->float_sq = 0.0;
    s->float_dof = 0;
    s->n_steps = 0;
    s->n_vectors = 0;
    s->method = (uint8_t)method;
    s->decorrelated = false;

    status = pel_ils_factor(s, method == PEL_ILS_LAMBDA);
    if (status == PEL_OK) {
        if (method == PEL_ILS_LAMBDA) { pel_ils_decorrelate(s); }
        for (int p = 0; p < n; p++) { s->inv_D[p] = 1.0 / tri_row(s->LD, p)[p]; }
        status = pel_ils_first_node(s);
    }
    if (status != PEL_OK) {
        s->n = 0;
        s->stage = PEL_ILS_EMPTY;
    }
    return status;
}

pel_status_t pel_ils_init(pel_ils_t *s, int n, const double *a, const double *Q, int n_best, int32_t budget)
{
    return pel_ils_init_as(s, PEL_ILS_LAMBDA, n, a, Q, n_best, budget);
}

pel_status_t pel_ils_init_as(pel_ils_t *s, pel_ils_method_t method, int n, const double *a, const double *Q, int n_best,
                             int32_t budget)
{
    s->n = 0;
    s->stage = PEL_ILS_EMPTY;
    if (n < 1 || n > PEL_MAX_AMB) { return PEL_E_RANGE; }
    memmove(s->LD, Q, (size_t)PEL_TRI(n) * sizeof Q[0]); /* the caller may have written them in place */
    memmove(s->zhat, a, (size_t)n * sizeof a[0]);
    return pel_ils_start(s, method, n, n_best, budget);
}

/* Integers of the float ambiguities behind decorrelated ones: the steps undone, last first. Arithmetic modulo 2^64, which is exact for
 * every N that fits, whatever the numbers on the way. */
static void undo(const pel_ils_t *s, uint64_t *z)
{
    for (const pel_ils_step_t *t = s->step_made + s->n_steps; t-- != s->step_made;) {
        uint64_t *at = &z[t->k];
        if (t->j == t->k) {
            const uint64_t reduced = at[-1];
            at[-1] = at[0];
            at[0] = reduced + (uint64_t)(int64_t)t->m * at[-1];
        } else {
            at[0] += (uint64_t)((int64_t)t->m * (1 << 8 * t->shift)) * z[t->j];
        }
    }
}

pel_status_t pel_ils_get(const pel_ils_t *s, int k, int64_t *N, double *sq)
{
    if (s->stage == PEL_ILS_EMPTY || k < 0 || k >= s->n_found) { return PEL_E_MISSING; }
    const int n = s->n;
    if (N != NULL) {
        uint64_t z[PEL_MAX_AMB];
        for (int p = 0; p < n; p++) { z[p] = (uint64_t)(int64_t)s->best_z[k][p]; }
        undo(s, z);
        for (int p = 0; p < n; p++) { N[s->order[p]] = (int64_t)((uint64_t)s->origin[s->order[p]] + z[p]); }
    }
    if (sq != NULL) { *sq = s->best_sq[k]; }
    return PEL_OK;
}

double pel_ils_ratio(const pel_ils_t *s)
{
    if (s->stage == PEL_ILS_EMPTY || s->n_found < 2) { return 0.0; }
    if (s->best_sq[1] >= RATIO_MAX * s->best_sq[0]) { return RATIO_MAX; }
    return s->best_sq[1] / s->best_sq[0];
}

/* ils.c - life of an integer least-squares problem: taking it in, and what is known of it. */
#include "ambiguity_internal.h"
#include "ils_fixed.h"
#include "pelorus/math.h"

#define RATIO_MAX     1e9
#define SURE_VARIANCE (1.0 / 324.0) /* half a cycle is nine sigmas: wrong once in 1e18 */

double pel_ils_success(const pel_ils_t *s)
{
    double success = (s->stage == PEL_ILS_EMPTY) ? 0.0 : 1.0;
    for (int p = 0; p < s->n; p++) {
        const double d = pel_ils_variance(s, p);
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
        product *= pel_ils_scaled((double)join(fixed_row_const(s->G, p)[p]), s->row_unit[p] - PLACES);
        if (product < 1e-200 || product > 1e200) { /* one logarithm for many factors */
            log_sum += pel_log(product);
            product = 1.0;
        }
    }
    return pel_exp((log_sum + pel_log(product)) / s->n);
}

pel_status_t pel_ils_init_as(pel_ils_t *s, pel_ils_method_t method, int n, const double *a, const double *Q, int n_best,
                             int32_t budget)
{
    s->n = 0;
    s->stage = PEL_ILS_EMPTY;
    if (n < 1 || n > PEL_MAX_AMB || n_best < 1 || n_best > PEL_ILS_BEST || budget < 1) { return PEL_E_RANGE; }
    s->n = (int16_t)n;
    s->n_best = (int16_t)n_best;
    s->n_found = 0;
    s->nodes = 0;
    s->budget = budget;
    s->swaps = 0;
    s->float_sq = 0.0;
    s->float_dof = 0;
    s->n_notes = 0;
    s->n_vectors = 0;
    s->method = (uint8_t)method;
    s->decorrelated = false;
    s->patience = INT32_MAX;

    pel_status_t status = pel_ils_take_in(s, a, Q, method == PEL_ILS_LAMBDA);
    if (status == PEL_OK) {
        if (method == PEL_ILS_LAMBDA) { pel_ils_decorrelate(s); }
        pel_ils_first_node(s);
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

pel_status_t pel_ils_get(const pel_ils_t *s, int k, int64_t *N, double *sq)
{
    if (s->stage == PEL_ILS_EMPTY || k < 0 || k >= s->n_found) { return PEL_E_MISSING; }
    if (N != NULL) {
        int32_t apart[PEL_MAX_AMB];
        pel_ils_apart(s, k, apart);
        for (int p = 0; p < s->n; p++) { N[s->order[p]] = s->origin[s->order[p]] + apart[p]; }
    }
    if (sq != NULL) { *sq = pel_ils_norm(s, k); }
    return PEL_OK;
}

double pel_ils_ratio(const pel_ils_t *s)
{
    if (s->stage == PEL_ILS_EMPTY || s->n_found < 2) { return 0.0; }
    const double best = pel_ils_norm(s, 0);
    const double second = pel_ils_norm(s, 1);
    return (second >= RATIO_MAX * best) ? RATIO_MAX : second / best;
}

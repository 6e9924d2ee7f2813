/* ils_search.c - depth-first search of the best integer vectors, cut into slices.
 *
 * Levels 0..n-1, nearest integer first, then alternating outwards (Schnorr and Euchner 1994). The bound is the norm of the worst
 * candidate held; before n_best are held there is none, and each descent then ends in a candidate after at most n nodes. */
#include <string.h>

#include "ambiguity_internal.h"
#include "pelorus/math.h"

#define UNBOUNDED   1e300
#define FASF_KAPPA  4.0
#define INTEGER_MAX 1073741824.0 /* 2^30: a level's integer and its neighbours stay within 32 bits */

/* Conditional mean of level p given the integers of the levels before, and its nearest integer. */
static pel_status_t enter_level(pel_ils_t *s, int p)
{
    const double *row = tri_row_const(s->LD, p);
    const double mean = s->zhat[p] - dot(row, s->w, p);
    if (!(pel_fabs(mean) < INTEGER_MAX)) { return PEL_E_RANGE; }
    const int32_t nearest = nearest_integer(mean);
    s->level = (int16_t)p;
    s->mean[p] = mean;
    s->z[p] = nearest;
    s->w[p] = mean - (double)nearest;
    s->step[p] = (s->w[p] < 0.0) ? -1 : 1;
    return PEL_OK;
}

/* Next nearest integer of the level. */
static void next_sibling(pel_ils_t *s, int p)
{
    const int32_t step = s->step[p];
    s->z[p] += step;
    s->w[p] = s->mean[p] - (double)s->z[p];
    s->step[p] = (step > 0) ? -step - 1 : -step + 1;
}

static double bound(const pel_ils_t *s)
{
    return (s->n_found < s->n_best) ? UNBOUNDED : s->best_sq[s->n_best - 1];
}

/* Put the vector of the present path among the best, after those of equal norm. */
static void keep(pel_ils_t *s, double sq)
{
    int k = (s->n_found < s->n_best) ? s->n_found++ : s->n_best - 1;
    for (; k > 0 && s->best_sq[k - 1] > sq; k--) {
        s->best_sq[k] = s->best_sq[k - 1];
        memcpy(s->best_z[k], s->best_z[k - 1], sizeof s->best_z[k]);
    }
    s->best_sq[k] = sq;
    memcpy(s->best_z[k], s->z, sizeof s->best_z[k]);
}

pel_status_t pel_ils_first_node(pel_ils_t *s)
{
    s->cost[0] = 0.0;
    memset(s->z, 0, sizeof s->z);
    s->stage = PEL_ILS_SEARCHING;
    return enter_level(s, 0);
}

/* Is the node at hand, whose partial squared norm is sq, not worth to go on from? */
static bool beyond(const pel_ils_t *s, int p, double sq)
{
    if (s->method == PEL_ILS_FASF) { return s->w[p] * s->w[p] * s->inv_D[p] > FASF_KAPPA * FASF_KAPPA; }
    return sq >= bound(s);
}

/* Visit the node at hand and move to the next. */
static pel_status_t visit(pel_ils_t *s)
{
    const int p = s->level;
    const double sq = s->cost[p] + s->w[p] * s->w[p] * s->inv_D[p];
    s->nodes++;
    if (beyond(s, p, sq)) { /* its farther siblings are worse: back to the level before */
        if (p == 0) {
            s->stage = PEL_ILS_OPTIMAL;
        } else {
            s->level = (int16_t)(p - 1);
            next_sibling(s, p - 1);
        }
        return PEL_OK;
    }
    if (p + 1 < s->n) {
        s->cost[p + 1] = sq;
        return enter_level(s, p + 1);
    }
    if (s->n_found < s->n_best || sq < bound(s)) { keep(s, sq); }
    if (s->method == PEL_ILS_FASF && ++s->n_vectors > PEL_ILS_FASF_VECTORS) { s->stage = PEL_ILS_BUDGET; }
    next_sibling(s, p);
    return PEL_OK;
}

pel_status_t pel_ils_run(pel_ils_t *s, int32_t max_nodes)
{
    if (s->stage == PEL_ILS_EMPTY) { return PEL_E_MISSING; }
    for (int32_t i = 0; i < max_nodes && s->stage == PEL_ILS_SEARCHING; i++) {
        if (s->nodes >= s->budget) {
            s->stage = PEL_ILS_BUDGET;
            break;
        }
        const pel_status_t status = visit(s);
        if (status != PEL_OK) {
            s->n = 0;
            s->stage = PEL_ILS_EMPTY;
            return status;
        }
    }
    switch ((pel_ils_stage_t)s->stage) {
    case PEL_ILS_OPTIMAL: return PEL_OK;
    case PEL_ILS_BUDGET: return PEL_W_BUDGET;
    case PEL_ILS_SEARCHING:
    case PEL_ILS_EMPTY: break;
    }
    return PEL_W_RUNNING;
}

double pel_ils_lower_bound(const pel_ils_t *s)
{
    double low = bound(s);
    if (s->stage == PEL_ILS_EMPTY) { return 0.0; }
    if (s->stage == PEL_ILS_OPTIMAL) { return low; }
    for (int p = 0; p <= s->level; p++) { /* the node at hand, and the next sibling of each level above it */
        const double w = (p == s->level) ? s->w[p] : s->w[p] - (double)s->step[p];
        low = pel_min(low, s->cost[p] + w * w * s->inv_D[p]);
    }
    return low;
}

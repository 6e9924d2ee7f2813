/* ils_search.c - depth-first search of the best integer vectors, cut into slices.
 *
 * Levels 0..n-1, nearest integer first, then alternating outwards (Schnorr and Euchner 1994). The bound is the norm of the worst
 * candidate held; before n_best are held there is none, and each descent then ends in a candidate after at most n nodes.
 *
 * Norms of the search carry the rounding of pel_real. So vectors are held up to `slack` beyond the bound and ranked by their exact norms
 * in the end; if these show that the slack was too small, the search begins anew with more of it. Bounds: docs/INTEGERS.md. */
#include <string.h>

#include "ambiguity_internal.h"
#include "ils_fixed.h"
#include "pelorus/math.h"

#define FASF_BOX    PEL_R(16.0)   /* four standard deviations, squared */
#define SLACK_SHARE PEL_R(0.0625) /* of the slack that exact norms may differ by */
#define SLACK_MAX   PEL_R(0.5)
#if PEL_REAL_DOUBLE
#define SLACK 1e-7
#else
#define SLACK 0.00390625f
#endif

/* Sum of a[i] b[i], i < n. */
static pel_real dot(const pel_real *a, const pel_real *b, int n)
{
    pel_real even = PEL_R(0.0);
    pel_real odd = PEL_R(0.0);
    int i = 0;
    for (; i + 2 <= n; i += 2) {
        even += a[i] * b[i];
        odd += a[i + 1] * b[i + 1];
    }
    if (i < n) { even += a[i] * b[i]; }
    return even + odd;
}

/* Conditional mean of level p given the integers of the levels before, and its nearest integer. */
static inline bool enter_level(pel_ils_t *s, int p)
{
    const pel_real mean = s->zhat[p] - dot(real_row_const(s->LD, p), s->w, p);
    if (!(absolute(mean) < NEAREST_MAX)) { return false; }
    const pel_real integer = nearest(mean);
    s->level = (int16_t)p;
    s->mean[p] = mean;
    s->z[p] = (int32_t)integer;
    s->w[p] = mean - integer;
    s->step[p] = (mean < integer) ? -1 : 1;
    return true;
}

/* Next nearest integer of the level. */
static inline void next_sibling(pel_ils_t *s, int p)
{
    const int32_t step = s->step[p];
    s->z[p] += step;
    s->w[p] = s->mean[p] - (pel_real)s->z[p];
    s->step[p] = (step > 0) ? -step - 1 : -step + 1;
}

/* Candidates beyond this are not among the best, whatever rounding did. */
static void set_bound(pel_ils_t *s)
{
    const pel_real near = (s->n_held < s->n_best) ? PEL_REAL_MAX : s->held_near[s->n_best - 1];
    s->bound = (near < PEL_REAL_MAX) ? near + s->slack * (near + s->grain) : near;
}

/* Exchange candidates i and i - 1. */
static void exchange(pel_ils_t *s, int i)
{
    SWAP(int64_t, s->held_sq[i], s->held_sq[i - 1]);
    SWAP(pel_real, s->held_near[i], s->held_near[i - 1]);
    for (int p = 0; p < s->n; p++) { SWAP(int32_t, s->held[i][p], s->held[i - 1][p]); }
}

static void move(pel_ils_t *s, int to, int from)
{
    s->held_sq[to] = s->held_sq[from];
    s->held_near[to] = s->held_near[from];
    memcpy(s->held[to], s->held[from], (size_t)s->n * sizeof s->z[0]);
}

/* Make room: the candidate goes that n_best others are better than, by exact norms. */
static void drop_worst(pel_ils_t *s)
{
    int worst = 0;
    pel_ils_exact_norms(s);
    for (int k = 1; k < s->n_held; k++) {
        if (s->held_sq[k] > s->held_sq[worst]) { worst = k; }
    }
    s->n_held--;
    for (int k = worst; k < s->n_held; k++) { move(s, k, k + 1); }
}

/* Put the vector of the present path among those held, after those of equal norm. */
static void hold(pel_ils_t *s, pel_real near)
{
    if (s->n_held == PEL_ILS_HELD) { drop_worst(s); }
    int k = s->n_held++;
    for (; k > 0 && s->held_near[k - 1] > near; k--) { move(s, k, k - 1); }
    s->held_near[k] = near;
    s->held_sq[k] = PEL_ILS_NOT_UNDONE;
    memcpy(s->held[k], s->z, (size_t)s->n * sizeof s->z[0]);
    set_bound(s);
    while (s->n_held > s->n_best && s->held_near[s->n_held - 1] > s->bound) { s->n_held--; }
    s->n_found = (s->n_held < s->n_best) ? s->n_held : s->n_best;
}

/* From the root, with nothing in hand. */
static void begin(pel_ils_t *s)
{
    s->n_held = 0;
    s->n_found = 0;
    s->exact_scale = PEL_R(0.0);
    s->bound = PEL_REAL_MAX;
    s->cost[0] = PEL_R(0.0);
    s->stage = PEL_ILS_SEARCHING;
    (void)enter_level(s, 0); /* a mean of at most one half */
}

void pel_ils_first_node(pel_ils_t *s)
{
    for (int p = 0; p < s->n; p++) {
        const int64_t rest = s->a_z[p] - scaled(whole_of(s->a_z[p]), A_Z_PLACES);
        s->zhat[p] = ((pel_real)(int32_t)(rest >> 16) * PEL_R(65536.0) + (pel_real)(int32_t)(rest & 0xFFFF)) *
                     PEL_R(1.4551915228366852e-11); /* 2^-36 */
        s->inv_D[p] = PEL_R(1.0) / real_row(s->LD, p)[p];
        if (p == 0 || s->inv_D[p] * PEL_R(0.25) < s->grain) { s->grain = s->inv_D[p] * PEL_R(0.25); }
    }
    if (s->method == PEL_ILS_FASF) { s->one = (pel_real)pel_ils_scaled(1.0, 2 * s->unit); }
    s->slack = SLACK;
    begin(s);
}

/* Is there as much of the budget left as has been used? If not, what is in hand is worth more than a better search. */
static bool may_begin_anew(const pel_ils_t *s)
{
    return s->budget - s->nodes >= s->nodes;
}

/* The search has turned out to be long: decorrelate to the end and begin anew. */
static void reconsider(pel_ils_t *s)
{
    if (!s->decorrelated || !may_begin_anew(s)) {
        s->patience = INT32_MAX;
        return;
    }
    pel_ils_decorrelate_more(s);
    pel_ils_first_node(s);
}

void pel_ils_decorrelate_to_the_end(pel_ils_t *s)
{
    if (s->stage != PEL_ILS_SEARCHING || s->nodes > 0 || s->method != PEL_ILS_LAMBDA || s->patience == INT32_MAX) {
        return;
    }
    pel_ils_decorrelate_more(s);
    pel_ils_first_node(s);
}

/* Rank by exact norms; if they differ so much from the search's that nothing is proved, begin anew with more slack. */
static void settle(pel_ils_t *s)
{
    if (s->n_held == 0) { return; }
    pel_ils_exact_norms(s);
    const pel_real limit = (s->held_near[s->n_found - 1] + s->grain) * s->slack * SLACK_SHARE;
    pel_real off = PEL_R(0.0);
    for (int k = 0; k < s->n_held; k++) {
        const pel_real d = absolute(s->held_near[k] - real_of_whole(s->held_sq[k]) * s->exact_scale);
        if (!(d <= off)) { off = d; }
    }
    if (!(off <= limit) && s->method != PEL_ILS_FASF) {
        const pel_real more = s->slack * (off / limit) * PEL_R(2.0);
        if (s->slack < SLACK_MAX && s->stage == PEL_ILS_OPTIMAL && may_begin_anew(s)) {
            s->slack = (more < SLACK_MAX) ? more : SLACK_MAX;
            begin(s);
            return;
        }
        s->stage = PEL_ILS_BUDGET; /* pel_real is not enough for a proof */
    }
    for (int k = 1; k < s->n_held; k++) {
        for (int i = k; i > 0 && s->held_sq[i] < s->held_sq[i - 1]; i--) { exchange(s, i); }
    }
}

/* Visit the node at hand and move to the next. False: a conditional mean beyond all integers. */
static inline bool visit(pel_ils_t *s)
{
    const int p = s->level;
    const pel_real of_level = s->w[p] * s->w[p] * s->inv_D[p];
    const pel_real sq = s->cost[p] + of_level;
    s->nodes++;
    if ((s->method == PEL_ILS_FASF) ? of_level > FASF_BOX * s->one : sq >= s->bound) {
        if (p == 0) { /* farther siblings are worse: one level up */
            s->stage = PEL_ILS_OPTIMAL;
        } else {
            s->level = (int16_t)(p - 1);
            next_sibling(s, p - 1);
        }
        return true;
    }
    if (p + 1 < s->n) {
        s->cost[p + 1] = sq;
        return enter_level(s, p + 1);
    }
    if (sq < s->bound) { hold(s, sq); }
    if (s->method == PEL_ILS_FASF && ++s->n_vectors > PEL_ILS_FASF_VECTORS) { s->stage = PEL_ILS_BUDGET; }
    next_sibling(s, p);
    return true;
}

pel_status_t pel_ils_run(pel_ils_t *s, int32_t max_nodes)
{
    if (s->stage == PEL_ILS_EMPTY) { return PEL_E_MISSING; }
    const bool sliced = max_nodes <= s->budget - s->nodes;
    const int32_t until = sliced ? s->nodes + max_nodes : s->budget;
    while (s->stage == PEL_ILS_SEARCHING && s->nodes < until) {
        const int32_t stop = (until < s->patience) ? until : s->patience;
        while (s->nodes < stop && s->stage == PEL_ILS_SEARCHING) {
            if (!visit(s)) {
                s->n = 0;
                s->stage = PEL_ILS_EMPTY;
                return PEL_E_RANGE;
            }
        }
        if (s->stage != PEL_ILS_SEARCHING) {
            settle(s);
        } else if (s->nodes == s->patience) {
            reconsider(s);
        }
    }
    if (s->stage == PEL_ILS_SEARCHING && !sliced) {
        s->stage = PEL_ILS_BUDGET;
        settle(s);
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
    if (s->stage == PEL_ILS_EMPTY) { return 0.0; }
    if (s->stage == PEL_ILS_OPTIMAL && s->n_found == s->n_best) { return pel_ils_norm(s, s->n_found - 1); }
    pel_real low = s->bound;
    for (int p = 0; p <= s->level && s->stage != PEL_ILS_OPTIMAL; p++) {
        /* the node at hand, and the next sibling of each level above it */
        const pel_real w = (p == s->level) ? s->w[p] : s->w[p] - (pel_real)s->step[p];
        const pel_real sq = s->cost[p] + w * w * s->inv_D[p];
        if (sq < low) { low = sq; }
    }
    return pel_ils_scaled((double)(low * (PEL_R(1.0) - s->slack)), -2 * s->unit);
}

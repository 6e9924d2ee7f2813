/* resolve.c - one epoch's integers in slices: float, search, verdict, and a bounded number of smaller problems when the whole is refused. */
#include "ambiguity_internal.h"

#define BIT(reason) (1u << (reason))
#define MISFIT      (BIT(PEL_INT_CHI2) | BIT(PEL_INT_BAND) | BIT(PEL_INT_PRIOR))
#define WEAK        (BIT(PEL_INT_SUCCESS) | BIT(PEL_INT_RATIO) | BIT(PEL_INT_BUDGET))
#define UNSURE      (BIT(PEL_INT_SUCCESS) | BIT(PEL_INT_BUDGET)) /* a misfit then blames nobody */

enum { SET_UP, SEARCH, JUDGE, ENDED };

pel_status_t pel_amb_resolve_begin(pel_amb_resolver_t *r, const pel_amb_problem_t *p, const pel_int_limits_t *limits,
                                   int32_t budget, int max_tries)
{
    if (p->n_rows < 0 || p->n_rows > PEL_MAX_AMB || p->n_groups < 0 || p->n_groups > PEL_AMB_GROUPS || budget < 1 ||
        max_tries < 1 || max_tries > 63) {
        r->stage = ENDED;
        return PEL_E_RANGE;
    }
    r->limits = *limits;
    if (max_tries > 1) { r->limits.failure_max *= 0.5; }
    r->budget = budget;
    r->stage = SET_UP;
    r->subset = PEL_AMB_ALL;
    r->index = 0;
    r->tries = (int8_t)max_tries;
    r->setups = (int8_t)(2 * max_tries);
    pel_subset_remember(r, p);
    return PEL_OK;
}

static pel_status_t end(pel_amb_resolver_t *r, pel_amb_problem_t *p, pel_status_t status)
{
    r->stage = ENDED;
    if (status != PEL_OK) { pel_subset_restore(r, p); }
    return status;
}

static void count_integers(const pel_amb_resolver_t *r, const pel_ils_t *s, pel_int_verdict_t *v)
{
    v->n_integers = s->n;
    v->n_asked = 0;
    for (uint64_t rows = r->asked_integer; rows != 0; rows &= rows - 1) { v->n_asked++; }
    v->subset = r->subset;
    v->subset_index = (r->subset == PEL_AMB_ALL) ? 0 : (uint8_t)(r->index - 1);
}

/* On to the next subset, or the end. */
static pel_status_t try_less(pel_amb_resolver_t *r, pel_amb_problem_t *p, pel_int_verdict_t *v)
{
    if (r->tries > 0 && r->setups > 0 && r->budget > 0 && pel_subset_next(r, p, (r->first.failed & WEAK) != 0)) {
        r->stage = SET_UP;
        return PEL_W_RUNNING;
    }
    *v = r->first;
    return end(r, p, PEL_W_REJECTED);
}

/* All together were refused: what is worth trying? */
static pel_status_t plan(pel_amb_resolver_t *r, pel_amb_problem_t *p, const pel_ils_t *s, pel_int_verdict_t *v)
{
    const unsigned failed = r->first.failed;
    r->subset = PEL_AMB_WITHOUT_SUSPECT;
    r->n_suspects = 0;
    r->agreed = 0;
    if ((failed & MISFIT) == 0) {
        pel_subset_note_agreement(r, p, s);
    } else if ((failed & UNSURE) == 0) {
        pel_subset_list_suspects(r, p, s);
    }
    return try_less(r, p, v);
}

static pel_status_t set_up(pel_amb_resolver_t *r, pel_amb_problem_t *p, pel_ils_t *s, pel_int_verdict_t *v)
{
    const int32_t share = (r->tries > 1) ? (r->budget + 1) / 2 : r->budget;
    const pel_status_t status = pel_amb_float(p, s, 2, share);
    r->setups--;
    if (r->subset != PEL_AMB_ALL && (status != PEL_OK || !(pel_ils_success(s) >= r->limits.success_min))) {
        return try_less(r, p, v);
    }
    if (status != PEL_OK) {
        *v = (pel_int_verdict_t){.reason = PEL_INT_NOT_TRIED, .worst_row = -1};
        return end(r, p, status);
    }
    if (r->subset != PEL_AMB_ALL && r->tries > 1) { r->limits.failure_max *= 0.5; } /* half of what is left */
    r->tries--;
    r->stage = SEARCH;
    return PEL_W_RUNNING;
}

static pel_status_t search(pel_amb_resolver_t *r, pel_amb_problem_t *p, pel_ils_t *s, int32_t max_nodes,
                           pel_int_verdict_t *v)
{
    const pel_status_t status = pel_ils_run(s, max_nodes);
    if (status == PEL_W_RUNNING) { return PEL_W_RUNNING; }
    r->budget -= s->nodes;
    if (status >= 0) {
        r->stage = JUDGE;
        return PEL_W_RUNNING;
    }
    if (r->subset != PEL_AMB_ALL) { return try_less(r, p, v); }
    *v = (pel_int_verdict_t){.reason = PEL_INT_NOT_TRIED, .worst_row = -1};
    return end(r, p, status);
}

static void deliver(const pel_amb_problem_t *p, const pel_ils_t *s, int64_t *N)
{
    int64_t sought[PEL_MAX_AMB];
    (void)pel_ils_get(s, 0, sought, NULL);
    for (int i = 0, k = 0; i < p->n_rows; i++) { N[i] = p->row[i].integer ? sought[k++] : 0; }
}

static pel_status_t judge(pel_amb_resolver_t *r, pel_amb_problem_t *p, pel_ils_t *s, int64_t *N, pel_int_verdict_t *v)
{
    pel_int_verdict_t verdict;
    (void)pel_int_validate(p, s, &r->limits, &verdict);
    count_integers(r, s, &verdict);
    if (verdict.reason == PEL_INT_OK) {
        *v = verdict;
        deliver(p, s, N);
        return end(r, p, PEL_OK);
    }
    if (r->subset == PEL_AMB_AGREED && (verdict.failed & MISFIT) == 0) { pel_subset_note_agreement(r, p, s); }
    if (r->subset != PEL_AMB_ALL) { return try_less(r, p, v); }
    r->first = verdict;
    return plan(r, p, s, v);
}

pel_status_t pel_amb_resolve_step(pel_amb_resolver_t *r, pel_amb_problem_t *p, pel_ils_t *s, int32_t max_nodes,
                                  int64_t *N, pel_int_verdict_t *v)
{
    switch (r->stage) {
    case SET_UP: return set_up(r, p, s, v);
    case SEARCH: return search(r, p, s, max_nodes, v);
    case JUDGE: return judge(r, p, s, N, v);
    default: return PEL_E_MISSING;
    }
}

pel_status_t pel_amb_resolve(pel_amb_problem_t *p, pel_ils_t *s, const pel_int_limits_t *limits, int32_t budget,
                             int max_tries, int64_t *N, pel_int_verdict_t *v)
{
    pel_amb_resolver_t r;
    *v = (pel_int_verdict_t){.reason = PEL_INT_NOT_TRIED, .worst_row = -1};
    pel_status_t status = pel_amb_resolve_begin(&r, p, limits, budget, max_tries);
    if (status != PEL_OK) { return status; }
    do {
        status = pel_amb_resolve_step(&r, p, s, INT32_MAX, N, v);
    } while (status == PEL_W_RUNNING);
    return status;
}

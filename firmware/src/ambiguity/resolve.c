/* resolve.c - one epoch's integers in one call, with a bounded number of smaller problems when the whole one is refused.
 *
 * A problem that is too weak loses its noisiest satellites one after the other. A problem that does not fit has a satellite that is
 * wrong (half cycle, multipath), and then the integers of all are wrong and no residual points at it surely: each satellite is left
 * out in turn, those that fit worst first. */
#include "ambiguity_internal.h"

#define MISFIT ((1u << PEL_INT_CHI2) | (1u << PEL_INT_BAND) | (1u << PEL_INT_PRIOR))

_Static_assert(PEL_MAX_AMB <= 64, "rows are remembered by the bits of a word");

/* Which rows took part when the caller asked. */
typedef struct {
    uint64_t integer, code;
} rows_t;

static rows_t remember(const pel_amb_problem_t *p)
{
    rows_t r = {0, 0};
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].integer) { r.integer |= UINT64_C(1) << i; }
        if (p->row[i].code) { r.code |= UINT64_C(1) << i; }
    }
    return r;
}

static void restore(pel_amb_problem_t *p, const rows_t *r)
{
    for (int i = 0; i < p->n_rows; i++) {
        p->row[i].integer = ((r->integer >> i) & 1u) != 0;
        p->row[i].code = ((r->code >> i) & 1u) != 0;
    }
}

/* One satellite out: its phases, and its codes too if it is suspected rather than weak. */
static void drop(pel_amb_problem_t *p, uint8_t sat, bool suspected)
{
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].sat != sat) { continue; }
        p->row[i].integer = false;
        if (suspected) { p->row[i].code = false; }
    }
}

static int noisiest_row(const pel_amb_problem_t *p)
{
    int worst = -1;
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].integer && (worst < 0 || p->row[i].var_phase > p->row[worst].var_phase)) { worst = i; }
    }
    return worst;
}

/* The row that fits worst of the satellites not yet suspected; its satellite's rows are taken off the list. -1: none left. */
static int next_suspect(const pel_amb_problem_t *p, float misfit[PEL_MAX_AMB])
{
    int worst = -1;
    for (int i = 0; i < p->n_rows; i++) {
        if (misfit[i] > 0.0f && (worst < 0 || misfit[i] > misfit[worst])) { worst = i; }
    }
    for (int i = 0; worst >= 0 && i < p->n_rows; i++) {
        if (p->row[i].sat == p->row[worst].sat) { misfit[i] = 0.0f; }
    }
    return worst;
}

/* Float, search and verdict; takes the nodes off the budget. */
static pel_status_t attempt(const pel_amb_problem_t *p, pel_ils_t *s, const pel_int_limits_t *limits, int32_t *budget,
                            pel_int_verdict_t *v)
{
    pel_status_t status = pel_amb_float(p, s, 2, *budget);
    if (status == PEL_OK) { status = pel_ils_run(s, INT32_MAX); }
    if (status < 0) { return status; }
    *budget -= s->nodes;
    return pel_int_validate(p, s, limits, v);
}

static void list_misfits(const pel_amb_problem_t *p, const pel_ils_t *s, float misfit[PEL_MAX_AMB])
{
    int64_t N[PEL_MAX_AMB];
    double b[3];
    double P[3][3];
    double sq;
    int dof;
    for (int i = 0; i < p->n_rows; i++) { misfit[i] = 0.0f; }
    if (pel_ils_get(s, 0, N, NULL) != PEL_OK || pel_amb_fixed(p, N, b, P, &sq, &dof) != PEL_OK) { return; }
    pel_amb_misfits(p, N, b, misfit);
}

static void deliver(const pel_amb_problem_t *p, const pel_ils_t *s, int64_t *N)
{
    int64_t sought[PEL_MAX_AMB];
    (void)pel_ils_get(s, 0, sought, NULL);
    for (int i = 0, k = 0; i < p->n_rows; i++) { N[i] = p->row[i].integer ? sought[k++] : 0; }
}

pel_status_t pel_amb_resolve(pel_amb_problem_t *p, pel_ils_t *s, const pel_int_limits_t *limits, int32_t budget,
                             int max_tries, int64_t *N, pel_int_verdict_t *v)
{
    float misfit[PEL_MAX_AMB];
    *v = (pel_int_verdict_t){.reason = PEL_INT_NOT_TRIED, .worst_row = -1};
    pel_int_verdict_t verdict = *v;
    const pel_status_t status = attempt(p, s, limits, &budget, &verdict);
    if (status < 0) { return status; }
    *v = verdict;
    const rows_t asked = remember(p);
    const bool suspected = (verdict.failed & MISFIT) != 0;
    if (verdict.reason != PEL_INT_OK && suspected) { list_misfits(p, s, misfit); }

    for (int t = 1; verdict.reason != PEL_INT_OK && t < max_tries && budget > 0; t++) {
        if (suspected) { restore(p, &asked); }
        const int row = suspected ? next_suspect(p, misfit) : noisiest_row(p);
        if (row < 0) { break; }
        drop(p, p->row[row].sat, suspected);
        if (pel_amb_count(p) < limits->n_min || attempt(p, s, limits, &budget, &verdict) < 0) {
            if (suspected) { continue; }
            break;
        }
    }
    if (verdict.reason != PEL_INT_OK) {
        restore(p, &asked);
        return PEL_W_REJECTED;
    }
    *v = verdict;
    deliver(p, s, N);
    return PEL_OK;
}

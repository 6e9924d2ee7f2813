/* resolve.c - one epoch's integers in one call, with a bounded number of smaller problems when the whole one is refused. */
#include "pelorus/ambiguity.h"

#define MISFIT ((1u << PEL_INT_CHI2) | (1u << PEL_INT_BAND) | (1u << PEL_INT_PRIOR))

/* The row whose satellite weakens the problem most: the noisiest phase. */
static int noisiest(const pel_amb_problem_t *p)
{
    int worst = -1;
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].integer && (worst < 0 || p->row[i].var_phase > p->row[worst].var_phase)) { worst = i; }
    }
    return worst;
}

/* Give a satellite up, with its code too if it is suspected rather than weak. */
static void drop(pel_amb_problem_t *p, uint8_t sat, bool suspected)
{
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].sat != sat) { continue; }
        p->row[i].integer = false;
        if (suspected) { p->row[i].code = false; }
    }
}

pel_status_t pel_amb_resolve(pel_amb_problem_t *p, pel_ils_t *s, const pel_int_limits_t *limits, int32_t budget,
                             int max_tries, int64_t *N, pel_int_verdict_t *v)
{
    *v = (pel_int_verdict_t){.reason = PEL_INT_NOT_TRIED, .worst_row = -1};
    for (int t = 0; t < max_tries && budget > 0; t++) {
        pel_int_verdict_t verdict;
        pel_status_t status = pel_amb_float(p, s, 2, budget);
        if (status == PEL_OK) { status = pel_ils_run(s, INT32_MAX); }
        if (status < 0) { return (t == 0) ? status : PEL_W_REJECTED; }
        budget -= s->nodes;
        (void)pel_int_validate(p, s, limits, &verdict);
        if (t == 0 || verdict.reason == PEL_INT_OK) { *v = verdict; }
        if (verdict.reason == PEL_INT_OK) {
            int64_t sought[PEL_MAX_AMB];
            (void)pel_ils_get(s, 0, sought, NULL);
            for (int i = 0, k = 0; i < p->n_rows; i++) { N[i] = p->row[i].integer ? sought[k++] : 0; }
            return PEL_OK;
        }
        const bool suspected = (verdict.failed & MISFIT) != 0 && verdict.worst_row >= 0;
        const int row = suspected ? verdict.worst_row : noisiest(p);
        if (row < 0) { break; }
        drop(p, p->row[row].sat, suspected);
        if (pel_amb_count(p) < limits->n_min) { break; }
    }
    return PEL_W_REJECTED;
}

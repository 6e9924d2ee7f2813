/* validate.c - may the integers be believed? Each test has its own verdict. */
#include "ambiguity_internal.h"
#include "pelorus/math.h"

void pel_int_limits_default(pel_int_limits_t *limits)
{
    *limits = (pel_int_limits_t){
        .ratio_min = 2.0, .success_min = 0.95, .chi2_p = 0.999, .prior_sigma = 5.0, .iono_sigmas = 3.0, .n_min = 4};
}

static void fail(pel_int_verdict_t *v, pel_int_reason_t reason)
{
    v->failed = (uint16_t)(v->failed | (1u << reason));
    if (v->reason == PEL_INT_OK) { v->reason = reason; }
}

/* Rows i and j: the same satellite on two carriers, against the same pivot? */
static bool is_pair(const pel_amb_problem_t *p, int i, int j)
{
    const pel_amb_row_t *a = &p->row[i];
    const pel_amb_row_t *b = &p->row[j];
    return a->integer && b->integer && a->sat == b->sat && a->group != b->group &&
           p->group[a->group].sat == p->group[b->group].sat;
}

/* |u| over the half width of a pair; negative: the band is void. The shorter wave counts. */
static double band_of_pair(const pel_amb_problem_t *p, int i, int j, const int64_t *N, double iono_sigmas)
{
    const bool swap = p->row[i].lambda_m > p->row[j].lambda_m;
    const pel_amb_row_t *r1 = &p->row[swap ? j : i];
    const pel_amb_row_t *r2 = &p->row[swap ? i : j];
    const pel_amb_group_t *g1 = &p->group[r1->group];
    const pel_amb_group_t *g2 = &p->group[r2->group];
    const double half = pel_band_half_width(r1->lambda_m, pel_sqrt(r1->var_phase + g1->var_phase),
                                            pel_sqrt(r2->var_phase + g2->var_phase), pel_fabs(g2->mu - g1->mu),
                                            iono_sigmas * pel_sqrt(2.0 * p->var_iono));
    if (!(half < 0.5)) { return -1.0; }
    double u;
    (void)pel_band_test(N[swap ? j : i], N[swap ? i : j], r1->phase_m / r1->lambda_m, r2->phase_m / r2->lambda_m,
                        r2->lambda_m / r1->lambda_m, half, &u);
    return pel_fabs(u) / half;
}

/* N by row of p. */
static void check_band(const pel_amb_problem_t *p, const int64_t *N, const pel_int_limits_t *limits,
                       pel_int_verdict_t *v)
{
    for (int i = 0; i < p->n_rows; i++) {
        for (int j = i + 1; j < p->n_rows; j++) {
            if (!is_pair(p, i, j)) { continue; }
            const double share = band_of_pair(p, i, j, N, limits->iono_sigmas);
            if (share < 0.0) { continue; }
            v->n_pairs++;
            if (share > v->band_worst) {
                v->band_worst = share;
                if (share >= 1.0) { v->worst_row = i; }
            }
        }
    }
    if (v->band_worst >= 1.0) { fail(v, PEL_INT_BAND); }
}

/* Fixed position against the prior, and the phase that fits it worst. */
static void check_position(const pel_amb_problem_t *p, const int64_t *N_sought, const pel_int_limits_t *limits,
                           pel_int_verdict_t *v)
{
    double b[3];
    double P[3][3];
    double inverse[3][3];
    double sq;
    int dof;
    if (pel_amb_fixed(p, N_sought, b, P, &sq, &dof) != PEL_OK) { return; }
    float misfit[PEL_MAX_AMB];
    float worst = -1.0f;
    pel_amb_misfits(p, N_sought, b, misfit);
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].integer && misfit[i] > worst) {
            worst = misfit[i];
            v->worst_row = i;
        }
    }
    if (!p->have_prior) { return; }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { P[i][j] += p->P_r[i][j]; }
    }
    if (pel_mat3_inverse(P, inverse) != PEL_OK) { return; }
    double y[3];
    pel_mat3_vec(inverse, b, y);
    v->prior_sq = pel_dot3(b, y);
    if (!(v->prior_sq <= limits->prior_sigma * limits->prior_sigma)) { fail(v, PEL_INT_PRIOR); }
}

pel_status_t pel_int_validate(const pel_amb_problem_t *p, const pel_ils_t *s, const pel_int_limits_t *limits,
                              pel_int_verdict_t *v)
{
    int64_t N_sought[PEL_MAX_AMB];
    int64_t N[PEL_MAX_AMB] = {0};
    double sq;
    *v = (pel_int_verdict_t){.reason = PEL_INT_OK, .worst_row = -1, .n_integers = s->n, .n_asked = s->n};
    if (s->n < limits->n_min || s->n != pel_amb_count(p)) { fail(v, PEL_INT_FEW); }
    if (s->stage != PEL_ILS_OPTIMAL) { fail(v, PEL_INT_BUDGET); }
    if (s->n != pel_amb_count(p) || pel_ils_get(s, 0, N_sought, &sq) != PEL_OK) { return PEL_E_MISSING; }

    v->success = pel_ils_success(s);
    if (!(v->success >= limits->success_min)) { fail(v, PEL_INT_SUCCESS); }
    v->ratio = pel_ils_ratio(s);
    v->ratio_needed = limits->ratio_min;
    if (limits->failure_max > 0.0) {
        v->ratio_needed = pel_max(v->ratio_needed, pel_ils_ratio_needed(s, limits->failure_max));
    }
    if (!(v->ratio >= v->ratio_needed)) { fail(v, PEL_INT_RATIO); }
    v->chi2 = s->float_sq + sq;
    v->chi2_dof = s->float_dof + s->n;
    v->chi2_max = pel_chi2_threshold(v->chi2_dof, limits->chi2_p);
    if (!(v->chi2 <= v->chi2_max)) { fail(v, PEL_INT_CHI2); }

    for (int i = 0, k = 0; i < p->n_rows; i++) {
        if (p->row[i].integer) { N[i] = N_sought[k++]; }
    }
    /* The prior is judged last but computed first: an offending pair is a better suspect than the largest residual. */
    pel_int_verdict_t position = {.reason = PEL_INT_OK, .worst_row = -1};
    check_position(p, N_sought, limits, &position);
    v->worst_row = position.worst_row;
    v->prior_sq = position.prior_sq;
    check_band(p, N, limits, v);
    if (position.reason != PEL_INT_OK) { fail(v, position.reason); }
    return PEL_OK;
}

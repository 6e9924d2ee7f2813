/* test_problem.c - the float problem of an epoch against one dense estimate of everything at once, and the verdicts. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelorus/ambiguity.h"
#include "support_epoch.h"
#include "unity.h"

static pel_ils_t ils;

void setUp(void) {}
void tearDown(void) {}

/* ---- dense oracle ---------------------------------------------------------------------------------------------------- */

#define DENSE (2 * PEL_MAX_AMB)

/* Covariance of all codes (first) and phases of a problem, ambiguities known: noise, prior and ionosphere together. */
static int dense_covariance(const pel_amb_problem_t *p, double C[DENSE][DENSE], double y[DENSE],
                            const pel_amb_row_t *of[DENSE])
{
    int n = 0;
    int n_code = 0;
    for (int kind = 0; kind < 2; kind++) {
        for (int i = 0; i < p->n_rows; i++) {
            if (kind == 0 ? !p->row[i].code : !p->row[i].integer) { continue; }
            of[n] = &p->row[i];
            y[n++] = (kind == 0) ? p->row[i].code_m : p->row[i].phase_m;
        }
        if (kind == 0) { n_code = n; }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            const pel_amb_row_t *a = of[i];
            const pel_amb_row_t *b = of[j];
            const pel_amb_group_t *ga = &p->group[a->group];
            const pel_amb_group_t *gb = &p->group[b->group];
            double c = 0.0;
            for (int k = 0; k < 3; k++) {
                for (int l = 0; l < 3; l++) {
                    c += a->g[k] * (p->have_prior ? p->P_r[k][l] : (k == l) * 1e6) * b->g[l];
                }
            }
            const double sign = ((i < n_code) == (j < n_code)) ? 1.0 : -1.0;
            const int shared = (a->sat == b->sat) - (a->sat == gb->sat) - (ga->sat == b->sat) + (ga->sat == gb->sat);
            c += sign * ga->mu * gb->mu * shared * p->var_iono;
            if ((i < n_code) == (j < n_code) && a->group == b->group) {
                c += (i < n_code) ? ga->var_code : ga->var_phase;
                if (i == j) { c += (i < n_code) ? a->var_code : a->var_phase; }
            }
            C[i][j] = c;
        }
    }
    return n_code;
}

/* Solve A X = B (n x n, n x m) by elimination with pivoting, long double. A and B are spoiled; X is left in B. */
static long double A_[DENSE][DENSE];
static long double B_[DENSE][DENSE];
static void solve(int n, int m)
{
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k + 1; i < n; i++) {
            if (fabsl(A_[i][k]) > fabsl(A_[p][k])) { p = i; }
        }
        for (int j = 0; j < n; j++) {
            const long double t = A_[k][j];
            A_[k][j] = A_[p][j];
            A_[p][j] = t;
        }
        for (int j = 0; j < m; j++) {
            const long double t = B_[k][j];
            B_[k][j] = B_[p][j];
            B_[p][j] = t;
        }
        for (int i = 0; i < n; i++) {
            if (i == k) { continue; }
            const long double f = A_[i][k] / A_[k][k];
            for (int j = k; j < n; j++) { A_[i][j] -= f * A_[k][j]; }
            for (int j = 0; j < m; j++) { B_[i][j] -= f * B_[k][j]; }
        }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < m; j++) { B_[i][j] /= A_[i][i]; }
    }
}

/* a and Q by conditioning the phases on the codes; returns the misfit of the codes. */
static double dense_float(const pel_amb_problem_t *p, double *a, double Q[PEL_MAX_AMB][PEL_MAX_AMB])
{
    static double C[DENSE][DENSE];
    double y[DENSE];
    const pel_amb_row_t *of[DENSE];
    const int nc = dense_covariance(p, C, y, of);
    const int n = pel_amb_count(p);
    for (int i = 0; i < nc; i++) {
        for (int j = 0; j < nc; j++) { A_[i][j] = C[i][j]; }
        for (int j = 0; j < n; j++) { B_[i][j] = C[i][nc + j]; }
        B_[i][n] = y[i];
    }
    solve(nc, n + 1);
    double misfit = 0.0;
    for (int i = 0; i < nc; i++) { misfit += (double)(y[i] * B_[i][n]); }
    for (int i = 0; i < n; i++) {
        long double rest = y[nc + i];
        for (int k = 0; k < nc; k++) { rest -= C[nc + i][k] * B_[k][n]; }
        a[i] = (double)(rest / of[nc + i]->lambda_m);
        for (int j = 0; j < n; j++) {
            long double q = C[nc + i][nc + j];
            for (int k = 0; k < nc; k++) { q -= C[nc + i][k] * B_[k][j]; }
            Q[i][j] = (double)(q / (of[nc + i]->lambda_m * of[nc + j]->lambda_m));
        }
    }
    return misfit;
}

/* (a - N)' Q^-1 (a - N) and the logarithm of det Q. */
static double dense_norm(int n, double Q[PEL_MAX_AMB][PEL_MAX_AMB], const double *a, const int64_t *N, double *log_det)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) { A_[i][j] = Q[i][j]; }
        B_[i][0] = (long double)a[i] - N[i];
    }
    solve(n, 1);
    long double sum = 0.0L;
    *log_det = 0.0;
    for (int i = 0; i < n; i++) {
        sum += ((long double)a[i] - N[i]) * B_[i][0];
        *log_det += log(fabs((double)A_[i][i]));
    }
    return (double)sum;
}

/* Several systems and carriers, unequal variances, some codes and some phases missing, pivots that differ by system. */
static pel_amb_problem_t random_epoch(rng_t *r, bool prior, double var_iono)
{
    static const double lambda[3] = {LAMBDA1, LAMBDA2, 0.254828048790854};
    pel_amb_problem_t p;
    memset(&p, 0, sizeof p);
    p.have_prior = prior;
    p.var_iono = var_iono;
    for (int i = 0; i < 3; i++) { p.P_r[i][i] = 0.01 + rng_uniform(r); }
    p.P_r[0][1] = p.P_r[1][0] = 0.4 * sqrt(p.P_r[0][0] * p.P_r[1][1]);
    const int n_sys = rng_int(r, 1, 3);
    for (int sys = 0; sys < n_sys; sys++) {
        const int n_sat = (n_sys == 1) ? rng_int(r, 4, 7) : rng_int(r, 2, 4);
        double u[8][3];
        for (int s = 0; s <= n_sat; s++) {
            const double z = 0.2 + 0.8 * rng_uniform(r);
            const double az = 6.2832 * rng_uniform(r);
            u[s][0] = sqrt(1 - z * z) * cos(az);
            u[s][1] = sqrt(1 - z * z) * sin(az);
            u[s][2] = z;
        }
        for (int f = 0; f < 3; f += 1 + (sys == 1)) {
            pel_amb_group_t *g = &p.group[p.n_groups];
            const int pivot = rng_int(r, 0, n_sat); /* each carrier may have its own */
            *g = (pel_amb_group_t){.sat = (uint8_t)(10 * sys + pivot),
                                   .mu = lambda[f] * lambda[f] / (LAMBDA1 * LAMBDA1),
                                   .var_phase = 1e-5 * (1 + rng_uniform(r)),
                                   .var_code = 0.2 + rng_uniform(r)};
            for (int s = 0; s <= n_sat && p.n_rows < PEL_MAX_AMB; s++) {
                if (s == pivot) { continue; }
                pel_amb_row_t *row = &p.row[p.n_rows++];
                *row = (pel_amb_row_t){.group = (uint8_t)p.n_groups,
                                       .sat = (uint8_t)(10 * sys + s),
                                       .integer = rng_uniform(r) < 0.9,
                                       .code = rng_uniform(r) < 0.9,
                                       .lambda_m = lambda[f],
                                       .phase_m = 1e4 * rng_gauss(r),
                                       .code_m = rng_gauss(r),
                                       .var_phase = 1e-5 * (1 + 3 * rng_uniform(r)),
                                       .var_code = 0.2 + 2 * rng_uniform(r)};
                for (int k = 0; k < 3; k++) { row->g[k] = -(u[s][k] - u[pivot][k]); }
            }
            p.n_groups++;
        }
    }
    return p;
}

static void the_float_problem_is_that_of_one_dense_estimate(void)
{
    static double Q[PEL_MAX_AMB][PEL_MAX_AMB];
    double worst_sq[2] = {0.0}; /* with a prior, without */
    double worst_adop = 0.0;
    double worst_float = 0.0;
    rng_t r = {21};
    int largest = 0;
    for (int t = 0; t < 150; t++) {
        const double var_iono = (t % 3 == 0) ? 0.0 : pow(10.0, -5.0 + 4.0 * rng_uniform(&r));
        const pel_amb_problem_t p = random_epoch(&r, t % 2 == 0, var_iono);
        int n_code = 0;
        for (int i = 0; i < p.n_rows; i++) { n_code += p.row[i].code; }
        double a[PEL_MAX_AMB];
        const double misfit = dense_float(&p, a, Q);
        const int n = pel_amb_count(&p);
        if (n > largest) { largest = n; }
        TEST_ASSERT_EQUAL(PEL_OK, pel_amb_float(&p, &ils, 2, 100000));
        const pel_status_t status = pel_ils_run(&ils, INT32_MAX);
        TEST_ASSERT_TRUE(status == PEL_OK || status == PEL_W_BUDGET);
        TEST_ASSERT_EQUAL_INT(n, ils.n);
        TEST_ASSERT_EQUAL_INT(p.have_prior ? n_code : n_code - 3, ils.float_dof);
        double *worst = p.have_prior ? &worst_sq[0] : &worst_sq[1];
        worst_float = fmax(worst_float, fabs(ils.float_sq - misfit) / (misfit + 1.0));
        for (int k = 0; k < 2; k++) {
            int64_t N[PEL_MAX_AMB];
            double sq;
            double log_det;
            TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, k, N, &sq));
            const double dense = dense_norm(n, Q, a, N, &log_det);
            *worst = fmax(*worst, fabs(sq - dense) / dense);
            worst_adop = fmax(worst_adop, fabs(pel_ils_adop(&ils) / exp(log_det / (2 * n)) - 1.0));
        }
    }
    printf("  150 epochs, n up to %d: squared norms within %.1e (without prior %.1e) of the dense estimate, ADOP %.1e, "
           "code misfit %.1e\n",
           largest, worst_sq[0], worst_sq[1], worst_adop, worst_float);
    TEST_ASSERT_TRUE(worst_sq[0] < 1e-7);
    TEST_ASSERT_TRUE(worst_sq[1] < 1e-3);
    TEST_ASSERT_TRUE(worst_adop < 1e-4);
    TEST_ASSERT_TRUE(worst_float < 1e-6);
}

static void fixed_phases_give_the_position_they_were_made_from(void)
{
    const case_t c = {.t_s = 2100, .sd_code = 3, .sd_phase = 0.003, .sd_prior = 2.0};
    rng_t r = {22};
    const int n = 2000;
    double chi2 = 0.0;
    for (int t = 0; t < n; t++) {
        const epoch_t e = epoch_draw(&c, &r);
        int64_t N[PEL_MAX_AMB];
        memcpy(N, e.N1, sizeof(int64_t) * (size_t)e.m);
        memcpy(N + e.m, e.N2, sizeof(int64_t) * (size_t)e.m);
        double b[3];
        double P[3][3];
        double sq;
        int dof;
        TEST_ASSERT_EQUAL(PEL_OK, pel_amb_fixed(&e.problem, N, b, P, &sq, &dof));
        TEST_ASSERT_EQUAL_INT(2 * e.m - 3, dof);
        chi2 += sq;
        TEST_ASSERT_TRUE(P[0][0] > 0 && P[1][1] > 0 && P[2][2] > 0 && P[0][0] < 1e-3);
    }
    printf("  residuals of fixed phases: mean chi-square %.2f of 9 degrees of freedom\n", chi2 / n);
    TEST_ASSERT_DOUBLE_WITHIN(4.0 * sqrt(18.0 / n), 9.0, chi2 / n);
}

/* ---- verdicts ---------------------------------------------------------------------------------------------------- */

static pel_int_verdict_t judge(const epoch_t *e, const pel_int_limits_t *limits, int32_t budget)
{
    pel_int_verdict_t v;
    TEST_ASSERT_EQUAL(PEL_OK, pel_amb_float(&e->problem, &ils, 2, budget));
    (void)pel_ils_run(&ils, INT32_MAX);
    (void)pel_int_validate(&e->problem, &ils, limits, &v);
    return v;
}

#define FAILED(v, reason) (((v).failed & (1u << (reason))) != 0)

static void every_test_has_its_own_verdict(void)
{
    const case_t strong = {.t_s = 8100, .sd_code = 1, .sd_phase = 0.002, .sd_prior = 0.3};
    rng_t r = {23};
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    epoch_t e = epoch_draw(&strong, &r);
    const epoch_t good = e;
    pel_int_verdict_t v = judge(&e, &limits, 10000);
    TEST_ASSERT_EQUAL(PEL_INT_OK, v.reason);
    TEST_ASSERT_EQUAL_UINT16(0, v.failed);
    TEST_ASSERT_EQUAL_INT(e.m, v.n_pairs);
    TEST_ASSERT_TRUE(v.ratio > 2.0 && v.chi2 < v.chi2_max && v.band_worst < 1.0 && v.prior_sq < 25.0);
    TEST_ASSERT_EQUAL_INT(3 * e.m, v.chi2_dof); /* m codes and 2 m phases; position and prior cancel */

    v = judge(&e, &limits, 3);
    TEST_ASSERT_EQUAL(PEL_INT_BUDGET, v.reason);

    limits.n_min = 2 * e.m + 1;
    v = judge(&e, &limits, 10000);
    TEST_ASSERT_EQUAL(PEL_INT_FEW, v.reason);
    pel_int_limits_default(&limits);

    limits.ratio_min = 1e8;
    v = judge(&e, &limits, 10000);
    TEST_ASSERT_EQUAL(PEL_INT_RATIO, v.reason);
    TEST_ASSERT_EQUAL_UINT16(1u << PEL_INT_RATIO, v.failed);
    pel_int_limits_default(&limits);

    limits.success_min = 1.0;
    e.problem.have_prior = false;
    v = judge(&e, &limits, 10000);
    TEST_ASSERT_EQUAL(PEL_INT_SUCCESS, v.reason);
    pel_int_limits_default(&limits);
    e = good;

    e.problem.row[2].code_m += 30.0; /* a code outlier leaves the integers right and the misfit large */
    v = judge(&e, &limits, 10000);
    TEST_ASSERT_TRUE(FAILED(v, PEL_INT_CHI2));
    TEST_ASSERT_FALSE(FAILED(v, PEL_INT_BAND));
    e = good;

    e.problem.row[3].phase_m += 0.25 * LAMBDA1; /* a quarter cycle on L1 alone: no integer pair fits the band */
    v = judge(&e, &limits, 10000);
    TEST_ASSERT_TRUE(FAILED(v, PEL_INT_BAND));
    TEST_ASSERT_EQUAL_INT(3, v.worst_row % e.m);
    e = good;

    for (int i = 0; i < e.problem.n_rows; i++) { /* the predicted position 3 m off, ten of its sigmas */
        const double shift = 3.0 * e.problem.row[i].g[0];
        e.problem.row[i].code_m += shift;
        e.problem.row[i].phase_m += shift;
    }
    v = judge(&e, &limits, 10000);
    TEST_ASSERT_TRUE(FAILED(v, PEL_INT_PRIOR) || FAILED(v, PEL_INT_CHI2));

    limits.prior_sigma = 0.01;
    v = judge(&good, &limits, 10000);
    TEST_ASSERT_EQUAL(PEL_INT_PRIOR, v.reason);
}

static void a_bad_satellite_is_found_and_left_out(void)
{
    const case_t c = {.t_s = 8100, .sd_code = 1, .sd_phase = 0.002, .sd_prior = 0.5};
    rng_t r = {24};
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    int fixed = 0;
    int right_one = 0;
    int wrong = 0;
    const int n = 300;
    for (int t = 0; t < n; t++) {
        epoch_t e = epoch_draw(&c, &r);
        const int bad = rng_int(&r, 0, e.m - 1);
        e.problem.row[bad].phase_m += 0.5 * LAMBDA1;
        int64_t N[PEL_MAX_AMB];
        pel_int_verdict_t v;
        if (pel_amb_resolve(&e.problem, &ils, &limits, 20000, 8, N, &v) != PEL_OK) { continue; }
        fixed++;
        right_one += !e.problem.row[bad].integer;
        for (int i = 0; i < e.m; i++) {
            if (!e.problem.row[i].integer) {
                TEST_ASSERT_EQUAL_INT64(0, N[i]);
                continue;
            }
            wrong += N[i] != e.N1[i] || N[e.m + i] != e.N2[i];
        }
    }
    printf("  half a cycle on one of seven: fixed without it in %d of %d epochs (%d another), %d wrong integers\n",
           right_one, n, fixed - right_one, wrong);
    TEST_ASSERT_GREATER_THAN(n * 9 / 10, right_one);
    TEST_ASSERT_EQUAL_INT(0, wrong);
}

static void default_limits_let_few_wrong_fixes_pass(void)
{
    static const struct {
        const char *name;
        case_t c;
    } rows[] = {{"6 satellites, code 3 m", {.t_s = 0, .sd_code = 3, .sd_phase = 0.003}},
                {"7 satellites, code 3 m", {.t_s = 2100, .sd_code = 3, .sd_phase = 0.003}},
                {"7, iono 10 mm modelled",
                 {.t_s = 2100, .sd_code = 3, .sd_phase = 0.003, .sd_iono = 0.01, .iono_modelled = true}},
                {"8 satellites, code 1 m", {.t_s = 8100, .sd_code = 1, .sd_phase = 0.003}}};
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    const int n = 2000;
    int all_wrong = 0;
    for (int k = 0; k < 4; k++) {
        for (int tries = 1; tries <= 8; tries += 7) {
            rng_t r = {(uint64_t)(500 + k)};
            int fixed = 0;
            int wrong = 0;
            for (int t = 0; t < n; t++) {
                epoch_t e = epoch_draw(&rows[k].c, &r);
                int64_t N[PEL_MAX_AMB];
                pel_int_verdict_t v;
                if (pel_amb_resolve(&e.problem, &ils, &limits, 20000, tries, N, &v) != PEL_OK) { continue; }
                fixed++;
                bool ok = true;
                for (int i = 0; i < e.m; i++) {
                    ok = ok && (!e.problem.row[i].integer || N[i] == e.N1[i]) &&
                         (!e.problem.row[e.m + i].integer || N[e.m + i] == e.N2[i]);
                }
                wrong += !ok;
            }
            printf("  %s, %d tries: fixed %5.1f %%, wrong %.2f %%\n", rows[k].name, tries, 100.0 * fixed / n,
                   100.0 * wrong / n);
            all_wrong += wrong;
        }
    }
    TEST_ASSERT_LESS_OR_EQUAL_INT(n / 200, all_wrong);
}

static void impossible_problems_get_a_status(void)
{
    const case_t c = {.t_s = 2100, .sd_code = 3, .sd_phase = 0.003};
    rng_t r = {25};
    const epoch_t good = epoch_draw(&c, &r);
    epoch_t e = good;
    e.problem.n_rows = 0;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_amb_float(&e.problem, &ils, 2, 100));
    e = good;
    e.problem.row[1].phase_m = NAN;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_amb_float(&e.problem, &ils, 2, 100));
    e = good;
    e.problem.row[1].var_phase = 0.0;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_amb_float(&e.problem, &ils, 2, 100));
    e = good;
    e.problem.row[1].group = 7;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_amb_float(&e.problem, &ils, 2, 100));
    e = good;
    for (int i = 2; i < e.problem.n_rows; i++) { e.problem.row[i].code = false; }
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_amb_float(&e.problem, &ils, 2, 100));
    e = good;
    for (int i = 0; i < e.problem.n_rows; i++) { e.problem.row[i].integer = false; }
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_amb_float(&e.problem, &ils, 2, 100));
    e = good;
    e.problem.have_prior = true; /* a prior that is no covariance */
    e.problem.P_r[0][0] = -1.0;
    TEST_ASSERT_TRUE(pel_amb_float(&e.problem, &ils, 2, 100) < 0);

    int64_t N[PEL_MAX_AMB] = {7, 7};
    pel_int_verdict_t v;
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    TEST_ASSERT_TRUE(pel_amb_resolve(&e.problem, &ils, &limits, 100, 3, N, &v) < 0);
    TEST_ASSERT_EQUAL_INT64(7, N[0]);
    TEST_ASSERT_EQUAL(PEL_INT_NOT_TRIED, v.reason);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_float_problem_is_that_of_one_dense_estimate);
    RUN_TEST(fixed_phases_give_the_position_they_were_made_from);
    RUN_TEST(every_test_has_its_own_verdict);
    RUN_TEST(a_bad_satellite_is_found_and_left_out);
    RUN_TEST(default_limits_let_few_wrong_fixes_pass);
    RUN_TEST(impossible_problems_get_a_status);
    return UNITY_END();
}

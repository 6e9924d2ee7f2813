/* test_transform.c - the float-transform search against a scan of everything, against the engine, and its promise of containment. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/ambiguity_methods.h"
#include "support_ambiguity.h"
#include "unity.h"

static pel_transform_t out;
static pel_ils_t ils;

void setUp(void) {}
void tearDown(void) {}

/* ---- brute force ---------------------------------------------------------------------------------------------------- */

#define REACH 3 /* integers to each side of the nearest */

typedef struct {
    int64_t N[2][PEL_TRANSFORM_MAX];
    double sq[2];
} scan_t;

/* Lower Cholesky factor of Q and its use: squared norm of a - N by forward substitution. */
static void cholesky(const problem_t *p, double L[AMB_MAX][AMB_MAX])
{
    for (int i = 0; i < p->n; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = p->Q[i][j];
            for (int k = 0; k < j; k++) { sum -= L[i][k] * L[j][k]; }
            L[i][j] = (i == j) ? sqrt(sum) : sum / L[j][j];
        }
    }
}

static double norm(const problem_t *p, double L[AMB_MAX][AMB_MAX], const int64_t *N, double *largest)
{
    double y[PEL_TRANSFORM_MAX];
    double sq = 0.0;
    *largest = 0.0;
    for (int i = 0; i < p->n; i++) {
        y[i] = p->a[i] - (double)N[i];
        for (int k = 0; k < i; k++) { y[i] -= L[i][k] * y[k]; }
        y[i] /= L[i][i];
        sq += y[i] * y[i];
        *largest = fmax(*largest, fabs(y[i]));
    }
    return sq;
}

/* Every vector of the cube. True: nothing outside can be better, for |a_i - N_i| <= sqrt(norm Q_ii). */
static bool scan(const problem_t *p, double L[AMB_MAX][AMB_MAX], scan_t *s)
{
    int64_t N[PEL_TRANSFORM_MAX];
    int at[PEL_TRANSFORM_MAX] = {0};
    double largest;
    s->sq[0] = s->sq[1] = 1e300;
    for (;;) {
        for (int i = 0; i < p->n; i++) { N[i] = llround(p->a[i]) + at[i] - REACH; }
        const double sq = norm(p, L, N, &largest);
        const int k = (sq < s->sq[0]) ? 0 : 1;
        if (sq < s->sq[k]) {
            if (k == 0) {
                s->sq[1] = s->sq[0];
                memcpy(s->N[1], s->N[0], sizeof N);
            }
            s->sq[k] = sq;
            memcpy(s->N[k], N, sizeof N);
        }
        int i = 0;
        while (i < p->n && ++at[i] > 2 * REACH) { at[i++] = 0; }
        if (i == p->n) { break; }
    }
    for (int i = 0; i < p->n; i++) {
        if (sqrt(s->sq[1] * p->Q[i][i]) + 0.5 > REACH) { return false; }
    }
    return true;
}

static problem_t random_small(rng_t *r, int n)
{
    problem_t p;
    double A[AMB_MAX][AMB_MAX];
    memset(&p, 0, sizeof p);
    p.n = n;
    for (int i = 0; i < n; i++) {
        p.a[i] = 100.0 * rng_gauss(r);
        for (int k = 0; k < n; k++) { A[i][k] = 0.25 * rng_gauss(r); }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            p.Q[i][j] = (i == j) ? 0.02 : 0.0;
            for (int k = 0; k < n; k++) { p.Q[i][j] += A[i][k] * A[j][k]; }
        }
    }
    return p;
}

static pel_status_t solve(const problem_t *p, pel_transform_region_t region, double k)
{
    static double Q[PEL_TRI(AMB_MAX)];
    problem_pack(p, Q);
    const pel_transform_input_t in = {.n = p->n, .a = p->a, .Q = Q, .region = region, .k = k};
    return pel_transform_solve(&in, &out);
}

static void expect(const int64_t *N, double sq, int k, int n)
{
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * sq + 1e-9, sq, out.score[k]);
    for (int i = 0; i < n; i++) { TEST_ASSERT_EQUAL_INT64(N[i], out.N[k][i]); }
}

static void the_search_finds_what_a_scan_of_everything_finds(void)
{
    static double L[AMB_MAX][AMB_MAX];
    rng_t r = {81};
    int proved = 0, capped = 0, nodes = 0;
    for (int t = 0; proved < 1000; t++) {
        const problem_t p = random_small(&r, 2 + t % 5);
        scan_t s;
        cholesky(&p, L);
        if (!scan(&p, L, &s)) { continue; }
        proved++;
        const pel_status_t status = solve(&p, PEL_TRANSFORM_SPHERE, 0.0);
        TEST_ASSERT_LESS_OR_EQUAL_INT32(PEL_TRANSFORM_NODES, out.nodes);
        if (out.nodes > nodes) { nodes = (int)out.nodes; }
        TEST_ASSERT_EQUAL(PEL_OK, status);
        TEST_ASSERT_TRUE(out.n_found == 2 || s.sq[1] > 27.6); /* 1 - 1e-6 of two degrees of freedom */
        for (int k = 0; k < out.n_found; k++) { expect(s.N[k], s.sq[k], k, p.n); }
        capped += solve(&p, PEL_TRANSFORM_BOX, 5.0) == PEL_W_BUDGET;
        TEST_ASSERT_LESS_OR_EQUAL_INT32(PEL_TRANSFORM_NODES, out.nodes);
    }
    printf("  1000 random Q, n = 2..6: sphere as the scan, at most %d nodes; box k = 5 capped in %d\n", nodes, capped);
}

static void where_its_region_holds_them_it_finds_the_engines_two_best(void)
{
    static double L[AMB_MAX][AMB_MAX];
    static double Q[PEL_TRI(AMB_MAX)];
    int best[2] = {0}, second[2] = {0}, capped[2] = {0}, empty[2] = {0};
    rng_t r = {82};
    const int n = 2000;
    for (int t = 0; t < n; t++) {
        problem_t p = problem_random(&r, 2 + t % 11);
        for (int i = 0; i < p.n; i++) { p.a[i] = remainder(p.a[i], 1000.0); }
        problem_pack(&p, Q);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, p.n, p.a, Q, 2, 2000000));
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_run(&ils, INT32_MAX));
        cholesky(&p, L);
        for (int sphere = 0; sphere < 2; sphere++) {
            const pel_status_t status = solve(&p, sphere ? PEL_TRANSFORM_SPHERE : PEL_TRANSFORM_BOX, 3.0);
            capped[sphere] += status == PEL_W_BUDGET;
            empty[sphere] += status == PEL_W_REJECTED;
            if (status == PEL_W_BUDGET) { continue; }
            for (int k = 0; k < 2; k++) {
                int64_t N[AMB_MAX];
                double sq, largest;
                TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, k, N, &sq));
                (void)norm(&p, L, N, &largest);
                const bool holds = sphere ? sq < 27.6 : largest < 3.0;
                if (!holds) { break; }
                TEST_ASSERT_EQUAL(PEL_OK, status);
                expect(N, sq, k, p.n);
                (k == 0 ? best : second)[sphere]++;
            }
        }
    }
    printf("  %d problems of the generator, n = 2..12, as the engine: box k = 3 best %d, second %d (capped %d, nothing "
           "inside %d); sphere %d, %d (%d, %d)\n",
           n, best[0], second[0], capped[0], empty[0], best[1], second[1], capped[1], empty[1]);
    TEST_ASSERT_GREATER_THAN(400, second[0]);
    TEST_ASSERT_GREATER_THAN(400, second[1]);
}

static void the_box_holds_the_truth_as_often_as_promised(void)
{
    const int draws = 20000;
    for (int n = 4; n <= 8; n += 2) {
        /* so strong that the truth is always the best of those inside */
        problem_t p;
        double L[AMB_MAX][AMB_MAX] = {{0}};
        rng_t r = {(uint64_t)(83 + n)};
        memset(&p, 0, sizeof p);
        p.n = n;
        for (int i = 0; i < n; i++) {
            for (int j = 0; j <= i; j++) { L[i][j] = 0.02 * rng_gauss(&r); }
            L[i][i] = 0.03 + 0.03 * rng_uniform(&r);
        }
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++) {
                for (int k = 0; k < n; k++) { p.Q[i][j] += L[i][k] * L[j][k]; }
            }
        }
        int held = 0;
        for (int t = 0; t < draws; t++) {
            double e[AMB_MAX];
            for (int i = 0; i < n; i++) {
                e[i] = rng_gauss(&r);
                p.a[i] = 7.0 * i;
                for (int k = 0; k <= i; k++) { p.a[i] += L[i][k] * e[k]; }
            }
            bool right = solve(&p, PEL_TRANSFORM_BOX, 3.0) == PEL_OK;
            for (int i = 0; i < n; i++) { right = right && out.N[0][i] == 7 * i; }
            held += right;
        }
        const double promised = pow(erf(3.0 / sqrt(2.0)), n);
        const double sd = sqrt(promised * (1.0 - promised) / draws);
        printf("  box k = 3, %d double differences: truth inside %.4f, (2 Phi(3) - 1)^%d = %.4f\n", n,
               (double)held / draws, n, promised);
        TEST_ASSERT_DOUBLE_WITHIN(3.0 * sd, promised, (double)held / draws);
    }
}

static void bad_input_and_caps_are_told(void)
{
    double a[PEL_TRANSFORM_MAX] = {0.3, -0.2};
    double Q[PEL_TRI(PEL_TRANSFORM_MAX)] = {0.1, 0.05, 0.1};
    pel_transform_input_t in = {.n = 2, .a = a, .Q = Q, .k = 5.0};
    TEST_ASSERT_EQUAL(PEL_OK, pel_transform_solve(&in, &out));
    TEST_ASSERT_EQUAL_INT(2, out.n_found);
    in.n = PEL_TRANSFORM_MAX + 1;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_solve(&in, &out));
    TEST_ASSERT_EQUAL_INT(0, out.n_found);
    in.n = 0;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_solve(&in, &out));
    in.n = 2;
    a[1] = NAN;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_solve(&in, &out));
    a[1] = 8388608.0;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_solve(&in, &out));
    a[1] = -0.2;
    Q[1] = INFINITY;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_solve(&in, &out));
    Q[1] = 0.1;
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_transform_solve(&in, &out));
    Q[1] = 0.05;
    in.k = NAN;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_solve(&in, &out));
    in.k = 100.1;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_solve(&in, &out));
    in.k = 0.01; /* nothing this near */
    TEST_ASSERT_EQUAL(PEL_W_REJECTED, pel_transform_solve(&in, &out));
    in.k = 100.0;
    Q[0] = Q[2] = 1e6;
    TEST_ASSERT_EQUAL(PEL_W_BUDGET, pel_transform_solve(&in, &out));
    TEST_ASSERT_EQUAL_INT32(PEL_TRANSFORM_NODES, out.nodes);
    Q[0] = 1e12;
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_transform_solve(&in, &out));
    in.region = PEL_TRANSFORM_SPHERE;
    in.metric = Q;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_solve(&in, &out));
    const double g[4][3] = {{1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}};
    double metric[PEL_TRI(4)] = {7.0};
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_transform_phase_metric(4, g, 0.86, 1.0, false, metric));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_phase_metric(3, g, 0.86, 1.0, false, metric));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_phase_metric(PEL_TRANSFORM_MAX + 1, g, 0.86, 1.0, false, metric));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_phase_metric(4, g, 0.0, 1.0, false, metric));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_transform_phase_metric(4, g, 0.86, NAN, false, metric));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 7.0, metric[0]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_search_finds_what_a_scan_of_everything_finds);
    RUN_TEST(where_its_region_holds_them_it_finds_the_engines_two_best);
    RUN_TEST(the_box_holds_the_truth_as_often_as_promised);
    RUN_TEST(bad_input_and_caps_are_told);
    return UNITY_END();
}

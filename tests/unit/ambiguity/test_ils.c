/* build: f32 f64 */
/* test_ils.c - the search engine against published problems, RTKLIB's search, and exhaustive enumeration. */
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelorus/ambiguity.h"
#include "support_ambiguity.h"
#include "unity.h"

static pel_ils_t ils;

void setUp(void) {}
void tearDown(void) {}

static bool required(void)
{
    const char *r = getenv("PELORUS_REQUIRE_DATA");
    return r != NULL && strcmp(r, "1") == 0;
}

/* ---- published problems ------------------------------------------------------------------------------------------ */

/* Next line of a reference file that is not a comment. */
static char *data_line(FILE *f, char *line, int cap)
{
    while (fgets(line, cap, f) != NULL) {
        if (line[0] != '#') { return line; }
    }
    return NULL;
}

static void read_row(FILE *f, int n, double *out)
{
    char line[4096];
    char *at = data_line(f, line, sizeof line);
    TEST_ASSERT_NOT_NULL(at);
    for (int i = 0; i < n; i++) { out[i] = strtod(at, &at); }
}

static void check_reference(const char *dir, const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/lambda-reference/%s.txt", dir, name);
    FILE *f = fopen(path, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(f, path);
    double n_read;
    read_row(f, 1, &n_read);
    const int n = (int)n_read;
    problem_t p = {.n = n};
    for (int i = 0; i < n; i++) { read_row(f, 1, &p.a[i]); }
    for (int i = 0; i < n; i++) { read_row(f, n, p.Q[i]); }
    double sq[2];
    double z[2][AMB_MAX];
    for (int k = 0; k < 2; k++) {
        read_row(f, 1, &sq[k]);
        read_row(f, n, z[k]);
    }
    fclose(f);

    double Q[PEL_TRI(AMB_MAX)];
    problem_pack(&p, Q);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, n, p.a, Q, 2, 20000));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ils_run(&ils, 20000));
    for (int k = 0; k < 2; k++) {
        int64_t N[AMB_MAX];
        double got;
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, k, N, &got));
        for (int i = 0; i < n; i++) { TEST_ASSERT_EQUAL_INT64_MESSAGE((int64_t)z[k][i], N[i], name); }
        TEST_ASSERT_DOUBLE_WITHIN(1e-8 * sq[k] + 1e-9, sq[k], got);
    }
    printf("  %-10s n = %2d  ratio %.6f  nodes %4d  exchanges %3d  success %.4f  ADOP %.4f\n", name, n,
           pel_ils_ratio(&ils), (int)ils.nodes, (int)ils.swaps, pel_ils_success(&ils), pel_ils_adop(&ils));
}

static void published_problems_have_their_published_answers(void)
{
    const char *dir = getenv("PELORUS_DATA");
    if (dir == NULL || dir[0] == '\0') { dir = "../shared/data"; }
    char path[512];
    snprintf(path, sizeof path, "%s/lambda-reference/small.txt", dir);
    FILE *f = fopen(path, "r");
    if (f == NULL) {
        if (required()) { TEST_FAIL_MESSAGE("lambda-reference is absent and PELORUS_REQUIRE_DATA=1"); }
        TEST_IGNORE_MESSAGE("lambda-reference is absent (PELORUS_DATA)");
    }
    fclose(f);
    static const char *const names[] = {"small", "sixdim", "geofree", "rtklib_t1", "rtklib_t2"};
    for (int i = 0; i < 5; i++) { check_reference(dir, names[i]); }
}

/* (a - z)' Q^-1 (a - z) by Gauss elimination in long double. */
static long double norm_of(int n, double Q[AMB_MAX][AMB_MAX], const double *a, const int64_t *z)
{
    static long double A[AMB_MAX][AMB_MAX + 1];
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) { A[i][j] = Q[i][j]; }
        A[i][n] = (long double)a[i] - (long double)z[i];
    }
    long double d[AMB_MAX];
    for (int i = 0; i < n; i++) { d[i] = A[i][n]; }
    for (int k = 0; k < n; k++) {
        for (int i = k + 1; i < n; i++) {
            const long double f = A[i][k] / A[k][k];
            for (int j = k; j <= n; j++) { A[i][j] -= f * A[k][j]; }
        }
    }
    long double sum = 0;
    long double x[AMB_MAX];
    for (int i = n - 1; i >= 0; i--) {
        x[i] = A[i][n];
        for (int j = i + 1; j < n; j++) { x[i] -= A[i][j] * x[j]; }
        x[i] /= A[i][i];
        sum += x[i] * d[i];
    }
    return sum;
}

/* ---- RTKLIB's search as an oracle ---------------------------------------------------------------------------------- */

typedef int (*rtklib_lambda_t)(int n, int m, const double *a, const double *Q, double *F, double *s);

static rtklib_lambda_t rtklib_lambda(void)
{
    rtklib_lambda_t f = NULL;
    void *lib = dlopen("libRTKLib.so.1", RTLD_LAZY | RTLD_GLOBAL);
    if (lib == NULL) { lib = dlopen("libRTKLib.so", RTLD_LAZY | RTLD_GLOBAL); }
    if (lib != NULL) {
        void *symbol = dlsym(lib, "lambda");
        memcpy(&f, &symbol, sizeof f);
    }
    return f;
}

static int compare_int(const void *a, const void *b)
{
    return *(const int *)a - *(const int *)b;
}

static void random_problems_are_answered_as_rtklib_answers_them(void)
{
    enum { TRIALS = 2500 };
    rtklib_lambda_t lambda = rtklib_lambda();
    if (lambda == NULL) {
        if (required()) { TEST_FAIL_MESSAGE("libRTKLib.so is absent and PELORUS_REQUIRE_DATA=1"); }
        TEST_IGNORE_MESSAGE("libRTKLib.so is absent (Debian: librtklib1)");
    }
    static int nodes[41][TRIALS];
    int count[41] = {0};
    int max_swaps = 0;
    int rtklib_gave_up = 0;
    int over_10000 = 0;
    int right = 0;
    int capped = 0;
    double ours = 0.0; /* largest relative error of a squared norm against long double */
    double theirs = 0.0;
    rng_t r = {20261123};
    for (int t = 0; t < TRIALS; t++) {
        const int n = 3 + t % 38;
        const problem_t p = problem_random(&r, n);
        double Q[PEL_TRI(AMB_MAX)];
        double full[AMB_MAX * AMB_MAX];
        double F[2 * AMB_MAX];
        double s[2];
        problem_pack(&p, Q);
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++) { full[i * n + j] = p.Q[i][j]; }
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, n, p.a, Q, 2, 2000000));
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_run(&ils, 2000000));
        nodes[n][count[n]++] = (int)ils.nodes;
        if (ils.nodes > 10000) { over_10000++; }
        if (ils.swaps > max_swaps) { max_swaps = (int)ils.swaps; }
        if (!ils.decorrelated) { capped++; }
        int64_t N[2][AMB_MAX];
        double sq[2];
        for (int k = 0; k < 2; k++) { TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, k, N[k], &sq[k])); }
        right += memcmp(N[0], p.truth, sizeof(int64_t) * (size_t)n) == 0;
        if (lambda(n, 2, p.a, full, F, s) != 0) {
            rtklib_gave_up++;
            continue;
        }
        for (int k = 0; k < 2; k++) {
            const double exact = (double)norm_of(n, (double(*)[AMB_MAX])p.Q, p.a, N[k]);
            ours = fmax(ours, fabs(sq[k] - exact) / exact);
            theirs = fmax(theirs, fabs(s[k] - exact) / exact);
            for (int i = 0; i < n; i++) { TEST_ASSERT_EQUAL_INT64(llround(F[k * n + i]), N[k][i]); }
        }
    }
    printf("  %d problems n = 3..40: RTKLIB gave up on %d, every other answer identical (best and second)\n", TRIALS,
           rtklib_gave_up);
    printf("  best = truth in %.1f %%; nodes > 10000: %d; exchanges at most %d, capped %d\n", 100.0 * right / TRIALS,
           over_10000, max_swaps, capped);
    printf("  squared norms against long double: ours within %.1e, RTKLIB's within %.1e\n", ours, theirs);
    TEST_ASSERT_TRUE(ours < 1e-7);
    static const int show[] = {6, 10, 15, 20, 30, 40};
    for (int i = 0; i < 6; i++) {
        const int n = show[i];
        qsort(nodes[n], (size_t)count[n], sizeof(int), compare_int);
        printf("  n = %2d: nodes median %d, 90 %% %d, max %d\n", n, nodes[n][count[n] / 2], nodes[n][count[n] * 9 / 10],
               nodes[n][count[n] - 1]);
    }
    TEST_ASSERT_LESS_THAN(TRIALS / 20, rtklib_gave_up);
}

/* ---- exhaustive enumeration ---------------------------------------------------------------------------------------- */

static void small_problems_agree_with_enumeration_of_a_box(void)
{
    enum { TRIALS = 300, N_BEST = 4 };
    rng_t r = {7};
    for (int t = 0; t < TRIALS; t++) {
        const int n = 1 + t % 4;
        problem_t p = {.n = n};
        double B[4][4];
        for (int i = 0; i < n; i++) {
            p.a[i] = 20.0 * rng_gauss(&r);
            for (int j = 0; j < n; j++) { B[i][j] = rng_gauss(&r); }
        }
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++) {
                p.Q[i][j] = (i == j) ? 0.02 : 0.0;
                for (int k = 0; k < n; k++) { p.Q[i][j] += B[i][k] * B[j][k]; }
            }
        }
        double Q[PEL_TRI(4)];
        problem_pack(&p, Q);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, n, p.a, Q, N_BEST, 1000000));
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_run(&ils, 1000000));
        double sq[N_BEST];
        for (int k = 0; k < N_BEST; k++) { TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, k, NULL, &sq[k])); }

        /* the box that holds every vector of norm <= sq[3]: |a_i - z_i| <= sqrt(sq Q_ii) */
        int64_t low[4];
        int64_t z[4];
        long cells = 1;
        int64_t high[4];
        for (int i = 0; i < n; i++) {
            const double half = sqrt(sq[N_BEST - 1] * p.Q[i][i]) + 1e-6;
            low[i] = (int64_t)ceil(p.a[i] - half);
            high[i] = (int64_t)floor(p.a[i] + half);
            cells *= high[i] - low[i] + 1;
        }
        int below[N_BEST] = {0}; /* vectors strictly better than the k-th, by more than rounding */
        int as_good = 0;
        for (long c = 0; c < cells; c++) {
            long rest = c;
            for (int i = 0; i < n; i++) {
                z[i] = low[i] + rest % (high[i] - low[i] + 1);
                rest /= high[i] - low[i] + 1;
            }
            const double q = (double)norm_of(n, p.Q, p.a, z);
            as_good += q <= sq[N_BEST - 1] * (1 + 1e-9);
            for (int k = 0; k < N_BEST; k++) { below[k] += q < sq[k] * (1 - 1e-9); }
        }
        for (int k = 0; k < N_BEST; k++) { TEST_ASSERT_EQUAL_INT(k, below[k]); }
        TEST_ASSERT_EQUAL_INT(N_BEST, as_good);
        for (int k = 0; k < N_BEST; k++) {
            int64_t N[4];
            TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, k, N, NULL));
            TEST_ASSERT_DOUBLE_WITHIN(1e-9 * (1.0 + sq[k]), (double)norm_of(n, p.Q, p.a, N), sq[k]);
        }
    }
    printf("  %d problems n = 1..4: the best four are the best four of the whole box\n", TRIALS);
}

/* ---- bounded, resumable, honest ---------------------------------------------------------------------------------- */

static void slices_do_not_change_the_answer(void)
{
    static pel_ils_t sliced;
    rng_t r = {11};
    for (int t = 0; t < 100; t++) {
        const int n = rng_int(&r, 3, 40);
        const problem_t p = problem_random(&r, n);
        double Q[PEL_TRI(AMB_MAX)];
        problem_pack(&p, Q);
        const int32_t budget = (t % 3 == 0) ? 3 * n : 2000000;
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, n, p.a, Q, 2, budget));
        memset(&sliced, 0xA5, sizeof sliced); /* nothing may depend on what was there */
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&sliced, n, p.a, Q, 2, budget));
        const pel_status_t whole = pel_ils_run(&ils, INT32_MAX);
        pel_status_t status;
        do {
            status = pel_ils_run(&sliced, rng_int(&r, 1, 50));
        } while (status == PEL_W_RUNNING);
        TEST_ASSERT_EQUAL(whole, status);
        TEST_ASSERT_EQUAL_INT32(ils.nodes, sliced.nodes);
        TEST_ASSERT_EQUAL_INT(ils.n_found, sliced.n_found);
        for (int k = 0; k < ils.n_found; k++) {
            int64_t N[2][AMB_MAX];
            double sq[2];
            TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, k, N[0], &sq[0]));
            TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&sliced, k, N[1], &sq[1]));
            TEST_ASSERT_EQUAL_MEMORY(N[0], N[1], sizeof(int64_t) * (size_t)n);
            TEST_ASSERT_EQUAL_MEMORY(&sq[0], &sq[1], sizeof sq[0]);
        }
    }
}

static void a_spent_budget_tells_best_so_far_and_what_cannot_be_beaten(void)
{
    rng_t r = {13};
    int budget_hits = 0;
    int best_anyway = 0;
    for (int t = 0; t < 400; t++) {
        const int n = rng_int(&r, 8, 40);
        const problem_t p = problem_random(&r, n);
        double Q[PEL_TRI(AMB_MAX)];
        problem_pack(&p, Q);
        double optimum;
        int64_t N[2][AMB_MAX];
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, n, p.a, Q, 2, 2000000));
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_run(&ils, INT32_MAX));
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, 0, N[0], &optimum));
        const int32_t all = ils.nodes;

        const int32_t budget = n + rng_int(&r, 0, 2 * n);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, n, p.a, Q, 2, budget));
        const pel_status_t status = pel_ils_run(&ils, INT32_MAX);
        TEST_ASSERT_EQUAL((all <= budget) ? PEL_OK : PEL_W_BUDGET, status);
        if (status == PEL_OK) { continue; }
        budget_hits++;
        TEST_ASSERT_EQUAL_INT32(budget, ils.nodes);
        TEST_ASSERT_EQUAL(PEL_W_BUDGET, pel_ils_run(&ils, 1000)); /* spent is spent */
        double sq;
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, 0, N[1], &sq));
        const double low = pel_ils_lower_bound(&ils);
        const bool same = memcmp(N[0], N[1], sizeof(int64_t) * (size_t)n) == 0;
        best_anyway += same;
        if (!same) { TEST_ASSERT_TRUE(low <= optimum * (1 + 1e-12)); } /* the optimum was still out there */
        TEST_ASSERT_TRUE(sq >= optimum * (1 - 1e-12));
    }
    printf("  budget of n to 3 n nodes spent in %d of 400; the optimum was in hand in %d of them\n", budget_hits,
           best_anyway);
    TEST_ASSERT_GREATER_THAN(50, budget_hits);
}

static void the_lower_bound_is_the_norm_of_the_best_vector_not_visited(void)
{
    /* Q = I, a = (0.1, 0.2): norms 0.05, 0.65, 0.85, ... A budget of 2 nodes ends with one candidate. */
    const double a[2] = {0.1, 0.2};
    const double Q[3] = {1.0, 0.0, 1.0};
    TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, 2, a, Q, 2, 2));
    TEST_ASSERT_EQUAL(PEL_W_RUNNING, pel_ils_run(&ils, 2));
    TEST_ASSERT_EQUAL(PEL_W_BUDGET, pel_ils_run(&ils, 1));
    TEST_ASSERT_EQUAL_INT(1, ils.n_found);
    const double low = pel_ils_lower_bound(&ils); /* (0, 1) is next; what rounding might hide is taken off */
    TEST_ASSERT_TRUE(low <= 0.65 && low > 0.65 * (sizeof(pel_real) == 4 ? 0.996 : 0.9999998));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, pel_ils_ratio(&ils));
}

/* Refused with this status; the engine is empty and hands out nothing. */
static void expect_refused(pel_status_t status, int n, const double *a, const double *Q, int n_best, int32_t budget)
{
    int64_t N[2] = {-5, -6};
    double sq = -7.0;
    TEST_ASSERT_EQUAL(status, pel_ils_init(&ils, n, a, Q, n_best, budget));
    TEST_ASSERT_EQUAL_INT(0, ils.n);
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_ils_run(&ils, 10));
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_ils_get(&ils, 0, N, &sq));
    TEST_ASSERT_EQUAL_INT64(-5, N[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, -7.0, sq);
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, pel_ils_ratio(&ils));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, pel_ils_success(&ils));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, pel_ils_adop(&ils));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, pel_ils_lower_bound(&ils));
}

static void bad_input_gets_a_status(void)
{
    const double a[2] = {0.1, 0.2};
    const double Q[3] = {1.0, 0.5, 1.0};
    expect_refused(PEL_E_RANGE, 0, a, Q, 2, 100);
    expect_refused(PEL_E_RANGE, -1, a, Q, 2, 100);
    expect_refused(PEL_E_RANGE, PEL_MAX_AMB + 1, a, Q, 2, 100);
    expect_refused(PEL_E_RANGE, 2, a, Q, 0, 100);
    expect_refused(PEL_E_RANGE, 2, a, Q, PEL_ILS_BEST + 1, 100);
    expect_refused(PEL_E_RANGE, 2, a, Q, 2, 0);
    static const double no_ambiguity[] = {NAN, -NAN, INFINITY, -INFINITY, 1e16, -1e300};
    for (int i = 0; i < 6; i++) {
        const double bad[2] = {0.1, no_ambiguity[i]};
        expect_refused(PEL_E_RANGE, 2, bad, Q, 2, 100);
    }
    static const struct {
        double q, r; /* off and on the diagonal */
        pel_status_t status;
    } matrix[] = {
        {0.5, NAN, PEL_E_RANGE},        {0.5, INFINITY, PEL_E_RANGE},    {0.5, 1e300, PEL_E_RANGE},
        {0.5, -1e300, PEL_E_RANGE},     {NAN, 1.0, PEL_E_RANGE},         {INFINITY, 1.0, PEL_E_RANGE},
        {-INFINITY, 1.0, PEL_E_RANGE},  {0.5, 0.25, PEL_E_NOT_POSDEF},   {0.5, 0.1, PEL_E_NOT_POSDEF},
        {0.5, 0.0, PEL_E_NOT_POSDEF},   {0.0, -0.0, PEL_E_NOT_POSDEF},   {0.5, -1.0, PEL_E_NOT_POSDEF},
        {1.0, 1.0, PEL_E_NOT_POSDEF},   {-1.0, 1.0, PEL_E_NOT_POSDEF},   {1.5, 1.0, PEL_E_NOT_POSDEF},
        {1e300, 1.0, PEL_E_NOT_POSDEF}, {0.0, 1e-310, PEL_E_NOT_POSDEF}, {0.0, 1e-20, PEL_E_RANGE},
        {0.0, 2.3e-308, PEL_E_RANGE},
    };
    for (size_t i = 0; i < sizeof matrix / sizeof matrix[0]; i++) {
        const double bad[3] = {1.0, matrix[i].q, matrix[i].r};
        expect_refused(matrix[i].status, 2, a, bad, 2, 100);
    }
}

static void any_bits_at_all_give_an_answer_or_a_status(void)
{
    /* Words of random bits, and matrices that are nearly something sensible: whatever comes, no undefined behaviour (the sanitizers watch),
     * and what is called proved is no worse than rounding the answer's neighbours. */
    rng_t r = {99};
    int accepted = 0;
    for (int t = 0; t < 20000; t++) {
        const int n = rng_int(&r, 1, 8);
        double a[8];
        double Q[PEL_TRI(8)];
        for (int i = 0; i < n; i++) {
            a[i] = rng_gauss(&r) * pow(10.0, rng_int(&r, -20, 16));
            for (int j = 0; j <= i; j++) {
                Q[i * (i + 1) / 2 + j] = (i == j) ? pow(10.0, rng_int(&r, -18, 13)) : 0.0;
                if (i != j && t % 2 == 0) {
                    Q[i * (i + 1) / 2 + j] = rng_gauss(&r) * 0.3 * sqrt(Q[j * (j + 1) / 2 + j]);
                }
            }
        }
        if (t % 3 == 0) {
            const uint64_t bits = (uint64_t)(rng_uniform(&r) * 0x1p53) << 11 ^ (uint64_t)(rng_uniform(&r) * 0x1p53);
            memcpy((t % 2 == 0) ? &a[rng_int(&r, 0, n - 1)] : &Q[rng_int(&r, 0, PEL_TRI(n) - 1)], &bits, sizeof bits);
        }
        const pel_status_t status = pel_ils_init(&ils, n, a, Q, 2, 20000);
        if (status != PEL_OK) {
            TEST_ASSERT_TRUE(status == PEL_E_RANGE || status == PEL_E_NOT_POSDEF);
            continue;
        }
        const pel_status_t searched = pel_ils_run(&ils, INT32_MAX);
        TEST_ASSERT_TRUE(searched == PEL_OK || searched == PEL_W_BUDGET || searched == PEL_E_RANGE);
        if (searched != PEL_OK) { continue; }
        accepted++;
        double sq[2];
        for (int k = 0; k < 2; k++) {
            int64_t N[8];
            TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, k, N, &sq[k]));
            TEST_ASSERT_TRUE(isfinite(sq[k]) && sq[k] >= 0.0);
        }
        TEST_ASSERT_TRUE(sq[0] <= sq[1]);
        TEST_ASSERT_TRUE(isfinite(pel_ils_success(&ils)) && isfinite(pel_ils_adop(&ils)) &&
                         isfinite(pel_ils_lower_bound(&ils)));
    }
    printf("  20000 problems of any size: %d proved, the others refused or left unproved\n", accepted);
    TEST_ASSERT_GREATER_THAN(1000, accepted);
}

static void strength_is_what_the_variances_say(void)
{
    /* Independent ambiguities of 0.1 and 0.3 cycles: success (2 Phi(5) - 1)(2 Phi(5/3) - 1), ADOP sqrt(0.1 0.3). */
    const double a[2] = {12.1, -7.9};
    const double Q[3] = {0.01, 0.0, 0.09};
    TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, 2, a, Q, 2, 100));
    const double tolerance = (sizeof(pel_real) == 4) ? 1e-7 : 1e-9;
    TEST_ASSERT_DOUBLE_WITHIN(tolerance, erf(5.0 / sqrt(2.0)) * erf(5.0 / 3.0 / sqrt(2.0)), pel_ils_success(&ils));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sqrt(0.03), pel_ils_adop(&ils));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(published_problems_have_their_published_answers);
    RUN_TEST(random_problems_are_answered_as_rtklib_answers_them);
    RUN_TEST(small_problems_agree_with_enumeration_of_a_box);
    RUN_TEST(slices_do_not_change_the_answer);
    RUN_TEST(a_spent_budget_tells_best_so_far_and_what_cannot_be_beaten);
    RUN_TEST(the_lower_bound_is_the_norm_of_the_best_vector_not_visited);
    RUN_TEST(bad_input_gets_a_status);
    RUN_TEST(any_bits_at_all_give_an_answer_or_a_status);
    RUN_TEST(strength_is_what_the_variances_say);
    return UNITY_END();
}

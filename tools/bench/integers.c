#include "integers.h"

#include "pelorus/ambiguity.h"
#include "support_ambiguity.h"

const int bench_sizes[BENCH_SIZES] = {6, 10, 15, 20, 30, 40};

static problem_t problem;
static double packed[PEL_TRI(AMB_MAX)];
static double full[AMB_MAX * AMB_MAX];
static pel_ils_t ils;
static int64_t answer[2][AMB_MAX];

void bench_integers_prepare(int size, int which)
{
    rng_t r = {(uint64_t)(1000 * size + which)};
    problem = problem_random(&r, bench_sizes[size]);
    problem_pack(&problem, packed);
    for (int i = 0; i < problem.n * problem.n; i++) { full[i] = problem.Q[i / problem.n][i % problem.n]; }
}

void bench_integers(void)
{
    double sq[2];
    (void)pel_ils_init(&ils, problem.n, problem.a, packed, 2, 10000);
    (void)pel_ils_run(&ils, 10000);
    for (int k = 0; k < 2; k++) { (void)pel_ils_get(&ils, k, answer[k], &sq[k]); }
}

int bench_integers_problem(const double **a, const double **Q)
{
    *a = problem.a;
    *Q = full;
    return problem.n;
}

long bench_median(long *counts, int n)
{
    for (int i = 1; i < n; i++) {
        const long c = counts[i];
        int j = i;
        for (; j > 0 && counts[j - 1] > c; j--) { counts[j] = counts[j - 1]; }
        counts[j] = c;
    }
    return counts[n / 2];
}

/* build: f32 f64 */
/* test_ils_many.c - the engine against an unlimited search in long double on many realistic problems, and what a budget costs.
 *
 * 1 000 problems; PELORUS_LONG=1, or a number as argument, makes it 10 000 or that number. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelorus/ambiguity.h"
#include "support_ambiguity.h"
#include "unity.h"

#define BUDGET 10000

static pel_ils_t ils;
static int trials = 1000;

void setUp(void) {}
void tearDown(void) {}

typedef struct {
    int wrong, tie, spent, spent_best, spent_both, right;
    double worst_sq;
} tally_t;

/* Does candidate k differ from the oracle's other than by a tie? */
static bool differs(const oracle_t *o, int k, int n, tally_t *tally)
{
    int64_t N[AMB_MAX];
    double sq;
    if (pel_ils_get(&ils, k, N, &sq) != PEL_OK) { return true; }
    const double off = fabs((double)(((long double)sq - o->sq[k]) / o->sq[k]));
    tally->worst_sq = fmax(tally->worst_sq, off);
    if (memcmp(N, o->N[k], sizeof N[0] * (size_t)n) == 0) { return off > 1e-7; }
    tally->tie += off < 1e-9;
    return off >= 1e-9;
}

static void one_problem(const problem_t *p, tally_t *tally)
{
    static oracle_t o;
    double Q[PEL_TRI(AMB_MAX)];
    problem_pack(p, Q);
    oracle_solve(p, &o);
    tally->right += memcmp(o.N[0], p->truth, sizeof p->truth[0] * (size_t)p->n) == 0;

    TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, p->n, p->a, Q, 2, INT32_MAX));
    TEST_ASSERT_EQUAL(PEL_W_RUNNING, pel_ils_run(&ils, 1));
    const pel_status_t within = pel_ils_run(&ils, BUDGET - 1);
    if (within == PEL_W_RUNNING) { /* what a caller with this budget would have in hand */
        int64_t N[2][AMB_MAX];
        const bool both = pel_ils_get(&ils, 0, N[0], NULL) == PEL_OK && pel_ils_get(&ils, 1, N[1], NULL) == PEL_OK;
        const size_t size = sizeof N[0][0] * (size_t)p->n;
        const bool best = both && memcmp(N[0], o.N[0], size) == 0;
        tally->spent++;
        tally->spent_best += best;
        tally->spent_both += best && memcmp(N[1], o.N[1], size) == 0;
        TEST_ASSERT_TRUE(best || (long double)pel_ils_lower_bound(&ils) <= o.sq[0] * (1 + 1e-9L));
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_run(&ils, INT32_MAX));
    }
    const bool first = differs(&o, 0, p->n, tally);
    const bool second = differs(&o, 1, p->n, tally);
    tally->wrong += first || second;
}

static void many_problems_are_answered_as_by_an_unlimited_search(void)
{
    rng_t r = {31};
    tally_t tally = {0};
    for (int t = 0; t < trials; t++) {
        const problem_t p = problem_random(&r, 5 + t % 36);
        one_problem(&p, &tally);
    }
    printf("  %d problems n = 5..40: %d wrong (best or second), %d ties; truth is best in %.1f %%; squared norms "
           "within %.1e\n",
           trials, tally.wrong, tally.tie, 100.0 * tally.right / trials, tally.worst_sq);
    printf("  a budget of %d nodes is spent in %d (%.2f %%); best so far is then the optimum in %d, second best too in "
           "%d\n",
           BUDGET, tally.spent, 100.0 * tally.spent / trials, tally.spent_best, tally.spent_both);
    TEST_ASSERT_EQUAL_INT(0, tally.wrong);
    TEST_ASSERT_LESS_OR_EQUAL(5 + trials / 50, tally.spent);
    TEST_ASSERT_GREATER_OR_EQUAL(tally.spent / 2, tally.spent_best);
}

int main(int argc, char **argv)
{
    const char *all = getenv("PELORUS_LONG");
    if (all != NULL && strcmp(all, "1") == 0) { trials = 10000; }
    if (argc > 1) { trials = atoi(argv[1]); }
    UNITY_BEGIN();
    RUN_TEST(many_problems_are_answered_as_by_an_unlimited_search);
    return UNITY_END();
}

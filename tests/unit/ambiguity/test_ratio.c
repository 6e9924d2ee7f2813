/* test_ratio.c - the ratio test of a promised failure rate, by simulation. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/ambiguity.h"
#include "support_ambiguity.h"
#include "unity.h"

#define CLASSES 5
#define RULES   5 /* failure 1 %, failure 0.1 %, proved 1 %, ratio 2, ratio 3 */

static pel_ils_t ils;

void setUp(void) {}
void tearDown(void) {}

typedef struct {
    int draws, wrong_unchecked;
    int fixed[RULES], wrong[RULES];
} tally_t;

static void one_draw(const problem_t *p, tally_t *t)
{
    double Q[PEL_TRI(AMB_MAX)];
    int64_t N[AMB_MAX];
    problem_pack(p, Q);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, p->n, p->a, Q, 2, 200000));
    if (pel_ils_run(&ils, 200000) != PEL_OK) { return; }
    const double needed[RULES] = {pel_ils_ratio_needed(&ils, 0.01), pel_ils_ratio_needed(&ils, 0.001),
                                  pel_ils_ratio_bound(&ils, 0.01), 2.0, 3.0};
    TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, 0, N, NULL));
    const bool wrong = memcmp(N, p->truth, sizeof N[0] * (size_t)p->n) != 0;
    t->draws++;
    t->wrong_unchecked += wrong;
    for (int k = 0; k < RULES; k++) {
        const bool fixed = pel_ils_ratio(&ils) >= needed[k];
        t->fixed[k] += fixed;
        t->wrong[k] += fixed && wrong;
    }
}

/* Classes of n at random strength: the promise must hold in each, not on the mean. */
static void wrong_fixes_stay_below_the_promised_rate(void)
{
    static const int limit[CLASSES + 1] = {4, 7, 11, 16, 25, 33};
    rng_t r = {47};
    int fixed = 0;
    printf(
        "  n        draws  wrong unchecked | fixed, wrong %%: failure <= 1 %%  | <= 0.1 %%       | proved 1 %%     | "
        "ratio 2        "
        "| ratio 3\n");
    for (int c = 0; c < CLASSES; c++) {
        tally_t t = {0};
        for (int k = 0; k < 8000; k++) {
            const problem_t p = problem_random(&r, rng_int(&r, limit[c], limit[c + 1] - 1));
            one_draw(&p, &t);
        }
        printf("  %2d..%2d  %6d  %12.1f %%  |", limit[c], limit[c + 1] - 1, t.draws,
               100.0 * t.wrong_unchecked / t.draws);
        for (int k = 0; k < RULES; k++) {
            printf("    %5.1f %7.3f |", 100.0 * t.fixed[k] / t.draws, 100.0 * t.wrong[k] / t.draws);
        }
        printf("\n");
        TEST_ASSERT_LESS_OR_EQUAL_DOUBLE(0.01 * t.draws + 2.6 * sqrt(0.01 * t.draws), (double)t.wrong[0]);
        TEST_ASSERT_LESS_OR_EQUAL_DOUBLE(0.001 * t.draws + 2.6 * sqrt(0.001 * t.draws), (double)t.wrong[1]);
        TEST_ASSERT_LESS_OR_EQUAL(t.fixed[0], t.fixed[2]);
        fixed += t.fixed[1];
    }
    TEST_ASSERT_GREATER_THAN(CLASSES * 8000 / 3,
                             fixed); /* a test that refuses everything would also keep its promise */
}

/* Independent ambiguities, k of them weak with a failure rate of P together, the others sure: the slowest gain of failures from a
 * larger ratio, since the sure ones add to best and second best alike. */
static int wrong_of_weak(rng_t *r, int n, int k, double sd, double failure_max, int draws)
{
    double Q[PEL_TRI(AMB_MAX)] = {0.0}, a[AMB_MAX];
    int64_t N[AMB_MAX];
    int wrong = 0;
    for (int i = 0; i < n; i++) { Q[PEL_TRI(i) + i] = (i < k) ? sd * sd : 1e-4; }
    for (int d = 0; d < draws; d++) {
        for (int i = 0; i < n; i++) { a[i] = sqrt(Q[PEL_TRI(i) + i]) * rng_gauss(r); }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, n, a, Q, 2, 20000));
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_run(&ils, 20000));
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, 0, N, NULL));
        bool off = false;
        for (int i = 0; i < n; i++) { off = off || N[i] != 0; }
        wrong += off && pel_ils_ratio(&ils) >= pel_ils_ratio_needed(&ils, failure_max);
    }
    return wrong;
}

static void a_few_weak_ambiguities_among_sure_ones_keep_the_promise(void)
{
    enum { DRAWS = 4000 };
    static const int sizes[] = {2, 5, 12, 40};
    rng_t r = {11};
    double most = 0.0;
    for (int i = 0; i < 4; i++) {
        for (int k = 1; k <= 3 && k <= sizes[i]; k++) {
            for (double sd = 0.18; sd < 0.4; sd += 0.05) {
                const int wrong = wrong_of_weak(&r, sizes[i], k, sd, 0.02, DRAWS);
                most = fmax(most, (double)wrong / DRAWS);
                TEST_ASSERT_LESS_OR_EQUAL_DOUBLE(0.02 * DRAWS + 3.1 * sqrt(0.02 * DRAWS), (double)wrong);
            }
        }
    }
    printf("  1 to 3 weak of n = 2..40: at most %.2f %% wrong of 2 %% promised\n", 100.0 * most);
    TEST_ASSERT_GREATER_THAN_DOUBLE(0.01, most); /* more than half of what was promised is used */
}

static void the_bound_is_the_larger_and_rules_alone_beyond_what_was_measured(void)
{
    rng_t r = {12};
    for (int t = 0; t < 500; t++) {
        const problem_t p = problem_random(&r, rng_int(&r, 2, 40));
        double Q[PEL_TRI(AMB_MAX)];
        problem_pack(&p, Q);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, p.n, p.a, Q, 2, 100));
        TEST_ASSERT_TRUE(pel_ils_ratio_needed(&ils, 0.001) <= pel_ils_ratio_bound(&ils, 0.001));
        TEST_ASSERT_EQUAL_DOUBLE(pel_ils_ratio_bound(&ils, 1e-5), pel_ils_ratio_needed(&ils, 1e-5));
        TEST_ASSERT_EQUAL_DOUBLE(pel_ils_ratio_bound(&ils, 0.3), pel_ils_ratio_needed(&ils, 0.3));
        if (1.0 - pel_ils_success(&ils) <= 0.001) { TEST_ASSERT_EQUAL_DOUBLE(1.0, pel_ils_ratio_bound(&ils, 0.001)); }
    }
}

static void a_strong_model_needs_no_ratio_and_a_weak_one_much(void)
{
    const double a[3] = {0.1, 0.0, -0.2};
    double Q[6] = {1e-4, 0.0, 1e-4, 0.0, 0.0, 1e-4};
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 0.0, (ils.n = 0, ils.stage = PEL_ILS_EMPTY, pel_ils_ratio_needed(&ils, 0.001)));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, 3, a, Q, 2, 100));
    TEST_ASSERT_DOUBLE_WITHIN(0.0, 1.0, pel_ils_ratio_needed(&ils, 0.001));
    double before = 1.0;
    for (double sd = 0.2; sd < 1.0; sd *= 1.3) {
        for (int i = 0; i < 3; i++) { Q[PEL_TRI(i) + i] = sd * sd; }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, 3, a, Q, 2, 100));
        const double needed = pel_ils_ratio_needed(&ils, 0.001);
        TEST_ASSERT_TRUE(needed > before && needed >= pel_ils_ratio_needed(&ils, 0.01));
        before = needed;
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(wrong_fixes_stay_below_the_promised_rate);
    RUN_TEST(a_few_weak_ambiguities_among_sure_ones_keep_the_promise);
    RUN_TEST(the_bound_is_the_larger_and_rules_alone_beyond_what_was_measured);
    RUN_TEST(a_strong_model_needs_no_ratio_and_a_weak_one_much);
    return UNITY_END();
}

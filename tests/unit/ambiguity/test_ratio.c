/* test_ratio.c - the ratio test of a promised failure rate, by simulation. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/ambiguity.h"
#include "support_ambiguity.h"
#include "unity.h"

#define CLASSES 5

static pel_ils_t ils;

void setUp(void) {}
void tearDown(void) {}

typedef struct {
    int draws, wrong_unchecked;
    int fixed[4], wrong[4]; /* failure 1 %, failure 0.1 %, ratio 2, ratio 3 */
} tally_t;

static void one_draw(const problem_t *p, tally_t *t)
{
    double Q[PEL_TRI(AMB_MAX)];
    int64_t N[AMB_MAX];
    problem_pack(p, Q);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ils_init(&ils, p->n, p->a, Q, 2, 200000));
    if (pel_ils_run(&ils, 200000) != PEL_OK) { return; }
    const double needed[4] = {pel_ils_ratio_needed(&ils, 0.01), pel_ils_ratio_needed(&ils, 0.001), 2.0, 3.0};
    TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, 0, N, NULL));
    const bool wrong = memcmp(N, p->truth, sizeof N[0] * (size_t)p->n) != 0;
    t->draws++;
    t->wrong_unchecked += wrong;
    for (int k = 0; k < 4; k++) {
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
    printf("  n        draws  wrong unchecked | fixed, wrong %%: failure <= 1 %%  | <= 0.1 %%       | ratio 2         "
           "| ratio 3\n");
    for (int c = 0; c < CLASSES; c++) {
        tally_t t = {0};
        for (int k = 0; k < 8000; k++) {
            const problem_t p = problem_random(&r, rng_int(&r, limit[c], limit[c + 1] - 1));
            one_draw(&p, &t);
        }
        printf("  %2d..%2d  %6d  %12.1f %%  |", limit[c], limit[c + 1] - 1, t.draws,
               100.0 * t.wrong_unchecked / t.draws);
        for (int k = 0; k < 4; k++) {
            printf("    %5.1f %7.3f |", 100.0 * t.fixed[k] / t.draws, 100.0 * t.wrong[k] / t.draws);
        }
        printf("\n");
        TEST_ASSERT_LESS_OR_EQUAL_DOUBLE(0.01 * t.draws + 2.6 * sqrt(0.01 * t.draws), (double)t.wrong[0]);
        TEST_ASSERT_LESS_OR_EQUAL_DOUBLE(0.001 * t.draws + 2.6 * sqrt(0.001 * t.draws), (double)t.wrong[1]);
        fixed += t.fixed[1];
    }
    TEST_ASSERT_GREATER_THAN(CLASSES * 8000 / 3,
                             fixed); /* a test that refuses everything would also keep its promise */
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
    RUN_TEST(a_strong_model_needs_no_ratio_and_a_weak_one_much);
    return UNITY_END();
}

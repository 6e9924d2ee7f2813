/* build: f32 f64 */
/* Linear maps of states on the factors, against the same maps of a dense covariance. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/math.h"
#include "support_dense.h"
#include "unity.h"

#define TOL (PEL_REAL_DOUBLE ? 1e-12 : 4e-5)

void setUp(void) {}
void tearDown(void) {}

static random_t rng = {7};
static double J[DENSE_MAX][DENSE_MAX];
static double q[DENSE_MAX];

static void identity(int n)
{
    memset(J, 0, sizeof J);
    memset(q, 0, sizeof q);
    for (int i = 0; i < n; i++) { J[i][i] = 1.0; }
}

static void hold_against_dense(dense_t *d, const pel_ud_t *ud, double *worst)
{
    double ex;
    dense_time_update(d, J, q);
    *worst = fmax(*worst, dense_compare(d, ud, &ex));
    *worst = fmax(*worst, ex);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(ud));
}

static void a_state_becomes_a_combination_of_those_behind_it(void)
{
    double worst = 0.0;
    for (int trial = 0; trial < 200; trial++) {
        pel_ud_t ud;
        dense_t d;
        pel_real a[PEL_MAX_STATES];
        const int n = 2 + trial % (PEL_MAX_STATES - 1);
        const int i = (int)random_uniform(&rng, 0.0, (double)n);
        random_filter(&rng, n, &ud, &d);
        identity(n);
        for (int k = 0; k < n; k++) {
            a[k] = (k <= i) ? (pel_real)NAN : (pel_real)random_uniform(&rng, -1.0, 1.0); /* not read up to i */
            J[i][k] = (k <= i) ? 0.0 : (double)a[k];
        }
        q[i] = (double)PEL_R(0.01);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_assign(&ud, i, a, PEL_R(0.01)));
        hold_against_dense(&d, &ud, &worst);
    }
    printf("  200 assignments: %.1e sigma\n", worst);
    TEST_ASSERT_TRUE(worst < TOL);
}

static void sums_signs_and_exchanges_match_the_dense_filter(void)
{
    double worst = 0.0;
    for (int trial = 0; trial < 300; trial++) {
        pel_ud_t ud;
        dense_t d;
        const int n = 2 + trial % (PEL_MAX_STATES - 1);
        const int i = (int)random_uniform(&rng, 0.0, (double)(n - 1));
        const int k = i + 1 + (int)random_uniform(&rng, 0.0, (double)(n - 1 - i));
        random_filter(&rng, n, &ud, &d);
        identity(n);
        if (trial % 3 == 0) {
            J[i][k] = -0.75;
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_combine(&ud, i, k, PEL_R(-0.75)));
        } else if (trial % 3 == 1) {
            J[k][k] = -1.0;
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_negate(&ud, k));
        } else {
            J[i][i] = J[i + 1][i + 1] = 0.0;
            J[i][i + 1] = J[i + 1][i] = 1.0;
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_swap(&ud, i));
        }
        hold_against_dense(&d, &ud, &worst);
    }
    printf("  300 sums, signs and exchanges: %.1e sigma\n", worst);
    TEST_ASSERT_TRUE(worst < TOL);
}

static void a_change_of_reference_loses_nothing(void)
{
    double worst = 0.0;
    for (int trial = 0; trial < 200; trial++) {
        pel_ud_t ud;
        dense_t d;
        const int n = 4 + trial % (PEL_MAX_STATES - 3);
        const int size = 1 + trial % 4;
        const int first = (int)random_uniform(&rng, 0.0, (double)(n - size + 1));
        const int p = first + (int)random_uniform(&rng, 0.0, (double)size);
        random_filter(&rng, n, &ud, &d);
        identity(n);
        for (int k = first; k < first + size; k++) {
            const int from = (k < p) ? k : k + 1;
            J[k][k] = 0.0;
            if (k < first + size - 1) { J[k][from] = 1.0; }
            J[k][p] = -1.0;
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_change_reference(&ud, first, size, p));
        hold_against_dense(&d, &ud, &worst);
    }
    printf("  200 changes of reference: %.1e sigma\n", worst);
    TEST_ASSERT_TRUE(worst < TOL);
}

static void there_and_back_again_is_where_it_was(void)
{
    pel_ud_t ud;
    dense_t d;
    random_filter(&rng, 20, &ud, &d);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_change_reference(&ud, 12, 5, 14)); /* the old reference is now the last, 16 */
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_change_reference(&ud, 12, 5, 16)); /* and the one of 14 is last */
    for (int k = 15; k >= 14; k--) { TEST_ASSERT_EQUAL(PEL_OK, pel_ud_swap(&ud, k)); }
    TEST_ASSERT_TRUE(dense_compare(&d, &ud, NULL) < TOL);
}

static void wrong_indices_are_refused_and_nothing_changes(void)
{
    pel_ud_t ud;
    dense_t d;
    pel_real a[PEL_MAX_STATES] = {PEL_R(0.0)};
    random_filter(&rng, 10, &ud, &d);
    const pel_ud_t before = ud;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_assign(&ud, 10, a, PEL_R(1.0)));
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_assign(&ud, 3, a, PEL_R(0.0)));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_combine(&ud, 4, 4, PEL_R(1.0)));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_combine(&ud, 4, 5, (pel_real)NAN));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_negate(&ud, -1));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_swap(&ud, 9));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_change_reference(&ud, 6, 5, 7));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_change_reference(&ud, 5, 4, 9));
    a[7] = (pel_real)NAN;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_assign(&ud, 3, a, PEL_R(1.0)));
    TEST_ASSERT_EQUAL_MEMORY(&before, &ud, sizeof ud);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_state_becomes_a_combination_of_those_behind_it);
    RUN_TEST(sums_signs_and_exchanges_match_the_dense_filter);
    RUN_TEST(a_change_of_reference_loses_nothing);
    RUN_TEST(there_and_back_again_is_where_it_was);
    RUN_TEST(wrong_indices_are_refused_and_nothing_changes);
    return UNITY_END();
}

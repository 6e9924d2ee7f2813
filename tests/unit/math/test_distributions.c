/* Normal and chi-square distributions against the C library's erfc, published tables and themselves. */
#include <math.h>
#include <stdio.h>

#include "pelorus/math.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void normal_probabilities_hold_in_the_tails(void)
{
    double worst = 0.0;
    for (double x = -37.0; x < 8.0; x += 0.00137) {
        const double want = (double)(0.5L * erfcl(-(long double)x * sqrtl(0.5L)));
        worst = fmax(worst, fabs(pel_normal_cdf(x) / want - 1.0));
    }
    printf("  normal cdf: %.1e relative, -37 < x < 8\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-12);
}

static void normal_quantile_inverts(void)
{
    double worst = 0.0;
    for (double lp = -290.0; lp < -0.31; lp += 0.173) {
        const double p = pow(10.0, lp);
        worst = fmax(worst, fabs(pel_normal_cdf(pel_normal_quantile(p)) / p - 1.0));
        if (p > 1e-9) { worst = fmax(worst, 1e-6 * fabs(pel_normal_quantile(1.0 - p) + pel_normal_quantile(p))); }
    }
    printf("  normal quantile: probability of the answer off by %.1e relative\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-9);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.959963984540054, pel_normal_quantile(0.975));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, pel_normal_quantile(0.5));
    TEST_ASSERT_TRUE(isnan(pel_normal_quantile(0.0)) && isnan(pel_normal_quantile(1.0)));
}

/* scipy.stats.chi2.ppf(p, dof) */
static void chi_square_thresholds_are_those_of_the_tables(void)
{
    static const struct {
        int dof;
        double p, x;
    } table[] = {{1, 0.99, 6.6348966010212145},    {1, 0.999, 10.827566170662733},  {2, 0.99, 9.21034037197618},
                 {3, 0.95, 7.814727903251179},     {15, 0.999, 37.69729821835383},  {30, 0.975, 46.97924224367115},
                 {100, 0.99, 135.80672317102676},  {200, 0.999, 267.5405278227572}, {540, 0.5, 0.0},
                 {18, 0.99999, 55.68290738215997}, {7, 0.999999, 40.52183123411472}};
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        const double got = pel_chi2_threshold(table[i].dof, table[i].p);
        if (table[i].dof > 400) {
            TEST_ASSERT_TRUE(isnan(got));
            continue;
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-6 * table[i].x, table[i].x, got);
    }
    double worst = 0.0;
    for (int dof = 1; dof <= 400; dof++) {
        for (int k = 1; k <= 9; k++) {
            const double tail = pow(10.0, -(double)k);
            const double x = pel_chi2_threshold(dof, 1.0 - tail);
            worst = fmax(worst, fabs(pel_chi2_tail(dof, x) / (1.0 - (1.0 - tail)) - 1.0));
        }
    }
    printf("  chi-square threshold: tail of the answer off by %.1e relative, dof 1..400, p 0.9..1 - 1e-9\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-6);
    TEST_ASSERT_TRUE(isnan(pel_chi2_threshold(0, 0.99)) && isnan(pel_chi2_tail(1, -1.0)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.0, pel_chi2_tail(5, 0.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, exp(-3.0), pel_chi2_tail(2, 6.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, erfc(sqrt(3.0)), pel_chi2_tail(1, 6.0));
}

/* Each argument at both ends of its range and just beyond. */
static void arguments_outside_their_range_have_no_answer(void)
{
    const double nan = (double)NAN;
    static const int DOF_OUT[] = {0, -1, 401, INT32_MAX, INT32_MIN};
    for (size_t i = 0; i < sizeof DOF_OUT / sizeof DOF_OUT[0]; i++) {
        TEST_ASSERT_TRUE(isnan(pel_chi2_tail(DOF_OUT[i], 5.0)));
        TEST_ASSERT_TRUE(isnan(pel_chi2_threshold(DOF_OUT[i], 0.99)));
    }
    static const int DOF_IN[] = {1, 2, 399, 400};
    for (size_t i = 0; i < sizeof DOF_IN / sizeof DOF_IN[0]; i++) {
        const int dof = DOF_IN[i];
        TEST_ASSERT_TRUE(isnan(pel_chi2_tail(dof, -1e-300)) && isnan(pel_chi2_tail(dof, nan)));
        TEST_ASSERT_EQUAL_DOUBLE(1.0, pel_chi2_tail(dof, 0.0));
        TEST_ASSERT_TRUE(pel_chi2_tail(dof, 1400.0) >= 0.0 && pel_chi2_tail(dof, 1400.0) < 1e-60);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, pel_chi2_tail(dof, nextafter(1400.0, 2000.0)));
        TEST_ASSERT_EQUAL_DOUBLE(0.0, pel_chi2_tail(dof, (double)INFINITY));
        TEST_ASSERT_TRUE(isnan(pel_chi2_threshold(dof, 0.5)) && isnan(pel_chi2_threshold(dof, nan)));
        TEST_ASSERT_TRUE(isnan(pel_chi2_threshold(dof, nextafter(1.0 - 1e-9, 1.0))));
        TEST_ASSERT_TRUE(isfinite(pel_chi2_threshold(dof, nextafter(0.5, 1.0))));
        TEST_ASSERT_TRUE(isfinite(pel_chi2_threshold(dof, 1.0 - 1e-9)));
    }
    const double p_out[] = {0.0, -0.1, 1e-300, 1.0, 1.1, nan};
    for (size_t i = 0; i < sizeof p_out / sizeof p_out[0]; i++) {
        TEST_ASSERT_TRUE(isnan(pel_normal_quantile(p_out[i])));
    }
    TEST_ASSERT_TRUE(isfinite(pel_normal_quantile(2e-300)) && isfinite(pel_normal_quantile(nextafter(1.0, 0.0))));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(normal_probabilities_hold_in_the_tails);
    RUN_TEST(normal_quantile_inverts);
    RUN_TEST(chi_square_thresholds_are_those_of_the_tables);
    RUN_TEST(arguments_outside_their_range_have_no_answer);
    return UNITY_END();
}

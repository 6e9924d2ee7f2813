/* Elementary functions against the C library in long double, over wide ranges. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/math.h"
#include "unity.h"

double pel_sqrt_soft(double x);

void setUp(void) {}
void tearDown(void) {}

static uint64_t seed = 88172645463325252ull;

static uint64_t random_bits(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return seed;
}

static double uniform(double lo, double hi)
{
    return lo + (hi - lo) * (double)(random_bits() >> 11) * 0x1p-53;
}

static double from_bits(uint64_t b)
{
    double x;
    memcpy(&x, &b, sizeof x);
    return x;
}

/* |got - want| in units of the last place of want */
static double ulps(double got, long double want)
{
    int e;
    (void)frexp((double)want, &e);
    const long double ulp = ldexpl(1.0L, ((e - 53) < -1074) ? -1074 : e - 53);
    return (double)(fabsl((long double)got - want) / ulp);
}

typedef double (*function_t)(double);
typedef long double (*reference_t)(long double);

static double worst_ulps(function_t f, reference_t ref, double lo, double hi, int n)
{
    double worst = 0.0;
    for (int i = 0; i < n; i++) {
        const double x = uniform(lo, hi);
        const double u = ulps(f(x), ref((long double)x));
        if (u > worst) { worst = u; }
    }
    return worst;
}

static void square_root_is_correctly_rounded_in_software_too(void)
{
    for (int i = 0; i < 300000; i++) {
        const double x = from_bits(random_bits() & UINT64_C(0x7FFFFFFFFFFFFFFF));
        if (!isfinite(x)) { continue; }
        const double want = sqrt(x);
        const double a = pel_sqrt(x);
        const double b = pel_sqrt_soft(x);
        if (a != want || b != want) { TEST_FAIL_MESSAGE("square root differs from the processor's"); }
    }
    for (int k = 1; k < 20000; k++) { /* perfect squares and their neighbours, subnormals */
        const double s = (double)k * (double)k;
        TEST_ASSERT_TRUE(pel_sqrt_soft(s) == (double)k);
        TEST_ASSERT_TRUE(pel_sqrt_soft(nextafter(s, 0.0)) == sqrt(nextafter(s, 0.0)));
        TEST_ASSERT_TRUE(pel_sqrt_soft((double)k * 5e-324) == sqrt((double)k * 5e-324));
    }
    TEST_ASSERT_TRUE(isnan(pel_sqrt_soft(-1.0)) && isnan(pel_sqrt(-1.0)) && isnan(pel_sqrt_soft((double)NAN)));
    TEST_ASSERT_TRUE(pel_sqrt_soft(0.0) == 0.0 && isinf(pel_sqrt_soft((double)INFINITY)));
    TEST_ASSERT_TRUE(pel_sqrtr(PEL_R(9.0)) == PEL_R(3.0));
}

static void rounding_is_exact(void)
{
    for (int i = 0; i < 200000; i++) {
        const double x = uniform(-1.0, 1.0) * pow(10.0, uniform(-3.0, 17.0));
        TEST_ASSERT_TRUE(pel_floor(x) == floor(x));
        TEST_ASSERT_TRUE(pel_round(x) == round(x));
    }
    const double edge[] = {0.5,  -0.5, 1.5, 2.5, 0.49999999999999994, -0.49999999999999994, 4503599627370495.5,
                           -0.0, 1e300};
    for (size_t i = 0; i < sizeof edge / sizeof edge[0]; i++) {
        TEST_ASSERT_TRUE(pel_round(edge[i]) == round(edge[i]));
        TEST_ASSERT_TRUE(pel_floor(edge[i]) == floor(edge[i]));
    }
}

static void sine_and_cosine_within_one_ulp(void)
{
    double worst = 0.0;
    double worst_abs = 0.0;
    const double range[] = {0.8, 3.2, 100.0, 1e4, 1e6};
    for (int k = 0; k < 5; k++) {
        for (int i = 0; i < 200000; i++) {
            const double x = uniform(-range[k], range[k]);
            double s;
            double c;
            pel_sincos(x, &s, &c);
            worst = fmax(worst, fmax(ulps(s, sinl((long double)x)), ulps(c, cosl((long double)x))));
            worst_abs =
                fmax(worst_abs, (double)fmaxl(fabsl(s - sinl((long double)x)), fabsl(c - cosl((long double)x))));
        }
    }
    printf("  sin, cos: %.3f ulp, %.2e absolute, |x| <= 1e6\n", worst, worst_abs);
    TEST_ASSERT_TRUE(worst < 1.0);
    TEST_ASSERT_TRUE(worst_abs < 1.2e-16);

    double near_zero = 0.0; /* near multiples of pi/2, where all leading digits cancel */
    for (int n = 1; n < 600000; n += 7) {
        const double x = (double)n * 1.57079632679489661923;
        const double e = (n % 2 == 0) ? ulps(pel_sin(x), sinl((long double)x)) : ulps(pel_cos(x), cosl((long double)x));
        near_zero = fmax(near_zero, e);
    }
    printf("  sin, cos next to their zeros: %.3f ulp\n", near_zero);
    TEST_ASSERT_TRUE(near_zero < 1.0);
    TEST_ASSERT_TRUE(isnan(pel_sin(1.1e6)) && isnan(pel_cos((double)NAN)) && isnan(pel_sin((double)INFINITY)));
}

static void arc_functions_within_two_ulp(void)
{
    double worst = 0.0;
    for (int i = 0; i < 600000; i++) {
        const double scale = pow(10.0, uniform(-12.0, 12.0));
        const double y = uniform(-1.0, 1.0) * ((i & 1) ? scale : 1.0);
        const double x = uniform(-1.0, 1.0);
        worst = fmax(worst, ulps(pel_atan2(y, x), atan2l((long double)y, (long double)x)));
    }
    printf("  atan2 %.3f ulp", worst);
    TEST_ASSERT_TRUE(worst < 1.5);
    const double as =
        fmax(worst_ulps(pel_asin, asinl, -1.0, 1.0, 200000), worst_ulps(pel_asin, asinl, 0.999, 1.0, 100000));
    const double ac =
        fmax(worst_ulps(pel_acos, acosl, -1.0, 1.0, 200000), worst_ulps(pel_acos, acosl, 0.999, 1.0, 100000));
    printf(", asin %.3f, acos %.3f\n", as, ac);
    TEST_ASSERT_TRUE(as < 2.0 && ac < 2.0);

    TEST_ASSERT_TRUE(pel_atan2(0.0, 0.0) == 0.0 && pel_atan2(0.0, -1.0) == PEL_PI &&
                     pel_atan2(-1.0, 0.0) == -0.5 * PEL_PI);
    TEST_ASSERT_TRUE(pel_atan2(1e308, 1e308) == 0.25 * PEL_PI && pel_atan2(1e-310, 1e-310) == 0.25 * PEL_PI);
    /* rounding may have carried a cosine just past its end */
    TEST_ASSERT_TRUE(pel_asin(1.0 + 1e-15) == 0.5 * PEL_PI && pel_asin(-1.0 - 1e-15) == -0.5 * PEL_PI);
    TEST_ASSERT_TRUE(pel_acos(-1.5) == PEL_PI && pel_acos(1.0) == 0.0 && pel_acos(1.0 + 1e-15) == 0.0);
    TEST_ASSERT_TRUE(isnan(pel_atan2((double)NAN, 1.0)) && isnan(pel_asin((double)NAN)));
}

static void exponential_and_logarithm_within_one_ulp(void)
{
    const double e =
        fmax(worst_ulps(pel_exp, expl, -700.0, 709.0, 300000), worst_ulps(pel_exp, expl, -1.0, 1.0, 300000));
    const double l =
        fmax(worst_ulps(pel_log, logl, 1e-300, 1e300, 200000),
             fmax(worst_ulps(pel_log, logl, 0.5, 2.0, 300000), worst_ulps(pel_log, logl, 0.99, 1.01, 300000)));
    printf("  exp %.3f ulp, log %.3f ulp\n", e, l);
    TEST_ASSERT_TRUE(e < 1.0 && l < 1.0);
    TEST_ASSERT_TRUE(pel_exp(0.0) == 1.0 && pel_exp(-800.0) == 0.0 && isinf(pel_exp(710.0)) &&
                     isnan(pel_exp((double)NAN)));
    TEST_ASSERT_TRUE(pel_log(1.0) == 0.0 && isinf(pel_log(0.0)) && isnan(pel_log(-1.0)));
    TEST_ASSERT_TRUE(ulps(pel_log(4e-320), logl((long double)4e-320)) < 1.0);
}

static void angles_wrap_into_half_a_turn(void)
{
    for (int i = 0; i < 100000; i++) {
        const double x = uniform(-1000.0, 1000.0);
        const double y = pel_wrap_pi(x);
        TEST_ASSERT_TRUE(y > -PEL_PI - 1e-12 && y <= PEL_PI + 1e-12);
        TEST_ASSERT_TRUE(fabs(sin(x) - sin(y)) < 1e-12 && fabs(cos(x) - cos(y)) < 1e-12);
    }
    TEST_ASSERT_TRUE(pel_wrap_pi(PEL_PI) == PEL_PI &&
                     pel_wrap_pi(-PEL_PI) == PEL_PI); /* one end belongs, the other not */
    TEST_ASSERT_TRUE(pel_isfinite(1e308) && !pel_isfinite((double)INFINITY) && !pel_isfinite((double)NAN));
    TEST_ASSERT_TRUE(pel_isfiniter(PEL_R(1e30)) && !pel_isfiniter((pel_real)INFINITY) && !pel_isfiniter((pel_real)NAN));
}

/* The same bits on every machine: a hash over many results, which a build elsewhere must repeat. */
static void results_have_the_committed_bits(void)
{
    uint64_t h = 14695981039346656037ull;
    for (int i = 0; i < 20000; i++) {
        const double x = ((double)i - 10000.0) * 0.0371;
        double out[6];
        pel_sincos(x, &out[0], &out[1]);
        out[2] = pel_atan2(x, 1.7 - 0.01 * x);
        out[3] = pel_exp(0.05 * x);
        out[4] = pel_log(1.0 + x * x);
        out[5] = pel_sqrt(x * x + 0.3);
        for (int k = 0; k < 6; k++) {
            uint64_t b;
            memcpy(&b, &out[k], sizeof b);
            h = (h ^ b) * 1099511628211ull;
        }
    }
    printf("  hash of 120 000 results: %016llx\n", (unsigned long long)h);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x6D5BD82A45F4363E), h);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(square_root_is_correctly_rounded_in_software_too);
    RUN_TEST(rounding_is_exact);
    RUN_TEST(sine_and_cosine_within_one_ulp);
    RUN_TEST(arc_functions_within_two_ulp);
    RUN_TEST(exponential_and_logarithm_within_one_ulp);
    RUN_TEST(angles_wrap_into_half_a_turn);
    RUN_TEST(results_have_the_committed_bits);
    return UNITY_END();
}

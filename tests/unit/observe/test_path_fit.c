/* Drift of a pair of satellites: the polynomial, the rule on its order, and the rate's sigma against what a random walk really does. */
#include <math.h>
#include <stdio.h>

#include "pelorus/observe.h"
#include "unity.h"

#define WALK  2e-4 /* of one satellite's path, m/sqrt(s) */
#define WHITE 3e-3 /* of one phase, m */

void setUp(void) {}
void tearDown(void) {}

static uint64_t state = 88172645463325252u;

static double uniform(void)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return ((double)(state >> 11) + 0.5) * 0x1p-53;
}

static double normal(void)
{
    return sqrt(-2.0 * log(uniform())) * cos(6.283185307179586 * uniform());
}

/* A static segment of T seconds at 10 Hz; the walk's value where it ends goes out. */
static void segment(pel_path_fit_t *f, double T, const double p[3], double walk_m, double white_m)
{
    double walk = 0.0;
    pel_path_fit_init(f);
    for (int k = 0; k <= (int)(10.0 * T); k++) {
        const double t = 0.1 * k;
        walk += walk_m * sqrt(2.0 * 0.1) * normal();
        pel_path_fit_add(f, 5000.0 + t, p[0] + t * (p[1] + t * p[2]) + walk + white_m * 1.4142135623730951 * normal());
    }
}

static void a_polynomial_without_noise_is_found_again(void)
{
    const double p[3] = {3.2e7, 2e-3, 4e-6};
    pel_path_fit_t f;
    pel_path_t fit;
    segment(&f, 300.0, p, 0.0, 0.0);
    TEST_ASSERT_EQUAL(PEL_OK, pel_path_fit_solve(&f, WALK, &fit));
    TEST_ASSERT_EQUAL_INT(2, fit.order);
    TEST_ASSERT_DOUBLE_WITHIN(1e-7, p[0], fit.p[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, p[1], fit.p[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-11, p[2], fit.p[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, p[0] + 1000.0 * p[1] + 1e6 * p[2], pel_path_at(&fit, 6000.0));
}

/* S3 section 7: p2 = 3e-8 m/s^2 is not worth an order within 300 s, is after 600 s; a strong one always. */
static void the_order_follows_length_and_significance(void)
{
    const double weak[3] = {0.0, 1e-4, 3e-8}, strong[3] = {0.0, 1e-4, 2e-6};
    pel_path_fit_t f;
    pel_path_t fit;
    int second = 0;
    for (int run = 0; run < 100; run++) {
        segment(&f, 300.0, weak, WALK, WHITE);
        TEST_ASSERT_EQUAL(PEL_OK, pel_path_fit_solve(&f, WALK, &fit));
        second += (fit.order == 2) ? 1 : 0;
    }
    TEST_ASSERT_LESS_OR_EQUAL_INT(3, second);
    segment(&f, 300.0, strong, WALK, WHITE);
    TEST_ASSERT_EQUAL(PEL_OK, pel_path_fit_solve(&f, WALK, &fit));
    TEST_ASSERT_EQUAL_INT(2, fit.order);
    segment(&f, 600.0, weak, WALK, WHITE);
    TEST_ASSERT_EQUAL(PEL_OK, pel_path_fit_solve(&f, WALK, &fit));
    TEST_ASSERT_EQUAL_INT(2, fit.order);
}

/* 400 segments without drift: the fitted rate's spread is the sigma said, first and second order. The walk is made strong enough to pass the
 * prior's floor. */
static void the_sigma_of_the_rate_is_what_the_walk_does(void)
{
    const double length[2] = {100.0, 620.0}, none[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 2; k++) {
        double sum = 0.0, said = 0.0;
        for (int run = 0; run < 400; run++) {
            pel_path_fit_t f;
            pel_path_t fit;
            segment(&f, length[k], none, 20.0 * WALK, WHITE);
            TEST_ASSERT_EQUAL(PEL_OK, pel_path_fit_solve(&f, 20.0 * WALK, &fit));
            const double rate = fit.p[1] + 2.0 * fit.p[2] * length[k];
            sum += rate * rate;
            said += fit.sd_rate_mps * fit.sd_rate_mps;
        }
        printf("  %3.0f s: rate %.2e m/s rms, said %.2e\n", length[k], sqrt(sum / 400.0), sqrt(said / 400.0));
        TEST_ASSERT_DOUBLE_WITHIN(0.15, 1.0, sqrt(sum / said));
    }
}

static void what_cannot_be_fitted_is_refused(void)
{
    const double p[3] = {1.0, 1e-3, 0.0};
    pel_path_fit_t f;
    pel_path_t fit = {.order = 7};
    segment(&f, 59.0, p, WALK, WHITE);
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_path_fit_solve(&f, WALK, &fit));
    pel_path_fit_init(&f);
    for (int k = 0; k < 200; k++) { pel_path_fit_add(&f, (k == 199) ? 100.0 : 1e-3 * k, 0.0); } /* all at one end */
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_path_fit_solve(&f, WALK, &fit));
    pel_path_fit_init(&f);
    for (int k = 0; k < 20; k++) { pel_path_fit_add(&f, 5.0 * k, 0.0); } /* few */
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_path_fit_solve(&f, WALK, &fit));
    pel_path_fit_init(&f);
    for (int k = 0; k < 40; k++) { pel_path_fit_add(&f, 100.0 * (k % 2), 0.0); } /* at two instants: no parabola */
    pel_path_fit_add(&f, 100.0, 0.0);
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_path_fit_solve(&f, WALK, &fit));
    TEST_ASSERT_EQUAL_INT(7, fit.order);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_polynomial_without_noise_is_found_again);
    RUN_TEST(the_order_follows_length_and_significance);
    RUN_TEST(the_sigma_of_the_rate_is_what_the_walk_does);
    RUN_TEST(what_cannot_be_fitted_is_refused);
    return UNITY_END();
}

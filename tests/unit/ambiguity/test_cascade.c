/* test_cascade.c - wide-lane, then narrow-lane integers on longer baselines, beside the joint search. */
/* build: f32 f64 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelorus/ambiguity_methods.h"
#include "support_scene.h"
#include "unity.h"

static pel_ils_t ils;
static pel_amb_cascade_t cascade;
static int draws = 500;

void setUp(void) {}
void tearDown(void) {}

/* Two systems on two carriers; 1.4 mm of single-difference ionosphere a kilometre. */
static scene_case_t baseline(double km, double sd_prior)
{
    return (scene_case_t){.n_sys = 2,
                          .n_sat = 9,
                          .n_carrier = 2,
                          .one_carrier = 0.1,
                          .sd_code = 0.4,
                          .sd_phase = 0.003,
                          .sd_low = 0.002,
                          .sd_iono = 1.4e-3 * km,
                          .sd_prior = sd_prior};
}

typedef struct {
    int joint, joint_wrong;
    int wide, wide_wrong, narrow, narrow_wrong;
    int wide_only;             /* fixed wide where the joint search is refused */
    double wide_sq, narrow_sq; /* squared position errors */
    double wide_d2, narrow_d2; /* the same in their own covariance */
    long wide_integers, narrow_integers;
} tally_t;

static bool wide_right(const scene_t *e)
{
    for (int k = 0; k < cascade.n_pairs; k++) {
        if (cascade.is_wide[k] && cascade.N_wide[k] != e->truth[cascade.row1[k]] - e->truth[cascade.row2[k]]) {
            return false;
        }
    }
    return true;
}

static bool narrow_right(const scene_t *e, const int64_t *N)
{
    for (int i = 0; i < e->problem.n_rows; i++) {
        if (((cascade.fixed >> i) & 1u) != 0 && N[i] != e->truth[i]) { return false; }
    }
    return true;
}

static double position_error(const scene_t *e, double *d2)
{
    double L[3][3] = {{0}}, y[3];
    double sq = 0.0;
    *d2 = 0.0;
    for (int i = 0; i < 3; i++) {
        y[i] = cascade.b[i] - e->b[i];
        sq += y[i] * y[i];
        for (int j = 0; j <= i; j++) {
            double sum = cascade.P_b[i][j];
            for (int k = 0; k < j; k++) { sum -= L[i][k] * L[j][k]; }
            L[i][j] = (i == j) ? sqrt(sum) : sum / L[j][j];
        }
        for (int k = 0; k < i; k++) { y[i] -= L[i][k] * y[k]; }
        y[i] /= L[i][i];
        *d2 += y[i] * y[i];
    }
    return sq;
}

static tally_t run(const scene_case_t *c, const pel_int_limits_t *limits, uint64_t seed)
{
    tally_t t = {0};
    rng_t r = {seed};
    for (int i = 0; i < draws; i++) {
        const scene_t e = scene_draw(c, &r);
        pel_amb_problem_t p = e.problem;
        int64_t N[PEL_MAX_AMB];
        pel_int_verdict_t v;
        double d2;
        const bool joint = pel_amb_resolve(&p, &ils, limits, 10000, 8, N, &v) == PEL_OK;
        t.joint += joint;
        t.joint_wrong += joint && !scene_right(&e, &p, N);

        const pel_status_t status = pel_amb_cascade(&cascade, &e.problem, &ils, limits, 10000, 8, N);
        TEST_ASSERT_EQUAL(status == PEL_OK, cascade.level == PEL_CASCADE_NARROW);
        if (cascade.level == PEL_CASCADE_NONE) { continue; }
        t.wide++;
        t.wide_integers += cascade.n_wide;
        t.wide_only += !joint;
        const bool right = wide_right(&e);
        t.wide_wrong += !right;
        if (status == PEL_OK) {
            t.narrow++;
            t.narrow_integers += cascade.n_narrow;
            t.narrow_wrong += !narrow_right(&e, N);
            t.narrow_sq += position_error(&e, &d2);
            t.narrow_d2 += d2;
        } else if (right) {
            t.wide_sq += position_error(&e, &d2);
            t.wide_d2 += d2;
        }
    }
    return t;
}

/* Of all epochs at most `rate` wrong, within 99.5 % of a binomial. */
static void expect_at_most(int wrong, double rate)
{
    TEST_ASSERT_LESS_OR_EQUAL_DOUBLE(rate * draws + 2.6 * sqrt(rate * draws), (double)wrong);
}

static double mean(double sum, int n)
{
    return (n > 0) ? sum / n : 0.0;
}

static void print_case(double km, bool prior, const tally_t *t)
{
    const double percent = 100.0 / draws;
    const int wide_only = t->wide - t->narrow;
    printf("    %2.0f km%s | %5.1f %4.1f | %5.1f %4.1f %4.1f, %5.1f | %5.1f %4.1f %4.1f | %.2f %.3f\n", km,
           prior ? ", prior 0.1 m" : "             ", percent * t->joint, percent * t->joint_wrong, percent * t->wide,
           percent * t->wide_wrong, mean((double)t->wide_integers, t->wide), percent * t->wide_only,
           percent * t->narrow, percent * t->narrow_wrong, mean((double)t->narrow_integers, t->narrow),
           sqrt(mean(t->wide_sq, wide_only)), sqrt(mean(t->narrow_sq, t->narrow)));
}

/* Wrong fixes of joint search, wide lanes and narrow lanes stay below `rate` of all epochs. out: [prior][10, 20, 40, 60 km]. */
static void compare(const char *what, const pel_int_limits_t *limits, double rate, tally_t out[2][4])
{
    static const double km[] = {10, 20, 40, 60};
    printf(
        "  %s, %d draws each, %%: joint fixed, wrong | wide fixed, wrong, satellites, fixed where joint is refused | "
        "narrow fixed, wrong, satellites | position rms where only wide, where narrow, m\n",
        what, draws);
    for (int prior = 0; prior < 2; prior++) {
        for (int k = 0; k < 4; k++) {
            const scene_case_t c = baseline(km[k], prior ? 0.1 : 0.0);
            const tally_t t = run(&c, limits, (uint64_t)(900 + 10 * prior + k));
            print_case(km[k], prior, &t);
            expect_at_most(t.joint_wrong, rate);
            expect_at_most(t.wide_wrong, rate);
            expect_at_most(t.narrow_wrong, rate);
            if (t.narrow > draws / 5) {
                TEST_ASSERT_DOUBLE_WITHIN(0.8, 3.0, t.narrow_d2 / t.narrow);
            } /* honest covariance */
            out[prior][k] = t;
        }
    }
}

static void the_cascade_fixes_wide_lanes_where_the_joint_search_is_refused(void)
{
    tally_t t[2][4];
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    compare("default limits", &limits, 0.005, t);
    for (int prior = 0; prior < 2; prior++) {
        TEST_ASSERT_GREATER_THAN(draws * 98 / 100, t[prior][0].narrow);
        TEST_ASSERT_GREATER_THAN(draws * 98 / 100, t[prior][1].wide);
        TEST_ASSERT_GREATER_THAN(t[prior][1].joint + draws * 3 / 10, t[prior][1].narrow);
    }
    TEST_ASSERT_GREATER_THAN(draws * 95 / 100, t[1][2].wide);
    limits.ratio_min = 1.0;
    limits.success_min = 0.5;
    limits.failure_max = 0.001;
    compare("failure rate 0.1 % instead of a ratio", &limits, 0.001, t);
    TEST_ASSERT_GREATER_THAN(draws * 90 / 100, t[1][2].wide);
}

static void slices_and_the_order_of_carriers_do_not_matter(void)
{
    rng_t r = {91};
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    const scene_case_t c = {.n_sys = 1,
                            .n_sat = 9,
                            .n_carrier = 2,
                            .one_carrier = 0.1,
                            .sd_code = 0.3,
                            .sd_phase = 0.003,
                            .sd_iono = 0.01,
                            .sd_prior = 0.1};
    int narrow = 0;
    for (int t = 0; t < 200; t++) {
        static pel_amb_cascade_t sliced;
        const scene_t e = scene_draw(&c, &r);
        int64_t N[PEL_MAX_AMB] = {0}, N_sliced[PEL_MAX_AMB] = {0};
        const pel_status_t status = pel_amb_cascade(&cascade, &e.problem, &ils, &limits, 10000, 8, N);
        TEST_ASSERT_EQUAL(PEL_OK, pel_amb_cascade_begin(&sliced, &e.problem, &limits, 10000, 8));
        pel_status_t s;
        do {
            s = pel_amb_cascade_step(&sliced, &e.problem, &ils, 3, N_sliced);
        } while (s == PEL_W_RUNNING);
        TEST_ASSERT_EQUAL(status, s);
        TEST_ASSERT_EQUAL_UINT8(cascade.level, sliced.level);
        TEST_ASSERT_TRUE(cascade.fixed == sliced.fixed);
        TEST_ASSERT_EQUAL_MEMORY(cascade.N_wide, sliced.N_wide, sizeof sliced.N_wide);
        TEST_ASSERT_EQUAL_MEMORY(cascade.b, sliced.b, sizeof sliced.b);
        TEST_ASSERT_EQUAL_INT(cascade.narrow.reason, sliced.narrow.reason);
        TEST_ASSERT_EQUAL_MEMORY(N, N_sliced, sizeof N);
        TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_amb_cascade_step(&sliced, &e.problem, &ils, 3, N_sliced));
        narrow += status == PEL_OK;

        pel_amb_problem_t p = e.problem; /* the lower frequency first */
        const int n2 = p.n_rows - 8;
        p.group[0] = e.problem.group[1];
        p.group[1] = e.problem.group[0];
        for (int i = 0; i < p.n_rows; i++) {
            p.row[i] = e.problem.row[(i < n2) ? 8 + i : i - n2];
            p.row[i].group = i >= n2;
        }
        TEST_ASSERT_EQUAL(status, pel_amb_cascade(&cascade, &p, &ils, &limits, 10000, 8, N_sliced));
        for (int i = 0; i < p.n_rows && status == PEL_OK; i++) {
            TEST_ASSERT_EQUAL_INT64(N[(i < n2) ? 8 + i : i - n2], N_sliced[i]);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, sliced.b[0], cascade.b[0]);
    }
    TEST_ASSERT_GREATER_THAN(100, narrow);
}

static void without_pairs_there_is_no_cascade(void)
{
    rng_t r = {92};
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    const scene_case_t c = {.n_sys = 1, .n_sat = 9, .n_carrier = 1, .sd_code = 0.3, .sd_phase = 0.003};
    scene_t e = scene_draw(&c, &r);
    int64_t N[PEL_MAX_AMB] = {7};
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_amb_cascade(&cascade, &e.problem, &ils, &limits, 1000, 8, N));
    TEST_ASSERT_EQUAL_INT64(7, N[0]);
    TEST_ASSERT_EQUAL(PEL_CASCADE_NONE, cascade.level);
    e.problem.row[3].group = 9;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_amb_cascade(&cascade, &e.problem, &ils, &limits, 1000, 8, N));
    const scene_case_t two = {.n_sys = 1, .n_sat = 9, .n_carrier = 2, .sd_code = 0.3, .sd_phase = 0.003};
    e = scene_draw(&two, &r);
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_amb_cascade(&cascade, &e.problem, &ils, &limits, 0, 8, N));
    e.problem.row[2].phase_m = NAN;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_amb_cascade(&cascade, &e.problem, &ils, &limits, 1000, 8, N));
    TEST_ASSERT_EQUAL(PEL_INT_NOT_TRIED, cascade.wide.reason);
}

int main(int argc, char **argv)
{
    if (argc > 1) { draws = atoi(argv[1]); }
    UNITY_BEGIN();
    RUN_TEST(slices_and_the_order_of_carriers_do_not_matter);
    RUN_TEST(without_pairs_there_is_no_cascade);
    RUN_TEST(the_cascade_fixes_wide_lanes_where_the_joint_search_is_refused);
    return UNITY_END();
}

/* test_resolve.c - one epoch's integers in slices, and what solving for fewer of them gains. */
/* build: f32 f64 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelorus/ambiguity.h"
#include "support_scene.h"
#include "unity.h"

static pel_ils_t ils;
static int draws = 500;

void setUp(void) {}
void tearDown(void) {}

static const char *const subset_name[] = {"all",          "without suspect",  "agreed",
                                          "two carriers", "without noisiest", "without system"};
#define SUBSETS   6
#define WRONG_MAX 0.001 /* of all epochs, whatever their subsets */

/* Epochs of every kind: one to three systems, one or two carriers, short and long baselines, with a bad satellite now and then. */
static scene_t any_scene(rng_t *r)
{
    const int n_sys = rng_int(r, 1, 3);
    scene_case_t c = {.n_sys = n_sys,
                      .n_sat = rng_int(r, (n_sys == 1) ? 5 : 4, 7),
                      .n_carrier = rng_int(r, 1, 2),
                      .one_carrier = 0.3 * rng_uniform(r),
                      .sd_code = 0.3 + rng_uniform(r),
                      .sd_phase = 0.002 + 0.003 * rng_uniform(r),
                      .sd_low = 0.01 * rng_uniform(r) * rng_uniform(r),
                      .sd_iono = 0.02 * rng_uniform(r) * rng_uniform(r),
                      .sd_prior = (rng_uniform(r) < 0.5) ? 0.05 + rng_uniform(r) : 0.0};
    scene_t e = scene_draw(&c, r);
    if (rng_uniform(r) < 0.25) {
        pel_amb_row_t *bad = &e.problem.row[rng_int(r, 0, e.problem.n_rows - 1)];
        bad->phase_m += 0.5 * bad->lambda_m;
    }
    return e;
}

typedef struct {
    pel_status_t status;
    pel_amb_problem_t p;
    int64_t N[PEL_MAX_AMB];
    pel_int_verdict_t v;
    int steps;
} result_t;

static void resolve_in_slices(const scene_t *e, int32_t max_nodes, int32_t budget, int tries, result_t *out)
{
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    memset(out, 0, sizeof *out);
    out->p = e->problem;
    pel_amb_resolver_t r;
    TEST_ASSERT_EQUAL(PEL_OK, pel_amb_resolve_begin(&r, &out->p, &limits, budget, tries));
    do {
        const int32_t before = ils.nodes;
        const bool searching = ils.stage == PEL_ILS_SEARCHING;
        out->status = pel_amb_resolve_step(&r, &out->p, &ils, max_nodes, out->N, &out->v);
        if (searching && ils.nodes > before) { TEST_ASSERT_LESS_OR_EQUAL_INT32(max_nodes, ils.nodes - before); }
        out->steps++;
    } while (out->status == PEL_W_RUNNING);
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_amb_resolve_step(&r, &out->p, &ils, max_nodes, out->N, &out->v));
}

static void slices_give_what_one_call_gives(void)
{
    static const int32_t slice[] = {1, 7, 100};
    static result_t once, cut;
    int by_subset[SUBSETS] = {0};
    int refused = 0;
    long steps[3] = {0};
    rng_t r = {61};
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    const int n = 1500;
    for (int t = 0; t < n; t++) {
        const scene_t e = any_scene(&r);
        const int32_t budget = (t % 5 == 0) ? 60 : 5000;
        memset(&once, 0, sizeof once);
        once.p = e.problem;
        once.status = pel_amb_resolve(&once.p, &ils, &limits, budget, 8, once.N, &once.v);
        if (once.status == PEL_OK) { by_subset[once.v.subset]++; }
        refused += once.status == PEL_W_REJECTED;
        for (int k = 0; k < 3; k++) {
            resolve_in_slices(&e, slice[k], budget, 8, &cut);
            steps[k] += cut.steps;
            TEST_ASSERT_EQUAL(once.status, cut.status);
            TEST_ASSERT_EQUAL_MEMORY(once.N, cut.N, sizeof once.N);
            TEST_ASSERT_EQUAL_MEMORY(&once.p, &cut.p, sizeof once.p);
            TEST_ASSERT_EQUAL_INT(once.v.reason, cut.v.reason);
            TEST_ASSERT_EQUAL_UINT16(once.v.failed, cut.v.failed);
            TEST_ASSERT_EQUAL_INT(once.v.subset, cut.v.subset);
            TEST_ASSERT_EQUAL_INT(once.v.n_integers, cut.v.n_integers);
            TEST_ASSERT_EQUAL_MEMORY(&once.v.ratio, &cut.v.ratio, sizeof(double));
            TEST_ASSERT_EQUAL_MEMORY(&once.v.chi2, &cut.v.chi2, sizeof(double));
        }
    }
    printf("  %d problems, steps in slices of 1, 7, 100 nodes: %ld, %ld, %ld; refused %d; fixed:\n", n, steps[0],
           steps[1], steps[2], refused);
    for (int k = 0; k < SUBSETS; k++) { printf("    %-17s %d\n", subset_name[k], by_subset[k]); }
    printf("  resolver %u bytes\n", (unsigned)sizeof(pel_amb_resolver_t));
    TEST_ASSERT_GREATER_THAN(100, refused);

    for (int k = 0; k < SUBSETS; k++) { TEST_ASSERT_GREATER_THAN(2, by_subset[k]); }
}

static void a_refused_problem_is_left_as_it_was(void)
{
    rng_t r = {62};
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    limits.ratio_min = 1e12;
    for (int t = 0; t < 100; t++) {
        const scene_t e = any_scene(&r);
        pel_amb_problem_t p = e.problem;
        int64_t N[PEL_MAX_AMB] = {7};
        pel_int_verdict_t v;
        TEST_ASSERT_EQUAL(PEL_W_REJECTED, pel_amb_resolve(&p, &ils, &limits, 3000, 8, N, &v));
        TEST_ASSERT_EQUAL_MEMORY(&e.problem, &p, sizeof p);
        TEST_ASSERT_EQUAL_INT64(7, N[0]);
        TEST_ASSERT_EQUAL_INT(PEL_AMB_ALL, v.subset);
        TEST_ASSERT_EQUAL_INT(e.problem.n_rows, v.n_asked);
    }
    scene_t e = any_scene(&r);
    pel_amb_resolver_t resolver;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_amb_resolve_begin(&resolver, &e.problem, &limits, 0, 8));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_amb_resolve_begin(&resolver, &e.problem, &limits, 100, 0));
    e.problem.n_rows = PEL_MAX_AMB + 1;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_amb_resolve_begin(&resolver, &e.problem, &limits, 100, 8));
}

/* ---- bad pivots ------------------------------------------------------------------------------------------------------ */

/* Half a cycle on the pivot of a system bends its whole group: no satellite left out helps, the system must go. Two such systems of three
 * are too many for this plan. */
static void a_bad_pivot_takes_its_system_out(void)
{
    const scene_case_t c = {.n_sys = 3, .n_sat = 7, .n_carrier = 2, .sd_code = 0.3, .sd_phase = 0.003, .sd_prior = 0.1};
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    rng_t r = {63};
    const int n = 300;
    for (int bad = 1; bad <= 2; bad++) {
        int fixed = 0, without = 0, wrong = 0;
        for (int t = 0; t < n; t++) {
            scene_t e = scene_draw(&c, &r);
            for (int i = 0; i < e.problem.n_rows; i++) {
                pel_amb_row_t *row = &e.problem.row[i];
                if (row->group == 0 || (row->group == 2 && bad == 2)) { row->phase_m += 0.5 * row->lambda_m; }
            }
            int64_t N[PEL_MAX_AMB];
            pel_int_verdict_t v;
            if (pel_amb_resolve(&e.problem, &ils, &limits, 20000, 8, N, &v) != PEL_OK) { continue; }
            fixed++;
            without += v.subset == PEL_AMB_WITHOUT_SYSTEM && v.subset_index == 0;
            wrong += !scene_right(&e, &e.problem, N);
        }
        printf("  half a cycle on %d pivots of three: fixed %d of %d, %d without the first's system, wrong %d\n", bad,
               fixed, n, without, wrong);
        TEST_ASSERT_EQUAL_INT(0, wrong);
        if (bad == 1) { TEST_ASSERT_GREATER_THAN(n * 95 / 100, without); }
    }
}

/* ---- partial fixing ----------------------------------------------------------------------------------------------- */

typedef struct {
    int fixed, wrong;
    int by_subset[SUBSETS], wrong_by_subset[SUBSETS];
    long integers;
} tally_t;

static tally_t tally(const scene_case_t *c, const pel_int_limits_t *limits, int tries, uint64_t seed)
{
    tally_t t = {0};
    rng_t r = {seed};
    for (int i = 0; i < draws; i++) {
        const scene_t e = scene_draw(c, &r);
        pel_amb_problem_t p = e.problem;
        int64_t N[PEL_MAX_AMB];
        pel_int_verdict_t v;
        if (pel_amb_resolve(&p, &ils, limits, 10000, tries, N, &v) != PEL_OK) { continue; }
        TEST_ASSERT_EQUAL_INT(pel_amb_count(&p), v.n_integers);
        const bool wrong = !scene_right(&e, &p, N);
        t.fixed++;
        t.wrong += wrong;
        t.by_subset[v.subset]++;
        t.wrong_by_subset[v.subset] += wrong;
        t.integers += v.n_integers;
    }
    return t;
}

static const struct {
    const char *name;
    scene_case_t c;
} cases[] = {
    {"1 system, L1, prior 0.3 m, low noisy", {1, 10, 1, 0, 0.4, 0.003, 0.010, 0.002, 0.3}},
    {"2 systems, L1, low noisy            ", {2, 8, 1, 0, 0.5, 0.003, 0.008, 0.002, 0}},
    {"2 systems, L1+L2, low noisy         ", {2, 7, 2, 0.3, 0.5, 0.003, 0.015, 0.003, 0}},
    {"3 systems, L1+L2                    ", {3, 6, 2, 0.3, 0.5, 0.003, 0.003, 0.010, 0}},
    {"3 systems, L1+L2, ionosphere 2 cm   ", {3, 6, 2, 0.3, 0.5, 0.003, 0.003, 0.020, 0}},
    {"3 systems, L1, prior 1 m            ", {3, 8, 1, 0, 0.8, 0.004, 0.008, 0.003, 1.0}},
};
#define CASES ((int)(sizeof cases / sizeof cases[0]))

static void print_case(const char *name, const tally_t *a, const tally_t *b)
{
    const tally_t *both[2] = {a, b};
    printf("    %s", name);
    for (int k = 0; k < 2; k++) {
        printf(" | %5.1f %5.2f  %4.1f", 100.0 * both[k]->fixed / draws, 100.0 * both[k]->wrong / draws,
               (both[k]->fixed > 0) ? (double)both[k]->integers / both[k]->fixed : 0.0);
    }
    printf("\n");
}

/* Of n epochs at most `rate` wrong, within 99.5 % of a binomial. */
static void expect_at_most(int wrong, int n, double rate)
{
    TEST_ASSERT_LESS_OR_EQUAL_DOUBLE(rate * n + 2.6 * sqrt(rate * n), (double)wrong);
}

static void compare(const char *what, const pel_int_limits_t *limits, double gain_min)
{
    tally_t all = {0}, less = {0};
    printf("  %s, %d draws each: fixed %%, wrong %%, integers; all together | with subsets\n", what, draws);
    for (int i = 0; i < CASES; i++) {
        const tally_t a = tally(&cases[i].c, limits, 1, (uint64_t)(700 + i));
        const tally_t b = tally(&cases[i].c, limits, 8, (uint64_t)(700 + i));
        print_case(cases[i].name, &a, &b);
        expect_at_most(b.wrong, draws, WRONG_MAX);
        all.fixed += a.fixed;
        all.wrong += a.wrong;
        less.fixed += b.fixed;
        less.wrong += b.wrong;
        for (int k = 0; k < SUBSETS; k++) {
            less.by_subset[k] += b.by_subset[k];
            less.wrong_by_subset[k] += b.wrong_by_subset[k];
        }
    }
    printf("    in all fixed %d, wrong %d | %d, %d:", all.fixed, all.wrong, less.fixed, less.wrong);
    for (int k = 0; k < SUBSETS; k++) {
        printf(" %s %d (%d)%s", subset_name[k], less.by_subset[k], less.wrong_by_subset[k],
               (k < SUBSETS - 1) ? "," : "\n");
    }
    expect_at_most(less.wrong, CASES * draws, WRONG_MAX);
    TEST_ASSERT_GREATER_THAN((int)(gain_min * CASES * draws), less.fixed - all.fixed);
}

static void partial_fixing_fixes_more_at_a_bounded_rate_of_wrong_ones(void)
{
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    compare("default limits", &limits, 0.05);
    limits.ratio_min = 1.0;
    limits.success_min = 0.5;
    limits.failure_max = WRONG_MAX;
    compare("failure rate 0.1 % instead of a ratio", &limits, 0.02);
}

/* The ratio of a promised failure rate alone, no limit of success: over all subsets tried the promise must hold, in every case. */
static void wrong_fixes_stay_below_every_promise(void)
{
    static const double promised[] = {0.1, 0.01, 0.001, 0.0001};
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    limits.ratio_min = 1.0;
    limits.success_min = 0.0;
    printf("  promised, %d epochs each: fixed %%, wrong %% all together | with subsets; most wrong of a case\n",
           CASES * draws);
    for (int k = 0; k < 4; k++) {
        int fixed[2] = {0}, wrong[2] = {0}, worst = 0;
        limits.failure_max = promised[k];
        for (int i = 0; i < CASES; i++) {
            for (int parts = 0; parts < 2; parts++) {
                const tally_t t = tally(&cases[i].c, &limits, parts ? 8 : 1, (uint64_t)(800 + 10 * i + k));
                fixed[parts] += t.fixed;
                wrong[parts] += t.wrong;
                if (t.wrong > worst) { worst = t.wrong; }
                expect_at_most(t.wrong, draws, promised[k]);
            }
        }
        printf("    %7.2f %%  %5.2f %7.4f | %5.2f %7.4f; %.3f\n", 100.0 * promised[k],
               100.0 * fixed[0] / (CASES * draws), 100.0 * wrong[0] / (CASES * draws),
               100.0 * fixed[1] / (CASES * draws), 100.0 * wrong[1] / (CASES * draws), 100.0 * worst / draws);
        expect_at_most(wrong[1], CASES * draws, promised[k]);
    }
}

int main(int argc, char **argv)
{
    if (argc > 1) { draws = atoi(argv[1]); }
    UNITY_BEGIN();
    RUN_TEST(slices_give_what_one_call_gives);
    RUN_TEST(a_refused_problem_is_left_as_it_was);
    RUN_TEST(a_bad_pivot_takes_its_system_out);
    RUN_TEST(partial_fixing_fixes_more_at_a_bounded_rate_of_wrong_ones);
    RUN_TEST(wrong_fixes_stay_below_every_promise);
    return UNITY_END();
}

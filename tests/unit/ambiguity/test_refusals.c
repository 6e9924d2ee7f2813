/* Problems that cannot be, and those that are at the edge of what can: each number spoiled once, pairs and groups that do not match. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/ambiguity_methods.h"
#include "support_epoch.h"
#include "support_scene.h"
#include "unity.h"

static pel_ils_t ils;
static pel_band_t band;
static pel_amb_cascade_t cascade;
static epoch_t epoch;
static scene_t scene;
static int64_t N[PEL_MAX_AMB];

/* One member and a number that it must not have. */
typedef struct {
    size_t at;
    char type; /* d double, i int, b byte */
    double value;
} spoil_t;

static void put(void *into, const spoil_t *s)
{
    uint8_t *to = (uint8_t *)into + s->at;
    const int whole = (s->type == 'd') ? 0 : (int)s->value;
    const uint8_t byte = (uint8_t)whole;
    switch (s->type) {
    case 'd': memcpy(to, &s->value, sizeof s->value); break;
    case 'i': memcpy(to, &whole, sizeof whole); break;
    default: memcpy(to, &byte, 1); break;
    }
}

static void draw_scene(int n_sys, int n_sat)
{
    const scene_case_t c = {
        .n_sys = n_sys, .n_sat = n_sat, .n_carrier = 2, .sd_code = 0.4, .sd_phase = 0.002, .sd_prior = 0.3};
    rng_t r = {77};
    scene = scene_draw(&c, &r);
}

void setUp(void)
{
    const case_t c = {.t_s = 8100, .sd_code = 1, .sd_phase = 0.002, .sd_prior = 0.3};
    rng_t r = {23};
    epoch = epoch_draw(&c, &r);
    epoch.band.half_width_cyc = 0.15;
    epoch.band.window = 4.0;
    epoch.band.ratio_min = 2.0;
    epoch.band.max_triples = 400000;
    draw_scene(2, 6);
}

void tearDown(void) {}

/* ---- the float problem ----------------------------------------------------------------------------------------------------------- */

#define P(member) offsetof(pel_amb_problem_t, member)

static void each_number_of_a_problem_has_its_limits(void)
{
    static const spoil_t BAD[] = {
        {P(n_rows), 'i', PEL_MAX_AMB + 1},
        {P(n_groups), 'i', 0},
        {P(n_groups), 'i', PEL_AMB_GROUPS + 1},
        {P(var_iono), 'd', -1e-9},
        {P(var_iono), 'd', 1e6},
        {P(var_iono), 'd', NAN},
        {P(row[1].sat), 'b', PEL_MAX_SATS},
        {P(row[0].group), 'b', 1},
        {P(group[0].sat), 'b', PEL_MAX_SATS},
        {P(group[1].mu), 'd', -1.0},
        {P(group[1].mu), 'd', 100.0},
        {P(row[2].g[1]), 'd', NAN},
        {P(row[0].var_phase), 'd', 1e12},
        {P(group[0].var_phase), 'd', 0},
        {P(row[0].lambda_m), 'd', 1e-3},
        {P(row[0].lambda_m), 'd', 1e3},
        {P(row[0].var_code), 'd', -1.0},
        {P(group[0].var_code), 'd', 1e12},
        {P(row[0].code_m), 'd', INFINITY},
        {P(row[0].phase_m), 'd', -INFINITY},
    };
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        pel_amb_problem_t p = epoch.problem;
        put(&p, &BAD[i]);
        TEST_ASSERT_EQUAL_INT(PEL_E_RANGE, pel_amb_float(&p, &ils, 2, 100));
        TEST_ASSERT_EQUAL_INT(0, ils.n);
        TEST_ASSERT_EQUAL_INT(PEL_ILS_EMPTY, ils.stage);
    }
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_amb_float(&epoch.problem, &ils, 2, 100));
}

/* More satellites than states: the ionosphere of those that find none is noise. */
static void more_satellites_than_states_are_solved_all_the_same(void)
{
    pel_amb_problem_t p = {.n_groups = 1, .have_prior = true, .var_iono = 1e-4};
    p.group[0] = (pel_amb_group_t){.sat = 47, .mu = 1.0, .var_phase = 4e-6, .var_code = 0.1};
    for (int k = 0; k < 3; k++) { p.P_r[k][k] = 1e-2; }
    for (int i = 0; i < PEL_MAX_AMB; i++) {
        p.row[p.n_rows++] = (pel_amb_row_t){.sat = (uint8_t)i,
                                            .integer = true,
                                            .code = true,
                                            .g = {cos(i), sin(i), cos(2.0 * i)},
                                            .lambda_m = 0.19,
                                            .phase_m = 0.19 * i,
                                            .var_phase = 4e-6,
                                            .var_code = 0.1};
    }
    TEST_ASSERT_GREATER_THAN_INT(PEL_AMB_IONO_SATS, p.n_rows);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_amb_float(&p, &ils, 1, 100000));
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_ils_run(&ils, INT32_MAX));
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_ils_get(&ils, 0, N, NULL));
    for (int i = 0; i < PEL_MAX_AMB; i++) { TEST_ASSERT_EQUAL_INT64(i, N[i]); }
}

static void fewer_than_three_phases_or_flat_ones_give_no_position(void)
{
    double b[3], P_b[3][3], sq;
    int dof;
    pel_amb_problem_t p = epoch.problem;
    for (int i = 2; i < p.n_rows; i++) { p.row[i].integer = false; }
    TEST_ASSERT_EQUAL_INT(PEL_E_GEOMETRY, pel_amb_fixed(&p, N, b, P_b, &sq, &dof));
    p = epoch.problem;
    for (int i = 0; i < p.n_rows; i++) { p.row[i].g[2] = 0.0; }
    TEST_ASSERT_EQUAL_INT(PEL_E_GEOMETRY, pel_amb_fixed(&p, N, b, P_b, &sq, &dof));
}

static void a_problem_that_changed_after_the_search_is_not_judged(void)
{
    pel_int_limits_t limits;
    pel_int_verdict_t v;
    pel_int_limits_default(&limits);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_amb_float(&epoch.problem, &ils, 2, 10000));
    (void)pel_ils_run(&ils, INT32_MAX);
    pel_amb_problem_t p = epoch.problem;
    p.row[3].integer = false;
    TEST_ASSERT_EQUAL_INT(PEL_E_MISSING, pel_int_validate(&p, &ils, &limits, &v));
    TEST_ASSERT_EQUAL_INT(PEL_INT_FEW, v.reason);
}

/* The order of carriers does not matter to a pair's band, and two codes of one carrier are no pair. */
static void pairs_are_of_two_carriers_in_any_order(void)
{
    pel_int_limits_t limits;
    pel_int_verdict_t v, turned_v;
    pel_int_limits_default(&limits);
    pel_amb_problem_t p = epoch.problem, turned = epoch.problem;
    const int m = epoch.m;
    p.row[1].phase_m += 0.15 * LAMBDA1;
    for (int i = 0; i < 2 * m; i++) { /* L2 first */
        turned.row[i] = p.row[(i + m) % (2 * m)];
        turned.row[i].group = (uint8_t)(i / m);
    }
    turned.group[0] = p.group[1];
    turned.group[1] = p.group[0];
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_amb_float(&p, &ils, 2, 10000));
    (void)pel_ils_run(&ils, INT32_MAX);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_int_validate(&p, &ils, &limits, &v));
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_amb_float(&turned, &ils, 2, 10000));
    (void)pel_ils_run(&ils, INT32_MAX);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_int_validate(&turned, &ils, &limits, &turned_v));
    TEST_ASSERT_EQUAL_INT(m, v.n_pairs);
    TEST_ASSERT_EQUAL_INT(m, turned_v.n_pairs);
    TEST_ASSERT_TRUE(v.band_worst > 0.3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, v.band_worst, turned_v.band_worst);

    p = epoch.problem;
    p.n_rows = m; /* L1 alone, its last satellite twice */
    p.n_groups = 1;
    p.row[m - 1].sat = p.row[m - 2].sat;
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_amb_float(&p, &ils, 2, 100000));
    (void)pel_ils_run(&ils, INT32_MAX);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_int_validate(&p, &ils, &limits, &v));
    TEST_ASSERT_EQUAL_INT(0, v.n_pairs);
}

/* ---- all and some of them ---------------------------------------------------------------------------------------------------------- */

static void what_cannot_be_asked_for_is_refused_at_once(void)
{
    pel_int_limits_t limits;
    pel_int_verdict_t v;
    pel_amb_resolver_t r;
    pel_int_limits_default(&limits);
    static const struct {
        int rows, groups, budget, tries;
    } bad[] = {{-1, 2, 100, 8}, {PEL_MAX_AMB + 1, 2, 100, 8},
               {8, -1, 100, 8}, {8, PEL_AMB_GROUPS + 1, 100, 8},
               {8, 2, 0, 8},    {8, 2, 100, 0},
               {8, 2, 100, 64}};
    for (int i = 0; i < 7; i++) {
        pel_amb_problem_t p = epoch.problem;
        p.n_rows = bad[i].rows;
        p.n_groups = bad[i].groups;
        TEST_ASSERT_EQUAL_INT(PEL_E_RANGE, pel_amb_resolve_begin(&r, &p, &limits, bad[i].budget, bad[i].tries));
        TEST_ASSERT_EQUAL_INT(PEL_E_MISSING, pel_amb_resolve_step(&r, &p, &ils, 100, N, &v));
        TEST_ASSERT_EQUAL_INT(PEL_E_RANGE, pel_amb_resolve(&p, &ils, &limits, bad[i].budget, bad[i].tries, N, &v));
        TEST_ASSERT_EQUAL_INT(PEL_INT_NOT_TRIED, v.reason);
    }
}

/* Without a prior three codes are the least: a suspect with one of them cannot be left out, one without can. */
static void a_subset_without_enough_codes_is_passed_over(void)
{
    pel_int_limits_t limits;
    pel_int_verdict_t v;
    pel_int_limits_default(&limits);
    limits.success_min = 0.0;
    limits.ratio_min = 1.0;
    for (int bad = 0; bad < 2; bad++) {
        draw_scene(1, 8);
        pel_amb_problem_t p = scene.problem;
        p.have_prior = false;
        for (int i = 0; i < p.n_rows; i++) {
            p.row[i].code = i < 3;
            p.row[i].var_code = 1e-4; /* as good as a prior */
        }
        for (int g = 0; g < p.n_groups; g++) { p.group[g].var_code = 1e-4; }
        for (int i = 0; i < 3; i++) { /* and without an error of its own */
            double range = 0.0;
            for (int k = 0; k < 3; k++) { range += p.row[i].g[k] * scene.b[k]; }
            p.row[i].code_m = range;
        }
        const int row = (bad == 0) ? 1 : 5;
        p.row[row].phase_m += 0.3 * p.row[row].lambda_m;
        const pel_status_t status = pel_amb_resolve(&p, &ils, &limits, 20000, 8, N, &v);
        TEST_ASSERT_EQUAL_INT((bad == 0) ? PEL_W_REJECTED : PEL_OK, status);
        if (bad == 1) { TEST_ASSERT_TRUE(scene_right(&scene, &p, N)); }
    }
}

/* Two integers that do not fit blame nobody: they give no position. */
static void a_misfit_of_too_few_has_no_suspects(void)
{
    pel_int_limits_t limits;
    pel_int_verdict_t v;
    pel_int_limits_default(&limits);
    limits.n_min = 1;
    limits.success_min = 0.0;
    limits.ratio_min = 1.0;
    pel_amb_problem_t p = epoch.problem;
    for (int i = 2; i < p.n_rows; i++) { p.row[i].integer = false; }
    for (int k = 0; k < 3; k++) { p.P_r[k][k] = 1e-6; }
    p.row[0].phase_m += 0.4 * LAMBDA1;
    TEST_ASSERT_EQUAL_INT(PEL_W_REJECTED, pel_amb_resolve(&p, &ils, &limits, 10000, 8, N, &v));
    TEST_ASSERT_TRUE((v.failed & (1u << PEL_INT_CHI2)) != 0);
    TEST_ASSERT_EQUAL_INT(PEL_AMB_ALL, v.subset);
}

/* Groups with different pivots are of one system if they share any satellite: its carriers leave together. */
static void groups_that_share_a_satellite_are_one_system(void)
{
    pel_int_limits_t limits;
    pel_amb_resolver_t r;
    pel_int_limits_default(&limits);
    pel_amb_problem_t p = scene.problem;
    TEST_ASSERT_EQUAL_INT(4, p.n_groups);
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_amb_resolve_begin(&r, &p, &limits, 100, 8));
    TEST_ASSERT_EQUAL_INT(2, r.n_systems);
    p.group[1].sat = 40; /* another pivot on the second carrier */
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_amb_resolve_begin(&r, &p, &limits, 100, 8));
    TEST_ASSERT_EQUAL_INT(2, r.n_systems);
    for (int i = 0; i < p.n_rows; i++) { /* and other satellites than the first */
        if (p.row[i].group == 1) { p.row[i].sat = (uint8_t)(p.row[i].sat + 20); }
    }
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_amb_resolve_begin(&r, &p, &limits, 100, 8));
    TEST_ASSERT_EQUAL_INT(3, r.n_systems);
}

/* ---- band --------------------------------------------------------------------------------------------------------------------------- */

#define B(member) offsetof(pel_band_input_t, member)

static void each_number_of_a_band_has_its_limits(void)
{
    static const spoil_t BAD[] = {
        {B(m), 'i', 2},
        {B(m), 'i', PEL_BAND_DD + 1},
        {B(max_triples), 'i', 0},
        {B(sd_code_m), 'd', 0.0},
        {B(sd_phase_m), 'd', 0.0},
        {B(window), 'd', NAN},
        {B(ratio_min), 'd', 0.99},
        {B(lambda1_m), 'd', 0.05},
        {B(lambda2_m), 'd', 0.19},
        {B(lambda2_m), 'd', 1e3},
        {B(half_width_cyc), 'd', 0.0},
        {B(half_width_cyc), 'd', 0.5},
        {B(G[1][2]), 'd', INFINITY},
        {B(P_m[0]), 'd', 1e8},
        {B(L2_m[2]), 'd', NAN},
    };
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        pel_band_input_t in = epoch.band;
        put(&in, &BAD[i]);
        TEST_ASSERT_EQUAL_INT(PEL_E_RANGE, pel_band_solve(&in, &band));
        TEST_ASSERT_EQUAL_INT(PEL_INT_NOT_TRIED, band.reason);
    }
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_band_solve(&epoch.band, &band));
    TEST_ASSERT_TRUE(band.accepted);
}

static void a_band_without_geometry_is_told(void)
{
    pel_band_input_t in = epoch.band;
    for (int k = 0; k < 3; k++) { in.P_r[k][k] = 0.0; }
    TEST_ASSERT_EQUAL_INT(PEL_E_NOT_POSDEF, pel_band_solve(&in, &band));
    in = epoch.band;
    in.have_prior = false;
    for (int i = 0; i < in.m; i++) { in.G[i][2] = 0.0; } /* all in a plane */
    TEST_ASSERT_EQUAL_INT(PEL_E_GEOMETRY, pel_band_solve(&in, &band));
    in.have_prior = true; /* a prior for the rest, but no triple has a volume */
    const pel_status_t status = pel_band_solve(&in, &band);
    TEST_ASSERT_TRUE(status == PEL_E_GEOMETRY);
}

static void windows_beyond_all_lists_are_refused(void)
{
    pel_band_input_t in = epoch.band;
    in.window = 1e5; /* kilometres */
    TEST_ASSERT_EQUAL_INT(PEL_E_FULL, pel_band_solve(&in, &band));
    /* codes that put a phase three thousand million cycles away */
    memset(&in, 0, sizeof in);
    in.m = 7;
    in.lambda1_m = 0.06;
    in.lambda2_m = 0.07;
    in.sd_code_m = 1.0;
    in.sd_phase_m = 0.003;
    in.half_width_cyc = 0.15;
    in.window = 1.0;
    in.ratio_min = 2.0;
    in.max_triples = 100;
    for (int i = 0; i < 7; i++) {
        in.G[i][(i < 5) ? 0 : i - 4] = 1.0;
        in.P_m[i] = (i == 0 || i > 4) ? 0.0 : 9.9e7;
    }
    in.L1_m[0] = -9.9e7;
    TEST_ASSERT_EQUAL_INT(PEL_E_FULL, pel_band_solve(&in, &band));
}

/* Two satellites half a cycle off leave two lists empty; of three double differences none can be left out. */
static void more_than_one_empty_list_is_too_many(void)
{
    const case_t c = {.t_s = 2100, .sd_code = 3, .sd_phase = 0.001, .sd_prior = 0.05};
    rng_t r = {5};
    int two = 0, of_three = 0;
    for (int i = 0; i < 300; i++) {
        epoch_t e = epoch_draw(&c, &r);
        e.band.half_width_cyc = 0.15;
        e.band.window = (i % 3 == 2) ? 1.0 : 4.0;
        e.band.ratio_min = 2.0;
        e.band.max_triples = 400000;
        e.band.L1_m[2] += 0.5 * LAMBDA1;
        if (i % 3 == 0) { e.band.L1_m[1] += 0.5 * LAMBDA1; }
        if (i % 3 == 1) { e.band.m = 3; }
        const pel_status_t status = pel_band_solve(&e.band, &band);
        TEST_ASSERT_TRUE(status == PEL_OK || status == PEL_E_GEOMETRY);
        if (status == PEL_E_GEOMETRY) { TEST_ASSERT_FALSE(band.accepted); }
        two += i % 3 == 0 && status == PEL_E_GEOMETRY;
        of_three += i % 3 == 1 && status == PEL_E_GEOMETRY;
    }
    TEST_ASSERT_GREATER_THAN(50, two);
    TEST_ASSERT_GREATER_THAN(50, of_three);
}

/* Codes that put each satellite elsewhere: every combination is far from where they say. */
static void codes_that_contradict_the_phases_leave_no_combination(void)
{
    int nothing = 0;
    for (int i = 0; i < 40; i++) {
        pel_band_input_t in = epoch.band;
        in.have_prior = false;
        in.window = 1.0;
        for (int k = 0; k < in.m; k++) { in.P_m[k] += ((k % 2 == 0) ? 1.0 : -1.0) * 0.5 * i; }
        const pel_status_t status = pel_band_solve(&in, &band);
        if (status != PEL_OK) { continue; }
        nothing += band.evaluations == 0;
        if (i > 10) { TEST_ASSERT_FALSE(band.accepted); }
        if (band.evaluations == 0) { TEST_ASSERT_EQUAL_INT(PEL_INT_CHI2, band.reason); }
    }
    TEST_ASSERT_GREATER_THAN(0, nothing);
}

/* ---- cascade -------------------------------------------------------------------------------------------------------------------------- */

static int pairs_of(const pel_amb_problem_t *p)
{
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    const pel_status_t status = pel_amb_cascade_begin(&cascade, p, &limits, 10000, 4);
    TEST_ASSERT_EQUAL_INT((cascade.n_pairs > 0) ? PEL_OK : PEL_E_MISSING, status);
    return cascade.n_pairs;
}

static void pairs_are_made_of_rows_that_belong_together(void)
{
    pel_amb_problem_t p = scene.problem;
    const int n = pairs_of(&p);
    TEST_ASSERT_EQUAL_INT(10, n); /* five against the pivot in two systems */
    p.row[1].integer = false;     /* of the first carrier of the first system */
    TEST_ASSERT_EQUAL_INT(n - 1, pairs_of(&p));
    p.row[7].integer = false; /* of its second */
    TEST_ASSERT_EQUAL_INT(n - 2, pairs_of(&p));
    p.group[3].sat = 46; /* another pivot on the second carrier of the second system */
    TEST_ASSERT_EQUAL_INT(3, pairs_of(&p));
    p = scene.problem;
    for (int i = 5; i < 10; i++) { p.row[i].lambda_m = p.row[0].lambda_m; } /* the same wave twice */
    TEST_ASSERT_EQUAL_INT(5, pairs_of(&p));
    for (int i = 0; i < p.n_rows; i++) { p.row[i].sat = (uint8_t)i; }
    TEST_ASSERT_EQUAL_INT(0, pairs_of(&p));
}

/* Three carriers: the longest is left over, whatever it could be paired with; a group's partners lie in one other group. */
static void of_three_carriers_two_are_paired(void)
{
    pel_amb_problem_t p;
    memset(&p, 0, sizeof p);
    static const double LAMBDA[] = {0.19, 0.24, 0.25};
    for (int g = 0; g < 3; g++) {
        p.group[p.n_groups++] = (pel_amb_group_t){.sat = 9, .mu = 1.0 + g, .var_phase = 1e-5, .var_code = 0.1};
        for (int s = 0; s < 4; s++) {
            if (g == 1 && s == 3) { continue; } /* the last satellite has the first and the third */
            p.row[p.n_rows++] = (pel_amb_row_t){.group = (uint8_t)g,
                                                .sat = (uint8_t)s,
                                                .integer = true,
                                                .code = true,
                                                .lambda_m = LAMBDA[g],
                                                .var_phase = 1e-5,
                                                .var_code = 0.1};
        }
    }
    TEST_ASSERT_EQUAL_INT(3, pairs_of(&p));
    for (int k = 0; k < 3; k++) {
        TEST_ASSERT_EQUAL_INT(0, p.row[cascade.row1[k]].group);
        TEST_ASSERT_EQUAL_INT(1, p.row[cascade.row2[k]].group);
    }
    p.row[4].lambda_m = p.row[0].lambda_m; /* two rows of one wave: the third carrier's row can serve one of them */
    TEST_ASSERT_EQUAL_INT(4, pairs_of(&p));
    uint64_t taken = 0;
    for (int k = 0; k < 4; k++) {
        const uint64_t rows = (UINT64_C(1) << cascade.row1[k]) | (UINT64_C(1) << cascade.row2[k]);
        TEST_ASSERT_EQUAL_UINT64(0, taken & rows);
        TEST_ASSERT_EQUAL_INT(2, p.row[cascade.row2[k]].group);
        taken |= rows;
    }
}

/* Ten groups of one satellite each, all with their partner in an eleventh: the narrow lanes have room for eight. */
static void groups_beyond_the_room_of_narrow_lanes_are_left_out(void)
{
    pel_amb_problem_t p;
    memset(&p, 0, sizeof p);
    for (int g = 0; g < 11; g++) {
        p.group[p.n_groups++] = (pel_amb_group_t){.sat = 30, .mu = 1.0, .var_phase = 1e-5, .var_code = 0.1};
        for (int s = (g < 10) ? g : 0; s < ((g < 10) ? g + 1 : 10); s++) {
            p.row[p.n_rows++] = (pel_amb_row_t){.group = (uint8_t)g,
                                                .sat = (uint8_t)s,
                                                .integer = true,
                                                .code = true,
                                                .lambda_m = (g < 10) ? 0.19 : 0.24,
                                                .var_phase = 1e-5,
                                                .var_code = 0.1};
        }
    }
    TEST_ASSERT_EQUAL_INT(8, pairs_of(&p));
}

static void a_cascade_that_cannot_be_asked_for_is_refused(void)
{
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    static const struct {
        int rows, groups, tries;
        uint8_t group;
    } bad[] = {{-1, 4, 4, 0}, {PEL_MAX_AMB + 1, 4, 4, 0}, {20, PEL_AMB_GROUPS + 1, 4, 0}, {20, 4, 0, 0}, {20, 4, 64, 0},
               {20, 4, 4, 9}};
    for (int i = 0; i < 6; i++) {
        pel_amb_problem_t p = scene.problem;
        p.n_rows = bad[i].rows;
        p.n_groups = bad[i].groups;
        if (bad[i].group > 0) { p.row[3].group = bad[i].group; }
        TEST_ASSERT_EQUAL_INT(PEL_E_RANGE, pel_amb_cascade(&cascade, &p, &ils, &limits, 10000, bad[i].tries, N));
        TEST_ASSERT_EQUAL_INT(PEL_E_MISSING, pel_amb_cascade_step(&cascade, &p, &ils, 100, N));
    }
    TEST_ASSERT_EQUAL_INT(PEL_E_RANGE, pel_amb_cascade(&cascade, &scene.problem, &ils, &limits, 0, 4, N));
}

/* Codes of one carrier, of the other, of both, or of none: the wide lane takes what its pairs have in common. */
static void wide_lanes_take_the_codes_there_are(void)
{
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    for (int codes = 0; codes < 5; codes++) {
        draw_scene(2, 8);
        pel_amb_problem_t p = scene.problem;
        for (int i = 0; i < p.n_rows; i++) {
            const bool first = p.row[i].group % 2 == 0;
            if (codes == 1) { p.row[i].code = first; }
            if (codes == 2) { p.row[i].code = !first; }
            if (codes == 3) { p.row[i].code = false; }
            if (codes == 4) { p.row[i].code = first ? p.row[i].sat % 2 == 0 : p.row[i].sat % 3 == 0; }
        }
        const pel_status_t status = pel_amb_cascade(&cascade, &p, &ils, &limits, 100000, 8, N);
        if (codes < 3) { TEST_ASSERT_EQUAL_INT(PEL_OK, status); }
        if (status != PEL_OK) { continue; }
        for (int i = 0; i < p.n_rows; i++) {
            if (((cascade.fixed >> i) & 1u) != 0) { TEST_ASSERT_EQUAL_INT64(scene.truth[i], N[i]); }
        }
    }
}

/* Nodes for the wide lanes alone: what they give stays, the narrow ones are told as not proved. */
static void a_budget_that_ends_with_the_wide_lanes_keeps_them(void)
{
    pel_int_limits_t limits;
    pel_int_limits_default(&limits);
    int wide_only = 0;
    for (int budget = 1; budget < 60; budget++) {
        const pel_status_t status = pel_amb_cascade(&cascade, &scene.problem, &ils, &limits, budget, 1, N);
        if (cascade.level != PEL_CASCADE_WIDE) { continue; }
        TEST_ASSERT_EQUAL_INT(PEL_W_REJECTED, status);
        wide_only += cascade.narrow.reason == PEL_INT_BUDGET;
        for (int k = 0; k < cascade.n_pairs; k++) {
            if (!cascade.is_wide[k]) { continue; }
            TEST_ASSERT_EQUAL_INT64(scene.truth[cascade.row1[k]] - scene.truth[cascade.row2[k]], cascade.N_wide[k]);
        }
    }
    TEST_ASSERT_GREATER_THAN(0, wide_only);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(each_number_of_a_problem_has_its_limits);
    RUN_TEST(more_satellites_than_states_are_solved_all_the_same);
    RUN_TEST(fewer_than_three_phases_or_flat_ones_give_no_position);
    RUN_TEST(a_problem_that_changed_after_the_search_is_not_judged);
    RUN_TEST(pairs_are_of_two_carriers_in_any_order);
    RUN_TEST(what_cannot_be_asked_for_is_refused_at_once);
    RUN_TEST(a_subset_without_enough_codes_is_passed_over);
    RUN_TEST(a_misfit_of_too_few_has_no_suspects);
    RUN_TEST(groups_that_share_a_satellite_are_one_system);
    RUN_TEST(each_number_of_a_band_has_its_limits);
    RUN_TEST(a_band_without_geometry_is_told);
    RUN_TEST(windows_beyond_all_lists_are_refused);
    RUN_TEST(more_than_one_empty_list_is_too_many);
    RUN_TEST(codes_that_contradict_the_phases_leave_no_combination);
    RUN_TEST(pairs_are_made_of_rows_that_belong_together);
    RUN_TEST(of_three_carriers_two_are_paired);
    RUN_TEST(groups_beyond_the_room_of_narrow_lanes_are_left_out);
    RUN_TEST(a_cascade_that_cannot_be_asked_for_is_refused);
    RUN_TEST(wide_lanes_take_the_codes_there_are);
    RUN_TEST(a_budget_that_ends_with_the_wide_lanes_keeps_them);
    return UNITY_END();
}

/* The integer problem of one epoch, made of its single differences: what takes part, what does not fit, what the verdicts count. */
/* with: carried pair gnss */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_pair.h"
#include "unity.h"

#define GPS (1u << PEL_SYS_GPS)
#define GLO (1u << PEL_SYS_GLO)
#define L1  (1u << PEL_CARRIER_L1)
#define L2  (1u << PEL_CARRIER_L2)

static const double WIDE[3][3] = {{1.0, 0, 0}, {0, 1.0, 0}, {0, 0, 1.0}};
static pair_t pair;
static pel_navigator_t good, nav;
static pel_nav_integers_t ints;

static void observed(unsigned systems, uint8_t carriers)
{
    pair_init(&pair, &good, systems, carriers);
    for (int i = 0; i < 3; i++) { (void)pair_step(&pair, &good); }
    for (int i = 0; i < good.sd.n; i++) { /* above the mask, all of them */
        pel_sd_t *sd = &good.sd.sd[i];
        if ((double)sd->el_rad < good.cfg.integer_mask_rad) { sd->el_rad = (float)(16.0 * PEL_DEG); }
    }
    pair_see_again(&good);
    nav = good;
    memset(&ints, 0, sizeof ints);
}

void setUp(void)
{
    observed(GPS, L1 | L2);
}

void tearDown(void) {}

static bool begun(void)
{
    memset(&ints, 0, sizeof ints);
    return pel_nav_resolve_begin(&nav, WIDE, &ints);
}

static void resolved(const double P[3][3])
{
    memset(&ints, 0, sizeof ints);
    TEST_ASSERT_TRUE(pel_nav_resolve_begin(&nav, P, &ints));
    while (!pel_nav_resolve_step(&nav, 500, &ints)) {}
}

static int rows_of(uint8_t sys)
{
    int n = 0;
    for (int r = 0; r < nav.problem.n_rows; r++) { n += nav.sd.sd[nav.update.row_of[r]].sys == sys; }
    return n;
}

static void phases_that_can_be_integers_take_part(void)
{
    TEST_ASSERT_TRUE(begun());
    const int n = nav.problem.n_rows;
    TEST_ASSERT_EQUAL_INT(nav.sd.n - nav.sd.n_groups, n); /* all but the pivots */
    nav.sd.sd[1].half = true;
    TEST_ASSERT_TRUE(begun());
    TEST_ASSERT_EQUAL_INT(n - 1, nav.problem.n_rows);
    nav.sd.sd[2].has_phase = false;
    TEST_ASSERT_TRUE(begun());
    TEST_ASSERT_EQUAL_INT(n - 2, nav.problem.n_rows);
    nav.sd.sd[3].el_rad = (float)(14.0 * PEL_DEG);
    TEST_ASSERT_TRUE(begun());
    TEST_ASSERT_EQUAL_INT(n - 3, nav.problem.n_rows);
    nav.sd.sd[0].half = true; /* the pivot: its whole group */
    TEST_ASSERT_TRUE(begun());
    for (int r = 0; r < nav.problem.n_rows; r++) {
        TEST_ASSERT_NOT_EQUAL(nav.sd.sd[0].group, nav.sd.sd[nav.update.row_of[r]].group);
    }
}

static void codes_take_part_where_both_ends_have_one(void)
{
    nav.sd.sd[2].has_code = false;
    TEST_ASSERT_TRUE(begun());
    for (int r = 0; r < nav.problem.n_rows; r++) {
        TEST_ASSERT_EQUAL_INT(nav.update.row_of[r] != 2, nav.problem.row[r].code);
    }
    nav.sd.sd[0].has_code = false;
    TEST_ASSERT_TRUE(begun());
    for (int r = 0; r < nav.problem.n_rows; r++) {
        const bool first_group = nav.sd.sd[nav.update.row_of[r]].group == nav.sd.sd[0].group;
        TEST_ASSERT_EQUAL_INT(!first_group, nav.problem.row[r].code);
    }
}

/* A datum of GLONASS comes from a code, so a phase without one cannot be on it. */
static void glonass_phases_need_their_code(void)
{
    observed(GPS | GLO, L1);
    TEST_ASSERT_TRUE(begun());
    const int n = rows_of(PEL_SYS_GLO);
    TEST_ASSERT_GREATER_THAN_INT(3, n);
    for (int i = 0; i < nav.sd.n; i++) { nav.sd.sd[i].has_code = nav.sd.sd[i].sys != PEL_SYS_GLO; }
    TEST_ASSERT_TRUE(begun());
    TEST_ASSERT_EQUAL_INT(0, rows_of(PEL_SYS_GLO));
}

static void rows_of_a_group_without_a_pivot_are_left_out(void)
{
    const uint8_t group = nav.sd.sd[0].group;
    int first = 0;
    while (nav.sd.sd[first].group == group) { first++; }
    nav.sd.sd[first].pivot = false; /* of the second: those of the first are not held against it */
    TEST_ASSERT_TRUE(begun());
    for (int r = 0; r < nav.problem.n_rows; r++) {
        TEST_ASSERT_EQUAL_INT(group, nav.sd.sd[nav.update.row_of[r]].group);
    }
}

static void fewer_than_four_are_not_tried(void)
{
    nav.sd.n = 4; /* three against a pivot */
    TEST_ASSERT_FALSE(begun());
    TEST_ASSERT_EQUAL_INT(PEL_INT_FEW, ints.reason);
    TEST_ASSERT_EQUAL_INT(3, ints.n);
    nav.sd.n = 5;
    TEST_ASSERT_TRUE(begun());
}

/* Of more than there is room for the lowest are left out, as many degrees as it takes. */
static void what_is_too_much_is_cut_from_below(void)
{
    const pel_sd_t model = nav.sd.sd[1];
    nav.sd.n = 60;
    for (int i = 0; i < 60; i++) {
        nav.sd.sd[i] = model;
        nav.sd.sd[i].group = 0;
        nav.sd.sd[i].pivot = i == 0;
        nav.sd.sd[i].el_rad = (float)((16.5 + i) * PEL_DEG);
    }
    TEST_ASSERT_TRUE(begun());
    TEST_ASSERT_EQUAL_INT(36, nav.problem.n_rows); /* above 40 degrees: 24..59 */
    TEST_ASSERT_EQUAL_INT(24, nav.update.row_of[0]);
    for (int i = 0; i < 60; i++) { /* as many groups as satellites, each of two: more than the problem has */
        nav.sd.sd[i].group = (uint8_t)(i / 2);
        nav.sd.sd[i].pivot = i % 2 == 0;
    }
    TEST_ASSERT_TRUE(begun());
    TEST_ASSERT_LESS_OR_EQUAL_INT(PEL_AMB_GROUPS, nav.problem.n_groups);
    TEST_ASSERT_GREATER_THAN_INT(12, nav.problem.n_rows);
    for (int i = 0; i < 60; i++) { nav.sd.sd[i].el_rad = 3.0f; } /* no elevation: no mask can cut them */
    (void)begun();
    TEST_ASSERT_LESS_OR_EQUAL_INT(PEL_AMB_GROUPS, nav.problem.n_groups);
}

/* A satellite that is in no view any more has no number of its own: the engine refuses. */
static void a_problem_that_the_engine_refuses_is_none(void)
{
    nav.view_rover.n = 1;
    resolved(WIDE);
    TEST_ASSERT_EQUAL_INT(PEL_INT_FEW, ints.reason);
    TEST_ASSERT_EQUAL_INT(0, ints.n_fixed);
    TEST_ASSERT_EQUAL_UINT32(good.counters.fix_tried + 1, nav.counters.fix_tried);
    TEST_ASSERT_EQUAL_UINT32(good.counters.fix_ok, nav.counters.fix_ok);
}

/* Numbers that do not fit 32 bits are left float, the others are fixed. */
static void a_number_too_large_to_be_told_is_not_fixed(void)
{
    static const double CYCLES[] = {3e9, -3e9};
    resolved(WIDE);
    TEST_ASSERT_EQUAL_INT(PEL_INT_OK, ints.reason);
    const int n = ints.n_fixed;
    for (int i = 0; i < 2; i++) {
        nav = good;
        nav.sd.sd[1].phase_m += CYCLES[i] * nav.sd.sd[1].lambda_m;
        resolved(WIDE);
        TEST_ASSERT_EQUAL_INT(n - 1, ints.n_fixed);
        TEST_ASSERT_FALSE(ints.fixed[1]);
        TEST_ASSERT_TRUE(ints.fixed[2]);
    }
}

/* A position that the prior does not believe, though the phases are sure of it. */
static void a_fix_away_from_its_prior_is_counted_as_such(void)
{
    static const double SURE[3][3] = {{1e-4, 0, 0}, {0, 1e-4, 0}, {0, 0, 1e-4}};
    uint32_t prior = 0;
    for (int mm = 0; mm <= 60; mm += 2) {
        nav = good;
        for (int i = 0; i < nav.sd.n; i++) {
            nav.sd.sd[i].phase_m += 1e-3 * mm * nav.sd.sd[i].u_e[0];
            nav.sd.sd[i].code_m += 1e-3 * mm * nav.sd.sd[i].u_e[0];
        }
        resolved(SURE);
        if (mm <= 30) { TEST_ASSERT_EQUAL_INT(PEL_INT_OK, ints.reason); } /* three sigma */
        if (mm >= 54) { TEST_ASSERT_NOT_EQUAL(PEL_INT_OK, ints.reason); }
        prior += nav.counters.fix_prior - good.counters.fix_prior;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(0, prior);
}

/* Three satellites on two carriers: too few to leave one out, enough to see that one's carriers are apart. */
static void a_pair_outside_its_band_is_counted_as_such(void)
{
    static const double SURE[3][3] = {{1e-4, 0, 0}, {0, 1e-4, 0}, {0, 0, 1e-4}};
    uint8_t kept[2];
    for (int i = 0; i < 2; i++) { kept[i] = good.sd.sd[i + 1].prn; }
    uint32_t band = 0, chi2 = 0, ratio = 0;
    for (int mm = 0; mm <= 60; mm++) {
        nav = good;
        for (int i = 0; i < nav.sd.n; i++) {
            pel_sd_t *sd = &nav.sd.sd[i];
            if (!sd->pivot && sd->prn != kept[0] && sd->prn != kept[1]) { sd->has_phase = false; }
            if (sd->prn == kept[0]) { sd->phase_m += 1e-3 * mm * ((sd->carrier == PEL_CARRIER_L1) ? 1.0 : -1.0); }
        }
        resolved(SURE);
        TEST_ASSERT_EQUAL_INT(4, ints.n);
        if (mm <= 5) { TEST_ASSERT_EQUAL_INT(PEL_INT_OK, ints.reason); }
        band += nav.counters.fix_band - good.counters.fix_band;
        chi2 += nav.counters.fix_chi2 - good.counters.fix_chi2;
        ratio += nav.counters.fix_ratio - good.counters.fix_ratio;
    }
    TEST_ASSERT_GREATER_THAN_UINT32(4,
                                    band); /* first it leaves its band, then it fits no more, then another is as good */
    TEST_ASSERT_GREATER_THAN_UINT32(4, chi2);
    TEST_ASSERT_GREATER_THAN_UINT32(4, ratio);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(phases_that_can_be_integers_take_part);
    RUN_TEST(codes_take_part_where_both_ends_have_one);
    RUN_TEST(glonass_phases_need_their_code);
    RUN_TEST(rows_of_a_group_without_a_pivot_are_left_out);
    RUN_TEST(fewer_than_four_are_not_tried);
    RUN_TEST(what_is_too_much_is_cut_from_below);
    RUN_TEST(a_problem_that_the_engine_refuses_is_none);
    RUN_TEST(a_number_too_large_to_be_told_is_not_fixed);
    RUN_TEST(a_fix_away_from_its_prior_is_counted_as_such);
    RUN_TEST(a_pair_outside_its_band_is_counted_as_such);
    return UNITY_END();
}

/* test_ovt.c - agreement of integers over epochs: pivots change, satellites come and go, one cycle restarts the count. */
#include <string.h>

#include "pelorus/ambiguity_methods.h"
#include "unity.h"

static pel_ovt_t ovt;
static pel_ovt_verdict_t v;

void setUp(void)
{
    memset(&ovt, 0, sizeof ovt);
}
void tearDown(void) {}

/* Undifferenced integers of satellite s on carrier f; the tests change single ones. */
static int64_t cycles[2][12];

static void set_cycles(void)
{
    for (int f = 0; f < 2; f++) {
        for (int s = 0; s < 12; s++) { cycles[f][s] = 1000000007LL * (s + 1) + 31 * f; }
    }
}

/* One epoch of two carriers: satellites sat[0..n-1], the first is the pivot. */
static void push(int n, const uint8_t *sat, int needed)
{
    static pel_amb_problem_t p;
    int64_t N[PEL_MAX_AMB];
    memset(&p, 0, sizeof p);
    for (int f = 0; f < 2; f++) {
        p.group[p.n_groups++].sat = sat[0];
        for (int i = 1; i < n; i++) {
            p.row[p.n_rows] = (pel_amb_row_t){.group = (uint8_t)f,
                                              .sat = sat[i],
                                              .integer = true,
                                              .lambda_m = (f == 0) ? 0.190293672798 : 0.244210213425};
            N[p.n_rows++] = cycles[f][sat[i]] - cycles[f][sat[0]];
        }
    }
    pel_ovt_push(&ovt, &p, N, needed, &v);
}

static void the_same_integers_in_five_epochs_pass(void)
{
    const uint8_t sat[] = {3, 5, 7, 1, 9};
    set_cycles();
    for (int k = 1; k <= 6; k++) {
        push(5, sat, 5);
        TEST_ASSERT_EQUAL_INT32(k, v.epochs);
        TEST_ASSERT_EQUAL(k >= 5, v.passed);
        TEST_ASSERT_EQUAL_INT((k == 1) ? 0 : 8, v.n_compared);
    }
}

static void a_change_of_one_cycle_restarts_the_count(void)
{
    const uint8_t sat[] = {3, 5, 7, 1, 9};
    set_cycles();
    for (int k = 0; k < 4; k++) { push(5, sat, 5); }
    cycles[1][7]++;
    push(5, sat, 5);
    TEST_ASSERT_FALSE(v.passed);
    TEST_ASSERT_EQUAL_INT32(1, v.epochs);
    TEST_ASSERT_EQUAL_INT(7, v.sat_changed);
    for (int k = 0; k < 4; k++) { push(5, sat, 5); }
    TEST_ASSERT_TRUE(v.passed);
    TEST_ASSERT_EQUAL_INT(-1, v.sat_changed);
}

static void a_new_pivot_is_no_change(void)
{
    const uint8_t before[] = {3, 5, 7, 1, 9};
    const uint8_t after[] = {7, 3, 1, 9, 11}; /* 5 has set, 11 has risen, 7 is the pivot */
    set_cycles();
    for (int k = 0; k < 3; k++) { push(5, before, 5); }
    for (int k = 4; k <= 5; k++) {
        push(5, after, 5);
        TEST_ASSERT_EQUAL_INT32(k, v.epochs);
        TEST_ASSERT_EQUAL_INT((k == 4) ? 6 : 8, v.n_compared); /* of 3, 7, 1, 9 three differences on two carriers */
    }
    TEST_ASSERT_TRUE(v.passed);
    cycles[0][7]--; /* a wrong integer of the pivot shows in all others */
    push(5, after, 5);
    TEST_ASSERT_EQUAL_INT32(1, v.epochs);
}

static void too_few_common_satellites_say_nothing(void)
{
    const uint8_t before[] = {3, 5, 7};
    const uint8_t after[] = {7, 3, 1, 2};
    set_cycles();
    push(3, before, 2);
    push(4, after, 2); /* one difference on each carrier */
    TEST_ASSERT_EQUAL_INT(2, v.n_compared);
    TEST_ASSERT_FALSE(v.passed);
    TEST_ASSERT_EQUAL_INT32(1, v.epochs);
    push(4, after, 2);
    TEST_ASSERT_TRUE(v.passed);
    ovt.epochs = 0; /* an epoch without integers */
    push(4, after, 2);
    TEST_ASSERT_FALSE(v.passed);
}

/* Two groups of one carrier, each with satellites of its own: what they had in common is not known. */
static void satellites_of_different_groups_are_not_compared(void)
{
    static pel_amb_problem_t p;
    int64_t N[PEL_MAX_AMB] = {5, 6, 7, 8};
    memset(&p, 0, sizeof p);
    for (int i = 0; i < 4; i++) {
        p.row[p.n_rows++] =
            (pel_amb_row_t){.group = (uint8_t)(i / 2), .sat = (uint8_t)(10 + i), .integer = true, .lambda_m = 0.19};
    }
    p.n_groups = 2;
    p.group[0].sat = 1;
    p.group[1].sat = 2;
    pel_ovt_push(&ovt, &p, N, 2, &v);
    for (int i = 0; i < 4; i++) { p.row[i].group = 0; } /* all against satellite 1 now */
    p.n_groups = 1;
    N[2] = N[3] = 99;
    pel_ovt_push(&ovt, &p, N, 2, &v);
    TEST_ASSERT_EQUAL_INT(2, v.n_compared); /* the two that were of its group */
    TEST_ASSERT_EQUAL_INT(-1, v.sat_changed);
}

/* Rows without integers say nothing, and a group of such rows has no carrier. */
static void what_is_not_an_integer_is_not_remembered(void)
{
    static pel_amb_problem_t p;
    int64_t N[PEL_MAX_AMB] = {5, 6, 7, 8};
    memset(&p, 0, sizeof p);
    for (int i = 0; i < 4; i++) {
        p.row[p.n_rows++] =
            (pel_amb_row_t){.group = (uint8_t)(i / 2), .sat = (uint8_t)(10 + i), .integer = i == 1, .lambda_m = 0.19};
    }
    p.n_groups = 2;
    p.group[0].sat = 1;
    p.group[1].sat = 2;
    pel_ovt_push(&ovt, &p, N, 2, &v);
    TEST_ASSERT_EQUAL_INT(2, ovt.n); /* the pivot of the first group and one row */
    pel_ovt_push(&ovt, &p, N, 2, &v);
    TEST_ASSERT_EQUAL_INT(1, v.n_compared);
    TEST_ASSERT_EQUAL_INT32(1, v.epochs); /* too few to count as agreement */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_same_integers_in_five_epochs_pass);
    RUN_TEST(a_change_of_one_cycle_restarts_the_count);
    RUN_TEST(a_new_pivot_is_no_change);
    RUN_TEST(too_few_common_satellites_say_nothing);
    RUN_TEST(satellites_of_different_groups_are_not_compared);
    RUN_TEST(what_is_not_an_integer_is_not_remembered);
    return UNITY_END();
}

/* build: f32 f64 */
/* What a filter is asked that it cannot do: refused, and left as it was. */
#include <math.h>
#include <string.h>

#include "pelorus/filter.h"
#include "pelorus/math.h"
#include "unity.h"

#define N 6

static pel_ud_t ud, before;

void setUp(void)
{
    pel_real sd[N];
    for (int i = 0; i < N; i++) { sd[i] = (pel_real)(i + 1); }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, N, sd));
    for (int k = 0; k < N * (N - 1) / 2; k++) { ud.U[k] = PEL_R(0.1) * (pel_real)(k - 7); }
    for (int i = 0; i < N; i++) { ud.x[i] = PEL_R(0.5) * (pel_real)i; }
    before = ud;
}

void tearDown(void) {}

static void refused(pel_status_t expected, pel_status_t status)
{
    TEST_ASSERT_EQUAL(expected, status);
    TEST_ASSERT_EQUAL_MEMORY(&before, &ud, sizeof ud);
}

static void a_filter_of_no_or_too_many_states_is_none(void)
{
    pel_real sd[PEL_MAX_STATES + 1];
    for (int i = 0; i <= PEL_MAX_STATES; i++) { sd[i] = PEL_R(1.0); }
    refused(PEL_E_RANGE, pel_ud_init(&ud, 0, sd));
    refused(PEL_E_RANGE, pel_ud_init(&ud, PEL_MAX_STATES + 1, sd));
    static const double BAD[] = {0.0, -1.0, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        sd[2] = (pel_real)BAD[i];
        refused(PEL_E_NOT_POSDEF, pel_ud_init(&ud, 3, sd));
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, 1, sd));
    sd[2] = PEL_R(1.0);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, PEL_MAX_STATES, sd));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&ud));
}

static void indices_end_where_the_states_end(void)
{
    const pel_real a[N + 1] = {0};
    for (int k = 0; k < 2; k++) {
        const int i = (k == 0) ? -1 : N;
        refused(PEL_E_RANGE, pel_ud_assign(&ud, i, a, PEL_R(1.0)));
        refused(PEL_E_RANGE, pel_ud_set_variance(&ud, i, PEL_R(1.0)));
        refused(PEL_E_RANGE, pel_ud_negate(&ud, i));
        refused(PEL_E_RANGE, pel_ud_remove(&ud, i));
        refused(PEL_E_RANGE, pel_ud_clone(&ud, i, 0, PEL_R(1.0)));
        refused(PEL_E_RANGE, pel_ud_swap(&ud, (k == 0) ? -1 : N - 1)); /* the last has none behind it */
        refused(PEL_E_RANGE, pel_ud_insert(&ud, (k == 0) ? -1 : N + 1, PEL_R(1.0)));
    }
    refused(PEL_E_RANGE, pel_ud_clone(&ud, 2, -1, PEL_R(1.0)));
    refused(PEL_E_RANGE, pel_ud_clone(&ud, 2, 3, PEL_R(1.0))); /* a copy goes before its original */
    refused(PEL_E_RANGE, pel_ud_combine(&ud, -1, 2, PEL_R(1.0)));
    refused(PEL_E_RANGE, pel_ud_combine(&ud, 2, 2, PEL_R(1.0)));
    refused(PEL_E_RANGE, pel_ud_combine(&ud, 2, N, PEL_R(1.0)));
    refused(PEL_E_RANGE, pel_ud_combine(&ud, 2, 3, (pel_real)INFINITY));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_clone(&ud, N - 1, N - 1, PEL_R(1.0)));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_insert(&ud, N + 1, PEL_R(1.0)));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_swap(&ud, N));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_remove(&ud, N + 1));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&ud));
}

static void references_lie_among_what_they_are_of(void)
{
    static const struct {
        int first, n, p;
    } bad[] = {{-1, 3, 0}, {2, 3, 1}, {2, 3, 5}, {4, 3, 4}};
    for (int i = 0; i < 4; i++) {
        refused(PEL_E_RANGE, pel_ud_change_reference(&ud, bad[i].first, bad[i].n, bad[i].p));
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_change_reference(&ud, 3, 3, 3));
}

static void variances_that_cannot_be_are_refused(void)
{
    static const double BAD[] = {0.0, -1.0, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        const pel_real var = (pel_real)BAD[i];
        refused(PEL_E_NOT_POSDEF, pel_ud_set_variance(&ud, 1, var));
        refused(PEL_E_NOT_POSDEF, pel_ud_insert(&ud, 1, var));
        refused(PEL_E_NOT_POSDEF, pel_ud_clone(&ud, 1, 0, var));
    }
    const pel_real h[N] = {1};
    refused(PEL_E_NOT_POSDEF, pel_ud_update(&ud, h, 0, PEL_R(1.0), PEL_R(0.0), 0, NULL));
    refused(PEL_E_RANGE, pel_ud_update(&ud, h, -1, PEL_R(1.0), PEL_R(1.0), 0, NULL));
    refused(PEL_E_RANGE, pel_ud_update(&ud, h, N, PEL_R(1.0), PEL_R(1.0), 0, NULL));
}

static void the_last_state_stays(void)
{
    while (ud.n > 1) { TEST_ASSERT_EQUAL(PEL_OK, pel_ud_remove(&ud, 0)); }
    before = ud;
    refused(PEL_E_RANGE, pel_ud_remove(&ud, 0));
}

static void a_block_that_is_no_covariance_is_refused(void)
{
    static const double BAD[][3][3] = {
        {{1, 0, 0}, {0, 1, 0}, {0, 0, 0}},                            /* each pivot in turn not positive */
        {{1, 0, 0}, {0, 1, 2}, {0, 2, 1}},                            /* */
        {{1, 2, 0}, {2, 1, 0}, {0, 0, 1}},                            /* */
        {{1, 0, 0}, {0, 1, 0}, {0, 0, INFINITY}},                     /* no finite variance */
        {{1, 0, 0}, {0, 1, 0}, {0, 0, NAN}},                          /* */
        {{1, 0, 0}, {0, 1, 0}, {0, 0, PEL_REAL_DOUBLE ? -1 : 1e-60}}, /* positive only as double */
    };
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        refused(PEL_E_NOT_POSDEF, pel_ud_set_block3(&ud, 1, BAD[i]));
    }
    const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    refused(PEL_E_RANGE, pel_ud_set_block3(&ud, -1, unit));
    refused(PEL_E_RANGE, pel_ud_set_block3(&ud, N - 2, unit));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_set_block3(&ud, N - 3, unit));
}

/* A variance that has turned negative makes the innovation's smaller than the measurement's own: no gain can be had from that. */
static void a_row_on_a_filter_that_lost_its_factors_is_refused(void)
{
    const pel_real h[N] = {0, 0, 0, 0, 0, 1};
    ud.D[N - 1] = PEL_R(-0.5);
    before = ud;
    refused(PEL_E_RANGE, pel_ud_update(&ud, h, 0, PEL_R(0.1), PEL_R(1.0), 0, NULL));
}

static void health_sees_each_number(void)
{
    ud.U[4] = (pel_real)NAN;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_check(&ud));
    ud = before;
    ud.D[2] = (pel_real)INFINITY;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_check(&ud));
    ud = before;
    ud.x[N - 1] = (pel_real)-INFINITY;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_check(&ud));
    ud = before;
    ud.D[0] = PEL_R(0.0);
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_check(&ud));
}

/* ---- time updates ------------------------------------------------------------------------------------------------------ */

static pel_transition_t still(int n)
{
    pel_transition_t t;
    memset(&t, 0, sizeof t);
    t.n = n;
    return t;
}

static void transitions_that_do_not_fit_are_refused(void)
{
    pel_transition_t t = still(N - 1);
    refused(PEL_E_RANGE, pel_ud_time_update(&ud, &t));
    t = still(N);
    t.n_blocks = 1;
    t.block[0].row = N - 2;
    refused(PEL_E_RANGE, pel_ud_time_update(&ud, &t));
    t.block[0].row = 0;
    t.block[0].col = N - 2;
    refused(PEL_E_RANGE, pel_ud_time_update(&ud, &t));
    t.block[0].col = N - 3;
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&ud, &t));
}

static void noise_and_motion_have_room_for_so_many_states(void)
{
    pel_real sd[PEL_MAX_STATES];
    for (int i = 0; i < PEL_MAX_STATES; i++) { sd[i] = PEL_R(1.0); }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, PEL_MAX_STATES, sd));
    before = ud;
    pel_transition_t t = still(PEL_MAX_STATES);
    for (int i = 0; i <= PEL_UD_MAX_NOISE; i++) { t.q[i] = PEL_R(1.0); }
    refused(PEL_E_RANGE, pel_ud_time_update(&ud, &t));
    t = still(PEL_MAX_STATES);
    t.q[PEL_UD_MAX_MOVING] = PEL_R(1.0);
    refused(PEL_E_RANGE, pel_ud_time_update(&ud, &t));
    t = still(PEL_MAX_STATES);
    for (int i = 1; i <= PEL_UD_MAX_NOISE; i++) { t.q[PEL_UD_MAX_MOVING - i] = PEL_R(1.0); }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&ud, &t));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.0, (double)pel_ud_cov(&ud, PEL_UD_MAX_MOVING - 1, PEL_UD_MAX_MOVING - 1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, (double)pel_ud_cov(&ud, PEL_UD_MAX_MOVING, PEL_UD_MAX_MOVING));
}

static void states_that_a_step_wipes_out_are_what_its_noise_says(void)
{
    pel_transition_t t = still(N);
    t.n_blocks = 1;
    for (int i = 0; i < 3; i++) { /* x = 0 x + noise */
        t.block[0].m[i][i] = PEL_R(-1.0);
        t.q[i] = (pel_real)(2 + i);
    }
    const double kept = (double)pel_ud_cov(&ud, 4, 4);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&ud, &t));
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < N; j++) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-5, (i == j) ? 2.0 + i : 0.0, (double)pel_ud_cov(&ud, i, j));
        }
        TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)ud.x[i]);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, kept, (double)pel_ud_cov(&ud, 4, 4));
}

static void a_step_that_loses_the_factors_says_so(void)
{
    pel_transition_t t = still(N);
    t.q[2] = PEL_REAL_DOUBLE ? (pel_real)1.7e308 : (pel_real)3e38; /* with what is there: beyond the largest number */
    ud.D[2] = t.q[2];
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_time_update(&ud, &t));
    ud = before;
    t.q[2] = PEL_R(1.0);
    ud.D[1] = PEL_R(-1.0);
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_time_update(&ud, &t));
}

static void decay_of_more_than_all_or_by_no_number_is_refused(void)
{
    static const double BAD_DECAY[] = {-1.0, -2.0, NAN}, BAD_NOISE[] = {-1e-9, NAN};
    pel_real decay[N] = {0}, q[N] = {0};
    for (int i = 0; i < 3; i++) {
        decay[3] = (pel_real)BAD_DECAY[i];
        refused(PEL_E_RANGE, pel_ud_decay(&ud, decay, q));
    }
    decay[3] = PEL_R(-0.5);
    for (int i = 0; i < 2; i++) {
        q[5] = (pel_real)BAD_NOISE[i];
        refused(PEL_E_RANGE, pel_ud_decay(&ud, decay, q));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_filter_of_no_or_too_many_states_is_none);
    RUN_TEST(indices_end_where_the_states_end);
    RUN_TEST(references_lie_among_what_they_are_of);
    RUN_TEST(variances_that_cannot_be_are_refused);
    RUN_TEST(the_last_state_stays);
    RUN_TEST(a_block_that_is_no_covariance_is_refused);
    RUN_TEST(a_row_on_a_filter_that_lost_its_factors_is_refused);
    RUN_TEST(health_sees_each_number);
    RUN_TEST(transitions_that_do_not_fit_are_refused);
    RUN_TEST(noise_and_motion_have_room_for_so_many_states);
    RUN_TEST(states_that_a_step_wipes_out_are_what_its_noise_says);
    RUN_TEST(a_step_that_loses_the_factors_says_so);
    RUN_TEST(decay_of_more_than_all_or_by_no_number_is_refused);
    return UNITY_END();
}

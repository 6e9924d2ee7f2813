/* build: f32 f64 */
/* UD factors against a dense filter in double with Joseph's update: single operations on random problems, states that come
 * and go, refusals, the hash. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/bits.h"
#include "pelorus/math.h"
#include "support_dense.h"
#include "unity.h"

#define TOL (PEL_REAL_DOUBLE ? 1e-12 : 4e-5) /* of normalised covariances, after a few operations */

void setUp(void) {}
void tearDown(void) {}

static random_t rng = {1};

static void covariances_are_read_back(void)
{
    pel_ud_t ud;
    dense_t d;
    for (int k = 0; k < 50; k++) {
        const int n = 1 + k % PEL_MAX_STATES;
        random_filter(&rng, n, &ud, &d);
        TEST_ASSERT_TRUE(dense_compare(&d, &ud, NULL) < TOL);
        pel_real h[PEL_MAX_STATES];
        pel_real Ph[PEL_MAX_STATES];
        const int first = (int)random_uniform(&rng, 0.0, (double)n);
        for (int i = 0; i < n; i++) { h[i] = (pel_real)random_normal(&rng); }
        double want = 0.0;
        double scale = 0.0;
        pel_ud_ph(&ud, h, first, Ph);
        for (int i = 0; i < n; i++) {
            double row = 0.0;
            for (int j = first; j < n; j++) { row += d.P[i][j] * (double)h[j]; }
            double size = 1e-30;
            for (int j = first; j < n; j++) { size += fabs(d.P[i][j] * (double)h[j]); }
            TEST_ASSERT_TRUE(fabs((double)Ph[i] - row) < 10.0 * TOL * (size + sqrt(d.P[i][i])));
            if (i >= first) {
                want += (double)h[i] * row;
                scale += fabs((double)h[i]) * size;
            }
        }
        TEST_ASSERT_TRUE(fabs((double)pel_ud_hph(&ud, h, first) - want) < TOL * scale);
    }
}

/* Random blocks anywhere, noise anywhere, untouched states at the end. */
static void time_updates_match_the_dense_filter(void)
{
    double worst = 0.0;
    double worst_x = 0.0;
    for (int trial = 0; trial < 400; trial++) {
        pel_ud_t ud;
        dense_t d;
        pel_transition_t t = {0};
        double Phi[DENSE_MAX][DENSE_MAX];
        double q[DENSE_MAX];
        const int n = 6 + trial % (PEL_MAX_STATES - 5);
        const int moving = (n < PEL_UD_MAX_MOVING) ? n : PEL_UD_MAX_MOVING;
        const int groups = n / 3;
        random_filter(&rng, n, &ud, &d);
        t.n = n;
        const int n_blocks = (int)random_uniform(&rng, 0.0, 13.0);
        for (int k = 0; k < n_blocks; k++) {
            const int row = 3 * (int)random_uniform(&rng, 0.0, (double)(moving / 3));
            const int col = 3 * (int)random_uniform(&rng, 0.0, (double)groups);
            t.block[t.n_blocks].row = (uint8_t)((trial % 4 == 0 && row + 3 < moving) ? row + (moving - row) % 2 : row);
            t.block[t.n_blocks].col = (uint8_t)col;
            for (int i = 0; i < 9; i++) {
                t.block[t.n_blocks].m[i / 3][i % 3] = (pel_real)random_uniform(&rng, -0.3, 0.3);
            }
            t.n_blocks++;
        }
        const int n_noise = trial % (PEL_UD_MAX_NOISE + 1);
        for (int k = 0; k < n_noise; k++) {
            t.q[(int)random_uniform(&rng, 0.0, (double)moving)] = (pel_real)pow(10.0, random_uniform(&rng, -4.0, 1.0));
        }
        dense_transition(&t, Phi, q);
        dense_time_update(&d, Phi, q);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&ud, &t));
        double ex;
        const double e = dense_compare(&d, &ud, &ex);
        worst = fmax(worst, e);
        worst_x = fmax(worst_x, ex);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&ud));
    }
    printf("  400 random time updates: P %.1e, x %.1e sigma\n", worst, worst_x);
    TEST_ASSERT_TRUE(worst < TOL);
    TEST_ASSERT_TRUE(worst_x < TOL);
}

static void measurement_updates_match_the_dense_filter(void)
{
    double worst = 0.0;
    double worst_x = 0.0;
    for (int trial = 0; trial < 500; trial++) {
        pel_ud_t ud;
        dense_t d;
        const int n = 1 + trial % PEL_MAX_STATES;
        random_filter(&rng, n, &ud, &d);
        for (int k = 0; k < 4; k++) {
            pel_real h[PEL_MAX_STATES];
            double hd[PEL_MAX_STATES];
            const int first = (int)random_uniform(&rng, 0.0, (double)n);
            for (int i = 0; i < n; i++) {
                h[i] = (i < first) ? (pel_real)NAN : (pel_real)random_normal(&rng); /* below `first` nothing is read */
                hd[i] = (i < first) ? 0.0 : (double)h[i];
            }
            const pel_real z = (pel_real)random_normal(&rng);
            const pel_real var = (pel_real)pow(10.0, random_uniform(&rng, -2.0, 2.0));
            double hph = (double)var;
            double innov = (double)z;
            for (int i = 0; i < n; i++) {
                innov -= hd[i] * d.x[i];
                for (int j = 0; j < n; j++) { hph += hd[i] * hd[j] * d.P[i][j]; }
            }
            pel_real nis;
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_update(&ud, h, first, z, var, PEL_R(0.0), &nis));
            TEST_ASSERT_DOUBLE_WITHIN(100.0 * TOL * (1.0 + innov * innov / hph), innov * innov / hph, (double)nis);
            dense_update(&d, hd, (double)z, (double)var);
        }
        double ex;
        worst = fmax(worst, dense_compare(&d, &ud, &ex));
        worst_x = fmax(worst_x, ex);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&ud));
    }
    printf("  2000 random rows: P %.1e, x %.1e sigma\n", worst, worst_x);
    TEST_ASSERT_TRUE(worst < 20.0 * TOL);
    TEST_ASSERT_TRUE(worst_x < 100.0 * TOL);
}

static void a_rejected_row_leaves_the_filter_untouched(void)
{
    pel_ud_t ud;
    dense_t d;
    random_filter(&rng, 10, &ud, &d);
    const pel_ud_t before = ud;
    pel_real h[PEL_MAX_STATES] = {0};
    h[9] = PEL_R(1.0);
    const double var9 = d.P[9][9] + 1.0;
    const pel_real far = (pel_real)((double)ud.x[9] + 10.0 * sqrt(var9));
    pel_real nis = PEL_R(-1.0);
    TEST_ASSERT_EQUAL(PEL_W_REJECTED, pel_ud_update(&ud, h, 9, far, PEL_R(1.0), PEL_R(5.0), &nis));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 100.0, (double)nis);
    TEST_ASSERT_EQUAL_MEMORY(&before, &ud, sizeof ud);

    nis = PEL_R(-1.0);
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_update(&ud, h, 9, PEL_R(0.0), PEL_R(0.0), PEL_R(0.0), &nis));
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_update(&ud, h, 9, PEL_R(0.0), (pel_real)NAN, PEL_R(0.0), &nis));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_update(&ud, h, 9, (pel_real)NAN, PEL_R(1.0), PEL_R(0.0), &nis));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_update(&ud, h, 10, PEL_R(0.0), PEL_R(1.0), PEL_R(0.0), &nis));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_update(&ud, h, -1, PEL_R(0.0), PEL_R(1.0), PEL_R(0.0), &nis));
    h[9] = (pel_real)INFINITY;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_update(&ud, h, 9, PEL_R(0.0), PEL_R(1.0), PEL_R(0.0), &nis));
    TEST_ASSERT_EQUAL_MEMORY(&before, &ud, sizeof ud);
    TEST_ASSERT_TRUE(nis == PEL_R(-1.0));
}

static void delete_state(dense_t *d, int s)
{
    for (int i = 0; i < d->n; i++) {
        for (int j = s; j + 1 < d->n; j++) { d->P[i][j] = d->P[i][j + 1]; }
    }
    for (int i = s; i + 1 < d->n; i++) {
        for (int j = 0; j + 1 < d->n; j++) { d->P[i][j] = d->P[i + 1][j]; }
        d->x[i] = d->x[i + 1];
    }
    d->n--;
}

static void insert_state(dense_t *d, int s)
{
    for (int i = 0; i < d->n; i++) {
        for (int j = d->n; j > s; j--) { d->P[i][j] = d->P[i][j - 1]; }
        d->P[i][s] = 0.0;
    }
    for (int i = d->n; i > s; i--) {
        for (int j = 0; j <= d->n; j++) { d->P[i][j] = d->P[i - 1][j]; }
        d->x[i] = d->x[i - 1];
    }
    d->n++;
    for (int j = 0; j < d->n; j++) { d->P[s][j] = 0.0; }
    d->x[s] = 0.0;
}

static void states_come_and_go_as_in_dense_algebra(void)
{
    double worst = 0.0;
    for (int trial = 0; trial < 600; trial++) {
        pel_ud_t ud;
        dense_t d;
        const int n = 4 + trial % (PEL_MAX_STATES - 4);
        random_filter(&rng, n, &ud, &d);
        const int s = (int)random_uniform(&rng, 0.0, (double)n);
        const pel_real var = (pel_real)random_uniform(&rng, 0.1, 4.0);
        switch (trial % 5) {
        case 0:
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_remove(&ud, s));
            delete_state(&d, s);
            break;
        case 1: {
            const int at = (int)random_uniform(&rng, 0.0, (double)(n + 1));
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_insert(&ud, at, var));
            insert_state(&d, at);
            d.P[at][at] = (double)var;
            break;
        }
        case 2: {
            const int at = (int)random_uniform(&rng, 0.0, (double)(s + 1));
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_clone(&ud, s, at, var));
            insert_state(&d, at);
            for (int j = 0; j < d.n; j++) {
                if (j != at) { d.P[at][j] = d.P[j][at] = d.P[s + 1][j]; }
            }
            d.P[at][at] = d.P[s + 1][s + 1] + (double)var;
            d.x[at] = d.x[s + 1];
            break;
        }
        case 3:
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_set_variance(&ud, s, var));
            for (int j = 0; j < n; j++) { d.P[s][j] = d.P[j][s] = 0.0; }
            d.P[s][s] = (double)var;
            d.x[s] = 0.0;
            break;
        default: {
            const int f = (s + 3 <= n) ? s : n - 3;
            double A[3][3];
            double P[3][3];
            for (int i = 0; i < 9; i++) { A[i / 3][i % 3] = random_normal(&rng); }
            pel_mat3_mult(A, A, P);
            for (int i = 0; i < 3; i++) { P[i][i] += 0.1; }
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_set_block3(&ud, f, P));
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < n; j++) { d.P[f + i][j] = d.P[j][f + i] = 0.0; }
                d.x[f + i] = 0.0;
            }
            for (int i = 0; i < 9; i++) { d.P[f + i / 3][f + i % 3] = P[i / 3][i % 3]; }
            double back[3][3];
            pel_ud_block3(&ud, f, f, back);
            for (int i = 0; i < 9; i++) { TEST_ASSERT_DOUBLE_WITHIN(1e4 * TOL, P[i / 3][i % 3], back[i / 3][i % 3]); }
            break;
        }
        }
        double ex;
        worst = fmax(worst, dense_compare(&d, &ud, &ex));
        worst = fmax(worst, ex);
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&ud));
    }
    printf("  600 x remove, insert, clone, set: %.1e\n", worst);
    TEST_ASSERT_TRUE(worst < TOL);

    pel_ud_t full;
    dense_t d;
    random_filter(&rng, PEL_MAX_STATES, &full, &d);
    const pel_ud_t before = full;
    const double bad[3][3] = {{1.0, 2.0, 0.0}, {2.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    TEST_ASSERT_EQUAL(PEL_E_FULL, pel_ud_insert(&full, 0, PEL_R(1.0)));
    TEST_ASSERT_EQUAL(PEL_E_FULL, pel_ud_clone(&full, 1, 0, PEL_R(1.0)));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_remove(&full, PEL_MAX_STATES));
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_set_block3(&full, 0, bad));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_set_block3(&full, INT32_MAX, bad));
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_set_variance(&full, 3, PEL_R(0.0)));
    TEST_ASSERT_EQUAL_MEMORY(&before, &full, sizeof full);
}

static void markov_states_decay(void)
{
    for (int trial = 0; trial < 100; trial++) {
        pel_ud_t ud;
        dense_t d;
        const int n = 2 + trial % (PEL_MAX_STATES - 1);
        pel_real decay[PEL_MAX_STATES];
        pel_real q[PEL_MAX_STATES];
        double Phi[DENSE_MAX][DENSE_MAX] = {{0}};
        double qd[DENSE_MAX];
        random_filter(&rng, n, &ud, &d);
        for (int i = 0; i < n; i++) {
            decay[i] = (i % 3 == 0) ? PEL_R(0.0) : (pel_real)random_uniform(&rng, -0.5, 0.0);
            q[i] = (i % 4 == 0) ? (pel_real)random_uniform(&rng, 0.0, 1.0) : PEL_R(0.0);
            Phi[i][i] = 1.0 + (double)decay[i];
            qd[i] = (double)q[i];
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_decay(&ud, decay, q));
        dense_time_update(&d, Phi, qd);
        double ex;
        TEST_ASSERT_TRUE(dense_compare(&d, &ud, &ex) < TOL);
        TEST_ASSERT_TRUE(ex < TOL);
    }
}

static void blocks_are_their_elements_wherever_they_lie(void)
{
    pel_ud_t ud;
    dense_t d;
    double P[3][3];
    random_filter(&rng, 11, &ud, &d);
    for (int k = 0; k < 9 * 9; k++) { /* on the diagonal, beside it, above and below */
        const int i = k / 9;
        const int j = k % 9;
        pel_ud_block3(&ud, i, j, P);
        for (int e = 0; e < 9; e++) {
            const double cov = (double)pel_ud_cov(&ud, i + e / 3, j + e % 3);
            TEST_ASSERT_TRUE(P[e / 3][e % 3] == cov);
        }
    }
}

static void the_variance_of_a_sum_is_that_of_its_parts(void)
{
    pel_ud_t ud;
    dense_t d;
    random_filter(&rng, 11, &ud, &d);
    for (int i = 0; i < 11; i++) {
        for (int j = 0; j < 11; j++) {
            if (i == j) { continue; }
            const double expected = d.P[i][i] + d.P[j][j] + 2.0 * d.P[i][j];
            const double scale = d.P[i][i] + d.P[j][j];
            TEST_ASSERT_DOUBLE_WITHIN(TOL * scale, expected, (double)pel_ud_var_of_sum(&ud, i, j));
        }
    }
}

static void the_hash_sees_every_number_and_no_padding(void)
{
    pel_ud_t ud;
    dense_t d;
    random_filter(&rng, 9, &ud, &d);
    const uint32_t h = pel_ud_hash(&ud, PEL_FNV_START);
    pel_ud_t other = ud;
    other.U[36] = PEL_R(99.0); /* beyond 9 states */
    other.D[9] = PEL_R(99.0);
    TEST_ASSERT_EQUAL_HEX32(h, pel_ud_hash(&other, PEL_FNV_START));
    for (int k = 0; k < 36 + 9 + 9; k++) {
        other = ud;
        pel_real *v = (k < 36) ? &other.U[k] : ((k < 45) ? &other.D[k - 36] : &other.x[k - 45]);
        *v = *v * PEL_R(1.000001) + PEL_R(1e-6);
        TEST_ASSERT_TRUE(h != pel_ud_hash(&other, PEL_FNV_START));
    }
}

static void lost_factors_are_noticed(void)
{
    pel_ud_t ud;
    dense_t d;
    random_filter(&rng, 9, &ud, &d);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&ud));
    ud.D[4] = PEL_R(0.0);
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_check(&ud));
    ud.D[4] = (pel_real)NAN;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_check(&ud));
    pel_transition_t t = {.n = 9};
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_time_update(&ud, &t)); /* touches nothing */
    t.q[4] = PEL_R(1.0);
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_time_update(&ud, &t));
    random_filter(&rng, PEL_MAX_STATES, &ud, &d);
    t = (pel_transition_t){.n = PEL_MAX_STATES};
    t.q[PEL_MAX_STATES - 1] = PEL_R(1.0);
    const pel_ud_t before = ud;
    TEST_ASSERT_EQUAL((PEL_MAX_STATES > PEL_UD_MAX_MOVING) ? PEL_E_RANGE : PEL_OK, pel_ud_time_update(&ud, &t));
    if (PEL_MAX_STATES > PEL_UD_MAX_MOVING) { TEST_ASSERT_EQUAL_MEMORY(&before, &ud, sizeof ud); }
    t.n = 8;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_ud_time_update(&ud, &t));
}

/* Found by the proof ud_init: 1e-30 is positive and its square is not. */
static void deviations_whose_square_vanishes_or_overflows_are_refused(void)
{
    pel_ud_t ud;
    const pel_real tiny = (sizeof(pel_real) == 4) ? (pel_real)1e-30 : (pel_real)1e-200;
    const pel_real huge = PEL_R(1.0) / tiny;
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_init(&ud, 1, &tiny));
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_init(&ud, 1, &huge));
    const pel_real one = PEL_R(1.0);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, 1, &one));
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_ud_insert(&ud, 1, huge * huge));
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&ud));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(deviations_whose_square_vanishes_or_overflows_are_refused);
    RUN_TEST(covariances_are_read_back);
    RUN_TEST(time_updates_match_the_dense_filter);
    RUN_TEST(measurement_updates_match_the_dense_filter);
    RUN_TEST(a_rejected_row_leaves_the_filter_untouched);
    RUN_TEST(states_come_and_go_as_in_dense_algebra);
    RUN_TEST(markov_states_decay);
    RUN_TEST(blocks_are_their_elements_wherever_they_lie);
    RUN_TEST(the_variance_of_a_sum_is_that_of_its_parts);
    RUN_TEST(the_hash_sees_every_number_and_no_padding);
    RUN_TEST(lost_factors_are_noticed);
    return UNITY_END();
}

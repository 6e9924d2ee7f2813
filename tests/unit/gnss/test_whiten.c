/* Whitening of double differences: against a Cholesky factor in long double, and when rows are refused. */
/* build: f32 f64 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/gnss.h"
#include "unity.h"

#define M 12
#define N 4

void setUp(void) {}
void tearDown(void) {}

static const double R0 = 0.7;
static const double R[M] = {1.0, 0.2, 5.0, 0.9, 0.9, 2.5, 0.05, 1.1, 3.0, 0.4, 0.6, 8.0};

static double entry(int i, int k)
{
    return sin(1.7 * i + 0.9 * k + 0.3);
}

/* Rows (z, h) of the satellites in use, whitened by the unit factor of their dense covariance. */
static int dense(const bool use[M], long double w[M][N + 1], long double d[M])
{
    long double A[M][M];
    int index[M];
    int m = 0;
    for (int i = 0; i < M; i++) {
        if (use[i]) { index[m++] = i; }
    }
    for (int i = 0; i < m; i++) {
        for (int j = 0; j < m; j++) { A[i][j] = (long double)R0 + ((i == j) ? (long double)R[index[i]] : 0.0L); }
        for (int k = 0; k <= N; k++) { w[i][k] = (long double)entry(index[i], k); }
    }
    for (int j = 0; j < m; j++) { /* A = L D L', applied as it is made */
        d[j] = A[j][j];
        for (int i = j + 1; i < m; i++) {
            const long double l = A[i][j] / d[j];
            for (int k = 0; k <= N; k++) { w[i][k] -= l * w[j][k]; }
            for (int k = j + 1; k < m; k++) { A[i][k] -= l * A[j][k]; }
        }
    }
    return m;
}

static double largest_error(const bool use[M])
{
    static const double eps = (sizeof(pel_real) == 4) ? 1.2e-7 : 2.3e-16;
    long double w[M][N + 1];
    long double d[M];
    pel_whiten_t t;
    double worst = 0.0;
    int m = 0;
    (void)dense(use, w, d);
    TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_begin(&t, N, (pel_real)R0));
    for (int i = 0; i < M; i++) {
        pel_real z = (pel_real)entry(i, 0);
        pel_real h[N];
        pel_real var;
        for (int k = 0; k < N; k++) { h[k] = (pel_real)entry(i, k + 1); }
        if (!use[i]) { /* an outlier offered, and refused by the filter */
            z += (pel_real)1e4;
            TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_row(&t, (pel_real)R[i], &z, h, &var));
            continue;
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_row(&t, (pel_real)R[i], &z, h, &var));
        worst = fmax(worst, fabs((double)z - (double)w[m][0]));
        for (int k = 0; k < N; k++) { worst = fmax(worst, fabs((double)h[k] - (double)w[m][k + 1])); }
        worst = fmax(worst, fabs((double)var / (double)d[m] - 1.0));
        pel_whiten_accept(&t, (pel_real)R[i], z, h);
        m++;
    }
    return worst / eps;
}

static void rows_equal_those_of_the_dense_factor(void)
{
    bool all[M];
    memset(all, 1, sizeof all);
    const double e = largest_error(all);
    printf("12 rows: %.1f units of rounding\n", e);
    TEST_ASSERT_TRUE(e < 10.0);
}

static void a_refused_row_leaves_no_trace(void)
{
    for (unsigned mask = 0; mask < (1u << M); mask += 37u) {
        bool use[M];
        for (int i = 0; i < M; i++) { use[i] = ((mask >> i) & 1u) != 0u; }
        TEST_ASSERT_TRUE(largest_error(use) < 10.0);
    }
}

static void a_pivot_without_noise_leaves_rows_as_they_are(void)
{
    pel_whiten_t t;
    pel_real z = PEL_REAL_DOUBLE ? (pel_real)2.0 : (pel_real)2.0f;
    pel_real h[1] = {(pel_real)3.0};
    pel_real var;
    TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_begin(&t, 1, (pel_real)0.0));
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_row(&t, (pel_real)0.5, &z, h, &var));
        pel_whiten_accept(&t, (pel_real)0.5, z, h);
    }
    TEST_ASSERT_TRUE(z == (pel_real)2.0 && h[0] == (pel_real)3.0 && var == (pel_real)0.5);
}

static void impossible_variances_are_refused(void)
{
    pel_whiten_t t;
    pel_real z = (pel_real)1.0;
    pel_real var = (pel_real)9.0;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_whiten_begin(&t, -1, (pel_real)1.0));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_whiten_begin(&t, PEL_MAX_STATES + 1, (pel_real)1.0));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_whiten_begin(&t, 1, (pel_real)NAN));
    TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_begin(&t, 0, (pel_real)1.0));
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_whiten_row(&t, (pel_real)0.0, &z, NULL, &var));
    TEST_ASSERT_EQUAL(PEL_E_NOT_POSDEF, pel_whiten_row(&t, (pel_real)NAN, &z, NULL, &var));
    TEST_ASSERT_TRUE(z == (pel_real)1.0 && var == (pel_real)9.0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rows_equal_those_of_the_dense_factor);
    RUN_TEST(a_refused_row_leaves_no_trace);
    RUN_TEST(a_pivot_without_noise_leaves_rows_as_they_are);
    RUN_TEST(impossible_variances_are_refused);
    return UNITY_END();
}

/* Small matrices and rotations. */
#include <math.h>
#include <stdio.h>

#include "pelorus/math.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static uint64_t seed = 42;

static double uniform(double lo, double hi)
{
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return lo + (hi - lo) * (double)(seed >> 11) * 0x1p-53;
}

static void random_vector(double v[3], double size)
{
    for (int i = 0; i < 3; i++) { v[i] = uniform(-size, size); }
}

static double departure(const double A[3][3], const double B[3][3])
{
    double worst = 0.0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { worst = fmax(worst, fabs(A[i][j] - B[i][j])); }
    }
    return worst;
}

static const double IDENTITY[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};

/* exp([v x]) by its power series in long double */
static void series_exponential(const double v[3], double C[3][3])
{
    long double V[3][3] = {{0.0L, -v[2], v[1]}, {v[2], 0.0L, -v[0]}, {-v[1], v[0], 0.0L}};
    long double T[3][3] = {{1.0L, 0, 0}, {0, 1.0L, 0}, {0, 0, 1.0L}};
    long double S[3][3] = {{1.0L, 0, 0}, {0, 1.0L, 0}, {0, 0, 1.0L}};
    for (int n = 1; n < 50; n++) {
        long double N[3][3] = {{0}};
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                for (int k = 0; k < 3; k++) { N[i][j] += T[i][k] * V[k][j] / n; }
            }
        }
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                T[i][j] = N[i][j];
                S[i][j] += N[i][j];
            }
        }
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { C[i][j] = (double)S[i][j]; }
    }
}

static void rotation_vectors_and_matrices_agree(void)
{
    double worst = 0.0;
    double worst_orthogonal = 0.0;
    double worst_back = 0.0;
    double worst_near_pi = 0.0;
    for (int k = 0; k < 60000; k++) {
        double v[3];
        double C[3][3];
        double ref[3][3];
        double CtC[3][3];
        double back[3];
        random_vector(v, 1.0);
        const double size = pow(10.0, uniform(-9.0, 0.497));
        const double n = pel_unit3(v, v);
        if (n == 0.0) { continue; }
        for (int i = 0; i < 3; i++) { v[i] *= size; }
        pel_rotvec_to_dcm(v, C);
        series_exponential(v, ref);
        pel_mat3_tmul(C, C, CtC);
        worst = fmax(worst, departure(C, ref));
        worst_orthogonal = fmax(worst_orthogonal, departure(CtC, IDENTITY));
        pel_dcm_to_rotvec(C, back);
        for (int i = 0; i < 3; i++) {
            double *w = (size < 3.0) ? &worst_back : &worst_near_pi;
            *w = fmax(*w, fabs(back[i] - v[i]));
        }
    }
    printf("  exp: %.1e from its series, C'C - I %.1e; log(exp(v)) - v: %.1e below 3 rad, %.1e from 3 to 3.14\n", worst,
           worst_orthogonal, worst_back, worst_near_pi);
    TEST_ASSERT_TRUE(worst < 1e-15);
    TEST_ASSERT_TRUE(worst_orthogonal < 2e-15);
    TEST_ASSERT_TRUE(worst_back < 1e-14);
    TEST_ASSERT_TRUE(worst_near_pi < 1e-12);
}

static void half_turns_keep_their_axis(void)
{
    for (int k = 0; k < 1000; k++) {
        double v[3];
        double C[3][3];
        double back[3];
        random_vector(v, 1.0);
        (void)pel_unit3(v, v);
        for (int i = 0; i < 3; i++) { v[i] *= PEL_PI; }
        pel_rotvec_to_dcm(v, C);
        pel_dcm_to_rotvec(C, back);
        const double sign = (pel_dot3(v, back) < 0.0) ? -1.0 : 1.0; /* +pi and -pi are one rotation */
        for (int i = 0; i < 3; i++) { TEST_ASSERT_DOUBLE_WITHIN(1e-14, v[i], sign * back[i]); }
    }
}

static void orthonormalising_squares_the_error(void)
{
    double v[3] = {0.4, -1.1, 0.7};
    double C[3][3];
    double CtC[3][3];
    pel_rotvec_to_dcm(v, C);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { C[i][j] += uniform(-1e-6, 1e-6); }
    }
    pel_dcm_orthonormalise(C);
    pel_mat3_tmul(C, C, CtC);
    TEST_ASSERT_TRUE(departure(CtC, IDENTITY) < 2e-11);
    pel_dcm_orthonormalise(C);
    pel_mat3_tmul(C, C, CtC);
    TEST_ASSERT_TRUE(departure(CtC, IDENTITY) < 5e-16);
}

static void products_inverse_and_congruence_fit_together(void)
{
    for (int k = 0; k < 1000; k++) {
        double A[3][3];
        double B[3][3];
        double At[3][3];
        double C1[3][3];
        double C2[3][3];
        double inv[3][3];
        for (int i = 0; i < 3; i++) {
            random_vector(A[i], 2.0);
            random_vector(B[i], 2.0);
        }
        pel_mat3_transpose(A, At);
        pel_mat3_mul(At, B, C1);
        pel_mat3_tmul(A, B, C2);
        TEST_ASSERT_TRUE(departure(C1, C2) == 0.0);
        pel_mat3_mult(B, A, C1);
        pel_mat3_mul(B, At, C2);
        TEST_ASSERT_TRUE(departure(C1, C2) == 0.0);
        pel_mat3_congruence(A, B, C1);
        double AB[3][3];
        pel_mat3_mul(A, B, AB);
        pel_mat3_mul(AB, At, C2);
        TEST_ASSERT_TRUE(departure(C1, C2) == 0.0);
        if (pel_mat3_inverse(A, inv) == PEL_OK) {
            double size = 1.0;
            for (int i = 0; i < 3; i++) { size = fmax(size, pel_norm3(inv[i])); }
            pel_mat3_mul(A, inv, C1);
            TEST_ASSERT_TRUE(departure(C1, IDENTITY) < 1e-14 * size * size);
        }
        double x[3];
        double y[3];
        double z[3];
        random_vector(x, 1.0);
        pel_mat3_tvec(A, x, y);
        pel_mat3_vec(At, x, z);
        for (int i = 0; i < 3; i++) { TEST_ASSERT_TRUE(y[i] == z[i]); }
    }
    const double singular[3][3] = {{1.0, 2.0, 3.0}, {2.0, 4.0, 6.0}, {0.0, 1.0, 0.0}};
    double out[3][3] = {{7.0}};
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_mat3_inverse(singular, out));
    TEST_ASSERT_TRUE(out[0][0] == 7.0);
    double zero[3] = {0.0, 0.0, 0.0};
    TEST_ASSERT_TRUE(pel_unit3(zero, zero) == 0.0 && zero[0] == 0.0);
}

/* Turned by v in the frame it comes from and by C v in the frame it goes to, an attitude is the same; and back again. */
static void a_turn_is_the_same_in_either_frame(void)
{
    for (int i = 0; i < 1000; i++) {
        double at[3], v[3], back[3], Cv[3], C[3][3], from[3][3], to[3][3], series[3][3], want[3][3];
        random_vector(at, 3.0);
        random_vector(v, 1.5);
        pel_rotvec_to_dcm(at, C);
        pel_mat3_copy(C, from);
        pel_mat3_copy(C, to);
        pel_mat3_vec(C, v, Cv);
        series_exponential(v, series);
        pel_mat3_mul(C, series, want);
        pel_dcm_turn_from(from, v);
        pel_dcm_turn_to(to, Cv);
        TEST_ASSERT_TRUE(departure(want, from) < 2e-15);
        TEST_ASSERT_TRUE(departure(want, to) < 4e-15);
        for (int k = 0; k < 3; k++) { back[k] = -v[k]; }
        pel_dcm_turn_from(from, back);
        TEST_ASSERT_TRUE(departure(C, from) < 2e-15);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rotation_vectors_and_matrices_agree);
    RUN_TEST(half_turns_keep_their_axis);
    RUN_TEST(orthonormalising_squares_the_error);
    RUN_TEST(products_inverse_and_congruence_fit_together);
    RUN_TEST(a_turn_is_the_same_in_either_frame);
    return UNITY_END();
}

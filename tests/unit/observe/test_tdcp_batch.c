/* build: f32 f64 */
/* S3 12.5: the float-phase form is all time differences of a pass with their full correlation; the cloned form is the same differences called
 * white. Both against a batch solution in long double. Three constant parameters (a velocity), three satellites, 100 epochs. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/filter.h"
#include "pelorus/math.h"
#include "pelorus/observe.h"
#include "unity.h"

typedef long double ld;

enum { EPOCHS = 100, PAIRS = 2, ROWS = (EPOCHS - 1) * PAIRS };
#define SIGMA 3e-3
#define PRIOR 0.5
#define STEP  1.0

void setUp(void) {}
void tearDown(void) {}

static uint64_t seed = 0x9e3779b97f4a7c15u;
static double noise[EPOCHS][PAIRS + 1];

static double uniform(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return ((double)(seed >> 11) + 0.5) * 0x1p-53;
}

static void draw(void)
{
    for (int k = 0; k < EPOCHS; k++) {
        for (int i = 0; i <= PAIRS; i++) {
            noise[k][i] = SIGMA * sqrt(-2.0 * log(uniform())) * cos(6.283185307179586 * uniform());
        }
    }
}

/* Direction of a pair at an epoch: turning quickly enough for all three parameters to be seen. */
static void direction(int pair, int k, double g[3])
{
    const double a = 0.9 * pair + 0.02 * k;
    g[0] = sin(a) - 0.3;
    g[1] = cos(1.7 * a) + 0.2 * pair;
    g[2] = 0.5 * sin(2.3 * a + pair);
}

static const double TRUTH[3] = {0.11, -0.07, 0.19};

/* Phase of a pair: way along g with the time since the start, an unknown offset, noise. */
static double phase(int pair, int k)
{
    double g[3];
    direction(pair, k, g);
    return STEP * k * pel_dot3(g, TRUTH) + 17.0 * (pair + 1) + noise[k][pair + 1] - noise[k][0];
}

/* Least squares with prior: differences d = A v + n, covariance R full or without what neighbours share. */
static void batch(bool full, bool other_end, ld v[3], ld P[3][3])
{
    static ld R[ROWS][ROWS], A[ROWS][3], d[ROWS];
    memset(R, 0, sizeof R);
    for (int k = 1; k < EPOCHS; k++) {
        for (int p = 0; p < PAIRS; p++) {
            const int r = (k - 1) * PAIRS + p;
            double now[3], before[3];
            direction(p, k, now);
            direction(p, k - 1, before);
            d[r] = phase(p, k) - phase(p, k - 1);
            for (int j = 0; j < 3; j++) {
                /* the cloned form looks along today's line of sight at both ends */
                A[r][j] = other_end ? (ld)STEP * (k * (ld)now[j] - (k - 1) * (ld)before[j]) : (ld)STEP * (ld)now[j];
            }
            for (int q = 0; q < PAIRS; q++) {
                const ld pair = (ld)(SIGMA * SIGMA) * ((p == q) ? 2.0L : 1.0L);
                R[r][r - p + q] = 2.0L * pair;
                if (full && k > 1) { R[r][r - p + q - PAIRS] = R[r - p + q - PAIRS][r] = -pair; }
            }
            if (!other_end) {
                for (int j = 0; j < 3; j++) { d[r] -= (ld)(STEP * (k - 1) * (now[j] - before[j]) * TRUTH[j]); }
            }
        }
    }
    ld N[3][4] = {{0}};
    for (int j = 0; j < 3; j++) { N[j][j] = 1.0L / (ld)(PRIOR * PRIOR); }
    /* Cholesky of R, forward substitution of [A d] in place */
    for (int i = 0; i < ROWS; i++) {
        for (int j = 0; j <= i; j++) {
            ld s = R[i][j];
            for (int k = 0; k < j; k++) { s -= R[i][k] * R[j][k]; }
            R[i][j] = (i == j) ? sqrtl(s) : s / R[j][j];
        }
        for (int k = 0; k < i; k++) {
            for (int j = 0; j < 3; j++) { A[i][j] -= R[i][k] * A[k][j]; }
            d[i] -= R[i][k] * d[k];
        }
        for (int j = 0; j < 3; j++) { A[i][j] /= R[i][i]; }
        d[i] /= R[i][i];
        for (int a = 0; a < 3; a++) {
            for (int b = 0; b < 3; b++) { N[a][b] += A[i][a] * A[i][b]; }
            N[a][3] += A[i][a] * d[i];
        }
    }
    double M[3][3], inverse[3][3];
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) { M[a][b] = (double)N[a][b]; }
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_mat3_inverse(M, inverse));
    for (int a = 0; a < 3; a++) {
        v[a] = 0.0L;
        for (int b = 0; b < 3; b++) {
            P[a][b] = (ld)inverse[a][b];
            v[a] += (ld)inverse[a][b] * N[b][3];
        }
    }
}

static void compare(const char *name, const pel_ud_t *ud, int first, const ld v[3], const ld P[3][3], double tolerance)
{
    double worst = 0.0;
    for (int a = 0; a < 3; a++) {
        worst = fmax(worst, fabs((double)ud->x[first + a] - (double)v[a]) / sqrt((double)P[a][a]));
        for (int b = 0; b < 3; b++) {
            const double off = (double)pel_ud_cov(ud, first + a, first + b) - (double)P[a][b];
            worst = fmax(worst, fabs(off) / sqrt((double)(P[a][a] * P[b][b])));
        }
    }
    printf("  %s against its batch: %.1e sigma (sigma %.2e m/s)\n", name, worst, sqrt((double)P[0][0]));
    TEST_ASSERT_LESS_THAN_DOUBLE(tolerance, worst);
}

/* An epoch's rows, whitened against the shared satellite, into the filter; z is the state's own value (x is not fed back). */
static void take_in(pel_ud_t *ud, pel_real rows[PAIRS][PEL_MAX_STATES], const double z[PAIRS], double var, int first)
{
    pel_whiten_t w;
    TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_begin(&w, ud->n, (pel_real)var));
    for (int p = 0; p < PAIRS; p++) {
        pel_real white, value = (pel_real)z[p];
        TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_row(&w, (pel_real)var, &value, rows[p], &white));
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_update(ud, rows[p], first, value, white, PEL_R(0.0), NULL));
        pel_whiten_accept(&w, (pel_real)var, value, rows[p]);
    }
}

static void the_float_form_is_every_difference_with_its_correlation(void)
{
    const pel_real sd[5] = {PEL_R(0.5), PEL_R(0.5), PEL_R(0.5), PEL_R(100.0), PEL_R(100.0)};
    pel_ud_t ud;
    ld v[3], P[3][3];
    draw();
    batch(true, true, v, P);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, 5, sd));
    for (int k = 0; k < EPOCHS; k++) {
        pel_real rows[PAIRS][PEL_MAX_STATES];
        double z[PAIRS];
        for (int p = 0; p < PAIRS; p++) {
            double g[3];
            direction(p, k, g);
            for (int j = 0; j < 5; j++) { rows[p][j] = (j < 3) ? (pel_real)(STEP * k * g[j]) : PEL_R(0.0); }
            rows[p][3 + p] = PEL_R(1.0);
            z[p] = phase(p, k) - 17.0 * (p + 1);
        }
        take_in(&ud, rows, z, SIGMA * SIGMA, 0);
    }
    compare("float form", &ud, 0, v, P, PEL_REAL_DOUBLE ? 1e-6 : 2e-2);
}

static void the_cloned_form_is_the_differences_called_white(void)
{
    /* c (the way so far at the previous epoch, 3 states), then the velocity */
    const pel_real sd[6] = {PEL_R(1e-3), PEL_R(1e-3), PEL_R(1e-3), PEL_R(0.5), PEL_R(0.5), PEL_R(0.5)};
    pel_ud_t ud;
    ld v[3], P[3][3];
    draw();
    batch(false, false, v, P);
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&ud, 6, sd));
    for (int k = 0; k < EPOCHS; k++) {
        pel_real rows[PAIRS][PEL_MAX_STATES];
        double z[PAIRS];
        for (int p = 0; p < PAIRS && k > 0; p++) {
            double g[3], before[3];
            direction(p, k, g);
            direction(p, k - 1, before);
            z[p] = phase(p, k) - phase(p, k - 1);
            for (int j = 0; j < 3; j++) {
                rows[p][j] = (pel_real)-g[j];
                rows[p][3 + j] = (pel_real)(STEP * k * g[j]);
                z[p] -= STEP * (k - 1) * (g[j] - before[j]) * TRUTH[j];
            }
        }
        if (k > 0) { take_in(&ud, rows, z, 2.0 * SIGMA * SIGMA, 0); }
        for (int j = 0; j < 3; j++) {
            pel_real a[PEL_MAX_STATES] = {PEL_R(0.0)};
            a[3 + j] = (pel_real)(STEP * k);
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_assign(&ud, j, a, PEL_R(1e-14)));
        }
    }
    compare("cloned form", &ud, 3, v, P, PEL_REAL_DOUBLE ? 1e-6 : 2e-2);
}

static void calling_shared_noise_white_widens_sigma_several_times(void)
{
    ld v[3], P[3][3], v_white[3], P_white[3][3];
    draw();
    batch(true, true, v, P);
    batch(false, true, v_white, P_white);
    printf("  sigma when shared epochs are called white: %.1f times\n", sqrt((double)(P_white[0][0] / P[0][0])));
    TEST_ASSERT_GREATER_THAN_DOUBLE(3.0, sqrt((double)(P_white[0][0] / P[0][0])));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_float_form_is_every_difference_with_its_correlation);
    RUN_TEST(the_cloned_form_is_the_differences_called_white);
    RUN_TEST(calling_shared_noise_white_widens_sigma_several_times);
    return UNITY_END();
}

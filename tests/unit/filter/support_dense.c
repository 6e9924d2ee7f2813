#include "support_dense.h"

#include <math.h>
#include <string.h>

double random_uniform(random_t *r, double lo, double hi)
{
    r->s = r->s * 6364136223846793005ull + 1442695040888963407ull;
    uint64_t b = r->s;
    b ^= b >> 33; /* the low bits of the generator alone are poor */
    b *= 0xff51afd7ed558ccdull;
    b ^= b >> 33;
    return lo + (hi - lo) * (double)(b >> 11) * 0x1p-53;
}

double random_normal(random_t *r)
{
    const double u = random_uniform(r, 0x1p-53, 1.0);
    const double v = random_uniform(r, 0.0, 6.283185307179586);
    return sqrt(-2.0 * log(u)) * cos(v);
}

void random_filter(random_t *r, int n, pel_ud_t *ud, dense_t *d)
{
    pel_real sd[PEL_MAX_STATES] = {0};
    for (int i = 0; i < n; i++) { sd[i] = (pel_real)pow(10.0, random_uniform(r, -2.0, 1.0)); }
    (void)pel_ud_init(ud, n, sd);
    for (int k = 0; k < n * (n - 1) / 2; k++) { ud->U[k] = (pel_real)random_uniform(r, -1.0, 1.0); }
    memset(d, 0, sizeof *d);
    d->n = n;
    for (int i = 0; i < n; i++) {
        ud->x[i] = (pel_real)random_normal(r);
        d->x[i] = (double)ud->x[i];
        for (int j = 0; j < n; j++) {
            for (int k = (i > j) ? i : j; k < n; k++) {
                const double a = (i == k) ? 1.0 : (double)ud->U[k * (k - 1) / 2 + i];
                const double b = (j == k) ? 1.0 : (double)ud->U[k * (k - 1) / 2 + j];
                d->P[i][j] += a * b * (double)ud->D[k];
            }
        }
    }
}

void dense_init(dense_t *d, int n, const double sd[])
{
    memset(d, 0, sizeof *d);
    d->n = n;
    for (int i = 0; i < n; i++) { d->P[i][i] = sd[i] * sd[i]; }
}

void dense_transition(const pel_transition_t *t, double Phi[DENSE_MAX][DENSE_MAX], double q[])
{
    for (int i = 0; i < t->n; i++) {
        for (int j = 0; j < t->n; j++) { Phi[i][j] = (i == j) ? 1.0 : 0.0; }
        q[i] = (double)t->q[i];
    }
    for (int k = 0; k < t->n_blocks; k++) {
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                Phi[t->block[k].row + i][t->block[k].col + j] += (double)t->block[k].m[i][j];
            }
        }
    }
}

static void symmetrise(dense_t *d)
{
    for (int i = 0; i < d->n; i++) {
        for (int j = 0; j < i; j++) { d->P[i][j] = d->P[j][i] = 0.5 * (d->P[i][j] + d->P[j][i]); }
    }
}

void dense_time_update(dense_t *d, const double Phi[DENSE_MAX][DENSE_MAX], const double q[])
{
    const int n = d->n;
    static double T[DENSE_MAX][DENSE_MAX];
    double x[DENSE_MAX];
    for (int i = 0; i < n; i++) {
        x[i] = 0.0;
        for (int j = 0; j < n; j++) {
            T[i][j] = 0.0;
            for (int k = 0; k < n; k++) { T[i][j] += Phi[i][k] * d->P[k][j]; }
            x[i] += Phi[i][j] * d->x[j];
        }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            double s = (i == j) ? q[i] : 0.0;
            for (int k = 0; k < n; k++) { s += T[i][k] * Phi[j][k]; }
            d->P[i][j] = s;
        }
        d->x[i] = x[i];
    }
    symmetrise(d);
}

void dense_update(dense_t *d, const double h[], double z, double var)
{
    const int n = d->n;
    double Ph[DENSE_MAX];
    double alpha = var;
    double innov = z;
    for (int i = 0; i < n; i++) {
        Ph[i] = 0.0;
        for (int j = 0; j < n; j++) { Ph[i] += d->P[i][j] * h[j]; }
    }
    for (int i = 0; i < n; i++) {
        alpha += h[i] * Ph[i];
        innov -= h[i] * d->x[i];
    }
    static double A[DENSE_MAX][DENSE_MAX];
    static double q[DENSE_MAX][DENSE_MAX];
    double K[DENSE_MAX];
    for (int i = 0; i < n; i++) { K[i] = Ph[i] / alpha; }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            double s = 0.0; /* (P - K h P) */
            s = d->P[i][j] - K[i] * Ph[j];
            A[i][j] = s;
        }
    }
    for (int i = 0; i < n; i++) {
        double Ah = 0.0;
        for (int k = 0; k < n; k++) { Ah += A[i][k] * h[k]; }
        for (int j = 0; j < n; j++) { q[i][j] = A[i][j] - Ah * K[j] + K[i] * var * K[j]; }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) { d->P[i][j] = q[i][j]; }
        d->x[i] += K[i] * innov;
    }
    symmetrise(d);
}

double dense_compare(const dense_t *d, const pel_ud_t *ud, double *worst_x)
{
    double worst = (d->n == ud->n) ? 0.0 : 1e9;
    double wx = 0.0;
    for (int i = 0; i < d->n; i++) {
        for (int j = 0; j < d->n; j++) {
            const double e = fabs((double)pel_ud_cov(ud, i, j) - d->P[i][j]) / sqrt(d->P[i][i] * d->P[j][j]);
            if (!(e <= worst)) { worst = e; }
        }
        const double e = fabs((double)ud->x[i] - d->x[i]) / sqrt(d->P[i][i]);
        if (!(e <= wx)) { wx = e; }
    }
    if (worst_x != NULL) { *worst_x = wx; }
    return worst;
}

double dense_compare_sd(const dense_t *d, const pel_ud_t *ud)
{
    double worst = 0.0;
    for (int i = 0; i < d->n; i++) {
        const double e = fabs(sqrt((double)pel_ud_cov(ud, i, i) / d->P[i][i]) - 1.0);
        if (!(e <= worst)) { worst = e; }
    }
    return worst;
}

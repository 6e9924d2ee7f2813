#include "dense.h"

#include "pelorus/math.h"

void bench_dense_phi(const pel_transition_t *t, pel_real Phi[PEL_MAX_STATES][PEL_MAX_STATES])
{
    for (int i = 0; i < t->n; i++) {
        for (int j = 0; j < t->n; j++) { Phi[i][j] = (i == j) ? PEL_R(1.0) : PEL_R(0.0); }
    }
    for (int k = 0; k < t->n_blocks; k++) {
        for (int i = 0; i < 9; i++) {
            Phi[t->block[k].row + i / 3][t->block[k].col + i % 3] += t->block[k].m[i / 3][i % 3];
        }
    }
}

void bench_dense_time_update(bench_dense_t *d, const pel_real Phi[PEL_MAX_STATES][PEL_MAX_STATES], const pel_real q[])
{
    const int n = d->n;
    pel_real T[PEL_MAX_STATES][PEL_MAX_STATES];
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            pel_real s = PEL_R(0.0);
            for (int k = 0; k < n; k++) { s += Phi[i][k] * d->P[k][j]; }
            T[i][j] = s;
        }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            pel_real s = (i == j) ? q[i] : PEL_R(0.0);
            for (int k = 0; k < n; k++) { s += T[i][k] * Phi[j][k]; }
            d->P[i][j] = s;
            d->P[j][i] = s;
        }
    }
}

static pel_real gain(const bench_dense_t *d, const pel_real h[], pel_real var, pel_real Ph[])
{
    pel_real alpha = var;
    for (int i = 0; i < d->n; i++) {
        pel_real s = PEL_R(0.0);
        for (int j = 0; j < d->n; j++) { s += d->P[i][j] * h[j]; }
        Ph[i] = s;
        alpha += h[i] * s;
    }
    return alpha;
}

static void correct(bench_dense_t *d, const pel_real h[], const pel_real Ph[], pel_real z, pel_real alpha)
{
    pel_real innov = z;
    for (int i = 0; i < d->n; i++) { innov -= h[i] * d->x[i]; }
    for (int i = 0; i < d->n; i++) { d->x[i] += Ph[i] * innov / alpha; }
}

void bench_dense_update(bench_dense_t *d, const pel_real h[], pel_real z, pel_real var)
{
    pel_real Ph[PEL_MAX_STATES];
    const pel_real alpha = gain(d, h, var, Ph);
    correct(d, h, Ph, z, alpha);
    for (int i = 0; i < d->n; i++) {
        const pel_real k = Ph[i] / alpha;
        for (int j = 0; j <= i; j++) {
            d->P[i][j] -= k * Ph[j];
            d->P[j][i] = d->P[i][j];
        }
    }
}

void bench_dense_update_joseph(bench_dense_t *d, const pel_real h[], pel_real z, pel_real var)
{
    const int n = d->n;
    pel_real A[PEL_MAX_STATES][PEL_MAX_STATES];
    pel_real T[PEL_MAX_STATES][PEL_MAX_STATES];
    pel_real Ph[PEL_MAX_STATES];
    const pel_real alpha = gain(d, h, var, Ph);
    correct(d, h, Ph, z, alpha);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) { A[i][j] = ((i == j) ? PEL_R(1.0) : PEL_R(0.0)) - Ph[i] / alpha * h[j]; }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            pel_real s = PEL_R(0.0);
            for (int k = 0; k < n; k++) { s += A[i][k] * d->P[k][j]; }
            T[i][j] = s;
        }
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            pel_real s = Ph[i] / alpha * var * Ph[j] / alpha;
            for (int k = 0; k < n; k++) { s += T[i][k] * A[j][k]; }
            d->P[i][j] = s;
            d->P[j][i] = s;
        }
    }
}

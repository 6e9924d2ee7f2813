/* support_oracle.c - integer least squares in long double, without limits: what the engine's answers are held against.
 *
 * Shares nothing with the engine: Q = L D L' without pivoting, every row completely size-reduced at every visit, the inverse transform
 * kept as a matrix, a recursive search. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "support_ambiguity.h"

typedef long double real;

static struct {
    int n;
    real L[AMB_MAX][AMB_MAX], D[AMB_MAX], zhat[AMB_MAX];
    int64_t T[AMB_MAX][AMB_MAX]; /* N = T z */
    real w[AMB_MAX];
    int64_t z[AMB_MAX];
    oracle_t *out;
    int64_t best_z[ORACLE_BEST][AMB_MAX];
} o;

static void factor(const problem_t *p)
{
    for (int j = 0; j < o.n; j++) {
        o.D[j] = p->Q[j][j];
        for (int k = 0; k < j; k++) { o.D[j] -= o.L[j][k] * o.L[j][k] * o.D[k]; }
        for (int i = j + 1; i < o.n; i++) {
            real sum = p->Q[i][j];
            for (int k = 0; k < j; k++) { sum -= o.L[i][k] * o.L[j][k] * o.D[k]; }
            o.L[i][j] = sum / o.D[j];
        }
    }
}

static void reduce(int k)
{
    for (int j = k - 1; j >= 0; j--) {
        const real mu = roundl(o.L[k][j]);
        if (mu == 0) { continue; }
        for (int i = 0; i < j; i++) { o.L[k][i] -= mu * o.L[j][i]; }
        o.L[k][j] -= mu;
        o.zhat[k] -= mu * o.zhat[j];
        for (int i = 0; i < o.n; i++) { o.T[i][j] += (int64_t)mu * o.T[i][k]; }
    }
}

static void swap_real(real *a, real *b)
{
    const real t = *a;
    *a = *b;
    *b = t;
}

static void exchange(int k, real d_new)
{
    const real mu = o.L[k][k - 1];
    const real mu_new = mu * o.D[k - 1] / d_new;
    o.D[k] = o.D[k - 1] * o.D[k] / d_new;
    o.D[k - 1] = d_new;
    o.L[k][k - 1] = mu_new;
    for (int j = 0; j < k - 1; j++) { swap_real(&o.L[k][j], &o.L[k - 1][j]); }
    for (int i = k + 1; i < o.n; i++) {
        const real t = o.L[i][k];
        o.L[i][k] = o.L[i][k - 1] - mu * t;
        o.L[i][k - 1] = t + mu_new * o.L[i][k];
    }
    swap_real(&o.zhat[k], &o.zhat[k - 1]);
    for (int i = 0; i < o.n; i++) {
        const int64_t t = o.T[i][k];
        o.T[i][k] = o.T[i][k - 1];
        o.T[i][k - 1] = t;
    }
}

static void keep(real sq)
{
    int k = (o.out->n_found < ORACLE_BEST) ? o.out->n_found++ : ORACLE_BEST - 1;
    for (; k > 0 && o.out->sq[k - 1] > sq; k--) {
        o.out->sq[k] = o.out->sq[k - 1];
        memcpy(o.best_z[k], o.best_z[k - 1], sizeof o.best_z[k]);
    }
    o.out->sq[k] = sq;
    memcpy(o.best_z[k], o.z, sizeof o.z);
}

static void search(int p, real cost)
{
    if (p == o.n) {
        keep(cost);
        return;
    }
    real mean = o.zhat[p];
    for (int j = 0; j < p; j++) { mean -= o.L[p][j] * o.w[j]; }
    const int64_t nearest = (int64_t)llroundl(mean);
    const int64_t side = (mean < (real)nearest) ? -1 : 1;
    for (int64_t i = 0;; i++) { /* 0, 1, -1, 2, -2, ... towards the mean first */
        o.z[p] = nearest + side * ((i % 2 == 1) ? (i + 1) / 2 : -(i / 2));
        o.w[p] = mean - (real)o.z[p];
        const real sq = cost + o.w[p] * o.w[p] / o.D[p];
        if (o.out->n_found == ORACLE_BEST && sq >= o.out->sq[ORACLE_BEST - 1]) { return; }
        search(p + 1, sq);
    }
}

void oracle_solve(const problem_t *p, oracle_t *out)
{
    memset(&o, 0, sizeof o);
    o.n = p->n;
    o.out = out;
    out->n_found = 0;
    factor(p);
    int64_t origin[AMB_MAX];
    for (int i = 0; i < o.n; i++) {
        origin[i] = llround(p->a[i]);
        o.zhat[i] = (real)p->a[i] - (real)origin[i];
        o.T[i][i] = 1;
    }
    for (int k = 1; k < o.n;) {
        reduce(k);
        const real d_new = o.D[k] + o.L[k][k - 1] * o.L[k][k - 1] * o.D[k - 1];
        if (d_new < 0.999L * o.D[k - 1]) {
            exchange(k, d_new);
            k = (k > 1) ? k - 1 : 1;
        } else {
            k++;
        }
    }
    search(0, 0);
    for (int k = 0; k < ORACLE_BEST; k++) {
        for (int i = 0; i < o.n; i++) {
            out->N[k][i] = origin[i];
            for (int j = 0; j < o.n; j++) { out->N[k][i] += o.T[i][j] * o.best_z[k][j]; }
        }
    }
}

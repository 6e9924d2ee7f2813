/* support_problem.c - random integer problems as receivers meet them. */
#include <math.h>
#include <string.h>

#include "support_ambiguity.h"

#define PI      3.14159265358979323846
#define F1      1575.42e6
#define LIGHT   299792458.0
#define SYSTEMS 4

static const double carriers[SYSTEMS][3] = {
    {1575.42e6, 1227.60e6, 1176.45e6},  /* GPS */
    {1575.42e6, 1176.45e6, 1207.14e6},  /* Galileo */
    {1561.098e6, 1268.52e6, 1207.14e6}, /* BeiDou */
    {1575.42e6, 1227.60e6, 1176.45e6},  /* QZSS */
};

/* One epoch, or the mean of several. Satellite s belongs to system s % n_system, whose pivot is its own. */
typedef struct {
    int n_sat, n_carrier, n_system;
    double code, phase, iono; /* single differences: m at the zenith */
    bool prior;
    double prior_sd;
    double g[AMB_MAX][3]; /* -(u - u_pivot) */
    double var[AMB_MAX];  /* in units of the zenith's */
} epoch_t;

static void direction(rng_t *r, double low, double u[3])
{
    const double z = low + (0.97 - low) * rng_uniform(r);
    const double az = 2.0 * PI * rng_uniform(r);
    u[0] = sqrt(1.0 - z * z) * cos(az);
    u[1] = sqrt(1.0 - z * z) * sin(az);
    u[2] = z;
}

static epoch_t random_epoch(rng_t *r, int n)
{
    epoch_t e = {.n_carrier = rng_int(r, 1, 3)};
    while (n / e.n_carrier < 3 && e.n_carrier > 1) { e.n_carrier--; }
    e.n_sat = (n + e.n_carrier - 1) / e.n_carrier; /* the last satellites may lack a carrier */
    e.n_system = rng_int(r, 1, (e.n_sat < 8) ? 1 + e.n_sat / 4 : SYSTEMS);
    const double epochs = (rng_uniform(r) < 0.5) ? 1.0 : 1.0 + 300.0 * rng_uniform(r);
    e.code = (0.3 + 2.7 * rng_uniform(r)) / sqrt(epochs);
    e.phase = (0.002 + 0.004 * rng_uniform(r)) / sqrt(1.0 + (epochs - 1.0) / 20.0); /* multipath does not average */
    e.iono = 1e-6 * 100.0 * pow(600.0, rng_uniform(r)) * 1.4;                       /* 1 ppm of 0.1 to 60 km */
    e.prior = rng_uniform(r) < 0.3;
    e.prior_sd = 0.02 + rng_uniform(r);
    double pivot[SYSTEMS][3];
    for (int s = 0; s < e.n_system; s++) { direction(r, 0.85, pivot[s]); }
    for (int s = 0; s < e.n_sat; s++) {
        double u[3];
        direction(r, 0.17, u);
        for (int i = 0; i < 3; i++) { e.g[s][i] = -(u[i] - pivot[s % e.n_system][i]); }
        e.var[s] = 0.5 + 0.5 / (u[2] * u[2]);
    }
    return e;
}

/* Inverse of a symmetric positive definite 3 x 3 matrix. */
static void inverse3(double A[3][3], double out[3][3])
{
    const double c00 = A[1][1] * A[2][2] - A[1][2] * A[2][1];
    const double c01 = A[1][2] * A[2][0] - A[1][0] * A[2][2];
    const double c02 = A[1][0] * A[2][1] - A[1][1] * A[2][0];
    const double det = A[0][0] * c00 + A[0][1] * c01 + A[0][2] * c02;
    out[0][0] = c00 / det;
    out[1][1] = (A[0][0] * A[2][2] - A[0][2] * A[2][0]) / det;
    out[2][2] = (A[0][0] * A[1][1] - A[0][1] * A[1][0]) / det;
    out[0][1] = out[1][0] = c01 / det;
    out[0][2] = out[2][0] = c02 / det;
    out[1][2] = out[2][1] = (A[0][1] * A[2][0] - A[0][0] * A[2][1]) / det;
}

/* Covariance of the position from codes and prior: information with the weights of double differences,
 * W = D^-1 - D^-1 1 1' D^-1 / (1 / r_pivot + sum 1 / r), system by system. */
static void position_covariance(const epoch_t *e, double P[3][3])
{
    double M[3][3] = {{1e-4, 0, 0}, {0, 1e-4, 0}, {0, 0, 1e-4}}; /* 100 m */
    for (int k = 0; k < e->n_system; k++) {
        double sum_w = 1.0;
        double sum_g[3] = {0};
        for (int s = k; s < e->n_sat; s += e->n_system) {
            sum_w += 1.0 / e->var[s];
            for (int i = 0; i < 3; i++) { sum_g[i] += e->g[s][i] / e->var[s]; }
        }
        for (int i = 0; i < 9; i++) {
            double m = -sum_g[i / 3] * sum_g[i % 3] / sum_w;
            for (int s = k; s < e->n_sat; s += e->n_system) { m += e->g[s][i / 3] * e->g[s][i % 3] / e->var[s]; }
            M[i / 3][i % 3] += m * e->n_carrier / (2.0 * e->code * e->code);
        }
    }
    for (int i = 0; i < 3 && e->prior; i++) { M[i][i] += 1.0 / (e->prior_sd * e->prior_sd); }
    inverse3(M, P);
}

static void fill_covariance(const epoch_t *e, problem_t *p)
{
    double P[3][3];
    position_covariance(e, P);
    for (int i = 0; i < p->n; i++) {
        const int si = i % e->n_sat;
        const double fi = carriers[si % e->n_system][i / e->n_sat];
        for (int j = 0; j <= i; j++) {
            const int sj = j % e->n_sat;
            const double fj = carriers[sj % e->n_system][j / e->n_sat];
            double q = 0.0;
            for (int k = 0; k < 9; k++) { q += e->g[si][k / 3] * P[k / 3][k % 3] * e->g[sj][k % 3]; }
            if (si % e->n_system == sj % e->n_system) {
                const double share = 1.0 + ((si == sj) ? e->var[si] : 0.0); /* pivot, and the satellite itself */
                q += e->iono * e->iono * (F1 / fi) * (F1 / fi) * (F1 / fj) * (F1 / fj) * share;
                if (i / e->n_sat == j / e->n_sat) { q += 2.0 * e->phase * e->phase * share; }
            }
            p->Q[i][j] = p->Q[j][i] = q * fi * fj / (LIGHT * LIGHT);
        }
    }
}

/* Lower Cholesky factor in place, long double inside. */
static void cholesky(int n, double A[AMB_MAX][AMB_MAX])
{
    for (int j = 0; j < n; j++) {
        for (int i = j; i < n; i++) {
            long double sum = A[i][j];
            for (int k = 0; k < j; k++) { sum -= (long double)A[i][k] * A[j][k]; }
            A[i][j] = (i == j) ? (double)sqrtl(sum) : (double)(sum / A[j][j]);
        }
    }
}

problem_t problem_random(rng_t *r, int n)
{
    problem_t p = {.n = n};
    const epoch_t epoch = random_epoch(r, n);
    fill_covariance(&epoch, &p);
    static double L[AMB_MAX][AMB_MAX];
    memcpy(L, p.Q, sizeof L);
    cholesky(n, L);
    double e[AMB_MAX];
    for (int i = 0; i < n; i++) {
        e[i] = rng_gauss(r);
        p.truth[i] = (int64_t)floor((rng_uniform(r) - 0.5) * 2e9 * pow(rng_uniform(r), 8.0));
        p.a[i] = (double)p.truth[i];
        for (int j = 0; j <= i; j++) { p.a[i] += L[i][j] * e[j]; }
    }
    return p;
}

void problem_pack(const problem_t *p, double *packed)
{
    for (int i = 0; i < p->n; i++) {
        for (int j = 0; j <= i; j++) { *packed++ = p->Q[i][j]; }
    }
}

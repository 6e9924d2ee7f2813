#include "support_ambiguity.h"

#include <math.h>
#include <string.h>

#define PI    3.14159265358979323846
#define F1    1575.42e6
#define LIGHT 299792458.0

double rng_uniform(rng_t *r) /* splitmix64 (Steele, Lea, Flood 2014) */
{
    r->s += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = r->s;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

double rng_gauss(rng_t *r)
{
    const double u = 1.0 - rng_uniform(r);
    return sqrt(-2.0 * log(u)) * cos(2.0 * PI * rng_uniform(r));
}

int rng_int(rng_t *r, int low, int high)
{
    return low + (int)(rng_uniform(r) * (high - low + 1));
}

sky_t sky_of(double lat_deg, double lon_deg, double h_m, double t_s, double mask_deg)
{
    const double a = 6378137.0;
    const double e2 = 6.69437999014e-3;
    const double w_ie = 7.292115e-5;
    const double orbit = 26560e3;
    const double rate = sqrt(3.986004418e14 / (orbit * orbit * orbit));
    const double inc = 55.0 * PI / 180.0;
    const double lat = lat_deg * PI / 180.0;
    const double lon = lon_deg * PI / 180.0;
    const double N = a / sqrt(1.0 - e2 * sin(lat) * sin(lat));
    const double r[3] = {(N + h_m) * cos(lat) * cos(lon), (N + h_m) * cos(lat) * sin(lon),
                         (N * (1.0 - e2) + h_m) * sin(lat)};
    const double up[3] = {cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
    sky_t sky = {0};
    for (int k = 0; k < 24; k++) {
        const int p = k / 4;
        const int s = k % 4;
        const double node = 60.0 * p * PI / 180.0 - w_ie * t_s;
        const double u = (90.0 * s + 30.0 * p + 7.0 * s * p) * PI / 180.0 + rate * t_s;
        const double x = orbit * cos(u);
        const double y = orbit * sin(u);
        const double sat[3] = {x * cos(node) - y * cos(inc) * sin(node), x * sin(node) + y * cos(inc) * cos(node),
                               y * sin(inc)};
        double los[3];
        double d = 0.0;
        for (int i = 0; i < 3; i++) {
            los[i] = sat[i] - r[i];
            d += los[i] * los[i];
        }
        d = sqrt(d);
        const double el = asin((los[0] * up[0] + los[1] * up[1] + los[2] * up[2]) / d);
        if (el < mask_deg * PI / 180.0) { continue; }
        int at = sky.n++;
        for (; at > 0 && sky.el[at - 1] < el; at--) {
            sky.el[at] = sky.el[at - 1];
            sky.id[at] = sky.id[at - 1];
            memcpy(sky.u[at], sky.u[at - 1], sizeof sky.u[at]);
        }
        sky.el[at] = el;
        sky.id[at] = k;
        for (int i = 0; i < 3; i++) { sky.u[at][i] = los[i] / d; }
    }
    return sky;
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

problem_t problem_random(rng_t *r, int n)
{
    static const double carrier[3] = {1575.42e6, 1227.60e6, 1176.45e6};
    problem_t p = {.n = n};
    int n_carrier = rng_int(r, 1, 3);
    while (n / n_carrier < 3 && n_carrier > 1) { n_carrier--; }
    const int n_sat = (n + n_carrier - 1) / n_carrier; /* the last satellite may lack a carrier */
    const bool prior = rng_uniform(r) < 0.3;
    const double epochs = (rng_uniform(r) < 0.5) ? 1.0 : 1.0 + 300.0 * rng_uniform(r);
    const double code = (0.3 + 2.7 * rng_uniform(r)) / sqrt(epochs);
    const double phase = (0.002 + 0.004 * rng_uniform(r)) / sqrt(1.0 + (epochs - 1.0) / 20.0);
    const double iono = 1e-6 * 100.0 * pow(600.0, rng_uniform(r)) * 1.4; /* 1 ppm of 0.1 to 60 km */
    double g[AMB_MAX][3];
    double up0[3] = {0.1, 0.2, 0.97};
    double vr[AMB_MAX];
    for (int s = 0; s < n_sat; s++) { /* uniform above 10 degrees */
        const double z = 0.17 + 0.8 * rng_uniform(r);
        const double az = 2.0 * PI * rng_uniform(r);
        const double u[3] = {sqrt(1.0 - z * z) * cos(az), sqrt(1.0 - z * z) * sin(az), z};
        for (int i = 0; i < 3; i++) { g[s][i] = -(u[i] - up0[i]); }
        vr[s] = 0.5 + 0.5 / (z * z);
    }
    /* position from code and prior: information with DD weights W = D^-1 - D^-1 1 1' D^-1 / (1/r0 + sum 1/r) */
    double M[3][3] = {{1e-4, 0, 0}, {0, 1e-4, 0}, {0, 0, 1e-4}};
    if (prior) {
        const double sd = 0.02 + rng_uniform(r);
        for (int i = 0; i < 3; i++) { M[i][i] += 1.0 / (sd * sd); }
    }
    double sum_w = 1.0;
    double sum_g[3] = {0};
    for (int s = 0; s < n_sat; s++) {
        sum_w += 1.0 / vr[s];
        for (int i = 0; i < 3; i++) { sum_g[i] += g[s][i] / vr[s]; }
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double m = -sum_g[i] * sum_g[j] / sum_w;
            for (int s = 0; s < n_sat; s++) { m += g[s][i] * g[s][j] / vr[s]; }
            M[i][j] += m * n_carrier / (2.0 * code * code);
        }
    }
    double P[3][3];
    inverse3(M, P);
    for (int i = 0; i < n; i++) {
        const int si = i % n_sat;
        const double fi = carrier[i / n_sat];
        for (int j = 0; j <= i; j++) {
            const int sj = j % n_sat;
            const double fj = carrier[j / n_sat];
            double q = 0.0;
            for (int k = 0; k < 3; k++) {
                for (int l = 0; l < 3; l++) { q += g[si][k] * P[k][l] * g[sj][l]; }
            }
            const double same = (si == sj) ? vr[si] : 0.0;
            q += iono * iono * (F1 / fi) * (F1 / fi) * (F1 / fj) * (F1 / fj) * (same + 1.0);
            if (fi == fj) { q += 2.0 * phase * phase * (same + 1.0); }
            p.Q[i][j] = p.Q[j][i] = q * fi * fj / (LIGHT * LIGHT);
        }
    }
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

static double binomial_log(int k, int n, double p)
{
    return lgamma(n + 1.0) - lgamma(k + 1.0) - lgamma(n - k + 1.0) + k * log(p) + (n - k) * log1p(-p);
}

bool binomial_agrees(int k, int n, double p)
{
    if (p <= 0.0) { return k == 0; }
    if (p >= 1.0) { return k == n; }
    double below = 0.0;
    double above = 0.0;
    for (int i = 0; i <= n; i++) {
        const double w = exp(binomial_log(i, n, p));
        if (i <= k) { below += w; }
        if (i >= k) { above += w; }
    }
    return below > 0.005 && above > 0.005;
}

bool proportions_agree(int k, int n, double p_ref, int n_ref)
{
    /* The reference count is known to half a unit at best: 100 % of 500 is compatible with 99.1 %. */
    const double p = (double)k / n;
    const double pooled = (k + p_ref * n_ref + 0.5) / (n + n_ref + 1.0);
    const double sd = sqrt(pooled * (1.0 - pooled) * (1.0 / n + 1.0 / n_ref));
    return fabs(p - p_ref) <= 2.576 * sd + 0.5 / n + 0.5 / n_ref;
}

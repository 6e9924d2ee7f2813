/* transform.c - integers by whitening alone: "float transform full decorrelation" (S6 section 6), kept for comparison.
 *
 * With Q = L D L' and M = L^-1 the components of M (a - N) are independent with variances D. Each level's integers lie in an interval about
 * the one that makes its component zero. */
#include <string.h>

#include "ambiguity_internal.h"
#include "pelorus/ambiguity_methods.h"
#include "pelorus/math.h"

#define INTEGER_MAX   8388608.0 /* 2^23 */
#define PIVOT_MIN     1e-12
#define SPHERE_MISSES 1e-6

/* Where the depth-first search stands. */
typedef struct {
    int level;
    int32_t z[PEL_TRANSFORM_MAX];
    int32_t step[PEL_TRANSFORM_MAX];   /* to the next nearest integer */
    double mean[PEL_TRANSFORM_MAX];    /* integer that would make the component zero */
    double e[PEL_TRANSFORM_MAX];       /* a - z */
    double sum[PEL_TRANSFORM_MAX + 1]; /* squared norm of the levels before */
} walk_t;

/* Q = L D L' into M, then M = L^-1. */
static pel_status_t factor(const pel_transform_input_t *in, pel_transform_t *t)
{
    const int n = in->n;
    double D[PEL_TRANSFORM_MAX];
    double largest = 0.0;
    for (int i = 0; i < n; i++) { largest = pel_max(largest, tri_row_const(in->Q, i)[i]); }
    for (int i = 0; i < n; i++) {
        const double *q = tri_row_const(in->Q, i);
        double *l = tri_row(t->M, i);
        D[i] = q[i];
        for (int j = 0; j < i; j++) {
            const double *lj = tri_row_const(t->M, j);
            l[j] = q[j]; /* times D[j] until the row is complete */
            for (int k = 0; k < j; k++) { l[j] -= l[k] * lj[k]; }
        }
        for (int j = 0; j < i; j++) {
            const double unit = l[j] * t->inv_D[j];
            D[i] -= unit * l[j];
            l[j] = unit;
        }
        if (!(D[i] > PIVOT_MIN * largest) || !(D[i] < 1e12)) { return PEL_E_NOT_POSDEF; }
        l[i] = 1.0;
        t->inv_D[i] = 1.0 / D[i];
    }
    for (int i = 0; i < n; i++) { /* M_ij = -sum over k of L_ik M_kj, k = j..i-1; row i of L is used up from the left */
        double *row = tri_row(t->M, i);
        for (int j = 0; j < i; j++) {
            double sum = row[j];
            for (int k = j + 1; k < i; k++) { sum += row[k] * tri_row_const(t->M, k)[j]; }
            row[j] = -sum;
        }
    }
    return PEL_OK;
}

static void enter(const pel_transform_input_t *in, const pel_transform_t *t, walk_t *w, int level)
{
    const double *row = tri_row_const(t->M, level);
    double mean = in->a[level];
    for (int j = 0; j < level; j++) { mean += row[j] * w->e[j]; }
    mean = pel_max(pel_min(mean, 2.0 * INTEGER_MAX), -2.0 * INTEGER_MAX);
    w->level = level;
    w->mean[level] = mean;
    w->z[level] = nearest_integer(mean);
    w->step[level] = (mean < (double)w->z[level]) ? -1 : 1;
}

static void next_sibling(walk_t *w)
{
    const int32_t step = w->step[w->level];
    w->z[w->level] += step;
    w->step[w->level] = (step > 0) ? -step - 1 : -step + 1;
}

static double score(const pel_transform_input_t *in, const walk_t *w)
{
    if (in->metric == NULL) { return w->sum[in->n]; }
    double sum = 0.0;
    for (int i = 0; i < in->n; i++) {
        const double *row = tri_row_const(in->metric, i);
        for (int j = 0; j < i; j++) { sum += 2.0 * w->e[i] * row[j] * w->e[j]; }
        sum += w->e[i] * row[i] * w->e[i];
    }
    return sum;
}

static void keep(const pel_transform_input_t *in, const walk_t *w, pel_transform_t *t)
{
    const double sq = score(in, w);
    t->vectors++;
    int at = t->n_found;
    while (at > 0 && sq < t->score[at - 1]) { at--; }
    if (at >= 2) { return; }
    if (at == 0) {
        t->score[1] = t->score[0];
        memcpy(t->N[1], t->N[0], sizeof t->N[0]);
    }
    t->score[at] = sq;
    memcpy(t->N[at], w->z, sizeof t->N[at]);
    if (t->n_found < 2) { t->n_found++; }
}

/* Is the integer at hand, whose component is c^2 in variances, in the region? Those after it are farther. */
static bool inside(const pel_transform_input_t *in, const pel_transform_t *t, double c2, double sum, double sphere)
{
    if (in->region == PEL_TRANSFORM_BOX) { return c2 <= in->k * in->k; }
    return sum <= ((t->n_found == 2) ? pel_min(sphere, t->score[1]) : sphere);
}

static pel_status_t enumerate(const pel_transform_input_t *in, pel_transform_t *t)
{
    walk_t w;
    memset(&w, 0, sizeof w);
    const double sphere = pel_chi2_threshold(in->n, 1.0 - SPHERE_MISSES);
    enter(in, t, &w, 0);
    while (t->nodes < PEL_TRANSFORM_NODES) {
        const int p = w.level;
        const double c = w.mean[p] - (double)w.z[p];
        const double c2 = c * c * t->inv_D[p];
        t->nodes++;
        if (!inside(in, t, c2, w.sum[p] + c2, sphere)) {
            if (p == 0) { return (t->n_found > 0) ? PEL_OK : PEL_W_REJECTED; }
            w.level--;
            next_sibling(&w);
            continue;
        }
        w.e[p] = in->a[p] - (double)w.z[p];
        w.sum[p + 1] = w.sum[p] + c2;
        if (p + 1 < in->n) {
            enter(in, t, &w, p + 1);
        } else {
            keep(in, &w, t);
            next_sibling(&w);
        }
    }
    return PEL_W_BUDGET;
}

pel_status_t pel_transform_solve(const pel_transform_input_t *in, pel_transform_t *t)
{
    t->n_found = 0;
    t->nodes = 0;
    t->vectors = 0;
    if (in->n < 1 || in->n > PEL_TRANSFORM_MAX) { return PEL_E_RANGE; }
    const bool box = in->region == PEL_TRANSFORM_BOX;
    if (box ? !(in->k > 0.0 && in->k <= 100.0) : in->metric != NULL) { return PEL_E_RANGE; }
    for (int i = 0; i < in->n; i++) {
        if (!(pel_fabs(in->a[i]) < INTEGER_MAX)) { return PEL_E_RANGE; }
        for (int j = 0; j <= i; j++) {
            if (!pel_isfinite(tri_row_const(in->Q, i)[j])) { return PEL_E_RANGE; }
        }
    }
    const pel_status_t status = factor(in, t);
    return (status == PEL_OK) ? enumerate(in, t) : status;
}

/* Weights W of equal variances: (D D')^-1 = I - 1 1' / (n + 1), or I. The metric is lambda^2 / var (W - W G (G' W G)^-1 G' W). */
pel_status_t pel_transform_phase_metric(int n, const double (*g)[3], double lambda_m, double var_m2, bool whitened,
                                        double *metric)
{
    if (n < 4 || n > PEL_TRANSFORM_MAX || !(lambda_m > 0.0) || !(var_m2 > 0.0)) { return PEL_E_RANGE; }
    const double shared = whitened ? 1.0 / (n + 1) : 0.0;
    double total[3] = {0.0};
    double WG[PEL_TRANSFORM_MAX][3];
    double normal[3][3] = {{0.0}};
    double inverse[3][3];
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) { total[k] += g[i][k]; }
    }
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 3; k++) { WG[i][k] = g[i][k] - shared * total[k]; }
        for (int k = 0; k < 9; k++) { normal[k / 3][k % 3] += g[i][k / 3] * WG[i][k % 3]; }
    }
    if (pel_mat3_inverse(normal, inverse) != PEL_OK) { return PEL_E_GEOMETRY; }
    const double scale = lambda_m * lambda_m / var_m2;
    for (int i = 0; i < n; i++) {
        double y[3];
        pel_mat3_vec(inverse, WG[i], y);
        for (int j = 0; j <= i; j++) { tri_row(metric, i)[j] = scale * ((i == j) - shared - pel_dot3(y, WG[j])); }
    }
    return PEL_OK;
}

#include "normal.h"

#include <string.h>

#include "pelorus/math.h"

void pel_normal_begin(pel_normal_t *q, int n)
{
    memset(q, 0, sizeof *q);
    q->n = n;
}

void pel_normal_add(pel_normal_t *q, const double h[NORMAL_MAX], double z, double var)
{
    for (int i = 0; i < q->n; i++) {
        const double w = h[i] / var;
        q->b[i] += w * z;
        for (int j = 0; j <= i; j++) { q->N[i][j] += w * h[j]; }
    }
}

/* N = L L', in the lower triangle. */
static pel_status_t factor(pel_normal_t *q)
{
    for (int j = 0; j < q->n; j++) {
        double pivot = q->N[j][j];
        for (int k = 0; k < j; k++) { pivot -= q->N[j][k] * q->N[j][k]; }
        if (!(pivot > 1e-10 * q->N[j][j])) { return PEL_E_GEOMETRY; } /* also NaN, and a state nobody observed */
        const double root = pel_sqrt(pivot);
        q->N[j][j] = root;
        for (int i = j + 1; i < q->n; i++) {
            double s = q->N[i][j];
            for (int k = 0; k < j; k++) { s -= q->N[i][k] * q->N[j][k]; }
            q->N[i][j] = s / root;
        }
    }
    return PEL_OK;
}

/* Lower triangle: L <- L^-1. */
static void invert_factor(pel_normal_t *q)
{
    for (int j = 0; j < q->n; j++) {
        q->N[j][j] = 1.0 / q->N[j][j];
        for (int i = j + 1; i < q->n; i++) {
            double s = 0.0;
            for (int k = j; k < i; k++) { s -= q->N[i][k] * q->N[k][j]; }
            q->N[i][j] = s / q->N[i][i];
        }
    }
}

pel_status_t pel_normal_solve(pel_normal_t *q)
{
    double x[NORMAL_MAX];
    const pel_status_t status = factor(q);
    if (status != PEL_OK) { return status; }
    invert_factor(q);

    /* N^-1 = L^-T L^-1, column by column: entry (i, j) needs rows k >= i of L^-1 alone, so it can overwrite. */
    for (int i = 0; i < q->n; i++) {
        for (int j = 0; j <= i; j++) {
            double s = 0.0;
            for (int k = i; k < q->n; k++) { s += q->N[k][i] * q->N[k][j]; }
            q->N[i][j] = s;
        }
    }
    for (int i = 0; i < q->n; i++) {
        for (int j = 0; j < i; j++) { q->N[j][i] = q->N[i][j]; }
    }
    for (int i = 0; i < q->n; i++) {
        x[i] = 0.0;
        for (int j = 0; j < q->n; j++) { x[i] += q->N[i][j] * q->b[j]; }
    }
    memcpy(q->b, x, sizeof x[0] * (size_t)q->n);
    return PEL_OK;
}

double pel_normal_var(const pel_normal_t *q, const double h[NORMAL_MAX])
{
    double s = 0.0;
    for (int i = 0; i < q->n; i++) {
        double row = 0.0;
        for (int j = 0; j < q->n; j++) { row += q->N[i][j] * h[j]; }
        s += h[i] * row;
    }
    return s;
}

/* normal.h - normal equations of up to 8 unknowns: accumulate scalar observations, solve, invert. Private to src/gnss/. */
#ifndef PELORUS_GNSS_NORMAL_H
#define PELORUS_GNSS_NORMAL_H

#include "pelorus/base.h"

#define NORMAL_MAX 8

typedef struct {
    int n;
    double N[NORMAL_MAX][NORMAL_MAX]; /* sum of h h' / var; after pel_normal_solve() its inverse */
    double b[NORMAL_MAX];             /* sum of h z / var; after pel_normal_solve() the solution */
} pel_normal_t;

void pel_normal_begin(pel_normal_t *q, int n);
void pel_normal_add(pel_normal_t *q, const double h[NORMAL_MAX], double z, double var);

/* Solution into b, covariance into N. PEL_E_GEOMETRY if a Cholesky pivot falls below 1e-10 of its diagonal: contents are
 * then void. n^3 multiply-adds. */
pel_status_t pel_normal_solve(pel_normal_t *q);

/* h' N h after pel_normal_solve(): variance of a predicted observation. */
double pel_normal_var(const pel_normal_t *q, const double h[NORMAL_MAX]);

#endif

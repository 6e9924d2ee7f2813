/* support_dense.h - a filter with a full covariance in double, written without the library: what UD is held against. */
#ifndef SUPPORT_DENSE_H
#define SUPPORT_DENSE_H

#include "pelorus/filter.h"

#define DENSE_MAX PEL_MAX_STATES

typedef struct {
    int n;
    double P[DENSE_MAX][DENSE_MAX];
    double x[DENSE_MAX];
} dense_t;

/* Deterministic random numbers: uniform in [lo, hi), standard normal. */
typedef struct {
    uint64_t s;
} random_t;
double random_uniform(random_t *r, double lo, double hi);
double random_normal(random_t *r);

/* A random filter and its dense twin: unit upper triangular U with elements of order 1, D over six decades. */
void random_filter(random_t *r, int n, pel_ud_t *ud, dense_t *d);

void dense_init(dense_t *d, int n, const double sd[]);

/* P = Phi P Phi' + Q, x = Phi x, with Phi a full matrix. */
void dense_time_update(dense_t *d, const double Phi[DENSE_MAX][DENSE_MAX], const double q[]);

/* Phi and q of a transition, written out. */
void dense_transition(const pel_transition_t *t, double Phi[DENSE_MAX][DENSE_MAX], double q[]);

/* Scalar update in Joseph's form: P = (I - K h) P (I - K h)' + K var K'. */
void dense_update(dense_t *d, const double h[], double z, double var);

/* Largest |P_ud - P| / sqrt(P_ii P_jj), and of x in units of sigma (NULL allowed). */
double dense_compare(const dense_t *d, const pel_ud_t *ud, double *worst_x);

/* Largest relative difference of a standard deviation. */
double dense_compare_sd(const dense_t *d, const pel_ud_t *ud);

#endif

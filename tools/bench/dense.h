/* dense.h - the same filter with a full covariance matrix: what the library's is measured against. Plain, as textbooks write it. */
#ifndef BENCH_DENSE_H
#define BENCH_DENSE_H

#include "pelorus/filter.h"

typedef struct {
    int n;
    pel_real P[PEL_MAX_STATES][PEL_MAX_STATES];
    pel_real x[PEL_MAX_STATES];
} bench_dense_t;

/* P = Phi P Phi' + Q with Phi a full matrix. */
void bench_dense_time_update(bench_dense_t *d, const pel_real Phi[PEL_MAX_STATES][PEL_MAX_STATES], const pel_real q[]);

/* P = P - K h P; and Joseph's form, (I - K h) P (I - K h)' + K var K'. */
void bench_dense_update(bench_dense_t *d, const pel_real h[], pel_real z, pel_real var);
void bench_dense_update_joseph(bench_dense_t *d, const pel_real h[], pel_real z, pel_real var);

/* Phi of a transition, written out. */
void bench_dense_phi(const pel_transition_t *t, pel_real Phi[PEL_MAX_STATES][PEL_MAX_STATES]);

#endif

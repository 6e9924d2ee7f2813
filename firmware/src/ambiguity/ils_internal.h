/* ils_internal.h - what the files of the search engine share. */
#ifndef PELORUS_ILS_INTERNAL_H
#define PELORUS_ILS_INTERNAL_H

#include "pelorus/ambiguity.h"

/* Row i of a packed lower triangle. */
static inline double *tri_row(double *packed, int i)
{
    return &packed[i * (i + 1) / 2];
}
static inline const double *tri_row_const(const double *packed, int i)
{
    return &packed[i * (i + 1) / 2];
}

/* Begin with the covariance in s->LD and the float ambiguities in s->zhat (both filled by the caller). */
pel_status_t ils_start(pel_ils_t *s, int n, int n_best, int32_t budget);

/* Q in s->LD = L D L' in place, rows permuted (with zhat and back) so that each pivot is the smallest left. */
pel_status_t ils_factor(pel_ils_t *s);

/* Unimodular transform in place on L, D, zhat and back. PEL_E_RANGE: an entry of the transform beyond 31 bits. */
pel_status_t ils_decorrelate(pel_ils_t *s);

/* First node of the search. */
pel_status_t ils_first_node(pel_ils_t *s);

#endif

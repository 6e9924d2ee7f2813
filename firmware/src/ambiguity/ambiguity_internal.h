/* ambiguity_internal.h - what the files of the room share. */
#ifndef PELORUS_AMBIGUITY_INTERNAL_H
#define PELORUS_AMBIGUITY_INTERNAL_H

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
pel_status_t pel_ils_start(pel_ils_t *s, int n, int n_best, int32_t budget);

/* Q in s->LD = L D L' in place, rows permuted (with zhat and back) so that each pivot is the smallest left. */
pel_status_t pel_ils_factor(pel_ils_t *s);

/* Unimodular transform in place on L, D, zhat and back. PEL_E_RANGE: an entry of the transform beyond 31 bits. */
pel_status_t pel_ils_decorrelate(pel_ils_t *s);

/* First node of the search. */
pel_status_t pel_ils_first_node(pel_ils_t *s);

/* How badly each row's phase fits the position b that all of them give: squared residual over its variance, by row; 0 where no
 * integer is sought. N in the order of the rows with `integer`. */
void pel_amb_misfits(const pel_amb_problem_t *p, const int64_t *N, const double b[3], float misfit[PEL_MAX_AMB]);

#endif

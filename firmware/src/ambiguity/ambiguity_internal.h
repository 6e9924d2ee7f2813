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

/* For |x| < 2^30. */
static inline int32_t nearest_integer(double x)
{
    return (int32_t)((x < 0.0) ? x - 0.5 : x + 0.5);
}

/* Sum of a[i] b[i], i < n. */
static inline double dot(const double *a, const double *b, int n)
{
    double even = 0.0;
    double odd = 0.0;
    int i = 0;
    for (; i + 4 <= n; i += 4) {
        even += a[i] * b[i];
        odd += a[i + 1] * b[i + 1];
        even += a[i + 2] * b[i + 2];
        odd += a[i + 3] * b[i + 3];
    }
    for (; i < n; i++) { even += a[i] * b[i]; }
    return even + odd;
}

/* Begin with the covariance in s->LD and the float ambiguities in s->zhat (both filled by the caller). */
pel_status_t pel_ils_start(pel_ils_t *s, pel_ils_method_t method, int n, int n_best, int32_t budget);

/* Q in s->LD = L D L' in place, rows permuted (with zhat and order) so that each pivot is the smallest left, if `pivoting`. */
pel_status_t pel_ils_factor(pel_ils_t *s, bool pivoting);

/* Unimodular transform in place on L, D and zhat, noted step by step. */
void pel_ils_decorrelate(pel_ils_t *s);

/* First node of the search. */
pel_status_t pel_ils_first_node(pel_ils_t *s);

/* How badly each row's phase fits the position b that all of them give: squared residual over its variance, by row; 0 where no
 * integer is sought. N in the order of the rows with `integer`. */
void pel_amb_misfits(const pel_amb_problem_t *p, const int64_t *N, const double b[3], float misfit[PEL_MAX_AMB]);

/* The rows taking part when the caller asked: into r; and back from it. */
void pel_subset_remember(pel_amb_resolver_t *r, const pel_amb_problem_t *p);
void pel_subset_restore(const pel_amb_resolver_t *r, pel_amb_problem_t *p);

/* From the solution of all together: the satellites that fit worst; the rows in which best and second best are the same. */
void pel_subset_list_suspects(pel_amb_resolver_t *r, const pel_amb_problem_t *p, const pel_ils_t *s);
void pel_subset_note_agreement(pel_amb_resolver_t *r, const pel_amb_problem_t *p, const pel_ils_t *s);

/* Rows of the next subset; those for weakness only if `weak`. False: none left, all rows restored. */
bool pel_subset_next(pel_amb_resolver_t *r, pel_amb_problem_t *p, bool weak);

#endif

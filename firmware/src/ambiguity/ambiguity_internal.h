/* ambiguity_internal.h - what the files of the room share. */
#ifndef PELORUS_AMBIGUITY_INTERNAL_H
#define PELORUS_AMBIGUITY_INTERNAL_H

#include "pelorus/ambiguity.h"
#include "pelorus/math.h"

/* Row i of a packed lower triangle. */
static inline double *tri_row(double *packed, int i)
{
    return &packed[(i * (i + 1)) >> 1];
}
static inline const double *tri_row_const(const double *packed, int i)
{
    return &packed[(i * (i + 1)) >> 1];
}

static inline pel_real *real_row(pel_real *packed, int i)
{
    return &packed[(i * (i + 1)) >> 1];
}
static inline const pel_real *real_row_const(const pel_real *packed, int i)
{
    return &packed[(i * (i + 1)) >> 1];
}

static inline pel_real absolute(pel_real x)
{
    return (x < PEL_R(0.0)) ? -x : x;
}

/* For |x| < 2^30. */
static inline int32_t nearest_integer(double x)
{
    return (int32_t)((x < 0.0) ? x - 0.5 : x + 0.5);
}

/* Nearest integer as a number, for |x| < NEAREST_MAX: adding this pushes out the digits behind the point. */
#if PEL_REAL_DOUBLE
#define NEAREST_MAX 1073741824.0       /* 2^30 */
#define TO_INTEGER  6755399441055744.0 /* 1.5 2^52 */
#else
#define NEAREST_MAX 4194304.0f  /* 2^22 */
#define TO_INTEGER  12582912.0f /* 1.5 2^23 */
#endif
static inline pel_real nearest(pel_real x)
{
    return (x + TO_INTEGER) - TO_INTEGER;
}

/* a into origin and frac, Q = G G' with rows permuted (and frac and order with them) so that each pivot is the smallest left, if
 * `pivoting`; then LD and a_z from these. */
pel_status_t pel_ils_take_in(pel_ils_t *s, const double *a, const double *Q, bool pivoting);

/* Unimodular transform in place on LD and a_z, noted step by step. */
void pel_ils_decorrelate(pel_ils_t *s);

/* The same to the end, for searches that turn out to be long. */
void pel_ils_decorrelate_more(pel_ils_t *s);

/* First node of the search. */
void pel_ils_first_node(pel_ils_t *s);

/* What held_sq says of a candidate before its exact norm is known: held as the search found it, or as N - N0 already. */
#define PEL_ILS_NOT_UNDONE (-1)
#define PEL_ILS_NOT_SUMMED (-2)

/* N - N0 of candidate k, in the order of pivots. */
void pel_ils_apart(const pel_ils_t *s, int k, int32_t *N);

/* Exact squared norms of all candidates held, as far as they have none yet. */
void pel_ils_exact_norms(pel_ils_t *s);

/* Conditional variance of level p, cycles^2. */
double pel_ils_variance(const pel_ils_t *s, int p);

/* Squared norm of candidate k. */
double pel_ils_norm(const pel_ils_t *s, int k);

/* x 2^k; 0 or the largest number beyond the range of exponents. */
double pel_ils_scaled(double x, int k);

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

/* ambiguity_methods.h - further ways to integers, on top of ambiguity.h: the float-transform search of the literature, the wide-lane
 * cascade of longer baselines, agreement over epochs. Room: ambiguity/. All state is the caller's. Derivations: docs/INTEGERS.md. */
#ifndef PELORUS_AMBIGUITY_METHODS_H
#define PELORUS_AMBIGUITY_METHODS_H

#include "pelorus/ambiguity.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ==== float transform (S6 section 6): for comparison with pel_ils ================================================== */

#define PEL_TRANSFORM_MAX   12
#define PEL_TRANSFORM_NODES 4096

typedef enum {
    PEL_TRANSFORM_BOX = 0, /* each whitened component within k: every vector in the box is scored */
    PEL_TRANSFORM_SPHERE /* squared norm below the quantile 1 - 1e-6, shrinking to the second best; only with the norm as score */
} pel_transform_region_t;

typedef struct {
    int n;           /* 1..PEL_TRANSFORM_MAX */
    const double *a; /* [n] float ambiguities, cycles, |a| < 2^23 */
    const double *Q; /* [PEL_TRI(n)] covariance, packed lower triangle, cycles^2 */
    pel_transform_region_t region;
    double k; /* half width of the box in sigmas: 3 in the paper, 5 sensible */
    const double
        *metric; /* [PEL_TRI(n)] score (a - N)' metric (a - N), or NULL: the squared norm (a - N)' Q^-1 (a - N) */
} pel_transform_input_t;

typedef struct {
    int n_found;     /* 0..2 of the two best */
    int32_t nodes;   /* integers looked at; at most PEL_TRANSFORM_NODES */
    int32_t vectors; /* complete vectors scored */
    int32_t N[2][PEL_TRANSFORM_MAX];
    double score[2]; /* ascending; the first met keeps its place on a tie */

    /* private: unit lower triangle L^-1 of Q = L D L' and 1 / D */
    double M[PEL_TRI(PEL_TRANSFORM_MAX)];
    double inv_D[PEL_TRANSFORM_MAX];
} pel_transform_t;

/* Enumerate the integer vectors of the region depth first, nearest integers first, and keep the best two. The ambiguities are
 * whitened by M = L^-1 and searched in their given order: no pivoting, no integer transform.
 *
 * PEL_OK: every vector of the region was met. PEL_W_BUDGET: capped at PEL_TRANSFORM_NODES, N and score are no answer.
 * PEL_W_REJECTED: no vector in the region (the truth is outside with probability 1 - (2 Phi(k) - 1)^n for a box).
 * PEL_E_RANGE, PEL_E_NOT_POSDEF (pivot <= 1e-12 of the largest variance): t->n_found is 0.
 * Cost n^3 / 3 + nodes * n multiply-adds, and n^2 / 2 for each vector with a metric of its own.
 * Reference: Meng, Wu, Yuan (2011), Geomatics and Information Science of Wuhan University 36(3); corrected in docs/INTEGERS.md. */
pel_status_t pel_transform_solve(const pel_transform_input_t *in, pel_transform_t *t);

/* Metric of the paper's score: squared phase residuals of n double differences of one wavelength after the position is solved for
 * anew with N fixed; units of the undifferenced-satellite variance var_m2 (m^2).
 *  g         in   [n][3] -(u_sat - u_pivot)
 *  whitened  in   true: weights (D D')^-1 of equal variances; false: equal weights, as printed
 *  metric    out  [PEL_TRI(n)]
 * PEL_E_RANGE: n not 4..PEL_TRANSFORM_MAX. PEL_E_GEOMETRY: singular; metric unchanged. */
pel_status_t pel_transform_phase_metric(int n, const double (*g)[3], double lambda_m, double var_m2, bool whitened,
                                        double *metric);

/* ==== agreement over epochs (S6 section 6.2, "OVT") ================================================================= */

#define PEL_OVT_COMPARED 3 /* fewest common double differences that say anything */

/* The integers of the epoch before. 904 bytes at PEL_MAX_AMB = 40. All zero: empty; so is it after an epoch without integers, which
 * the caller says by setting `epochs` to 0. */
typedef struct {
    int32_t epochs; /* consecutive epochs with the same integers, this one included */
    int32_t n;
    struct {
        int64_t N;
        float lambda_m; /* tells carriers apart */
        uint8_t sat;
        uint8_t group;
    } entry[PEL_MAX_AMB + PEL_AMB_GROUPS]; /* pivots too, with N = 0 */
} pel_ovt_t;

typedef struct {
    bool passed;     /* the same in the epochs asked for */
    int32_t epochs;  /* so far */
    int n_compared;  /* double differences common to this epoch and the one before */
    int sat_changed; /* first satellite whose integer changed, or -1 */
} pel_ovt_verdict_t;

/* Take in one epoch's integers and compare them with those of the epoch before, satellite by satellite and carrier by carrier. Pivots may
 * change and satellites come and go: within a group, N - N_before must be the same for all common satellites. A change, or fewer
 * than PEL_OVT_COMPARED common differences, restarts the count at this epoch.
 *
 *  p, N    in  rows with `integer` and their integers by row, as from pel_amb_resolve()
 *  needed  in  epochs asked for, e.g. 5 (S6) or 10 (S1)
 * Integers that were wrong by correlated multipath repeat: a gate beside the others, not in their place. */
void pel_ovt_push(pel_ovt_t *o, const pel_amb_problem_t *p, const int64_t *N, int needed, pel_ovt_verdict_t *v);

#ifdef __cplusplus
}
#endif
#endif

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

/* ==== wide-lane, then narrow-lane: longer baselines ================================================================= */

/* Pairs of rows: one satellite on two carriers. */
#define PEL_CASCADE_PAIRS (PEL_MAX_AMB / 2)

typedef enum {
    PEL_CASCADE_NONE = 0, /* nothing fixed */
    PEL_CASCADE_WIDE,     /* wide-lane integers: position of centimetres to decimetres, by ionosphere */
    PEL_CASCADE_NARROW    /* both carriers of the satellites in `fixed` */
} pel_cascade_level_t;

/* A cascade under way and its result. 4320 bytes at PEL_MAX_AMB = 40. Callers may read the first group. */
typedef struct {
    uint8_t level;            /* pel_cascade_level_t reached, at the end */
    int n_pairs;              /* satellites with two carriers, */
    int n_wide;               /* of these wide-lane integers fixed, */
    int n_narrow;             /* and both carriers' */
    pel_int_verdict_t wide;   /* of each step, with its subset */
    pel_int_verdict_t narrow; /* PEL_INT_NOT_TRIED if wide was refused */
    double b[3];      /* true - predicted, m, from phases of the level reached alone (of the wide lanes if better) */
    double P_b[3][3]; /* m^2 */
    uint8_t row1[PEL_CASCADE_PAIRS];   /* rows of a pair in the problem: the carrier of higher frequency, */
    uint8_t row2[PEL_CASCADE_PAIRS];   /* and of lower */
    bool is_wide[PEL_CASCADE_PAIRS];   /* its N_wide is fixed */
    int64_t N_wide[PEL_CASCADE_PAIRS]; /* N1 - N2 */
    uint64_t fixed;                    /* bit 1 << row: both its carriers are fixed */

    /* private */
    uint8_t stage;
    int8_t max_tries;
    int32_t budget;
    pel_int_limits_t limits;
    pel_amb_resolver_t resolver;
    pel_amb_problem_t work; /* of the step at hand */
} pel_amb_cascade_t;

/* Wide-lane integers of all satellites with integers sought on two carriers against one pivot, then their L1/L2 (or other) integers given
 * these, each by a resolver with its subsets. To be tried where the joint problem of pel_amb_resolve() is too weak: the joint search is
 * the optimum when it succeeds, the cascade says what is known when it does not.
 *
 * With the wide lane W fixed, N2 = N1 - N_wide; what is left of two phases is one more, M, the combination whose noise is uncorrelated
 * with W's, with the integer N1 and wavelength 0.2 m. W, M and the ionosphere of each satellite (var_iono) are tied exactly. Codes
 * take part in the wide-lane step, as do prior and ionosphere (there as noise: 1.28 times that on L1); the narrow-lane step has W
 * in their place. Carriers of a satellite beyond two, and satellites with one, take no part.
 *
 * The limits hold for each step; failure_max is halved between them.
 * PEL_E_RANGE: as pel_amb_resolve_begin(). PEL_E_MISSING: no pair. */
pel_status_t pel_amb_cascade_begin(pel_amb_cascade_t *c, const pel_amb_problem_t *p, const pel_int_limits_t *limits,
                                   int32_t budget, int max_tries);

/* One step, as pel_amb_resolve_step(). p is read only and must be the one begun with.
 *  N  out  [PEL_MAX_AMB] by row of p, those in c->fixed; the others 0; unchanged unless PEL_OK
 * PEL_W_RUNNING: call again. PEL_OK: narrow-lane integers. PEL_W_REJECTED: see c->level, wide-lane or nothing. < 0: as pel_amb_float(). */
pel_status_t pel_amb_cascade_step(pel_amb_cascade_t *c, const pel_amb_problem_t *p, pel_ils_t *s, int32_t max_nodes,
                                  int64_t *N);

/* Begin and all steps in one call. */
pel_status_t pel_amb_cascade(pel_amb_cascade_t *c, const pel_amb_problem_t *p, pel_ils_t *s,
                             const pel_int_limits_t *limits, int32_t budget, int max_tries, int64_t *N);

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

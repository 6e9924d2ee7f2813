/* ambiguity.h - integers of carrier phase: float problem, bounded search, error band, verdicts. Room: ambiguity/.
 *
 * One epoch, the usual way:
 *   fill a pel_amb_problem_t with one row a double difference (satellite, carrier)
 *   pel_amb_float(&problem, &ils, 2, budget)        float ambiguities into the search engine, decorrelated
 *   while (pel_ils_run(&ils, 500) == PEL_W_RUNNING) between two slices the caller may do other things
 *   pel_int_validate(&problem, &ils, &limits, &verdict)
 *   pel_ils_get(&ils, 0, integers, NULL)            if verdict.reason == PEL_INT_OK
 * or all of it, with smaller problems when the whole is refused, by pel_amb_resolve() or in slices by pel_amb_resolve_step().
 *
 * All state is the caller's; nothing is kept between calls elsewhere; no call recurses. Derivations: docs/INTEGERS.md. */
#ifndef PELORUS_AMBIGUITY_H
#define PELORUS_AMBIGUITY_H

#include "pelorus/base.h"
#include "pelorus/solution.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Length of a packed lower triangle: element (i, j), j <= i, at i (i + 1) / 2 + j. */
#define PEL_TRI(n) ((n) * ((n) + 1) / 2)

/* ==== integer least squares: decorrelation and bounded search ================================================== */

/* Most candidates kept. */
#define PEL_ILS_BEST 4

typedef enum { PEL_ILS_EMPTY = 0, PEL_ILS_SEARCHING, PEL_ILS_OPTIMAL, PEL_ILS_BUDGET } pel_ils_stage_t;

/* How a problem is searched. All three walk the same tree; the last two are kept for comparison (S1 5.6). */
typedef enum {
    PEL_ILS_LAMBDA = 0, /* decorrelated; bound: the worst of the best (Teunissen 1995) */
    PEL_ILS_CHOLESKY,   /* not decorrelated; the same bound */
    PEL_ILS_FASF /* not decorrelated; every integer within four conditional standard deviations (Chen, Lachapelle 1995) */
} pel_ils_method_t;

/* FASF defers a problem with more vectors than this in its box. */
#define PEL_ILS_FASF_VECTORS 1024

/* A number of the factor, (hi 2^30 + lo) 2^-59 of a unit: a product costs three 32 x 32 -> 64 bit multiply-adds. */
typedef struct {
    int32_t hi, lo;
} pel_ils_fixed_t;

/* Room for the notes of the decorrelation: 2 bytes a step with a multiplier below 8, else 4. */
#define PEL_ILS_NOTES (34 * PEL_MAX_AMB)

/* Candidates held at a time: those asked for and some that rounding does not tell from them. */
#define PEL_ILS_HELD (PEL_ILS_BEST + 2)

/* One integer least-squares problem: min over integer vectors N of (a - N)' Q^-1 (a - N).
 * Callers may read the first group and write nothing. At most 16 KB at PEL_MAX_AMB = 40. */
typedef struct {
    int32_t nodes;     /* visited so far */
    int16_t n;         /* ambiguities, 0: empty */
    int16_t n_best;    /* candidates wanted */
    int16_t n_found;   /* candidates held */
    uint8_t stage;     /* pel_ils_stage_t */
    bool decorrelated; /* false: a cap was met first (the search is still exact, only slower) */
    int32_t swaps;     /* exchanges made by the decorrelation */
    double float_sq;   /* misfit of the float solution and its degrees of freedom, set by pel_amb_float(); else 0 */
    int32_t float_dof;

    /* private */
    int32_t budget;
    int32_t patience; /* nodes after which it is decorrelated to the end */
    int16_t level;
    int16_t n_notes;
    int16_t n_vectors; /* met by FASF */
    int16_t unit;      /* L, D and squared norms of the search are in units of 2^unit cycles */
    uint8_t method;    /* pel_ils_method_t */
    uint8_t n_held;
    int16_t exact_unit;
    pel_real exact_scale;         /* from held_sq to norms of the search; 0: exact_unit is not yet chosen */
    pel_real bound, slack, grain; /* of the search: docs/INTEGERS.md */
    pel_real one;                 /* a squared norm of 1 as the search has it (FASF) */
    pel_real w[PEL_MAX_AMB];      /* mean - z */
    pel_real mean[PEL_MAX_AMB];   /* conditional means down to `level` */
    pel_real cost[PEL_MAX_AMB];   /* partial squared norms of the levels before */
    pel_real inv_D[PEL_MAX_AMB];  /* 1 / D */
    pel_real zhat[PEL_MAX_AMB];   /* a_z beside its nearest integer */
    int32_t z[PEL_MAX_AMB], step[PEL_MAX_AMB];
    uint8_t order[PEL_MAX_AMB];    /* the ambiguity that pivoting put at each place */
    uint8_t shift[PEL_MAX_AMB];    /* 1 / G_ii = -minus_inverse 2^shift */
    int16_t row_unit[PEL_MAX_AMB]; /* row i of G is in units of 2^row_unit cycles */
    union {
        double Q[PEL_TRI(PEL_MAX_AMB)];          /* the covariance as the caller writes it */
        pel_ils_fixed_t G[PEL_TRI(PEL_MAX_AMB)]; /* Q = G G', pivoted */
    };
    union {
        double a[PEL_MAX_AMB];     /* the float ambiguities as the caller writes them */
        int64_t frac[PEL_MAX_AMB]; /* what they are beside an integer, 2^-51 cycle, pivoted */
    };
    union {
        struct {
            int64_t origin[PEL_MAX_AMB]; /* N0: the integer part removed first */
            int64_t a_z[PEL_MAX_AMB];    /* decorrelated float ambiguities, 2^-36 cycle */
            pel_ils_fixed_t minus_inverse[PEL_MAX_AMB];
            pel_real LD[PEL_TRI(PEL_MAX_AMB)];       /* Q_z = L D L': unit L with D on its diagonal */
            int32_t held[PEL_ILS_HELD][PEL_MAX_AMB]; /* z; N - N0 once the exact norm is known */
            pel_real held_near[PEL_ILS_HELD];        /* squared norm by the search; ascending until the search ends */
            int64_t held_sq[PEL_ILS_HELD]; /* exact, 2^-59 of 4^exact_unit, < 0: not yet; ascending in the end */
            uint16_t note[PEL_ILS_NOTES];  /* steps of the decorrelation; undone in reverse they turn z into N - N0 */
        };
        double scratch[PEL_TRI(PEL_MAX_AMB)];
    };
} pel_ils_t;

_Static_assert(PEL_MAX_AMB > 40 || sizeof(pel_ils_t) <= 16384 || sizeof(pel_real) > 4,
               "search state at most 16 KB at n = 40");

/* Take in a problem: integer part removed, Q = L D L' with symmetric pivoting, integer decorrelation that reduces
 * what its exchanges need.
 *
 *  s       out  engine; on failure empty (s->n = 0)
 *  n       in   ambiguities, 1..PEL_MAX_AMB
 *  a       in   [n] float ambiguities, cycles, |a| <= 1e15
 *  Q       in   [PEL_TRI(n)] covariance, packed lower triangle by rows, cycles^2
 *  n_best  in   candidates wanted, 1..PEL_ILS_BEST (a ratio needs 2)
 *  budget  in   nodes after which the search gives up, >= 1
 *
 * PEL_E_RANGE: n, n_best or budget out of range, a or Q not finite, |a| too large, a variance above 1e12 cycles^2, or variances more
 * than 2^48 apart. PEL_E_NOT_POSDEF: Q is not positive definite (a pivot at or below 2^-43 of its variance).
 * No double arithmetic. Cost about n^3 / 6 multiply-adds of 59 bits for the factor and 2 n of pel_real for each of at most
 * PEL_ILS_SWAPS(n) exchanges.
 * Reference: Teunissen (1995), J. Geodesy 70; Chang, Yang, Zhou (2005), J. Geodesy 79 (pivoting); Xie, Chang, Al Borno (2011), Partial
 * LLL reduction. */
pel_status_t pel_ils_init(pel_ils_t *s, int n, const double *a, const double *Q, int n_best, int32_t budget);

/* The same by another method. With PEL_ILS_FASF the answer holds within its box: fewer than n_best vectors may be found, and
 * pel_ils_run() returns PEL_W_BUDGET for more than PEL_ILS_FASF_VECTORS. a and Q may lie in the engine's room for them, here and above. */
pel_status_t pel_ils_init_as(pel_ils_t *s, pel_ils_method_t method, int n, const double *a, const double *Q, int n_best,
                             int32_t budget);

/* After pel_ils_init() and before the search: decorrelate as far as it goes. The vectors are the same without; success rate and the ratio
 * needed, which are bounds, come nearer to the truth. Where no verdict hangs on them it costs more than it saves. */
void pel_ils_decorrelate_to_the_end(pel_ils_t *s);

/* Room in the engine where a caller short of stack may write Q and a before it gives them to pel_ils_init(). */
static inline double *pel_ils_room_for_Q(pel_ils_t *s)
{
    return s->Q;
}
static inline double *pel_ils_room_for_a(pel_ils_t *s)
{
    return s->a;
}

/* Cap on exchanges of the decorrelation. */
#define PEL_ILS_SWAPS(n) (32 * (n))

/* Search on, at most max_nodes nodes (>= 1): depth first, candidates of a level nearest first, bound = the worst of the best
 * n_best found. The answer does not depend on how the work is cut into slices.
 *
 * PEL_OK        optimal: the n_best vectors of smallest norm, proved
 * PEL_W_RUNNING slice used, call again
 * PEL_W_BUDGET  total budget spent: best so far; nothing unexplored has a norm below pel_ils_lower_bound(). Or pel_real has not the digits
 *               that a proof would take
 * PEL_E_MISSING no problem in s
 * PEL_E_RANGE   a conditional mean beyond 2^22 cycles (2^30 with double): the problem is given up, s is empty
 * Cost of a node: at most n multiply-adds. A search that turns out to be long is decorrelated further once, within one slice. */
pel_status_t pel_ils_run(pel_ils_t *s, int32_t max_nodes);

/* k-th best vector found so far (k = 0 is the best), integers in the order of a, and its squared norm,
 * right to 1e-10 of it. Either output may be NULL.
 * PEL_E_MISSING and outputs unchanged: fewer found. */
pel_status_t pel_ils_get(const pel_ils_t *s, int k, int64_t *N, double *sq);

/* Second over best squared norm (0 if there are not two; at most 1e9). */
double pel_ils_ratio(const pel_ils_t *s);

/* Probability that the bootstrapped vector is right, prod (2 Phi(1 / (2 sigma_p)) - 1) over the decorrelated conditional sigmas: a lower
 * bound of the best vector's (Teunissen 1998). 0 if s is empty. Right to 1e-7; a longer search may decorrelate further and
 * raise it. Cost an error function for each sigma above 1/18 cycle. */
double pel_ils_success(const pel_ils_t *s);

/* Ambiguity dilution of precision det(Q)^(1/2n), cycles (Teunissen 1997). 0 if s is empty. */
double pel_ils_adop(const pel_ils_t *s);

/* Ratio from which on a wrong vector is accepted with at most this probability, for this n and these variances: 1 for a strong model,
 * large for a weak one (at most 1e9). 0 if s is empty; failure_max in (0, 1). Probability of all epochs, not of those accepted.
 * The smaller of pel_ils_ratio_bound() and, for failure_max 1e-4..0.1, of (P / failure_max)^(2.8 / n + 0.01) with P = 1 -
 * pel_ils_success(): a law found by simulation (make promise), not proved.
 * Cost as pel_ils_ratio_bound(). Reference: docs/INTEGERS.md; Verhagen, Teunissen (2013), GPS Solutions 17, for the fixed failure rate. */
double pel_ils_ratio_needed(const pel_ils_t *s, double failure_max);

/* The same as a proved bound: two to four times as large where the model is weak. Cost about 120 n exponentials. */
double pel_ils_ratio_bound(const pel_ils_t *s, double failure_max);

/* No vector that was not visited has a smaller squared norm than this; rounding is taken off (0.4 %). Equals the bound of the last candidate once optimal. */
double pel_ils_lower_bound(const pel_ils_t *s);

/* ==== the float problem of one epoch ============================================================================ */

/* One double difference against its group's pivot. A group = one system and carrier; its rows follow one another. */
typedef struct {
    uint8_t group; /* index into group[] */
    uint8_t sat;   /* any number that tells satellites apart, < PEL_MAX_SATS; the same on all carriers */
    bool integer;  /* the phase takes part and its integer is sought */
    bool code;     /* the code takes part */
    double g[3];   /* -(u_sat - u_pivot), unit vectors antenna -> satellite */
    double lambda_m;
    double phase_m; /* observed - predicted at the position the problem is about, m */
    double code_m;
    double var_phase; /* of the satellite's own single difference, m^2, > 0 where used */
    double var_code;
} pel_amb_row_t;

typedef struct {
    uint8_t sat;      /* the pivot */
    double mu;        /* (f_L1 / f)^2: ionosphere of this carrier in units of that on L1 */
    double var_phase; /* of the pivot's single difference, m^2 */
    double var_code;
} pel_amb_group_t;

#define PEL_AMB_GROUPS 16

/* 3.5 KB at PEL_MAX_AMB = 40. Filled by the caller. */
typedef struct {
    int n_rows; /* 0..PEL_MAX_AMB */
    int n_groups;
    bool have_prior;  /* P_r is the covariance of the predicted position; else 1 km per axis */
    double P_r[3][3]; /* m^2 */
    double var_iono;  /* single-difference ionosphere on L1, m^2; 0: none */
    pel_amb_group_t group[PEL_AMB_GROUPS];
    pel_amb_row_t row[PEL_MAX_AMB];
} pel_amb_problem_t;

/* Build a and Q of the rows with `integer` (in their order) from code, phase and prior, and load them into the engine.
 * With b = true - predicted position:  code = G b + mu I + e,  phase = G b - mu I + lambda N + e.
 *
 *  p       in   problem
 *  s       out  as pel_ils_init(), float_sq and float_dof included; contents undefined on failure (s->n = 0)
 *
 * PEL_E_RANGE: counts or values out of range. PEL_E_MISSING: no integers sought. PEL_E_GEOMETRY: no prior and fewer than 3 code
 * rows. Else as pel_ils_init(). The ionosphere of up to PEL_AMB_IONO_SATS satellites is tied across their carriers and code; that of
 * any further satellite counts as noise.
 * Cost n_code * k^2 with k = 3 (+ satellites, with ionosphere), n^2 * 3 (or 5), then pel_ils_init() and
 * pel_ils_decorrelate_to_the_end(). */
pel_status_t pel_amb_float(const pel_amb_problem_t *p, pel_ils_t *s, int n_best, int32_t budget);

#define PEL_AMB_IONO_SATS ((PEL_MAX_AMB < 36) ? PEL_MAX_AMB - 4 : 32) /* their covariance shares the engine's memory */

/* Number of integers sought. */
int pel_amb_count(const pel_amb_problem_t *p);

/* Position from phases alone, once their integers are known (the order of the rows with `integer`).
 *  b, P_b  out  true - predicted position, m, and its covariance
 *  sq, dof out  weighted squared residuals of the phases; dof = n - 3
 * PEL_E_GEOMETRY: fewer than 3 integers or singular; outputs unchanged. */
pel_status_t pel_amb_fixed(const pel_amb_problem_t *p, const int64_t *N, double b[3], double P_b[3][3], double *sq,
                           int *dof);

/* ==== the error band of a pair of carriers (S5 section 6) ======================================================= */

/* Half width in cycles of the first carrier: max(0.15, 4 sigma_u, 3 sigma_u + iono_max |mu2 - mu1| / lambda1).
 *  sd1_m, sd2_m  in  DD phase noise of each carrier, m
 *  iono_max_m    in  largest DD ionosphere believed on L1, m */
double pel_band_half_width(double lambda1_m, double sd1_m, double sd2_m, double dmu, double iono_max_m);

/* u = N1 - g N2 - phi1 + g phi2, g = lambda2 / lambda1; phi in cycles (DD, any common range removed). True if |u| < half_width < 0.5.
 * *u may be NULL. */
bool pel_band_test(int64_t N1, int64_t N2, double phi1_cyc, double phi2_cyc, double g, double half_width, double *u);

#define PEL_BAND_DD   12  /* double differences at most */
#define PEL_BAND_LIST 256 /* pairs (N1, N2) of one double difference at most */

/* One epoch for BAND: equal variances, as the published method has it. */
typedef struct {
    int m; /* double differences, 3..PEL_BAND_DD */
    double lambda1_m, lambda2_m;
    double G[PEL_BAND_DD][3]; /* -(u_i - u_0) */
    double L1_m[PEL_BAND_DD]; /* DD observed - predicted, m */
    double L2_m[PEL_BAND_DD];
    double P_m[PEL_BAND_DD];
    double sd_code_m;  /* undifferenced */
    double sd_phase_m; /* undifferenced, each carrier */
    bool have_prior;   /* the predicted position has covariance P_r; it then adds to the code */
    double P_r[3][3];
    double half_width_cyc; /* see pel_band_half_width() */
    double window;         /* lists reach this many sigmas of the adjusted range (4) */
    double ratio_min;      /* J2 / J1 (2) */
    int32_t max_triples;   /* cap on work (400 000) */
} pel_band_input_t;

typedef struct {
    bool accepted;
    pel_int_reason_t reason;
    int32_t N1[PEL_BAND_DD], N2[PEL_BAND_DD]; /* best */
    int dropped;                              /* DD whose list was empty and that took no part, or -1 */
    double J1, J2, J_max;                     /* cost of best and second, chi-square limit of J1 */
    int dof;
    int32_t n_window; /* integers looked at, longest window */
    int32_t n_list;   /* longest list */
    int32_t triples, evaluations;

    /* private */
    int16_t list[PEL_BAND_DD][PEL_BAND_LIST]; /* N1 - N1 origin, ascending */
    int16_t list_n[PEL_BAND_DD];
    int32_t origin[PEL_BAND_DD];
} pel_band_t;

/* Integers of one epoch by enumeration of pairs inside the error band: S5 section 7, exactly.
 * PEL_OK: done, see accepted and reason. PEL_E_FULL: a list would exceed PEL_BAND_LIST. PEL_W_BUDGET: max_triples spent, best so far,
 * not accepted. PEL_E_RANGE: sizes, variances or values (half width >= 0.5: the band is void). PEL_E_GEOMETRY: singular, or more
 * than one empty list. On < 0 only `reason`, `accepted` and the counts are meaningful.
 * Cost: triples (at most max_triples) of about 60 multiply-adds, evaluations of about 20 m.
 * Reference: Sun, Li, Jiang (Wuhan University); corrected in docs/INTEGERS.md. */
pel_status_t pel_band_solve(const pel_band_input_t *in, pel_band_t *b);

/* ==== verdicts ================================================================================================== */

typedef struct {
    double ratio_min;   /* second over best, e.g. 2 (S5) or 3 */
    double success_min; /* bootstrapped success of the search problem, e.g. 0.99; 0: no limit */
    double chi2_p;      /* the fixed misfit stays below this quantile, e.g. 0.999 */
    double prior_sigma; /* the fixed position within this many sigmas of the prior, e.g. 5 */
    double iono_sigmas; /* largest ionosphere believed in the band, in sigmas of var_iono, e.g. 3 */
    int n_min;          /* fewest integers, e.g. 4 */
    double
        failure_max; /* 0: not asked for. Else the ratio must also reach pel_ils_ratio_needed() of this, e.g. 0.001 */
} pel_int_limits_t;

typedef struct {
    pel_int_reason_t reason; /* PEL_INT_OK, or the first test that failed in the order of the fields below */
    uint16_t failed;         /* bit 1 << pel_int_reason_t for every test that failed */
    double success;
    double ratio;
    double ratio_needed;   /* what it was held against */
    double chi2, chi2_max; /* float_sq + best squared norm, degrees of freedom chi2_dof */
    int chi2_dof;
    double band_worst; /* largest |u| / half width of all pairs; 0 if there is no pair */
    int n_pairs;
    double prior_sq;      /* Mahalanobis distance squared of the fixed position from the prior; 0 without one */
    int worst_row;        /* row with the largest normalised fixed residual, -1 if there is none */
    int n_integers;       /* integers judged */
    int n_asked;          /* integers asked for; more than n_integers if only a subset was solved for */
    uint8_t subset;       /* pel_amb_subset_t, set by pel_amb_resolve(); 0 otherwise */
    uint8_t subset_index; /* of its kind: 0 the first suspect, ..., or the system's number in the order of the groups */
} pel_int_verdict_t;

/* Sane limits: ratio 2, success 0.95, chi-square 99.9 %, prior 5 sigma, ionosphere 3 sigma, 4 integers. */
void pel_int_limits_default(pel_int_limits_t *limits);

/* Judge what the search found. Every test is made and told apart; none is skipped because another failed.
 * PEL_INT_BUDGET: the search is not proved. PEL_INT_FEW: fewer than n_min integers.
 * Returns PEL_OK (see v->reason), PEL_E_MISSING (no candidate in s; v->reason says why it is not fixed). */
pel_status_t pel_int_validate(const pel_amb_problem_t *p, const pel_ils_t *s, const pel_int_limits_t *limits,
                              pel_int_verdict_t *v);

/* ==== one epoch's integers, in slices =========================================================================== */

/* Which of the integers asked for were solved for, and why: in the order in which they are tried. */
typedef enum {
    PEL_AMB_ALL = 0,         /* all of them */
    PEL_AMB_WITHOUT_SUSPECT, /* did not fit: one satellite is out, its codes too; those that fit worst first */
    PEL_AMB_AGREED,       /* too weak, but it fits: only those in which best and second best agree; up to three times */
    PEL_AMB_TWO_CARRIERS, /* too weak: only satellites with two carriers or more */
    PEL_AMB_WITHOUT_NOISIEST, /* too weak: the noisiest satellites are out, all their carriers; one more each time */
    PEL_AMB_WITHOUT_SYSTEM    /* either: one system is out (groups that share satellites are one system) */
} pel_amb_subset_t;

/* A resolution under way. 232 bytes at PEL_MAX_AMB = 40; all private. The rows of the problem show the subset at hand. */
typedef struct {
    pel_int_limits_t limits; /* of one try */
    pel_int_verdict_t first; /* verdict of all together */
    uint64_t asked_integer, asked_code;
    uint64_t agreed; /* rows in which best and second best were the same */
    int32_t budget;  /* nodes left */
    uint8_t stage;
    uint8_t subset;       /* pel_amb_subset_t */
    uint8_t index;        /* of the next of its kind */
    int8_t tries, setups; /* left */
    uint8_t n_systems;
    uint8_t n_suspects; /* satellites to leave out, the worst first */
    uint8_t suspect[PEL_MAX_AMB];
} pel_amb_resolver_t;

/* Begin with all integers of the problem. When all together are refused, smaller problems are tried, in the order of pel_amb_subset_t:
 * for a problem that does not fit (chi-square, band, prior) though its model is strong, each satellite left out in turn, then each
 * system; for one that is too weak (success, budget, ratio) the others. As many searches as there are systems are kept for the systems.
 *
 * Every subset is a problem of its own, with every test of pel_int_validate(); one whose bootstrapped success rate is below success_min
 * is not searched. Nodes and what failure_max promises are for all tries together: each but the last has half of what is left.
 *
 *  budget     in  nodes for all tries together
 *  max_tries  in  searches at most, 1..63 (8 is plenty), with at most twice as many problems set up
 * PEL_E_RANGE: budget or max_tries out of range, n_rows not 0..PEL_MAX_AMB. */
pel_status_t pel_amb_resolve_begin(pel_amb_resolver_t *r, const pel_amb_problem_t *p, const pel_int_limits_t *limits,
                                   int32_t budget, int max_tries);

/* One step: a float problem set up and decorrelated, or at most max_nodes (>= 1) nodes of a search, or one verdict. The results do not
 * depend on max_nodes.
 *
 *  p  in/out  the problem begun with, not touched by others meanwhile. At the end: rows given up have `integer` (and, if suspected,
 *             `code`) cleared if fixed, else as it was
 *  s  in/out  engine, the same in all steps
 *  N  out     [PEL_MAX_AMB] by row of p (0 where `integer` is false); unchanged unless PEL_OK
 *  v  out     at the end: verdict of the subset fixed, or that of all together; unchanged before
 *
 * PEL_W_RUNNING: call again. PEL_OK: fixed, v tells the subset. PEL_W_REJECTED: not fixed, v says why. < 0: as pel_amb_float(),
 * v->reason is PEL_INT_NOT_TRIED. PEL_E_MISSING also: already ended. */
pel_status_t pel_amb_resolve_step(pel_amb_resolver_t *r, pel_amb_problem_t *p, pel_ils_t *s, int32_t max_nodes,
                                  int64_t *N, pel_int_verdict_t *v);

/* Begin and all steps in one call. */
pel_status_t pel_amb_resolve(pel_amb_problem_t *p, pel_ils_t *s, const pel_int_limits_t *limits, int32_t budget,
                             int max_tries, int64_t *N, pel_int_verdict_t *v);

#ifdef __cplusplus
}
#endif
#endif

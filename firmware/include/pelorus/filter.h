/* filter.h - the estimator: error state x and its covariance P = U diag(D) U'. Room: filter/.
 *
 * U is unit upper triangular, packed by columns without its diagonal; D > 0. Every update is one scalar row; correlated
 * measurements are whitened before (observe.h). Nothing but propagation (pel_propagat*) knows what a state
 * means.
 * Closed loop: after the rows of an epoch the navigator subtracts x from its state and clears x.
 * Sources: Bierman (1977), Factorization Methods for Discrete Sequential Estimation, ch. V and VI; Agee and Turner (1972), rank-one
 * update; Gentleman (1973), J. IMA 12, scaled rotations. */
#ifndef PELORUS_FILTER_H
#define PELORUS_FILTER_H

#include "pelorus/base.h"
#include "pelorus/inertial.h"
#include "pelorus/model.h"

#ifdef __cplusplus
extern "C" {
#endif

#define PEL_UD_PACKED (PEL_MAX_STATES * (PEL_MAX_STATES - 1) / 2)

/* Most states that white noise may drive directly in one pel_ud_time_update(): attitude and velocity. */
#define PEL_UD_MAX_NOISE 6

/* Most states, counted from the first, that a pel_ud_time_update() may touch; those after them (ambiguities) stand still. */
#define PEL_UD_MAX_MOVING 24

/* 1300 bytes in float at PEL_MAX_STATES = 24, 4900 at 48. Callers may read every field and write x. */
typedef struct {
    int n;                     /* states in use */
    pel_real U[PEL_UD_PACKED]; /* element (i, j), i < j, at j (j - 1) / 2 + i */
    pel_real D[PEL_MAX_STATES];
    pel_real x[PEL_MAX_STATES];
} pel_ud_t;

/* ---- start ----------------------------------------------------------------------------------------------------------- */

/* Diagonal start: n states (1..PEL_MAX_STATES), standard deviations sd > 0, x = 0. PEL_E_RANGE, PEL_E_NOT_POSDEF: ud unchanged. */
pel_status_t pel_ud_init(pel_ud_t *ud, int n, const pel_real sd[]);

/* Forget states first..first+2 and give them this covariance, uncorrelated with all others (x of them 0). P symmetric, positive
 * definite, else PEL_E_NOT_POSDEF and ud unchanged. */
pel_status_t pel_ud_set_block3(pel_ud_t *ud, int first, const double P[3][3]);

/* The same for one state. var > 0. */
pel_status_t pel_ud_set_variance(pel_ud_t *ud, int i, pel_real var);

/* ---- time -------------------------------------------------------------------------------------------------------------- */

/* P = Phi P Phi' + Q, x = Phi x.
 *
 * PEL_E_RANGE (ud unchanged) if sizes differ, a state beyond PEL_UD_MAX_MOVING is touched or more than PEL_UD_MAX_NOISE states have
 * noise; PEL_E_NOT_POSDEF (ud unusable: restart it) if a D is no longer > 0 or not finite.
 * Cost: rotations for every element left of a touched row's diagonal; 18 states of S5: about 3 900 multiply-adds in 1 940 pairs, 230
 * divisions. Untouched states at the end cost only their columns. Stack 3.4 KB in float. */
pel_status_t pel_ud_time_update(pel_ud_t *ud, const pel_transition_t *t);

/* P = (I + diag(decay)) P (I + diag(decay))' + diag(q): Markov states (pel_model_slow). x decays too. decay > -1, q >= 0. */
pel_status_t pel_ud_decay(pel_ud_t *ud, const pel_real decay[], const pel_real q[]);

/* P_ii += q: white noise on one state. q >= 0. i^2 multiply-adds. */
void pel_ud_add_noise(pel_ud_t *ud, int i, pel_real q);

/* P += q c c' with c zero from row k on (Agee and Turner): c has k elements. Destroys c. q >= 0. k^2 multiply-adds. */
void pel_ud_rank_one(pel_ud_t *ud, int k, pel_real c[], pel_real q);

/* ---- measurement ------------------------------------------------------------------------------------------------------- */

/* Fold in z = h'x + w, E[w^2] = var.
 *
 *  h      in   row; elements below `first` are not read and count as zero
 *  first  in   0..n-1
 *  z      in   computed - measured (the error state's sign; x need not be 0)
 *  var    in   > 0
 *  gate   in   largest accepted innovation / sigma; <= 0 accepts all
 *  nis    out  innovation^2 over its variance, on PEL_OK and PEL_W_REJECTED; may be NULL
 *
 * Returns PEL_OK; PEL_W_REJECTED (gate); PEL_E_NOT_POSDEF (var <= 0 or NaN); PEL_E_RANGE (not finite, index out of range). ud is unchanged
 * unless PEL_OK. With m = n - first: m (n + first) / 2 ... n^2 multiply-adds; the last three of 18 states cost a third of a dense row. */
pel_status_t pel_ud_update(pel_ud_t *ud, const pel_real h[], int first, pel_real z, pel_real var, pel_real gate,
                           pel_real *nis);

/* h P h' of a row (without noise): n (n + 1) / 2 multiply-adds when dense. */
pel_real pel_ud_hph(const pel_ud_t *ud, const pel_real h[], int first);

/* out = P h, n elements: cross covariances, and together with a second row h2' P h. */
void pel_ud_ph(const pel_ud_t *ud, const pel_real h[], int first, pel_real out[]);

/* ---- reading P --------------------------------------------------------------------------------------------------------- */

pel_real pel_ud_cov(const pel_ud_t *ud, int i, int j);

/* Variance of x_i + x_j, i and j different: a sum of squares, never negative. */
pel_real pel_ud_var_of_sum(const pel_ud_t *ud, int i, int j);

/* P[i.., j..], 3x3. */
void pel_ud_block3(const pel_ud_t *ud, int i, int j, double P[3][3]);

/* ---- states that come and go ---------------------------------------------------------------------------------------------- */

/* Insert a state at index i (0..n), uncorrelated, x = 0. PEL_E_FULL, PEL_E_RANGE, PEL_E_NOT_POSDEF: ud unchanged. At i = n it is free. */
pel_status_t pel_ud_insert(pel_ud_t *ud, int i, pel_real var);

/* Marginalise state i out: the others keep mean and covariance. i^2 multiply-adds. */
pel_status_t pel_ud_remove(pel_ud_t *ud, int i);

/* Insert at index i <= j a copy of state j plus independent noise of variance var > 0 (a perfect copy would make P singular). What was at j
 * is then at j + 1. x is copied. */
pel_status_t pel_ud_clone(pel_ud_t *ud, int j, int i, pel_real var);

/* x_i := sum over k > i of a_k x_k + w, E[w^2] = var > 0: state i is forgotten and becomes a combination of states behind it (a delayed copy of
 * the antenna, a pivot's part). a has n elements, those up to i are not read. The mean follows. n^2/2 multiply-adds.
 * PEL_E_RANGE, PEL_E_NOT_POSDEF: ud unchanged. */
pel_status_t pel_ud_assign(pel_ud_t *ud, int i, const pel_real a[], pel_real var);

/* x_i += a x_k for i < k: exact and free, i.e. a row of U. PEL_E_RANGE unless 0 <= i < k < n. */
pel_status_t pel_ud_combine(pel_ud_t *ud, int i, int k, pel_real a);

/* Change the sign of state i. */
pel_status_t pel_ud_negate(pel_ud_t *ud, int i);

/* Exchange states i and i + 1. 2 i multiply-adds. PEL_E_RANGE unless 0 <= i, i + 1 < n. */
pel_status_t pel_ud_swap(pel_ud_t *ud, int i);

/* States first..first+n-1 are differences against a common reference, x_j = X_j - X_0; make state p the reference:
 * x_j := X_j - X_p, and the last one X_0 - X_p in place of x_p, which goes; the states after p move up by one place. Double-difference
 * ambiguities and between-satellite offsets when the pivot changes: nothing is lost or added. PEL_E_RANGE: ud unchanged. */
pel_status_t pel_ud_change_reference(pel_ud_t *ud, int first, int n, int p);

/* ---- health ---------------------------------------------------------------------------------------------------------------- */

/* PEL_OK; PEL_E_NOT_POSDEF if a D is not > 0; PEL_E_RANGE if anything is not finite. */
pel_status_t pel_ud_check(const pel_ud_t *ud);

/* 32 bits (FNV-1a taken by words) of n, U, D, x, the same on every machine: equal hashes, equal filters. Continues from seed; start
 * with PEL_FNV_START of bits.h. */
uint32_t pel_ud_hash(const pel_ud_t *ud, uint32_t seed);

/* ---- propagation at IMU rate --------------------------------------------------------------------------------------------- */

/* Collects strapdown steps into substeps of the time update: mean specific force, mean attitude. */
typedef struct {
    double dv_f_e[3];     /* sum since the last time update */
    double C_start[3][3]; /* attitude there */
    double dt_s;
    double slow_s; /* since the last decay of Markov states */
} pel_propagator_t;

#define PEL_SUBSTEP_S 0.05 /* longest substep of the INS time update */
#define PEL_SLOW_S    1.0  /* interval of Markov decay */

/* C_b_e: attitude now. */
void pel_propagator_init(pel_propagator_t *p, const double C_b_e[3][3]);

/* After each strapdown step: add its specific-force increment; runs the time update when PEL_SUBSTEP_S is reached.
 *  C_b_e, r_e  in  after the step
 * Returns pel_ud_time_update()'s status; PEL_W_RUNNING when nothing was due. */
pel_status_t pel_propagator_add(pel_propagator_t *p, const pel_model_t *m, const double dv_f_e[3], double dt_s,
                                const double C_b_e[3][3], const double r_e[3], pel_ud_t *ud);

/* Bring ud to now: time update of what is collected, and Markov decay when due (every PEL_SLOW_S). Before rows and outputs. */
pel_status_t pel_propagator_flush(pel_propagator_t *p, const pel_model_t *m, const double C_b_e[3][3],
                                  const double r_e[3], pel_ud_t *ud);

/* The same for pel_model_ins_enu(), after pel_strapdown_enu_step(): C_start and dv_f are then those of local axes. */
pel_status_t pel_propagator_add_enu(pel_propagator_t *p, const pel_model_t *m, const double dv_f_enu[3], double dt_s,
                                    const pel_strapdown_enu_t *s, pel_ud_t *ud);
pel_status_t pel_propagator_flush_enu(pel_propagator_t *p, const pel_model_t *m, const pel_strapdown_enu_t *s,
                                      pel_ud_t *ud);

/* Offsets, their rates and the height deviation over dt_s (pel_model_tdcp; blocks a model lacks are passed over): B += dt Bdot; noise of B is
 * path_m_rts^2 dt on each satellite and once more on their common reference. Call it before an epoch's rows, dt_s below tau_height_s.
 * PEL_E_RANGE (ud unchanged) unless dt_s > 0 and ud is of this model. 5 rank-one updates with two offsets. */
pel_status_t pel_propagate_offsets(const pel_model_t *m, const pel_drift_model_t *drift, double dt_s, pel_ud_t *ud);

/* Model without IMU: time update over dt_s in substeps of 0.25 s, 40 of them at most (then longer). */
pel_status_t pel_propagate_gnss(const pel_model_t *m, const double r_e[3], double dt_s, pel_ud_t *ud);

#ifdef __cplusplus
}
#endif
#endif

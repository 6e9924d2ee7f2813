/* horizon.c - the nominal state and its covariance through time: to the next epoch, and on to now. */
#include <string.h>

#include "internal.h"

#include "pelorus/earth.h"
#include "pelorus/math.h"

#define OMEGA_SMOOTH_S    0.02 /* one 500 Hz gyro increment's quantization is 8 mm/s on a 3 m arm */
#define LEAST_LAG_S       0.6 /* without epochs the filter follows now this closely, or as far as one may be waited for */
#define LAG_STEP_NS       (100 * PEL_NS_PER_MS)
#define SINGLE_STEP_MAX_S 100.0 /* GNSS alone: a longer silence starts afresh */

static void sensor_errors(const pel_navigator_t *nav, double b_g[3], double b_a[3])
{
    for (int k = 0; k < 3; k++) {
        b_g[k] = nav->errors.gyro_constant[k] + nav->errors.gyro_markov[k];
        b_a[k] = nav->errors.accel_markov[k];
    }
}

/* One increment on a strapdown state, corrected for the sensor errors known now. */
static void step(const pel_navigator_t *nav, const pel_imu_t *imu, pel_strapdown_t *s, pel_coning_t *c)
{
    double b_g[3], b_a[3], alpha[3], upsilon[3];
    sensor_errors(nav, b_g, b_a);
    pel_imu_correct(imu, b_g, b_a, alpha, upsilon);
    pel_strapdown_step(s, c, alpha, upsilon, imu->dt_s, imu->t_ns);
}

/* The part of the ring's i-th increment that lies in (from, to]: the increment itself or, where it is cut, *part. NULL if nothing is
 * left of it. */
static const pel_imu_t *clipped(const pel_navigator_t *nav, int i, pel_time_t from_ns, pel_time_t to_ns,
                                pel_imu_t *part)
{
    const pel_imu_t *imu = pel_imu_ring_at(&nav->ring, i);
    pel_imu_t rest;
    if (imu == NULL) { return NULL; }
    if (pel_imu_split(imu, from_ns, &rest, part) == PEL_OK) { imu = part; }
    if (imu->t_ns > to_ns && pel_imu_split(imu, to_ns, part, &rest) == PEL_OK) { imu = part; }
    return (imu->t_ns > from_ns && imu->t_ns <= to_ns) ? imu : NULL;
}

static void smooth_omega(pel_navigator_t *nav, const pel_imu_t *imu)
{
    const double w = pel_min(1.0, imu->dt_s / OMEGA_SMOOTH_S);
    for (int k = 0; k < 3; k++) {
        const double rate = imu->alpha_ib_b[k] / imu->dt_s - nav->errors.gyro_constant[k] - nav->errors.gyro_markov[k];
        nav->omega_ib_b[k] += w * (rate - nav->omega_ib_b[k]);
    }
}

static void decay_markov(pel_navigator_t *nav, double dt_s)
{
    const double g = 1.0 - dt_s / nav->cfg.imu.tau_gm_s;
    const double a = 1.0 - dt_s / nav->cfg.imu.tau_am_s;
    for (int k = 0; k < 3; k++) {
        nav->errors.gyro_markov[k] *= g;
        nav->errors.accel_markov[k] *= a;
    }
}

/* Have the increments from here on (and the one before, which the search went by) not changed while they waited? If one has, nobody
 * knows which others did: the ring is emptied. */
static bool is_whole_from(pel_navigator_t *nav, int first)
{
    for (int i = (first > 0) ? first - 1 : 0; i < nav->ring.n; i++) {
        if (pel_imu_ring_is_whole(&nav->ring, i)) { continue; }
        pel_imu_ring_init(&nav->ring);
        nav->counters.numeric_faults++;
        return false;
    }
    return true;
}

static pel_status_t advance_ins(pel_navigator_t *nav, pel_time_t t_ns)
{
    pel_strapdown_t *s = &nav->at_horizon;
    const pel_imu_t *newest = pel_imu_ring_newest(&nav->ring);
    const pel_imu_t *oldest = pel_imu_ring_oldest(&nav->ring);
    if (newest == NULL || newest->t_ns < t_ns) { return PEL_E_MISSING; }
    if (pel_time_diff_s(oldest->t_ns, s->t_ns) > oldest->dt_s + 1e-6) { return PEL_E_MISSING; }
    pel_status_t status = PEL_OK;
    pel_imu_t part;
    const pel_imu_t *imu;
    const int first = pel_imu_ring_after(&nav->ring, s->t_ns);
    if (!is_whole_from(nav, first)) { return PEL_E_RANGE; }
    for (int i = first; (imu = clipped(nav, i, s->t_ns, t_ns, &part)) != NULL; i++) {
        step(nav, imu, s, &nav->coning_horizon);
        smooth_omega(nav, imu);
        decay_markov(nav, imu->dt_s);
        const pel_status_t added = pel_propagator_add(&nav->propagator, &nav->model, nav->coning_horizon.dv_f_e,
                                                      imu->dt_s, s->C_b_e, s->r_eb_e, &nav->ud);
        if (added < 0) { status = added; }
        double turn, push;
        if (pel_nav_doubt_of(nav, i, imu->dt_s, &turn, &push)) { pel_nav_doubt_motion(nav, turn, push); }
    }
    const pel_status_t flushed = pel_propagator_flush(&nav->propagator, &nav->model, s->C_b_e, s->r_eb_e, &nav->ud);
    s->t_ns = t_ns;
    return (flushed < 0) ? flushed : status;
}

static pel_status_t advance_gnss(pel_navigator_t *nav, pel_time_t t_ns)
{
    pel_strapdown_t *s = &nav->at_horizon;
    const double dt_s = pel_time_diff_s(t_ns, s->t_ns);
    if (dt_s > SINGLE_STEP_MAX_S) { return PEL_E_STALE; }
    for (int k = 0; k < 3; k++) { s->r_eb_e[k] += s->v_eb_e[k] * dt_s; }
    s->t_ns = t_ns;
    return (dt_s > 0.0) ? pel_propagate_gnss(&nav->model, s->r_eb_e, dt_s, &nav->ud) : PEL_OK;
}

pel_status_t pel_nav_advance(pel_navigator_t *nav, pel_time_t t_ns)
{
    if (t_ns < nav->at_horizon.t_ns) { return PEL_E_STALE; }
    return nav->ins ? advance_ins(nav, t_ns) : advance_gnss(nav, t_ns);
}

void pel_nav_close_loop(pel_navigator_t *nav)
{
    pel_strapdown_t *s = &nav->at_horizon;
    pel_real *x = nav->ud.x;
    const int i_v = pel_model_index(&nav->model, PEL_BLOCK_VELOCITY);
    const int i_r = pel_model_index(&nav->model, PEL_BLOCK_POSITION);
    for (int k = 0; k < 3; k++) {
        s->v_eb_e[k] -= (double)x[i_v + k];
        s->r_eb_e[k] -= (double)x[i_r + k];
        nav->corrected_e[k] -= (double)x[i_r + k];
    }
    if (nav->ins) {
        const int i_psi = pel_model_index(&nav->model, PEL_BLOCK_ATTITUDE);
        const int i_bg = pel_model_index(&nav->model, PEL_BLOCK_GYRO_CONSTANT);
        const int i_gm = pel_model_index(&nav->model, PEL_BLOCK_GYRO_MARKOV);
        const int i_am = pel_model_index(&nav->model, PEL_BLOCK_ACCEL_MARKOV);
        double minus_psi[3];
        for (int k = 0; k < 3; k++) {
            minus_psi[k] = -(double)x[i_psi + k];
            nav->errors.gyro_constant[k] += (double)x[i_bg + k];
            nav->errors.gyro_markov[k] += (double)x[i_gm + k];
            nav->errors.accel_markov[k] += (double)x[i_am + k];
        }
        pel_dcm_turn_to(s->C_b_e, minus_psi);
        pel_dcm_orthonormalise(s->C_b_e);
    }
    pel_nav_track_close_loop(nav);
    for (int i = 0; i < nav->ud.n; i++) { x[i] = 0; }
}

void pel_nav_predict_now(pel_navigator_t *nav)
{
    nav->now = nav->at_horizon;
    if (!nav->ins) { return; }
    nav->coning_now = nav->coning_horizon;
    pel_imu_t part;
    const pel_imu_t *imu;
    const int first = pel_imu_ring_after(&nav->ring, nav->now.t_ns);
    if (!is_whole_from(nav, first)) {
        pel_nav_drop_ins(nav);
        return;
    }
    for (int i = first; (imu = clipped(nav, i, nav->now.t_ns, INT64_MAX, &part)) != NULL; i++) {
        step(nav, imu, &nav->now, &nav->coning_now);
    }
}

/* A predicted solution at the whole multiple of the output period that this increment passes. */
static void tick(pel_navigator_t *nav, const pel_imu_t *body)
{
    const pel_time_t period = nav->cfg.output_period_ns;
    if (period <= 0) { return; }
    const pel_time_t due = body->t_ns - body->t_ns % period;
    if (due <= nav->now.t_ns) { return; }
    pel_strapdown_t at = nav->now;
    pel_coning_t coning = nav->coning_now;
    pel_imu_t part = *body, rest;
    (void)pel_imu_split(body, due, &part, &rest);
    step(nav, &part, &at, &coning);
    pel_nav_fill_solution(nav, &at, &nav->solution);
    nav->counters.coast_epochs += (nav->solution.fix == PEL_FIX_COAST);
    nav->ready |= PEL_NAV_BIT(PEL_NAV_SOLUTION);
}

/* Without epochs the horizon still follows, so that the ring never runs over it and the covariance grows as it should. */
static void limit_lag(pel_navigator_t *nav)
{
    if (nav->search != PEL_NAV_SEARCH_NONE) { return; } /* its epoch holds the horizon, for LONGEST_SEARCH_S at most */
    const int waiting = nav->ring.n - pel_imu_ring_after(&nav->ring, nav->at_horizon.t_ns);
    const bool nearly_full = waiting >= PEL_IMU_RING - 4;
    const double longest_lag_s =
        pel_max(LEAST_LAG_S, (double)nav->cfg.base_wait_s + (double)nav->cfg.apply_delay_s + 0.2);
    if (!nearly_full && pel_time_diff_s(nav->now.t_ns, nav->at_horizon.t_ns) < longest_lag_s) { return; }
    const pel_time_t to_ns =
        nearly_full ? pel_imu_ring_at(&nav->ring, PEL_IMU_RING / 4)->t_ns : nav->at_horizon.t_ns + LAG_STEP_NS;
    if (pel_nav_advance(nav, to_ns) < 0) {
        nav->counters.numeric_faults++;
        pel_nav_drop_ins(nav);
    }
}

void pel_nav_take_increment(pel_navigator_t *nav, const pel_imu_t *body)
{
    (void)pel_imu_ring_push(&nav->ring, body);
    if (!nav->ins) {
        pel_nav_align_increment(nav, body);
        return;
    }
    tick(nav, body);
    step(nav, body, &nav->now, &nav->coning_now);
    pel_nav_keep_pose(nav, body->alpha_ib_b);
    limit_lag(nav);
}

void pel_nav_antenna(const pel_navigator_t *nav, pel_antenna_t *ant, double r_ea_e[3], double v_ea_e[3])
{
    const pel_strapdown_t *s = &nav->at_horizon;
    ant->n_states = nav->model.n;
    ant->i_psi = pel_model_index(&nav->model, PEL_BLOCK_ATTITUDE);
    ant->i_v = pel_model_index(&nav->model, PEL_BLOCK_VELOCITY);
    ant->i_r = pel_model_index(&nav->model, PEL_BLOCK_POSITION);
    for (int k = 0; k < 3; k++) { ant->lever_e[k] = ant->lever_rate_e[k] = 0.0; }
    if (nav->ins) {
        double omega_ib_e[3], omega_eb_e[3];
        pel_mat3_vec(s->C_b_e, nav->omega_ib_b, omega_ib_e);
        pel_mat3_vec(s->C_b_e, nav->cfg.lever_ba_b, ant->lever_e);
        memcpy(omega_eb_e, omega_ib_e, sizeof omega_eb_e);
        omega_eb_e[2] -= PEL_OMEGA_IE;
        pel_cross3(omega_eb_e, ant->lever_e, ant->lever_rate_e);
    }
    for (int k = 0; k < 3; k++) {
        r_ea_e[k] = s->r_eb_e[k] + ant->lever_e[k];
        v_ea_e[k] = s->v_eb_e[k] + ant->lever_rate_e[k];
    }
}

/* d = dr + psi x arm, so cov = Prr + [.]Ppp[.]' + cross terms with A = -[arm x]. */
void pel_nav_antenna_cov(const pel_navigator_t *nav, const pel_antenna_t *ant, bool rate, double P[3][3])
{
    const int i = rate ? ant->i_v : ant->i_r;
    const double *a = rate ? ant->lever_rate_e : ant->lever_e;
    pel_ud_block3(&nav->ud, i, i, P);
    if (ant->i_psi < 0) { return; }
    const double A[3][3] = {{0.0, a[2], -a[1]}, {-a[2], 0.0, a[0]}, {a[1], -a[0], 0.0}};
    double Ppp[3][3], Ppr[3][3], APA[3][3], cross[3][3];
    pel_ud_block3(&nav->ud, ant->i_psi, ant->i_psi, Ppp);
    pel_ud_block3(&nav->ud, ant->i_psi, i, Ppr);
    pel_mat3_congruence(A, Ppp, APA);
    pel_mat3_mul(A, Ppr, cross);
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) { P[r][c] += APA[r][c] + cross[r][c] + cross[c][r]; }
    }
}

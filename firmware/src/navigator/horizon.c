/* horizon.c - the nominal state and its covariance through time: to the next epoch, and on to now. */
#include <string.h>

#include "internal.h"

#include "pelorus/earth.h"
#include "pelorus/math.h"

#define OMEGA_SMOOTH_S    0.02 /* one 500 Hz gyro increment's quantization is 8 mm/s on a 3 m arm */
#define LEAST_LAG_S       0.6 /* without epochs the filter follows now this closely, or as far as one may be waited for */
#define LAG_STEP_NS       (100 * PEL_NS_PER_MS)
#define SINGLE_STEP_MAX_S 100.0 /* GNSS alone: a longer silence starts afresh */

/* An increment without the sensor errors known now. */
static void correct(const pel_navigator_t *nav, const pel_imu_t *imu, double alpha[3], double upsilon[3])
{
    const double *constant = nav->errors.gyro_constant, *markov = nav->errors.gyro_markov;
    const double b_g[3] = {constant[0] + markov[0], constant[1] + markov[1], constant[2] + markov[2]};
    pel_imu_correct(imu, b_g, nav->errors.accel_markov, alpha, upsilon);
}

/* One increment on a strapdown state. */
static void step(const pel_navigator_t *nav, const pel_imu_t *imu, pel_strapdown_t *s, pel_coning_t *c)
{
    double alpha[3], upsilon[3];
    correct(nav, imu, alpha, upsilon);
    pel_strapdown_step(s, c, alpha, upsilon, imu->dt_s, imu->t_ns);
}

/* The part of the ring's i-th increment, which ends after from, that lies in (from, to]: the increment itself or, where it is cut,
 * *part. NULL if nothing is left of it. */
static const pel_imu_t *clipped(const pel_navigator_t *nav, int i, pel_time_t from_ns, pel_time_t to_ns,
                                pel_imu_t *part)
{
    const pel_imu_t *imu = pel_imu_ring_at(&nav->ring, i);
    pel_imu_t rest;
    if (imu == NULL) { return NULL; }
    if (pel_imu_split(imu, from_ns, &rest, part) == PEL_OK) { imu = part; }
    if (imu->t_ns > to_ns && pel_imu_split(imu, to_ns, part, &rest) == PEL_OK) { imu = part; }
    return (imu->t_ns <= to_ns) ? imu : NULL;
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

/* One increment on the horizon's state and its covariance; the state in local axes where the filter is. */
static pel_status_t step_horizon(pel_navigator_t *nav, const pel_imu_t *part, pel_strapdown_enu_t *enu)
{
    pel_strapdown_t *s = &nav->at_horizon;
    pel_coning_t *c = &nav->coning_horizon;
    pel_propagator_t *p = &nav->propagator;
    if (!nav->local) {
        step(nav, part, s, c);
        return pel_propagator_add(p, &nav->model, c->dv_f_e, part->dt_s, s->C_b_e, s->r_eb_e, &nav->ud);
    }
    double alpha[3], upsilon[3];
    correct(nav, part, alpha, upsilon);
    const pel_status_t status = pel_strapdown_enu_step(enu, c, alpha, upsilon, part->dt_s, part->t_ns);
    if (status < 0) { return status; }
    s->t_ns = part->t_ns;
    return pel_propagator_add_enu(p, &nav->model, c->dv_f_e, part->dt_s, enu, &nav->ud);
}

/* The horizon's state in the axes of the filter, before and after an advance. */
static pel_status_t enter_axes(pel_navigator_t *nav, pel_strapdown_enu_t *enu)
{
    const pel_status_t status = pel_nav_choose_axes(nav);
    if (status < 0 || !nav->local) { return status; }
    const pel_status_t inside = pel_strapdown_to_enu(&nav->at_horizon, enu);
    if (inside == PEL_OK) { pel_nav_restart_substep(nav, enu->C_b_enu); }
    return inside;
}

static pel_status_t leave_axes(pel_navigator_t *nav, const pel_strapdown_enu_t *enu)
{
    pel_strapdown_t *s = &nav->at_horizon;
    if (!nav->local) { return pel_propagator_flush(&nav->propagator, &nav->model, s->C_b_e, s->r_eb_e, &nav->ud); }
    pel_strapdown_from_enu(enu, s);
    return pel_propagator_flush_enu(&nav->propagator, &nav->model, enu, &nav->ud);
}

static pel_status_t advance_ins(pel_navigator_t *nav, pel_time_t t_ns)
{
    pel_strapdown_t *s = &nav->at_horizon;
    pel_strapdown_enu_t enu;
    const pel_imu_t *newest = pel_imu_ring_newest(&nav->ring);
    const pel_imu_t *oldest = pel_imu_ring_oldest(&nav->ring);
    if (newest == NULL || newest->t_ns < t_ns) { return PEL_E_MISSING; }
    if (pel_time_diff_s(oldest->t_ns, s->t_ns) > oldest->dt_s + 1e-6) { return PEL_E_MISSING; }
    pel_imu_t part;
    const pel_imu_t *imu;
    const int first = pel_imu_ring_after(&nav->ring, s->t_ns);
    if (!is_whole_from(nav, first)) { return PEL_E_RANGE; }
    pel_status_t status = enter_axes(nav, &enu);
    if (status < 0) { return status; }
    for (int i = first; (imu = clipped(nav, i, s->t_ns, t_ns, &part)) != NULL; i++) {
        const pel_status_t added = step_horizon(nav, imu, &enu);
        if (added < 0) { status = added; }
        smooth_omega(nav, imu);
        decay_markov(nav, imu->dt_s);
        double turn, push;
        if (pel_nav_doubt_of(nav, i, imu->dt_s, &turn, &push)) { pel_nav_doubt_motion(nav, turn, push); }
    }
    const pel_status_t flushed = leave_axes(nav, &enu);
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

/* C <- exp(-[psi x]) C */
static void turn_back(const pel_real psi[3], double C_b[3][3])
{
    const double minus_psi[3] = {-(double)psi[0], -(double)psi[1], -(double)psi[2]};
    pel_dcm_turn_to(C_b, minus_psi);
    pel_dcm_orthonormalise(C_b);
}

/* x of position, velocity and (with INS) attitude out of the horizon's state. */
static void correct_e(pel_navigator_t *nav, const pel_real *dr, const pel_real *dv, const pel_real *psi)
{
    pel_strapdown_t *s = &nav->at_horizon;
    for (int k = 0; k < 3; k++) {
        s->v_eb_e[k] -= (double)dv[k];
        s->r_eb_e[k] -= (double)dr[k];
        nav->corrected_e[k] -= (double)dr[k];
    }
    if (psi != NULL) { turn_back(psi, s->C_b_e); }
}

static void correct_local(pel_navigator_t *nav, const pel_real *dr, const pel_real *dv, const pel_real *psi)
{
    pel_strapdown_t *s = &nav->at_horizon;
    const double before_e[3] = {s->r_eb_e[0], s->r_eb_e[1], s->r_eb_e[2]};
    pel_strapdown_enu_t enu;
    double M, N;
    if (pel_strapdown_to_enu(s, &enu) != PEL_OK) { return; } /* not this near to a pole: pel_nav_choose_axes() */
    pel_earth_radii_at(pel_sin(enu.lat), &M, &N);
    for (int k = 0; k < 3; k++) { enu.v_eb_enu[k] -= (double)dv[k]; }
    turn_back(psi, enu.C_b_enu);
    enu.lon -= (double)dr[0] / ((N + enu.h) * pel_cos(enu.lat));
    enu.lat -= (double)dr[1] / (M + enu.h);
    enu.h -= (double)dr[2];
    pel_strapdown_from_enu(&enu, s);
    for (int k = 0; k < 3; k++) { nav->corrected_e[k] += s->r_eb_e[k] - before_e[k]; }
}

static void correct_sensors(pel_navigator_t *nav)
{
    const pel_real *x = nav->ud.x;
    const int i_bg = pel_model_index(&nav->model, PEL_BLOCK_GYRO_CONSTANT);
    const int i_gm = pel_model_index(&nav->model, PEL_BLOCK_GYRO_MARKOV);
    const int i_am = pel_model_index(&nav->model, PEL_BLOCK_ACCEL_MARKOV);
    for (int k = 0; k < 3; k++) {
        nav->errors.gyro_constant[k] += (double)x[i_bg + k];
        nav->errors.gyro_markov[k] += (double)x[i_gm + k];
        nav->errors.accel_markov[k] += (double)x[i_am + k];
    }
}

void pel_nav_close_loop(pel_navigator_t *nav)
{
    pel_real *x = nav->ud.x;
    const pel_real *dr = &x[pel_model_index(&nav->model, PEL_BLOCK_POSITION)];
    const pel_real *dv = &x[pel_model_index(&nav->model, PEL_BLOCK_VELOCITY)];
    const pel_real *psi = nav->ins ? &x[pel_model_index(&nav->model, PEL_BLOCK_ATTITUDE)] : NULL;
    if (nav->ins && nav->local) {
        correct_local(nav, dr, dv, psi);
    } else {
        correct_e(nav, dr, dv, psi);
    }
    if (nav->ins) { correct_sensors(nav); }
    pel_nav_track_close_loop(nav);
    pel_nav_vehicle_close_loop(nav);
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
    const bool nearly_full = pel_imu_ring_has_after(&nav->ring, nav->at_horizon.t_ns, PEL_IMU_RING - 4);
    const double longest_lag_s =
        pel_max(LEAST_LAG_S, (double)nav->cfg.base_wait_s + (double)nav->cfg.apply_delay_s + 0.2);
    if (!nearly_full && pel_time_diff_s(nav->now.t_ns, nav->at_horizon.t_ns) < longest_lag_s) { return; }
    const pel_time_t to_ns =
        nearly_full ? pel_imu_ring_at(&nav->ring, PEL_IMU_RING / 4)->t_ns : nav->at_horizon.t_ns + LAG_STEP_NS;
    if (pel_nav_advance(nav, to_ns) < 0) {
        nav->counters.numeric_faults++;
        pel_nav_drop_ins(nav);
    } else if (pel_nav_wheels_update(nav)) {
        pel_nav_predict_now(nav);
    }
}

void pel_nav_take_increment(pel_navigator_t *nav, const pel_imu_t *body)
{
    (void)pel_imu_ring_push(&nav->ring, body);
    pel_nav_wheels_increment(nav, body);
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
    pel_nav_axes_t axes;
    pel_nav_axes(nav, &axes);
    pel_nav_block_e(nav, &axes, i, i, P);
    if (ant->i_psi < 0) { return; }
    const double A[3][3] = {{0.0, a[2], -a[1]}, {-a[2], 0.0, a[0]}, {a[1], -a[0], 0.0}};
    double Ppp[3][3], Ppr[3][3], APA[3][3], cross[3][3];
    pel_nav_block_e(nav, &axes, ant->i_psi, ant->i_psi, Ppp);
    pel_nav_block_e(nav, &axes, ant->i_psi, i, Ppr);
    pel_mat3_congruence(A, Ppp, APA);
    pel_mat3_mul(A, Ppr, cross);
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) { P[r][c] += APA[r][c] + cross[r][c] + cross[c][r]; }
    }
}

/* wheels.c - what a vehicle on wheels is known to do: it goes where it points and not sideways or upwards; where it stands, it does not
 * move. Only where the configuration says that there are wheels.
 *
 * Which way it points on the body is learnt while GNSS tells its velocity, so the IMU may be mounted anyhow: an error of heading then turns both
 * alike and the course stays right. Standing shows in the gyros: they are as quiet as they were when GNSS said so, and the velocity agrees. */
#include "internal.h"

#include "pelorus/math.h"

#define UPDATE_S     0.5  /* rows are made this often */
#define ALONE_S      1.0  /* rolling counts so long after the last epoch: beside GNSS it ties heading to what it told */
#define WINDOW_S     0.5  /* of the gyros, to judge whether it stands */
#define LEARN_MPS    5.0  /* direction: above this speed ... */
#define LEARN_RPS    0.05 /* ... and straight on ... */
#define LEARN_SD_MPS 0.2  /* ... with a velocity known this well (3-D, 1 sigma) */
#define LEARN_S      10.0 /* before the direction is used */
#define MEMORY_S     120.0
#define STRANGE_COS  0.98 /* 11 degrees off what was learnt: sliding, or a ramp being met */
#define MEAN_TURN_S  0.5  /* turn rates are averaged this long: wheels shake */
#define SLIP_MPS     0.1  /* tyres, suspension: 1 sigma, for SLIP_TAU_S */
#define SLIP_TAU_S   1.0
#define ARM_M        1.5   /* a turn moves the IMU sideways by its distance from the axle that does not steer */
#define ANGLE_RAD    0.005 /* of the direction learnt, for ANGLE_TAU_S */
#define ANGLE_TAU_S  60.0
#define SLIDING      PEL_R(4.0) /* sigma: a row beyond is no rolling */
#define QUIET        4.0        /* variance of the gyros over that at rest */
#define EVEN_MPS2    0.1  /* specific force of a window against the one before: setting off, or the jerk of stopping */
#define REST_MPS     0.1  /* GNSS says that it stands */
#define CREEP_MPS    0.15 /* it may be standing: so much, and three sigma */
#define RESTS_LEAST  4.0  /* windows before the level is known */
#define RESTS_MOST   200.0
#define STAND_MPS    0.03 /* an engine shakes; 1 sigma of a row */

static double velocity_sd(const pel_navigator_t *nav)
{
    const int i_v = pel_model_index(&nav->model, PEL_BLOCK_VELOCITY);
    double var = 0.0;
    for (int k = 0; k < 3; k++) { var += (double)pel_ud_cov(&nav->ud, i_v + k, i_v + k); }
    return pel_sqrt(var);
}

/* ---- standing ------------------------------------------------------------------------------------------------------ */

static void learn_rest(pel_wheels_t *w, double var)
{
    const double rests = pel_min((double)w->rests + 1.0, RESTS_MOST);
    const double before = (w->rests < 1.0f) ? var : (double)w->rest_var;
    const double seen = pel_min(var, QUIET * before); /* the jolt of setting off is no rest */
    w->rest_var = (float)(before + (seen - before) / rests);
    w->rests = (float)rests;
}

static void end_window(pel_navigator_t *nav)
{
    pel_wheels_t *w = &nav->wheels;
    const double n = (double)w->n_samples;
    double var = 0.0, change[3];
    for (int k = 0; k < 3; k++) {
        const double f_b = (double)w->sum_f[k] / (double)w->span_s, mean = (double)w->sum[k] / n;
        change[k] = f_b - (double)w->f_b[k];
        w->f_b[k] = (float)f_b;
        var += (double)w->sum_sq[k] / n - mean * mean;
        w->sum[k] = w->sum_sq[k] = w->sum_f[k] = 0.0f;
    }
    w->n_samples = w->span_s = 0.0f;
    if (!nav->have_state) { return; }
    const double speed = pel_norm3(nav->at_horizon.v_eb_e), sd = velocity_sd(nav);
    if (speed < REST_MPS && sd < LEARN_SD_MPS) { learn_rest(w, var); }
    w->quiet = (double)w->rests >= RESTS_LEAST && var < QUIET * (double)w->rest_var && pel_norm3(change) < EVEN_MPS2 &&
               speed < CREEP_MPS + 3.0 * sd;
}

void pel_nav_wheels_increment(pel_navigator_t *nav, const pel_imu_t *body)
{
    pel_wheels_t *w = &nav->wheels;
    if (!nav->cfg.wheels) { return; }
    for (int k = 0; k < 3; k++) {
        const float rate = (float)(body->alpha_ib_b[k] / body->dt_s);
        w->sum[k] += rate;
        w->sum_sq[k] += rate * rate;
        w->sum_f[k] += (float)body->upsilon_ib_b[k];
    }
    w->n_samples += 1.0f;
    w->span_s += (float)body->dt_s;
    const double span_s = (double)w->span_s;
    if (span_s < WINDOW_S - 0.5 * body->dt_s) { return; }
    const bool was_quiet = w->quiet;
    end_window(nav);
    if (!was_quiet) { w->quiet_since_ns = body->t_ns - (int64_t)(1e9 * span_s); }
    w->judged_ns = body->t_ns;
}

/* ---- rolling ------------------------------------------------------------------------------------------------------- */

static bool is_direction(const float d[3])
{
    const float n_sq = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    return n_sq > 0.9f && n_sq < 1.1f; /* false for NaN */
}

/* Two axes across the direction of travel, and that between them, as the columns of a matrix. */
static void axes_across(const float direction_b[3], double C_v_b[3][3])
{
    const double d_b[3] = {(double)direction_b[0], (double)direction_b[1], (double)direction_b[2]};
    double right[3], up[3], forward[3];
    const int k = (pel_fabs(d_b[2]) < 0.9) ? 2 : 0;
    double other[3] = {0.0, 0.0, 0.0};
    other[k] = 1.0;
    (void)pel_unit3(d_b, forward);
    pel_cross3(forward, other, right);
    (void)pel_unit3(right, right);
    pel_cross3(right, forward, up);
    for (int i = 0; i < 3; i++) {
        C_v_b[i][0] = right[i];
        C_v_b[i][1] = forward[i];
        C_v_b[i][2] = up[i];
    }
}

/* Variance of a velocity across, as one row each dt_s: errors that last count with 2 tau / dt of theirs. */
static double variance_across(double speed, double turn_radps, double dt_s)
{
    const double arm = ARM_M * turn_radps, angle = ANGLE_RAD * speed;
    return (SLIP_MPS * SLIP_MPS + arm * arm) * pel_max(1.0, 2.0 * SLIP_TAU_S / dt_s) +
           angle * angle * pel_max(1.0, 2.0 * ANGLE_TAU_S / dt_s);
}

static void roll(pel_navigator_t *nav, const pel_nav_axes_t *axes, const pel_antenna_t *ant, double dt_s)
{
    const pel_strapdown_t *s = &nav->at_horizon;
    const double no_arm[3] = {0.0, 0.0, 0.0};
    double f_b[3], omega_b[3], C_v_b[3][3], C_v_e[3][3];
    pel_row_t row;
    if (pel_nav_ring_mean(nav, s->t_ns, MEAN_TURN_S, f_b, omega_b) < 0.5 * MEAN_TURN_S) { return; }
    axes_across(nav->wheels.d_b, C_v_b);
    pel_mat3_mul(s->C_b_e, C_v_b, C_v_e);
    const double var = variance_across(pel_norm3(s->v_eb_e), pel_norm3(omega_b), dt_s);
    for (int axis = 0; axis <= 2; axis += 2) {
        pel_observe_body_velocity(ant, C_v_e, s->v_eb_e, no_arm, axis, 0.0, &row);
        pel_nav_known_row(nav, axes, ant, &row, pel_sqrt(var), SLIDING);
    }
}

/* After an epoch: where on the body does the velocity point? */
static void learn_direction(pel_navigator_t *nav, double dt_s)
{
    pel_wheels_t *w = &nav->wheels;
    const pel_strapdown_t *s = &nav->at_horizon;
    double f_b[3], omega_b[3], u[3];
    if (pel_norm3(s->v_eb_e) < LEARN_MPS || velocity_sd(nav) > LEARN_SD_MPS) { return; }
    if (pel_nav_ring_mean(nav, s->t_ns, MEAN_TURN_S, f_b, omega_b) < 0.5 * MEAN_TURN_S) { return; }
    if (pel_norm3(omega_b) > LEARN_RPS) { return; }
    pel_mat3_tvec(s->C_b_e, s->v_eb_e, u);
    (void)pel_unit3(u, u);
    if (!is_direction(w->d_b)) { w->direction_s = 0.0f; }
    const double learnt_s = (double)w->direction_s;
    const double d_b[3] = {(double)w->d_b[0], (double)w->d_b[1], (double)w->d_b[2]};
    const double along = (learnt_s > 0.0) ? pel_dot3(d_b, u) : 1.0;
    const double sign = (along < 0.0) ? -1.0 : 1.0; /* backwards is along the same line */
    if (learnt_s > LEARN_S && along * sign < STRANGE_COS) { return; }
    const double total_s = pel_min(learnt_s + dt_s, MEMORY_S), gain = pel_min(1.0, dt_s / total_s);
    w->direction_s = (float)total_s;
    for (int k = 0; k < 3; k++) {
        w->d_b[k] = (float)((learnt_s > 0.0) ? d_b[k] + gain * (sign * u[k] - d_b[k]) : u[k]);
    }
}

bool pel_nav_wheels_update(pel_navigator_t *nav)
{
    pel_wheels_t *w = &nav->wheels;
    const pel_time_t t_ns = nav->at_horizon.t_ns;
    const double dt_s = pel_time_diff_s(t_ns, w->updated_ns);
    if (!nav->cfg.wheels || !nav->ins || (dt_s >= 0.0 && dt_s < UPDATE_S)) { return false; }
    const bool stands = w->quiet && w->quiet_since_ns <= t_ns && t_ns <= w->judged_ns; /* it may have set off since */
    const bool alone = pel_time_diff_s(t_ns, nav->last_epoch_ns) > ALONE_S;
    if (!stands && (w->quiet || !alone || (double)w->direction_s < LEARN_S || !is_direction(w->d_b))) { return false; }
    w->updated_ns = t_ns;

    pel_nav_axes_t axes;
    pel_antenna_t ant;
    double r_e[3], v_e[3];
    pel_nav_axes(nav, &axes);
    pel_nav_antenna(nav, &ant, r_e, v_e);
    if (stands) {
        pel_nav_rest_rows(nav, &axes, &ant, STAND_MPS, 0);
    } else {
        roll(nav, &axes, &ant, UPDATE_S);
    }
    pel_nav_close_loop(nav);
    return true;
}

void pel_nav_wheels_epoch(pel_navigator_t *nav)
{
    const double gap_s = pel_time_diff_s(nav->at_horizon.t_ns, nav->epoch_before_ns);
    if (!nav->cfg.wheels || !nav->ins) { return; }
    if (nav->epoch_before_ns != 0 && gap_s > 0.0 && gap_s < 1.5) { learn_direction(nav, gap_s); }
    (void)pel_nav_wheels_update(nav);
}

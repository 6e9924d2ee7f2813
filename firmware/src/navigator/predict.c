/* predict.c - covariance of the state predicted to now. The filter's is that of the horizon; over the half second since then attitude
 * becomes velocity through gravity, and velocity position.
 *
 *     psi' = psi + C b_g t      v' = v - [s x] psi + C b_a t      r' = r + v t - [s x] psi t / 2
 *
 * with s the integral of specific force over t, taken from the change of velocity. Cross terms with the sensor errors are left out:
 * their share is below a millimetre a second. */
#include "internal.h"

#include "pelorus/earth.h"
#include "pelorus/math.h"

typedef double mat3_t[3][3];

/* P += w (A + A') */
static void add_both(mat3_t P, double w, const mat3_t A)
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { P[i][j] += w * (A[i][j] + A[j][i]); }
    }
}

static void add_diagonal(mat3_t P, double var)
{
    for (int k = 0; k < 3; k++) { P[k][k] += var; }
}

/* Mean variance of the three states of a block: turned by C it is that on every axis. */
static double mean_var(const pel_navigator_t *nav, pel_block_t block)
{
    const int i = pel_model_index(&nav->model, block);
    return ((double)pel_ud_cov(&nav->ud, i, i) + (double)pel_ud_cov(&nav->ud, i + 1, i + 1) +
            (double)pel_ud_cov(&nav->ud, i + 2, i + 2)) /
           3.0;
}

/* -[s x] */
static void minus_cross(const pel_navigator_t *nav, const pel_strapdown_t *at, double t_s, mat3_t A)
{
    double g_e[3], s[3];
    pel_earth_gravity_e(at->r_eb_e, g_e);
    for (int k = 0; k < 3; k++) { s[k] = at->v_eb_e[k] - nav->at_horizon.v_eb_e[k] - g_e[k] * t_s; }
    const mat3_t minus = {{0.0, s[2], -s[1]}, {-s[2], 0.0, s[0]}, {s[1], -s[0], 0.0}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { A[i][j] = minus[i][j]; }
    }
}

/* What doubtful increments since the horizon bring. */
static void add_doubts(const pel_navigator_t *nav, const pel_strapdown_t *at, double t_s, pel_nav_cov_t *P)
{
    double turn, push;
    for (int i = pel_imu_ring_after(&nav->ring, nav->at_horizon.t_ns); i < nav->ring.n; i++) {
        const pel_imu_t *imu = pel_imu_ring_at(&nav->ring, i);
        if (!pel_nav_doubt_of(nav, i, imu->dt_s, &turn, &push)) { continue; }
        if (imu->t_ns - (int64_t)(imu->dt_s * 1e9) >= at->t_ns) { return; }
        add_diagonal(P->psi, turn);
        add_diagonal(P->v, push);
        add_diagonal(P->r, push * t_s * t_s);
    }
}

void pel_nav_predicted_cov(const pel_navigator_t *nav, const pel_strapdown_t *at, pel_nav_cov_t *P)
{
    const int i_v = pel_model_index(&nav->model, PEL_BLOCK_VELOCITY);
    const int i_r = pel_model_index(&nav->model, PEL_BLOCK_POSITION);
    const int i_p = pel_model_index(&nav->model, PEL_BLOCK_ATTITUDE);
    const double t = pel_time_diff_s(at->t_ns, nav->at_horizon.t_ns);
    pel_nav_axes_t axes;
    pel_nav_axes(nav, &axes);
    pel_nav_block_e(nav, &axes, i_v, i_v, P->v);
    pel_nav_block_e(nav, &axes, i_r, i_r, P->r);
    if (i_p >= 0) { pel_nav_block_e(nav, &axes, i_p, i_p, P->psi); }
    if (i_p < 0 || !(t > 0.0)) { return; }

    add_doubts(nav, at, t, P);
    mat3_t P_pv, P_pr, P_vr, A, AP, APA;
    pel_nav_block_e(nav, &axes, i_p, i_v, P_pv);
    pel_nav_block_e(nav, &axes, i_p, i_r, P_pr);
    pel_nav_block_e(nav, &axes, i_v, i_r, P_vr);
    minus_cross(nav, at, t, A);
    pel_mat3_congruence(A, P->psi, APA);
    add_both(P->r, t, P_vr);
    add_both(P->r, 0.5 * t * t, P->v);
    add_both(P->r, 0.125 * t * t, APA);
    pel_mat3_mul(A, P_pr, AP);
    add_both(P->r, 0.5 * t, AP);
    pel_mat3_mul(A, P_pv, AP);
    add_both(P->r, 0.5 * t * t, AP);
    add_both(P->v, 1.0, AP);
    add_both(P->v, 0.5, APA);

    const pel_imu_model_t *imu = &nav->cfg.imu;
    const double var_a = t * t * mean_var(nav, PEL_BLOCK_ACCEL_MARKOV) + imu->vrw_mps_rts * imu->vrw_mps_rts * t;
    const double var_g = t * t * (mean_var(nav, PEL_BLOCK_GYRO_CONSTANT) + mean_var(nav, PEL_BLOCK_GYRO_MARKOV)) +
                         imu->arw_rad_rts * imu->arw_rad_rts * t;
    add_diagonal(P->v, var_a);
    add_diagonal(P->r, 0.25 * t * t * var_a);
    add_diagonal(P->psi, var_g);
}

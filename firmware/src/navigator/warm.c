/* warm.c - is the attitude of the life before still true? Age, place, gravity and Earth rate at the first epoch decide. */
#include "internal.h"

#include "pelorus/earth.h"
#include "pelorus/math.h"

#define GATE_SIGMA        5.0
#define STILL_MPS         0.1              /* and three of the velocity's own sigma */
#define STILL_RADPS       (0.5 * PEL_DEG)  /* and five of the gyro's: rate over the omega filter's 20 ms */
#define STARTING_MPS      0.5              /* of the first epoch, code and Doppler alone */
#define SETTLE_RAD        (0.05 * PEL_DEG) /* what a vehicle's springs and load do to it while it stands */
#define SPAN_S            1.0              /* of IMU data, at most */
#define REPEAT            0.5 /* a gyro constant changes at power-up; half of its spread between units is assumed */
#define GNSS_SYSTEMATIC_M 2.0 /* code errors common to an epoch's satellites, not in its covariance */

static void unpack(const float p[6], double P[3][3])
{
    static const int INDEX[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { P[i][j] = (double)p[INDEX[i][j]]; }
    }
}

void pel_nav_warm_epoch(pel_navigator_t *nav)
{
    pel_warm_t *w = &nav->warm;
    if (!nav->ins) {
        w->still_since_ns = 0;
        return;
    }
    const int i_v = pel_model_index(&nav->model, PEL_BLOCK_VELOCITY);
    const int i_g = pel_model_index(&nav->model, PEL_BLOCK_GYRO_CONSTANT);
    const double sd_v = pel_sqrt((double)pel_ud_cov(&nav->ud, i_v, i_v));
    const double sd_g = pel_sqrt((double)pel_ud_cov(&nav->ud, i_g, i_g));
    const double noise = nav->cfg.imu.arw_rad_rts / 0.1; /* over the filter's 20 ms, and some vibration */
    const bool still = pel_norm3(nav->at_horizon.v_eb_e) < STILL_MPS + 3.0 * pel_min(sd_v, 0.1) &&
                       pel_norm3(nav->omega_ib_b) < STILL_RADPS + GATE_SIGMA * (sd_g + noise);
    if (!still) {
        w->still_since_ns = 0;
    } else if (w->still_since_ns == 0) {
        w->still_since_ns = nav->at_horizon.t_ns;
    }
}

/* ---- the verdict -------------------------------------------------------------------------------------------------------- */

/* Variances of the kept sensor errors now: Markov states have decayed, a constant was switched on anew. */
static void age_errors(const pel_navigator_t *nav, double age_s, double error[9], double var[9])
{
    const pel_snapshot_t *s = &nav->warm.kept;
    const pel_imu_model_t *imu = &nav->cfg.imu;
    const double keep[3] = {1.0, pel_exp(-age_s / imu->tau_gm_s), pel_exp(-age_s / imu->tau_am_s)};
    const double sd[3] = {REPEAT * imu->sd_bg_radps, imu->sd_gm_radps, imu->sd_am_mps2};
    for (int i = 0; i < 9; i++) {
        const double k = keep[i / 3], fresh = (i < 3) ? 1.0 : 1.0 - k * k;
        error[i] = k * s->error[i];
        var[i] = k * k * (double)s->sd_error[i] * (double)s->sd_error[i] + fresh * sd[i / 3] * sd[i / 3];
    }
}

static bool has_moved(const pel_navigator_t *nav)
{
    const pel_snapshot_t *s = &nav->warm.kept;
    const int i_r = pel_model_index(&nav->model, PEL_BLOCK_POSITION);
    double now[3][3], then[3][3], d2 = 0.0, var = 0.0;
    pel_ud_block3(&nav->ud, i_r, i_r, now);
    unpack(s->cov_r_e, then);
    for (int k = 0; k < 3; k++) {
        const double d = nav->at_horizon.r_eb_e[k] - s->r_ea_e[k]; /* without INS the horizon is the antenna's */
        d2 += d * d;
        var += now[k][k] + then[k][k] + GNSS_SYSTEMATIC_M * GNSS_SYSTEMATIC_M;
    }
    return !(d2 < GATE_SIGMA * GATE_SIGMA * var);
}

/* Gravity and Earth rate as this attitude would have them felt, against what is felt. */
static bool has_turned(const pel_navigator_t *nav, const double C_b_e[3][3], double age_s)
{
    double f[3], omega[3], error[9], var[9], g_e[3], f_then[3], omega_then[3], P[3][3], across[3];
    const double omega_ie_e[3] = {0.0, 0.0, PEL_OMEGA_IE};
    const double span_s = pel_nav_ring_mean(nav, nav->at_horizon.t_ns, SPAN_S, f, omega);
    age_errors(nav, age_s, error, var);
    unpack(nav->warm.kept.cov_psi_e, P);
    pel_earth_gravity_e(nav->at_horizon.r_eb_e, g_e);
    pel_mat3_tvec(C_b_e, g_e, f_then);
    pel_mat3_tvec(C_b_e, omega_ie_e, omega_then);
    for (int k = 0; k < 3; k++) { f[k] -= error[6 + k]; }
    const double g = pel_norm3(g_e);
    pel_cross3(f, f_then, across);
    const double tilt = pel_norm3(across) / (g * g); /* also large when upside down is felt as upright: see dot */
    const double var_white = nav->cfg.imu.vrw_mps_rts * nav->cfg.imu.vrw_mps_rts / span_s;
    const double var_tilt = P[0][0] + P[1][1] + P[2][2] + 2.0 * SETTLE_RAD * SETTLE_RAD +
                            (var[6] + var[7] + var[8] + 3.0 * var_white) / (g * g);
    if (!(tilt * tilt < GATE_SIGMA * GATE_SIGMA * var_tilt) || pel_dot3(f, f_then) > 0.0) { return true; }
    for (int k = 0; k < 3; k++) {
        const double d = omega[k] - error[k] - error[3 + k] - omega_then[k];
        const double noise = nav->cfg.imu.arw_rad_rts * nav->cfg.imu.arw_rad_rts / span_s;
        if (!(d * d < GATE_SIGMA * GATE_SIGMA * (var[k] + var[3 + k] + noise))) { return true; }
    }
    return false;
}

static pel_snap_t judge(const pel_navigator_t *nav, const double C_b_e[3][3], double age_s)
{
    const double max_age_s = nav->cfg.warm_max_age_s;
    if (!(age_s >= 0.0 && age_s <= max_age_s)) { return PEL_SNAP_STALE; }
    if (!(nav->warm.kept.still_s > 0.0f)) { return PEL_SNAP_UNDER_WAY; }
    if (has_moved(nav)) { return PEL_SNAP_MOVED; }
    if (nav->align.restarts > 0 || pel_norm3(nav->at_horizon.v_eb_e) > STARTING_MPS) { return PEL_SNAP_NOT_STILL; }
    if (has_turned(nav, C_b_e, age_s)) { return PEL_SNAP_TURNED; }
    return PEL_SNAP_USED;
}

bool pel_nav_warm_attitude(pel_navigator_t *nav, pel_alignment_t *out)
{
    pel_warm_t *w = &nav->warm;
    if (w->report.verdict != PEL_SNAP_WAITING) { return false; }
    double C_b_e[3][3], up[3];
    pel_rotvec_to_dcm(w->kept.theta_b_e, C_b_e);
    const double age_s = pel_time_diff_s(nav->at_horizon.t_ns, w->kept.t_ns);
    const pel_snap_t verdict = judge(nav, C_b_e, age_s);
    w->report.t_ns = nav->at_horizon.t_ns;
    w->report.verdict = (uint8_t)verdict;
    w->report.age_s = (float)age_s;
    w->report.count[verdict]++;
    nav->ready |= PEL_NAV_BIT(PEL_NAV_WARM);
    if (verdict != PEL_SNAP_USED) { return false; }
    unpack(w->kept.cov_psi_e, out->cov_psi_e);
    pel_mat3_copy(C_b_e, out->C_b_e);
    for (int i = 0; i < 3; i++) { out->cov_psi_e[i][i] += SETTLE_RAD * SETTLE_RAD; }
    (void)pel_unit3(nav->at_horizon.r_eb_e, up);
    const double var_heading = pel_nav_along(out->cov_psi_e, up);
    const double var_level = out->cov_psi_e[0][0] + out->cov_psi_e[1][1] + out->cov_psi_e[2][2] - var_heading;
    out->sd_heading_rad = pel_sqrt(var_heading);
    out->sd_level_rad = pel_sqrt(0.5 * pel_max(var_level, 0.0));
    w->errors_due = true;
    return true;
}

void pel_nav_warm_errors(pel_navigator_t *nav, pel_real sd[PEL_MAX_STATES])
{
    pel_warm_t *w = &nav->warm;
    if (!w->errors_due) { return; }
    w->errors_due = false;
    double error[9], var[9];
    age_errors(nav, pel_time_diff_s(nav->at_horizon.t_ns, w->kept.t_ns), error, var);
    const int i_c = pel_model_index(&nav->model, PEL_BLOCK_GYRO_CONSTANT);
    const int i_m = pel_model_index(&nav->model, PEL_BLOCK_GYRO_MARKOV);
    const int i_a = pel_model_index(&nav->model, PEL_BLOCK_ACCEL_MARKOV);
    for (int k = 0; k < 3; k++) {
        nav->errors.accel_markov[k] = error[6 + k];
        sd[i_a + k] = (pel_real)pel_sqrt(var[6 + k]);
        /* What this standstill has shown of the gyros may be better; it is their whole error. */
        if ((double)sd[i_c + k] * (double)sd[i_c + k] < var[k]) { continue; }
        nav->errors.gyro_constant[k] = error[k];
        nav->errors.gyro_markov[k] = error[3 + k];
        sd[i_c + k] = (pel_real)pel_sqrt(var[k]);
        sd[i_m + k] = (pel_real)pel_sqrt(var[3 + k]);
    }
}

/* start.c - from nothing to GNSS alone, from there to the INS, and back when it must be. */
#include <string.h>

#include "internal.h"

#include "pelorus/earth.h"
#include "pelorus/math.h"

#define START_SD_R_M       5.0 /* at least: a single-point solution has biases its covariance does not know */
#define START_SD_V_MPS     0.5
#define UNKNOWN_SD_V_MPS   10.0 /* no Doppler */
#define STATIC_MIN_S       20.0 /* gyrocompassing and gyro calibration need this much standing still */
#define STILL_MPS          0.5  /* a steady turn or a straight flight looks static to an IMU: GNSS must say so too */
#define LEVEL_SPAN_S       1.0  /* specific force is averaged this long to level while moving */
#define RATE_SPAN_S        0.02 /* angular rate likewise, for the lever arm's rate */
#define LEVEL_SD_RAD       (4.0 * PEL_DEG)
#define COURSE_SD_RAD      (15.0 * PEL_DEG) /* crab, and a forward axis mounted by hand */
#define COMPASS_SD_MAX_RAD (3.0 * PEL_DEG)
#define SHAKE_RAD          2e-6 /* of a vehicle that stands */
#define IMU_READY_NS       (50 * PEL_NS_PER_MS)

void pel_nav_reset_alignment(pel_navigator_t *nav)
{
    const pel_imu_model_t *imu = &nav->cfg.imu;
    const pel_align_config_t cfg = {
        .arw_rad_rts = imu->arw_rad_rts,
        .vrw_mps_rts = imu->vrw_mps_rts,
        .sd_bg_radps = imu->sd_bg_radps,
        .sd_ba_mps2 = imu->sd_am_mps2,
        .block_s = 0.25,
        .gyro_tol_radps = pel_max(0.002, 6.0 * imu->arw_rad_rts),
        .accel_tol_mps2 = pel_max(0.02, 8.0 * imu->vrw_mps_rts),
    };
    pel_align_init(&nav->align, &cfg);
    memset(&nav->yaw, 0, sizeof nav->yaw);
    nav->first_imu_ns = 0;
}

void pel_nav_align_increment(pel_navigator_t *nav, const pel_imu_t *body)
{
    (void)pel_align_push(&nav->align, body);
    pel_nav_yaw_increment(&nav->yaw, body);
    if (nav->first_imu_ns == 0) {
        nav->first_imu_ns = body->t_ns - (int64_t)(body->dt_s * 1e9);
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) { nav->C_rel[i][j] = (i == j) ? 1.0 : 0.0; }
        }
    }
    pel_dcm_turn_from(nav->C_rel, body->alpha_ib_b);
}

/* ---- GNSS alone ----------------------------------------------------------------------------------------------------- */

void pel_nav_start_gnss(pel_navigator_t *nav, const pel_spp_t *spp)
{
    pel_model_gnss(&nav->model, &nav->cfg.imu);
    pel_nav_track_forget(nav);
    nav->ins = false;
    nav->have_state = true;
    nav->at_horizon.t_ns = spp->t_ns;
    memcpy(nav->at_horizon.r_eb_e, spp->r_ea_e, sizeof spp->r_ea_e);
    pel_real sd[PEL_MAX_STATES];
    for (int k = 0; k < 3; k++) {
        nav->at_horizon.v_eb_e[k] = spp->has_velocity ? spp->v_ea_e[k] : 0.0;
        const double sd_v = spp->has_velocity ? START_SD_V_MPS : UNKNOWN_SD_V_MPS;
        sd[k] = (pel_real)pel_sqrt(sd_v * sd_v + (spp->has_velocity ? spp->cov_v_e[k][k] : 0.0));
        sd[3 + k] = (pel_real)pel_sqrt(START_SD_R_M * START_SD_R_M + 4.0 * spp->cov_r_e[k][k]);
    }
    if (pel_ud_init(&nav->ud, nav->model.n, sd) != PEL_OK) { nav->have_state = false; }
    nav->now = nav->at_horizon;
    nav->doubts = 0;
}

void pel_nav_drop_ins(pel_navigator_t *nav)
{
    if (!nav->ins) { return; }
    pel_antenna_t ant;
    pel_spp_t as_spp = {.t_ns = nav->at_horizon.t_ns, .has_velocity = true};
    pel_nav_antenna(nav, &ant, as_spp.r_ea_e, as_spp.v_ea_e);
    pel_nav_antenna_cov(nav, &ant, false, as_spp.cov_r_e);
    pel_nav_antenna_cov(nav, &ant, true, as_spp.cov_v_e);
    nav->counters.restarts++;
    pel_nav_start_gnss(nav, &as_spp);
    pel_nav_reset_alignment(nav);
}

/* ---- the INS -------------------------------------------------------------------------------------------------------- */

/* The attitude given at the first increment, carried to t by the gyros and the turn of the Earth. */
static void carry_given_attitude(const pel_navigator_t *nav, pel_time_t t_ns, double lat, double lon,
                                 pel_alignment_t *out)
{
    const pel_nav_config_t *cfg = &nav->cfg;
    pel_align_from_attitude(cfg->roll_rad, cfg->pitch_rad, cfg->heading_rad, cfg->sd_tilt_rad, cfg->sd_heading_rad, lat,
                            lon, out);
    double C_rel[3][3], C[3][3];
    pel_mat3_copy(nav->C_rel, C_rel);
    pel_imu_t part, rest;
    for (int i = nav->ring.n - 1; i >= 0 && pel_imu_ring_at(&nav->ring, i)->t_ns > t_ns; i--) {
        part = *pel_imu_ring_at(&nav->ring, i);
        (void)pel_imu_split(&part, t_ns, &rest, &part);
        const double undo[3] = {-part.alpha_ib_b[0], -part.alpha_ib_b[1], -part.alpha_ib_b[2]};
        pel_dcm_turn_from(C_rel, undo);
    }
    const double earth_turn[3] = {0.0, 0.0, -PEL_OMEGA_IE * pel_time_diff_s(t_ns, nav->first_imu_ns)};
    pel_mat3_mul(out->C_b_e, C_rel, C);
    pel_dcm_turn_to(C, earth_turn);
    pel_mat3_copy(C, out->C_b_e);
}

double pel_nav_ring_mean(const pel_navigator_t *nav, pel_time_t t_ns, double longest_s, double f_ib_b[3],
                         double omega_ib_b[3])
{
    double span_s = 0.0;
    for (int k = 0; k < 3; k++) { f_ib_b[k] = omega_ib_b[k] = 0.0; }
    for (int i = pel_imu_ring_after(&nav->ring, t_ns) - 1; i >= 0 && span_s < longest_s; i--) {
        const pel_imu_t *imu = pel_imu_ring_at(&nav->ring, i);
        span_s += imu->dt_s;
        for (int k = 0; k < 3; k++) {
            f_ib_b[k] += imu->upsilon_ib_b[k];
            omega_ib_b[k] += imu->alpha_ib_b[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        f_ib_b[k] /= span_s;
        omega_ib_b[k] /= span_s;
    }
    return span_s;
}

/* Level from gravity and the GNSS acceleration, heading from the course over ground. */
static bool align_moving(const pel_navigator_t *nav, double lat, double lon, double h, pel_alignment_t *out)
{
    const pel_strapdown_t *s = &nav->at_horizon;
    double C_e_enu[3][3], v_enu[3], dv_e[3], a_enu[3], f_ib_b[3], omega_ib_b[3];
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    pel_mat3_vec(C_e_enu, s->v_eb_e, v_enu);
    const double speed = pel_sqrt(v_enu[0] * v_enu[0] + v_enu[1] * v_enu[1]);
    const double dt_s = pel_time_diff_s(s->t_ns, nav->epoch_before_ns);
    if (speed < nav->cfg.align_speed_mps) { return false; }
    if (pel_nav_ring_mean(nav, s->t_ns, LEVEL_SPAN_S, f_ib_b, omega_ib_b) < 0.25 * LEVEL_SPAN_S) { return false; }
    for (int k = 0; k < 3; k++) { dv_e[k] = (s->v_eb_e[k] - nav->v_before_e[k]) / pel_max(dt_s, 0.05); }
    pel_mat3_vec(C_e_enu, dv_e, a_enu);
    const bool have_a = nav->epoch_before_ns != 0 && dt_s < 1.5;
    const double sd_course = pel_sqrt(COURSE_SD_RAD * COURSE_SD_RAD + 0.01 / (speed * speed));
    return pel_align_level(f_ib_b, have_a ? a_enu : NULL, pel_atan2(v_enu[0], v_enu[1]), sd_course, LEVEL_SD_RAD, lat,
                           lon, h, out) == PEL_OK;
}

static bool stands_still(const pel_navigator_t *nav)
{
    return pel_norm3(nav->at_horizon.v_eb_e) < STILL_MPS;
}

/* While standing still the gyros show their own error (and 15 deg/h of the Earth): better than the data sheet. */
static void calibrate_gyros(pel_navigator_t *nav, const double C_b_e[3][3], pel_real sd[PEL_MAX_STATES])
{
    const double t_s = nav->align.t_static_s;
    if (t_s < 1.0 || !stands_still(nav)) { return; }
    const double omega_ie_e[3] = {0.0, 0.0, PEL_OMEGA_IE};
    double omega_ie_b[3];
    pel_mat3_tvec(C_b_e, omega_ie_e, omega_ie_b);
    const double sd_mean = nav->cfg.imu.arw_rad_rts / pel_sqrt(t_s) + PEL_OMEGA_IE;
    if (sd_mean >= nav->cfg.imu.sd_bg_radps) { return; }
    for (int k = 0; k < 3; k++) {
        nav->errors.gyro_constant[k] = nav->align.sum_alpha[k] / t_s - omega_ie_b[k];
        sd[k] = (pel_real)sd_mean;
    }
}

static bool find_attitude(pel_navigator_t *nav, pel_alignment_t *out)
{
    double lat, lon, h;
    out->leans_on_sensors = false;
    pel_earth_ecef_to_llh(nav->at_horizon.r_eb_e, &lat, &lon, &h);
    if (nav->attitude_given) {
        carry_given_attitude(nav, nav->at_horizon.t_ns, lat, lon, out);
        return true;
    }
    if (pel_nav_warm_attitude(nav, out)) { return true; }
    if (nav->align.t_static_s >= STATIC_MIN_S && stands_still(nav) &&
        pel_align_gyrocompass(&nav->align, lat, lon, h, COMPASS_SD_MAX_RAD, out) == PEL_OK) {
        return true;
    }
    if (nav->cfg.mount_known) { return align_moving(nav, lat, lon, h, out); }
    double C_b_enu[3][3], sd_heading, roll, pitch, heading;
    if (!pel_nav_yaw_solve(nav, C_b_enu, &sd_heading)) { return false; }
    pel_attitude_from_C_b_enu(C_b_enu, &roll, &pitch, &heading);
    pel_align_from_attitude(roll, pitch, heading, LEVEL_SD_RAD, sd_heading, lat, lon, out);
    return true;
}

/* State and covariance of the antenna become those of the IMU: r_b = r_a - C l, so dr_b = dr_a + [C l x] psi; velocity alike
 * with the arm's rate. Without these terms a well-known antenna would make a vague attitude look as well known. */
static pel_status_t antenna_to_imu(pel_navigator_t *nav)
{
    pel_antenna_t ant;
    pel_transition_t t;
    double f_ib_b[3], r_e[3], v_e[3], A[3][3];
    (void)pel_nav_ring_mean(nav, nav->at_horizon.t_ns, RATE_SPAN_S, f_ib_b, nav->omega_ib_b);
    for (int k = 0; k < 3; k++) { nav->omega_ib_b[k] -= nav->errors.gyro_constant[k]; }
    pel_nav_antenna(nav, &ant, r_e, v_e);
    for (int k = 0; k < 3; k++) {
        nav->at_horizon.r_eb_e[k] -= ant.lever_e[k];
        nav->at_horizon.v_eb_e[k] -= ant.lever_rate_e[k];
    }
    memset(&t, 0, sizeof t);
    t.n = nav->model.n;
    pel_cross_matrix(ant.lever_rate_e, A);
    pel_nav_add_block(&t, ant.i_v, ant.i_psi, A);
    pel_cross_matrix(ant.lever_e, A);
    pel_nav_add_block(&t, ant.i_r, ant.i_psi, A);
    return pel_ud_time_update(&nav->ud, &t);
}

/* How much of a Markov error's mean over a span is still there at its end: correlation, 1 sigma. */
static double kept(double span_s, double tau_s)
{
    const double x = span_s / tau_s;
    return (x < 1e-3) ? 1.0 : (1.0 - pel_exp(-x)) / x;
}

/* An attitude from a standing IMU and the IMU's errors are one lump: what of the attitude is noise is uncorrelated, the rest follows from the
 * sensor states, so that rows that show the one show the other. */
static pel_status_t lean_on_sensors(pel_navigator_t *nav)
{
    const pel_imu_model_t *imu = &nav->cfg.imu;
    const double t_s = nav->align.t_static_s;
    const double keep_f = kept(t_s, imu->tau_am_s), keep_w = kept(t_s, imu->tau_gm_s);
    const double var_f =
        imu->vrw_mps_rts * imu->vrw_mps_rts / t_s + imu->sd_am_mps2 * imu->sd_am_mps2 * (1.0 - keep_f * keep_f);
    const double var_w =
        imu->arw_rad_rts * imu->arw_rad_rts / t_s + imu->sd_gm_radps * imu->sd_gm_radps * (1.0 - keep_w * keep_w);
    const int i_psi = pel_model_index(&nav->model, PEL_BLOCK_ATTITUDE);
    double lat, lon, h, A_f[3][3], A_w[3][3], P[3][3];
    pel_transition_t t;
    pel_earth_ecef_to_llh(nav->at_horizon.r_eb_e, &lat, &lon, &h);
    pel_align_sensor_part(nav->at_horizon.C_b_e, lat, lon, h, A_f, A_w);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const double level = var_f * pel_dot3(A_f[i], A_f[j]), heading = var_w * pel_dot3(A_w[i], A_w[j]);
            P[i][j] = level + heading + ((i == j) ? SHAKE_RAD * SHAKE_RAD : 0.0);
        }
    }
    pel_status_t status = pel_ud_set_block3(&nav->ud, i_psi, P);
    if (status != PEL_OK) { return status; }
    memset(&t, 0, sizeof t);
    t.n = nav->model.n;
    pel_nav_add_block(&t, i_psi, pel_model_index(&nav->model, PEL_BLOCK_GYRO_CONSTANT), A_w);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            A_w[i][j] *= keep_w;
            A_f[i][j] *= keep_f;
        }
    }
    pel_nav_add_block(&t, i_psi, pel_model_index(&nav->model, PEL_BLOCK_GYRO_MARKOV), A_w);
    pel_nav_add_block(&t, i_psi, pel_model_index(&nav->model, PEL_BLOCK_ACCEL_MARKOV), A_f);
    return pel_ud_time_update(&nav->ud, &t);
}

static pel_status_t begin_filter(pel_navigator_t *nav, const pel_alignment_t *attitude)
{
    pel_antenna_t ant;
    double P_r[3][3], P_v[3][3], r_e[3], v_e[3];
    pel_nav_antenna(nav, &ant, r_e, v_e);
    pel_nav_antenna_cov(nav, &ant, false, P_r);
    pel_nav_antenna_cov(nav, &ant, true, P_v);

    pel_real sd[PEL_MAX_STATES];
    pel_nav_preset(nav->cfg.preset)->model(&nav->model, &nav->cfg.imu);
    nav->local = false; /* the first advance turns it */
    pel_nav_track_forget(nav);
    for (int i = 0; i < nav->model.n; i++) { sd[i] = PEL_R(1.0); }
    pel_model_sensor_sd(&nav->model, sd);
    nav->errors = (pel_sensor_errors_t){{0}, {0}, {0}};
    calibrate_gyros(nav, attitude->C_b_e, sd);
    pel_nav_warm_errors(nav, sd);
    pel_status_t status = pel_ud_init(&nav->ud, nav->model.n, sd);
    if (status == PEL_OK) {
        status = pel_ud_set_block3(&nav->ud, pel_model_index(&nav->model, PEL_BLOCK_ATTITUDE), attitude->cov_psi_e);
    }
    if (status == PEL_OK) {
        status = pel_ud_set_block3(&nav->ud, pel_model_index(&nav->model, PEL_BLOCK_VELOCITY), P_v);
    }
    if (status == PEL_OK) {
        status = pel_ud_set_block3(&nav->ud, pel_model_index(&nav->model, PEL_BLOCK_POSITION), P_r);
    }
    return status;
}

static void begin_ins(pel_navigator_t *nav, const pel_alignment_t *attitude)
{
    pel_status_t status = begin_filter(nav, attitude);
    nav->ins = true;
    nav->attitude_given = false; /* that of the first increment: good for one start */
    pel_mat3_copy(attitude->C_b_e, nav->at_horizon.C_b_e);
    if (status == PEL_OK && attitude->leans_on_sensors) { status = lean_on_sensors(nav); }
    if (status == PEL_OK) { status = antenna_to_imu(nav); }
    if (status == PEL_OK) { status = pel_nav_vehicle_begin(nav); }
    if (status != PEL_OK) {
        nav->counters.numeric_faults++;
        nav->ins = nav->have_state = false;
        return;
    }
    pel_coning_init(&nav->coning_horizon);
    pel_propagator_init(&nav->propagator, nav->at_horizon.C_b_e);
    nav->poses.n = 0;
}

void pel_nav_try_start_ins(pel_navigator_t *nav)
{
    const pel_time_t t_ns = nav->at_horizon.t_ns;
    if (nav->timing.doubted) { return; }
    if (nav->ins || !pel_nav_preset(nav->cfg.preset)->imu) { return; }
    const pel_imu_t *oldest = pel_imu_ring_oldest(&nav->ring);
    if (oldest == NULL || oldest->t_ns > t_ns - IMU_READY_NS || nav->last_imu_ns < t_ns) { return; }
    pel_alignment_t attitude;
    pel_nav_yaw_epoch(nav);
    if (find_attitude(nav, &attitude)) { begin_ins(nav, &attitude); }
}

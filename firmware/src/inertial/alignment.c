/* alignment.c - static averages, gyrocompass, levelling, given attitude. */
#include "pelorus/earth.h"
#include "pelorus/inertial.h"
#include "pelorus/math.h"

#define MISFIT                                                                                                         \
    0.25 /* largest relative misfit of a measured magnitude: beyond it the input is not what it is said to be */

void pel_align_init(pel_align_t *a, const pel_align_config_t *cfg)
{
    const pel_align_t none = {0};
    *a = none;
    a->cfg = *cfg;
}

/* Does the finished block agree with the mean so far? The first one always does. */
static bool block_is_static(const pel_align_t *a)
{
    for (int i = 0; i < 3 && a->t_static_s > 0.0; i++) {
        const double dw = a->block_alpha[i] / a->block_s - a->sum_alpha[i] / a->t_static_s;
        const double df = a->block_upsilon[i] / a->block_s - a->sum_upsilon[i] / a->t_static_s;
        if (!(pel_fabs(dw) < a->cfg.gyro_tol_radps && pel_fabs(df) < a->cfg.accel_tol_mps2)) { return false; }
    }
    return true;
}

pel_status_t pel_align_push(pel_align_t *a, const pel_imu_t *imu)
{
    for (int i = 0; i < 3; i++) {
        a->block_alpha[i] += imu->alpha_ib_b[i];
        a->block_upsilon[i] += imu->upsilon_ib_b[i];
    }
    a->block_s += imu->dt_s;
    if (a->block_s < a->cfg.block_s) { return PEL_W_RUNNING; }

    a->still = block_is_static(a);
    const double keep = a->still ? 1.0 : 0.0; /* on motion the block is the first of a new average */
    for (int i = 0; i < 3; i++) {
        a->sum_alpha[i] = keep * a->sum_alpha[i] + a->block_alpha[i];
        a->sum_upsilon[i] = keep * a->sum_upsilon[i] + a->block_upsilon[i];
        a->block_alpha[i] = 0.0;
        a->block_upsilon[i] = 0.0;
    }
    a->t_static_s = keep * a->t_static_s + a->block_s;
    a->block_s = 0.0;
    if (!a->still) { a->restarts++; }
    return a->still ? PEL_OK : PEL_W_REJECTED;
}

pel_status_t pel_align_mean(const pel_align_t *a, double f_ib_b[3], double omega_ib_b[3])
{
    if (!(a->t_static_s > 0.0)) { return PEL_E_MISSING; }
    for (int i = 0; i < 3; i++) {
        f_ib_b[i] = a->sum_upsilon[i] / a->t_static_s;
        omega_ib_b[i] = a->sum_alpha[i] / a->t_static_s;
    }
    return PEL_OK;
}

/* Covariance of psi in e from that in east-north-up: tilts sd_level each, heading sd_heading in all, of which the part
 * `coupling` x (tilt about north). */
static void covariance_of_psi(double sd_level, double sd_heading, double coupling, double lat, double lon,
                              double cov_psi_e[3][3])
{
    const double var_level = sd_level * sd_level;
    const double P[3][3] = {{var_level, 0.0, 0.0},
                            {0.0, var_level, coupling * var_level},
                            {0.0, coupling * var_level, sd_heading * sd_heading}};
    double C_e_enu[3][3];
    double C_enu_e[3][3];
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    pel_mat3_transpose(C_e_enu, C_enu_e);
    pel_mat3_congruence(C_enu_e, P, cov_psi_e);
}

/* Orthonormal east, north, up as rows, from up (unit) and any vector in the plane of north and up. False if they are parallel. */
static bool triad(const double up[3], const double polar[3], double enu[3][3])
{
    double east[3];
    pel_cross3(polar, up, east);
    if (!(pel_unit3(east, enu[0]) > 0.0)) { return false; }
    pel_cross3(up, enu[0], enu[1]);
    for (int i = 0; i < 3; i++) { enu[2][i] = up[i]; }
    return true;
}

pel_status_t pel_align_gyrocompass(const pel_align_t *a, double lat, double lon, double h, double sd_heading_max_rad,
                                   pel_alignment_t *out)
{
    double f[3];
    double omega[3];
    const pel_status_t status = pel_align_mean(a, f, omega);
    if (status != PEL_OK) { return status; }

    double r_e[3];
    double g_e[3];
    pel_earth_llh_to_ecef(lat, lon, h, r_e);
    pel_earth_gravity_e(r_e, g_e);
    const double g = pel_norm3(g_e);
    const double T = a->t_static_s;
    const double var_f = a->cfg.sd_ba_mps2 * a->cfg.sd_ba_mps2 + a->cfg.vrw_mps_rts * a->cfg.vrw_mps_rts / T;
    const double var_w = a->cfg.sd_bg_radps * a->cfg.sd_bg_radps + a->cfg.arw_rad_rts * a->cfg.arw_rad_rts / T;
    const double sd_level = pel_sqrt(var_f) / g;
    const double cos_lat = pel_cos(lat);
    const double tan_lat = pel_sin(lat) / cos_lat;
    /* heading error = tan(lat) x tilt about north + east gyro error / horizontal Earth rate */
    const double sd_heading =
        pel_sqrt(var_w / (PEL_OMEGA_IE * PEL_OMEGA_IE * cos_lat * cos_lat) + tan_lat * tan_lat * sd_level * sd_level);
    if (!(cos_lat > 0.0175) || !(sd_heading <= sd_heading_max_rad)) {
        const pel_status_t level = pel_align_level(f, NULL, 0.0, PEL_PI, sd_level, lat, lon, h, out);
        return (level == PEL_OK) ? PEL_W_REJECTED : level;
    }

    double up_b[3];
    double up_e[3];
    double enu_b[3][3];
    double enu_e[3][3];
    const double polar_e[3] = {0.0, 0.0, 1.0};
    const double f_norm = pel_unit3(f, up_b);
    const double w_norm = pel_norm3(omega);
    (void)pel_unit3(g_e, up_e);
    for (int i = 0; i < 3; i++) { up_e[i] = -up_e[i]; } /* the plumb line, not the ellipsoid's normal */
    if (!(pel_fabs(f_norm - g) < MISFIT * g &&
          pel_fabs(w_norm - PEL_OMEGA_IE) < MISFIT * PEL_OMEGA_IE + 3.0 * pel_sqrt(var_w)) ||
        !triad(up_b, omega, enu_b) || !triad(up_e, polar_e, enu_e)) {
        return PEL_E_GEOMETRY;
    }
    pel_mat3_tmul(enu_e, enu_b, out->C_b_e);
    out->sd_level_rad = sd_level;
    out->sd_heading_rad = sd_heading;
    covariance_of_psi(sd_level, sd_heading, tan_lat, lat, lon, out->cov_psi_e);
    out->leans_on_sensors = true;
    return PEL_OK;
}

/* From C f = g up and (C omega) east = 0 to first order: psi_E = Delta_N/g, psi_N = -Delta_E/g, psi_U = (eps_E + omega_U psi_N)/omega_N. */
void pel_align_sensor_part(const double C_b_e[3][3], double lat, double lon, double h, double A_f[3][3],
                           double A_w[3][3])
{
    double r_e[3], g_e[3], C_e_enu[3][3], C_b_enu[3][3], sin_lat, cos_lat;
    pel_earth_llh_to_ecef(lat, lon, h, r_e);
    pel_earth_gravity_e(r_e, g_e);
    pel_sincos(lat, &sin_lat, &cos_lat);
    const double per_g = 1.0 / pel_norm3(g_e), per_omega_N = 1.0 / (PEL_OMEGA_IE * cos_lat);
    const double F[3][3] = {{0.0, per_g, 0.0}, {-per_g, 0.0, 0.0}, {-per_g * sin_lat / cos_lat, 0.0, 0.0}};
    const double W[3][3] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {per_omega_N, 0.0, 0.0}};
    double part[3][3];
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    pel_mat3_mul(C_e_enu, C_b_e, C_b_enu);
    pel_mat3_mul(F, C_b_enu, part);
    pel_mat3_tmul(C_e_enu, part, A_f);
    pel_mat3_mul(W, C_b_enu, part);
    pel_mat3_tmul(C_e_enu, part, A_w);
}

pel_status_t pel_align_level(const double f_ib_b[3], const double a_eb_enu[3], double heading, double sd_heading,
                             double sd_level, double lat, double lon, double h, pel_alignment_t *out)
{
    double r_e[3];
    double g_e[3];
    double C_e_enu[3][3];
    double f_enu[3]; /* what the specific force must be: acceleration minus gravity */
    pel_earth_llh_to_ecef(lat, lon, h, r_e);
    pel_earth_gravity_e(r_e, g_e);
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    pel_mat3_vec(C_e_enu, g_e, f_enu);
    for (int i = 0; i < 3; i++) { f_enu[i] = ((a_eb_enu != NULL) ? a_eb_enu[i] : 0.0) - f_enu[i]; }

    const double expected = pel_norm3(f_enu);
    if (!(pel_fabs(pel_norm3(f_ib_b) - expected) < MISFIT * expected)) { return PEL_E_GEOMETRY; }

    /* Rx(pitch) Ry(roll) f_b = Rz(heading) f_enu: its x component gives roll, then y and z give pitch */
    double sh;
    double ch;
    pel_sincos(heading, &sh, &ch);
    const double right = ch * f_enu[0] - sh * f_enu[1];
    const double forward = sh * f_enu[0] + ch * f_enu[1];
    const double xz = pel_sqrt(f_ib_b[0] * f_ib_b[0] + f_ib_b[2] * f_ib_b[2]);
    if (!(xz > 0.1 * expected) || !(pel_fabs(right) <= xz)) { return PEL_E_GEOMETRY; }
    const double roll = pel_asin(right / xz) - pel_atan2(f_ib_b[0], f_ib_b[2]);
    const double z = -pel_sin(roll) * f_ib_b[0] + pel_cos(roll) * f_ib_b[2];
    const double pitch = pel_atan2(f_enu[2], forward) - pel_atan2(z, f_ib_b[1]);
    pel_align_from_attitude(roll, pitch, heading, sd_level, sd_heading, lat, lon, out);
    return PEL_OK;
}

void pel_align_from_attitude(double roll, double pitch, double heading, double sd_level, double sd_heading, double lat,
                             double lon, pel_alignment_t *out)
{
    pel_attitude_to_C_b_e(roll, pitch, heading, lat, lon, out->C_b_e);
    out->sd_level_rad = sd_level;
    out->sd_heading_rad = sd_heading;
    covariance_of_psi(sd_level, sd_heading, 0.0, lat, lon, out->cov_psi_e);
}

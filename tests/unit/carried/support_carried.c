#include "support_carried.h"

#include <math.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"

#define EPOCH_WAITS_NS (200 * PEL_NS_PER_MS)

/* Along the line at time t: place, speed, acceleration. */
static void motion(const carried_t *c, double t, double *d, double *v, double *a)
{
    const double w = c->sway_radps, moving_s = t - c->begin_s;
    *d = *v = *a = 0.0;
    if (moving_s < 0.0) { return; }
    *d = c->speed_mps * moving_s + c->sway_m * (1.0 - cos(w * moving_s));
    *v = c->speed_mps + c->sway_m * w * sin(w * moving_s);
    *a = c->sway_m * w * w * cos(w * moving_s);
}

static void local_axes(const carried_t *c, double C_e_enu[3][3])
{
    double lat, lon, h;
    pel_earth_ecef_to_llh(c->start_e, &lat, &lon, &h);
    pel_earth_C_e_enu(lat, lon, C_e_enu);
}

void carried_course(carried_t *c, double course_rad)
{
    double C_e_enu[3][3];
    const double enu[3] = {sin(course_rad), cos(course_rad), 0.0};
    local_axes(c, C_e_enu);
    pel_mat3_tvec(C_e_enu, enu, c->along_e);
}

void carried_introduce(carried_t *c, pel_navigator_t *nav, const pel_nav_config_t *cfg)
{
    c->pair.epoch = c->sample = 0;
    pair_introduce(&c->pair, nav, cfg);
}

void carried_init(carried_t *c, pel_navigator_t *nav, double heading_rad, bool told)
{
    memset(c, 0, sizeof *c);
    pair_init(&c->pair, nav, 1u << PEL_SYS_GPS, (1u << PEL_CARRIER_L1) | (1u << PEL_CARRIER_L2));
    c->seed = 7;
    c->noise = 1.0;
    memcpy(c->start_e, c->pair.rover.r_e, sizeof c->start_e);
    double C_e_enu[3][3];
    local_axes(c, C_e_enu);
    const double s = sin(heading_rad), k = cos(heading_rad);
    const double C_b_enu[3][3] = {{k, s, 0.0}, {-s, k, 0.0}, {0.0, 0.0, 1.0}};
    pel_mat3_tmul(C_e_enu, C_b_enu, c->C_b_e);
    carried_course(c, heading_rad);

    pel_nav_config_t cfg = nav->cfg;
    cfg.have_attitude = told;
    cfg.heading_rad = heading_rad;
    cfg.sd_tilt_rad = 0.2 * PEL_DEG;
    cfg.sd_heading_rad = 0.5 * PEL_DEG;
    carried_introduce(c, nav, &cfg);
}

double carried_heading_error(const carried_t *c, const pel_navigator_t *nav)
{
    double C_e_enu[3][3], C[3][3], truth[3][3], turn[3][3];
    local_axes(c, C_e_enu);
    pel_mat3_mul(C_e_enu, nav->at_horizon.C_b_e, C);
    pel_mat3_mul(C_e_enu, c->C_b_e, truth);
    pel_mat3_mult(C, truth, turn);
    return -atan2(turn[1][0], turn[0][0]);
}

static double uniform(carried_t *c)
{
    c->seed = c->seed * 1664525u + 1013904223u;
    return (double)(c->seed >> 8) / 16777216.0 - 0.5;
}

pel_imu_t carried_imu(carried_t *c)
{
    const double dt = 1e-9 * (double)CARRIED_IMU_NS;
    const double t = dt * (c->sample - 0.5);
    double d, v, a, r_e[3], g_e[3], f_e[3];
    motion(c, t, &d, &v, &a);
    for (int k = 0; k < 3; k++) { r_e[k] = c->start_e[k] + d * c->along_e[k]; }
    pel_earth_gravity_e(r_e, g_e);
    const double omega_e[3] = {0.0, 0.0, PEL_OMEGA_IE};
    double coriolis[3];
    pel_cross3(omega_e, c->along_e, coriolis);
    for (int k = 0; k < 3; k++) { f_e[k] = (a * c->along_e[k] + 2.0 * v * coriolis[k] - g_e[k]) * dt; }
    const double turn_e[3] = {0.0, 0.0, PEL_OMEGA_IE * dt};
    pel_imu_t imu = {.t_ns = SKY_T0 + c->sample * CARRIED_IMU_NS, .dt_s = dt, .seq = (uint16_t)c->sample};
    pel_mat3_tvec(c->C_b_e, turn_e, imu.alpha_ib_b);
    pel_mat3_tvec(c->C_b_e, f_e, imu.upsilon_ib_b);
    for (int k = 0; k < 3; k++) {
        imu.alpha_ib_b[k] += c->gyro_error[k] * dt + c->noise * 1e-5 * uniform(c);
        imu.upsilon_ib_b[k] += c->noise * 1e-4 * uniform(c);
    }
    c->sample++;
    return imu;
}

void carried_imu_until(carried_t *c, pel_navigator_t *nav, pel_time_t t_ns)
{
    while (SKY_T0 + c->sample * CARRIED_IMU_NS <= t_ns) {
        const pel_imu_t imu = carried_imu(c);
        pel_navigator_push_imu(nav, &imu);
    }
}

void carried_observe(carried_t *c, pel_epoch_t *base, pel_epoch_t *rover)
{
    double d, v, a;
    motion(c, c->pair.epoch, &d, &v, &a);
    for (int k = 0; k < 3; k++) {
        c->pair.rover.r_e[k] = c->start_e[k] + d * c->along_e[k];
        c->pair.rover.v_e[k] = v * c->along_e[k];
    }
    pair_observe(&c->pair, base, rover);
}

void carried_push(carried_t *c, pel_navigator_t *nav, const pel_epoch_t *base, const pel_epoch_t *rover)
{
    const pel_time_t t_ns = SKY_T0 + (c->pair.epoch - 1) * PEL_NS_PER_S;
    carried_imu_until(c, nav, t_ns);
    if (base != NULL) { pel_navigator_push_base(nav, base); }
    if (rover != NULL) { pel_navigator_push_rover(nav, rover); }
    carried_imu_until(c, nav, t_ns + EPOCH_WAITS_NS);
}

void carried_step(carried_t *c, pel_navigator_t *nav)
{
    static pel_epoch_t base, rover;
    carried_observe(c, &base, &rover);
    carried_push(c, nav, &base, &rover);
}

void carried_run(carried_t *c, pel_navigator_t *nav, int seconds)
{
    for (int i = 0; i < seconds; i++) { carried_step(c, nav); }
}

double carried_error_m(const carried_t *c, const pel_navigator_t *nav)
{
    double d, v, a, sq = 0.0;
    motion(c, pel_time_diff_s(nav->at_horizon.t_ns, SKY_T0), &d, &v, &a);
    for (int k = 0; k < 3; k++) {
        const double off = nav->at_horizon.r_eb_e[k] - c->start_e[k] - d * c->along_e[k];
        sq += off * off;
    }
    return sqrt(sq);
}

double carried_wandered_by(pel_navigator_t *nav, void (*wander)(pel_navigator_t *), double dt_s)
{
    int i = 0;
    while (nav->track.entry[i].state < 0) { i++; }
    const int s = nav->track.entry[i].state;
    const double before = (double)pel_ud_cov(&nav->ud, s, s);
    nav->track.wandered_ns = nav->at_horizon.t_ns - (int64_t)(dt_s * 1e9);
    wander(nav);
    return (double)pel_ud_cov(&nav->ud, s, s) - before;
}

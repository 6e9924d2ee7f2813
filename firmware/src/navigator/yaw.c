/* yaw.c - heading of an IMU mounted anyhow: velocity changes felt by the IMU against those seen by GNSS.
 *
 * A levelled frame l (z up, heading arbitrary) is carried by the gyros. Over each GNSS interval the IMU gives a horizontal
 * velocity change in l, the Doppler velocities one in enu; the rotation between the two series is the heading. Means are
 * removed, so that a tilt or accelerometer error, constant in l, does not turn the answer. In a long turn specific force leans with
 * the bank: l is levelled only while GNSS sees no such acceleration, and carried by the gyros through it. */
#include <string.h>

#include "internal.h"

#include "pelorus/earth.h"
#include "pelorus/math.h"

#define LEVEL_AFTER_S   1.0             /* first levelling averages this long */
#define LEVEL_TAU_S     10.0            /* tilt drift is pulled back to gravity this slowly */
#define CALM_MPS2       0.5             /* 3 degrees of apparent tilt, within LEVEL_SD_RAD of start.c */
#define DRIFT_MAX_RAD   (4.0 * PEL_DEG) /* of the gyros between calm intervals: beyond it levelling begins anew */
#define SHORTEST_S      0.4             /* shorter intervals drown in Doppler noise */
#define LONGEST_S       2.5             /* longer ones had an outage in them */
#define MEMORY          30.0            /* intervals remembered */
#define FEWEST          6.0
#define CORRELATION_MIN 0.6
#define SD_MAX_RAD      (12.0 * PEL_DEG)
#define SD_FLOOR_RAD    (4.0 * PEL_DEG)

/* z of l along the specific force; y of l along the horizontal part of the body's y (or x) axis. */
static void level(pel_yaw_t *y)
{
    double up[3], east[3], north[3], forward[3] = {0.0, 1.0, 0.0};
    (void)pel_unit3(y->dv, up);
    if (pel_fabs(up[1]) > 0.9) {
        forward[0] = 1.0;
        forward[1] = 0.0;
    }
    pel_cross3(forward, up, east);
    (void)pel_unit3(east, east);
    pel_cross3(up, east, north);
    for (int k = 0; k < 3; k++) {
        y->C_b_l[0][k] = east[k];
        y->C_b_l[1][k] = north[k];
        y->C_b_l[2][k] = up[k];
        y->dv[k] = 0.0;
    }
    y->levelled = true;
    y->since_ns = 0; /* an interval does not reach across it */
    y->span_s = 0.0;
}

void pel_nav_yaw_increment(pel_yaw_t *y, const pel_imu_t *body)
{
    y->span_s += body->dt_s;
    if (!y->levelled) {
        for (int k = 0; k < 3; k++) { y->dv[k] += body->upsilon_ib_b[k]; }
        if (y->span_s >= LEVEL_AFTER_S && y->calm) { level(y); }
        return;
    }
    double dv_l[3];
    pel_dcm_turn_from(y->C_b_l, body->alpha_ib_b);
    pel_mat3_vec(y->C_b_l, body->upsilon_ib_b, dv_l);
    for (int k = 0; k < 3; k++) { y->dv[k] += dv_l[k]; }
    const double pull = y->calm ? 1.0 / (LEVEL_TAU_S * 9.8) : 0.0;
    y->leaning_s = y->calm ? 0.0 : y->leaning_s + body->dt_s;
    const double back[3] = {dv_l[1] * pull, -dv_l[0] * pull, 0.0}; /* f_l x z */
    pel_dcm_turn_to(y->C_b_l, back);
    pel_dcm_orthonormalise(y->C_b_l);
}

/* Levelled attitude and velocity change at t, which lies a little behind the newest increment. */
static void rewind_to(const pel_navigator_t *nav, pel_time_t t_ns, double C_b_l[3][3], double dv[3])
{
    double dv_l[3];
    pel_imu_t part, before;
    pel_mat3_copy(nav->yaw.C_b_l, C_b_l);
    memcpy(dv, nav->yaw.dv, sizeof nav->yaw.dv);
    for (int i = nav->ring.n - 1; i >= 0 && pel_imu_ring_at(&nav->ring, i)->t_ns > t_ns; i--) {
        part = *pel_imu_ring_at(&nav->ring, i);
        (void)pel_imu_split(&part, t_ns, &before, &part);
        pel_mat3_vec(C_b_l, part.upsilon_ib_b, dv_l);
        const double undo[3] = {-part.alpha_ib_b[0], -part.alpha_ib_b[1], -part.alpha_ib_b[2]};
        pel_dcm_turn_from(C_b_l, undo);
        for (int k = 0; k < 3; k++) { dv[k] -= dv_l[k]; }
    }
}

static void remember(pel_yaw_t *y, const double a[2], const double b[2])
{
    const double keep = 1.0 - 1.0 / MEMORY;
    y->n = y->n * keep + 1.0;
    for (int k = 0; k < 2; k++) {
        y->a[k] = y->a[k] * keep + a[k];
        y->b[k] = y->b[k] * keep + b[k];
    }
    y->aa = y->aa * keep + a[0] * a[0] + a[1] * a[1];
    y->bb = y->bb * keep + b[0] * b[0] + b[1] * b[1];
    y->dot = y->dot * keep + a[0] * b[0] + a[1] * b[1];
    y->cross = y->cross * keep + a[0] * b[1] - a[1] * b[0];
}

static void wait_for_calm(pel_yaw_t *y)
{
    y->span_s = 0.0;
    for (int k = 0; k < 3; k++) { y->dv[k] = 0.0; }
}

void pel_nav_yaw_epoch(pel_navigator_t *nav)
{
    pel_yaw_t *y = &nav->yaw;
    const pel_spp_t *spp = &nav->spp;
    if (y->leaning_s * nav->cfg.imu.sd_bg_radps > DRIFT_MAX_RAD) { memset(y, 0, sizeof *y); }
    if (!nav->have_spp || !spp->has_velocity || spp->t_ns != nav->at_horizon.t_ns) { return; }
    double C_b_l[3][3], dv[3], lat, lon, h, C_e_enu[3][3], dv_e[3], dv_enu[3];
    rewind_to(nav, spp->t_ns, C_b_l, dv);
    const double span_s = pel_time_diff_s(spp->t_ns, y->since_ns);
    if (y->since_ns != 0 && span_s < SHORTEST_S) { return; }
    pel_earth_ecef_to_llh(spp->r_ea_e, &lat, &lon, &h);
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    for (int k = 0; k < 3; k++) { dv_e[k] = spp->v_ea_e[k] - y->v_since_e[k]; }
    pel_mat3_vec(C_e_enu, dv_e, dv_enu);
    const bool whole = y->since_ns != 0 && span_s < LONGEST_S;
    const double per_s = whole ? 1.0 / span_s : 0.0;
    y->calm = whole && pel_sqrt(dv_enu[0] * dv_enu[0] + dv_enu[1] * dv_enu[1]) * per_s < CALM_MPS2;
    if (!y->calm && !y->levelled) { wait_for_calm(y); }
    if (whole && y->levelled) {
        const double a[2] = {(dv[0] - y->dv_since[0]) * per_s, (dv[1] - y->dv_since[1]) * per_s};
        const double b[2] = {dv_enu[0] * per_s, dv_enu[1] * per_s};
        remember(y, a, b);
    }
    y->since_ns = spp->t_ns;
    memcpy(y->dv_since, dv, sizeof y->dv_since);
    memcpy(y->v_since_e, spp->v_ea_e, sizeof y->v_since_e);
}

bool pel_nav_yaw_solve(const pel_navigator_t *nav, double C_b_enu[3][3], double *sd_rad)
{
    const pel_yaw_t *y = &nav->yaw;
    if (y->n < FEWEST) { return false; }
    const double dot = y->dot - (y->a[0] * y->b[0] + y->a[1] * y->b[1]) / y->n;
    const double cross = y->cross - (y->a[0] * y->b[1] - y->a[1] * y->b[0]) / y->n;
    const double aa = y->aa - (y->a[0] * y->a[0] + y->a[1] * y->a[1]) / y->n;
    const double bb = y->bb - (y->b[0] * y->b[0] + y->b[1] * y->b[1]) / y->n;
    const double size = pel_sqrt(dot * dot + cross * cross);
    if (!(aa > 0.0 && bb > 0.0)) { return false; }
    const double r = pel_min(1.0, size / pel_sqrt(aa * bb));
    if (r < CORRELATION_MIN) { return false; }
    *sd_rad = pel_sqrt((1.0 - r * r) / (r * r * 2.0 * (y->n - 2.0)) + SD_FLOOR_RAD * SD_FLOOR_RAD);
    if (*sd_rad > SD_MAX_RAD) { return false; }
    double dv[3];
    const double about_up[3] = {0.0, 0.0, pel_atan2(cross, dot)};
    rewind_to(nav, nav->at_horizon.t_ns, C_b_enu, dv);
    pel_dcm_turn_to(C_b_enu, about_up);
    return true;
}

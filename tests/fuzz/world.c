/* world.c - see world.h. Satellites and observations are those of the unit tests of gnss/. */
#include "world.h"

#include <math.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "support_gnss.h"

#define SYSTEMS   ((1u << PEL_SYS_GPS) | (1u << PEL_SYS_GAL))
#define SPEED_MPS 10.0

/* Forward is east, up is up, right is south. */
static void set_body(world_t *w, const double r_e[3])
{
    double lat, lon, h, C_e_enu[3][3];
    pel_earth_ecef_to_llh(r_e, &lat, &lon, &h);
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    for (int k = 0; k < 3; k++) {
        w->C_b_e[k][0] = -C_e_enu[1][k];
        w->C_b_e[k][1] = C_e_enu[0][k];
        w->C_b_e[k][2] = C_e_enu[2][k];
    }
}

/* At constant velocity in e a gyro sees the Earth turn, an accelerometer what keeps the body from falling. */
static void set_imu(world_t *w, const double r_e[3], const double v_e[3])
{
    const double dt_s = 1e-9 * (double)WORLD_SAMPLE_NS;
    const double omega_e[3] = {0.0, 0.0, PEL_OMEGA_IE};
    double g_e[3], coriolis[3], f_e[3];
    pel_earth_gravity_e(r_e, g_e);
    pel_cross3(omega_e, v_e, coriolis);
    for (int k = 0; k < 3; k++) { f_e[k] = 2.0 * coriolis[k] - g_e[k]; }
    pel_mat3_tvec(w->C_b_e, omega_e, w->alpha);
    pel_mat3_tvec(w->C_b_e, f_e, w->upsilon);
    for (int k = 0; k < 3; k++) {
        w->alpha[k] *= dt_s;
        w->upsilon[k] *= dt_s;
    }
}

void world_init(world_t *w)
{
    memset(w, 0, sizeof *w);
    sky_init(&w->orbits);
    w->t_start_ns = SKY_T0 + 60 * PEL_NS_PER_S;

    scene_t base = scene_default();
    scene_t rover = scene_default();
    set_body(w, rover.r_e);
    base.clk_m = -20000.0;
    base.clk_rate_mps = 0.0;
    for (int k = 0; k < 3; k++) {
        base.r_e[k] += 700.0 * w->C_b_e[k][0] - 300.0 * w->C_b_e[k][1];
        rover.v_e[k] = SPEED_MPS * w->C_b_e[k][1];
    }
    set_imu(w, rover.r_e, rover.v_e);
    w->station.id = 1;
    memcpy(w->station.r_ea_e, base.r_e, sizeof base.r_e);
    for (int i = 0; i < WORLD_EPOCHS; i++) {
        const pel_time_t t = w->t_start_ns + i * WORLD_EPOCH_NS;
        scene_observe(&rover, &w->orbits, t, SYSTEMS, &w->rover[i]);
        scene_observe(&base, &w->orbits, t, SYSTEMS, &w->base[i]);
        for (int k = 0; k < 3; k++) { rover.r_e[k] += rover.v_e[k] * 1e-9 * (double)WORLD_EPOCH_NS; }
        rover.clk_m += rover.clk_rate_mps * 1e-9 * (double)WORLD_EPOCH_NS;
    }
}

pel_imu_t world_imu(const world_t *w, int k)
{
    pel_imu_t imu = {
        .t_ns = w->t_start_ns + (k + 1) * WORLD_SAMPLE_NS, .dt_s = 1e-9 * (double)WORLD_SAMPLE_NS, .seq = (uint16_t)k};
    memcpy(imu.alpha_ib_b, w->alpha, sizeof imu.alpha_ib_b);
    memcpy(imu.upsilon_ib_b, w->upsilon, sizeof imu.upsilon_ib_b);
    return imu;
}

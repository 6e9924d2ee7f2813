/* output.c - the solution as told to the outside, and what was really used. */
#include <string.h>

#include "internal.h"

#include "pelorus/bits.h"
#include "pelorus/earth.h"
#include "pelorus/math.h"

/* Errors beyond the protection level once in 10^7, if the filter's model holds (two-sided normal). */
#define PROTECTION_SIGMAS 5.33

void pel_nav_pack_symmetric(const double P[3][3], float out[6])
{
    int n = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = i; j < 3; j++) { out[n++] = (float)P[i][j]; }
    }
}

static void fill_protection(const double P_n[3][3], pel_solution_t *out)
{
    const double mean = 0.5 * (P_n[0][0] + P_n[1][1]);
    const double half = 0.5 * (P_n[0][0] - P_n[1][1]);
    const double largest = mean + pel_sqrt(half * half + P_n[0][1] * P_n[0][1]);
    out->hpl_m = (float)(PROTECTION_SIGMAS * pel_sqrt(largest));
    out->vpl_m = (float)(PROTECTION_SIGMAS * pel_sqrt(P_n[2][2]));
}

static void fill_attitude(const pel_strapdown_t *at, const double C_e_n[3][3], const double P_psi_e[3][3],
                          pel_solution_t *out)
{
    double roll, pitch, heading, P_n[3][3];
    pel_attitude_from_C_b_e(at->C_b_e, out->lat_rad, out->lon_rad, &roll, &pitch, &heading);
    pel_mat3_congruence(C_e_n, P_psi_e, P_n);
    pel_nav_pack_symmetric(P_n, out->cov_att);
    out->roll_rad = (float)roll;
    out->pitch_rad = (float)pitch;
    out->heading_rad = (float)heading;
    /* Pitch turns about the body's horizontal right axis, roll about forward: the tilt covariance turned by heading. */
    double s, c;
    pel_sincos(heading, &s, &c);
    const double var_pitch = s * s * P_n[0][0] - 2.0 * s * c * P_n[0][1] + c * c * P_n[1][1];
    const double var_roll = c * c * P_n[0][0] + 2.0 * s * c * P_n[0][1] + s * s * P_n[1][1];
    out->sd_pitch_rad = (float)pel_sqrt(var_pitch);
    out->sd_roll_rad = (float)pel_sqrt(var_roll);
    out->sd_heading_rad = (float)pel_sqrt(P_n[2][2]);
    out->flags |= PEL_SOL_INS | PEL_SOL_ATTITUDE;
    if (out->sd_heading_rad < (float)(20.0 * PEL_DEG)) { out->flags |= PEL_SOL_HEADING; }
}

static void fill_biases(const pel_navigator_t *nav, pel_solution_t *out)
{
    const int i_c = pel_model_index(&nav->model, PEL_BLOCK_GYRO_CONSTANT);
    const int i_m = pel_model_index(&nav->model, PEL_BLOCK_GYRO_MARKOV);
    const int i_a = pel_model_index(&nav->model, PEL_BLOCK_ACCEL_MARKOV);
    for (int k = 0; k < 3; k++) {
        out->b_g[k] = (float)(nav->errors.gyro_constant[k] + nav->errors.gyro_markov[k]);
        out->b_a[k] = (float)nav->errors.accel_markov[k];
        out->sd_b_g[k] = (float)pel_sqrt((double)pel_ud_var_of_sum(&nav->ud, i_c + k, i_m + k));
        out->sd_b_a[k] = (float)pel_sqrt((double)pel_ud_cov(&nav->ud, i_a + k, i_a + k));
    }
}

static uint32_t hash_state(const pel_navigator_t *nav)
{
    const pel_strapdown_t *s = &nav->at_horizon;
    uint32_t h = pel_ud_hash(&nav->ud, PEL_FNV_START);
    h = pel_fnv1a(s->r_eb_e, sizeof s->r_eb_e, h);
    h = pel_fnv1a(s->v_eb_e, sizeof s->v_eb_e, h);
    return pel_fnv1a(s->C_b_e, sizeof s->C_b_e, h);
}

void pel_nav_fill_solution(const pel_navigator_t *nav, const pel_strapdown_t *at, pel_solution_t *out)
{
    double C_e_n[3][3], v_n[3], P_n[3][3];
    pel_nav_cov_t P;
    if (out != &nav->epoch_solution) { *out = nav->epoch_solution; }
    out->t_ns = at->t_ns;
    out->flags = (uint16_t)(out->flags & PEL_SOL_RESTARTED);
    const bool coasting = pel_time_diff_s(at->t_ns, nav->last_epoch_ns) > (double)nav->cfg.coast_after_s;
    out->fix = (uint8_t)(coasting ? PEL_FIX_COAST : nav->last_fix);
    memcpy(out->r_eb_e, at->r_eb_e, sizeof out->r_eb_e);
    pel_earth_ecef_to_llh(at->r_eb_e, &out->lat_rad, &out->lon_rad, &out->height_m);
    pel_earth_C_e_n(out->lat_rad, out->lon_rad, C_e_n);
    pel_mat3_vec(C_e_n, at->v_eb_e, v_n);
    for (int k = 0; k < 3; k++) { out->v_ned[k] = (float)v_n[k]; }
    pel_nav_predicted_cov(nav, at, &P);
    pel_mat3_congruence(C_e_n, P.v, P_n);
    pel_nav_pack_symmetric(P_n, out->cov_v_ned);
    pel_mat3_congruence(C_e_n, P.r, P_n);
    pel_nav_pack_symmetric(P_n, out->cov_r_ned);
    fill_protection(P_n, out);
    if (nav->ins) {
        fill_attitude(at, C_e_n, P.psi, out);
        fill_biases(nav, out);
    }
    out->state_hash = hash_state(nav);
}

/* ---- asked and used -------------------------------------------------------------------------------------------------- */

static void note_carriers(const pel_epoch_t *e, uint8_t seen[PEL_N_SYS])
{
    for (int i = 0; i < e->n; i++) {
        seen[e->obs[i].sys] |= (uint8_t)(1u << e->obs[i].carrier); /* systems that are allowed, so they exist */
    }
}

static pel_why_t system_why(const pel_navigator_t *nav, const pel_used_t *u, int sys)
{
    if ((nav->cfg.systems & (1u << sys)) == 0) { return PEL_WHY_CONFIG; }
    if (u->rover_seen[sys] == 0) { return PEL_WHY_NO_DATA; }
    if (u->carriers_used[sys] != 0) { return PEL_WHY_NONE; }
    if (sys == PEL_SYS_SBS) { return PEL_WHY_UNSUPPORTED; }
    if (nav->relative && u->base_carriers[sys] == 0) { return PEL_WHY_NO_DATA; }
    return PEL_WHY_NO_ORBIT;
}

static pel_why_t imu_why(const pel_navigator_t *nav)
{
    if (nav->ins) { return PEL_WHY_NONE; }
    if (nav->last_imu_ns == 0) { return PEL_WHY_NO_DATA; }
    return pel_nav_preset(nav->cfg.preset)->imu ? PEL_WHY_NOT_ALIGNED : PEL_WHY_CONFIG;
}

static pel_why_t base_why(const pel_navigator_t *nav)
{
    if (nav->relative) { return PEL_WHY_NONE; }
    if (!pel_nav_preset(nav->cfg.preset)->base) { return PEL_WHY_CONFIG; }
    if (nav->n_base == 0) { return PEL_WHY_NO_DATA; }
    return nav->have_station ? PEL_WHY_NO_ORBIT : PEL_WHY_NO_STATION;
}

static bool differs_in_use(const pel_used_t *a, const pel_used_t *b)
{
    bool same = a->preset_used == b->preset_used && a->preset_why == b->preset_why && a->imu_seen == b->imu_seen &&
                a->imu_used == b->imu_used && a->imu_why == b->imu_why && a->base_seen == b->base_seen &&
                a->base_used == b->base_used && a->base_why == b->base_why;
    for (int k = 0; k < 3; k++) { same = same && pel_fabs(a->r_station_e[k] - b->r_station_e[k]) < 1e-4; }
    for (int sys = 0; sys < PEL_N_SYS; sys++) {
        same = same && a->rover_seen[sys] == b->rover_seen[sys] && a->base_carriers[sys] == b->base_carriers[sys] &&
               a->carriers_used[sys] == b->carriers_used[sys] && a->sys_why[sys] == b->sys_why[sys];
    }
    return !same;
}

void pel_nav_note_seen(pel_navigator_t *nav, const pel_epoch_t *rover, const pel_epoch_t *base)
{
    note_carriers(rover, nav->rover_seen);
    if (base != NULL) { note_carriers(base, nav->base_seen); }
}

void pel_nav_note_used(pel_navigator_t *nav)
{
    pel_used_t u = nav->used;
    memcpy(u.rover_seen, nav->rover_seen, sizeof u.rover_seen);
    memcpy(u.base_carriers, nav->base_seen, sizeof u.base_carriers);
    for (int i = 0; i < nav->n_sats; i++) {
        const pel_sat_report_t *r = &nav->sats[i];
        const unsigned any = PEL_SAT_CODE_USED | PEL_SAT_PHASE_USED | PEL_SAT_DOPPLER_USED;
        if ((r->flags & any) != 0) { u.carriers_used[r->sys] |= (uint8_t)(1u << r->carrier); }
    }
    u.preset_asked = (uint8_t)nav->cfg.preset;
    u.preset_used = (uint8_t)pel_nav_preset_in_use(nav);
    u.imu_seen = nav->last_imu_ns != 0;
    u.imu_used = nav->ins;
    u.imu_why = (uint8_t)imu_why(nav);
    u.base_seen = nav->n_base > 0;
    u.base_used = nav->relative;
    u.base_why = (uint8_t)base_why(nav);
    const bool differs = nav->cfg.preset != PEL_PRESET_AUTO && u.preset_used != u.preset_asked;
    const bool lacks_imu = !nav->ins && pel_nav_preset(nav->cfg.preset)->imu; /* AUTO lacks nothing */
    u.preset_why = !differs ? PEL_WHY_NONE : lacks_imu ? u.imu_why : u.base_why;
    for (int sys = 0; sys < PEL_N_SYS; sys++) { u.sys_why[sys] = (uint8_t)system_why(nav, &u, sys); }
    u.arw_rad_rts = (float)nav->cfg.imu.arw_rad_rts;
    u.vrw_mps_rts = (float)nav->cfg.imu.vrw_mps_rts;
    u.sd_bg_radps = (float)nav->cfg.imu.sd_bg_radps;
    u.sd_ba_mps2 = (float)nav->cfg.imu.sd_am_mps2;
    memcpy(u.r_station_e, nav->station.r_ea_e, sizeof u.r_station_e);
    const bool changed = differs_in_use(&u, &nav->used);
    nav->used = u;
    if (!changed) { return; }
    nav->used.t_ns = nav->at_horizon.t_ns;
    nav->used.base_age_s = nav->epoch_solution.base_age_s;
    const pel_imu_t *newest = pel_imu_ring_newest(&nav->ring);
    nav->used.imu_rate_hz = (newest == NULL) ? 0.0f : (float)(1.0 / newest->dt_s);
    nav->ready |= PEL_NAV_BIT(PEL_NAV_USED);
}

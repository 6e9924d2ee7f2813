/* axes.c - the axes of the filter's attitude, velocity and position states: e, or east-north-up at the horizon where the preset asks for it.
 *
 * The nominal state is kept in e for everybody; local axes are those of its place, made when they are needed. Errors in local axes are against
 * axes at the computed place, which a position error dr turns by T dr:
 *
 *     psi_e = C (psi + T dr)      dv_e = C (dv - [v x] T dr)      dr_e = C dr      T dr = (-dr_n / M, dr_e / N, dr_e tan(lat) / N)
 *
 * The maps between both are exact in that; rows and outputs leave T out, 1.6e-7 rad a metre. */
#include "internal.h"

#include <string.h>

#include "pelorus/earth.h"

#define LOCAL_ENDS_RAD   (88.9 * PEL_DEG) /* before the mechanization's own end: no advance flies the 11 km between */
#define LOCAL_BEGINS_RAD (88.8 * PEL_DEG)

void pel_nav_axes(const pel_navigator_t *nav, pel_nav_axes_t *axes)
{
    double lat, lon, h;
    axes->local = nav->ins && nav->local;
    if (!axes->local) { return; }
    pel_earth_ecef_to_llh(nav->at_horizon.r_eb_e, &lat, &lon, &h);
    pel_earth_C_e_enu(lat, lon, axes->C_e_enu);
}

void pel_nav_block_e(const pel_navigator_t *nav, const pel_nav_axes_t *axes, int i, int j, double P[3][3])
{
    double turned[3][3];
    pel_ud_block3(&nav->ud, i, j, P);
    if (!axes->local) { return; }
    pel_mat3_tmul(axes->C_e_enu, P, turned);
    pel_mat3_mul(turned, axes->C_e_enu, P);
}

static void turn_part(const double C[3][3], pel_real h[3])
{
    const double e[3] = {(double)h[0], (double)h[1], (double)h[2]};
    double enu[3];
    pel_mat3_vec(C, e, enu);
    for (int k = 0; k < 3; k++) { h[k] = (pel_real)enu[k]; }
}

void pel_nav_turn_row(const pel_nav_axes_t *axes, const pel_antenna_t *ant, pel_row_t *row)
{
    const int first[3] = {ant->i_psi, ant->i_v, ant->i_r};
    for (int k = 0; axes->local && k < 3; k++) {
        if (first[k] >= row->first) { turn_part(axes->C_e_enu, &row->h[first[k]]); }
    }
}

/* ---- from one to the other ---------------------------------------------------------------------------------------------- */

void pel_nav_add_block(pel_transition_t *t, int row, int col, const double A[3][3])
{
    pel_real(*m)[3] = pel_transition_add(t, row, col);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { m[i][j] = (pel_real)(A[i][j] - ((row == col && i == j) ? 1.0 : 0.0)); }
    }
}

/* x_to = Phi x_from, C from the old axes to the new ones. W: what a position error turns local axes by, on the old position states, resolved
 * in the new ones; +W leaves local axes, -W enters them. */
static pel_status_t turn_states(pel_navigator_t *nav, const double C[3][3], const double W[3][3], const double v_new[3])
{
    const int i_psi = pel_model_index(&nav->model, PEL_BLOCK_ATTITUDE);
    const int i_v = pel_model_index(&nav->model, PEL_BLOCK_VELOCITY);
    const int i_r = pel_model_index(&nav->model, PEL_BLOCK_POSITION);
    const double minus_v[3] = {-v_new[0], -v_new[1], -v_new[2]};
    double V[3][3], VW[3][3];
    pel_transition_t t;
    memset(&t, 0, sizeof t);
    t.n = nav->model.n;
    pel_cross_matrix(minus_v, V);
    pel_mat3_mul(V, W, VW);
    pel_nav_add_block(&t, i_psi, i_psi, C);
    pel_nav_add_block(&t, i_psi, i_r, W);
    pel_nav_add_block(&t, i_v, i_v, C);
    pel_nav_add_block(&t, i_v, i_r, VW);
    pel_nav_add_block(&t, i_r, i_r, C);
    return pel_ud_time_update(&nav->ud, &t);
}

static pel_status_t change(pel_navigator_t *nav, double lat, double lon, double h, bool to_local)
{
    const pel_strapdown_t *s = &nav->at_horizon;
    const double sign = to_local ? -1.0 : 1.0;
    double C_e_enu[3][3], C_enu_e[3][3], v_enu[3], W[3][3], M, N, sin_lat, cos_lat;
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    pel_sincos(lat, &sin_lat, &cos_lat);
    pel_earth_radii_at(sin_lat, &M, &N);
    const double T[3][3] = {
        {0.0, -sign / (M + h), 0.0}, {sign / (N + h), 0.0, 0.0}, {sign * sin_lat / (cos_lat * (N + h)), 0.0, 0.0}};
    if (!to_local) {
        pel_mat3_transpose(C_e_enu, C_enu_e);
        pel_mat3_mul(C_enu_e, T, W);
        return turn_states(nav, C_enu_e, W, s->v_eb_e);
    }
    pel_mat3_mul(T, C_e_enu, W);
    pel_mat3_vec(C_e_enu, s->v_eb_e, v_enu);
    return turn_states(nav, C_e_enu, W, v_enu);
}

/* Between advances nothing is collected, but the attitude is that of the axes before. */
void pel_nav_restart_substep(pel_navigator_t *nav, const double C[3][3])
{
    const double slow_s = nav->propagator.slow_s;
    pel_propagator_init(&nav->propagator, C);
    nav->propagator.slow_s = slow_s;
}

pel_status_t pel_nav_choose_axes(pel_navigator_t *nav)
{
    double lat, lon, h;
    if (!nav->local && !pel_nav_preset(nav->cfg.preset)->local) { return PEL_OK; }
    pel_earth_ecef_to_llh(nav->at_horizon.r_eb_e, &lat, &lon, &h);
    const bool to_local = !nav->local && pel_fabs(lat) < LOCAL_BEGINS_RAD;
    const bool to_e = nav->local && !(pel_fabs(lat) < LOCAL_ENDS_RAD);
    if (!to_local && !to_e) { return PEL_OK; }
    nav->local = to_local;
    pel_nav_restart_substep(nav, nav->at_horizon.C_b_e);
    return change(nav, lat, lon, h, to_local);
}

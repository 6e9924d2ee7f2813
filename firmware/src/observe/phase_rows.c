/* phase_rows.c - phases whose integer is a state, and phases against the previous epoch (S2 section 8, S3 section 6). */
#include "pelorus/earth.h"
#include "row.h"

void pel_observe_float(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double dd_m, int i_state,
                       double scale, pel_row_t *row)
{
    pel_observe_range(ant, sat, pivot, dd_m, row);
    row->h[i_state] = (pel_real)scale;
}

void pel_observe_clone(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double change_m,
                       int i_clone, pel_row_t *row)
{
    pel_observe_range(ant, sat, pivot, change_m, row);
    for (int k = 0; k < 3; k++) { row->h[i_clone + k] = -row->h[ant->i_r + k]; }
    row->first = i_clone;
}

void pel_observe_clone_map(const pel_antenna_t *ant, int axis, pel_real a[PEL_MAX_STATES])
{
    double along[3] = {0.0, 0.0, 0.0};
    double on_psi[3];
    along[axis] = 1.0;
    pel_cross3(ant->lever_e, along, on_psi);
    for (int i = 0; i < ant->n_states; i++) { a[i] = PEL_R(0.0); }
    for (int k = 0; k < 3; k++) { a[ant->i_psi + k] = (pel_real)on_psi[k]; }
    a[ant->i_r + axis] = PEL_R(1.0);
}

/* What the two attitudes make of arm, force and their integrals. */
typedef struct {
    double mean[3][3]; /* of C_b_e */
    double late
        [3]
        [3]; /* C_b_e two thirds into the interval: centroid of what an error of acceleration does to the way, seen from its end */
    double f_e[3], lever_e[3], lever_change_e[3];
} interval_t;

static void interval(const pel_delay_t *d, interval_t *x)
{
    double now[3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            x->mean[i][j] = 0.5 * (d->C_before[i][j] + d->C_now[i][j]);
            x->late[i][j] = (d->C_before[i][j] + 2.0 * d->C_now[i][j]) / 3.0;
        }
    }
    pel_mat3_vec(x->late, d->f_ib_b, x->f_e);
    pel_mat3_vec(d->C_before, d->lever_b, x->lever_e);
    pel_mat3_vec(d->C_now, d->lever_b, now);
    for (int k = 0; k < 3; k++) { x->lever_change_e[k] = now[k] - x->lever_e[k]; }
}

void pel_observe_delayed(const pel_model_t *m, const pel_delay_t *d, const pel_sd_t *sat, const pel_sd_t *pivot,
                         double change_m, pel_row_t *row)
{
    const double T = d->dt_s;
    const double half = 0.5 * T * T;
    interval_t x;
    double g[3];
    double gf[3]; /* g'[f x] = g x f, and so on */
    double gL[3];
    double gdL[3];
    double gyro_f[3];
    double gyro_L[3];
    double h[3];
    interval(d, &x);
    pel_row_direction(sat, pivot, g);
    pel_cross3(g, x.f_e, gf);
    pel_cross3(g, x.lever_e, gL);
    pel_cross3(g, x.lever_change_e, gdL);

    pel_row_begin(row, m->n, 0, -change_m);
    /* v: g' (T I + T^2 W), W = [omega_ie x] */
    const double on_v[3] = {T * g[0] + T * T * PEL_OMEGA_IE * g[1], T * g[1] - T * T * PEL_OMEGA_IE * g[0], T * g[2]};
    pel_row_put(row, pel_model_index(m, PEL_BLOCK_VELOCITY), on_v);
    /* psi: T^2/2 g'[f x] - g'[dL x] + T g'[L x] W */
    for (int k = 0; k < 3; k++) { h[k] = half * gf[k] - gdL[k]; }
    h[0] += T * PEL_OMEGA_IE * gL[1];
    h[1] -= T * PEL_OMEGA_IE * gL[0];
    pel_row_put(row, pel_model_index(m, PEL_BLOCK_ATTITUDE), h);
    /* gyro: -(T^3/6 g'[f x] + T g'[L x]) C; accelerometer: -T^2/2 g' C */
    pel_mat3_tvec(x.late, gf, gyro_f);
    pel_mat3_tvec(x.mean, gL, gyro_L);
    for (int k = 0; k < 3; k++) { h[k] = -T * half / 3.0 * gyro_f[k] - T * gyro_L[k]; }
    pel_row_put(row, pel_model_index(m, PEL_BLOCK_GYRO_CONSTANT), h);
    pel_mat3_tvec(x.late, g, h);
    for (int k = 0; k < 3; k++) { h[k] *= -half; }
    pel_row_put(row, pel_model_index(m, PEL_BLOCK_ACCEL_CONSTANT), h);
}

/* transition.c - the transition matrix of the ECEF error model, block by block (S5 section 4, to second order in dt).
 *
 * All in pel_real: these are coefficients of small errors, and a processor without double pays for every digit. */
#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "pelorus/model.h"

#define OMEGA ((pel_real)PEL_OMEGA_IE)

typedef pel_real mat3[3][3];

pel_real (*pel_transition_add(pel_transition_t *t, int row, int col))[3]
{
    const int k = t->n_blocks++;
    t->block[k].row = (uint8_t)row;
    t->block[k].col = (uint8_t)col;
    return t->block[k].m;
}

/* out = a A + b W B, W = [omega_ie x]: rows of W B are -omega B_y, omega B_x, 0 */
static void combine(pel_real a, const mat3 A, pel_real b, const mat3 B, mat3 out)
{
    const pel_real w = b * OMEGA;
    for (int j = 0; j < 3; j++) {
        out[0][j] = a * A[0][j] - w * B[1][j];
        out[1][j] = a * A[1][j] + w * B[0][j];
        out[2][j] = a * A[2][j];
    }
}

/* out = a [f x] B */
static void cross_times(pel_real a, const pel_real f[3], const mat3 B, mat3 out)
{
    for (int j = 0; j < 3; j++) {
        out[0][j] = a * (f[1] * B[2][j] - f[2] * B[1][j]);
        out[1][j] = a * (f[2] * B[0][j] - f[0] * B[2][j]);
        out[2][j] = a * (f[0] * B[1][j] - f[1] * B[0][j]);
    }
}

/* out = a I + b W + c W W */
static void turn(pel_real a, pel_real b, pel_real c, mat3 out)
{
    const pel_real square = a - c * OMEGA * OMEGA;
    const mat3 T = {{square, -b * OMEGA, PEL_R(0.0)}, {b * OMEGA, square, PEL_R(0.0)}, {PEL_R(0.0), PEL_R(0.0), a}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { out[i][j] = T[i][j]; }
    }
}

/* Gravity gradient as pel_earth_gravity_gradient_e(), in pel_real. */
static void gradient(const double r_e[3], mat3 G)
{
    const pel_real r[3] = {(pel_real)r_e[0], (pel_real)r_e[1], (pel_real)r_e[2]};
    const pel_real inv2 = PEL_R(1.0) / (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    const pel_real k = (pel_real)PEL_MU * inv2 * pel_sqrtr(inv2);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { G[i][j] = PEL_R(3.0) * k * inv2 * r[i] * r[j]; }
        G[i][i] -= k;
    }
    G[0][0] += OMEGA * OMEGA;
    G[1][1] += OMEGA * OMEGA;
}

/* psi' = -W psi + C (bg + gm) */
static void attitude_rows(const pel_model_t *m, const mat3 C, pel_real dt, pel_transition_t *t)
{
    const int psi = pel_model_index(m, PEL_BLOCK_ATTITUDE);
    const int gyro[2] = {pel_model_index(m, PEL_BLOCK_GYRO_CONSTANT), pel_model_index(m, PEL_BLOCK_GYRO_MARKOV)};
    for (int k = 0; k < 2; k++) {
        if (gyro[k] >= 0) { combine(dt, C, PEL_R(-0.5) * dt * dt, C, pel_transition_add(t, psi, gyro[k])); }
    }
    turn(PEL_R(0.0), -dt, PEL_R(0.5) * dt * dt, pel_transition_add(t, psi, psi));
}

/* v' = -2 W v - [f x] psi + C am + G r; second order: -[f x] C gyro, ([f x] W + 2 W [f x]) psi, (4 W W + G) v, -2 W C am, -2 W G r */
static void velocity_rows(const pel_model_t *m, const pel_real *f, const mat3 C, const mat3 G, pel_real dt,
                          pel_transition_t *t)
{
    const int psi = pel_model_index(m, PEL_BLOCK_ATTITUDE);
    const int v = pel_model_index(m, PEL_BLOCK_VELOCITY);
    const int r = pel_model_index(m, PEL_BLOCK_POSITION);
    const int gyro[2] = {pel_model_index(m, PEL_BLOCK_GYRO_CONSTANT), pel_model_index(m, PEL_BLOCK_GYRO_MARKOV)};
    const int accel[2] = {pel_model_index(m, PEL_BLOCK_ACCEL_CONSTANT), pel_model_index(m, PEL_BLOCK_ACCEL_MARKOV)};
    const pel_real half = PEL_R(0.5) * dt * dt;

    if (psi >= 0) {
        for (int k = 0; k < 2; k++) {
            if (gyro[k] >= 0) { cross_times(-half, f, C, pel_transition_add(t, v, gyro[k])); }
        }
        for (int k = 0; k < 2; k++) {
            if (accel[k] >= 0) { combine(dt, C, -dt * dt, C, pel_transition_add(t, v, accel[k])); }
        }
        const mat3 S = {{PEL_R(0.0), -f[2], f[1]}, {f[2], PEL_R(0.0), -f[0]}, {-f[1], f[0], PEL_R(0.0)}};
        pel_real(*b)[3] = pel_transition_add(t, v, psi);
        combine(-dt, S, PEL_R(2.0) * half, S, b);
        for (int i = 0; i < 3; i++) { /* + half S W: columns of S W are omega S_y, -omega S_x, 0 */
            b[i][0] += half * OMEGA * S[i][1];
            b[i][1] -= half * OMEGA * S[i][0];
        }
    }
    pel_real(*vv)[3] = pel_transition_add(t, v, v);
    turn(PEL_R(0.0), PEL_R(-2.0) * dt, PEL_R(4.0) * half, vv);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { vv[i][j] += half * G[i][j]; }
    }
    if (r >= 0) { combine(dt, G, PEL_R(-2.0) * half, G, pel_transition_add(t, v, r)); }
}

/* r' = v; second order: -2 W v, -[f x] psi, C am, G r */
static void position_rows(const pel_model_t *m, const pel_real *f, const mat3 C, const mat3 G, pel_real dt,
                          pel_transition_t *t)
{
    const int psi = pel_model_index(m, PEL_BLOCK_ATTITUDE);
    const int v = pel_model_index(m, PEL_BLOCK_VELOCITY);
    const int r = pel_model_index(m, PEL_BLOCK_POSITION);
    const int accel[2] = {pel_model_index(m, PEL_BLOCK_ACCEL_CONSTANT), pel_model_index(m, PEL_BLOCK_ACCEL_MARKOV)};
    const pel_real half = PEL_R(0.5) * dt * dt;
    const mat3 zero = {{PEL_R(0.0)}};

    if (psi >= 0) {
        for (int k = 0; k < 2; k++) {
            if (accel[k] >= 0) { combine(half, C, PEL_R(0.0), zero, pel_transition_add(t, r, accel[k])); }
        }
        const mat3 identity = {{PEL_R(1.0), 0, 0}, {0, PEL_R(1.0), 0}, {0, 0, PEL_R(1.0)}};
        cross_times(-half, f, identity, pel_transition_add(t, r, psi));
    }
    turn(dt, PEL_R(-2.0) * half, PEL_R(0.0), pel_transition_add(t, r, v));
    combine(half, G, PEL_R(0.0), zero, pel_transition_add(t, r, r));
}

void pel_model_transition(const pel_model_t *m, const double f_e[3], const double C_b_e[3][3], const double r_e[3],
                          double dt_s, pel_transition_t *t)
{
    const int psi = pel_model_index(m, PEL_BLOCK_ATTITUDE);
    const int v = pel_model_index(m, PEL_BLOCK_VELOCITY);
    const bool has_r = pel_model_index(m, PEL_BLOCK_POSITION) >= 0;
    const pel_real dt = (pel_real)dt_s;
    pel_real f[3] = {PEL_R(0.0), PEL_R(0.0), PEL_R(0.0)};
    mat3 C = {{PEL_R(0.0)}};
    mat3 G = {{PEL_R(0.0)}};

    t->n = m->n;
    t->n_blocks = 0;
    for (int i = 0; i < m->n; i++) { t->q[i] = PEL_R(0.0); }
    for (int i = 0; i < 3 && psi >= 0; i++) {
        f[i] = (pel_real)f_e[i];
        for (int j = 0; j < 3; j++) { C[i][j] = (pel_real)C_b_e[i][j]; }
    }
    if (has_r) { gradient(r_e, G); }
    if (psi >= 0) { attitude_rows(m, C, dt, t); }
    velocity_rows(m, f, C, G, dt, t);
    if (has_r) { position_rows(m, f, C, G, dt, t); }

    const double white_v = (psi >= 0) ? m->imu.vrw_mps_rts : m->imu.accel_psd_rts;
    for (int i = 0; i < 3; i++) {
        t->q[v + i] = (pel_real)(white_v * white_v * dt_s);
        if (psi >= 0) { t->q[psi + i] = (pel_real)(m->imu.arw_rad_rts * m->imu.arw_rad_rts * dt_s); }
    }
}

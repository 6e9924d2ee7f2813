/* transition_enu.c - the transition matrix of the local-level error model (S2 section 6), Phi = I + F dt + F^2 dt^2 / 2.
 *
 * F of (psi, v, r) is a 3x3 grid of 3x3 blocks; the sensors come in through C. Products of blocks make F^2. */
#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "pelorus/model.h"

enum { PSI = 0, V = 1, R = 2 };

typedef pel_real mat3[3][3];

typedef struct {
    mat3 F[3][3];
    mat3 C;
} dynamics_t;

/* What latitude, height and velocity make of the rates of the local axes. */
typedef struct {
    pel_real s, c, t;          /* sine, cosine, tangent of latitude */
    pel_real M, N;             /* radii of curvature plus height, m */
    pel_real v[3];             /* m/s */
    pel_real w_ie[3], w_in[3]; /* rad/s */
    pel_real g_h;              /* -dg/dh, 1/s^2 */
} local_t;

static void local_at(const double v_enu[3], double lat, double h, local_t *l)
{
    double sin_lat;
    double cos_lat;
    double R_M;
    double R_N;
    pel_sincos(lat, &sin_lat, &cos_lat);
    l->s = (pel_real)sin_lat;
    l->c = (pel_real)cos_lat;
    l->t = l->s / l->c;
    pel_earth_radii_at(sin_lat, &R_M, &R_N);
    l->N = (pel_real)(R_N + h);
    l->M = (pel_real)(R_M + h);
    for (int i = 0; i < 3; i++) { l->v[i] = (pel_real)v_enu[i]; }
    l->w_ie[0] = PEL_R(0.0);
    l->w_ie[1] = (pel_real)PEL_OMEGA_IE * l->c;
    l->w_ie[2] = (pel_real)PEL_OMEGA_IE * l->s;
    l->w_in[0] = -l->v[1] / l->M;
    l->w_in[1] = l->w_ie[1] + l->v[0] / l->N;
    l->w_in[2] = l->w_ie[2] + l->v[0] * l->t / l->N;
    /* 2 mu / r^3 + w^2 cos^2: how gravity falls with height, without J2 (0.7 % of it) */
    const pel_real k = PEL_R(1.0) / l->N;
    l->g_h = PEL_R(2.0) * (pel_real)PEL_MU * k * k * k + (pel_real)(PEL_OMEGA_IE * PEL_OMEGA_IE) * l->c * l->c;
}

/* out = a [x x] */
static void skew(pel_real a, const pel_real x[3], mat3 out)
{
    const mat3 S = {
        {PEL_R(0.0), -a * x[2], a * x[1]}, {a * x[2], PEL_R(0.0), -a * x[0]}, {-a * x[1], a * x[0], PEL_R(0.0)}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { out[i][j] = S[i][j]; }
    }
}

/* out += a A B */
static void add_product(pel_real a, const mat3 A, const mat3 B, mat3 out)
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { out[i][j] += a * (A[i][0] * B[0][j] + A[i][1] * B[1][j] + A[i][2] * B[2][j]); }
    }
}

/* psi' = -w_in x psi - dw_in */
static void attitude_rows(const local_t *l, const mat3 by_v, const mat3 by_r, dynamics_t *d)
{
    skew(PEL_R(-1.0), l->w_in, d->F[PSI][PSI]);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            d->F[PSI][V][i][j] = -by_v[i][j];
            d->F[PSI][R][i][j] = -by_r[i][j];
        }
    }
}

/* v' = -[f x] psi - (w_in + w_ie) x dv + v x (dw_in + dw_ie) + (0, 0, g_h dh) */
static void velocity_rows(const local_t *l, const pel_real f[3], const mat3 by_v, const mat3 by_r, dynamics_t *d)
{
    mat3 v_cross;
    mat3 turning = {{PEL_R(0.0)}}; /* d(w_in + w_ie) / dr */
    const pel_real w_c[3] = {l->w_in[0], l->w_in[1] + l->w_ie[1], l->w_in[2] + l->w_ie[2]};
    skew(PEL_R(1.0), l->v, v_cross);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { turning[i][j] = by_r[i][j]; }
    }
    turning[1][1] -= l->w_ie[2] / l->M;
    turning[2][1] += l->w_ie[1] / l->M;

    skew(PEL_R(-1.0), f, d->F[V][PSI]);
    skew(PEL_R(-1.0), w_c, d->F[V][V]);
    add_product(PEL_R(1.0), v_cross, by_v, d->F[V][V]);
    add_product(PEL_R(1.0), v_cross, turning, d->F[V][R]);
    d->F[V][R][2][2] += l->g_h;
}

/* r = (N cos dlon, M dlat, dh): the scales change while it moves */
static void position_rows(const local_t *l, dynamics_t *d)
{
    mat3 *r = &d->F[R][R];
    for (int i = 0; i < 3; i++) { d->F[R][V][i][i] = PEL_R(1.0); }
    (*r)[0][0] = (l->v[2] - l->v[1] * l->t) / l->N;
    (*r)[0][1] = l->v[0] * l->t / l->N;
    (*r)[0][2] = -l->v[0] / l->N;
    (*r)[1][1] = l->v[2] / l->M;
    (*r)[1][2] = -l->v[1] / l->M;
}

static void dynamics(const local_t *l, const double f_enu[3], const double C_b_enu[3][3], dynamics_t *d)
{
    const dynamics_t none = {0};
    const pel_real f[3] = {(pel_real)f_enu[0], (pel_real)f_enu[1], (pel_real)f_enu[2]};
    const pel_real m = PEL_R(1.0) / l->M;
    const pel_real n = PEL_R(1.0) / l->N;
    const pel_real turn = l->v[0] * n; /* the local axes' turn about north by the eastward velocity */
    /* d(w_in)/dv and d(w_in)/dr */
    const mat3 by_v = {{PEL_R(0.0), -m, PEL_R(0.0)}, {n, PEL_R(0.0), PEL_R(0.0)}, {l->t * n, PEL_R(0.0), PEL_R(0.0)}};
    const mat3 by_r = {{PEL_R(0.0), PEL_R(0.0), l->v[1] * m * m},
                       {PEL_R(0.0), -l->w_ie[2] * m, -turn * n},
                       {PEL_R(0.0), (l->w_ie[1] + turn / (l->c * l->c)) * m, -turn * l->t * n}};
    *d = none;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { d->C[i][j] = (pel_real)C_b_enu[i][j]; }
    }
    attitude_rows(l, by_v, by_r, d);
    velocity_rows(l, f, by_v, by_r, d);
    position_rows(l, d);
}

/* Blocks of row x (PSI, V, R) for two sensor blocks that enter the row `entry` of F through C. */
static void sensor_blocks(const pel_model_t *m, const dynamics_t *d, int x, int row, int entry, pel_block_t kind,
                          pel_real dt, pel_transition_t *t)
{
    for (int k = 0; k < 2; k++) {
        const int sensor = pel_model_index(m, (pel_block_t)((int)kind + k)); /* constant, then Markov */
        if (sensor < 0) { continue; }
        pel_real(*b)[3] = pel_transition_add(t, row, sensor);
        const pel_real first = (x == entry) ? dt : PEL_R(0.0);
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) { b[i][j] = first * d->C[i][j]; }
        }
        add_product(PEL_R(0.5) * dt * dt, d->F[x][entry], d->C, b);
    }
}

void pel_model_transition_enu(const pel_model_t *m, const double f_enu[3], const double C_b_enu[3][3],
                              const double v_enu[3], double lat, double h, double dt_s, pel_transition_t *t)
{
    const int row[3] = {pel_model_index(m, PEL_BLOCK_ATTITUDE), pel_model_index(m, PEL_BLOCK_VELOCITY),
                        pel_model_index(m, PEL_BLOCK_POSITION)};
    const pel_real dt = (pel_real)dt_s;
    local_t local;
    dynamics_t d;
    local_at(v_enu, lat, h, &local);
    dynamics(&local, f_enu, C_b_enu, &d);

    t->n = m->n;
    t->n_blocks = 0;
    for (int i = 0; i < m->n; i++) { t->q[i] = PEL_R(0.0); }
    for (int x = PSI; x <= R; x++) {
        /* second order would carry the accelerometers to attitude (1e-10) and the gyros to position (third order): left out */
        if (x != R) { sensor_blocks(m, &d, x, row[x], PSI, PEL_BLOCK_GYRO_CONSTANT, dt, t); }
        if (x != PSI) { sensor_blocks(m, &d, x, row[x], V, PEL_BLOCK_ACCEL_CONSTANT, dt, t); }
        for (int y = PSI; y <= R; y++) {
            pel_real(*b)[3] = pel_transition_add(t, row[x], row[y]);
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++) { b[i][j] = dt * d.F[x][y][i][j]; }
            }
            for (int k = PSI; k <= R; k++) { add_product(PEL_R(0.5) * dt * dt, d.F[x][k], d.F[k][y], b); }
        }
    }
    for (int i = 0; i < 3; i++) {
        t->q[row[PSI] + i] = (pel_real)(m->imu.arw_rad_rts * m->imu.arw_rad_rts * dt_s);
        t->q[row[V] + i] = (pel_real)(m->imu.vrw_mps_rts * m->imu.vrw_mps_rts * dt_s);
    }
}

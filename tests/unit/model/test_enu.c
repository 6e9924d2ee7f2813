/* build: f32 f64 */
/* The local-level error model against S2's equations: its F, in the paper's units and signs, against the corrected table of S2 section 6
 * and that table against central differences of the nonlinear mechanization (S2 section 5), which is written here in long double. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "pelorus/model.h"
#include "unity.h"

typedef long double ld;

#define W_IE 7.292115e-5L
#define E2   ((ld)PEL_WGS84_E2)

void setUp(void) {}
void tearDown(void) {}

/* The paper's 18 inertial states: phi (platform angle, C~ = (I - [phi x]) C), v, (L, lambda, h), gyro constant, gyro Markov, accelerometer. */
enum { PHI = 0, VEL = 3, POS = 6, GYRO = 9, MARKOV = 12, ACCEL = 15, N = 18 };

/* Where the derivatives are taken: a climbing, turning aeroplane. */
static const ld LAT = 0.5585L, HEIGHT = 1500.0L;
static const ld VELOCITY[3] = {110.0L, -70.0L, 8.0L};
static const ld FORCE[3] = {1.7L, -2.1L, 10.9L};  /* f_ib_b */
static const ld RATE[3] = {0.11L, -0.23L, 0.31L}; /* omega_ib_b */
static ld ATTITUDE[3][3];

typedef struct {
    ld C[3][3], v[3], p[3]; /* p: lat, lon, h */
} state_t;

static ld meridian(ld lat)
{
    const ld s = sinl(lat);
    return 6378137.0L * (1.0L - E2) / powl(1.0L - E2 * s * s, 1.5L);
}

static ld normal(ld lat)
{
    const ld s = sinl(lat);
    return 6378137.0L / sqrtl(1.0L - E2 * s * s);
}

/* Magnitude of normal gravity: Somigliana and free air. Its derivative by latitude is what the model leaves out. */
static ld gravity(ld lat, ld h)
{
    const ld s2 = sinl(lat) * sinl(lat);
    const ld g0 = 9.7803253359L * (1.0L + 0.001931853L * s2) / sqrtl(1.0L - E2 * s2);
    const ld f = 1.0L / 298.257223563L;
    return g0 * (1.0L - 2.0L / 6378137.0L * (1.0L + f + 0.00344978650684L - 2.0L * f * s2) * h +
                 3.0L * h * h / (6378137.0L * 6378137.0L));
}

static void cross_ld(const ld a[3], const ld b[3], ld c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* S2 section 5. lat_left_out: the latitude of gravity and radii, held where
 * their derivatives are to be left out. */
static void derivative(const state_t *s, const ld dw[3], const ld df[3], ld lat_left_out, state_t *d)
{
    const ld lat = s->p[0];
    const ld M = meridian(lat_left_out) + s->p[2], R = normal(lat_left_out) + s->p[2];
    const ld w_ie[3] = {0.0L, W_IE * cosl(lat), W_IE * sinl(lat)};
    const ld w_in[3] = {-s->v[1] / M, w_ie[1] + s->v[0] / R, w_ie[2] + s->v[0] * tanl(lat) / R};
    const ld w_c[3] = {w_in[0], w_in[1] + w_ie[1], w_in[2] + w_ie[2]};
    ld coriolis[3], w[3], f[3];
    cross_ld(w_c, s->v, coriolis);
    for (int i = 0; i < 3; i++) {
        w[i] = RATE[i] + dw[i];
        f[i] = FORCE[i] + df[i];
    }
    for (int i = 0; i < 3; i++) {
        d->v[i] = s->C[i][0] * f[0] + s->C[i][1] * f[1] + s->C[i][2] * f[2] - coriolis[i];
        d->C[i][0] = s->C[i][1] * w[2] - s->C[i][2] * w[1];
        d->C[i][1] = s->C[i][2] * w[0] - s->C[i][0] * w[2];
        d->C[i][2] = s->C[i][0] * w[1] - s->C[i][1] * w[0];
    }
    d->v[2] -= gravity(lat_left_out, s->p[2]);
    for (int j = 0; j < 3; j++) {
        const ld column[3] = {s->C[0][j], s->C[1][j], s->C[2][j]};
        ld turned[3];
        cross_ld(w_in, column, turned);
        for (int i = 0; i < 3; i++) { d->C[i][j] -= turned[i]; }
    }
    d->p[0] = s->v[1] / M;
    d->p[1] = s->v[0] / (R * cosl(lat));
    d->p[2] = s->v[2];
}

static void nominal(state_t *s)
{
    double C[3][3];
    pel_attitude_to_C_b_enu(0.2, -0.1, 2.3, C);
    for (int i = 0; i < 3; i++) {
        s->v[i] = VELOCITY[i];
        for (int j = 0; j < 3; j++) { s->C[i][j] = ATTITUDE[i][j] = C[i][j]; }
    }
    s->p[0] = LAT;
    s->p[1] = 2.06L;
    s->p[2] = HEIGHT;
}

/* Apply error state x of the paper: C~ = exp(-[phi x]) C to second order. */
static void perturb(state_t *s, const ld x[N], ld dw[3], ld df[3])
{
    const ld psi[3] = {-x[PHI], -x[PHI + 1], -x[PHI + 2]};
    for (int j = 0; j < 3; j++) {
        const ld c[3] = {s->C[0][j], s->C[1][j], s->C[2][j]};
        ld once[3], twice[3];
        cross_ld(psi, c, once);
        cross_ld(psi, once, twice);
        for (int i = 0; i < 3; i++) { s->C[i][j] += once[i] + 0.5L * twice[i]; }
    }
    for (int i = 0; i < 3; i++) {
        s->v[i] += x[VEL + i];
        s->p[i] += x[POS + i];
        dw[i] = x[GYRO + i] + x[MARKOV + i];
        df[i] = x[ACCEL + i];
    }
}

/* Rate of change of the error between two states that move: phi' from C~' C' + C~ C'', antisymmetric part, for small phi. */
static void error_rate(const state_t *a, const state_t *da, const state_t *b, const state_t *db, ld out[9])
{
    ld Q[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            Q[i][j] = 0.0L;
            for (int k = 0; k < 3; k++) { Q[i][j] += da->C[i][k] * b->C[j][k] + a->C[i][k] * db->C[j][k]; }
        }
        out[VEL + i] = da->v[i] - db->v[i];
        out[POS + i] = da->p[i] - db->p[i];
    }
    out[PHI + 0] = -0.5L * (Q[2][1] - Q[1][2]);
    out[PHI + 1] = -0.5L * (Q[0][2] - Q[2][0]);
    out[PHI + 2] = -0.5L * (Q[1][0] - Q[0][1]);
}

/* F of the first nine rows by central differences. */
static void by_differences(ld F[9][N], bool leave_out)
{
    for (int j = 0; j < N; j++) {
        const ld e = (j < VEL) ? 1e-5L : (j < POS) ? 1e-2L : (j < POS + 2) ? 1e-6L : (j < GYRO) ? 1.0L : 1e-4L;
        ld rate[2][9];
        for (int side = 0; side < 2; side++) {
            state_t s, t, ds, dt;
            ld x[N] = {0}, dw[3], df[3];
            const ld none[3] = {0};
            nominal(&s);
            nominal(&t);
            x[j] = (side == 0) ? e : -e;
            perturb(&s, x, dw, df);
            derivative(&s, dw, df, leave_out ? LAT : s.p[0], &ds);
            derivative(&t, none, none, LAT, &dt);
            error_rate(&s, &ds, &t, &dt, rate[side]);
        }
        for (int i = 0; i < 9; i++) { F[i][j] = (rate[0][i] - rate[1][i]) / (2.0L * e); }
    }
}

/* The corrected table of S2 section 6, sensor columns included. */
static void by_table(ld F[9][N])
{
    const ld s = sinl(LAT), c = cosl(LAT), t = tanl(LAT), w = W_IE;
    const ld M = meridian(LAT) + HEIGHT, R = normal(LAT) + HEIGHT;
    const ld vE = VELOCITY[0], vN = VELOCITY[1], vU = VELOCITY[2];
    ld f[3];
    for (int i = 0; i < 3; i++) {
        f[i] = ATTITUDE[i][0] * FORCE[0] + ATTITUDE[i][1] * FORCE[1] + ATTITUDE[i][2] * FORCE[2];
    }
    memset(F, 0, 9 * sizeof F[0]);
#define F_(i, j) F[(i)-1][(j)-1]
    F_(1, 2) = w * s + vE * t / R;
    F_(1, 3) = -(w * c + vE / R);
    F_(1, 5) = -1 / M;
    F_(1, 9) = vN / (M * M);
    F_(2, 1) = -F_(1, 2);
    F_(2, 3) = -vN / M;
    F_(2, 4) = 1 / R;
    F_(2, 7) = -w * s;
    F_(2, 9) = -vE / (R * R);
    F_(3, 1) = w * c + vE / R;
    F_(3, 2) = vN / M;
    F_(3, 4) = t / R;
    F_(3, 7) = w * c + vE / (R * c * c);
    F_(3, 9) = -vE * t / (R * R);
    F_(4, 2) = -f[2];
    F_(4, 3) = f[1];
    F_(4, 4) = (vN * t - vU) / R;
    F_(4, 5) = 2 * w * s + vE * t / R;
    F_(4, 6) = -(2 * w * c + vE / R);
    F_(4, 7) = 2 * w * c * vN + vE * vN / (R * c * c) + 2 * w * s * vU;
    F_(4, 9) = vE * (vU - vN * t) / (R * R);
    F_(5, 1) = f[2];
    F_(5, 3) = -f[0];
    F_(5, 4) = -2 * (w * s + vE * t / R);
    F_(5, 5) = -vU / M;
    F_(5, 6) = -vN / M;
    F_(5, 7) = -(2 * w * c + vE / (R * c * c)) * vE;
    F_(5, 9) = vE * vE * t / (R * R) + vN * vU / (M * M);
    F_(6, 1) = -f[1];
    F_(6, 2) = f[0];
    F_(6, 4) = 2 * (w * c + vE / R);
    F_(6, 5) = 2 * vN / M;
    F_(6, 7) = -2 * w * s * vE;
    F_(6, 9) = 2 * gravity(LAT, HEIGHT) / 6378137.0L - vE * vE / (R * R) - vN * vN / (M * M);
    F_(7, 5) = 1 / M;
    F_(7, 9) = -vN / (M * M);
    F_(8, 4) = 1 / (R * c);
    F_(8, 7) = vE * t / (R * c);
    F_(8, 9) = -vE / (R * R * c);
    F_(9, 6) = 1;
#undef F_
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            F[PHI + i][GYRO + j] = F[PHI + i][MARKOV + j] = -ATTITUDE[i][j];
            F[VEL + i][ACCEL + j] = ATTITUDE[i][j];
        }
    }
}

/* Largest difference between two F, each entry relative to itself or, for entries that should be zero, to the largest of its row in
 * the column's unit (phi 1, v 1e3, L 1e0, h 1e6). F69 by itself. */
static double compare(ld A[9][N], ld B[9][N], double *vertical)
{
    static const ld unit[N] = {1, 1, 1, 1e3L, 1e3L, 1e3L, 1, 1, 1e6L, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    double worst = 0.0;
    for (int i = 0; i < 9; i++) {
        ld scale = 0.0L;
        for (int j = 0; j < GYRO; j++) { scale = fmaxl(scale, fabsl(B[i][j]) * unit[j]); }
        for (int j = 0; j < N; j++) {
            const ld own = (fabsl(B[i][j]) > 0.0L) ? fabsl(B[i][j]) : ((j < GYRO) ? scale / unit[j] : 1.0L);
            const double off = (double)(fabsl(A[i][j] - B[i][j]) / own);
            if (i == 5 && j == 8) {
                *vertical = off;
            } else if (off > worst) {
                worst = off;
            }
        }
    }
    return worst;
}

/* The model's own F, taken out of Phi(dt) = I + F dt + F^2 dt^2 / 2 with two dt, in the paper's signs and units. */
static void by_model(ld F[9][N])
{
    const int house[6] = {9, 12, 15, 0, 3, 6}; /* psi, v, r, gyro constant, gyro Markov, accelerometer */
    const int paper[6] = {PHI, VEL, POS, GYRO, MARKOV, ACCEL};
    const double dt = 0.2;
    double f_enu[3], C[3][3], v[3];
    static pel_transition_t one, half;
    static ld H[18][18];
    pel_imu_model_t imu;
    pel_model_t m;
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    pel_model_ins_enu(&m, &imu);
    TEST_ASSERT_EQUAL_INT(18, m.n);
    for (int i = 0; i < 3; i++) {
        v[i] = (double)VELOCITY[i];
        f_enu[i] = 0.0;
        for (int j = 0; j < 3; j++) {
            C[i][j] = (double)ATTITUDE[i][j];
            f_enu[i] += C[i][j] * (double)FORCE[j];
        }
    }
    pel_model_transition_enu(&m, f_enu, C, v, (double)LAT, (double)HEIGHT, dt, &one);
    pel_model_transition_enu(&m, f_enu, C, v, (double)LAT, (double)HEIGHT, 0.5 * dt, &half);
    TEST_ASSERT_EQUAL_INT(15, one.n_blocks);
    memset(H, 0, sizeof H);
    for (int k = 0; k < one.n_blocks; k++) {
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) {
                H[one.block[k].row + i][one.block[k].col + j] =
                    (4.0L * (ld)half.block[k].m[i][j] - (ld)one.block[k].m[i][j]) / (ld)dt;
            }
        }
    }
    /* x_paper = T x_house: phi = -psi; dL = rN / M, dlambda = rE / (N cos); and T' T^-1 for their growing scales */
    const ld M = meridian(LAT) + HEIGHT, R = normal(LAT) + HEIGHT;
    const ld vN = VELOCITY[1], vU = VELOCITY[2];
    ld T[N];
    int from[N];
    for (int b = 0; b < 6; b++) {
        for (int i = 0; i < 3; i++) {
            from[paper[b] + i] = house[b] + i;
            T[paper[b] + i] = (b == 0) ? -1.0L : 1.0L;
        }
    }
    from[POS] = 15 + 1;
    T[POS] = 1 / M;
    from[POS + 1] = 15 + 0;
    T[POS + 1] = 1 / (R * cosl(LAT));
    for (int i = 0; i < 9; i++) {
        for (int j = 0; j < N; j++) { F[i][j] = T[i] * H[from[i]][from[j]] / T[j]; }
    }
    F[POS][POS] -= vU / M;
    F[POS + 1][POS + 1] -= (vU - vN * tanl(LAT)) / R;
    F[POS + 1][POS] *= R / M; /* in metres the model has the change of R_N with latitude, the table has not */
}

static void the_table_is_the_derivative_of_the_mechanization(void)
{
    ld table[9][N], truth[9][N];
    double vertical;
    by_differences(truth, true);
    by_table(table);
    const double worst = compare(truth, table, &vertical);
    printf("S2's corrected F against central differences: worst entry %.1e, F69 %.1e relative\n", worst, vertical);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-6, worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.01, vertical); /* the paper's 2 g / a */
}

static void the_model_is_the_table_in_other_units(void)
{
    ld table[9][N], model[9][N];
    double vertical;
    state_t s;
    nominal(&s);
    by_model(model);
    by_table(table);
    const double worst = compare(model, table, &vertical);
    printf("the model's F against the table: worst entry %.1e, F69 %.1e relative\n", worst, vertical);
    TEST_ASSERT_LESS_THAN_DOUBLE(PEL_REAL_DOUBLE ? 1e-12 : 1e-6, worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.01, vertical);
}

static void what_is_left_out_is_the_latitude_of_radii_and_gravity(void)
{
    ld all[9][N], table[9][N];
    ld worst = 0.0L;
    by_differences(all, false);
    by_table(table);
    for (int i = 0; i < 9; i++) {
        for (int j = 0; j < N; j++) {
            const ld off = fabsl(all[i][j] - table[i][j]);
            if (j != POS) {
                TEST_ASSERT_TRUE(i == 5 && j == 8 ? off < 3e-8L : off <= 1e-6L * fabsl(table[i][j]) + 1e-14L);
            } else if (off > worst) {
                worst = off;
            }
        }
    }
    printf("left out by latitude: at most %.1e per rad\n", (double)worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(6e-2, (double)worst); /* gravity: 52 mm/s^2 from equator to pole */
}

/* What the print says instead (S2 section 6, marked entries), each held against differences: all far off. */
static void the_printed_entries_are_wrong(void)
{
    ld F[9][N];
    by_differences(F, true);
    const ld M = meridian(LAT) + HEIGHT, R = normal(LAT) + HEIGHT, t = tanl(LAT);
    const struct {
        int row, col;
        ld printed;
    } print[] = {
        {2, 3, -1 / M}, {3, 2, 1 / M}, {2, 4, -1 / R}, {4, 4, (VELOCITY[1] * t - VELOCITY[2]) / M}, {6, 9, 0.0L}};
    for (int k = 0; k < 5; k++) {
        const ld right = F[print[k].row - 1][print[k].col - 1];
        TEST_ASSERT_GREATER_THAN_DOUBLE(5e-4, (double)fabsl(print[k].printed / right - 1.0L));
    }
    /* and the sign of the gyro columns: measured - true tilts the platform backwards */
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-9, (double)fabsl(F[0][GYRO] + ATTITUDE[0][0]));
}

/* Second order: Phi over 0.05 s against the nonlinear equations carried on from perturbed states. */
static void advance(const state_t *s, const state_t *d, ld h, state_t *out)
{
    for (int i = 0; i < 3; i++) {
        out->v[i] = s->v[i] + h * d->v[i];
        out->p[i] = s->p[i] + h * d->p[i];
        for (int j = 0; j < 3; j++) { out->C[i][j] = s->C[i][j] + h * d->C[i][j]; }
    }
}

static void integrate(state_t *s, const ld dw[3], const ld df[3], ld T, ld f_sum[3])
{
    const ld h = T / 20.0L;
    for (int n = 0; n < 20; n++) {
        state_t k1, k2, k3, k4, m;
        derivative(s, dw, df, LAT, &k1);
        advance(s, &k1, 0.5L * h, &m);
        derivative(&m, dw, df, LAT, &k2);
        for (int i = 0; i < 3; i++) {
            f_sum[i] += (m.C[i][0] * FORCE[0] + m.C[i][1] * FORCE[1] + m.C[i][2] * FORCE[2]) / 20.0L;
        }
        advance(s, &k2, 0.5L * h, &m);
        derivative(&m, dw, df, LAT, &k3);
        advance(s, &k3, h, &m);
        derivative(&m, dw, df, LAT, &k4);
        advance(s, &k1, h / 6.0L, s);
        advance(s, &k2, h / 3.0L, s);
        advance(s, &k3, h / 3.0L, s);
        advance(s, &k4, h / 6.0L, s);
    }
}

/* House error of a against b: psi, v, r in metres at b. */
static void house_error(const state_t *a, const state_t *b, ld out[9])
{
    ld Q[3][3] = {{0}};
    const ld M = meridian(LAT) + b->p[2], R = normal(LAT) + b->p[2];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            for (int k = 0; k < 3; k++) { Q[i][j] += a->C[i][k] * b->C[j][k]; }
        }
        out[3 + i] = a->v[i] - b->v[i];
    }
    out[0] = 0.5L * (Q[2][1] - Q[1][2]);
    out[1] = 0.5L * (Q[0][2] - Q[2][0]);
    out[2] = 0.5L * (Q[1][0] - Q[0][1]);
    out[6] = R * cosl(b->p[0]) * (a->p[1] - b->p[1]);
    out[7] = M * (a->p[0] - b->p[0]);
    out[8] = a->p[2] - b->p[2];
}

static void the_transition_is_second_order_in_its_step(void)
{
    const ld T = 0.05L;
    const int house[9] = {9, 10, 11, 12, 13, 14, 15, 16, 17};
    /* sizes of usual errors: what a wrong entry of Phi would cost (rad, m/s, m; gyros, accelerometers) */
    const ld size[18] = {5e-7L, 5e-7L, 5e-7L, 5e-7L, 5e-7L, 5e-7L, 1e-3L, 1e-3L, 1e-3L,
                         1e-4L, 1e-4L, 1e-4L, 0.05L, 0.05L, 0.05L, 1.0L,  1.0L,  1.0L};
    state_t end;
    ld f_mean[3] = {0}, dummy[3], zero[3] = {0};
    double f_enu[3], C[3][3], v[3], worst = 0.0;
    pel_transition_t t;
    pel_imu_model_t imu;
    pel_model_t m;
    nominal(&end);
    integrate(&end, zero, zero, T, f_mean);
    for (int i = 0; i < 3; i++) {
        f_enu[i] = (double)f_mean[i];
        v[i] = 0.5 * (double)(VELOCITY[i] + end.v[i]);
        for (int j = 0; j < 3; j++) { C[i][j] = 0.5 * (double)(ATTITUDE[i][j] + end.C[i][j]); }
    }
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    pel_model_ins_enu(&m, &imu);
    pel_model_transition_enu(&m, f_enu, C, v, 0.5 * (double)(LAT + end.p[0]), 0.5 * (double)(HEIGHT + end.p[2]),
                             (double)T, &t);
    static ld Phi[18][18];
    memset(Phi, 0, sizeof Phi);
    for (int i = 0; i < 18; i++) { Phi[i][i] = 1.0L; }
    for (int k = 0; k < t.n_blocks; k++) {
        for (int i = 0; i < 3; i++) {
            for (int j = 0; j < 3; j++) { Phi[t.block[k].row + i][t.block[k].col + j] += (ld)t.block[k].m[i][j]; }
        }
    }
    for (int j = 0; j < 18; j++) {
        ld moved[2][9];
        for (int side = 0; side < 2; side++) {
            ld x[N] = {0}, dw[3], df[3], e = (side == 0) ? size[j] : -size[j];
            state_t s;
            nominal(&s);
            if (j < 6) { x[GYRO + j % 3] = e; }
            if (j >= 6 && j < 9) { x[ACCEL + j - 6] = e; }
            if (j >= 9 && j < 12) { x[PHI + j - 9] = -e; }
            if (j >= 12 && j < 15) { x[VEL + j - 12] = e; }
            if (j == 15) { x[POS + 1] = e / ((normal(LAT) + HEIGHT) * cosl(LAT)); }
            if (j == 16) { x[POS] = e / (meridian(LAT) + HEIGHT); }
            if (j == 17) { x[POS + 2] = e; }
            perturb(&s, x, dw, df);
            integrate(&s, dw, df, T, dummy);
            house_error(&s, &end, moved[side]);
        }
        for (int i = 0; i < 9; i++) {
            const ld column = 0.5L * (moved[0][i] - moved[1][i]);
            const ld off = fabsl(column - Phi[house[i]][j] * size[j]) / size[house[i]];
            if ((double)off > worst) { worst = (double)off; }
        }
    }
    printf("Phi over %.2f s against the nonlinear equations: %.1e of a usual sigma\n", (double)T, worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(PEL_REAL_DOUBLE ? 2e-7 : 4e-7, worst);
}

int main(void)
{
    state_t s;
    nominal(&s);
    UNITY_BEGIN();
    RUN_TEST(the_table_is_the_derivative_of_the_mechanization);
    RUN_TEST(the_model_is_the_table_in_other_units);
    RUN_TEST(what_is_left_out_is_the_latitude_of_radii_and_gravity);
    RUN_TEST(the_printed_entries_are_wrong);
    RUN_TEST(the_transition_is_second_order_in_its_step);
    return UNITY_END();
}

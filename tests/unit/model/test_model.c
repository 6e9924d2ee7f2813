/* build: f32 f64 */
/* The error model against a nonlinear one written here: R' = R[w x] - [w_ie x]R, V' = R f + g(r) - 2 W V, r' = V, in long double,
 * perturbed state by state and differenced (S5 section 4). */
#include <math.h>
#include <stdio.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "pelorus/model.h"
#include "unity.h"

typedef long double ld;

#define W_IE     7.292115e-5L
#define REAL_EPS (PEL_REAL_DOUBLE ? 1e-14 : 4e-7)

void setUp(void) {}
void tearDown(void) {}

typedef struct {
    ld R[3][3], V[3], r[3]; /* r from ORIGIN: differences of 1e-13 m count */
} state_t;

static ld ORIGIN[3];

static const ld RATE[3] = {0.11L, -0.23L, 0.31L}; /* omega_ib_b */
static const ld FORCE[3] = {1.7L, -2.1L, 10.9L};  /* f_ib_b */

static void gravity(const ld r[3], ld g[3])
{
    const ld rr = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    const ld k = -3.986004418e14L / (rr * sqrtl(rr));
    const ld j = 1.5L * 1.082627e-3L * 6378137.0L * 6378137.0L / rr;
    const ld t = 5.0L * r[2] * r[2] / rr;
    g[0] = (k * (1.0L + j * (1.0L - t)) + W_IE * W_IE) * r[0];
    g[1] = (k * (1.0L + j * (1.0L - t)) + W_IE * W_IE) * r[1];
    g[2] = k * (1.0L + j * (3.0L - t)) * r[2];
}

/* Time derivative with sensor errors added to rate and force. */
static void derivative(const state_t *s, const ld dw[3], const ld df[3], state_t *d)
{
    const ld w[3] = {RATE[0] + dw[0], RATE[1] + dw[1], RATE[2] + dw[2]};
    const ld f[3] = {FORCE[0] + df[0], FORCE[1] + df[1], FORCE[2] + df[2]};
    ld g[3];
    const ld r[3] = {ORIGIN[0] + s->r[0], ORIGIN[1] + s->r[1], ORIGIN[2] + s->r[2]};
    gravity(r, g);
    for (int i = 0; i < 3; i++) {
        d->R[i][0] = s->R[i][1] * w[2] - s->R[i][2] * w[1];
        d->R[i][1] = s->R[i][2] * w[0] - s->R[i][0] * w[2];
        d->R[i][2] = s->R[i][0] * w[1] - s->R[i][1] * w[0];
        d->V[i] = s->R[i][0] * f[0] + s->R[i][1] * f[1] + s->R[i][2] * f[2] + g[i];
        d->r[i] = s->V[i];
    }
    for (int j = 0; j < 3; j++) {
        d->R[0][j] += W_IE * s->R[1][j];
        d->R[1][j] -= W_IE * s->R[0][j];
    }
    d->V[0] += 2.0L * W_IE * s->V[1];
    d->V[1] -= 2.0L * W_IE * s->V[0];
}

static void advance(const state_t *s, const state_t *d, ld h, state_t *out)
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { out->R[i][j] = s->R[i][j] + h * d->R[i][j]; }
        out->V[i] = s->V[i] + h * d->V[i];
        out->r[i] = s->r[i] + h * d->r[i];
    }
}

/* Runge and Kutta's fourth order in 20 steps */
static void integrate(state_t *s, const ld dw[3], const ld df[3], ld T)
{
    const ld h = T / 20.0L;
    for (int n = 0; n < 20; n++) {
        state_t k1, k2, k3, k4, m;
        derivative(s, dw, df, &k1);
        advance(s, &k1, 0.5L * h, &m);
        derivative(&m, dw, df, &k2);
        advance(s, &k2, 0.5L * h, &m);
        derivative(&m, dw, df, &k3);
        advance(s, &k3, h, &m);
        derivative(&m, dw, df, &k4);
        advance(s, &k1, h / 6.0L, s);
        advance(s, &k2, h / 3.0L, s);
        advance(s, &k3, h / 3.0L, s);
        advance(s, &k4, h / 6.0L, s);
    }
}

static void start(state_t *s)
{
    double r[3];
    double C[3][3];
    pel_earth_llh_to_ecef(0.53, 1.99, 1500.0, r);
    pel_attitude_to_C_b_e(0.2, -0.1, 2.3, 0.53, 1.99, C);
    for (int i = 0; i < 3; i++) {
        ORIGIN[i] = r[i];
        s->r[i] = 0.0L;
        s->V[i] = 100.0L - 60.0L * i;
        for (int j = 0; j < 3; j++) { s->R[i][j] = C[i][j]; }
    }
}

/* s with error state x applied: R~ = exp([psi x]) R */
static void perturb(state_t *s, const ld x[18], ld dw[3], ld df[3])
{
    const ld psi[3] = {x[9], x[10], x[11]};
    ld out[3][3];
    for (int j = 0; j < 3; j++) {
        ld c[3] = {s->R[0][j], s->R[1][j], s->R[2][j]};
        ld sum[3] = {c[0], c[1], c[2]};
        for (int n = 1; n < 12; n++) {
            const ld p[3] = {psi[1] * c[2] - psi[2] * c[1], psi[2] * c[0] - psi[0] * c[2],
                             psi[0] * c[1] - psi[1] * c[0]};
            for (int i = 0; i < 3; i++) {
                c[i] = p[i] / n;
                sum[i] += c[i];
            }
        }
        for (int i = 0; i < 3; i++) { out[i][j] = sum[i]; }
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { s->R[i][j] = out[i][j]; }
        s->V[i] += x[12 + i];
        s->r[i] += x[15 + i];
        dw[i] = x[i] + x[3 + i];
        df[i] = x[6 + i];
    }
}

/* Difference of two states as an error vector: psi from R~ R' */
static void difference(const state_t *a, const state_t *b, ld psi[3], ld dV[3], ld dr[3])
{
    ld M[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            M[i][j] = a->R[i][0] * b->R[j][0] + a->R[i][1] * b->R[j][1] + a->R[i][2] * b->R[j][2];
        }
        dV[i] = a->V[i] - b->V[i];
        dr[i] = a->r[i] - b->r[i];
    }
    psi[0] = 0.5L * (M[2][1] - M[1][2]);
    psi[1] = 0.5L * (M[0][2] - M[2][0]);
    psi[2] = 0.5L * (M[1][0] - M[0][1]);
    const ld n = sqrtl(psi[0] * psi[0] + psi[1] * psi[1] + psi[2] * psi[2]); /* sine of the angle */
    for (int i = 0; i < 3 && n > 0.0L; i++) { psi[i] *= asinl(n) / n; }
}

/* Columns of the true transition over T by central differences. */
static void true_transition(ld T, ld Phi[18][18])
{
    static const ld size[18] = {1e-6L, 1e-6L, 1e-6L, 1e-6L, 1e-6L, 1e-6L, 1e-4L, 1e-4L, 1e-4L,
                                1e-6L, 1e-6L, 1e-6L, 1e-2L, 1e-2L, 1e-2L, 10.0L, 10.0L, 10.0L};
    for (int k = 0; k < 18; k++) {
        state_t s[2];
        for (int side = 0; side < 2; side++) {
            ld x[18] = {0};
            ld dw[3];
            ld df[3];
            x[k] = (side == 0) ? size[k] : -size[k];
            start(&s[side]);
            perturb(&s[side], x, dw, df);
            integrate(&s[side], dw, df, T);
        }
        ld e[9];
        difference(&s[0], &s[1], &e[0], &e[3], &e[6]);
        for (int i = 0; i < 9; i++) { Phi[9 + i][k] = e[i] / (2.0L * size[k]); }
        for (int i = 0; i < 9; i++) { Phi[i][k] = (i == k) ? 1.0L : 0.0L; }
    }
}

/* Transition from the library, with the mean force and attitude of the same interval. */
static void library_transition(ld T, pel_transition_t *t, double Phi[18][18])
{
    pel_model_t m;
    pel_imu_model_t imu;
    state_t s;
    const ld zero[3] = {0};
    double f_e[3] = {0};
    double C[3][3];
    double C0[3][3];
    double r[3];
    start(&s);
    for (int i = 0; i < 3; i++) {
        r[i] = (double)ORIGIN[i];
        for (int j = 0; j < 3; j++) { C0[i][j] = (double)s.R[i][j]; }
    }
    for (int n = 0; n < 100; n++) { /* mean of R f by the midpoint rule */
        integrate(&s, zero, zero, T / 200.0L);
        for (int i = 0; i < 3; i++) {
            f_e[i] += (double)((s.R[i][0] * FORCE[0] + s.R[i][1] * FORCE[1] + s.R[i][2] * FORCE[2]) / 100.0L);
        }
        integrate(&s, zero, zero, T / 200.0L);
    }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { C[i][j] = 0.5 * (C0[i][j] + (double)s.R[i][j]); }
    }
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    pel_model_ins_ecef(&m, &imu);
    pel_model_transition(&m, f_e, C, r, (double)T, t);
    for (int i = 0; i < 18; i++) {
        for (int j = 0; j < 18; j++) { Phi[i][j] = (i == j) ? 1.0 : 0.0; }
    }
    for (int k = 0; k < t->n_blocks; k++) {
        for (int i = 0; i < 9; i++) {
            Phi[t->block[k].row + i / 3][t->block[k].col + i % 3] += (double)t->block[k].m[i / 3][i % 3];
        }
    }
}

/* Scale of a state, to make entries of different units comparable: what counts in S5. */
static double unit(int i)
{
    static const double u[6] = {5e-8, 5e-8, 1e-4, 1e-5, 1e-2, 1.0};
    return u[i / 3];
}

/* d/dt of the error vector between two states, from their derivatives: psi' from d/dt (R~ R'), exact to psi^2. */
static void error_rate(const state_t *a, const state_t *da, const state_t *b, const state_t *db, ld rate[9])
{
    ld M[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            M[i][j] = 0.0L;
            for (int k = 0; k < 3; k++) { M[i][j] += da->R[i][k] * b->R[j][k] + a->R[i][k] * db->R[j][k]; }
        }
        rate[3 + i] = da->V[i] - db->V[i];
        rate[6 + i] = da->r[i] - db->r[i];
    }
    rate[0] = 0.5L * (M[2][1] - M[1][2]);
    rate[1] = 0.5L * (M[0][2] - M[2][0]);
    rate[2] = 0.5L * (M[1][0] - M[0][1]);
}

/* F of the nonlinear equations by central differences: no integration, so no entry hides behind another. */
static void true_system_matrix(ld F[18][18])
{
    for (int k = 0; k < 18; k++) {
        const ld size = (k >= 15) ? 10.0L : 1e-6L;
        state_t s[2];
        state_t d[2];
        for (int side = 0; side < 2; side++) {
            ld x[18] = {0};
            ld dw[3];
            ld df[3];
            x[k] = (side == 0) ? size : -size;
            start(&s[side]);
            perturb(&s[side], x, dw, df);
            derivative(&s[side], dw, df, &d[side]);
        }
        ld rate[9];
        error_rate(&s[0], &d[0], &s[1], &d[1], rate);
        for (int i = 0; i < 18; i++) { F[i][k] = (i < 9) ? 0.0L : rate[i - 9] / (2.0L * size); }
    }
}

/* The library's Phi is a polynomial of degree 2 in T: 4 Phi(T/2) - Phi(T) - 3 I = F T. Every entry, also those that must be zero;
 * small ones are judged by what they do to a state of its usual size, 1e-5 sigma per second. */
static void the_system_matrix_matches_central_differences(void)
{
    const double T = 0.01;
    static ld want[18][18];
    double got[18][18] = {{0}};
    state_t s;
    double f_e[3];
    double C[3][3];
    double r[3];
    pel_model_t m;
    pel_imu_model_t imu;
    pel_transition_t whole;
    pel_transition_t half;
    true_system_matrix(want);
    start(&s);
    for (int i = 0; i < 3; i++) {
        f_e[i] = (double)(s.R[i][0] * FORCE[0] + s.R[i][1] * FORCE[1] + s.R[i][2] * FORCE[2]);
        r[i] = (double)ORIGIN[i];
        for (int j = 0; j < 3; j++) { C[i][j] = (double)s.R[i][j]; }
    }
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    pel_model_ins_ecef(&m, &imu);
    pel_model_transition(&m, f_e, C, r, T, &whole);
    pel_model_transition(&m, f_e, C, r, 0.5 * T, &half);
    for (int k = 0; k < whole.n_blocks; k++) {
        TEST_ASSERT_TRUE(whole.block[k].row == half.block[k].row && whole.block[k].col == half.block[k].col);
        for (int i = 0; i < 9; i++) {
            got[whole.block[k].row + i / 3][whole.block[k].col + i % 3] +=
                (4.0 * (double)half.block[k].m[i / 3][i % 3] - (double)whole.block[k].m[i / 3][i % 3]) / T;
        }
    }
    double worst = 0.0;
    int wi = 0;
    int wj = 0;
    for (int i = 0; i < 18; i++) {
        for (int j = 0; j < 18; j++) {
            if (i >= 12 && i < 15 && j >= 15) { continue; } /* the gravity gradient: below */
            const double size = fmax((double)fabsl(want[i][j]), 1e-5 * unit(i) / unit(j));
            const double e = fabs((double)want[i][j] - got[i][j]) / size;
            if (e > worst) {
                worst = e;
                wi = i;
                wj = j;
            }
        }
    }
    printf("  F entry by entry: worst %.1e relative, at (%d, %d)\n", worst, wi, wj);
    TEST_ASSERT_TRUE(worst < (PEL_REAL_DOUBLE ? 1e-8 : 2e-6));

    double gradient = 0.0;
    for (int i = 12; i < 15; i++) {
        for (int j = 15; j < 18; j++) { gradient = fmax(gradient, fabs((double)want[i][j] - got[i][j])); }
    }
    printf("  gravity gradient: %.1e 1/s^2 (S5: 6e-9)\n", gradient);
    TEST_ASSERT_TRUE(gradient < 2.1e-8);
}

/* Over a substep the error of Phi must fall with the third power of its length (in double; float stops at rounding). */
static void the_transition_is_of_second_order(void)
{
    static const ld SPANS_S[3] = {0.2L, 0.1L, 0.05L};
    double error[3];
    for (int k = 0; k < 3; k++) {
        const ld T = SPANS_S[k];
        static ld want[18][18];
        double got[18][18];
        pel_transition_t t;
        true_transition(T, want);
        library_transition(T, &t, got);
        error[k] = 0.0;
        for (int i = 0; i < 18; i++) {
            for (int j = 0; j < 18; j++) {
                if (i >= 12 && j >= 15) { continue; } /* J2 again */
                error[k] = fmax(error[k], fabs((double)want[i][j] - got[i][j]) * unit(j) / unit(i));
            }
        }
    }
    printf("  Phi over 0.2, 0.1, 0.05 s: %.1e, %.1e, %.1e sigma; ratios %.1f, %.1f\n", error[0], error[1], error[2],
           error[0] / error[1], error[1] / error[2]);
    TEST_ASSERT_TRUE(error[2] < 2e-5);
    TEST_ASSERT_TRUE(error[0] / error[1] > 7.0 && error[1] / error[2] > 7.0);
}

static void blocks_are_where_s5_wants_them(void)
{
    pel_model_t m;
    pel_imu_model_t imu;
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    pel_model_ins_ecef(&m, &imu);
    TEST_ASSERT_EQUAL(18, m.n);
    TEST_ASSERT_EQUAL(0, pel_model_index(&m, PEL_BLOCK_GYRO_CONSTANT));
    TEST_ASSERT_EQUAL(3, pel_model_index(&m, PEL_BLOCK_GYRO_MARKOV));
    TEST_ASSERT_EQUAL(6, pel_model_index(&m, PEL_BLOCK_ACCEL_MARKOV));
    TEST_ASSERT_EQUAL(9, pel_model_index(&m, PEL_BLOCK_ATTITUDE));
    TEST_ASSERT_EQUAL(12, pel_model_index(&m, PEL_BLOCK_VELOCITY));
    TEST_ASSERT_EQUAL(15, pel_model_index(&m, PEL_BLOCK_POSITION));
    TEST_ASSERT_EQUAL(-1, pel_model_index(&m, PEL_BLOCK_AMBIGUITY));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_model_append(&m, PEL_BLOCK_VELOCITY, 3));
    TEST_ASSERT_EQUAL(PEL_E_FULL, pel_model_append(&m, PEL_BLOCK_AMBIGUITY, PEL_MAX_STATES));
    TEST_ASSERT_EQUAL(PEL_E_FULL, pel_model_append(&m, PEL_BLOCK_AMBIGUITY, INT32_MAX));
    TEST_ASSERT_EQUAL(PEL_OK, pel_model_append(&m, PEL_BLOCK_AMBIGUITY, 6));
    TEST_ASSERT_EQUAL(18, pel_model_index(&m, PEL_BLOCK_AMBIGUITY));
    pel_model_gnss(&m, &imu);
    TEST_ASSERT_EQUAL(6, m.n);
    TEST_ASSERT_EQUAL(3, pel_model_index(&m, PEL_BLOCK_POSITION));

    /* S5 section 10: 0.01 deg/h is 4.848e-8 rad/s, 0.001 deg/sqrt(h) 2.909e-7 rad/sqrt(s), 10 ug 9.807e-5 m/s^2 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-11, 4.8481e-8, imu.sd_bg_radps);
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, 2.9089e-7, imu.arw_rad_rts);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 9.80665e-5, imu.sd_am_mps2);
    pel_real sd[PEL_MAX_STATES] = {0};
    pel_model_ins_ecef(&m, &imu);
    pel_model_sensor_sd(&m, sd);
    TEST_ASSERT_TRUE(sd[0] == (pel_real)imu.sd_bg_radps && sd[5] == (pel_real)imu.sd_gm_radps &&
                     sd[8] == (pel_real)imu.sd_am_mps2);
    TEST_ASSERT_TRUE(sd[9] == PEL_R(0.0));
}

static void noise_and_decay_are_those_of_the_sensors(void)
{
    pel_model_t m;
    pel_imu_model_t imu;
    pel_transition_t t;
    pel_real decay[PEL_MAX_STATES];
    pel_real q[PEL_MAX_STATES];
    double r[3];
    const double f[3] = {0.0, 0.0, 9.8};
    const double C[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    pel_earth_llh_to_ecef(0.5, 1.0, 0.0, r);
    pel_imu_model_preset(PEL_IMU_GRADE_MEMS, &imu);
    pel_model_ins_ecef(&m, &imu);
    pel_model_transition(&m, f, C, r, 0.05, &t);
    for (int i = 0; i < 18; i++) {
        const double want = (i >= 12 && i < 15)  ? imu.vrw_mps_rts * imu.vrw_mps_rts * 0.05
                            : (i >= 9 && i < 12) ? imu.arw_rad_rts * imu.arw_rad_rts * 0.05
                                                 : 0.0;
        TEST_ASSERT_DOUBLE_WITHIN(REAL_EPS * want, want, (double)t.q[i]);
    }
    for (double dt = 0.01; dt < 200.0; dt *= 3.0) {
        pel_model_slow(&m, dt, decay, q);
        const double phi = exp(-dt / imu.tau_gm_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 + REAL_EPS, 1.0, (double)decay[3] / expm1(-dt / imu.tau_gm_s));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 + REAL_EPS, 1.0,
                                  (double)q[4] /
                                      (imu.sd_gm_radps * imu.sd_gm_radps * -expm1(-2.0 * dt / imu.tau_gm_s)));
        TEST_ASSERT_DOUBLE_WITHIN(1e-9 + REAL_EPS, 1.0, (double)decay[8] / expm1(-dt / imu.tau_am_s));
        TEST_ASSERT_TRUE(decay[0] == PEL_R(0.0) && decay[9] == PEL_R(0.0) && q[0] == PEL_R(0.0) && phi < 1.0);
    }
}

static void blocks_that_cannot_be_are_not_appended(void)
{
    pel_model_t m;
    pel_imu_model_t imu;
    pel_imu_model_preset(PEL_IMU_GRADE_MEMS, &imu);
    pel_model_gnss(&m, &imu);
    const pel_model_t before = m;
    static const struct {
        int block, size;
    } bad[] = {{PEL_BLOCK_HEIGHT, 0}, {PEL_BLOCK_HEIGHT, -1}, {-1, 1}, {PEL_N_BLOCK, 1}};
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_model_append(&m, (pel_block_t)bad[i].block, bad[i].size));
    }
    TEST_ASSERT_EQUAL_MEMORY(&before, &m, sizeof m);
    TEST_ASSERT_EQUAL(PEL_OK, pel_model_append(&m, PEL_BLOCK_HEIGHT, PEL_MAX_STATES - 6)); /* the last that fits */
    TEST_ASSERT_EQUAL(PEL_MAX_STATES, m.n);
}

static void offsets_are_at_least_one_and_at_most_what_there_is_room_for(void)
{
    static const int ASKED[] = {-3, 0, 1, 2, (PEL_MAX_STATES - 16) / 2, (PEL_MAX_STATES - 16) / 2 + 1, 1000};
    const int most = (PEL_MAX_STATES - 16) / 2;
    pel_model_t m;
    pel_imu_model_t imu;
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    for (int i = 0; i < 7; i++) {
        pel_model_tdcp(&m, &imu, ASKED[i]);
        const int n = (ASKED[i] < 1) ? 1 : (ASKED[i] > most) ? most : ASKED[i];
        TEST_ASSERT_EQUAL(16 + 2 * n, m.n);
        TEST_ASSERT_EQUAL(15, pel_model_index(&m, PEL_BLOCK_OFFSET));
        TEST_ASSERT_EQUAL(15 + n, pel_model_index(&m, PEL_BLOCK_OFFSET_RATE));
        TEST_ASSERT_EQUAL(15 + 2 * n, pel_model_index(&m, PEL_BLOCK_HEIGHT));
    }
}

static void sensor_states_are_set_where_a_model_has_them(void)
{
    pel_model_t m;
    pel_imu_model_t imu;
    pel_real sd[PEL_MAX_STATES];
    pel_imu_model_preset(PEL_IMU_GRADE_MEMS, &imu);
    imu.sd_ba_mps2 = 0.3;
    for (int i = 0; i < PEL_MAX_STATES; i++) { sd[i] = PEL_R(7.0); }
    pel_model_gnss(&m, &imu);
    pel_model_sensor_sd(&m, sd);
    for (int i = 0; i < PEL_MAX_STATES; i++) { TEST_ASSERT_TRUE(sd[i] == PEL_R(7.0)); } /* it has none */
    pel_model_tdcp(&m, &imu, 2);
    pel_model_sensor_sd(&m, sd);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_TRUE(sd[i] == (pel_real)imu.sd_bg_radps && sd[3 + i] == (pel_real)imu.sd_ba_mps2);
    }
    TEST_ASSERT_TRUE(sd[6] == PEL_R(7.0));
    TEST_ASSERT_EQUAL(20, m.n);
    TEST_ASSERT_EQUAL(15, pel_model_index(&m, PEL_BLOCK_OFFSET));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_system_matrix_matches_central_differences);
    RUN_TEST(the_transition_is_of_second_order);
    RUN_TEST(blocks_are_where_s5_wants_them);
    RUN_TEST(noise_and_decay_are_those_of_the_sensors);
    RUN_TEST(blocks_that_cannot_be_are_not_appended);
    RUN_TEST(offsets_are_at_least_one_and_at_most_what_there_is_room_for);
    RUN_TEST(sensor_states_are_set_where_a_model_has_them);
    return UNITY_END();
}

/* build: f32 f64 */
/* Rows of phases with a float state, of time differences and of vehicle constraints, each against central differences of what it linearises. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "pelorus/observe.h"
#include "unity.h"

typedef long double ld;

enum { GYRO = 0, ACCEL = 3, CLONE = 6, PSI = 9, V = 12, R = 15, EXTRA = 18, N = 20 };

/* Vehicle, two satellites, an extra state and the antenna at the previous epoch. */
typedef struct {
    double C[3][3], v[3], r[3], clone[3], lever_b[3], sat[2][3], extra;
} world_t;

static world_t world;
static const double ARM_B[3] = {-0.4, -1.9, -0.6}, OMEGA_B[3] = {0.05, -0.1, 0.2};

static void antenna(const world_t *w, double r_a[3])
{
    double arm[3];
    pel_mat3_vec(w->C, w->lever_b, arm);
    for (int k = 0; k < 3; k++) { r_a[k] = w->r[k] + arm[k]; }
}

static double range(const double sat[3], const double r_a[3], double u[3])
{
    double d[3];
    for (int k = 0; k < 3; k++) { d[k] = sat[k] - r_a[k]; }
    const double rho = pel_norm3(d);
    for (int k = 0; k < 3; k++) { u[k] = d[k] / rho; }
    return rho;
}

static double dd_from(const world_t *w, const double r_a[3])
{
    double u[3];
    return range(w->sat[1], r_a, u) - range(w->sat[0], r_a, u);
}

static double float_phase(const world_t *w)
{
    double r_a[3];
    antenna(w, r_a);
    return dd_from(w, r_a) + 0.19 * w->extra;
}

/* Both ends with the line of sight of now: what the clone row promises (S3 6.2a). */
static double clone_change(const world_t *w)
{
    double now[3], true_now[3], u0[3], u1[3], at_clone = 0.0;
    antenna(w, now);
    antenna(&world, true_now);
    (void)range(world.sat[0], true_now, u0);
    (void)range(world.sat[1], true_now, u1);
    for (int k = 0; k < 3; k++) { at_clone += (u0[k] - u1[k]) * (w->clone[k] - world.clone[k]); }
    return dd_from(w, now) - at_clone;
}

static double height(const world_t *w)
{
    double r_a[3], lat, lon, h;
    antenna(w, r_a);
    pel_earth_ecef_to_llh(r_a, &lat, &lon, &h);
    return h - w->extra;
}

static double up_velocity(const world_t *w)
{
    double lat, lon, h, C[3][3];
    pel_earth_ecef_to_llh(world.r, &lat, &lon, &h);
    pel_earth_C_e_enu(lat, lon, C);
    return pel_dot3(C[2], w->v);
}

static int body_axis;
static double body_velocity(const world_t *w)
{
    double v_b[3], rate_b[3];
    pel_mat3_tvec(w->C, w->v, v_b);
    pel_cross3(OMEGA_B, ARM_B, rate_b);
    return v_b[body_axis] + rate_b[body_axis];
}

static world_t perturbed(int i, double e)
{
    world_t w = world;
    if (i == EXTRA) { w.extra += e; }
    if (i >= R && i < R + 3) { w.r[i - R] += e; }
    if (i >= V && i < V + 3) { w.v[i - V] += e; }
    if (i >= CLONE && i < CLONE + 3) { w.clone[i - CLONE] += e; }
    if (i >= PSI && i < PSI + 3) {
        double psi[3] = {0.0, 0.0, 0.0}, turn[3][3];
        psi[i - PSI] = e;
        pel_rotvec_to_dcm(psi, turn);
        pel_mat3_mul(turn, world.C, w.C);
    }
    return w;
}

/* Tolerances: the last digit of a range of 4e7 m over 1e-3 rad is 4e-6 m/rad; of a height 1e-6. */
static void hold(const char *name, const pel_row_t *row, double (*model)(const world_t *), double tolerance)
{
    double worst = 0.0;
    TEST_ASSERT_EQUAL_INT(N, row->n);
    for (int i = 0; i < N; i++) {
        const double e = (i >= PSI && i < V) ? 1e-3 : 1.0;
        const world_t plus = perturbed(i, e), minus = perturbed(i, -e);
        const double slope = (model(&plus) - model(&minus)) / (2.0 * e);
        const double h = (i < row->first) ? 0.0 : (double)row->h[i];
        worst = fmax(worst, fabs(slope - h));
    }
    printf("  %s row against central differences: %.1e\n", name, worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(tolerance, worst);
}

void setUp(void)
{
    const double attitude[3] = {0.3, -0.5, 1.1}, v[3] = {6.0, -11.0, 4.0}, lever[3] = {0.5, 0.8, 1.2};
    const double s0[3] = {-1.4e7, 3.9e7, 1.0e5}, s1[3] = {7.3e6, 4.15e7, -2.0e5};
    memset(&world, 0, sizeof world);
    pel_rotvec_to_dcm(attitude, world.C);
    pel_earth_llh_to_ecef(28.22 * PEL_DEG, 112.99 * PEL_DEG, 50.0, world.r);
    for (int k = 0; k < 3; k++) {
        world.v[k] = v[k];
        world.lever_b[k] = lever[k];
        world.sat[0][k] = s0[k];
        world.sat[1][k] = s1[k];
    }
    world.extra = 3.0;
}

void tearDown(void) {}

static pel_antenna_t ant;
static pel_sd_t sat, pivot;

static void prepare(void)
{
    double r_a[3];
    memset(&sat, 0, sizeof sat);
    memset(&pivot, 0, sizeof pivot);
    ant = (pel_antenna_t){.n_states = N, .i_psi = PSI, .i_v = V, .i_r = R};
    pel_mat3_vec(world.C, world.lever_b, ant.lever_e);
    antenna(&world, r_a);
    (void)range(world.sat[0], r_a, pivot.u_e);
    (void)range(world.sat[1], r_a, sat.u_e);
}

static void a_float_phase_sees_attitude_position_and_its_ambiguity(void)
{
    pel_row_t row;
    prepare();
    pel_observe_float(&ant, &sat, &pivot, 0.25, EXTRA, 0.19, &row);
    TEST_ASSERT_EQUAL_DOUBLE(-0.25, (double)row.z);
    TEST_ASSERT_EQUAL_INT(PSI, row.first);
    hold("float phase", &row, float_phase, 2e-5);
}

static void a_cloned_change_sees_both_ends(void)
{
    pel_row_t row;
    prepare();
    pel_observe_clone(&ant, &sat, &pivot, 0.25, CLONE, &row);
    TEST_ASSERT_EQUAL_DOUBLE(-0.25, (double)row.z);
    TEST_ASSERT_EQUAL_INT(CLONE, row.first);
    hold("clone", &row, clone_change, 2e-5);
}

static void the_clone_becomes_the_antenna_now(void)
{
    double worst = 0.0;
    prepare();
    for (int axis = 0; axis < 3; axis++) {
        pel_real a[PEL_MAX_STATES];
        pel_observe_clone_map(&ant, axis, a);
        for (int i = 0; i < N; i++) {
            const double e = (i >= PSI && i < V) ? 1e-4 : 1.0;
            const world_t plus = perturbed(i, e), minus = perturbed(i, -e);
            double p[3], q[3];
            antenna(&plus, p);
            antenna(&minus, q);
            worst = fmax(worst, fabs((p[axis] - q[axis]) / (2.0 * e) - (double)a[i]));
        }
    }
    printf("  clone map against central differences: %.1e\n", worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-5, worst); /* the position's last digit over 1e-4 rad */
}

static void a_height_sees_position_lever_and_the_reference(void)
{
    pel_row_t row;
    double lat, lon, h, C[3][3];
    prepare();
    pel_earth_ecef_to_llh(world.r, &lat, &lon, &h);
    pel_earth_C_e_enu(lat, lon, C);
    pel_observe_height(&ant, C[2], 1.5, EXTRA, &row);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, (double)row.z);
    hold("height", &row, height, 5e-6);
    pel_observe_height(&ant, C[2], 1.5, -1, &row);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)row.h[EXTRA]);
}

static void velocity_rows_see_what_they_say(void)
{
    pel_row_t row;
    double lat, lon, h, C[3][3], rate_b[3];
    prepare();
    pel_earth_ecef_to_llh(world.r, &lat, &lon, &h);
    pel_earth_C_e_enu(lat, lon, C);
    pel_observe_velocity(&ant, C[2], pel_dot3(C[2], world.v), &row);
    TEST_ASSERT_EQUAL_INT(V, row.first);
    hold("vertical velocity", &row, up_velocity, 1e-6);
    pel_cross3(OMEGA_B, ARM_B, rate_b);
    for (body_axis = 0; body_axis < 3; body_axis++) {
        pel_observe_body_velocity(&ant, world.C, world.v, rate_b, body_axis, 0.5, &row);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, body_velocity(&world) - 0.5, (double)row.z);
        hold("body velocity", &row, body_velocity, 1e-5);
    }
}

/* ---- the paper's delayed row ------------------------------------------------------------------------------------------ */

#define W_IE 7.292115e-5L

typedef struct {
    ld C[3][3], v[3], r[3]; /* r from an origin */
} motion_t;

static const ld RATE[3] = {0.11L, -0.12L, 0.31L}; /* 0.35 rad/s */
static const ld FORCE[3] = {1.7L, -2.1L, 9.9L};
static ld GRAVITY[3];

static void derivative(const motion_t *s, const ld dw[3], const ld df[3], motion_t *d)
{
    const ld w[3] = {RATE[0] + dw[0], RATE[1] + dw[1], RATE[2] + dw[2]};
    for (int i = 0; i < 3; i++) {
        d->C[i][0] = s->C[i][1] * w[2] - s->C[i][2] * w[1];
        d->C[i][1] = s->C[i][2] * w[0] - s->C[i][0] * w[2];
        d->C[i][2] = s->C[i][0] * w[1] - s->C[i][1] * w[0];
        d->v[i] = GRAVITY[i]; /* the paper's model has no gravity gradient */
        for (int j = 0; j < 3; j++) { d->v[i] += s->C[i][j] * (FORCE[j] + df[j]); }
        d->r[i] = s->v[i];
    }
    for (int j = 0; j < 3; j++) {
        d->C[0][j] += W_IE * s->C[1][j];
        d->C[1][j] -= W_IE * s->C[0][j];
    }
    d->v[0] += 2.0L * W_IE * s->v[1];
    d->v[1] -= 2.0L * W_IE * s->v[0];
}

static void advance(const motion_t *s, const motion_t *d, ld h, motion_t *out)
{
    for (int i = 0; i < 3; i++) {
        out->v[i] = s->v[i] + h * d->v[i];
        out->r[i] = s->r[i] + h * d->r[i];
        for (int j = 0; j < 3; j++) { out->C[i][j] = s->C[i][j] + h * d->C[i][j]; }
    }
}

static void integrate(motion_t *s, const ld dw[3], const ld df[3], ld T)
{
    const ld h = T / 20.0L;
    for (int n = 0; n < 20; n++) {
        motion_t k1, k2, k3, k4, m;
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

/* Where the antenna went over T, given the state at the end: back in time, then the difference along g. */
static ld antenna_path(const motion_t *now, const ld dw[3], const ld df[3], ld T, const double g[3], motion_t *before)
{
    ld path = 0.0L;
    *before = *now;
    integrate(before, dw, df, -T);
    for (int i = 0; i < 3; i++) {
        ld a = now->r[i] - before->r[i];
        for (int j = 0; j < 3; j++) { a += (now->C[i][j] - before->C[i][j]) * (ld)world.lever_b[j]; }
        path += (ld)g[i] * a;
    }
    return path;
}

static void start_now(motion_t *now)
{
    for (int i = 0; i < 3; i++) {
        now->v[i] = world.v[i];
        now->r[i] = 0.0L;
        for (int j = 0; j < 3; j++) { now->C[i][j] = world.C[i][j]; }
    }
}

static void make_delayed(double T, pel_row_t *row, double g[3])
{
    const ld none[3] = {0};
    motion_t now, before;
    pel_delay_t d = {.dt_s = T};
    pel_imu_model_t imu;
    pel_model_t m;
    double gravity[3];
    pel_earth_gravity_e(world.r, gravity);
    for (int i = 0; i < 3; i++) { GRAVITY[i] = gravity[i]; }
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    pel_model_tdcp_paper(&m, &imu);
    TEST_ASSERT_EQUAL_INT(12, m.n);
    prepare();
    for (int k = 0; k < 3; k++) { g[k] = pivot.u_e[k] - sat.u_e[k]; }
    start_now(&now);
    (void)antenna_path(&now, none, none, T, g, &before);
    for (int i = 0; i < 3; i++) {
        d.f_ib_b[i] = (double)FORCE[i];
        d.lever_b[i] = world.lever_b[i];
        for (int j = 0; j < 3; j++) {
            d.C_now[i][j] = (double)now.C[i][j];
            d.C_before[i][j] = (double)before.C[i][j];
        }
    }
    pel_observe_delayed(&m, &d, &sat, &pivot, 0.25, row);
}

static double slope(int i, double T, const double g[3])
{
    const ld e = (i < 3) ? 1e-4L : 1e-3L;
    ld path[2];
    for (int side = 0; side < 2; side++) {
        const ld s = (side == 0) ? e : -e;
        ld dw[3] = {0}, df[3] = {0};
        motion_t now, before;
        start_now(&now);
        if (i < 3) { dw[i] = s; }
        if (i >= 3 && i < 6) { df[i - 3] = s; }
        if (i >= 9) { now.v[i - 9] += s; }
        if (i >= 6 && i < 9) {
            double psi[3] = {0.0, 0.0, 0.0}, turn[3][3], C[3][3], turned[3][3];
            psi[i - 6] = (double)s;
            pel_rotvec_to_dcm(psi, turn);
            memcpy(C, world.C, sizeof C);
            pel_mat3_mul(turn, C, turned);
            for (int a = 0; a < 3; a++) {
                for (int b = 0; b < 3; b++) { now.C[a][b] = turned[a][b]; }
            }
        }
        path[side] = antenna_path(&now, dw, df, (ld)T, g, &before);
    }
    return (double)((path[0] - path[1]) / (2.0L * e));
}

static void the_delayed_row_is_the_derivative_of_the_antenna_s_path(void)
{
    pel_row_t row;
    double g[3], worst[4] = {0}, scale[4] = {0};
    make_delayed(0.1, &row, g);
    TEST_ASSERT_EQUAL_INT(0, row.first);
    TEST_ASSERT_EQUAL_DOUBLE(-0.25, (double)row.z);
    for (int i = 0; i < 12; i++) {
        const double s = slope(i, 0.1, g);
        scale[i / 3] = fmax(scale[i / 3], fabs(s));
        worst[i / 3] = fmax(worst[i / 3], fabs(s - (double)row.h[i]));
    }
    printf("  delayed row, relative to its largest: gyro %.1e, accelerometer %.1e, psi %.1e, v %.1e\n",
           worst[0] / scale[0], worst[1] / scale[1], worst[2] / scale[2], worst[3] / scale[3]);
    for (int b = 0; b < 4; b++) { TEST_ASSERT_LESS_THAN_DOUBLE(1e-3, worst[b] / scale[b]); }
}

static void the_gyro_lever_term_has_the_sign_that_differences_have(void)
{
    pel_row_t row;
    double g[3], right = 0.0, printed = 0.0;
    make_delayed(0.1, &row, g);
    for (int i = 0; i < 3; i++) {
        const double s = slope(i, 0.1, g);
        right = fmax(right, fabs(s - (double)row.h[i]));
        printed = fmax(printed, fabs(s + (double)row.h[i])); /* T^3/6 is 1 % of it: what is left is the lever's term */
    }
    printf("  gyro columns: derived sign %.1e, printed sign %.1e m/(rad/s)\n", right, printed);
    TEST_ASSERT_LESS_THAN_DOUBLE(2e-4, right);
    TEST_ASSERT_GREATER_THAN_DOUBLE(0.09, printed);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_float_phase_sees_attitude_position_and_its_ambiguity);
    RUN_TEST(a_cloned_change_sees_both_ends);
    RUN_TEST(the_clone_becomes_the_antenna_now);
    RUN_TEST(a_height_sees_position_lever_and_the_reference);
    RUN_TEST(velocity_rows_see_what_they_say);
    RUN_TEST(the_delayed_row_is_the_derivative_of_the_antenna_s_path);
    RUN_TEST(the_gyro_lever_term_has_the_sign_that_differences_have);
    return UNITY_END();
}

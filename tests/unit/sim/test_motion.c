/* link: pel_sim */
/* The truth agrees with itself: rates are derivatives, increments integrate back to it, gravity is a potential's gradient. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "motion.h"
#include "unity.h"
#include "world.h"

static motion_t motion;

/* Take-off, climb, banked turns, S5's sinusoids, strides, and a 17 Hz coning pair. */
void setUp(void)
{
    motion_config_t c = {
        .llh = {30.5 * WORLD_DEG, 114.3 * WORLD_DEG, 30.0}, .heading = 0.3, .pitch = 0.02, .bank = true};
    c.pitch_along_path = true;
    c.wave_speed = 5.0;
    const wave_t waves[] = {{WAVE_ROLL, 0.3 * WORLD_DEG, 0.31, 0.0},  {WAVE_PITCH, 0.2 * WORLD_DEG, 0.23, 1.0},
                            {WAVE_YAW, 0.15 * WORLD_DEG, 0.17, 2.0},  {WAVE_UP, 0.02, 1.9, 0.5},
                            {WAVE_ROLL, 0.01 * WORLD_DEG, 17.0, 0.0}, {WAVE_PITCH, 0.01 * WORLD_DEG, 17.0, 1.5707963}};
    c.n_waves = (int)(sizeof waves / sizeof waves[0]);
    memcpy(c.waves, waves, sizeof waves);
    const segment_t s[] = {{20.0, 0.0, 0.0, 0.0},  {50.0, 139.0, 0.0, 0.0},    {100.0, 0.0, 1.0, 1470.0},
                           {120.0, 0.0, 0.0, 0.0}, {130.0, 0.0, 3.14159, 0.0}, {100.0, -50.0, -1.0, 100.0},
                           {80.0, 0.0, 0.0, 0.0}};
    TEST_ASSERT_TRUE(motion_init(&motion, &c, s, 7));
}

void tearDown(void)
{
    motion_free(&motion);
}

/* Fourth-order central difference of component i of what `get` reads. */
static double derivative(double t, double h, double (*get)(const state_t *, int), int i)
{
    double x[4];
    const double at[4] = {t - 2.0 * h, t - h, t + h, t + 2.0 * h};
    for (int k = 0; k < 4; k++) {
        state_t s;
        motion_at(&motion, at[k], &s);
        x[k] = get(&s, i);
    }
    return (x[0] - 8.0 * x[1] + 8.0 * x[2] - x[3]) / (12.0 * h);
}

static double position(const state_t *s, int i)
{
    return s->r_eb_e[i];
}
static double velocity(const state_t *s, int i)
{
    return s->v_eb_e[i];
}
static double element(const state_t *s, int i)
{
    return s->C_b_e[i / 3][i % 3];
}

static void velocity_and_acceleration_are_the_derivatives_of_position(void)
{
    double worst_v = 0.0;
    double worst_a = 0.0;
    for (int k = 0; k < 820; k++) { /* across all segment boundaries */
        const double t = 0.31 + 0.777 * k;
        state_t s;
        motion_at(&motion, t, &s);
        for (int i = 0; i < 3; i++) {
            worst_v = fmax(worst_v, fabs(derivative(t, 2e-3, position, i) - s.v_eb_e[i]));
            worst_a = fmax(worst_a, fabs(derivative(t, 2e-3, velocity, i) - s.a_eb_e[i]));
        }
    }
    printf("dr/dt - v %.1e m/s, dv/dt - a %.1e m/s^2\n", worst_v, worst_a);
    TEST_ASSERT_LESS_THAN_DOUBLE(2e-6, worst_v);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-5, worst_a);
}

static void body_rate_is_the_derivative_of_attitude(void)
{
    double worst = 0.0;
    for (int n = 0; n < 770; n++) {
        const double t = 0.31 + 0.777 * n;
        state_t s;
        double dC[9];
        motion_at(&motion, t, &s);
        for (int i = 0; i < 9; i++) { dC[i] = derivative(t, 1e-4, element, i); }
        const int pair[3][2] = {{2, 1}, {0, 2}, {1, 0}}; /* C' dC/dt = [omega x] */
        for (int k = 0; k < 3; k++) {
            double w = 0.0;
            for (int j = 0; j < 3; j++) { w += s.C_b_e[j][pair[k][0]] * dC[3 * j + pair[k][1]]; }
            worst = fmax(worst, fabs(w - s.omega_eb_b[k]));
        }
    }
    printf("C'dC/dt - omega %.1e rad/s\n", worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-9, worst);
}

/* Gravity potential of a point mass, J2 and rotation. */
static double potential(const double r[3])
{
    const double r2 = dot(r, r);
    const double q = WORLD_A * WORLD_A / r2;
    const double s2 = r[2] * r[2] / r2;
    return WORLD_MU / sqrt(r2) * (1.0 - WORLD_J2 * q * (1.5 * s2 - 0.5)) +
           0.5 * WORLD_OMEGA * WORLD_OMEGA * (r[0] * r[0] + r[1] * r[1]);
}

static void gradient(const double r[3], double g[3])
{
    const double h = 30.0;
    for (int i = 0; i < 3; i++) {
        double a[3] = {r[0], r[1], r[2]};
        double b[3] = {r[0], r[1], r[2]};
        a[i] -= h;
        b[i] += h;
        g[i] = (potential(b) - potential(a)) / (2.0 * h);
    }
}

static void gravity_is_the_gradient_of_its_potential(void)
{
    for (int k = 0; k < 50; k++) {
        const double llh[3] = {(-80.0 + 3.3 * k) * WORLD_DEG, 17.0 * k * WORLD_DEG, 200.0 * k};
        double r[3];
        double g[3];
        double expected[3];
        world_llh_to_ecef(llh, r);
        world_gravity(r, g);
        gradient(r, expected);
        for (int i = 0; i < 3; i++) { TEST_ASSERT_DOUBLE_WITHIN(1e-8, expected[i], g[i]); }
    }
}

static void exponential(const double v[3], double C[3][3])
{
    const double a = sqrt(dot(v, v));
    const double s = (a > 1e-9) ? sin(a) / a : 1.0;
    const double k = (a > 1e-9) ? (1.0 - cos(a)) / (a * a) : 0.5;
    const double X[3][3] = {{0.0, -v[2], v[1]}, {v[2], 0.0, -v[0]}, {-v[1], v[0], 0.0}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const double x2 = X[i][0] * X[0][j] + X[i][1] * X[1][j] + X[i][2] * X[2][j];
            C[i][j] = ((i == j) ? 1.0 : 0.0) + s * X[i][j] + k * x2;
        }
    }
}

/* A navigator of the test's own: 2 kHz increments, coning and sculling from the previous one, gravity from the potential. */
static void increments_integrate_back_to_the_truth_within_a_millimetre_in_ten_minutes(void)
{
    const double dt = 5e-4;
    const double earth[3] = {0.0, 0.0, -WORLD_OMEGA * dt};
    state_t s;
    double C[3][3];
    double v[3];
    double r[3];
    double E[3][3];
    double alpha0[3] = {0.0};
    double dv0[3] = {0.0};
    motion_at(&motion, 0.0, &s);
    memcpy(C, s.C_b_e, sizeof C);
    memcpy(v, s.v_eb_e, sizeof v);
    memcpy(r, s.r_eb_e, sizeof r);
    exponential(earth, E);
    motion_increment(&motion, -dt, 0.0, alpha0, dv0);
    for (int k = 0; k < 1200000; k++) {
        double alpha[3];
        double dv[3];
        double coning[3];
        double a[3];
        double b[3];
        double c[3];
        double phi[3];
        double u[3];
        double u_e[3];
        double g[3];
        motion_increment(&motion, k * dt, (k + 1) * dt, alpha, dv);
        cross(alpha0, alpha, coning);
        cross(alpha, dv, a);
        cross(alpha0, dv, b);
        cross(dv0, alpha, c);
        for (int i = 0; i < 3; i++) {
            phi[i] = alpha[i] + coning[i] / 12.0;
            u[i] = dv[i] + 0.5 * a[i] + (b[i] + c[i]) / 12.0;
        }
        double half[3][3]; /* the Earth turns half a step before the mean of the interval */
        double turned[3][3];
        const double half_turn[3] = {0.0, 0.0, 0.5 * earth[2]};
        exponential(half_turn, half);
        multiply(half, C, turned);
        rotate(turned, u, u_e);
        double middle[3];
        for (int i = 0; i < 3; i++) { middle[i] = r[i] + 0.5 * dt * v[i]; }
        gradient(middle, g);
        const double vm[2] = {v[0] + 0.5 * (u_e[0] + g[0] * dt), v[1] + 0.5 * (u_e[1] + g[1] * dt)};
        const double step[3] = {u_e[0] + dt * (g[0] + 2.0 * WORLD_OMEGA * vm[1]),
                                u_e[1] + dt * (g[1] - 2.0 * WORLD_OMEGA * vm[0]), u_e[2] + dt * g[2]};
        for (int i = 0; i < 3; i++) {
            r[i] += dt * (v[i] + 0.5 * step[i]);
            v[i] += step[i];
        }
        double turn[3][3];
        exponential(phi, turn);
        multiply(E, C, turned);
        multiply(turned, turn, C);
        memcpy(alpha0, alpha, sizeof alpha);
        memcpy(dv0, dv, sizeof dv);
    }
    motion_at(&motion, 600.0, &s);
    double dr = 0.0;
    double dC = 0.0;
    for (int i = 0; i < 3; i++) {
        dr = fmax(dr, fabs(r[i] - s.r_eb_e[i]));
        for (int j = 0; j < 3; j++) { dC = fmax(dC, fabs(C[i][j] - s.C_b_e[i][j])); }
    }
    printf("after 600 s: position %.1e m, attitude %.1e rad\n", dr, dC);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-3, dr);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-8, dC);
}

static void a_vehicle_at_rest_feels_gravity_and_the_turning_earth_alone(void)
{
    state_t s;
    double g[3];
    motion_at(&motion, 10.0, &s);
    world_gravity(s.r_eb_e, g);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, sqrt(dot(g, g)), sqrt(dot(s.f_ib_b, s.f_ib_b)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, WORLD_OMEGA, sqrt(dot(s.omega_ib_b, s.omega_ib_b)));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.02, s.pitch);
}

static void turns_are_coordinated(void) /* no sideways force at the steepest bank, beside the sinusoids */
{
    motion.cfg.n_waves = 0;
    state_t s;
    motion_at(&motion, 355.0, &s);
    printf("bank %.1f deg, sideways %.3f m/s^2\n", s.roll / WORLD_DEG, s.f_ib_b[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 33.0, s.roll / WORLD_DEG);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 0.0, s.f_ib_b[0]);
}

static void attitude_angles_come_back(void)
{
    double C[3][3];
    double out[3];
    world_C_b_n(0.4, -0.3, 2.5, C);
    world_attitude(C, out);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.4, out[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, -0.3, out[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 2.5, out[2]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(velocity_and_acceleration_are_the_derivatives_of_position);
    RUN_TEST(body_rate_is_the_derivative_of_attitude);
    RUN_TEST(gravity_is_the_gradient_of_its_potential);
    RUN_TEST(increments_integrate_back_to_the_truth_within_a_millimetre_in_ten_minutes);
    RUN_TEST(a_vehicle_at_rest_feels_gravity_and_the_turning_earth_alone);
    RUN_TEST(turns_are_coordinated);
    RUN_TEST(attitude_angles_come_back);
    return UNITY_END();
}

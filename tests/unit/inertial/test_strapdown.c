/* Strapdown against motion known in closed form: attitude and position are sums of sines in a fixed local frame, rate and specific force
 * follow by differentiation, increments by 8-point Gauss quadrature. What is left at the end is the algorithm's error. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/inertial.h"
#include "pelorus/math.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

#define LAT 0.53
#define LON 1.99

/* a0 + a1 t + A sin(w t + p) + B sin(u t + s) */
typedef struct {
    double a0, a1, A, w, p, B, u, s;
} curve_t;

typedef struct {
    curve_t angle[3]; /* roll, pitch, heading */
    curve_t place[3]; /* east, north, up of a fixed local frame */
} motion_t;

static double value(const curve_t *c, double t, int derivative)
{
    switch (derivative) {
    case 0: return c->a0 + c->a1 * t + c->A * sin(c->w * t + c->p) + c->B * sin(c->u * t + c->s);
    case 1: return c->a1 + c->A * c->w * cos(c->w * t + c->p) + c->B * c->u * cos(c->u * t + c->s);
    default: return -c->A * c->w * c->w * sin(c->w * t + c->p) - c->B * c->u * c->u * sin(c->u * t + c->s);
    }
}

/* Local frame to e: constant. */
static void local_frame(double C_l_e[3][3], double origin[3])
{
    double C_e_l[3][3];
    pel_earth_C_e_enu(LAT, LON, C_e_l);
    pel_mat3_transpose(C_e_l, C_l_e);
    pel_earth_llh_to_ecef(LAT, LON, 1500.0, origin);
}

static void truth(const motion_t *m, double t, pel_strapdown_t *s)
{
    double C_l_e[3][3];
    double origin[3];
    double C_b_l[3][3];
    double d[3];
    double v[3];
    double x[3];
    local_frame(C_l_e, origin);
    pel_attitude_to_C_b_enu(value(&m->angle[0], t, 0), value(&m->angle[1], t, 0), value(&m->angle[2], t, 0), C_b_l);
    pel_mat3_mul(C_l_e, C_b_l, s->C_b_e);
    for (int i = 0; i < 3; i++) {
        d[i] = value(&m->place[i], t, 0);
        v[i] = value(&m->place[i], t, 1);
    }
    pel_mat3_vec(C_l_e, d, x);
    pel_mat3_vec(C_l_e, v, s->v_eb_e);
    for (int i = 0; i < 3; i++) { s->r_eb_e[i] = origin[i] + x[i]; }
}

/* omega_ib_b and f_ib_b at t */
static void sensors(const motion_t *m, double t, double omega[3], double f[3])
{
    pel_strapdown_t s;
    double C_l_e[3][3];
    double origin[3];
    truth(m, t, &s);
    local_frame(C_l_e, origin);

    /* body rate against the local frame: roll rate about y, pitch rate about x turned by roll, heading rate about -z turned by both */
    const double roll = value(&m->angle[0], t, 0);
    const double pitch = value(&m->angle[1], t, 0);
    const double dr = value(&m->angle[0], t, 1);
    const double dp = value(&m->angle[1], t, 1);
    const double dh = value(&m->angle[2], t, 1);
    const double mid[3] = {dp, -sin(pitch) * dh, -cos(pitch) * dh}; /* before roll */
    omega[0] = cos(roll) * mid[0] - sin(roll) * mid[2];
    omega[1] = mid[1] + dr;
    omega[2] = sin(roll) * mid[0] + cos(roll) * mid[2];
    const double earth[3] = {0.0, 0.0, PEL_OMEGA_IE};
    double earth_b[3];
    pel_mat3_tvec(s.C_b_e, earth, earth_b);
    for (int i = 0; i < 3; i++) { omega[i] += earth_b[i]; }

    double a_l[3];
    double a_e[3];
    double g[3];
    for (int i = 0; i < 3; i++) { a_l[i] = value(&m->place[i], t, 2); }
    pel_mat3_vec(C_l_e, a_l, a_e);
    pel_earth_gravity_e(s.r_eb_e, g);
    const double f_e[3] = {a_e[0] - g[0] - 2.0 * PEL_OMEGA_IE * s.v_eb_e[1],
                           a_e[1] - g[1] + 2.0 * PEL_OMEGA_IE * s.v_eb_e[0], a_e[2] - g[2]};
    pel_mat3_tvec(s.C_b_e, f_e, f);
}

static void increment(const motion_t *m, double t, double dt, double alpha[3], double upsilon[3])
{
    static const double x[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
    static const double w[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
    memset(alpha, 0, 3 * sizeof alpha[0]);
    memset(upsilon, 0, 3 * sizeof upsilon[0]);
    for (int k = 0; k < 8; k++) {
        const double node = (k & 1) ? -x[k / 2] : x[k / 2];
        double omega[3];
        double f[3];
        sensors(m, t + 0.5 * dt * (1.0 + node), omega, f);
        for (int i = 0; i < 3; i++) {
            alpha[i] += 0.5 * dt * w[k / 2] * omega[i];
            upsilon[i] += 0.5 * dt * w[k / 2] * f[i];
        }
    }
}

typedef struct {
    double angle, v, r; /* norms of the final errors: rad, m/s, m */
    double orthogonal;  /* departure of C'C from I */
} error_t;

/* Run T seconds at a rate; steps whose index is a multiple of `cut` are taken in two unequal pieces. */
static error_t run(const motion_t *m, double T, double rate, int cut)
{
    pel_strapdown_t s = {0};
    pel_strapdown_t end;
    pel_coning_t c;
    const double dt = 1.0 / rate;
    const int n = (int)lround(T * rate);
    truth(m, 0.0, &s);
    pel_coning_init(&c);
    { /* the increment before the start, so that the first step has a predecessor */
        increment(m, -dt, dt, c.alpha, c.upsilon);
        c.dt_s = dt;
    }
    for (int k = 0; k < n; k++) {
        double alpha[3];
        double upsilon[3];
        const double t = (double)k * dt;
        const double part = (cut > 0 && k % cut == 0) ? 0.3 * dt : 0.0;
        if (part > 0.0) {
            increment(m, t, part, alpha, upsilon);
            pel_strapdown_step(&s, &c, alpha, upsilon, part, 0);
        }
        increment(m, t + part, dt - part, alpha, upsilon);
        pel_strapdown_step(&s, &c, alpha, upsilon, dt - part, (pel_time_t)((double)(k + 1) * dt * 1e9));
    }
    truth(m, (double)n * dt, &end);
    double M[3][3];
    double psi[3];
    error_t e = {0};
    double I[3][3];
    pel_mat3_tmul(s.C_b_e, s.C_b_e, I);
    for (int i = 0; i < 9; i++) {
        e.orthogonal = fmax(e.orthogonal, fabs(I[i / 3][i % 3] - ((i % 4 == 0) ? 1.0 : 0.0)));
    }
    pel_mat3_mult(s.C_b_e, end.C_b_e, M);
    pel_dcm_to_rotvec(M, psi);
    e.angle = pel_norm3(psi);
    for (int i = 0; i < 3; i++) {
        end.v_eb_e[i] -= s.v_eb_e[i];
        end.r_eb_e[i] -= s.r_eb_e[i];
    }
    e.v = pel_norm3(end.v_eb_e);
    e.r = pel_norm3(end.r_eb_e);
    return e;
}

/* Roll and pitch half a degree at 10 Hz, a quarter period apart: the classical coning motion. */
static void coning_motion_leaves_an_error_of_fourth_order(void)
{
    const motion_t m = {.angle = {{.A = 0.0087, .w = 62.8}, {.A = 0.0087, .w = 62.8, .p = 1.5708}, {.a0 = 0.7}}};
    const error_t a = run(&m, 20.0, 500.0, 0);
    const error_t b = run(&m, 20.0, 250.0, 0);
    const error_t c = run(&m, 20.0, 125.0, 0);
    const double uncorrected = 0.5 * 62.8 * 0.0087 * 0.0087 * 20.0; /* what the cone's solid angle would add */
    printf("  coning 0.5 deg 10 Hz, 20 s: %.2e, %.2e, %.2e rad at 500, 250, 125 Hz (motion itself %.1e); ratios %.1f, "
           "%.1f\n",
           a.angle, b.angle, c.angle, uncorrected, b.angle / a.angle, c.angle / b.angle);
    TEST_ASSERT_TRUE(a.angle < 2e-6);
    TEST_ASSERT_TRUE(b.angle / a.angle > 12.0);
    TEST_ASSERT_TRUE(c.angle / b.angle > 10.0);
}

/* Roll and lateral motion in phase at 10 Hz: sculling, 1 g of acceleration, half a degree. */
static void sculling_motion_leaves_an_error_of_fourth_order(void)
{
    const motion_t m = {.angle = {{.A = 0.0087, .w = 62.8}, {0}, {.a0 = 0.0}},
                        .place = {{.A = -9.8 / 62.8 / 62.8, .w = 62.8}, {0}, {0}}};
    const error_t a = run(&m, 20.0, 500.0, 0);
    const error_t b = run(&m, 20.0, 250.0, 0);
    const error_t c = run(&m, 20.0, 125.0, 0);
    printf("  sculling 0.5 deg 1 g 10 Hz, 20 s: %.2e, %.2e, %.2e m/s (motion itself %.2f); ratios %.1f, %.1f\n", a.v,
           b.v, c.v, 0.5 * 0.0087 * 9.8 * 20.0, b.v / a.v, c.v / b.v);
    TEST_ASSERT_TRUE(a.v < 1e-4);
    TEST_ASSERT_TRUE(b.v / a.v > 12.0);
    TEST_ASSERT_TRUE(c.v / b.v > 10.0);
}

/* S5 section 10: 139 m/s, small sinusoids of attitude, turning; 500 Hz. */
static void the_survey_flight_stays_below_its_sensors(void)
{
    const motion_t m = {
        .angle = {{.a0 = 0.02, .A = 0.0052, .w = 1.948, .B = 0.3, .u = 0.05},
                  {.A = 0.0035, .w = 1.445, .B = 0.02, .u = 0.03},
                  {.a0 = 1.0, .a1 = 0.02, .A = 0.0026, .w = 1.068}},
        .place = {{.a1 = 100.0, .A = 800.0, .w = 0.05}, {.a1 = -96.0, .A = 500.0, .w = 0.07}, {.A = 40.0, .w = 0.1}}};
    const error_t a = run(&m, 300.0, 500.0, 0);
    const error_t b = run(&m, 300.0, 125.0, 0);
    printf("  survey flight, 300 s free inertial: 500 Hz %.1e rad %.1e m/s %.1e m; 125 Hz %.1e rad %.1e m/s %.1e m; "
           "C'C - I %.0e\n",
           a.angle, a.v, a.r, b.angle, b.v, b.r, a.orthogonal);
    TEST_ASSERT_TRUE(a.angle < 1e-12);
    TEST_ASSERT_TRUE(a.v < 2e-8);
    TEST_ASSERT_TRUE(a.r < 5e-6);
    TEST_ASSERT_TRUE(a.orthogonal < 1e-11);
}

/* Cutting increments at GNSS epochs must not disturb: pieces from the true motion, one step in five cut at 30 %. */
static void cut_increments_lose_little(void)
{
    const motion_t m = {.angle = {{.A = 0.0087, .w = 31.4}, {.A = 0.0087, .w = 31.4, .p = 1.5708}, {.a0 = 0.7}},
                        .place = {{.A = 0.01, .w = 31.4}, {0}, {0}}};
    const error_t whole = run(&m, 10.0, 200.0, 0);
    const error_t cut = run(&m, 10.0, 200.0, 5);
    printf("  every fifth increment cut: %.2e rad %.2e m/s, whole %.2e rad %.2e m/s\n", cut.angle, cut.v, whole.angle,
           whole.v);
    TEST_ASSERT_TRUE(cut.angle < 2.0 * whole.angle + 1e-6);
    TEST_ASSERT_TRUE(cut.v < 2.0 * whole.v + 1e-4);
}

/* Standing still with perfect sensors for an hour: what is left is rounding and gravity's own curvature. */
static void standing_still_stays(void)
{
    const motion_t m = {.angle = {{.a0 = 0.1}, {.a0 = -0.2}, {.a0 = 2.0}}};
    const error_t e = run(&m, 3600.0, 100.0, 0);
    printf("  one hour at rest: %.1e rad %.1e m/s %.1e m\n", e.angle, e.v, e.r);
    TEST_ASSERT_TRUE(e.angle < 1e-11);
    TEST_ASSERT_TRUE(e.r < 1e-3);
}

static void sensor_errors_are_taken_off(void)
{
    const pel_imu_t imu = {.dt_s = 0.01, .alpha_ib_b = {1e-3, 2e-3, 3e-3}, .upsilon_ib_b = {0.1, 0.2, 0.3}};
    const double b_g[3] = {0.01, 0.0, -0.01};
    const double b_a[3] = {0.0, 1.0, 0.0};
    double alpha[3];
    double upsilon[3];
    pel_imu_correct(&imu, b_g, b_a, alpha, upsilon);
    TEST_ASSERT_DOUBLE_WITHIN(1e-18, 9e-4, alpha[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-17, 3.1e-3, alpha[2]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-16, 0.19, upsilon[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(coning_motion_leaves_an_error_of_fourth_order);
    RUN_TEST(sculling_motion_leaves_an_error_of_fourth_order);
    RUN_TEST(the_survey_flight_stays_below_its_sensors);
    RUN_TEST(cut_increments_lose_little);
    RUN_TEST(standing_still_stays);
    RUN_TEST(sensor_errors_are_taken_off);
    return UNITY_END();
}

/* Every H against central differences of the nonlinear measurement. */
/* build: f32 f64 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/math.h"
#include "pelorus/observe.h"
#include "unity.h"

enum { I_PSI = 9, I_V = 12, I_R = 15, N = 18 };

/* The nonlinear model: antenna on a lever, two satellites, double difference of range and range rate. */
typedef struct {
    double C[3][3], v[3], r[3], omega_eb_b[3], lever_b[3];
    double sat[2][3], v_sat[2][3];
} world_t;

static world_t world;

static void antenna(const world_t *w, double r_a[3], double v_a[3])
{
    double arm[3], rate_b[3], rate[3];
    pel_mat3_vec(w->C, w->lever_b, arm);
    pel_cross3(w->omega_eb_b, w->lever_b, rate_b);
    pel_mat3_vec(w->C, rate_b, rate);
    for (int k = 0; k < 3; k++) {
        r_a[k] = w->r[k] + arm[k];
        v_a[k] = w->v[k] + rate[k];
    }
}

static double range(const world_t *w, int s, double u[3])
{
    double r_a[3], v_a[3], d[3];
    antenna(w, r_a, v_a);
    for (int k = 0; k < 3; k++) { d[k] = w->sat[s][k] - r_a[k]; }
    const double rho = pel_norm3(d);
    for (int k = 0; k < 3; k++) { u[k] = d[k] / rho; }
    return rho;
}

static double rate(const world_t *w, int s)
{
    double r_a[3], v_a[3], u[3], dv[3];
    antenna(w, r_a, v_a);
    (void)range(w, s, u);
    for (int k = 0; k < 3; k++) { dv[k] = w->v_sat[s][k] - v_a[k]; }
    return pel_dot3(u, dv);
}

static double dd(const world_t *w, bool of_rate)
{
    double u[3];
    return of_rate ? rate(w, 1) - rate(w, 0) : range(w, 1, u) - range(w, 0, u);
}

/* The world with error e on state i: computed = true + error, C~ = (I + [psi x]) C. */
static world_t perturbed(int i, double e)
{
    world_t w = world;
    if (i >= I_R) {
        w.r[i - I_R] += e;
    } else if (i >= I_V) {
        w.v[i - I_V] += e;
    } else {
        double psi[3] = {0.0, 0.0, 0.0}, turn[3][3];
        psi[i - I_PSI] = e;
        pel_rotvec_to_dcm(psi, turn);
        pel_mat3_mul(turn, world.C, w.C);
    }
    return w;
}

void setUp(void)
{
    const double attitude[3] = {0.3, -0.5, 1.1};
    memset(&world, 0, sizeof world);
    pel_rotvec_to_dcm(attitude, world.C);
    const double r[3] = {-2.2e6, 4.9e6, 3.2e6}, v[3] = {60.0, -110.0, 40.0};
    const double s0[3] = {-1.1e7, 2.1e7, 1.2e7}, s1[3] = {5.0e6, 1.4e7, 2.1e7};
    const double vs0[3] = {1500.0, 900.0, -2600.0}, vs1[3] = {-2700.0, 800.0, 700.0};
    const double lever[3] = {0.6, 1.0, 2.764}, omega[3] = {0.02, -0.1, 0.17};
    for (int k = 0; k < 3; k++) {
        world.r[k] = r[k];
        world.v[k] = v[k];
        world.sat[0][k] = s0[k];
        world.sat[1][k] = s1[k];
        world.v_sat[0][k] = vs0[k];
        world.v_sat[1][k] = vs1[k];
        world.lever_b[k] = lever[k];
        world.omega_eb_b[k] = omega[k];
    }
}

void tearDown(void) {}

static void make_row(bool of_rate, pel_row_t *row)
{
    pel_antenna_t ant = {.n_states = N, .i_psi = I_PSI, .i_v = I_V, .i_r = I_R};
    pel_sd_t sat = {0}, pivot = {0};
    double rate_b[3];
    pel_mat3_vec(world.C, world.lever_b, ant.lever_e);
    pel_cross3(world.omega_eb_b, world.lever_b, rate_b);
    pel_mat3_vec(world.C, rate_b, ant.lever_rate_e);
    (void)range(&world, 0, pivot.u_e);
    (void)range(&world, 1, sat.u_e);
    if (of_rate) {
        pel_observe_rate(&ant, &sat, &pivot, 0.25, row);
    } else {
        pel_observe_range(&ant, &sat, &pivot, 0.25, row);
    }
}

static void check_against_differences(bool of_rate, int first, int last, double tolerance)
{
    pel_row_t row;
    double worst = 0.0;
    make_row(of_rate, &row);
    TEST_ASSERT_EQUAL_INT(I_PSI, row.first);
    TEST_ASSERT_EQUAL_DOUBLE(-0.25, (double)row.z); /* computed - measured */
    for (int i = first; i < last; i++) {
        const double e = (i >= I_V) ? 10.0 : 1e-3;
        const world_t plus = perturbed(i, e), minus = perturbed(i, -e);
        const double slope = (dd(&plus, of_rate) - dd(&minus, of_rate)) / (2.0 * e);
        const double off = fabs(slope - (double)row.h[i]);
        if (off > worst) { worst = off; }
    }
    printf("%s row against central differences: worst %.2e\n", of_rate ? "Doppler" : "range", worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(tolerance, worst);
}

static void range_row_is_the_derivative_of_the_double_difference(void)
{
    check_against_differences(false, I_PSI, N, 2e-6); /* 3 m arm: psi^2 terms and float rounding */
}

static void rate_row_is_the_derivative_of_the_range_rate(void)
{
    /* What is left is how the line of sight turns when psi moves the antenna on its arm: 3 m x 1e-4 /s, dropped on purpose. */
    check_against_differences(true, I_PSI, I_R, 5e-4);
}

/* What the rate row leaves out: how the line of sight turns with position. */
static void rate_row_leaves_out_less_than_a_thousandth_of_a_millimetre_per_second_and_metre(void)
{
    pel_row_t row;
    make_row(true, &row);
    for (int i = I_R; i < N; i++) {
        const world_t plus = perturbed(i, 1.0), minus = perturbed(i, -1.0);
        TEST_ASSERT_LESS_THAN_DOUBLE(5e-4, fabs(dd(&plus, true) - dd(&minus, true)) / 2.0);
        TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)row.h[i]);
    }
}

static void without_attitude_states_the_row_begins_at_position(void)
{
    const pel_antenna_t ant = {.n_states = 6, .i_psi = -1, .i_v = 0, .i_r = 3};
    pel_sd_t sat = {0}, pivot = {0};
    pel_row_t row;
    (void)range(&world, 0, pivot.u_e);
    (void)range(&world, 1, sat.u_e);
    pel_observe_range(&ant, &sat, &pivot, 1.0, &row);
    TEST_ASSERT_EQUAL_INT(3, row.first);
    for (int k = 0; k < 3; k++) { TEST_ASSERT_DOUBLE_WITHIN(1e-7, pivot.u_e[k] - sat.u_e[k], (double)row.h[3 + k]); }
}

/* Height of the antenna against central differences, with and without attitude, with and without a deviation of the reference. */
static void height_row_is_the_derivative_of_the_height(void)
{
    const double up_e[3] = {-0.35, 0.78, 0.52};
    pel_antenna_t ant = {.n_states = N, .i_psi = I_PSI, .i_v = I_V, .i_r = I_R};
    pel_row_t row;
    pel_mat3_vec(world.C, world.lever_b, ant.lever_e);
    pel_observe_height(&ant, up_e, 1.5, 0, &row);
    TEST_ASSERT_EQUAL_INT(I_PSI, row.first);
    TEST_ASSERT_EQUAL_INT(N, row.n);
    TEST_ASSERT_EQUAL_DOUBLE(1.5, (double)row.z);
    TEST_ASSERT_EQUAL_DOUBLE(-1.0, (double)row.h[0]);
    for (int i = I_PSI; i < N; i++) {
        const double e = (i >= I_V) ? 1.0 : 1e-3;
        const world_t plus = perturbed(i, e), minus = perturbed(i, -e);
        double r_plus[3], r_minus[3], v[3];
        antenna(&plus, r_plus, v);
        antenna(&minus, r_minus, v);
        const double slope = (pel_dot3(up_e, r_plus) - pel_dot3(up_e, r_minus)) / (2.0 * e);
        TEST_ASSERT_DOUBLE_WITHIN(2e-6, slope, (double)row.h[i]);
    }

    ant = (pel_antenna_t){.n_states = 6, .i_psi = -1, .i_v = 0, .i_r = 3};
    pel_observe_height(&ant, up_e, -0.5, -1, &row);
    TEST_ASSERT_EQUAL_INT(3, row.first);
    for (int k = 0; k < 3; k++) {
        TEST_ASSERT_EQUAL_DOUBLE(0.0, (double)row.h[k]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-7, up_e[k], (double)row.h[3 + k]);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(range_row_is_the_derivative_of_the_double_difference);
    RUN_TEST(rate_row_is_the_derivative_of_the_range_rate);
    RUN_TEST(rate_row_leaves_out_less_than_a_thousandth_of_a_millimetre_per_second_and_metre);
    RUN_TEST(without_attitude_states_the_row_begins_at_position);
    RUN_TEST(height_row_is_the_derivative_of_the_height);
    return UNITY_END();
}

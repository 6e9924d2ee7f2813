/* The local mechanization against the one in ECEF, on the same increments: two derivations, one path. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/inertial.h"
#include "pelorus/math.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void start_at(double lat_deg, double lon_deg, double v_east, double v_north, pel_strapdown_enu_t *s)
{
    memset(s, 0, sizeof *s);
    pel_attitude_to_C_b_enu(0.05, 0.1, 0.9, s->C_b_enu);
    s->v_eb_enu[0] = v_east;
    s->v_eb_enu[1] = v_north;
    s->lat = lat_deg * PEL_DEG;
    s->lon = lon_deg * PEL_DEG;
    s->h = 1000.0;
}

/* A flight: what a pilot makes the sensors feel. Specific force holds the height about, turns and climbs come and go. */
static void increments(double t, double dt, const pel_strapdown_enu_t *s, double alpha[3], double upsilon[3])
{
    const double a_enu[3] = {2.0 * sin(0.11 * t), 1.5 * cos(0.07 * t), 9.795 + 0.8 * sin(0.23 * t)};
    pel_mat3_tvec(s->C_b_enu, a_enu, upsilon);
    const double rate[3] = {0.03 * sin(0.31 * t), 0.05 * cos(0.17 * t), 0.06 * sin(0.05 * t) + 0.01};
    for (int i = 0; i < 3; i++) {
        upsilon[i] *= dt;
        alpha[i] = rate[i] * dt;
    }
}

/* Differences of two end states. */
typedef struct {
    double position_m, velocity_mps, attitude_rad;
} gap_t;

static gap_t gap(const pel_strapdown_t *a, const pel_strapdown_enu_t *b)
{
    pel_strapdown_t e;
    double d[3], turned[3][3], psi[3];
    gap_t g;
    pel_strapdown_from_enu(b, &e);
    for (int i = 0; i < 3; i++) { d[i] = a->r_eb_e[i] - e.r_eb_e[i]; }
    g.position_m = pel_norm3(d);
    for (int i = 0; i < 3; i++) { d[i] = a->v_eb_e[i] - e.v_eb_e[i]; }
    g.velocity_mps = pel_norm3(d);
    pel_mat3_mult(a->C_b_e, e.C_b_e, turned);
    pel_dcm_to_rotvec(turned, psi);
    g.attitude_rad = pel_norm3(psi);
    return g;
}

/* The pilot flies the true state; both mechanizations start from `enu` and see his increments with sensor errors. */
static gap_t fly(pel_strapdown_enu_t pilot, pel_strapdown_enu_t enu, double seconds, double rate_hz,
                 const double b_g[3], const double b_a[3], pel_strapdown_enu_t *end)
{
    const double dt = 1.0 / rate_hz;
    pel_strapdown_t ecef;
    pel_coning_t c_enu, c_ecef, c_pilot;
    pel_strapdown_from_enu(&enu, &ecef);
    pel_coning_init(&c_enu);
    pel_coning_init(&c_ecef);
    pel_coning_init(&c_pilot);
    for (int k = 0; k < (int)(seconds * rate_hz); k++) {
        double alpha[3], upsilon[3];
        increments(k * dt, dt, &pilot, alpha, upsilon);
        (void)pel_strapdown_enu_step(&pilot, &c_pilot, alpha, upsilon, dt, k + 1);
        for (int i = 0; i < 3; i++) {
            alpha[i] += b_g[i] * dt;
            upsilon[i] += b_a[i] * dt;
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_strapdown_enu_step(&enu, &c_enu, alpha, upsilon, dt, k + 1));
        pel_strapdown_step(&ecef, &c_ecef, alpha, upsilon, dt, k + 1);
    }
    *end = enu;
    return gap(&ecef, &enu);
}

static const double NONE[3] = {0.0, 0.0, 0.0};

static void five_minutes_of_flight_end_at_the_same_place_in_both_frames(void)
{
    pel_strapdown_enu_t s, end;
    start_at(32.0, 118.0, 90.0, 60.0, &s);
    const gap_t at100 = fly(s, s, 300.0, 100.0, NONE, NONE, &end);
    const gap_t at10 = fly(s, s, 300.0, 10.0, NONE, NONE, &end);
    printf("300 s of flight, enu against ECEF: 100 Hz %.1e m, %.1e m/s, %.1e rad; 10 Hz %.1e m\n", at100.position_m,
           at100.velocity_mps, at100.attitude_rad, at10.position_m);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-4, at100.position_m);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-6, at100.velocity_mps);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-10, at100.attitude_rad);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-2, at10.position_m);
}

static void errors_grow_alike_in_both_frames(void)
{
    const double b_g[3] = {2e-6, -3e-6, 5e-6}, b_a[3] = {1e-3, 2e-3, -1e-3};
    pel_strapdown_enu_t s, clean, wrong;
    start_at(32.0, 118.0, 90.0, 60.0, &s);
    (void)fly(s, s, 300.0, 100.0, NONE, NONE, &clean);
    const pel_strapdown_enu_t true_start = s;
    s.lat += 1e-5; /* 64 m */
    s.v_eb_enu[0] += 0.3;
    const double tilt[3] = {1e-3, -1e-3, 2e-3};
    double R[3][3], C[3][3];
    pel_rotvec_to_dcm(tilt, R);
    pel_mat3_mul(R, s.C_b_enu, C);
    memcpy(s.C_b_enu, C, sizeof C);
    const gap_t g = fly(true_start, s, 300.0, 100.0, b_g, b_a, &wrong);
    const double error_m = hypot(wrong.lat - clean.lat, cos(clean.lat) * (wrong.lon - clean.lon)) * 6.371e6;
    printf("after 300 s with errors: %.0f m off the path, frames %.1e m apart\n", error_m, g.position_m);
    TEST_ASSERT_GREATER_THAN_DOUBLE(300.0, error_m);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-4, g.position_m);
}

static void the_date_line_is_crossed_both_ways(void)
{
    for (int side = 0; side < 2; side++) {
        pel_strapdown_enu_t s, end;
        start_at(60.0, side == 0 ? 179.99 : -179.99, side == 0 ? 250.0 : -250.0, 0.0, &s);
        const gap_t g = fly(s, s, 30.0, 100.0, NONE, NONE, &end);
        TEST_ASSERT_LESS_THAN_DOUBLE(1e-4, g.position_m);
        TEST_ASSERT_TRUE(side == 0 ? (end.lon < -3.0) : (end.lon > 3.0));
        TEST_ASSERT_TRUE(end.lon <= PEL_PI && end.lon > -PEL_PI);
    }
}

static void near_a_pole_the_step_is_refused_and_the_state_goes_on_in_ECEF(void)
{
    const double alpha[3] = {0.0, 0.0, 0.0}, upsilon[3] = {0.0, 0.0, 9.83 * 0.01};
    for (int pole = -1; pole <= 1; pole += 2) {
        pel_strapdown_enu_t s;
        pel_strapdown_t e;
        pel_coning_t c;
        pel_status_t status = PEL_OK;
        start_at(88.9999 * pole, 10.0, 100.0, 300.0 * pole, &s);
        pel_coning_init(&c);
        int steps = 0;
        while (status == PEL_OK && steps < 100) {
            const pel_strapdown_enu_t before = s;
            const pel_coning_t c_before = c;
            status = pel_strapdown_enu_step(&s, &c, alpha, upsilon, 0.01, ++steps);
            if (status != PEL_OK) {
                TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
                TEST_ASSERT_EQUAL_MEMORY(&c_before, &c, sizeof c);
            }
        }
        TEST_ASSERT_EQUAL(PEL_E_RANGE, status);
        TEST_ASSERT_GREATER_THAN_INT(1, steps);
        pel_strapdown_from_enu(&s, &e);
        for (int k = 0; k < 60000; k++) { pel_strapdown_step(&e, &c, alpha, upsilon, 0.01, k); }
        TEST_ASSERT_TRUE(isfinite(e.r_eb_e[0]) && isfinite(e.r_eb_e[1]) && isfinite(e.r_eb_e[2]));
        TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_strapdown_to_enu(&(pel_strapdown_t){.r_eb_e = {0, 0, pole * 6.36e6}}, &s));
    }
}

static void a_number_that_is_not_finite_is_refused(void)
{
    const double alpha[3] = {0.0, 0.0, 0.0}, upsilon[3] = {NAN, 0.0, 0.0};
    pel_strapdown_enu_t s;
    pel_coning_t c;
    start_at(10.0, 10.0, 1.0, 1.0, &s);
    pel_coning_init(&c);
    const pel_strapdown_enu_t before = s;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_strapdown_enu_step(&s, &c, alpha, upsilon, 0.01, 1));
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
}

static void a_state_survives_the_change_of_frame(void)
{
    pel_strapdown_enu_t s, back;
    pel_strapdown_t e;
    start_at(-47.0, -179.5, 120.0, -80.0, &s);
    pel_strapdown_from_enu(&s, &e);
    TEST_ASSERT_EQUAL(PEL_OK, pel_strapdown_to_enu(&e, &back));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, s.lat, back.lat);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, s.lon, back.lon);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, s.h, back.h);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, s.v_eb_enu[i], back.v_eb_enu[i]);
        for (int j = 0; j < 3; j++) { TEST_ASSERT_DOUBLE_WITHIN(1e-15, s.C_b_enu[i][j], back.C_b_enu[i][j]); }
    }
}

static void numbers_of_the_state_that_are_not_finite_are_refused(void)
{
    static const size_t MEMBERS[] = {
        offsetof(pel_strapdown_enu_t, lat),         offsetof(pel_strapdown_enu_t, lon),
        offsetof(pel_strapdown_enu_t, h),           offsetof(pel_strapdown_enu_t, v_eb_enu),
        offsetof(pel_strapdown_enu_t, v_eb_enu[1]), offsetof(pel_strapdown_enu_t, v_eb_enu[2])};
    static const double BAD[] = {NAN, INFINITY, -INFINITY};
    const double alpha[3] = {0.0, 0.0, 0.0}, upsilon[3] = {0.0, 0.0, 0.098};
    for (int i = 0; i < 18; i++) {
        pel_strapdown_enu_t s;
        pel_coning_t c;
        start_at(10.0, 10.0, 1.0, 1.0, &s);
        pel_coning_init(&c);
        memcpy((uint8_t *)&s + MEMBERS[i / 3], &BAD[i % 3], sizeof BAD[0]);
        const pel_strapdown_enu_t before = s;
        const pel_coning_t coning = c;
        TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_strapdown_enu_step(&s, &c, alpha, upsilon, 0.01, 1));
        TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
        TEST_ASSERT_EQUAL_MEMORY(&coning, &c, sizeof c);
    }
}

static void a_height_beyond_the_largest_number_is_refused(void)
{
    const double alpha[3] = {0.0, 0.0, 0.0}, upsilon[3] = {0.0, 0.0, 0.098};
    pel_strapdown_enu_t s;
    pel_coning_t c;
    start_at(10.0, 10.0, 0.0, 0.0, &s);
    pel_coning_init(&c);
    s.h = 1.79e308;
    s.v_eb_enu[2] = 1e306;
    const pel_strapdown_enu_t before = s;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_strapdown_enu_step(&s, &c, alpha, upsilon, 1.0, 1));
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(five_minutes_of_flight_end_at_the_same_place_in_both_frames);
    RUN_TEST(errors_grow_alike_in_both_frames);
    RUN_TEST(the_date_line_is_crossed_both_ways);
    RUN_TEST(near_a_pole_the_step_is_refused_and_the_state_goes_on_in_ECEF);
    RUN_TEST(a_number_that_is_not_finite_is_refused);
    RUN_TEST(a_state_survives_the_change_of_frame);
    RUN_TEST(numbers_of_the_state_that_are_not_finite_are_refused);
    RUN_TEST(a_height_beyond_the_largest_number_is_refused);
    return UNITY_END();
}

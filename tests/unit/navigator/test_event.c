/* Exterior orientation at event marks: the interpolation table of S5 section 12, Hermite at 100 Hz. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "unity.h"

#define ARCSEC (PEL_PI / 180.0 / 3600.0)
#define T0     (INT64_C(1300000000) * PEL_NS_PER_S)

static pel_navigator_t nav;

void setUp(void)
{
    pel_nav_config_t cfg;
    pel_nav_config_default(&cfg);
    pel_navigator_init(&nav, &cfg);
    nav.ins = true;
}

void tearDown(void) {}

/* 0.3 deg at 0.31 Hz + 20" at 1.7 Hz + 6" at 7 Hz + 1" at 23 Hz about x; half of it about y. */
static double angle(double t)
{
    return 0.3 * PEL_DEG * sin(2 * PEL_PI * 0.31 * t) + 20 * ARCSEC * sin(2 * PEL_PI * 1.7 * t + 1.0) +
           6 * ARCSEC * sin(2 * PEL_PI * 7.0 * t + 2.0) + 1 * ARCSEC * sin(2 * PEL_PI * 23.0 * t + 3.0);
}

/* The truth is given in the Earth's frame with C_b_e a rotation about one fixed axis, so that increments are exact. */
static void pose(double t, pel_strapdown_t *s)
{
    const double v[3] = {angle(t) * 0.8, angle(t) * 0.6, 0.0};
    memset(s, 0, sizeof *s);
    s->t_ns = T0 + (int64_t)llround(t * 1e9);
    pel_rotvec_to_dcm(v, s->C_b_e);
    s->r_eb_e[0] = 6378137.0 + 30.0 * sin(0.5 * t);
    s->r_eb_e[1] = 139.0 * t;
    s->v_eb_e[0] = 15.0 * cos(0.5 * t);
    s->v_eb_e[1] = 139.0;
}

static void fly_to(double from, double to)
{
    const double h = 0.002;
    for (double t = from + h; t < to + 0.5 * h; t += h) {
        pose(t, &nav.now);
        const double d = angle(t) - angle(t - h);
        double alpha[3] = {0.8 * d, 0.6 * d, 0.0}, earth[3];
        const double omega[3] = {0.0, 0.0, PEL_OMEGA_IE * h};
        pel_mat3_tvec(nav.now.C_b_e, omega, earth); /* gyros feel the Earth turn too */
        for (int k = 0; k < 3; k++) { alpha[k] += earth[k]; }
        pel_nav_keep_pose(&nav, alpha);
        pel_nav_serve_event(&nav);
    }
}

static void hermite_at_100_hz_is_within_its_published_error(void)
{
    double worst_arcsec = 0.0, worst_mm = 0.0, sum = 0.0;
    int n = 0;
    fly_to(0.0, 1.0);
    for (int i = 0; i < 400; i++) {
        const double t = 1.0 + 0.038 * i;
        pel_navigator_push_event(&nav, T0 + (int64_t)llround((t - 0.0213) * 1e9), (uint32_t)i);
        fly_to(t, t + 0.038);
        if (pel_navigator_poll(&nav) != PEL_NAV_EVENT) { continue; }
        pel_strapdown_t truth;
        pose(t - 0.0213, &truth);
        double C_enu[3][3], C[3][3];
        pel_earth_C_e_enu(nav.event.lat_rad, nav.event.lon_rad, C_enu);
        pel_mat3_mul(C_enu, truth.C_b_e, C);
        const double off[3] = {(double)nav.event.omega_rad - atan2(-C[1][2], C[2][2]),
                               (double)nav.event.phi_rad - asin(C[0][2]),
                               (double)nav.event.kappa_rad - atan2(-C[0][1], C[0][0])};
        for (int k = 0; k < 3; k++) {
            worst_arcsec = fmax(worst_arcsec, fabs(off[k]) / ARCSEC);
            worst_mm = fmax(worst_mm, 1e3 * fabs(nav.event.r_ec_e[k] - truth.r_eb_e[k]));
            sum += off[k] * off[k] / ARCSEC / ARCSEC;
        }
        n++;
    }
    printf("Hermite at 100 Hz: %d events, rms %.4f arcsec, max %.4f arcsec, position max %.4f mm\n", n,
           sqrt(sum / 3 / n), worst_arcsec, worst_mm);
    TEST_ASSERT_GREATER_THAN_INT(390, n);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.05, worst_arcsec); /* 0.02 of interpolation + float radians near pi/2 */
    TEST_ASSERT_LESS_THAN_DOUBLE(0.01, worst_mm);
}

static void an_event_older_than_the_ring_is_refused_and_counted(void)
{
    fly_to(0.0, 5.0);
    pel_navigator_push_event(&nav, T0 + 2 * PEL_NS_PER_S, 7);
    TEST_ASSERT_EQUAL_INT(PEL_NAV_NONE, pel_navigator_poll(&nav));
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.events_refused);
}

static void an_event_two_seconds_late_is_still_served(void)
{
    fly_to(0.0, 5.0);
    pel_navigator_push_event(&nav, T0 + 3 * PEL_NS_PER_S, 7);
    TEST_ASSERT_EQUAL_INT(PEL_NAV_EVENT, pel_navigator_poll(&nav));
    TEST_ASSERT_EQUAL_UINT32(7, nav.event.id);
}

static void an_event_that_comes_while_another_waits_takes_its_place(void)
{
    fly_to(0.0, 1.0);
    pel_navigator_push_event(&nav, T0 + 1010 * PEL_NS_PER_MS, 1); /* poses are still to come */
    TEST_ASSERT_TRUE(nav.event_waiting);
    pel_navigator_push_event(&nav, T0 + 1020 * PEL_NS_PER_MS, 2);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.events_refused);
    fly_to(1.0, 1.1);
    TEST_ASSERT_EQUAL_INT(PEL_NAV_EVENT, pel_navigator_poll(&nav));
    TEST_ASSERT_EQUAL_UINT32(2, nav.event.id);
    TEST_ASSERT_EQUAL_UINT32(1, nav.counters.events);
}

/* Its sigma and status are those of the newest solution, which without an output rate is that of the epoch. */
static void an_event_has_the_sigma_of_the_newest_solution(void)
{
    for (int predicted = 0; predicted < 2; predicted++) {
        setUp();
        fly_to(0.0, 1.0);
        nav.solution.t_ns = T0 + (predicted ? 950 : 800) * PEL_NS_PER_MS;
        nav.solution.fix = PEL_FIX_FLOAT;
        nav.solution.cov_r_ned[0] = 4.0f;
        nav.epoch_solution.t_ns = T0 + 900 * PEL_NS_PER_MS;
        nav.epoch_solution.fix = PEL_FIX_FIXED;
        nav.epoch_solution.cov_r_ned[0] = 9.0f;
        pel_navigator_push_event(&nav, T0 + 500 * PEL_NS_PER_MS, 1);
        TEST_ASSERT_EQUAL_INT(PEL_NAV_EVENT, pel_navigator_poll(&nav));
        TEST_ASSERT_EQUAL_FLOAT(predicted ? 2.0f : 3.0f, nav.event.sd_r_m[0]);
        TEST_ASSERT_EQUAL_INT(predicted ? PEL_FIX_FLOAT : PEL_FIX_FIXED, nav.event.fix);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(hermite_at_100_hz_is_within_its_published_error);
    RUN_TEST(an_event_older_than_the_ring_is_refused_and_counted);
    RUN_TEST(an_event_two_seconds_late_is_still_served);
    RUN_TEST(an_event_that_comes_while_another_waits_takes_its_place);
    RUN_TEST(an_event_has_the_sigma_of_the_newest_solution);
    return UNITY_END();
}

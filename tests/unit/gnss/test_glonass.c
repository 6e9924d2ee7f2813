/* Orbits broadcast as a state vector: the integration against what no integrator knows (energy, its own reverse, slopes). */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unity.h>

#include "pelorus/gnss.h"

#define T0 (INT64_C(1223121600) * PEL_NS_PER_S)

void setUp(void) {}
void tearDown(void) {}

/* A circular orbit of 11 h 15 min, inclined by 64.8 degrees, in axes that turn. */
static pel_ephemeris_t glonass(double u)
{
    const double r = 25508e3, i = 1.131, omega = 7.292115e-5;
    const double v = sqrt(3.986004418e14 / r);
    pel_ephemeris_t e;
    memset(&e, 0, sizeof e);
    e.sys = PEL_SYS_GLO;
    e.prn = 4;
    e.toe_ns = e.toc_ns = T0;
    e.af0 = 3e-5;
    e.af1 = 1.8e-12;
    e.tgd_s[0] = 4e-9;
    e.sd_ura_m = 4.0f;
    e.glo.k = 6;
    e.glo.r_e[0] = r * cos(u);
    e.glo.r_e[1] = r * sin(u) * cos(i);
    e.glo.r_e[2] = r * sin(u) * sin(i);
    e.glo.v_e[0] = -v * sin(u) + omega * e.glo.r_e[1];
    e.glo.v_e[1] = v * cos(u) * cos(i) - omega * e.glo.r_e[0];
    e.glo.v_e[2] = v * cos(u) * sin(i);
    return e;
}

/* Jacobi's integral: constant along the orbit when only the turning, flattened Earth attracts. */
static double energy(const double r[3], const double v[3])
{
    const double mu = 3.986004418e14, j2 = 1.08262575e-3, a = 6378136.0, w = 7.292115e-5;
    const double d = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    const double s = r[2] / d;
    const double U = mu / d * (1.0 - j2 * (a / d) * (a / d) * 0.5 * (3.0 * s * s - 1.0));
    return 0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) - 0.5 * w * w * (r[0] * r[0] + r[1] * r[1]) - U;
}

static void energy_is_kept(void)
{
    double worst = 0.0;
    for (int k = 0; k < 12; k++) {
        const pel_ephemeris_t e = glonass(0.5 * k);
        const double before = energy(e.glo.r_e, e.glo.v_e);
        for (double tk = -3600.0; tk <= 3600.0; tk += 450.0) {
            pel_sat_state_t s;
            TEST_ASSERT_EQUAL(PEL_OK, pel_sat_state(&e, T0, tk, &s));
            worst = fmax(worst, fabs(energy(s.r_e, s.v_e) - before));
        }
    }
    printf("energy after an hour: %.1e m^2/s^2 (1 mm of height is 6e-4)\n", worst);
    TEST_ASSERT_TRUE(worst < 6e-4);
}

static void there_and_back_is_the_same_place(void)
{
    double worst = 0.0;
    for (int k = 0; k < 12; k++) {
        const pel_ephemeris_t e = glonass(0.5 * k);
        pel_ephemeris_t there = e;
        pel_sat_state_t s;
        TEST_ASSERT_EQUAL(PEL_OK, pel_sat_state(&e, T0, 1777.7, &s));
        memcpy(there.glo.r_e, s.r_e, sizeof s.r_e);
        memcpy(there.glo.v_e, s.v_e, sizeof s.v_e);
        TEST_ASSERT_EQUAL(PEL_OK, pel_sat_state(&there, T0, -1777.7, &s));
        for (int c = 0; c < 3; c++) { worst = fmax(worst, fabs(s.r_e[c] - e.glo.r_e[c])); }
    }
    printf("half an hour there and back: %.1e m\n", worst);
    TEST_ASSERT_TRUE(worst < 2e-3);
}

/* The slope is taken across a boundary of steps too. */
static void velocity_and_clock_rate_are_slopes(void)
{
    double worst = 0.0;
    for (int k = 0; k < 60; k++) {
        pel_ephemeris_t e = glonass(0.1 * k);
        e.glo.a_e[0] = 2e-6;
        e.glo.a_e[2] = -1e-6;
        const double h = 4.0, at = 37.0 * k - 1000.0;
        pel_sat_state_t s[5];
        for (int j = 0; j < 5; j++) { TEST_ASSERT_EQUAL(PEL_OK, pel_sat_state(&e, T0, at + h * (j - 2), &s[j])); }
        for (int c = 0; c < 3; c++) {
            const double slope = (8.0 * (s[3].r_e[c] - s[1].r_e[c]) - (s[4].r_e[c] - s[0].r_e[c])) / (12.0 * h);
            worst = fmax(worst, fabs(slope - s[2].v_e[c]));
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-18, e.af0 + e.af1 * at, s[2].clk_s);
        TEST_ASSERT_DOUBLE_WITHIN(1e-25, e.af1, s[2].clk_rate);
    }
    printf("velocity against slope of position: %.1e m/s\n", worst);
    TEST_ASSERT_TRUE(worst < 5e-6); /* what the last, shorter step of a minute leaves */
}

static void an_ephemeris_serves_half_an_hour(void)
{
    static pel_orbits_t o;
    const pel_ephemeris_t e = glonass(1.0);
    pel_orbits_init(&o);
    TEST_ASSERT_EQUAL(PEL_OK, pel_orbits_add(&o, &e));
    TEST_ASSERT_NOT_NULL(pel_orbits_find(&o, PEL_SYS_GLO, 4, T0 + 1790 * PEL_NS_PER_S));
    TEST_ASSERT_NULL(pel_orbits_find(&o, PEL_SYS_GLO, 4, T0 + 1810 * PEL_NS_PER_S));
    TEST_ASSERT_NULL(pel_orbits_find(&o, PEL_SYS_GLO, 5, T0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, pel_sat_group_delay_m(&e, PEL_CARRIER_L1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 4e-9 * PEL_SPEED_OF_LIGHT, pel_sat_group_delay_m(&e, PEL_CARRIER_L2));
}

static void what_no_satellite_has_is_refused(void)
{
    static pel_orbits_t o;
    pel_sat_state_t s;
    pel_orbits_init(&o);
    for (int k = 0; k < 9; k++) {
        pel_ephemeris_t e = glonass(1.0);
        switch (k) {
        case 0: e.glo.r_e[1] = (double)NAN; break;
        case 1: e.glo.v_e[0] = 9000.0; break;
        case 2: e.glo.a_e[2] = 1.0; break;
        case 3: e.glo.k = 7; break;
        case 4: e.glo.r_e[0] *= 3.0; break;
        case 5: e.af0 = 1.0; break;
        case 6: e.af1 = (double)NAN; break;
        case 7: e.prn = 33; break;
        default: e.tgd_s[0] = 1e-3; break;
        }
        TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_orbits_add(&o, &e));
    }
    const pel_ephemeris_t e = glonass(1.0);
    memset(&s, 0x55, sizeof s);
    const pel_sat_state_t before = s;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_sat_state(&e, T0, 3601.0, &s));
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_sat_state(&e, T0, (double)NAN, &s));
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(energy_is_kept);
    RUN_TEST(there_and_back_is_the_same_place);
    RUN_TEST(velocity_and_clock_rate_are_slopes);
    RUN_TEST(an_ephemeris_serves_half_an_hour);
    RUN_TEST(what_no_satellite_has_is_refused);
    return UNITY_END();
}

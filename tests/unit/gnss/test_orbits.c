/* The store of ephemerides: what it keeps, what it refuses, which one it gives. Positions are held against RTKLIB in
 * tests/peers/test_gnss_orbits.py; here what a peer cannot show. */
/* build: f32 f64 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "support_gnss.h"
#include "unity.h"

static pel_orbits_t sky;
static pel_orbits_t o;

void setUp(void)
{
    sky_init(&sky);
    pel_orbits_init(&o);
}
void tearDown(void) {}

static pel_ephemeris_t at_hour(double hours)
{
    pel_ephemeris_t e = sky.eph[0];
    e.toe_ns += (int64_t)(hours * 3600e9);
    e.toc_ns = e.toe_ns;
    return e;
}

static void the_nearest_toe_within_its_fit_is_found(void)
{
    pel_ephemeris_t e = at_hour(0);
    TEST_ASSERT_EQUAL(PEL_OK, pel_orbits_add(&o, &e));
    e = at_hour(2);
    TEST_ASSERT_EQUAL(PEL_OK, pel_orbits_add(&o, &e));
    TEST_ASSERT_EQUAL_INT64(SKY_T0, pel_orbits_find(&o, 0, 1, SKY_T0 + 3500 * PEL_NS_PER_S)->toe_ns);
    TEST_ASSERT_EQUAL_INT64(e.toe_ns, pel_orbits_find(&o, 0, 1, SKY_T0 + 3700 * PEL_NS_PER_S)->toe_ns);
    TEST_ASSERT_NULL(pel_orbits_find(&o, 0, 1, SKY_T0 + 5 * 3600 * PEL_NS_PER_S));
    TEST_ASSERT_NULL(pel_orbits_find(&o, 0, 2, SKY_T0));
    TEST_ASSERT_NULL(pel_orbits_find(&o, 2, 1, SKY_T0));
}

static void a_stated_fit_interval_is_obeyed(void)
{
    pel_ephemeris_t e = at_hour(0);
    e.fit_s = 14400.0f;
    (void)pel_orbits_add(&o, &e);
    TEST_ASSERT_NOT_NULL(pel_orbits_find(&o, 0, 1, SKY_T0 + 14000 * PEL_NS_PER_S));
    TEST_ASSERT_NULL(pel_orbits_find(&o, 0, 1, SKY_T0 + 15100 * PEL_NS_PER_S));
}

static void two_generations_are_kept_and_the_same_one_is_replaced(void)
{
    for (int k = 0; k < 5; k++) {
        const pel_ephemeris_t e = at_hour(2.0 * k);
        (void)pel_orbits_add(&o, &e);
        (void)pel_orbits_add(&o, &e);
    }
    TEST_ASSERT_EQUAL(2, o.n);
    TEST_ASSERT_NOT_NULL(pel_orbits_find(&o, 0, 1, SKY_T0 + 8 * 3600 * PEL_NS_PER_S));
    TEST_ASSERT_NOT_NULL(pel_orbits_find(&o, 0, 1, SKY_T0 + 5 * 3600 * PEL_NS_PER_S));
}

static void of_galileos_two_messages_one_is_kept(void)
{
    pel_ephemeris_t e = at_hour(0);
    e.sys = PEL_SYS_GAL;
    e.source = 1;
    (void)pel_orbits_add(&o, &e);
    TEST_ASSERT_EQUAL(1, pel_orbits_find(&o, PEL_SYS_GAL, 1, SKY_T0)->source);
    e.source = 0;
    (void)pel_orbits_add(&o, &e);
    TEST_ASSERT_EQUAL(0, pel_orbits_find(&o, PEL_SYS_GAL, 1, SKY_T0)->source);
    e.source = 1;
    (void)pel_orbits_add(&o, &e);
    TEST_ASSERT_EQUAL(1, o.n);
    TEST_ASSERT_EQUAL(0, pel_orbits_find(&o, PEL_SYS_GAL, 1, SKY_T0)->source);
}

static void a_full_store_gives_up_old_generations_first(void)
{
    for (int k = 0; k < PEL_MAX_EPH / 2; k++) { /* two generations each fill it */
        for (int g = 0; g < 2; g++) {
            pel_ephemeris_t e = at_hour(2 * g);
            e.sys = (uint8_t)((k < 32) ? PEL_SYS_GPS : PEL_SYS_BDS);
            e.prn = (uint8_t)(1 + k % 32);
            (void)pel_orbits_add(&o, &e);
        }
    }
    TEST_ASSERT_EQUAL(PEL_MAX_EPH, o.n);
    for (int k = 0; k < 20; k++) {
        pel_ephemeris_t e = at_hour(0);
        e.sys = PEL_SYS_GAL;
        e.prn = (uint8_t)(1 + k);
        TEST_ASSERT_EQUAL(PEL_OK, pel_orbits_add(&o, &e));
    }
    TEST_ASSERT_EQUAL(PEL_MAX_EPH, o.n);
    for (int k = 0; k < 20; k++) { TEST_ASSERT_NOT_NULL(pel_orbits_find(&o, PEL_SYS_GAL, (uint8_t)(1 + k), SKY_T0)); }
    for (int k = 0; k < 32; k++) {
        TEST_ASSERT_NOT_NULL(pel_orbits_find(&o, PEL_SYS_GPS, (uint8_t)(1 + k), SKY_T0 + 7200 * PEL_NS_PER_S));
    }
}

static void impossible_elements_are_refused(void)
{
    const double bad[] = {NAN, INFINITY, -INFINITY, 1e9};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        pel_ephemeris_t e[8];
        for (int k = 0; k < 8; k++) { e[k] = at_hour(0); }
        e[0].sqrt_a = bad[i];
        e[1].e = bad[i];
        e[2].M0 = bad[i];
        e[3].af0 = bad[i];
        e[4].dn = bad[i];
        e[5].tgd_s[0] = bad[i];
        e[6].i0 = bad[i];
        e[7].Omega0 = bad[i];
        for (int k = 0; k < 8; k++) { TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_orbits_add(&o, &e[k])); }
    }
    pel_ephemeris_t e = at_hour(0);
    e.prn = 33;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_orbits_add(&o, &e));
    e = at_hour(0);
    e.sys = PEL_SYS_GLO;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_orbits_add(&o, &e));
    TEST_ASSERT_EQUAL(0, o.n);
}

static void velocity_is_the_slope_of_position_for_every_kind_of_orbit(void)
{
    double worst = 0.0;
    for (int i = 0; i < sky.n; i++) {
        const double h = 4.0;
        pel_sat_state_t s[5];
        for (int k = 0; k < 5; k++) {
            TEST_ASSERT_EQUAL(PEL_OK, pel_sat_state(&sky.eph[i], SKY_T0 + 777 * PEL_NS_PER_S, h * (k - 2), &s[k]));
        }
        for (int c = 0; c < 3; c++) {
            const double slope = (8.0 * (s[3].r_e[c] - s[1].r_e[c]) - (s[4].r_e[c] - s[0].r_e[c])) / (12.0 * h);
            worst = fmax(worst, fabs(slope - s[2].v_e[c]));
        }
    }
    printf("velocity against slope of position: %.1e m/s\n", worst);
    TEST_ASSERT_TRUE(worst < 1e-7);
}

static void eccentric_orbits_converge_within_the_bound(void)
{
    pel_ephemeris_t e = at_hour(0);
    pel_sat_state_t s;
    for (e.e = 0.0; e.e < 0.5; e.e += 0.01) {
        for (e.M0 = -3.2; e.M0 < 3.2; e.M0 += 0.05) { TEST_ASSERT_EQUAL(PEL_OK, pel_sat_state(&e, SKY_T0, 0.0, &s)); }
    }
    e.e = 0.7;
    const pel_sat_state_t before = s;
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_sat_state(&e, SKY_T0, 0.0, &s));
    TEST_ASSERT_EQUAL_MEMORY(&before, &s, sizeof s);
}

static void group_delays_belong_to_their_clocks(void)
{
    const double c = PEL_SPEED_OF_LIGHT;
    const double g2 = (77.0 / 60.0) * (77.0 / 60.0);
    const double g5 = (154.0 / 115.0) * (154.0 / 115.0);
    const double g7 = (154.0 / 118.0) * (154.0 / 118.0);
    pel_ephemeris_t e = at_hour(0);
    e.tgd_s[0] = 5e-9;
    e.tgd_s[1] = 7e-9;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, c * 5e-9, pel_sat_group_delay_m(&e, PEL_CARRIER_L1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, c * 5e-9 * g2, pel_sat_group_delay_m(&e, PEL_CARRIER_L2));

    /* The ionosphere-free pair of a clock is free of delay: P1 g - P2 (g = ratio) has delay tau1 g - tau2 = 0. */
    e.sys = PEL_SYS_GAL;
    e.source = 0;
    const double b1 = pel_sat_group_delay_m(&e, PEL_CARRIER_L1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, c * 7e-9, b1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, b1 * g7 - pel_sat_group_delay_m(&e, PEL_CARRIER_E5B));
    e.source = 1;
    const double a1 = pel_sat_group_delay_m(&e, PEL_CARRIER_L1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, c * 5e-9, a1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, a1 * g5 - pel_sat_group_delay_m(&e, PEL_CARRIER_L5));

    e.sys = PEL_SYS_BDS;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, c * 5e-9, pel_sat_group_delay_m(&e, PEL_CARRIER_B1I));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, c * 7e-9, pel_sat_group_delay_m(&e, PEL_CARRIER_E5B));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, pel_sat_group_delay_m(&e, PEL_CARRIER_B3I));
    e.prn = 30; /* BeiDou-3 */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, c * 5e-9, pel_sat_group_delay_m(&e, PEL_CARRIER_L1));
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.0, pel_sat_group_delay_m(&e, PEL_CARRIER_E5B));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_nearest_toe_within_its_fit_is_found);
    RUN_TEST(a_stated_fit_interval_is_obeyed);
    RUN_TEST(two_generations_are_kept_and_the_same_one_is_replaced);
    RUN_TEST(of_galileos_two_messages_one_is_kept);
    RUN_TEST(a_full_store_gives_up_old_generations_first);
    RUN_TEST(impossible_elements_are_refused);
    RUN_TEST(velocity_is_the_slope_of_position_for_every_kind_of_orbit);
    RUN_TEST(eccentric_orbits_converge_within_the_bound);
    RUN_TEST(group_delays_belong_to_their_clocks);
    return UNITY_END();
}

/* Single-point solutions of simulated receivers whose truth is known, and of bad input. */
/* build: f32 f64 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support_gnss.h"
#include "unity.h"

#define ALL ((1u << PEL_SYS_GPS) | (1u << PEL_SYS_GAL) | (1u << PEL_SYS_BDS))
#define GPS (1u << PEL_SYS_GPS)

static pel_orbits_t o;
static pel_epoch_t e;
static pel_view_t view;
static pel_spp_config_t cfg;
static pel_nav_counters_t count;
static pel_spp_t out;

void setUp(void)
{
    sky_init(&o);
    pel_spp_default(&cfg);
    memset(&count, 0, sizeof count);
    memset(&out, 0, sizeof out);
}
void tearDown(void) {}

static double distance(const double a[3], const double b[3])
{
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void a_receiver_at_rest_is_found_from_the_earths_centre(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0 + 600 * PEL_NS_PER_S, ALL, &e);
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    printf("at rest: %d satellites, position %.1e m, velocity %.1e m/s, time %lld ns\n", out.n_used,
           distance(out.r_ea_e, s.r_e), distance(out.v_ea_e, s.v_e),
           (long long)(out.t_ns - SKY_T0 - 600 * PEL_NS_PER_S));
    TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 1e-3);
    TEST_ASSERT_TRUE(distance(out.v_ea_e, s.v_e) < 1e-4); /* Dopplers are float */
    TEST_ASSERT_TRUE(llabs(out.t_ns - SKY_T0 - 600 * PEL_NS_PER_S) <= 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, s.clk_rate_mps, out.clk_rate_mps);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.0, out.isb_m[PEL_SYS_BDS]);
    TEST_ASSERT_EQUAL(0, out.n_excluded);
    TEST_ASSERT_EQUAL(view.n, out.n_used);
}

static void a_fast_receiver_with_a_bad_clock_is_placed_at_the_true_instant(void)
{
    scene_t s = scene_default();
    s.v_e[0] = 120.0;
    s.v_e[1] = -180.0;
    s.v_e[2] = 90.0;
    s.clk_m = 2.5e6; /* 8.3 ms */
    scene_observe(&s, &o, SKY_T0, ALL, &e);
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    printf("240 m/s, 8 ms: position %.1e m, velocity %.1e m/s\n", distance(out.r_ea_e, s.r_e),
           distance(out.v_ea_e, s.v_e));
    TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 1e-3);
    TEST_ASSERT_TRUE(distance(out.v_ea_e, s.v_e) < 1e-4);
    TEST_ASSERT_TRUE(llabs(out.t_ns - SKY_T0) <= 1);
}

static void bad_observations_are_as_if_absent(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    e.obs[0].P_m = (double)NAN;
    e.obs[1].P_m = (double)INFINITY;
    e.obs[2].P_m = -2.3e7;
    e.obs[3].prn = 200;
    e.obs[4].D_hz = NAN;
    e.obs[5].L_cyc = (double)NAN;
    e.obs[7].sys = 99;
    e.obs[9].carrier = 77;
    e.obs[e.n] = e.obs[6]; /* the same satellite again */
    e.n++;
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 1e-3);
    TEST_ASSERT_TRUE(distance(out.v_ea_e, s.v_e) < 1e-4);
}

static void too_few_satellites_leave_the_output_alone(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    e.n = 6; /* two carriers of three satellites */
    const pel_spp_t before = out;
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_EQUAL_MEMORY(&before, &out, sizeof out);
    e.n = 0;
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    e.n = 8;
    for (int i = 0; i < 8; i++) { e.obs[i] = e.obs[0]; } /* one satellite eight times */
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
}

static void unhealthy_unknown_and_low_satellites_are_counted(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    const int seen = e.n / 2;
    for (int i = 0; i < o.n; i++) {
        if (o.eph[i].sys == e.obs[0].sys && o.eph[i].prn == e.obs[0].prn) { o.eph[i].health = 1; }
        if (o.eph[i].sys == e.obs[2].sys && o.eph[i].prn == e.obs[2].prn) { o.eph[i].toe_ns -= 86400 * PEL_NS_PER_S; }
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_EQUAL(1, count.sats_unhealthy);
    TEST_ASSERT_EQUAL(1, count.sats_no_eph);
    TEST_ASSERT_EQUAL(seen - 2, out.n_used);

    memset(&count, 0, sizeof count);
    TEST_ASSERT_EQUAL(PEL_OK, pel_view_compute(&e, &o, e.t_ns, s.r_e, NULL, 0.7, &count, &view));
    TEST_ASSERT_TRUE(count.sats_low > 0);
    TEST_ASSERT_EQUAL(seen - 2, view.n + (int)count.sats_low);
}

static void faults_are_excluded_three_at_most(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, ALL, &e);
    TEST_ASSERT_TRUE(e.n / 2 >= 12);
    for (int faults = 1; faults <= 3; faults++) {
        for (int k = 0; k < 2; k++) { e.obs[6 * (faults - 1) + k].P_m += 150.0 * faults; }
        memset(&count, 0, sizeof count);
        TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
        TEST_ASSERT_EQUAL(faults, out.n_excluded);
        TEST_ASSERT_EQUAL(faults, count.sats_excluded);
        TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 1e-3);
        TEST_ASSERT_TRUE(pel_view_find(&view, e.obs[0].sys, e.obs[0].prn)->excluded);
    }
    for (int k = 0; k < 2; k++) { e.obs[20 + k].P_m -= 600.0; }
    TEST_ASSERT_EQUAL(PEL_W_REJECTED, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_TRUE(sqrt(out.cov_r_e[0][0]) > 20.0); /* and says so */
}

static void one_wrong_doppler_does_not_move_the_velocity(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    e.obs[4].D_hz += 300.0f;
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_TRUE(out.has_velocity);
    TEST_ASSERT_TRUE(distance(out.v_ea_e, s.v_e) < 1e-4);
}

static void a_clock_between_systems_is_solved_for(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, ALL, &e);
    for (int i = 0; i < e.n; i++) {
        if (e.obs[i].sys == PEL_SYS_BDS) { e.obs[i].P_m += 1234.5; }
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 1234.5, out.isb_m[PEL_SYS_BDS]);
    TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 1e-2);
}

/* Two clocks would ask for five. */
static void four_satellites_of_gps_and_qzss_are_a_position(void)
{
    const scene_t s = scene_default();
    static pel_epoch_t four;
    int qzss = 0;
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    gnss_hand_some_to_qzss(&o, &e);
    memset(&four, 0, sizeof four);
    four.t_ns = e.t_ns;
    for (int i = 0; i < e.n; i++) {
        const pel_obs_t *obs = &e.obs[i];
        const int of_system = (obs->sys == PEL_SYS_QZS) ? qzss : four.n - qzss;
        if (obs->carrier != PEL_CARRIER_L1 || of_system >= 2) { continue; }
        four.obs[four.n++] = *obs;
        qzss += obs->sys == PEL_SYS_QZS;
    }
    TEST_ASSERT_EQUAL(4, four.n);
    TEST_ASSERT_EQUAL(2, qzss);
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&four, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 1e-2);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, out.isb_m[PEL_SYS_QZS]);
}

static void the_ionosphere_is_never_ignored(void)
{
    const scene_t s = scene_default();
    double with_nominal;
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    with_nominal = sqrt(out.cov_r_e[0][0]);
    for (int i = 0; i < view.n; i++) {
        TEST_ASSERT_TRUE(view.sight[i].iono_L1_m > 1.5 && view.sight[i].sd_iono_m > 0.7f);
    }
    o.klobuchar = (pel_klobuchar_t){.valid = true, .alpha = {1e-8f}, .beta = {1e5f}};
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_TRUE(sqrt(out.cov_r_e[0][0]) < with_nominal); /* broadcast ones are trusted more */
    TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 1e-3);
}

static void more_satellites_than_room_are_dropped_and_counted(void)
{
    pel_orbits_init(&o);
    pel_ephemeris_t k = {.sqrt_a = 5153.6, .e = 0.01, .i0 = 0.96, .toe_ns = SKY_T0, .toc_ns = SKY_T0, .prn = 1};
    memset(&e, 0, sizeof e);
    e.t_ns = SKY_T0;
    for (int i = 0; i < PEL_MAX_EPH && e.n < PEL_MAX_OBS; i++) {
        k.sys = (uint8_t)((i < 32) ? PEL_SYS_GPS : PEL_SYS_GAL);
        k.prn = (uint8_t)(1 + i % 32);
        k.M0 = 0.1 * i - 3.0;
        TEST_ASSERT_EQUAL(PEL_OK, pel_orbits_add(&o, &k));
        e.obs[e.n++] = (pel_obs_t){.sys = k.sys, .prn = k.prn, .P_m = 2.2e7, .flags = PEL_OBS_CODE};
    }
    const scene_t s = scene_default();
    (void)pel_view_compute(&e, &o, e.t_ns, s.r_e, NULL, -2.0, &count, &view);
    TEST_ASSERT_EQUAL((e.n < PEL_MAX_SATS) ? e.n : PEL_MAX_SATS, view.n);
    TEST_ASSERT_EQUAL(e.n - view.n, (int)count.sats_excluded);
    (void)pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out); /* any verdict, no harm */
}

static void a_view_from_nowhere_is_refused(void)
{
    const double nowhere[][3] = {{0, 0, 0}, {(double)NAN, 0, 6.4e6}, {1e8, 0, 0}};
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_view_compute(&e, &o, e.t_ns, nowhere[i], NULL, 0.1, &count, &view));
        TEST_ASSERT_EQUAL(0, view.n);
    }
    const double v[3] = {0, (double)NAN, 0};
    TEST_ASSERT_EQUAL(PEL_E_RANGE, pel_view_compute(&e, &o, e.t_ns, s.r_e, v, 0.1, &count, &view));
}

static void moving_a_view_is_computing_it_anew(void)
{
    static pel_view_t moved;
    const scene_t s = scene_default();
    const double r[3] = {s.r_e[0] + 900.0, s.r_e[1] - 700.0, s.r_e[2] + 400.0};
    const double v[3] = {30.0, 40.0, -20.0};
    scene_observe(&s, &o, SKY_T0, ALL, &e);
    (void)pel_view_compute(&e, &o, e.t_ns, s.r_e, NULL, 0.2, NULL, &moved);
    (void)pel_view_compute(&e, &o, e.t_ns, r, v, 0.2, NULL, &view);
    pel_view_move(&moved, r, v);
    for (int i = 0; i < moved.n; i++) {
        const pel_sight_t *f = pel_view_find(&view, moved.sight[i].sys, moved.sight[i].prn);
        if (f == NULL) { continue; }
        TEST_ASSERT_DOUBLE_WITHIN(1e-8, f->rho_m, moved.sight[i].rho_m);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, f->rho_rate_mps, moved.sight[i].rho_rate_mps);
    }
}

/* ---- edges ------------------------------------------------------------------------------------------------------------------------ */

static void first_carriers_are_taken_in_whatever_order_they_come(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    for (int i = 0; i + 1 < e.n; i += 2) { /* L2 first, with a code that is wrong */
        const pel_obs_t swap = e.obs[i];
        e.obs[i] = e.obs[i + 1];
        e.obs[i + 1] = swap;
        e.obs[i].P_m += 400.0 * (i % 3);
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 0.01);
}

static void a_prior_that_is_nowhere_is_not_begun_with(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    pel_spp_t prior;
    memset(&prior, 0, sizeof prior);
    static const double PLACES[] = {0.0, NAN, 1e9};
    for (int i = 0; i < 3; i++) {
        prior.r_ea_e[1] = PLACES[i];
        TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, &prior, &count, &view, &out));
        TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 0.01);
    }
}

/* One satellite more than unknowns shows a fault, and cannot say whose it is. */
static void with_one_satellite_to_spare_a_fault_is_told_but_not_found(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    e.n = 10;
    e.obs[4].P_m += 3000.0;
    TEST_ASSERT_EQUAL(PEL_W_REJECTED, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_EQUAL_INT(0, out.n_excluded);
    TEST_ASSERT_EQUAL_INT(5, out.n_used);
    TEST_ASSERT_TRUE(out.rms_m > 5.0);
}

/* An antenna on a spacecraft: codes that fit, at a place that no receiver of this kind has. */
static void a_place_above_the_earth_is_none(void)
{
    scene_t s = scene_default();
    s.atmosphere = false;
    for (int k = 0; k < 3; k++) { s.r_e[k] *= 1.3; }
    scene_observe(&s, &o, SKY_T0, ALL, &e);
    const pel_spp_t before = out;
    TEST_ASSERT_EQUAL(PEL_E_GEOMETRY, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_EQUAL_MEMORY(&before, &out, sizeof out);
}

/* Codes of no place at all: refused one way or another, never believed. */
static void codes_at_random_are_never_believed(void)
{
    uint32_t dice = 1;
    int not_converged = 0;
    const scene_t s = scene_default();
    for (int trial = 0; trial < 400; trial++) {
        scene_observe(&s, &o, SKY_T0, GPS, &e);
        for (int i = 0; i < e.n; i++) {
            dice = dice * 1664525u + 1013904223u;
            e.obs[i].P_m = 1.1e7 + 4.8e7 * (double)(dice >> 8) / 16777216.0;
            e.obs[i].carrier = (i % 2 == 0) ? PEL_CARRIER_L1 : PEL_CARRIER_L2;
        }
        e.n = (trial % 2 == 0) ? 8 : 14;
        const pel_status_t status = pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out);
        not_converged += status == PEL_E_NO_CONVERGENCE;
        TEST_ASSERT_TRUE(status != PEL_OK || e.n == 8 || out.rms_m > 100.0); /* four fit any place */
    }
    printf("of 400 at random: %d without convergence\n", not_converged);
    TEST_ASSERT_TRUE(not_converged > 0);
}

static void a_velocity_that_is_none_is_not_given(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    (void)pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out);
    const pel_view_t sights = view;
    for (int i = 0; i < e.n; i++) { /* as if the antenna moved with twelve kilometres a second */
        const pel_sight_t *sight = pel_view_find(&sights, e.obs[i].sys, e.obs[i].prn);
        if (sight == NULL) { continue; }
        e.obs[i].D_hz += (float)(12000.0 * sight->u_e[0] / pel_obs_lambda_m(&e.obs[i]));
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_FALSE(out.has_velocity);
    TEST_ASSERT_EQUAL_DOUBLE(0.0, out.v_ea_e[0]);
    TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 0.01);
}

static void an_epoch_that_says_it_is_longer_than_it_can_be_is_cut(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, GPS, &e);
    e.n = UINT16_MAX;
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 0.01);
}

/* ---- which satellites are seen ------------------------------------------------------------------------------------------------------ */

/* QZSS says by its lowest bit of health only something of a signal that is not used. */
static void health_is_of_the_signals_that_are_used(void)
{
    static const struct {
        uint8_t sys, health;
        bool seen;
    } of[] = {{PEL_SYS_GPS, 0, true},
              {PEL_SYS_GPS, 1, false},
              {PEL_SYS_QZS, 0, true},
              {PEL_SYS_QZS, 1, true},
              {PEL_SYS_QZS, 2, false}};
    const scene_t s = scene_default();
    for (int i = 0; i < 5; i++) {
        sky_init(&o);
        scene_observe(&s, &o, SKY_T0, GPS, &e);
        pel_ephemeris_t eph = *pel_orbits_find(&o, PEL_SYS_GPS, e.obs[0].prn, SKY_T0);
        pel_orbits_init(&o);
        eph.sys = of[i].sys;
        eph.prn = 2;
        eph.health = of[i].health;
        TEST_ASSERT_EQUAL(PEL_OK, pel_orbits_add(&o, &eph));
        e.obs[0].sys = of[i].sys;
        e.obs[0].prn = 2;
        e.n = 1;
        memset(&count, 0, sizeof count);
        TEST_ASSERT_EQUAL(of[i].seen ? PEL_OK : PEL_E_MISSING,
                          pel_view_compute(&e, &o, SKY_T0, s.r_e, NULL, 0.0, &count, &view));
        TEST_ASSERT_EQUAL_UINT32(!of[i].seen, count.sats_unhealthy);
    }
}

/* An orbit that says it is good for days, of a kind that can be carried for an hour. */
static void an_orbit_that_cannot_be_carried_so_far_is_none(void)
{
    const scene_t s = scene_default();
    pel_orbits_t glonass;
    pel_orbits_init(&glonass);
    sky_add_glonass(&glonass);
    pel_orbits_init(&o);
    for (int i = 0; i < glonass.n; i++) {
        glonass.eph[i].fit_s = 1e5f;
        TEST_ASSERT_EQUAL(PEL_OK, pel_orbits_add(&o, &glonass.eph[i]));
    }
    scene_observe(&s, &o, SKY_T0, 1u << PEL_SYS_GLO, &e);
    TEST_ASSERT_EQUAL(PEL_OK, pel_view_compute(&e, &o, SKY_T0, s.r_e, NULL, 0.0, &count, &view));
    e.t_ns += 7200 * PEL_NS_PER_S;
    memset(&count, 0, sizeof count);
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_view_compute(&e, &o, e.t_ns, s.r_e, NULL, 0.0, &count, &view));
    TEST_ASSERT_EQUAL_UINT32(e.n / 2u, count.sats_no_eph);
}

static void systems_that_are_not_asked_for_take_no_part(void)
{
    const scene_t s = scene_default();
    scene_observe(&s, &o, SKY_T0, ALL, &e);
    cfg.sys_mask = GPS;
    TEST_ASSERT_EQUAL(PEL_OK, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
    for (int i = 0; i < view.n; i++) { TEST_ASSERT_EQUAL_INT(PEL_SYS_GPS, view.sight[i].sys); }
    TEST_ASSERT_TRUE(distance(out.r_ea_e, s.r_e) < 0.01);
    for (int i = 0; i < e.n; i++) { e.obs[i].sys = PEL_N_SYS; }
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_spp_solve(&e, &o, &cfg, NULL, &count, &view, &out));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_receiver_at_rest_is_found_from_the_earths_centre);
    RUN_TEST(a_fast_receiver_with_a_bad_clock_is_placed_at_the_true_instant);
    RUN_TEST(bad_observations_are_as_if_absent);
    RUN_TEST(too_few_satellites_leave_the_output_alone);
    RUN_TEST(unhealthy_unknown_and_low_satellites_are_counted);
    RUN_TEST(faults_are_excluded_three_at_most);
    RUN_TEST(one_wrong_doppler_does_not_move_the_velocity);
    RUN_TEST(a_clock_between_systems_is_solved_for);
    RUN_TEST(four_satellites_of_gps_and_qzss_are_a_position);
    RUN_TEST(the_ionosphere_is_never_ignored);
    RUN_TEST(more_satellites_than_room_are_dropped_and_counted);
    RUN_TEST(a_view_from_nowhere_is_refused);
    RUN_TEST(moving_a_view_is_computing_it_anew);
    RUN_TEST(first_carriers_are_taken_in_whatever_order_they_come);
    RUN_TEST(a_prior_that_is_nowhere_is_not_begun_with);
    RUN_TEST(with_one_satellite_to_spare_a_fault_is_told_but_not_found);
    RUN_TEST(a_place_above_the_earth_is_none);
    RUN_TEST(codes_at_random_are_never_believed);
    RUN_TEST(a_velocity_that_is_none_is_not_given);
    RUN_TEST(an_epoch_that_says_it_is_longer_than_it_can_be_is_cut);
    RUN_TEST(health_is_of_the_signals_that_are_used);
    RUN_TEST(an_orbit_that_cannot_be_carried_so_far_is_none);
    RUN_TEST(systems_that_are_not_asked_for_take_no_part);
    return UNITY_END();
}

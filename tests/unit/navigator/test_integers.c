/* Integers from epoch to epoch: GLONASS on its own wavelengths, noise that is not what was told, wrong integers, lost messages. */
/* build: f32 f64 */
/* with: pair gnss */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "support_pair.h"
#include "unity.h"

#define GPS     (1u << PEL_SYS_GPS)
#define GLO     (1u << PEL_SYS_GLO)
#define L1      (1u << PEL_CARRIER_L1)
#define L1_L2   (L1 | (1u << PEL_CARRIER_L2))
#define WRONG_M 0.1

static pel_navigator_t nav;
static pair_t pair;

void setUp(void) {}
void tearDown(void) {}

/* Epochs until the first fix, and how many of n are fixed and wrong. */
typedef struct {
    int first, fixed, wrong;
} run_t;

static run_t run(int n)
{
    run_t r = {.first = -1};
    for (int i = 0; i < n; i++) {
        if (!pair_step(&pair, &nav)) { continue; }
        if (r.first < 0) { r.first = i; }
        r.fixed++;
        r.wrong += pair_error_m(&pair, &nav) > WRONG_M;
    }
    return r;
}

static int glonass_fixed(void)
{
    int n = 0;
    for (int i = 0; i < nav.n_sats; i++) {
        n += nav.sats[i].sys == PEL_SYS_GLO && (nav.sats[i].flags & PEL_SAT_FIXED) != 0;
    }
    return n;
}

static double slope_m(uint8_t carrier)
{
    return nav.track.channels[carrier].slope_m;
}

static void glonass_integers_of_two_receivers_of_one_make_are_fixed(void)
{
    pair_init(&pair, &nav, GPS | GLO, L1_L2);
    const run_t r = run(20);
    TEST_ASSERT_EQUAL(0, r.wrong);
    TEST_ASSERT_GREATER_OR_EQUAL(18, r.fixed);
    TEST_ASSERT_GREATER_OR_EQUAL(6, glonass_fixed());
}

static void glonass_integers_of_two_makes_are_fixed_once_their_slope_is_known(void)
{
    pair_init(&pair, &nav, GPS | GLO, L1_L2);
    pair.rover.glo_slope_m = 0.023; /* as between makes: a third of a cycle over three channels */
    pair.base.glo_slope_m = -0.008;
    const run_t r = run(60);
    TEST_ASSERT_EQUAL(0, r.wrong);
    TEST_ASSERT_GREATER_OR_EQUAL(50, r.fixed);
    TEST_ASSERT_GREATER_OR_EQUAL(6, glonass_fixed());
    /* The datum's own error, a few cycles of its wavelength, is part of the slope. */
    printf("slope found: %.1f and %.1f mm a channel of 31.0\n", 1e3 * slope_m(0), 1e3 * slope_m(1));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.031, slope_m(0));
    TEST_ASSERT_DOUBLE_WITHIN(0.002, 0.031, slope_m(1));
}

static void on_one_frequency_glonass_brings_the_fix_earlier(void)
{
    int first[2];
    for (int with = 0; with < 2; with++) {
        pair_init(&pair, &nav, GPS | (with ? GLO : 0u), L1);
        const run_t r = run(120);
        TEST_ASSERT_EQUAL(0, r.wrong);
        TEST_ASSERT_GREATER_OR_EQUAL(0, r.first);
        first[with] = r.first;
    }
    printf("L1: first fix in epoch %d without GLONASS, %d with it\n", first[0], first[1]);
    TEST_ASSERT_LESS_THAN(first[0], first[1]);
}

static void code_noise_is_learnt_whatever_was_told(void)
{
    static const double SD_M[] = {0.25, 0.35, 1.4};
    for (int i = 0; i < 3; i++) {
        pair_init(&pair, &nav, GPS, L1_L2);
        pair.code_sd_m = SD_M[i];
        pel_nav_config_t cfg = nav.cfg;
        cfg.code_tau_s = 0.0; /* white in this scene */
        pair_introduce(&pair, &nav, &cfg);
        const run_t r = run(90);
        const double expected = SD_M[i] * SD_M[i];
        /* Told: 0.35 m at the zenith, and half of the variance grows with 1 / sin^2 of elevation; the scene is white at all. */
        double told = 0.0;
        for (int k = 0; k < nav.sd.n; k++) {
            told += pel_noise_var(&nav.cfg.noise, PEL_OBS_CODE, sin((double)nav.sd.sd[k].el_rad), 45.0) / nav.sd.n;
        }
        const double learnt = told * (double)nav.noise_level.of[PEL_NAV_LEVEL_CODE][PEL_SYS_GPS][PEL_CARRIER_L1].factor;
        printf("code of %.2f m: taken as %.2f m on average\n", SD_M[i], sqrt(learnt));
        TEST_ASSERT_EQUAL(0, r.wrong);
        TEST_ASSERT_DOUBLE_WITHIN(0.6, 0.0, log(learnt / expected));
    }
}

static void shift_held(int n_sats, double cycles)
{
    for (int i = 0; i < nav.track.n && n_sats > 0; i++) {
        pel_tracked_t *t = &nav.track.entry[i];
        if (!t->held || t->carrier != PEL_CARRIER_L1) { continue; }
        t->N += cycles;
        n_sats--;
    }
}

static void wrong_integers_do_not_last(void)
{
    for (int n_sats = 1; n_sats <= 4; n_sats++) {
        pair_init(&pair, &nav, GPS, L1_L2);
        (void)run(10);
        shift_held(n_sats, 2.0);
        (void)run(10);
        const run_t after = run(20);
        TEST_ASSERT_EQUAL(0, after.wrong);
        TEST_ASSERT_GREATER_OR_EQUAL(15, after.fixed);
    }
}

static void a_system_lost_on_the_bases_line_comes_from_the_epoch_before(void)
{
    static pel_epoch_t base, rover;
    pair_init(&pair, &nav, GPS | GLO, L1_L2);
    (void)run(10);
    int fixed = 0, glonass = 0;
    for (int i = 0; i < 12; i++) {
        pair_observe(&pair, &base, &rover);
        int kept = 0;
        for (int k = 0; k < base.n; k++) { /* every second epoch of the base lacks GLONASS */
            if (i % 2 == 0 || base.obs[k].sys != PEL_SYS_GLO) { base.obs[kept++] = base.obs[k]; }
        }
        base.n = (uint16_t)kept;
        pel_navigator_push_base(&nav, &base);
        pel_navigator_push_rover(&nav, &rover);
        while (pel_navigator_flush(&nav)) {}
        fixed += nav.epoch_solution.fix == PEL_FIX_FIXED;
        glonass += glonass_fixed() >= 6;
        TEST_ASSERT_LESS_THAN_DOUBLE(WRONG_M, pair_error_m(&pair, &nav));
    }
    TEST_ASSERT_EQUAL(12, fixed);
    TEST_ASSERT_EQUAL(12, glonass);
}

static void half_a_cycle_that_nobody_told_is_not_fixed(void)
{
    static pel_epoch_t base, rover;
    pair_init(&pair, &nav, GPS, L1_L2);
    int wrong = 0;
    for (int i = 0; i < 60; i++) {
        pair_observe(&pair, &base, &rover);
        rover.obs[0].L_cyc += 0.5;
        rover.obs[4].L_cyc += 0.5;
        pel_navigator_push_base(&nav, &base);
        pel_navigator_push_rover(&nav, &rover);
        while (pel_navigator_flush(&nav)) {}
        wrong += nav.epoch_solution.fix == PEL_FIX_FIXED && pair_error_m(&pair, &nav) > WRONG_M;
    }
    TEST_ASSERT_EQUAL(0, wrong);
    TEST_ASSERT_GREATER_THAN_UINT32(50, nav.counters.epochs_used);
}

/* Told: the receiver flags it. */
static void phases_with_an_open_half_cycle_smooth_the_float_and_are_never_fixed(void)
{
    static pel_epoch_t base, rover;
    double rms[2];
    for (int with = 0; with < 2; with++) {
        pair_init(&pair, &nav, GPS, L1);
        double sum = 0.0, before[3] = {0.0};
        int n = 0;
        for (int i = 0; i < 40; i++) {
            pair_observe(&pair, &base, &rover);
            for (int k = 0; k < rover.n; k++) {
                rover.obs[k].L_cyc += 0.5 * (k % 2);
                rover.obs[k].flags |= PEL_OBS_HALF_CYCLE;
                if (!with) { rover.obs[k].flags &= (uint8_t)~PEL_OBS_PHASE; }
            }
            pel_navigator_push_base(&nav, &base);
            pel_navigator_push_rover(&nav, &rover);
            while (pel_navigator_flush(&nav)) {}
            TEST_ASSERT_NOT_EQUAL(PEL_FIX_FIXED, nav.epoch_solution.fix);
            for (int k = 0; k < 3; k++) {
                const double step = nav.epoch_solution.r_eb_e[k] - before[k];
                before[k] = nav.epoch_solution.r_eb_e[k];
                if (i > 10) { sum += step * step; }
            }
            n += i > 10;
        }
        rms[with] = sqrt(sum / n);
    }
    printf("steps of a float at rest: %.3f m from codes, %.3f m with half-cycle phases\n", rms[0], rms[1]);
    TEST_ASSERT_LESS_THAN_DOUBLE(rms[0] / 3.0, rms[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(glonass_integers_of_two_receivers_of_one_make_are_fixed);
    RUN_TEST(glonass_integers_of_two_makes_are_fixed_once_their_slope_is_known);
    RUN_TEST(on_one_frequency_glonass_brings_the_fix_earlier);
    RUN_TEST(code_noise_is_learnt_whatever_was_told);
    RUN_TEST(wrong_integers_do_not_last);
    RUN_TEST(a_system_lost_on_the_bases_line_comes_from_the_epoch_before);
    RUN_TEST(half_a_cycle_that_nobody_told_is_not_fixed);
    RUN_TEST(phases_with_an_open_half_cycle_smooth_the_float_and_are_never_fixed);
    return UNITY_END();
}

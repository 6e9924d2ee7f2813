/* Pairing, single differences, pivots: two simulated receivers whose tags differ, without noise, so that every double
 * difference must be an integer to a fraction of a millimetre. */
/* build: f32 f64 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "support_gnss.h"
#include "unity.h"

#define ALL  ((1u << PEL_SYS_GPS) | (1u << PEL_SYS_GAL) | (1u << PEL_SYS_BDS))
#define GPS  (1u << PEL_SYS_GPS)
#define MASK 0.2

static pel_orbits_t o;
static pel_epoch_t rover;
static pel_epoch_t base;
static pel_view_t rover_view;
static pel_view_t base_view;
static pel_noise_config_t noise;
static pel_sd_set_t set;
static scene_t at_rover;
static scene_t at_base;

void setUp(void)
{
    sky_init(&o);
    pel_noise_default(&noise);
    at_base = scene_default();
    at_rover = scene_default();
    at_rover.r_e[0] += 2500.0;
    at_rover.r_e[1] -= 1800.0;
    at_rover.r_e[2] += 900.0;
    at_rover.v_e[0] = 50.0;
    at_rover.v_e[2] = -80.0;
    at_rover.clk_m = -120000.0;
    at_rover.clk_rate_mps = -45.0;
}
void tearDown(void) {}

static void observe(double base_late_s, unsigned systems)
{
    const pel_time_t t = SKY_T0 + 1234 * PEL_NS_PER_S;
    scene_observe(&at_rover, &o, t, systems, &rover);
    scene_observe(&at_base, &o, t + (int64_t)(base_late_s * 1e9), systems, &base);
    (void)pel_view_compute(&rover, &o, t, at_rover.r_e, at_rover.v_e, MASK, NULL, &rover_view);
    (void)pel_view_compute(&base, &o, t, at_base.r_e, NULL, MASK, NULL, &base_view);
}

static int group_size(int group)
{
    int n = 0;
    for (int i = 0; i < set.n; i++) { n += (set.sd[i].group == group); }
    return n;
}

/* Largest departure of DD code, DD phase and DD rate from zero (phase: from the known integers' zero). */
static void departures(double *code_m, double *phase_m, double *rate_mps)
{
    const pel_sd_t *pivot = NULL;
    *code_m = *phase_m = *rate_mps = 0.0;
    for (int i = 0; i < set.n; i++) {
        const pel_sd_t *d = &set.sd[i];
        if (d->pivot) { pivot = d; }
        *code_m = fmax(*code_m, fabs(d->code_m - pivot->code_m));
        *phase_m = fmax(*phase_m, fabs(d->phase_m - pivot->phase_m)); /* both receivers have the same integers */
        *rate_mps = fmax(*rate_mps, fabs(d->rate_mps - pivot->rate_mps));
    }
}

static void tags_apart_by_milliseconds_or_seconds_change_nothing(void)
{
    const double late_s[] = {0.0, 0.009, -0.05, 1.0, -10.0, 30.0};
    for (size_t k = 0; k < sizeof late_s / sizeof late_s[0]; k++) {
        double code;
        double phase;
        double rate;
        observe(late_s[k], ALL);
        TEST_ASSERT_EQUAL(PEL_OK, pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, -late_s[k], &set));
        departures(&code, &phase, &rate);
        printf("base %+7.3f s: %d rows in %d groups, DD code %.1e m, phase %.1e m, rate %.1e m/s\n", late_s[k], set.n,
               set.n_groups, code, phase, rate);
        TEST_ASSERT_TRUE(code < 1e-4 && phase < 1e-4);
        TEST_ASSERT_TRUE(rate < 4e-4); /* Doppler is float: 1e-4 Hz */
        TEST_ASSERT_EQUAL(6, set.n_groups);
    }
}

static void rows_are_sorted_with_the_highest_complete_satellite_first(void)
{
    observe(0.0, ALL);
    TEST_ASSERT_EQUAL(PEL_OK, pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set));
    for (int i = 0; i < set.n; i++) {
        const pel_sd_t *d = &set.sd[i];
        const bool first = (i == 0) || set.sd[i - 1].group != d->group;
        TEST_ASSERT_EQUAL(first, d->pivot);
        if (first) {
            for (int k = i; k < set.n && set.sd[k].group == d->group; k++) {
                TEST_ASSERT_TRUE(set.sd[k].el_rad <= d->el_rad);
            }
            continue;
        }
        TEST_ASSERT_TRUE(set.sd[i - 1].pivot || set.sd[i - 1].prn < d->prn);
        TEST_ASSERT_TRUE(set.sd[i - 1].sys == d->sys && set.sd[i - 1].carrier == d->carrier);
    }
    const uint8_t highest = set.sd[0].prn;
    for (int i = 0; i < rover.n; i++) {
        if (rover.obs[i].sys == set.sd[0].sys && rover.obs[i].prn == highest) { rover.obs[i].flags |= PEL_OBS_SLIP; }
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set));
    TEST_ASSERT_TRUE(set.sd[0].prn != highest);
}

static void flags_and_missing_parts_are_carried_over(void)
{
    observe(0.0, GPS);
    rover.obs[0].flags = PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_HALF_CYCLE;
    base.obs[2].flags |= PEL_OBS_SLIP;
    const uint8_t prn_half = rover.obs[0].prn;
    const uint8_t prn_slip = base.obs[2].prn;
    TEST_ASSERT_EQUAL(PEL_OK, pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set));
    int found = 0;
    for (int i = 0; i < set.n; i++) {
        const pel_sd_t *d = &set.sd[i];
        if (d->prn == prn_half && d->carrier == PEL_CARRIER_L1) {
            TEST_ASSERT_TRUE(d->half && d->has_phase && !d->has_rate && d->var_rate == 0.0);
            found++;
        }
        if (d->prn == prn_slip && d->carrier == PEL_CARRIER_L1) {
            TEST_ASSERT_TRUE(d->slip && d->has_rate);
            found++;
        }
    }
    TEST_ASSERT_EQUAL(2, found);
}

static void variances_grow_with_age_low_elevation_and_factor(void)
{
    observe(0.0, GPS);
    (void)pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set);
    const pel_sd_t fresh = set.sd[0];
    const double sin_el = sin((double)fresh.el_rad);
    const double law = 0.5 + 0.5 / (sin_el * sin_el);
    /* base and rover see it at elevations 0.001 rad apart */
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0, fresh.var_code / (2.0 * 0.09 * law));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0, fresh.var_phase / (2.0 * 9e-6 * law));
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0, fresh.var_rate / (2.0 * 9e-4 * law));
    (void)pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 10.0, &set);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, fresh.var_phase + 1e-4, set.sd[0].var_phase);
    noise.rover_factor = 3.0;
    (void)pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 5.0, set.sd[0].var_code / fresh.var_code);

    noise.cn0_ref_dbhz = 45.0;
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-9, 10.0, pel_noise_var(&noise, PEL_OBS_CODE, 1.0, 35.0) / pel_noise_var(&noise, PEL_OBS_CODE, 1.0, 50.0));
    TEST_ASSERT_EQUAL_DOUBLE(pel_noise_var(&noise, PEL_OBS_CODE, 1.0, 45.0),
                             pel_noise_var(&noise, PEL_OBS_CODE, 1.0, 0.0));
}

static void the_code_both_receivers_have_is_taken(void)
{
    observe(0.0, GPS);
    const uint8_t prn = rover.obs[0].prn;
    rover.obs[rover.n] = rover.obs[0]; /* a second code on the same carrier, half a cycle off */
    rover.obs[0].code = 'X';
    rover.obs[0].L_cyc += 0.5;
    rover.n++;
    TEST_ASSERT_EQUAL(PEL_OK, pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set));
    double code;
    double phase;
    double rate;
    departures(&code, &phase, &rate);
    TEST_ASSERT_TRUE(phase < 1e-4);
    int rows = 0;
    for (int i = 0; i < set.n; i++) { rows += (set.sd[i].prn == prn && set.sd[i].carrier == PEL_CARRIER_L1); }
    TEST_ASSERT_EQUAL(1, rows);
}

static void satellites_with_different_ephemerides_are_not_differenced(void)
{
    observe(0.0, GPS);
    (void)pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set);
    const int before = set.n;
    base_view.sight[0].iode++;
    base_view.sight[1].excluded = true;
    (void)pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set);
    TEST_ASSERT_EQUAL(before - 4, set.n);
    base_view.n = 0;
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set));
    TEST_ASSERT_EQUAL(0, set.n);
}

static void a_receiver_alone_gives_the_same_rows(void)
{
    double code;
    double phase;
    double rate;
    observe(0.0, GPS);
    TEST_ASSERT_EQUAL(PEL_OK, pel_sd_undifferenced(&rover, &rover_view, &noise, &set));
    departures(&code, &phase, &rate);
    TEST_ASSERT_EQUAL(2, set.n_groups);
    TEST_ASSERT_TRUE(group_size(0) > 5);
    TEST_ASSERT_TRUE(code < 1e-4 && rate < 2e-4);
    TEST_ASSERT_TRUE(set.sd[0].var_code > 1.0 + 0.09); /* half of a URA of 2 m */
}

/* GPS satellites 11 to 20 become J01 to J10: numbers that GPS has as well. */
static void hand_some_to_qzss(pel_epoch_t *epoch)
{
    for (int i = 0; i < o.n; i++) {
        pel_ephemeris_t *eph = &o.eph[i];
        if (eph->sys != PEL_SYS_GPS || eph->prn < 11 || eph->prn > 20) { continue; }
        eph->sys = PEL_SYS_QZS;
        eph->prn = (uint8_t)(eph->prn - 10);
    }
    for (int i = 0; i < epoch->n; i++) {
        pel_obs_t *obs = &epoch->obs[i];
        if (obs->sys != PEL_SYS_GPS || obs->prn < 11 || obs->prn > 20) { continue; }
        obs->sys = PEL_SYS_QZS;
        obs->prn = (uint8_t)(obs->prn - 10);
    }
}

static void gps_and_qzss_share_a_clock_for_a_receiver_alone(void)
{
    observe(0.0, GPS);
    TEST_ASSERT_EQUAL(PEL_OK, pel_sd_undifferenced(&rover, &rover_view, &noise, &set));
    const int rows = set.n;
    hand_some_to_qzss(&rover);
    (void)pel_view_compute(&rover, &o, rover.t_ns, at_rover.r_e, at_rover.v_e, MASK, NULL, &rover_view);
    TEST_ASSERT_EQUAL(PEL_OK, pel_sd_undifferenced(&rover, &rover_view, &noise, &set));
    int qzss = 0, pivots = 0;
    for (int i = 0; i < set.n; i++) {
        qzss += set.sd[i].sys == PEL_SYS_QZS;
        pivots += set.sd[i].pivot;
    }
    TEST_ASSERT_EQUAL(rows, set.n);
    TEST_ASSERT_EQUAL(2, set.n_groups);
    TEST_ASSERT_EQUAL(2, pivots);
    TEST_ASSERT_TRUE(qzss >= 4 && qzss < set.n);
}

static void the_nearest_base_epoch_is_paired(void)
{
    static pel_epoch_t ring[3];
    int index = 7;
    double age = -1.0;
    memset(ring, 0, sizeof ring);
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_pair_epochs(ring, 3, SKY_T0, 1.0, &index, &age));
    for (int i = 0; i < 3; i++) {
        ring[i].n = 1;
        ring[i].t_ns = SKY_T0 + i * PEL_NS_PER_S;
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_pair_epochs(ring, 3, SKY_T0 + 1009 * PEL_NS_PER_MS, 0.1, &index, &age));
    TEST_ASSERT_EQUAL(1, index);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.009, age);
    TEST_ASSERT_EQUAL(PEL_E_STALE, pel_pair_epochs(ring, 3, SKY_T0 + 5 * PEL_NS_PER_S, 2.0, &index, &age));
    TEST_ASSERT_EQUAL(1, index);
    TEST_ASSERT_EQUAL(PEL_OK, pel_pair_epochs(ring, 3, SKY_T0 - 5 * PEL_NS_PER_S, 6.0, &index, &age));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, -5.0, age);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(tags_apart_by_milliseconds_or_seconds_change_nothing);
    RUN_TEST(rows_are_sorted_with_the_highest_complete_satellite_first);
    RUN_TEST(flags_and_missing_parts_are_carried_over);
    RUN_TEST(variances_grow_with_age_low_elevation_and_factor);
    RUN_TEST(the_code_both_receivers_have_is_taken);
    RUN_TEST(satellites_with_different_ephemerides_are_not_differenced);
    RUN_TEST(a_receiver_alone_gives_the_same_rows);
    RUN_TEST(gps_and_qzss_share_a_clock_for_a_receiver_alone);
    RUN_TEST(the_nearest_base_epoch_is_paired);
    return UNITY_END();
}

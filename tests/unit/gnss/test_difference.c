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

static void gps_and_qzss_share_a_clock_for_a_receiver_alone(void)
{
    observe(0.0, GPS);
    TEST_ASSERT_EQUAL(PEL_OK, pel_sd_undifferenced(&rover, &rover_view, &noise, &set));
    const int rows = set.n;
    gnss_hand_some_to_qzss(&o, &rover);
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

/* ---- what a pair of observations has in common --------------------------------------------------------------------------------- */

static const pel_sd_t *row_of(uint8_t prn, uint8_t carrier)
{
    for (int i = 0; i < set.n; i++) {
        if (set.sd[i].prn == prn && set.sd[i].carrier == carrier) { return &set.sd[i]; }
    }
    return NULL;
}

static void form(void)
{
    (void)pel_sd_form(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set);
}

static pel_obs_t *of(pel_epoch_t *e, uint8_t prn, uint8_t carrier)
{
    int i = 0;
    while (e->obs[i].prn != prn || e->obs[i].carrier != carrier) { i++; }
    return &e->obs[i];
}

/* Both receivers see this satellite of GPS well; it is no pivot. */
static uint8_t observe_one(void)
{
    observe(0.0, GPS);
    form();
    TEST_ASSERT_FALSE(set.sd[1].pivot);
    return set.sd[1].prn;
}

/* Parts that one of the two lacks are not in the row; a row of no part is none. */
static void a_row_has_what_both_have(void)
{
    static const struct {
        uint8_t rover, base;
        bool row, code, phase, rate;
    } parts[] = {
        {7, 7, true, true, true, true},   {7, 6, true, false, true, true},    {7, 5, true, true, false, true},
        {7, 3, true, true, true, false},  {1, 7, true, true, false, false},   {2, 7, true, false, true, false},
        {4, 7, true, false, false, true}, {3, 4, false, false, false, false}, {0, 7, false, false, false, false}};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        const uint8_t prn = observe_one();
        of(&rover, prn, PEL_CARRIER_L2)->flags = parts[i].rover;
        of(&base, prn, PEL_CARRIER_L2)->flags = parts[i].base;
        form();
        const pel_sd_t *d = row_of(prn, PEL_CARRIER_L2);
        TEST_ASSERT_EQUAL_INT(parts[i].row, d != NULL);
        if (d == NULL) { continue; }
        TEST_ASSERT_EQUAL_INT(parts[i].code, d->has_code && d->var_code > 0.0);
        TEST_ASSERT_EQUAL_INT(parts[i].phase, d->has_phase && d->var_phase > 0.0);
        TEST_ASSERT_EQUAL_INT(parts[i].rate, d->has_rate && d->var_rate > 0.0);
    }
}

static void a_receiver_alone_has_a_row_for_any_part(void)
{
    static const uint8_t PARTS[] = {1, 2, 4, 7, 0};
    for (int i = 0; i < 5; i++) {
        const uint8_t prn = observe_one();
        of(&rover, prn, PEL_CARRIER_L2)->flags = PARTS[i];
        TEST_ASSERT_EQUAL(PEL_OK, pel_sd_undifferenced(&rover, &rover_view, &noise, &set));
        const pel_sd_t *d = row_of(prn, PEL_CARRIER_L2);
        TEST_ASSERT_EQUAL_INT(PARTS[i] != 0, d != NULL);
        if (d == NULL) { continue; }
        TEST_ASSERT_EQUAL_INT((PARTS[i] & 1) != 0, d->var_code > 0.0);
        TEST_ASSERT_EQUAL_INT((PARTS[i] & 4) != 0, d->var_rate > 0.0);
    }
    observe(0.0, GPS);
    TEST_ASSERT_EQUAL(PEL_OK, pel_sd_undifferenced(&rover, &rover_view, &noise, &set));
    const int n = set.n;
    rover_view.sight[0].excluded = true; /* refused as a satellite: both carriers */
    TEST_ASSERT_EQUAL(PEL_OK, pel_sd_undifferenced(&rover, &rover_view, &noise, &set));
    TEST_ASSERT_EQUAL_INT(n - 2, set.n);
}

static void a_half_cycle_open_at_the_base_is_open_in_the_row(void)
{
    const uint8_t prn = observe_one();
    of(&base, prn, PEL_CARRIER_L2)->flags |= PEL_OBS_HALF_CYCLE;
    form();
    TEST_ASSERT_TRUE(row_of(prn, PEL_CARRIER_L2)->half);
    TEST_ASSERT_FALSE(row_of(prn, PEL_CARRIER_L1)->half);
}

static void a_signal_that_the_base_lacks_is_no_row(void)
{
    const uint8_t prn = observe_one();
    const int n = set.n;
    *of(&base, prn, PEL_CARRIER_L2) = base.obs[base.n - 1];
    base.n--;
    form();
    TEST_ASSERT_EQUAL_INT(n - 1, set.n);
    TEST_ASSERT_NULL(row_of(prn, PEL_CARRIER_L2));
    TEST_ASSERT_NOT_NULL(row_of(prn, PEL_CARRIER_L1));
}

static void ephemerides_differ_by_age_issue_or_message(void)
{
    for (int i = 0; i < 4; i++) {
        const uint8_t prn = observe_one();
        int k = 0;
        while (base_view.sight[k].prn != prn) { k++; }
        pel_sight_t *s = &base_view.sight[k];
        s->iode = (uint16_t)(s->iode + (i == 1));
        s->toe_gps_s += (i == 2);
        s->source = (uint8_t)(s->source + (i == 3));
        form();
        TEST_ASSERT_EQUAL_INT(i == 0, row_of(prn, PEL_CARRIER_L1) != NULL);
    }
}

static void the_channel_of_glonass_tells_one_satellite_from_another(void)
{
    const uint8_t prn = observe_one();
    of(&base, prn, PEL_CARRIER_L1)->glo_k = 3;
    form();
    TEST_ASSERT_NULL(row_of(prn, PEL_CARRIER_L1));
    TEST_ASSERT_NOT_NULL(row_of(prn, PEL_CARRIER_L2));
}

/* Two codes at the rover, others at the base: the first of its own has to do, and the satellite has one row. */
static void codes_that_are_not_shared_are_paired_in_their_order(void)
{
    const uint8_t prn = observe_one();
    const int n = set.n;
    pel_obs_t *r = of(&rover, prn, PEL_CARRIER_L1), *b = of(&base, prn, PEL_CARRIER_L1);
    r->code = 'X';
    rover.obs[rover.n] = *r;
    rover.obs[rover.n++].code = 'Y';
    b->code = 'A';
    base.obs[base.n] = *b;
    base.obs[base.n].code = 'B';
    base.obs[base.n++].L_cyc += 1000.0;
    double code, phase, rate;
    form();
    departures(&code, &phase, &rate);
    TEST_ASSERT_TRUE(phase < 1e-4); /* A against X: B is a thousand cycles off */
    TEST_ASSERT_EQUAL_INT(n, set.n);
    TEST_ASSERT_NOT_NULL(row_of(prn, PEL_CARRIER_L1));
}

/* Another of the rover's codes counts only if the base has that one, of this satellite and on this carrier. */
static void a_code_elsewhere_is_better_only_if_the_base_has_it(void)
{
    static const struct {
        char code;
        uint8_t sys;
        int8_t glo_k;
        bool better;
    } others[] = {{'C', PEL_SYS_GPS, 0, true},
                  {'Z', PEL_SYS_GPS, 0, false},
                  {'C', PEL_SYS_GPS, 5, false},
                  {'C', PEL_SYS_GAL, 0, false}};
    for (int i = 0; i < 4; i++) {
        const uint8_t prn = observe_one();
        pel_obs_t *r = of(&rover, prn, PEL_CARRIER_L1);
        rover.obs[rover.n] = *r;
        rover.obs[rover.n].code = others[i].code;
        rover.obs[rover.n].sys = others[i].sys;
        rover.obs[rover.n].glo_k = others[i].glo_k;
        rover.obs[rover.n++].L_cyc += 0.25; /* it tells who is in the row */
        r->code = 'X';
        form();
        const pel_sd_t *d = row_of(prn, PEL_CARRIER_L1), *pivot = &set.sd[0];
        TEST_ASSERT_NOT_NULL(d);
        const double N = (d->phase_m - pivot->phase_m) / d->lambda_m;
        TEST_ASSERT_DOUBLE_WITHIN(1e-3, others[i].better ? 0.25 : 0.0, N - floor(N + 1e-2));
    }
}

/* Lengths that epochs say they have but cannot, and sets that are full. */
static void more_than_there_is_room_for_is_left_out(void)
{
    const uint8_t prn = observe_one();
    const int n = set.n;
    const pel_obs_t filler = {.sys = PEL_SYS_GAL, .prn = 1, .carrier = PEL_CARRIER_L5, .glo_k = 9};
    for (int i = rover.n; i < PEL_MAX_OBS; i++) { rover.obs[i] = filler; }
    for (int i = base.n; i < PEL_MAX_OBS; i++) { base.obs[i] = filler; }
    of(&rover, prn, PEL_CARRIER_L1)->code = 'X'; /* look through all of both for a better code */
    rover.n = base.n = UINT16_MAX;
    form();
    TEST_ASSERT_EQUAL_INT(n, set.n);
    for (int i = 0; i < PEL_MAX_OBS; i++) { set.sd[i] = (pel_sd_t){.sys = PEL_SYS_GAL, .prn = 1}; }
    set.n = PEL_MAX_OBS;
    TEST_ASSERT_EQUAL(PEL_E_MISSING, pel_sd_add_missing(&rover, &rover_view, &base, &base_view, &noise, 0.0, &set));
    TEST_ASSERT_EQUAL_INT(PEL_MAX_OBS, set.n);
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
    RUN_TEST(form);
    RUN_TEST(a_row_has_what_both_have);
    RUN_TEST(a_receiver_alone_has_a_row_for_any_part);
    RUN_TEST(a_half_cycle_open_at_the_base_is_open_in_the_row);
    RUN_TEST(a_signal_that_the_base_lacks_is_no_row);
    RUN_TEST(ephemerides_differ_by_age_issue_or_message);
    RUN_TEST(the_channel_of_glonass_tells_one_satellite_from_another);
    RUN_TEST(codes_that_are_not_shared_are_paired_in_their_order);
    RUN_TEST(a_code_elsewhere_is_better_only_if_the_base_has_it);
    RUN_TEST(more_than_there_is_room_for_is_left_out);
    return UNITY_END();
}

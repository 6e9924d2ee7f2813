/* link: pel_sim */
/* Satellites move as their elements say; receivers measure what geometry, clocks and integers make. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "receiver.h"
#include "unity.h"
#include "world.h"

static const double site[3] = {32.04 * WORLD_DEG, 118.8 * WORLD_DEG, 40.0};
static sky_t sky;
static atmosphere_t air;
static receiver_config_t config;
static receiver_t *receiver;
static pel_epoch_t epoch;
static pel_time_t start;
static double speed; /* east, m/s */

static void antenna(void *context, double t_s, double r_e[3], double v_e[3])
{
    (void)context;
    const double east[3] = {-sin(site[1]), cos(site[1]), 0.0};
    world_llh_to_ecef(site, r_e);
    for (int i = 0; i < 3; i++) {
        r_e[i] += speed * t_s * east[i];
        v_e[i] = speed * east[i];
    }
}

static void make_sky(sky_kind_t kind, bool clocks)
{
    sky_config_t c = {.kind = kind, .clocks = clocks};
    for (int i = 0; i < PEL_N_SYS; i++) { c.systems[i] = true; }
    sky_init(&sky, &c, start, 1);
}

static void begin(void)
{
    receiver_init(receiver, &config, &sky, &air, antenna, NULL, start, 1, 1);
}

void setUp(void)
{
    start = pel_time_from_week(2300, 77400.0);
    speed = 0.0;
    memset(&air, 0, sizeof air);
    memset(&config, 0, sizeof config);
    config.present = true;
    config.interval_ns = PEL_NS_PER_S;
    config.mask = 10.0 * WORLD_DEG;
    config.n_signals = 2;
    TEST_ASSERT_TRUE(signal_parse("G1C", &config.signals[0]));
    TEST_ASSERT_TRUE(signal_parse("G2L", &config.signals[1]));
    receiver = calloc(1, sizeof *receiver);
    make_sky(SKY_IDEAL24, false);
}

void tearDown(void)
{
    free(receiver);
}

static void the_ideal_sky_is_that_of_the_published_attitude_system(void)
{
    /* S1 7: site 32.04 N 118.8 E, mask 10 deg, t0 = 2100 s: satellites 11, 1, 20, 4, 23, 8, 14 counted from 0 */
    const int expected[7] = {1, 4, 8, 11, 14, 20, 23};
    start = pel_time_from_week(2300, 2099.0);
    make_sky(SKY_IDEAL24, false);
    begin();
    receiver_epoch(receiver, &epoch);
    TEST_ASSERT_EQUAL_INT(14, epoch.n);
    for (int i = 0; i < 7; i++) { TEST_ASSERT_EQUAL_INT(expected[i] + 1, epoch.obs[2 * i].prn); }
}

static void satellite_velocity_is_the_derivative_of_its_position(void)
{
    double worst = 0.0;
    make_sky(SKY_MULTI, true);
    TEST_ASSERT_EQUAL_INT(31 + 24 + 36 + 4, sky.n);
    for (int i = 0; i < sky.n; i++) {
        sat_state_t a;
        sat_state_t b;
        sat_state_t s;
        sky_state(&sky.sats[i], start, 999.0, &a);
        sky_state(&sky.sats[i], start, 1001.0, &b);
        sky_state(&sky.sats[i], start, 1000.0, &s);
        for (int k = 0; k < 3; k++) { worst = fmax(worst, fabs(0.5 * (b.r_e[k] - a.r_e[k]) - s.v_e[k])); }
        worst = fmax(worst, WORLD_C * fabs(0.5 * (b.clock_s - a.clock_s) - s.clock_rate));
    }
    printf("dr/dt - v of 95 satellites: %.1e m/s\n", worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(1e-4, worst);
}

static void the_next_issue_of_an_ephemeris_describes_the_same_orbit(void)
{
    double worst = 0.0;
    make_sky(SKY_MULTI, true);
    for (int i = 0; i < sky.n; i++) {
        for (int hours = 2; hours <= 180; hours += 89) { /* the last across a week */
            sat_t next = sky.sats[i];
            sat_state_t a;
            sat_state_t b;
            const double dt = 3600.0 * hours;
            sky_ephemeris(&sky.sats[i], start + (pel_time_t)dt * PEL_NS_PER_S, &next.eph);
            TEST_ASSERT_GREATER_THAN_INT64(sky.sats[i].eph.toe_ns, next.eph.toe_ns);
            sky_state(&sky.sats[i], start, dt, &a);
            sky_state(&next, start, dt, &b);
            for (int k = 0; k < 3; k++) { worst = fmax(worst, fabs(a.r_e[k] - b.r_e[k]) / hours); }
            worst = fmax(worst, WORLD_C * fabs(a.clock_s - b.clock_s) / hours);
        }
    }
    printf("orbit of the next issue: %.3f m at most for each hour carried on\n", worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(0.1, worst); /* steps of the message alone */
}

static void geostationary_satellites_stay_where_they_are(void)
{
    int found = 0;
    make_sky(SKY_MULTI, true);
    for (int i = 0; i < sky.n; i++) {
        if (!sky.sats[i].geostationary) { continue; }
        found++;
        for (int hours = 0; hours < 24; hours += 2) {
            sat_state_t s;
            sky_state(&sky.sats[i], start, 3600.0 * hours, &s);
            const double lon[5] = {140.0, 80.0, 110.5, 160.0, 58.75};
            TEST_ASSERT_DOUBLE_WITHIN(0.2, lon[sky.sats[i].eph.prn - 1], atan2(s.r_e[1], s.r_e[0]) / WORLD_DEG);
            TEST_ASSERT_DOUBLE_WITHIN(2e3, 0.0, s.r_e[2]);
        }
    }
    TEST_ASSERT_EQUAL_INT(5, found);
}

static void ambiguities_are_whole_numbers(void)
{
    config.clock_bias_s = 3e-4;
    config.clock_drift = 1e-7;
    speed = 139.0;
    begin();
    receiver_epoch(receiver, &epoch);
    TEST_ASSERT_GREATER_THAN_INT(10, epoch.n);
    for (int i = 0; i < epoch.n; i++) {
        const pel_obs_t *o = &epoch.obs[i];
        const double lambda = WORLD_C / pel_carrier_hz((pel_sys_t)o->sys, (pel_carrier_t)o->carrier, 0);
        const double N = o->L_cyc - o->P_m / lambda;
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, round(N), N);
    }
}

static void doppler_is_the_rate_of_the_phase(void)
{
    double before[PEL_MAX_OBS] = {0.0};
    double now[PEL_MAX_OBS] = {0.0};
    config.interval_ns = 50 * PEL_NS_PER_MS;
    config.clock_bias_s = 1e-4;
    config.clock_drift = 5e-7;
    speed = 139.0;
    make_sky(SKY_IDEAL24, true);
    begin();
    double worst = 0.0;
    for (int k = 0; k < 3; k++) {
        receiver_epoch(receiver, &epoch);
        for (int i = 0; i < epoch.n; i++) {
            if (k == 0) { before[i] = epoch.obs[i].L_cyc; }
            if (k == 1) { now[i] = (double)epoch.obs[i].D_hz; }
            if (k == 2) { worst = fmax(worst, fabs((epoch.obs[i].L_cyc - before[i]) / 0.1 + now[i])); }
        }
    }
    printf("Doppler against phase: %.1e Hz\n", worst);
    TEST_ASSERT_LESS_THAN_DOUBLE(2e-3,
                                 worst); /* the tenth of a hertz's last digit in float, and curvature over 0.1 s */
}

static void noise_has_the_size_asked_for(void)
{
    double sum2[2] = {0.0};
    int n = 0;
    config.code_m = 3.0;
    config.phase_m = 0.003;
    config.interval_ns = 100 * PEL_NS_PER_MS;
    begin();
    receiver_config_t quiet = config;
    quiet.code_m = 0.0;
    quiet.phase_m = 0.0;
    receiver_t *silent = calloc(1, sizeof *silent);
    receiver_init(silent, &quiet, &sky, &air, antenna, NULL, start, 1, 1);
    for (int k = 0; k < 1000; k++) {
        pel_epoch_t truth;
        receiver_epoch(receiver, &epoch);
        receiver_epoch(silent, &truth);
        for (int i = 0; i < epoch.n; i++) {
            const double lambda = (epoch.obs[i].carrier == PEL_CARRIER_L1) ? 0.190294 : 0.244210;
            sum2[0] += pow(epoch.obs[i].P_m - truth.obs[i].P_m, 2.0);
            sum2[1] += pow((epoch.obs[i].L_cyc - truth.obs[i].L_cyc) * lambda, 2.0);
            n++;
        }
    }
    free(silent);
    printf("code %.4f m, phase %.6f m of %d\n", sqrt(sum2[0] / n), sqrt(sum2[1] / n), n);
    TEST_ASSERT_DOUBLE_WITHIN(0.06, 3.0, sqrt(sum2[0] / n));
    TEST_ASSERT_DOUBLE_WITHIN(0.00006, 0.003, sqrt(sum2[1] / n));
}

static void the_ionosphere_delays_the_code_and_advances_the_phase(void)
{
    begin();
    receiver_epoch(receiver, &epoch);
    const pel_epoch_t without = epoch;
    air.iono = IONO_SHELL;
    air.vertical_m = 3.0;
    begin();
    receiver_epoch(receiver, &epoch);
    const pel_obs_t *o = epoch.obs;
    const double code1 = o[0].P_m - without.obs[0].P_m;
    const double code2 = o[1].P_m - without.obs[1].P_m;
    TEST_ASSERT_GREATER_THAN_DOUBLE(3.0, code1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 77.0 * 77.0 / 3600.0, code2 / code1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, -code1, (o[0].L_cyc - without.obs[0].L_cyc) * WORLD_C / 1575.42e6);
}

static void a_told_slip_restarts_the_lock_time_and_a_silent_one_does_not(void)
{
    selector_t who;
    TEST_ASSERT_TRUE(selector_parse("G:1", &who));
    config.happenings[0] = (happening_t){HAPPENS_SLIP, who, 2.5, 0.0, 7.0, false};
    TEST_ASSERT_TRUE(selector_parse("G:2", &who));
    config.happenings[1] = (happening_t){HAPPENS_SLIP, who, 2.5, 0.0, 1.0, true};
    config.n_happenings = 2;
    begin();
    double before[2] = {0.0};
    for (int k = 0; k < 3; k++) {
        receiver_epoch(receiver, &epoch);
        for (int i = 0; i < 2; i++) {
            const double N =
                epoch.obs[i].L_cyc - epoch.obs[i].P_m * pel_carrier_hz(PEL_SYS_GPS, (pel_carrier_t)i, 0) / WORLD_C;
            if (k == 2) {
                TEST_ASSERT_DOUBLE_WITHIN(1e-4, (i == 0) ? 7.0 : 1.0, N - before[i]);
                TEST_ASSERT_EQUAL_UINT32((i == 0) ? 0 : 2000, epoch.obs[i].lock_ms);
            }
            before[i] = N;
        }
    }
}

static void an_outage_silences_one_satellite_for_its_time(void)
{
    selector_t who;
    begin();
    receiver_epoch(receiver, &epoch);
    const int all = epoch.n;
    char name[8];
    (void)snprintf(name, sizeof name, "G%02d", epoch.obs[0].prn);
    TEST_ASSERT_TRUE(selector_parse(name, &who));
    config.happenings[0] = (happening_t){HAPPENS_OUTAGE, who, 1.5, 3.5, 0.0, false};
    config.n_happenings = 1;
    begin();
    const int expected[5] = {all, all - 2, all - 2, all, all};
    for (int k = 0; k < 5; k++) {
        receiver_epoch(receiver, &epoch);
        TEST_ASSERT_EQUAL_INT(expected[k], epoch.n);
    }
    TEST_ASSERT_EQUAL_UINT32(1000, epoch.obs[0].lock_ms); /* locked anew at 4 s */
}

static void an_unresolved_half_cycle_is_flagged_until_it_is_known(void)
{
    config.half_cycle_s = 3.0;
    begin();
    for (int k = 0; k < 5; k++) {
        receiver_epoch(receiver, &epoch);
        for (int i = 0; i < epoch.n; i++) {
            TEST_ASSERT_EQUAL_INT(k < 3, (epoch.obs[i].flags & PEL_OBS_HALF_CYCLE) != 0);
        }
    }
}

static void the_clock_is_steered_by_whole_milliseconds(void)
{
    config.clock_drift = 1e-4; /* 0.1 ms a second */
    config.clock_steering = true;
    begin();
    int jumps = 0;
    double before = 0.0;
    for (int k = 0; k < 25; k++) {
        receiver_epoch(receiver, &epoch);
        if (k > 0 && epoch.clock_reset) {
            jumps++;
            TEST_ASSERT_DOUBLE_WITHIN(0.05, -1.0, (epoch.obs[0].P_m - before) / WORLD_C * 1e3 - 0.1);
        }
        before = epoch.obs[0].P_m;
        TEST_ASSERT_TRUE(fabs(receiver->clock_m) <= 0.6e-3 * WORLD_C);
    }
    TEST_ASSERT_EQUAL_INT(2, jumps);
}

static void signals_and_satellites_are_named_as_in_rinex(void)
{
    signal_t s;
    selector_t w;
    TEST_ASSERT_TRUE(signal_parse("C7I", &s));
    TEST_ASSERT_EQUAL_INT(PEL_CARRIER_E5B, s.carrier);
    TEST_ASSERT_TRUE(signal_parse("C2I", &s));
    TEST_ASSERT_EQUAL_INT(PEL_CARRIER_B1I, s.carrier);
    TEST_ASSERT_FALSE(signal_parse("G7I", &s));
    TEST_ASSERT_FALSE(signal_parse("X1C", &s));
    TEST_ASSERT_FALSE(signal_parse("G1", &s));
    TEST_ASSERT_TRUE(selector_parse("E05:7", &w));
    TEST_ASSERT_EQUAL_INT(5, w.prn);
    TEST_ASSERT_FALSE(selector_parse("E99", &w));
    TEST_ASSERT_FALSE(selector_parse("", &w));
}

/* S3's three transmitters as seen from Changsha. */
static void three_geostationary_satellites_stand_where_they_should(void)
{
    static const double elevation_deg[3] = {46.0, 41.0, 57.0};
    const double changsha[3] = {28.22 * WORLD_DEG, 112.99 * WORLD_DEG, 50.0};
    double r_a[3];
    make_sky(SKY_GEO3, false);
    TEST_ASSERT_EQUAL_INT(3, sky.n);
    world_llh_to_ecef(changsha, r_a);
    for (int i = 0; i < 3; i++) {
        sat_state_t s;
        double u[3], az, el;
        sky_state(&sky.sats[i], start, 0.0, &s);
        for (int k = 0; k < 3; k++) { u[k] = s.r_e[k] - r_a[k]; }
        const double range = sqrt(dot(u, u));
        for (int k = 0; k < 3; k++) { u[k] /= range; }
        world_azel(changsha[0], changsha[1], u, &az, &el);
        TEST_ASSERT_DOUBLE_WITHIN(1.0, elevation_deg[i], el / WORLD_DEG);
    }
}

/* Two receivers of one seed, one with drifting paths: what differs is the same on code and phase, its rate on Doppler, and the receivers' noise stays. */
static void a_drifting_path_is_the_same_on_code_phase_and_doppler(void)
{
    pel_epoch_t still[2], drifting[2];
    config.phase_m = 0.003;
    for (int run = 0; run < 2; run++) {
        config.path_walk_m = (run == 0) ? 0.0 : 2e-4;
        config.path_rate_mps = (run == 0) ? 0.0 : 0.02;
        config.path_accel_mps2 = (run == 0) ? 0.0 : 1e-5;
        begin();
        for (int k = 0; k <= 100; k++) {
            receiver_epoch(receiver, &epoch);
            if (k == 0) { *((run == 0) ? &still[0] : &drifting[0]) = epoch; }
        }
        *((run == 0) ? &still[1] : &drifting[1]) = epoch;
    }
    double sum = 0.0;
    for (int i = 0; i < epoch.n; i++) {
        const pel_obs_t *a = &still[1].obs[i], *b = &drifting[1].obs[i];
        const double lambda = WORLD_C / pel_carrier_hz(PEL_SYS_GPS, (pel_carrier_t)a->carrier, 0);
        const double code = b->P_m - a->P_m;
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, code, lambda * (b->L_cyc - a->L_cyc));
        const double rate = -lambda * (double)(b->D_hz - a->D_hz);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, code, 100.0 * rate); /* the acceleration and the walk make up the rest */
        sum += code * code;
    }
    TEST_ASSERT_TRUE(sqrt(sum / epoch.n) > 0.5 && sqrt(sum / epoch.n) < 5.0); /* 2 m rms after 100 s */
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, still[0].obs[0].P_m, drifting[0].obs[0].P_m);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_ideal_sky_is_that_of_the_published_attitude_system);
    RUN_TEST(satellite_velocity_is_the_derivative_of_its_position);
    RUN_TEST(the_next_issue_of_an_ephemeris_describes_the_same_orbit);
    RUN_TEST(geostationary_satellites_stay_where_they_are);
    RUN_TEST(ambiguities_are_whole_numbers);
    RUN_TEST(doppler_is_the_rate_of_the_phase);
    RUN_TEST(noise_has_the_size_asked_for);
    RUN_TEST(the_ionosphere_delays_the_code_and_advances_the_phase);
    RUN_TEST(a_told_slip_restarts_the_lock_time_and_a_silent_one_does_not);
    RUN_TEST(an_outage_silences_one_satellite_for_its_time);
    RUN_TEST(an_unresolved_half_cycle_is_flagged_until_it_is_known);
    RUN_TEST(the_clock_is_steered_by_whole_milliseconds);
    RUN_TEST(signals_and_satellites_are_named_as_in_rinex);
    RUN_TEST(three_geostationary_satellites_stand_where_they_should);
    RUN_TEST(a_drifting_path_is_the_same_on_code_phase_and_doppler);
    return UNITY_END();
}

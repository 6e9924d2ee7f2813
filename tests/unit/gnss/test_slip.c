/* Slip detectors, each apart, on a simulated receiver in motion; and what tries to hide from them. */
/* build: f32 f64 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "support_gnss.h"
#include "unity.h"

#define GPS    (1u << PEL_SYS_GPS)
#define MS_M   (1e-3 * PEL_SPEED_OF_LIGHT)
#define EPOCHS 8

static pel_orbits_t o;
static pel_slip_t slip;
static pel_epoch_t e;
static pel_view_t view;
static pel_nav_counters_t count;
static scene_t s;
static int step;
static double dt_s;
static uint64_t seed;

static double noise(void) /* about N(0, 1), |.| < 6 */
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        sum += (double)(seed >> 11) * 0x1p-53;
    }
    return sum;
}

void setUp(void)
{
    sky_init(&o);
    pel_slip_init(&slip);
    memset(&count, 0, sizeof count);
    s = scene_default();
    s.v_e[0] = 60.0;
    s.v_e[1] = 40.0;
    s.v_e[2] = -30.0;
    step = 0;
    dt_s = 1.0;
    seed = 88172645463325252u;
}
void tearDown(void) {}

/* The next epoch of the receiver, with 2 mm phase and 3 cm/s Doppler noise, its view from a position known to 1 cm. */
static void advance(void)
{
    if (step > 0) {
        for (int k = 0; k < 3; k++) { s.r_e[k] += s.v_e[k] * dt_s; }
        s.clk_m += s.clk_rate_mps * dt_s;
    }
    scene_observe(&s, &o, SKY_T0 + (int64_t)(step * dt_s * 1e9), GPS, &e);
    (void)pel_view_compute(&e, &o, SKY_T0, s.r_e, s.v_e, 0.1, NULL, &view);
    for (int i = 0; i < e.n; i++) {
        e.obs[i].L_cyc += 0.002 * noise() / pel_obs_lambda_m(&e.obs[i]);
        e.obs[i].P_m += 0.3 * noise();
        e.obs[i].D_hz += (float)(0.03 * noise() / pel_obs_lambda_m(&e.obs[i]));
        e.obs[i].lock_ms = (uint32_t)(10000.0 + 1e3 * step * dt_s);
    }
    step++;
}

static const pel_slip_aid_t AID = {{0.0, 0.0, 0.0}, 0.01};

static void check(const pel_slip_aid_t *aid)
{
    memset(&count, 0, sizeof count);
    pel_slip_check(&slip, &e, &view, aid, &count);
}

static void warm_up(void)
{
    for (int i = 0; i < 3; i++) {
        advance();
        check(&AID);
    }
}

static uint32_t counted(void)
{
    return count.slip_lock + count.slip_half_cycle + count.slip_geometry_free + count.slip_doppler + count.slip_ins;
}

static int marked(void)
{
    int n = 0;
    for (int i = 0; i < e.n; i++) { n += (e.obs[i].flags & PEL_OBS_SLIP) != 0u; }
    return n;
}

static void the_first_epoch_is_marked_and_not_counted(void)
{
    advance();
    check(&AID);
    TEST_ASSERT_EQUAL(e.n, marked());
    TEST_ASSERT_EQUAL(0, counted());
    advance();
    check(&AID);
    TEST_ASSERT_EQUAL(0, marked());
}

static void clean_data_raise_no_alarm(void)
{
    warm_up();
    uint32_t alarms = 0;
    int phases = 0;
    for (int i = 0; i < 300; i++) {
        advance();
        check(&AID);
        alarms += counted();
        phases += e.n;
        TEST_ASSERT_EQUAL(0, count.clock_jumps);
    }
    printf("%d clean phases at 1 Hz: %u alarms\n", phases, (unsigned)alarms);
    TEST_ASSERT_EQUAL(0, alarms);
}

static void lock_time_and_the_receivers_own_flag(void)
{
    warm_up();
    advance();
    e.obs[0].lock_ms = 500; /* fell */
    e.obs[3].flags |= PEL_OBS_SLIP;
    check(&AID);
    TEST_ASSERT_EQUAL(2, count.slip_lock);
    TEST_ASSERT_EQUAL(2, counted());
    TEST_ASSERT_EQUAL(2, marked());

    advance();
    e.obs[0].lock_ms = 501; /* grew */
    check(&AID);
    TEST_ASSERT_EQUAL(0, count.slip_lock); /* coarse lock times are lower bounds: the truth may be twice as long */
    dt_s = 2.0;
    step = 3; /* 2 s later */
    advance();
    e.obs[0].lock_ms = 600;
    check(&AID);
    TEST_ASSERT_EQUAL(1, count.slip_lock);
}

static void no_lock_time_at_all_is_no_slip(void)
{
    for (int i = 0; i < 5; i++) {
        advance();
        for (int k = 0; k < e.n; k++) { e.obs[k].lock_ms = 0; }
        check(&AID);
    }
    TEST_ASSERT_EQUAL(0, marked());
}

static void the_half_cycle_flag_changing_either_way(void)
{
    warm_up();
    advance();
    e.obs[2].flags |= PEL_OBS_HALF_CYCLE;
    check(&AID);
    TEST_ASSERT_EQUAL(1, count.slip_half_cycle);
    advance();
    e.obs[2].flags |= PEL_OBS_HALF_CYCLE;
    check(&AID);
    TEST_ASSERT_EQUAL(0, count.slip_half_cycle);
    advance();
    check(&AID);
    TEST_ASSERT_EQUAL(1, count.slip_half_cycle);
    TEST_ASSERT_EQUAL(1, marked());
}

static void one_cycle_on_one_carrier_is_seen_by_the_other(void)
{
    warm_up();
    advance();
    e.obs[4].L_cyc += 1.0;
    pel_slip_check(&slip, &e, NULL, NULL, &count); /* neither view nor prediction */
    TEST_ASSERT_EQUAL(1, count.slip_geometry_free);
    TEST_ASSERT_EQUAL(1, counted());
    TEST_ASSERT_TRUE(e.obs[4].flags & PEL_OBS_SLIP);
    TEST_ASSERT_TRUE(e.obs[5].flags & PEL_OBS_SLIP); /* either may be the one */
    TEST_ASSERT_EQUAL(2, marked());
}

static void a_slip_told_on_one_carrier_does_not_accuse_the_other(void)
{
    warm_up();
    advance();
    e.obs[4].L_cyc += 40.0;
    e.obs[4].lock_ms = 0;
    check(&AID);
    TEST_ASSERT_EQUAL(1, count.slip_lock);
    TEST_ASSERT_EQUAL(0, count.slip_geometry_free);
    TEST_ASSERT_EQUAL(1, marked());
}

/* 77 cycles of L1 are as long as 60 of L2: their difference does not move at all. 9 and 7 move it by 3 mm. */
static void a_slip_that_hides_from_the_geometry_free_is_caught_by_doppler_and_prediction(void)
{
    const double hidden[][2] = {{77.0, 60.0}, {9.0, 7.0}};
    for (int k = 0; k < 2; k++) {
        setUp();
        warm_up();
        advance();
        e.obs[6].L_cyc += hidden[k][0];
        e.obs[7].L_cyc += hidden[k][1];
        check(&AID);
        TEST_ASSERT_EQUAL(0, count.slip_geometry_free);
        TEST_ASSERT_EQUAL(2, count.slip_doppler);
        TEST_ASSERT_EQUAL(2, count.slip_ins);
        TEST_ASSERT_EQUAL(2, marked());
    }
}

static void four_against_three_is_below_doppler_noise_at_low_rates_and_seen_by_prediction(void)
{
    dt_s = 10.0;
    warm_up();
    advance();
    e.obs[6].L_cyc += 4.0; /* 0.76 m, 28 mm of geometry-free: 5 sigma of a 10 s Doppler mean is 1.8 m */
    e.obs[7].L_cyc += 3.0;
    check(&AID);
    TEST_ASSERT_EQUAL(0, count.slip_doppler);
    TEST_ASSERT_EQUAL(2, count.slip_ins);
    TEST_ASSERT_EQUAL(2, marked());
}

static void single_frequency_slips_are_seen_by_doppler(void)
{
    warm_up();
    advance();
    const int n = e.n;
    for (int i = 0; i < n; i += 2) { e.obs[i / 2] = e.obs[i]; }
    e.n = (uint16_t)(n / 2);
    e.obs[1].L_cyc -= 3.0;
    pel_slip_check(&slip, &e, NULL, NULL, &count);
    TEST_ASSERT_EQUAL(1, count.slip_doppler);
    TEST_ASSERT_EQUAL(0, count.slip_geometry_free);
    TEST_ASSERT_EQUAL(1, marked());
}

static void without_doppler_the_prediction_finds_one_cycle(void)
{
    for (int i = 0; i < 4; i++) {
        advance();
        for (int k = 0; k < e.n; k++) { e.obs[k].flags &= (uint8_t)~PEL_OBS_DOPPLER; }
        if (i == 3) { e.obs[8].L_cyc += 1.0; }
        check(&AID);
    }
    TEST_ASSERT_EQUAL(0, count.slip_doppler);
    TEST_ASSERT_EQUAL(1, count.slip_ins);
    TEST_ASSERT_EQUAL(1, count.slip_geometry_free);
}

/* An update moved the position by half a metre between two views; told so, the prediction is not deceived. */
static void a_corrected_position_is_no_slip(void)
{
    static pel_view_t off;
    const double wrong[3] = {s.r_e[0] + 0.5, s.r_e[1] - 0.3, s.r_e[2] + 0.4};
    advance();
    (void)pel_view_compute(&e, &o, SKY_T0, wrong, s.v_e, 0.1, NULL, &off);
    pel_slip_check(&slip, &e, &off, &AID, &count);
    advance(); /* the view is now from the right place */
    pel_slip_aid_t aid = {{-0.5, 0.3, -0.4}, 0.01};
    check(&aid);
    TEST_ASSERT_EQUAL(0, marked());

    setUp();
    advance();
    pel_slip_check(&slip, &e, &off, &AID, &count);
    advance();
    check(&AID); /* not told */
    TEST_ASSERT_TRUE(count.slip_ins > 0);
}

/* Code jumps by 1 ms and the phase does not (most receivers), or both do. 800 m/s times 1 ms is 4 cycles: the true interval
 * is what counts. */
static void a_clock_jump_is_recognised_and_no_slip(void)
{
    for (int with_phase = 0; with_phase < 2; with_phase++) {
        for (int ms = -2; ms <= 3; ms++) {
            setUp();
            warm_up();
            /* From now on the receiver samples ms earlier by true time, under the same tags. */
            s.clk_m += ms * MS_M;
            const double early_s = 1e-3 * ms;
            for (int i = 0; i < 3; i++) {
                for (int k = 0; k < 3; k++) { s.r_e[k] += s.v_e[k] * (dt_s - ((i == 0) ? early_s : 0.0)); }
                s.clk_m += s.clk_rate_mps * dt_s;
                scene_observe(&s, &o, SKY_T0 + (int64_t)((step * dt_s - early_s) * 1e9), GPS, &e);
                (void)pel_view_compute(&e, &o, SKY_T0, s.r_e, s.v_e, 0.1, NULL, &view);
                for (int k = 0; k < e.n; k++) {
                    e.obs[k].lock_ms = 100000;
                    if (!with_phase) { e.obs[k].L_cyc -= ms * MS_M / pel_obs_lambda_m(&e.obs[k]); }
                }
                check(&AID);
                TEST_ASSERT_EQUAL(0, marked());
                TEST_ASSERT_EQUAL((i == 0 && ms != 0) ? 1 : 0, count.clock_jumps);
                step++;
            }
        }
    }
}

static void a_slip_in_the_epoch_of_a_clock_jump_is_still_found(void)
{
    warm_up();
    s.clk_m += MS_M;
    for (int k = 0; k < 3; k++) { s.r_e[k] += s.v_e[k] * 0.999; }
    scene_observe(&s, &o, SKY_T0 + (int64_t)((step * dt_s - 1e-3) * 1e9), GPS, &e);
    (void)pel_view_compute(&e, &o, SKY_T0, s.r_e, s.v_e, 0.1, NULL, &view);
    for (int k = 0; k < e.n; k++) {
        e.obs[k].lock_ms = 100000;
        e.obs[k].L_cyc -= MS_M / pel_obs_lambda_m(&e.obs[k]);
    }
    e.obs[2].L_cyc += 77.0;
    e.obs[3].L_cyc += 60.0;
    check(&AID);
    TEST_ASSERT_EQUAL(1, count.clock_jumps);
    TEST_ASSERT_EQUAL(2, count.slip_doppler);
    TEST_ASSERT_EQUAL(2, count.slip_ins);
    TEST_ASSERT_EQUAL(2, marked());
}

/* The last signal is missing in one epoch; its lock time when it returns is as given. Marks then. */
static int marked_after_absence(uint32_t lock_ms)
{
    warm_up();
    advance();
    const pel_obs_t kept = e.obs[e.n - 1];
    e.n--;
    check(&AID);
    TEST_ASSERT_EQUAL(0, marked());
    advance();
    TEST_ASSERT_TRUE(e.obs[e.n - 1].prn == kept.prn);
    e.obs[e.n - 1].lock_ms = lock_ms;
    check(&AID);
    return marked();
}

static void a_signal_that_the_line_lost_goes_on_if_it_was_tracked_all_along(void)
{
    TEST_ASSERT_EQUAL(0, marked_after_absence(100000));
}

static void a_signal_that_was_away_and_tells_no_lock_time_returns_marked(void)
{
    TEST_ASSERT_EQUAL(1, marked_after_absence(0));
}

static void a_long_gap_marks_every_signal(void)
{
    warm_up();
    dt_s = 20.0;
    step = 10; /* a gap of 194 s */
    advance();
    check(&AID);
    TEST_ASSERT_EQUAL(e.n, marked());
    step--;
    check(&AID); /* the same epoch again: no time has passed */
    TEST_ASSERT_EQUAL(e.n, marked());
}

static void broken_numbers_do_no_harm(void)
{
    warm_up();
    advance();
    e.obs[0].L_cyc = (double)NAN;
    e.obs[1].P_m = (double)INFINITY;
    e.obs[2].D_hz = NAN;
    e.obs[3].sys = 44;
    check(&AID);
    TEST_ASSERT_EQUAL(0, counted());
    advance();
    check(&AID);
    TEST_ASSERT_EQUAL(0, marked()); /* the two that were broken tell by their lock times that nothing was lost */
    e.n = PEL_MAX_OBS + 1;
    check(&AID);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_first_epoch_is_marked_and_not_counted);
    RUN_TEST(clean_data_raise_no_alarm);
    RUN_TEST(lock_time_and_the_receivers_own_flag);
    RUN_TEST(no_lock_time_at_all_is_no_slip);
    RUN_TEST(the_half_cycle_flag_changing_either_way);
    RUN_TEST(one_cycle_on_one_carrier_is_seen_by_the_other);
    RUN_TEST(a_slip_told_on_one_carrier_does_not_accuse_the_other);
    RUN_TEST(a_slip_that_hides_from_the_geometry_free_is_caught_by_doppler_and_prediction);
    RUN_TEST(four_against_three_is_below_doppler_noise_at_low_rates_and_seen_by_prediction);
    RUN_TEST(single_frequency_slips_are_seen_by_doppler);
    RUN_TEST(without_doppler_the_prediction_finds_one_cycle);
    RUN_TEST(a_corrected_position_is_no_slip);
    RUN_TEST(a_clock_jump_is_recognised_and_no_slip);
    RUN_TEST(a_slip_in_the_epoch_of_a_clock_jump_is_still_found);
    RUN_TEST(a_signal_that_the_line_lost_goes_on_if_it_was_tracked_all_along);
    RUN_TEST(a_signal_that_was_away_and_tells_no_lock_time_returns_marked);
    RUN_TEST(a_long_gap_marks_every_signal);
    RUN_TEST(broken_numbers_do_no_harm);
    return UNITY_END();
}

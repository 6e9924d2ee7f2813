/* link: pel_sim */
/* S2 at the level of the filter: 1000 s of flight, seven satellites, float ambiguities as states in local axes, over seeds, against S2 section 12.
 * Model, mechanization and rows of the library; motion and sensor errors of the simulator; ranges exact, no atmosphere. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "pelorus/ambiguity.h"
#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "pelorus/observe.h"
#include "support_world.h"
#include "unity.h"

enum { SATS = 7, PAIRS = 6, PSI = 9, V = 12, R = 15, AMB = 18, N = 24, SEEDS = 30 };
#define STEP      0.01
#define LAMBDA    (PEL_SPEED_OF_LIGHT / 1575.42e6)
#define ARCSEC    (PEL_DEG / 3600.0)
#define DEG_PER_H (PEL_DEG / 3600.0)

void setUp(void) {}
void tearDown(void) {}

/* The flight of scenarios/s2_flight.toml. */
static void make_motion(motion_t *m)
{
    static const segment_t legs[] = {{20, 0, 0, 0},   {30, 10, 0, 0},   {15, 0, 40, 0},     {5, 0, 0, 0},
                                     {40, 75, 0, 0},  {10, 0, 0, 0},    {115, 65, 0, 2200}, {115, 0, 0, 0},
                                     {50, 0, 90, 0},  {90, 0, 0, 0},    {70, 0, 0, -1150},  {60, 50, 0, 0},
                                     {20, 0, 0, 0},   {80, 0, -135, 0}, {60, -60, 0, 0},    {20, 0, 0, 0},
                                     {85, 0, 0, 900}, {15, 0, 0, 0},    {30, 0, 45, 0},     {70, 0, 0, 0}};
    enum { LEGS = sizeof legs / sizeof legs[0] };
    segment_t flown[LEGS];
    const motion_config_t cfg = {.llh = {32.0 * PEL_DEG, 118.0 * PEL_DEG, 1000.0},
                                 .heading = 30.0 * PEL_DEG,
                                 .bank = true,
                                 .pitch_along_path = true};
    for (int i = 0; i < LEGS; i++) {
        flown[i] = legs[i];
        flown[i].turn *= PEL_DEG;
    }
    TEST_ASSERT_TRUE(motion_init(m, &cfg, flown, LEGS));
}

/* Satellite k of S1's 24 circular orbits, t seconds into the flight (2100 s into the constellation). */
static void satellite(int k, double t, double r[3])
{
    const double a = 26560e3, n = sqrt(3.986005e14 / a) / a, time = 2100.0 + t;
    const int p = k / 4, s = k % 4;
    const double node = 60.0 * p * PEL_DEG - PEL_OMEGA_IE * time;
    const double u = (90.0 * s + 30.0 * p + 7.0 * s * p) * PEL_DEG + n * time, i = 55.0 * PEL_DEG;
    r[0] = a * (cos(u) * cos(node) - sin(u) * cos(i) * sin(node));
    r[1] = a * (cos(u) * sin(node) + sin(u) * cos(i) * cos(node));
    r[2] = a * sin(u) * sin(i);
}

static int chosen[SATS]; /* the pivot first: the highest over the flight */

static double elevation(int k, double t, double lat, double lon)
{
    double sat[3], site[3], u[3], C[3][3];
    satellite(k, t, sat);
    pel_earth_llh_to_ecef(lat, lon, 1000.0, site);
    (void)range_to(sat, site, u);
    pel_earth_C_e_enu(lat, lon, C);
    return asin(pel_dot3(C[2], u));
}

/* Seven satellites above 10 degrees from beginning to end. */
static void choose_satellites(void)
{
    bool taken[24] = {false};
    int n = 0;
    for (; n < SATS; n++) {
        int best = -1;
        double highest = 0.0;
        for (int k = 0; k < 24; k++) {
            double lowest = 10.0;
            for (double t = 0.0; t <= 1000.0; t += 100.0) {
                lowest = fmin(lowest, elevation(k, t, 32.3 * PEL_DEG, 118.5 * PEL_DEG));
            }
            if (!taken[k] && lowest > 10.0 * PEL_DEG && lowest > highest) {
                highest = lowest;
                best = k;
            }
        }
        TEST_ASSERT_GREATER_OR_EQUAL_INT_MESSAGE(0, best, "fewer than seven satellites");
        taken[best] = true;
        chosen[n] = best;
    }
}

typedef struct {
    double phase_m; /* of one receiver's phase, 1 sigma */
    double code_m;  /* 0: no code rows */
    bool fix;       /* integers from the filter's float vector, then conditioning on them */
} noise_t;

typedef struct {
    pel_model_t model;
    pel_ud_t ud;
    pel_strapdown_enu_t s;
    pel_coning_t coning;
    pel_propagator_t prop;
    double b_g[2][3], b_a[3]; /* constant, Markov */
    double amb[PAIRS];
    bool started;
    int fixed_s; /* second of the flight; 0: not yet */
    bool wrong;
} system_t;

static void s2_imu(pel_imu_model_t *imu)
{
    memset(imu, 0, sizeof *imu);
    imu->arw_rad_rts = 0.01 * DEG_PER_H;
    imu->vrw_mps_rts = 1e-6;
    imu->sd_bg_radps = 0.1 * DEG_PER_H;
    imu->sd_gm_radps = 0.1 * DEG_PER_H;
    imu->tau_gm_s = 3600.0;
    imu->sd_am_mps2 = 1e-4 * 9.80665;
    imu->tau_am_s = 1800.0;
}

static void start(system_t *x, const motion_t *m, const pel_imu_model_t *imu, rng_t *rng)
{
    const double sd[9] = {100 * ARCSEC, 100 * ARCSEC, 200 * ARCSEC, 0.3, 0.3, 0.3, 20.0, 20.0, 20.0};
    pel_real s[PEL_MAX_STATES] = {PEL_R(0.0)};
    double error[9];
    state_t truth;
    pel_strapdown_t e = {0};
    memset(x, 0, sizeof *x);
    motion_at(m, 0.0, &truth);
    memcpy(e.C_b_e, truth.C_b_e, sizeof e.C_b_e);
    memcpy(e.v_eb_e, truth.v_eb_e, sizeof e.v_eb_e);
    memcpy(e.r_eb_e, truth.r_eb_e, sizeof e.r_eb_e);
    TEST_ASSERT_EQUAL(PEL_OK, pel_strapdown_to_enu(&e, &x->s));
    for (int i = 0; i < 9; i++) { error[i] = sd[i] * rng_normal(rng); }
    turn_back(x->s.C_b_enu, error);
    for (int i = 0; i < 3; i++) { x->s.v_eb_enu[i] += error[3 + i]; }
    x->s.lon += error[6] / (6.38e6 * cos(x->s.lat));
    x->s.lat += error[7] / 6.37e6;
    x->s.h += error[8];
    pel_model_ins_enu(&x->model, imu);
    TEST_ASSERT_EQUAL(PEL_OK, pel_model_append(&x->model, PEL_BLOCK_AMBIGUITY, PAIRS));
    pel_model_sensor_sd(&x->model, s);
    for (int i = 0; i < 9; i++) { s[PSI + i] = (pel_real)sd[i]; }
    for (int i = 0; i < PAIRS; i++) { s[AMB + i] = PEL_R(160.0); }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&x->ud, N, s));
    pel_coning_init(&x->coning);
    pel_propagator_init(&x->prop, x->s.C_b_enu);
}

static void feed_back(system_t *x)
{
    double psi[3], M, N_radius;
    pel_earth_radii_at(pel_sin(x->s.lat), &M, &N_radius);
    for (int i = 0; i < 3; i++) {
        psi[i] = (double)x->ud.x[PSI + i];
        x->s.v_eb_enu[i] -= (double)x->ud.x[V + i];
        x->b_g[0][i] += (double)x->ud.x[i];
        x->b_g[1][i] += (double)x->ud.x[3 + i];
        x->b_a[i] += (double)x->ud.x[6 + i];
    }
    turn_back(x->s.C_b_enu, psi);
    x->s.lon -= (double)x->ud.x[R] / ((N_radius + x->s.h) * cos(x->s.lat));
    x->s.lat -= (double)x->ud.x[R + 1] / (M + x->s.h);
    x->s.h -= (double)x->ud.x[R + 2];
    for (int i = 0; i < PAIRS; i++) { x->amb[i] -= (double)x->ud.x[AMB + i]; }
    for (int i = 0; i < N; i++) { x->ud.x[i] = PEL_R(0.0); }
    memcpy(x->prop.C_start, x->s.C_b_enu, sizeof x->prop.C_start);
}

/* What both receivers measure, as single differences; observed minus predicted from the system's place, lines of sight in local axes. */
static void differences(const system_t *x, const state_t *truth, const noise_t *noise, double t, rng_t *rng,
                        pel_sd_t sd[SATS])
{
    double base[3], r_e[3], C[3][3], u[3], u_e[3], sat[3];
    pel_earth_llh_to_ecef(32.0 * PEL_DEG, 118.0 * PEL_DEG + 0.001, 20.0, base);
    pel_earth_llh_to_ecef(x->s.lat, x->s.lon, x->s.h, r_e);
    pel_earth_C_e_enu(x->s.lat, x->s.lon, C);
    memset(sd, 0, SATS * sizeof *sd);
    for (int i = 0; i < SATS; i++) {
        satellite(chosen[i], t, sat);
        const double off = range_to(sat, truth->r_eb_e, u) - range_to(sat, r_e, u_e);
        pel_mat3_vec(C, u_e, sd[i].u_e);
        sd[i].phase_m = off + LAMBDA * (1000.0 * i) + noise->phase_m * (rng_normal(rng) - rng_normal(rng));
        sd[i].code_m = off + noise->code_m * (rng_normal(rng) - rng_normal(rng));
    }
}

static void rows(system_t *x, const pel_sd_t sd[SATS], double sigma, bool code)
{
    const pel_antenna_t ant = {.n_states = N, .i_psi = PSI, .i_v = V, .i_r = R};
    const pel_real var = (pel_real)(2.0 * sigma * sigma);
    pel_whiten_t w;
    TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_begin(&w, N, var));
    for (int k = 0; k < PAIRS; k++) {
        const double dd = code ? sd[k + 1].code_m - sd[0].code_m : sd[k + 1].phase_m - sd[0].phase_m;
        pel_row_t row;
        if (code) {
            pel_observe_range(&ant, &sd[k + 1], &sd[0], dd, &row);
        } else {
            if (!x->started) { x->amb[k] = floor(dd / LAMBDA + 0.5); }
            pel_observe_float(&ant, &sd[k + 1], &sd[0], dd - LAMBDA * x->amb[k], AMB + k, LAMBDA, &row);
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_whiten_row(&w, var, &row.z, row.h, &row.var));
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_update(&x->ud, row.h, row.first, row.z, row.var, PEL_R(0.0), NULL));
        pel_whiten_accept(&w, var, row.z, row.h);
    }
    if (!code) { x->started = true; }
}

/* The filter's float vector to the integer search; conditioning on the best by one row each (S2 section 14: success 0.999 and ratio 3). */
static void fix(system_t *x, int second)
{
    static pel_ils_t ils;
    double Q[PEL_TRI(PAIRS)];
    int64_t best[PAIRS];
    if (x->fixed_s == 0) {
        for (int i = 0; i < PAIRS; i++) {
            for (int j = 0; j <= i; j++) { Q[PEL_TRI(i) + j] = (double)pel_ud_cov(&x->ud, AMB + i, AMB + j); }
        }
        if (pel_ils_init(&ils, PAIRS, x->amb, Q, 2, 100000) != PEL_OK || pel_ils_run(&ils, 100000) != PEL_OK) {
            return;
        }
        if (pel_ils_success(&ils) < 0.999 || pel_ils_ratio(&ils) < 3.0) { return; }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ils_get(&ils, 0, best, NULL));
        for (int i = 0; i < PAIRS; i++) {
            pel_real h[PEL_MAX_STATES] = {PEL_R(0.0)};
            h[AMB + i] = PEL_R(1.0);
            const pel_real z = (pel_real)(x->amb[i] - (double)best[i]);
            TEST_ASSERT_EQUAL(PEL_OK, pel_ud_update(&x->ud, h, AMB + i, z, PEL_R(1e-6), PEL_R(0.0), NULL));
            x->wrong = x->wrong || best[i] != 1000 * (i + 1);
        }
        x->fixed_s = second;
    }
}

static void errors_of(const system_t *x, const state_t *truth, double e[9])
{
    pel_strapdown_t t = {0}, mine;
    double C[3][3], psi[3], turned[3][3], C_true[3][3];
    pel_strapdown_from_enu(&x->s, &mine);
    memcpy(t.C_b_e, truth->C_b_e, sizeof t.C_b_e);
    pel_earth_C_e_enu(truth->llh[0], truth->llh[1], C);
    pel_mat3_mul(C, truth->C_b_e, C_true);
    pel_mat3_mult(x->s.C_b_enu, C_true, turned);
    pel_dcm_to_rotvec(turned, psi);
    for (int i = 0; i < 3; i++) { e[i] = psi[i]; }
    local_error(truth, mine.r_eb_e, mine.v_eb_e, &e[6], &e[3]);
}

typedef struct {
    double rms[9], sigma[9]; /* last 200 s; arc seconds, m/s, m, east north up */
    int fixed, wrong, latest_s;
} trial_t;

static void count_fix(const system_t *x, trial_t *sum)
{
    sum->fixed += (x->fixed_s > 0) ? 1 : 0;
    sum->wrong += x->wrong ? 1 : 0;
    if (x->fixed_s > sum->latest_s) { sum->latest_s = x->fixed_s; }
}

static void run(const motion_t *m, const noise_t *noise, uint64_t seed, trial_t *sum)
{
    static system_t x;
    carried_imu_t imu;
    pel_imu_model_t model;
    rng_t rng;
    s2_imu(&model);
    carried_imu_init(&imu, &model, STEP, seed);
    rng_init(&rng, seed, 903);
    start(&x, m, &model, &rng);
    for (int second = 0; second <= 1000; second++) {
        pel_sd_t sd[SATS];
        state_t truth;
        motion_at(m, second, &truth);
        TEST_ASSERT_EQUAL(PEL_OK, pel_propagator_flush_enu(&x.prop, &x.model, &x.s, &x.ud));
        differences(&x, &truth, noise, second, &rng, sd);
        rows(&x, sd, noise->phase_m, false);
        if (noise->code_m > 0.0) { rows(&x, sd, noise->code_m, true); }
        feed_back(&x);
        if (noise->fix) {
            fix(&x, second);
            feed_back(&x);
        }
        TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&x.ud));
        if (second > 800) {
            double e[9];
            errors_of(&x, &truth, e);
            for (int i = 0; i < 9; i++) {
                sum->rms[i] += e[i] * e[i] / 200.0;
                sum->sigma[i] += (double)pel_ud_cov(&x.ud, PSI + i, PSI + i) / 200.0;
            }
        }
        for (int k = 0; k < 100 && second < 1000; k++) {
            double b_g[3], alpha[3], upsilon[3];
            for (int i = 0; i < 3; i++) {
                b_g[i] = x.b_g[0][i] + x.b_g[1][i];
                x.b_g[1][i] *= exp(-STEP / model.tau_gm_s);
                x.b_a[i] *= exp(-STEP / model.tau_am_s);
            }
            carried_imu_step(&imu, m, second + k * STEP, b_g, x.b_a, alpha, upsilon);
            TEST_ASSERT_EQUAL(PEL_OK, pel_strapdown_enu_step(&x.s, &x.coning, alpha, upsilon, STEP, 0));
            TEST_ASSERT_GREATER_OR_EQUAL_INT(
                0, (int)pel_propagator_add_enu(&x.prop, &x.model, x.coning.dv_f_e, STEP, &x.s, &x.ud));
        }
    }
    count_fix(&x, sum);
}

static trial_t trial(const char *name, const noise_t *noise)
{
    trial_t t = {0};
    motion_t m;
    choose_satellites();
    make_motion(&m);
    for (int seed = 1; seed <= SEEDS; seed++) { run(&m, noise, (uint64_t)seed, &t); }
    motion_free(&m);
    printf("  %s, %d seeds, last 200 s, rms (rms / sigma):", name, SEEDS);
    for (int i = 0; i < 9; i++) {
        const double unit = (i < 3) ? ARCSEC : 1.0;
        t.rms[i] = sqrt(t.rms[i] / SEEDS) / unit;
        t.sigma[i] = sqrt(t.sigma[i] / SEEDS) / unit;
        printf(" %.*f (%.2f)", (i < 3) ? 2 : 4, t.rms[i], t.rms[i] / t.sigma[i]);
    }
    if (noise->fix) { printf(" fixed %d, by %d s at the latest, %d wrong", t.fixed, t.latest_s, t.wrong); }
    printf("\n");
    return t;
}

static void hold(const trial_t *t, const double bound[9])
{
    for (int i = 0; i < 9; i++) {
        TEST_ASSERT_LESS_THAN_DOUBLE(bound[i], t->rms[i]);
        TEST_ASSERT_DOUBLE_WITHIN(0.2, 1.0, t->rms[i] / t->sigma[i]);
    }
}

static void phases_of_five_centimetres_alone(void)
{
    const double bound[9] = {5.5, 5.6, 9.0, 0.0033, 0.0027, 0.0041, 0.48, 0.065, 0.23};
    const trial_t t = trial("phase 4.99 cm", &(noise_t){.phase_m = 0.0499});
    hold(&t, bound);
}

static void with_code_of_three_metres(void)
{
    const double bound[9] = {5.5, 5.6, 9.0, 0.0033, 0.0027, 0.0041, 0.12, 0.055, 0.10};
    const trial_t t = trial("phase 4.99 cm, code 3 m", &(noise_t){.phase_m = 0.0499, .code_m = 3.0});
    hold(&t, bound);
}

/* S2 12.4 */
static void phases_of_five_millimetres_with_code_and_their_integers(void)
{
    const double bound[9] = {5.0, 5.2, 7.0, 0.0012, 0.0012, 0.0012, 0.006, 0.004, 0.009};
    const trial_t t = trial("phase 5 mm, code 3 m, integers", &(noise_t){.phase_m = 0.005, .code_m = 3.0, .fix = true});
    hold(&t, bound);
    TEST_ASSERT_EQUAL_INT(SEEDS, t.fixed);
    TEST_ASSERT_EQUAL_INT(0, t.wrong);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(phases_of_five_centimetres_alone);
    RUN_TEST(with_code_of_three_metres);
    RUN_TEST(phases_of_five_millimetres_with_code_and_their_integers);
    return UNITY_END();
}

/* The filter's states in e and in local axes say the same: maps between them against nominal states, rows and covariances across a change. */
/* build: f32 f64 */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "pelorus/bits.h"
#include "pelorus/earth.h"
#include "unity.h"

enum { PSI = 9, V = 12, R = 15, N = 18 };
#define BEYOND (88.95 * PEL_DEG) /* where local axes have ended */
#define BEFORE (88.7 * PEL_DEG)
#define LON    (0.9999 * PEL_PI) /* beside the date line */

static pel_navigator_t nav;
static const double LENGTH[9] = {1e-4, -2e-4, 3e-4, 0.2, -0.3, 0.1, 7.0, -9.0, 4.0}; /* rad, m/s, m */

static pel_strapdown_enu_t place(double lat)
{
    const double phi[3] = {0.3, -0.2, 1.1};
    pel_strapdown_enu_t s = {.lat = lat, .lon = LON, .h = 900.0, .v_eb_enu = {120.0, -160.0, 3.0}};
    pel_rotvec_to_dcm(phi, s.C_b_enu);
    return s;
}

/* The state that is off by LENGTH in local axes. */
static pel_strapdown_enu_t off(const pel_strapdown_enu_t *true_state)
{
    pel_strapdown_enu_t s = *true_state;
    double turn[3][3], M, N_radius;
    pel_earth_radii_at(sin(s.lat), &M, &N_radius);
    pel_rotvec_to_dcm(LENGTH, turn);
    pel_mat3_mul(turn, true_state->C_b_enu, s.C_b_enu);
    for (int k = 0; k < 3; k++) { s.v_eb_enu[k] += LENGTH[3 + k]; }
    s.lon += LENGTH[6] / ((N_radius + s.h) * cos(s.lat));
    s.lat += LENGTH[7] / (M + s.h);
    s.h += LENGTH[8];
    return s;
}

/* Error of the second against the first, in e. */
static void error_e(const pel_strapdown_enu_t *true_state, const pel_strapdown_enu_t *computed, double e[9])
{
    pel_strapdown_t a, b;
    double turned[3][3];
    pel_strapdown_from_enu(true_state, &a);
    pel_strapdown_from_enu(computed, &b);
    pel_mat3_mult(b.C_b_e, a.C_b_e, turned);
    pel_dcm_to_rotvec(turned, e);
    for (int k = 0; k < 3; k++) {
        e[3 + k] = b.v_eb_e[k] - a.v_eb_e[k];
        e[6 + k] = b.r_eb_e[k] - a.r_eb_e[k];
    }
}

static void stand_at(double lat, bool local)
{
    pel_nav_config_t cfg;
    pel_real sd[N];
    pel_nav_config_default(&cfg);
    cfg.preset = PEL_PRESET_INS_FLOAT;
    pel_navigator_init(&nav, &cfg);
    const pel_strapdown_enu_t s = place(lat);
    pel_strapdown_from_enu(&s, &nav.at_horizon);
    pel_model_ins_enu(&nav.model, &cfg.imu);
    for (int i = 0; i < N; i++) { sd[i] = (pel_real)(0.01 * (i + 1)); }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_init(&nav.ud, N, sd));
    nav.ins = true;
    nav.local = local;
}

static void is_error(const double expected[9])
{
    for (int i = 0; i < 9; i++) {
        const double scale = fabs(LENGTH[3 * (i / 3)]) + fabs(LENGTH[3 * (i / 3) + 1]);
        TEST_ASSERT_DOUBLE_WITHIN(2e-3 * scale, expected[i],
                                  (double)nav.ud.x[PSI + i]); /* second order of 9 m at 54 = tan(lat) */
    }
}

void setUp(void) {}
void tearDown(void) {}

static void leaving_local_axes_an_error_is_that_of_the_states_in_e(void)
{
    double e[9];
    stand_at(BEYOND, true);
    const pel_strapdown_enu_t true_state = place(BEYOND);
    const pel_strapdown_enu_t wrong = off(&true_state);
    error_e(&true_state, &wrong, e);
    for (int i = 0; i < 9; i++) { nav.ud.x[PSI + i] = (pel_real)LENGTH[i]; }
    TEST_ASSERT_EQUAL(PEL_OK, pel_nav_choose_axes(&nav));
    TEST_ASSERT_FALSE(nav.local);
    is_error(e);
}

static void entering_local_axes_an_error_is_that_of_the_states_in_them(void)
{
    double e[9];
    stand_at(BEFORE, false);
    const pel_strapdown_enu_t true_state = place(BEFORE);
    const pel_strapdown_enu_t wrong = off(&true_state);
    error_e(&true_state, &wrong, e);
    for (int i = 0; i < 9; i++) { nav.ud.x[PSI + i] = (pel_real)e[i]; }
    TEST_ASSERT_EQUAL(PEL_OK, pel_nav_choose_axes(&nav));
    TEST_ASSERT_TRUE(nav.local);
    is_error(LENGTH);
}

/* Correlations between all states, of the size that hours of flight leave. */
static void mix(void)
{
    for (int i = 0; i < 40; i++) {
        pel_real c[PEL_MAX_STATES];
        for (int k = 0; k < N; k++) { c[k] = (pel_real)(0.01 * sin(1.7 * i + 2.3 * k * k)); }
        pel_ud_rank_one(&nav.ud, N, c, PEL_R(1.0));
    }
}

static void rows_and_covariances_do_not_notice(void)
{
    const pel_sd_t sat = {.u_e = {0.6, 0.64, 0.48}}, pivot = {.u_e = {-0.48, 0.8, 0.36}};
    const pel_antenna_t ant = {
        .lever_e = {0.5, -1.0, 2.0}, .lever_rate_e = {0.1, 0.2, -0.1}, .n_states = N, .i_psi = PSI, .i_v = V, .i_r = R};
    pel_nav_axes_t axes;
    pel_row_t row[2];
    double before[3][3], after[3][3];
    pel_real var[2];
    stand_at(45.0 * PEL_DEG, false); /* what they leave out is small there */
    mix();
    pel_nav_axes(&nav, &axes);
    TEST_ASSERT_FALSE(axes.local);
    pel_nav_block_e(&nav, &axes, V, R, before);
    pel_observe_range(&ant, &sat, &pivot, 1.0, &row[0]);
    pel_observe_rate(&ant, &sat, &pivot, 1.0, &row[1]);
    for (int k = 0; k < 2; k++) { var[k] = pel_ud_hph(&nav.ud, row[k].h, row[k].first); }

    TEST_ASSERT_EQUAL(PEL_OK, pel_nav_choose_axes(&nav));
    pel_nav_axes(&nav, &axes);
    TEST_ASSERT_TRUE(axes.local);
    pel_nav_block_e(&nav, &axes, V, R, after);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { TEST_ASSERT_DOUBLE_WITHIN(3e-6, before[i][j], after[i][j]); }
    }
    for (int k = 0; k < 2; k++) {
        const pel_real h0 = row[k].h[R];
        pel_nav_turn_row(&axes, &ant, &row[k]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-4 * (double)var[k], (double)var[k],
                                  (double)pel_ud_hph(&nav.ud, row[k].h, row[k].first));
        TEST_ASSERT_TRUE(k == 1 || fabs((double)(row[k].h[R] - h0)) > 0.1);
    }
    TEST_ASSERT_EQUAL(PEL_OK, pel_ud_check(&nav.ud));
}

static void between_the_two_latitudes_nothing_changes(void)
{
    for (int local = 0; local < 2; local++) {
        stand_at(88.85 * PEL_DEG, local != 0);
        mix();
        const uint32_t hash = pel_ud_hash(&nav.ud, PEL_FNV_START);
        TEST_ASSERT_EQUAL(PEL_OK, pel_nav_choose_axes(&nav));
        TEST_ASSERT_EQUAL(local != 0, nav.local);
        TEST_ASSERT_EQUAL_UINT32(hash, pel_ud_hash(&nav.ud, PEL_FNV_START));
    }
}

static void presets_in_e_stay_there(void)
{
    stand_at(0.5, false);
    nav.cfg.preset = PEL_PRESET_INS_RTK;
    TEST_ASSERT_EQUAL(PEL_OK, pel_nav_choose_axes(&nav));
    TEST_ASSERT_FALSE(nav.local);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(leaving_local_axes_an_error_is_that_of_the_states_in_e);
    RUN_TEST(entering_local_axes_an_error_is_that_of_the_states_in_them);
    RUN_TEST(rows_and_covariances_do_not_notice);
    RUN_TEST(between_the_two_latitudes_nothing_changes);
    RUN_TEST(presets_in_e_stay_there);
    return UNITY_END();
}

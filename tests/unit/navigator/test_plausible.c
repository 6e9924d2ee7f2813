/* Epochs and an INS that contradict themselves: a base away from its place, Doppler against the INS; and what variances learn. */
/* with: carried pair gnss */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/navigator/internal.h"
#include "support_carried.h"
#include "unity.h"

static carried_t world;
static pel_navigator_t nav;
static pel_epoch_t base, rover;

void setUp(void)
{
    carried_init(&world, &nav, 1.0, true);
    pel_nav_config_t cfg = nav.cfg;
    cfg.slice_nodes = 0;
    carried_introduce(&world, &nav, &cfg);
    carried_run(&world, &nav, 5);
    carried_observe(&world, &base, &rover);
    TEST_ASSERT_EQUAL(
        PEL_OK, pel_view_compute(&base, &nav.orbits, base.t_ns, nav.station.r_ea_e, NULL, 0.0, NULL, &nav.view_base));
}

void tearDown(void) {}

/* ---- the base ------------------------------------------------------------------------------------------------------------------ */

/* Codes of L1 that are wrong by so much, of every second satellite. */
static void spoil(int satellites, double off_m)
{
    for (int i = 0, k = 0; i < base.n && k < satellites; i++) {
        if (base.obs[i].carrier != PEL_CARRIER_L1) { continue; }
        base.obs[i].P_m += ((k % 2 == 0) ? 1.0 : -1.0) * off_m * (1.0 + k);
        k++;
    }
}

static void a_base_is_believed_if_half_of_its_codes_agree(void)
{
    TEST_ASSERT_TRUE(pel_nav_base_is_plausible(&nav, &base));
    for (int i = 0; i < base.n; i++) { base.obs[i].P_m += 3e5; } /* a clock: nothing to the point */
    TEST_ASSERT_TRUE(pel_nav_base_is_plausible(&nav, &base));
    spoil(2, 5000.0);
    TEST_ASSERT_TRUE(pel_nav_base_is_plausible(&nav, &base));
    spoil(100, 5000.0);
    TEST_ASSERT_FALSE(pel_nav_base_is_plausible(&nav, &base));
}

static void four_codes_are_too_few_to_judge(void)
{
    spoil(100, 5000.0);
    base.n = 8; /* of two carriers */
    TEST_ASSERT_TRUE(pel_nav_base_is_plausible(&nav, &base));
    base.n = 10;
    TEST_ASSERT_FALSE(pel_nav_base_is_plausible(&nav, &base));
}

static void only_codes_of_one_clock_and_carrier_are_compared(void)
{
    spoil(100, 5000.0);
    for (int i = 0; i < base.n; i++) {
        if (base.obs[i].carrier == PEL_CARRIER_L1) { base.obs[i].flags &= (uint8_t)~PEL_OBS_CODE; }
    }
    TEST_ASSERT_TRUE(pel_nav_base_is_plausible(&nav, &base)); /* L2 is as it should be */
    base.obs[0].flags |= PEL_OBS_CODE;
    base.obs[0].prn = 32; /* not in view */
    TEST_ASSERT_TRUE(pel_nav_base_is_plausible(&nav, &base));
}

/* One satellite told again and again, by an epoch that says it is longer than it can be. */
static void a_base_epoch_of_repetitions_is_bounded(void)
{
    for (int i = 1; i < PEL_MAX_OBS; i++) { base.obs[i] = base.obs[0]; }
    base.n = PEL_MAX_OBS;
    TEST_ASSERT_TRUE(pel_nav_base_is_plausible(&nav, &base));
    for (int i = 0; i < PEL_MAX_OBS; i++) { base.obs[i].flags = 0; }
    base.n = UINT16_MAX;
    TEST_ASSERT_TRUE(pel_nav_base_is_plausible(&nav, &base));
}

/* ---- the INS -------------------------------------------------------------------------------------------------------------------- */

/* n Dopplers of which so many were used; has it been contradicted? */
static bool contradicted(int n, int used)
{
    nav.n_sats = n;
    for (int i = 0; i < n; i++) {
        nav.sats[i].sd_doppler_mps = 0.1f;
        nav.sats[i].flags = (i < used) ? PEL_SAT_DOPPLER_USED : PEL_SAT_EXCLUDED;
    }
    return pel_nav_ins_is_contradicted(&nav);
}

static void three_epochs_of_refused_doppler_contradict_the_ins(void)
{
    TEST_ASSERT_FALSE(contradicted(9, 2) || contradicted(9, 2));
    TEST_ASSERT_TRUE(contradicted(9, 2));
    TEST_ASSERT_FALSE(contradicted(9, 3)); /* a third agrees */
    TEST_ASSERT_FALSE(contradicted(9, 2) || contradicted(9, 2));
    TEST_ASSERT_FALSE(contradicted(4, 0)); /* too few to say so */
    TEST_ASSERT_FALSE(contradicted(5, 0) || contradicted(5, 1));
    nav.ins = false; /* there is none */
    TEST_ASSERT_FALSE(contradicted(9, 0));
    TEST_ASSERT_EQUAL_INT(0, nav.restless);
}

/* ---- variances ------------------------------------------------------------------------------------------------------------------- */

static void levels_are_learnt_once_a_second_against_a_base_at_each_epoch_alone(void)
{
    static const struct {
        bool wanted, relative;
        double since_s;
        bool learns;
    } of[] = {{true, true, 1.0, true},  {false, true, 1.0, false}, {true, false, 0.1, true},
              {true, true, 0.5, false}, {true, true, -3.0, true}, /* time began anew */
              {true, true, 0.0, false}};
    for (int i = 0; i < 6; i++) {
        nav.cfg.learn_noise = of[i].wanted;
        nav.relative = of[i].relative;
        nav.noise_level.learnt_ns = nav.at_horizon.t_ns - (int64_t)(of[i].since_s * 1e9);
        pel_nav_noise_level_begin(&nav, 1.0);
        TEST_ASSERT_EQUAL_INT(of[i].learns, nav.noise_level.learning);
    }
    nav.noise_level.learnt_ns = 0; /* the first ever */
    pel_nav_noise_level_begin(&nav, 1.0);
    TEST_ASSERT_EQUAL_FLOAT(1.0f, nav.noise_level.share);
}

static void levels_have_limits_and_a_memory(void)
{
    const pel_sd_t sd = {.sys = PEL_SYS_GPS, .carrier = PEL_CARRIER_L1};
    static const float LEAST[2] = {0.1f, 0.5f}, MOST[2] = {10.0f, 4.0f};
    nav.noise_level.share = nav.noise_level.code_inflated_by = 1.0f;
    for (int kind = 0; kind < 2; kind++) {
        const pel_noise_factor_t *f = &nav.noise_level.of[kind][PEL_SYS_GPS][PEL_CARRIER_L1];
        for (int i = 0; i < 400; i++) { pel_nav_noise_level_learn(&nav, &sd, kind, 1e3, 0.0, 1.0); }
        TEST_ASSERT_EQUAL_FLOAT(MOST[kind], f->factor);
        TEST_ASSERT_EQUAL_FLOAT(150.0f, f->rows);
        for (int i = 0; i < 4000; i++) { pel_nav_noise_level_learn(&nav, &sd, kind, 0.0, 0.0, 1.0); }
        TEST_ASSERT_EQUAL_FLOAT(LEAST[kind], f->factor);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(a_base_is_believed_if_half_of_its_codes_agree);
    RUN_TEST(four_codes_are_too_few_to_judge);
    RUN_TEST(only_codes_of_one_clock_and_carrier_are_compared);
    RUN_TEST(a_base_epoch_of_repetitions_is_bounded);
    RUN_TEST(three_epochs_of_refused_doppler_contradict_the_ins);
    RUN_TEST(levels_are_learnt_once_a_second_against_a_base_at_each_epoch_alone);
    RUN_TEST(levels_have_limits_and_a_memory);
    return UNITY_END();
}

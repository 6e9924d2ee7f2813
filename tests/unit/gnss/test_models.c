/* build: f32 f64 */
/* Models of one satellite and one signal at their limits: atmosphere, group delays, orbits that cannot be, what counts as a measurement. */
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "pelorus/math.h"
#include "support_gnss.h"
#include "unity.h"

static pel_orbits_t sky, o;
static pel_sat_state_t state;

void setUp(void)
{
    sky_init(&sky);
    pel_orbits_init(&o);
    memset(&state, 0, sizeof state);
}

void tearDown(void) {}

/* ---- atmosphere ----------------------------------------------------------------------------------------------------------------- */

static const pel_klobuchar_t NONE = {.valid = false};

static void what_is_no_number_has_no_delay(void)
{
    for (int i = 0; i < 4; i++) {
        double x[4] = {0.6, 2.0, 1.0, 0.5};
        x[i] = (i % 2 == 0) ? NAN : INFINITY;
        if (i < 3) { TEST_ASSERT_EQUAL_DOUBLE(0.0, pel_tropo_saastamoinen_m(x[0], 1e3 * x[1], x[2])); }
        TEST_ASSERT_EQUAL_DOUBLE(0.0, pel_iono_klobuchar_m(&NONE, SKY_T0, x[0], x[1], x[2], x[3]));
    }
    TEST_ASSERT_TRUE(pel_tropo_saastamoinen_m(0.6, 2e3, 1.0) > 1.0);
    TEST_ASSERT_TRUE(pel_iono_klobuchar_m(&NONE, SKY_T0, 0.6, 2.0, 1.0, 0.5) > 0.5);
}

static void the_troposphere_ends_and_thins_and_is_no_worse_below_three_degrees(void)
{
    TEST_ASSERT_EQUAL_DOUBLE(0.0, pel_tropo_saastamoinen_m(0.6, 20000.1, 1.0));
    TEST_ASSERT_DOUBLE_WITHIN(0.2, 2.4, pel_tropo_saastamoinen_m(0.6, 0.0, PEL_PI / 2.0));
    TEST_ASSERT_TRUE(pel_tropo_saastamoinen_m(0.6, 20000.0, 1.0) < 0.2);
    TEST_ASSERT_EQUAL_DOUBLE(pel_tropo_saastamoinen_m(0.6, -500.0, 1.0), pel_tropo_saastamoinen_m(0.6, -3000.0, 1.0));
    const double lowest = pel_tropo_saastamoinen_m(0.6, 0.0, 3.0 * PEL_DEG);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, lowest, pel_tropo_saastamoinen_m(0.6, 0.0, -0.5));
}

/* By night 5 ns of zenith delay (IS-GPS-200), by day more; beyond 75 degrees of latitude as at 75. */
static void the_ionosphere_has_a_night_and_ends_at_the_poles(void)
{
    const double lon = 0.0, zenith = PEL_PI / 2.0;
    const pel_time_t midnight = SKY_T0 - (pel_time_t)(pel_time_tow_s(SKY_T0) * 1e9);
    const double night_m = pel_iono_klobuchar_m(&NONE, midnight + 2 * 3600 * PEL_NS_PER_S, 0.5, lon, 0.0, zenith);
    const double noon_m = pel_iono_klobuchar_m(&NONE, midnight + 14 * 3600 * PEL_NS_PER_S, 0.5, lon, 0.0, zenith);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 5e-9 * PEL_SPEED_OF_LIGHT, night_m);
    TEST_ASSERT_TRUE(noon_m > 1.5 * night_m);
    TEST_ASSERT_DOUBLE_WITHIN(
        1e-9, pel_iono_klobuchar_m(&NONE, midnight, 0.5, lon, 1.0, 0.0),
        pel_iono_klobuchar_m(&NONE, midnight, 0.5, lon, 1.0, -0.3)); /* below the horizon: as on it */
    for (int south = 0; south < 2; south++) {
        const double az = south ? PEL_PI : 0.0, sign = south ? -1.0 : 1.0;
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, pel_iono_klobuchar_m(&NONE, midnight, sign * 80.0 * PEL_DEG, lon, az, 0.2),
                                  pel_iono_klobuchar_m(&NONE, midnight, sign * 88.0 * PEL_DEG, lon, az, 0.2));
    }
}

static void coefficients_that_give_less_than_nothing_give_nothing(void)
{
    const pel_klobuchar_t dark = {.valid = true, .alpha = {-1e-7f, 0, 0, 0}, .beta = {1e5f, 0, 0, 0}};
    const pel_klobuchar_t quick = {.valid = true, .alpha = {3e-8f, 0, 0, 0}, .beta = {100.0f, 0, 0, 0}};
    const pel_klobuchar_t least = {.valid = true, .alpha = {3e-8f, 0, 0, 0}, .beta = {72000.0f, 0, 0, 0}};
    for (int hour = 0; hour < 24; hour++) {
        const pel_time_t t = SKY_T0 + hour * 3600 * PEL_NS_PER_S;
        TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.5, pel_iono_klobuchar_m(&dark, t, 0.5, 0.0, 0.0, PEL_PI / 2.0));
        TEST_ASSERT_EQUAL_DOUBLE(pel_iono_klobuchar_m(&least, t, 0.5, 0.0, 0.0, 0.7), /* periods of 20 hours at least */
                                 pel_iono_klobuchar_m(&quick, t, 0.5, 0.0, 0.0, 0.7));
    }
}

/* ---- signals ---------------------------------------------------------------------------------------------------------------------- */

static void what_is_broadcast_delays_the_carriers_it_is_of(void)
{
    static const struct {
        uint8_t sys, prn;
        pel_carrier_t carrier;
        double first, second; /* of the two broadcast numbers */
    } of[] = {
        {PEL_SYS_GPS, 5, PEL_CARRIER_L1, 1.0, 0.0},       {PEL_SYS_GPS, 5, PEL_CARRIER_L2, 1.6469444, 0.0},
        {PEL_SYS_GPS, 5, PEL_CARRIER_L5, 0.0, 0.0},       {PEL_SYS_QZS, 2, PEL_CARRIER_L1, 1.0, 0.0},
        {PEL_SYS_QZS, 2, PEL_CARRIER_L2, 1.6469444, 0.0}, {PEL_SYS_QZS, 2, PEL_CARRIER_L5, 0.0, 0.0},
        {PEL_SYS_GAL, 5, PEL_CARRIER_L1, 0.0, 1.0},       {PEL_SYS_GAL, 5, PEL_CARRIER_L2, 0.0, 0.0},
        {PEL_SYS_GLO, 5, PEL_CARRIER_L1, 0.0, 0.0},       {PEL_SYS_GLO, 5, PEL_CARRIER_L2, 1.0, 0.0},
        {PEL_SYS_BDS, 8, PEL_CARRIER_B1I, 1.0, 0.0},      {PEL_SYS_BDS, 8, PEL_CARRIER_E5B, 0.0, 1.0},
        {PEL_SYS_BDS, 30, PEL_CARRIER_E5B, 0.0, 0.0},     {PEL_SYS_BDS, 30, PEL_CARRIER_L1, 1.0, 0.0},
        {PEL_SYS_SBS, 5, PEL_CARRIER_L1, 0.0, 0.0},       {PEL_SYS_GPS, 5, PEL_N_CARRIER, 0.0, 0.0},
        {PEL_SYS_GPS, 5, (pel_carrier_t)-1, 0.0, 0.0},
    };
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        const pel_ephemeris_t eph = {.sys = of[i].sys, .prn = of[i].prn, .tgd_s = {1e-8, 3e-8}};
        const double expected = PEL_SPEED_OF_LIGHT * (of[i].first * 1e-8 + of[i].second * 3e-8);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, expected, pel_sat_group_delay_m(&eph, of[i].carrier));
    }
}

static void a_measurement_has_a_satellite_a_wave_and_a_size(void)
{
    const pel_obs_t good = {.P_m = 2.2e7, .L_cyc = 1e8, .D_hz = 100.0f, .sys = PEL_SYS_GPS, .prn = 5, .flags = 0xFF};
    pel_obs_t obs = good;
    for (unsigned part = 1; part <= 4; part *= 2) { TEST_ASSERT_TRUE(pel_obs_usable(&obs, part)); }
    TEST_ASSERT_FALSE(pel_obs_usable(&obs, 0x08u)); /* a flag, but no measurement */
    obs.prn = 0;
    TEST_ASSERT_FALSE(pel_obs_usable(&obs, PEL_OBS_CODE));
    obs.prn = 33;
    TEST_ASSERT_FALSE(pel_obs_usable(&obs, PEL_OBS_CODE));
    obs = good;
    obs.carrier = PEL_N_CARRIER;
    TEST_ASSERT_FALSE(pel_obs_usable(&obs, PEL_OBS_CODE));
    static const double CODES[] = {1.0e7, 6.0e7, NAN, -2.2e7}, PHASES[] = {0.0, 1.0e10, -1.0e10, NAN};
    static const float DOPPLERS[] = {1e5f, -1e5f, NAN, INFINITY};
    for (int i = 0; i < 4; i++) {
        obs = good;
        obs.P_m = CODES[i];
        obs.L_cyc = PHASES[i];
        obs.D_hz = DOPPLERS[i];
        for (unsigned part = 1; part <= 4; part *= 2) { TEST_ASSERT_FALSE(pel_obs_usable(&obs, part)); }
    }
}

static void noise_is_bounded_at_the_horizon(void)
{
    pel_noise_config_t noise;
    pel_noise_default(&noise);
    const double lowest = pel_noise_var(&noise, PEL_OBS_PHASE, 0.04, 45.0);
    TEST_ASSERT_EQUAL_DOUBLE(lowest, pel_noise_var(&noise, PEL_OBS_PHASE, -1.0, 45.0));
    TEST_ASSERT_EQUAL_DOUBLE(lowest, pel_noise_var(&noise, PEL_OBS_PHASE, NAN, 45.0));
    TEST_ASSERT_TRUE(lowest > pel_noise_var(&noise, PEL_OBS_PHASE, 0.06, 45.0));
}

/* A carrier that there is none of is not bent by the ionosphere, nor by anything else of it. */
static void a_carrier_that_is_none_has_no_ionosphere(void)
{
    const pel_sight_t s = {.sys = PEL_SYS_GPS, .prn = 3, .rho_m = 2.1e7, .iono_L1_m = 5.0, .tropo_m = 2.0};
    pel_obs_t obs = {.sys = PEL_SYS_GPS, .prn = 3, .carrier = PEL_CARRIER_L1};
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.1e7 + 7.0, pel_sight_code_m(&s, &obs));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.1e7 - 3.0, pel_sight_phase_m(&s, &obs));
    obs.carrier = PEL_N_CARRIER;
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.1e7 + 2.0, pel_sight_code_m(&s, &obs));
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 2.1e7 + 2.0, pel_sight_phase_m(&s, &obs));
}

/* ---- orbits ------------------------------------------------------------------------------------------------------------------------- */

typedef struct {
    size_t at;
    char type; /* d double, f float, t time, b byte */
    double value;
    bool good;
} field_t;

#define OF(member) offsetof(pel_ephemeris_t, member)

static void put(pel_ephemeris_t *e, const field_t *f)
{
    const float f32 = (float)f->value;
    const int64_t t = (f->type == 't') ? (int64_t)f->value : 0;
    const int8_t b = (f->type == 'b') ? (int8_t)(int)f->value : 0;
    uint8_t *to = (uint8_t *)e + f->at;
    switch (f->type) {
    case 'd': memcpy(to, &f->value, 8); break;
    case 'f': memcpy(to, &f32, 4); break;
    case 't': memcpy(to, &t, 8); break;
    default: memcpy(to, &b, 1); break;
    }
}

static void each_taken_or_not(const pel_ephemeris_t *model, const field_t list[], size_t n)
{
    for (size_t i = 0; i < n; i++) {
        pel_ephemeris_t e = *model;
        put(&e, &list[i]);
        pel_orbits_init(&o);
        TEST_ASSERT_EQUAL_INT(list[i].good ? PEL_OK : PEL_E_RANGE, pel_orbits_add(&o, &e));
        TEST_ASSERT_EQUAL_INT(list[i].good, o.n);
    }
}

static void elements_have_limits(void)
{
    static const field_t KEPLER[] = {
        {OF(sys), 'b', PEL_N_SYS, false}, {OF(sys), 'b', PEL_SYS_SBS, false}, {OF(prn), 'b', 0, false},
        {OF(prn), 'b', 32, true},         {OF(prn), 'b', 33, false},          {OF(sqrt_a), 'd', 4000.0, false},
        {OF(sqrt_a), 'd', 7000.0, false}, {OF(sqrt_a), 'd', 6999.0, true},    {OF(e), 'd', -1e-9, false},
        {OF(e), 'd', 0.0, true},          {OF(e), 'd', 0.5, false},           {OF(M0), 'd', 10.0, false},
        {OF(omega), 'd', -10.0, false},   {OF(Omega0), 'd', 10.0, false},     {OF(i0), 'd', 4.0, false},
        {OF(dn), 'd', 1e-6, false},       {OF(dn), 'd', -9e-7, true},         {OF(cis), 'd', NAN, false},
        {OF(idot), 'd', INFINITY, false}, {OF(af0), 'd', 0.1, false},         {OF(af1), 'd', NAN, false},
        {OF(af2), 'd', INFINITY, false},  {OF(tgd_s[0]), 'd', 1e-5, false},   {OF(tgd_s[1]), 'd', -1e-5, false},
        {OF(fit_s), 'f', -1.0, false},    {OF(fit_s), 'f', 1e6, false},       {OF(fit_s), 'f', 0.0, true},
        {OF(sd_ura_m), 'f', -0.1, false}, {OF(sd_ura_m), 'f', NAN, false},    {OF(toe_ns), 't', 0.0, false},
        {OF(toc_ns), 't', -1.0, false},   {OF(toc_ns), 't', 1.0, true},
    };
    each_taken_or_not(&sky.eph[0], KEPLER, sizeof KEPLER / sizeof KEPLER[0]);
    static const field_t GLONASS[] = {
        {OF(glo.r_e[0]), 'd', 0.0, false}, {OF(glo.r_e[1]), 'd', 3e7, false},  {OF(glo.v_e[0]), 'd', 4900.0, false},
        {OF(glo.v_e[1]), 'd', NAN, false}, {OF(glo.a_e[2]), 'd', 1e-4, false}, {OF(glo.k), 'b', -8, false},
        {OF(glo.k), 'b', 7, false},        {OF(glo.k), 'b', 6, true},          {OF(glo.k), 'b', -7, true},
        {OF(glo.a_e[2]), 'd', 9e-5, true},
    };
    pel_ephemeris_t glonass = {.sys = PEL_SYS_GLO, .prn = 1, .toe_ns = SKY_T0, .toc_ns = SKY_T0};
    glonass.glo.r_e[0] = 2.55e7;
    glonass.glo.v_e[1] = 3000.0;
    glonass.glo.v_e[2] = 1500.0;
    each_taken_or_not(&glonass, GLONASS, sizeof GLONASS / sizeof GLONASS[0]);
    glonass.glo.v_e[1] = glonass.glo.v_e[2] = 1000.0; /* too slow to stay up */
    TEST_ASSERT_EQUAL_INT(PEL_E_RANGE, pel_orbits_add(&o, &glonass));
}

/* Elements that came past the store. */
static void a_state_of_elements_that_cannot_be_is_refused(void)
{
    static const field_t BAD[] = {
        {OF(sqrt_a), 'd', 1000.0, false}, {OF(sqrt_a), 'd', NAN, false}, {OF(e), 'd', -0.01, false},
        {OF(e), 'd', 0.5, false},         {OF(e), 'd', NAN, false},      {OF(M0), 'd', 1001.0, false},
        {OF(M0), 'd', NAN, false},        {OF(dn), 'd', 10.0, false},
    };
    const pel_sat_state_t before = state;
    for (size_t i = 0; i < sizeof BAD / sizeof BAD[0]; i++) {
        pel_ephemeris_t e = sky.eph[0];
        put(&e, &BAD[i]);
        TEST_ASSERT_EQUAL_INT(PEL_E_RANGE, pel_sat_state(&e, SKY_T0 + 600 * PEL_NS_PER_S, 0.0, &state));
        TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
    }
    static const double RADII[] = {1.9e7, 3.6e7, NAN};
    for (int i = 0; i < 3; i++) {
        pel_ephemeris_t e = {.sys = PEL_SYS_GLO, .prn = 1, .toe_ns = SKY_T0, .toc_ns = SKY_T0};
        e.glo.r_e[1] = RADII[i];
        TEST_ASSERT_EQUAL_INT(PEL_E_RANGE, pel_sat_state(&e, SKY_T0, 0.0, &state));
        TEST_ASSERT_EQUAL_MEMORY(&before, &state, sizeof state);
    }
}

/* Geostationary satellites of BeiDou have elements of their own kind, on an equator tilted by five degrees: numbers 1 to 5 and from 59 on. */
static void beidous_geostationary_satellites_are_known_by_their_number(void)
{
    int geo = 0;
    while (sky.eph[geo].sys != PEL_SYS_BDS) { geo++; }
    static const uint8_t PRN[] = {5, 6, 58, 59, 63};
    pel_sat_state_t of[5];
    for (int i = 0; i < 5; i++) {
        pel_ephemeris_t e = sky.eph[geo];
        e.prn = PRN[i];
        TEST_ASSERT_EQUAL_INT(PEL_OK, pel_sat_state(&e, SKY_T0, 0.0, &of[i]));
        const bool is_geo = PRN[i] <= 5 || PRN[i] >= 59;
        for (int k = 0; k < 3; k++) { TEST_ASSERT_EQUAL_DOUBLE(of[is_geo ? 0 : 1].r_e[k], of[i].r_e[k]); }
    }
    double d[3];
    for (int k = 0; k < 3; k++) { d[k] = of[0].r_e[k] - of[1].r_e[k]; }
    TEST_ASSERT_TRUE(pel_norm3(d) > 1e5);
    TEST_ASSERT_DOUBLE_WITHIN(1.0, pel_norm3(of[1].r_e), pel_norm3(of[0].r_e));
}

/* In a full store of satellites that all have a newer generation the oldest of these goes; without one, the oldest of all. */
static void the_oldest_that_another_stands_in_for_goes_first(void)
{
    pel_ephemeris_t e = sky.eph[0];
    for (int i = 0; i < PEL_MAX_EPH; i++) { /* two of each of 32, the first generation at different times */
        e.prn = (uint8_t)(1 + i / 2);
        e.toe_ns = e.toc_ns = SKY_T0 + (i % 2 == 0 ? (i == 10 ? -9000 : i) : 7200) * PEL_NS_PER_S;
        if (i == PEL_MAX_EPH - 1) { /* older than all, but the only one of its satellite */
            e.sys = PEL_SYS_QZS;
            e.prn = 1;
            e.toe_ns = e.toc_ns = SKY_T0 - 9500 * PEL_NS_PER_S;
        }
        TEST_ASSERT_EQUAL_INT(PEL_OK, pel_orbits_add(&o, &e));
    }
    TEST_ASSERT_EQUAL_INT(PEL_MAX_EPH, o.n);
    e = sky.eph[0];
    e.sys = PEL_SYS_GAL;
    e.prn = 1;
    e.toe_ns = e.toc_ns = SKY_T0 + 7200 * PEL_NS_PER_S;
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_orbits_add(&o, &e));
    TEST_ASSERT_EQUAL_INT(PEL_MAX_EPH, o.n);
    TEST_ASSERT_NOT_NULL(pel_orbits_find(&o, PEL_SYS_QZS, 1, SKY_T0 - 9500 * PEL_NS_PER_S));
    TEST_ASSERT_NULL(pel_orbits_find(&o, PEL_SYS_GPS, 6, SKY_T0 - 9000 * PEL_NS_PER_S));
    TEST_ASSERT_NOT_NULL(pel_orbits_find(&o, PEL_SYS_GPS, 6, SKY_T0 + 7200 * PEL_NS_PER_S));
    TEST_ASSERT_NOT_NULL(pel_orbits_find(&o, PEL_SYS_GAL, 1, SKY_T0 + 7200 * PEL_NS_PER_S));
}

/* Where no satellite has another generation the oldest of all goes. */
static void of_single_generations_the_oldest_goes(void)
{
    static const uint8_t SYSTEMS[] = {PEL_SYS_GPS, PEL_SYS_GAL};
    pel_ephemeris_t e = sky.eph[0];
    for (int i = 0; i < PEL_MAX_EPH; i++) {
        e.sys = SYSTEMS[i / 32];
        e.prn = (uint8_t)(1 + i % 32);
        e.toe_ns = e.toc_ns = SKY_T0 + ((i == 20) ? -600 : (i * 7) % 60) * PEL_NS_PER_S;
        TEST_ASSERT_EQUAL_INT(PEL_OK, pel_orbits_add(&o, &e));
    }
    e.sys = PEL_SYS_BDS;
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_orbits_add(&o, &e));
    TEST_ASSERT_EQUAL_INT(PEL_MAX_EPH, o.n);
    TEST_ASSERT_NULL(pel_orbits_find(&o, PEL_SYS_GPS, 21, SKY_T0));
    TEST_ASSERT_NOT_NULL(pel_orbits_find(&o, PEL_SYS_GPS, 20, SKY_T0));
}

/* Of Galileo's two messages far apart in time both are kept, and I/NAV is given where it serves. */
static void i_nav_is_given_before_f_nav(void)
{
    pel_ephemeris_t e = sky.eph[30];
    TEST_ASSERT_EQUAL_INT(PEL_SYS_GAL, e.sys);
    for (int order = 0; order < 2; order++) {
        pel_orbits_init(&o);
        for (int k = 0; k < 2; k++) {
            const bool f_nav = k == order;
            e.source = f_nav;
            e.toe_ns = e.toc_ns = SKY_T0 + (f_nav ? 7300 : 0) * PEL_NS_PER_S;
            TEST_ASSERT_EQUAL_INT(PEL_OK, pel_orbits_add(&o, &e));
        }
        const pel_ephemeris_t *given = pel_orbits_find(&o, PEL_SYS_GAL, e.prn, SKY_T0 + 7000 * PEL_NS_PER_S);
        TEST_ASSERT_NOT_NULL(given);
        TEST_ASSERT_EQUAL_INT(0, given->source);
    }
}

/* In a full store the later message may have got the earlier place. */
static void i_nav_is_given_wherever_it_lies(void)
{
    pel_ephemeris_t e = sky.eph[0];
    for (int i = 0; i < PEL_MAX_EPH - 1; i++) {
        e.prn = (uint8_t)(1 + i / 2);
        e.toe_ns = e.toc_ns = SKY_T0 + (i % 2 == 0 ? i : 7200) * PEL_NS_PER_S;
        TEST_ASSERT_EQUAL_INT(PEL_OK, pel_orbits_add(&o, &e));
    }
    e.sys = PEL_SYS_GAL;
    e.prn = 7;
    for (int f_nav = 0; f_nav < 2; f_nav++) {
        e.source = (uint8_t)f_nav;
        e.toe_ns = e.toc_ns = SKY_T0 + f_nav * 7300 * PEL_NS_PER_S;
        TEST_ASSERT_EQUAL_INT(PEL_OK, pel_orbits_add(&o, &e));
    }
    TEST_ASSERT_EQUAL_INT(PEL_SYS_GAL, o.eph[0].sys);
    TEST_ASSERT_EQUAL_INT(1, o.eph[0].source);
    const pel_ephemeris_t *given = pel_orbits_find(&o, PEL_SYS_GAL, 7, SKY_T0 + 7000 * PEL_NS_PER_S);
    TEST_ASSERT_NOT_NULL(given);
    TEST_ASSERT_EQUAL_INT(0, given->source);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_is_no_number_has_no_delay);
    RUN_TEST(the_troposphere_ends_and_thins_and_is_no_worse_below_three_degrees);
    RUN_TEST(the_ionosphere_has_a_night_and_ends_at_the_poles);
    RUN_TEST(coefficients_that_give_less_than_nothing_give_nothing);
    RUN_TEST(what_is_broadcast_delays_the_carriers_it_is_of);
    RUN_TEST(a_measurement_has_a_satellite_a_wave_and_a_size);
    RUN_TEST(noise_is_bounded_at_the_horizon);
    RUN_TEST(a_carrier_that_is_none_has_no_ionosphere);
    RUN_TEST(elements_have_limits);
    RUN_TEST(a_state_of_elements_that_cannot_be_is_refused);
    RUN_TEST(beidous_geostationary_satellites_are_known_by_their_number);
    RUN_TEST(the_oldest_that_another_stands_in_for_goes_first);
    RUN_TEST(of_single_generations_the_oldest_goes);
    RUN_TEST(i_nav_is_given_before_f_nav);
    RUN_TEST(i_nav_is_given_wherever_it_lies);
    return UNITY_END();
}

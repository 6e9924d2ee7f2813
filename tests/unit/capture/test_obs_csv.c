/* test_obs_csv.c - text rows of code and Doppler: columns, epochs, damage; what was taken out of them is put back. */
/* link: pel_capture */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "obs_csv.h"
#include "obs_restore.h"
#include "pelorus/math.h"
#include "support_capture.h"
#include "unity.h"

#define T0 ((INT64_C(2130) * 604800 + 364500) * PEL_NS_PER_S)

static text_t text;
static tally_t tally;
static obs_csv_t rows;
static pel_epoch_t epoch;
static obs_restore_t restore;

void setUp(void)
{
    memset(&text, 0, sizeof text);
    memset(&tally, 0, sizeof tally);
}
void tearDown(void) {}

static void open_text(pel_time_t ref_ns)
{
    const char *why = "";
    const input_t in = text_input(&text);
    TEST_ASSERT_TRUE_MESSAGE(obs_csv_open(&rows, &in, ref_ns, &tally, &why), why);
}

static void rows_of_one_time_are_an_epoch(void)
{
    text_add(&text, "week,tow_s,sys,prn,pseudorange_m,range_rate_mps,cn0_dbhz\n");
    text_add(&text, "2130,364509.600088,G,12,21971364.8164,-380.0,40\n2130,364509.600088,J,1,36412355.4,,42\n");
    text_add(&text, "2130,364509.800041,G,12,21971297.8,-334.5,39\n");
    open_text(0);
    TEST_ASSERT_TRUE(obs_csv_has_date(&rows));
    TEST_ASSERT_TRUE(obs_csv_next(&rows, &epoch));
    TEST_ASSERT_EQUAL_INT64((INT64_C(2130) * 604800 + 364509) * PEL_NS_PER_S + 600088000, epoch.t_ns);
    TEST_ASSERT_EQUAL_UINT(2, epoch.n);
    TEST_ASSERT_EQUAL_DOUBLE(21971364.8164, epoch.obs[0].P_m);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 380.0f * 1575.42e6f / 299792458.0f, epoch.obs[0].D_hz); /* approaching: positive */
    TEST_ASSERT_EQUAL_UINT(PEL_OBS_CODE | PEL_OBS_DOPPLER, epoch.obs[0].flags);
    TEST_ASSERT_EQUAL_UINT(PEL_SYS_QZS, epoch.obs[1].sys);
    TEST_ASSERT_EQUAL_UINT(PEL_OBS_CODE, epoch.obs[1].flags);
    TEST_ASSERT_EQUAL_FLOAT(42.0f, epoch.obs[1].cn0_dbhz);
    TEST_ASSERT_TRUE(obs_csv_next(&rows, &epoch));
    TEST_ASSERT_EQUAL_UINT(1, epoch.n);
    TEST_ASSERT_FALSE(obs_csv_next(&rows, &epoch));
}

static void satellites_and_times_have_other_names_too(void)
{
    text_add(&text, "sat;tow_s;doppler_hz;pseudorange_m\nC06;364509.6;-100.5;4.0e7\nE36;364509.6;7;2.4e7\n");
    open_text(T0);
    TEST_ASSERT_FALSE(obs_csv_has_date(&rows));
    TEST_ASSERT_TRUE(obs_csv_next(&rows, &epoch));
    TEST_ASSERT_EQUAL_INT64(T0 + INT64_C(9600000000), epoch.t_ns);
    TEST_ASSERT_EQUAL_UINT(PEL_CARRIER_B1I, epoch.obs[0].carrier);
    TEST_ASSERT_EQUAL_FLOAT(-100.5f, epoch.obs[0].D_hz);
    TEST_ASSERT_EQUAL_UINT(PEL_CARRIER_L1, epoch.obs[1].carrier);
    TEST_ASSERT_EQUAL_UINT(36, epoch.obs[1].prn);
}

static void a_header_that_lacks_a_column_says_which(void)
{
    static const struct {
        const char *header, *word;
    } CASE[] = {{"", "header"},
                {"1,2,3\n", "header"},
                {"sat,pseudorange_m\n", "time"},
                {"gpst_s,prn,pseudorange_m\n", "satellites"},
                {"gpst_s,sat,range\n", "pseudorange_m"}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        const char *why = "";
        memset(&text, 0, sizeof text);
        text_add(&text, "%s", CASE[i].header);
        const input_t in = text_input(&text);
        TEST_ASSERT_FALSE(obs_csv_open(&rows, &in, 0, &tally, &why));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(why, CASE[i].word), why);
    }
}

static void what_is_damaged_costs_its_row_and_is_counted(void)
{
    text_add(&text, "week,tow_s,sat,pseudorange_m\n2130,10,G01,2.1e7\n2130,10,G01,2.2e7\n2130,10\n2130,x,G02,2.1e7\n");
    text_add(&text, "0,10,G02,2.1e7\n2130,10,G00,2.1e7\n2130,10,R01,2.1e7\n2130,10,G03,5\n2130,10,G04,nan\n");
    text_add(&text, "2130,9,G05,2.1e7\n2130,8,G05,2.1e7\n2130,11,G05,2.1e7\n");
    open_text(0);
    TEST_ASSERT_TRUE(obs_csv_next(&rows, &epoch));
    TEST_ASSERT_EQUAL_UINT(1, epoch.n);
    TEST_ASSERT_EQUAL_DOUBLE(2.1e7, epoch.obs[0].P_m);
    TEST_ASSERT_TRUE(obs_csv_next(&rows, &epoch));
    TEST_ASSERT_EQUAL_UINT(5, epoch.obs[0].prn);
    TEST_ASSERT_EQUAL_INT64((INT64_C(2130) * 604800 + 11) * PEL_NS_PER_S, epoch.t_ns);
    TEST_ASSERT_FALSE(obs_csv_next(&rows, &epoch));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "satellite twice in an epoch"));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "row with too few fields"));
    TEST_ASSERT_EQUAL_UINT64(2, tally_get(&tally, "row without a time"));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "rows without a satellite known here"));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "GLONASS and SBAS"));
    TEST_ASSERT_EQUAL_UINT64(2, tally_get(&tally, "rows without a possible pseudorange"));
    TEST_ASSERT_EQUAL_UINT64(2, tally_get(&tally, "row not later than the epoch before"));
}

static void what_was_removed_is_a_list_of_known_words(void)
{
    obs_removed_t r = {0};
    TEST_ASSERT_TRUE(obs_removed_parse("group-delay,receiver-clock", &r));
    TEST_ASSERT_TRUE(r.receiver_clock && r.group_delay && !r.satellite_clock);
    TEST_ASSERT_FALSE(obs_removed_parse("", &r));
    TEST_ASSERT_FALSE(obs_removed_parse("satellite", &r));
    TEST_ASSERT_FALSE(obs_removed_parse("satellite-clock;group-delay", &r));
}

/* ---- put back -------------------------------------------------------------------------------------------------------- */

#define N_SATS 8

static const double R_E[3] = {-3961765.2, 3349009.3, 3698311.6};

static bool is_high(const pel_ephemeris_t *eph)
{
    pel_sat_state_t s;
    double u[3], up[3];
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_sat_state(eph, T0, 0.0, &s));
    for (int k = 0; k < 3; k++) { u[k] = s.r_e[k] - R_E[k]; }
    (void)pel_unit3(u, u);
    (void)pel_unit3(R_E, up);
    return pel_dot3(u, up) > 0.3;
}

/* Satellites above 17 degrees, each with a clock and a delay of its own. */
static void make_orbits(nav_set_t *nav)
{
    nav->record = calloc(N_SATS, sizeof *nav->record);
    TEST_ASSERT_NOT_NULL(nav->record);
    for (int k = 0; k < 100 && nav->n < N_SATS; k++) {
        const int i = (int)nav->n;
        pel_ephemeris_t *eph = &nav->record[i].eph;
        nav->record[i].t_tx_ns = T0 - 3600 * PEL_NS_PER_S;
        *eph = (pel_ephemeris_t){.sys = PEL_SYS_GPS,
                                 .prn = (uint8_t)(i + 1),
                                 .iode = 1,
                                 .fit_s = 7200.0f,
                                 .sd_ura_m = 2.0f,
                                 .toe_ns = T0,
                                 .toc_ns = T0,
                                 .af0 = 1e-4 * (i - 3),
                                 .af1 = 1e-11 * i,
                                 .tgd_s = {1e-9 * (double)(i - 5), 0.0}};
        eph->sqrt_a = 5153.7;
        eph->e = 0.01;
        eph->i0 = 0.96;
        eph->Omega0 = PEL_PI / 3.0 * (k % 6 - 3);
        eph->M0 = remainder(0.7 * k, 2.0 * PEL_PI);
        nav->n += is_high(eph) ? 1 : 0;
    }
    TEST_ASSERT_EQUAL_size_t(N_SATS, nav->n);
    nav->cap = N_SATS;
}

/* The rows of a receiver at R_E whose clock is clk_s ahead, as it has them itself. Returns how many. */
static int receive(const nav_set_t *nav, pel_time_t t, double clk_s, pel_epoch_t *e)
{
    memset(e, 0, sizeof *e);
    e->t_ns = t + (pel_time_t)llround(1e9 * clk_s);
    for (int i = 0; i < N_SATS; i++) {
        const pel_ephemeris_t *eph = &nav->record[i].eph;
        pel_sat_state_t s = {0};
        double rho = 2.2e7;
        for (int k = 0; k < 5; k++) {
            TEST_ASSERT_EQUAL_INT(PEL_OK, pel_sat_state(eph, t, -rho / PEL_SPEED_OF_LIGHT, &s));
            const double a = 7.2921151467e-5 * rho / PEL_SPEED_OF_LIGHT; /* the Earth turns under the signal */
            const double d[3] = {s.r_e[0] * cos(a) + s.r_e[1] * sin(a) - R_E[0],
                                 s.r_e[1] * cos(a) - s.r_e[0] * sin(a) - R_E[1], s.r_e[2] - R_E[2]};
            rho = pel_norm3(d);
        }
        pel_obs_t *o = &e->obs[e->n++];
        *o = (pel_obs_t){.sys = PEL_SYS_GPS, .prn = eph->prn, .code = 'C', .flags = PEL_OBS_CODE, .cn0_dbhz = 45.0f};
        o->P_m = rho + PEL_SPEED_OF_LIGHT * (clk_s - s.clk_s) + pel_sat_group_delay_m(eph, PEL_CARRIER_L1);
    }
    return e->n;
}

static void what_was_taken_out_is_put_back(void)
{
    const obs_removed_t removed = {true, true, true};
    nav_set_t nav;
    static pel_epoch_t own, given;
    nav_set_init(&nav);
    make_orbits(&nav);
    obs_restore_open(&restore, &removed, &nav, T0 - PEL_NS_PER_S, &tally);
    for (int k = 0; k < 3; k++) {
        const pel_time_t t = T0 + k * PEL_NS_PER_S / 5;
        TEST_ASSERT_EQUAL_INT(N_SATS, receive(&nav, t, -7e-3 + 1e-6 * k, &own));
        given = own;
        given.t_ns = t;
        for (int i = 0; i < N_SATS; i++) {
            const pel_ephemeris_t *eph = &nav.record[i].eph;
            pel_sat_state_t s;
            TEST_ASSERT_EQUAL_INT(PEL_OK, pel_sat_state(eph, t, -0.075, &s));
            given.obs[i].P_m += PEL_SPEED_OF_LIGHT * s.clk_s - pel_sat_group_delay_m(eph, PEL_CARRIER_L1);
        }
        TEST_ASSERT_TRUE(obs_restore_epoch(&restore, &given));
        TEST_ASSERT_EQUAL_UINT(N_SATS, given.n);
        for (int i = 0; i < N_SATS; i++) { TEST_ASSERT_DOUBLE_WITHIN(1e-3, own.obs[i].P_m, given.obs[i].P_m); }
        TEST_ASSERT_INT64_WITHIN(200, own.t_ns, given.t_ns); /* the atmosphere it has not got is taken for clock */
    }
    obs_restore_close(&restore);
    nav_set_free(&nav);
}

/* Without what was removed, n satellites at T0. */
static void begin_restoring(const obs_removed_t *removed, nav_set_t *nav, int n)
{
    nav_set_init(nav);
    make_orbits(nav);
    obs_restore_open(&restore, removed, nav, T0 - PEL_NS_PER_S, &tally);
    memset(&epoch, 0, sizeof epoch);
    epoch.t_ns = T0;
    epoch.n = (uint16_t)n;
}

static void a_satellite_without_orbit_is_left_out(void)
{
    const obs_removed_t removed = {.satellite_clock = true};
    nav_set_t nav;
    begin_restoring(&removed, &nav, 2);
    epoch.obs[0] = (pel_obs_t){.sys = PEL_SYS_GPS, .prn = 31, .P_m = 2.1e7, .flags = PEL_OBS_CODE};
    epoch.obs[1] = (pel_obs_t){.sys = PEL_SYS_GPS, .prn = 2, .P_m = 2.1e7, .flags = PEL_OBS_CODE};
    TEST_ASSERT_TRUE(obs_restore_epoch(&restore, &epoch));
    TEST_ASSERT_EQUAL_UINT(1, epoch.n);
    TEST_ASSERT_EQUAL_UINT(2, epoch.obs[0].prn);
    TEST_ASSERT_EQUAL_INT64(T0, epoch.t_ns);
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "rows of satellites without an orbit"));
    obs_restore_close(&restore);
    nav_set_free(&nav);
}

static void a_clock_that_cannot_be_found_leaves_the_epoch_out(void)
{
    const obs_removed_t removed = {.receiver_clock = true};
    nav_set_t nav;
    begin_restoring(&removed, &nav, 1);
    epoch.obs[0] = (pel_obs_t){.sys = PEL_SYS_GPS, .prn = 2, .P_m = 2.1e7, .flags = PEL_OBS_CODE};
    TEST_ASSERT_FALSE(obs_restore_epoch(&restore, &epoch));
    TEST_ASSERT_EQUAL_UINT64(1, tally_get(&tally, "epochs whose receiver clock is not known"));
    obs_restore_close(&restore);
    nav_set_free(&nav);
}

static void no_truncation_breaks_the_reader(void)
{
    static text_t whole;
    memset(&whole, 0, sizeof whole);
    text_add(&whole, "week,tow_s,sat,pseudorange_m,range_rate_mps\n2130,10,G01,2.1e7,3\n2130,11,G01,2.2e7,4\n");
    for (size_t n = 0; n <= whole.n; n++) {
        const char *why = NULL;
        memcpy(&text, &whole, sizeof text);
        text.n = n;
        const input_t in = text_input(&text);
        if (!obs_csv_open(&rows, &in, 0, &tally, &why)) {
            TEST_ASSERT_NOT_NULL(why);
            continue;
        }
        int epochs = 0;
        while (obs_csv_next(&rows, &epoch)) { epochs++; }
        TEST_ASSERT_LESS_OR_EQUAL_INT(2, epochs);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(rows_of_one_time_are_an_epoch);
    RUN_TEST(satellites_and_times_have_other_names_too);
    RUN_TEST(a_header_that_lacks_a_column_says_which);
    RUN_TEST(what_is_damaged_costs_its_row_and_is_counted);
    RUN_TEST(what_was_removed_is_a_list_of_known_words);
    RUN_TEST(what_was_taken_out_is_put_back);
    RUN_TEST(a_satellite_without_orbit_is_left_out);
    RUN_TEST(a_clock_that_cannot_be_found_leaves_the_epoch_out);
    RUN_TEST(no_truncation_breaks_the_reader);
    return UNITY_END();
}

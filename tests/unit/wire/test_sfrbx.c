/* RXM-SFRBX: which signals are read, how long parts are kept, and the words of GPS and QZSS. */
#include <string.h>

#include "../../../firmware/src/wire/navmsg.h"
#include "support_sfrbx.h"
#include "unity.h"

static sfrbx_bench_t b;

void setUp(void)
{
    sfrbx_begin(&b);
}
void tearDown(void) {}

/* ---- the message ----------------------------------------------------------------------------------------------------- */

/* Receivers before message version 2 do not tell the signal: there was only one. */
static void every_signal_that_carries_the_message_is_read_and_no_other(void)
{
    static const struct {
        pel_sys_t sys;
        uint8_t prn, gnss_id, sig_id, version;
        bool read;
    } CASE[] = {
        {PEL_SYS_GPS, 3, 0, 0, 2, true},  {PEL_SYS_GPS, 3, 0, 3, 2, false},  {PEL_SYS_GPS, 3, 0, 3, 1, true},
        {PEL_SYS_QZS, 3, 5, 0, 2, true},  {PEL_SYS_QZS, 3, 5, 5, 2, false},  {PEL_SYS_QZS, 3, 5, 5, 1, true},
        {PEL_SYS_GAL, 3, 2, 1, 2, true},  {PEL_SYS_GAL, 3, 2, 5, 2, true},   {PEL_SYS_GAL, 3, 2, 3, 2, false},
        {PEL_SYS_GAL, 3, 2, 3, 1, true},  {PEL_SYS_BDS, 20, 3, 0, 2, true},  {PEL_SYS_BDS, 20, 3, 2, 2, true},
        {PEL_SYS_BDS, 20, 3, 4, 2, true}, {PEL_SYS_BDS, 20, 3, 5, 2, false}, {PEL_SYS_BDS, 20, 3, 7, 1, true},
        {PEL_SYS_BDS, 6, 3, 0, 1, true},  {PEL_SYS_BDS, 58, 3, 0, 1, true},  {PEL_SYS_BDS, 3, 3, 1, 2, true},
        {PEL_SYS_BDS, 3, 3, 3, 2, true},  {PEL_SYS_BDS, 3, 3, 10, 2, true},  {PEL_SYS_BDS, 3, 3, 6, 2, false},
        {PEL_SYS_BDS, 5, 3, 0, 1, true},  {PEL_SYS_BDS, 59, 3, 0, 1, true},  {PEL_SYS_GLO, 3, 6, 0, 2, true},
        {PEL_SYS_GLO, 3, 6, 2, 2, true},  {PEL_SYS_GLO, 3, 6, 1, 2, false},  {PEL_SYS_GLO, 3, 6, 1, 1, true},
        {PEL_SYS_GPS, 3, 1, 0, 2, false}, {PEL_SYS_GPS, 3, 4, 0, 2, false},  {PEL_SYS_GPS, 3, 7, 0, 1, false},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        const pel_ephemeris_t e = sfrbx_ephemeris(CASE[i].sys, CASE[i].prn);
        const int parts = pel_ubx_sfrbx_parts(&e);
        int events = 0;
        sfrbx_begin(&b);
        for (int part = 1; part <= parts; part++) {
            const size_t n = sfrbx_part(&b, CASE[i].sys, CASE[i].prn, part);
            b.payload[0] = CASE[i].gnss_id;
            b.payload[2] = CASE[i].sig_id;
            b.payload[6] = CASE[i].version;
            events += sfrbx_push(&b, n);
        }
        TEST_ASSERT_EQUAL_INT(CASE[i].read ? 1 : 0, events);
        sfrbx_expect(&b, CASE[i].read ? 0 : (uint32_t)parts, 0, 0, 0);
    }
}

static void satellites_that_do_not_exist_are_refused(void)
{
    static const struct {
        pel_sys_t sys;
        uint8_t sv;
        uint32_t bad_value;
    } CASE[] = {{PEL_SYS_GPS, 0, 1},  {PEL_SYS_GPS, 1, 0},  {PEL_SYS_GPS, 32, 0}, {PEL_SYS_GPS, 33, 1},
                {PEL_SYS_GAL, 36, 0}, {PEL_SYS_GAL, 37, 1}, {PEL_SYS_BDS, 64, 1}, {PEL_SYS_GPS, 255, 1},
                {PEL_SYS_GLO, 33, 1}, {PEL_SYS_GLO, 255, 0}}; /* GLONASS 255: the receiver does not know it yet */
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        sfrbx_begin(&b);
        const size_t n = sfrbx_part(&b, CASE[i].sys, 9, 1);
        b.payload[1] = CASE[i].sv;
        (void)sfrbx_push(&b, n);
        sfrbx_expect(&b, 0, 0, CASE[i].bad_value, 0);
        TEST_ASSERT_EQUAL_UINT32((CASE[i].bad_value == 0 && CASE[i].sv != 255) ? 1 : 0, b.rx.nav_clock);
    }
}

/* A number of words that is not the frame's, and one that is not the message's. */
static void words_are_counted(void)
{
    static const struct {
        pel_sys_t sys;
        uint8_t prn, words;
        uint32_t bad_length;
    } CASE[] = {
        {PEL_SYS_GPS, 9, 9, 1},  {PEL_SYS_GPS, 9, 11, 1}, {PEL_SYS_GAL, 9, 7, 1},
        {PEL_SYS_GAL, 9, 8, 0},  {PEL_SYS_GAL, 9, 9, 0},  {PEL_SYS_BDS, 9, 9, 1},
        {PEL_SYS_BDS, 3, 11, 1}, {PEL_SYS_GLO, 9, 3, 1},  {PEL_SYS_GLO, 9, 5, 1},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        sfrbx_begin(&b);
        (void)sfrbx_part(&b, CASE[i].sys, CASE[i].prn, 1);
        b.payload[4] = CASE[i].words;
        (void)sfrbx_push(&b, 8u + 8u + 4u * CASE[i].words);
        sfrbx_expect(&b, 0, CASE[i].bad_length, 0, 0);
    }
    sfrbx_begin(&b);
    const size_t n = sfrbx_part(&b, PEL_SYS_GPS, 9, 1);
    b.payload[4] = 9;
    (void)sfrbx_push(&b, n);
    sfrbx_expect(&b, 0, 1, 0, 0);
}

/* ---- how long parts are kept ------------------------------------------------------------------------------------------ */

/* Frames of other satellites that need no place: subframe 5, almanac. */
static void let_frames_pass(int n)
{
    for (int i = 0; i < n; i++) {
        const size_t size = sfrbx_part(&b, PEL_SYS_GPS, 31, 1);
        sfrbx_put(&b, 1, 8, 3, 5);
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, size));
    }
}

static void parts_are_forgotten_after_a_thousand_frames_of_others(void)
{
    for (int passed = 999; passed <= 1000; passed++) {
        sfrbx_begin(&b);
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push_all_but(&b, PEL_SYS_GPS, 9, 3));
        let_frames_pass(passed);
        TEST_ASSERT_EQUAL_INT((passed == 999) ? 1 : 0, sfrbx_push(&b, sfrbx_part(&b, PEL_SYS_GPS, 9, 3)));
    }
}

static void with_all_places_taken_a_satellite_waits_until_one_is_idle(void)
{
    static const struct {
        pel_sys_t sys;
        uint8_t prn;
    } LATE[] = {{PEL_SYS_QZS, 3}, {PEL_SYS_GAL, 36}, {PEL_SYS_BDS, 20}, {PEL_SYS_BDS, 3}, {PEL_SYS_GLO, 3}};
    for (uint32_t i = 0; i < 5; i++) {
        sfrbx_begin(&b);
        for (int k = 0; k < PEL_NAV_SLOTS; k++) {
            (void)sfrbx_push(&b, (k < 30) ? sfrbx_part(&b, PEL_SYS_GPS, k + 1, 1)
                                          : sfrbx_part(&b, PEL_SYS_BDS, k - 30 + 21, 1));
        }
        (void)sfrbx_push(&b, sfrbx_part(&b, LATE[i].sys, LATE[i].prn, 1));
        sfrbx_expect(&b, 0, 0, 0, 1);
        let_frames_pass(1000);
        (void)sfrbx_push(&b, sfrbx_part(&b, LATE[i].sys, LATE[i].prn, 1));
        sfrbx_expect(&b, 0, 0, 0, 1);
        TEST_ASSERT_EQUAL_INT(1, sfrbx_push_all_but(&b, LATE[i].sys, LATE[i].prn, 1));
    }
}

static void fill_all_places(void)
{
    sfrbx_begin(&b);
    for (int k = 0; k < PEL_NAV_SLOTS; k++) {
        const pel_sys_t sys = (k < 30) ? PEL_SYS_GPS : PEL_SYS_BDS;
        (void)sfrbx_push(&b, sfrbx_part(&b, sys, (k < 30) ? k + 1 : k - 30 + 21, 1));
    }
}

/* The first place is touched by the first frame; the frame of the satellite that wants it counts as well. */
static void a_place_is_idle_after_a_thousand_frames(void)
{
    for (int idle = 1000; idle <= 1001; idle++) {
        fill_all_places();
        let_frames_pass(idle - PEL_NAV_SLOTS);
        (void)sfrbx_push(&b, sfrbx_part(&b, PEL_SYS_GAL, 7, 1));
        sfrbx_expect(&b, 0, 0, 0, (idle == 1000) ? 1 : 0);
    }
}

static void a_free_place_is_taken_before_an_idle_one_and_of_those_the_one_idle_longest(void)
{
    fill_all_places();
    (void)sfrbx_push(&b, sfrbx_part(&b, PEL_SYS_GPS, 1, 1)); /* heard again: the second is now idle longest */
    (void)sfrbx_push_all_but(&b, PEL_SYS_GPS, 10, 1);        /* complete: its place is free */
    let_frames_pass(1001);
    (void)sfrbx_push(&b, sfrbx_part(&b, PEL_SYS_GAL, 7, 1));
    TEST_ASSERT_EQUAL_UINT8(PEL_SYS_GAL, b.rx.nav[9].sys);
    (void)sfrbx_push(&b, sfrbx_part(&b, PEL_SYS_GAL, 8, 1));
    TEST_ASSERT_EQUAL_UINT8(PEL_SYS_GAL, b.rx.nav[1].sys);
    (void)sfrbx_push(&b, sfrbx_part(&b, PEL_SYS_GAL, 9, 1));
    TEST_ASSERT_EQUAL_UINT8(PEL_SYS_GAL, b.rx.nav[2].sys);
    TEST_ASSERT_EQUAL_UINT8(PEL_SYS_GPS, b.rx.nav[0].sys);
}

/* ---- GPS and QZSS ----------------------------------------------------------------------------------------------------- */

static void lnav_subframes_are_1_to_5_behind_their_preamble(void)
{
    static const struct {
        pel_sys_t sys;
        uint32_t subframe, bad_value;
    } CASE[] = {{PEL_SYS_GPS, 0, 1}, {PEL_SYS_GPS, 6, 1}, {PEL_SYS_GPS, 7, 1}, {PEL_SYS_GPS, 5, 0},
                {PEL_SYS_GPS, 4, 0}, {PEL_SYS_QZS, 4, 0}, {PEL_SYS_QZS, 5, 0}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        sfrbx_begin(&b);
        const size_t n = sfrbx_part(&b, CASE[i].sys, 9, 1);
        sfrbx_put(&b, 1, 8, 3, CASE[i].subframe);
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
        sfrbx_expect(&b, 0, 0, CASE[i].bad_value, 0);
        for (int k = 0; k < PEL_NAV_SLOTS; k++) { TEST_ASSERT_EQUAL_UINT8(0, b.rx.nav[k].prn); }
    }
    sfrbx_begin(&b);
    const size_t n = sfrbx_part(&b, PEL_SYS_GPS, 9, 1);
    sfrbx_put(&b, 0, 22, 8, 0x8A);
    TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
    sfrbx_expect(&b, 0, 0, 1, 0);
}

/* Page 18 of subframe 4 of GPS is the ionosphere; other pages and QZSS's subframe 4 are not. */
static void the_ionosphere_is_on_page_18_of_gps_alone(void)
{
    const pel_klobuchar_t k = {.valid = true, .alpha = {1e-8f}, .beta = {1e5f}};
    for (int what = 0; what < 3; what++) {
        sfrbx_begin(&b);
        const size_t n = pel_ubx_encode_sfrbx_klobuchar(&k, 3, T0, b.frame, sizeof b.frame);
        if (what == 1) { sfrbx_put(&b, 2, 22, 8, 0x40u | 55u); }
        if (what == 2) { b.payload[0] = 5; }
        (void)pel_ubx_seal(2, 0x13, n - 8u, b.frame, sizeof b.frame);
        TEST_ASSERT_EQUAL_INT((what == 0) ? 1 : 0, support_push(&b.rx, b.frame, n, PEL_RX_KLOBUCHAR));
        TEST_ASSERT_EQUAL(what == 0, b.rx.klobuchar.valid);
        sfrbx_expect(&b, 0, 0, 0, 0);
    }
}

/* The issue number is in subframes 2 and 3, its low bits in subframe 1. */
static void lnav_parts_of_different_issues_wait_for_the_right_one(void)
{
    static const struct {
        int part, word;
    } ISSUE[] = {{1, 7}, {2, 2}, {3, 9}};
    for (int i = 0; i < 3; i++) {
        sfrbx_begin(&b);
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push_all_but(&b, PEL_SYS_GPS, 9, ISSUE[i].part));
        const size_t n = sfrbx_part(&b, PEL_SYS_GPS, 9, ISSUE[i].part);
        sfrbx_put(&b, ISSUE[i].word, 22, 8, 18);
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
        TEST_ASSERT_EQUAL_INT(1, sfrbx_push(&b, sfrbx_part(&b, PEL_SYS_GPS, 9, ISSUE[i].part)));
        sfrbx_expect(&b, 0, 0, 0, 0);
    }
}

/* A frame may begin in one week and end in the next: the week is that of subframe 1, which tells it. */
static void the_week_is_that_of_its_own_subframe(void)
{
    const pel_time_t edge = INT64_C(2301) * PEL_NS_PER_WEEK;
    for (int before_s = 18; before_s >= 0; before_s -= 6) {
        pel_ephemeris_t e = sfrbx_ephemeris(PEL_SYS_GPS, 9);
        int events = 0;
        sfrbx_begin(&b);
        e.toe_ns = e.toc_ns = edge + 7200 * PEL_NS_PER_S;
        for (int part = 1; part <= 3; part++) {
            events += sfrbx_push(
                &b, pel_ubx_encode_sfrbx_eph(&e, part, edge - before_s * PEL_NS_PER_S, b.frame, sizeof b.frame));
        }
        TEST_ASSERT_EQUAL_INT(1, events);
        TEST_ASSERT_EQUAL_INT64(e.toe_ns, b.rx.ephemeris.toe_ns);
    }
}

static void a_complete_set_of_an_impossible_orbit_is_refused_and_forgotten(void)
{
    TEST_ASSERT_EQUAL_INT(0, sfrbx_push_all_but(&b, PEL_SYS_GPS, 9, 2));
    const size_t n = sfrbx_part(&b, PEL_SYS_GPS, 9, 2);
    sfrbx_put(&b, 7, 6, 8, 0xFF); /* an axis of 66 000 km */
    TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
    sfrbx_expect(&b, 0, 0, 1, 0);
    TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, sfrbx_part(&b, PEL_SYS_GPS, 9, 2))); /* the others went with it */
    TEST_ASSERT_EQUAL_INT(1, sfrbx_push_all_but(&b, PEL_SYS_GPS, 9, 2));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_signal_that_carries_the_message_is_read_and_no_other);
    RUN_TEST(satellites_that_do_not_exist_are_refused);
    RUN_TEST(words_are_counted);
    RUN_TEST(parts_are_forgotten_after_a_thousand_frames_of_others);
    RUN_TEST(with_all_places_taken_a_satellite_waits_until_one_is_idle);
    RUN_TEST(a_place_is_idle_after_a_thousand_frames);
    RUN_TEST(a_free_place_is_taken_before_an_idle_one_and_of_those_the_one_idle_longest);
    RUN_TEST(lnav_subframes_are_1_to_5_behind_their_preamble);
    RUN_TEST(the_ionosphere_is_on_page_18_of_gps_alone);
    RUN_TEST(lnav_parts_of_different_issues_wait_for_the_right_one);
    RUN_TEST(the_week_is_that_of_its_own_subframe);
    RUN_TEST(a_complete_set_of_an_impossible_orbit_is_refused_and_forgotten);
    return UNITY_END();
}

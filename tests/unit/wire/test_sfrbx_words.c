/* RXM-SFRBX: the words of Galileo, BeiDou and GLONASS, damaged, foreign and of different issues. */
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

/* ---- Galileo ----------------------------------------------------------------------------------------------------------- */

static void reseal_page(void)
{
    uint8_t page[32] = {0};
    uint8_t crc_input[25] = {0};
    for (unsigned i = 0; i < 8u; i++) { pel_bits_put(page, 32u * i, 32, pel_le_u(b.payload + 8 + 4u * i, 4)); }
    pel_bits_copy(crc_input, 4, page, 0, 114);
    pel_bits_copy(crc_input, 118, page, 128, 82);
    pel_bits_put(page, 128 + 82, 24, pel_crc24q(0, crc_input, sizeof crc_input));
    for (unsigned i = 0; i < 8u; i++) { pel_le_put(b.payload + 8 + 4u * i, 4, pel_bits_u(page, 32u * i, 32)); }
}

static void pages_of_galileo_are_an_even_and_an_odd_half(void)
{
    static const struct {
        int word;
        uint32_t flags, bad_value;
    } CASE[] = {{0, 0, 0}, {0, 1, 0}, {0, 2, 1}, {0, 3, 1}, {4, 2, 0}, {4, 0, 1}, {4, 1, 1}, {4, 3, 1}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) { /* even 01: an alert page, which is no error */
        sfrbx_begin(&b);
        const size_t n = sfrbx_part(&b, PEL_SYS_GAL, 9, 1);
        sfrbx_put(&b, CASE[i].word, 30, 2, CASE[i].flags);
        reseal_page();
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
        sfrbx_expect(&b, 0, 0, CASE[i].bad_value, 0);
    }
}

static void words_of_galileo_without_orbit_are_passed_over(void)
{
    static const uint32_t TYPE[] = {0, 6, 16, 63};
    for (size_t i = 0; i < 4; i++) {
        const size_t n = sfrbx_part(&b, PEL_SYS_GAL, 9, 1);
        sfrbx_put(&b, 0, 24, 6, TYPE[i]);
        reseal_page();
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
    }
    sfrbx_expect(&b, 0, 0, 0, 0);
    TEST_ASSERT_EQUAL_UINT8(0, b.rx.nav[0].prn);
}

static void galileo_words_of_different_issues_wait_for_the_right_one(void)
{
    for (int word = 1; word <= 4; word++) {
        sfrbx_begin(&b);
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push_all_but(&b, PEL_SYS_GAL, 9, word));
        const size_t n = sfrbx_part(&b, PEL_SYS_GAL, 9, word);
        sfrbx_put(&b, 0, 14, 10, 18);
        reseal_page();
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
        TEST_ASSERT_EQUAL_INT(1, sfrbx_push(&b, sfrbx_part(&b, PEL_SYS_GAL, 9, word)));
        sfrbx_expect(&b, 0, 0, 0, 0);
    }
}

/* Word 4 names its satellite: a receiver that assigns a page to another is found out. */
static void a_set_that_names_another_satellite_is_refused(void)
{
    int events = 0;
    for (int word = 1; word <= 5; word++) {
        const size_t n = sfrbx_part(&b, PEL_SYS_GAL, 9, word);
        b.payload[1] = 10;
        events += sfrbx_push(&b, n);
    }
    TEST_ASSERT_EQUAL_INT(0, events);
    sfrbx_expect(&b, 0, 0, 1, 0);
    TEST_ASSERT_EQUAL_INT(1, sfrbx_push_all_but(&b, PEL_SYS_GAL, 10, 0));
}

/* ---- BeiDou ------------------------------------------------------------------------------------------------------------ */

static void subframes_of_beidou_are_1_to_5_behind_their_preamble(void)
{
    static const struct {
        uint8_t prn;
        uint32_t subframe, bad_value;
        bool kept;
    } CASE[] = {{20, 0, 1, false}, {20, 1, 0, true},  {20, 3, 0, true},  {20, 4, 0, false},
                {20, 5, 0, false}, {20, 6, 1, false}, {20, 7, 1, false}, {3, 1, 0, true},
                {3, 2, 0, false},  {3, 5, 0, false},  {3, 6, 1, false}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        sfrbx_begin(&b);
        const size_t n = sfrbx_part(&b, PEL_SYS_BDS, CASE[i].prn, 1);
        sfrbx_put(&b, 0, 12, 3, CASE[i].subframe);
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
        sfrbx_expect(&b, 0, 0, CASE[i].bad_value, 0);
        TEST_ASSERT_EQUAL_UINT8(CASE[i].kept ? CASE[i].prn : 0, b.rx.nav[0].prn);
    }
    for (int what = 0; what < 2; what++) {
        sfrbx_begin(&b);
        const size_t n = sfrbx_part(&b, PEL_SYS_BDS, 20, 1);
        sfrbx_put(&b, 0, (what == 0) ? 19 : 4, (what == 0) ? 11 : 8,
                  (what == 0) ? 0x713 : 0xFF); /* preamble; second of week */
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
        sfrbx_expect(&b, 0, 0, 1, 0);
    }
}

static void pages_of_d2_are_1_to_10(void)
{
    static const struct {
        uint32_t page, bad_value;
    } CASE[] = {{0, 1}, {1, 0}, {10, 0}, {11, 1}, {15, 1}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        sfrbx_begin(&b);
        const size_t n = sfrbx_part(&b, PEL_SYS_BDS, 3, 1);
        sfrbx_put(&b, 1, 14, 4, CASE[i].page);
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
        sfrbx_expect(&b, 0, 0, CASE[i].bad_value, 0);
    }
}

/* ---- GLONASS ----------------------------------------------------------------------------------------------------------- */

/* The string in `frame` after a change of n bits at pos, its parity made good again. */
static void change_string(size_t pos, unsigned n, uint32_t value)
{
    uint8_t s[12];
    for (unsigned i = 0; i < 3u; i++) { pel_bits_put(s, 32u * i, 32, pel_le_u(b.payload + 8 + 4u * i, 4)); }
    pel_bits_put(s, pos, n, value);
    pel_glo_string_seal(s);
    for (unsigned i = 0; i < 3u; i++) { pel_le_put(b.payload + 8 + 4u * i, 4, pel_bits_u(s, 32u * i, 32)); }
}

static void strings_of_glonass_are_1_to_4_with_good_parity_and_a_date(void)
{
    static const struct {
        uint32_t number;
        bool kept;
    } CASE[] = {{0, false}, {1, true}, {4, true}, {5, false}, {15, false}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        sfrbx_begin(&b);
        const size_t n = sfrbx_part(&b, PEL_SYS_GLO, 9, 1);
        change_string(1, 4, CASE[i].number);
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
        sfrbx_expect(&b, 0, 0, 0, 0);
        TEST_ASSERT_EQUAL_UINT8(CASE[i].kept ? 9 : 0, b.rx.nav[0].prn);
    }
    const size_t n = sfrbx_part(&b, PEL_SYS_GLO, 9, 1);
    sfrbx_begin(&b);
    sfrbx_put(&b, 1, 3, 1, ~(uint32_t)pel_le_u(b.payload + 12, 4) >> 3 & 1u); /* one flipped bit */
    TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, n));
    sfrbx_expect(&b, 0, 0, 1, 0);
    pel_receiver_init(&b.rx); /* no date yet */
    TEST_ASSERT_EQUAL_INT(0, sfrbx_push(&b, sfrbx_part(&b, PEL_SYS_GLO, 9, 1)));
    sfrbx_expect(&b, 0, 0, 0, 0);
    TEST_ASSERT_EQUAL_UINT8(0, b.rx.nav[0].prn);
}

/* String 4 names its satellite, but for early ones; the channel is the receiver's. */
static void a_string_that_names_another_slot_or_a_channel_that_is_none_is_refused(void)
{
    static const struct {
        uint32_t slot;
        uint8_t channel;
        int events;
    } CASE[] = {{9, 0, 1}, {9, 13, 1}, {9, 14, 0}, {9, 255, 0}, {0, 7, 1}, {10, 7, 0}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        sfrbx_begin(&b);
        TEST_ASSERT_EQUAL_INT(0, sfrbx_push_all_but(&b, PEL_SYS_GLO, 9, 4));
        const size_t n = sfrbx_part(&b, PEL_SYS_GLO, 9, 4);
        change_string(70, 5, CASE[i].slot);
        b.payload[3] = CASE[i].channel;
        TEST_ASSERT_EQUAL_INT(CASE[i].events, sfrbx_push(&b, n));
        sfrbx_expect(&b, 0, 0, (CASE[i].events == 1) ? 0 : 1, 0);
        TEST_ASSERT_EQUAL_UINT8(0, b.rx.nav[0].prn);
        if (CASE[i].events == 1) { TEST_ASSERT_EQUAL_INT8(CASE[i].channel - 7, b.rx.ephemeris.glo.k); }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(pages_of_galileo_are_an_even_and_an_odd_half);
    RUN_TEST(words_of_galileo_without_orbit_are_passed_over);
    RUN_TEST(galileo_words_of_different_issues_wait_for_the_right_one);
    RUN_TEST(a_set_that_names_another_satellite_is_refused);
    RUN_TEST(subframes_of_beidou_are_1_to_5_behind_their_preamble);
    RUN_TEST(pages_of_d2_are_1_to_10);
    RUN_TEST(strings_of_glonass_are_1_to_4_with_good_parity_and_a_date);
    RUN_TEST(a_string_that_names_another_slot_or_a_channel_that_is_none_is_refused);
    return UNITY_END();
}

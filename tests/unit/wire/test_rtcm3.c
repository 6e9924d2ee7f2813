/* RTCM 3: which message goes where and which ends an epoch, stations at their limits, 1004 and 1012 bit by bit. */
#include <math.h>
#include <string.h>

#include "../../../firmware/src/wire/navmsg.h"
#include "support_wire.h"
#include "unity.h"

#define S PEL_NS_PER_S

static pel_receiver_t rx;
static uint8_t frame[PEL_MAX_FRAME_BYTES];
static uint8_t *const message = frame + 3;

void setUp(void)
{
    pel_receiver_init(&rx);
    pel_receiver_set_time(&rx, T0);
}
void tearDown(void) {}

/* ---- dispatch -------------------------------------------------------------------------------------------------------- */

/* Observations that are not read still tell that the epoch is complete; other messages tell nothing. */
static void messages_of_observations_end_an_epoch_though_they_are_not_read(void)
{
    static const struct {
        unsigned number;
        bool ends;
    } CASE[] = {
        {1001, true},  {1002, true},  {1003, true},  {1007, false}, {1008, false}, {1009, true},  {1010, true},
        {1011, true},  {1013, false}, {1018, false}, {1021, false}, {1041, false}, {1043, false}, {1047, false},
        {1070, false}, {1071, true},  {1073, true},  {1078, false}, {1079, false}, {1080, false}, {1083, true},
        {1093, true},  {1103, true},  {1113, true},  {1123, true},  {1131, true},  {1134, true},  {1137, true},
        {1138, false}, {1141, false}, {1230, false}, {4072, false},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        setUp();
        support_push_msm7(&rx, T0, PEL_SYS_GPS, true);
        memset(message, 0, 30);
        pel_bits_put(message, 0, 12, CASE[i].number);
        TEST_ASSERT_EQUAL_INT_MESSAGE(CASE[i].ends ? 1 : 0, support_push_rtcm3(&rx, frame, 240, PEL_RX_EPOCH), "");
        TEST_ASSERT_EQUAL_UINT32(1, rx.counters.unknown);
        TEST_ASSERT_EQUAL_UINT32(1, rx.counters.frames); /* the one before */
        TEST_ASSERT_EQUAL_INT(
            0, support_push_rtcm3(&rx, frame, 240, PEL_RX_EPOCH)); /* nothing is being collected now, or still is */
    }
}

/* With the flag that more follow, or cut before it, they end nothing. */
static void a_message_cut_before_its_flag_ends_no_epoch(void)
{
    static const struct {
        unsigned number;
        size_t flag; /* bits before it */
    } CASE[] = {{1002, 54}, {1073, 54}, {1010, 51}};
    for (size_t i = 0; i < 3; i++) {
        for (int what = 0; what < 3; what++) {
            setUp();
            support_push_msm7(&rx, T0, PEL_SYS_GPS, true);
            memset(message, 0, 30);
            pel_bits_put(message, 0, 12, CASE[i].number);
            if (what == 1) { pel_bits_put(message, CASE[i].flag, 1, 1); }
            TEST_ASSERT_EQUAL_INT((what == 0) ? 1 : 0,
                                  support_push_rtcm3(&rx, frame, (what == 2) ? 48 : 56, PEL_RX_EPOCH));
        }
    }
}

/* The same body of zeros as each message that is read: refused for what its own layout asks. */
static void messages_that_are_read_are_told_apart(void)
{
    static const struct {
        unsigned number;
        uint32_t length, value; /* counters of a message of 80 zero bytes */
    } CASE[] = {
        {1005, 0, 1}, {1006, 0, 1}, {1019, 0, 1}, {1020, 0, 1}, {1042, 0, 1}, {1044, 0, 1}, {1045, 0, 1}, {1046, 0, 1},
        {1004, 0, 0}, {1074, 0, 0}, {1077, 0, 0}, {1084, 0, 0}, {1095, 0, 0}, {1107, 0, 0}, {1116, 0, 0}, {1127, 0, 0},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        for (int cut = 0; cut < 2; cut++) {
            setUp();
            memset(message, 0, 80);
            pel_bits_put(message, 0, 12, CASE[i].number);
            (void)support_push_rtcm3(&rx, frame, (cut == 0) ? 640 : 56, PEL_RX_NONE);
            TEST_ASSERT_EQUAL_UINT32((cut == 0) ? CASE[i].length : 1, rx.counters.bad_length);
            TEST_ASSERT_EQUAL_UINT32((cut == 0) ? CASE[i].value : 0, rx.counters.bad_value);
            TEST_ASSERT_EQUAL_UINT32(0, rx.counters.unknown);
            TEST_ASSERT_EQUAL_UINT32(1, rx.counters.frames);
        }
    }
}

static void a_frame_without_a_message_is_unknown(void)
{
    TEST_ASSERT_EQUAL_INT(0, support_push_rtcm3(&rx, frame, 0, PEL_RX_EPOCH));
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.unknown);
    TEST_ASSERT_EQUAL_UINT32(0, rx.counters.bad_length);
    pel_bits_put(message, 0, 12, 1005); /* with a number and nothing else it is that message, cut */
    (void)support_push_rtcm3(&rx, frame, 16, PEL_RX_STATION);
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.unknown);
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.bad_length);
}

/* ---- 1005, 1006 ------------------------------------------------------------------------------------------------------ */

static void a_station_stands_between_6000_and_7000_kilometres_from_the_centre(void)
{
    static const struct {
        double r_m;
        bool good;
    } CASE[] = {{6.0e6, false}, {6.000001e6, true}, {6.999999e6, true}, {7.0e6, false}, {0.0, false}};
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        for (int axis = 0; axis < 3; axis++) {
            pel_station_t s = {.id = 4095};
            setUp();
            s.r_ea_e[axis] = -CASE[i].r_m;
            const size_t n = pel_rtcm3_encode_station(&s, 1005 + axis % 2, frame, sizeof frame);
            TEST_ASSERT_EQUAL_INT(CASE[i].good ? 1 : 0, support_push(&rx, frame, n, PEL_RX_STATION));
            TEST_ASSERT_EQUAL_UINT32(CASE[i].good ? 0 : 1, rx.counters.bad_value);
            if (CASE[i].good) { TEST_ASSERT_DOUBLE_WITHIN(5.1e-5, s.r_ea_e[axis], rx.station.r_ea_e[axis]); }
        }
    }
}

static void a_station_is_sent_as_1005_or_1006_if_it_fits(void)
{
    pel_station_t s = {.id = 4095, .r_ea_e = {4.0e6, 1.0e6, 4.8e6}};
    TEST_ASSERT_EQUAL_size_t(25, pel_rtcm3_encode_station(&s, 1005, frame, 27));
    TEST_ASSERT_EQUAL_size_t(27, pel_rtcm3_encode_station(&s, 1006, frame, 27));
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_station(&s, 1005, frame, 26));
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_station(&s, 1004, frame, 27));
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_station(&s, 1007, frame, 27));
    s.id = 4096;
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_station(&s, 1005, frame, 27));
    s.id = 0;
    s.r_ea_e[1] = 1e8; /* 38 bits of 0.1 mm end at 13 700 km */
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_station(&s, 1005, frame, 27));
    s.r_ea_e[1] = (double)NAN;
    TEST_ASSERT_EQUAL_size_t(0, pel_rtcm3_encode_station(&s, 1005, frame, 27));
}

static void a_station_of_1006_without_its_height_is_cut(void)
{
    const pel_station_t s = {.id = 5, .r_ea_e = {4.0e6, 1.0e6, 4.8e6}};
    (void)pel_rtcm3_encode_station(&s, 1006, frame, sizeof frame);
    TEST_ASSERT_EQUAL_INT(0, support_push_rtcm3(&rx, frame, 8 * 20, PEL_RX_STATION));
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.bad_length);
    TEST_ASSERT_EQUAL_INT(1, support_push_rtcm3(&rx, frame, 8 * 21, PEL_RX_STATION));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(messages_of_observations_end_an_epoch_though_they_are_not_read);
    RUN_TEST(a_message_cut_before_its_flag_ends_no_epoch);
    RUN_TEST(messages_that_are_read_are_told_apart);
    RUN_TEST(a_frame_without_a_message_is_unknown);
    RUN_TEST(a_station_stands_between_6000_and_7000_kilometres_from_the_centre);
    RUN_TEST(a_station_is_sent_as_1005_or_1006_if_it_fits);
    RUN_TEST(a_station_of_1006_without_its_height_is_cut);
    return UNITY_END();
}

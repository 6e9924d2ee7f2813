/* What bad bytes do to a receiver stream: nothing but counts. */
#include <stdio.h>
#include <string.h>

#include "pelorus/bits.h"
#include "support_wire.h"
#include "unity.h"

static pel_receiver_t rx, twin;
static pel_epoch_t epoch;
static uint8_t frame[PEL_MAX_FRAME_BYTES];
static uint8_t stream[4 * PEL_MAX_FRAME_BYTES];

void setUp(void)
{
    pel_receiver_init(&rx);
    pel_receiver_set_time(&rx, T0);
}
void tearDown(void) {}

/* A frame of each kind that carries something, by number; its length, 0 past the last. */
static size_t sample(int kind, uint8_t *out, size_t cap, pel_rx_event_t *event)
{
    pel_ephemeris_t eph;
    const pel_station_t station = {.id = 5, .r_ea_e = {4.0e6, 1.0e6, 4.8e6}};
    const pel_klobuchar_t k = {.valid = true, .alpha = {1e-8f}, .beta = {1e5f}};
    const pel_pvt_t pvt = {.t_ns = T0, .fix = 3};
    support_epoch(&epoch, T0, PEL_SYS_GPS, 6);
    support_ephemeris(&eph, PEL_SYS_GPS, 3);
    *event = PEL_RX_EPOCH;
    switch (kind) {
    case 0: return pel_ubx_encode_rawx(&epoch, 18, out, cap);
    case 1: return pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 7, 5, false, out, cap);
    case 2: return pel_rtcm3_encode_msm(&epoch, PEL_SYS_GPS, 4, 5, false, out, cap);
    case 3: return pel_rtcm3_encode_1004(&epoch, 5, false, out, cap);
    case 4: *event = PEL_RX_EPHEMERIS; return pel_rtcm3_encode_ephemeris(&eph, out, cap);
    case 5: *event = PEL_RX_STATION; return pel_rtcm3_encode_station(&station, 1006, out, cap);
    case 6: *event = PEL_RX_KLOBUCHAR; return pel_ubx_encode_sfrbx_klobuchar(&k, 3, T0, out, cap);
    case 7: *event = PEL_RX_PVT; return pel_ubx_encode_pvt(&pvt, out, cap);
    default: return 0;
    }
}

static void every_sample_is_accepted(void)
{
    pel_rx_event_t event;
    for (int kind = 0;; kind++) {
        const size_t n = sample(kind, frame, sizeof frame, &event);
        if (n == 0) { break; }
        setUp();
        TEST_ASSERT_EQUAL_INT(1, support_push(&rx, frame, n, event));
        TEST_ASSERT_EQUAL_UINT32(1, rx.counters.frames);
        TEST_ASSERT_EQUAL_UINT32(0, rx.counters.noise_bytes);
    }
}

static void every_single_bit_flip_is_refused(void)
{
    pel_rx_event_t event;
    unsigned flips = 0;
    for (int kind = 0;; kind++) {
        const size_t n = sample(kind, frame, sizeof frame, &event);
        if (n == 0) { break; }
        for (size_t bit = 0; bit < 8 * n; bit++) {
            setUp();
            frame[bit / 8] ^= (uint8_t)(1u << (bit % 8));
            TEST_ASSERT_EQUAL_INT(0, support_push_all(&rx, frame, n, event));
            TEST_ASSERT_EQUAL_UINT32(0, rx.counters.frames);
            TEST_ASSERT_GREATER_THAN_UINT32(0, rx.counters.noise_bytes);
            frame[bit / 8] ^= (uint8_t)(1u << (bit % 8));
            flips++;
        }
    }
    printf("%u flips refused\n", flips);
}

static void every_truncation_is_refused_and_the_next_frame_kept(void)
{
    pel_rx_event_t event;
    pel_rx_event_t second_event;
    uint8_t second[64];
    const size_t n_second = sample(5, second, sizeof second, &second_event);
    for (int kind = 0; kind < 5; kind++) {
        const size_t n = sample(kind, frame, sizeof frame, &event);
        for (size_t cut = 1; cut < n; cut++) {
            setUp();
            memcpy(stream, frame, cut);
            memcpy(stream + cut, second, n_second);
            TEST_ASSERT_EQUAL_INT(1, support_push_all(&rx, stream, cut + n_second, PEL_RX_STATION));
            TEST_ASSERT_EQUAL_UINT32(1, rx.counters.frames);
        }
    }
}

/* A cut frame holds back what follows only until its announced length has come. */
static void a_cut_frame_delays_but_does_not_swallow(void)
{
    pel_rx_event_t event;
    uint8_t second[64];
    const size_t n = sample(0, frame, sizeof frame, &event);
    const size_t n_second = sample(5, second, sizeof second, &event);
    int stations = 0;
    support_push(&rx, frame, n / 2, PEL_RX_EPOCH);
    for (size_t i = 0; i < n; i += n_second) { stations += support_push(&rx, second, n_second, PEL_RX_STATION); }
    TEST_ASSERT_GREATER_THAN_INT((int)(n / 2 / n_second) / 2, stations);
}

static void a_good_frame_inside_a_false_one_is_found(void)
{
    pel_rx_event_t event;
    const size_t n = sample(4, frame, sizeof frame, &event);
    /* a sync of each kind that announces far more than there is */
    const uint8_t false_sync[][6] = {
        {0xB5, 0x62, 0x01, 0x35, 0x00, 0x02}, {0xD3, 0x02, 0x00, 0x3E, 0xD0, 0x00}, {'$', 'G', 'P', 'G', 'G', 'A'}};
    for (int i = 0; i < 3; i++) {
        setUp();
        memcpy(stream, false_sync[i], 6);
        memcpy(stream + 6, frame, n);
        TEST_ASSERT_EQUAL_INT(1, support_push_all(&rx, stream, 6 + n, PEL_RX_EPHEMERIS));
    }
}

static void a_million_random_bytes_give_nothing(void)
{
    int events = 0;
    for (int i = 0; i < 1000000; i++) {
        events += (pel_receiver_push(&rx, (uint8_t)(support_random() >> 11)) != PEL_RX_NONE) ? 1 : 0;
    }
    const pel_wire_counters_t *c = &rx.counters;
    printf("1e6 random bytes: %d events, checksum %u, length %u, noise %u\n", events, c->bad_checksum, c->bad_length,
           c->noise_bytes);
    TEST_ASSERT_EQUAL_INT(0, events);
    TEST_ASSERT_UINT32_WITHIN(sizeof rx.buf, 1000000, c->noise_bytes + 0);
}

/* Random bytes with plausible sync and length, the hard kind of noise. */
static void random_payloads_with_good_checksums_do_no_harm(void)
{
    for (int round = 0; round < 20000; round++) {
        static const uint8_t KIND[][2] = {{0x02, 0x15}, {0x02, 0x13}, {0x01, 0x07}};
        static const uint16_t NUMBER[] = {1004, 1005, 1006, 1012, 1019, 1020, 1042, 1044, 1045,
                                          1046, 1074, 1077, 1087, 1095, 1117, 1084, 1127};
        size_t n;
        if (round % 2 == 0) {
            const int k = (int)(support_random() % 3u);
            const unsigned meas = support_random() % 8u;
            size_t payload = (k == 0) ? 16u + 32u * meas : (k == 1) ? 8u + 4u * (support_random() % 20u) : 92u;
            memcpy(frame,
                   (const uint8_t[]){0xB5, 0x62, KIND[k][0], KIND[k][1], (uint8_t)payload, (uint8_t)(payload >> 8)}, 6);
            for (size_t i = 0; i < payload; i++) { frame[6 + i] = (uint8_t)(support_random() >> 9); }
            if (k == 0) { frame[6 + 11] = (uint8_t)meas; }
            if (k == 1) {
                memcpy(frame + 6,
                       (const uint8_t[]){(uint8_t)(support_random() % 8u), 7, 1, 0, (uint8_t)((payload - 8u) / 4u)}, 5);
            }
            const uint16_t sum = pel_fletcher8(frame + 2, payload + 4);
            frame[6 + payload] = (uint8_t)(sum >> 8);
            frame[7 + payload] = (uint8_t)sum;
            n = payload + 8;
        } else {
            const size_t message = 8u + support_random() % 300u;
            frame[0] = 0xD3;
            frame[1] = (uint8_t)(message >> 8);
            frame[2] = (uint8_t)message;
            for (size_t i = 0; i < message; i++) { frame[3 + i] = (uint8_t)(support_random() >> 9); }
            pel_bits_put(frame, 24, 12, NUMBER[support_random() % 17u]);
            pel_bits_put(frame, 24 + 24, 30, (345600000u + 1000u * (unsigned)round) % 604800000u);
            pel_bits_put(frame, 8 * (message + 3), 24, pel_crc24q(0, frame, message + 3));
            n = message + 6;
        }
        for (size_t i = 0; i < n; i++) {
            if (pel_receiver_push(&rx, frame[i]) == PEL_RX_EPOCH) {
                TEST_ASSERT_LESS_OR_EQUAL_UINT16(PEL_MAX_OBS, rx.epoch.n);
                for (int k = 0; k < (int)rx.epoch.n; k++) {
                    const pel_obs_t *o = &rx.epoch.obs[k];
                    TEST_ASSERT_TRUE(o->prn >= 1 && o->prn <= pel_sys_max_prn((pel_sys_t)o->sys));
                    TEST_ASSERT_TRUE((o->flags & PEL_OBS_CODE) == 0 || (o->P_m >= 1e6 && o->P_m <= 1e8));
                }
            }
        }
    }
    printf("20000 random payloads: frames %u value %u length %u duplicate %u back %u\n", rx.counters.frames,
           rx.counters.bad_value, rx.counters.bad_length, rx.counters.duplicate, rx.counters.time_back);
}

static void noise_between_frames_changes_nothing(void)
{
    pel_rx_event_t event;
    size_t at = 0;
    int expected = 0;
    for (int kind = 4; kind < 8; kind++) {
        at += sample(kind, stream + at, sizeof stream - at, &event);
        for (int i = 0; i < 37; i++) {
            stream[at++] = (uint8_t)(support_random() % 0x20u);
        } /* no sync bytes among them */
        expected++;
    }
    int events = 0;
    for (size_t i = 0; i < at; i++) { events += (pel_receiver_push(&rx, stream[i]) != PEL_RX_NONE) ? 1 : 0; }
    TEST_ASSERT_EQUAL_INT(expected, events);
    TEST_ASSERT_EQUAL_UINT32(4 * 37, rx.counters.noise_bytes);
    TEST_ASSERT_EQUAL_UINT32(0, rx.counters.bad_checksum);
}

static void nmea_is_passed_over_as_known_text(void)
{
    const char text[] = "$GNGGA,092725.00,4717.11399,N,00833.91590,E,1,08,1.01,499.6,M,48.0,M,,*45\r\n";
    support_push(&rx, (const uint8_t *)text, sizeof text - 1, PEL_RX_NONE);
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.unknown);
    TEST_ASSERT_EQUAL_UINT32(0, rx.counters.noise_bytes);
    support_push(&rx, (const uint8_t *)"$GNGGA,1*00\r\n", 13, PEL_RX_NONE);
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.bad_checksum);
}

static void a_receiver_may_be_copied_in_the_middle_of_a_frame(void)
{
    pel_rx_event_t event;
    const size_t n = sample(0, frame, sizeof frame, &event);
    support_push(&rx, frame, n / 3, event);
    memcpy(&twin, &rx, sizeof rx);
    memset(&rx, 0x5A, sizeof rx);
    TEST_ASSERT_EQUAL_INT(1, support_push(&twin, frame + n / 3, n - n / 3, event));
}

static void rawx_longer_than_the_buffer_is_refused_at_its_header(void)
{
    const unsigned n = 16u + 32u * (PEL_MAX_OBS + 1u);
    const uint8_t header[6] = {0xB5, 0x62, 0x02, 0x15, (uint8_t)n, (uint8_t)(n >> 8)};
    support_push(&rx, header, sizeof header, PEL_RX_NONE);
    TEST_ASSERT_EQUAL_UINT32(1, rx.counters.bad_length);
    TEST_ASSERT_LESS_THAN_UINT16(6, rx.fill);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_sample_is_accepted);
    RUN_TEST(every_single_bit_flip_is_refused);
    RUN_TEST(every_truncation_is_refused_and_the_next_frame_kept);
    RUN_TEST(a_cut_frame_delays_but_does_not_swallow);
    RUN_TEST(a_good_frame_inside_a_false_one_is_found);
    RUN_TEST(a_million_random_bytes_give_nothing);
    RUN_TEST(random_payloads_with_good_checksums_do_no_harm);
    RUN_TEST(noise_between_frames_changes_nothing);
    RUN_TEST(nmea_is_passed_over_as_known_text);
    RUN_TEST(a_receiver_may_be_copied_in_the_middle_of_a_frame);
    RUN_TEST(rawx_longer_than_the_buffer_is_refused_at_its_header);
    return UNITY_END();
}

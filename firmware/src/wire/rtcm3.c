#include "framing.h"

#define PREAMBLE 0xD3u

/* RTCM 3 message numbers: the standard's and the proprietary ones. Others mean that the sync byte was a chance. */
static bool number_known(unsigned number)
{
    return (number >= 1001u && number <= 1304u) || number >= 4001u;
}

pel_probe_t pel_rtcm3_probe(const uint8_t *p, size_t n, size_t *length)
{
    if (n < 2u) { return PEL_PROBE_MORE; }
    if ((p[1] & 0xFCu) != 0u) { return PEL_PROBE_NOISE; } /* six reserved bits are zero */
    if (n < 3u) { return PEL_PROBE_MORE; }
    const size_t n_message = (size_t)pel_bits_u(p, 14, 10);
    if (n_message == 1u) { return PEL_PROBE_BAD_LENGTH; }
    if (n_message >= 2u) {
        if (n < 5u) { return PEL_PROBE_MORE; }
        if (!number_known((unsigned)pel_bits_u(p, 24, 12))) { return PEL_PROBE_NOISE; }
    }
    *length = n_message + 6u;
    if (n < *length) { return PEL_PROBE_MORE; }
    return (pel_crc24q(0, p, n_message + 3u) == pel_bits_u(p, 8u * (n_message + 3u), 24)) ? PEL_PROBE_FRAME
                                                                                          : PEL_PROBE_BAD_CHECKSUM;
}

size_t pel_rtcm3_seal(size_t n_bits, uint8_t *out, size_t cap)
{
    const size_t n = (n_bits + 7u) / 8u;
    if (n > 1023u || cap < n + 6u) { return 0; }
    out[0] = PREAMBLE;
    out[1] = (uint8_t)(n >> 8);
    out[2] = (uint8_t)n;
    pel_bits_put(out, 8u * (n + 3u), 24, pel_crc24q(0, out, n + 3u));
    return n + 6u;
}

/* ---- 1005, 1006 ------------------------------------------------------------------------------------------------------------ */

#define STATION_UNIT_M 1e-4

/* r_ea_e is the antenna reference point itself; the height of 1006 is that of this point above a marker, and not to be added. */
static void station_fields(pel_bitio_t *io, pel_station_t *s, uint32_t *type)
{
    uint32_t id = s->id;
    pel_io_u(io, 12, type);
    pel_io_u(io, 12, &id);
    pel_io_fill(io, 6, 0);    /* ITRF year */
    pel_io_fill(io, 4, 0x0A); /* GPS, GLONASS, Galileo served; real station */
    pel_io_signed(io, 38, STATION_UNIT_M, &s->r_ea_e[0]);
    pel_io_fill(io, 2, 2); /* single oscillator */
    pel_io_signed(io, 38, STATION_UNIT_M, &s->r_ea_e[1]);
    pel_io_fill(io, 2, 0);
    pel_io_signed(io, 38, STATION_UNIT_M, &s->r_ea_e[2]);
    if (*type == 1006u) { pel_io_fill(io, 16, 0); }
    s->id = (uint16_t)id;
}

static pel_rx_event_t station(pel_receiver_t *rx, const uint8_t *message, size_t n)
{
    pel_station_t s = {0};
    uint32_t type = 0;
    pel_bitio_t io;
    double square = 0.0;

    pel_bitio_read(&io, message, n);
    station_fields(&io, &s, &type);
    for (int i = 0; i < 3; i++) { square += s.r_ea_e[i] * s.r_ea_e[i]; }
    if (pel_bitio_failed(&io)) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    if (!(square > 6.0e6 * 6.0e6 && square < 7.0e6 * 7.0e6)) { /* not on Earth: a station that does not know itself */
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    rx->station = s;
    return PEL_RX_STATION;
}

size_t pel_rtcm3_encode_station(const pel_station_t *s, int type, uint8_t *out, size_t cap)
{
    pel_station_t copy = *s;
    uint32_t number = (uint32_t)type;
    pel_bitio_t io;

    if ((type != 1005 && type != 1006) || cap < 27u) { return 0; }
    pel_bitio_write(&io, out + 3, cap - 6u);
    station_fields(&io, &copy, &number);
    return pel_bitio_failed(&io) ? 0u : pel_rtcm3_seal(io.w.pos, out, cap);
}

/* ---- dispatch --------------------------------------------------------------------------------------------------------------- */

/* Observations that are not used still tell where the epoch ends: bit `at` says whether more messages of it follow. */
static pel_rx_event_t skip_observations(pel_receiver_t *rx, const uint8_t *message, size_t n, size_t at)
{
    rx->counters.unknown++;
    if (8u * n <= at) { return PEL_RX_NONE; }
    const bool more = pel_bits_u(message, at, 1) != 0u;
    return (rx->collecting && !more) ? pel_rx_deliver(rx) : PEL_RX_NONE;
}

/* 1071..1137: the tens are the system, the last digit the kind. Used are the kinds with whole phases of all but NavIC (113). */
static bool is_msm(unsigned number)
{
    return number >= 1071u && number <= 1137u && number % 10u >= 1u && number % 10u <= 7u;
}

static bool msm_used(unsigned number)
{
    return is_msm(number) && number % 10u >= 4u && number < 1130u;
}

pel_rx_event_t pel_rtcm3_handle(pel_receiver_t *rx, const uint8_t *frame, size_t n, bool *hold)
{
    const uint8_t *const message = frame + 3;
    const size_t n_message = n - 6u;
    const unsigned number = (n_message >= 2u) ? (unsigned)pel_bits_u(message, 0, 12) : 0u;
    pel_rx_event_t event;

    if (msm_used(number)) {
        event = pel_rtcm3_msm(rx, message, n_message, hold);
    } else if (number == 1004u) {
        event = pel_rtcm3_1004(rx, message, n_message, hold);
    } else if (number == 1012u) {
        event = pel_rtcm3_1012(rx, message, n_message, hold);
    } else if (number == 1005u || number == 1006u) {
        event = station(rx, message, n_message);
    } else if (number == 1019u || number == 1020u || number == 1042u || (number >= 1044u && number <= 1046u)) {
        event = pel_rtcm3_ephemeris(rx, message, n_message);
    } else if (is_msm(number) || (number >= 1001u && number <= 1003u)) {
        return skip_observations(rx, message, n_message, 12 + 12 + 30);
    } else if (number >= 1009u && number <= 1011u) {
        return skip_observations(rx, message, n_message, 12 + 12 + 27); /* GLONASS time has 27 bits */
    } else {
        rx->counters.unknown++;
        return PEL_RX_NONE;
    }
    if (!*hold) { rx->counters.frames++; }
    return event;
}

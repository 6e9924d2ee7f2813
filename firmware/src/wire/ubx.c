#include "framing.h"

#define SYNC_1    0xB5u
#define SYNC_2    0x62u
#define CLASS_NAV 0x01u
#define CLASS_RXM 0x02u

/* Whether a payload of n bytes can belong to this message. Where the layout is known it is asked for exactly: a cut frame
 * is then found out by its header and not a thousand bytes later. */
static bool length_possible(uint8_t cls, uint8_t id, size_t n)
{
    if (n + 8u > PEL_MAX_FRAME_BYTES) { return false; }
    if (cls == CLASS_RXM && id == 0x15) { return n % 32u == 16u; }
    if (cls == CLASS_RXM && id == 0x13) { return n >= 8u && n <= 8u + 4u * 32u && n % 4u == 0u; }
    if (cls == CLASS_NAV && id == 0x07) { return n == 84u || n == 92u; }
    return true;
}

/* Message classes in use by any receiver generation; other bytes after the sync are not a frame. */
static bool class_known(uint8_t cls)
{
    static const uint8_t KNOWN[] = {0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x09, 0x0A, 0x0B, 0x0C, 0x0D,
                                    0x10, 0x13, 0x21, 0x27, 0x28, 0x29, 0x2A, 0x2B, 0xF0, 0xF1};
    for (size_t i = 0; i < sizeof KNOWN; i++) {
        if (KNOWN[i] == cls) { return true; }
    }
    return false;
}

pel_probe_t pel_ubx_probe(const uint8_t *p, size_t n, size_t *length)
{
    if (n < 2u) { return PEL_PROBE_MORE; }
    if (p[1] != SYNC_2) { return PEL_PROBE_NOISE; }
    if (n < 3u) { return PEL_PROBE_MORE; }
    if (!class_known(p[2])) { return PEL_PROBE_NOISE; }
    if (n < 6u) { return PEL_PROBE_MORE; }

    const size_t n_payload = (size_t)pel_le_u(p + 4, 2);
    if (!length_possible(p[2], p[3], n_payload)) { return PEL_PROBE_BAD_LENGTH; }
    *length = n_payload + 8u;
    if (n < *length) { return PEL_PROBE_MORE; }

    const uint16_t sum = (uint16_t)(((unsigned)p[n_payload + 6u] << 8) | p[n_payload + 7u]);
    return (pel_fletcher8(p + 2, n_payload + 4u) == sum) ? PEL_PROBE_FRAME : PEL_PROBE_BAD_CHECKSUM;
}

size_t pel_ubx_seal(uint8_t cls, uint8_t id, size_t n_payload, uint8_t *out, size_t cap)
{
    if (n_payload > 65535u || cap < n_payload + 8u) { return 0; }
    out[0] = SYNC_1;
    out[1] = SYNC_2;
    out[2] = cls;
    out[3] = id;
    pel_le_put(out + 4, 2, n_payload);
    const uint16_t sum = pel_fletcher8(out + 2, n_payload + 4u);
    out[n_payload + 6u] = (uint8_t)(sum >> 8);
    out[n_payload + 7u] = (uint8_t)sum;
    return n_payload + 8u;
}

pel_rx_event_t pel_ubx_handle(pel_receiver_t *rx, const uint8_t *frame, size_t n, bool *hold)
{
    const uint8_t *const payload = frame + 6;
    const size_t n_payload = n - 8u;
    pel_rx_event_t event = PEL_RX_NONE;

    if (frame[2] == CLASS_RXM && frame[3] == 0x15) {
        event = pel_ubx_rawx(rx, payload, n_payload, hold);
    } else if (frame[2] == CLASS_RXM && frame[3] == 0x13) {
        event = pel_ubx_sfrbx(rx, payload, n_payload);
    } else if (frame[2] == CLASS_NAV && frame[3] == 0x07) {
        event = pel_ubx_pvt(rx, payload, n_payload);
    } else {
        rx->counters.unknown++;
        return PEL_RX_NONE;
    }
    if (!*hold) { rx->counters.frames++; }
    return event;
}

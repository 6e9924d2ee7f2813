#include "framing.h"

#include <string.h>

/* 'P' 'L', id, version, payload length (u16 LE), payload, CRC-24Q over id..payload (MSB first). */

pel_probe_t pel_pelorus_probe(const uint8_t *p, size_t n, size_t max_payload, size_t *length)
{
    if (n < 2u) { return PEL_PROBE_MORE; }
    if (p[1] != 'L') { return PEL_PROBE_NOISE; }
    if (n < 6u) { return PEL_PROBE_MORE; }
    const size_t n_payload = (size_t)pel_le_u(p + 4, 2);
    if (n_payload > max_payload) { return PEL_PROBE_BAD_LENGTH; }
    *length = n_payload + PEL_OUT_OVERHEAD;
    if (n < *length) { return PEL_PROBE_MORE; }
    return (pel_crc24q(0, p + 2, n_payload + 4u) == pel_bits_u(p, 8u * (n_payload + 6u), 24)) ? PEL_PROBE_FRAME
                                                                                              : PEL_PROBE_BAD_CHECKSUM;
}

size_t pel_out_seal(uint8_t id, size_t n_payload, uint8_t *out, size_t cap)
{
    if (n_payload > 65535u || cap < n_payload + PEL_OUT_OVERHEAD) { return 0; }
    out[0] = 'P';
    out[1] = 'L';
    out[2] = id;
    out[3] = PEL_OUT_VERSION;
    pel_le_put(out + 4, 2, n_payload);
    pel_bits_put(out, 8u * (n_payload + 6u), 24, pel_crc24q(0, out + 2, n_payload + 4u));
    return n_payload + PEL_OUT_OVERHEAD;
}

size_t pel_out_encode(uint8_t id, const pel_member_t m[], size_t n_members, const void *from, uint8_t *out, size_t cap)
{
    const size_t n = pel_members_bytes(m, n_members);
    if (cap < n + PEL_OUT_OVERHEAD) { return 0; }
    (void)pel_members_put(m, n_members, from, out + 6);
    return pel_out_seal(id, n, out, cap);
}

pel_status_t pel_out_decode(const pel_member_t m[], size_t n_members, const uint8_t *payload, size_t n, void *to)
{
    if (n != pel_members_bytes(m, n_members)) { return PEL_E_FORMAT; }
    (void)pel_members_get(m, n_members, payload, to);
    return PEL_OK;
}

void pel_out_reader_init(pel_out_reader_t *r)
{
    memset(r, 0, sizeof *r);
}

static pel_probe_t probe(const uint8_t *p, size_t n, size_t *length)
{
    return (p[0] == 'P') ? pel_pelorus_probe(p, n, PEL_OUT_MAX_PAYLOAD, length) : PEL_PROBE_NOISE;
}

bool pel_out_reader_push(pel_out_reader_t *r, uint8_t byte)
{
    size_t length = 0;
    pel_frame_append(r->buf, sizeof r->buf, &r->fill, &r->counters, byte);
    if (!pel_frame_next(r->buf, &r->fill, &r->counters, probe, false, &length)) { return false; }
    r->id = r->buf[2];
    r->version = r->buf[3];
    r->n = (uint16_t)(length - PEL_OUT_OVERHEAD);
    memcpy(r->payload, r->buf + 6, r->n);
    r->counters.frames++;
    pel_frame_drop(r->buf, &r->fill, length);
    return true;
}

/* Proofs of wire/framing.c and of the probes: where frames begin and end. */
#include "framing.h"

#include "prove.h"

#define CAP 24

/* PROVE frame_append: appending to a buffer of any filling stays inside it
 * sources wire/framing.c
 * flags --unwind 26
 * quick
 * plant wire/framing.c: if (*fill == cap) { => if (*fill > cap) { */
void frame_append(void)
{
    struct {
        uint8_t buf[CAP], behind;
    } b;
    pel_wire_counters_t count;
    uint16_t fill = (uint16_t)any_upto(CAP);
    b.behind = 7;
    pel_frame_append(b.buf, CAP, &fill, &count, any_u8());
    claim(fill >= 1 && fill <= CAP && b.behind == 7);
}

/* PROVE frame_drop: dropping any number of bytes leaves what was behind them
 * sources wire/framing.c
 * flags --unwind 26
 * quick
 * plant wire/framing.c: (n < *fill) ? (size_t)*fill - n : 0u => (size_t)*fill - n */
void frame_drop(void)
{
    uint8_t buf[6], before[6];
    const size_t n = any_size(), i = any_upto(5);
    const uint16_t was = (uint16_t)any_upto(6);
    uint16_t fill = was;
    for (int k = 0; k < 6; k++) { before[k] = buf[k] = any_u8(); }
    pel_frame_drop(buf, &fill, n);
    claim(fill == ((n < was) ? was - n : 0));
    if (i < fill) { claim(buf[i] == before[n + i]); }
}

static pel_probe_t any_probe(const uint8_t *p, size_t n, size_t *length)
{
    const pel_probe_t verdict = (pel_probe_t)any_upto(PEL_PROBE_FRAME);
    claim(n > 0 && p[n - 1] == p[n - 1]); /* it is given bytes that are there */
    *length = any_upto(n);
    return verdict;
}

/* PROVE frame_next: whatever the probe answers, the search ends and the filling stays in bounds
 * sources wire/framing.c
 * flags --unwind 8
 * plant wire/framing.c: *fill = 0;\n    return false; => *fill = (uint16_t)(*fill + 1u);\n    return false; */
void frame_next(void)
{
    uint8_t buf[6];
    pel_wire_counters_t count;
    const uint16_t was = (uint16_t)any_upto(sizeof buf);
    uint16_t fill = was;
    size_t length = 0;
    any_bytes(buf, sizeof buf);
    const bool found = pel_frame_next(buf, &fill, &count, any_probe, any_bool(), &length);
    claim(fill <= was);
    claim(!found || length <= fill);
}

/* PROVE time_order: any two times of messages, any history
 * sources wire/framing.c
 * flags --unwind 4 --boolector
 * quick
 * plant wire/framing.c: if (t >= given - tol_ns) { => if (t >= 3 * given - tol_ns) { */
void time_order(void)
{
    pel_wire_counters_t count;
    const pel_time_t t = any_i64(), tol = any_i64(), given = any_i64();
    pel_time_t back = any_i64();
    uint8_t n_back = any_u8();
    assume(t >= 0 && t < PEL_TIME_LAST && given >= 0 && given < PEL_TIME_LAST && back >= 0 && back < PEL_TIME_LAST);
    assume(tol >= 0 && tol < 10 * PEL_NS_PER_S && n_back < PEL_WIRE_RESTART);
    const pel_order_t order = pel_time_order(t, tol, given, &back, &n_back, &count);
    claim(n_back < PEL_WIRE_RESTART);
    claim(order != PEL_ORDER_SAME || (t - given <= tol && given - t <= tol));
}

/* PROVE ubx_probe: reads only what is there, and a frame it finds is there whole
 * sources wire/ubx.c base/bits.c base/crc.c
 * flags --unwind 26 -DPEL_MAX_OBS=8
 * quick
 * plant wire/ubx.c: if (n < 6u) { return PEL_PROBE_MORE; } => if (n < 5u) { return PEL_PROBE_MORE; } */
void ubx_probe(void)
{
    const size_t n = any_size();
    assume(n >= 1 && n <= CAP);
    uint8_t buf[n];
    size_t length = 0;
    any_bytes(buf, n);
    claim(pel_ubx_probe(buf, n, &length) != PEL_PROBE_FRAME || (length >= 8 && length <= n));
}

/* PROVE rtcm3_probe: likewise
 * sources wire/rtcm3.c base/bits.c base/crc.c
 * flags --unwind 26 -DPEL_MAX_OBS=8
 * plant wire/rtcm3.c: if (n < 5u) { return PEL_PROBE_MORE; } => if (n < 4u) { return PEL_PROBE_MORE; } */
void rtcm3_probe(void)
{
    const size_t n = any_size();
    assume(n >= 1 && n <= CAP);
    uint8_t buf[n];
    size_t length = 0;
    any_bytes(buf, n);
    claim(pel_rtcm3_probe(buf, n, &length) != PEL_PROBE_FRAME || (length >= 6 && length <= n));
}

/* PROVE nmea_probe: likewise
 * sources wire/nmea_probe.c
 * flags --unwind 26 -DPEL_MAX_OBS=8
 * quick
 * plant wire/nmea_probe.c: if (n < i + 5u) { => if (n < i + 4u) { */
void nmea_probe(void)
{
    const size_t n = any_size();
    assume(n >= 1 && n <= CAP);
    uint8_t buf[n];
    size_t length = 0;
    any_bytes(buf, n);
    claim(pel_nmea_probe(buf, n, &length) != PEL_PROBE_FRAME || length <= n);
}

/* PROVE pelorus_probe: likewise, and no payload beyond what the reader can hold
 * sources wire/pelorus_frame.c base/bits.c base/crc.c
 * flags --unwind 26 -DPEL_MAX_OBS=8
 * quick
 * plant wire/pelorus_frame.c: if (n_payload > max_payload) { return PEL_PROBE_BAD_LENGTH; } => (void)max_payload; */
void pelorus_probe(void)
{
    const size_t n = any_size();
    assume(n >= 1 && n <= CAP);
    uint8_t buf[n];
    size_t length = 0;
    any_bytes(buf, n);
    claim(pel_pelorus_probe(buf, n, 12, &length) != PEL_PROBE_FRAME ||
          (length <= n && length <= 12 + PEL_OUT_OVERHEAD));
}

/* PROVE novatel_probe: likewise
 * sources wire/novatel_imu.c base/bits.c base/crc.c base/time.c
 * flags --unwind 26 -DPEL_MAX_OBS=8
 * plant wire/novatel_imu.c: if (n < *length) { return PEL_PROBE_MORE; } => (void)n; */
void novatel_probe(void)
{
    const size_t n = any_size();
    assume(n >= 1 && n <= CAP);
    uint8_t buf[n];
    size_t length = 0;
    any_bytes(buf, n);
    claim(pel_novatel_probe(buf, n, &length) != PEL_PROBE_FRAME || (length >= 16 && length <= n));
}

/* PROVE seals: frames are closed only inside their buffer, whatever the lengths said to be in it
 * sources wire/ubx.c wire/rtcm3.c wire/pelorus_frame.c base/bits.c base/crc.c
 * flags --unwind 14 -DPEL_MAX_OBS=8
 * plant wire/ubx.c: cap < n_payload + 8u => cap < n_payload + 7u */
void seals(void)
{
    const size_t cap = 1u + any_upto(11);
    uint8_t buf[cap];
    any_bytes(buf, cap);
    const size_t n = any_upto(255); /* more than the buffer; lengths near SIZE_MAX cannot come from a writer */
    claim(pel_ubx_seal(1, 2, n, buf, cap) <= cap);
    claim(pel_out_seal(1, n, buf, cap) <= cap);
    claim(pel_rtcm3_seal(8 * n, buf, cap) <= cap);
}

/* PROVE bits_copy: moving bits between any places of two buffers
 * sources wire/navmsg.c base/bits.c
 * flags --unwind 12 -DPEL_MAX_OBS=8
 * plant wire/navmsg.c: (n_bits - i < 32u) ? (unsigned)(n_bits - i) : 32u => 32u */
void bits_copy(void)
{
    uint8_t from[8], to[8];
    const size_t n = any_upto(64);
    any_bytes(from, sizeof from);
    any_bytes(to, sizeof to);
    void pel_bits_copy(uint8_t *, size_t, const uint8_t *, size_t, size_t);
    pel_bits_copy(to, any_upto(64 - n), from, any_upto(64 - n), n);
}

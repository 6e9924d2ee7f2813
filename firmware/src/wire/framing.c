#include "framing.h"

#include <string.h>

void pel_frame_drop(uint8_t *buf, uint16_t *fill, size_t n)
{
    if (n == 0u) { return; } /* the usual case: a frame is coming in and begins the buffer */
    const size_t left = (n < *fill) ? (size_t)*fill - n : 0u;
    if (left > 0u) { memmove(buf, buf + (*fill - left), left); }
    *fill = (uint16_t)left;
}

void pel_frame_append(uint8_t *buf, size_t cap, uint16_t *fill, pel_wire_counters_t *count, uint8_t byte)
{
    if (*fill > cap) { *fill = 0; } /* memory has changed by itself */
    if (*fill == cap) {
        pel_frame_drop(buf, fill, 1);
        count->noise_bytes++;
    }
    buf[*fill] = byte;
    (*fill)++;
}

/* Gives up the byte at `at`, after the noise before it. */
static void reject(uint8_t *buf, uint16_t *fill, pel_wire_counters_t *count, size_t at)
{
    count->noise_bytes += (uint32_t)at + 1u;
    pel_frame_drop(buf, fill, at + 1u);
}

bool pel_frame_next(uint8_t *buf, uint16_t *fill, pel_wire_counters_t *count, pel_probe_fn probe, bool final,
                    size_t *length)
{
    size_t at = 0;
    while (at < *fill) {
        const pel_probe_t verdict = probe(buf + at, (size_t)*fill - at, length);
        if (verdict == PEL_PROBE_NOISE) {
            at++;
            continue;
        }
        if (verdict == PEL_PROBE_FRAME || (verdict == PEL_PROBE_MORE && !final)) {
            count->noise_bytes += (uint32_t)at;
            pel_frame_drop(buf, fill, at);
            return verdict == PEL_PROBE_FRAME;
        }
        if (verdict == PEL_PROBE_BAD_CHECKSUM) {
            count->bad_checksum++;
        } else {
            count->bad_length++; /* impossible, or cut by the end */
        }
        reject(buf, fill, count, at);
        if (!final) { return false; }
        at = 0;
    }
    count->noise_bytes += (uint32_t)at;
    *fill = 0;
    return false;
}

pel_order_t pel_time_order(pel_time_t t, pel_time_t tol_ns, pel_time_t given, pel_time_t *back, uint8_t *n_back,
                           pel_wire_counters_t *count)
{
    if (given == 0 || t > given + tol_ns) {
        *n_back = 0;
        return PEL_ORDER_NEW;
    }
    if (t >= given - tol_ns) {
        count->duplicate++;
        return PEL_ORDER_SAME;
    }
    count->time_back++;
    if (t > *back + tol_ns) {
        (*n_back)++;
    } else if (*n_back == 0u || t < *back - tol_ns) {
        *n_back = 1;
    }
    *back = t;
    if (*n_back < PEL_WIRE_RESTART) { return PEL_ORDER_BACK; }
    *n_back = 0;
    return PEL_ORDER_NEW;
}

bool pel_week_possible(int32_t week, double tow_s)
{
    return week >= PEL_WEEK_FIRST && week <= PEL_WEEK_LAST && tow_s >= 0.0 && tow_s < 604801.0;
}

pel_time_t pel_tow_ms_near(uint32_t tow_ms, pel_time_t ref)
{
    pel_time_t t = (pel_time_t)pel_time_week(ref) * PEL_NS_PER_WEEK + (pel_time_t)tow_ms * PEL_NS_PER_MS;
    if (t - ref > PEL_NS_PER_WEEK / 2) {
        t -= PEL_NS_PER_WEEK;
    } else if (ref - t > PEL_NS_PER_WEEK / 2) {
        t += PEL_NS_PER_WEEK;
    }
    return t;
}

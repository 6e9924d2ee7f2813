#include "pelorus/bits.h"

#include <string.h>

uint64_t pel_bits_u(const uint8_t *p, size_t pos, unsigned n_bits)
{
    uint64_t v = 0;
    size_t i = pos;
    const size_t end = pos + n_bits;
    while (i < end) {
        /* as many bits as this byte still has, or as are wanted */
        const unsigned left = 8u - (unsigned)(i & 7u);
        const unsigned take = (end - i < left) ? (unsigned)(end - i) : left;
        const uint64_t part = ((uint64_t)p[i >> 3] >> (left - take)) & ((1u << take) - 1u);
        v = (v << take) | part;
        i += take;
    }
    return v;
}

int64_t pel_bits_s(const uint8_t *p, size_t pos, unsigned n_bits)
{
    const uint64_t v = pel_bits_u(p, pos, n_bits);
    const uint64_t sign = UINT64_C(1) << (n_bits - 1u);
    return (int64_t)((v ^ sign) - sign);
}

void pel_bits_put(uint8_t *p, size_t pos, unsigned n_bits, uint64_t value)
{
    size_t i = pos + n_bits;
    while (i > pos) { /* from the last bit backwards, a byte at a time */
        const unsigned used = (unsigned)((i - 1u) & 7u) + 1u;
        const unsigned take = (i - pos < used) ? (unsigned)(i - pos) : used;
        const unsigned shift = 8u - used;
        const unsigned mask = ((1u << take) - 1u) << shift;
        const size_t at = (i - 1u) >> 3;
        p[at] = (uint8_t)((p[at] & ~mask) | (((unsigned)(value & 0xFFu) << shift) & mask));
        value >>= take;
        i -= take;
    }
}

void pel_bit_reader_init(pel_bit_reader_t *r, const uint8_t *p, size_t n_bytes)
{
    r->p = p;
    r->n_bits = 8u * n_bytes;
    r->pos = 0;
    r->overrun = false;
}

static bool advance(pel_bit_reader_t *r, size_t n_bits, size_t *at)
{
    if (r->overrun || n_bits > r->n_bits - r->pos) {
        r->overrun = true;
        return false;
    }
    *at = r->pos;
    r->pos += n_bits;
    return true;
}

uint64_t pel_read_u(pel_bit_reader_t *r, unsigned n_bits)
{
    size_t at;
    return advance(r, n_bits, &at) ? pel_bits_u(r->p, at, n_bits) : 0u;
}

int64_t pel_read_s(pel_bit_reader_t *r, unsigned n_bits)
{
    size_t at;
    return advance(r, n_bits, &at) ? pel_bits_s(r->p, at, n_bits) : 0;
}

int64_t pel_read_sm(pel_bit_reader_t *r, unsigned n_bits)
{
    size_t at;
    if (!advance(r, n_bits, &at)) { return 0; }
    const int64_t magnitude = (int64_t)pel_bits_u(r->p, at + 1u, n_bits - 1u);
    return (pel_bits_u(r->p, at, 1) != 0u) ? -magnitude : magnitude;
}

void pel_skip_bits(pel_bit_reader_t *r, size_t n_bits)
{
    size_t at;
    (void)advance(r, n_bits, &at);
}

void pel_bit_writer_init(pel_bit_writer_t *w, uint8_t *p, size_t n_bytes)
{
    memset(p, 0, n_bytes);
    w->p = p;
    w->n_bits = 8u * n_bytes;
    w->pos = 0;
    w->overrun = false;
    w->out_of_range = false;
}

static void write_bits(pel_bit_writer_t *w, unsigned n_bits, uint64_t value)
{
    if (w->overrun || n_bits > w->n_bits - w->pos) {
        w->overrun = true;
        return;
    }
    pel_bits_put(w->p, w->pos, n_bits, value);
    w->pos += n_bits;
}

void pel_write_u(pel_bit_writer_t *w, unsigned n_bits, uint64_t value)
{
    if (n_bits < 64u && (value >> n_bits) != 0u) { w->out_of_range = true; }
    write_bits(w, n_bits, value);
}

void pel_write_s(pel_bit_writer_t *w, unsigned n_bits, int64_t value)
{
    const int64_t limit = (int64_t)(UINT64_C(1) << (n_bits - 1u));
    if (n_bits < 64u && (value < -limit || value >= limit)) { w->out_of_range = true; }
    write_bits(w, n_bits, (uint64_t)value);
}

uint64_t pel_le_u(const uint8_t *p, unsigned n_bytes)
{
    uint64_t v = 0;
    for (unsigned i = n_bytes; i > 0; i--) { v = (v << 8) | p[i - 1u]; }
    return v;
}

int64_t pel_le_s(const uint8_t *p, unsigned n_bytes)
{
    const uint64_t sign = UINT64_C(1) << (8u * n_bytes - 1u);
    return (int64_t)((pel_le_u(p, n_bytes) ^ sign) - sign);
}

float pel_le_f32(const uint8_t *p)
{
    const uint32_t bits = (uint32_t)pel_le_u(p, 4);
    float v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

double pel_le_f64(const uint8_t *p)
{
    return pel_f64_from_bits(pel_le_u(p, 8));
}

void pel_le_put(uint8_t *p, unsigned n_bytes, uint64_t value)
{
    for (unsigned i = 0; i < n_bytes; i++) {
        p[i] = (uint8_t)value;
        value >>= 8;
    }
}

void pel_le_put_f32(uint8_t *p, float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    pel_le_put(p, 4, bits);
}

void pel_le_put_f64(uint8_t *p, double value)
{
    pel_le_put(p, 8, pel_f64_bits(value));
}

size_t pel_members_bytes(const pel_member_t m[], size_t n)
{
    size_t bytes = 0;
    for (size_t i = 0; i < n; i++) { bytes += (size_t)m[i].bytes * m[i].count; }
    return bytes;
}

/* A number of 1, 2, 4 or 8 bytes in memory, in whatever order the machine has them. */
static uint64_t load(const uint8_t *p, unsigned bytes)
{
    uint16_t v16;
    uint32_t v32;
    uint64_t v64;
    switch (bytes) {
    case 1: return *p;
    case 2: memcpy(&v16, p, sizeof v16); return v16;
    case 4: memcpy(&v32, p, sizeof v32); return v32;
    default: memcpy(&v64, p, sizeof v64); return v64;
    }
}

static void store(uint8_t *p, unsigned bytes, uint64_t v)
{
    const uint16_t v16 = (uint16_t)v;
    const uint32_t v32 = (uint32_t)v;
    switch (bytes) {
    case 1: *p = (uint8_t)v; break;
    case 2: memcpy(p, &v16, sizeof v16); break;
    case 4: memcpy(p, &v32, sizeof v32); break;
    default: memcpy(p, &v, sizeof v); break;
    }
}

size_t pel_members_put(const pel_member_t m[], size_t n, const void *from, uint8_t *out)
{
    uint8_t *at = out;
    for (const pel_member_t *f = m; f < m + n; f++) {
        const uint8_t *p = (const uint8_t *)from + f->at;
        for (unsigned k = 0; k < f->count; k++, p += f->bytes, at += f->bytes) {
            pel_le_put(at, f->bytes, load(p, f->bytes));
        }
    }
    return (size_t)(at - out);
}

size_t pel_members_get(const pel_member_t m[], size_t n, const uint8_t *in, void *to)
{
    const uint8_t *at = in;
    for (const pel_member_t *f = m; f < m + n; f++) {
        uint8_t *p = (uint8_t *)to + f->at;
        for (unsigned k = 0; k < f->count; k++, p += f->bytes, at += f->bytes) {
            store(p, f->bytes, pel_le_u(at, f->bytes));
        }
    }
    return (size_t)(at - in);
}

int64_t pel_round_i64(double x)
{
    const double limit = 4611686018427387904.0; /* 2^62 */
    if (!(x > -limit && x < limit)) { return INT64_MIN; }
    /* x + 0.5 would round again for large x: compare the fraction, which is exact */
    const int64_t whole = (int64_t)x;
    const double fraction = x - (double)whole;
    if (fraction >= 0.5) { return whole + 1; }
    if (fraction <= -0.5) { return whole - 1; }
    return whole;
}

double pel_pow2(int n)
{
    return pel_f64_from_bits((uint64_t)(n + 1023) << 52);
}

/* Proofs of base/bits.c and base/crc.c: everything the decoders read with. */
#include "pelorus/bits.h"
#include "prove.h"

/* PROVE bits_u: any field inside a buffer is read inside it and holds no more bits than it has
 * sources base/bits.c
 * flags --unwind 13
 * plant base/bits.c: (end - i < left) ? (unsigned)(end - i) : left => left */
void bits_u(void)
{
    uint8_t buf[12];
    any_bytes(buf, sizeof buf);
    const unsigned n_bits = any_u32();
    assume(n_bits >= 1 && n_bits <= 64);
    const size_t pos = any_upto(96 - n_bits);
    const uint64_t v = pel_bits_u(buf, pos, n_bits);
    claim(n_bits == 64 || (v >> n_bits) == 0);
}

/* PROVE bits_s: a signed field lies in the range of its width
 * sources base/bits.c
 * flags --unwind 13
 * plant base/bits.c: (int64_t)((v ^ sign) - sign) => (int64_t)((v ^ sign) + sign) */
void bits_s(void)
{
    uint8_t buf[12];
    any_bytes(buf, sizeof buf);
    const unsigned n_bits = any_u32();
    assume(n_bits >= 1 && n_bits <= 63);
    const int64_t v = pel_bits_s(buf, any_upto(96 - n_bits), n_bits);
    const int64_t limit = INT64_C(1) << (n_bits - 1);
    claim(v >= -limit && v < limit);
}

/* PROVE bits_put: what is written is read again, and no other bit changes
 * sources base/bits.c
 * flags --unwind 13
 * plant base/bits.c: ((1u << take) - 1u) << shift => 0xFFu << shift */
void bits_put(void)
{
    uint8_t buf[4], before[4];
    for (int i = 0; i < 4; i++) { before[i] = buf[i] = any_u8(); }
    const unsigned n_bits = any_u32();
    assume(n_bits >= 1 && n_bits <= 24);
    const size_t pos = any_upto(32 - n_bits), other = any_upto(31);
    const uint64_t value = any_u64();
    assume((value >> n_bits) == 0);
    pel_bits_put(buf, pos, n_bits, value);
    claim(pel_bits_u(buf, pos, n_bits) == value);
    assume(other < pos || other >= pos + n_bits);
    claim(pel_bits_u(buf, other, 1) == pel_bits_u(before, other, 1));
}

/* PROVE read_u: three reads of any widths never leave the buffer
 * sources base/bits.c
 * flags --unwind 13
 * plant base/bits.c: n_bits > r->n_bits - r->pos => n_bits > r->n_bits */
void read_u(void)
{
    uint8_t buf[8];
    pel_bit_reader_t r;
    any_bytes(buf, sizeof buf);
    pel_bit_reader_init(&r, buf, any_upto(sizeof buf));
    for (int i = 0; i < 3; i++) {
        const unsigned n_bits = any_u32();
        assume(n_bits >= 1 && n_bits <= 64);
        const uint64_t v = pel_read_u(&r, n_bits);
        claim(r.pos <= r.n_bits);
        claim(!r.overrun || v == 0);
    }
}

/* PROVE read_signed: so do reads of signed fields, in both notations
 * sources base/bits.c
 * flags --unwind 13
 * plant base/bits.c: r->pos += n_bits; => r->pos += n_bits + 1u; */
void read_signed(void)
{
    uint8_t buf[6];
    pel_bit_reader_t r;
    any_bytes(buf, sizeof buf);
    pel_bit_reader_init(&r, buf, any_upto(sizeof buf));
    for (int i = 0; i < 2; i++) {
        const unsigned n_bits = any_u32();
        assume(n_bits >= 1 && n_bits <= 64);
        (void)pel_read_s(&r, n_bits);
        (void)pel_read_sm(&r, n_bits);
        claim(r.pos <= r.n_bits);
    }
}

/* PROVE skip_bits: skipping any number of bits, however large, does not wrap around
 * sources base/bits.c
 * flags --unwind 13
 * quick
 * plant base/bits.c: n_bits > r->n_bits - r->pos => r->pos + n_bits > r->n_bits */
void skip_bits(void)
{
    uint8_t buf[4];
    pel_bit_reader_t r;
    any_bytes(buf, sizeof buf);
    pel_bit_reader_init(&r, buf, sizeof buf);
    pel_skip_bits(&r, any_size());
    const size_t before = r.pos;
    pel_skip_bits(&r, any_size());
    claim(r.pos >= before && r.pos <= r.n_bits);
    (void)pel_read_u(&r, 8);
}

/* PROVE write_u: three writes of any widths and values never leave the buffer
 * sources base/bits.c
 * flags --unwind 13
 * plant base/bits.c: n_bits > w->n_bits - w->pos => n_bits > w->n_bits */
void write_u(void)
{
    uint8_t buf[8];
    pel_bit_writer_t w;
    pel_bit_writer_init(&w, buf, any_upto(sizeof buf));
    for (int i = 0; i < 3; i++) {
        const unsigned n_bits = any_u32();
        assume(n_bits >= 1 && n_bits <= 64);
        const uint64_t value = any_u64();
        pel_write_u(&w, n_bits, value);
        claim(w.pos <= w.n_bits);
        claim(n_bits == 64 || (value >> n_bits) == 0 || w.out_of_range);
    }
}

/* PROVE write_s: a signed value that does not fit its field is told
 * sources base/bits.c
 * flags --unwind 13
 * plant base/bits.c: value >= limit) => value > limit) */
void write_s(void)
{
    uint8_t buf[8];
    pel_bit_writer_t w;
    pel_bit_writer_init(&w, buf, sizeof buf);
    const unsigned n_bits = any_u32();
    assume(n_bits >= 1 && n_bits <= 64);
    const int64_t value = any_i64();
    pel_write_s(&w, n_bits, value);
    claim(w.out_of_range || pel_bits_s(buf, 0, n_bits) == value);
}

/* PROVE le_integers: little-endian numbers of every width return
 * sources base/bits.c
 * flags --unwind 10
 * quick
 * plant base/bits.c: i > 0; i--) { v = (v << 8) | p[i - 1u] => i > 0; i--) { v = (v << 8) | p[i] */
void le_integers(void)
{
    uint8_t buf[8];
    const unsigned n = any_u32();
    assume(n >= 1 && n <= 8);
    const uint64_t value = any_u64();
    assume(n == 8 || (value >> (8 * n)) == 0);
    pel_le_put(buf, n, value);
    claim(pel_le_u(buf, n) == value);
    claim((pel_le_s(buf, n) < 0) == ((value >> (8 * n - 1)) == 1));
}

/* PROVE le_floats: floats of any bits are read and written inside their bytes
 * sources base/bits.c
 * flags --unwind 10
 * plant base/bits.c: pel_le_put(p, 8, pel_f64_bits(value)) => pel_le_put(p, 9, pel_f64_bits(value)) */
void le_floats(void)
{
    uint8_t in[8], out[8] = {0};
    any_bytes(in, sizeof in);
    pel_le_put_f64(out, pel_le_f64(in));
    pel_le_put_f32(out, pel_le_f32(in));
}

/* PROVE round_i64: any double, NaN and infinity too, becomes an integer or the mark for none
 * sources base/bits.c
 * flags --unwind 4 --boolector
 * plant base/bits.c: if (!(x > -limit && x < limit)) => if (x <= -limit || x >= limit) */
void round_i64(void)
{
    const double x = any_double();
    const int64_t n = pel_round_i64(x);
    claim((x == x && x > -4e18 && x < 4e18) || n == INT64_MIN ||
          (n >= -4611686018427387904 && n <= 4611686018427387904));
    if (x >= -1e6 && x <= 1e6) { claim((double)n - x <= 0.5 && (double)n - x >= -0.5); }
    if (x != x) { claim(n == INT64_MIN); }
}

/* PROVE pow2: every exponent of a normal double gives a positive finite number
 * sources base/bits.c
 * flags --unwind 9
 * plant base/bits.c: (uint64_t)(n + 1023) << 52 => (uint64_t)(n + 1024) << 52 */
void pow2(void)
{
    const int n = any_int();
    assume(n >= -1022 && n <= 1023);
    const double x = pel_pow2(n);
    claim(x > 0.0 && x <= 1.7976931348623157e308);
}

/* PROVE crc24q: any bytes, any start, stay within the table and 24 bits
 * sources base/crc.c
 * flags --unwind 9
 * quick
 * plant base/crc.c: & 0xFFFFFFu;\n    } => ;\n    } */
void crc24q(void)
{
    uint8_t buf[8];
    any_bytes(buf, sizeof buf);
    const uint32_t start = any_u32();
    assume(start <= 0xFFFFFF);
    claim(pel_crc24q(start, buf, any_upto(sizeof buf)) <= 0xFFFFFF);
}

/* PROVE crc32: any bytes stay within the table
 * sources base/crc.c
 * flags --unwind 9
 * quick
 * plant base/crc.c: i < n; i++) {\n        crc ^= p[i]; => i <= n; i++) {\n        crc ^= p[i]; */
void crc32(void)
{
    uint8_t buf[8];
    any_bytes(buf, sizeof buf);
    (void)pel_crc32_novatel(buf, any_upto(sizeof buf));
}

/* PROVE fletcher8: any bytes, and both sums are bytes
 * sources base/crc.c
 * flags --unwind 9
 * quick
 * plant base/crc.c: b = (b + a) & 0xFFu; => b = b + a + p[i + 1u]; */
void fletcher8(void)
{
    uint8_t buf[8];
    any_bytes(buf, sizeof buf);
    (void)pel_fletcher8(buf, any_upto(sizeof buf));
}

/* PROVE fnv1a: any bytes of any length
 * sources base/crc.c
 * flags --unwind 10
 * quick
 * plant base/crc.c: i < n; i++) { h = => i <= n; i++) { h = */
void fnv1a(void)
{
    uint8_t buf[8];
    any_bytes(buf, sizeof buf);
    (void)pel_fnv1a(buf, any_upto(sizeof buf), PEL_FNV_START);
}

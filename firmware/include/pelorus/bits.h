/* bits.h - bytes, bit fields and checksums that every wire format is made of. Room: base/.
 *
 * Bit positions count from the most significant bit of byte 0, as RTCM and navigation messages are drawn.
 * All functions are reentrant and cost O(bits) or O(bytes). */
#ifndef PELORUS_BITS_H
#define PELORUS_BITS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- checksums -------------------------------------------------------------------------------------------------- */

/* CRC-24Q (RTCM 3, polynomial 0x1864CFB, initial 0, MSB first). Pass the last result to continue; start with 0. */
uint32_t pel_crc24q(uint32_t crc, const uint8_t *p, size_t n);

/* CRC-32 as NovAtel uses it (polynomial 0xEDB88320 reflected, initial 0, no final inversion). */
uint32_t pel_crc32_novatel(const uint8_t *p, size_t n);

/* Rotate and exclusive-or of words in memory, for what never leaves it: any one flipped bit changes it. n_bytes: a multiple of four.
 * The result depends on the machine's order of bytes. Three instructions a word. */
uint32_t pel_word_check(const void *bytes, size_t n_bytes, uint32_t seed);

/* 8-bit Fletcher of UBX over class..payload, as (first byte << 8) | second byte. */
uint16_t pel_fletcher8(const uint8_t *p, size_t n);

/* FNV-1a (32 bit; Fowler, Noll, Vo). Pass the last result to continue; start with PEL_FNV_START. */
#define PEL_FNV_START UINT32_C(2166136261)
uint32_t pel_fnv1a(const void *bytes, size_t n, uint32_t seed);

/* ---- bit fields at a position; 1 <= n_bits <= 64. The caller guarantees that the buffer is long enough. ----------- */

uint64_t pel_bits_u(const uint8_t *p, size_t pos, unsigned n_bits);
int64_t pel_bits_s(const uint8_t *p, size_t pos, unsigned n_bits);          /* two's complement */
void pel_bits_put(uint8_t *p, size_t pos, unsigned n_bits, uint64_t value); /* low n_bits of value */

/* ---- a cursor over bits that cannot leave its buffer --------------------------------------------------------------- */

typedef struct {
    const uint8_t *p;
    size_t n_bits; /* size of the buffer, bits */
    size_t pos;    /* next bit */
    bool overrun;  /* a read went past the end; it gave 0 */
} pel_bit_reader_t;

void pel_bit_reader_init(pel_bit_reader_t *r, const uint8_t *p, size_t n_bytes);
uint64_t pel_read_u(pel_bit_reader_t *r, unsigned n_bits);
int64_t pel_read_s(pel_bit_reader_t *r, unsigned n_bits);  /* two's complement */
int64_t pel_read_sm(pel_bit_reader_t *r, unsigned n_bits); /* sign and magnitude */
void pel_skip_bits(pel_bit_reader_t *r, size_t n_bits);

typedef struct {
    uint8_t *p; /* must be zeroed by pel_bit_writer_init */
    size_t n_bits;
    size_t pos;
    bool overrun;      /* a write did not fit; nothing was written */
    bool out_of_range; /* a value did not fit its field */
} pel_bit_writer_t;

void pel_bit_writer_init(pel_bit_writer_t *w, uint8_t *p, size_t n_bytes); /* zeroes the buffer */
void pel_write_u(pel_bit_writer_t *w, unsigned n_bits, uint64_t value);
void pel_write_s(pel_bit_writer_t *w, unsigned n_bits, int64_t value);

/* ---- little-endian numbers ------------------------------------------------------------------------------------------ */

uint64_t pel_le_u(const uint8_t *p, unsigned n_bytes); /* 1 to 8 */
int64_t pel_le_s(const uint8_t *p, unsigned n_bytes);
float pel_le_f32(const uint8_t *p);
double pel_le_f64(const uint8_t *p);
void pel_le_put(uint8_t *p, unsigned n_bytes, uint64_t value); /* low bytes of value; cast a signed one to uint64_t */
void pel_le_put_f32(uint8_t *p, float value);
void pel_le_put_f64(uint8_t *p, double value);

/* The bits of a number are copied, never its struct or its pointer: IEEE 754 is asked for, byte order is not. */
static inline uint64_t pel_f64_bits(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}
static inline double pel_f64_from_bits(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Members of a struct in the order of their bytes: numbers of 1, 2, 4 or 8 bytes, integer or IEEE 754, alone or in arrays. */
typedef struct {
    uint8_t bytes, count;
    uint16_t at; /* offset in the struct */
} pel_member_t;

#define PEL_MEMBER(type, m)                                                                                            \
    {                                                                                                                  \
        sizeof(((type *)0)->m), 1, offsetof(type, m)                                                                   \
    }
#define PEL_ARRAY(type, m)                                                                                             \
    {                                                                                                                  \
        sizeof(((type *)0)->m[0]), sizeof(((type *)0)->m) / sizeof(((type *)0)->m[0]), offsetof(type, m)               \
    }
#define PEL_COUNT(table) (sizeof(table) / sizeof((table)[0]))

/* n members: their bytes together; out of a struct; into one. The buffer is large enough by the caller's word. put and get return the bytes. */
size_t pel_members_bytes(const pel_member_t m[], size_t n);
size_t pel_members_put(const pel_member_t m[], size_t n, const void *from, uint8_t *out);
size_t pel_members_get(const pel_member_t m[], size_t n, const uint8_t *in, void *to);

/* Nearest integer, ties away from zero; |x| < 2^62, else (or NaN) INT64_MIN, which no field can hold. */
int64_t pel_round_i64(double x);

/* 2^n, -1022 <= n <= 1023, exact. */
double pel_pow2(int n);

#ifdef __cplusplus
}
#endif
#endif

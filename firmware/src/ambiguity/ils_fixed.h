/* ils_fixed.h - arithmetic of the integer engine: 59 binary places in two words.
 *
 * The covariance of ambiguities needs more digits than a float has, and a Cortex-M4F has no others in hardware. Its integer unit has:
 * a product of two such numbers is three multiply-adds of 32 x 32 -> 64 bits (hi hi, hi lo, lo hi; lo lo is below 2^-60). Integers also
 * give the same bits on every machine. Bounds: docs/INTEGERS.md. */
#ifndef PELORUS_ILS_FIXED_H
#define PELORUS_ILS_FIXED_H

#include "pelorus/ambiguity.h"
#include "pelorus/math.h"

typedef pel_ils_fixed_t fixed_t;

#define PLACES 59
#define ONE    (INT64_C(1) << PLACES)

#define FRACTION   51 /* binary places of pel_ils_t's frac and a_z */
#define A_Z_PLACES 36

/* A function kept out of its caller, so that neither has to spare registers for the other: sums of products take twelve of fourteen. */
#define OWN_REGISTERS __attribute__((noinline))

/* Nearest integer of a_z. */
static inline int64_t whole_of(int64_t a_z)
{
    return (a_z + (INT64_C(1) << (A_Z_PLACES - 1))) >> A_Z_PLACES;
}

#define SWAP(type, a, b)                                                                                               \
    do {                                                                                                               \
        const type swap = (a);                                                                                         \
        (a) = (b);                                                                                                     \
        (b) = swap;                                                                                                    \
    } while (0)

/* Row i of a packed lower triangle. */
static inline fixed_t *fixed_row(fixed_t *packed, int i)
{
    return &packed[(i * (i + 1)) >> 1];
}
static inline const fixed_t *fixed_row_const(const fixed_t *packed, int i)
{
    return &packed[(i * (i + 1)) >> 1];
}

/* Leading zeros of x > 0, sign bit included. */
static inline int leading_zeros(uint64_t x)
{
    const uint32_t top = (uint32_t)(x >> 32);
    return (top != 0) ? __builtin_clz(top) : 32 + __builtin_clz((uint32_t)x);
}

/* Two words to one, and back with |lo| <= 2^29. */
static inline int64_t join(fixed_t x)
{
    return (int64_t)x.hi * (INT64_C(1) << 30) + x.lo;
}
static inline fixed_t split(int64_t x)
{
    const int32_t hi = (int32_t)((x + (INT64_C(1) << 29)) >> 30);
    return (fixed_t){hi, (int32_t)((uint32_t)x - ((uint32_t)hi << 30))};
}

/* x 2^k, k >= 0, for results that fit. */
static inline int64_t scaled(int64_t x, int k)
{
    return (int64_t)((uint64_t)x << k);
}

static inline pel_real real_of(fixed_t x)
{
    return (pel_real)x.hi * PEL_R(1073741824.0) + (pel_real)x.lo;
}
static inline pel_real real_of_whole(int64_t x)
{
    return (pel_real)(int32_t)(x >> 32) * PEL_R(4294967296.0) + (pel_real)(uint32_t)x;
}

/* A sum of products, rounded once. */
typedef struct {
    int64_t top, rest; /* units of 2^-58 and 2^-88 */
} sum_t;

#define SUM_START ((sum_t){0, INT64_C(1) << 28})

static inline void add_product(sum_t *s, fixed_t a, fixed_t b)
{
    s->top += (int64_t)a.hi * b.hi;
    s->rest += (int64_t)a.hi * b.lo;
    s->rest += (int64_t)a.lo * b.hi;
}
static inline int64_t sum_value(sum_t s)
{
    return s.top * 2 + (s.rest >> 29);
}

static inline int64_t square(fixed_t a)
{
    return (int64_t)a.hi * a.hi * 2 + (((int64_t)a.hi * a.lo) >> 28);
}
static inline int64_t product(fixed_t a, fixed_t b)
{
    sum_t s = SUM_START;
    add_product(&s, a, b);
    return sum_value(s);
}

/* Sum of a[i] b[i], i < n. */
static inline int64_t fixed_dot(const fixed_t *a, const fixed_t *b, int n)
{
    sum_t s = SUM_START;
    const fixed_t *end = a + n;
    if ((n & 1) != 0) { add_product(&s, *a++, *b++); }
    for (; a != end; a += 2, b += 2) {
        add_product(&s, a[0], b[0]);
        add_product(&s, a[1], b[1]);
    }
    return sum_value(s);
}

/* A reciprocal as mantissa 2^shift, the mantissa in [1, 2]. */
typedef struct {
    fixed_t mantissa;
    int shift; /* at most 30 */
} reciprocal_t;

/* 1 / sqrt(x), 2^-60 ONE < x < ONE, to 2^-57. */
reciprocal_t pel_ils_inverse_root(int64_t x);

/* x times a reciprocal, for results below ONE. */
static inline fixed_t times(int64_t x, reciprocal_t r)
{
    const int64_t up = (int64_t)((uint64_t)x * ((uint32_t)1 << r.shift));
    const fixed_t parts = {(int32_t)(up >> 30),
                           (int32_t)(up & 0x3FFFFFFF)}; /* not rounded: only one product is made of them */
    return split(product(parts, r.mantissa));
}

#endif

/* roots.c - square roots and rounding, exact on every machine. */
#include "float_bits.h"
#include "pelorus/math.h"

/* The square-root instruction itself: a builtin may call the C library for negative arguments. */
#if defined(__x86_64__)
#define HAS_SQRT64   1
#define HAS_SQRT32   1
#define SQRT64(r, x) __asm__("sqrtsd %1, %0" : "=x"(r) : "x"(x))
#define SQRT32(r, x) __asm__("sqrtss %1, %0" : "=x"(r) : "x"(x))
#elif defined(__aarch64__)
#define HAS_SQRT64   1
#define HAS_SQRT32   1
#define SQRT64(r, x) __asm__("fsqrt %d0, %d1" : "=w"(r) : "w"(x))
#define SQRT32(r, x) __asm__("fsqrt %s0, %s1" : "=w"(r) : "w"(x))
#elif defined(__ARM_FP) && ((__ARM_FP & 8) != 0)
#define HAS_SQRT64   1
#define HAS_SQRT32   1
#define SQRT64(r, x) __asm__("vsqrt.f64 %P0, %P1" : "=w"(r) : "w"(x))
#define SQRT32(r, x) __asm__("vsqrt.f32 %0, %1" : "=t"(r) : "t"(x))
#elif defined(__ARM_FP) && ((__ARM_FP & 4) != 0)
#define HAS_SQRT32   1
#define SQRT32(r, x) __asm__("vsqrt.f32 %0, %1" : "=t"(r) : "t"(x))
#endif

double pel_sqrt_soft(double x); /* external for the test that compares it with the instruction */

/* Digit by digit: 54 bits of the root of the significand, the last of which rounds. A root of a 53-bit number is never
 * exactly half way, so that bit decides alone. */
double pel_sqrt_soft(double x)
{
    uint64_t b = pel_f64_bits(x);
    if (x == 0.0 || b == UINT64_C(0x7FF0000000000000)) { return x; }
    if (!(x > 0.0)) { return not_a_number(); }

    int e = (int)(b >> 52);
    if (e == 0) { /* subnormal: scale by 2^54 first */
        b = pel_f64_bits(x * 18014398509481984.0);
        e = (int)(b >> 52) - 54;
    }
    uint64_t m = (b & UINT64_C(0xFFFFFFFFFFFFF)) | UINT64_C(0x10000000000000);
    e -= 1023;
    if ((e & 1) != 0) {
        m <<= 1;
        e -= 1;
    }
    uint64_t rest = 0;
    uint64_t root = 0; /* of the digits taken so far */
    m <<= 10;          /* m in [2^62, 2^64): two bits a digit from the top */
    for (int i = 0; i < 54; i++) {
        rest = (rest << 2) | (m >> 62);
        m <<= 2;
        const uint64_t trial = (root << 2) | 1u;
        root <<= 1;
        if (rest >= trial) {
            rest -= trial;
            root |= 1u;
        }
    }
    const uint64_t rounded = (root + 1u) >> 1; /* 53 bits, or 2^53, which carries into the exponent below */
    return pel_f64_from_bits(((uint64_t)(e / 2 + 1022) << 52) + rounded);
}

double pel_sqrt(double x)
{
#if defined(HAS_SQRT64)
    double r;
    SQRT64(r, x);
    return r;
#else
    return pel_sqrt_soft(x);
#endif
}

pel_real pel_sqrtr(pel_real x)
{
#if PEL_REAL_DOUBLE
    return pel_sqrt(x);
#elif defined(HAS_SQRT32)
    float r;
    SQRT32(r, x);
    return r;
#else
    /* rounding the double root again is exact: 53 >= 2 * 24 + 2 bits */
    return (float)pel_sqrt_soft((double)x);
#endif
}

double pel_floor(double x)
{
    if (!(pel_fabs(x) < 4503599627370496.0)) { return x; } /* 2^52: an integer already, or NaN */
    const double t = (double)(int64_t)x;                   /* toward zero */
    return (t > x) ? t - 1.0 : t;
}

double pel_round(double x)
{
    if (!(pel_fabs(x) < 4503599627370496.0)) { return x; }
    const double t = (double)(int64_t)x;
    const double rest = x - t; /* exact */
    if (rest >= 0.5) { return t + 1.0; }
    if (rest <= -0.5) { return t - 1.0; }
    return t;
}

bool pel_isfinite(double x)
{
    return (pel_f64_bits(x) & UINT64_C(0x7FF0000000000000)) != UINT64_C(0x7FF0000000000000);
}

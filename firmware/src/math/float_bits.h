/* float_bits.h - a double and its bits. Private to math/. */
#ifndef PELORUS_MATH_FLOAT_BITS_H
#define PELORUS_MATH_FLOAT_BITS_H

#include <stdint.h>
#include <string.h>

static inline uint64_t bits_of(double x)
{
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    return b;
}

static inline double from_bits(uint64_t b)
{
    double x;
    memcpy(&x, &b, sizeof x);
    return x;
}

static inline double not_a_number(void)
{
    return from_bits(UINT64_C(0x7FF8000000000000));
}

/* 2^k for -1022 <= k <= 1023. */
static inline double power_of_two(int k)
{
    return from_bits((uint64_t)(k + 1023) << 52);
}

#endif

/* float_bits.h - doubles by their bits. Private to math/. */
#ifndef PELORUS_MATH_FLOAT_BITS_H
#define PELORUS_MATH_FLOAT_BITS_H

#include "pelorus/bits.h"

static inline double not_a_number(void)
{
    return pel_f64_from_bits(UINT64_C(0x7FF8000000000000));
}

#endif

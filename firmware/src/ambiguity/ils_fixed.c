/* ils_fixed.c - the reciprocal root: from a float's 24 bits to 57 in one step of third order. */
#include "ils_fixed.h"

reciprocal_t pel_ils_inverse_root(int64_t x)
{
    const int shift = (leading_zeros((uint64_t)x) - (64 - PLACES)) / 2;
    const fixed_t v = split(scaled(x, 2 * shift));                              /* [1/4, 1) */
    const pel_real half = PEL_R(6219777023950.951) / pel_sqrtr((pel_real)v.hi); /* 2^42.5 / root */
    const fixed_t h = {(int32_t)half, 0};
    const int64_t e = ONE - 4 * product(split(product(v, h)), h); /* below 2^-21: its square needs one word */
    const int64_t e_word = (int32_t)(e >> 8);
    const int64_t e2_eighth = (e_word * e_word) >> 46;
    return (reciprocal_t){split(2 * (join(h) + product(h, split((e >> 1) + 3 * e2_eighth)))), shift};
}

/* arm_double_add.c - double addition rounded as IEEE 754 says, for ARM cores without a double-precision FPU.
 *
 * libgcc's __aeabi_dadd and __aeabi_dsub (seen in GCC 12.2) keep too few bits of the smaller operand when the exponents are 33 apart and
 * the difference loses its leading bit: 1 - 0x1.0e14696b62a48p-33 comes out one unit in the last place too large. That is once in
 * thousands of subtractions, and enough to make a board's solutions differ from the desktop's. The linker sends all calls through
 * here (-Wl,--wrap=__aeabi_dadd,--wrap=__aeabi_dsub); all but the doubtful ones go on to libgcc, ten instructions later.
 *
 * Doubles are taken as their two words, low word first: the ABI passes both in the same registers. */
#include <stdbool.h>
#include <stdint.h>

#define SIGN   UINT64_C(0x8000000000000000)
#define HIDDEN UINT64_C(0x10000000000000)
#define GUARD  10 /* bits kept below the last place; the lowest says that something was lost below it */

typedef uint64_t sum_t(uint32_t a_low, uint32_t a_high, uint32_t b_low, uint32_t b_high);
sum_t __real___aeabi_dadd, double_add_doubtful, double_subtract_doubtful;
void __wrap___aeabi_dadd(void); /* in truth sum_t: written in assembler below */
void __wrap___aeabi_dsub(void);

static uint32_t exponent(uint64_t a)
{
    const uint32_t e = (uint32_t)(a >> 52) & 0x7FFu;
    return (e == 0) ? 1 : e;
}

static uint64_t whole(uint64_t a)
{
    const uint64_t fraction = a & (HIDDEN - 1);
    return ((uint32_t)(a >> 52 & 0x7FFu) == 0) ? fraction : fraction | HIDDEN;
}

/* |large| - |small|, with the sign of large, a normal number 33 exponents above small. */
static uint64_t subtract(uint64_t large, uint64_t small)
{
    const uint64_t s = whole(small);
    const int shift = 33 - GUARD;
    const bool lost = (s & ((UINT64_C(1) << shift) - 1)) != 0;
    uint64_t d = (whole(large) << GUARD) - ((s >> shift) | (lost ? 1u : 0u));
    uint64_t e = exponent(large);
    if (d < HIDDEN << GUARD) {
        d <<= 1;
        e--;
    }
    const uint64_t rest = d & ((UINT64_C(1) << GUARD) - 1);
    const uint64_t half = UINT64_C(1) << (GUARD - 1);
    d >>= GUARD;
    if (rest > half || (rest == half && (d & 1u) != 0)) { d++; }
    return (large & SIGN) | (((e - 1) << 52) + d); /* the hidden bit, or a carry beyond it, counts the exponent up */
}

/* Wrong ones have opposite signs, are finite, and their effective exponents are 33 apart. */
uint64_t double_add_doubtful(uint32_t a_low, uint32_t a_high, uint32_t b_low, uint32_t b_high)
{
    const uint64_t a = (uint64_t)a_high << 32 | a_low, b = (uint64_t)b_high << 32 | b_low;
    const uint32_t ea = exponent(a), eb = exponent(b);
    const bool differ = ((a ^ b) & SIGN) != 0 && ea != 0x7FF && eb != 0x7FF;
    if (differ && ea == eb + 33) { return subtract(a, b); }
    if (differ && eb == ea + 33) { return subtract(b, a); }
    return __real___aeabi_dadd(a_low, a_high, b_low, b_high);
}

uint64_t double_subtract_doubtful(uint32_t a_low, uint32_t a_high, uint32_t b_low, uint32_t b_high)
{
    return double_add_doubtful(a_low, a_high, b_low, b_high ^ 0x80000000u);
}

/* Doubtful: exponents 33 apart, or 34 where one may be subnormal. Nothing but the scratch register is touched on the way past. */
#define PASS_UNLESS_DOUBTFUL(doubtful, real)                                                                           \
    __asm volatile("lsr  r12, r3, #20            \n\t" /* signs only touch bit 11 of the difference */                 \
                   "rsb  r12, r12, r1, lsr #20   \n\t"                                                                 \
                   "add  r12, r12, #34           \n\t"                                                                 \
                   "ubfx r12, r12, #0, #11       \n\t"                                                                 \
                   "cmp  r12, #1                 \n\t"                                                                 \
                   "bls  " #doubtful "           \n\t"                                                                 \
                   "sub  r12, r12, #67           \n\t"                                                                 \
                   "cmp  r12, #1                 \n\t"                                                                 \
                   "bls  " #doubtful "           \n\t"                                                                 \
                   "b.w  " #real "               \n\t")

__attribute__((naked)) void __wrap___aeabi_dadd(void)
{
    PASS_UNLESS_DOUBTFUL(double_add_doubtful, __real___aeabi_dadd);
}

__attribute__((naked)) void __wrap___aeabi_dsub(void)
{
    PASS_UNLESS_DOUBTFUL(double_subtract_doubtful, __real___aeabi_dsub);
}

/* support_input.c - bytes of an input as numbers, and small checks. */
#include <math.h>
#include <string.h>

#include "fuzz.h"

uint8_t fuzz_u8(fuzz_input_t *in)
{
    if (in->left == 0) { return 0; }
    in->left--;
    return *in->at++;
}

uint32_t fuzz_u32(fuzz_input_t *in)
{
    uint32_t v = 0;
    for (int i = 0; i < 4; i++) { v = (v << 8) | fuzz_u8(in); }
    return v;
}

double fuzz_double(fuzz_input_t *in)
{
    static const double SPECIAL[] = {NAN,   INFINITY, -INFINITY, 0.0,  -0.0,  5e-324, -1e-310, 1e300, -1e300, 9.3e18,
                                     -1e19, 2.2e9,    -2.2e9,    1e-9, -1e-9, 1.0,    -1.0,    0.5,   1e6,    6.4e6};
    const uint8_t kind = fuzz_u8(in);
    if (kind < 200) { return SPECIAL[kind % (sizeof SPECIAL / sizeof SPECIAL[0])]; }
    const uint64_t bits = ((uint64_t)fuzz_u32(in) << 32) | fuzz_u32(in);
    double v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

bool fuzz_counters_grew(const void *before, const void *after, size_t bytes)
{
    for (size_t i = 0; i < bytes / sizeof(uint32_t); i++) {
        uint32_t a;
        uint32_t b;
        memcpy(&a, (const uint8_t *)before + i * sizeof a, sizeof a);
        memcpy(&b, (const uint8_t *)after + i * sizeof b, sizeof b);
        if (b < a) { return false; }
    }
    return true;
}

bool fuzz_finite(double x)
{
    return isfinite(x);
}

/* support_frames.c - checksums made good after a mutation. */
#include <string.h>

#include "fuzz.h"
#include "pelorus/bits.h"

/* Repairs the frame that begins at p, if one does; returns its length, else 1. */
static size_t repair(uint8_t *p, size_t n)
{
    if (n >= 8 && p[0] == 0xB5 && p[1] == 0x62) {
        const size_t length = 8u + (size_t)pel_le_u(p + 4, 2);
        if (length > n) { return 1; }
        const uint16_t sum = pel_fletcher8(p + 2, length - 4u);
        p[length - 2u] = (uint8_t)(sum >> 8);
        p[length - 1u] = (uint8_t)sum;
        return length;
    }
    if (n >= 6 && p[0] == 0xD3) {
        p[1] &= 3u;
        const size_t length = 6u + (size_t)pel_bits_u(p, 14, 10);
        if (length > n) { return 1; }
        pel_bits_put(p, 8u * (length - 3u), 24, pel_crc24q(0, p, length - 3u));
        return length;
    }
    if (n >= PEL_OUT_OVERHEAD && p[0] == 'P' && p[1] == 'L') {
        const size_t length = PEL_OUT_OVERHEAD + (size_t)pel_le_u(p + 4, 2);
        if (length > n) { return 1; }
        pel_bits_put(p, 8u * (length - 3u), 24, pel_crc24q(0, p + 2, length - 5u));
        return length;
    }
    if (n >= 16 && p[0] == 0xAA && p[1] == 0x44 && p[2] == 0x13) {
        const size_t length = 16u + (size_t)p[3];
        if (length > n) { return 1; }
        pel_le_put(p + length - 4u, 4, pel_crc32_novatel(p, length - 4u));
        return length;
    }
    return 1;
}

void fuzz_repair_frames(uint8_t *data, size_t n)
{
    for (size_t at = 0; at < n;) { at += repair(data + at, n - at); }
}

size_t fuzz_mutate_frames(uint8_t *data, size_t n, size_t max, unsigned seed)
{
    const size_t m = LLVMFuzzerMutate(data, n, max);
    if (seed % 8u != 0u) { fuzz_repair_frames(data, m); }
    return m;
}

/* hash.c - FNV-1a of the filter (Fowler, Noll, Vo; 32 bit): what two machines compare. */
#include <string.h>

#include "packed.h"
#include "pelorus/filter.h"

#define FNV_PRIME UINT32_C(16777619)

uint32_t pel_fnv1a(const void *bytes, size_t n, uint32_t seed)
{
    const uint8_t *b = bytes;
    uint32_t h = seed;
    for (size_t i = 0; i < n; i++) { h = (h ^ b[i]) * FNV_PRIME; }
    return h;
}

/* Least significant byte first, whatever the machine's order. */
static uint32_t hash_word(uint64_t word, size_t bytes, uint32_t h)
{
    for (size_t i = 0; i < bytes; i++) {
        h = (h ^ (uint32_t)(word & 0xFFu)) * FNV_PRIME;
        word >>= 8;
    }
    return h;
}

static uint32_t hash_reals(const pel_real *v, int n, uint32_t h)
{
    for (int i = 0; i < n; i++) {
#if PEL_REAL_DOUBLE
        uint64_t word;
#else
        uint32_t word;
#endif
        memcpy(&word, &v[i], sizeof word);
        h = hash_word(word, sizeof word, h);
    }
    return h;
}

uint32_t pel_ud_hash(const pel_ud_t *ud, uint32_t seed)
{
    uint32_t h = hash_word((uint64_t)ud->n, 4, seed);
    h = hash_reals(ud->U, column(ud->n), h);
    h = hash_reals(ud->D, ud->n, h);
    return hash_reals(ud->x, ud->n, h);
}

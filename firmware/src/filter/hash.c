/* hash.c - the filter in 32 bits (after FNV-1a by Fowler, Noll, Vo): what two machines compare. */
#include <string.h>

#include "packed.h"
#include "pelorus/bits.h"
#include "pelorus/filter.h"

#define FNV_PRIME UINT32_C(16777619)

/* A whole word instead of a byte: a fifth of the work. The product carries no bit downwards, so its high half is folded into the low. */
static uint32_t hash_word(uint32_t word, uint32_t h)
{
    h = (h ^ word) * FNV_PRIME;
    return h ^ (h >> 16);
}

static uint32_t hash_reals(const pel_real *v, int n, uint32_t h)
{
    for (int i = 0; i < n; i++) {
#if PEL_REAL_DOUBLE
        uint64_t word;
        memcpy(&word, &v[i], sizeof word);
        h = hash_word((uint32_t)(word >> 32), hash_word((uint32_t)word, h));
#else
        uint32_t word;
        memcpy(&word, &v[i], sizeof word);
        h = hash_word(word, h);
#endif
    }
    return h;
}

uint32_t pel_ud_hash(const pel_ud_t *ud, uint32_t seed)
{
    uint32_t h = hash_word((uint32_t)ud->n, seed);
    h = hash_reals(ud->U, column(ud->n), h);
    h = hash_reals(ud->D, ud->n, h);
    return hash_reals(ud->x, ud->n, h);
}

/* hash.c - FNV-1a of the filter: what two machines compare. */
#include "packed.h"
#include "pelorus/bits.h"
#include "pelorus/filter.h"

/* Least significant byte first, whatever the machine's order. */
static uint32_t hash_reals(const pel_real *v, int n, uint32_t h)
{
    uint8_t bytes[sizeof(pel_real)];
    for (int i = 0; i < n; i++) {
#if PEL_REAL_DOUBLE
        pel_le_put_f64(bytes, v[i]);
#else
        pel_le_put_f32(bytes, v[i]);
#endif
        h = pel_fnv1a(bytes, sizeof bytes, h);
    }
    return h;
}

uint32_t pel_ud_hash(const pel_ud_t *ud, uint32_t seed)
{
    uint8_t n[4];
    pel_le_put(n, sizeof n, (uint64_t)ud->n);
    uint32_t h = pel_fnv1a(n, sizeof n, seed);
    h = hash_reals(ud->U, column(ud->n), h);
    h = hash_reals(ud->D, ud->n, h);
    return hash_reals(ud->x, ud->n, h);
}

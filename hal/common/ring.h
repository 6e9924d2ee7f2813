/* ring.h - bytes between an interrupt and the main loop. One writer and one reader, so no lock is needed: each index is written by one
 * side only. */
#ifndef HAL_RING_H
#define HAL_RING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint8_t *bytes;
    uint32_t size;          /* a power of two */
    volatile uint32_t head; /* bytes ever put in; head - tail are waiting */
    volatile uint32_t tail; /* bytes ever taken out */
    volatile uint32_t lost;
} ring_t;

/* Keep the compiler from moving a ring's bytes past its index; one core, so the hardware needs no barrier. */
static inline void ring_barrier(void)
{
    __asm volatile("" ::: "memory");
}

/* False: full. */
static inline bool ring_put(ring_t *r, uint8_t byte)
{
    if (r->head - r->tail >= r->size) { return false; }
    r->bytes[r->head & (r->size - 1)] = byte;
    ring_barrier();
    r->head++;
    return true;
}

/* False: empty. */
static inline bool ring_get(ring_t *r, uint8_t *byte)
{
    if (r->tail == r->head) { return false; }
    ring_barrier();
    *byte = r->bytes[r->tail & (r->size - 1)];
    r->tail++;
    return true;
}

/* What waits and fits; how many bytes. */
static inline size_t ring_read(ring_t *r, uint8_t *buf, size_t cap)
{
    size_t n = 0;
    while (n < cap && ring_get(r, &buf[n])) { n++; }
    return n;
}

/* What there is room for; how many bytes. */
static inline size_t ring_write(ring_t *r, const uint8_t *buf, size_t n)
{
    size_t taken = 0;
    while (taken < n && ring_put(r, buf[taken])) { taken++; }
    return taken;
}

#endif

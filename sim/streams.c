/* streams.c - see streams.h. */
#include "streams.h"

#include <stdlib.h>
#include <string.h>

#include "common/capture_log.h"

struct packet_t {
    pel_time_t t_ns;
    uint64_t order; /* of sending, where arrivals are equal */
    const char *channel;
    uint8_t *data;
    size_t n;
};

void streams_init(streams_t *s, sink_t sink, void *context)
{
    memset(s, 0, sizeof *s);
    s->sink = sink;
    s->context = context;
}

void streams_free(streams_t *s)
{
    for (int i = 0; i < s->n; i++) { free(s->heap[i].data); }
    free(s->heap);
    memset(s, 0, sizeof *s);
}

void line_init(line_t *l, const char *channel, const line_config_t *cfg, uint64_t seed, uint64_t name)
{
    l->channel = channel;
    l->cfg = *cfg;
    l->last_ns = 0;
    rng_init(&l->rng, seed, 1000u + name);
}

static bool earlier(const packet_t *a, const packet_t *b)
{
    return (a->t_ns != b->t_ns) ? a->t_ns < b->t_ns : a->order < b->order;
}

static void swap(packet_t *a, packet_t *b)
{
    const packet_t x = *a;
    *a = *b;
    *b = x;
}

static bool push(streams_t *s, const packet_t *p)
{
    if (s->n == s->cap) {
        const int cap = (s->cap == 0) ? 64 : 2 * s->cap;
        packet_t *grown = realloc(s->heap, (size_t)cap * sizeof *grown);
        if (grown == NULL) { return false; }
        s->heap = grown;
        s->cap = cap;
    }
    int i = s->n++;
    s->heap[i] = *p;
    while (i > 0 && earlier(&s->heap[i], &s->heap[(i - 1) / 2])) {
        swap(&s->heap[i], &s->heap[(i - 1) / 2]);
        i = (i - 1) / 2;
    }
    return true;
}

static packet_t pop(streams_t *s)
{
    const packet_t first = s->heap[0];
    s->heap[0] = s->heap[--s->n];
    s->heap[s->n].data = NULL; /* the bytes belong to the caller or to the entry that moved */
    for (int i = 0;;) {
        int child = 2 * i + 1;
        if (child >= s->n) { break; }
        if (child + 1 < s->n && earlier(&s->heap[child + 1], &s->heap[child])) { child++; }
        if (!earlier(&s->heap[child], &s->heap[i])) { break; }
        swap(&s->heap[child], &s->heap[i]);
        i = child;
    }
    return first;
}

static bool damage(line_t *l, uint8_t *data, size_t n)
{
    bool hit = false;
    for (size_t i = 0; i < 8 * n; i++) {
        if (rng_uniform(&l->rng) < l->cfg.bit_errors) {
            data[i / 8] ^= (uint8_t)(1u << (i % 8));
            hit = true;
        }
    }
    return hit;
}

bool streams_send(streams_t *s, line_t *l, pel_time_t t, const uint8_t *data, size_t n)
{
    if (n == 0) { return true; }
    if (l->cfg.lost_frames > 0.0 && rng_uniform(&l->rng) < l->cfg.lost_frames) {
        s->lost++;
        return true;
    }
    packet_t p = {.order = s->count++, .channel = l->channel, .n = n};
    double delay_s = l->cfg.latency_s;
    if (l->cfg.jitter_s > 0.0) { delay_s += l->cfg.jitter_s * rng_uniform(&l->rng); }
    p.t_ns = t + (pel_time_t)(1e9 * delay_s);
    if (p.t_ns < l->last_ns) { p.t_ns = l->last_ns; }
    l->last_ns = p.t_ns;
    p.data = malloc(n);
    if (p.data == NULL) { return false; }
    memcpy(p.data, data, n);
    if (l->cfg.bit_errors > 0.0 && damage(l, p.data, n)) { s->damaged++; }
    if (!push(s, &p)) {
        free(p.data);
        return false;
    }
    return true;
}

bool streams_until(streams_t *s, pel_time_t t)
{
    while (s->n > 0 && s->heap[0].t_ns < t) {
        const packet_t p = pop(s);
        const bool ok = s->sink(s->context, capture_unix_us(p.t_ns), p.channel, p.data, p.n);
        free(p.data);
        if (!ok) { return false; }
    }
    return true;
}

/* streams.h - serial lines: frames go in at the time they were made, and come out in the order they arrive. */
#ifndef PELORUS_SIM_STREAMS_H
#define PELORUS_SIM_STREAMS_H

#include <stdbool.h>
#include <stdint.h>

#include "pelorus/base.h"
#include "rng.h"
#include "scenario.h"

/* Where events go. False: it cannot take more (disk full). */
typedef bool (*sink_t)(void *context, int64_t unix_us, const char *channel, const uint8_t *data, size_t n);

typedef struct packet_t packet_t;

/* One line. Bytes on it keep their order. */
typedef struct {
    const char *channel;
    line_config_t cfg;
    rng_t rng;
    pel_time_t last_ns;
} line_t;

typedef struct {
    sink_t sink;
    void *context;
    packet_t *heap; /* earliest arrival first */
    int n, cap;
    uint64_t count;
    uint64_t lost, damaged; /* frames the lines lost or flipped bits in, on purpose */
} streams_t;

void streams_init(streams_t *s, sink_t sink, void *context);
void streams_free(streams_t *s);

void line_init(line_t *l, const char *channel, const line_config_t *cfg, uint64_t seed, uint64_t name);

/* Send n bytes made at t. False: out of memory. */
bool streams_send(streams_t *s, line_t *l, pel_time_t t, const uint8_t *data, size_t n);

/* Give everything that arrives before t to the sink. False: the sink refused, or out of memory. */
bool streams_until(streams_t *s, pel_time_t t);

#endif

/* timeline.h - the bytes of one serial line with their arrival times, and the merging of several lines into a capture. */
#ifndef PELORUS_TOOLS_CAPTURE_TIMELINE_H
#define PELORUS_TOOLS_CAPTURE_TIMELINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pelorus/base.h"

/* Largest event: what a driver hands over at once. */
#define TIMELINE_CHUNK 1024

typedef struct {
    pel_time_t t_ns; /* arrival */
    size_t at;       /* of its bytes in timeline_t.bytes */
    uint32_t n;
    bool frame_ended; /* no frame is open behind these bytes: others may follow here */
} timeline_event_t;

/* Arrival never goes back within a line: an earlier time is taken as that of the event before. */
typedef struct {
    timeline_event_t *event; /* owned */
    size_t n, cap;
    uint8_t *bytes; /* owned */
    size_t n_bytes, cap_bytes;
    pel_time_t last_ns; /* of the last event */
} timeline_t;

void timeline_free(timeline_t *t);

/* Append bytes, in events of at most TIMELINE_CHUNK; frame_ended is told of the last. False: out of memory. */
bool timeline_add(timeline_t *t, pel_time_t t_ns, const uint8_t *data, size_t n, bool frame_ended);

/* Put the events of `extra` (whole frames) into t by time, but only where no frame of t is open: a frame that is due
 * inside another waits for its end. Both keep their order. False: out of memory, t then unchanged. */
bool timeline_inject(timeline_t *t, const timeline_t *extra);

/* Called for each event in order of arrival over all lines; lines given first go first at equal times. False stops. */
typedef bool (*timeline_sink_t)(void *user, int line, pel_time_t t_ns, const uint8_t *data, size_t n, double fraction);
bool timeline_merge(const timeline_t *line, int n_lines, timeline_sink_t sink, void *user);

#endif

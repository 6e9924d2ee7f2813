/* raw.h - recorded serial bytes, unchanged, with the times at which they arrived.
 *
 * The stream is decoded with the firmware's own decoders only to learn its times: the bytes up to and including an epoch
 * arrive at that epoch plus a latency, or when a time tag file says. */
#ifndef PELORUS_TOOLS_CAPTURE_RAW_H
#define PELORUS_TOOLS_CAPTURE_RAW_H

#include "input.h"
#include "pelorus/base.h"
#include "tagfile.h"
#include "tally.h"
#include "timeline.h"

typedef struct {
    pel_time_t first_ns, last_ns; /* first and last epoch or sample */
    pel_time_t tag_late_ns; /* how much the tags' clock was found ahead of GPS time, and corrected; 0 without tags */
    uint64_t n;             /* epochs or samples */
} raw_times_t;

/* UBX, RTCM 3, or both mixed. approx: GPS time within 3 days, 0 if not known (then the stream has to tell its week).
 * tags may be NULL. False with *why (a literal) if no time is found or memory is short. */
bool raw_receiver(const input_t *in, pel_time_t approx, pel_time_t latency, const tagfile_t *tags, tally_t *tally,
                  timeline_t *out, raw_times_t *times, const char **why);

/* Pelorus IMU frames or NovAtel RAWIMUSX: each sample arrives at its own time plus the latency. */
bool raw_imu(const input_t *in, pel_time_t latency, tally_t *tally, timeline_t *out, raw_times_t *times,
             const char **why);

/* The date of a stream that carries no week, from its ephemerides: the latest that is not in the future (`now`), because
 * GPS counts 1024 weeks and begins again. 0 if it has none. */
pel_time_t raw_receiver_date(const input_t *in, pel_time_t now);

#endif

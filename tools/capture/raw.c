#include "raw.h"

#include <stdlib.h>
#include <string.h>

#include "pelorus/wire.h"

/* The bytes pass unchanged whatever the decoder says of them. Refused is what tells of a damaged recording. */
static void tally_counters(tally_t *t, const pel_wire_counters_t *c)
{
    tally_add(t, TALLY_TAKEN, "frames", c->frames);
    tally_add(t, TALLY_LEFT, "bytes outside frames", c->noise_bytes);
    tally_add(t, TALLY_LEFT, "frames of other messages (passed on)", c->unknown);
    tally_add(t, TALLY_LEFT, "signals beyond what the firmware keeps of an epoch", c->overflow);
    tally_add(t, TALLY_NOTE, "epochs or samples given twice", c->duplicate);
    tally_add(t, TALLY_NOTE, "gaps", c->gap);
    tally_add(t, TALLY_REFUSED, "wrong checksum", c->bad_checksum);
    tally_add(t, TALLY_REFUSED, "impossible length", c->bad_length);
    tally_add(t, TALLY_LEFT, "values the firmware will not take: unknown signal or satellite, out of range (passed on)",
              c->bad_value);
    tally_add(t, TALLY_LEFT, "epochs or samples older than one before (passed on)", c->time_back);
}

/* An epoch of the stream: its time, and the byte that completed it. */
typedef struct {
    pel_time_t t_ns;
    size_t end;
} mark_t;

typedef struct {
    mark_t *mark; /* owned */
    size_t n, cap;
} marks_t;

static bool add_mark(marks_t *m, pel_time_t t_ns, size_t end)
{
    if (m->n == m->cap) {
        const size_t cap = (m->cap == 0) ? 1024 : 2 * m->cap;
        mark_t *grown = realloc(m->mark, cap * sizeof *grown);
        if (grown == NULL) { return false; }
        m->mark = grown;
        m->cap = cap;
    }
    m->mark[m->n++] = (mark_t){t_ns, end};
    return true;
}

/* A bit a byte: no frame is open behind it. */
static void set_clean(uint8_t *clean, size_t i)
{
    clean[i / 8] = (uint8_t)(clean[i / 8] | 1u << (i % 8));
}
static bool is_clean(const uint8_t *clean, size_t end)
{
    return end == 0 || (clean[(end - 1) / 8] >> ((end - 1) % 8) & 1u);
}

/* Decode all of it: epochs into marks (navigation solutions if there are no epochs), frame ends into clean. */
static bool find_epochs(const input_t *in, pel_time_t approx, tally_t *tally, marks_t *marks, uint8_t *clean)
{
    pel_receiver_t *rx = malloc(sizeof *rx);
    marks_t pvt = {0};
    bool ok = (rx != NULL);
    if (ok) {
        pel_receiver_init(rx);
        if (approx != 0) { pel_receiver_set_time(rx, approx); }
    }
    for (size_t i = 0; ok && i < in->n; i++) {
        const pel_rx_event_t event = pel_receiver_push(rx, in->bytes[i]);
        if (event == PEL_RX_EPOCH) { ok = add_mark(marks, rx->epoch.t_ns, i + 1); }
        if (event == PEL_RX_PVT && rx->pvt.fix >= 2) { ok = add_mark(&pvt, rx->pvt.t_ns, i + 1); }
        if (rx->fill == 0) { set_clean(clean, i); }
    }
    if (ok) {
        for (pel_rx_event_t event = pel_receiver_flush(rx); event != PEL_RX_NONE; event = pel_receiver_flush(rx)) {
            if (event == PEL_RX_EPOCH) { ok = add_mark(marks, rx->epoch.t_ns, in->n); }
        }
        tally_counters(tally, &rx->counters);
        tally_add(tally, TALLY_TAKEN, "epochs", marks->n);
    }
    if (ok && marks->n == 0 && pvt.n > 0) {
        tally_add(tally, TALLY_NOTE, "no observations: times are those of navigation solutions", 1);
        free(marks->mark);
        *marks = pvt;
        pvt.mark = NULL;
    }
    free(pvt.mark);
    free(rx);
    return ok;
}

/* By how much the tags' clock is ahead: nothing if every epoch arrives after it was measured and some within a second of
 * it; else so much that the promptest arrives with the nominal latency. */
static pel_time_t tag_error(const tagfile_t *tags, const marks_t *marks, pel_time_t latency)
{
    pel_time_t least = INT64_MAX;
    for (size_t i = 0; i < marks->n; i++) {
        const pel_time_t delay = tagfile_arrival(tags, marks->mark[i].end) - marks->mark[i].t_ns;
        if (delay < least) { least = delay; }
    }
    return (least >= 0 && least < PEL_NS_PER_S) ? 0 : least - latency;
}

static bool lay_out(const input_t *in, const marks_t *marks, const uint8_t *clean, pel_time_t latency, timeline_t *out)
{
    size_t from = 0;
    for (size_t i = 0; i < marks->n; i++) {
        const size_t end = marks->mark[i].end;
        if (!timeline_add(out, marks->mark[i].t_ns + latency, in->bytes + from, end - from, is_clean(clean, end))) {
            return false;
        }
        from = end;
    }
    const pel_time_t last = marks->mark[marks->n - 1].t_ns + latency;
    return timeline_add(out, last, in->bytes + from, in->n - from, true);
}

static bool lay_out_tagged(const input_t *in, const tagfile_t *tags, pel_time_t late, const uint8_t *clean,
                           timeline_t *out)
{
    size_t from = 0;
    for (size_t i = 0; i < tags->n && from < in->n; i++) {
        const size_t end = (tags->tag[i].end < in->n) ? tags->tag[i].end : in->n;
        if (!timeline_add(out, tags->tag[i].t_ns - late, in->bytes + from, end - from, is_clean(clean, end))) {
            return false;
        }
        from = end;
    }
    return timeline_add(out, tags->tag[tags->n - 1].t_ns - late, in->bytes + from, in->n - from, true);
}

bool raw_receiver(const input_t *in, pel_time_t approx, pel_time_t latency, const tagfile_t *tags, tally_t *tally,
                  timeline_t *out, raw_times_t *times, const char **why)
{
    marks_t marks = {0};
    uint8_t *clean = calloc(in->n / 8 + 1, 1);
    *times = (raw_times_t){0};
    *why = "out of memory";
    bool ok = clean != NULL && find_epochs(in, approx, tally, &marks, clean);
    if (ok && marks.n == 0) {
        *why = "no epoch in it tells a time";
        ok = false;
    }
    if (ok) {
        times->n = marks.n;
        times->first_ns = marks.mark[0].t_ns;
        times->last_ns = marks.mark[marks.n - 1].t_ns;
        if (tags != NULL && tags->n > 0) {
            times->tag_late_ns = tag_error(tags, &marks, latency);
            if (times->tag_late_ns != 0) {
                tally_add(tally, TALLY_NOTE, "time tags of a clock that was off: moved to the epochs", 1);
            }
            ok = lay_out_tagged(in, tags, times->tag_late_ns, clean, out);
        } else {
            ok = lay_out(in, &marks, clean, latency, out);
        }
    }
    if (in->truncated) { tally_add(tally, TALLY_REFUSED, "gzip stream damaged or cut off", 1); }
    free(marks.mark);
    free(clean);
    return ok;
}

bool raw_imu(const input_t *in, pel_time_t latency, tally_t *tally, timeline_t *out, raw_times_t *times,
             const char **why)
{
    pel_imu_stream_t s;
    size_t from = 0;
    pel_imu_stream_init(&s);
    *times = (raw_times_t){0};
    *why = "out of memory";
    for (size_t i = 0; i < in->n; i++) {
        if (pel_imu_stream_push(&s, in->bytes[i]) != PEL_IMU_SAMPLE) { continue; }
        if (!timeline_add(out, s.imu.t_ns + latency, in->bytes + from, i + 1 - from, s.fill == 0)) { return false; }
        from = i + 1;
        if (times->n == 0) { times->first_ns = s.imu.t_ns; }
        times->last_ns = s.imu.t_ns;
        times->n++;
    }
    tally_counters(tally, &s.counters);
    tally_add(tally, TALLY_TAKEN, "samples", times->n);
    if (in->truncated) { tally_add(tally, TALLY_REFUSED, "gzip stream damaged or cut off", 1); }
    if (times->n == 0) {
        *why = "no IMU sample in it";
        return false;
    }
    return timeline_add(out, times->last_ns + latency, in->bytes + from, in->n - from, true);
}

pel_time_t raw_receiver_date(const input_t *in, pel_time_t now)
{
    pel_receiver_t *rx = malloc(sizeof *rx);
    pel_time_t date = 0;
    if (rx == NULL) { return 0; }
    pel_receiver_init(rx);
    pel_receiver_set_time(rx, now);
    for (size_t i = 0; i < in->n && date == 0; i++) {
        if (pel_receiver_push(rx, in->bytes[i]) == PEL_RX_EPHEMERIS) { date = rx->ephemeris.toe_ns; }
    }
    while (date > now + 7 * 86400 * PEL_NS_PER_S) { date -= 1024 * PEL_NS_PER_WEEK; }
    free(rx);
    return date;
}

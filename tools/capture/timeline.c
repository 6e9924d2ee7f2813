#include "timeline.h"

#include <stdlib.h>
#include <string.h>

void timeline_free(timeline_t *t)
{
    free(t->event);
    free(t->bytes);
    *t = (timeline_t){0};
}

/* Room for `more` items of a size behind *n. */
static bool reserve(void **items, size_t n, size_t *cap, size_t more, size_t size)
{
    if (more <= *cap - n) { return true; }
    size_t grown = (*cap == 0) ? 1024 : *cap;
    while (grown - n < more) { grown *= 2; }
    void *p = realloc(*items, grown * size);
    if (p == NULL) { return false; }
    *items = p;
    *cap = grown;
    return true;
}

static bool add_event(timeline_t *t, pel_time_t t_ns, const uint8_t *data, size_t n, bool frame_ended)
{
    void *events = t->event, *bytes = t->bytes;
    const bool ok = reserve(&events, t->n, &t->cap, 1, sizeof t->event[0]);
    const bool ok_bytes = reserve(&bytes, t->n_bytes, &t->cap_bytes, n, 1);
    t->event = events;
    t->bytes = bytes;
    if (!ok || !ok_bytes || t->event == NULL || t->bytes == NULL) { return false; }
    if (t->n > 0 && t_ns < t->last_ns) { t_ns = t->last_ns; }
    t->last_ns = t_ns;
    memcpy(t->bytes + t->n_bytes, data, n);
    t->event[t->n++] = (timeline_event_t){t_ns, t->n_bytes, (uint32_t)n, frame_ended};
    t->n_bytes += n;
    return true;
}

bool timeline_add(timeline_t *t, pel_time_t t_ns, const uint8_t *data, size_t n, bool frame_ended)
{
    while (n > 0) {
        const size_t part = (n > TIMELINE_CHUNK) ? TIMELINE_CHUNK : n;
        if (!add_event(t, t_ns, data, part, frame_ended && part == n)) { return false; }
        data += part;
        n -= part;
    }
    return true;
}

bool timeline_inject(timeline_t *t, const timeline_t *extra)
{
    timeline_t both = {0};
    size_t k = 0;
    bool between = true, ok = true;
    for (size_t i = 0; ok && i <= t->n; i++) {
        const timeline_event_t *next = (i < t->n) ? &t->event[i] : NULL;
        while (ok && between && k < extra->n && (next == NULL || extra->event[k].t_ns <= next->t_ns)) {
            const timeline_event_t *e = &extra->event[k++];
            ok = add_event(&both, e->t_ns, extra->bytes + e->at, e->n, true);
        }
        if (next == NULL) { break; }
        ok = ok && add_event(&both, next->t_ns, t->bytes + next->at, next->n, next->frame_ended);
        between = next->frame_ended;
    }
    for (; ok && k < extra->n; k++) { /* the line ended inside a frame that will never be complete */
        const timeline_event_t *e = &extra->event[k];
        ok = add_event(&both, e->t_ns, extra->bytes + e->at, e->n, true);
    }
    if (!ok) {
        timeline_free(&both);
        return false;
    }
    timeline_free(t);
    *t = both;
    return true;
}

bool timeline_merge(const timeline_t *line, int n_lines, timeline_sink_t sink, void *user)
{
    size_t at[16] = {0}, total = 0, done = 0;
    if (n_lines > 16) { return false; }
    for (int i = 0; i < n_lines; i++) { total += line[i].n; }
    for (; done < total; done++) {
        int first = -1;
        for (int i = 0; i < n_lines; i++) {
            if (at[i] == line[i].n) { continue; }
            if (first < 0 || line[i].event[at[i]].t_ns < line[first].event[at[first]].t_ns) { first = i; }
        }
        if (first < 0) { break; }
        const timeline_event_t *e = &line[first].event[at[first]++];
        const double fraction = (double)done / (double)total;
        if (!sink(user, first, e->t_ns, line[first].bytes + e->at, e->n, fraction)) { return false; }
    }
    return true;
}

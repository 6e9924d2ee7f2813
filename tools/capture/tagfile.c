#include "tagfile.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define UNIX_S_AT_GPS_START 315964800

static uint32_t u4(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static double f8(const uint8_t *p)
{
    const uint64_t bits = (uint64_t)u4(p) | (uint64_t)u4(p + 4) << 32;
    double v = 0.0;
    memcpy(&v, &bits, sizeof v);
    return v;
}

bool tagfile_parse(const input_t *in, tagfile_t *t)
{
    *t = (tagfile_t){0};
    if (in->n < 84 || memcmp(in->bytes, "TIMETAG RTKLIB", 14) != 0) { return false; }
    const double fraction = f8(in->bytes + 68);
    if (!(fraction >= 0.0 && fraction < 2.0)) { return false; }
    const pel_time_t start =
        ((int64_t)u4(in->bytes + 64) - UNIX_S_AT_GPS_START) * PEL_NS_PER_S + (int64_t)(fraction * 1e9);
    const size_t n = (in->n - 76) / 8;
    t->tag = malloc(n * sizeof t->tag[0]);
    if (t->tag == NULL) { return false; }
    for (size_t i = 0; i < n; i++) {
        const uint8_t *p = in->bytes + 76 + 8 * i;
        const tag_t tag = {start + (int64_t)u4(p) * PEL_NS_PER_MS, u4(p + 4)};
        if (t->n > 0 && (tag.t_ns < t->tag[t->n - 1].t_ns || tag.end < t->tag[t->n - 1].end)) { continue; }
        t->tag[t->n++] = tag;
    }
    return true;
}

bool tagfile_find(const char *log_path, tagfile_t *t)
{
    static const char *const SUFFIX[] = {".tag", ".tag.gz"};
    size_t n = strlen(log_path);
    char path[4096];
    *t = (tagfile_t){0};
    if (n > 3 && strcmp(log_path + n - 3, ".gz") == 0) { n -= 3; }
    if (n + 8 > sizeof path) { return false; }
    for (int i = 0; i < 2; i++) {
        input_t in;
        snprintf(path, sizeof path, "%.*s%s", (int)n, log_path, SUFFIX[i]);
        if (input_load(path, &in) != 0) { continue; }
        const bool ok = tagfile_parse(&in, t);
        input_free(&in);
        if (ok) { return true; }
    }
    return false;
}

void tagfile_free(tagfile_t *t)
{
    free(t->tag);
    *t = (tagfile_t){0};
}

void tagfile_fit_text(tagfile_t *t, const input_t *log)
{
    size_t lines = 0;
    for (size_t i = 0; i < log->n; i++) { lines += (log->bytes[i] == '\n'); }
    if (t->n == 0 || lines == 0) { return; }
    const size_t last = t->tag[t->n - 1].end;
    const size_t with_cr = log->n + lines; /* what is logged after the last tag is less than a buffer */
    if (last <= log->n || last + 256 < with_cr || last > with_cr + 256) { return; }
    size_t at = 0, lost = 0;
    for (size_t i = 0; i < t->n; i++) {
        while (at < log->n && at + lost < t->tag[i].end) { lost += (log->bytes[at++] == '\n'); }
        t->tag[i].end = at;
    }
}

pel_time_t tagfile_arrival(const tagfile_t *t, size_t end)
{
    size_t low = 0, high = t->n - 1; /* the first tag with tag.end >= end */
    while (low < high) {
        const size_t mid = low + (high - low) / 2;
        if (t->tag[mid].end >= end) {
            high = mid;
        } else {
            low = mid + 1;
        }
    }
    return t->tag[low].t_ns;
}

/* capture_log.c - see capture_log.h. */
#include "capture_log.h"

#include <lcm/lcm.h>
#include <stdio.h>
#include <string.h>

#define UNIX_S_AT_GPS_START INT64_C(315964800) /* 1980-01-06 00:00:00 UTC */

int64_t capture_unix_us(pel_time_t t_ns)
{
    const int64_t us = (t_ns >= 0) ? (t_ns / 1000) : -((-t_ns + 999) / 1000);
    return us + (UNIX_S_AT_GPS_START - pel_time_leap_s(t_ns)) * INT64_C(1000000);
}

pel_time_t capture_gps_ns(int64_t unix_us)
{
    const pel_time_t utc = (unix_us - UNIX_S_AT_GPS_START * INT64_C(1000000)) * 1000;
    return utc + (pel_time_t)pel_time_leap_s(utc) * PEL_NS_PER_S;
}

static bool open_log(capture_log_t *c, const char *path, const char *mode)
{
    memset(c, 0, sizeof *c);
    if (strcmp(path, "-") == 0) { path = (mode[0] == 'r') ? "/dev/stdin" : "/dev/stdout"; }
    lcm_eventlog_t *log = lcm_eventlog_create(path, mode);
    if (log == NULL) { return false; }
    (void)setvbuf(log->f, NULL, _IOFBF, 1u << 18);
    c->log = log;
    return true;
}

bool capture_log_create(capture_log_t *c, const char *path)
{
    return open_log(c, path, "w");
}

bool capture_log_open(capture_log_t *c, const char *path)
{
    if (!open_log(c, path, "r")) { return false; }
    FILE *f = ((lcm_eventlog_t *)c->log)->f;
    if (fseeko(f, 0, SEEK_END) == 0) {
        const off_t end = ftello(f);
        c->bytes = (end > 0) ? (int64_t)end : 0;
        rewind(f);
    }
    return true;
}

bool capture_log_write(capture_log_t *c, int64_t t_us, const char *channel, const void *data, size_t n)
{
    /* liblcm's event has no const members and writes through none of them. */
    lcm_eventlog_event_t e = {0};
    e.timestamp = t_us;
    e.channellen = (int32_t)strlen(channel);
    e.datalen = (int32_t)n;
    memcpy(&e.channel, &channel, sizeof channel);
    memcpy(&e.data, &data, sizeof data);
    c->n_events++;
    return lcm_eventlog_write_event(c->log, &e) == 0;
}

bool capture_log_read(capture_log_t *c, capture_event_t *e)
{
    if (c->event != NULL) { lcm_eventlog_free_event(c->event); }
    lcm_eventlog_event_t *next = lcm_eventlog_read_next_event(c->log);
    c->event = next;
    if (next == NULL) { return false; }
    c->n_events++;
    e->t_us = next->timestamp;
    e->channel = next->channel;
    e->data = next->data;
    e->n = (size_t)next->datalen;
    return true;
}

double capture_log_fraction(const capture_log_t *c)
{
    if (c->bytes <= 0 || c->log == NULL) { return 0.0; }
    return (double)ftello(((lcm_eventlog_t *)c->log)->f) / (double)c->bytes;
}

bool capture_log_close(capture_log_t *c)
{
    bool ok = true;
    if (c->event != NULL) { lcm_eventlog_free_event(c->event); }
    if (c->log != NULL) {
        FILE *f = ((lcm_eventlog_t *)c->log)->f;
        ok = (fflush(f) == 0) && (ferror(f) == 0);
        lcm_eventlog_destroy(c->log);
    }
    memset(c, 0, sizeof *c);
    return ok;
}

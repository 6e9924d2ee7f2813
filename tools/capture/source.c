#include "source.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "obs_csv.h"
#include "pelorus/wire.h"
#include "raw.h"
#include "rinex_obs.h"
#include "rinex_signals.h"

#define UNIX_S_AT_GPS_START 315964800
#define STATION_EVERY_NS    (30 * PEL_NS_PER_S)

const char *const FORMAT_NAMES[N_FORMATS] = {"ubx", "rtcm3", "novatel", "rinex", "imu-csv", "pelorus", "obs-csv"};

int source_load(source_t *s)
{
    if (input_load(s->path, &s->in) != 0) { return -1; }
    s->tagged = strcmp(s->path, "-") != 0 && tagfile_find(s->path, &s->tags);
    if (s->tagged && s->format == FORMAT_IMU_CSV) { tagfile_fit_text(&s->tags, &s->in); }
    return 0;
}

void source_free(source_t *s)
{
    input_free(&s->in);
    tagfile_free(&s->tags);
    timeline_free(&s->line);
}

bool source_needs_date(const source_t *s, const source_options_t *o)
{
    imu_layout_t layout;
    obs_csv_t rows;
    tally_t unheard = {0};
    const char *why = NULL;
    if (s->format == FORMAT_RTCM3) { return true; }
    if (s->format == FORMAT_OBS_CSV) {
        return obs_csv_open(&rows, &s->in, 0, &unheard, &why) && !obs_csv_has_date(&rows);
    }
    /* A logger's own clock is tied to the tags, whose error shows in a receiver's stream: that one goes first. */
    return s->format == FORMAT_IMU_CSV && imu_csv_layout(&s->in, &o->imu, &layout, &why) &&
           layout.time != IMU_TIME_GPST;
}

/* An epoch as UBX RXM-RAWX into the line. False: out of memory. */
static bool add_epoch(source_t *s, const pel_epoch_t *e)
{
    uint8_t frame[PEL_RAWX_FRAME_BYTES];
    const size_t n = pel_ubx_encode_rawx(e, pel_time_leap_s(e->t_ns), frame, sizeof frame);
    if (n == 0) {
        tally_add(&s->tally, TALLY_REFUSED, "epochs that do not go into a frame", 1);
        return true;
    }
    if (s->n++ == 0) { s->first_ns = e->t_ns; }
    s->last_ns = e->t_ns;
    return timeline_add(&s->line, e->t_ns + s->latency, frame, n, true);
}

static bool read_rinex(source_t *s, const int8_t glo_k[33], const char **why)
{
    rinex_obs_t *r = malloc(sizeof *r);
    pel_epoch_t *e = malloc(sizeof *e);
    bool ok = (r != NULL && e != NULL);
    if (!ok) { *why = "out of memory"; }
    if (ok) {
        ok = rinex_obs_open(r, &s->in, &s->tally, why);
        if (ok) {
            rinex_obs_set_glo_k(r, glo_k);
            rinex_signals_describe(r, s->codes, sizeof s->codes);
            s->has_station = rinex_header_station(&r->header, s->r_ea_e);
        }
        while (ok && rinex_obs_next(r, e)) {
            *why = "out of memory";
            ok = add_epoch(s, e);
        }
        rinex_obs_close(r);
    }
    free(r);
    free(e);
    if (ok && s->n == 0) {
        *why = "no epoch in it";
        ok = false;
    }
    return ok;
}

static bool read_obs_csv(source_t *s, const source_options_t *o, const char **why)
{
    obs_csv_t rows;
    obs_restore_t *restore = malloc(sizeof *restore);
    pel_epoch_t *e = malloc(sizeof *e);
    bool ok = (restore != NULL && e != NULL), opened = false;
    *why = "out of memory";
    ok = ok && obs_csv_open(&rows, &s->in, o->approx, &s->tally, why);
    while (ok && obs_csv_next(&rows, e)) {
        if (!opened) { obs_restore_open(restore, &o->removed, o->nav, e->t_ns - SOURCE_LEAD_NS, &s->tally); }
        opened = true;
        if (obs_removed_any(&o->removed) && !obs_restore_epoch(restore, e)) { continue; }
        tally_add(&s->tally, TALLY_TAKEN, "epochs", 1);
        tally_add(&s->tally, TALLY_TAKEN, "signals", e->n);
        *why = "out of memory";
        ok = add_epoch(s, e);
    }
    if (opened) { obs_restore_close(restore); }
    free(restore);
    free(e);
    if (ok && s->n == 0) {
        *why = "no epoch in it, or no orbits to put its clocks back";
        ok = false;
    }
    return ok;
}

static bool read_imu_csv(source_t *s, const source_options_t *options, const char **why)
{
    imu_csv_options_t o = options->imu;
    imu_samples_t samples;
    uint8_t frame[PEL_IMU_FRAME_MAX];
    o.ref_ns = options->approx;
    o.tags = s->tagged ? &s->tags : NULL;
    if (!imu_csv_read(&s->in, &o, &samples, &s->tally, why)) { return false; }
    bool ok = true;
    for (size_t i = 0; ok && i < samples.n; i++) {
        const pel_imu_t *m = &samples.imu[i];
        const size_t n = pel_imu_encode(m, frame, sizeof frame);
        if (n == 0) {
            tally_add(&s->tally, TALLY_REFUSED, "samples that do not go into a frame", 1);
            continue;
        }
        *why = "out of memory";
        ok = timeline_add(&s->line, m->t_ns + s->latency, frame, n, true);
        if (s->n++ == 0) { s->first_ns = m->t_ns; }
        s->last_ns = m->t_ns;
    }
    free(samples.imu);
    return ok;
}

bool source_read(source_t *s, const source_options_t *o, const char **why)
{
    pel_time_t approx = o->approx;
    raw_times_t times = {0};
    bool ok = false;
    switch (s->format) {
    case FORMAT_RINEX: return read_rinex(s, o->nav->glo_k, why);
    case FORMAT_IMU_CSV: return read_imu_csv(s, o, why);
    case FORMAT_OBS_CSV: return read_obs_csv(s, o, why);
    case FORMAT_UBX:
    case FORMAT_RTCM3:
        if (s->format == FORMAT_RTCM3 && approx == 0 && s->tagged && s->tags.n > 0) { approx = s->tags.tag[0].t_ns; }
        if (s->format == FORMAT_RTCM3 && approx == 0) {
            const pel_time_t now = ((int64_t)time(NULL) - UNIX_S_AT_GPS_START) * PEL_NS_PER_S;
            approx = raw_receiver_date(&s->in, now);
            if (approx == 0) {
                *why = "nothing tells its date: give --date YYYY-MM-DD";
                return false;
            }
            tally_add(&s->tally, TALLY_NOTE, "date taken from its own ephemerides (latest week that fits)", 1);
        }
        ok = raw_receiver(&s->in, approx, s->latency, s->tagged ? &s->tags : NULL, &s->tally, &s->line, &times, why);
        break;
    case FORMAT_NOVATEL:
    case FORMAT_PELORUS: ok = raw_imu(&s->in, s->latency, &s->tally, &s->line, &times, why); break;
    case N_FORMATS: break;
    }
    s->first_ns = times.first_ns;
    s->last_ns = times.last_ns;
    s->n = times.n;
    s->tag_late_ns = times.tag_late_ns;
    return ok;
}

bool source_add_nav(timeline_t *line, nav_set_t *nav, pel_time_t start, pel_time_t end, tally_t *tally)
{
    timeline_t extra = {0};
    nav_sent_t *sent = NULL;
    uint8_t frame[1100];
    bool ok = true;
    if (nav->klobuchar.valid) {
        const size_t n = pel_ubx_encode_sfrbx_klobuchar(&nav->klobuchar, 1, start, frame, sizeof frame);
        if (n > 0) { ok = timeline_add(&extra, start, frame, n, true); }
        tally_add(tally, (n > 0) ? TALLY_TAKEN : TALLY_LEFT, "ionosphere (Klobuchar)", 1);
    }
    const size_t n_sent = nav_set_schedule(nav, start, end, tally, &sent);
    for (size_t i = 0; ok && i < n_sent; i++) {
        const size_t n = pel_rtcm3_encode_ephemeris(sent[i].eph, frame, sizeof frame);
        if (n == 0) {
            tally_add(tally, TALLY_REFUSED, "ephemerides that do not go into a frame", 1);
            continue;
        }
        ok = timeline_add(&extra, sent[i].t_ns, frame, n, true);
    }
    ok = ok && timeline_inject(line, &extra);
    timeline_free(&extra);
    free(sent);
    return ok;
}

bool source_add_station(timeline_t *line, const double r_ea_e[3], pel_time_t start, pel_time_t end)
{
    timeline_t extra = {0};
    pel_station_t station = {0};
    uint8_t frame[64];
    bool ok = true;
    memcpy(station.r_ea_e, r_ea_e, sizeof station.r_ea_e);
    const size_t n = pel_rtcm3_encode_station(&station, 1006, frame, sizeof frame);
    if (n == 0) { return false; }
    for (pel_time_t t = start; ok && t <= end; t += STATION_EVERY_NS) { ok = timeline_add(&extra, t, frame, n, true); }
    ok = ok && timeline_inject(line, &extra);
    timeline_free(&extra);
    return ok;
}

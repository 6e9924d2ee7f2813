/* pelorus-capture: recorded files to a capture, the same serial bytes with the same arrival times as on a board. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "calendar.h"
#include "common/capture_log.h"
#include "common/cli.h"
#include "source.h"

#define MAX_NAV 32

enum { IMU, ROVER, BASE, N_LINES };
static const char *const CHANNEL[N_LINES] = {CAPTURE_UART_IMU, CAPTURE_UART_ROVER, CAPTURE_UART_BASE};

enum {
    OPT_OUTPUT,
    OPT_IMU,
    OPT_ROVER,
    OPT_BASE,
    OPT_NAV,
    OPT_BASE_ECEF,
    OPT_DATE,
    OPT_SETUP,
    OPT_LATENCY,
    OPT_IMU_COLUMNS,
    OPT_IMU_UNITS,
    OPT_IMU_WEEK,
    OPT_IMU_TIME_OFFSET,
    OPT_OBS_REMOVED,
    N_OPTIONS
};

static const cli_option_t OPTIONS[N_OPTIONS] = {
    [OPT_OUTPUT] = {"output", 'o', "CAPTURE", "where to write, an LCM event log ('-': standard output)"},
    [OPT_IMU] = {"imu", 0, "FILE:FORMAT", "IMU: imu-csv, pelorus, novatel (RAWIMUSX)"},
    [OPT_ROVER] = {"rover", 0, "FILE:FORMAT", "receiver that moves: ubx, rtcm3, rinex, obs-csv"},
    [OPT_BASE] = {"base", 0, "FILE:FORMAT", "receiver that does not: ubx, rtcm3, rinex, obs-csv"},
    [OPT_NAV] = {"nav", 0, "FILE", "RINEX 2 or 3 navigation file, sent to the rover; may be repeated"},
    [OPT_BASE_ECEF] = {"base-ecef", 0, "X,Y,Z", "position of the base, m (default: of its RINEX header)"},
    [OPT_DATE] = {"date", 0, "YYYY-MM-DD",
                  "date within 3 days, for rtcm3 and seconds of week (default: from other streams)"},
    [OPT_SETUP] = {"setup", 0, "FILE.toml", "stored configuration to put into the capture (channel SETUP)"},
    [OPT_LATENCY] = {"latency-ms", 0, "I,R,B", "arrival after validity of imu, rover, base (default 1,50,80)"},
    [OPT_IMU_COLUMNS] = {"imu-columns", 0, "NAMES", "columns of an imu-csv without header, e.g. ax,ay,az,gx,gy,gz,ms"},
    [OPT_IMU_UNITS] = {"imu-units", 0, "A,G",
                       "units of columns without suffix: g, mg, m/s2; deg/s, rad/s, mrad/s, deg/h"},
    [OPT_IMU_WEEK] = {"imu-week", 0, "WEEK", "GPS week of an imu-csv in seconds of week"},
    [OPT_IMU_TIME_OFFSET] = {"imu-time-offset", 0, "S",
                             "added to every time of an imu-csv (GPS seconds at zero of its own clock)"},
    [OPT_OBS_REMOVED] = {"obs-removed", 0, "LIST",
                         "put back into an obs-csv: receiver-clock, satellite-clock, group-delay (needs --nav)"},
};

static const char NOTES[] =
    "Files may be gzip. Raw bytes pass unchanged; those up to an epoch arrive at its time + latency, or as FILE.tag\n"
    "(RTKLIB time tags) beside the file says. RINEX epochs become UBX RXM-RAWX frames, one code per satellite and "
    "carrier:\n"
    "the most complete in the file, at equal completeness GPS L1 C W, L2 W L X, L5 Q X; Galileo C X (E1), Q X (E5);\n"
    "BeiDou I X, B1C/B2a P X; QZSS L1 C X, L2 L X, L5 Q X. Times, codes and what was refused are printed with -v.\n"
    "imu-csv columns: ax ay az (_mps2, _g) gx gy gz (_radps, _dps) and one of gpst_s tow_s t_s ms; docs/CAPTURE.md.\n"
    "obs-csv columns: gpst_s or week tow_s, sat or sys prn, pseudorange_m, range_rate_mps or doppler_hz, cn0_dbhz.";

static const cli_program_t PROGRAM = {"pelorus-capture",
                                      "-o CAPTURE [--imu FILE:FORMAT] [--rover FILE:FORMAT] [--base FILE:FORMAT]",
                                      "Turn recorded raw files into a capture for pelorus-sil.",
                                      OPTIONS,
                                      N_OPTIONS,
                                      NOTES};

typedef struct {
    cli_t cli;
    const char *output, *setup, *nav[MAX_NAV];
    int n_nav;
    source_t source[N_LINES];
    double base_ecef[3];
    bool has_base_ecef;
    pel_time_t date;
    source_options_t options;
} capture_t;

/* ---- command line -------------------------------------------------------------------------------------------------- */

static void take_source(capture_t *c, int line)
{
    static const bool FITS[N_LINES][N_FORMATS] = {
        [IMU] = {[FORMAT_IMU_CSV] = true, [FORMAT_PELORUS] = true, [FORMAT_NOVATEL] = true},
        [ROVER] = {[FORMAT_UBX] = true, [FORMAT_RTCM3] = true, [FORMAT_RINEX] = true, [FORMAT_OBS_CSV] = true},
        [BASE] = {[FORMAT_UBX] = true, [FORMAT_RTCM3] = true, [FORMAT_RINEX] = true, [FORMAT_OBS_CSV] = true},
    };
    static const char *const NAMES[N_LINES] = {"imu", "rover", "base"};
    const char *value = c->cli.value;
    const char *colon = strrchr(value, ':');
    if (c->source[line].path != NULL) { cli_fail(&c->cli, "--%s given twice", NAMES[line]); }
    const size_t n_path = (colon == NULL) ? 0 : (size_t)(colon - value);
    if (n_path == 0) { cli_fail(&c->cli, "--%s %s: wanted FILE:FORMAT", NAMES[line], value); }
    const char *name = value + n_path + 1;
    int format = -1;
    for (int i = 0; i < N_FORMATS; i++) {
        if (strcmp(name, FORMAT_NAMES[i]) == 0) { format = i; }
    }
    if (format < 0) {
        const int near = cli_nearest(name, FORMAT_NAMES, N_FORMATS);
        if (near >= 0) {
            cli_fail(&c->cli, "--%s: no format '%s'; did you mean '%s'?", NAMES[line], name, FORMAT_NAMES[near]);
        }
        cli_fail(&c->cli, "--%s: no format '%s' (ubx, rtcm3, novatel, rinex, imu-csv, pelorus, obs-csv)", NAMES[line],
                 name);
    }
    if (format >= 0 && !FITS[line][format]) {
        cli_fail(&c->cli, "--%s cannot be %s (see --help)", NAMES[line], FORMAT_NAMES[format]);
    }
    c->source[line].path = strndup(value, n_path);
    if (c->source[line].path == NULL) { cli_fail(&c->cli, "out of memory"); }
    c->source[line].format = (format_t)format;
}

/* "a,b,c" of exactly three numbers. */
static void take_three(const capture_t *c, const char *option, double out[3])
{
    const char *p = c->cli.value;
    for (int i = 0; i < 3; i++) {
        char *end = NULL;
        out[i] = strtod(p, &end);
        if (end == p || !isfinite(out[i]) || *end != ((i < 2) ? ',' : '\0')) {
            cli_fail(&c->cli, "--%s %s: wanted three numbers with commas", option, c->cli.value);
        }
        p = end + 1;
    }
}

static void take_option(capture_t *c, int option)
{
    double v[3];
    switch (option) {
    case OPT_OUTPUT: c->output = c->cli.value; break;
    case OPT_IMU: take_source(c, IMU); break;
    case OPT_ROVER: take_source(c, ROVER); break;
    case OPT_BASE: take_source(c, BASE); break;
    case OPT_NAV:
        if (c->n_nav == MAX_NAV) { cli_fail(&c->cli, "more than %d --nav files", MAX_NAV); }
        c->nav[c->n_nav++] = c->cli.value;
        break;
    case OPT_BASE_ECEF:
        take_three(c, "base-ecef", c->base_ecef);
        if (fabs(sqrt(c->base_ecef[0] * c->base_ecef[0] + c->base_ecef[1] * c->base_ecef[1] +
                      c->base_ecef[2] * c->base_ecef[2]) -
                 6.37e6) > 1e5) {
            cli_fail(&c->cli, "--base-ecef %s: not near the ground (ECEF, m)", c->cli.value);
        }
        c->has_base_ecef = true;
        break;
    case OPT_DATE:
        if (!calendar_parse_date(c->cli.value, &c->date)) {
            cli_fail(&c->cli, "--date %s: wanted YYYY-MM-DD", c->cli.value);
        }
        break;
    case OPT_SETUP: c->setup = c->cli.value; break;
    case OPT_LATENCY:
        take_three(c, "latency-ms", v);
        for (int i = 0; i < N_LINES; i++) {
            if (v[i] < 0.0 || v[i] > 10000.0) { cli_fail(&c->cli, "--latency-ms %s: 0 to 10000", c->cli.value); }
            c->source[i].latency = (pel_time_t)(v[i] * 1e6);
        }
        break;
    case OPT_IMU_COLUMNS: c->options.imu.columns = c->cli.value; break;
    case OPT_IMU_UNITS:
        if (!imu_csv_units(c->cli.value, &c->options.imu.accel_unit, &c->options.imu.gyro_unit)) {
            cli_fail(&c->cli, "--imu-units %s: wanted e.g. g,deg/s or m/s2,rad/s", c->cli.value);
        }
        break;
    case OPT_IMU_WEEK: c->options.imu.week = (int)cli_integer(&c->cli, 0, 9999); break;
    case OPT_IMU_TIME_OFFSET: {
        const double s = cli_number(&c->cli, -1e10, 1e10);
        c->options.imu.offset_ns = (pel_time_t)llround(fmod(s, 1.0) * 1e9) + (pel_time_t)trunc(s) * PEL_NS_PER_S;
        c->options.imu.has_offset = true;
        break;
    }
    case OPT_OBS_REMOVED:
        if (!obs_removed_parse(c->cli.value, &c->options.removed)) {
            cli_fail(&c->cli, "--obs-removed %s: some of receiver-clock, satellite-clock, group-delay, with commas",
                     c->cli.value);
        }
        break;
    default: break;
    }
}

static void parse(capture_t *c, int argc, char **argv)
{
    memset(c, 0, sizeof *c);
    c->options.imu.week = -1;
    c->source[IMU].latency = 1 * PEL_NS_PER_MS;
    c->source[ROVER].latency = 50 * PEL_NS_PER_MS;
    c->source[BASE].latency = 80 * PEL_NS_PER_MS;
    c->cli = cli_start(&PROGRAM, argc, argv);
    for (int o = cli_next(&c->cli); o != CLI_END; o = cli_next(&c->cli)) { take_option(c, o); }
    cli_positional(&c->cli, 0, 0, "");
    if (c->output == NULL) { cli_fail(&c->cli, "no output: give -o CAPTURE"); }
    if (c->source[IMU].path == NULL && c->source[ROVER].path == NULL && c->source[BASE].path == NULL) {
        cli_fail(&c->cli, "nothing to capture: give --imu, --rover or --base");
    }
    if (c->n_nav > 0 && c->source[ROVER].path == NULL && c->source[BASE].path == NULL) {
        cli_fail(&c->cli, "--nav needs a --rover or a --base");
    }
    if (obs_removed_any(&c->options.removed) && c->n_nav == 0) {
        cli_fail(&c->cli, "--obs-removed needs the orbits of a --nav");
    }
    if (c->has_base_ecef && c->source[BASE].path == NULL) { cli_fail(&c->cli, "--base-ecef needs a --base"); }
}

/* ---- work ---------------------------------------------------------------------------------------------------------- */

static int unreadable(const char *path, const char *why)
{
    fprintf(stderr, "pelorus-capture: %s: %s\n", path, why);
    return EXIT_UNREADABLE;
}

static int read_nav(capture_t *c, nav_set_t *nav, tally_t *tally)
{
    for (int i = 0; i < c->n_nav; i++) {
        input_t in;
        const char *why = "";
        if (input_load(c->nav[i], &in) != 0) { return unreadable(c->nav[i], strerror(errno)); }
        const bool ok = rinex_nav_read(nav, &in, tally, &why);
        input_free(&in);
        if (!ok) { return unreadable(c->nav[i], why); }
    }
    return EXIT_DONE;
}

/* Streams that know their own time first, then those that need a date from them; the text IMU last, because its tags are
 * judged by the receiver's. */
static int read_sources(capture_t *c, nav_set_t *nav)
{
    static const int ORDER[N_LINES] = {ROVER, BASE, IMU};
    c->options.approx = c->date;
    c->options.nav = nav;
    for (int i = 0; i < N_LINES; i++) {
        source_t *s = &c->source[i];
        if (s->path != NULL && source_load(s) != 0) { return unreadable(s->path, strerror(errno)); }
    }
    for (int round = 0; round < 2; round++) {
        for (int k = 0; k < N_LINES; k++) {
            source_t *s = &c->source[ORDER[k]];
            const char *why = "";
            if (s->path == NULL || source_needs_date(s, &c->options) != (round == 1)) { continue; }
            if (!source_read(s, &c->options, &why)) { return unreadable(s->path, why); }
            if (c->options.approx == 0) { c->options.approx = s->first_ns; }
            if (s->tag_late_ns != 0) { c->options.imu.tag_late_ns = s->tag_late_ns; }
            cli_progress(&c->cli, 0.1 + 0.2 * (double)(k + round));
        }
    }
    return EXIT_DONE;
}

static int add_frames(capture_t *c, nav_set_t *nav, tally_t *tally)
{
    source_t *rover = &c->source[ROVER], *base = &c->source[BASE];
    source_t *to = (rover->path != NULL) ? rover : base;
    const double *station = c->has_base_ecef ? c->base_ecef : base->has_station ? base->r_ea_e : NULL;
    if (nav->n > 0 && !source_add_nav(&to->line, nav, to->first_ns - SOURCE_LEAD_NS, to->last_ns, tally)) {
        return unreadable(c->output, "out of memory");
    }
    if (base->path != NULL && station != NULL &&
        !source_add_station(&base->line, station, base->first_ns - SOURCE_LEAD_NS, base->last_ns)) {
        return unreadable(base->path, "the base position does not go into a frame");
    }
    return EXIT_DONE;
}

typedef struct {
    capture_t *c;
    capture_log_t log;
} writer_t;

static bool write_event(void *user, int line, pel_time_t t, const uint8_t *data, size_t n, double fraction)
{
    writer_t *w = user;
    cli_progress(&w->c->cli, 0.8 + 0.2 * fraction);
    return capture_log_write(&w->log, capture_unix_us(t), CHANNEL[line], data, n);
}

static int write_capture(capture_t *c)
{
    writer_t w = {.c = c};
    timeline_t line[N_LINES];
    pel_time_t start = INT64_MAX;
    input_t setup = {0};
    bool ok = true;
    for (int i = 0; i < N_LINES; i++) {
        line[i] = c->source[i].line;
        if (line[i].n > 0 && line[i].event[0].t_ns < start) { start = line[i].event[0].t_ns; }
    }
    if (c->setup != NULL && input_load(c->setup, &setup) != 0) { return unreadable(c->setup, strerror(errno)); }
    if (!capture_log_create(&w.log, c->output)) {
        input_free(&setup);
        return unreadable(c->output, strerror(errno));
    }
    if (c->setup != NULL) {
        ok = capture_log_write(&w.log, capture_unix_us(start), CAPTURE_SETUP, setup.bytes, setup.n);
    }
    ok = ok && timeline_merge(line, N_LINES, write_event, &w);
    input_free(&setup);
    ok = capture_log_close(&w.log) && ok;
    cli_progress(&c->cli, 1.0);
    return ok ? EXIT_DONE : unreadable(c->output, "could not be written");
}

/* One line a source; causes below it with -v, or where something was refused. */
static uint64_t report(const capture_t *c, const tally_t *nav)
{
    const int verbosity = c->cli.verbosity;
    uint64_t refused = tally_refused(nav);
    for (int i = 0; i < N_LINES; i++) {
        const source_t *s = &c->source[i];
        char from[64], to[64];
        if (s->path == NULL) { continue; }
        refused += tally_refused(&s->tally);
        calendar_print(s->first_ns, from);
        calendar_print(s->last_ns, to);
        if (verbosity >= 0) {
            fprintf(stderr, "%-10s %7llu %s  %s .. %s  %zu bytes in %zu events%s  (%s)\n", CHANNEL[i],
                    (unsigned long long)s->n, (i == IMU) ? "samples" : "epochs ", from, to, s->line.n_bytes, s->line.n,
                    s->tagged ? ", time tags" : "", s->path);
            if (verbosity > 0 && s->codes[0] != '\0') { fprintf(stderr, "  codes    %s\n", s->codes); }
            tally_print(&s->tally, stderr, verbosity > 0);
        }
    }
    if (c->n_nav > 0 && verbosity >= 0) {
        fprintf(stderr, "navigation files\n");
        tally_print(nav, stderr, verbosity > 0);
    }
    if (refused > 0) {
        fprintf(stderr, "pelorus-capture: %llu things refused in the input\n", (unsigned long long)refused);
    }
    return refused;
}

int main(int argc, char **argv)
{
    static capture_t c;
    static tally_t nav_tally;
    nav_set_t nav;
    parse(&c, argc, argv);
    nav_set_init(&nav);
    int code = read_nav(&c, &nav, &nav_tally);
    if (code == EXIT_DONE) { code = read_sources(&c, &nav); }
    if (code == EXIT_DONE) { code = add_frames(&c, &nav, &nav_tally); }
    if (code == EXIT_DONE) { code = write_capture(&c); }
    if (code == EXIT_DONE && report(&c, &nav_tally) > 0) { code = EXIT_REFUSED; }
    nav_set_free(&nav);
    for (int i = 0; i < N_LINES; i++) {
        char *path = NULL;
        memcpy(&path, &c.source[i].path, sizeof path);
        free(path);
        source_free(&c.source[i]);
    }
    return code;
}

/* source.h - one recorded file to one serial line. */
#ifndef PELORUS_TOOLS_CAPTURE_SOURCE_H
#define PELORUS_TOOLS_CAPTURE_SOURCE_H

#include "imu_csv.h"
#include "input.h"
#include "obs_restore.h"
#include "rinex_nav.h"
#include "tagfile.h"
#include "tally.h"
#include "timeline.h"

typedef enum {
    FORMAT_UBX,
    FORMAT_RTCM3,
    FORMAT_NOVATEL,
    FORMAT_RINEX,
    FORMAT_IMU_CSV,
    FORMAT_PELORUS,
    FORMAT_OBS_CSV,
    N_FORMATS
} format_t;

extern const char *const FORMAT_NAMES[N_FORMATS];

typedef struct {
    const char *path; /* NULL: not given */
    format_t format;
    input_t in;
    tagfile_t tags;
    bool tagged;
    pel_time_t latency;
    tally_t tally;
    timeline_t line;
    /* filled by source_read */
    pel_time_t first_ns, last_ns; /* epochs or samples */
    uint64_t n;
    pel_time_t tag_late_ns;
    bool has_station; /* RINEX header */
    double r_ea_e[3];
    char codes[512]; /* RINEX: codes chosen */
} source_t;

/* Orbits and station are sent this long before the first epoch. */
#define SOURCE_LEAD_NS (PEL_NS_PER_S)

/* What else reading a source takes. */
typedef struct {
    pel_time_t approx; /* GPS time within 3 days, 0 if not known */
    nav_set_t *nav;    /* GLONASS channels; orbits for what is put back into text rows (sorted in place) */
    imu_csv_options_t imu;
    obs_removed_t removed; /* from text rows */
} source_options_t;

/* Does it need an approximate date before it can be read? */
bool source_needs_date(const source_t *s, const source_options_t *o);

/* Load the file and the time tags beside it. 0, or -1 with errno. */
int source_load(source_t *s);

/* Fill the line. False: *why. */
bool source_read(source_t *s, const source_options_t *o, const char **why);

/* Ephemerides and ionosphere as frames, from just before `start` on; and a station every 30 s. */
bool source_add_nav(timeline_t *line, nav_set_t *nav, pel_time_t start, pel_time_t end, tally_t *tally);
bool source_add_station(timeline_t *line, const double r_ea_e[3], pel_time_t start, pel_time_t end);

void source_free(source_t *s);

#endif

/* obs_csv.h - text recordings of code and Doppler, one row a satellite, to receiver epochs.
 *
 * Columns are separated by comma, semicolon, blank or tab and named by a header line:
 *   gpst_s            GPS seconds since 1980-01-06, or
 *   week, tow_s       GPS week (whole, not truncated) and its seconds; without `week` the one nearest to a reference
 *   sat               "G12"; or sys (the letter) and prn (as in RINEX 3: J01 is 1)
 *   pseudorange_m     code
 *   range_rate_mps    growing with distance; or doppler_hz, positive when approaching: may be missing
 *   cn0_dbhz          may be missing
 * Other names are ignored. A row belongs to the first civil signal of its system: GPS, Galileo, QZSS 1575.42 MHz, BeiDou B1I; GLONASS
 * and SBAS are left out. Rows of one epoch follow one another and have one time. */
#ifndef PELORUS_TOOLS_CAPTURE_OBS_CSV_H
#define PELORUS_TOOLS_CAPTURE_OBS_CSV_H

#include "input.h"
#include "pelorus/base.h"
#include "tally.h"

typedef enum {
    OBS_GPST,
    OBS_WEEK,
    OBS_TOW,
    OBS_SAT,
    OBS_SYS,
    OBS_PRN,
    OBS_RANGE,
    OBS_RATE,
    OBS_DOPPLER,
    OBS_CN0,
    N_OBS_COLUMNS
} obs_column_t;

typedef struct {
    pel_time_t t_ns;
    pel_obs_t obs;
} obs_row_t;

typedef struct {
    int column[N_OBS_COLUMNS]; /* -1 where missing */
    int n_columns;             /* a row has at least so many */
    lines_t lines;             /* what is still to be read */
    pel_time_t ref_ns;         /* for tow_s without week */
    pel_time_t last_ns;        /* of the last epoch */
    obs_row_t row;             /* the first of the next epoch */
    bool have_row;
    tally_t *tally;
} obs_csv_t;

/* Read the header. ref_ns: GPS time within 3 days, 0 if not known. False: *why says what is missing (a literal). The input must outlive *o. */
bool obs_csv_open(obs_csv_t *o, const input_t *in, pel_time_t ref_ns, tally_t *tally, const char **why);

/* Next epoch with at least one satellite, its tag as the rows give it. False at the end. Damaged rows are counted and skipped. */
bool obs_csv_next(obs_csv_t *o, pel_epoch_t *e);

/* Do its rows tell the week? */
bool obs_csv_has_date(const obs_csv_t *o);

#endif

/* imu_csv.h - text recordings of an IMU (rates, not increments) to increments with exact GPS time.
 *
 * Columns are separated by comma, semicolon, blank or tab. They are named by a header line or by a list in the same words:
 *   ax ay az   specific force    _mps2 or _g            (without unit: the units given, else m/s^2)
 *   gx gy gz   angular rate      _radps or _dps         (                          else rad/s)
 *   gpst_s     GPS seconds since 1980-01-06;  tow_s  seconds of week;  t_s  seconds of some clock;  ms  milliseconds of some clock
 * Other names are ignored. Known without either: seven columns "ax,ay,az,gx,gy,gz,ms" in g and deg/s, ms whole numbers.
 *
 * Increment k is the trapezoid between samples k-1 and k: half the sum of their rates times their distance in time, valid at
 * sample k. Across a gap (over 2.5 times the median distance) it is sample k's rate over one median distance, the
 * sequence counter jumps by what is missing, and the gap is counted. */
#ifndef PELORUS_TOOLS_CAPTURE_IMU_CSV_H
#define PELORUS_TOOLS_CAPTURE_IMU_CSV_H

#include "input.h"
#include "pelorus/base.h"
#include "tagfile.h"
#include "tally.h"

typedef enum { IMU_TIME_NONE, IMU_TIME_GPST, IMU_TIME_TOW, IMU_TIME_OWN } imu_time_t;

typedef struct {
    int column[7];  /* of time, ax, ay, az, gx, gy, gz; -1 where missing */
    double unit[7]; /* ns, m/s^2, rad/s of one */
    int n_columns;  /* a line has at least so many */
    imu_time_t time;
} imu_layout_t;

typedef struct {
    const char *columns;  /* list of names, or NULL */
    double accel_unit;    /* m/s^2, 0: 1 */
    double gyro_unit;     /* rad/s, 0: 1 */
    int week;             /* for tow_s; < 0: the one nearest to ref_ns */
    pel_time_t ref_ns;    /* 0: not known */
    pel_time_t offset_ns; /* added to every time */
    bool has_offset;
    const tagfile_t *tags;  /* of this file, or NULL */
    pel_time_t tag_late_ns; /* subtracted from the tags' times */
} imu_csv_options_t;

typedef struct {
    pel_imu_t *imu; /* owned */
    size_t n;
} imu_samples_t;

/* The layout by header, list or look. False: *why says what is missing (a literal). */
bool imu_csv_layout(const input_t *in, const imu_csv_options_t *o, imu_layout_t *layout, const char **why);

/* Read all samples. False with *why; counts go into *tally. */
bool imu_csv_read(const input_t *in, const imu_csv_options_t *o, imu_samples_t *out, tally_t *tally, const char **why);

/* "g,deg/s", "m/s2,rad/s", ... -> units in SI. False if not understood. */
bool imu_csv_units(const char *text, double *accel, double *gyro);

#endif

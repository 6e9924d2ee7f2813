#include "imu_csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fields.h"

#define G0  9.80665 /* m/s^2, standard gravity: the unit "g" */
#define DEG 0.017453292519943295

/* ---- layout -------------------------------------------------------------------------------------------------------- */

bool imu_csv_units(const char *text, double *accel, double *gyro)
{
    static const struct {
        const char *name;
        double unit;
    } A[] = {{"g", G0}, {"mg", 1e-3 * G0}, {"m/s2", 1.0}, {"m/s^2", 1.0}},
      G[] = {{"deg/s", DEG}, {"rad/s", 1.0}, {"mrad/s", 1e-3}, {"deg/h", DEG / 3600.0}};
    const char *comma = strchr(text, ',');
    *accel = *gyro = 0.0;
    if (comma == NULL) { return false; }
    const size_t n = (size_t)(comma - text);
    for (size_t i = 0; i < 4; i++) {
        if (strlen(A[i].name) == n && strncmp(A[i].name, text, n) == 0) { *accel = A[i].unit; }
        if (strcmp(G[i].name, comma + 1) == 0) { *gyro = G[i].unit; }
    }
    return *accel > 0.0 && *gyro > 0.0;
}

/* One column's name; false if it is none of ours. */
static void name_column(imu_layout_t *l, int column, line_t f, const imu_csv_options_t *o)
{
    const int axis = (f.n >= 2) ? f.s[1] - 'x' : -1;
    const double accel = (o->accel_unit > 0.0) ? o->accel_unit : 1.0, gyro = (o->gyro_unit > 0.0) ? o->gyro_unit : 1.0;
    int k = -1;
    double unit = 1.0;
    if (field_named(f, "gpst_s") || field_named(f, "gpst")) {
        k = 0;
        l->time = IMU_TIME_GPST;
    } else if (field_named(f, "tow_s") || field_named(f, "tow")) {
        k = 0;
        l->time = IMU_TIME_TOW;
    } else if (field_named(f, "t_s") || field_named(f, "t") || field_named(f, "ms")) {
        k = 0;
        l->time = IMU_TIME_OWN;
        unit = field_named(f, "ms") ? 1e6 : 1.0;
    } else if (axis >= 0 && axis < 3 && (f.s[0] == 'a' || f.s[0] == 'g')) {
        const bool is_accel = (f.s[0] == 'a');
        k = (is_accel ? 1 : 4) + axis;
        if (f.n == 2) {
            unit = is_accel ? accel : gyro;
        } else if (is_accel && field_ends(f, "_g")) {
            unit = G0;
        } else if (is_accel && field_ends(f, "_mps2")) {
            unit = 1.0;
        } else if (!is_accel && field_ends(f, "_radps")) {
            unit = 1.0;
        } else if (!is_accel && field_ends(f, "_dps")) {
            unit = DEG;
        } else {
            k = -1;
        }
    }
    if (k >= 0) {
        l->column[k] = column;
        l->unit[k] = unit;
    }
}

static bool name_columns(imu_layout_t *l, line_t names, const imu_csv_options_t *o, const char **why)
{
    fields_t f;
    fields_split(names, &f);
    for (int i = 0; i < 7; i++) { l->column[i] = -1; }
    for (int i = 0; i < f.n; i++) { name_column(l, i, f.f[i], o); }
    l->n_columns = f.n;
    for (int i = 0; i < 7; i++) {
        if (l->column[i] < 0) {
            *why = (i == 0) ? "no column of time: name one gpst_s, tow_s, t_s or ms"
                            : "an axis is missing: columns ax, ay, az, gx, gy, gz are needed";
            return false;
        }
    }
    return true;
}

/* Seven numbers a line, the last whole and increasing: what a microcontroller prints with its millisecond counter. */
static bool looks_like_logger(const input_t *in)
{
    lines_t lines = lines_of(in);
    line_t l;
    double before = -1.0;
    int good = 0;
    if (!lines_next(&lines, &l)) { return false; } /* the first line may be cut off */
    for (int i = 0; i < 20 && lines_next(&lines, &l); i++) {
        fields_t f;
        double v = 0.0;
        if (lines.at == lines.end && good >= 2) { break; } /* the last may be, too */
        fields_split(l, &f);
        if (f.n != 7 || !field_number(f.f[6], &v) || floor(v) != v || v < before) { return false; }
        before = v;
        good++;
    }
    return good >= 2;
}

bool imu_csv_layout(const input_t *in, const imu_csv_options_t *o, imu_layout_t *layout, const char **why)
{
    lines_t lines = lines_of(in);
    line_t first;
    fields_t f;
    memset(layout, 0, sizeof *layout);
    if (!lines_next(&lines, &first)) {
        *why = "empty file";
        return false;
    }
    if (o->columns != NULL) { return name_columns(layout, (line_t){o->columns, strlen(o->columns)}, o, why); }
    fields_split(first, &f);
    if (fields_are_names(&f)) { return name_columns(layout, first, o, why); }
    if (looks_like_logger(in)) {
        imu_csv_options_t units = *o;
        if (units.accel_unit <= 0.0) { units.accel_unit = G0; }
        if (units.gyro_unit <= 0.0) { units.gyro_unit = DEG; }
        static const char NAMES[] = "ax,ay,az,gx,gy,gz,ms";
        return name_columns(layout, (line_t){NAMES, strlen(NAMES)}, &units, why);
    }
    *why = "no header line: name the columns with --imu-columns";
    return false;
}

/* ---- samples ------------------------------------------------------------------------------------------------------- */

typedef struct {
    pel_time_t t_ns; /* on the file's clock */
    size_t end;      /* of its line */
    double f[3], w[3];
} rates_t;

static bool parse_rates(line_t l, const imu_layout_t *layout, rates_t *r)
{
    fields_t f;
    double v[7];
    fields_split(l, &f);
    if (f.n < layout->n_columns) { return false; }
    if (!field_time_ns(f.f[layout->column[0]], layout->unit[0] != 1.0, &r->t_ns)) { return false; }
    for (int i = 1; i < 7; i++) {
        if (!field_number(f.f[layout->column[i]], &v[i])) { return false; }
        v[i] *= layout->unit[i];
    }
    for (int i = 0; i < 3; i++) {
        r->f[i] = v[1 + i];
        r->w[i] = v[4 + i];
        if (fabs(r->f[i]) > 2000.0 || fabs(r->w[i]) > 200.0) { return false; } /* 200 g, 11 000 deg/s */
    }
    return true;
}

static size_t read_rates(const input_t *in, const imu_layout_t *layout, rates_t *r, tally_t *tally)
{
    lines_t lines = lines_of(in);
    line_t l;
    size_t n = 0, number_of_line = 0;
    pel_time_t before = INT64_MIN;
    while (lines_next(&lines, &l)) {
        number_of_line++;
        r[n].end = (size_t)(lines.at - (const char *)in->bytes);
        if (line_blank(l, 0, l.n)) { continue; }
        if (!parse_rates(l, layout, &r[n])) {
            if (number_of_line == 1) {
                tally_add(tally, TALLY_LEFT, "first line: header, or cut off", 1);
            } else if (lines.at == lines.end && in->bytes[in->n - 1] != '\n') {
                tally_add(tally, TALLY_LEFT, "last line cut off", 1);
            } else {
                tally_add(tally, TALLY_REFUSED, "line that is not a sample", 1);
            }
            continue;
        }
        if (r[n].t_ns <= before) {
            tally_add(tally, TALLY_REFUSED, "sample not later than the one before", 1);
            continue;
        }
        before = r[n++].t_ns;
    }
    return n;
}

static int compare_i64(const void *a, const void *b)
{
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* Logger clock to GPS time by arrival tags. The clocks differ by a rate and an offset: the rate is the regression's, the offset
 * that of the promptest arrivals (5th of a hundred), because a sample can arrive late but not early. */
static bool clock_of_tags(const rates_t *r, size_t n, const tagfile_t *tags, pel_time_t late, double *rate,
                          pel_time_t *offset)
{
    int64_t *rest = malloc(n * sizeof *rest);
    if (rest == NULL) { return false; }
    double st = 0.0, sd = 0.0, stt = 0.0, std = 0.0;
    const pel_time_t t0 = r[0].t_ns, d0 = tagfile_arrival(tags, r[0].end) - r[0].t_ns;
    for (size_t i = 0; i < n; i++) {
        const double t = 1e-9 * (double)(r[i].t_ns - t0);
        const double d = 1e-9 * (double)(tagfile_arrival(tags, r[i].end) - r[i].t_ns - d0);
        st += t;
        sd += d;
        stt += t * t;
        std += t * d;
    }
    const double m = (double)n, det = m * stt - st * st;
    *rate = (det > 0.0 && n > 100) ? (m * std - st * sd) / det : 0.0;
    if (fabs(*rate) > 1e-3) { *rate = 0.0; } /* no clock is that bad: the tags are */
    for (size_t i = 0; i < n; i++) {
        const pel_time_t drift = (pel_time_t)(*rate * (double)(r[i].t_ns - t0));
        rest[i] = tagfile_arrival(tags, r[i].end) - r[i].t_ns - drift;
    }
    qsort(rest, n, sizeof rest[0], compare_i64);
    *offset = rest[n / 20] - late;
    free(rest);
    return true;
}

static bool to_gps_time(rates_t *r, size_t n, const imu_layout_t *layout, const imu_csv_options_t *o, const char **why)
{
    const pel_time_t t0 = r[0].t_ns;
    pel_time_t offset = o->offset_ns, tag_offset = 0;
    double rate = 0.0;
    if (layout->time == IMU_TIME_TOW) {
        if (o->week < 0 && o->ref_ns == 0) {
            *why = "seconds of week, and no week: give --imu-week or --date";
            return false;
        }
        const int32_t week =
            (o->week >= 0) ? o->week : pel_time_week(pel_time_from_tow_near(1e-9 * (double)t0, o->ref_ns));
        offset += (int64_t)week * PEL_NS_PER_WEEK;
    }
    if (layout->time == IMU_TIME_OWN) {
        if (o->tags != NULL) {
            if (!clock_of_tags(r, n, o->tags, o->tag_late_ns, &rate, &tag_offset)) {
                *why = "out of memory";
                return false;
            }
            offset += tag_offset;
        } else if (!o->has_offset) {
            *why = "times of a clock of its own, and no .tag file: give --imu-time-offset (GPS seconds at its zero)";
            return false;
        }
    }
    for (size_t i = 0; i < n; i++) { r[i].t_ns += offset + (pel_time_t)llround(rate * (double)(r[i].t_ns - t0)); }
    return true;
}

static void to_increments(const rates_t *r, size_t n, imu_samples_t *out, int64_t *steps, tally_t *tally)
{
    for (size_t i = 1; i < n; i++) { steps[i - 1] = r[i].t_ns - r[i - 1].t_ns; }
    qsort(steps, n - 1, sizeof steps[0], compare_i64);
    const int64_t nominal = steps[(n - 1) / 2];
    uint16_t seq = 0;
    for (size_t i = 1; i < n; i++) {
        pel_imu_t *m = &out->imu[out->n++];
        const int64_t step = r[i].t_ns - r[i - 1].t_ns;
        const bool gap = (double)step > 2.5 * (double)nominal;
        memset(m, 0, sizeof *m);
        if (gap) {
            tally_add(tally, TALLY_NOTE, "gaps", 1);
            seq = (uint16_t)(seq + (step / nominal - 1) % 65535);
        }
        m->t_ns = r[i].t_ns;
        m->seq = seq++;
        m->dt_s = 1e-9 * (double)(gap ? nominal : step);
        for (int k = 0; k < 3; k++) {
            m->alpha_ib_b[k] = m->dt_s * (gap ? r[i].w[k] : 0.5 * (r[i].w[k] + r[i - 1].w[k]));
            m->upsilon_ib_b[k] = m->dt_s * (gap ? r[i].f[k] : 0.5 * (r[i].f[k] + r[i - 1].f[k]));
        }
    }
    tally_add(tally, TALLY_TAKEN, "samples", out->n);
}

bool imu_csv_read(const input_t *in, const imu_csv_options_t *o, imu_samples_t *out, tally_t *tally, const char **why)
{
    imu_layout_t layout;
    size_t lines = 2;
    *out = (imu_samples_t){0};
    if (!imu_csv_layout(in, o, &layout, why)) { return false; }
    for (size_t i = 0; i < in->n; i++) { lines += (in->bytes[i] == '\n'); }
    rates_t *r = malloc(lines * sizeof *r);
    int64_t *steps = malloc(lines * sizeof *steps);
    out->imu = malloc(lines * sizeof *out->imu);
    bool ok = (r != NULL && steps != NULL && out->imu != NULL);
    *why = "out of memory";
    if (ok) {
        const size_t n = read_rates(in, &layout, r, tally);
        *why = "fewer than two samples";
        ok = n >= 2 && to_gps_time(r, n, &layout, o, why);
        if (ok) { to_increments(r, n, out, steps, tally); }
    }
    if (in->truncated) { tally_add(tally, TALLY_REFUSED, "gzip stream damaged or cut off", 1); }
    free(r);
    free(steps);
    if (!ok) {
        free(out->imu);
        *out = (imu_samples_t){0};
    }
    return ok;
}

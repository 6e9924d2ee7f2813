#include "obs_csv.h"

#include <math.h>
#include <string.h>

#include "fields.h"
#include "rinex_header.h"

#define NEAREST_M  1.0e7 /* a receiver's clock may be milliseconds off */
#define FARTHEST_M 6.0e7

/* ---- header -------------------------------------------------------------------------------------------------------- */

static bool has(const obs_csv_t *o, obs_column_t c)
{
    return o->column[c] >= 0;
}

static void name_columns(obs_csv_t *o, const fields_t *f)
{
    static const char *const NAME[N_OBS_COLUMNS] = {[OBS_GPST] = "gpst_s",
                                                    [OBS_WEEK] = "week",
                                                    [OBS_TOW] = "tow_s",
                                                    [OBS_SAT] = "sat",
                                                    [OBS_SYS] = "sys",
                                                    [OBS_PRN] = "prn",
                                                    [OBS_RANGE] = "pseudorange_m",
                                                    [OBS_RATE] = "range_rate_mps",
                                                    [OBS_DOPPLER] = "doppler_hz",
                                                    [OBS_CN0] = "cn0_dbhz"};
    for (int c = 0; c < N_OBS_COLUMNS; c++) {
        o->column[c] = -1;
        for (int i = 0; i < f->n; i++) {
            if (field_named(f->f[i], NAME[c])) { o->column[c] = i; }
        }
        if (o->column[c] >= o->n_columns) { o->n_columns = o->column[c] + 1; }
    }
}

bool obs_csv_has_date(const obs_csv_t *o)
{
    return has(o, OBS_GPST) || has(o, OBS_WEEK);
}

bool obs_csv_open(obs_csv_t *o, const input_t *in, pel_time_t ref_ns, tally_t *tally, const char **why)
{
    line_t first;
    fields_t f;
    memset(o, 0, sizeof *o);
    o->lines = lines_of(in);
    o->ref_ns = ref_ns;
    o->tally = tally;
    *why = "no header line: columns gpst_s (or week, tow_s), sat (or sys, prn), pseudorange_m are needed";
    if (!lines_next(&o->lines, &first)) { return false; }
    fields_split(first, &f);
    if (!fields_are_names(&f)) { return false; }
    name_columns(o, &f);
    if (!has(o, OBS_GPST) && !has(o, OBS_TOW)) {
        *why = "no column of time: name one gpst_s, or two week and tow_s";
        return false;
    }
    if (!has(o, OBS_SAT) && !(has(o, OBS_SYS) && has(o, OBS_PRN))) {
        *why = "no column of satellites: name one sat, or two sys and prn";
        return false;
    }
    if (!has(o, OBS_RANGE)) {
        *why = "no column pseudorange_m";
        return false;
    }
    if (in->truncated) { tally_add(tally, TALLY_REFUSED, "gzip stream damaged or cut off", 1); }
    return true;
}

/* ---- rows ---------------------------------------------------------------------------------------------------------- */

static bool number_of(const obs_csv_t *o, const fields_t *f, obs_column_t c, double *v)
{
    return has(o, c) && field_number(f->f[o->column[c]], v);
}

static bool time_of(const obs_csv_t *o, const fields_t *f, pel_time_t *t)
{
    if (has(o, OBS_GPST)) { return field_time_ns(f->f[o->column[OBS_GPST]], false, t) && *t > 0; }
    double week = 0.0;
    int64_t tow_ns = 0;
    if (!field_time_ns(f->f[o->column[OBS_TOW]], false, &tow_ns)) { return false; }
    if (tow_ns < 0 || tow_ns >= PEL_NS_PER_WEEK) { return false; }
    if (has(o, OBS_WEEK)) {
        if (!number_of(o, f, OBS_WEEK, &week) || week != floor(week)) { return false; }
    } else {
        week = (double)pel_time_week(pel_time_from_tow_near(1e-9 * (double)tow_ns, o->ref_ns));
    }
    if (!(week >= 1.0 && week < 9999.0)) { return false; }
    *t = (int64_t)week * PEL_NS_PER_WEEK + tow_ns;
    return true;
}

/* "G12", or "G" and "12" in columns of their own. */
static bool satellite_of(const obs_csv_t *o, const fields_t *f, pel_obs_t *obs)
{
    char name[4] = {0};
    double prn = 0.0;
    if (has(o, OBS_SAT)) {
        const line_t s = f->f[o->column[OBS_SAT]];
        return s.n == 3 && rinex_satellite(s, 0, &obs->sys, &obs->prn);
    }
    const line_t sys = f->f[o->column[OBS_SYS]];
    if (sys.n != 1 || !number_of(o, f, OBS_PRN, &prn) || !(prn >= 1.0 && prn <= 99.0) || prn != floor(prn)) {
        return false;
    }
    name[0] = sys.s[0];
    name[1] = (char)('0' + (int)prn / 10);
    name[2] = (char)('0' + (int)prn % 10);
    return rinex_satellite((line_t){name, 3}, 0, &obs->sys, &obs->prn);
}

static void observation_of(const obs_csv_t *o, const fields_t *f, pel_obs_t *obs)
{
    double v = 0.0;
    obs->carrier = (uint8_t)((obs->sys == PEL_SYS_BDS) ? PEL_CARRIER_B1I : PEL_CARRIER_L1);
    obs->code = (obs->sys == PEL_SYS_BDS) ? 'I' : 'C';
    const double lambda_m = PEL_SPEED_OF_LIGHT / pel_carrier_hz((pel_sys_t)obs->sys, (pel_carrier_t)obs->carrier, 0);
    if (number_of(o, f, OBS_RANGE, &v) && v > NEAREST_M && v < FARTHEST_M) {
        obs->P_m = v;
        obs->flags |= PEL_OBS_CODE;
    }
    const bool is_rate = number_of(o, f, OBS_RATE, &v);
    if (is_rate || number_of(o, f, OBS_DOPPLER, &v)) {
        obs->D_hz = (float)(is_rate ? -v / lambda_m : v);
        obs->flags |= PEL_OBS_DOPPLER;
    }
    if (number_of(o, f, OBS_CN0, &v) && v > 0.0 && v < 99.0) { obs->cn0_dbhz = (float)v; }
}

/* One row; false at the end. Rows that hold nothing for us are counted by cause and stepped over. */
static bool next_row(obs_csv_t *o, obs_row_t *r)
{
    line_t l;
    fields_t f;
    while (lines_next(&o->lines, &l)) {
        memset(r, 0, sizeof *r);
        if (line_blank(l, 0, l.n)) { continue; }
        fields_split(l, &f);
        if (f.n < o->n_columns) {
            tally_add(o->tally, TALLY_REFUSED, "row with too few fields", 1);
        } else if (!satellite_of(o, &f, &r->obs)) {
            tally_add(o->tally, TALLY_LEFT, "rows without a satellite known here", 1);
        } else if (!time_of(o, &f, &r->t_ns)) {
            tally_add(o->tally, TALLY_REFUSED, "row without a time", 1);
        } else if (r->obs.sys == PEL_SYS_GLO || r->obs.sys == PEL_SYS_SBS) {
            tally_add(o->tally, TALLY_LEFT, "GLONASS and SBAS", 1);
        } else {
            observation_of(o, &f, &r->obs);
            if ((r->obs.flags & PEL_OBS_CODE) != 0) { return true; }
            tally_add(o->tally, TALLY_LEFT, "rows without a possible pseudorange", 1);
        }
    }
    return false;
}

static bool is_there(const pel_epoch_t *e, const pel_obs_t *obs)
{
    for (int i = 0; i < e->n; i++) {
        if (e->obs[i].sys == obs->sys && e->obs[i].prn == obs->prn) { return true; }
    }
    return false;
}

static void add(obs_csv_t *o, pel_epoch_t *e, const pel_obs_t *obs)
{
    if (is_there(e, obs)) {
        tally_add(o->tally, TALLY_REFUSED, "satellite twice in an epoch", 1);
    } else if (e->n == PEL_MAX_OBS) {
        e->dropped++;
        tally_add(o->tally, TALLY_LEFT, "signals beyond what the firmware keeps of an epoch", 1);
    } else {
        e->obs[e->n++] = *obs;
    }
}

bool obs_csv_next(obs_csv_t *o, pel_epoch_t *e)
{
    memset(e, 0, sizeof *e);
    while (o->have_row || next_row(o, &o->row)) {
        o->have_row = e->n > 0 && o->row.t_ns != e->t_ns;
        if (o->have_row) { break; }
        if (e->n == 0 && o->row.t_ns <= o->last_ns) {
            tally_add(o->tally, TALLY_REFUSED, "row not later than the epoch before", 1);
            continue;
        }
        e->t_ns = o->row.t_ns;
        add(o, e, &o->row.obs);
    }
    if (e->n == 0) { return false; }
    o->last_ns = e->t_ns;
    return true;
}

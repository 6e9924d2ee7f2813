#include "rinex_obs.h"

#include <stdlib.h>
#include <string.h>

#include "rinex_signals.h"

/* ---- epoch lines --------------------------------------------------------------------------------------------------- */

typedef struct {
    pel_time_t t_ns;
    bool has_time;
    int flag;
    int n; /* satellites, or special records */
} epoch_line_t;

static bool parse_epoch_v2(const rinex_header_t *h, line_t l, epoch_line_t *e)
{
    int y = 0, mo = 0, d = 0, hh = 0, mi = 0;
    int64_t ns = 0;
    /* Blanks where the format has them tell an epoch line from a line of numbers. */
    if (line_char(l, 0) != ' ' || line_char(l, 3) != ' ' || line_char(l, 6) != ' ' || line_char(l, 9) != ' ' ||
        line_char(l, 12) != ' ' || !line_blank(l, 26, 2)) {
        return false;
    }
    if (line_int(l, 28, 1, &e->flag) == FIELD_BAD || line_int(l, 29, 3, &e->n) != FIELD_OK) { return false; }
    if (line_blank(l, 28, 1)) { e->flag = 0; }
    if (e->flag < 0 || e->flag > 6 || e->n < 0) { return false; }
    e->has_time = line_int(l, 1, 2, &y) == FIELD_OK && line_int(l, 4, 2, &mo) == FIELD_OK &&
                  line_int(l, 7, 2, &d) == FIELD_OK && line_int(l, 10, 2, &hh) == FIELD_OK &&
                  line_int(l, 13, 2, &mi) == FIELD_OK && line_seconds_ns(l, 15, 11, &ns) == FIELD_OK &&
                  calendar_to_gps((y < 80) ? 2000 + y : 1900 + y, mo, d, hh, mi, ns, h->time_system, &e->t_ns);
    return e->has_time || (e->flag >= 2 && line_blank(l, 0, 26));
}

static bool parse_epoch_v3(const rinex_header_t *h, line_t l, epoch_line_t *e)
{
    int y = 0, mo = 0, d = 0, hh = 0, mi = 0;
    int64_t ns = 0;
    if (line_char(l, 0) != '>') { return false; }
    if (line_int(l, 31, 1, &e->flag) != FIELD_OK || line_int(l, 32, 3, &e->n) != FIELD_OK) { return false; }
    if (e->flag < 0 || e->flag > 6 || e->n < 0) { return false; }
    e->has_time = line_int(l, 2, 4, &y) == FIELD_OK && line_int(l, 7, 2, &mo) == FIELD_OK &&
                  line_int(l, 10, 2, &d) == FIELD_OK && line_int(l, 13, 2, &hh) == FIELD_OK &&
                  line_int(l, 16, 2, &mi) == FIELD_OK && line_seconds_ns(l, 18, 11, &ns) == FIELD_OK &&
                  calendar_to_gps(y, mo, d, hh, mi, ns, h->time_system, &e->t_ns);
    return e->has_time || (e->flag >= 2 && line_blank(l, 1, 28));
}

static bool parse_epoch(const rinex_header_t *h, line_t l, epoch_line_t *e)
{
    return (h->version_100 < 300) ? parse_epoch_v2(h, l, e) : parse_epoch_v3(h, l, e);
}

/* ---- epochs -------------------------------------------------------------------------------------------------------- */

/* What goes first when an epoch has more signals than the firmware keeps: systems with orbits here before the others,
 * then a first, second, third carrier of each satellite. */
static int rank(const pel_obs_t *o)
{
    static const int CARRIER[PEL_N_CARRIER] = {0, 1, 2, 2, 4, 0, 1};
    const int sys = (o->sys == PEL_SYS_GLO || o->sys == PEL_SYS_SBS) ? 10 : 0;
    const int e5a_before_e5b = (o->sys == PEL_SYS_GAL && o->carrier == PEL_CARRIER_E5B) ? 1 : 0;
    return sys + CARRIER[o->carrier] + e5a_before_e5b;
}

static int compare_rank(const void *a, const void *b)
{
    const pel_obs_t *x = a, *y = b;
    if (rank(x) != rank(y)) { return rank(x) - rank(y); }
    if (x->sys != y->sys) { return (int)x->sys - (int)y->sys; }
    return (int)x->prn - (int)y->prn;
}

static int compare_satellite(const void *a, const void *b)
{
    const pel_obs_t *x = a, *y = b;
    if (x->sys != y->sys) { return (int)x->sys - (int)y->sys; }
    if (x->prn != y->prn) { return (int)x->prn - (int)y->prn; }
    return (int)x->carrier - (int)y->carrier;
}

static void fill_epoch(rinex_obs_t *r, pel_time_t t, pel_obs_t *obs, int n, pel_epoch_t *e)
{
    memset(e, 0, sizeof *e);
    e->t_ns = t;
    if (n > PEL_MAX_OBS) {
        qsort(obs, (size_t)n, sizeof obs[0], compare_rank);
        e->dropped = (uint16_t)(n - PEL_MAX_OBS);
        tally_add(r->tally, TALLY_LEFT, "signals beyond what the firmware keeps of an epoch", e->dropped);
        n = PEL_MAX_OBS;
    }
    qsort(obs, (size_t)n, sizeof obs[0], compare_satellite);
    e->n = (uint16_t)n;
    if (n > 0) { memcpy(e->obs, obs, (size_t)n * sizeof obs[0]); }
}

/* Satellites of a RINEX 2 epoch are named on its own line and, beyond 12, on continuation lines. */
static bool read_names_v2(rinex_obs_t *r, line_t l, int n, uint8_t sys[], uint8_t prn[])
{
    for (int i = 0; i < n; i++) {
        if (i > 0 && i % 12 == 0 && !lines_next(&r->lines, &l)) { return false; }
        if (!rinex_satellite(l, 32 + 3 * (size_t)(i % 12), &sys[i], &prn[i])) {
            sys[i] = PEL_SYS_GPS; /* its lines have to be stepped over all the same */
            prn[i] = 0;
        }
    }
    return true;
}

/* The satellites of an epoch into obs[]; their number, or -1 when the lines end inside. */
static int read_epoch_body(rinex_obs_t *r, line_t epoch_line, const epoch_line_t *e, pel_obs_t *obs, int cap)
{
    const bool v2 = r->header.version_100 < 300;
    uint8_t sys[1000], prn[1000]; /* I3 */
    rinex_signal_t sig[RINEX_SATELLITE_SIGNALS];
    int n = 0;
    if (v2 && !read_names_v2(r, epoch_line, e->n, sys, prn)) { return -1; }
    for (int i = 0; i < e->n; i++) {
        const lines_t before = r->lines;
        line_t l;
        int n_sig = 0;
        if (!lines_next(&r->lines, &l)) { return -1; }
        if (!v2 && line_char(l, 0) == '>') { /* satellites are missing: this epoch is over */
            r->lines = before;
            if (!r->counting) { tally_add(r->tally, TALLY_REFUSED, "epoch with fewer satellites than it says", 1); }
            break;
        }
        if (!v2 && !rinex_satellite(l, 0, &sys[i], &prn[i])) { prn[i] = 0; }
        if (prn[i] == 0) {
            if (!r->counting) { tally_add(r->tally, TALLY_LEFT, "satellites of systems or numbers not known here", 1); }
            if (!v2) { continue; }
        }
        if (!rinex_satellite_read(r, l, sys[i], prn[i], sig, &n_sig)) { return -1; }
        if (prn[i] == 0) { continue; }
        if (r->counting) {
            rinex_signals_count(r, sys[i], prn[i], sig, n_sig);
        } else {
            n += rinex_signals_take(r, e->t_ns, sys[i], prn[i], sig, n_sig, obs + n, cap - n);
        }
    }
    return n;
}

/* Step over n satellites' observations whose first line is this one. */
static void skip_body(rinex_obs_t *r, int n)
{
    const bool v2 = r->header.version_100 < 300;
    const int columns = r->header.n_columns[PEL_SYS_GPS]; /* RINEX 2 has one list for all systems */
    const int count = v2 ? (n - 1) / 12 + n * ((columns + 4) / 5) : n;
    line_t l;
    for (int i = 0; i < count; i++) {
        const lines_t before = r->lines;
        if (!lines_next(&r->lines, &l)) { return; }
        if (!v2 && line_char(l, 0) == '>') {
            r->lines = before;
            return;
        }
    }
}

/* Flags 2 to 5 are followed by header records, flag 6 by repaired slips in the layout of an epoch. */
static void read_event(rinex_obs_t *r, const epoch_line_t *e)
{
    if (!r->counting) { tally_add(r->tally, TALLY_LEFT, "event records (epoch flags 2 to 6)", 1); }
    if (e->flag == 6) {
        skip_body(r, e->n);
        return;
    }
    tally_t unheard = {0}; /* notes were made on the first walk */
    for (int i = 0; i < e->n; i++) {
        line_t l;
        epoch_line_t probe;
        const lines_t before = r->lines;
        if (!lines_next(&r->lines, &l)) { return; }
        if (r->header.version_100 >= 300 && parse_epoch(&r->header, l, &probe)) {
            r->lines = before;
            return;
        }
        (void)rinex_header_record(&r->header, l, r->counting ? r->tally : &unheard);
    }
}

/* An epoch is out of order if it is not later than the last one taken, or later than both that follow it: so that one damaged
 * date costs one epoch and not the rest of the file. */
static bool in_order(const rinex_obs_t *r, uint64_t i, pel_time_t t)
{
    if (r->n_epochs > 0 && t <= r->t_last_ns) { return false; }
    return !(i + 2 < r->n_times && r->times[i + 1] <= t && r->times[i + 2] <= t);
}

static bool remember_time(rinex_obs_t *r, pel_time_t t)
{
    if (r->n_times == r->cap_times) {
        r->cap_times = (r->cap_times == 0) ? 4096 : 2 * r->cap_times;
        pel_time_t *grown = realloc(r->times, r->cap_times * sizeof *grown);
        if (grown == NULL) { return false; }
        r->times = grown;
    }
    r->times[r->n_times++] = t;
    return true;
}

/* Next observation epoch: its signals in obs[], their number in *n. False at the end of the file. */
static bool next_epoch(rinex_obs_t *r, pel_time_t *t, pel_obs_t *obs, int cap, int *n)
{
    line_t l;
    while (lines_next(&r->lines, &l)) {
        epoch_line_t e = {0};
        if (!parse_epoch(&r->header, l, &e)) {
            if (!r->counting && !line_blank(l, 0, l.n)) {
                tally_add(r->tally, TALLY_REFUSED, "line where an epoch should begin", 1);
            }
            continue;
        }
        if (e.flag >= 2) {
            read_event(r, &e);
            continue;
        }
        if (r->counting && !remember_time(r, e.t_ns)) { return false; }
        if (!r->counting && !in_order(r, r->i_time++, e.t_ns)) {
            tally_add(r->tally, TALLY_REFUSED, "epoch out of order", 1);
            skip_body(r, e.n);
            continue;
        }
        r->n_epochs++;
        r->power_failure = (e.flag == 1);
        r->t_last_ns = e.t_ns;
        *t = e.t_ns;
        *n = read_epoch_body(r, l, &e, obs, cap);
        if (*n < 0) {
            if (!r->counting) { tally_add(r->tally, TALLY_REFUSED, "epoch cut off by the end of the file", 1); }
            return false;
        }
        return true;
    }
    return false;
}

bool rinex_obs_open(rinex_obs_t *r, const input_t *in, tally_t *tally, const char **why)
{
    memset(r, 0, sizeof *r);
    r->tally = tally;
    r->lines = lines_of(in);
    if (!rinex_header_read(&r->header, &r->lines, tally, why)) { return false; }

    const rinex_header_t first_header =
        r->header; /* records inside the file may change it: the second walk starts anew */
    const lines_t first_epoch = r->lines;
    pel_time_t t = 0;
    int n = 0;
    r->counting = true;
    while (next_epoch(r, &t, NULL, 0, &n)) {}
    r->counting = false;
    rinex_signals_choose(r);
    r->header = first_header;
    r->lines = first_epoch;
    r->n_epochs = 0;
    if (in->truncated) { tally_add(tally, TALLY_REFUSED, "gzip stream damaged or cut off", 1); }
    return true;
}

bool rinex_obs_next(rinex_obs_t *r, pel_epoch_t *e)
{
    pel_obs_t obs[RINEX_MAX_SIGNALS];
    pel_time_t t = 0;
    int n = 0;
    while (next_epoch(r, &t, obs, RINEX_MAX_SIGNALS, &n)) {
        if (n == 0) {
            tally_add(r->tally, TALLY_LEFT, "epochs without usable signals", 1);
            continue;
        }
        fill_epoch(r, t, obs, n, e);
        tally_add(r->tally, TALLY_TAKEN, "epochs", 1);
        tally_add(r->tally, TALLY_TAKEN, "signals", e->n);
        return true;
    }
    return false;
}

void rinex_obs_close(rinex_obs_t *r)
{
    free(r->times);
    r->times = NULL;
    r->n_times = 0;
}

void rinex_obs_set_glo_k(rinex_obs_t *r, const int8_t glo_k[33])
{
    for (int slot = 1; slot <= 32; slot++) {
        if (r->header.glo_k[slot] == GLO_K_UNKNOWN) { r->header.glo_k[slot] = glo_k[slot]; }
    }
}

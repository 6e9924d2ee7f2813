#include "rinex_nav.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "calendar.h"
#include "rinex_header.h"

#define BDT_WEEK_0 1356 /* GPS week of BeiDou week 0 */
#define GLO_SD_M   4.0f /* most files do not tell it */
#define MAX_LINES  9    /* of one record, RINEX 3.05 GLONASS has 5, the others 8 */

typedef struct {
    int version_100;
    char file_sys; /* of RINEX 2: 'G', 'R' (GLONASS), 'S' (GEO), ... */
} nav_header_t;

void nav_set_init(nav_set_t *set)
{
    memset(set, 0, sizeof *set);
    memset(set->glo_k, GLO_K_UNKNOWN, sizeof set->glo_k);
}

void nav_set_free(nav_set_t *set)
{
    free(set->record);
    set->record = NULL;
    set->n = set->cap = 0;
}

/* ---- header -------------------------------------------------------------------------------------------------------- */

static bool four_reals(line_t l, size_t col, size_t width, float out[4])
{
    for (size_t i = 0; i < 4; i++) {
        double v = 0.0;
        if (line_real(l, col + width * i, width, &v) != FIELD_OK) { return false; }
        out[i] = (float)v;
    }
    return true;
}

static bool read_header(nav_set_t *set, lines_t *lines, nav_header_t *h, const char **why)
{
    line_t l;
    double version = 0.0;
    float alpha[4], beta[4];
    bool has_alpha = false, has_beta = false;
    *why = "not a RINEX file";
    if (!lines_next(lines, &l) || !line_label(l, "RINEX VERSION / TYPE")) { return false; }
    if (line_real(l, 0, 9, &version) != FIELD_OK) { return false; }
    h->version_100 = (int)lround(fmin(version, 99.0) * 100.0);
    if (h->version_100 < 200 || h->version_100 >= 400) {
        *why = "RINEX version is neither 2 nor 3";
        return false;
    }
    const char type = line_char(l, 20);
    if (type != 'N' && type != 'G' && type != 'H') {
        *why = "a RINEX file, but not of navigation messages";
        return false;
    }
    h->file_sys = (type == 'G') ? 'R' : (type == 'H') ? 'S' : 'G';
    while (lines_next(lines, &l)) {
        if (line_label(l, "ION ALPHA")) { has_alpha = four_reals(l, 2, 12, alpha); }
        if (line_label(l, "ION BETA")) { has_beta = four_reals(l, 2, 12, beta); }
        if (line_label(l, "IONOSPHERIC CORR") && l.n > 5 && memcmp(l.s, "GPSA", 4) == 0) {
            has_alpha = four_reals(l, 5, 12, alpha);
        }
        if (line_label(l, "IONOSPHERIC CORR") && l.n > 5 && memcmp(l.s, "GPSB", 4) == 0) {
            has_beta = four_reals(l, 5, 12, beta);
        }
        if (!line_label(l, "END OF HEADER")) { continue; }
        if (has_alpha && has_beta && !set->klobuchar.valid) {
            memcpy(set->klobuchar.alpha, alpha, sizeof alpha);
            memcpy(set->klobuchar.beta, beta, sizeof beta);
            set->klobuchar.valid = true;
        }
        return true;
    }
    *why = "header has no end";
    return false;
}

/* ---- one record ---------------------------------------------------------------------------------------------------- */

/* Value k of orbit line i (1..7), or of the first line after the date (i = 0, k 1..3). Absent values are 0. */
typedef struct {
    line_t line[MAX_LINES];
    int n;
    bool v2;
    bool bad;
} record_t;

static double value(record_t *rec, int i, int k)
{
    double v = 0.0;
    if (i >= rec->n) {
        rec->bad = true;
        return 0.0;
    }
    const size_t col = (rec->v2 ? 3u : 4u) + 19u * (size_t)k;
    if (line_real(rec->line[i], col, 19, &v) == FIELD_BAD) { rec->bad = true; }
    return v;
}

static bool record_time(const record_t *rec, time_system_t sys, pel_time_t *t)
{
    const line_t l = rec->line[0];
    int y = 0, mo = 0, d = 0, h = 0, mi = 0;
    int64_t ns = 0;
    bool ok = false;
    if (rec->v2) {
        ok = line_int(l, 3, 2, &y) == FIELD_OK && line_int(l, 6, 2, &mo) == FIELD_OK &&
             line_int(l, 9, 2, &d) == FIELD_OK && line_int(l, 12, 2, &h) == FIELD_OK &&
             line_int(l, 15, 2, &mi) == FIELD_OK && line_seconds_ns(l, 17, 5, &ns) == FIELD_OK;
        y += (y < 80) ? 2000 : 1900;
    } else {
        ok = line_int(l, 4, 4, &y) == FIELD_OK && line_int(l, 9, 2, &mo) == FIELD_OK &&
             line_int(l, 12, 2, &d) == FIELD_OK && line_int(l, 15, 2, &h) == FIELD_OK &&
             line_int(l, 18, 2, &mi) == FIELD_OK && line_seconds_ns(l, 21, 2, &ns) == FIELD_OK;
    }
    return ok && calendar_to_gps(y, mo, d, h, mi, ns, sys, t);
}

static void orbit(record_t *rec, pel_ephemeris_t *eph)
{
    eph->af0 = value(rec, 0, 1);
    eph->af1 = value(rec, 0, 2);
    eph->af2 = value(rec, 0, 3);
    eph->crs = value(rec, 1, 1);
    eph->dn = value(rec, 1, 2);
    eph->M0 = value(rec, 1, 3);
    eph->cuc = value(rec, 2, 0);
    eph->e = value(rec, 2, 1);
    eph->cus = value(rec, 2, 2);
    eph->sqrt_a = value(rec, 2, 3);
    eph->cic = value(rec, 3, 1);
    eph->Omega0 = value(rec, 3, 2);
    eph->cis = value(rec, 3, 3);
    eph->i0 = value(rec, 4, 0);
    eph->crc = value(rec, 4, 1);
    eph->omega = value(rec, 4, 2);
    eph->Omega_dot = value(rec, 4, 3);
    eph->idot = value(rec, 5, 0);
}

/* A non-negative integer field within a limit; anything else makes the record bad. */
static uint16_t whole(record_t *rec, int i, int k, double max)
{
    const double v = value(rec, i, k);
    if (!(v >= 0.0 && v <= max)) {
        rec->bad = true;
        return 0;
    }
    return (uint16_t)(v + 0.5);
}

/* Galileo health of RINEX (E1-B, E5a, E5b: validity and two status bits each, from the lowest) as the firmware numbers it:
 * E1-B or, in F/NAV, E5a lowest, E5b above. */
static uint8_t galileo_health(unsigned rinex, uint8_t source)
{
    if (source != 0) { return (uint8_t)(rinex >> 3 & 7u); }
    return (uint8_t)((rinex & 7u) | (rinex >> 6 & 7u) << 3);
}

/* GPS and QZSS fields share a layout, Galileo and BeiDou put their own into three of its places. */
static void system_fields(record_t *rec, pel_ephemeris_t *eph)
{
    eph->iode = whole(rec, 1, 0, 1023.0);
    const unsigned health = whole(rec, 6, 1, 511.0);
    eph->health = (uint8_t)(health & 63u);
    eph->sd_ura_m = (float)value(rec, 6, 0);
    eph->tgd_s[0] = value(rec, 6, 2);
    double fit_h = 0.0;
    switch (eph->sys) {
    case PEL_SYS_GAL: {
        const unsigned source = whole(rec, 5, 1, 65535.0);
        eph->tgd_s[1] = value(rec, 6, 3);
        eph->iodc = eph->iode;
        eph->source = (source & 0x5u) ? 0 : 1; /* bits 0, 2: I/NAV on E1-B, E5b-I; bit 1: F/NAV */
        eph->health = galileo_health(health, eph->source);
        eph->fit_s = 14400.0f;
        break;
    }
    case PEL_SYS_BDS:
        eph->tgd_s[1] = value(rec, 6, 3);
        eph->iodc = whole(rec, 7, 1, 1023.0); /* AODC */
        eph->fit_s = 7200.0f;
        break;
    default: /* GPS, QZSS */
        eph->iodc = whole(rec, 6, 3, 1023.0);
        fit_h = value(rec, 7, 1);
        /* GPS writes hours (0: four), QZSS a flag (0: two hours, 1: more); usable is half of it to each side. */
        eph->fit_s = (eph->sys == PEL_SYS_GPS && fit_h > 4.0 && fit_h < 200.0) ? (float)(fit_h * 1800.0) : 7200.0f;
        break;
    }
}

/* Is this an orbit a receiver could use, or a blank or damaged one? */
static bool plausible(const pel_ephemeris_t *e)
{
    return e->sqrt_a > 4000.0 && e->sqrt_a < 8000.0 && e->e >= 0.0 && e->e < 0.5 && fabs(e->af0) < 0.1 &&
           fabs(e->M0) < 7.0 && fabs(e->omega) < 7.0 && fabs(e->Omega0) < 7.0 && fabs(e->i0) < 3.2 &&
           e->sd_ura_m >= -1.0f;
}

static bool decode(record_t *rec, uint8_t sys, uint8_t prn, nav_record_t *out)
{
    pel_ephemeris_t *eph = &out->eph;
    const pel_time_t system_s = (sys == PEL_SYS_BDS) ? 14 * PEL_NS_PER_S : 0;
    const time_system_t ts = (sys == PEL_SYS_BDS) ? CLOCK_BDT : CLOCK_GPS;
    memset(out, 0, sizeof *out);
    eph->sys = sys;
    eph->prn = prn;
    if (!record_time(rec, ts, &eph->toc_ns)) { return false; }
    orbit(rec, eph);
    system_fields(rec, eph);
    /* toe and transmission time are seconds of week: the one nearest to toc, whose date is written out. Some files let the
     * transmission time run outside the week, and write 0.9999e9 where it is not known. */
    const double toe_s = value(rec, 3, 0), tx_s = value(rec, 7, 0);
    if (rec->bad || !plausible(eph) || toe_s < 0.0 || toe_s > 604800.0) { return false; }
    eph->toe_ns = pel_time_from_tow_near(toe_s, eph->toc_ns - system_s) + system_s;
    out->t_tx_ns = eph->toe_ns - ((sys == PEL_SYS_GPS || sys == PEL_SYS_QZS) ? 7200 * PEL_NS_PER_S : 0);
    if (fabs(tx_s) <= 2.0 * 604800.0 && !line_blank(rec->line[7], rec->v2 ? 3 : 4, 19)) {
        const pel_time_t tx =
            pel_time_from_tow_near(fmod(tx_s + 604800.0, 604800.0), eph->toe_ns - system_s) + system_s;
        if (llabs(tx - eph->toe_ns) < 43200 * PEL_NS_PER_S) { out->t_tx_ns = tx; }
    }
    return true;
}

/* A record of GLONASS: state vector in km, clock as -tau_n and gamma_n, time in UTC; 4 lines, later versions add one. */
static bool decode_glonass(record_t *rec, uint8_t prn, nav_record_t *out)
{
    pel_ephemeris_t *eph = &out->eph;
    double square = 0.0;
    memset(out, 0, sizeof *out);
    eph->sys = PEL_SYS_GLO;
    eph->prn = prn;
    if (!record_time(rec, CLOCK_UTC, &eph->toe_ns)) { return false; }
    eph->toc_ns = eph->toe_ns;
    const int64_t moscow_s = eph->toe_ns / PEL_NS_PER_S - pel_time_leap_s(eph->toe_ns) + 10800;
    eph->iode = eph->iodc = (uint16_t)(moscow_s % 86400 / 900); /* t_b */
    eph->af0 = value(rec, 0, 1);
    eph->af1 = value(rec, 0, 2);
    for (int i = 0; i < 3; i++) {
        eph->glo.r_e[i] = 1e3 * value(rec, i + 1, 0);
        eph->glo.v_e[i] = 1e3 * value(rec, i + 1, 1);
        eph->glo.a_e[i] = 1e3 * value(rec, i + 1, 2);
        square += eph->glo.r_e[i] * eph->glo.r_e[i];
    }
    const double k = value(rec, 2, 3);
    eph->health = (value(rec, 1, 3) != 0.0) ? 1 : 0;
    eph->glo.k = (int8_t)lround(fmax(-8.0, fmin(k, 7.0)));
    eph->sd_ura_m = GLO_SD_M;
    eph->fit_s = 1200.0f;
    out->t_tx_ns = eph->toe_ns - 900 * PEL_NS_PER_S; /* sent during the half hour in whose middle it is valid */
    return !rec->bad && square > 2.4e7 * 2.4e7 && square < 2.7e7 * 2.7e7 && k >= -7.0 && k <= 6.0 &&
           fabs(eph->af0) < 0.1;
}

static bool same(const pel_ephemeris_t *a, const pel_ephemeris_t *b)
{
    return a->sys == b->sys && a->prn == b->prn && a->source == b->source && a->toe_ns == b->toe_ns &&
           a->toc_ns == b->toc_ns && a->iode == b->iode;
}

static bool keep(nav_set_t *set, const nav_record_t *rec, tally_t *tally)
{
    for (size_t i = set->n; i > 0; i--) {
        nav_record_t *old = &set->record[i - 1];
        if (!same(&old->eph, &rec->eph)) { continue; }
        if (rec->t_tx_ns < old->t_tx_ns) { old->t_tx_ns = rec->t_tx_ns; }
        tally_add(tally, TALLY_LEFT, "ephemeris that is there already", 1);
        return true;
    }
    if (set->n == set->cap) {
        const size_t cap = (set->cap == 0) ? 256 : 2 * set->cap;
        nav_record_t *grown = realloc(set->record, cap * sizeof *grown);
        if (grown == NULL) { return false; }
        set->record = grown;
        set->cap = cap;
    }
    set->record[set->n++] = *rec;
    tally_add(tally, TALLY_TAKEN, "ephemerides", 1);
    return true;
}

static void take(nav_set_t *set, const nav_header_t *h, record_t *rec, tally_t *tally)
{
    int sys = rinex_system(rec->v2 ? h->file_sys : line_char(rec->line[0], 0));
    int n = 0;
    if (line_int(rec->line[0], rec->v2 ? 0 : 1, 2, &n) != FIELD_OK) {
        tally_add(tally, TALLY_REFUSED, "ephemeris without a satellite number", 1);
        return;
    }
    if (sys == PEL_SYS_GLO) {
        const double k = value(rec, 2, 3);
        if (!rec->bad && n >= 1 && n <= 32 && k >= -7.0 && k <= 6.0) { set->glo_k[n] = (int8_t)lround(k); }
    }
    if (sys < 0 || sys == PEL_SYS_SBS) {
        tally_add(tally, TALLY_LEFT, "SBAS, IRNSS and other orbits", 1);
        return;
    }
    if (sys == PEL_SYS_QZS && n > 192) { n -= 192; }
    const int n_lines = (sys == PEL_SYS_GLO) ? 4 : 8;
    nav_record_t out;
    bool good = n >= 1 && n <= pel_sys_max_prn((pel_sys_t)sys) && rec->n >= n_lines;
    if (good) {
        good =
            (sys == PEL_SYS_GLO) ? decode_glonass(rec, (uint8_t)n, &out) : decode(rec, (uint8_t)sys, (uint8_t)n, &out);
    }
    if (!good) {
        tally_add(tally, TALLY_REFUSED,
                  (rec->n < n_lines) ? "ephemeris cut short" : "ephemeris with an impossible value", 1);
        return;
    }
    (void)keep(set, &out, tally);
}

/* First line of a record: RINEX 3 has a letter in column 0, RINEX 2 a satellite number where other lines are blank. */
static bool begins(const nav_header_t *h, line_t l)
{
    const char c0 = line_char(l, 0), c1 = line_char(l, 1);
    if (h->version_100 >= 300) { return c0 != ' '; }
    return (c0 >= '0' && c0 <= '9') || (c1 >= '0' && c1 <= '9');
}

bool rinex_nav_read(nav_set_t *set, const input_t *in, tally_t *tally, const char **why)
{
    lines_t lines = lines_of(in);
    nav_header_t h;
    record_t rec = {0};
    line_t l;
    if (!read_header(set, &lines, &h, why)) { return false; }
    while (lines_next(&lines, &l)) {
        if (begins(&h, l)) {
            if (rec.n > 0) { take(set, &h, &rec, tally); }
            rec.n = 0;
            rec.bad = false;
            rec.v2 = h.version_100 < 300;
            rec.line[rec.n++] = l;
        } else if (rec.n > 0 && rec.n < MAX_LINES) {
            rec.line[rec.n++] = l;
        }
    }
    if (rec.n > 0) { take(set, &h, &rec, tally); }
    if (in->truncated) { tally_add(tally, TALLY_REFUSED, "gzip stream damaged or cut off", 1); }
    return true;
}

/* ---- when to send -------------------------------------------------------------------------------------------------- */

static int by_satellite_then_toe(const void *a, const void *b)
{
    const pel_ephemeris_t *x = &((const nav_record_t *)a)->eph, *y = &((const nav_record_t *)b)->eph;
    if (x->sys != y->sys) { return (int)x->sys - (int)y->sys; }
    if (x->prn != y->prn) { return (int)x->prn - (int)y->prn; }
    if (x->source != y->source) { return (int)x->source - (int)y->source; }
    if (x->toe_ns != y->toe_ns) { return (x->toe_ns > y->toe_ns) - (x->toe_ns < y->toe_ns); }
    return (x->iode > y->iode) - (x->iode < y->iode);
}

static int by_time(const void *a, const void *b)
{
    const nav_sent_t *x = a, *y = b;
    if (x->t_ns != y->t_ns) { return (x->t_ns > y->t_ns) - (x->t_ns < y->t_ns); }
    return by_satellite_then_toe(x->eph, y->eph); /* eph is the first member of nav_record_t */
}

size_t nav_set_schedule(nav_set_t *set, pel_time_t start, pel_time_t end, tally_t *tally, nav_sent_t **out)
{
    size_t n = 0;
    *out = (set->n > 0) ? malloc(set->n * sizeof **out) : NULL;
    if (*out == NULL) { return 0; }
    qsort(set->record, set->n, sizeof set->record[0], by_satellite_then_toe);
    bool has_inav[RINEX_MAX_PRN] = {false};
    for (size_t i = 0; i < set->n; i++) {
        const pel_ephemeris_t *e = &set->record[i].eph;
        if (e->sys == PEL_SYS_GAL && e->source == 0) { has_inav[e->prn] = true; }
    }
    for (size_t i = 0; i < set->n; i++) {
        const nav_record_t *r = &set->record[i];
        const pel_ephemeris_t *e = &r->eph, *next = NULL, *prev = NULL;
        const pel_time_t fit = (pel_time_t)e->fit_s * PEL_NS_PER_S;
        if (e->sys == PEL_SYS_GAL && e->source != 0 && has_inav[e->prn]) {
            tally_add(tally, TALLY_LEFT, "Galileo F/NAV beside I/NAV", 1);
            continue;
        }
        if (i > 0 && r[-1].eph.sys == e->sys && r[-1].eph.prn == e->prn && r[-1].eph.source == e->source) {
            prev = &r[-1].eph;
        }
        if (i + 1 < set->n && r[1].eph.sys == e->sys && r[1].eph.prn == e->prn && r[1].eph.source == e->source) {
            next = &r[1].eph;
        }
        /* In use from its transmission, or as soon as it is valid if its predecessor no longer is. */
        pel_time_t t = r->t_tx_ns;
        const pel_time_t prev_end = (prev == NULL) ? INT64_MIN : prev->toe_ns + fit;
        if (prev_end < t) { t = (prev_end > e->toe_ns - fit) ? prev_end : (e->toe_ns - fit < t) ? e->toe_ns - fit : t; }
        const bool superseded = next != NULL && r[1].t_tx_ns <= start && next->toe_ns - fit <= start;
        if (t > end || e->toe_ns + fit < start || superseded) {
            tally_add(tally, TALLY_LEFT, "ephemerides not valid during the recording, or replaced before it", 1);
            continue;
        }
        (*out)[n].t_ns = (t < start) ? start : t;
        (*out)[n].eph = e;
        n++;
    }
    qsort(*out, n, sizeof **out, by_time);
    tally_add(tally, TALLY_TAKEN, "ephemerides sent", n);
    return n;
}

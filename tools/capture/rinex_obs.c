#include "rinex_obs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What one satellite's one tracking code says at one epoch. */
typedef struct {
    pel_obs_t obs;
    bool lost_lock; /* LLI bit 0 */
} signal_t;

/* Order among codes of one carrier that are equally complete. GPS L2: W first, because every satellite has it. */
static const char *order_of(int sys, uint8_t carrier)
{
    switch (sys) {
    case PEL_SYS_GPS:
        return (carrier == PEL_CARRIER_L1) ? "CWPYLXSMN" : (carrier == PEL_CARRIER_L2) ? "WPYCLXSDMN" : "QXI";
    case PEL_SYS_GLO: return "CP";
    case PEL_SYS_GAL: return (carrier == PEL_CARRIER_L1 || carrier == PEL_CARRIER_E6) ? "CXBAZ" : "QXI";
    case PEL_SYS_BDS: return (carrier == PEL_CARRIER_L1 || carrier == PEL_CARRIER_L5) ? "PXDAN" : "IXQPDZA";
    case PEL_SYS_QZS: return (carrier == PEL_CARRIER_L1) ? "CXLSZ" : (carrier == PEL_CARRIER_L5) ? "QXI" : "LXSEZ";
    default: return "CIQX";
    }
}

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

/* ---- one satellite ------------------------------------------------------------------------------------------------- */

static void set_value(rinex_obs_t *r, signal_t *s, const rinex_column_t *c, double v, int lli, bool squaring)
{
    pel_obs_t *o = &s->obs;
    v /= c->scale;
    switch (c->type) {
    case 'C':
        if (!(v > 1e6 && v < 1e9)) {
            if (!r->counting && v != 0.0) { tally_add(r->tally, TALLY_REFUSED, "pseudorange out of range", 1); }
            return;
        }
        o->P_m = v;
        o->flags |= PEL_OBS_CODE;
        return;
    case 'L':
        if (lli & 1) { s->lost_lock = true; }
        if (v == 0.0 || fabs(v) > 1e11) { return; }
        o->L_cyc = v;
        o->flags |= PEL_OBS_PHASE;
        /* RINEX 2.10 lets LLI bit 1 mean "the other wavelength factor this time"; writers for squaring receivers set both
         * the header's 2 and the bit, so here either one means that a half cycle is open. */
        if ((lli & 2) || squaring) { o->flags |= PEL_OBS_HALF_CYCLE; }
        return;
    case 'D':
        if (v == 0.0 || fabs(v) > 1e5) { return; }
        o->D_hz = (float)v;
        o->flags |= PEL_OBS_DOPPLER;
        return;
    default:
        if (r->header.strength_dbhz && v > 0.0 && v < 70.0) { o->cn0_dbhz = (float)v; }
        return;
    }
}

static signal_t *find_signal(signal_t *sig, int *n, int cap, uint8_t carrier, char attr)
{
    for (int i = 0; i < *n; i++) {
        if (sig[i].obs.carrier == carrier && sig[i].obs.code == attr) { return &sig[i]; }
    }
    if (*n == cap) { return NULL; }
    memset(&sig[*n], 0, sizeof sig[*n]);
    sig[*n].obs.carrier = carrier;
    sig[*n].obs.code = attr;
    return &sig[(*n)++];
}

/* RINEX 2: give each carrier's shared phase, Doppler and strength to each of its codes. */
static int share_phase(signal_t *sig, int n, int cap)
{
    for (int i = 0; i < n; i++) {
        if (sig[i].obs.code != '*') { continue; }
        bool given = false;
        for (int k = 0; k < n; k++) {
            if (k == i || sig[k].obs.carrier != sig[i].obs.carrier) { continue; }
            sig[k].obs.L_cyc = sig[i].obs.L_cyc;
            sig[k].obs.D_hz = sig[i].obs.D_hz;
            if (sig[i].obs.cn0_dbhz > 0.0f) { sig[k].obs.cn0_dbhz = sig[i].obs.cn0_dbhz; }
            sig[k].obs.flags |= sig[i].obs.flags;
            sig[k].lost_lock = sig[i].lost_lock;
            given = true;
        }
        if (!given) { /* phase alone */
            signal_t *s = find_signal(sig, &n, cap, sig[i].obs.carrier, 'C');
            if (s != NULL) { /* find_signal may have appended: copy all but the attribute */
                *s = sig[i];
                s->obs.code = 'C';
            }
        }
    }
    return n;
}

/* All signals of one satellite from its columns, which begin `first` characters into the line and continue in RINEX 2 on
 * following lines of five. False: lines ended. */
static bool read_satellite(rinex_obs_t *r, line_t l, bool v2, uint8_t sys, uint8_t prn, signal_t *sig, int cap, int *n)
{
    const rinex_header_t *h = &r->header;
    *n = 0;
    for (int k = 0; k < h->n_columns[sys]; k++) {
        if (v2 && k > 0 && k % 5 == 0 && !lines_next(&r->lines, &l)) { return false; }
        const rinex_column_t *c = &h->column[sys][k];
        const size_t col = v2 ? 16 * (size_t)(k % 5) : 3 + 16 * (size_t)k;
        if (c->type == 0 || line_blank(l, col, 16)) { continue; }
        signal_t *s = find_signal(sig, n, cap, c->carrier, c->attr);
        if (s == NULL) { continue; }
        double v = 0.0;
        int lli = 0, ssi = 0;
        const field_t f = line_real(l, col, 14, &v);
        if (line_int(l, col + 14, 1, &lli) != FIELD_OK) { lli = 0; }
        if (f == FIELD_BAD && !r->counting) { tally_add(r->tally, TALLY_REFUSED, "value is not a number", 1); }
        const bool squaring =
            v2 && sys == PEL_SYS_GPS && c->carrier <= PEL_CARRIER_L2 && h->half_cycle[prn][c->carrier];
        if (f == FIELD_OK || c->type == 'L') { set_value(r, s, c, v, lli, squaring); }
        /* The one-digit strength stands in (middle of its 6 dB-Hz step) where there is no S column. */
        if (c->type == 'L' && s->obs.cn0_dbhz <= 0.0f && line_int(l, col + 15, 1, &ssi) == FIELD_OK && ssi > 0) {
            s->obs.cn0_dbhz = (float)(6 * ssi + 3);
        }
    }
    if (v2) { *n = share_phase(sig, *n, cap); }
    return true;
}

/* First walk: one point for code with phase four times that of a Doppler, because a code without phase fixes nothing. */
static void count_signals(rinex_obs_t *r, uint8_t sys, uint8_t prn, const signal_t *sig, int n)
{
    for (int i = 0; i < n; i++) {
        const pel_obs_t *o = &sig[i].obs;
        if (o->code < 'A' || o->code > 'Z') { continue; }
        uint32_t *score = &r->score[sys][prn][o->carrier][o->code - 'A'];
        if ((o->flags & PEL_OBS_CODE) && (o->flags & PEL_OBS_PHASE)) {
            *score += 8;
        } else if (o->flags & (PEL_OBS_CODE | PEL_OBS_PHASE)) {
            *score += 2;
        }
        if (o->flags & PEL_OBS_DOPPLER) { *score += 1; }
    }
}

/* The first in order whose score is within 5 % of the best one. */
static char choose(int sys, uint8_t carrier, const uint32_t score[26])
{
    uint32_t best = 0;
    for (int i = 0; i < 26; i++) { best = (score[i] > best) ? score[i] : best; }
    if (best == 0) { return '\0'; }
    const uint64_t enough = ((uint64_t)best * 95 + 99) / 100;
    for (const char *p = order_of(sys, carrier); *p != '\0'; p++) {
        if (score[*p - 'A'] >= enough) { return *p; }
    }
    for (int i = 0; i < 26; i++) {
        if (score[i] == best) { return (char)('A' + i); }
    }
    return '\0';
}

static void choose_all(rinex_obs_t *r)
{
    for (int s = 0; s < PEL_N_SYS; s++) {
        for (int p = 0; p < RINEX_MAX_PRN; p++) {
            for (uint8_t c = 0; c < PEL_N_CARRIER; c++) { r->chosen[s][p][c] = choose(s, c, r->score[s][p][c]); }
        }
    }
}

/* Lock time at this epoch: zero where continuity is not certain. */
static void set_lock(rinex_obs_t *r, pel_time_t t, pel_obs_t *o, bool lost_lock)
{
    rinex_lock_t *lock = &r->lock[o->sys][o->prn][o->carrier];
    if (!(o->flags & PEL_OBS_PHASE)) {
        lock->epoch = 0;
        return;
    }
    const bool continues = lock->epoch != 0 && lock->epoch + 1 == r->n_epochs && !lost_lock && !r->power_failure;
    if (!continues) {
        lock->since_ns = t;
        o->flags |= PEL_OBS_SLIP;
    }
    lock->epoch = r->n_epochs;
    const int64_t ms = (t - lock->since_ns) / PEL_NS_PER_MS;
    o->lock_ms = (ms > (int64_t)UINT32_MAX) ? UINT32_MAX : (uint32_t)ms;
}

/* Second walk: the chosen code of each carrier, at most one observation a carrier. */
static int take_signals(rinex_obs_t *r, pel_time_t t, uint8_t sys, uint8_t prn, const signal_t *sig, int n,
                        pel_obs_t *out, int room)
{
    const bool v2 = r->header.version_100 < 300;
    int taken = 0;
    for (uint8_t c = 0; c < PEL_N_CARRIER; c++) {
        const signal_t *best = NULL;
        int best_merit = 0, seen = 0;
        for (int i = 0; i < n; i++) {
            const signal_t *s = &sig[i];
            if (s->obs.carrier != c || s->obs.code == '*') { continue; }
            if (!(s->obs.flags & (PEL_OBS_CODE | PEL_OBS_PHASE))) { continue; }
            const int is_chosen = (s->obs.code == r->chosen[sys][prn][c]);
            /* RINEX 2: any code will do, the phase is the same one. RINEX 3: another code has another phase. */
            const int merit = v2 ? 1 + is_chosen + ((s->obs.flags & PEL_OBS_CODE) ? 2 : 0) : is_chosen;
            seen++;
            if (merit > best_merit) {
                best = s;
                best_merit = merit;
            }
        }
        if (seen > (best != NULL)) {
            tally_add(r->tally, TALLY_LEFT, "signals of another code on a carrier already taken",
                      (uint64_t)(seen - (best != NULL)));
        }
        if (best == NULL || taken == room) { continue; }
        pel_obs_t *o = &out[taken++];
        *o = best->obs;
        o->sys = sys;
        o->prn = prn;
        if (sys == PEL_SYS_GLO) {
            const int8_t k = r->header.glo_k[prn];
            if (k == GLO_K_UNKNOWN) {
                tally_add(r->tally, TALLY_LEFT, "GLONASS slot without a known frequency channel", 1);
                taken--;
                continue;
            }
            o->glo_k = k;
        }
        set_lock(r, t, o, best->lost_lock);
    }
    return taken;
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
    signal_t sig[40];
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
        if (!read_satellite(r, l, v2, sys[i], prn[i], sig, (int)(sizeof sig / sizeof sig[0]), &n_sig)) { return -1; }
        if (prn[i] == 0) { continue; }
        if (r->counting) {
            count_signals(r, sys[i], prn[i], sig, n_sig);
        } else {
            n += take_signals(r, e->t_ns, sys[i], prn[i], sig, n_sig, obs + n, cap - n);
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
    choose_all(r);
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

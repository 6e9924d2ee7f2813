#include "rinex_signals.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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

/* ---- columns of one satellite ------------------------------------------------------------------------------------------------- */

static void set_value(rinex_obs_t *r, rinex_signal_t *s, const rinex_column_t *c, double v, int lli, bool squaring)
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

static rinex_signal_t *find_signal(rinex_signal_t *sig, int *n, uint8_t carrier, char attr)
{
    for (int i = 0; i < *n; i++) {
        if (sig[i].obs.carrier == carrier && sig[i].obs.code == attr) { return &sig[i]; }
    }
    if (*n == RINEX_SATELLITE_SIGNALS) { return NULL; }
    memset(&sig[*n], 0, sizeof sig[*n]);
    sig[*n].obs.carrier = carrier;
    sig[*n].obs.code = attr;
    return &sig[(*n)++];
}

/* RINEX 2: give each carrier's shared phase, Doppler and strength to each of its codes. */
static int share_phase(rinex_signal_t *sig, int n)
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
            rinex_signal_t *s = find_signal(sig, &n, sig[i].obs.carrier, 'C');
            if (s != NULL) { /* find_signal may have appended: copy all but the attribute */
                *s = sig[i];
                s->obs.code = 'C';
            }
        }
    }
    return n;
}

bool rinex_satellite_read(rinex_obs_t *r, line_t l, uint8_t sys, uint8_t prn,
                          rinex_signal_t sig[RINEX_SATELLITE_SIGNALS], int *n)
{
    const rinex_header_t *h = &r->header;
    const bool v2 = h->version_100 < 300;
    *n = 0;
    for (int k = 0; k < h->n_columns[sys]; k++) {
        if (v2 && k > 0 && k % 5 == 0 && !lines_next(&r->lines, &l)) { return false; }
        const rinex_column_t *c = &h->column[sys][k];
        const size_t col = v2 ? 16 * (size_t)(k % 5) : 3 + 16 * (size_t)k;
        if (c->type == 0 || line_blank(l, col, 16)) { continue; }
        rinex_signal_t *s = find_signal(sig, n, c->carrier, c->attr);
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
    if (v2) { *n = share_phase(sig, *n); }
    return true;
}

/* First walk: one point for code with phase four times that of a Doppler, because a code without phase fixes nothing. */
void rinex_signals_count(rinex_obs_t *r, uint8_t sys, uint8_t prn, const rinex_signal_t *sig, int n)
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

void rinex_signals_choose(rinex_obs_t *r)
{
    for (int s = 0; s < PEL_N_SYS; s++) {
        for (int p = 0; p < RINEX_MAX_PRN; p++) {
            for (int c = 0; c < PEL_N_CARRIER; c++) { r->chosen[s][p][c] = choose(s, (uint8_t)c, r->score[s][p][c]); }
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
int rinex_signals_take(rinex_obs_t *r, pel_time_t t, uint8_t sys, uint8_t prn, const rinex_signal_t *sig, int n,
                       pel_obs_t *out, int room)
{
    const bool v2 = r->header.version_100 < 300;
    int taken = 0;
    for (int c = 0; c < PEL_N_CARRIER; c++) {
        const rinex_signal_t *best = NULL;
        int best_merit = 0, seen = 0;
        for (int i = 0; i < n; i++) {
            const rinex_signal_t *s = &sig[i];
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

void rinex_signals_describe(const rinex_obs_t *r, char *out, size_t cap)
{
    static const char *const CARRIER[PEL_N_CARRIER] = {"L1", "L2", "L5", "E5b", "E6", "B1I", "B3I"};
    size_t n = 0;
    out[0] = '\0';
    for (int s = 0; s < PEL_N_SYS; s++) {
        for (int c = 0; c < PEL_N_CARRIER; c++) {
            int count[26] = {0}, total = 0;
            for (int p = 0; p < RINEX_MAX_PRN; p++) {
                if (r->chosen[s][p][c] == '\0') { continue; }
                count[r->chosen[s][p][c] - 'A']++;
                total++;
            }
            if (total > 0 && n < cap) {
                n += (size_t)snprintf(out + n, cap - n, "  %c %s", pel_sys_letter((pel_sys_t)s), CARRIER[c]);
            }
            for (int i = 0; i < 26; i++) {
                if (count[i] > 0 && n < cap) { n += (size_t)snprintf(out + n, cap - n, " %c x%d", 'A' + i, count[i]); }
            }
        }
    }
}

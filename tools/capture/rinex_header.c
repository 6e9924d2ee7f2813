#include "rinex_header.h"

#include <math.h>
#include <string.h>

int rinex_system(char letter)
{
    static const char LETTERS[] = "GRECJS"; /* in the order of pel_sys_t */
    if (letter == ' ') { return PEL_SYS_GPS; }
    const char *p = (letter == '\0') ? NULL : strchr(LETTERS, letter);
    return (p == NULL) ? -1 : (int)(p - LETTERS);
}

bool rinex_satellite(line_t l, size_t col, uint8_t *sys, uint8_t *prn)
{
    const int s = rinex_system(line_char(l, col));
    int n = 0;
    if (s < 0 || line_int(l, col + 1, 2, &n) != FIELD_OK) { return false; }
    if (s == PEL_SYS_SBS) { n -= 19; } /* S20 is PRN 120, the first */
    if (n < 1 || n > pel_sys_max_prn((pel_sys_t)s)) { return false; }
    *sys = (uint8_t)s;
    *prn = (uint8_t)n;
    return true;
}

/* Carrier of a RINEX band digit, PEL_N_CARRIER for one without a pel_carrier_t (E5 AltBOC, L3 CDMA, ...). */
static uint8_t carrier_of(int sys, char band, char attr)
{
    switch (band) {
    /* RINEX 3.02 wrote B1I as C1I, L1Q, ...; B1C has other attributes. */
    case '1': return (sys == PEL_SYS_BDS && strchr("IQX", attr) != NULL) ? PEL_CARRIER_B1I : PEL_CARRIER_L1;
    case '2': return (sys == PEL_SYS_BDS) ? PEL_CARRIER_B1I : PEL_CARRIER_L2;
    case '5': return PEL_CARRIER_L5;
    case '6':
        if (sys == PEL_SYS_GLO) { return PEL_N_CARRIER; }
        return (sys == PEL_SYS_BDS) ? PEL_CARRIER_B3I : PEL_CARRIER_E6;
    case '7': return PEL_CARRIER_E5B;
    default: return PEL_N_CARRIER;
    }
}

/* "C1C" of RINEX 3; X1, I1 (channel, ionosphere) and unknown carriers become unused columns. */
static rinex_column_t column_v3(const rinex_header_t *h, int sys, const char id[3])
{
    rinex_column_t c = {0, id[2], 0, 1.0};
    char attr = id[2];
    if (h->version_100 != 302 && attr == 'X' && sys == PEL_SYS_BDS && id[1] == '1') { attr = 'P'; } /* B1C D+P */
    if (attr == ' ') { c.attr = attr = 'C'; } /* written by some */
    const uint8_t carrier = carrier_of(sys, id[1], attr);
    if (strchr("CLDS", id[0]) != NULL && carrier != PEL_N_CARRIER) {
        c.type = id[0];
        c.carrier = carrier;
    }
    return c;
}

/* "C1", "P2", "L1", ... of RINEX 2. Phase, Doppler and strength belong to whichever code the carrier was tracked on. */
static rinex_column_t column_v2(int sys, const char id[2])
{
    rinex_column_t c = {0, '*', 0, 1.0};
    const uint8_t carrier = carrier_of(sys, id[1], 'C');
    if (carrier == PEL_N_CARRIER || strchr("CPLDS", id[0]) == NULL) { return c; }
    c.carrier = carrier;
    c.type = (id[0] == 'P') ? 'C' : id[0];
    if (id[0] == 'P') { c.attr = (sys == PEL_SYS_GLO) ? 'P' : 'W'; }
    if (id[0] == 'C') { c.attr = (carrier == PEL_CARRIER_L1 || sys == PEL_SYS_GLO) ? 'C' : 'X'; }
    if (id[0] == 'C' && sys == PEL_SYS_BDS) { c.attr = 'I'; }
    return c;
}

static void obs_types_v3(rinex_header_t *h, line_t l)
{
    int n = 0;
    if (line_char(l, 0) != ' ') {
        h->types_sys = rinex_system(line_char(l, 0));
        h->types_left = (line_int(l, 3, 3, &n) == FIELD_OK && n > 0) ? n : 0;
        if (h->types_sys >= 0) { h->n_columns[h->types_sys] = 0; }
    }
    for (size_t i = 0; i < 13 && h->types_left > 0; i++, h->types_left--) {
        const char id[3] = {line_char(l, 7 + 4 * i), line_char(l, 8 + 4 * i), line_char(l, 9 + 4 * i)};
        if (h->types_sys < 0 || h->n_columns[h->types_sys] == RINEX_MAX_COLUMNS) { continue; }
        h->column[h->types_sys][h->n_columns[h->types_sys]++] = column_v3(h, h->types_sys, id);
    }
}

static void obs_types_v2(rinex_header_t *h, line_t l)
{
    int n = 0;
    if (line_int(l, 0, 6, &n) == FIELD_OK && n > 0) {
        h->types_left = n;
        for (int s = 0; s < PEL_N_SYS; s++) { h->n_columns[s] = 0; }
    }
    for (size_t i = 0; i < 9 && h->types_left > 0; i++, h->types_left--) {
        const char id[2] = {line_char(l, 10 + 6 * i), line_char(l, 11 + 6 * i)};
        for (int s = 0; s < PEL_N_SYS; s++) {
            if (h->n_columns[s] < RINEX_MAX_COLUMNS) { h->column[s][h->n_columns[s]++] = column_v2(s, id); }
        }
    }
}

static void scale_factor(rinex_header_t *h, line_t l)
{
    const int sys = rinex_system(line_char(l, 0));
    int factor = 1, n = 0;
    if (line_char(l, 0) == ' ' || sys < 0 || line_int(l, 2, 4, &factor) != FIELD_OK || factor < 1) { return; }
    if (line_int(l, 8, 2, &n) != FIELD_OK) { n = 0; } /* no list: all types of the system */
    for (int k = 0; k < h->n_columns[sys]; k++) {
        rinex_column_t *c = &h->column[sys][k];
        bool meant = (n == 0);
        for (size_t i = 0; i < (size_t)n && i < 12; i++) {
            const char attr = line_char(l, 13 + 4 * i);
            const uint8_t carrier = carrier_of(sys, line_char(l, 12 + 4 * i), attr);
            if (line_char(l, 11 + 4 * i) == c->type && carrier == c->carrier && attr == c->attr) { meant = true; }
        }
        if (meant) { c->scale = (double)factor; }
    }
}

/* "     2     1     n   G05   G07 ...": factor 2 means a squaring receiver, whose phase is ambiguous by half cycles. */
static void wavelength_factor(rinex_header_t *h, line_t l)
{
    int f1 = 1, f2 = 1, n = 0;
    if (line_int(l, 0, 6, &f1) != FIELD_OK) { return; }
    (void)line_int(l, 6, 6, &f2);
    if (line_int(l, 12, 6, &n) != FIELD_OK || n <= 0) {
        for (int prn = 0; prn < RINEX_MAX_PRN; prn++) {
            h->half_cycle[prn][0] = (f1 == 2);
            h->half_cycle[prn][1] = (f2 == 2);
        }
        return;
    }
    for (size_t i = 0; i < (size_t)n && i < 7; i++) {
        uint8_t sys = 0, prn = 0;
        if (!rinex_satellite(l, 21 + 6 * i, &sys, &prn) || sys != PEL_SYS_GPS) { continue; }
        h->half_cycle[prn][0] = (f1 == 2);
        h->half_cycle[prn][1] = (f2 == 2);
    }
}

static void glonass_slots(rinex_header_t *h, line_t l)
{
    for (size_t i = 0; i < 8; i++) {
        int slot = 0, k = 0;
        if (line_char(l, 4 + 7 * i) != 'R' || line_int(l, 5 + 7 * i, 2, &slot) != FIELD_OK) { continue; }
        if (line_int(l, 8 + 7 * i, 2, &k) != FIELD_OK) { continue; }
        if (slot >= 1 && slot <= 32 && k >= -7 && k <= 6) { h->glo_k[slot] = (int8_t)k; }
    }
}

static void position(rinex_header_t *h, line_t l)
{
    double r[3];
    for (size_t i = 0; i < 3; i++) {
        if (line_real(l, 14 * i, 14, &r[i]) != FIELD_OK) { return; }
    }
    const double norm = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
    if (norm < 6.3e6 || norm > 6.5e6) { return; } /* "0 0 0" says unknown */
    memcpy(h->r_marker_e, r, sizeof r);
    h->has_position = true;
}

bool rinex_header_record(rinex_header_t *h, line_t l, tally_t *tally)
{
    double v = 0.0;
    if (line_label(l, "SYS / # / OBS TYPES")) {
        obs_types_v3(h, l);
    } else if (line_label(l, "# / TYPES OF OBSERV")) {
        obs_types_v2(h, l);
    } else if (line_label(l, "SYS / SCALE FACTOR")) {
        scale_factor(h, l);
    } else if (line_label(l, "WAVELENGTH FACT L1/2")) {
        wavelength_factor(h, l);
    } else if (line_label(l, "GLONASS SLOT / FRQ #")) {
        glonass_slots(h, l);
    } else if (line_label(l, "APPROX POSITION XYZ")) {
        position(h, l);
    } else if (line_label(l, "ANTENNA: DELTA H/E/N")) {
        for (size_t i = 0; i < 3; i++) {
            if (line_real(l, 14 * i, 14, &v) == FIELD_OK && fabs(v) < 100.0) { h->delta_hen[i] = v; }
        }
    } else if (line_label(l, "TIME OF FIRST OBS")) {
        const char a = line_char(l, 48), b = line_char(l, 49);
        if (a == 'G' && b == 'P') { h->time_system = CLOCK_GPS; }
        if (a == 'G' && b == 'L') { h->time_system = CLOCK_UTC; }
        if (a == 'B' && b == 'D') { h->time_system = CLOCK_BDT; }
    } else if (line_label(l, "SIGNAL STRENGTH UNIT")) {
        h->strength_dbhz = (line_char(l, 0) == 'D');
    } else if (line_label(l, "SYS / PHASE SHIFT") || line_label(l, "SYS / PHASE SHIFTS")) {
        if (line_real(l, 6, 8, &v) == FIELD_OK && fabs(v) > 1e-9) {
            tally_add(tally, TALLY_NOTE, "non-zero SYS / PHASE SHIFT: phases are taken as aligned, as RINEX demands",
                      1);
        }
    } else if (line_label(l, "RCV CLOCK OFFS APPL") && line_char(l, 5) == '1') {
        tally_add(tally, TALLY_NOTE, "clock offset already applied to epochs, code and phase", 1);
    } else if (line_label(l, "SYS / DCBS APPLIED") || line_label(l, "SYS / PCVS APPLIED")) {
        tally_add(tally, TALLY_NOTE, "header says DCB or PCV corrections were applied", 1);
    }
    return line_label(l, "END OF HEADER");
}

static void read_version(rinex_header_t *h, line_t l)
{
    double version = 0.0;
    if (line_label(l, "RINEX VERSION / TYPE") && line_real(l, 0, 9, &version) == FIELD_OK && version < 100.0) {
        h->version_100 = (int)lround(version * 100.0);
        h->is_obs = (line_char(l, 20) == 'O');
        h->file_sys = (line_char(l, 40) == ' ') ? 'G' : line_char(l, 40);
        h->time_system = (h->file_sys == 'R') ? CLOCK_UTC : (h->file_sys == 'C') ? CLOCK_BDT : CLOCK_GPS;
        h->strength_dbhz =
            true; /* dB-Hz in practice also where RINEX 2 leaves it open; out of range is ignored later */
    }
}

bool rinex_header_read(rinex_header_t *h, lines_t *lines, tally_t *tally, const char **why)
{
    line_t l;
    memset(h, 0, sizeof *h);
    memset(h->glo_k, GLO_K_UNKNOWN, sizeof h->glo_k);
    if (!lines_next(lines, &l)) {
        *why = "empty file";
        return false;
    }
    read_version(h, l);
    if (line_label(l, "CRINEX VERS")) {
        *why = "Hatanaka-compressed RINEX: expand it first (crx2rnx)";
        return false;
    }
    if (h->version_100 < 200 || h->version_100 >= 400 || !h->is_obs) {
        *why = (h->version_100 == 0) ? "not a RINEX file"
               : h->is_obs           ? "RINEX version is neither 2 nor 3"
                                     : "a RINEX file, but not of observations";
        return false;
    }
    while (lines_next(lines, &l)) {
        if (!rinex_header_record(h, l, tally)) { continue; }
        int n = 0;
        for (int s = 0; s < PEL_N_SYS; s++) { n += h->n_columns[s]; }
        *why = "header names no observation types";
        return n > 0;
    }
    *why = "header has no end";
    return false;
}

bool rinex_header_station(const rinex_header_t *h, double r_ea_e[3])
{
    if (!h->has_position) { return false; }
    const double *r = h->r_marker_e;
    /* The delta is at most metres: geodetic up by one closed step (Bowring, 1976) is exact far below a millimetre. */
    const double a = 6378137.0, f = 1.0 / 298.257223563, b = a * (1.0 - f), e2 = f * (2.0 - f), ep2 = e2 / (1.0 - e2);
    const double p = hypot(r[0], r[1]);
    const double u = atan2(r[2] * a, p * b);
    const double lat = atan2(r[2] + ep2 * b * pow(sin(u), 3.0), p - e2 * a * pow(cos(u), 3.0));
    const double lon = atan2(r[1], r[0]);
    const double sl = sin(lat), cl = cos(lat), so = sin(lon), co = cos(lon);
    const double h_m = h->delta_hen[0], e_m = h->delta_hen[1], n_m = h->delta_hen[2];
    r_ea_e[0] = r[0] + cl * co * h_m - so * e_m - sl * co * n_m;
    r_ea_e[1] = r[1] + cl * so * h_m + co * e_m - sl * so * n_m;
    r_ea_e[2] = r[2] + sl * h_m + cl * n_m;
    return true;
}

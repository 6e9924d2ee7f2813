#include <string.h>

#include "pelorus/gnss.h"
#include "pelorus/math.h"

#define BOTH_SOURCES_S 7200.0 /* Galileo's two messages this near one another describe the same orbit */

static bool kepler_plausible(const pel_ephemeris_t *p)
{
    const double finite[] = {p->i0,  p->Omega0, p->omega, p->M0, p->dn,   p->cuc,       p->cus,   p->crc,
                             p->crs, p->cic,    p->cis,   p->e,  p->idot, p->Omega_dot, p->sqrt_a};
    for (size_t i = 0; i < sizeof finite / sizeof finite[0]; i++) {
        if (!pel_isfinite(finite[i])) { return false; }
    }
    return p->sqrt_a > 4000.0 && p->sqrt_a < 7000.0 && p->e >= 0.0 && p->e < 0.5 && pel_fabs(p->M0) < 10.0 &&
           pel_fabs(p->omega) < 10.0 && pel_fabs(p->Omega0) < 10.0 && pel_fabs(p->i0) < 4.0 && pel_fabs(p->dn) < 1e-6;
}

/* Circular orbits of 25 500 km at 3.1 to 3.9 km/s over ground; Sun and Moon pull with 5e-6 m/s^2 at most. */
static bool glonass_plausible(const pel_ephemeris_t *p)
{
    const double r = pel_norm3(p->glo.r_e);
    const double v = pel_norm3(p->glo.v_e);
    return r > 2.4e7 && r < 2.7e7 && v > 2000.0 && v < 5000.0 && pel_norm3(p->glo.a_e) < 1e-4 && p->glo.k >= -7 &&
           p->glo.k <= 6;
}

/* Elements that no satellite of these systems has stop here, so that nothing downstream meets a NaN or a crash orbit. */
static bool plausible(const pel_ephemeris_t *p)
{
    if (p->sys >= PEL_N_SYS || p->sys == PEL_SYS_SBS) { return false; }
    if (p->prn < 1 || p->prn > pel_sys_max_prn((pel_sys_t)p->sys)) { return false; }
    if (!pel_isfinite(p->af1) || !pel_isfinite(p->af2)) { return false; }
    const bool orbit = (p->sys == PEL_SYS_GLO) ? glonass_plausible(p) : kepler_plausible(p);
    return orbit && pel_fabs(p->af0) < 0.1 && pel_fabs(p->tgd_s[0]) < 1e-5 && pel_fabs(p->tgd_s[1]) < 1e-5 &&
           p->fit_s >= 0.0f && p->fit_s < 1e6f && p->sd_ura_m >= 0.0f && p->toe_ns > 0 && p->toc_ns > 0;
}

static bool same_satellite(const pel_ephemeris_t *a, const pel_ephemeris_t *b)
{
    return a->sys == b->sys && a->prn == b->prn;
}

void pel_orbits_init(pel_orbits_t *o)
{
    memset(o, 0, sizeof *o);
}

static bool has_newer(const pel_orbits_t *o, int i)
{
    for (int k = 0; k < o->n; k++) {
        if (same_satellite(&o->eph[k], &o->eph[i]) && o->eph[k].toe_ns > o->eph[i].toe_ns) { return true; }
    }
    return false;
}

/* Where an ephemeris may go in a full store: the oldest that a newer one of its satellite stands in for, else the oldest. */
static int dispensable(const pel_orbits_t *o)
{
    int best = 0;
    bool best_newer = false;
    for (int i = 0; i < o->n; i++) {
        const bool newer = has_newer(o, i);
        const bool older = o->eph[i].toe_ns < o->eph[best].toe_ns;
        if ((newer && !best_newer) || (newer == best_newer && older)) {
            best = i;
            best_newer = newer;
        }
    }
    return best;
}

pel_status_t pel_orbits_add(pel_orbits_t *o, const pel_ephemeris_t *eph)
{
    int of_sat = 0;
    int at = -1; /* oldest of the satellite, or what the newcomer replaces for certain */
    bool replace = false;

    if (!plausible(eph)) { return PEL_E_RANGE; }
    for (int i = 0; i < o->n && !replace; i++) {
        const pel_ephemeris_t *k = &o->eph[i];
        if (!same_satellite(k, eph)) { continue; }
        const bool same_time = pel_fabs(pel_time_diff_s(k->toe_ns, eph->toe_ns)) < BOTH_SOURCES_S;
        if (k->source < eph->source && same_time) { return PEL_OK; } /* I/NAV is there: F/NAV adds nothing */
        of_sat++;
        replace = k->source > eph->source || (k->source == eph->source && k->toe_ns == eph->toe_ns);
        if (replace || at < 0 || k->toe_ns < o->eph[at].toe_ns) { at = i; }
    }
    if (!replace && of_sat < 2) { at = (o->n < PEL_MAX_EPH) ? o->n++ : dispensable(o); }
    o->eph[at] = *eph;
    return PEL_OK;
}

static double usable_for_s(const pel_ephemeris_t *p)
{
    const double grace_s = 600.0;
    const double fit_s = (double)p->fit_s;
    if (fit_s > 0.0) { return fit_s + grace_s; }
    if (p->sys == PEL_SYS_GLO) { return 1200.0 + grace_s; }
    return ((p->sys == PEL_SYS_GAL) ? 14400.0 : 7200.0) + grace_s;
}

const pel_ephemeris_t *pel_orbits_find(const pel_orbits_t *o, uint8_t sys, uint8_t prn, pel_time_t t_ns)
{
    const pel_ephemeris_t *best = NULL;
    double best_s = 0.0;

    for (int i = 0; i < o->n; i++) {
        const pel_ephemeris_t *p = &o->eph[i];
        if (p->sys != sys || p->prn != prn) { continue; }
        const double age_s = pel_fabs(pel_time_diff_s(t_ns, p->toe_ns));
        if (age_s > usable_for_s(p)) { continue; }
        if (best == NULL || p->source < best->source || (p->source == best->source && age_s < best_s)) {
            best = p;
            best_s = age_s;
        }
    }
    return best;
}

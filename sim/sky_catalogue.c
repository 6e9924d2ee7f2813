/* sky_catalogue.c - three skies: 24 ideal circular orbits, a plausible one of four systems, three geostationary satellites.
 *
 * Semi-major axes, inclinations, planes and slots are the systems' published nominal ones; eccentricities, phases within a
 * slot, harmonic corrections, clocks and group delays are drawn once and for all within the range of real ones. */
#include "sky_catalogue.h"

#include <math.h>
#include <string.h>

#include "world.h"

#define A_GPS     26559.7e3
#define A_GALILEO 29600.318e3
#define A_BDS_MEO 27906.1e3
#define A_GEOSYNC 42164.17e3

enum { CATALOGUE_SEED = 20240101 };

typedef struct {
    sky_t *sky;
    const sky_config_t *cfg;
    pel_time_t t;
    rng_t rng;
} maker_t;

static double spread(maker_t *m, double half_width)
{
    return half_width * (2.0 * rng_uniform(&m->rng) - 1.0);
}

static pel_ephemeris_t *add(maker_t *m, pel_sys_t sys, int prn, double a, double inclination)
{
    sat_t *s = &m->sky->sats[m->sky->n];
    memset(s, 0, sizeof *s);
    pel_ephemeris_t *e = &s->eph;
    e->sys = (uint8_t)sys;
    e->prn = (uint8_t)prn;
    e->sqrt_a = sqrt(a);
    e->i0 = inclination;
    e->sd_ura_m = 2.0f;
    e->fit_s = 7200.0f;
    e->toe_ns = m->t / PEL_NS_PER_S * PEL_NS_PER_S;
    e->toc_ns = e->toe_ns;
    if (m->cfg->systems[sys]) { m->sky->n++; } /* else the next one overwrites it: draws stay where they were */
    return e;
}

/* What real orbits have beside the ellipse. */
static void perturb(maker_t *m, pel_ephemeris_t *e)
{
    e->dn = 4.5e-9 + spread(m, 0.5e-9);
    e->idot = spread(m, 3e-10);
    e->cuc = spread(m, 4e-6);
    e->cus = 7e-6 + spread(m, 4e-6);
    e->crc = 220.0 + spread(m, 100.0);
    e->crs = spread(m, 90.0);
    e->cic = spread(m, 1.5e-7);
    e->cis = spread(m, 1.5e-7);
}

static void clock_of(maker_t *m, pel_ephemeris_t *e)
{
    const double af0 = spread(m, 4e-4);
    const double af1 = spread(m, 8e-12);
    const double delay[2] = {spread(m, 8e-9), spread(m, 8e-9)};
    if (!m->cfg->clocks) { return; }
    e->af0 = af0;
    e->af1 = af1;
    e->tgd_s[0] = delay[0];
    switch (e->sys) {
    case PEL_SYS_GAL: e->tgd_s[1] = delay[0] + 0.05 * delay[1]; break; /* E5a and E5b share most of their path */
    case PEL_SYS_BDS: e->tgd_s[1] = delay[1]; break;
    default: e->tgd_s[1] = 0.0; break;
    }
}

static double tow_bdt(pel_time_t t)
{
    return pel_time_tow_s(t - 14 * PEL_NS_PER_S);
}

/* Walker-like shells: planes spread evenly, a phase shift from plane to plane. */
static void shell(maker_t *m, pel_sys_t sys, const uint8_t *prn, int n, int planes, double phase, double a,
                  double inclination, double e_max, double jitter)
{
    const int slots = (n + planes - 1) / planes;
    for (int k = 0; k < n; k++) {
        const int p = k % planes;
        const int slot = k / planes;
        pel_ephemeris_t *e = add(m, sys, prn[k], a, inclination + spread(m, 0.6 * WORLD_DEG));
        e->e = 1e-4 + 0.5 * (e_max + spread(m, e_max));
        e->omega = spread(m, 0.5 * WORLD_TWO_PI);
        e->Omega0 = WORLD_TWO_PI * p / planes + spread(m, 2.0 * WORLD_DEG);
        e->M0 = WORLD_TWO_PI * slot / slots + phase * p + spread(m, jitter) - e->omega;
        e->Omega_dot = -7.5e-9 + spread(m, 1e-9);
        perturb(m, e);
        clock_of(m, e);
    }
}

/* Inclined geosynchronous: crosses the equator northward at this longitude; u is its argument of latitude now. */
static void geosynchronous(maker_t *m, pel_sys_t sys, int prn, double longitude, double u, double inclination,
                           double ecc, double omega)
{
    pel_ephemeris_t *e = add(m, sys, prn, A_GEOSYNC, inclination);
    const double tow = (sys == PEL_SYS_BDS) ? tow_bdt(e->toe_ns) : pel_time_tow_s(e->toe_ns);
    e->e = ecc;
    e->omega = omega;
    e->M0 = u - omega;
    e->Omega0 = longitude - u + 7.292115e-5 * tow;
    e->Omega_dot = -2.0e-9;
    clock_of(m, e);
}

/* BeiDou GEO in the frame of its interface document, tilted by 5 degrees: an equatorial orbit has its node at 180 degrees. */
static void geostationary(maker_t *m, int prn, double longitude)
{
    pel_ephemeris_t *e = add(m, PEL_SYS_BDS, prn, A_GEOSYNC, 5.0 * WORLD_DEG);
    m->sky->sats[m->sky->n - (m->cfg->systems[PEL_SYS_BDS] ? 1 : 0)].geostationary = true;
    e->e = 3e-4;
    e->omega = spread(m, 0.5 * WORLD_TWO_PI);
    e->Omega0 = 0.5 * WORLD_TWO_PI + 7.292115e-5 * tow_bdt(e->toe_ns);
    e->M0 = longitude - 0.5 * WORLD_TWO_PI - e->omega;
    clock_of(m, e);
}

static void multi(maker_t *m)
{
    uint8_t prn[32];
    int n = 0;
    for (int p = 1; p <= 32; p++) {
        if (p != 22) { prn[n++] = (uint8_t)p; }
    }
    shell(m, PEL_SYS_GPS, prn, 31, 6, 25.0 * WORLD_DEG, A_GPS, 55.2 * WORLD_DEG, 0.012, 12.0 * WORLD_DEG);
    for (int p = 0; p < 24; p++) { prn[p] = (uint8_t)(p + 1); }
    shell(m, PEL_SYS_GAL, prn, 24, 3, 15.0 * WORLD_DEG, A_GALILEO, 56.3 * WORLD_DEG, 5e-4, 1.0 * WORLD_DEG);
    static const uint8_t meo[24] = {11, 12, 14, 19, 20, 21, 22, 23, 24, 25, 26, 27,
                                    28, 29, 30, 32, 33, 34, 35, 36, 37, 41, 42, 43};
    shell(m, PEL_SYS_BDS, meo, 24, 3, 15.0 * WORLD_DEG, A_BDS_MEO, 55.1 * WORLD_DEG, 1e-3, 2.0 * WORLD_DEG);
    static const uint8_t igso[7] = {6, 7, 8, 9, 10, 13, 16};
    static const double igso_lon[7] = {118.0, 118.0, 118.0, 95.0, 95.0, 95.0, 115.0};
    for (int k = 0; k < 7; k++) {
        geosynchronous(m, PEL_SYS_BDS, igso[k], igso_lon[k] * WORLD_DEG,
                       (120.0 * k + ((k < 3)   ? 0.0
                                     : (k < 6) ? 17.0
                                               : 34.0)) *
                           WORLD_DEG,
                       55.0 * WORLD_DEG, 0.004, spread(m, 3.0));
    }
    static const double geo_lon[5] = {140.0, 80.0, 110.5, 160.0, 58.75};
    for (int k = 0; k < 5; k++) { geostationary(m, k + 1, geo_lon[k] * WORLD_DEG); }
    for (int k = 0; k < 3; k++) { /* eccentric, lingering in the north */
        geosynchronous(m, PEL_SYS_QZS, (k < 2) ? k + 1 : 4, 135.0 * WORLD_DEG, (90.0 + 120.0 * k) * WORLD_DEG,
                       41.0 * WORLD_DEG, 0.075, 270.0 * WORLD_DEG);
    }
    geosynchronous(m, PEL_SYS_QZS, 3, 127.0 * WORLD_DEG, 0.3, 0.05 * WORLD_DEG, 2e-4, 1.0);
}

static void geo3(maker_t *m)
{
    static const double longitude[3] = {140.0, 80.0, 110.5}; /* prn as in multi() */
    for (int k = 0; k < 3; k++) { geostationary(m, k + 1, longitude[k] * WORLD_DEG); }
}

static void ideal24(maker_t *m)
{
    const double a = 26560e3;
    const double n = sqrt(3.986005e14 / a) / a;
    for (int k = 0; k < 24; k++) {
        const int p = k / 4;
        const int s = k % 4;
        pel_ephemeris_t *e = add(m, PEL_SYS_GPS, k + 1, a, 55.0 * WORLD_DEG);
        e->Omega0 = 60.0 * p * WORLD_DEG;
        e->M0 = (90.0 * s + 30.0 * p + 7.0 * s * p) * WORLD_DEG + n * pel_time_tow_s(e->toe_ns);
        clock_of(m, e);
    }
}

void sky_catalogue(sky_t *sky, const sky_config_t *cfg, pel_time_t t)
{
    maker_t m = {.sky = sky, .cfg = cfg, .t = t};
    rng_init(&m.rng, CATALOGUE_SEED, 0);
    sky->n = 0;
    switch (cfg->kind) {
    case SKY_IDEAL24: ideal24(&m); break;
    case SKY_MULTI: multi(&m); break;
    case SKY_GEO3: geo3(&m); break;
    }
}

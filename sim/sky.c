/* sky.c - orbits and clocks. Which satellites there are: sky_catalogue.c.
 *
 * User algorithms of IS-GPS-200 (20.3.3.4.3), Galileo OS SIS ICD (5.1.1) and BeiDou BDS-SIS-ICD-B1I (5.2.4.12). */
#include "sky.h"

#include <math.h>

#include "sky_catalogue.h"
#include "world.h"

#define ISSUE_S      7200 /* a new ephemeris every so often */
#define GEO_TILT     (-5.0 * WORLD_DEG)
#define BDT_BEHIND_S 14
#define OMEGA_GPS    7.2921151467e-5
#define OMEGA_BDS    7.2921150e-5
#define MU_GPS       3.986005e14
#define MU_OTHERS    3.986004418e14

enum { CAUSE_ORBIT = 21 };

static double mu_of(uint8_t sys)
{
    return (sys == PEL_SYS_GPS || sys == PEL_SYS_QZS) ? MU_GPS : MU_OTHERS;
}

static double earth_rate_of(uint8_t sys)
{
    return (sys == PEL_SYS_BDS) ? OMEGA_BDS : OMEGA_GPS;
}

/* Seconds into the week of the system's own time scale. */
static double own_tow(uint8_t sys, pel_time_t t)
{
    return pel_time_tow_s(t - ((sys == PEL_SYS_BDS) ? BDT_BEHIND_S * PEL_NS_PER_S : 0));
}

/* Round to a multiple of 2^exponent, in the unit given. */
static double step(double x, double unit, int exponent)
{
    return ldexp(round(ldexp(x / unit, -exponent)), exponent) * unit;
}

static double wrap(double angle)
{
    return remainder(angle, WORLD_TWO_PI);
}

/* The coarsest steps of the four systems' messages (GPS LNAV), which the others contain. */
static void round_to_message(pel_ephemeris_t *e)
{
    const double semicircle = 0.5 * WORLD_TWO_PI;
    e->sqrt_a = step(e->sqrt_a, 1.0, -19);
    e->e = step(e->e, 1.0, -33);
    e->i0 = step(wrap(e->i0), semicircle, -31);
    e->Omega0 = step(wrap(e->Omega0), semicircle, -31);
    e->omega = step(wrap(e->omega), semicircle, -31);
    e->M0 = step(wrap(e->M0), semicircle, -31);
    e->dn = step(e->dn, semicircle, -43);
    e->Omega_dot = step(e->Omega_dot, semicircle, -43);
    e->idot = step(e->idot, semicircle, -43);
    double *const harmonic[4] = {&e->cuc, &e->cus, &e->cic, &e->cis};
    for (int i = 0; i < 4; i++) { *harmonic[i] = step(*harmonic[i], 1.0, -29); }
    e->crc = step(e->crc, 1.0, -5);
    e->crs = step(e->crs, 1.0, -5);
    e->af0 = step(e->af0, 1.0, -31);
    e->af1 = step(e->af1, 1.0, -43);
    e->af2 = step(e->af2, 1.0, -55);
    for (int i = 0; i < 2; i++) {
        e->tgd_s[i] = (e->sys == PEL_SYS_BDS) ? 1e-10 * round(1e10 * e->tgd_s[i]) : step(e->tgd_s[i], 1.0, -31);
    }
}

/* Reference time of the issue in force at t. */
static pel_time_t toe_at(uint8_t sys, pel_time_t t)
{
    const pel_time_t issue = ISSUE_S * PEL_NS_PER_S;
    const pel_time_t shift = (sys == PEL_SYS_BDS) ? BDT_BEHIND_S * PEL_NS_PER_S : 0;
    return (t - shift + issue / 2) / issue * issue + shift;
}

/* The same orbit and clock, referred to another toe. */
static void refer_to(const sat_t *s, pel_time_t toe, pel_ephemeris_t *e)
{
    *e = s->eph;
    const double dt = pel_time_diff_s(toe, s->eph.toe_ns);
    const double a = e->sqrt_a * e->sqrt_a;
    const double rate = earth_rate_of(e->sys);
    const double dtow = own_tow(e->sys, toe) - own_tow(e->sys, s->eph.toe_ns); /* differs from dt across a week */
    e->M0 += (sqrt(mu_of(e->sys) / a) / a + e->dn) * dt;
    e->i0 += e->idot * dt;
    if (s->geostationary) {
        e->Omega0 += rate * dtow;
        e->omega -= rate * dt;
    } else {
        e->Omega0 += e->Omega_dot * dt + rate * (dtow - dt);
    }
    e->af0 += e->af1 * dt;
    e->toe_ns = toe;
    e->toc_ns = toe;
    const uint16_t issue = (uint16_t)((int64_t)own_tow(e->sys, toe) / ISSUE_S); /* 0..83 */
    e->iode = (e->sys == PEL_SYS_BDS) ? (uint16_t)(issue % 24u) : (uint16_t)(issue + 1u);
    e->iodc = e->iode;
}

void sky_init(sky_t *sky, const sky_config_t *cfg, pel_time_t t, uint64_t seed)
{
    rng_t rng;
    rng_init(&rng, seed, CAUSE_ORBIT);
    sky_catalogue(sky, cfg, t);
    for (int i = 0; i < sky->n; i++) {
        sat_t *s = &sky->sats[i];
        pel_ephemeris_t e;
        refer_to(s, toe_at(s->eph.sys, t), &e);
        round_to_message(&e);
        s->eph = e;
        for (int k = 0; k < 3; k++) { s->offset_e[k] = cfg->orbit_error_m * rng_normal(&rng); }
        s->clock_error_s = cfg->clock_error_m / WORLD_C * rng_normal(&rng);
    }
}

void sky_ephemeris(const sat_t *s, pel_time_t t, pel_ephemeris_t *out)
{
    refer_to(s, toe_at(s->eph.sys, t), out);
    round_to_message(out);
}

/* Rotate a position and velocity about the third axis by an angle that grows at a rate: frame rotation. */
static void turn_frame(double angle, double rate, double r[3], double v[3])
{
    const double s = sin(angle);
    const double c = cos(angle);
    const double x = c * r[0] + s * r[1];
    const double y = -s * r[0] + c * r[1];
    const double vx = c * v[0] + s * v[1] + rate * y;
    const double vy = -s * v[0] + c * v[1] - rate * x;
    r[0] = x;
    r[1] = y;
    v[0] = vx;
    v[1] = vy;
}

static void tilt_frame(double angle, double r[3])
{
    const double s = sin(angle);
    const double c = cos(angle);
    const double y = c * r[1] + s * r[2];
    r[2] = -s * r[1] + c * r[2];
    r[1] = y;
}

void sky_state(const sat_t *sat, pel_time_t t_ns, double dt_s, sat_state_t *out)
{
    const pel_ephemeris_t *e = &sat->eph;
    const double mu = mu_of(e->sys);
    const double rate = earth_rate_of(e->sys);
    const double tk = pel_time_diff_s(t_ns, e->toe_ns) + dt_s;
    const double a = e->sqrt_a * e->sqrt_a;
    const double n = sqrt(mu / a) / a + e->dn;
    const double M = e->M0 + n * tk;
    double E = M;
    for (int i = 0; i < 12; i++) { E -= (E - e->e * sin(E) - M) / (1.0 - e->e * cos(E)); }
    const double se = sin(E);
    const double ce = cos(E);
    const double q = 1.0 - e->e * ce;
    const double root = sqrt(1.0 - e->e * e->e);
    const double dE = n / q;
    const double phi = atan2(root * se, ce - e->e) + e->omega;
    const double dphi = root * dE / q;
    const double s2 = sin(2.0 * phi);
    const double c2 = cos(2.0 * phi);
    const double u = phi + e->cus * s2 + e->cuc * c2;
    const double du = dphi * (1.0 + 2.0 * (e->cus * c2 - e->cuc * s2));
    const double r = a * q + e->crs * s2 + e->crc * c2;
    const double dr = a * e->e * se * dE + 2.0 * dphi * (e->crs * c2 - e->crc * s2);
    const double i = e->i0 + e->idot * tk + e->cis * s2 + e->cic * c2;
    const double di = e->idot + 2.0 * dphi * (e->cis * c2 - e->cic * s2);

    const double x = r * cos(u);
    const double y = r * sin(u);
    const double vx = dr * cos(u) - y * du;
    const double vy = dr * sin(u) + x * du;
    out->r_e[0] = x;
    out->r_e[1] = y * cos(i);
    out->r_e[2] = y * sin(i);
    out->v_e[0] = vx;
    out->v_e[1] = vy * cos(i) - y * sin(i) * di;
    out->v_e[2] = vy * sin(i) + y * cos(i) * di;
    const double node = e->Omega0 - rate * own_tow(e->sys, e->toe_ns);
    if (sat->geostationary) {
        turn_frame(-(node + e->Omega_dot * tk), -e->Omega_dot, out->r_e, out->v_e);
        tilt_frame(GEO_TILT, out->r_e);
        tilt_frame(GEO_TILT, out->v_e);
        turn_frame(rate * tk, rate, out->r_e, out->v_e);
    } else {
        const double node_rate = e->Omega_dot - rate;
        turn_frame(-(node + node_rate * tk), -node_rate, out->r_e, out->v_e);
    }
    for (int k = 0; k < 3; k++) { out->r_e[k] += sat->offset_e[k]; }

    const double relativity = -2.0 * sqrt(mu) * e->e * e->sqrt_a / (WORLD_C * WORLD_C);
    const double tc = pel_time_diff_s(t_ns, e->toc_ns) + dt_s;
    out->clock_s = e->af0 + tc * (e->af1 + tc * e->af2) + relativity * se + sat->clock_error_s;
    out->clock_rate = e->af1 + 2.0 * tc * e->af2 + relativity * ce * dE;
}

double sky_group_delay(const sat_t *s, pel_carrier_t carrier)
{
    const pel_ephemeris_t *e = &s->eph;
    const double f1 = pel_carrier_hz(PEL_SYS_GPS, PEL_CARRIER_L1, 0);
    const double f = pel_carrier_hz((pel_sys_t)e->sys, carrier, 0);
    const double gamma = (f > 0.0) ? f1 * f1 / (f * f) : 1.0;
    switch (e->sys) {
    case PEL_SYS_GPS:
    case PEL_SYS_QZS: return gamma * e->tgd_s[0];
    case PEL_SYS_GAL: /* the clock is that of E1/E5b; E5a follows from E1 being one and the same signal */
        if (carrier == PEL_CARRIER_L5) { return e->tgd_s[1] - e->tgd_s[0] + gamma * e->tgd_s[0]; }
        return gamma * e->tgd_s[1];
    case PEL_SYS_BDS: /* the clock is that of B3I */
        if (carrier == PEL_CARRIER_B1I) { return e->tgd_s[0]; }
        return (carrier == PEL_CARRIER_E5B) ? e->tgd_s[1] : 0.0;
    default: return 0.0;
    }
}

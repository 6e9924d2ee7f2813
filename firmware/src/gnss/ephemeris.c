#include "pelorus/gnss.h"
#include "pelorus/math.h"

#include "glonass.h"

/* Constants of the interface documents; they belong to the orbits' fits and differ from WGS-84's by design. */
#define MU_GPS       3.9860050e14
#define MU_GAL_BDS   3.986004418e14
#define OMEGA_GPS    7.2921151467e-5 /* GPS, QZSS, Galileo */
#define OMEGA_BDS    7.292115e-5
#define BDT_LAG_NS   (14 * PEL_NS_PER_S)     /* GPS time - BeiDou time */
#define SIN_GEO      (-0.087155742747658174) /* sin, cos of -5 degrees */
#define COS_GEO      0.99619469809174555
#define KEPLER_STEPS 10

/* The orbit in its own plane: argument of latitude u, radius r, inclination i and their derivatives by time. */
typedef struct {
    double u, r, i;
    double u_dot, r_dot, i_dot;
    double relativity_s, relativity_rate;
} plane_t;

static bool is_bds_geo(const pel_ephemeris_t *p)
{
    return p->sys == PEL_SYS_BDS && (p->prn <= 5 || p->prn >= 59);
}

/* Kepler's equation by Newton from E = M + e sin M. Quadratic: 3 or 4 steps for e < 0.1; bounded for any e < 0.5. */
static bool solve_kepler(double M, double e, double *sin_E, double *cos_E)
{
    double E = M + e * pel_sin(M);
    for (int k = 0; k < KEPLER_STEPS; k++) {
        pel_sincos(E, sin_E, cos_E);
        const double step = (E - e * *sin_E - M) / (1.0 - e * *cos_E);
        E -= step;
        if (pel_fabs(step) < 1e-9) { /* the step after this one would be below 1e-18 */
            pel_sincos(E, sin_E, cos_E);
            return true;
        }
    }
    return false;
}

/* IS-GPS-200 table 20-IV, and its derivative line by line. */
static pel_status_t orbit_in_plane(const pel_ephemeris_t *p, double mu, double tk, plane_t *o)
{
    const double a = p->sqrt_a * p->sqrt_a;
    const double n = pel_sqrt(mu / (a * a * a)) + p->dn;
    const double M = p->M0 + n * tk;
    double sin_E;
    double cos_E;
    double s2;
    double c2;

    if (!(pel_fabs(M) < 1e3)) { return PEL_E_RANGE; }
    if (!solve_kepler(M, p->e, &sin_E, &cos_E)) { return PEL_E_NO_CONVERGENCE; }

    const double g = 1.0 - p->e * cos_E;
    const double E_dot = n / g;
    const double root = pel_sqrt(1.0 - p->e * p->e);
    const double phi = pel_atan2(root * sin_E, cos_E - p->e) + p->omega;
    const double phi_dot = root * E_dot / g;
    pel_sincos(2.0 * phi, &s2, &c2);
    const double s2_dot = 2.0 * c2 * phi_dot;
    const double c2_dot = -2.0 * s2 * phi_dot;

    o->u = phi + p->cus * s2 + p->cuc * c2;
    o->r = a * g + p->crs * s2 + p->crc * c2;
    o->i = p->i0 + p->idot * tk + p->cis * s2 + p->cic * c2;
    o->u_dot = phi_dot + p->cus * s2_dot + p->cuc * c2_dot;
    o->r_dot = a * p->e * sin_E * E_dot + p->crs * s2_dot + p->crc * c2_dot;
    o->i_dot = p->idot + p->cis * s2_dot + p->cic * c2_dot;

    /* Relativity of an eccentric orbit: -2 r.v / c^2. */
    const double F = -2.0 * pel_sqrt(mu) / (PEL_SPEED_OF_LIGHT * PEL_SPEED_OF_LIGHT);
    o->relativity_s = F * p->e * p->sqrt_a * sin_E;
    o->relativity_rate = F * p->e * p->sqrt_a * cos_E * E_dot;
    return PEL_OK;
}

/* From the plane to axes whose node stands at Omega and moves by Omega_dot. */
static void plane_to_axes(const plane_t *o, double Omega, double Omega_dot, double r[3], double v[3])
{
    double sin_u;
    double cos_u;
    double sin_i;
    double cos_i;
    double sin_O;
    double cos_O;
    pel_sincos(o->u, &sin_u, &cos_u);
    pel_sincos(o->i, &sin_i, &cos_i);
    pel_sincos(Omega, &sin_O, &cos_O);

    const double x = o->r * cos_u;
    const double y = o->r * sin_u;
    const double x_dot = o->r_dot * cos_u - y * o->u_dot;
    const double y_dot = o->r_dot * sin_u + x * o->u_dot;
    const double across_dot = y_dot * cos_i - y * sin_i * o->i_dot;

    r[0] = x * cos_O - y * cos_i * sin_O;
    r[1] = x * sin_O + y * cos_i * cos_O;
    r[2] = y * sin_i;
    v[0] = x_dot * cos_O - across_dot * sin_O - Omega_dot * r[1];
    v[1] = x_dot * sin_O + across_dot * cos_O + Omega_dot * r[0];
    v[2] = y_dot * sin_i + y * cos_i * o->i_dot;
}

/* BDS-SIS-ICD-B1I table 5-11: a GEO's elements refer to an equator tilted by -5 degrees that does not turn. */
static void geo_to_ecef(double tk, double r[3], double v[3])
{
    double s;
    double c;
    pel_sincos(OMEGA_BDS * tk, &s, &c);
    const double tilted_r[3] = {r[0], COS_GEO * r[1] + SIN_GEO * r[2], -SIN_GEO * r[1] + COS_GEO * r[2]};
    const double tilted_v[3] = {v[0], COS_GEO * v[1] + SIN_GEO * v[2], -SIN_GEO * v[1] + COS_GEO * v[2]};

    r[0] = c * tilted_r[0] + s * tilted_r[1];
    r[1] = -s * tilted_r[0] + c * tilted_r[1];
    r[2] = tilted_r[2];
    v[0] = c * tilted_v[0] + s * tilted_v[1] + OMEGA_BDS * r[1];
    v[1] = -s * tilted_v[0] + c * tilted_v[1] - OMEGA_BDS * r[0];
    v[2] = tilted_v[2];
}

pel_status_t pel_sat_state(const pel_ephemeris_t *eph, pel_time_t t_ns, double dt_s, pel_sat_state_t *out)
{
    const bool bds = (eph->sys == PEL_SYS_BDS);
    const double mu = (bds || eph->sys == PEL_SYS_GAL) ? MU_GAL_BDS : MU_GPS;
    const double omega_ie = bds ? OMEGA_BDS : OMEGA_GPS;
    const double tk = pel_time_diff_s(t_ns, eph->toe_ns) + dt_s;
    const double tc = pel_time_diff_s(t_ns, eph->toc_ns) + dt_s;
    /* The node is given at the start of the system's own week. */
    const double toe_s = pel_time_tow_s(bds ? (eph->toe_ns - BDT_LAG_NS) : eph->toe_ns);
    plane_t plane;

    if (eph->sys == PEL_SYS_GLO) { return pel_glo_state(eph, tk, out); }
    if (!(eph->sqrt_a > 1000.0) || !(eph->e >= 0.0 && eph->e < 0.5)) { return PEL_E_RANGE; }
    const pel_status_t status = orbit_in_plane(eph, mu, tk, &plane);
    if (status != PEL_OK) { return status; }

    const double Omega = eph->Omega0 + eph->Omega_dot * tk - omega_ie * toe_s;
    if (is_bds_geo(eph)) {
        plane_to_axes(&plane, Omega, eph->Omega_dot, out->r_e, out->v_e);
        geo_to_ecef(tk, out->r_e, out->v_e);
    } else {
        plane_to_axes(&plane, Omega - omega_ie * tk, eph->Omega_dot - omega_ie, out->r_e, out->v_e);
    }
    out->clk_s = eph->af0 + (eph->af1 + eph->af2 * tc) * tc + plane.relativity_s;
    out->clk_rate = eph->af1 + 2.0 * eph->af2 * tc + plane.relativity_rate;
    return PEL_OK;
}

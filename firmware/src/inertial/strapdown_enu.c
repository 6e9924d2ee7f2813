/* strapdown_enu.c - one increment of attitude, velocity and position in local east-north-up axes (S2 section 5). */
#include "increments.h"
#include "pelorus/earth.h"

/* What a place alone decides. */
typedef struct {
    double sin_lat, cos_lat;
    double M, N;     /* radii of curvature plus height, m */
    double g_enu[3]; /* m/s^2 */
} place_t;

static void place_at(double lat, double h, place_t *p)
{
    pel_sincos(lat, &p->sin_lat, &p->cos_lat);
    double R_M;
    double R_N;
    pel_earth_radii_at(p->sin_lat, &R_M, &R_N);
    p->M = R_M + h;
    p->N = R_N + h;
    /* gravity does not depend on longitude: take the meridian of Greenwich */
    const double r_e[3] = {p->N * p->cos_lat, 0.0, (R_N * (1.0 - PEL_WGS84_E2) + h) * p->sin_lat};
    double g_e[3];
    pel_earth_gravity_e(r_e, g_e);
    p->g_enu[0] = 0.0;
    p->g_enu[1] = p->cos_lat * g_e[2] - p->sin_lat * g_e[0];
    p->g_enu[2] = p->cos_lat * g_e[0] + p->sin_lat * g_e[2];
}

/* omega_in of the local axes, and w_c = omega_in + omega_ie, which goes with velocity. */
static void rates_at(const place_t *p, const double v[3], double w_in[3], double w_c[3])
{
    const double w_n = PEL_OMEGA_IE * p->cos_lat;
    const double w_u = PEL_OMEGA_IE * p->sin_lat;
    w_in[0] = -v[1] / p->M;
    w_in[1] = w_n + v[0] / p->N;
    w_in[2] = w_u + v[0] * p->sin_lat / (p->N * p->cos_lat);
    w_c[0] = w_in[0];
    w_c[1] = w_in[1] + w_n;
    w_c[2] = w_in[2] + w_u;
}

/* a = g - w_c x v */
static void fall(const place_t *p, const double w_c[3], const double v[3], double a[3])
{
    double coriolis[3];
    pel_cross3(w_c, v, coriolis);
    for (int i = 0; i < 3; i++) { a[i] = p->g_enu[i] - coriolis[i]; }
}

/* C <- exp(-[turn x]) C exp([phi x]) */
static void turn_attitude(double C[3][3], const double turn[3], const double phi[3])
{
    const double back[3] = {-turn[0], -turn[1], -turn[2]};
    pel_dcm_turn_from(C, phi);
    pel_dcm_turn_to(C, back);
}

static bool inside(double lat)
{
    return (lat <= PEL_ENU_MAX_LAT) && (lat >= -PEL_ENU_MAX_LAT); /* false for NaN */
}

/* Velocity over the step: the mean acceleration at mid step; dv_f gets the specific force's share, w_in the mean rate of the axes. */
static void change_velocity(const place_t *mid, const double f[3], double dt_s, double v[3], double dv_f[3],
                            double w_in[3])
{
    double w_c[3];
    double a[3];
    double v_mid[3];
    double turned[3];
    rates_at(mid, v, w_in, w_c);
    fall(mid, w_c, v, a);
    for (int i = 0; i < 3; i++) { v_mid[i] = v[i] + 0.5 * (f[i] + a[i] * dt_s); }
    rates_at(mid, v_mid, w_in, w_c);
    fall(mid, w_c, v_mid, a);
    pel_cross3(w_in, f, turned);
    for (int i = 0; i < 3; i++) {
        dv_f[i] = f[i] - 0.5 * dt_s * turned[i]; /* the axes turn by half while the increment grows */
        v[i] += dv_f[i] + a[i] * dt_s;
    }
}

pel_status_t pel_strapdown_enu_step(pel_strapdown_enu_t *s, pel_coning_t *c, const double alpha[3],
                                    const double upsilon[3], double dt_s, pel_time_t t_end)
{
    double phi[3];
    double dv_b[3];
    double f[3];
    double w_in[3];
    pel_strapdown_enu_t next = *s;
    pel_coning_t coning = *c;
    place_t mid;
    correct_increments(c, coning_factor(c->dt_s, dt_s), alpha, upsilon, phi, dv_b);
    remember(&coning, alpha, upsilon, dt_s);

    /* a sphere is good enough for where mid step is: what depends on it changes by 1e-9 for that */
    const double lat_mid = s->lat + 0.5 * dt_s * s->v_eb_enu[1] / (PEL_WGS84_A + s->h);
    if (!inside(lat_mid)) { return PEL_E_RANGE; }
    place_at(lat_mid, s->h + 0.5 * dt_s * s->v_eb_enu[2], &mid);

    pel_mat3_vec(s->C_b_enu, dv_b, f);
    change_velocity(&mid, f, dt_s, next.v_eb_enu, coning.dv_f_e, w_in);
    const double half = 0.5 * dt_s;
    next.lat += half * (s->v_eb_enu[1] + next.v_eb_enu[1]) / mid.M;
    next.lon = pel_wrap_pi(s->lon + half * (s->v_eb_enu[0] + next.v_eb_enu[0]) / (mid.N * mid.cos_lat));
    next.h += half * (s->v_eb_enu[2] + next.v_eb_enu[2]);
    if (!inside(next.lat) || !pel_isfinite(next.lon) || !pel_isfinite(next.h)) { return PEL_E_RANGE; }

    const double turn[3] = {w_in[0] * dt_s, w_in[1] * dt_s, w_in[2] * dt_s};
    turn_attitude(next.C_b_enu, turn, phi);
    next.t_ns = t_end;
    *s = next;
    *c = coning;
    return PEL_OK;
}

pel_status_t pel_strapdown_to_enu(const pel_strapdown_t *s, pel_strapdown_enu_t *out)
{
    double lat;
    double lon;
    double h;
    double C_e_enu[3][3];
    pel_earth_ecef_to_llh(s->r_eb_e, &lat, &lon, &h);
    if (!inside(lat)) { return PEL_E_RANGE; }
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    out->t_ns = s->t_ns;
    pel_mat3_mul(C_e_enu, s->C_b_e, out->C_b_enu);
    pel_mat3_vec(C_e_enu, s->v_eb_e, out->v_eb_enu);
    out->lat = lat;
    out->lon = lon;
    out->h = h;
    return PEL_OK;
}

void pel_strapdown_from_enu(const pel_strapdown_enu_t *s, pel_strapdown_t *out)
{
    double C_e_enu[3][3];
    pel_earth_C_e_enu(s->lat, s->lon, C_e_enu);
    out->t_ns = s->t_ns;
    pel_mat3_tmul(C_e_enu, s->C_b_enu, out->C_b_e);
    pel_mat3_tvec(C_e_enu, s->v_eb_enu, out->v_eb_e);
    pel_earth_llh_to_ecef(s->lat, s->lon, s->h, out->r_eb_e);
}

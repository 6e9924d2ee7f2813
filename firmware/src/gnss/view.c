#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/gnss.h"
#include "pelorus/math.h"

#include "group_delay.h"
#include "view_internal.h"

#define C PEL_SPEED_OF_LIGHT
#define SD_BROADCAST                                                                                                   \
    0.25f /* of Klobuchar's delay: its error is half of it, and half of that common to all satellites */
#define SD_NOMINAL 0.5f
#define URA_TO_SD  0.5f /* broadcast URA is a bound; measured ranging errors are a third of it or less */

bool pel_view_near_earth(const double r_e[3])
{
    const double r = pel_norm3(r_e);
    return r > 6.3e6 && r < 7.4e6; /* false for NaN */
}

/* The satellite when it sent what the receiver tagged: tag - P/c is that instant by the satellite's clock. Leaving
 * relativity out of that clock moves the satellite by 0.2 mm at most, the same for two receivers. */
static bool satellite_at_transmission(pel_time_t tag_ns, double P_m, const pel_ephemeris_t *eph, pel_sight_t *s)
{
    pel_sat_state_t state;
    const double by_clock_s = -P_m / C;
    const double tc = pel_time_diff_s(tag_ns, eph->toc_ns) + by_clock_s;
    const double clk_s = eph->af0 + (eph->af1 + eph->af2 * tc) * tc;

    if (pel_sat_state(eph, tag_ns, by_clock_s - clk_s, &state) != PEL_OK) { return false; }
    memset(s, 0, sizeof *s);
    s->sys = eph->sys;
    s->prn = eph->prn;
    s->source = eph->source;
    s->iode = eph->iode;
    s->toe_gps_s = (uint32_t)(eph->toe_ns / PEL_NS_PER_S);
    s->sd_eph_m = URA_TO_SD * eph->sd_ura_m;
    s->tgd_m[0] = (float)(C * eph->tgd_s[0]);
    s->tgd_m[1] = (float)(C * eph->tgd_s[1]);
    for (int k = 0; k < 3; k++) {
        s->r_s_e[k] = state.r_e[k];
        s->v_s_e[k] = state.v_e[k];
    }
    s->clk_m = C * state.clk_s;
    s->clk_rate_mps = C * state.clk_rate;
    return true;
}

/* QZSS: the lowest bit speaks of a signal not used here (L1C/B or L6; IS-QZSS-PNT 5.4.1). */
static bool healthy(const pel_ephemeris_t *eph)
{
    return (eph->sys == PEL_SYS_QZS) ? (eph->health & 0xFEu) == 0u : eph->health == 0u;
}

/* Is this the first usable code of its satellite in the epoch? */
static bool first_code_of_satellite(const pel_epoch_t *e, int i)
{
    const pel_obs_t *obs = &e->obs[i];
    if (!pel_obs_usable(obs, PEL_OBS_CODE)) { return false; }
    for (int k = 0; k < i; k++) {
        const pel_obs_t *before = &e->obs[k];
        if (before->sys == obs->sys && before->prn == obs->prn && pel_obs_usable(before, PEL_OBS_CODE)) {
            return false;
        }
    }
    return true;
}

void pel_view_orbits(const pel_epoch_t *e, const pel_orbits_t *o, pel_time_t t_orbit_ns, unsigned sys_mask,
                     pel_nav_counters_t *count, pel_view_t *view)
{
    pel_nav_counters_t unheard;
    if (count == NULL) {
        memset(&unheard, 0, sizeof unheard);
        count = &unheard;
    }
    view->t_ns = e->t_ns;
    view->n = 0;
    for (int i = 0; i < e->n && i < PEL_MAX_OBS; i++) {
        const pel_obs_t *obs = &e->obs[i];
        if (obs->sys >= PEL_N_SYS || (sys_mask & (1u << obs->sys)) == 0u) { continue; }
        if (!first_code_of_satellite(e, i)) { continue; }
        const pel_ephemeris_t *eph = pel_orbits_find(o, obs->sys, obs->prn, t_orbit_ns);
        if (eph == NULL) {
            count->sats_no_eph++;
        } else if (!healthy(eph)) {
            count->sats_unhealthy++;
        } else if (view->n >= PEL_MAX_SATS) {
            count->sats_excluded++;
        } else if (satellite_at_transmission(e->t_ns, obs->P_m, eph, &view->sight[view->n])) {
            view->n++;
        } else {
            count->sats_no_eph++;
        }
    }
}

/* Range and its rate. The signal left in the Earth's attitude of tau ago: r_s is turned by omega tau, with tau from the
 * range itself (Sagnac term first, Groves 9.149, so that one pass leaves 1e-9 m).
 * rho_rate: rho(t) = |R(omega tau) r_s(t - tau) - r_a(t)|, tau = rho / c, differentiated by receive time t:
 * rho' = u.(R v_s - v_a) / (1 + u.(R v_s - omega x R r_s) / c), here written out. */
static void geometry(pel_sight_t *s, const double r_a[3], const double v_a[3])
{
    const double los0[3] = {s->r_s_e[0] - r_a[0], s->r_s_e[1] - r_a[1], s->r_s_e[2] - r_a[2]};
    const double sagnac = PEL_OMEGA_IE / C * (s->r_s_e[0] * r_a[1] - s->r_s_e[1] * r_a[0]);
    const double turn = PEL_OMEGA_IE * (pel_norm3(los0) + sagnac) / C; /* 5e-6..1e-5 rad: two terms suffice */
    const double c = 1.0 - 0.5 * turn * turn;
    const double r_s[3] = {c * s->r_s_e[0] + turn * s->r_s_e[1], c * s->r_s_e[1] - turn * s->r_s_e[0], s->r_s_e[2]};
    const double v_s[3] = {c * s->v_s_e[0] + turn * s->v_s_e[1], c * s->v_s_e[1] - turn * s->v_s_e[0], s->v_s_e[2]};
    const double los[3] = {r_s[0] - r_a[0], r_s[1] - r_a[1], r_s[2] - r_a[2]};

    s->rho_m = pel_unit3(los, s->u_e);
    const double u_v_s = pel_dot3(s->u_e, v_s);
    const double u_turn = PEL_OMEGA_IE * (s->u_e[0] * r_s[1] - s->u_e[1] * r_s[0]);
    s->rho_rate_mps = (u_v_s - pel_dot3(s->u_e, v_a)) / (1.0 + (u_v_s - u_turn) / C);
}

void pel_view_move(pel_view_t *view, const double r_ea_e[3], const double v_ea_e[3])
{
    static const double AT_REST[3] = {0.0, 0.0, 0.0};
    const double *v = (v_ea_e != NULL) ? v_ea_e : AT_REST;
    for (int i = 0; i < view->n; i++) { geometry(&view->sight[i], r_ea_e, v); }
}

void pel_view_atmosphere(const pel_orbits_t *o, const double r_ea_e[3], pel_view_t *view)
{
    double lat;
    double lon;
    double h;
    double C_e_n[3][3];
    pel_earth_ecef_to_llh(r_ea_e, &lat, &lon, &h);
    pel_earth_C_e_n(lat, lon, C_e_n);
    for (int i = 0; i < view->n; i++) {
        pel_sight_t *s = &view->sight[i];
        double u_n[3]; /* north, east, down */
        pel_mat3_vec(C_e_n, s->u_e, u_n);
        const double az = pel_atan2(u_n[1], u_n[0]);
        const double el = pel_asin(-u_n[2]);
        s->az_rad = (float)((az < 0.0) ? az + 2.0 * PEL_PI : az);
        s->el_rad = (float)el;
        s->tropo_m = pel_tropo_saastamoinen_m(lat, h, el);
        s->iono_L1_m = o->no_ionosphere ? 0.0 : pel_iono_klobuchar_m(&o->klobuchar, view->t_ns, lat, lon, az, el);
        s->sd_iono_m = (o->klobuchar.valid ? SD_BROADCAST : SD_NOMINAL) * (float)s->iono_L1_m;
    }
}

void pel_view_apply_mask(double mask_rad, pel_nav_counters_t *count, pel_view_t *view)
{
    int kept = 0;
    for (int i = 0; i < view->n; i++) {
        if ((double)view->sight[i].el_rad >= mask_rad) {
            if (kept != i) { view->sight[kept] = view->sight[i]; }
            kept++;
        } else if (count != NULL) {
            count->sats_low++;
        }
    }
    view->n = kept;
}

pel_status_t pel_view_compute(const pel_epoch_t *e, const pel_orbits_t *o, pel_time_t t_orbit_ns,
                              const double r_ea_e[3], const double v_ea_e[3], double mask_rad,
                              pel_nav_counters_t *count, pel_view_t *view)
{
    view->n = 0;
    view->t_ns = e->t_ns;
    if (!pel_view_near_earth(r_ea_e)) { return PEL_E_RANGE; }
    if (v_ea_e != NULL && !(pel_dot3(v_ea_e, v_ea_e) < 1e8)) { return PEL_E_RANGE; }

    pel_view_orbits(e, o, t_orbit_ns, ~0u, count, view);
    pel_view_move(view, r_ea_e, v_ea_e);
    pel_view_atmosphere(o, r_ea_e, view);
    pel_view_apply_mask(mask_rad, count, view);
    return (view->n > 0) ? PEL_OK : PEL_E_MISSING;
}

const pel_sight_t *pel_view_find(const pel_view_t *view, uint8_t sys, uint8_t prn)
{
    for (int i = 0; i < view->n; i++) {
        if (view->sight[i].sys == sys && view->sight[i].prn == prn) { return &view->sight[i]; }
    }
    return NULL;
}

static double iono_on_carrier_m(const pel_sight_t *s, const pel_obs_t *obs)
{
    if (s->iono_L1_m == 0.0) { return 0.0; } /* differences carry none */
    const double f1 = pel_carrier_hz(PEL_SYS_GPS, PEL_CARRIER_L1, 0);
    const double f = pel_carrier_hz((pel_sys_t)obs->sys, (pel_carrier_t)obs->carrier, obs->glo_k);
    return (f > 0.0) ? s->iono_L1_m * (f1 * f1) / (f * f) : 0.0;
}

double pel_sight_code_m(const pel_sight_t *s, const pel_obs_t *obs)
{
    const double delay = pel_group_delay(s->sys, s->prn, s->source, (double)s->tgd_m[0], (double)s->tgd_m[1],
                                         (pel_carrier_t)obs->carrier);
    return s->rho_m - s->clk_m + s->tropo_m + iono_on_carrier_m(s, obs) + delay;
}

double pel_sight_phase_m(const pel_sight_t *s, const pel_obs_t *obs)
{
    return s->rho_m - s->clk_m + s->tropo_m - iono_on_carrier_m(s, obs);
}

double pel_sight_rate_mps(const pel_sight_t *s)
{
    return s->rho_rate_mps - s->clk_rate_mps;
}

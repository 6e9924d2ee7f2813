#include "support_gnss.h"

#include <math.h>
#include <string.h>

static const double C = PEL_SPEED_OF_LIGHT;
static const double OMEGA = 7.292115e-5;

static void add(pel_orbits_t *o, pel_sys_t sys, int prn, double a, double e, double i0, double Omega0, double M0)
{
    pel_ephemeris_t k;
    memset(&k, 0, sizeof k);
    k.sys = (uint8_t)sys;
    k.prn = (uint8_t)prn;
    k.iode = 7;
    k.sd_ura_m = 2.0f;
    k.toe_ns = SKY_T0;
    k.toc_ns = SKY_T0;
    k.af0 = 1e-5 * (prn % 7 - 3);
    k.af1 = 1e-12 * (prn % 5);
    k.sqrt_a = sqrt(a);
    k.e = e;
    k.i0 = i0;
    k.Omega0 = Omega0 + OMEGA * pel_time_tow_s(SKY_T0); /* so that Omega0 is the node's longitude at toe */
    k.omega = 0.3;
    k.M0 = M0 - 0.3;
    k.Omega0 = fmod(k.Omega0, 6.283185307179586);
    (void)pel_orbits_add(o, &k);
}

void sky_init(pel_orbits_t *o)
{
    pel_orbits_init(o);
    for (int k = 0; k < 30; k++) {
        add(o, PEL_SYS_GPS, k + 1, 26559e3, 0.002 * (k % 5), 0.96, 1.0472 * (k % 6), 1.2566 * (k / 6) + 0.35 * (k % 6));
    }
    for (int k = 0; k < 12; k++) {
        add(o, PEL_SYS_GAL, k + 1, 29600e3, 0.0003, 0.977, 2.0944 * (k % 3), 1.5708 * (k / 3) + 0.5 * k);
    }
    for (int k = 0; k < 5; k++) { add(o, PEL_SYS_BDS, k + 1, 42164e3, 0.0003, 0.087, 0.2 * k, 1.6 + 0.35 * k); }
    for (int k = 0; k < 3; k++) { add(o, PEL_SYS_BDS, 11 + k, 27906e3, 0.001, 0.96, 1.5 * k, 1.1 * k); }
}

void sky_add_glonass(pel_orbits_t *o)
{
    const double r = 25508e3, incl = 1.131;
    const double v = sqrt(3.986004418e14 / r);
    for (int n = 0; n < 24; n++) {
        const double u = 0.7854 * (n / 3) + 0.2618 * (n % 3), node = 2.0944 * (n % 3);
        const double x[3] = {r * cos(u), r * sin(u) * cos(incl), r * sin(u) * sin(incl)};
        const double dx[3] = {-v * sin(u), v * cos(u) * cos(incl), v * cos(u) * sin(incl)};
        const double c = cos(node), s = sin(node);
        pel_ephemeris_t k;
        memset(&k, 0, sizeof k);
        k.sys = PEL_SYS_GLO;
        k.prn = (uint8_t)(n + 1);
        k.toe_ns = k.toc_ns = SKY_T0;
        k.sd_ura_m = 4.0f;
        k.af0 = 2e-5 * (n % 5 - 2);
        k.glo.k = (int8_t)(n % 14 - 7);
        k.glo.r_e[0] = c * x[0] - s * x[1];
        k.glo.r_e[1] = s * x[0] + c * x[1];
        k.glo.r_e[2] = x[2];
        k.glo.v_e[0] = c * dx[0] - s * dx[1] + OMEGA * k.glo.r_e[1];
        k.glo.v_e[1] = s * dx[0] + c * dx[1] - OMEGA * k.glo.r_e[0];
        k.glo.v_e[2] = dx[2];
        (void)pel_orbits_add(o, &k);
    }
}

scene_t scene_default(void)
{
    const scene_t s = {
        .r_e = {-3762000.0, 3633000.0, 3638000.0}, .clk_m = 45000.0, .clk_rate_mps = 20.0, .atmosphere = true};
    return s;
}

double scene_integer(uint8_t sys, uint8_t prn, uint8_t carrier)
{
    return 1000.0 * sys + 37.0 * prn + 11.0 * carrier - 500.0;
}

/* Range at true receive time, by iterating on the light time; also elevation's sine and the satellite clock. */
static double range_at(const scene_t *s, const pel_ephemeris_t *eph, pel_time_t t_ns, double dt_s, double *sin_el,
                       double *clk_s)
{
    double rho = 0.07 * C;
    pel_sat_state_t sat;
    double r_a[3];
    for (int k = 0; k < 3; k++) { r_a[k] = s->r_e[k] + s->v_e[k] * dt_s; }
    for (int it = 0; it < 8; it++) {
        const double tau = rho / C;
        (void)pel_sat_state(eph, t_ns, dt_s - tau, &sat);
        const double c = cos(OMEGA * tau);
        const double n = sin(OMEGA * tau);
        const double d[3] = {c * sat.r_e[0] + n * sat.r_e[1] - r_a[0], -n * sat.r_e[0] + c * sat.r_e[1] - r_a[1],
                             sat.r_e[2] - r_a[2]};
        rho = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        const double up = sqrt(r_a[0] * r_a[0] + r_a[1] * r_a[1] + r_a[2] * r_a[2]);
        *sin_el = (d[0] * r_a[0] + d[1] * r_a[1] + d[2] * r_a[2]) / (rho * up);
    }
    *clk_s = sat.clk_s;
    return rho;
}

void scene_observe(const scene_t *s, const pel_orbits_t *o, pel_time_t t_ns, unsigned sys_mask, pel_epoch_t *e)
{
    memset(e, 0, sizeof *e);
    e->t_ns = t_ns + (int64_t)llround(s->clk_m / C * 1e9);
    const double clk_m = C * 1e-9 * (double)(e->t_ns - t_ns); /* the tag is whole nanoseconds */
    for (int i = 0; i < o->n; i++) {
        const pel_ephemeris_t *eph = &o->eph[i];
        double sin_el;
        double clk;
        double before;
        double after;
        double unused;
        if ((sys_mask & (1u << eph->sys)) == 0u) { continue; }
        const double rho = range_at(s, eph, t_ns, 0.0, &sin_el, &clk);
        if (sin_el < 0.19) { continue; }
        const double back = range_at(s, eph, t_ns, -0.5, &unused, &before);
        const double ahead = range_at(s, eph, t_ns, 0.5, &unused, &after);
        const double rate = ahead - back - C * (after - before) + s->clk_rate_mps;
        /* Elevation over the sphere differs from the geodetic by 0.2 degrees; only used where it does not matter. */
        const double base = rho + clk_m - C * clk;
        const bool second_is_L2 = eph->sys == PEL_SYS_GPS || eph->sys == PEL_SYS_GLO;
        const uint8_t carriers[2] = {(eph->sys == PEL_SYS_BDS) ? PEL_CARRIER_B1I : PEL_CARRIER_L1,
                                     second_is_L2 ? PEL_CARRIER_L2 : PEL_CARRIER_E5B};
        for (int k = 0; k < 2 && e->n < PEL_MAX_OBS; k++) {
            pel_obs_t *obs = &e->obs[e->n++];
            obs->sys = eph->sys;
            obs->prn = eph->prn;
            obs->carrier = carriers[k];
            obs->code = 'C';
            obs->flags = PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER;
            obs->cn0_dbhz = 45.0f;
            obs->lock_ms = 100000;
            obs->glo_k = (eph->sys == PEL_SYS_GLO) ? eph->glo.k : 0;
            const double lambda = pel_obs_lambda_m(obs);
            obs->P_m = base;
            obs->L_cyc =
                (base + s->glo_slope_m * obs->glo_k) / lambda + scene_integer(obs->sys, obs->prn, obs->carrier);
            obs->D_hz = (float)(-rate / lambda);
        }
    }
    if (!s->atmosphere) { return; }
    /* The library's own model at its own elevation: what is tested with it is the geometry, not the atmosphere. */
    static pel_view_t view;
    (void)pel_view_compute(e, o, e->t_ns, s->r_e, s->v_e, 0.0, NULL, &view);
    for (int i = 0; i < e->n; i++) {
        const pel_sight_t *sight = pel_view_find(&view, e->obs[i].sys, e->obs[i].prn);
        if (sight == NULL) { continue; }
        const double lambda = pel_obs_lambda_m(&e->obs[i]);
        const double l1 = C / 1575.42e6;
        const double iono = sight->iono_L1_m * (lambda / l1) * (lambda / l1);
        e->obs[i].P_m += sight->tropo_m + iono;
        e->obs[i].L_cyc += (sight->tropo_m - iono) / lambda;
    }
}

void gnss_hand_some_to_qzss(pel_orbits_t *orbits, pel_epoch_t *epoch)
{
    for (int i = 0; i < orbits->n; i++) {
        pel_ephemeris_t *eph = &orbits->eph[i];
        if (eph->sys != PEL_SYS_GPS || eph->prn < 11 || eph->prn > 20) { continue; }
        eph->sys = PEL_SYS_QZS;
        eph->prn = (uint8_t)(eph->prn - 10);
    }
    for (int i = 0; i < epoch->n; i++) {
        pel_obs_t *obs = &epoch->obs[i];
        if (obs->sys != PEL_SYS_GPS || obs->prn < 11 || obs->prn > 20) { continue; }
        obs->sys = PEL_SYS_QZS;
        obs->prn = (uint8_t)(obs->prn - 10);
    }
}

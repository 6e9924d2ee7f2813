/* receiver.c - see receiver.h. */
#include "receiver.h"

#include <math.h>
#include <string.h>

#include "world.h"

/* What one satellite looks like from the antenna. */
typedef struct {
    double rho, rate; /* geometric range and its true rate, rotation of the Earth during the flight included */
    double clock_m, clock_rate_mps;
    double az, el;
    double tropo_m, iono_m; /* on L1 */
} sight_t;

enum { CAUSE_NOISE = 31, CAUSE_CLOCK = 32, CAUSE_MULTIPATH = 33, CAUSE_LOCK = 34, CAUSE_PATH = 35, CAUSES = 100 };

static const char system_letters[PEL_N_SYS + 1] = "GRECJS";

static int carrier_of(int sys, char band)
{
    static const char *const bands[PEL_N_SYS] = {"125", "12", "1567", "12567", "1256", "15"};
    if (band == '\0' || strchr(bands[sys], band) == NULL) { return -1; }
    switch (band) {
    case '1': return PEL_CARRIER_L1;
    case '2': return (sys == PEL_SYS_BDS) ? PEL_CARRIER_B1I : PEL_CARRIER_L2;
    case '5': return PEL_CARRIER_L5;
    case '6': return (sys == PEL_SYS_BDS) ? PEL_CARRIER_B3I : PEL_CARRIER_E6;
    case '7': return PEL_CARRIER_E5B;
    default: return -1;
    }
}

bool signal_parse(const char *text, signal_t *out)
{
    if (strlen(text) != 3) { return false; }
    const char *letter = strchr(system_letters, text[0]);
    if (letter == NULL) { return false; }
    const int sys = (int)(letter - system_letters);
    const int carrier = carrier_of(sys, text[1]);
    if (carrier < 0) { return false; }
    *out = (signal_t){(uint8_t)sys, (uint8_t)carrier, text[2]};
    return true;
}

bool selector_parse(const char *text, selector_t *out)
{
    *out = (selector_t){-1, 0, -1};
    if (strcmp(text, "all") == 0) { return true; }
    const char *letter = (text[0] != '\0') ? strchr(system_letters, text[0]) : NULL;
    if (letter == NULL) { return false; }
    out->sys = (int)(letter - system_letters);
    text++;
    while (*text >= '0' && *text <= '9' && out->prn < 100) { out->prn = 10 * out->prn + (*text++ - '0'); }
    if (*text == ':') {
        out->carrier = carrier_of(out->sys, text[1]);
        return out->carrier >= 0 && text[2] == '\0';
    }
    return *text == '\0' && out->prn <= pel_sys_max_prn((pel_sys_t)out->sys);
}

static bool selects(const selector_t *s, const pel_ephemeris_t *e, uint8_t carrier)
{
    return (s->sys < 0 || s->sys == e->sys) && (s->prn == 0 || s->prn == e->prn) &&
           (s->carrier < 0 || s->carrier == carrier);
}

void receiver_init(receiver_t *r, const receiver_config_t *cfg, const sky_t *sky, const atmosphere_t *air,
                   antenna_t antenna, void *context, pel_time_t start_ns, uint64_t seed, uint64_t name)
{
    memset(r, 0, sizeof *r);
    r->cfg = *cfg;
    r->sky = sky;
    r->air = air;
    r->antenna = antenna;
    r->context = context;
    r->start_ns = start_ns;
    r->clock_m = cfg->clock_bias_s * WORLD_C;
    r->clock_rate_mps = cfg->clock_drift * WORLD_C;
    rng_init(&r->noise, seed, name * CAUSES + CAUSE_NOISE);
    rng_init(&r->clock, seed, name * CAUSES + CAUSE_CLOCK);
    rng_init(&r->multipath, seed, name * CAUSES + CAUSE_MULTIPATH);
    rng_init(&r->lock, seed, name * CAUSES + CAUSE_LOCK);
    rng_init(&r->path, seed, name * CAUSES + CAUSE_PATH);
    for (int i = 0; i < sky->n; i++) {
        r->path_rate_mps[i] = cfg->path_rate_mps * rng_normal(&r->path);
        r->path_accel_mps2[i] = cfg->path_accel_mps2 * rng_normal(&r->path);
    }
    /* Tags are whole multiples of the interval in GPS time: the first one after the start. */
    r->k = (start_ns - cfg->tag_offset_ns) / cfg->interval_ns + 1;
}

static pel_time_t next_tag(const receiver_t *r)
{
    return r->k * r->cfg.interval_ns + r->cfg.tag_offset_ns;
}

double receiver_next_s(const receiver_t *r)
{
    return pel_time_diff_s(next_tag(r), r->start_ns) - r->clock_m / WORLD_C;
}

/* Range by iteration on the time of flight; satellite turned by the Earth's rotation during it. */
static void geometry(const sat_t *sat, pel_time_t t_ns, double dt_s, const double r_a[3], const double v_a[3],
                     double u[3], sight_t *out)
{
    double tau = 0.075;
    sat_state_t s;
    double r_s[3];
    double v_s[3];
    for (int i = 0; i < 6; i++) {
        sky_state(sat, t_ns, dt_s - tau, &s);
        const double a = WORLD_OMEGA * tau;
        const double sa = sin(a);
        const double ca = cos(a);
        r_s[0] = ca * s.r_e[0] + sa * s.r_e[1];
        r_s[1] = -sa * s.r_e[0] + ca * s.r_e[1];
        r_s[2] = s.r_e[2];
        v_s[0] = ca * s.v_e[0] + sa * s.v_e[1];
        v_s[1] = -sa * s.v_e[0] + ca * s.v_e[1];
        v_s[2] = s.v_e[2];
        for (int k = 0; k < 3; k++) { u[k] = r_s[k] - r_a[k]; }
        out->rho = sqrt(dot(u, u));
        tau = out->rho / WORLD_C;
    }
    double relative[3];
    for (int k = 0; k < 3; k++) {
        u[k] /= out->rho;
        relative[k] = v_s[k] - v_a[k];
    }
    /* rho' = u.(v_s (1 - tau') - v_a + tau' dR/dtau r_s), tau' = rho'/c */
    const double swing = WORLD_OMEGA * (u[0] * r_s[1] - u[1] * r_s[0]);
    out->rate = dot(u, relative) / (1.0 + (dot(u, v_s) - swing) / WORLD_C);
    out->clock_m = WORLD_C * s.clock_s;
    out->clock_rate_mps = WORLD_C * s.clock_rate * (1.0 - out->rate / WORLD_C);
}

static double ionosphere(const atmosphere_t *air, pel_time_t t, const double llh[3], double az, double el)
{
    switch (air->iono) {
    case IONO_NONE: return 0.0;
    case IONO_SHELL: {
        double lat;
        double lon;
        const double slant = world_pierce(llh, az, el, &lat, &lon);
        const double north_km = 6371.0 * (lat - air->origin[0]);
        const double east_km = 6371.0 * cos(air->origin[0]) * remainder(lon - air->origin[1], WORLD_TWO_PI);
        return slant * (air->vertical_m + air->gradient[0] * east_km + air->gradient[1] * north_km);
    }
    case IONO_KLOBUCHAR: {
        double alpha[4];
        double beta[4];
        for (int i = 0; i < 4; i++) {
            alpha[i] = (double)air->klobuchar.alpha[i];
            beta[i] = (double)air->klobuchar.beta[i];
        }
        return air->klobuchar_scale * world_klobuchar(alpha, beta, pel_time_tow_s(t), llh[0], llh[1], az, el);
    }
    }
    return 0.0;
}

static void look(const receiver_t *r, const sat_t *sat, pel_time_t t, double dt, const double r_a[3],
                 const double v_a[3], const double llh[3], sight_t *out)
{
    double u[3];
    geometry(sat, t, dt, r_a, v_a, u, out);
    world_azel(llh[0], llh[1], u, &out->az, &out->el);
    out->tropo_m = 0.0;
    out->iono_m = 0.0;
    if (out->el <= 0.0) { return; }
    if (r->air->troposphere) {
        out->tropo_m = world_troposphere(llh[0], llh[2], out->el, r->air->humidity) +
                       r->cfg.zenith_delay_error_m * world_troposphere_mapping(out->el);
    }
    out->iono_m = ionosphere(r->air, t, llh, out->az, out->el);
}

static void new_lock(receiver_t *r, channel_t *c, double t_s)
{
    c->since_s = t_s;
    c->half = (r->cfg.half_cycle_s > 0.0 && rng_uniform(&r->lock) < 0.5) ? 0.5 : 0.0;
}

/* Follow one signal: view, lock, slips. Returns whether it is tracked at this epoch, and whether it says a slip. */
static bool track(receiver_t *r, const sat_t *sat, const signal_t *signal, channel_t *c, bool visible, double t_s)
{
    const double interval_s = 1e-9 * (double)r->cfg.interval_ns;
    for (int i = 0; i < r->cfg.n_happenings; i++) {
        const happening_t *h = &r->cfg.happenings[i];
        if (h->kind == HAPPENS_OUTAGE && t_s >= h->from_s && t_s < h->to_s &&
            selects(&h->who, &sat->eph, signal->carrier)) {
            visible = false;
        }
    }
    if (!visible) {
        c->seen = false;
        c->tracked = false;
        return false;
    }
    if (!c->seen) {
        c->seen = true;
        c->since_s = t_s;
        const double sd = r->cfg.multipath_tau_s > 0.0 ? 1.0 : 0.0;
        c->mp_code = sd * r->cfg.multipath_code_m * rng_normal(&r->multipath);
        c->mp_phase = sd * r->cfg.multipath_phase_m * rng_normal(&r->multipath);
    } else {
        c->mp_code = rng_markov(&r->multipath, c->mp_code, r->cfg.multipath_code_m, r->cfg.multipath_tau_s, interval_s);
        c->mp_phase =
            rng_markov(&r->multipath, c->mp_phase, r->cfg.multipath_phase_m, r->cfg.multipath_tau_s, interval_s);
    }
    if (!c->tracked) {
        if (t_s - c->since_s < r->cfg.lock_s && t_s > r->cfg.lock_s) { return false; }
        c->tracked = true;
        c->N = (double)rng_integer(&r->lock, 1000);
        new_lock(r, c, t_s);
        return true;
    }
    if (rng_uniform(&r->lock) < r->cfg.slips_per_hour * interval_s / 3600.0) {
        const int64_t jump = 1 + rng_integer(&r->lock, 20);
        c->N += (double)((jump > 0) ? jump : jump - 1);
        new_lock(r, c, t_s);
    }
    for (int i = 0; i < r->cfg.n_happenings; i++) {
        const happening_t *h = &r->cfg.happenings[i];
        if (h->kind == HAPPENS_SLIP && h->from_s > t_s - interval_s && h->from_s <= t_s &&
            selects(&h->who, &sat->eph, signal->carrier)) {
            c->N += h->cycles;
            if (!h->silent) { new_lock(r, c, t_s); }
        }
    }
    return true;
}

static void measure(receiver_t *r, const sat_t *sat, const signal_t *signal, const channel_t *c, const sight_t *g,
                    double t_s, pel_obs_t *o)
{
    const double f1 = pel_carrier_hz(PEL_SYS_GPS, PEL_CARRIER_L1, 0);
    const bool rdss = r->cfg.rdss_hz > 0.0 && signal->sys == PEL_SYS_BDS && signal->carrier == PEL_CARRIER_B1I;
    const double f = rdss ? r->cfg.rdss_hz : pel_carrier_hz((pel_sys_t)signal->sys, (pel_carrier_t)signal->carrier, 0);
    const double lambda = WORLD_C / f;
    const double iono = g->iono_m * f1 * f1 / (f * f);
    const double s = sin(g->el);
    const double sd = r->cfg.elevation_law ? sqrt(0.5 * (1.0 + 1.0 / (s * s))) : 1.0;
    const double common = g->rho + r->clock_m - g->clock_m + g->tropo_m;
    const bool half_known = t_s - c->since_s >= r->cfg.half_cycle_s;
    const double delay = WORLD_C * sky_group_delay(sat, (pel_carrier_t)signal->carrier);
    const double code_noise = r->cfg.code_m * sd * rng_normal(&r->noise);
    const double phase_noise = r->cfg.phase_m * sd * rng_normal(&r->noise);
    const double rate_noise = r->cfg.doppler_mps * sd * rng_normal(&r->noise);

    memset(o, 0, sizeof *o);
    o->P_m = common + iono + delay + c->mp_code + code_noise;
    o->L_cyc = (common - iono + c->mp_phase + phase_noise) / lambda + c->N + (half_known ? 0.0 : c->half);
    /* The receiver counts cycles against its own second, which is 1 + clock rate long. */
    const double rate = (g->rate + r->clock_rate_mps - g->clock_rate_mps) / (1.0 + r->clock_rate_mps / WORLD_C);
    o->D_hz = (float)(-(rate + rate_noise) / lambda);
    o->cn0_dbhz = (float)round(34.0 + 16.0 * s + 0.5 * rng_normal(&r->noise));
    o->lock_ms = (uint32_t)fmin(4e9, 1000.0 * (t_s - c->since_s) + 0.5);
    o->sys = signal->sys;
    o->prn = sat->eph.prn;
    o->carrier = signal->carrier;
    o->code = signal->code;
    o->flags = PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER | (half_known ? 0u : PEL_OBS_HALF_CYCLE);
}

static void advance_clock(receiver_t *r)
{
    const double dt = 1e-9 * (double)r->cfg.interval_ns;
    const double ms = 1e-3 * WORLD_C;
    r->clock_m += r->clock_rate_mps * dt + r->cfg.clock_walk_m * sqrt(dt) * rng_normal(&r->clock);
    r->clock_rate_mps += r->cfg.clock_drift_walk * sqrt(dt) * rng_normal(&r->clock);
    r->jumped = false;
    if (r->cfg.clock_steering && fabs(r->clock_m) > 0.5 * ms) {
        r->clock_m -= ms * round(r->clock_m / ms);
        r->jumped = true;
    }
}

/* What no model knows of each satellite's way. */
static void advance_paths(receiver_t *r)
{
    const double dt = 1e-9 * (double)r->cfg.interval_ns;
    for (int i = 0; i < r->sky->n; i++) {
        r->path_m[i] += dt * (r->path_rate_mps[i] + 0.5 * dt * r->path_accel_mps2[i]) +
                        r->cfg.path_walk_m * sqrt(dt) * rng_normal(&r->path);
        r->path_rate_mps[i] += dt * r->path_accel_mps2[i];
    }
}

void receiver_epoch(receiver_t *r, pel_epoch_t *out)
{
    const double t_s = receiver_next_s(r);
    double r_a[3];
    double v_a[3];
    double llh[3];
    r->antenna(r->context, t_s, r_a, v_a);
    world_ecef_to_llh(r_a, llh);
    memset(out, 0, offsetof(pel_epoch_t, obs));
    out->t_ns = next_tag(r);
    out->clock_reset = r->jumped;
    for (int i = 0; i < r->sky->n; i++) {
        const sat_t *sat = &r->sky->sats[i];
        sight_t g;
        look(r, sat, out->t_ns, -r->clock_m / WORLD_C, r_a, v_a, llh, &g);
        g.tropo_m += r->path_m[i];
        g.rate += r->path_rate_mps[i];
        for (int k = 0; k < r->cfg.n_signals; k++) {
            const signal_t *signal = &r->cfg.signals[k];
            if (signal->sys != sat->eph.sys) { continue; }
            channel_t *c = &r->channel[i][k];
            if (!track(r, sat, signal, c, g.el >= r->cfg.mask, t_s)) { continue; }
            if (out->n >= PEL_MAX_OBS) {
                out->dropped++;
                continue;
            }
            measure(r, sat, signal, c, &g, t_s, &out->obs[out->n++]);
        }
    }
    r->k++;
    advance_paths(r);
    advance_clock(r);
}

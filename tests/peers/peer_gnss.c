/* peer_gnss - gnss/ behind text lines on standard input, for tests/peers/test_gnss_*.py. One answer line a question.
 *
 *   K a0..a3 b0..b3                                Klobuchar parameters
 *   N sys prn health source iode ura toe_ns toc_ns af0 af1 af2 sqrt_a e i0 Omega0 omega M0 dn Omega_dot idot
 *     cuc cus crc crs cic cis tgd0 tgd1            ephemeris
 *   R prn health toe_ns af0 af1 k x vx ax y vy ay z vz az      ephemeris of GLONASS
 *   S sys prn t_ns dt_s                            satellite state    -> S status x y z vx vy vz clk clk_rate
 *   G sys prn carrier t_ns                         group delay        -> G m
 *   T lat h el                                     troposphere        -> T m
 *   I t_ns lat lon az el                           ionosphere         -> I m
 *   E who t_ns                                     start the epoch of receiver 0 (rover) or 1 (base)
 *   O sys prn carrier code P L D cn0 lock flags    add a signal to it (GLONASS: its channel behind)
 *   P prior mask_deg                               solve the rover    -> P status t_ns x y z vx vy vz clk n excluded rate rms sdx sdy sdz
 *   L                                              rover slip check   -> L lock half gf doppler ins jumps, then marked signals
 *   D rx ry rz bx by bz age                        single differences -> D n, then n lines sys prn carrier pivot half slip code phase rate
 *                                                  lambda var_code var_phase var_rate ux uy uz
 *   W n m r0 then m lines r z h[n]                 whitening          -> n lines z var h[n] */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelorus/gnss.h"
#include "pelorus/math.h"

static pel_orbits_t orbits;
static pel_epoch_t epoch[2];
static pel_view_t view[2];
static pel_spp_t spp;
static pel_slip_t slip;
static pel_sd_set_t set;
static pel_nav_counters_t count;
static int who;

static double number(char **p)
{
    return strtod(*p, p);
}

static int64_t whole(char **p)
{
    return strtoll(*p, p, 10);
}

static void vector(char **p, double v[3])
{
    for (int i = 0; i < 3; i++) { v[i] = number(p); }
}

static void add_ephemeris(char *p)
{
    pel_ephemeris_t e;
    memset(&e, 0, sizeof e);
    e.sys = (uint8_t)whole(&p);
    e.prn = (uint8_t)whole(&p);
    e.health = (uint8_t)whole(&p);
    e.source = (uint8_t)whole(&p);
    e.iode = (uint16_t)whole(&p);
    e.sd_ura_m = (float)number(&p);
    e.toe_ns = whole(&p);
    e.toc_ns = whole(&p);
    double *const field[] = {&e.af0,   &e.af1, &e.af2, &e.sqrt_a,    &e.e,        &e.i0,      &e.Omega0,
                             &e.omega, &e.M0,  &e.dn,  &e.Omega_dot, &e.idot,     &e.cuc,     &e.cus,
                             &e.crc,   &e.crs, &e.cic, &e.cis,       &e.tgd_s[0], &e.tgd_s[1]};
    for (size_t i = 0; i < sizeof field / sizeof field[0]; i++) { *field[i] = number(&p); }
    printf("N %d\n", pel_orbits_add(&orbits, &e));
}

static void add_glonass(char *p)
{
    pel_ephemeris_t e;
    memset(&e, 0, sizeof e);
    e.sys = PEL_SYS_GLO;
    e.prn = (uint8_t)whole(&p);
    e.health = (uint8_t)whole(&p);
    e.toe_ns = e.toc_ns = whole(&p);
    e.sd_ura_m = 4.0f;
    e.af0 = number(&p);
    e.af1 = number(&p);
    e.glo.k = (int8_t)whole(&p);
    for (int i = 0; i < 3; i++) {
        e.glo.r_e[i] = number(&p);
        e.glo.v_e[i] = number(&p);
        e.glo.a_e[i] = number(&p);
    }
    printf("N %d\n", pel_orbits_add(&orbits, &e));
}

static void add_signal(char *p)
{
    pel_epoch_t *e = &epoch[who];
    if (e->n >= PEL_MAX_OBS) {
        e->dropped++;
        return;
    }
    pel_obs_t *o = &e->obs[e->n++];
    memset(o, 0, sizeof *o);
    o->sys = (uint8_t)whole(&p);
    o->prn = (uint8_t)whole(&p);
    o->carrier = (uint8_t)whole(&p);
    while (*p == ' ') { p++; }
    o->code = *p++;
    o->P_m = number(&p);
    o->L_cyc = number(&p);
    o->D_hz = (float)number(&p);
    o->cn0_dbhz = (float)number(&p);
    o->lock_ms = (uint32_t)whole(&p);
    o->flags = (uint8_t)whole(&p);
    o->glo_k = (int8_t)whole(&p);
}

static void solve(char *p)
{
    pel_spp_config_t cfg;
    pel_spp_default(&cfg);
    const bool with_prior = whole(&p) != 0;
    cfg.mask_rad = number(&p) * PEL_DEG;
    const pel_spp_t prior = spp;
    const int status = pel_spp_solve(&epoch[0], &orbits, &cfg, with_prior ? &prior : NULL, &count, &view[0], &spp);
    printf("P %d %" PRId64 " %.4f %.4f %.4f %.5f %.5f %.5f %.4f %d %d %d %.4f %.4f %.4f %.4f\n", status, spp.t_ns,
           spp.r_ea_e[0], spp.r_ea_e[1], spp.r_ea_e[2], spp.v_ea_e[0], spp.v_ea_e[1], spp.v_ea_e[2], spp.clk_m,
           spp.n_used, spp.n_excluded, spp.has_velocity, spp.rms_m, pel_sqrt(spp.cov_r_e[0][0]),
           pel_sqrt(spp.cov_r_e[1][1]), pel_sqrt(spp.cov_r_e[2][2]));
}

static void slips(void)
{
    memset(&count, 0, sizeof count);
    pel_slip_check(&slip, &epoch[0], NULL, NULL, &count);
    printf("L %u %u %u %u %u %u", count.slip_lock, count.slip_half_cycle, count.slip_geometry_free, count.slip_doppler,
           count.slip_ins, count.clock_jumps);
    for (int i = 0; i < epoch[0].n; i++) {
        const pel_obs_t *o = &epoch[0].obs[i];
        if ((o->flags & PEL_OBS_SLIP) != 0u) { printf(" %d:%d:%d", o->sys, o->prn, o->carrier); }
    }
    printf("\n");
}

static void differences(char *p)
{
    double r[3];
    double b[3];
    pel_noise_config_t noise;
    pel_noise_default(&noise);
    vector(&p, r);
    vector(&p, b);
    const double age = number(&p);
    const double mask = 10.0 * PEL_DEG;
    (void)pel_view_compute(&epoch[0], &orbits, epoch[0].t_ns, r, NULL, mask, &count, &view[0]);
    (void)pel_view_compute(&epoch[1], &orbits, epoch[0].t_ns, b, NULL, mask, &count, &view[1]);
    (void)pel_sd_form(&epoch[0], &view[0], &epoch[1], &view[1], &noise, age, &set);
    printf("D %d\n", set.n);
    for (int i = 0; i < set.n; i++) {
        const pel_sd_t *d = &set.sd[i];
        printf("%d %d %d %d %d %d %.6f %.6f %.6f %.12f %.9g %.9g %.9g %.9f %.9f %.9f\n", d->sys, d->prn, d->carrier,
               d->pivot, d->half, d->slip, d->code_m, d->phase_m, d->rate_mps, d->lambda_m, d->var_code, d->var_phase,
               d->var_rate, d->u_e[0], d->u_e[1], d->u_e[2]);
    }
}

static void whiten(char *p)
{
    pel_whiten_t w;
    pel_real h[PEL_MAX_STATES];
    char line[4096];
    const int n = (int)whole(&p);
    const int m = (int)whole(&p);
    (void)pel_whiten_begin(&w, n, (pel_real)number(&p));
    for (int i = 0; i < m && fgets(line, sizeof line, stdin) != NULL; i++) {
        p = line;
        const pel_real r = (pel_real)number(&p);
        pel_real z = (pel_real)number(&p);
        pel_real var;
        for (int k = 0; k < n; k++) { h[k] = (pel_real)number(&p); }
        (void)pel_whiten_row(&w, r, &z, h, &var);
        pel_whiten_accept(&w, r, z, h);
        printf("%.17g %.17g", (double)z, (double)var);
        for (int k = 0; k < n; k++) { printf(" %.17g", (double)h[k]); }
        printf("\n");
    }
}

static void state(char *p)
{
    pel_sat_state_t s;
    memset(&s, 0, sizeof s);
    const uint8_t sys = (uint8_t)whole(&p);
    const uint8_t prn = (uint8_t)whole(&p);
    const int64_t t_ns = whole(&p);
    const pel_ephemeris_t *e = pel_orbits_find(&orbits, sys, prn, t_ns);
    const int status = (e != NULL) ? pel_sat_state(e, t_ns, number(&p), &s) : PEL_E_MISSING;
    printf("S %d %.6f %.6f %.6f %.8f %.8f %.8f %.17g %.17g\n", status, s.r_e[0], s.r_e[1], s.r_e[2], s.v_e[0], s.v_e[1],
           s.v_e[2], s.clk_s, s.clk_rate);
}

int main(void)
{
    char line[4096];
    pel_orbits_init(&orbits);
    pel_slip_init(&slip);
    while (fgets(line, sizeof line, stdin) != NULL) {
        char *p = line + 1;
        double a[8];
        switch (line[0]) {
        case 'K':
            for (int i = 0; i < 4; i++) { orbits.klobuchar.alpha[i] = (float)number(&p); }
            for (int i = 0; i < 4; i++) { orbits.klobuchar.beta[i] = (float)number(&p); }
            orbits.klobuchar.valid = true;
            break;
        case 'N': add_ephemeris(p); break;
        case 'R': add_glonass(p); break;
        case 'S': state(p); break;
        case 'T':
            vector(&p, a);
            printf("T %.9f\n", pel_tropo_saastamoinen_m(a[0], a[1], a[2]));
            break;
        case 'I': {
            const int64_t t_ns = whole(&p);
            for (int i = 0; i < 4; i++) { a[i] = number(&p); }
            printf("I %.9f\n", pel_iono_klobuchar_m(&orbits.klobuchar, t_ns, a[0], a[1], a[2], a[3]));
            break;
        }
        case 'G': {
            const uint8_t sys = (uint8_t)whole(&p);
            const uint8_t prn = (uint8_t)whole(&p);
            const pel_carrier_t carrier = (pel_carrier_t)whole(&p);
            const pel_ephemeris_t *e = pel_orbits_find(&orbits, sys, prn, whole(&p));
            printf("G %.9f\n", (e != NULL) ? pel_sat_group_delay_m(e, carrier) : 0.0);
            break;
        }
        case 'E':
            who = (int)whole(&p) & 1;
            memset(&epoch[who], 0, sizeof epoch[who]);
            epoch[who].t_ns = whole(&p);
            break;
        case 'O': add_signal(p); break;
        case 'P': solve(p); break;
        case 'L': slips(); break;
        case 'D': differences(p); break;
        case 'W': whiten(p); break;
        default: break;
        }
        fflush(stdout);
    }
    return 0;
}

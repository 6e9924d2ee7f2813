#include "support_pair.h"

#include <math.h>
#include <string.h>

void pair_init(pair_t *p, pel_navigator_t *nav, unsigned systems, uint8_t carriers)
{
    static const double APART[3] = {1200.0, 1100.0, -900.0};
    memset(p, 0, sizeof *p);
    sky_init(&p->orbits);
    int kept = 0;
    for (int i = 0; i < p->orbits.n; i++) {
        if ((systems & (1u << p->orbits.eph[i].sys)) != 0) { p->orbits.eph[kept++] = p->orbits.eph[i]; }
    }
    p->orbits.n = kept;
    if ((systems & (1u << PEL_SYS_GLO)) != 0) { sky_add_glonass(&p->orbits); }
    p->base = p->rover = scene_default();
    p->base.clk_m = -2000.0;
    p->base.atmosphere = p->rover.atmosphere = false;
    for (int k = 0; k < 3; k++) { p->rover.r_e[k] += APART[k]; }
    p->code_sd_m = 0.4;
    p->phase_sd_m = 0.003;
    p->systems = systems;
    p->seed = 1;

    pel_nav_config_t cfg;
    pel_nav_config_default(&cfg);
    cfg.carriers = carriers;
    cfg.no_ionosphere = true;
    cfg.noise.iono_mm_per_km = 0.0;
    cfg.output_period_ns = 0;
    pair_introduce(p, nav, &cfg);
}

void pair_introduce(const pair_t *p, pel_navigator_t *nav, const pel_nav_config_t *cfg)
{
    pel_navigator_init(nav, cfg);
    for (int i = 0; i < p->orbits.n; i++) { pel_navigator_push_ephemeris(nav, &p->orbits.eph[i]); }
    pel_station_t station = {.id = 1};
    memcpy(station.r_ea_e, p->base.r_e, sizeof station.r_ea_e);
    pel_navigator_push_station(nav, &station);
}

/* Sum of twelve uniform numbers. */
static double normal(pair_t *p)
{
    double sum = -6.0;
    for (int i = 0; i < 12; i++) {
        p->seed = p->seed * 1664525u + 1013904223u;
        sum += (double)(p->seed >> 8) / 16777216.0;
    }
    return sum;
}

/* The scene has no troposphere here, the navigator models one: both receivers get what it will take away. */
static void add_noise(pair_t *p, const scene_t *s, pel_epoch_t *e)
{
    static pel_view_t view;
    (void)pel_view_compute(e, &p->orbits, e->t_ns, s->r_e, s->v_e, 0.0, NULL, &view);
    for (int i = 0; i < e->n; i++) {
        pel_obs_t *o = &e->obs[i];
        const pel_sight_t *sight = pel_view_find(&view, o->sys, o->prn);
        const double tropo_m = (sight != NULL) ? sight->tropo_m : 0.0;
        o->P_m += tropo_m + p->code_sd_m * normal(p);
        o->L_cyc += (tropo_m + p->phase_sd_m * normal(p)) / pel_obs_lambda_m(o);
        o->lock_ms = 10000u + 1000u * (uint32_t)p->epoch;
    }
}

void pair_observe(pair_t *p, pel_epoch_t *base, pel_epoch_t *rover)
{
    const pel_time_t t_ns = SKY_T0 + p->epoch * PEL_NS_PER_S;
    scene_observe(&p->base, &p->orbits, t_ns, p->systems, base);
    scene_observe(&p->rover, &p->orbits, t_ns, p->systems, rover);
    add_noise(p, &p->base, base);
    add_noise(p, &p->rover, rover);
    p->epoch++;
}

bool pair_step(pair_t *p, pel_navigator_t *nav)
{
    static pel_epoch_t base, rover;
    pair_observe(p, &base, &rover);
    pel_navigator_push_base(nav, &base);
    pel_navigator_push_rover(nav, &rover);
    while (pel_navigator_flush(nav)) {}
    return nav->epoch_solution.fix == PEL_FIX_FIXED;
}

double pair_error_m(const pair_t *p, const pel_navigator_t *nav)
{
    double sq = 0.0;
    for (int k = 0; k < 3; k++) {
        const double d = nav->epoch_solution.r_eb_e[k] - p->rover.r_e[k];
        sq += d * d;
    }
    return sqrt(sq);
}

void pair_see_again(pel_navigator_t *nav)
{
    pel_view_t *view = &nav->view_rover;
    view->n = 0;
    for (int i = 0; i < nav->sd.n; i++) {
        const pel_sd_t *sd = &nav->sd.sd[i];
        if (pel_view_find(view, sd->sys, sd->prn) != NULL) { continue; }
        view->sight[view->n++] = (pel_sight_t){.sys = sd->sys, .prn = sd->prn, .el_rad = sd->el_rad};
    }
}

#include <string.h>

#include "pelorus/gnss.h"
#include "pelorus/math.h"

#include "normal.h"
#include "view_internal.h"

#define MAX_ITERATIONS    12
#define ATMOSPHERE_STEP_M 1.0 /* upwards, that is 0.3 mm of zenith delay */
#define GLO_CODE_SD       2.0 /* chips of twice the length, and a delay of its own on each frequency channel */

/* One least-squares problem, position from codes or velocity from Dopplers, with the same search for outliers. */
typedef struct {
    const pel_epoch_t *e;
    const pel_orbits_t *o;
    const pel_spp_config_t *cfg;
    pel_view_t *view;
    bool rate;                 /* velocity instead of position */
    bool sky;                  /* elevations and atmosphere are known */
    double x[3];               /* antenna position, or velocity */
    double r[3];               /* antenna position of the last atmosphere (code), of the antenna (rate) */
    double clk[PEL_N_SYS];     /* receiver clock or its rate, by clock_of() */
    int column[PEL_N_SYS];     /* of that clock among the unknowns, -1 none */
    int16_t obs[PEL_MAX_SATS]; /* observation of each sight, -1 none */
    bool out[PEL_MAX_SATS];    /* refused */
    int n_used;
    int n_out;
    double sse; /* sum of squared residuals in units of sigma */
    pel_normal_t q;
} problem_t;

void pel_spp_default(pel_spp_config_t *cfg)
{
    *cfg = (pel_spp_config_t){
        .mask_rad = 10.0 * PEL_DEG,
        .code_sd_m = 1.0,
        .doppler_sd_mps = 0.05,
        .p_false = 0.001,
        .max_exclude = 3,
        .sys_mask =
            (1u << PEL_SYS_GPS) | (1u << PEL_SYS_GLO) | (1u << PEL_SYS_GAL) | (1u << PEL_SYS_BDS) | (1u << PEL_SYS_QZS),
    };
}

/* L1 first, B1I next (the only one of many BeiDou receivers), then as numbered. */
static int carrier_rank(const pel_obs_t *obs)
{
    if (obs->carrier == PEL_CARRIER_L1) { return 0; }
    return (obs->carrier == PEL_CARRIER_B1I) ? 1 : 2 + obs->carrier;
}

/* The satellite's best-ranked observation with this part, -1 if none. */
static int16_t choose(const pel_epoch_t *e, const pel_sight_t *s, unsigned part)
{
    int16_t best = -1;
    for (int i = 0; i < e->n && i < PEL_MAX_OBS; i++) {
        const pel_obs_t *obs = &e->obs[i];
        if (obs->sys != s->sys || obs->prn != s->prn || !pel_obs_usable(obs, part)) { continue; }
        if (best < 0 || carrier_rank(obs) < carrier_rank(&e->obs[best])) { best = (int16_t)i; }
    }
    return best;
}

static void choose_observations(problem_t *p)
{
    for (int i = 0; i < p->view->n; i++) {
        p->obs[i] = choose(p->e, &p->view->sight[i], p->rate ? PEL_OBS_DOPPLER : PEL_OBS_CODE);
    }
}

/* Bring the view to the present unknowns. */
static void place(problem_t *p)
{
    if (p->rate) {
        pel_view_move(p->view, p->r, p->x);
        return;
    }
    pel_view_move(p->view, p->x, NULL);
    const double step[3] = {p->x[0] - p->r[0], p->x[1] - p->r[1], p->x[2] - p->r[2]};
    if (!pel_view_near_earth(p->x) || (p->sky && pel_norm3(step) < ATMOSPHERE_STEP_M)) { return; }
    memcpy(p->r, p->x, sizeof p->r);
    p->sky = true;
    pel_view_atmosphere(p->o, p->r, p->view);
}

static bool takes_part(const problem_t *p, int i)
{
    const pel_sight_t *s = &p->view->sight[i];
    return p->obs[i] >= 0 && !p->out[i] && !s->excluded && (!p->sky || (double)s->el_rad >= p->cfg->mask_rad);
}

static double variance(const problem_t *p, int i)
{
    const pel_sight_t *s = &p->view->sight[i];
    const double sin_el = p->sky ? pel_max(pel_sin((double)s->el_rad), 0.05) : 1.0;
    const double law = 0.5 + 0.5 / (sin_el * sin_el);
    if (p->rate) { return p->cfg->doppler_sd_mps * p->cfg->doppler_sd_mps * law; }

    const double iono_sd = (double)s->sd_iono_m;
    const double tropo_sd = 0.05 * s->tropo_m;
    const double eph_sd = (double)s->sd_eph_m;
    const double code_sd = p->cfg->code_sd_m * ((s->sys == PEL_SYS_GLO) ? GLO_CODE_SD : 1.0);
    return code_sd * code_sd * law + iono_sd * iono_sd + tropo_sd * tropo_sd + eph_sd * eph_sd;
}

/* Which of the clocks a system is on: rates have one for all, QZSS is on GPS time to 2 m with GPS's own signals. */
static int clock_of(const problem_t *p, uint8_t sys)
{
    return (p->rate || sys == PEL_SYS_QZS) ? PEL_SYS_GPS : sys;
}

/* Observation equation of sight i: z = h dx. */
static double row(const problem_t *p, int i, double h[NORMAL_MAX])
{
    const pel_sight_t *s = &p->view->sight[i];
    const pel_obs_t *obs = &p->e->obs[p->obs[i]];
    const int k = clock_of(p, s->sys);
    memset(h, 0, sizeof(double) * NORMAL_MAX);
    for (int j = 0; j < 3; j++) { h[j] = -s->u_e[j]; }
    h[p->column[k]] = 1.0;
    if (p->rate) { return -pel_obs_lambda_m(obs) * (double)obs->D_hz - pel_sight_rate_mps(s) - p->clk[k]; }
    return obs->P_m - pel_sight_code_m(s, obs) - p->clk[k];
}

/* Number the clocks of the systems that take part; returns the number of unknowns. */
static int number_unknowns(problem_t *p)
{
    bool present[PEL_N_SYS] = {false};
    int n = 3;
    p->n_used = 0;
    for (int i = 0; i < p->view->n; i++) {
        if (!takes_part(p, i)) { continue; }
        present[clock_of(p, p->view->sight[i].sys)] = true;
        p->n_used++;
    }
    for (int k = 0; k < PEL_N_SYS; k++) { p->column[k] = (present[k] && n < NORMAL_MAX) ? n++ : -1; }
    return n;
}

/* Gauss-Newton from the present unknowns. */
static pel_status_t iterate(problem_t *p)
{
    const double small = p->rate ? 1e-5 : 1e-3; /* m/s, m */
    double h[NORMAL_MAX];

    for (int it = 0; it < MAX_ITERATIONS; it++) {
        place(p);
        const bool had_sky = p->sky;
        const int n = number_unknowns(p);
        if (p->n_used < n) { return PEL_E_GEOMETRY; }
        pel_normal_begin(&p->q, n);
        for (int i = 0; i < p->view->n; i++) {
            if (!takes_part(p, i)) { continue; }
            const double z = row(p, i, h);
            pel_normal_add(&p->q, h, z, variance(p, i));
        }
        const pel_status_t status = pel_normal_solve(&p->q);
        if (status != PEL_OK) { return status; }

        for (int k = 0; k < 3; k++) { p->x[k] += p->q.b[k]; }
        for (int k = 0; k < PEL_N_SYS; k++) {
            if (p->column[k] >= 0) { p->clk[k] += p->q.b[p->column[k]]; }
        }
        if (pel_norm3(p->q.b) < small && (had_sky || !pel_view_near_earth(p->x))) { return PEL_OK; }
    }
    return PEL_E_NO_CONVERGENCE;
}

/* Residuals at the solution. Returns the satellite with the largest normalised one (v^2 over its own variance), -1 if all
 * are uncontrolled. */
static int residuals(problem_t *p)
{
    double h[NORMAL_MAX];
    double worst_sq = 0.0;
    int worst = -1;

    place(p);
    p->sse = 0.0;
    for (int i = 0; i < p->view->n; i++) {
        if (!takes_part(p, i)) { continue; }
        const double v = row(p, i, h);
        const double var = variance(p, i);
        const double var_v = var - pel_normal_var(&p->q, h);
        p->sse += v * v / var;
        if (var_v > 1e-6 * var && v * v / var_v > worst_sq) {
            worst_sq = v * v / var_v;
            worst = i;
        }
    }
    return worst;
}

/* Solve, test, exclude, again. PEL_OK or PEL_W_REJECTED with a solution, else < 0. */
static pel_status_t solve_and_test(problem_t *p, pel_nav_counters_t *count)
{
    choose_observations(p);
    for (int attempt = 0;; attempt++) {
        const pel_status_t status = iterate(p);
        if (status != PEL_OK) { return status; }
        const int worst = residuals(p);
        const int dof = p->n_used - p->q.n;
        if (dof == 0 || p->sse < pel_chi2_threshold(dof, 1.0 - p->cfg->p_false)) { return PEL_OK; }
        if (attempt >= p->cfg->max_exclude || dof < 2 || worst < 0) { return PEL_W_REJECTED; }
        p->out[worst] = true;
        p->n_out++;
        if (count != NULL) { count->sats_excluded++; }
    }
}

/* Residuals larger than their model make the covariance larger, smaller ones do not make it smaller. */
static double scaled_covariance(const problem_t *p, double cov[3][3])
{
    const int dof = p->n_used - p->q.n;
    const double unit_var = (dof > 0) ? p->sse / (double)dof : 0.0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { cov[i][j] = p->q.N[i][j] * pel_max(unit_var, 1.0); }
    }
    return pel_sqrt(unit_var);
}

static void deliver_position(const problem_t *p, pel_spp_t *out)
{
    int first = -1;
    memset(out, 0, sizeof *out);
    for (int k = PEL_N_SYS - 1; k >= 0; k--) {
        if (p->column[k] >= 0) { first = k; }
    }
    for (int k = 0; k < PEL_N_SYS; k++) {
        if (p->column[k] >= 0) { out->isb_m[k] = p->clk[k] - p->clk[first]; }
    }
    out->clk_m = p->clk[first];
    out->t_ns = p->e->t_ns - (int64_t)pel_round(out->clk_m / PEL_SPEED_OF_LIGHT * 1e9);
    memcpy(out->r_ea_e, p->x, sizeof out->r_ea_e);
    out->rms_m = scaled_covariance(p, out->cov_r_e);
    out->n_used = p->n_used;
    out->n_excluded = p->n_out;
}

static void solve_velocity(problem_t *p, pel_nav_counters_t *count, pel_spp_t *out)
{
    p->rate = true;
    memcpy(p->r, out->r_ea_e, sizeof p->r);
    memset(p->x, 0, sizeof p->x);
    memset(p->clk, 0, sizeof p->clk);
    memset(p->out, 0, sizeof p->out);
    if (solve_and_test(p, count) < PEL_OK || !(pel_norm3(p->x) < 1e4)) {
        pel_view_move(p->view, out->r_ea_e, NULL);
        return;
    }
    memcpy(out->v_ea_e, p->x, sizeof out->v_ea_e);
    out->clk_rate_mps = p->clk[PEL_SYS_GPS];
    (void)scaled_covariance(p, out->cov_v_e);
    out->has_velocity = true;
}

pel_status_t pel_spp_solve(const pel_epoch_t *e, const pel_orbits_t *o, const pel_spp_config_t *cfg,
                           const pel_spp_t *prior, pel_nav_counters_t *count, pel_view_t *view, pel_spp_t *out)
{
    problem_t p;
    memset(&p, 0, sizeof p);
    p.e = e;
    p.o = o;
    p.cfg = cfg;
    p.view = view;
    if (prior != NULL && pel_view_near_earth(prior->r_ea_e)) { memcpy(p.x, prior->r_ea_e, sizeof p.x); }

    pel_view_orbits(e, o, e->t_ns, cfg->sys_mask, count, view);
    if (view->n == 0) { return PEL_E_MISSING; }
    const pel_status_t status = solve_and_test(&p, count);
    if (status < PEL_OK) { return status; }
    if (!pel_view_near_earth(p.x)) { return PEL_E_GEOMETRY; }

    deliver_position(&p, out);
    for (int i = 0; i < view->n; i++) { view->sight[i].excluded = p.out[i]; }
    solve_velocity(&p, count, out);
    pel_view_apply_mask(cfg->mask_rad, count, view);
    return status;
}

#include "pelorus/gnss.h"
#include "pelorus/math.h"

pel_status_t pel_pair_epochs(const pel_epoch_t base[], int n, pel_time_t t_ns, double max_age_s, int *index,
                             double *age_s)
{
    int best = -1;
    double best_s = 0.0;
    for (int i = 0; i < n; i++) {
        if (base[i].n == 0) { continue; }
        const double d = pel_time_diff_s(t_ns, base[i].t_ns);
        if (best < 0 || pel_fabs(d) < pel_fabs(best_s)) {
            best = i;
            best_s = d;
        }
    }
    if (best < 0) { return PEL_E_MISSING; }
    if (pel_fabs(best_s) > max_age_s) { return PEL_E_STALE; }
    *index = best;
    *age_s = best_s;
    return PEL_OK;
}

static double sq(double x)
{
    return x * x;
}

/* GLONASS code: chips of twice the length; two receivers of one make share the delays of its channels. */
#define GLO_CODE_GAIN 4.0

/* Observed minus predicted of one receiver, what there is of it. */
typedef struct {
    bool has_code, has_phase, has_rate;
    double code_m, phase_m, rate_mps;
    double var_code, var_phase, var_rate;
} reduced_t;

static void reduce(const pel_obs_t *obs, const pel_sight_t *s, const pel_noise_config_t *noise, double factor,
                   reduced_t *r)
{
    const double sin_el = pel_sin((double)s->el_rad);
    const double cn0 = (double)obs->cn0_dbhz;
    const double gain = factor * factor;
    const unsigned parts = pel_obs_usable_parts(obs);
    r->has_code = (parts & PEL_OBS_CODE) != 0u;
    r->has_phase = (parts & PEL_OBS_PHASE) != 0u;
    r->has_rate = (parts & PEL_OBS_DOPPLER) != 0u;
    r->code_m = r->phase_m = r->rate_mps = 0.0;
    r->var_code = r->var_phase = r->var_rate = 0.0;
    if (r->has_code) {
        r->code_m = obs->P_m - pel_sight_code_m(s, obs);
        r->var_code =
            gain * ((obs->sys == PEL_SYS_GLO) ? GLO_CODE_GAIN : 1.0) * pel_noise_var(noise, PEL_OBS_CODE, sin_el, cn0);
    }
    if (r->has_phase) {
        r->phase_m = pel_obs_lambda_m(obs) * obs->L_cyc - pel_sight_phase_m(s, obs);
        r->var_phase = gain * pel_noise_var(noise, PEL_OBS_PHASE, sin_el, cn0);
    }
    if (r->has_rate) {
        r->rate_mps = -pel_obs_lambda_m(obs) * (double)obs->D_hz - pel_sight_rate_mps(s);
        r->var_rate = gain * pel_noise_var(noise, PEL_OBS_DOPPLER, sin_el, cn0);
    }
}

static void blank_row(const pel_obs_t *obs, const pel_sight_t *s, pel_sd_t *d)
{
    *d = (pel_sd_t){.sys = obs->sys, .prn = obs->prn, .carrier = obs->carrier, .glo_k = obs->glo_k};
    d->half = (obs->flags & PEL_OBS_HALF_CYCLE) != 0u;
    d->slip = (obs->flags & PEL_OBS_SLIP) != 0u;
    d->el_rad = s->el_rad;
    d->cn0_dbhz = obs->cn0_dbhz;
    d->lambda_m = pel_obs_lambda_m(obs);
    for (int k = 0; k < 3; k++) { d->u_e[k] = s->u_e[k]; }
}

/* How much of what a carrier can offer this row has; a phase without its integer counts nothing. */
static int completeness(const pel_sd_t *d)
{
    return (d->has_phase && !d->half && !d->slip ? 4 : 0) + (d->has_code ? 2 : 0) + (d->has_rate ? 1 : 0);
}

/* Put the pivot of rows first..n-1 in front, leaving the others in their order. */
static void pivot_first(pel_sd_set_t *out, int first)
{
    int best = first;
    for (int i = first + 1; i < out->n; i++) {
        const int more = completeness(&out->sd[i]) - completeness(&out->sd[best]);
        if (more > 0 || (more == 0 && out->sd[i].el_rad > out->sd[best].el_rad)) { best = i; }
    }
    const pel_sd_t pivot = out->sd[best];
    for (int i = best; i > first; i--) { out->sd[i] = out->sd[i - 1]; }
    out->sd[first] = pivot;
    out->sd[first].pivot = true;
}

static int order(const pel_sd_t *d)
{
    return 256 * d->sys + d->prn;
}

/* Insert by satellite among rows first..n-1 of the group being built; one that is there already stays as it is. */
static void insert_row(pel_sd_set_t *out, int first, const pel_sd_t *d)
{
    int at = out->n;
    while (at > first && order(&out->sd[at - 1]) > order(d)) { at--; }
    if ((at > first && order(&out->sd[at - 1]) == order(d)) || out->n >= PEL_MAX_OBS) { return; }
    for (int i = out->n; i > at; i--) { out->sd[i] = out->sd[i - 1]; }
    out->sd[at] = *d;
    out->sd[at].group = (uint8_t)out->n_groups;
    out->n++;
}

/* The base's observation for one of the rover's: same satellite and carrier, by preference the same code. */
static const pel_obs_t *counterpart(const pel_obs_t *obs, const pel_epoch_t *base)
{
    const pel_obs_t *any = NULL;
    for (int i = 0; i < base->n && i < PEL_MAX_OBS; i++) {
        const pel_obs_t *b = &base->obs[i];
        if (b->prn != obs->prn || b->sys != obs->sys || b->carrier != obs->carrier || b->glo_k != obs->glo_k) {
            continue;
        }
        if (b->code == obs->code) { return b; }
        if (any == NULL) { any = b; }
    }
    return any;
}

/* Is another of the rover's codes on this carrier the one the base has, while this one is not? b: its counterpart. */
static bool better_code_elsewhere(const pel_epoch_t *rover, int i, const pel_epoch_t *base, const pel_obs_t *b)
{
    const pel_obs_t *obs = &rover->obs[i];
    if (b->code == obs->code) { return false; }
    for (int k = 0; k < rover->n && k < PEL_MAX_OBS; k++) {
        const pel_obs_t *other = &rover->obs[k];
        if (k == i || other->prn != obs->prn || other->sys != obs->sys || other->carrier != obs->carrier) { continue; }
        const pel_obs_t *ob = counterpart(other, base);
        if (ob != NULL && ob->code == other->code) { return true; }
    }
    return false;
}

static bool same_ephemeris(const pel_sight_t *a, const pel_sight_t *b)
{
    return a->iode == b->iode && a->toe_gps_s == b->toe_gps_s && a->source == b->source;
}

/* Everything one row needs to be made. base == NULL: a receiver alone. */
typedef struct {
    const pel_epoch_t *rover, *base;
    const pel_view_t *rover_view, *base_view;
    const pel_noise_config_t *noise;
    double var_age; /* m^2 */
} pair_t;

/* One receiver alone keeps the errors of orbit, clock and atmosphere; a base takes them away. Rates: 1 mm/s for what those
 * errors change in a second. */
static bool single_receiver_row(const pair_t *p, const pel_obs_t *obs, const pel_sight_t *s, pel_sd_t *d)
{
    reduced_t r;
    reduce(obs, s, p->noise, p->noise->rover_factor, &r);
    const double f1 = pel_carrier_hz(PEL_SYS_GPS, PEL_CARRIER_L1, 0);
    const double l1 = PEL_SPEED_OF_LIGHT / f1;
    blank_row(obs, s, d);
    const double iono_sd = (double)s->sd_iono_m * sq(d->lambda_m / l1);
    d->has_code = r.has_code;
    d->has_phase = r.has_phase;
    d->has_rate = r.has_rate;
    d->code_m = r.code_m;
    d->phase_m = r.phase_m;
    d->rate_mps = r.rate_mps;
    if (r.has_code) { d->var_code = r.var_code + sq((double)s->sd_eph_m) + sq(iono_sd) + sq(0.05 * s->tropo_m); }
    d->var_phase = r.var_phase;
    if (r.has_rate) { d->var_rate = r.var_rate + sq(0.001); }
    return r.has_code || r.has_phase || r.has_rate;
}

static bool differenced_row(const pair_t *p, int i, const pel_sight_t *s, pel_sd_t *d)
{
    const pel_obs_t *obs = &p->rover->obs[i];
    const pel_sight_t *sb = pel_view_find(p->base_view, obs->sys, obs->prn);
    const pel_obs_t *ob = counterpart(obs, p->base);
    if (sb == NULL || ob == NULL || sb->excluded || !same_ephemeris(s, sb)) { return false; }
    if (better_code_elsewhere(p->rover, i, p->base, ob)) { return false; }

    reduced_t a, b;
    reduce(obs, s, p->noise, p->noise->rover_factor, &a);
    reduce(ob, sb, p->noise, p->noise->base_factor, &b);
    blank_row(obs, s, d);
    d->half = d->half || (ob->flags & PEL_OBS_HALF_CYCLE) != 0u;
    d->slip = d->slip || (ob->flags & PEL_OBS_SLIP) != 0u;
    d->has_code = a.has_code && b.has_code;
    d->has_phase = a.has_phase && b.has_phase;
    d->has_rate = a.has_rate && b.has_rate;
    if (d->has_code) {
        d->code_m = a.code_m - b.code_m;
        d->var_code = a.var_code + b.var_code + p->var_age;
    }
    if (d->has_phase) {
        d->phase_m = a.phase_m - b.phase_m;
        d->var_phase = a.var_phase + b.var_phase + p->var_age;
    }
    if (d->has_rate) {
        d->rate_mps = a.rate_mps - b.rate_mps;
        d->var_rate = a.var_rate + b.var_rate;
    }
    return d->has_code || d->has_phase || d->has_rate;
}

static unsigned systems_in(const pel_sd_set_t *set)
{
    unsigned systems = 0;
    for (int i = 0; i < set->n; i++) { systems |= 1u << set->sd[i].sys; }
    return systems;
}

/* The carriers of each system that an epoch has, as bits. */
static void carriers_of(const pel_epoch_t *e, unsigned carriers[PEL_N_SYS])
{
    for (int sys = 0; sys < PEL_N_SYS; sys++) { carriers[sys] = 0u; }
    for (int i = 0; i < e->n && i < PEL_MAX_OBS; i++) {
        const pel_obs_t *obs = &e->obs[i];
        if (obs->sys < PEL_N_SYS && obs->carrier < PEL_N_CARRIER) { carriers[obs->sys] |= 1u << obs->carrier; }
    }
}

/* Append one group: the rows of these systems on one carrier. */
static void form_group(const pair_t *p, unsigned systems, int carrier, pel_sd_set_t *out)
{
    pel_sd_t d;
    const int first = out->n;
    for (int i = 0; i < p->rover->n && i < PEL_MAX_OBS; i++) {
        const pel_obs_t *obs = &p->rover->obs[i];
        if (obs->carrier != carrier || obs->sys >= PEL_N_SYS || (systems & (1u << obs->sys)) == 0) { continue; }
        const pel_sight_t *s = pel_view_find(p->rover_view, obs->sys, obs->prn);
        if (s == NULL || s->excluded) { continue; }
        const bool made = (p->base != NULL) ? differenced_row(p, i, s, &d) : single_receiver_row(p, obs, s, &d);
        if (made) { insert_row(out, first, &d); }
    }
    if (out->n == first) { return; }
    pivot_first(out, first);
    out->n_groups++;
}

/* Append the rows of all systems but these. QZSS is on GPS time to 2 m and its signals are GPS's own (IS-QZSS-PNT), so a receiver alone sees one
 * clock in both; rover minus base keeps them apart. */
static pel_status_t form(const pair_t *p, unsigned but, pel_sd_set_t *out)
{
    unsigned carriers[PEL_N_SYS];
    const int before = out->n;
    const unsigned joined = (p->base == NULL) ? 1u << PEL_SYS_QZS : 0u; /* to GPS */
    carriers_of(p->rover, carriers);
    if (joined != 0u) { carriers[PEL_SYS_GPS] |= carriers[PEL_SYS_QZS]; }
    for (unsigned sys = 0; sys < PEL_N_SYS; sys++) {
        unsigned systems = (1u << sys) & ~(but | joined);
        if (sys == PEL_SYS_GPS) { systems |= joined; }
        for (int carrier = 0; systems != 0u && carrier < PEL_N_CARRIER; carrier++) {
            if ((carriers[sys] & (1u << carrier)) != 0u) { form_group(p, systems, carrier, out); }
        }
    }
    return (out->n > before) ? PEL_OK : PEL_E_MISSING;
}

static void begin(const pel_epoch_t *rover, pel_sd_set_t *out)
{
    out->t_ns = rover->t_ns;
    out->n = 0;
    out->n_groups = 0;
}

static pair_t pair(const pel_epoch_t *rover, const pel_view_t *rover_view, const pel_epoch_t *base,
                   const pel_view_t *base_view, const pel_noise_config_t *noise, double base_age_s)
{
    return (pair_t){.rover = rover,
                    .base = base,
                    .rover_view = rover_view,
                    .base_view = base_view,
                    .noise = noise,
                    .var_age = sq(noise->sat_clock_mps * base_age_s)};
}

pel_status_t pel_sd_form(const pel_epoch_t *rover, const pel_view_t *rover_view, const pel_epoch_t *base,
                         const pel_view_t *base_view, const pel_noise_config_t *noise, double base_age_s,
                         pel_sd_set_t *out)
{
    const pair_t p = pair(rover, rover_view, base, base_view, noise, base_age_s);
    begin(rover, out);
    return form(&p, 0, out);
}

pel_status_t pel_sd_add_missing(const pel_epoch_t *rover, const pel_view_t *rover_view, const pel_epoch_t *base,
                                const pel_view_t *base_view, const pel_noise_config_t *noise, double base_age_s,
                                pel_sd_set_t *out)
{
    const pair_t p = pair(rover, rover_view, base, base_view, noise, base_age_s);
    return form(&p, systems_in(out), out);
}

pel_status_t pel_sd_undifferenced(const pel_epoch_t *rover, const pel_view_t *view, const pel_noise_config_t *noise,
                                  pel_sd_set_t *out)
{
    const pair_t p = {.rover = rover, .rover_view = view, .noise = noise};
    begin(rover, out);
    return form(&p, 0, out);
}

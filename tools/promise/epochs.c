#include "promise/epochs.h"

#include <math.h>
#include <string.h>

#define LIGHT   299792458.0
#define F1      1575.42e6
#define SYSTEMS 4
#define DAY_S   86400.0

static const double carriers[SYSTEMS][3] = {
    {1575.42e6, 1227.60e6, 1176.45e6},  /* GPS */
    {1575.42e6, 1176.45e6, 1207.14e6},  /* Galileo */
    {1561.098e6, 1268.52e6, 1207.14e6}, /* BeiDou */
    {1575.42e6, 1227.60e6, 1176.45e6},  /* QZSS */
};

/* Single-difference standard deviations at the zenith, m. */
typedef struct {
    double code, phase, iono;
    double noise;
    int n_carrier;
    double b[3]; /* true - predicted */
} scene_t;

/* Errors of one satellite's single differences. */
typedef struct {
    double range, iono, code[3], phase[3];
} errors_t;

static double logarithmic(rng_t *r, double low, double high)
{
    return low * pow(high / low, rng_uniform(r));
}

static scene_t random_scene(rng_t *r, double noise, pel_amb_problem_t *p)
{
    scene_t s = {.noise = noise};
    s.n_carrier = rng_int(r, 1, 3);
    s.code = logarithmic(r, 0.1, 3.0);
    s.phase = 0.002 + 0.002 * rng_uniform(r);
    s.iono = 1e-6 * logarithmic(r, 100.0, 60e3);
    p->have_prior = rng_uniform(r) < 0.3;
    const double prior = p->have_prior ? logarithmic(r, 0.02, 1.0) : 0.0;
    for (int i = 0; i < 3; i++) {
        p->P_r[i][i] = prior * prior;
        s.b[i] = prior * rng_gauss(r);
    }
    p->var_iono = s.iono * s.iono;
    return s;
}

static errors_t random_errors(const scene_t *s, rng_t *r, const double u[3], double var)
{
    errors_t e = {.range = -(u[0] * s->b[0] + u[1] * s->b[1] + u[2] * s->b[2])};
    e.iono = s->noise * s->iono * rng_gauss(r);
    for (int f = 0; f < s->n_carrier; f++) {
        e.code[f] = s->noise * s->code * sqrt(var) * rng_gauss(r);
        e.phase[f] = s->noise * s->phase * sqrt(var) * rng_gauss(r);
    }
    return e;
}

static double variance(double el)
{
    return 0.5 + 0.5 / (sin(el) * sin(el));
}

/* Double differences of one system: a group for each carrier, the highest satellite the pivot; satellites are numbered from `first`. */
static void add_system(promise_epoch_t *e, const scene_t *s, rng_t *r, int system, const sky_t *sky, int n_sat,
                       int first)
{
    pel_amb_problem_t *p = &e->problem;
    errors_t err[SKY_MAX];
    for (int k = 0; k < n_sat; k++) { err[k] = random_errors(s, r, sky->u[k], variance(sky->el[k])); }
    for (int f = 0; f < s->n_carrier; f++) {
        const double frequency = carriers[system][f];
        const double mu = (F1 / frequency) * (F1 / frequency);
        p->group[p->n_groups] = (pel_amb_group_t){.sat = (uint8_t)first,
                                                  .mu = mu,
                                                  .var_phase = s->phase * s->phase * variance(sky->el[0]),
                                                  .var_code = s->code * s->code * variance(sky->el[0])};
        for (int k = 1; k < n_sat; k++) {
            pel_amb_row_t *row = &p->row[p->n_rows];
            const double range = err[k].range - err[0].range;
            const double iono = mu * (err[k].iono - err[0].iono);
            *row = (pel_amb_row_t){.group = (uint8_t)p->n_groups,
                                   .sat = (uint8_t)(first + k),
                                   .integer = true,
                                   .code = true,
                                   .lambda_m = LIGHT / frequency,
                                   .var_phase = s->phase * s->phase * variance(sky->el[k]),
                                   .var_code = s->code * s->code * variance(sky->el[k])};
            for (int i = 0; i < 3; i++) { row->g[i] = sky->u[0][i] - sky->u[k][i]; }
            const int64_t N = rng_int(r, -1000000, 1000000);
            e->truth[p->n_rows++] = N;
            row->code_m = range + iono + err[k].code[f] - err[0].code[f];
            row->phase_m = range - iono + err[k].phase[f] - err[0].phase[f] + row->lambda_m * (double)N;
        }
        p->n_groups++;
    }
}

void promise_epoch(rng_t *r, double noise, promise_epoch_t *e)
{
    do {
        memset(e, 0, sizeof *e);
        const scene_t s = random_scene(r, noise, &e->problem);
        const int n_systems = rng_int(r, 1, SYSTEMS);
        const double lat = 120.0 * rng_uniform(r) - 60.0;
        const double lon = 360.0 * rng_uniform(r);
        int n_all = 0; /* satellites */
        for (int k = 0; k < n_systems; k++) {
            const sky_t sky = sky_of(lat, lon, 0.0, DAY_S * rng_uniform(r), 10.0);
            const int room = (PEL_MAX_AMB - e->problem.n_rows) / s.n_carrier + 1;
            const int n_sat = (sky.n < room) ? sky.n : room;
            if (n_sat < 2) { continue; }
            add_system(e, &s, r, k, &sky, n_sat, n_all);
            n_all += n_sat;
        }
    } while (e->problem.n_rows < 4);
}

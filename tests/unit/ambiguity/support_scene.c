#include "support_scene.h"

#include <math.h>
#include <string.h>

#define PI    3.14159265358979323846
#define LIGHT 299792458.0
#define F1    1575.42e6

static const double carriers[3][2] = {
    {1575.42e6, 1227.60e6}, {1575.42e6, 1176.45e6}, {1561.098e6, 1268.52e6}}; /* GPS, Galileo, BeiDou */

/* One satellite: direction and the errors of its single differences, carrier by carrier. */
typedef struct {
    double u[3];
    double iono;
    double code[2], phase[2];
    double var_code, var_phase;
    bool second;
} seen_t;

static seen_t see(const scene_case_t *c, rng_t *r, double sin_low, bool pivot)
{
    seen_t s;
    const double z = sin_low + (0.98 - sin_low) * rng_uniform(r);
    const double az = 2.0 * PI * rng_uniform(r);
    s.u[0] = sqrt(1.0 - z * z) * cos(az);
    s.u[1] = sqrt(1.0 - z * z) * sin(az);
    s.u[2] = z;
    const double scale = 0.5 + 0.5 / (z * z);
    s.var_code = c->sd_code * c->sd_code * scale;
    s.var_phase = c->sd_phase * c->sd_phase * scale + c->sd_low * c->sd_low / (z * z);
    s.iono = c->sd_iono * rng_gauss(r);
    for (int f = 0; f < 2; f++) {
        s.code[f] = sqrt(s.var_code) * rng_gauss(r);
        s.phase[f] = sqrt(s.var_phase) * rng_gauss(r);
    }
    s.second = pivot || rng_uniform(r) >= c->one_carrier;
    return s;
}

static void add_row(scene_t *e, rng_t *r, int f, const seen_t *s, const seen_t *pivot, uint8_t sat)
{
    pel_amb_problem_t *p = &e->problem;
    const pel_amb_group_t *g = &p->group[p->n_groups - 1];
    pel_amb_row_t *row = &p->row[p->n_rows];
    *row = (pel_amb_row_t){.group = (uint8_t)(p->n_groups - 1),
                           .sat = sat,
                           .integer = true,
                           .code = true,
                           .lambda_m = sqrt(g->mu) * LIGHT / F1,
                           .var_phase = s->var_phase,
                           .var_code = s->var_code};
    double range = 0.0;
    for (int k = 0; k < 3; k++) {
        row->g[k] = pivot->u[k] - s->u[k];
        range += row->g[k] * e->b[k];
    }
    const double iono = g->mu * (s->iono - pivot->iono);
    e->truth[p->n_rows] = rng_int(r, -1000000, 1000000);
    row->code_m = range + iono + s->code[f] - pivot->code[f];
    row->phase_m = range - iono + s->phase[f] - pivot->phase[f] + row->lambda_m * (double)e->truth[p->n_rows];
    p->n_rows++;
}

scene_t scene_draw(const scene_case_t *c, rng_t *r)
{
    scene_t e;
    memset(&e, 0, sizeof e);
    pel_amb_problem_t *p = &e.problem;
    p->have_prior = c->sd_prior > 0.0;
    p->var_iono = c->sd_iono * c->sd_iono;
    for (int k = 0; k < 3; k++) {
        e.b[k] = c->sd_prior * rng_gauss(r);
        p->P_r[k][k] = c->sd_prior * c->sd_prior;
    }
    for (int sys = 0; sys < c->n_sys; sys++) {
        seen_t sat[SKY_MAX];
        for (int s = 0; s < c->n_sat; s++) { sat[s] = see(c, r, (s == 0) ? 0.8 : 0.17, s == 0); }
        for (int f = 0; f < c->n_carrier; f++) {
            const double ratio = F1 / carriers[sys][f];
            p->group[p->n_groups++] = (pel_amb_group_t){.sat = (uint8_t)(15 * sys),
                                                        .mu = ratio * ratio,
                                                        .var_phase = sat[0].var_phase,
                                                        .var_code = sat[0].var_code};
            for (int s = 1; s < c->n_sat; s++) {
                if (f == 0 || sat[s].second) { add_row(&e, r, f, &sat[s], &sat[0], (uint8_t)(15 * sys + s)); }
            }
        }
    }
    return e;
}

bool scene_right(const scene_t *s, const pel_amb_problem_t *p, const int64_t *N)
{
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].integer && N[i] != s->truth[i]) { return false; }
    }
    return true;
}

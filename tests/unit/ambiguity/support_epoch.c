#include "support_epoch.h"

#include <math.h>
#include <string.h>

epoch_t epoch_draw(const case_t *c, rng_t *r)
{
    const sky_t sky = sky_of(30.5, 114.3, 1500.0, c->t_s, 10.0);
    const double mu2 = (LAMBDA2 / LAMBDA1) * (LAMBDA2 / LAMBDA1);
    epoch_t e;
    memset(&e, 0, sizeof e);
    e.m = sky.n - 1;

    double b[3] = {0.0}; /* true - predicted */
    for (int k = 0; k < 3; k++) { b[k] = c->sd_prior * rng_gauss(r); }
    double P[SKY_MAX], L1[SKY_MAX], L2[SKY_MAX], I[SKY_MAX]; /* single-difference noise */
    for (int s = 0; s < sky.n; s++) {
        P[s] = sqrt(2.0) * c->sd_code * rng_gauss(r);
        L1[s] = sqrt(2.0) * c->sd_phase * rng_gauss(r);
        L2[s] = sqrt(2.0) * c->sd_phase * rng_gauss(r);
        I[s] = sqrt(0.5) * c->sd_iono * rng_gauss(r);
    }

    pel_amb_problem_t *p = &e.problem;
    p->n_rows = 2 * e.m;
    p->n_groups = 2;
    p->have_prior = c->sd_prior > 0.0;
    for (int k = 0; k < 3; k++) { p->P_r[k][k] = c->sd_prior * c->sd_prior; }
    p->var_iono = c->iono_modelled ? 0.5 * c->sd_iono * c->sd_iono : 0.0;
    for (int g = 0; g < 2; g++) {
        p->group[g] = (pel_amb_group_t){.sat = (uint8_t)sky.id[0],
                                        .mu = (g == 0) ? 1.0 : mu2,
                                        .var_phase = 2.0 * c->sd_phase * c->sd_phase,
                                        .var_code = 2.0 * c->sd_code * c->sd_code};
    }
    e.band = (pel_band_input_t){.m = e.m,
                                .lambda1_m = LAMBDA1,
                                .lambda2_m = LAMBDA2,
                                .sd_code_m = c->sd_code,
                                .sd_phase_m = c->sd_phase,
                                .have_prior = p->have_prior};
    memcpy(e.band.P_r, p->P_r, sizeof p->P_r);

    for (int i = 0; i < e.m; i++) {
        const int s = i + 1;
        double g[3];
        double range = 0.0;
        for (int k = 0; k < 3; k++) {
            g[k] = -(sky.u[s][k] - sky.u[0][k]);
            range += g[k] * b[k];
        }
        const double iono = c->iono_independent ? c->sd_iono * rng_gauss(r) : I[s] - I[0];
        e.N1[i] = rng_int(r, -1000000, 1000000);
        e.N2[i] = rng_int(r, -1000000, 1000000);
        const double code = range + P[s] - P[0] + iono;
        const double phase1 = range + L1[s] - L1[0] - iono + LAMBDA1 * (double)e.N1[i];
        const double phase2 = range + L2[s] - L2[0] - mu2 * iono + LAMBDA2 * (double)e.N2[i];
        for (int f = 0; f < 2; f++) {
            pel_amb_row_t *row = &p->row[f * e.m + i];
            *row = (pel_amb_row_t){.group = (uint8_t)f,
                                   .sat = (uint8_t)sky.id[s],
                                   .integer = true,
                                   .code = f == 0, /* C/A code alone */
                                   .g = {g[0], g[1], g[2]},
                                   .lambda_m = (f == 0) ? LAMBDA1 : LAMBDA2,
                                   .phase_m = (f == 0) ? phase1 : phase2,
                                   .code_m = (f == 0) ? code : 0.0,
                                   .var_phase = p->group[f].var_phase,
                                   .var_code = p->group[f].var_code};
        }
        memcpy(e.band.G[i], g, sizeof g);
        e.band.L1_m[i] = phase1;
        e.band.L2_m[i] = phase2;
        e.band.P_m[i] = code;
    }
    return e;
}

#include "support_wide_lane.h"

#include <math.h>
#include <string.h>

#define SD_CYCLES 0.01               /* undifferenced, each carrier */
#define IONO_M    0.003              /* single difference at the zenith: 0.5 ppm of 6 km */
#define IONO_WIDE 1.2833333333333333 /* f1 / f2: delayed like a code */
#define MARGIN_M  0.008              /* for it in the filter's sigma */

static double noise_wide(void)
{
    return LAMBDA_W * SD_CYCLES * 2.0; /* two carriers, two receivers */
}

double wl_sd_phase(void)
{
    return sqrt(noise_wide() * noise_wide() + MARGIN_M * MARGIN_M);
}

static void inverse3(double A[3][3], double out[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const int r = (j + 1) % 3, s = (j + 2) % 3, p = (i + 1) % 3, q = (i + 2) % 3;
            out[i][j] = A[r][p] * A[s][q] - A[r][q] * A[s][p];
        }
    }
    const double det = A[0][0] * out[0][0] + A[0][1] * out[1][0] + A[0][2] * out[2][0];
    for (int k = 0; k < 9; k++) { out[k / 3][k % 3] /= det; }
}

/* N_F and Q of (4), W = I - 1 1' / (n + 1) for n double differences. */
static void float_solution(wl_epoch_t *e, double var_code, const double *code, const double *phase)
{
    double sum_g[3] = {0}, sum_y = 0, A[3][3], P[3][3], c[3] = {0}, x[3];
    const double share = 1.0 / (e->n + 1);
    for (int i = 0; i < e->n; i++) {
        for (int k = 0; k < 3; k++) { sum_g[k] += e->g[i][k]; }
        sum_y += code[i];
    }
    for (int k = 0; k < 3; k++) {
        c[k] = -share * sum_g[k] * sum_y;
        for (int m = 0; m < 3; m++) {
            A[k][m] = -share * sum_g[k] * sum_g[m];
            for (int i = 0; i < e->n; i++) { A[k][m] += e->g[i][k] * e->g[i][m]; }
        }
        for (int i = 0; i < e->n; i++) { c[k] += e->g[i][k] * code[i]; }
    }
    inverse3(A, P);
    for (int k = 0; k < 3; k++) { x[k] = P[k][0] * c[0] + P[k][1] * c[1] + P[k][2] * c[2]; }
    const double var_phase = wl_sd_phase() * wl_sd_phase();
    for (int i = 0, at = 0; i < e->n; i++) {
        e->a[i] = phase[i];
        for (int k = 0; k < 3; k++) { e->a[i] -= e->g[i][k] * x[k]; }
        e->a[i] /= LAMBDA_W;
        for (int j = 0; j <= i; j++) {
            double q = var_phase * ((i == j) ? 2.0 : 1.0);
            for (int k = 0; k < 9; k++) { q += var_code * e->g[i][k / 3] * P[k / 3][k % 3] * e->g[j][k % 3]; }
            e->Q[at++] = q / (LAMBDA_W * LAMBDA_W);
        }
    }
}

wl_epoch_t wl_draw(const wl_case_t *c, double t_s, rng_t *r)
{
    const sky_t sky = ((c->n_sat > 0) ? sky_of : sky_of_30)(28.22, 112.99, 50.0, t_s, 10.0);
    const int n_sat = (c->n_sat > 0) ? c->n_sat : sky.n;
    const double sd_code = sqrt(2.0) * c->sd_code;
    wl_epoch_t e;
    memset(&e, 0, sizeof e);
    if (sky.n < n_sat) { return e; }
    e.n = n_sat - 1;
    double b[3], code[SKY_MAX], phase[SKY_MAX];
    for (int k = 0; k < 3; k++) { b[k] = rng_gauss(r); } /* the approximate position is a metre off */
    for (int s = 0; s < n_sat; s++) {
        const double iono = IONO_M / sin(sky.el[s]);
        code[s] = iono + sd_code * rng_gauss(r);
        phase[s] = IONO_WIDE * iono + noise_wide() * rng_gauss(r);
    }
    pel_amb_problem_t *p = &e.problem;
    p->n_groups = 1;
    p->group[0] = (pel_amb_group_t){.sat = (uint8_t)sky.id[0],
                                    .mu = 1.0,
                                    .var_phase = wl_sd_phase() * wl_sd_phase(),
                                    .var_code = sd_code * sd_code};
    double dd_code[WL_MAX], dd_phase[WL_MAX];
    for (int i = 0; i < e.n; i++) {
        double range = 0.0;
        for (int k = 0; k < 3; k++) {
            e.g[i][k] = -(sky.u[i + 1][k] - sky.u[0][k]);
            range += e.g[i][k] * b[k];
        }
        /* an integer of its own for each satellite, the same in all epochs whoever is pivot */
        e.truth[i] = 1009 * (sky.id[i + 1] % 7) - 31 * sky.id[i + 1] - (1009 * (sky.id[0] % 7) - 31 * sky.id[0]);
        dd_code[i] = range + code[i + 1] - code[0];
        dd_phase[i] = range + phase[i + 1] - phase[0] + LAMBDA_W * (double)e.truth[i];
        pel_amb_row_t *row = &p->row[p->n_rows++];
        *row = (pel_amb_row_t){.sat = (uint8_t)sky.id[i + 1],
                               .integer = true,
                               .code = true,
                               .g = {e.g[i][0], e.g[i][1], e.g[i][2]},
                               .lambda_m = LAMBDA_W,
                               .phase_m = dd_phase[i],
                               .code_m = dd_code[i],
                               .var_phase = p->group[0].var_phase,
                               .var_code = p->group[0].var_code};
    }
    float_solution(&e, sd_code * sd_code, dd_code, dd_phase);
    return e;
}

/* path_fit.c - drift of a pair of satellites from a static segment: least squares from running sums (S3 section 7). */
#include <string.h>

#include "pelorus/math.h"
#include "pelorus/observe.h"

#define UNIT_S      100.0 /* of time in the sums, which keeps their powers apart by little */
#define MIN_SAMPLES 30
#define LONG_S      600.0 /* from here on second order is always good */

void pel_path_fit_init(pel_path_fit_t *f)
{
    memset(f, 0, sizeof *f);
}

void pel_path_fit_add(pel_path_fit_t *f, double t_s, double s_m)
{
    if (f->n == 0) {
        f->t0_s = t_s;
        f->s0_m = s_m;
    }
    const double t = (t_s - f->t0_s) / UNIT_S;
    const double s = s_m - f->s0_m;
    double power = 1.0;
    for (int k = 0; k < 5; k++) {
        f->st[k] += power;
        if (k < 3) { f->ss[k] += s * power; }
        power *= t;
    }
    f->s2 += s * s;
    f->last_s = t_s - f->t0_s;
    f->n++;
}

/* Normal equations on t scaled to [0, 1]: coefficients, their cofactors' diagonal and the sum of squares. False if singular. */
static bool solve(const pel_path_fit_t *f, int order, double p[3], double cofactor[3], double *sum_sq)
{
    const double scale = UNIT_S / f->last_s;
    double N[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    double y[3] = {0.0, 0.0, 0.0};
    double inverse[3][3];
    double powers[5];
    powers[0] = 1.0;
    for (int k = 1; k < 5; k++) { powers[k] = powers[k - 1] * scale; }
    for (int i = 0; i <= order; i++) {
        y[i] = f->ss[i] * powers[i];
        for (int j = 0; j <= order; j++) { N[i][j] = f->st[i + j] * powers[i + j]; }
    }
    if (pel_mat3_inverse(N, inverse) != PEL_OK) { return false; }
    pel_mat3_vec(inverse, y, p);
    *sum_sq = f->s2 - pel_dot3(p, y);
    for (int i = 0; i < 3; i++) { cofactor[i] = inverse[i][i]; }
    return true;
}

/* Condition by row sums of N and its inverse is below 1e6 whenever samples are spread: what is tested is that they are. */
static bool spread(const pel_path_fit_t *f)
{
    const double mean = f->st[1] / f->st[0];
    const double var = f->st[2] / f->st[0] - mean * mean;
    const double length = f->last_s / UNIT_S;
    return var > 0.02 * length * length; /* even sampling has 1/12 */
}

pel_status_t pel_path_fit_solve(const pel_path_fit_t *f, double path_m_rts, pel_path_t *out)
{
    double p[3];
    double cofactor[3];
    double sum_sq;
    const double T = f->last_s;
    const double q = 2.0 * path_m_rts * path_m_rts; /* of the pair, m^2/s */
    if (f->n < MIN_SAMPLES || !(T >= PEL_PATH_MIN_S) || !spread(f)) { return PEL_E_GEOMETRY; }
    if (!solve(f, 2, p, cofactor, &sum_sq)) { return PEL_E_GEOMETRY; }

    /* A random walk of q m^2/s moves the fitted coefficients (scaled time) by 30/7 q T and 6/5 q T: integrals of the squared
     * primitives of the estimator's weights, 180 (t^2 - t + 1/6) and 12 (t - 1/2). */
    int order = 2;
    const double white = pel_max(sum_sq, 0.0) / (double)(f->n - 3);
    const double var_p2 = white * cofactor[2] + 30.0 / 7.0 * q * T;
    if (T < LONG_S && p[2] * p[2] <= 9.0 * var_p2) {
        order = 1;
        (void)solve(f, 1, p, cofactor, &sum_sq); /* a line through samples that are spread is never singular */
        p[2] = 0.0;
    }
    /* the rate at the segment's end: as uncertain as at its start, and moved by 192/35 q T (second order) */
    const double noise = pel_max(sum_sq, 0.0) / (double)(f->n - 1 - order);
    const double var_rate = noise * cofactor[1] + ((order == 2) ? 192.0 / 35.0 : 6.0 / 5.0) * q * T;

    out->order = order;
    out->t0_s = f->t0_s;
    out->p[0] = p[0] + f->s0_m;
    out->p[1] = p[1] / T;
    out->p[2] = p[2] / (T * T);
    out->sd_rate_mps = pel_max(pel_sqrt(var_rate) / T, PEL_PATH_SD_RATE);
    out->rms_m = pel_sqrt(pel_max(sum_sq, 0.0) / (double)f->n);
    return PEL_OK;
}

double pel_path_at(const pel_path_t *p, double t_s)
{
    const double t = t_s - p->t0_s;
    return p->p[0] + t * (p->p[1] + t * p->p[2]);
}

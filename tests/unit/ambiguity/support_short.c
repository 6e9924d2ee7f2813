#include "support_short.h"

#include <math.h>
#include <string.h>

#define PI      3.14159265358979323846
#define LAT_DEG 32.04
#define LON_DEG 118.8
#define MASK    10.0

/* East, north, up to ECEF. */
static void to_ecef(const double enu[3], double e[3])
{
    const double lat = LAT_DEG * PI / 180.0;
    const double lon = LON_DEG * PI / 180.0;
    e[0] = -sin(lon) * enu[0] - sin(lat) * cos(lon) * enu[1] + cos(lat) * cos(lon) * enu[2];
    e[1] = cos(lon) * enu[0] - sin(lat) * sin(lon) * enu[1] + cos(lat) * sin(lon) * enu[2];
    e[2] = cos(lat) * enu[1] + sin(lat) * enu[2];
}

void short_start(short_run_t *run, const short_t *with, rng_t *r)
{
    const double heading = 40.0 * PI / 180.0;
    const double pitch = 2.0 * PI / 180.0;
    const double enu[3] = {with->length_m * sin(heading) * cos(pitch), with->length_m * cos(heading) * cos(pitch),
                           with->length_m * sin(pitch)};
    const sky_t sky = sky_of(LAT_DEG, LON_DEG, 40.0, with->t_s, MASK);
    memset(run, 0, sizeof *run);
    run->with = *with;
    run->t_s = with->t_s;
    run->n_sat = sky.n;
    memcpy(run->id, sky.id, sizeof run->id);
    to_ecef(enu, run->b);
    for (int a = 0; a < 2; a++) {
        for (int s = 0; s < run->n_sat; s++) { run->multipath[a][s] = with->sd_multipath * rng_gauss(r); }
    }
}

/* Direction of satellite `id`, which may have sunk below the mask since the start. */
static const double *direction(const sky_t *sky, int id)
{
    int k = 0;
    while (k < sky->n - 1 && sky->id[k] != id) { k++; }
    return sky->u[k];
}

static double phase_noise(short_run_t *run, int antenna, int s, rng_t *r)
{
    const short_t *with = &run->with;
    double *m = &run->multipath[antenna][s];
    const double keeps = (with->tau_s > 0.0) ? exp(-1.0 / with->tau_s) : 0.0;
    const double now = *m;
    *m = keeps * now + sqrt(1.0 - keeps * keeps) * with->sd_multipath * rng_gauss(r);
    return now + with->sd_phase * rng_gauss(r);
}

void short_epoch(short_run_t *run, rng_t *r)
{
    const sky_t sky = sky_of(LAT_DEG, LON_DEG, 40.0, run->t_s, -90.0);
    const double *pivot = direction(&sky, run->id[0]);
    double phase[SKY_MAX], code[SKY_MAX];
    for (int s = 0; s < run->n_sat; s++) {
        phase[s] = phase_noise(run, 1, s, r) - phase_noise(run, 0, s, r);
        code[s] = sqrt(2.0) * run->with.sd_code * rng_gauss(r);
    }
    for (int i = 0; i < run->n_sat - 1; i++) {
        const double *u = direction(&sky, run->id[i + 1]);
        double range = 0.0;
        for (int k = 0; k < 3; k++) {
            run->G[i][k] = pivot[k] - u[k];
            range += run->G[i][k] * run->b[k];
        }
        run->phase[i] = range + phase[i + 1] - phase[0];
        run->code[i] = range + code[i + 1] - code[0];
    }
    run->t_s += 1.0;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++) { out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]; }
}

/* out = exp([th x]) v */
static void rotate(const double th[3], const double v[3], double out[3])
{
    const double angle = sqrt(th[0] * th[0] + th[1] * th[1] + th[2] * th[2]);
    double tv[3], ttv[3];
    cross(th, v, tv);
    cross(th, tv, ttv);
    const double s = (angle > 0.0) ? sin(angle) / angle : 1.0;
    const double c = (angle > 0.0) ? (1.0 - cos(angle)) / (angle * angle) : 0.5;
    for (int i = 0; i < 3; i++) { out[i] = v[i] + s * tv[i] + c * ttv[i]; }
}

static void predict(const short_run_t *run, short_prior_t prior, double sd, rng_t *r, double b0[3], double P[3][3])
{
    const double th[3] = {sd * rng_gauss(r), sd * rng_gauss(r), sd * rng_gauss(r)};
    rotate(th, run->b, b0);
    const double sq = b0[0] * b0[0] + b0[1] * b0[1] + b0[2] * b0[2];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            P[i][j] = sd * sd * (((i == j) ? sq : 0.0) - ((prior == SHORT_CROSS) ? b0[i] * b0[j] : 0.0));
        }
    }
}

void short_problem(const short_run_t *run, short_prior_t prior, double sd_attitude, rng_t *r, pel_amb_problem_t *p)
{
    const double var_phase = 2.0 * run->with.sd_phase * run->with.sd_phase;
    const double var_code = 2.0 * run->with.sd_code * run->with.sd_code;
    double b0[3] = {0.0, 0.0, 0.0};
    memset(p, 0, sizeof *p);
    p->n_rows = run->n_sat - 1;
    p->n_groups = 1;
    p->group[0] = (pel_amb_group_t){.mu = 1.0, .var_phase = var_phase, .var_code = var_code};
    p->have_prior = prior != SHORT_NO_PRIOR;
    if (p->have_prior) { predict(run, prior, sd_attitude, r, b0, p->P_r); }
    for (int i = 0; i < p->n_rows; i++) {
        double predicted = 0.0;
        for (int k = 0; k < 3; k++) { predicted += run->G[i][k] * b0[k]; }
        p->row[i] = (pel_amb_row_t){.sat = (uint8_t)(i + 1),
                                    .integer = true,
                                    .code = true,
                                    .g = {run->G[i][0], run->G[i][1], run->G[i][2]},
                                    .lambda_m = SHORT_LAMBDA,
                                    .phase_m = run->phase[i] - predicted,
                                    .code_m = run->code[i] - predicted,
                                    .var_phase = var_phase,
                                    .var_code = var_code};
    }
}

/* imu.c - see imu.h. */
#include "imu.h"

#include <math.h>
#include <string.h>

#include "world.h"

enum { CAUSE_GYRO = 11, CAUSE_ACCEL = 12, CAUSE_TAG = 13 };

static void triad_init(triad_t *t, const triad_config_t *cfg, double dt_s, uint64_t seed, uint64_t cause)
{
    memset(t, 0, sizeof *t);
    t->cfg = *cfg;
    t->dt_s = dt_s;
    rng_init(&t->rng, seed, cause);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const double sd = (i == j) ? cfg->scale_sd : cfg->misalign_sd;
            t->M[i][j] = ((i == j) ? 1.0 : 0.0) + sd * rng_normal(&t->rng);
        }
        t->constant[i] = cfg->bias_sd * rng_normal(&t->rng);
        t->markov[i] = (cfg->markov_tau_s > 0.0) ? cfg->markov_sd * rng_normal(&t->rng) : 0.0;
    }
    t->markov_phi = (cfg->markov_tau_s > 0.0) ? exp(-dt_s / cfg->markov_tau_s) : 1.0;
    t->markov_kick = cfg->markov_sd * sqrt(1.0 - t->markov_phi * t->markov_phi);
    t->white_kick = cfg->white * sqrt(dt_s);
}

/* Returns whether an axis was saturated. */
static bool triad_step(triad_t *t, const double truth_s[3], double out[3])
{
    bool saturated = false;
    const double limit = t->cfg.range * t->dt_s;
    for (int i = 0; i < 3; i++) {
        double x = dot(t->M[i], truth_s) + (t->constant[i] + t->markov[i]) * t->dt_s;
        x += t->white_kick * rng_normal(&t->rng);
        t->markov[i] = t->markov_phi * t->markov[i] + t->markov_kick * rng_normal(&t->rng);
        if (limit > 0.0 && fabs(x) > limit) {
            x = copysign(limit, x);
            saturated = true;
        }
        if (t->cfg.lsb > 0.0) {
            const double sum = x + t->residue[i];
            x = t->cfg.lsb * round(sum / t->cfg.lsb);
            t->residue[i] = sum - x;
        }
        out[i] = x;
    }
    return saturated;
}

void imu_sim_init(imu_sim_t *s, const imu_config_t *cfg, uint64_t seed)
{
    memset(s, 0, sizeof *s);
    s->cfg = *cfg;
    const double dt_s = 1e-9 * (double)cfg->interval_ns;
    triad_init(&s->gyro, &cfg->gyro, dt_s, seed, CAUSE_GYRO);
    triad_init(&s->accel, &cfg->accel, dt_s, seed, CAUSE_ACCEL);
    world_C_b_n(cfg->mount[0], cfg->mount[1], cfg->mount[2], s->C_s_b);
    rng_t tag;
    rng_init(&tag, seed, CAUSE_TAG);
    s->tag_error_ns = (int64_t)llround(1e9 * cfg->time_offset_s * rng_normal(&tag));
}

void imu_sim_step(imu_sim_t *s, pel_time_t t_ns, const double alpha_b[3], const double upsilon_b[3], pel_imu_t *out)
{
    double alpha_s[3];
    double upsilon_s[3];
    memset(out, 0, sizeof *out);
    rotate_back(s->C_s_b, alpha_b, alpha_s);
    rotate_back(s->C_s_b, upsilon_b, upsilon_s);
    if (triad_step(&s->gyro, alpha_s, out->alpha_ib_b)) { out->flags |= PEL_IMU_GYRO_SATURATED; }
    if (triad_step(&s->accel, upsilon_s, out->upsilon_ib_b)) { out->flags |= PEL_IMU_ACCEL_SATURATED; }
    out->t_ns = t_ns + s->tag_error_ns;
    out->dt_s = 1e-9 * (double)s->cfg.interval_ns;
    out->seq = s->seq++;
}

void imu_sim_errors(const imu_sim_t *s, double b_g[3], double b_a[3])
{
    double g[3];
    double a[3];
    for (int i = 0; i < 3; i++) {
        g[i] = s->gyro.constant[i] + s->gyro.markov[i];
        a[i] = s->accel.constant[i] + s->accel.markov[i];
    }
    rotate(s->C_s_b, g, b_g);
    rotate(s->C_s_b, a, b_a);
}

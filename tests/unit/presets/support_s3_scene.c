/* support_s3_scene.c - see support_s3_scene.h. */
#include "support_s3_scene.h"

#include <math.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "unity.h"

const double S3_LEVER[3] = {0.5, 0.8, 1.2};
double S3_SAT[SATS][3];

void s3_sats_init(void)
{
    static const double longitude_deg[SATS] = {110.5, 80.0, 140.0};
    for (int i = 0; i < SATS; i++) {
        S3_SAT[i][0] = 42164170.0 * cos(longitude_deg[i] * PEL_DEG);
        S3_SAT[i][1] = 42164170.0 * sin(longitude_deg[i] * PEL_DEG);
    }
}

const scenario_t S3_STATIC = {.duration_s = 2050.0, .sd_height_m = 0.05, .tau_height_s = 60.0};
const scenario_t S3_CAMPUS = {.duration_s = 1800.0,
                              .sd_height_m = 1.5,
                              .tau_height_s = 60.0,
                              .side_s = 46.0,
                              .speed = 6.0,
                              .slow = 3.0,
                              .hill_m = 1.5,
                              .hill_s = 120.0};
/* hills of 40 m in 420 s, one half turn at 2200 s */
const scenario_t S3_HIGHWAY = {.duration_s = 3300.0,
                               .sd_height_m = 20.0,
                               .tau_height_s = 150.0,
                               .side_s = 1890.0,
                               .speed = 22.0,
                               .slow = 17.0,
                               .hill_m = 20.0,
                               .hill_s = 420.0,
                               .bump_m = 2.0,
                               .bump_s = 77.0};

void s3_motion(const scenario_t *s, motion_t *m)
{
    motion_config_t cfg = {.llh = {28.22 * PEL_DEG, 112.99 * PEL_DEG, 50.0}, .heading = 0.6, .wave_speed = 1.0};
    segment_t way[64] = {{.duration_s = 1.0}};
    const double turn = (s->speed > 10.0) ? PEL_PI : 0.5 * PEL_PI; /* a road and back, or round a block of 225 s */
    int n = 1;
    if (s->speed > 0.0) {
        cfg.n_waves = (s->bump_m > 0.0) ? 2 : 1;
        cfg.waves[0] = (wave_t){.axis = WAVE_UP, .amplitude = s->hill_m, .rate_hz = 1.0 / s->hill_s};
        if (cfg.n_waves == 2) {
            cfg.waves[1] = (wave_t){.axis = WAVE_UP, .amplitude = s->bump_m, .rate_hz = 1.0 / s->bump_s};
        }
    }
    for (int side = 0; s->speed > 0.0 && side < 31; side++) {
        const double change = (side == 0) ? s->speed : (s->speed - s->slow) * ((side % 2 == 0) ? 1.0 : -1.0);
        way[n++] = (segment_t){.duration_s = s->side_s, .speed_change = change};
        way[n++] = (segment_t){.duration_s = (turn > 2.0) ? 40.0 : 10.25, .turn = turn};
    }
    TEST_ASSERT_TRUE(motion_init(m, &cfg, way, n));
}

void s3_sky_init(sky_t *sky, uint64_t seed)
{
    memset(sky, 0, sizeof *sky);
    rng_init(&sky->rng, seed, 902);
    for (int i = 0; i < SATS; i++) {
        sky->rate[i] = 1e-4 * rng_normal(&sky->rng);
        sky->accel[i] = 4.24e-8 * rng_normal(&sky->rng); /* p2 of a pair: 3e-8 m/s^2 */
        sky->N[i] = 17.0 * i;
    }
}

void s3_sky_advance(sky_t *sky)
{
    for (int i = 0; i < SATS; i++) {
        sky->path[i] += EPOCH * sky->rate[i] + PATH * sqrt(EPOCH) * rng_normal(&sky->rng);
        sky->rate[i] += EPOCH * sky->accel[i];
    }
}

void s3_observe(sky_t *sky, const double r_a[3], double phase_m[SATS])
{
    for (int i = 0; i < SATS; i++) {
        double u[3];
        phase_m[i] = range_to(S3_SAT[i], r_a, u) + sky->path[i] + sky->N[i] + SIGMA * rng_normal(&sky->rng);
    }
}

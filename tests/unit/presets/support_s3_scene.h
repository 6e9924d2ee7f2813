/* support_s3_scene.h - S3 section 10: what is driven, and three geostationary satellites whose paths are not quite foreseen. */
#ifndef SUPPORT_S3_SCENE_H
#define SUPPORT_S3_SCENE_H

#include "support_world.h"

enum { SATS = 3, PAIRS = 2, EPOCH_STEPS = 5 };
#define STEP  0.02 /* 50 Hz */
#define EPOCH 0.1
#define SIGMA 3e-3
#define PATH  2e-4 /* m/sqrt(s) */

extern const double S3_LEVER[3];
extern double S3_SAT[SATS][3]; /* ECEF; s3_sats_init. The highest is the reference. */

typedef struct {
    double duration_s, sd_height_m, tau_height_s;
    double side_s, speed, slow; /* of the loops driven; speed 0: stands */
    double hill_m, bump_m;      /* amplitudes of the ground along the way */
    double hill_s, bump_s;      /* and how long one takes */
    bool barometer; /* the height reference is the true height with a drift of 1 m (300 s); else that of the start */
} scenario_t;

extern const scenario_t S3_STATIC, S3_CAMPUS, S3_HIGHWAY;

void s3_sats_init(void);
void s3_motion(const scenario_t *s, motion_t *m);

/* Each satellite's path, transponder and clock: what the polynomial is fitted to and what it does not foresee. */
typedef struct {
    rng_t rng;
    double path[SATS], rate[SATS], accel[SATS], N[SATS];
} sky_t;

void s3_sky_init(sky_t *sky, uint64_t seed);
void s3_sky_advance(sky_t *sky);
void s3_observe(sky_t *sky, const double r_a[3], double phase_m[SATS]);

#endif

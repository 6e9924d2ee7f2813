/* world.h - half a minute of true measurements: a rover that moves steadily, its IMU, a base. */
#ifndef FUZZ_WORLD_H
#define FUZZ_WORLD_H

#include "pelorus/navigator.h"

#define WORLD_EPOCHS    48 /* two a second */
#define WORLD_EPOCH_NS  (500 * PEL_NS_PER_MS)
#define WORLD_SAMPLES   25 /* IMU samples an epoch */
#define WORLD_SAMPLE_NS (WORLD_EPOCH_NS / WORLD_SAMPLES)

typedef struct {
    pel_orbits_t orbits;
    pel_station_t station;
    pel_epoch_t rover[WORLD_EPOCHS], base[WORLD_EPOCHS];
    double C_b_e[3][3];    /* constant: level, heading east */
    double alpha[3];       /* of one sample, rad */
    double upsilon[3];     /* m/s */
    pel_time_t t_start_ns; /* true time of epoch 0 */
} world_t;

void world_init(world_t *w);

/* The k-th sample since the start: it ends at t_start + (k + 1) samples. */
pel_imu_t world_imu(const world_t *w, int k);

#endif

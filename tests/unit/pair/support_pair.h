/* support_pair.h - a base and a rover under a simulated sky, fed to a navigator epoch by epoch. */
#ifndef SUPPORT_PAIR_H
#define SUPPORT_PAIR_H

#include "pelorus/navigator.h"
#include "support_gnss.h"

typedef struct {
    scene_t base, rover;
    double code_sd_m, phase_sd_m; /* white, each receiver */
    unsigned systems;             /* that the receivers observe */
    uint32_t seed;
    int epoch; /* of one second, the next to be made */
    pel_orbits_t orbits;
} pair_t;

/* 1.9 km apart, noise of 0.4 m and 3 mm; the navigator is told orbits, base position and that there is no ionosphere to model. */
void pair_init(pair_t *p, pel_navigator_t *nav, unsigned systems, uint8_t carriers);

/* Begin with another configuration: the navigator afresh, with the orbits and the base's place. */
void pair_introduce(const pair_t *p, pel_navigator_t *nav, const pel_nav_config_t *cfg);

/* What both receivers see in the next second; then the caller may change it and push it. */
void pair_observe(pair_t *p, pel_epoch_t *base, pel_epoch_t *rover);

/* Observe and push; true when the navigator says that this epoch is fixed. */
bool pair_step(pair_t *p, pel_navigator_t *nav);

/* Distance of the navigator's last epoch from the truth, m. */
double pair_error_m(const pair_t *p, const pel_navigator_t *nav);

/* The rover's view again, of the satellites in nav->sd: a search has taken its memory. */
void pair_see_again(pel_navigator_t *nav);

#endif

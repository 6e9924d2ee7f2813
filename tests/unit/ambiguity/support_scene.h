/* support_scene.h - simulated epochs of several systems and carriers, noise by elevation, ionosphere by satellite, integers known. */
#ifndef SUPPORT_SCENE_H
#define SUPPORT_SCENE_H

#include "pelorus/ambiguity.h"
#include "support_ambiguity.h"

typedef struct {
    int n_sys;                /* 1..3 */
    int n_sat;                /* of each system, the pivot included */
    int n_carrier;            /* 1..2 */
    double one_carrier;       /* share of satellites that lack the second */
    double sd_code, sd_phase; /* single difference at the zenith, m */
    double sd_low;            /* further phase error of a single difference, m / sin(elevation): troposphere */
    double sd_iono;           /* single difference on L1, m */
    double sd_prior;          /* per axis, m; 0: none */
} scene_case_t;

typedef struct {
    pel_amb_problem_t problem;
    int64_t truth[PEL_MAX_AMB]; /* by row */
    double b[3];                /* true - predicted */
} scene_t;

/* One draw of sky, noise, integers and prior error. */
scene_t scene_draw(const scene_case_t *c, rng_t *r);

/* Are all integers of rows with `integer` the true ones? */
bool scene_right(const scene_t *s, const pel_amb_problem_t *p, const int64_t *N);

#endif

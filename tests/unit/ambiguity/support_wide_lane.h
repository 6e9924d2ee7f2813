/* support_wide_lane.h - single-epoch wide-lane problems of S6: scenario A, and the float solution (4) by its formula. */
#ifndef SUPPORT_WIDE_LANE_H
#define SUPPORT_WIDE_LANE_H

#include "pelorus/ambiguity_methods.h"
#include "support_ambiguity.h"

#define LAMBDA_W 0.861918400
#define WL_MAX   PEL_TRANSFORM_MAX

typedef struct {
    double sd_code; /* undifferenced, m */
    int n_sat; /* 0: all in view of the 30 satellites of scenario A. Else the highest so many of the 24 of S1 section 7 */
} wl_case_t;

typedef struct {
    int n;               /* double differences */
    double g[WL_MAX][3]; /* -(u_sat - u_pivot), the pivot is the highest */
    double a[WL_MAX];    /* float ambiguities (4), cycles */
    double Q[PEL_TRI(WL_MAX)];
    int64_t truth[WL_MAX];
    pel_amb_problem_t problem; /* the same for the engine */
} wl_epoch_t;

/* Single difference of the wide-lane phase, the 8 mm for ionosphere included, m. */
double wl_sd_phase(void);

/* Second t of the day at scenario A's base, with the noise of r. */
wl_epoch_t wl_draw(const wl_case_t *c, double t_s, rng_t *r);

#endif

/* support_epoch.h - simulated epochs of S5 section 9, as a problem for the search and as one for the band. */
#ifndef SUPPORT_EPOCH_H
#define SUPPORT_EPOCH_H

#include "pelorus/ambiguity.h"
#include "support_ambiguity.h"

#define LAMBDA1 0.190293672798364880 /* c / f_L1 */
#define LAMBDA2 0.244210213424568200 /* c / f_L2 */

typedef struct {
    double t_s;               /* seconds of the constellation: decides how many satellites there are */
    double sd_code, sd_phase; /* undifferenced, m */
    double sd_iono;           /* DD, m on L1; 0: none */
    bool iono_independent;    /* drawn independently for each DD instead of with correlation 1/2 */
    bool iono_modelled;
    double sd_prior; /* per axis, m; 0: none */
} case_t;

typedef struct {
    int m;
    int64_t N1[SKY_MAX], N2[SKY_MAX];
    pel_amb_problem_t problem;
    pel_band_input_t band; /* half width, window and limits left to the caller */
} epoch_t;

/* One draw of noise, integers and prior error. */
epoch_t epoch_draw(const case_t *c, rng_t *r);

#endif

/* support_short.h - short baselines with L1 alone, as S1 section 7 simulates them. Written for tests alone. */
#ifndef SUPPORT_SHORT_H
#define SUPPORT_SHORT_H

#include "pelorus/ambiguity.h"
#include "support_ambiguity.h"

#define SHORT_LAMBDA 0.190293672798364880 /* c / f_L1 */
#define SHORT_DD     8

/* 7 satellites at 2100 s, 6 at 300 s, 8 at 9000 s of the constellation; heading 40 degrees, pitch 2. Undifferenced noise, m. */
typedef struct {
    double t_s, length_m;
    double sd_phase, sd_code;
    double sd_multipath, tau_s; /* of the phase: first-order Gauss-Markov of each antenna and satellite; 0: none */
} short_t;

/* One run of 1 Hz epochs. Integers are 0. */
typedef struct {
    short_t with;
    int n_sat; /* the first is the pivot: the highest at the start */
    int id[SKY_MAX];
    double t_s;
    double b[3];                            /* baseline, ECEF */
    double multipath[2][SKY_MAX];           /* antenna, satellite */
    double G[SHORT_DD][3];                  /* -(u_i - u_0) of this epoch */
    double phase[SHORT_DD], code[SHORT_DD]; /* DD, m */
} short_run_t;

void short_start(short_run_t *run, const short_t *with, rng_t *r);

/* Draw the epoch at run->t_s, and step on by 1 s. */
void short_epoch(short_run_t *run, rng_t *r);

/* Covariance told with a baseline b0 that an attitude of error sd (each axis, rad) predicts. */
typedef enum {
    SHORT_NO_PRIOR,
    SHORT_CROSS,    /* [b0 x] sd^2 [b0 x]': nothing along the baseline */
    SHORT_ISOTROPIC /* (|b0| sd)^2 on each axis, along the baseline too */
} short_prior_t;

/* The run's epoch as a problem of the engine; the attitude's error is drawn and turns the true baseline. */
void short_problem(const short_run_t *run, short_prior_t prior, double sd_attitude, rng_t *r, pel_amb_problem_t *p);

#endif

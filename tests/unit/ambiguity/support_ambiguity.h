/* support_ambiguity.h - what the tests of this room share: random numbers, satellites of the specifications' constellation,
 * realistic integer problems, limits of a binomial. Written for tests alone: no code of firmware/ in it. */
#ifndef SUPPORT_AMBIGUITY_H
#define SUPPORT_AMBIGUITY_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint64_t s;
} rng_t;

double rng_uniform(rng_t *r); /* [0, 1) */
double rng_gauss(rng_t *r);
int rng_int(rng_t *r, int low, int high); /* inclusive */

#define SKY_MAX 24

/* Satellites above a mask, highest first. */
typedef struct {
    int n;
    int id[SKY_MAX];
    double u[SKY_MAX][3]; /* ECEF, antenna -> satellite */
    double el[SKY_MAX];   /* rad */
} sky_t;

/* The 24 satellites of S1 section 7 as seen from a site at t seconds. */
sky_t sky_of(double lat_deg, double lon_deg, double h_m, double t_s, double mask_deg);

/* The same with 30 satellites, 5 evenly in each of 6 planes, each plane 12 degrees ahead of the one before. */
sky_t sky_of_30(double lat_deg, double lon_deg, double h_m, double t_s, double mask_deg);

#define AMB_MAX 40

typedef struct {
    int n;
    double a[AMB_MAX];
    double Q[AMB_MAX][AMB_MAX];
    int64_t truth[AMB_MAX];
} problem_t;

/* A realistic problem of n ambiguities: random sky, 1 to 4 systems with pivots and frequencies of their own, 1 to 3 carriers, code 0.3 to
 * 3 m, phase 2 to 6 mm, ionosphere of a baseline of 0.1 to 60 km, one epoch or up to 300 averaged, with (0.02 to 1 m) or without a position
 * prior; integers up to 1e9. */
problem_t problem_random(rng_t *r, int n);

/* Packed lower triangle of a problem's Q. */
void problem_pack(const problem_t *p, double *packed);

#define ORACLE_BEST 2

typedef struct {
    int n_found;
    int64_t N[ORACLE_BEST][AMB_MAX];
    long double sq[ORACLE_BEST];
} oracle_t;

/* Best and second best integer vectors, searched in long double without limit of any kind. */
void oracle_solve(const problem_t *p, oracle_t *out);

/* Is k successes of n compatible with probability p at the 99 % level (two-sided, exact binomial tails of 0.5 % each)? */
bool binomial_agrees(int k, int n, double p);

/* A table's figure that is itself an estimate from n_ref draws: are k of n and p_ref compatible at 99 % (difference of two
 * proportions, with a continuity correction)? */
bool proportions_agree(int k, int n, double p_ref, int n_ref);

#endif

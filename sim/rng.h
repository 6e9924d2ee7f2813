/* rng.h - the simulator's own random numbers: the same on every machine for one seed.
 *
 * xoshiro256** of Blackman and Vigna (2018), seeded through splitmix64; normal deviates by the polar method (Marsaglia and
 * Bray 1964). Each cause of randomness owns a stream named by a number, so that switching one error off leaves all others
 * as they were. */
#ifndef PELORUS_SIM_RNG_H
#define PELORUS_SIM_RNG_H

#include <stdbool.h>
#include <stdint.h>

typedef struct {
    uint64_t s[4];
    double spare; /* second deviate of a pair */
    bool have_spare;
} rng_t;

/* Stream `cause` of a seed. */
void rng_init(rng_t *r, uint64_t seed, uint64_t cause);

uint64_t rng_bits(rng_t *r);
double rng_uniform(rng_t *r); /* [0, 1) */
double rng_normal(rng_t *r);  /* mean 0, variance 1 */

/* Whole number in [-n, n]. */
int64_t rng_integer(rng_t *r, int64_t n);

/* Stationary first-order Gauss-Markov process, advanced by dt: exact for any dt. tau <= 0: constant. */
double rng_markov(rng_t *r, double x, double sd, double tau_s, double dt_s);

#endif

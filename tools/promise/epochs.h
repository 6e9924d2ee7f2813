/* epochs.h - simulated epochs of double differences as receivers give them. Desktop only. */
#ifndef PELORUS_PROMISE_EPOCHS_H
#define PELORUS_PROMISE_EPOCHS_H

#include "pelorus/ambiguity.h"
#include "support_ambiguity.h"

typedef struct {
    pel_amb_problem_t problem;
    int64_t truth[PEL_MAX_AMB]; /* integers by row */
} promise_epoch_t;

/* One epoch: a place between 60 N and 60 S, a moment, one to four systems of 24 satellites each, 10 degrees of mask, one to three
 * carriers, 4 to 40 integers; code 0.1 to 3 m, phase 2 to 4 mm (single difference at the zenith, growing to the horizon); 0.1 to 60 km with 1 ppm of
 * ionosphere; with (0.02 to 1 m) or without a position prior.
 *
 *  noise  in  errors are this many times as large as the problem says: 1 is an honest model */
void promise_epoch(rng_t *r, double noise, promise_epoch_t *e);

#endif

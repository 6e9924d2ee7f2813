/* integers.h - the integer engine on realistic problems (the generator of tests/unit/ambiguity), factor to proof and answer. */
#ifndef BENCH_INTEGERS_H
#define BENCH_INTEGERS_H

#define BENCH_SIZES    6
#define BENCH_PROBLEMS 21 /* of each size; the median counts */

extern const int bench_sizes[BENCH_SIZES];

/* Problem `which` of a size, for both of the bodies below. */
void bench_integers_prepare(int size, int which);

/* Best and second best by the library. */
void bench_integers(void);

/* The same problem as RTKLIB's lambda() takes it: n, float ambiguities, full covariance. */
int bench_integers_problem(const double **a, const double **Q);

/* Sorts counts; returns their median. */
long bench_median(long *counts, int n);

#endif

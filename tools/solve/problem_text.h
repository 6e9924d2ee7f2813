/* problem_text.h - integer ambiguity problems as text.
 *
 * A problem: a line n; n float ambiguities in cycles (on one line or several); n lines of the covariance in cycles^2, each with n
 * numbers (full) or with 1, 2, ... n numbers (lower triangle). `#` begins a comment. Several problems may follow one another.
 * Lines below a comment that names a candidate, a ratio or the truth are somebody's answers and are skipped. */
#ifndef PELORUS_TOOLS_PROBLEM_TEXT_H
#define PELORUS_TOOLS_PROBLEM_TEXT_H

#include <stdio.h>

/* Largest n that is read; larger than what is solved, so that a problem too large is refused and the next one still found. */
#define PROBLEM_TEXT_MAX 400

typedef struct {
    int line; /* where the problem begins, from 1 */
    int n;
    double *a;     /* [n] */
    double *Q;     /* packed lower triangle */
    char why[120]; /* what is wrong with it, empty: nothing */
} problem_text_t;

typedef struct {
    FILE *f;
    int line;
    char *text; /* the line at hand, of any length */
    size_t cap;
    int answers; /* below a comment that announces answers */
    problem_text_t problem;
    int stray; /* lines between problems that belong to none */
} problem_reader_t;

/* Read from f, which stays the caller's. */
void problem_reader_open(problem_reader_t *r, FILE *f);

/* The next problem, NULL at the end. It may be a bad one: see why. Valid until the next call. */
const problem_text_t *problem_reader_next(problem_reader_t *r);

void problem_reader_close(problem_reader_t *r);

#endif

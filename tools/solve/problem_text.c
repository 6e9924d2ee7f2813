/* problem_text.c - read integer ambiguity problems from text. */
#define _POSIX_C_SOURCE 200809L

#include "problem_text.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

void problem_reader_open(problem_reader_t *r, FILE *f)
{
    *r = (problem_reader_t){.f = f};
    r->problem.a = malloc(PROBLEM_TEXT_MAX * sizeof(double));
    r->problem.Q = malloc(PROBLEM_TEXT_MAX * PROBLEM_TEXT_MAX * sizeof(double));
    if (r->problem.a == NULL || r->problem.Q == NULL) { abort(); }
}

void problem_reader_close(problem_reader_t *r)
{
    free(r->text);
    free(r->problem.a);
    free(r->problem.Q);
}

/* Next line with data, its comment cut off; NULL at the end. */
static char *next_line(problem_reader_t *r)
{
    while (getline(&r->text, &r->cap, r->f) >= 0) {
        r->line++;
        char *comment = strchr(r->text, '#');
        if (comment != NULL) {
            r->answers = strstr(comment, "candidate") != NULL || strstr(comment, "ratio") != NULL ||
                         strstr(comment, "truth") != NULL;
            *comment = '\0';
        }
        char *at = r->text;
        while (isspace((unsigned char)*at)) { at++; }
        if (*at != '\0') { return at; }
    }
    return NULL;
}

/* Numbers of a line into out[max]; -1: something else is there, or more than max. Commas may stand between them. */
static int numbers(const char *at, double *out, int max)
{
    int n = 0;
    for (;;) {
        while (isspace((unsigned char)*at) || *at == ',') { at++; }
        if (*at == '\0') { return n; }
        char *end = NULL;
        const double x = strtod(at, &end);
        if (end == at || n >= max || !(isspace((unsigned char)*end) || *end == ',' || *end == '\0')) { return -1; }
        out[n++] = x;
        at = end;
    }
}

/* Does this line begin a problem: one positive whole number? */
static bool begins(const char *text, int *n)
{
    double x[2];
    if (numbers(text, x, 2) != 1 || !(x[0] >= 0.0 && x[0] <= 1e6) || x[0] != floor(x[0])) { return false; }
    *n = (int)x[0];
    return true;
}

/* Words of a line, whatever they are. */
static int words(const char *at)
{
    int n = 0;
    for (;;) {
        at += strspn(at, " \t\r\n,");
        if (*at == '\0') { return n; }
        at += strcspn(at, " \t\r\n,");
        n++;
    }
}

/* A bad line is counted for what it stands for, so that the next problem is still found where it begins. */
static void read_floats(problem_reader_t *r)
{
    problem_text_t *p = &r->problem;
    for (int have = 0; have < p->n;) {
        const char *text = next_line(r);
        if (text == NULL) {
            if (p->why[0] == '\0') {
                snprintf(p->why, sizeof p->why, "ends after %d of %d float ambiguities", have, p->n);
            }
            return;
        }
        const int got = numbers(text, p->a + have, p->n - have);
        if (got < 0 && p->why[0] == '\0') {
            snprintf(p->why, sizeof p->why, "line %d: not a number, or more than %d float ambiguities", r->line, p->n);
        }
        have += (got < 0) ? words(text) : got;
    }
}

/* Two entries that should be the same, beside the variances they belong to. */
static bool same(double a, double b, double va, double vb)
{
    return fabs(a - b) <= 1e-6 * sqrt(fabs(va * vb)) || (!isfinite(a) && !isfinite(b));
}

/* Packed lower triangle of a full matrix or of one whose rows hold 1, 2, ... n numbers. */
static void pack(problem_text_t *p, const double *full, bool lower)
{
    const int n = p->n;
    double *out = p->Q;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            if (lower) {
                *out++ = full[i * n + j];
                continue;
            }
            if (!same(full[i * n + j], full[j * n + i], full[i * n + i], full[j * n + j])) {
                snprintf(p->why, sizeof p->why, "covariance is not symmetric at row %d, column %d", i + 1, j + 1);
                return;
            }
            *out++ = 0.5 * (full[i * n + j] + full[j * n + i]);
        }
    }
}

static void read_covariance(problem_reader_t *r)
{
    problem_text_t *p = &r->problem;
    const int n = p->n;
    double *full = calloc((size_t)n * (size_t)n, sizeof(double));
    bool lower = false;
    if (full == NULL) { abort(); }
    for (int i = 0; i < n; i++) {
        const char *text = next_line(r);
        const int got = (text != NULL) ? numbers(text, full + i * n, n) : 0;
        if (i == 0) { lower = got == 1; }
        const int wanted = lower ? i + 1 : n;
        if (text != NULL && got == wanted) { continue; }
        if (p->why[0] == '\0' && text == NULL) {
            snprintf(p->why, sizeof p->why, "ends after %d of %d rows of the covariance", i, n);
        } else if (p->why[0] == '\0') {
            snprintf(p->why, sizeof p->why, "line %d: row %d of the covariance wants %d numbers", r->line, i + 1,
                     wanted);
        }
        if (text == NULL) { break; }
    }
    if (p->why[0] == '\0') { pack(p, full, lower); }
    free(full);
}

const problem_text_t *problem_reader_next(problem_reader_t *r)
{
    problem_text_t *p = &r->problem;
    p->why[0] = '\0';
    for (const char *text = next_line(r); text != NULL; text = next_line(r)) {
        if (r->answers) { continue; }
        if (!begins(text, &p->n)) {
            r->stray++;
            continue;
        }
        p->line = r->line;
        if (p->n < 1 || p->n > PROBLEM_TEXT_MAX) {
            snprintf(p->why, sizeof p->why, "n = %d is not in 1..%d", p->n, PROBLEM_TEXT_MAX);
        } else {
            read_floats(r);
            read_covariance(r);
        }
        return p;
    }
    return NULL;
}

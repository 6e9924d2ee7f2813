/* tally.h - what was taken, left out and refused from one input, by cause. */
#ifndef PELORUS_TOOLS_CAPTURE_TALLY_H
#define PELORUS_TOOLS_CAPTURE_TALLY_H

#include <stdint.h>
#include <stdio.h>

typedef enum {
    TALLY_TAKEN,   /* what the capture now holds */
    TALLY_LEFT,    /* understood, and left out for the reason given */
    TALLY_REFUSED, /* damaged or impossible: makes the exit code 4 */
    TALLY_NOTE     /* worth knowing, nothing lost */
} tally_kind_t;

typedef struct {
    struct {
        const char *cause; /* a literal */
        tally_kind_t kind;
        uint64_t n;
    } row[64];
    int n_rows;
} tally_t;

void tally_add(tally_t *t, tally_kind_t kind, const char *cause, uint64_t n);
uint64_t tally_get(const tally_t *t, const char *cause);
uint64_t tally_refused(const tally_t *t);
/* One line a cause; with `all` false only what was left out, refused or noted. */
void tally_print(const tally_t *t, FILE *f, int all);

#endif

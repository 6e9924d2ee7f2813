#include "tally.h"

#include <inttypes.h>
#include <string.h>

void tally_add(tally_t *t, tally_kind_t kind, const char *cause, uint64_t n)
{
    if (n == 0) { return; }
    for (int i = 0; i < t->n_rows; i++) {
        if (t->row[i].kind == kind && strcmp(t->row[i].cause, cause) == 0) {
            t->row[i].n += n;
            return;
        }
    }
    if (t->n_rows == (int)(sizeof t->row / sizeof t->row[0])) { return; } /* causes are literals: far fewer than rows */
    t->row[t->n_rows].cause = cause;
    t->row[t->n_rows].kind = kind;
    t->row[t->n_rows].n = n;
    t->n_rows++;
}

uint64_t tally_get(const tally_t *t, const char *cause)
{
    for (int i = 0; i < t->n_rows; i++) {
        if (strcmp(t->row[i].cause, cause) == 0) { return t->row[i].n; }
    }
    return 0;
}

uint64_t tally_refused(const tally_t *t)
{
    uint64_t sum = 0;
    for (int i = 0; i < t->n_rows; i++) {
        if (t->row[i].kind == TALLY_REFUSED) { sum += t->row[i].n; }
    }
    return sum;
}

void tally_print(const tally_t *t, FILE *f, int all)
{
    static const char *const KIND[] = {"taken", "left out", "refused", "note"};
    for (int kind = 0; kind < 4; kind++) {
        if (kind == TALLY_TAKEN && !all) { continue; }
        for (int i = 0; i < t->n_rows; i++) {
            if (t->row[i].kind != (tally_kind_t)kind) { continue; }
            fprintf(f, "  %-9s %9" PRIu64 "  %s\n", KIND[kind], t->row[i].n, t->row[i].cause);
        }
    }
}

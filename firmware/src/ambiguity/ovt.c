/* ovt.c - do the integers stay the same from epoch to epoch? */
#include "ambiguity_internal.h"
#include "pelorus/ambiguity_methods.h"
#include "pelorus/math.h"

#define NOT_THERE (-1)
#define SAME_CARRIER                                                                                                   \
    0.007 /* of a wavelength: GLONASS channels differ by less, carriers of a satellite by four times as much */

static int find(const pel_ovt_t *o, uint8_t sat, double lambda_m)
{
    for (int i = 0; i < o->n; i++) {
        if (o->entry[i].sat == sat && pel_fabs((double)o->entry[i].lambda_m - lambda_m) < SAME_CARRIER * lambda_m) {
            return i;
        }
    }
    return NOT_THERE;
}

/* What a group's common satellites have in common: the difference of the pivots. */
typedef struct {
    int reference; /* entry of the first common satellite, or NOT_THERE */
    int64_t shift;
} common_t;

static void compare(const pel_ovt_t *o, uint8_t sat, double lambda_m, int64_t N, common_t *c, pel_ovt_verdict_t *v)
{
    const int i = find(o, sat, lambda_m);
    if (i == NOT_THERE) { return; }
    const int64_t shift = N - o->entry[i].N;
    if (c->reference == NOT_THERE) {
        *c = (common_t){i, shift};
        return;
    }
    if (o->entry[i].group != o->entry[c->reference].group) { return; } /* their difference was unknown */
    v->n_compared++;
    if (shift != c->shift && v->sat_changed < 0) { v->sat_changed = sat; }
}

/* The carrier of a group, from its first row with an integer; 0: it has none. */
static double wavelength(const pel_amb_problem_t *p, int group)
{
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].group == group && p->row[i].integer) { return p->row[i].lambda_m; }
    }
    return 0.0;
}

static void add(pel_ovt_t *o, uint8_t sat, double lambda_m, int group, int64_t N)
{
    o->entry[o->n].N = N;
    o->entry[o->n].lambda_m = (float)lambda_m;
    o->entry[o->n].sat = sat;
    o->entry[o->n].group = (uint8_t)group;
    o->n++;
}

static void replace(pel_ovt_t *o, const pel_amb_problem_t *p, const int64_t *N)
{
    o->n = 0;
    for (int g = 0; g < p->n_groups; g++) {
        const double lambda_m = wavelength(p, g);
        if (lambda_m > 0.0) { add(o, p->group[g].sat, lambda_m, g, 0); }
    }
    for (int i = 0; i < p->n_rows; i++) {
        const pel_amb_row_t *row = &p->row[i];
        if (row->integer) { add(o, row->sat, row->lambda_m, row->group, N[i]); }
    }
}

void pel_ovt_push(pel_ovt_t *o, const pel_amb_problem_t *p, const int64_t *N, int needed, pel_ovt_verdict_t *v)
{
    *v = (pel_ovt_verdict_t){.sat_changed = -1};
    for (int g = 0; o->epochs > 0 && g < p->n_groups; g++) {
        common_t c = {.reference = NOT_THERE};
        compare(o, p->group[g].sat, wavelength(p, g), 0, &c, v);
        for (int i = 0; i < p->n_rows; i++) {
            const pel_amb_row_t *row = &p->row[i];
            if (row->integer && row->group == g) { compare(o, row->sat, row->lambda_m, N[i], &c, v); }
        }
    }
    const bool same = v->n_compared >= PEL_OVT_COMPARED && v->sat_changed < 0;
    o->epochs = same ? o->epochs + (o->epochs < INT32_MAX) : 1;
    replace(o, p, N);
    v->epochs = o->epochs;
    v->passed = o->epochs >= needed;
}

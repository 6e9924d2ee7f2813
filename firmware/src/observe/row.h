/* row.h - how rows are begun and filled. Private to observe/. */
#ifndef PELORUS_OBSERVE_ROW_H
#define PELORUS_OBSERVE_ROW_H

#include <string.h>

#include "pelorus/math.h"
#include "pelorus/observe.h"

/* An empty row over n states that begins at `first`. */
static inline void pel_row_begin(pel_row_t *row, int n, int first, double z)
{
    memset(row->h, 0, (size_t)n * sizeof row->h[0]);
    row->n = n;
    row->first = first;
    row->z = (pel_real)z;
    row->var = 0;
}

static inline void pel_row_put(pel_row_t *row, int index, const double v[3])
{
    for (int k = 0; k < 3; k++) { row->h[index + k] = (pel_real)v[k]; }
}

/* The row's part on psi: an arm C l moves by psi x (C l), so g'(psi x arm) = psi'(arm x g). */
static inline void pel_row_put_arm(const pel_antenna_t *ant, const double arm_e[3], const double g[3], pel_row_t *row)
{
    if (ant->i_psi < 0) { return; }
    double on_psi[3];
    pel_cross3(arm_e, g, on_psi);
    pel_row_put(row, ant->i_psi, on_psi);
}

/* g = -(u_sat - u_pivot): what a double difference gains when the antenna moves. */
static inline void pel_row_direction(const pel_sd_t *sat, const pel_sd_t *pivot, double g[3])
{
    for (int k = 0; k < 3; k++) { g[k] = pivot->u_e[k] - sat->u_e[k]; }
}

#endif

#include "pelorus/observe.h"

#include <string.h>

#include "pelorus/math.h"

static void start_row(const pel_antenna_t *ant, int first, double dd, pel_row_t *row)
{
    memset(row->h, 0, sizeof row->h);
    row->n = ant->n_states;
    row->first = (ant->i_psi >= 0) ? ant->i_psi : first;
    row->z = (pel_real)-dd;
    row->var = 0;
}

static void put_vector(pel_row_t *row, int index, const double v[3])
{
    for (int k = 0; k < 3; k++) { row->h[index + k] = (pel_real)v[k]; }
}

static void line_of_sight_difference(const pel_sd_t *sat, const pel_sd_t *pivot, double g[3])
{
    for (int k = 0; k < 3; k++) { g[k] = pivot->u_e[k] - sat->u_e[k]; }
}

/* The row's part on psi: an arm C l moves by psi x (C l), so g'(psi x arm) = psi'(arm x g). */
static void put_arm(const pel_antenna_t *ant, const double arm_e[3], const double g[3], pel_row_t *row)
{
    if (ant->i_psi < 0) { return; }
    double on_psi[3];
    pel_cross3(arm_e, g, on_psi);
    put_vector(row, ant->i_psi, on_psi);
}

void pel_observe_range(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double dd_m,
                       pel_row_t *row)
{
    double g[3];
    line_of_sight_difference(sat, pivot, g);
    start_row(ant, ant->i_r, dd_m, row);
    put_arm(ant, ant->lever_e, g, row);
    put_vector(row, ant->i_r, g);
}

void pel_observe_rate(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double dd_mps,
                      pel_row_t *row)
{
    double g[3];
    line_of_sight_difference(sat, pivot, g);
    start_row(ant, ant->i_v, dd_mps, row);
    put_arm(ant, ant->lever_rate_e, g, row);
    put_vector(row, ant->i_v, g);
}

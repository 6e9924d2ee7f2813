/* dd_rows.c - rows of double differences whose integer is known or not needed. */
#include "row.h"

static int first_of(const pel_antenna_t *ant, int otherwise)
{
    return (ant->i_psi >= 0) ? ant->i_psi : otherwise;
}

void pel_observe_range(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double dd_m,
                       pel_row_t *row)
{
    double g[3];
    pel_row_direction(sat, pivot, g);
    pel_row_begin(row, ant->n_states, first_of(ant, ant->i_r), -dd_m);
    pel_row_put_arm(ant, ant->lever_e, g, row);
    pel_row_put(row, ant->i_r, g);
}

void pel_observe_rate(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double dd_mps,
                      pel_row_t *row)
{
    double g[3];
    pel_row_direction(sat, pivot, g);
    pel_row_begin(row, ant->n_states, first_of(ant, ant->i_v), -dd_mps);
    pel_row_put_arm(ant, ant->lever_rate_e, g, row);
    pel_row_put(row, ant->i_v, g);
}

/* motion_rows.c - what is known of the vehicle without a satellite: height, standing still, not sliding (S3 sections 8 and 14). */
#include "row.h"

void pel_observe_height(const pel_antenna_t *ant, const double up_e[3], double dh_m, int i_height, pel_row_t *row)
{
    pel_row_begin(row, ant->n_states, (ant->i_psi >= 0) ? ant->i_psi : ant->i_r, dh_m);
    pel_row_put_arm(ant, ant->lever_e, up_e, row);
    pel_row_put(row, ant->i_r, up_e);
    if (i_height >= 0) { row->h[i_height] = PEL_R(-1.0); }
}

void pel_observe_velocity(const pel_antenna_t *ant, const double along_e[3], double dv_mps, pel_row_t *row)
{
    pel_row_begin(row, ant->n_states, ant->i_v, dv_mps);
    pel_row_put(row, ant->i_v, along_e);
}

void pel_observe_body_velocity(const pel_antenna_t *ant, const double C_b_e[3][3], const double v_eb_e[3],
                               const double rate_b[3], int axis, double measured_mps, pel_row_t *row)
{
    const double along_e[3] = {C_b_e[0][axis], C_b_e[1][axis], C_b_e[2][axis]};
    double on_psi[3];
    pel_cross3(along_e, v_eb_e, on_psi); /* C~' v~ = C' (v + dv - psi x v) */
    pel_row_begin(row, ant->n_states, ant->i_psi, pel_dot3(along_e, v_eb_e) + rate_b[axis] - measured_mps);
    pel_row_put(row, ant->i_psi, on_psi);
    pel_row_put(row, ant->i_v, along_e);
}

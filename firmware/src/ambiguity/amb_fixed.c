/* amb_fixed.c - the position that known integers give, from phases alone. */
#include "ambiguity_internal.h"
#include "pelorus/math.h"

pel_status_t pel_amb_fixed(const pel_amb_problem_t *p, const int64_t *N, double b[3], double P_b[3][3], double *sq,
                           int *dof)
{
    double M[3][3] = {{0.0}};
    double c[3] = {0.0};
    double yy = 0.0;
    double sum_h[3] = {0.0};
    double sum_y = 0.0;
    double q = 0.0;
    int group = -1;
    int n = 0;
    for (int i = 0; i < p->n_rows; i++) {
        const pel_amb_row_t *row = &p->row[i];
        if (!row->integer) { continue; }
        const pel_amb_group_t *g = &p->group[row->group];
        const double iono = g->mu * g->mu * p->var_iono; /* as noise: carriers of a satellite are not tied here */
        if (row->group != group) {
            group = row->group;
            q = g->var_phase + iono;
            sum_y = 0.0;
            for (int k = 0; k < 3; k++) { sum_h[k] = 0.0; }
        }
        const double r = row->var_phase + iono;
        const double d = r + q;
        const double l = q / d;
        const double y = row->phase_m - row->lambda_m * (double)N[n++] - sum_y;
        double h[3];
        for (int k = 0; k < 3; k++) {
            h[k] = row->g[k] - sum_h[k];
            sum_h[k] += l * h[k];
            c[k] += h[k] * y / d;
        }
        for (int k = 0; k < 3; k++) {
            for (int m = 0; m < 3; m++) { M[k][m] += h[k] * h[m] / d; }
        }
        sum_y += l * y;
        q *= r / d;
        yy += y * y / d;
    }
    double inverse[3][3];
    if (n < 3 || pel_mat3_inverse(M, inverse) != PEL_OK) { return PEL_E_GEOMETRY; }
    double x[3];
    pel_mat3_vec(inverse, c, x);
    for (int k = 0; k < 3; k++) {
        b[k] = x[k];
        for (int m = 0; m < 3; m++) { P_b[k][m] = inverse[k][m]; }
    }
    *sq = pel_max(yy - pel_dot3(c, x), 0.0);
    *dof = n - 3;
    return PEL_OK;
}

void pel_amb_misfits(const pel_amb_problem_t *p, const int64_t *N, const double b[3], float misfit[PEL_MAX_AMB])
{
    for (int i = 0, k = 0; i < p->n_rows; i++) {
        const pel_amb_row_t *row = &p->row[i];
        misfit[i] = 0.0f;
        if (!row->integer) { continue; }
        const double r = row->phase_m - row->lambda_m * (double)N[k++] - pel_dot3(row->g, b);
        misfit[i] = (float)(r * r / (row->var_phase + p->group[row->group].var_phase));
    }
}

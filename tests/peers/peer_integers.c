/* peer_integers - ambiguity/ behind text lines on standard input: one epoch of double differences a problem.
 *
 *   P have_prior Pxx Pxy Pxz Pyx .. Pzz var_iono     start a problem
 *   G sat mu var_phase var_code                      add a group, its pivot
 *   R group sat integer code gx gy gz lambda phase_m code_m var_phase var_code     add a row
 *   L ratio_min success_min failure_max              limits (0 0 0: those of pel_int_limits_default())
 *   S max_tries                                      solve -> S status, N status reason failed success ratio ratio_needed chi2 chi2_max dof prior_sq
 *                                                    bx by bz sdx sdy sdz, then the integers by row; max_tries > 1: pel_amb_resolve() */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelorus/ambiguity.h"
#include "pelorus/math.h"

#define NODES 1000000

static pel_amb_problem_t problem;
static pel_int_limits_t limits;
static pel_ils_t ils;

static double number(char **p)
{
    return strtod(*p, p);
}

static void start(char *p)
{
    memset(&problem, 0, sizeof problem);
    pel_int_limits_default(&limits);
    problem.have_prior = number(&p) != 0.0;
    for (int i = 0; i < 9; i++) { problem.P_r[i / 3][i % 3] = number(&p); }
    problem.var_iono = number(&p);
}

static void add_group(char *p)
{
    if (problem.n_groups >= PEL_AMB_GROUPS) { return; }
    pel_amb_group_t *g = &problem.group[problem.n_groups++];
    g->sat = (uint8_t)number(&p);
    g->mu = number(&p);
    g->var_phase = number(&p);
    g->var_code = number(&p);
}

static void add_row(char *p)
{
    if (problem.n_rows >= PEL_MAX_AMB) { return; }
    pel_amb_row_t *row = &problem.row[problem.n_rows++];
    row->group = (uint8_t)number(&p);
    row->sat = (uint8_t)number(&p);
    row->integer = number(&p) != 0.0;
    row->code = number(&p) != 0.0;
    for (int k = 0; k < 3; k++) { row->g[k] = number(&p); }
    double *const field[] = {&row->lambda_m, &row->phase_m, &row->code_m, &row->var_phase, &row->var_code};
    for (int k = 0; k < 5; k++) { *field[k] = number(&p); }
}

static void set_limits(char *p)
{
    double *const field[] = {&limits.ratio_min, &limits.success_min, &limits.failure_max};
    for (int k = 0; k < 3; k++) { *field[k] = number(&p); }
}

/* Integers of all rows, whatever the verdict, and the position they give. */
static void solve(char *p)
{
    pel_int_verdict_t v = {.reason = PEL_INT_NOT_TRIED};
    int64_t N[PEL_MAX_AMB] = {0};
    double b[3] = {0.0};
    double P_b[3][3] = {{0.0}};
    double sq;
    int dof;
    const int tries = (int)number(&p);
    pel_status_t status;
    if (tries > 1) {
        status = pel_amb_resolve(&problem, &ils, &limits, NODES, tries, N, &v);
    } else {
        status = pel_amb_float(&problem, &ils, 2, NODES);
        if (status == PEL_OK) { status = pel_ils_run(&ils, NODES); }
        if (status >= 0) { (void)pel_int_validate(&problem, &ils, &limits, &v); }
        (void)pel_ils_get(&ils, 0, N, NULL);
    }
    (void)pel_amb_fixed(&problem, N, b, P_b, &sq, &dof);
    printf("S %d %d %d %.9g %.9g %.9g %.9g %.9g %d %.9g", status, v.reason, v.failed, v.success, v.ratio,
           v.ratio_needed, v.chi2, v.chi2_max, v.chi2_dof, v.prior_sq);
    for (int k = 0; k < 3; k++) { printf(" %.9g", b[k]); }
    for (int k = 0; k < 3; k++) { printf(" %.9g", pel_sqrt(P_b[k][k])); }
    for (int i = 0; i < problem.n_rows; i++) { printf(" %" PRId64, N[i]); }
    printf("\n");
    (void)fflush(stdout);
}

int main(void)
{
    char line[1024];
    while (fgets(line, sizeof line, stdin) != NULL) {
        switch (line[0]) {
        case 'P': start(line + 1); break;
        case 'G': add_group(line + 1); break;
        case 'R': add_row(line + 1); break;
        case 'L': set_limits(line + 1); break;
        case 'S': solve(line + 1); break;
        default: break;
        }
    }
    return 0;
}

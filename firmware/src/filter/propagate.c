/* propagate.c - from strapdown steps to time updates. */
#include "pelorus/filter.h"
#include "pelorus/math.h"

#define MAX_GNSS_SUBSTEPS 40

/* Start the next substep here. The time since the last Markov decay runs on. */
static void restart(pel_propagator_t *p, const double C_b_e[3][3])
{
    p->dt_s = 0.0;
    for (int i = 0; i < 3; i++) { p->dv_f_e[i] = 0.0; }
    pel_mat3_copy(C_b_e, p->C_start);
}

void pel_propagator_init(pel_propagator_t *p, const double C_b_e[3][3])
{
    restart(p, C_b_e);
    p->slow_s = 0.0;
}

/* Mean specific force and mean attitude of what is collected: they make the time update second order in the substep. Then start anew. */
static double finish(pel_propagator_t *p, const double C_now[3][3], double f[3], double C[3][3])
{
    const double dt_s = p->dt_s;
    for (int i = 0; i < 3; i++) {
        f[i] = p->dv_f_e[i] / dt_s;
        for (int j = 0; j < 3; j++) { C[i][j] = 0.5 * (p->C_start[i][j] + C_now[i][j]); }
    }
    p->slow_s += dt_s;
    restart(p, C_now);
    return dt_s;
}

static pel_status_t substep(pel_propagator_t *p, const pel_model_t *m, const double C_b_e[3][3], const double r_e[3],
                            pel_ud_t *ud)
{
    double f_e[3];
    double C[3][3];
    pel_transition_t t;
    const double dt_s = finish(p, C_b_e, f_e, C);
    pel_model_transition(m, f_e, C, r_e, dt_s, &t);
    return pel_ud_time_update(ud, &t);
}

static pel_status_t substep_enu(pel_propagator_t *p, const pel_model_t *m, const pel_strapdown_enu_t *s, pel_ud_t *ud)
{
    double f_enu[3];
    double C[3][3];
    pel_transition_t t;
    const double dt_s = finish(p, s->C_b_enu, f_enu, C);
    pel_model_transition_enu(m, f_enu, C, s->v_eb_enu, s->lat, s->h, dt_s, &t);
    return pel_ud_time_update(ud, &t);
}

static pel_status_t decay(pel_propagator_t *p, const pel_model_t *m, pel_ud_t *ud)
{
    pel_real d[PEL_MAX_STATES];
    pel_real q[PEL_MAX_STATES];
    pel_model_slow(m, p->slow_s, d, q);
    p->slow_s = 0.0;
    return pel_ud_decay(ud, d, q);
}

/* Add a step; true when a time update is due. Half a step early rather than half a step late: substeps stay near PEL_SUBSTEP_S at
 * every IMU rate. */
static bool collect(pel_propagator_t *p, const double dv_f[3], double dt_s)
{
    for (int i = 0; i < 3; i++) { p->dv_f_e[i] += dv_f[i]; }
    p->dt_s += dt_s;
    return p->dt_s + 0.5 * dt_s >= PEL_SUBSTEP_S;
}

static pel_status_t decay_when_due(pel_propagator_t *p, const pel_model_t *m, pel_status_t status, pel_ud_t *ud)
{
    return (status == PEL_OK && p->slow_s >= PEL_SLOW_S) ? decay(p, m, ud) : status;
}

pel_status_t pel_propagator_add(pel_propagator_t *p, const pel_model_t *m, const double dv_f_e[3], double dt_s,
                                const double C_b_e[3][3], const double r_e[3], pel_ud_t *ud)
{
    if (!collect(p, dv_f_e, dt_s)) { return PEL_W_RUNNING; }
    return decay_when_due(p, m, substep(p, m, C_b_e, r_e, ud), ud);
}

pel_status_t pel_propagator_flush(pel_propagator_t *p, const pel_model_t *m, const double C_b_e[3][3],
                                  const double r_e[3], pel_ud_t *ud)
{
    if (!(p->dt_s > 0.0)) { return PEL_OK; }
    return decay_when_due(p, m, substep(p, m, C_b_e, r_e, ud), ud);
}

pel_status_t pel_propagator_add_enu(pel_propagator_t *p, const pel_model_t *m, const double dv_f_enu[3], double dt_s,
                                    const pel_strapdown_enu_t *s, pel_ud_t *ud)
{
    if (!collect(p, dv_f_enu, dt_s)) { return PEL_W_RUNNING; }
    return decay_when_due(p, m, substep_enu(p, m, s, ud), ud);
}

pel_status_t pel_propagator_flush_enu(pel_propagator_t *p, const pel_model_t *m, const pel_strapdown_enu_t *s,
                                      pel_ud_t *ud)
{
    if (!(p->dt_s > 0.0)) { return PEL_OK; }
    return decay_when_due(p, m, substep_enu(p, m, s, ud), ud);
}

pel_status_t pel_propagate_gnss(const pel_model_t *m, const double r_e[3], double dt_s, pel_ud_t *ud)
{
    if (!(dt_s > 0.0)) { return PEL_E_RANGE; }
    int steps = 1;
    while (steps < MAX_GNSS_SUBSTEPS && dt_s > 0.25 * (double)steps) { steps++; }

    const int v = pel_model_index(m, PEL_BLOCK_VELOCITY);
    pel_transition_t t;
    pel_model_transition(m, NULL, NULL, r_e, dt_s / (double)steps, &t);
    for (int i = 0; i < 3; i++) { t.q[v + i] *= PEL_R(0.5); }
    for (int k = 0; k < steps; k++) {
        /* noise half before and half after the step: its share of position is then right to second order */
        for (int i = 0; i < 3; i++) { pel_ud_add_noise(ud, v + i, t.q[v + i]); }
        const pel_status_t status = pel_ud_time_update(ud, &t);
        if (status != PEL_OK) { return status; }
    }
    return PEL_OK;
}

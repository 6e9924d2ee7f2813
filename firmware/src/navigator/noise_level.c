/* noise_level.c - how noisy codes and phases of rover and base really are, learnt from what they leave over.
 *
 * Receivers differ by a factor of ten, their antennas and surroundings by as much again, and what a measurement is believed
 * decides how early integers are and how often they are wrong. So the variances of each system and carrier have a factor for the
 * code and one for the phase, begun at one with the weight of a few rows: the mean of squared innovations over their variance,
 * each row with the weight of what it tells of the measurement rather than of the position. Derivation: docs/NAVIGATOR.md. */
#include "internal.h"

#define LEARN_EVERY_S 0.9
#define PRIOR_ROWS    4.0f
#define MEMORY_ROWS   150.0f /* and no longer: surroundings change */

#define LOST 0.95f

/* Limits of the factor of a variance. What wrong integers leave over must not make them look right: at its limit a phase's level says
 * that its integers are wrong. */
static const float LEAST[PEL_NAV_LEVELS] = {0.1f, 0.5f, 0.25f};
static const float MOST[PEL_NAV_LEVELS] = {10.0f, 4.0f, 25.0f};

void pel_nav_noise_level_init(pel_navigator_t *nav)
{
    for (int sys = 0; sys < PEL_N_SYS; sys++) {
        for (int carrier = 0; carrier < PEL_N_CARRIER; carrier++) {
            for (int kind = 0; kind < PEL_NAV_LEVELS; kind++) {
                nav->noise_level.of[kind][sys][carrier] = (pel_noise_factor_t){.factor = 1.0f, .rows = PRIOR_ROWS};
            }
        }
    }
}

bool pel_nav_noise_level_phase_is_lost(pel_navigator_t *nav)
{
    bool lost = false;
    for (int i = 0; i < nav->sd.n; i++) {
        pel_noise_factor_t *f = &nav->noise_level.of[PEL_NAV_LEVEL_PHASE][nav->sd.sd[i].sys][nav->sd.sd[i].carrier];
        if (f->factor < LOST * MOST[PEL_NAV_LEVEL_PHASE]) { continue; }
        *f = (pel_noise_factor_t){.factor = 1.0f, .rows = PRIOR_ROWS};
        lost = true;
    }
    return lost;
}

void pel_nav_noise_level_apply(pel_navigator_t *nav)
{
    for (int i = 0; i < nav->sd.n; i++) {
        pel_sd_t *sd = &nav->sd.sd[i];
        const int phase = nav->relative ? PEL_NAV_LEVEL_PHASE : PEL_NAV_LEVEL_ROVER;
        if (nav->relative) {
            sd->var_code *= (double)nav->noise_level.of[PEL_NAV_LEVEL_CODE][sd->sys][sd->carrier].factor;
        }
        sd->var_phase *= (double)nav->noise_level.of[phase][sd->sys][sd->carrier].factor;
    }
}

void pel_nav_noise_level_begin(pel_navigator_t *nav, double code_inflated_by)
{
    pel_noise_level_t *c = &nav->noise_level;
    const double dt_s = pel_time_diff_s(nav->at_horizon.t_ns, c->learnt_ns);
    const bool first = c->learnt_ns == 0 || dt_s < 0.0;
    c->learning = nav->cfg.learn_noise && (!nav->relative || first || dt_s >= LEARN_EVERY_S);
    c->code_inflated_by = (float)code_inflated_by;
    if (!c->learning) { return; }
    c->share =
        !nav->relative ? 1.0f : (float)(first ? 1.0 : pel_min(1.0, dt_s / pel_max(nav->cfg.code_tau_s, LEARN_EVERY_S)));
    c->learnt_ns = nav->at_horizon.t_ns;
}

void pel_nav_noise_level_learn(pel_navigator_t *nav, const pel_sd_t *sd, int kind, double nis, double var_state,
                               double var_row)
{
    pel_noise_level_t *c = &nav->noise_level;
    const double var = (kind == PEL_NAV_LEVEL_CODE) ? var_row / (double)c->code_inflated_by : var_row;
    const double told = var / (var_state + var); /* the part of the innovation that is the measurement's */
    const float weight = c->share * (float)(told * told);
    const float seen = (float)(nis * (var_state + var_row) / (var_state + var));
    pel_noise_factor_t *f = &c->of[kind][sd->sys][sd->carrier];
    f->rows = (f->rows + weight < MEMORY_ROWS) ? f->rows + weight : MEMORY_ROWS;
    f->factor += f->factor * (seen - 1.0f) * weight / f->rows;
    if (f->factor < LEAST[kind]) { f->factor = LEAST[kind]; }
    if (f->factor > MOST[kind]) { f->factor = MOST[kind]; }
}

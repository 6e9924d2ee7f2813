/* code_noise.c - how noisy the codes of rover and base really are, learnt from what they leave over.
 *
 * Receivers differ by a factor of ten, their antennas and surroundings by as much again, and what the codes are believed decides
 * how early integers are and how often they are wrong. So the variance of each system and carrier has one factor, begun at one
 * with the weight of a few rows: the mean of squared innovations over their variance, of those rows that tell more of the code
 * than of the position. */
#include "internal.h"

#define LEARN_EVERY_S 0.9
#define PRIOR_ROWS    10.0f
#define MEMORY_ROWS   400.0f /* and no longer: surroundings change */
#define FACTOR_MIN    0.1f   /* of the variance */
#define FACTOR_MAX    10.0f

void pel_nav_code_noise_init(pel_navigator_t *nav)
{
    for (int sys = 0; sys < PEL_N_SYS; sys++) {
        for (int carrier = 0; carrier < PEL_N_CARRIER; carrier++) {
            nav->code_noise.of[sys][carrier] = (pel_code_factor_t){.factor = 1.0f, .rows = PRIOR_ROWS};
        }
    }
}

void pel_nav_code_noise_apply(pel_navigator_t *nav)
{
    for (int i = 0; i < nav->sd.n; i++) {
        pel_sd_t *sd = &nav->sd.sd[i];
        sd->var_code *= (double)nav->code_noise.of[sd->sys][sd->carrier].factor;
    }
}

void pel_nav_code_noise_begin(pel_navigator_t *nav, double inflated_by)
{
    pel_code_noise_t *c = &nav->code_noise;
    const double dt_s = pel_time_diff_s(nav->at_horizon.t_ns, c->learnt_ns);
    c->learning = nav->relative && (dt_s >= LEARN_EVERY_S || dt_s < 0.0 || c->learnt_ns == 0);
    c->inflated_by = (float)inflated_by;
    if (!c->learning) { return; }
    c->share = (float)((c->learnt_ns == 0 || dt_s < 0.0)
                           ? 1.0
                           : pel_min(1.0, dt_s / pel_max(nav->cfg.code_tau_s, LEARN_EVERY_S)));
    c->learnt_ns = nav->at_horizon.t_ns;
}

void pel_nav_code_noise_learn(pel_navigator_t *nav, const pel_sd_t *sd, double nis, double var_state, double var_row)
{
    pel_code_noise_t *c = &nav->code_noise;
    const double var_code = var_row / (double)c->inflated_by;
    if (var_state > var_code) { return; }
    pel_code_factor_t *f = &c->of[sd->sys][sd->carrier];
    const float seen = (float)(nis * (var_state + var_row) / (var_state + var_code));
    f->rows = (f->rows + c->share < MEMORY_ROWS) ? f->rows + c->share : MEMORY_ROWS;
    f->factor += f->factor * (seen - 1.0f) * c->share / f->rows;
    if (f->factor < FACTOR_MIN) { f->factor = FACTOR_MIN; }
    if (f->factor > FACTOR_MAX) { f->factor = FACTOR_MAX; }
}

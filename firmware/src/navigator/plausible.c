/* plausible.c - does an epoch, or the INS, contradict itself? Faults of time and of sensors that pass every check of a single number. */
#include "internal.h"

#include "pelorus/math.h"

#define SPP_RMS_MAX                                                                                                    \
    30.0 /* code residuals over their sigma: beyond what multipath does; a tag off by a second does it */
#define BASE_SPREAD_M 100.0 /* of a base's code residuals at its known place: the median's distance */
#define BASE_FEWEST   5
#define RATE_FEWEST   5
#define MOST_RESTLESS 3 /* epochs in a row whose Doppler contradicts the INS */

bool pel_nav_spp_is_plausible(const pel_spp_t *spp)
{
    return spp->rms_m < SPP_RMS_MAX;
}

static void insert_sorted(double *x, int n, double v)
{
    int j = n;
    for (; j > 0 && x[j - 1] > v; j--) { x[j] = x[j - 1]; }
    x[j] = v;
}

bool pel_nav_base_is_plausible(const pel_navigator_t *nav, const pel_epoch_t *base)
{
    double residual[PEL_MAX_SATS], off[PEL_MAX_SATS];
    int n = 0;
    uint8_t sys = PEL_N_SYS, carrier = 0;
    for (int i = 0; i < base->n && i < PEL_MAX_OBS && n < PEL_MAX_SATS; i++) {
        const pel_obs_t *o = &base->obs[i];
        const pel_sight_t *s = pel_view_find(&nav->view_base, o->sys, o->prn);
        if (s == NULL || !pel_obs_usable(o, PEL_OBS_CODE)) { continue; }
        if (sys == PEL_N_SYS) { /* one clock: the first signal's system and carrier */
            sys = o->sys;
            carrier = o->carrier;
        }
        if (o->sys != sys || o->carrier != carrier) { continue; }
        insert_sorted(residual, n, o->P_m - pel_sight_code_m(s, o));
        n++;
    }
    if (n < BASE_FEWEST) { return true; }
    const double middle = residual[n / 2];
    for (int i = 0; i < n; i++) { insert_sorted(off, i, pel_fabs(residual[i] - middle)); }
    return off[n / 2] < BASE_SPREAD_M;
}

bool pel_nav_ins_is_contradicted(pel_navigator_t *nav)
{
    int tried = 0, used = 0;
    for (int i = 0; i < nav->n_sats; i++) {
        tried += nav->sats[i].sd_doppler_mps > 0.0f;
        used += (nav->sats[i].flags & PEL_SAT_DOPPLER_USED) != 0;
    }
    const bool restless = nav->ins && tried >= RATE_FEWEST && 3 * used < tried;
    nav->restless = (uint8_t)(restless ? nav->restless + 1 : 0);
    return nav->restless >= MOST_RESTLESS;
}

/* tdcp.c - the history of time-differenced phases, and their own test for slips (S3 sections 6 and 13). */
#include <string.h>

#include "pelorus/math.h"
#include "pelorus/observe.h"

#define GATE_SIGMA 6.0

void pel_tdcp_init(pel_tdcp_t *h)
{
    memset(h, 0, sizeof *h);
}

static const pel_obs_t *find_obs(const pel_epoch_t *e, const pel_sd_t *sd)
{
    for (int i = 0; i < e->n; i++) {
        const pel_obs_t *o = &e->obs[i];
        if (o->sys == sd->sys && o->prn == sd->prn && o->carrier == sd->carrier && pel_obs_usable(o, PEL_OBS_PHASE)) {
            return o;
        }
    }
    return NULL;
}

static const pel_tdcp_entry_t *find_entry(const pel_tdcp_t *h, const pel_obs_t *o)
{
    for (int i = 0; i < h->n; i++) {
        const pel_tdcp_entry_t *x = &h->entry[i];
        if (x->sys == o->sys && x->prn == o->prn && x->carrier == o->carrier && x->code == o->code) { return x; }
    }
    return NULL;
}

/* Is this phase the same integer's as far as the receiver says? */
static bool goes_on(const pel_tdcp_entry_t *x, const pel_obs_t *o, pel_time_t t_ns)
{
    const int64_t gap_ns = t_ns - x->t_ns;
    const bool half = (o->flags & PEL_OBS_HALF_CYCLE) != 0;
    const bool spans = (int64_t)o->lock_ms * PEL_NS_PER_MS >= gap_ns && o->lock_ms > x->lock_ms;
    if ((o->flags & PEL_OBS_SLIP) != 0 || half != x->half || o->lock_ms < x->lock_ms) { return false; }
    return spans || (double)gap_ns <= 1e9 * PEL_TDCP_MAX_GAP_S;
}

/* Median by counting: the smallest value that at least half of the values do not exceed; with an even number the mean of the two in the middle. */
static double median(const pel_tdcp_change_t change[], int n_rows, int n)
{
    double low = 0.0;
    double high = 0.0;
    for (int i = 0; i < n_rows; i++) {
        if (change[i].kind != PEL_TDCP_CONTINUOUS) { continue; }
        int below = 0;
        int equal = 0;
        for (int j = 0; j < n_rows; j++) {
            if (change[j].kind != PEL_TDCP_CONTINUOUS) { continue; }
            below += (change[j].change_m < change[i].change_m) ? 1 : 0;
            equal += (change[j].change_m == change[i].change_m) ? 1 : 0;
        }
        if (below <= (n - 1) / 2 && (n - 1) / 2 < below + equal) { low = change[i].change_m; }
        if (below <= n / 2 && n / 2 < below + equal) { high = change[i].change_m; }
    }
    return 0.5 * (low + high);
}

/* Changes against their common part. */
static void judge(pel_tdcp_t *h, const pel_sd_set_t *set, int n, double sd_m, pel_tdcp_change_t change[])
{
    const double common = median(change, set->n, n);
    for (int i = 0; i < set->n; i++) {
        if (change[i].kind != PEL_TDCP_CONTINUOUS) { continue; }
        if (n == 1) { /* nobody to compare with */
            change[i] = (pel_tdcp_change_t){.change_m = 0.0, .kind = PEL_TDCP_NEW};
            h->restarts++;
            continue;
        }
        const double sigma = pel_sqrt(sd_m * sd_m + 2.0 * set->sd[i].var_phase);
        const double gate = pel_max(0.5 * set->sd[i].lambda_m, GATE_SIGMA * sigma);
        /* the common part of two is their mean: each then shows half of what they differ by */
        const double off = pel_fabs(change[i].change_m - common) * ((n == 2) ? 2.0 : 1.0);
        if (!(off <= gate)) {
            change[i].kind = PEL_TDCP_SLIPPED;
            h->slips++;
        }
    }
}

pel_status_t pel_tdcp_step(pel_tdcp_t *h, const pel_epoch_t *e, const pel_sd_set_t *set, double sd_m,
                           pel_tdcp_change_t change[PEL_MAX_OBS])
{
    int n = 0;
    for (int i = 0; i < h->n; i++) {
        if (h->entry[i].t_ns >= e->t_ns) { return PEL_E_STALE; }
    }
    for (int i = 0; i < set->n; i++) {
        const pel_sd_t *sd = &set->sd[i];
        const pel_obs_t *o = sd->has_phase ? find_obs(e, sd) : NULL;
        change[i].change_m = 0.0;
        change[i].kind = (uint8_t)((o != NULL) ? PEL_TDCP_NEW : PEL_TDCP_NONE);
        if (o == NULL) { continue; }
        const pel_tdcp_entry_t *x = find_entry(h, o);
        if (x != NULL && !sd->slip && goes_on(x, o, e->t_ns)) {
            change[i].change_m = sd->phase_m - x->residual_m;
            change[i].kind = PEL_TDCP_CONTINUOUS;
            n++;
        } else {
            h->restarts++;
        }
    }
    judge(h, set, n, sd_m, change);

    h->n = 0; /* what is not seen now has a gap and starts anew */
    for (int i = 0; i < set->n; i++) {
        const pel_sd_t *sd = &set->sd[i];
        const pel_obs_t *o = sd->has_phase ? find_obs(e, sd) : NULL;
        if (o == NULL) { continue; }
        pel_tdcp_entry_t *x = &h->entry[h->n++];
        *x = (pel_tdcp_entry_t){.sys = o->sys,
                                .prn = o->prn,
                                .carrier = o->carrier,
                                .code = o->code,
                                .half = (o->flags & PEL_OBS_HALF_CYCLE) != 0,
                                .lock_ms = o->lock_ms,
                                .t_ns = e->t_ns,
                                .residual_m = sd->phase_m,
                                .u_e = {sd->u_e[0], sd->u_e[1], sd->u_e[2]}};
    }
    return PEL_OK;
}

void pel_tdcp_move(pel_tdcp_t *h, const double da_e[3])
{
    for (int i = 0; i < h->n; i++) { h->entry[i].residual_m += pel_dot3(h->entry[i].u_e, da_e); }
}

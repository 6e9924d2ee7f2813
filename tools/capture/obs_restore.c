#include "obs_restore.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TAG_STEPS                                                                                                      \
    4 /* a tag 10 ms off moves satellites by 40 m and the clock found by some of that: 100 ns, then less than 1 ns */
#define TAG_GOOD_NS 10

bool obs_removed_parse(const char *text, obs_removed_t *out)
{
    static const char *const NAME[3] = {"receiver-clock", "satellite-clock", "group-delay"};
    bool found[3] = {false};
    while (*text != '\0') {
        const size_t n = strcspn(text, ",");
        bool known = false;
        for (int i = 0; i < 3; i++) {
            if (strlen(NAME[i]) == n && strncmp(text, NAME[i], n) == 0) { known = found[i] = true; }
        }
        if (!known) { return false; }
        text += n + (text[n] == ',');
    }
    *out = (obs_removed_t){found[0], found[1], found[2]};
    return obs_removed_any(out);
}

bool obs_removed_any(const obs_removed_t *r)
{
    return r->receiver_clock || r->satellite_clock || r->group_delay;
}

void obs_restore_open(obs_restore_t *r, const obs_removed_t *removed, nav_set_t *nav, pel_time_t start, tally_t *tally)
{
    tally_t unheard = {0}; /* counted when they are sent */
    memset(r, 0, sizeof *r);
    r->removed = *removed;
    r->tally = tally;
    pel_orbits_init(&r->orbits);
    r->orbits.klobuchar = nav->klobuchar;
    r->n_sent = nav_set_schedule(nav, start, INT64_MAX, &unheard, &r->sent);
}

void obs_restore_close(obs_restore_t *r)
{
    free(r->sent);
    r->sent = NULL;
}

static void receive_orbits(obs_restore_t *r, pel_time_t t)
{
    for (; r->next < r->n_sent && r->sent[r->next].t_ns <= t; r->next++) {
        (void)pel_orbits_add(&r->orbits, r->sent[r->next].eph);
    }
}

/* False: no orbit, so its clock and delay are not known. */
static bool restore_code(const obs_restore_t *r, pel_time_t t, pel_obs_t *obs)
{
    pel_sat_state_t s;
    const pel_ephemeris_t *eph = pel_orbits_find(&r->orbits, obs->sys, obs->prn, t);
    if (eph == NULL || pel_sat_state(eph, t, -obs->P_m / PEL_SPEED_OF_LIGHT, &s) != PEL_OK) { return false; }
    if (r->removed.satellite_clock) { obs->P_m -= PEL_SPEED_OF_LIGHT * s.clk_s; }
    if (r->removed.group_delay) { obs->P_m += pel_sat_group_delay_m(eph, (pel_carrier_t)obs->carrier); }
    return true;
}

/* The receiver's own tag of an epoch at the true time e->t_ns. */
static bool restore_tag(obs_restore_t *r, pel_epoch_t *e)
{
    pel_spp_config_t cfg;
    const pel_time_t t = e->t_ns;
    const pel_spp_t before = r->fix;
    pel_time_t off = 0;
    pel_spp_default(&cfg);
    if (r->have_fix) {
        const double clk_m = before.clk_m + before.clk_rate_mps * pel_time_diff_s(t, before.t_ns);
        off = (pel_time_t)llround(1e9 * clk_m / PEL_SPEED_OF_LIGHT);
    }
    e->t_ns = t + off;
    for (int i = 0; i < TAG_STEPS; i++) {
        const pel_status_t status =
            pel_spp_solve(e, &r->orbits, &cfg, r->have_fix ? &before : NULL, NULL, &r->view, &r->fix);
        if (status != PEL_OK && status != PEL_W_REJECTED) {
            r->fix = before;
            e->t_ns = t + off;
            tally_add(r->tally, TALLY_NOTE, "epochs whose receiver clock is carried on from the one before",
                      r->have_fix);
            return r->have_fix;
        }
        const pel_time_t step = t - r->fix.t_ns;
        e->t_ns += step;
        if (step >= -TAG_GOOD_NS && step <= TAG_GOOD_NS) { break; }
    }
    r->have_fix = true;
    return true;
}

bool obs_restore_epoch(obs_restore_t *r, pel_epoch_t *e)
{
    int n = 0;
    receive_orbits(r, e->t_ns);
    for (int i = 0; i < e->n; i++) {
        if (restore_code(r, e->t_ns, &e->obs[i])) {
            e->obs[n++] = e->obs[i];
        } else {
            tally_add(r->tally, TALLY_LEFT, "rows of satellites without an orbit", 1);
        }
    }
    e->n = (uint16_t)n;
    if (n > 0 && r->removed.receiver_clock && !restore_tag(r, e)) {
        tally_add(r->tally, TALLY_LEFT, "epochs whose receiver clock is not known", 1);
        return false;
    }
    return n > 0;
}

#include <string.h>

#include "pelorus/gnss.h"
#include "pelorus/math.h"

#define MS_M             (1e-3 * PEL_SPEED_OF_LIGHT)
#define PHASE_SD_M       0.003 /* of one phase at the zenith, strong, unless told otherwise */
#define CN0_STRONG       42.0  /* dBHz; noise grows below, as of a loop that tracks less power */
#define DOPPLER_SD_MPS   0.05
#define IONO_RATE_MPS    0.002 /* between carriers, in a quiet mid-latitude ionosphere 1 mm/s at most */
#define REVERSED_MIN_MPS 100.0 /* slower changes do not tell the sign of a Doppler */
#define JERK_MPS3        2.0   /* of the antenna, for the trapezoid over Doppler: jerk dt^3 / 12 */
#define MAX_LOCK_MS      3600000u
#define NO_SIGHT         255u

_Static_assert(PEL_MAX_SATS < NO_SIGHT, "a sight's index is a byte");

/* An observation beside its memory. */
typedef struct {
    const pel_epoch_t *e;
    const pel_view_t *view;
    double phase_sd_m;           /* at the zenith, strong */
    int16_t old[PEL_MAX_OBS];    /* entry of the epoch before, -1 none */
    uint8_t usable[PEL_MAX_OBS]; /* PEL_OBS_CODE, _PHASE, _DOPPLER */
    uint8_t sight[PEL_MAX_OBS];  /* index into view of a phase's satellite, or NO_SIGHT */
    double value[PEL_MAX_OBS];   /* what a detector looks at; only where valid */
    double sorted[PEL_MAX_OBS];  /* the same, for the median */
    bool valid[PEL_MAX_OBS];
} pass_t;

void pel_slip_init(pel_slip_t *s)
{
    memset(s, 0, sizeof *s);
    s->phase_sd_m = PHASE_SD_M;
}

static bool is_signal(const pel_slip_entry_t *k, const pel_obs_t *obs)
{
    return k->prn == obs->prn && k->sys == obs->sys && k->carrier == obs->carrier && k->code == obs->code;
}

/* Receivers list their signals in the same order each time, so the search starts where the last one ended. */
static int16_t find_entry(const pel_slip_t *s, const pel_obs_t *obs, int start)
{
    for (int k = 0; k < s->n; k++) {
        const int i = (start + k) % s->n;
        if (is_signal(&s->entry[i], obs)) { return (int16_t)i; }
    }
    return -1;
}

static double elapsed_s(const pass_t *p, const pel_slip_entry_t *old)
{
    return pel_time_diff_s(p->e->t_ns, old->t_ns);
}

static uint8_t find_sight(const pel_view_t *view, const pel_obs_t *obs)
{
    const pel_sight_t *s = (view != NULL) ? pel_view_find(view, obs->sys, obs->prn) : NULL;
    return (uint8_t)((s != NULL) ? (unsigned)(s - view->sight) : NO_SIGHT);
}

static const pel_sight_t *sight_of(const pass_t *p, int i)
{
    return (p->sight[i] != NO_SIGHT) ? &p->view->sight[p->sight[i]] : NULL;
}

/* Noise of this signal over that of a strong one at the zenith: elevation (45 degrees if unknown) and C/N0. */
static double noise_factor(const pass_t *p, int i)
{
    const pel_sight_t *s = sight_of(p, i);
    const double cn0_dbhz = (double)p->e->obs[i].cn0_dbhz;
    const double sin_el = (s != NULL) ? pel_max(pel_sin((double)s->el_rad), 0.1) : 0.7;
    const double at_el = pel_sqrt(0.5 + 0.5 / (sin_el * sin_el));
    if (!(cn0_dbhz > 0.0 && cn0_dbhz < CN0_STRONG)) { return at_el; }
    return at_el * pel_exp((CN0_STRONG - cn0_dbhz) * 0.115129254649702286); /* 10^(dB/20) */
}

/* Median of the valid values; 0 with fewer than three, which cannot outvote a slip. */
static double median(pass_t *p)
{
    int n = 0;
    for (int i = 0; i < p->e->n; i++) {
        if (!p->valid[i]) { continue; }
        int at = n++;
        while (at > 0 && p->sorted[at - 1] > p->value[i]) {
            p->sorted[at] = p->sorted[at - 1];
            at--;
        }
        p->sorted[at] = p->value[i];
    }
    if (n < 3) { return 0.0; }
    return (n % 2 == 1) ? p->sorted[n / 2] : 0.5 * (p->sorted[n / 2 - 1] + p->sorted[n / 2]);
}

/* Whole milliseconds in a change common to all satellites, 0 if it is something else. */
static double whole_ms(double common_m)
{
    const double k = pel_round(common_m / MS_M);
    return (pel_fabs(common_m - k * MS_M) < 300.0) ? k : 0.0; /* 1 us for the codes' noise and the drift */
}

/* ---- detectors ------------------------------------------------------------------------------------------------- */

/* Lock time is a lower bound (RTCM gives it in coarse steps: the truth is below twice the value). 0 then and now: the
 * receiver tells none, and of a phase that was missing in between nothing is known. */
static bool lost_lock(const pel_obs_t *obs, const pel_slip_entry_t *old, bool missed, double dt_s)
{
    if (missed && obs->lock_ms == 0) { return true; }
    if (obs->lock_ms < old->lock_ms && obs->lock_ms < MAX_LOCK_MS) { return true; }
    return obs->lock_ms > 0 && 2.0 * (double)obs->lock_ms + 1.0 <= 1e3 * dt_s;
}

static void told_by_receiver(pass_t *p, const pel_slip_t *s, pel_epoch_t *e, pel_nav_counters_t *count)
{
    for (int i = 0; i < e->n; i++) {
        pel_obs_t *obs = &e->obs[i];
        if (p->old[i] < 0) { continue; }
        const pel_slip_entry_t *old = &s->entry[p->old[i]];
        const bool missed = old->t_ns != s->checked_ns;
        if ((obs->flags & PEL_OBS_SLIP) != 0u || lost_lock(obs, old, missed, elapsed_s(p, old))) {
            obs->flags |= PEL_OBS_SLIP;
            count->slip_lock++;
        }
        if (((obs->flags & PEL_OBS_HALF_CYCLE) != 0u) != old->half) {
            obs->flags |= PEL_OBS_SLIP;
            count->slip_half_cycle++;
        }
    }
}

/* 5 sigma of two phases in two epochs and the ionosphere's part; no more than half a cycle (or what strong signals need),
 * where weak signals raise alarms rather than hide slips. */
static double geometry_free_limit(const pass_t *p, int a, int b, double dt_s)
{
    const double sd_a = p->phase_sd_m * noise_factor(p, a);
    const double sd_b = p->phase_sd_m * noise_factor(p, b);
    const double limit = 5.0 * pel_sqrt(2.0 * (sd_a * sd_a + sd_b * sd_b)) + IONO_RATE_MPS * dt_s;
    const double half_cycle = 0.5 * pel_min(pel_obs_lambda_m(&p->e->obs[a]), pel_obs_lambda_m(&p->e->obs[b]));
    return pel_min(limit, pel_max(half_cycle, 10.0 * p->phase_sd_m));
}

/* Two carriers of a satellite see the same range: their difference moves with the ionosphere alone. Which of them slipped
 * is not known, so both are marked. Blind where a cycles on one and b on the other are equally long (77 L1 = 60 L2). */
static void geometry_free(pass_t *p, const pel_slip_t *s, pel_epoch_t *e, pel_nav_counters_t *count)
{
    for (int j = 1; j < e->n; j++) {
        pel_obs_t *b = &e->obs[j];
        if (p->old[j] < 0 || (b->flags & PEL_OBS_SLIP) != 0u) { continue; }
        for (int i = 0; i < j; i++) {
            pel_obs_t *a = &e->obs[i];
            if (a->prn != b->prn || a->sys != b->sys || p->old[i] < 0) { continue; }
            if ((a->flags & PEL_OBS_SLIP) != 0u && p->valid[i]) { continue; } /* told, not found here */
            const pel_slip_entry_t *old_a = &s->entry[p->old[i]];
            const pel_slip_entry_t *old_b = &s->entry[p->old[j]];
            if (old_a->t_ns != old_b->t_ns) { continue; }
            const double change =
                (pel_obs_lambda_m(a) * a->L_cyc - old_a->y_m) - (pel_obs_lambda_m(b) * b->L_cyc - old_b->y_m);
            if (pel_fabs(change) > geometry_free_limit(p, i, j, elapsed_s(p, old_a))) {
                a->flags |= PEL_OBS_SLIP;
                b->flags |= PEL_OBS_SLIP;
                count->slip_geometry_free++;
            }
            break; /* against the first carrier only */
        }
    }
}

/* Phase change minus mean range rate by Doppler over the true interval (tags less the clock's jump). */
static void phase_minus_doppler(pass_t *p, const pel_slip_t *s, double jump_ms)
{
    for (int i = 0; i < p->e->n; i++) {
        const pel_obs_t *obs = &p->e->obs[i];
        p->valid[i] = false;
        if (p->old[i] < 0 || (p->usable[i] & PEL_OBS_DOPPLER) == 0u) { continue; }
        const pel_slip_entry_t *old = &s->entry[p->old[i]];
        if (!old->has_rate) { continue; }
        const double lambda = pel_obs_lambda_m(obs);
        const double mean_rate = 0.5 * (-lambda * (double)obs->D_hz + (double)old->rate_mps);
        p->value[i] = (lambda * obs->L_cyc - old->y_m) - mean_rate * (elapsed_s(p, old) - 1e-3 * jump_ms);
        p->valid[i] = true;
    }
}

/* Mark what departs from the common change by more than limit_sd (per value) says. */
static uint32_t mark_departures(pass_t *p, const pel_slip_t *s, pel_epoch_t *e, double common, double sd_extra_m,
                                double doppler_sd, double jerk)
{
    uint32_t found = 0;
    for (int i = 0; i < e->n; i++) {
        if (!p->valid[i]) { continue; }
        pel_obs_t *obs = &e->obs[i];
        const double dt = elapsed_s(p, &s->entry[p->old[i]]);
        const double factor = noise_factor(p, i);
        const double phase_sd = p->phase_sd_m * factor;
        const double rate_sd = doppler_sd * factor;
        const double sd =
            pel_sqrt(2.0 * phase_sd * phase_sd + 0.5 * rate_sd * rate_sd * dt * dt + sd_extra_m * sd_extra_m);
        const double limit = pel_max(5.0 * sd + jerk * dt * dt * dt / 12.0, 0.5 * pel_obs_lambda_m(obs));
        if (pel_fabs(p->value[i] - common) > limit) {
            obs->flags |= PEL_OBS_SLIP;
            found++;
        }
    }
    return found;
}

/* Returns the clock's jump in whole ms, told by the code against the phase, or (a receiver that moves its phase along) by
 * the phase against the Doppler. */
static double clock_jump_ms(pass_t *p, const pel_slip_t *s)
{
    for (int i = 0; i < p->e->n; i++) {
        const pel_obs_t *obs = &p->e->obs[i];
        p->valid[i] = false;
        if (p->old[i] < 0 || (p->usable[i] & PEL_OBS_CODE) == 0u || s->entry[p->old[i]].code_m == 0.0) { continue; }
        p->value[i] = obs->P_m - pel_obs_lambda_m(obs) * obs->L_cyc - s->entry[p->old[i]].code_m;
        p->valid[i] = true;
    }
    const double by_code = whole_ms(median(p));
    if (by_code != 0.0) { return by_code; }
    phase_minus_doppler(p, s, 0.0);
    return whole_ms(median(p));
}

/* Phase change against the change of the predicted range. The view now starts from a position that updates have corrected
 * since the view before: bring that one to the same track. */
static void phase_minus_prediction(pass_t *p, const pel_slip_t *s, const pel_slip_aid_t *aid)
{
    for (int i = 0; i < p->e->n; i++) {
        const pel_obs_t *obs = &p->e->obs[i];
        p->valid[i] = false;
        if (p->old[i] < 0) { continue; }
        const pel_slip_entry_t *old = &s->entry[p->old[i]];
        const pel_sight_t *sight = sight_of(p, i);
        if (sight == NULL || !old->predicted || old->t_ns != s->checked_ns) { continue; } /* aid->dr_e is since then */
        const double predicted = pel_sight_phase_m(sight, obs) - old->range_m + pel_dot3(sight->u_e, aid->dr_e);
        p->value[i] = (pel_obs_lambda_m(obs) * obs->L_cyc - old->y_m) - predicted;
        p->valid[i] = true;
    }
}

/* ---- memory ---------------------------------------------------------------------------------------------------- */

static pel_slip_entry_t remember(const pass_t *p, int i)
{
    const pel_obs_t *obs = &p->e->obs[i];
    const double lambda = pel_obs_lambda_m(obs);
    const pel_sight_t *sight = sight_of(p, i);
    pel_slip_entry_t k = {.sys = obs->sys, .prn = obs->prn, .carrier = obs->carrier, .code = obs->code};
    k.half = (obs->flags & PEL_OBS_HALF_CYCLE) != 0u;
    k.lock_ms = obs->lock_ms;
    k.t_ns = p->e->t_ns;
    k.y_m = lambda * obs->L_cyc;
    if ((p->usable[i] & PEL_OBS_CODE) != 0u) { k.code_m = obs->P_m - k.y_m; }
    if ((p->usable[i] & PEL_OBS_DOPPLER) != 0u) {
        k.has_rate = true;
        k.rate_mps = (float)(-lambda * (double)obs->D_hz);
    }
    if (sight != NULL) {
        k.predicted = true;
        k.range_m = pel_sight_phase_m(sight, obs);
    }
    return k;
}

/* Entries seen again are renewed, those not seen kept while they may still come back, new signals appended. In a full memory what
 * is there now comes first. */
static void remember_epoch(pass_t *p, pel_slip_t *s)
{
    int n_new = 0, kept = 0;
    for (int i = 0; i < p->e->n; i++) {
        if (p->old[i] >= 0) { s->entry[p->old[i]] = remember(p, i); }
        n_new += p->old[i] < 0 && (p->usable[i] & PEL_OBS_PHASE) != 0u;
    }
    for (int k = 0; k < s->n; k++) {
        const double age_s = pel_time_diff_s(p->e->t_ns, s->entry[k].t_ns);
        const bool room = s->n + n_new <= PEL_MAX_OBS;
        if (age_s == 0.0 || (room && age_s > 0.0 && age_s <= PEL_SLIP_MAX_GAP_S)) { s->entry[kept++] = s->entry[k]; }
    }
    s->n = kept;
    for (int i = 0; i < p->e->n; i++) {
        const pel_obs_t *obs = &p->e->obs[i];
        if (p->old[i] >= 0 || (p->usable[i] & PEL_OBS_PHASE) == 0u) { continue; }
        const int16_t k = find_entry(s, obs, 0); /* too old to compare with, or the same signal twice */
        if (k >= 0) {
            s->entry[k] = remember(p, i);
        } else if (s->n < PEL_MAX_OBS) {
            s->entry[s->n++] = remember(p, i);
        }
    }
    s->checked_ns = p->e->t_ns;
}

/* Find each phase's memory; without one nothing is known about its integer. */
static void match(pass_t *p, const pel_slip_t *s, pel_epoch_t *e)
{
    int next = 0;
    for (int i = 0; i < e->n; i++) {
        pel_obs_t *obs = &e->obs[i];
        p->old[i] = -1;
        p->valid[i] = false;
        p->usable[i] = (uint8_t)pel_obs_usable_parts(obs);
        if ((p->usable[i] & PEL_OBS_PHASE) == 0u) { continue; }
        p->sight[i] = find_sight(p->view, obs);
        const int16_t k = find_entry(s, obs, next);
        if (k >= 0) {
            const double dt = elapsed_s(p, &s->entry[k]);
            next = k + 1;
            if (dt > 0.0 && dt <= PEL_SLIP_MAX_GAP_S) { p->old[i] = k; }
        }
        if (p->old[i] < 0) { obs->flags |= PEL_OBS_SLIP; }
    }
}

/* Some receivers send Doppler with the wrong sign (u-blox M8P in its MSM7). Against the change of phase that is beyond doubt on a
 * few satellites; the whole epoch is then turned round. */
static void turn_reversed_doppler(const pass_t *p, const pel_slip_t *s, pel_epoch_t *e)
{
    int right = 0, wrong = 0;
    for (int i = 0; i < e->n; i++) {
        const pel_obs_t *obs = &e->obs[i];
        if (p->old[i] < 0 || (p->usable[i] & PEL_OBS_DOPPLER) == 0u) { continue; }
        const pel_slip_entry_t *old = &s->entry[p->old[i]];
        const double lambda = pel_obs_lambda_m(obs);
        const double change = (lambda * obs->L_cyc - old->y_m) / elapsed_s(p, old);
        const double rate = -lambda * (double)obs->D_hz;
        if (pel_fabs(change) < REVERSED_MIN_MPS) { continue; }
        right += pel_fabs(change - rate) < 0.1 * pel_fabs(change + rate);
        wrong += pel_fabs(change + rate) < 0.1 * pel_fabs(change - rate);
    }
    if (wrong < 3 || wrong <= 3 * right) { return; }
    for (int i = 0; i < e->n; i++) { e->obs[i].D_hz = -e->obs[i].D_hz; }
}

void pel_slip_check(pel_slip_t *s, pel_epoch_t *e, const pel_view_t *view, const pel_slip_aid_t *aid,
                    pel_nav_counters_t *count)
{
    pel_nav_counters_t unheard;
    pass_t p; /* but for `old` not cleared: it is as large as the largest epoch */
    memset(p.old, 0xFF, sizeof p.old);
    p.e = e;
    p.view = view;
    p.phase_sd_m = s->phase_sd_m;
    if (count == NULL) {
        memset(&unheard, 0, sizeof unheard);
        count = &unheard;
    }
    if (e->n > PEL_MAX_OBS) { return; }

    match(&p, s, e);
    turn_reversed_doppler(&p, s, e);
    told_by_receiver(&p, s, e, count);
    const double jump_ms = clock_jump_ms(&p, s);
    if (jump_ms != 0.0 || e->clock_reset) { count->clock_jumps++; }
    /* Valid now tells the geometry-free detector which phases the receiver itself gave up. */
    for (int i = 0; i < e->n; i++) { p.valid[i] = (e->obs[i].flags & PEL_OBS_SLIP) != 0u; }
    geometry_free(&p, s, e, count);
    phase_minus_doppler(&p, s, jump_ms);
    count->slip_doppler += mark_departures(&p, s, e, median(&p), 0.0, DOPPLER_SD_MPS, JERK_MPS3);
    if (aid != NULL && view != NULL && aid->sd_m > 0.0) {
        phase_minus_prediction(&p, s, aid);
        count->slip_ins += mark_departures(&p, s, e, median(&p), aid->sd_m, 0.0, 0.0);
    }
    remember_epoch(&p, s);
}

/* float_search.c - integers from the filter's own float ambiguities, once they have settled: beside held phases each for itself, alone
 * only together, sure of themselves and again and again the same. */
#include "internal.h"

#include "pelorus/math.h"

#define RESOLVE_EPOCHS  2   /* of the youngest ambiguity that may be resolved */
#define RESOLVE_AFTER_S 0.9 /* and its age */
#define MISFIT_FLOATS   5
#define FAILURE_FACTOR                                                                                                 \
    10.0 /* epochs far apart that agree: one may promise this much less, of which a tenth is seen (make promise) */
#define RESOLVE_RATIO  3.0
#define INTEGER_SD_CYC 1e-3 /* conditioning on an integer */
#define FAR_APART_S    10.0 /* epochs with errors of their own */

/* What a search must show. */
typedef struct {
    int tries;      /* searches an epoch: each leaves out one ambiguity more */
    int fewest;     /* ambiguities that may be resolved together */
    int agree;      /* epochs with the same integers */
    double fit;     /* quantile of the misfit */
    double success; /* bootstrapped */
    bool by_ratio;  /* or a ratio that keeps the promise */
} rule_t;

/* Alone a misfit may be refused at 90 %: the filter's floats are a second opinion, and a right vector comes again at the next epoch. Where they
 * are all there is (S2 section 14) they are carried for long, and what does not fit now will not fit soon. */
static const rule_t BESIDE_HELD = {
    .tries = 6, .fewest = 1, .agree = 2, .fit = 0.999, .success = 0.99, .by_ratio = true};
static const rule_t ALONE = {.tries = 2, .fewest = 5, .agree = 3, .fit = 0.9, .success = 0.99, .by_ratio = true};
static const rule_t ALL_THERE_IS = {.tries = 2, .fewest = 4, .agree = 3, .fit = 0.999, .success = 0.999};

static const rule_t *rule_of(const pel_navigator_t *nav, const pel_nav_chosen_t *c)
{
    if (c->beside_held) { return &BESIDE_HELD; }
    return pel_nav_preset(pel_nav_preset_in_use(nav))->each_epoch ? &ALONE : &ALL_THERE_IS;
}

static bool is_settled(pel_navigator_t *nav, const pel_tracked_t *t)
{
    const pel_tracked_t *datum = (t->state >= 0) ? pel_nav_track_datum(nav, t->sys, t->carrier) : NULL;
    return datum != NULL && !datum->half && !t->half && t->epochs >= RESOLVE_EPOCHS &&
           pel_time_diff_s(nav->at_horizon.t_ns, t->since_ns) >= RESOLVE_AFTER_S;
}

/* Values and covariance of the chosen, written into the engine's own room. */
static void collect(pel_navigator_t *nav, const pel_nav_chosen_t *c)
{
    double *a = pel_ils_room_for_a(&nav->ils), *Q = pel_ils_room_for_Q(&nav->ils);
    for (int r = 0; r < c->n; r++) {
        const pel_tracked_t *t = &nav->track.entry[c->entry[r]];
        a[r] = t->N;
        for (int k = 0; k <= r; k++) {
            Q[PEL_TRI(r) + k] = (double)pel_ud_cov(&nav->ud, t->state, nav->track.entry[c->entry[k]].state);
        }
    }
}

/* Load the chosen into the engine. False: there is nothing to search. */
static bool load(pel_navigator_t *nav, const pel_nav_chosen_t *c)
{
    const double *a = pel_ils_room_for_a(&nav->ils), *Q = pel_ils_room_for_Q(&nav->ils);
    if (c->tries <= 0 || c->n < rule_of(nav, c)->fewest) { return false; }
    collect(nav, c);
    if (pel_ils_init(&nav->ils, c->n, a, Q, 2, nav->cfg.node_budget) != PEL_OK) { return false; }
    pel_ils_decorrelate_to_the_end(&nav->ils);
    return true;
}

/* Verdict on the search that has ended. */
static void judge(const pel_navigator_t *nav, const pel_nav_chosen_t *c, bool proved, double sq, double agreed_s,
                  pel_nav_integers_t *out)
{
    out->n = c->n;
    out->nodes += nav->ils.nodes;
    out->ratio = pel_ils_ratio(&nav->ils);
    out->success = pel_ils_success(&nav->ils);
    const double factor = (agreed_s >= FAR_APART_S) ? FAILURE_FACTOR : 1.0;
    const double failure_max = factor * (double)nav->cfg.failure_max;
    const rule_t *rule = rule_of(nav, c);
    const bool promised =
        out->success >= rule->success || (rule->by_ratio && out->ratio >= pel_ils_ratio_needed(&nav->ils, failure_max));
    out->reason = !proved                                      ? PEL_INT_BUDGET
                  : !promised                                  ? PEL_INT_SUCCESS
                  : (sq > pel_chi2_threshold(c->n, rule->fit)) ? PEL_INT_CHI2
                  : (out->ratio < RESOLVE_RATIO)               ? PEL_INT_RATIO
                                                               : PEL_INT_OK;
}

/* Leave out one: the least certain where the problem is weak, else the one farthest from its integer. */
static void leave_one_out(const pel_navigator_t *nav, const int64_t N[PEL_MAX_AMB], bool weak, pel_nav_chosen_t *c)
{
    int worst = 0;
    double most = -1.0;
    for (int r = 0; r < c->n; r++) {
        const pel_tracked_t *t = &nav->track.entry[c->entry[r]];
        const double var = (double)pel_ud_cov(&nav->ud, t->state, t->state);
        const double off = t->N - (double)N[r];
        const double bad = weak ? var : off * off / var;
        if (bad > most) {
            most = bad;
            worst = r;
        }
    }
    c->n--;
    for (int r = worst; r < c->n; r++) { c->entry[r] = c->entry[r + 1]; }
}

/* Condition the filter on the integers; their states go. */
static void condition(pel_navigator_t *nav, const pel_nav_chosen_t *c, const int64_t N[PEL_MAX_AMB],
                      pel_nav_integers_t *out)
{
    out->n_fixed = c->n;
    for (int r = 0; r < c->n; r++) {
        const pel_tracked_t *t = &nav->track.entry[c->entry[r]];
        pel_real h[PEL_MAX_STATES] = {0};
        h[t->state] = PEL_R(1.0);
        (void)pel_ud_update(&nav->ud, h, t->state, (pel_real)(t->N - (double)N[r]),
                            (pel_real)(INTEGER_SD_CYC * INTEGER_SD_CYC), 0, NULL);
    }
    for (int r = 0; r < c->n; r++) {
        const pel_tracked_t *t = &nav->track.entry[c->entry[r]];
        pel_tracked_t *datum = pel_nav_track_datum(nav, t->sys, t->carrier);
        if (datum != NULL) { datum->held = true; }
    }
    pel_nav_close_loop(nav);
    for (int r = 0; r < c->n; r++) {
        pel_tracked_t *t = &nav->track.entry[c->entry[r]];
        pel_nav_track_remove_state(nav, t);
        t->N = (double)N[r];
        t->held = true;
    }
}

/* Note the best vector of this epoch, accepted or not. */
static void note_candidates(pel_navigator_t *nav, const pel_nav_chosen_t *c, const int64_t N[PEL_MAX_AMB])
{
    for (int r = 0; r < c->n; r++) {
        pel_tracked_t *t = &nav->track.entry[c->entry[r]];
        const bool same = t->agreed > 0 && t->candidate == (uint32_t)N[r];
        if (!same) { t->agreed_since_ns = nav->at_horizon.t_ns; }
        t->agreed = (uint8_t)(!same ? 1 : (t->agreed < UINT8_MAX) ? t->agreed + 1 : UINT8_MAX);
        t->candidate = (uint32_t)N[r];
    }
}

/* For how long all of them have had these numbers, and in how many epochs. */
static double agreed_for_s(const pel_navigator_t *nav, const pel_nav_chosen_t *c, const int64_t N[PEL_MAX_AMB],
                           int *epochs)
{
    double least_s = 1e9;
    *epochs = UINT8_MAX;
    for (int r = 0; r < c->n; r++) {
        const pel_tracked_t *t = &nav->track.entry[c->entry[r]];
        if (t->candidate != (uint32_t)N[r]) {
            *epochs = 0;
            return 0.0;
        }
        least_s = pel_min(least_s, pel_time_diff_s(nav->at_horizon.t_ns, t->agreed_since_ns));
        if (t->agreed < *epochs) { *epochs = t->agreed; }
    }
    return least_s;
}

/* Epochs that agree are worth more than one that is sure of itself. Far apart, with errors of their own, two are enough. */
static bool agree(const rule_t *rule, double agreed_s, int epochs)
{
    return epochs >= ((agreed_s >= FAR_APART_S) ? 2 : rule->agree);
}

/* Float ambiguities that fit no integers for long hold a slip that nobody saw: they begin anew. True: so it was, and what was chosen of
 * them is gone. */
static bool watch_floats(pel_navigator_t *nav, const pel_nav_integers_t *out)
{
    const bool misfit = out->reason == PEL_INT_CHI2;
    nav->track.misfit_floats = (uint8_t)(misfit ? nav->track.misfit_floats + 1 : 0);
    if (nav->track.misfit_floats < MISFIT_FLOATS) { return false; }
    nav->track.misfit_floats = 0;
    for (int i = nav->track.n - 1; i >= 0; i--) {
        if (nav->track.entry[i].state >= 0) { pel_nav_track_drop_entry(nav, i); }
    }
    return true;
}

bool pel_nav_track_search_begin(pel_navigator_t *nav, bool held)
{
    pel_nav_chosen_t *c = &nav->update.chosen;
    *c = (pel_nav_chosen_t){.beside_held = held};
    c->tries = rule_of(nav, c)->tries;
    nav->update.later.reason = PEL_INT_NOT_TRIED;
    for (int i = 0; i < nav->track.n && c->n < PEL_MAX_AMB; i++) {
        if (is_settled(nav, &nav->track.entry[i])) { c->entry[c->n++] = (uint8_t)i; }
    }
    return load(nav, c);
}

/* The best vector is there, if any: accept it, or leave one out and go on. True: this was the last. */
static bool end_of_one(pel_navigator_t *nav, pel_nav_chosen_t *c, bool proved, pel_nav_integers_t *out)
{
    int64_t N[PEL_MAX_AMB];
    double sq = 0.0;
    if (pel_ils_get(&nav->ils, 0, N, &sq) != PEL_OK) { return true; }
    const rule_t *rule = rule_of(nav, c);
    const bool first = c->tries == rule->tries;
    if (first) { note_candidates(nav, c, N); }
    int epochs;
    const double agreed_s = agreed_for_s(nav, c, N, &epochs);
    judge(nav, c, proved, sq, agreed_s, out);
    if (first && !c->beside_held && watch_floats(nav, out)) { return true; }
    if (out->reason == PEL_INT_OK) {
        if (agree(rule, agreed_s, epochs)) { condition(nav, c, N, out); }
        return true;
    }
    leave_one_out(nav, N, out->reason == PEL_INT_SUCCESS, c);
    c->tries--;
    return !load(nav, c);
}

bool pel_nav_track_search_step(pel_navigator_t *nav, int32_t max_nodes)
{
    const pel_status_t status = pel_ils_run(&nav->ils, max_nodes);
    if (status == PEL_W_RUNNING) { return false; }
    return status < 0 || end_of_one(nav, &nav->update.chosen, status == PEL_OK, &nav->update.later);
}

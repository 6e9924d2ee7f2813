/* navigator.c - what arrives, in which order it is used, and what is ready. */
#include "internal.h"

#include <string.h>

#include "pelorus/math.h"

#define IMU_ALIVE_NS  (1 * PEL_NS_PER_S)   /* an IMU silent for longer does not take part */
#define BASE_ALIVE_NS (120 * PEL_NS_PER_S) /* a base silent for longer is not waited for */
#define BASE_MATCH_NS (50 * PEL_NS_PER_MS) /* base and rover epochs this near belong together */
#define IMU_SETTLE_NS                                                                                                  \
    (20 * PEL_NS_PER_MS)     /* receiver clocks may be off by this: the true instant must be in the ring */
#define MOST_LATE_EPOCHS  10 /* refused for their time in a row; their receiver then tells another time */
#define MOST_LATE_SAMPLES 200
#define FAR_BACK_NS       (5 * PEL_NS_PER_S)
#define LONGEST_SEARCH_S  0.4 /* behind the newest IMU sample: then it is ended in one go */

void pel_navigator_init(pel_navigator_t *nav, const pel_nav_config_t *cfg)
{
    memset(nav, 0, sizeof *nav);
    nav->cfg = *cfg;
    pel_nav_seal_config(nav);
    nav->attitude_given = cfg->have_attitude;
    pel_nav_seal_state(nav);
    pel_orbits_init(&nav->orbits);
    nav->orbits.no_ionosphere = cfg->no_ionosphere;
    pel_slip_init(&nav->slip_rover);
    pel_slip_init(&nav->slip_base);
    nav->slip_rover.phase_sd_m =
        pel_sqrt(cfg->noise.phase_a_m * cfg->noise.phase_a_m + cfg->noise.phase_b_m * cfg->noise.phase_b_m);
    nav->slip_base.phase_sd_m = nav->slip_rover.phase_sd_m;
    pel_imu_ring_init(&nav->ring);
    pel_nav_reset_alignment(nav);
    pel_nav_channels_init(nav);
    pel_nav_noise_level_init(nav);
    pel_nav_vehicle_init(nav);
}

static bool uses_base(const pel_navigator_t *nav)
{
    return pel_nav_preset(nav->cfg.preset)->base;
}

/* Newest of what has arrived, while an epoch waits. */
static pel_time_t stream_now(const pel_navigator_t *nav)
{
    pel_time_t now = nav->last_imu_ns;
    if (nav->rover[nav->n_rover - 1].t_ns > now) { now = nav->rover[nav->n_rover - 1].t_ns; }
    if (nav->n_base > 0 && nav->base[nav->n_base - 1].t_ns > now) { now = nav->base[nav->n_base - 1].t_ns; }
    return now;
}

/* ---- when is a rover epoch due ------------------------------------------------------------------------------------ */

static bool imu_has_passed(const pel_navigator_t *nav, pel_time_t t_ns)
{
    const bool alive = nav->last_imu_ns != 0 && nav->last_imu_ns > stream_now(nav) - IMU_ALIVE_NS;
    if (!alive) { return true; }
    const int64_t delay_ns = (int64_t)((double)nav->cfg.apply_delay_s * 1e9);
    return nav->last_imu_ns >= t_ns + ((delay_ns > IMU_SETTLE_NS) ? delay_ns : IMU_SETTLE_NS);
}

/* Is a base epoch for this time here, or no longer worth waiting for? */
static bool base_is_settled(const pel_navigator_t *nav, pel_time_t t_ns)
{
    if (!uses_base(nav)) { return true; }
    const bool waited = stream_now(nav) >= t_ns + (int64_t)((double)nav->cfg.base_wait_s * 1e9);
    /* Before anything was used a base may still be on its way; later, one that never came is not waited for. */
    if (nav->n_base == 0 || !nav->have_station) { return waited || nav->counters.epochs_used > 0; }
    const pel_time_t newest = nav->base[nav->n_base - 1].t_ns;
    if (newest >= t_ns - BASE_MATCH_NS || newest < t_ns - BASE_ALIVE_NS) { return true; }
    if (nav->n_base >= 2) {
        /* A slower base has nothing for this epoch: its next one comes later. */
        const pel_time_t next = newest + (newest - nav->base[nav->n_base - 2].t_ns);
        if (next > t_ns + BASE_MATCH_NS) { return true; }
    }
    return waited;
}

static pel_epoch_t *choose_base(pel_navigator_t *nav, pel_time_t t_ns)
{
    int index = 0;
    double age_s = 0.0;
    if (!uses_base(nav) || nav->n_base == 0) { return NULL; }
    if (pel_pair_epochs(nav->base, nav->n_base, t_ns, (double)nav->cfg.base_max_age_s, &index, &age_s) != PEL_OK) {
        return NULL;
    }
    return &nav->base[index];
}

/* What an epoch holds, not the room it has: its count may have changed by itself since it was looked at. */
static void copy_epoch(const pel_epoch_t *from, pel_epoch_t *to)
{
    const size_t n = (from->n < PEL_MAX_OBS) ? from->n : PEL_MAX_OBS;
    memcpy(to, from, offsetof(pel_epoch_t, obs) + n * sizeof from->obs[0]);
}

static void drop_oldest(pel_navigator_t *nav)
{
    nav->n_rover--;
    for (int i = 0; i < nav->n_rover; i++) { copy_epoch(&nav->rover[i + 1], &nav->rover[i]); }
}

static void begin_oldest(pel_navigator_t *nav)
{
    pel_epoch_t *base = choose_base(nav, nav->rover[0].t_ns);
    if (base == NULL && nav->n_base > 0 && uses_base(nav)) { nav->counters.epochs_unpaired++; }
    pel_nav_begin_epoch(nav, &nav->rover[0], base);
    if (nav->search == PEL_NAV_SEARCH_NONE) { drop_oldest(nav); }
}

/* Before an epoch or an orbit is used: is the navigator what it was? */
static bool can_go_on(pel_navigator_t *nav)
{
    if (pel_navigator_is_broken(nav)) { return false; }
    if (!pel_nav_is_sound(nav)) { pel_nav_begin_anew(nav); }
    pel_nav_check_station(nav);
    return true;
}

/* What is under way is done at once. */
static void complete(pel_navigator_t *nav)
{
    if (nav->search == PEL_NAV_SEARCH_NONE) { return; }
    while (nav->search != PEL_NAV_SEARCH_NONE) { pel_nav_go_on(nav, nav->cfg.node_budget); }
    drop_oldest(nav);
}

static void apply_oldest(pel_navigator_t *nav)
{
    if (nav->search == PEL_NAV_SEARCH_NONE) { begin_oldest(nav); }
    complete(nav);
}

/* Searches go on between IMU samples, where there are any and time is left. */
static bool in_slices(const pel_navigator_t *nav)
{
    return nav->cfg.slice_nodes > 0 && nav->ins;
}

static void go_on(pel_navigator_t *nav)
{
    pel_nav_go_on(nav, nav->cfg.slice_nodes);
    const bool late = pel_time_diff_s(nav->last_imu_ns, nav->at_horizon.t_ns) > LONGEST_SEARCH_S ||
                      pel_imu_ring_has_after(&nav->ring, nav->at_horizon.t_ns, (PEL_IMU_RING * 3) / 4 + 1);
    if (nav->search == PEL_NAV_SEARCH_NONE) {
        drop_oldest(nav);
    } else if (late) {
        complete(nav);
    }
}

/* At most one epoch a push, or a slice of one, so that the longest push is one epoch's work. */
static void apply_if_due(pel_navigator_t *nav)
{
    if (nav->search != PEL_NAV_SEARCH_NONE) {
        go_on(nav);
        return;
    }
    if (nav->n_rover == 0) { return; }
    const pel_time_t t_ns = nav->rover[0].t_ns;
    if (!imu_has_passed(nav, t_ns) || !base_is_settled(nav, t_ns)) { return; }
    if (!can_go_on(nav) || nav->n_rover == 0) { return; }
    begin_oldest(nav);
    if (!in_slices(nav)) { complete(nav); } /* asked now: the epoch may have ended the INS */
}

/* ---- when time begins anew ------------------------------------------------------------------------------------------ */

/* One epoch or sample with a time far ahead would shut out all true ones after it. Late by a line's delay is another thing. */
static bool begins_anew(uint8_t *late, int most, pel_time_t t_ns, pel_time_t newest_ns)
{
    if (newest_ns - t_ns < FAR_BACK_NS || ++*late < most) { return false; }
    *late = 0;
    return true;
}

static void restart_rover(pel_navigator_t *nav)
{
    complete(nav);
    nav->counters.restarts++;
    pel_nav_stop(nav);
    nav->n_rover = 0;
    nav->have_spp = false;
    nav->last_tag_ns = nav->last_epoch_ns = nav->epoch_before_ns = 0;
}

static void restart_imu(pel_navigator_t *nav)
{
    complete(nav);
    pel_imu_ring_init(&nav->ring);
    pel_nav_drop_ins(nav);
    pel_nav_reset_alignment(nav);
    nav->attitude_given = false; /* the turns since the first increment are lost */
    nav->last_imu_ns = 0;
}

/* ---- receivers ---------------------------------------------------------------------------------------------------- */

static bool allowed(const pel_navigator_t *nav, const pel_obs_t *obs)
{
    return obs->sys < PEL_N_SYS && (nav->cfg.systems & (1u << obs->sys)) != 0 && obs->carrier < PEL_N_CARRIER &&
           (nav->cfg.carriers & (1u << obs->carrier)) != 0;
}

/* Of an epoch of systems that are not used there is nothing to keep. */
static bool any_allowed(const pel_navigator_t *nav, const pel_epoch_t *e)
{
    for (int i = 0; i < e->n && i < PEL_MAX_OBS; i++) {
        if (allowed(nav, &e->obs[i])) { return true; }
    }
    return false;
}

/* Cycles of another carrier become cycles of B1I, and the phase a float: its ambiguity is no integer of them. */
static void from_rdss(double rdss_hz, pel_obs_t *obs)
{
    if (obs->sys != PEL_SYS_BDS || obs->carrier != PEL_CARRIER_B1I) { return; }
    const double ratio = pel_carrier_hz(PEL_SYS_BDS, PEL_CARRIER_B1I, 0) / rdss_hz;
    obs->L_cyc *= ratio;
    obs->D_hz = (float)((double)obs->D_hz * ratio);
    obs->flags |= PEL_OBS_HALF_CYCLE;
}

/* Keep what the configuration allows. */
static void copy_allowed(const pel_navigator_t *nav, const pel_epoch_t *in, pel_epoch_t *out)
{
    out->t_ns = in->t_ns;
    out->dropped = in->dropped;
    out->clock_reset = in->clock_reset;
    out->n = 0;
    for (int i = 0; i < in->n && i < PEL_MAX_OBS; i++) {
        const pel_obs_t *obs = &in->obs[i];
        if (!allowed(nav, obs)) { continue; }
        out->obs[out->n] = *obs;
        if (nav->cfg.rdss_hz > 0.0) { from_rdss(nav->cfg.rdss_hz, &out->obs[out->n]); }
        out->n++;
    }
}

/* Before 1980 and after 2094 there is no GPS time. */
static bool time_is_possible(pel_time_t t_ns)
{
    return t_ns > 0 && t_ns < INT64_C(6000) * PEL_NS_PER_WEEK;
}

static void take_rover(pel_navigator_t *nav, const pel_epoch_t *epoch)
{
    if (!time_is_possible(epoch->t_ns)) {
        nav->counters.epochs_late++;
        return;
    }
    if (epoch->t_ns <= nav->last_tag_ns) {
        nav->counters.epochs_late++;
        if (begins_anew(&nav->late_rover, MOST_LATE_EPOCHS, epoch->t_ns, nav->last_tag_ns)) { restart_rover(nav); }
        return;
    }
    nav->late_rover = 0;
    if (nav->n_rover == PEL_ROVER_QUEUE) { apply_oldest(nav); }
    int place = nav->n_rover;
    while (place > 0 && nav->rover[place - 1].t_ns > epoch->t_ns) { place--; }
    if (place > 0 && nav->rover[place - 1].t_ns == epoch->t_ns) {
        nav->counters.epochs_late++;
        return;
    }
    for (int i = nav->n_rover; i > place; i--) { copy_epoch(&nav->rover[i - 1], &nav->rover[i]); }
    copy_allowed(nav, epoch, &nav->rover[place]);
    nav->n_rover++;
    pel_nav_note_lead(nav, epoch->t_ns);
    apply_if_due(nav);
}

void pel_navigator_push_rover(pel_navigator_t *nav, const pel_epoch_t *epoch)
{
    if (!can_go_on(nav)) { return; }
    pel_nav_check_state(nav);
    take_rover(nav, epoch);
    pel_nav_seal_state(nav);
}

/* Slips of a base epoch that no rover epoch has used yet are still news. */
static void keep_unseen_slips(const pel_navigator_t *nav, pel_epoch_t *newest)
{
    if (nav->n_base < 2) { return; }
    const pel_epoch_t *before = &nav->base[nav->n_base - 2];
    for (int i = 0; i < before->n; i++) {
        const pel_obs_t *old = &before->obs[i];
        if ((old->flags & PEL_OBS_SLIP) == 0) { continue; }
        for (int j = 0; j < newest->n; j++) {
            pel_obs_t *o = &newest->obs[j];
            if (o->sys == old->sys && o->prn == old->prn && o->carrier == old->carrier) { o->flags |= PEL_OBS_SLIP; }
        }
    }
}

static void take_base(pel_navigator_t *nav, const pel_epoch_t *epoch)
{
    if (epoch->n > 0 && !any_allowed(nav, epoch)) { return; }
    if (!time_is_possible(epoch->t_ns)) {
        nav->counters.epochs_late++;
        return;
    }
    if (nav->n_base > 0 && epoch->t_ns <= nav->base[nav->n_base - 1].t_ns) {
        nav->counters.epochs_late++;
        const pel_time_t newest_ns = nav->base[nav->n_base - 1].t_ns;
        if (begins_anew(&nav->late_base, MOST_LATE_EPOCHS, epoch->t_ns, newest_ns)) { nav->n_base = 0; }
        return;
    }
    nav->late_base = 0;
    if (nav->n_base == PEL_BASE_QUEUE) {
        nav->n_base--;
        for (int i = 0; i < nav->n_base; i++) { copy_epoch(&nav->base[i + 1], &nav->base[i]); }
    }
    pel_epoch_t *kept = &nav->base[nav->n_base++];
    copy_allowed(nav, epoch, kept);
    pel_slip_check(&nav->slip_base, kept, NULL, NULL, &nav->counters);
    keep_unseen_slips(nav, kept);
    apply_if_due(nav);
}

void pel_navigator_push_base(pel_navigator_t *nav, const pel_epoch_t *epoch)
{
    if (!can_go_on(nav)) { return; }
    pel_nav_check_state(nav);
    take_base(nav, epoch);
    pel_nav_seal_state(nav);
}

void pel_navigator_push_ephemeris(pel_navigator_t *nav, const pel_ephemeris_t *eph)
{
    if (!can_go_on(nav)) { return; }
    if (eph->sys < PEL_N_SYS && (nav->cfg.systems & (1u << eph->sys)) != 0) { (void)pel_orbits_add(&nav->orbits, eph); }
}

void pel_navigator_push_klobuchar(pel_navigator_t *nav, const pel_klobuchar_t *k)
{
    nav->orbits.klobuchar = *k;
}

/* More than this is another station, not another rounding. */
#define STATION_MOVED_M 0.05

void pel_navigator_push_station(pel_navigator_t *nav, const pel_station_t *s)
{
    if (!can_go_on(nav)) { return; }
    const double r = pel_norm3(s->r_ea_e);
    if (!(r > 6.3e6 && r < 7.4e6)) { return; } /* a base that does not know its place sends zeros */
    double move = 0.0;
    for (int k = 0; k < 3; k++) { move += pel_fabs(s->r_ea_e[k] - nav->station.r_ea_e[k]); }
    if (nav->have_station && move > STATION_MOVED_M) { /* another base: other integers */
        pel_nav_check_state(nav);
        complete(nav);
        pel_nav_track_clear(nav);
        pel_nav_seal_state(nav);
    }
    nav->station = *s;
    nav->have_station = true;
    pel_nav_seal_station(nav);
}

/* ---- the IMU -------------------------------------------------------------------------------------------------------- */

static void turn_to_body(const pel_navigator_t *nav, const pel_imu_t *imu, pel_imu_t *body)
{
    *body = *imu;
    pel_mat3_vec(nav->cfg.C_s_b, imu->alpha_ib_b, body->alpha_ib_b);
    pel_mat3_vec(nav->cfg.C_s_b, imu->upsilon_ib_b, body->upsilon_ib_b);
}

/* A missing stretch is bridged by one increment at the new sample's rates: the motion between is unknown, and for the few
 * samples a serial line loses this is the best guess. Longer gaps end the INS. */
static void bridge_gap(pel_navigator_t *nav, pel_imu_t *body)
{
    const double gap_s = pel_time_diff_s(body->t_ns, nav->last_imu_ns) - body->dt_s;
    const bool jumped = pel_nav_imu_clock_jumped(nav, body, gap_s);
    if (jumped) {
        nav->counters.imu_gap++;
        restart_imu(nav);
        return;
    }
    if (nav->last_imu_ns == 0 || pel_fabs(gap_s) <= 0.5 * body->dt_s) { return; }
    nav->counters.imu_gap++;
    if (gap_s > PEL_NAV_LONGEST_GAP_S) {
        restart_imu(nav);
        return;
    }
    if (gap_s > 0.0) { body->flags |= PEL_NAV_IMU_BRIDGE; }
    const double scale = (gap_s + body->dt_s) / body->dt_s;
    for (int k = 0; k < 3; k++) {
        body->alpha_ib_b[k] *= scale;
        body->upsilon_ib_b[k] *= scale;
    }
    body->dt_s *= scale;
}

static void take_imu(pel_navigator_t *nav, const pel_imu_t *imu)
{
    if (!pel_nav_imu_is_sane(imu)) {
        nav->counters.imu_bad_value++;
        return;
    }
    if (imu->t_ns <= nav->last_imu_ns) {
        nav->counters.imu_out_of_order++;
        if (begins_anew(&nav->late_imu, MOST_LATE_SAMPLES, imu->t_ns, nav->last_imu_ns)) {
            restart_imu(nav);
            pel_nav_doubt_imu_clock(nav);
        }
        return;
    }
    nav->late_imu = 0;
    bool jolt;
    if (!pel_nav_admit_imu(nav, imu, &jolt)) {
        nav->counters.imu_bad_value++;
        return;
    }
    pel_imu_t body;
    turn_to_body(nav, imu, &body);
    body.flags = (uint16_t)((body.flags & PEL_IMU_TIME_UNSYNCED) | (jolt ? PEL_NAV_IMU_JOLT : 0u));
    bridge_gap(nav, &body);
    nav->last_imu_ns = body.t_ns;
    nav->counters.imu_used++;
    pel_nav_take_increment(nav, &body);
    pel_nav_serve_event(nav);
    apply_if_due(nav);
}

void pel_navigator_push_imu(pel_navigator_t *nav, const pel_imu_t *imu)
{
    if (!pel_nav_counts_are_sound(nav)) { pel_nav_begin_anew(nav); }
    pel_nav_check_state(nav);
    take_imu(nav, imu);
    pel_nav_seal_state(nav);
}

void pel_navigator_push_baro(pel_navigator_t *nav, const pel_baro_t *baro)
{
    if (!can_go_on(nav)) { return; }
    const bool sane =
        time_is_possible(baro->t_ns) && pel_fabs(baro->height_m) < 1e5 && baro->sd_m > 0.0f && baro->sd_m < 1e4f;
    if (!sane) {
        nav->counters.imu_bad_value++;
        return;
    }
    pel_nav_vehicle_baro(nav, baro);
}

/* ---- outputs -------------------------------------------------------------------------------------------------------- */

bool pel_navigator_flush(pel_navigator_t *nav)
{
    if (!can_go_on(nav)) { return false; }
    pel_nav_check_state(nav);
    const bool any = nav->n_rover > 0;
    if (any) { apply_oldest(nav); }
    pel_nav_seal_state(nav);
    return any;
}

pel_nav_output_t pel_navigator_poll(pel_navigator_t *nav)
{
    static const pel_nav_output_t ORDER[] = {PEL_NAV_WARM, PEL_NAV_USED, PEL_NAV_EPOCH, PEL_NAV_SOLUTION,
                                             PEL_NAV_EVENT};
    for (size_t i = 0; i < sizeof ORDER / sizeof ORDER[0]; i++) {
        const uint32_t bit = PEL_NAV_BIT(ORDER[i]);
        if ((nav->ready & bit) != 0) {
            nav->ready &= ~bit;
            return ORDER[i];
        }
    }
    return PEL_NAV_NONE;
}

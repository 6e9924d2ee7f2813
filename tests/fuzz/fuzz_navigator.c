/* The whole navigator under sequences of damaged measurements.
 *
 * The input is a script: which navigator to begin with (fresh, converged, or restored from a damaged snapshot), then one operation an epoch of
 * the world: untouched, bytes of its frames changed behind good checksums, numbers replaced by NaN and the like, lost,
 * doubled, reordered, moved in time. After every push:
 *   - state, covariance and every output are finite, D > 0
 *   - the horizon and each kind of output go forward in time, unless time was begun anew, which is counted
 *   - no counter goes down
 * and where an epoch comes whole and, to a copy, with satellites missing: if both used it in the same way, the copy's
 * protection levels are not below. While coasting they do not shrink at all. */
#include <math.h>
#include <string.h>

#include "fuzz.h"
#include "pelorus/bits.h"
#include "pelorus/math.h"
#include "world.h"

#define N_STARTS 5
#define BEGUN    16 /* epochs that the converged navigators have used */

static world_t world;
static pel_navigator_t start[N_STARTS], nav, copy;
static pel_receiver_t receiver;
static pel_imu_stream_t imu_stream;
static pel_epoch_t epoch, held;
static bool have_held;
static int64_t shift_ns; /* what the sources' clocks are off by, from a jump on */
static uint8_t frame[PEL_MAX_FRAME_BYTES];
static uint8_t snapshot[2048]; /* of one that has converged */
static size_t n_snapshot;

/* What the last check saw. */
static struct {
    pel_nav_counters_t counters;
    pel_time_t horizon_ns, solution_ns, epoch_ns;
    float hpl_m, vpl_m; /* of the last solution */
    uint32_t news;
    bool coasting;
} seen;

/* ---- what must hold ------------------------------------------------------------------------------------------------ */

static void check_floats(const float *x, int n, float least)
{
    for (int i = 0; i < n; i++) { FUZZ_CHECK(isfinite(x[i]) && x[i] >= least); }
}

static void check_solution(const pel_solution_t *s)
{
    FUZZ_CHECK(s->fix <= PEL_FIX_COAST && s->int_reason <= PEL_INT_BASE_AGE);
    for (int k = 0; k < 3; k++) { FUZZ_CHECK(isfinite(s->r_eb_e[k])); }
    FUZZ_CHECK(isfinite(s->lat_rad) && isfinite(s->lon_rad) && isfinite(s->height_m));
    const float any = -INFINITY;
    check_floats(s->v_ned, 3, any);
    check_floats(&s->roll_rad, 3, any);
    check_floats(s->cov_r_ned, 18, any); /* and of velocity, attitude */
    for (int k = 0; k < 3; k++) {
        static const int DIAGONAL[3] = {0, 3, 5};
        FUZZ_CHECK(s->cov_r_ned[DIAGONAL[k]] > 0.0f && s->cov_v_ned[DIAGONAL[k]] > 0.0f);
    }
    check_floats(&s->sd_roll_rad, 3, 0.0f);
    check_floats(&s->hpl_m, 2, 0.0f);
    check_floats(&s->base_age_s, 1, any);
    check_floats(&s->ratio, 3, 0.0f);
    check_floats(s->b_g, 12, any);
}

static void check_state(void)
{
    FUZZ_CHECK(fuzz_counters_grew(&seen.counters, &nav.counters, sizeof seen.counters));
    const bool anew = nav.counters.restarts != seen.counters.restarts;
    seen.counters = nav.counters;
    if (!nav.have_state) { return; }
    FUZZ_CHECK(pel_ud_check(&nav.ud) == PEL_OK);
    FUZZ_CHECK(nav.ud.n == nav.model.n);
    for (int k = 0; k < 3; k++) {
        FUZZ_CHECK(isfinite(nav.now.r_eb_e[k]) && isfinite(nav.now.v_eb_e[k]));
        FUZZ_CHECK(isfinite(nav.at_horizon.r_eb_e[k]) && isfinite(nav.at_horizon.v_eb_e[k]));
        for (int j = 0; j < 3; j++) { FUZZ_CHECK(isfinite(nav.now.C_b_e[k][j])); }
        FUZZ_CHECK(isfinite(nav.errors.gyro_constant[k]) && isfinite(nav.errors.accel_markov[k]));
    }
    FUZZ_CHECK(anew || nav.at_horizon.t_ns >= seen.horizon_ns);
    FUZZ_CHECK(!nav.ins || nav.now.t_ns >= nav.at_horizon.t_ns);
    if (anew) { seen.solution_ns = seen.epoch_ns = 0; }
    seen.horizon_ns = nav.at_horizon.t_ns;
}

/* Without a new row or integer nothing can be better known than before. A push predicts first and takes in an epoch then, so a
 * solution knows what the counters said before its push. */
static uint32_t news(void)
{
    const pel_nav_counters_t *c = &seen.counters;
    return c->epochs_used + c->rows_used + c->rows_gated + c->fix_ok + c->restarts; /* none goes down */
}

static void check_growth(const pel_solution_t *s)
{
    if (news() == seen.news && nav.ins && s->fix == PEL_FIX_COAST && seen.coasting) {
        FUZZ_CHECK(s->hpl_m >= 0.999f * seen.hpl_m && s->vpl_m >= 0.999f * seen.vpl_m);
    }
    seen.news = news();
    seen.coasting = s->fix == PEL_FIX_COAST;
    seen.hpl_m = s->hpl_m;
    seen.vpl_m = s->vpl_m;
}

static void check_outputs(void)
{
    for (pel_nav_output_t o = pel_navigator_poll(&nav); o != PEL_NAV_NONE; o = pel_navigator_poll(&nav)) {
        switch (o) {
        case PEL_NAV_NONE: break;
        case PEL_NAV_SOLUTION:
            check_solution(&nav.solution);
            FUZZ_CHECK(nav.solution.t_ns > seen.solution_ns);
            seen.solution_ns = nav.solution.t_ns;
            check_growth(&nav.solution);
            FUZZ_CHECK(pel_out_encode_solution(&nav.solution, frame, sizeof frame) > 0);
            break;
        case PEL_NAV_EPOCH:
            check_solution(&nav.epoch_solution);
            FUZZ_CHECK(nav.epoch_solution.t_ns > seen.epoch_ns);
            seen.epoch_ns = nav.epoch_solution.t_ns;
            FUZZ_CHECK(pel_nmea_gga(&nav.epoch_solution, (char *)frame, sizeof frame) > 0);
            FUZZ_CHECK(nav.n_sats >= 0 && nav.n_sats <= PEL_MAX_OBS);
            for (int i = 0; i < nav.n_sats; i++) { check_floats(&nav.sats[i].az_rad, 9, -INFINITY); }
            break;
        case PEL_NAV_USED:
            FUZZ_CHECK(isfinite(nav.used.imu_rate_hz) && isfinite(nav.used.base_age_s));
            FUZZ_CHECK(pel_out_encode_used(&nav.used, frame, sizeof frame) > 0);
            break;
        case PEL_NAV_WARM: FUZZ_CHECK(isfinite(nav.warm.report.age_s)); break;
        case PEL_NAV_EVENT:
            for (int k = 0; k < 3; k++) { FUZZ_CHECK(isfinite(nav.event.r_ec_e[k])); }
            check_floats(&nav.event.omega_rad, 9, -INFINITY);
            break;
        }
    }
    check_state();
}

/* ---- pushes --------------------------------------------------------------------------------------------------------- */

static void push_epoch(const pel_epoch_t *e, bool is_base)
{
    if (is_base) {
        pel_navigator_push_base(&nav, e);
    } else {
        pel_navigator_push_rover(&nav, e);
    }
    check_outputs();
}

/* Bytes of the epoch's own frame changed, the checksum made good, and what the decoder then makes of it. */
static void push_damaged(fuzz_input_t *in, const pel_epoch_t *e, bool is_base)
{
    const bool rtcm = is_base && (fuzz_u8(in) & 1u) != 0u;
    const size_t n = rtcm ? pel_rtcm3_encode_msm(e, PEL_SYS_GPS, 7, 1, false, frame, sizeof frame)
                          : pel_ubx_encode_rawx(e, 18, frame, sizeof frame);
    if (n == 0) { return; }
    for (int i = 1 + fuzz_u8(in) % 4; i > 0; i--) {
        const size_t at = 6u + fuzz_u32(in) % (n - 6u);
        frame[at] ^= fuzz_u8(in);
    }
    fuzz_repair_frames(frame, n);
    static uint8_t bytes[PEL_MAX_FRAME_BYTES];
    memcpy(bytes, frame, n);
    pel_receiver_init(&receiver);
    pel_receiver_set_time(&receiver, world.t_start_ns);
    for (size_t i = 0; i < n; i++) {
        if (pel_receiver_push(&receiver, bytes[i]) == PEL_RX_EPOCH) { push_epoch(&receiver.epoch, is_base); }
    }
}

/* Numbers that no decoder would give. */
static void spoil(fuzz_input_t *in, pel_epoch_t *e)
{
    for (int i = 1 + fuzz_u8(in) % 8; i > 0 && e->n > 0; i--) {
        pel_obs_t *o = &e->obs[fuzz_u8(in) % e->n];
        const double x = fuzz_double(in);
        switch (fuzz_u8(in) % 8u) {
        case 0: o->P_m = x; break;
        case 1: o->L_cyc = x; break;
        case 2: memcpy(&o->D_hz, &x, sizeof o->D_hz); break; /* any bits, and no conversion of what does not fit */
        case 3: memcpy(&o->cn0_dbhz, &x, sizeof o->cn0_dbhz); break;
        case 4: o->flags = fuzz_u8(in); break;
        case 5: o->prn = fuzz_u8(in); break;
        case 6: o->L_cyc += 0.5 * (double)(fuzz_u8(in) % 7u); break;
        default: o->P_m += (double)fuzz_u8(in) * 10.0; break;
        }
    }
}

static void drop_satellites(uint8_t which, pel_epoch_t *e)
{
    int n = 0;
    for (int i = 0; i < e->n; i++) {
        const unsigned hash = (unsigned)e->obs[i].prn * 7u + e->obs[i].sys;
        if (((which >> (hash % 8u)) & 1u) == 0u) { e->obs[n++] = e->obs[i]; }
    }
    e->n = (uint16_t)n;
}

static void push_imu(fuzz_input_t *in, uint8_t how, int k)
{
    pel_imu_t imu = world_imu(&world, k);
    imu.t_ns += shift_ns;
    if ((how & 1u) != 0u && fuzz_u8(in) % 16u == 0u) {
        double *const field[7] = {&imu.dt_s,        imu.alpha_ib_b,       imu.alpha_ib_b + 1,  imu.alpha_ib_b + 2,
                                  imu.upsilon_ib_b, imu.upsilon_ib_b + 1, imu.upsilon_ib_b + 2};
        *field[fuzz_u8(in) % 7u] = fuzz_double(in);
    }
    if ((how & 2u) != 0u && fuzz_u8(in) % 4u == 0u) { return; } /* lost */
    if ((how & 4u) != 0u) {                                     /* a byte of its frame changed */
        const size_t n = pel_imu_encode(&imu, frame, sizeof frame);
        if (n == 0) { return; }
        if (fuzz_u8(in) % 8u == 0u) { frame[6u + fuzz_u8(in) % 40u] ^= fuzz_u8(in); }
        fuzz_repair_frames(frame, n);
        uint8_t bytes[64];
        memcpy(bytes, frame, n);
        for (size_t i = 0; i < n; i++) {
            if (pel_imu_stream_push(&imu_stream, bytes[i]) != PEL_IMU_SAMPLE) { continue; }
            pel_navigator_push_imu(&nav, &imu_stream.imu);
            check_outputs();
        }
        return;
    }
    pel_navigator_push_imu(&nav, &imu);
    check_outputs();
}

static void push_ephemeris(fuzz_input_t *in)
{
    pel_ephemeris_t eph = world.orbits.eph[fuzz_u8(in) % (unsigned)world.orbits.n];
    double *const field[] = {&eph.af0, &eph.af1, &eph.af2,   &eph.sqrt_a, &eph.e,         &eph.i0,      &eph.Omega0,
                             &eph.M0,  &eph.dn,  &eph.omega, &eph.idot,   &eph.Omega_dot, &eph.crc,     &eph.crs,
                             &eph.cuc, &eph.cus, &eph.cic,   &eph.cis,    eph.tgd_s,      eph.tgd_s + 1};
    const unsigned which = fuzz_u8(in) % 24u;
    if (which < sizeof field / sizeof field[0]) { *field[which] = fuzz_double(in); }
    if (which == 20u) { eph.health = fuzz_u8(in); }
    if (which == 21u) { eph.toe_ns += (int64_t)(int8_t)fuzz_u8(in) * 3600 * PEL_NS_PER_S; }
    if (which == 22u) { eph.prn = fuzz_u8(in); }
    if (which == 23u) { eph.sys = fuzz_u8(in); }
    eph.iode = (uint16_t)(eph.iode + 1u);
    pel_navigator_push_ephemeris(&nav, &eph);
}

static void push_other(fuzz_input_t *in, pel_time_t now_ns)
{
    const uint8_t kind = fuzz_u8(in) % 4u;
    if (kind == 0u) {
        pel_navigator_push_event(&nav, now_ns + ((int64_t)(int8_t)fuzz_u8(in)) * 10 * PEL_NS_PER_MS, fuzz_u32(in));
    } else if (kind == 1u) {
        pel_station_t s = world.station;
        s.r_ea_e[fuzz_u8(in) % 3u] += (double)(int8_t)fuzz_u8(in);
        if (fuzz_u8(in) % 4u == 0u) { s.r_ea_e[0] = fuzz_double(in); }
        pel_navigator_push_station(&nav, &s);
    } else if (kind == 2u) {
        pel_klobuchar_t k = {.valid = true};
        const double x = fuzz_double(in);
        memcpy(&k.alpha[fuzz_u8(in) % 4u], &x, sizeof k.alpha[0]);
        memcpy(&k.beta[fuzz_u8(in) % 4u], (const uint8_t *)&x + 4, sizeof k.beta[0]);
        pel_navigator_push_klobuchar(&nav, &k);
    } else {
        while (pel_navigator_flush(&nav)) { check_outputs(); }
    }
    check_outputs();
}

/* ---- one epoch ------------------------------------------------------------------------------------------------------ */

/* Every row of an epoch was taken and the integers came out alike: then only the number of rows differs. */
static bool used_alike(const pel_navigator_t *a, const pel_navigator_t *b, const pel_nav_counters_t *before)
{
    const bool both =
        a->counters.epochs_used == before->epochs_used + 1u && b->counters.epochs_used == before->epochs_used + 1u;
    const bool none_refused =
        a->counters.rows_gated == before->rows_gated && b->counters.rows_gated == before->rows_gated &&
        a->counters.sats_excluded == before->sats_excluded && b->counters.sats_excluded == before->sats_excluded;
    const bool same_mode = a->ins == b->ins && a->relative == b->relative && a->counters.restarts == before->restarts &&
                           b->counters.restarts == before->restarts;
    return both && none_refused && same_mode && a->epoch_solution.fix == b->epoch_solution.fix &&
           a->epoch_solution.int_reason == b->epoch_solution.int_reason;
}

/* The epoch whole, and to a copy with satellites missing. */
static void push_and_compare(const pel_epoch_t *e, uint8_t which)
{
    const pel_nav_counters_t before = nav.counters;
    copy = nav;
    held = *e;
    have_held = false;
    drop_satellites(which, &held);
    pel_navigator_push_rover(&copy, &held);
    pel_navigator_push_rover(&nav, e);
    /* Where some integers are told apart and others not, those of the copy may be the ones that count more. */
    const bool alike = nav.epoch_solution.fix == PEL_FIX_FIXED ||
                       (nav.epoch_solution.n_fixed == 0 && copy.epoch_solution.n_fixed == 0);
    if (used_alike(&nav, &copy, &before) && alike && nav.epoch_solution.t_ns == copy.epoch_solution.t_ns) {
        FUZZ_CHECK(copy.epoch_solution.hpl_m >= 0.99f * nav.epoch_solution.hpl_m);
        FUZZ_CHECK(copy.epoch_solution.vpl_m >= 0.99f * nav.epoch_solution.vpl_m);
    }
    check_outputs();
}

static void jump(uint8_t how)
{
    static const int64_t JUMPS_S[8] = {1, -1, 3600, -3600, 604800, -604800, 619315200, -619315200};
    shift_ns += JUMPS_S[how % 8u] * PEL_NS_PER_S;
    if (shift_ns < -700000000 * PEL_NS_PER_S || shift_ns > 700000000 * PEL_NS_PER_S) { shift_ns = 0; }
}

/* Base first, rover, then the IMU up to the next epoch: epochs wait for the IMU, so each is used within its own turn. */
static void one_epoch(fuzz_input_t *in, int i)
{
    const uint8_t op = fuzz_u8(in);
    uint8_t imu = 0;
    bool rover = true;
    epoch = world.base[i];
    epoch.t_ns += shift_ns;
    switch (op & 15u) {
    case 6:
        rover = false;
        push_damaged(in, &epoch, true);
        break;
    case 7:
        spoil(in, &epoch);
        push_epoch(&epoch, true);
        break;
    case 8: break; /* lost */
    default: push_epoch(&epoch, true); break;
    }
    epoch = world.rover[i];
    epoch.t_ns += shift_ns;
    switch (op & 15u) {
    case 1:
        push_damaged(in, &epoch, false);
        rover = false;
        break;
    case 2: spoil(in, &epoch); break;
    case 3: drop_satellites(fuzz_u8(in), &epoch); break;
    case 4:
        push_and_compare(&epoch, fuzz_u8(in));
        rover = false;
        break;
    case 5:
        rover = false;
        held = epoch;
        have_held = true;
        break; /* lost, or later */
    case 9: imu = fuzz_u8(in); break;
    case 10: push_ephemeris(in); break;
    case 11: push_other(in, epoch.t_ns); break;
    case 12: jump(fuzz_u8(in)); break;
    case 13: push_epoch(&epoch, false); break; /* and again below */
    case 14: epoch.t_ns += (int64_t)(int32_t)fuzz_u32(in) * 1000; break;
    default: break;
    }
    if (rover) { push_epoch(&epoch, false); }
    if (have_held && (op & 15u) != 5u) {
        push_epoch(&held, false);
        have_held = false;
    }
    for (int k = 0; k < WORLD_SAMPLES && (op & 16u) == 0u; k++) { push_imu(in, imu, i * WORLD_SAMPLES + k); }
}

/* ---- the beginnings -------------------------------------------------------------------------------------------------- */

static void begin(pel_preset_t preset, bool attitude, int epochs)
{
    pel_nav_config_t cfg;
    pel_nav_config_default(&cfg);
    cfg.preset = preset;
    cfg.have_attitude = attitude;
    cfg.heading_rad = PEL_PI / 2.0;
    cfg.mount_known = true;
    cfg.node_budget = 500;
    pel_navigator_init(&nav, &cfg);
    for (int i = 0; i < world.orbits.n; i++) { pel_navigator_push_ephemeris(&nav, &world.orbits.eph[i]); }
    pel_navigator_push_station(&nav, &world.station);
    fuzz_input_t none = {NULL, 0};
    for (int i = 0; i < epochs; i++) { one_epoch(&none, i); }
}

/* A fresh navigator that takes in a snapshot with changed bytes and a good checksum, then bytes that are none. */
static void restore_damaged(fuzz_input_t *in)
{
    uint8_t bytes[sizeof snapshot];
    uint32_t sequence = 0;
    memcpy(bytes, snapshot, n_snapshot);
    for (int i = fuzz_u8(in) % 4; i > 0; i--) {
        const size_t at = fuzz_u32(in) % (n_snapshot - 4u);
        bytes[at] ^= fuzz_u8(in);
    }
    pel_le_put(bytes + n_snapshot - 4u, 4, pel_crc32_novatel(bytes, n_snapshot - 4u));
    nav = start[0];
    const pel_snap_t checked = pel_snapshot_check(bytes, n_snapshot, &sequence);
    const pel_snap_t verdict = pel_snapshot_restore(&nav, bytes, n_snapshot);
    FUZZ_CHECK(checked == PEL_SNAP_WAITING || verdict != PEL_SNAP_WAITING);
    (void)pel_snapshot_check(in->at, in->left, &sequence);
}

static void begin_all(void)
{
    world_init(&world);
    memset(&seen, 0, sizeof seen);
    begin(PEL_PRESET_AUTO, true, 0);
    start[0] = nav;
    const pel_preset_t preset[N_STARTS] = {PEL_PRESET_AUTO, PEL_PRESET_INS_RTK, PEL_PRESET_RTK, PEL_PRESET_INS_SINGLE,
                                           PEL_PRESET_INS_FLOAT};
    for (int s = 1; s < N_STARTS; s++) {
        memset(&seen, 0, sizeof seen);
        begin(preset[s], true, BEGUN);
        /* The script means what it says only if the navigator is where it should be. */
        FUZZ_CHECK(nav.have_state && nav.ins == (preset[s] != PEL_PRESET_RTK));
        FUZZ_CHECK(nav.local == (preset[s] == PEL_PRESET_INS_FLOAT));
        FUZZ_CHECK(preset[s] == PEL_PRESET_INS_SINGLE || nav.epoch_solution.fix == PEL_FIX_FIXED);
        start[s] = nav;
        if (preset[s] == PEL_PRESET_INS_RTK) { n_snapshot = pel_snapshot_encode(&nav, 1, snapshot, sizeof snapshot); }
    }
    FUZZ_CHECK(n_snapshot > PEL_SNAPSHOT_BYTES);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static bool begun;
    fuzz_input_t in = {data, n};
    if (!begun) {
        begin_all();
        begun = true;
    }
    const unsigned s = fuzz_u8(&in) % (N_STARTS + 1u);
    if (s < N_STARTS) {
        nav = start[s];
    } else {
        restore_damaged(&in);
    }
    memset(&seen, 0, sizeof seen);
    seen.counters = nav.counters;
    shift_ns = 0;
    have_held = false;
    pel_imu_stream_init(&imu_stream);
    for (int i = (s == 0u || s == N_STARTS) ? 0 : BEGUN; i < WORLD_EPOCHS && in.left > 0; i++) { one_epoch(&in, i); }
    while (pel_navigator_flush(&nav)) { check_outputs(); }
    check_outputs();
    return 0;
}

/* snapshot.c - a navigator's snapshot as bytes, and back. Layout: docs/FORMATS.md. */
#include "pelorus/snapshot.h"

#include <string.h>

#include "internal.h"

#include "pelorus/bits.h"
#include "pelorus/math.h"

#define MAGIC          UINT32_C(0x534C4550) /* "PELS" */
#define CRC_BYTES      4u
#define HEAD_BYTES     12u                   /* magic, version, length, sequence */
#define NEXT_STAND_NS  (60 * PEL_NS_PER_S)   /* a store wears out: not at every traffic light */
#define SAME_STAND_NS  (3600 * PEL_NS_PER_S) /* an older one is worth less (warm_max_age_s) */
#define MOVING_MPS     0.5                   /* of GNSS alone */
#define HEADING_SD_MAX (20.0 * PEL_DEG)
#define STILL_MIN_NS   (3 * PEL_NS_PER_S)
#define LARGEST_ERROR  100.0 /* of a sensor, rad/s or m/s^2: beyond what any product measures */

/* ---- the layout ------------------------------------------------------------------------------------------------------------ */

static const pel_member_t STATE[] = {
    PEL_MEMBER(pel_snapshot_t, config_hash), PEL_MEMBER(pel_snapshot_t, mount_hash),
    PEL_MEMBER(pel_snapshot_t, t_ns),        PEL_MEMBER(pel_snapshot_t, still_s),
    PEL_ARRAY(pel_snapshot_t, r_ea_e),       PEL_ARRAY(pel_snapshot_t, v_eb_e),
    PEL_ARRAY(pel_snapshot_t, theta_b_e),    PEL_ARRAY(pel_snapshot_t, cov_r_e),
    PEL_ARRAY(pel_snapshot_t, cov_psi_e),    PEL_ARRAY(pel_snapshot_t, error),
    PEL_ARRAY(pel_snapshot_t, sd_error),
};
/* Here: is there a station? Then: */
static const pel_member_t STATION[] = {PEL_MEMBER(pel_snapshot_t, station.id),
                                       PEL_ARRAY(pel_snapshot_t, station.r_ea_e)};

static const pel_member_t EPHEMERIS[] = {
    PEL_MEMBER(pel_ephemeris_t, sys),      PEL_MEMBER(pel_ephemeris_t, prn),   PEL_MEMBER(pel_ephemeris_t, health),
    PEL_MEMBER(pel_ephemeris_t, source),   PEL_MEMBER(pel_ephemeris_t, iode),  PEL_MEMBER(pel_ephemeris_t, iodc),
    PEL_MEMBER(pel_ephemeris_t, sd_ura_m), PEL_MEMBER(pel_ephemeris_t, fit_s), PEL_MEMBER(pel_ephemeris_t, toe_ns),
    PEL_MEMBER(pel_ephemeris_t, toc_ns),   PEL_MEMBER(pel_ephemeris_t, af0),   PEL_MEMBER(pel_ephemeris_t, af1),
    PEL_MEMBER(pel_ephemeris_t, af2),      PEL_ARRAY(pel_ephemeris_t, tgd_s),
};
static const pel_member_t KEPLER[] = {
    PEL_MEMBER(pel_ephemeris_t, sqrt_a), PEL_MEMBER(pel_ephemeris_t, e),         PEL_MEMBER(pel_ephemeris_t, i0),
    PEL_MEMBER(pel_ephemeris_t, Omega0), PEL_MEMBER(pel_ephemeris_t, omega),     PEL_MEMBER(pel_ephemeris_t, M0),
    PEL_MEMBER(pel_ephemeris_t, dn),     PEL_MEMBER(pel_ephemeris_t, Omega_dot), PEL_MEMBER(pel_ephemeris_t, idot),
    PEL_MEMBER(pel_ephemeris_t, cuc),    PEL_MEMBER(pel_ephemeris_t, cus),       PEL_MEMBER(pel_ephemeris_t, crc),
    PEL_MEMBER(pel_ephemeris_t, crs),    PEL_MEMBER(pel_ephemeris_t, cic),       PEL_MEMBER(pel_ephemeris_t, cis),
};
/* In the place of the Kepler elements; then zeros and, behind them, the channel. */
static const pel_member_t GLONASS[] = {PEL_ARRAY(pel_ephemeris_t, glo.r_e), PEL_ARRAY(pel_ephemeris_t, glo.v_e),
                                       PEL_ARRAY(pel_ephemeris_t, glo.a_e)};
#define CHANNEL_AT (PEL_SNAPSHOT_EPH_BYTES - 1u)

static size_t put_state(const pel_snapshot_t *s, uint8_t *out)
{
    size_t n = pel_members_put(STATE, PEL_COUNT(STATE), s, out);
    out[n++] = s->have_station ? 1 : 0;
    return n + pel_members_put(STATION, PEL_COUNT(STATION), s, out + n);
}

static size_t get_state(const uint8_t *in, pel_snapshot_t *s)
{
    size_t n = pel_members_get(STATE, PEL_COUNT(STATE), in, s);
    s->have_station = in[n++] != 0;
    return n + pel_members_get(STATION, PEL_COUNT(STATION), in + n, s);
}

static void put_ephemeris(const pel_ephemeris_t *e, uint8_t out[PEL_SNAPSHOT_EPH_BYTES])
{
    memset(out, 0, PEL_SNAPSHOT_EPH_BYTES);
    const size_t n = pel_members_put(EPHEMERIS, PEL_COUNT(EPHEMERIS), e, out);
    if (e->sys == PEL_SYS_GLO) {
        (void)pel_members_put(GLONASS, PEL_COUNT(GLONASS), e, out + n);
        out[CHANNEL_AT] = (uint8_t)e->glo.k;
    } else {
        (void)pel_members_put(KEPLER, PEL_COUNT(KEPLER), e, out + n);
    }
}

static void get_ephemeris(const uint8_t in[PEL_SNAPSHOT_EPH_BYTES], pel_ephemeris_t *e)
{
    memset(e, 0, sizeof *e);
    const size_t n = pel_members_get(EPHEMERIS, PEL_COUNT(EPHEMERIS), in, e);
    if (e->sys == PEL_SYS_GLO) {
        (void)pel_members_get(GLONASS, PEL_COUNT(GLONASS), in + n, e);
        e->glo.k = (int8_t)in[CHANNEL_AT];
    } else {
        (void)pel_members_get(KEPLER, PEL_COUNT(KEPLER), in + n, e);
    }
}

/* ---- what it was made under -------------------------------------------------------------------------------------------- */

static uint32_t hash_config(const pel_nav_config_t *cfg)
{
    const uint8_t preset = (uint8_t)cfg->preset;
    return pel_fnv1a(&cfg->imu, sizeof cfg->imu, pel_fnv1a(&preset, sizeof preset, PEL_FNV_START));
}

static uint32_t hash_mount(const pel_nav_config_t *cfg)
{
    const uint32_t h = pel_fnv1a(cfg->C_s_b, sizeof cfg->C_s_b, PEL_FNV_START);
    return pel_fnv1a(cfg->lever_ba_b, sizeof cfg->lever_ba_b, h);
}

/* ---- taking it ----------------------------------------------------------------------------------------------------------- */

static bool is_still(const pel_navigator_t *nav)
{
    const pel_time_t since_ns = nav->warm.still_since_ns;
    return since_ns != 0 && nav->at_horizon.t_ns - since_ns >= STILL_MIN_NS;
}

static bool is_worth_keeping(const pel_navigator_t *nav)
{
    const double age_s = pel_time_diff_s(nav->at_horizon.t_ns, nav->last_epoch_ns);
    if (!nav->ins || !nav->have_state || nav->last_epoch_ns == 0 || age_s > (double)nav->cfg.coast_after_s) {
        return false;
    }
    const int i_psi = pel_model_index(&nav->model, PEL_BLOCK_ATTITUDE);
    double P[3][3], up[3];
    pel_nav_axes_t axes;
    pel_nav_axes(nav, &axes);
    pel_nav_block_e(nav, &axes, i_psi, i_psi, P);
    (void)pel_unit3(nav->at_horizon.r_eb_e, up);
    return pel_ud_check(&nav->ud) == PEL_OK && pel_nav_along(P, up) < HEADING_SD_MAX * HEADING_SD_MAX;
}

static void take(const pel_navigator_t *nav, pel_snapshot_t *s)
{
    pel_antenna_t ant;
    pel_nav_axes_t axes;
    double P[3][3], v_ea_e[3];
    memset(s, 0, sizeof *s);
    s->config_hash = hash_config(&nav->cfg);
    s->mount_hash = hash_mount(&nav->cfg);
    s->t_ns = nav->at_horizon.t_ns;
    if (is_still(nav)) { s->still_s = (float)pel_time_diff_s(s->t_ns, nav->warm.still_since_ns); }
    pel_nav_antenna(nav, &ant, s->r_ea_e, v_ea_e);
    pel_nav_antenna_cov(nav, &ant, false, P);
    pel_nav_pack_symmetric(P, s->cov_r_e);
    pel_nav_axes(nav, &axes);
    pel_nav_block_e(nav, &axes, ant.i_psi, ant.i_psi, P);
    pel_nav_pack_symmetric(P, s->cov_psi_e);
    memcpy(s->v_eb_e, nav->at_horizon.v_eb_e, sizeof s->v_eb_e);
    pel_dcm_to_rotvec(nav->at_horizon.C_b_e, s->theta_b_e);
    const pel_block_t blocks[3] = {PEL_BLOCK_GYRO_CONSTANT, PEL_BLOCK_GYRO_MARKOV, PEL_BLOCK_ACCEL_MARKOV};
    const double *const values[3] = {nav->errors.gyro_constant, nav->errors.gyro_markov, nav->errors.accel_markov};
    for (int i = 0; i < 9; i++) {
        const int state = pel_model_index(&nav->model, blocks[i / 3]) + i % 3;
        s->error[i] = values[i / 3][i % 3];
        s->sd_error[i] = (float)pel_sqrt((double)pel_ud_cov(&nav->ud, state, state));
    }
    s->have_station = nav->have_station;
    s->station = nav->station;
}

size_t pel_snapshot_encode(const pel_navigator_t *nav, uint32_t sequence, uint8_t *out, size_t cap)
{
    if (cap < PEL_SNAPSHOT_BYTES || !is_worth_keeping(nav)) { return 0; }
    const size_t room = (cap - PEL_SNAPSHOT_BYTES) / PEL_SNAPSHOT_EPH_BYTES;
    const int n = (room < (size_t)nav->orbits.n) ? (int)room : nav->orbits.n;
    pel_snapshot_t s;
    take(nav, &s);
    pel_le_put(out, 4, MAGIC);
    pel_le_put(out + 4, 2, PEL_SNAPSHOT_VERSION);
    pel_le_put(out + 6, 2, (uint64_t)PEL_SNAPSHOT_BYTES + (uint64_t)n * PEL_SNAPSHOT_EPH_BYTES);
    pel_le_put(out + 8, 4, sequence);
    size_t at = HEAD_BYTES + put_state(&s, out + HEAD_BYTES);
    out[at++] = (uint8_t)n;
    for (int i = 0; i < n; i++, at += PEL_SNAPSHOT_EPH_BYTES) { /* the newest are the last */
        put_ephemeris(&nav->orbits.eph[nav->orbits.n - 1 - i], out + at);
    }
    pel_le_put(out + at, CRC_BYTES, pel_crc32_novatel(out, at));
    return at + CRC_BYTES;
}

bool pel_snapshot_is_due(const pel_navigator_t *nav, pel_time_t last_ns)
{
    const pel_time_t t_ns = nav->at_horizon.t_ns;
    const pel_time_t wait_ns = (last_ns >= nav->warm.still_since_ns) ? SAME_STAND_NS : NEXT_STAND_NS;
    const bool none = last_ns == 0 || last_ns > t_ns;
    return is_still(nav) && (none || t_ns - last_ns >= wait_ns) && is_worth_keeping(nav);
}

bool pel_snapshot_is_outlived(const pel_navigator_t *nav)
{
    if (!nav->have_state) { return false; }
    return nav->ins ? nav->warm.still_since_ns == 0 : pel_norm3(nav->at_horizon.v_eb_e) > MOVING_MPS;
}

/* ---- giving it back -------------------------------------------------------------------------------------------------------- */

static bool is_erased(const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n && i < HEAD_BYTES; i++) {
        if (bytes[i] != 0xFFu) { return false; }
    }
    return true;
}

pel_snap_t pel_snapshot_check(const uint8_t *bytes, size_t n, uint32_t *sequence)
{
    if (is_erased(bytes, n)) { return PEL_SNAP_NONE; }
    if (n < HEAD_BYTES + CRC_BYTES) { return PEL_SNAP_DAMAGED; }
    const size_t length = (size_t)pel_le_u(bytes + 6, 2);
    if (pel_le_u(bytes, 4) != MAGIC || length < HEAD_BYTES + CRC_BYTES || length > n ||
        pel_le_u(bytes + length - CRC_BYTES, CRC_BYTES) != pel_crc32_novatel(bytes, length - CRC_BYTES)) {
        return PEL_SNAP_DAMAGED;
    }
    if (pel_le_u(bytes + 4, 2) != PEL_SNAPSHOT_VERSION) { return PEL_SNAP_NEWER; }
    *sequence = (uint32_t)pel_le_u(bytes + 8, 4);
    return PEL_SNAP_WAITING;
}

static bool covariance_is_possible(const float P[6], double largest)
{
    for (int k = 0; k < 6; k++) {
        const double p = (double)P[k];
        const bool diagonal = k == 0 || k == 3 || k == 5;
        if (!(pel_fabs(p) < largest) || (diagonal && !(p > 0.0))) { return false; }
    }
    return true;
}

static bool is_possible(const pel_snapshot_t *s)
{
    const double r = pel_norm3(s->r_ea_e);
    if (s->t_ns <= 0 || !(r > 6.3e6 && r < 7.4e6) || !(s->still_s >= 0.0f && pel_isfinite((double)s->still_s)) ||
        !pel_isfinite(pel_norm3(s->station.r_ea_e))) {
        return false;
    }
    if (!(pel_norm3(s->theta_b_e) < 4.0 && pel_norm3(s->v_eb_e) < 1e4)) { return false; }
    for (int i = 0; i < 9; i++) {
        if (!(pel_fabs(s->error[i]) < LARGEST_ERROR && s->sd_error[i] > 0.0f &&
              (double)s->sd_error[i] < LARGEST_ERROR)) {
            return false;
        }
    }
    return covariance_is_possible(s->cov_r_e, 1e12) && covariance_is_possible(s->cov_psi_e, 10.0);
}

static pel_snap_t judge_bytes(const pel_navigator_t *nav, const uint8_t *bytes, size_t n, pel_snapshot_t *s,
                              size_t *first_eph)
{
    memset(s, 0, sizeof *s);
    const pel_snap_t whole = pel_snapshot_check(bytes, n, &s->sequence);
    if (whole != PEL_SNAP_WAITING) { return whole; }
    const size_t length = (size_t)pel_le_u(bytes + 6, 2);
    if (length < PEL_SNAPSHOT_BYTES) { return PEL_SNAP_BAD_VALUE; }
    size_t at = HEAD_BYTES + get_state(bytes + HEAD_BYTES, s);
    const uint8_t count = bytes[at++];
    *first_eph = at;
    if (length != PEL_SNAPSHOT_BYTES + (size_t)count * PEL_SNAPSHOT_EPH_BYTES) { return PEL_SNAP_BAD_VALUE; }
    if (!is_possible(s)) { return PEL_SNAP_BAD_VALUE; }
    if (s->mount_hash != hash_mount(&nav->cfg)) { return PEL_SNAP_REMOUNTED; }
    if (s->config_hash != hash_config(&nav->cfg)) { return PEL_SNAP_FOREIGN; }
    return PEL_SNAP_WAITING;
}

pel_snap_t pel_snapshot_restore(pel_navigator_t *nav, const uint8_t *bytes, size_t n)
{
    pel_snapshot_t s;
    size_t at = 0;
    if (!(nav->cfg.warm_max_age_s > 0.0)) { return PEL_SNAP_NONE; }
    const pel_snap_t verdict = judge_bytes(nav, bytes, n, &s, &at);
    if (verdict == PEL_SNAP_NONE) { return verdict; }
    nav->warm.report.verdict = (uint8_t)verdict;
    nav->warm.report.count[verdict]++;
    if (verdict != PEL_SNAP_WAITING) {
        nav->ready |= PEL_NAV_BIT(PEL_NAV_WARM);
        return verdict;
    }
    nav->warm.kept = s;
    if (s.have_station) { pel_navigator_push_station(nav, &s.station); }
    for (int i = bytes[at - 1]; i > 0; i--, at += PEL_SNAPSHOT_EPH_BYTES) {
        pel_ephemeris_t e;
        get_ephemeris(bytes + at, &e);
        pel_navigator_push_ephemeris(nav, &e);
    }
    return verdict;
}

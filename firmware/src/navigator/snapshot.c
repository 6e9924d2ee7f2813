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

/* ---- one layout, both directions: each function visits its fields in order --------------------------------------------- */

typedef struct {
    uint8_t *out; /* writing */
    const uint8_t *in;
    size_t n;
    bool possible; /* every number read so far is finite */
} io_t;

static void put_u(io_t *io, unsigned bytes, uint64_t *v)
{
    if (io->out != NULL) {
        pel_le_put(io->out + io->n, bytes, *v);
    } else {
        *v = pel_le_u(io->in + io->n, bytes);
    }
    io->n += bytes;
}

static void u8(io_t *io, uint8_t *v)
{
    uint64_t wide = *v;
    put_u(io, 1, &wide);
    *v = (uint8_t)wide;
}

static void u16(io_t *io, uint16_t *v)
{
    uint64_t wide = *v;
    put_u(io, 2, &wide);
    *v = (uint16_t)wide;
}

static void u32(io_t *io, uint32_t *v)
{
    uint64_t wide = *v;
    put_u(io, 4, &wide);
    *v = (uint32_t)wide;
}

static void i64(io_t *io, int64_t *v)
{
    uint64_t wide = (uint64_t)*v;
    put_u(io, 8, &wide);
    *v = (int64_t)wide;
}

static void f32(io_t *io, float *v, int count)
{
    for (int i = 0; i < count; i++, io->n += 4) {
        if (io->out != NULL) {
            pel_le_put_f32(io->out + io->n, v[i]);
        } else {
            v[i] = pel_le_f32(io->in + io->n);
            io->possible = io->possible && pel_isfinite((double)v[i]);
        }
    }
}

static void f64(io_t *io, double *v, int count)
{
    for (int i = 0; i < count; i++, io->n += 8) {
        if (io->out != NULL) {
            pel_le_put_f64(io->out + io->n, v[i]);
        } else {
            v[i] = pel_le_f64(io->in + io->n);
            io->possible = io->possible && pel_isfinite(v[i]);
        }
    }
}

static void head_fields(io_t *io, uint32_t *magic, uint16_t *version, uint16_t *length, uint32_t *sequence)
{
    u32(io, magic);
    u16(io, version);
    u16(io, length);
    u32(io, sequence);
}

static void state_fields(io_t *io, pel_snapshot_t *s)
{
    uint8_t have_station = s->have_station ? 1 : 0;
    u32(io, &s->config_hash);
    u32(io, &s->mount_hash);
    i64(io, &s->t_ns);
    f32(io, &s->still_s, 1);
    f64(io, s->r_ea_e, 3);
    f64(io, s->v_eb_e, 3);
    f64(io, s->theta_b_e, 3);
    f32(io, s->cov_r_e, 6);
    f32(io, s->cov_psi_e, 6);
    f64(io, s->error, 9);
    f32(io, s->sd_error, 9);
    u8(io, &have_station);
    u16(io, &s->station.id);
    f64(io, s->station.r_ea_e, 3);
    s->have_station = have_station != 0;
}

static void ephemeris_fields(io_t *io, pel_ephemeris_t *e)
{
    double elements[15] = {0};
    u8(io, &e->sys);
    u8(io, &e->prn);
    u8(io, &e->health);
    u8(io, &e->source);
    u16(io, &e->iode);
    u16(io, &e->iodc);
    f32(io, &e->sd_ura_m, 1);
    f32(io, &e->fit_s, 1);
    i64(io, &e->toe_ns);
    i64(io, &e->toc_ns);
    f64(io, &e->af0, 1);
    f64(io, &e->af1, 1);
    f64(io, &e->af2, 1);
    f64(io, e->tgd_s, 2);
    double *const kepler[15] = {&e->sqrt_a, &e->e,   &e->i0,  &e->Omega0, &e->omega, &e->M0,  &e->dn, &e->Omega_dot,
                                &e->idot,   &e->cuc, &e->cus, &e->crc,    &e->crs,   &e->cic, &e->cis};
    double *const glonass[9] = {&e->glo.r_e[0], &e->glo.r_e[1], &e->glo.r_e[2], &e->glo.v_e[0], &e->glo.v_e[1],
                                &e->glo.v_e[2], &e->glo.a_e[0], &e->glo.a_e[1], &e->glo.a_e[2]};
    const bool glo = e->sys == PEL_SYS_GLO;
    double *const *const field = glo ? glonass : kepler;
    const int n = glo ? 9 : 15;
    uint8_t channel = glo ? (uint8_t)e->glo.k : 0;
    for (int i = 0; i < n; i++) { elements[i] = *field[i]; }
    f64(io, elements, 15);
    u8(io, &channel);
    for (int i = 0; i < n; i++) { *field[i] = elements[i]; }
    if (glo) { e->glo.k = (int8_t)channel; }
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
    io_t io = {.out = out};
    uint32_t magic = MAGIC;
    uint16_t version = PEL_SNAPSHOT_VERSION;
    uint16_t length = (uint16_t)(PEL_SNAPSHOT_BYTES + (size_t)n * PEL_SNAPSHOT_EPH_BYTES);
    uint8_t count = (uint8_t)n;
    take(nav, &s);
    head_fields(&io, &magic, &version, &length, &sequence);
    state_fields(&io, &s);
    u8(&io, &count);
    for (int i = 0; i < n; i++) { /* the newest are the last */
        pel_ephemeris_t e = nav->orbits.eph[nav->orbits.n - 1 - i];
        ephemeris_fields(&io, &e);
    }
    pel_le_put(out + io.n, CRC_BYTES, pel_crc32_novatel(out, io.n));
    return io.n + CRC_BYTES;
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
    io_t io = {.in = bytes};
    uint32_t magic = 0, order = 0;
    uint16_t version = 0, length = 0;
    head_fields(&io, &magic, &version, &length, &order);
    if (magic != MAGIC || length < HEAD_BYTES + CRC_BYTES || length > n ||
        pel_le_u(bytes + length - CRC_BYTES, CRC_BYTES) != pel_crc32_novatel(bytes, length - CRC_BYTES)) {
        return PEL_SNAP_DAMAGED;
    }
    if (version != PEL_SNAPSHOT_VERSION) { return PEL_SNAP_NEWER; }
    *sequence = order;
    return PEL_SNAP_WAITING;
}

static bool covariance_is_possible(const float P[6], double largest)
{
    const int diagonal[3] = {0, 3, 5};
    for (int k = 0; k < 3; k++) {
        const double var = (double)P[diagonal[k]];
        if (!(var > 0.0 && var < largest)) { return false; }
    }
    return true;
}

static bool is_possible(const pel_snapshot_t *s)
{
    const double r = pel_norm3(s->r_ea_e);
    if (s->t_ns <= 0 || !(r > 6.3e6 && r < 7.4e6) || !(s->still_s >= 0.0f)) { return false; }
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
    io_t io = {.in = bytes, .n = HEAD_BYTES, .possible = true};
    uint8_t count = 0;
    state_fields(&io, s);
    u8(&io, &count);
    *first_eph = io.n;
    if (length != PEL_SNAPSHOT_BYTES + (size_t)count * PEL_SNAPSHOT_EPH_BYTES) { return PEL_SNAP_BAD_VALUE; }
    if (!io.possible || !is_possible(s)) { return PEL_SNAP_BAD_VALUE; }
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
    io_t io = {.in = bytes, .n = at, .possible = true};
    for (int i = bytes[at - 1]; i > 0; i--) {
        pel_ephemeris_t e;
        memset(&e, 0, sizeof e);
        ephemeris_fields(&io, &e);
        pel_navigator_push_ephemeris(nav, &e);
    }
    return verdict;
}

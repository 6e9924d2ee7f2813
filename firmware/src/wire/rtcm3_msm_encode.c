#include "msm.h"
#include "navmsg.h"

#define MAX_CELLS 64
/* A phase may differ from its code by any number of cycles, the message holds +-1171 m: whole multiples of this many cycles
 * are taken off. They are so long that code noise seldom changes their number. */
#define PHASE_BLOCK_CYC 4096.0

typedef struct {
    int32_t code, phase, rate; /* in units of the message; the most negative value: none */
    uint32_t lock, half, cn0;
} msm_cell_t;

typedef struct {
    uint64_t sat_mask;
    uint32_t sig_mask;
    int n_sat, n_sig;
} msm_masks_t;

static int signal_id(const pel_obs_t *o, pel_sys_t sys)
{
    if (o->sys != sys || !pel_obs_plausible(o)) { return 0; }
    return pel_msm_id(sys, o->carrier, o->code);
}

static uint64_t sat_bit(int prn)
{
    return UINT64_C(1) << (64 - prn);
}
static uint32_t sig_bit(int id)
{
    return UINT32_C(1) << (32 - id);
}

/* Only satellites with a code: the rough range comes from it. */
static bool has_code(const pel_epoch_t *e, pel_sys_t sys, int prn)
{
    for (int i = 0; i < (int)e->n; i++) {
        const pel_obs_t *const o = &e->obs[i];
        if (o->prn == prn && signal_id(o, sys) != 0 && (o->flags & PEL_OBS_CODE) != 0u) { return true; }
    }
    return false;
}

static void make_masks(const pel_epoch_t *e, pel_sys_t sys, msm_masks_t *m)
{
    *m = (msm_masks_t){0};
    for (int i = 0; i < (int)e->n; i++) {
        const pel_obs_t *const o = &e->obs[i];
        const int id = signal_id(o, sys);
        if (id == 0 || !has_code(e, sys, o->prn)) { continue; }
        const int n_sat = m->n_sat + (((m->sat_mask & sat_bit(o->prn)) == 0u) ? 1 : 0);
        const int n_sig = m->n_sig + (((m->sig_mask & sig_bit(id)) == 0u) ? 1 : 0);
        if (n_sat * n_sig > MAX_CELLS) { continue; }
        m->sat_mask |= sat_bit(o->prn);
        m->sig_mask |= sig_bit(id);
        m->n_sat = n_sat;
        m->n_sig = n_sig;
    }
}

static const pel_obs_t *find(const pel_epoch_t *e, pel_sys_t sys, int prn, int id)
{
    for (int i = 0; i < (int)e->n; i++) {
        if (e->obs[i].prn == prn && signal_id(&e->obs[i], sys) == id) { return &e->obs[i]; }
    }
    return NULL;
}

static double wavelength(const pel_obs_t *o)
{
    return PEL_SPEED_OF_LIGHT / pel_carrier_hz((pel_sys_t)o->sys, (pel_carrier_t)o->carrier, o->glo_k);
}

/* Rough range in 2^-10 ms and rough rate in m/s of a satellite, from its first signal that has them. */
static void rough_of(const pel_epoch_t *e, pel_sys_t sys, int prn, int32_t *range, int32_t *rate)
{
    *range = -1;
    *rate = -8192;
    for (int i = 0; i < (int)e->n; i++) {
        const pel_obs_t *const o = &e->obs[i];
        if (o->prn != prn || signal_id(o, sys) == 0) { continue; }
        if (*range < 0 && (o->flags & PEL_OBS_CODE) != 0u) {
            *range = (int32_t)pel_round_i64(o->P_m / PEL_RANGE_MS_M * 1024.0);
        }
        if (*rate == -8192 && (o->flags & PEL_OBS_DOPPLER) != 0u) {
            const int64_t r = pel_round_i64(-(double)o->D_hz * wavelength(o));
            if (r > -8192 && r < 8192) { *rate = (int32_t)r; }
        }
    }
}

/* value in units of 2^pow2, or the mark "none" when it does not fit. */
static int32_t field(double value, int pow2, unsigned bits)
{
    const int64_t none = -(INT64_C(1) << (bits - 1u));
    const int64_t raw = pel_round_i64(value * pel_pow2(-pow2));
    return (int32_t)((raw > none && raw < -none) ? raw : none);
}

static void make_cell(const pel_msm_kind_t *k, const pel_obs_t *o, int32_t rough, int32_t rough_rate, msm_cell_t *c)
{
    const double lambda = wavelength(o);
    const double rough_ms = (double)rough * pel_pow2(-10);
    const double reference_m = ((o->flags & PEL_OBS_CODE) != 0u) ? o->P_m : rough_ms * PEL_RANGE_MS_M;

    c->code = field((o->P_m / PEL_RANGE_MS_M) - rough_ms, k->code_pow2, k->code_bits);
    if ((o->flags & PEL_OBS_CODE) == 0u) { c->code = -(1 << (k->code_bits - 1)); }

    const int64_t blocks = pel_round_i64((o->L_cyc - reference_m / lambda) / PHASE_BLOCK_CYC);
    const double phase_m = (o->L_cyc - (double)blocks * PHASE_BLOCK_CYC) * lambda;
    c->phase = field(phase_m / PEL_RANGE_MS_M - rough_ms, k->phase_pow2, k->phase_bits);
    if ((o->flags & PEL_OBS_PHASE) == 0u) { c->phase = -(1 << (k->phase_bits - 1)); }

    c->rate = -16384;
    if ((o->flags & PEL_OBS_DOPPLER) != 0u && rough_rate != -8192) {
        const int64_t fine = pel_round_i64((-(double)o->D_hz * lambda - (double)rough_rate) * 1e4);
        if (fine > -16384 && fine < 16384) { c->rate = (int32_t)fine; }
    }
    c->lock = pel_msm_lock_indicator(k->lock_bits, o->lock_ms);
    c->half = ((o->flags & PEL_OBS_HALF_CYCLE) != 0u) ? 1u : 0u;
    const uint32_t cn0_max = (1u << k->cn0_bits) - 1u;
    const uint32_t cn0 = (uint32_t)pel_round_i64((double)o->cn0_dbhz * pel_pow2(-k->cn0_pow2));
    c->cn0 = (cn0 < cn0_max) ? cn0 : cn0_max;
}

/* Day of the week and ms of the day, of Moscow. */
static uint64_t glonass_epoch(pel_time_t t)
{
    const int64_t ms = (pel_moscow_from_gps(t) + PEL_NS_PER_MS / 2) % PEL_NS_PER_WEEK / PEL_NS_PER_MS;
    return ((uint64_t)(ms / 86400000) << 27) | (uint64_t)(ms % 86400000);
}

static void write_header(pel_bit_writer_t *w, const pel_epoch_t *e, pel_sys_t sys, int msm, uint16_t station, bool more,
                         const msm_masks_t *m)
{
    static const uint16_t NUMBER[PEL_N_SYS] = {1070, 1080, 1090, 1120, 1110, 1100};
    const pel_time_t offset = (sys == PEL_SYS_BDS) ? 14 * PEL_NS_PER_S : 0;
    const int64_t ms = (e->t_ns - offset + PEL_NS_PER_MS / 2) % PEL_NS_PER_WEEK / PEL_NS_PER_MS;
    pel_write_u(w, 12, (uint64_t)NUMBER[sys] + (uint64_t)msm);
    pel_write_u(w, 12, station);
    pel_write_u(w, 30, (sys == PEL_SYS_GLO) ? glonass_epoch(e->t_ns) : (uint64_t)ms);
    pel_write_u(w, 1, more ? 1u : 0u);
    pel_write_u(w, 3 + 7 + 2 + 2 + 1 + 3, 0);
    pel_write_u(w, 64, m->sat_mask);
    pel_write_u(w, 32, m->sig_mask);
}

static void write_sats(pel_bit_writer_t *w, bool has_rate, const int32_t *range, const int32_t *rate,
                       const uint8_t *info, int n)
{
    for (int i = 0; i < n; i++) { pel_write_u(w, 8, (uint64_t)(range[i] >> 10)); }
    for (int i = 0; has_rate && i < n; i++) { pel_write_u(w, 4, info[i]); }
    for (int i = 0; i < n; i++) { pel_write_u(w, 10, (uint64_t)range[i] & 1023u); }
    for (int i = 0; has_rate && i < n; i++) { pel_write_s(w, 14, rate[i]); }
}

static void write_cells(pel_bit_writer_t *w, const pel_msm_kind_t *k, const msm_cell_t *c, int n)
{
    for (int i = 0; i < n; i++) { pel_write_s(w, k->code_bits, c[i].code); }
    for (int i = 0; i < n; i++) { pel_write_s(w, k->phase_bits, c[i].phase); }
    for (int i = 0; i < n; i++) { pel_write_u(w, k->lock_bits, c[i].lock); }
    for (int i = 0; i < n; i++) { pel_write_u(w, 1, c[i].half); }
    for (int i = 0; i < n; i++) { pel_write_u(w, k->cn0_bits, c[i].cn0); }
    for (int i = 0; k->has_rate && i < n; i++) { pel_write_s(w, 15, c[i].rate); }
}

size_t pel_rtcm3_encode_msm(const pel_epoch_t *e, pel_sys_t sys, int msm, uint16_t station, bool more, uint8_t *out,
                            size_t cap)
{
    const pel_msm_kind_t *const k = pel_msm_kind(msm);
    msm_masks_t m;
    msm_cell_t cell[MAX_CELLS];
    int32_t range[64];
    int32_t rate[64];
    uint8_t info[64] = {0}; /* frequency channel of GLONASS */
    pel_bit_writer_t w;
    int n_sat = 0;
    int n_cell = 0;

    if (k == NULL || cap < 32u || e->n > PEL_MAX_OBS || e->t_ns < 14 * PEL_NS_PER_S || station > 4095u) { return 0; }
    if ((unsigned)sys >= PEL_N_SYS) { return 0; }
    make_masks(e, sys, &m);
    pel_bit_writer_init(&w, out + 3, ((cap < 1029u) ? cap : 1029u) - 6u);
    write_header(&w, e, sys, msm, station, more, &m);
    for (int prn = 1; prn <= 64; prn++) {
        if ((m.sat_mask & sat_bit(prn)) == 0u) { continue; }
        rough_of(e, sys, prn, &range[n_sat], &rate[n_sat]);
        for (int id = 1; id <= 32; id++) {
            if ((m.sig_mask & sig_bit(id)) == 0u) { continue; }
            const pel_obs_t *const o = find(e, sys, prn, id);
            pel_write_u(&w, 1, (o != NULL) ? 1u : 0u);
            if (o == NULL) { continue; }
            if (sys == PEL_SYS_GLO) { info[n_sat] = (uint8_t)(o->glo_k + 7); }
            make_cell(k, o, range[n_sat], rate[n_sat], &cell[n_cell]);
            n_cell++;
        }
        n_sat++;
    }
    write_sats(&w, k->has_rate, range, rate, info, n_sat);
    write_cells(&w, k, cell, n_cell);
    return (w.overrun || w.out_of_range) ? 0u : pel_rtcm3_seal(w.pos, out, cap);
}

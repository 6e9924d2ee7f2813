#include "msm.h"
#include "navmsg.h"

#define MAX_CELLS       64
#define GLO_MS_MASK     0x7FFFFFFu
#define ROUGH_RATE_NONE (-8192)
#define FINE_RATE_NONE  (-16384)

/* Header and masks of one message. */
typedef struct {
    pel_sys_t sys;
    const pel_msm_kind_t *kind;
    pel_time_t t_ns;
    bool more;
    int n_sat, n_sig, n_cell;
    uint8_t sat[64], sig[32]; /* numbers set in the masks */
    uint64_t cells;           /* satellite-major, first cell in the highest of n_sat * n_sig bits */
    size_t body;              /* where satellite data begin, bits */
} msm_header_t;

static pel_sys_t system_of(unsigned number)
{
    switch (number / 10u) {
    case 107: return PEL_SYS_GPS;
    case 108: return PEL_SYS_GLO;
    case 109: return PEL_SYS_GAL;
    case 110: return PEL_SYS_SBS; /* satellite 1 is PRN 120 there and here */
    case 111: return PEL_SYS_QZS;
    default: return PEL_SYS_BDS;
    }
}

static int mask_numbers(uint64_t mask, int n_bits, uint8_t *number)
{
    int n = 0;
    for (int i = 0; i < n_bits; i++) {
        if (((mask >> (n_bits - 1 - i)) & 1u) != 0u) {
            number[n] = (uint8_t)(i + 1);
            n++;
        }
    }
    return n;
}

/* False: too short for what its masks announce. */
static bool read_header(pel_bit_reader_t *r, msm_header_t *h, uint32_t *epoch_ms)
{
    const unsigned number = (unsigned)pel_read_u(r, 12);
    uint8_t unused[64];
    h->sys = system_of(number);
    h->kind = pel_msm_kind((int)(number % 10u));
    pel_skip_bits(r, 12);
    *epoch_ms = (uint32_t)pel_read_u(r, 30);
    h->more = pel_read_u(r, 1) != 0u;
    pel_skip_bits(r, 3 + 7 + 2 + 2 + 1 + 3);
    h->n_sat = mask_numbers(pel_read_u(r, 64), 64, h->sat);
    h->n_sig = mask_numbers(pel_read_u(r, 32), 32, h->sig);
    if (r->overrun || h->n_sat * h->n_sig > MAX_CELLS) { return false; }
    h->cells = (h->n_sat * h->n_sig > 0) ? pel_read_u(r, (unsigned)(h->n_sat * h->n_sig)) : 0u;
    h->n_cell = mask_numbers(h->cells, h->n_sat * h->n_sig, unused);
    h->body = r->pos;
    const pel_msm_kind_t *const k = h->kind;
    const size_t sat_bits = k->has_rate ? 36u : 18u;
    const size_t cell_bits =
        (size_t)k->code_bits + k->phase_bits + k->lock_bits + 1u + k->cn0_bits + (k->has_rate ? 15u : 0u);
    return !r->overrun && h->body + sat_bits * (size_t)h->n_sat + cell_bits * (size_t)h->n_cell <= r->n_bits;
}

/* Rough range in ms; false if the sender has none. Rough rate in m/s, NONE if it has none. */
static bool rough(const pel_bit_reader_t *r, const msm_header_t *h, int sat, double *range_ms, int32_t *rate)
{
    const size_t n = (size_t)h->n_sat;
    const size_t i = (size_t)sat;
    const size_t modulo_at = h->body + (8u + (h->kind->has_rate ? 4u : 0u)) * n;
    const uint32_t whole = (uint32_t)pel_bits_u(r->p, h->body + 8u * i, 8);
    *range_ms = (double)whole + (double)pel_bits_u(r->p, modulo_at + 10u * i, 10) * pel_pow2(-10);
    *rate = h->kind->has_rate ? (int32_t)pel_bits_s(r->p, modulo_at + 10u * n + 14u * i, 14) : ROUGH_RATE_NONE;
    return whole != 255u;
}

/* Extended information of a GLONASS satellite is its frequency channel; MSM4 and MSM6 have none. Without the channel
 * there is no wavelength, and no pairing with another receiver: such satellites are left out. */
static bool channel_of(pel_receiver_t *rx, const pel_bit_reader_t *r, const msm_header_t *h, int sat, int8_t *k)
{
    const unsigned slot = h->sat[sat];
    *k = 0;
    if (h->sys != PEL_SYS_GLO) { return true; }
    if (h->kind->has_rate) {
        const size_t at = h->body + 8u * (size_t)h->n_sat + 4u * (size_t)sat;
        pel_rx_learn_channel(rx, slot, (int)pel_bits_u(r->p, at, 4) - 7);
    }
    return pel_rx_channel(rx, slot, k);
}

/* Fields of one kind are stored one after the other for all cells: field f of cell c. */
static void decode_cell(const pel_bit_reader_t *r, const msm_header_t *h, int cell, double range_ms, int32_t rate,
                        pel_obs_t *o)
{
    const pel_msm_kind_t *const k = h->kind;
    const size_t n = (size_t)h->n_cell;
    const size_t c = (size_t)cell;
    const double lambda = PEL_SPEED_OF_LIGHT / pel_carrier_hz(h->sys, (pel_carrier_t)o->carrier, o->glo_k);
    size_t at = h->body + (k->has_rate ? 36u : 18u) * (size_t)h->n_sat;

    const int64_t code = pel_bits_s(r->p, at + k->code_bits * c, k->code_bits);
    if (code != -(INT64_C(1) << (k->code_bits - 1))) {
        o->P_m = PEL_RANGE_MS_M * (range_ms + (double)code * pel_pow2(k->code_pow2));
        o->flags |= PEL_OBS_CODE;
    }
    at += k->code_bits * n;
    const int64_t phase = pel_bits_s(r->p, at + k->phase_bits * c, k->phase_bits);
    if (phase != -(INT64_C(1) << (k->phase_bits - 1))) {
        o->L_cyc = PEL_RANGE_MS_M * (range_ms + (double)phase * pel_pow2(k->phase_pow2)) / lambda;
        o->flags |= PEL_OBS_PHASE;
    }
    at += k->phase_bits * n;
    o->lock_ms = pel_msm_lock_ms(k->lock_bits, (uint32_t)pel_bits_u(r->p, at + k->lock_bits * c, k->lock_bits));
    at += k->lock_bits * n;
    if (pel_bits_u(r->p, at + c, 1) != 0u && (o->flags & PEL_OBS_PHASE) != 0u) { o->flags |= PEL_OBS_HALF_CYCLE; }
    at += n;
    o->cn0_dbhz = (float)pel_bits_u(r->p, at + k->cn0_bits * c, k->cn0_bits) * (float)pel_pow2(k->cn0_pow2);
    at += k->cn0_bits * n;
    if (k->has_rate && rate != ROUGH_RATE_NONE) {
        const int64_t fine = pel_bits_s(r->p, at + 15u * c, 15);
        if (fine != FINE_RATE_NONE) {
            o->D_hz = (float)(-((double)rate + 1e-4 * (double)fine) / lambda);
            o->flags |= PEL_OBS_DOPPLER;
        }
    }
}

static void decode_cells(pel_receiver_t *rx, const pel_bit_reader_t *r, const msm_header_t *h)
{
    const int n_mask = h->n_sat * h->n_sig;
    int cell = 0;
    for (int i = 0; i < n_mask; i++) {
        if (((h->cells >> (n_mask - 1 - i)) & 1u) == 0u) { continue; }
        pel_obs_t o = {.sys = (uint8_t)h->sys, .prn = h->sat[i / h->n_sig]};
        double range_ms;
        int32_t rate;
        if (!pel_msm_signal(h->sys, h->sig[i % h->n_sig], &o.carrier, &o.code)) {
            rx->counters.bad_value++;
        } else if (!channel_of(rx, r, h, i / h->n_sig, &o.glo_k)) {
            rx->counters.unknown++;
        } else if (rough(r, h, i / h->n_sig, &range_ms, &rate)) {
            decode_cell(r, h, cell, range_ms, rate, &o);
            if ((o.flags & (PEL_OBS_CODE | PEL_OBS_PHASE)) != 0u) { pel_rx_add(rx, &o); }
        }
        cell++;
    }
}

/* GLONASS messages carry Moscow time: day of the week (3 bits) and ms of the day, which may have a leap second. */
static bool time_possible(pel_sys_t sys, uint32_t epoch_ms)
{
    return (sys == PEL_SYS_GLO) ? (epoch_ms & GLO_MS_MASK) <= 86400999u : epoch_ms < 604800000u;
}

/* BeiDou messages carry BeiDou time, 14 s behind GPS time. Some senders put GPS time there: then it is that of the epoch
 * whose other messages are just coming in. */
static pel_time_t time_of(const pel_receiver_t *rx, pel_sys_t sys, uint32_t epoch_ms)
{
    if (sys == PEL_SYS_GLO) {
        const pel_time_t near = rx->collecting ? rx->epoch.t_ns : rx->t_approx_ns;
        return pel_glo_epoch_near(epoch_ms >> 27, epoch_ms & GLO_MS_MASK, near);
    }
    const pel_time_t t = pel_tow_ms_near(epoch_ms, rx->t_approx_ns);
    if (sys != PEL_SYS_BDS) { return t; }
    if (rx->collecting && t == rx->epoch.t_ns) { return t; }
    return pel_tow_ms_near(epoch_ms + 14000u, rx->t_approx_ns);
}

pel_rx_event_t pel_rtcm3_msm(pel_receiver_t *rx, const uint8_t *message, size_t n, bool *hold)
{
    pel_bit_reader_t r;
    msm_header_t h;
    uint32_t epoch_ms;
    pel_rx_event_t event = PEL_RX_NONE;

    pel_bit_reader_init(&r, message, n);
    if (!read_header(&r, &h, &epoch_ms)) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    if (!time_possible(h.sys, epoch_ms)) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    if (rx->t_approx_ns == 0) {
        rx->counters.unknown++; /* nothing tells the week yet */
        return PEL_RX_NONE;
    }
    h.t_ns = time_of(rx, h.sys, epoch_ms);
    if (!pel_rx_collect(rx, h.t_ns, hold, &event)) { return event; }
    if (h.sys == PEL_SYS_GPS) { rx->t_gps_msm_ns = h.t_ns; }
    if (h.sys == PEL_SYS_GLO) { rx->t_glo_msm_ns = h.t_ns; }
    decode_cells(rx, &r, &h);
    return h.more ? PEL_RX_NONE : pel_rx_deliver(rx);
}

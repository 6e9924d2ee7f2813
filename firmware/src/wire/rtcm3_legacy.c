#include "navmsg.h"

/* RTCM 3 messages 1004 and 1012: extended L1 and L2 observations of GPS and GLONASS (RTCM 10403, tables 3.5-2, 3.5-5, 3.5-10
 * and 3.5-13). */

#define HEADER_BITS     64u
#define SAT_BITS        125u
#define GLO_HEADER_BITS 61u
#define GLO_SAT_BITS    130u
#define MS_M            (PEL_SPEED_OF_LIGHT * 1e-3)
#define CODE_UNIT_M     0.02
#define PHASE_UNIT_M    0.0005
#define NO_PHASE        (-524288)
#define NO_CODE_2       (-8192)
#define NO_RANGE_1      0xFFFFFFu
#define NO_GLO_RANGE_1  0x1FFFFFFu
/* The message holds phase minus code within +-262 m: multiples of 1500 cycles are taken off (3.5.1, DF012). */
#define PHASE_BLOCK_CYC 1500.0
/* After this long without an MSM of its system a legacy message counts again. */
#define MSM_GONE_S 60

/* DF013: blocks of 24 values, each with twice the step of the one before; 127 is 937 s or more. */
static uint32_t lock_s(uint32_t indicator)
{
    if (indicator >= 127u) { return 937; }
    const uint32_t block = indicator / 24u;
    const uint32_t start = 24u * ((1u << block) - 1u);
    return start + ((indicator - 24u * block) << block);
}

static uint32_t lock_indicator(uint32_t lock_ms)
{
    uint32_t i = 127;
    while (i > 0u && lock_s(i) * 1000u > lock_ms) { i--; }
    return i;
}

static double wavelength(pel_sys_t sys, pel_carrier_t carrier, int k)
{
    return PEL_SPEED_OF_LIGHT / pel_carrier_hz(sys, carrier, k);
}

/* Completes an observation whose names are there, and adds it. */
static void add(pel_receiver_t *rx, pel_obs_t o, double range_m, bool has_range, double phase_m, bool has_phase,
                uint32_t lock, uint32_t cn0)
{
    if (has_range) {
        o.P_m = range_m;
        o.flags |= PEL_OBS_CODE;
    }
    if (has_phase) {
        o.L_cyc = phase_m / wavelength((pel_sys_t)o.sys, (pel_carrier_t)o.carrier, o.glo_k);
        o.flags |= PEL_OBS_PHASE;
    }
    o.lock_ms = 1000u * lock_s(lock);
    o.cn0_dbhz = 0.25f * (float)cn0;
    if (o.flags != 0u) { pel_rx_add(rx, &o); }
}

static void decode_sat(pel_receiver_t *rx, pel_bit_reader_t *r, bool skip_gps)
{
    static const char L2_CODE[4] = {'X', 'P', 'W', 'W'};
    const uint32_t sv = (uint32_t)pel_read_u(r, 6);
    const uint32_t p_code_1 = (uint32_t)pel_read_u(r, 1);
    const uint32_t range = (uint32_t)pel_read_u(r, 24);
    const int64_t phase_1 = pel_read_s(r, 20);
    const uint32_t lock_1 = (uint32_t)pel_read_u(r, 7);
    const uint32_t whole_ms = (uint32_t)pel_read_u(r, 8);
    const uint32_t cn0_1 = (uint32_t)pel_read_u(r, 8);
    const uint32_t code_2 = (uint32_t)pel_read_u(r, 2);
    const int64_t range_2 = pel_read_s(r, 14);
    const int64_t phase_2 = pel_read_s(r, 20);
    const uint32_t lock_2 = (uint32_t)pel_read_u(r, 7);
    const uint32_t cn0_2 = (uint32_t)pel_read_u(r, 8);

    uint8_t sys = PEL_SYS_GPS;
    uint8_t prn = (uint8_t)sv;
    if (sv >= 40u && sv <= 58u) { /* SBAS 120 to 138, as S20 to S38 */
        sys = PEL_SYS_SBS;
        prn = (uint8_t)(sv - 39u);
    }
    if (sys == PEL_SYS_GPS && skip_gps) { return; }
    if (range == NO_RANGE_1) { return; } /* everything else is relative to it */
    const double range_m = (double)range * CODE_UNIT_M + (double)whole_ms * MS_M;
    const pel_obs_t o1 = {.sys = sys, .prn = prn, .carrier = PEL_CARRIER_L1, .code = (p_code_1 != 0u) ? 'W' : 'C'};
    const pel_obs_t o2 = {.sys = sys, .prn = prn, .carrier = PEL_CARRIER_L2, .code = L2_CODE[code_2]};
    add(rx, o1, range_m, true, range_m + (double)phase_1 * PHASE_UNIT_M, phase_1 != NO_PHASE, lock_1, cn0_1);
    if (sys == PEL_SYS_GPS) {
        add(rx, o2, range_m + (double)range_2 * CODE_UNIT_M, range_2 != NO_CODE_2,
            range_m + (double)phase_2 * PHASE_UNIT_M, phase_2 != NO_PHASE, lock_2, cn0_2);
    }
}

/* Ranges are modulo two light milliseconds; channels beyond those in use (0 to 20 fit) are refused by pel_rx_add(). */
static void decode_glonass_sat(pel_receiver_t *rx, pel_bit_reader_t *r, bool skip)
{
    const uint8_t slot = (uint8_t)pel_read_u(r, 6);
    const bool p_code_1 = pel_read_u(r, 1) != 0u;
    const int8_t k = (int8_t)((int)pel_read_u(r, 5) - 7);
    const uint32_t range = (uint32_t)pel_read_u(r, 25);
    const int64_t phase_1 = pel_read_s(r, 20);
    const uint32_t lock_1 = (uint32_t)pel_read_u(r, 7);
    const uint32_t whole = (uint32_t)pel_read_u(r, 7);
    const uint32_t cn0_1 = (uint32_t)pel_read_u(r, 8);
    const uint32_t code_2 = (uint32_t)pel_read_u(r, 2);
    const int64_t range_2 = pel_read_s(r, 14);
    const int64_t phase_2 = pel_read_s(r, 20);
    const uint32_t lock_2 = (uint32_t)pel_read_u(r, 7);
    const uint32_t cn0_2 = (uint32_t)pel_read_u(r, 8);
    const pel_obs_t o1 = {
        .sys = PEL_SYS_GLO, .prn = slot, .carrier = PEL_CARRIER_L1, .code = p_code_1 ? 'P' : 'C', .glo_k = k};
    const pel_obs_t o2 = {
        .sys = PEL_SYS_GLO, .prn = slot, .carrier = PEL_CARRIER_L2, .code = (code_2 == 0u) ? 'C' : 'P', .glo_k = k};

    pel_rx_learn_channel(rx, slot, k);
    if (skip || range == NO_GLO_RANGE_1) { return; }
    const double range_m = (double)range * CODE_UNIT_M + (double)whole * 2.0 * MS_M;
    add(rx, o1, range_m, true, range_m + (double)phase_1 * PHASE_UNIT_M, phase_1 != NO_PHASE, lock_1, cn0_1);
    add(rx, o2, range_m + (double)range_2 * CODE_UNIT_M, range_2 != NO_CODE_2, range_m + (double)phase_2 * PHASE_UNIT_M,
        phase_2 != NO_PHASE, lock_2, cn0_2);
}

/* A sender of both kinds has another integer in each: its MSM are taken, and only they. */
static bool has_msm(pel_receiver_t *rx, pel_time_t t_msm, pel_time_t t)
{
    const bool has = t_msm != 0 && t - t_msm < MSM_GONE_S * PEL_NS_PER_S;
    if (has) { rx->counters.duplicate++; }
    return has;
}

pel_rx_event_t pel_rtcm3_1004(pel_receiver_t *rx, const uint8_t *message, size_t n, bool *hold)
{
    pel_bit_reader_t r;
    pel_rx_event_t event = PEL_RX_NONE;

    pel_bit_reader_init(&r, message, n);
    pel_skip_bits(&r, 24);
    const uint32_t tow_ms = (uint32_t)pel_read_u(&r, 30);
    const bool more = pel_read_u(&r, 1) != 0u;
    const unsigned n_sat = (unsigned)pel_read_u(&r, 5);
    pel_skip_bits(&r, 4);
    if (HEADER_BITS + SAT_BITS * n_sat > r.n_bits) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    if (tow_ms >= 604800000u) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    if (rx->t_approx_ns == 0) {
        rx->counters.unknown++; /* nothing tells the week yet */
        return PEL_RX_NONE;
    }
    const pel_time_t t = pel_tow_ms_near(tow_ms, rx->t_approx_ns);
    if (!pel_rx_collect(rx, t, hold, &event)) { return event; }
    const bool skip = has_msm(rx, rx->t_gps_msm_ns, t);
    for (unsigned i = 0; i < n_sat; i++) { decode_sat(rx, &r, skip); }
    return more ? PEL_RX_NONE : pel_rx_deliver(rx);
}

pel_rx_event_t pel_rtcm3_1012(pel_receiver_t *rx, const uint8_t *message, size_t n, bool *hold)
{
    pel_bit_reader_t r;
    pel_rx_event_t event = PEL_RX_NONE;

    pel_bit_reader_init(&r, message, n);
    pel_skip_bits(&r, 24);
    const uint32_t ms_of_day = (uint32_t)pel_read_u(&r, 27);
    const bool more = pel_read_u(&r, 1) != 0u;
    const unsigned n_sat = (unsigned)pel_read_u(&r, 5);
    pel_skip_bits(&r, 4);
    if (GLO_HEADER_BITS + GLO_SAT_BITS * n_sat > r.n_bits) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    if (ms_of_day > 86400999u) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    if (!rx->collecting && rx->t_given_ns == 0) {
        rx->counters.unknown++; /* nothing tells the day yet */
        return PEL_RX_NONE;
    }
    const pel_time_t t = pel_glo_epoch_near(7, ms_of_day, rx->collecting ? rx->epoch.t_ns : rx->t_approx_ns);
    if (!pel_rx_collect(rx, t, hold, &event)) { return event; }
    const bool skip = has_msm(rx, rx->t_glo_msm_ns, t);
    for (unsigned i = 0; i < n_sat; i++) { decode_glonass_sat(rx, &r, skip); }
    return more ? PEL_RX_NONE : pel_rx_deliver(rx);
}

/* ---- encoder ------------------------------------------------------------------------------------------------------------------ */

static const pel_obs_t *find(const pel_epoch_t *e, int prn, pel_carrier_t carrier)
{
    for (int i = 0; i < (int)e->n; i++) {
        const pel_obs_t *const o = &e->obs[i];
        if (o->sys == PEL_SYS_GPS && o->prn == prn && o->carrier == (uint8_t)carrier && pel_obs_plausible(o)) {
            return o;
        }
    }
    return NULL;
}

/* Phase minus the (rounded) code of L1, in units, within half a block: at most 183 m of the 262 that fit. NO_PHASE if there is none. */
static int64_t phase_field(const pel_obs_t *o, double range_m)
{
    if (o == NULL || (o->flags & PEL_OBS_PHASE) == 0u) { return NO_PHASE; }
    const double lambda = wavelength(PEL_SYS_GPS, (pel_carrier_t)o->carrier, 0);
    const double cycles = o->L_cyc - range_m / lambda;
    const int64_t blocks = pel_round_i64(cycles / PHASE_BLOCK_CYC);
    return pel_round_i64((cycles - (double)blocks * PHASE_BLOCK_CYC) * lambda / PHASE_UNIT_M);
}

static uint32_t cn0_field(const pel_obs_t *o)
{
    const int64_t raw = pel_round_i64((double)o->cn0_dbhz * 4.0);
    return (uint32_t)((raw < 255) ? raw : 255);
}

static void encode_sat(pel_bit_writer_t *w, const pel_obs_t *o1, const pel_obs_t *o2)
{
    const int64_t whole_ms = (int64_t)(o1->P_m / MS_M);
    const int64_t range = pel_round_i64((o1->P_m - (double)whole_ms * MS_M) / CODE_UNIT_M);
    const double range_m = (double)range * CODE_UNIT_M + (double)whole_ms * MS_M;
    int64_t range_2 = NO_CODE_2;
    if (o2 != NULL && (o2->flags & PEL_OBS_CODE) != 0u) {
        const int64_t raw = pel_round_i64((o2->P_m - range_m) / CODE_UNIT_M);
        if (raw > NO_CODE_2 && raw < -NO_CODE_2) { range_2 = raw; }
    }
    pel_write_u(w, 6, o1->prn);
    pel_write_u(w, 1, (o1->code == 'C') ? 0u : 1u);
    pel_write_u(w, 24, (uint64_t)range);
    pel_write_s(w, 20, phase_field(o1, range_m));
    pel_write_u(w, 7, lock_indicator(o1->lock_ms));
    pel_write_u(w, 8, (uint64_t)whole_ms);
    pel_write_u(w, 8, cn0_field(o1));
    pel_write_u(w, 2, (o2 == NULL || o2->code == 'P') ? 1u : (o2->code == 'W') ? 3u : 0u);
    pel_write_s(w, 14, range_2);
    pel_write_s(w, 20, phase_field(o2, range_m));
    pel_write_u(w, 7, (o2 != NULL) ? lock_indicator(o2->lock_ms) : 0u);
    pel_write_u(w, 8, (o2 != NULL) ? cn0_field(o2) : 0u);
}

size_t pel_rtcm3_encode_1004(const pel_epoch_t *e, uint16_t station, bool more, uint8_t *out, size_t cap)
{
    pel_bit_writer_t w;
    unsigned n_sat = 0;

    if (cap < 14u || e->n > PEL_MAX_OBS || e->t_ns < 0 || station > 4095u) { return 0; }
    pel_bit_writer_init(&w, out + 3, ((cap < 1029u) ? cap : 1029u) - 6u);
    pel_write_u(&w, 12, 1004);
    pel_write_u(&w, 12, station);
    pel_write_u(&w, 30, (uint64_t)((e->t_ns + PEL_NS_PER_MS / 2) % PEL_NS_PER_WEEK / PEL_NS_PER_MS));
    pel_write_u(&w, 1, more ? 1u : 0u);
    pel_write_u(&w, 5, 0); /* the number of satellites, filled in below */
    pel_write_u(&w, 4, 0);
    for (int prn = 1; prn <= 32 && n_sat < 31u; prn++) {
        const pel_obs_t *const o1 = find(e, prn, PEL_CARRIER_L1);
        if (o1 == NULL || (o1->flags & PEL_OBS_CODE) == 0u) { continue; }
        encode_sat(&w, o1, find(e, prn, PEL_CARRIER_L2));
        n_sat++;
    }
    pel_bits_put(out + 3, 55, 5, n_sat);
    return (w.overrun || w.out_of_range) ? 0u : pel_rtcm3_seal(w.pos, out, cap);
}

#include "navmsg.h"

#include <string.h>

/* u-blox F9/X20 interface description, "GNSS identifiers" and "Signal identifiers". The first row of a carrier is what an
 * observation with another code letter on that carrier is sent as (RINEX W on L2 becomes L2 CL). */
typedef struct {
    uint8_t gnss_id, sig_id;
    uint8_t sys, carrier;
    char code;
} ubx_signal_t;

static const ubx_signal_t SIGNAL[] = {
    {0, 0, PEL_SYS_GPS, PEL_CARRIER_L1, 'C'},   {0, 3, PEL_SYS_GPS, PEL_CARRIER_L2, 'L'},
    {0, 4, PEL_SYS_GPS, PEL_CARRIER_L2, 'S'},   {0, 7, PEL_SYS_GPS, PEL_CARRIER_L5, 'Q'},
    {0, 6, PEL_SYS_GPS, PEL_CARRIER_L5, 'I'},   {1, 0, PEL_SYS_SBS, PEL_CARRIER_L1, 'C'},
    {2, 0, PEL_SYS_GAL, PEL_CARRIER_L1, 'C'},   {2, 1, PEL_SYS_GAL, PEL_CARRIER_L1, 'B'},
    {2, 4, PEL_SYS_GAL, PEL_CARRIER_L5, 'Q'},   {2, 3, PEL_SYS_GAL, PEL_CARRIER_L5, 'I'},
    {2, 6, PEL_SYS_GAL, PEL_CARRIER_E5B, 'Q'},  {2, 5, PEL_SYS_GAL, PEL_CARRIER_E5B, 'I'},
    {2, 9, PEL_SYS_GAL, PEL_CARRIER_E6, 'C'},   {2, 8, PEL_SYS_GAL, PEL_CARRIER_E6, 'B'},
    {2, 10, PEL_SYS_GAL, PEL_CARRIER_E6, 'A'},  {3, 0, PEL_SYS_BDS, PEL_CARRIER_B1I, 'I'},
    {3, 1, PEL_SYS_BDS, PEL_CARRIER_B1I, 'I'},  {3, 2, PEL_SYS_BDS, PEL_CARRIER_E5B, 'I'},
    {3, 3, PEL_SYS_BDS, PEL_CARRIER_E5B, 'I'},  {3, 4, PEL_SYS_BDS, PEL_CARRIER_B3I, 'I'},
    {3, 10, PEL_SYS_BDS, PEL_CARRIER_B3I, 'I'}, {3, 5, PEL_SYS_BDS, PEL_CARRIER_L1, 'P'},
    {3, 6, PEL_SYS_BDS, PEL_CARRIER_L1, 'D'},   {3, 7, PEL_SYS_BDS, PEL_CARRIER_L5, 'P'},
    {3, 8, PEL_SYS_BDS, PEL_CARRIER_L5, 'D'},   {5, 0, PEL_SYS_QZS, PEL_CARRIER_L1, 'C'},
    {5, 1, PEL_SYS_QZS, PEL_CARRIER_L1, 'Z'},   {5, 12, PEL_SYS_QZS, PEL_CARRIER_L1, 'B'},
    {5, 5, PEL_SYS_QZS, PEL_CARRIER_L2, 'L'},   {5, 4, PEL_SYS_QZS, PEL_CARRIER_L2, 'S'},
    {5, 9, PEL_SYS_QZS, PEL_CARRIER_L5, 'Q'},   {5, 8, PEL_SYS_QZS, PEL_CARRIER_L5, 'I'},
    {6, 0, PEL_SYS_GLO, PEL_CARRIER_L1, 'C'},   {6, 2, PEL_SYS_GLO, PEL_CARRIER_L2, 'C'},
};
#define N_SIGNAL (sizeof SIGNAL / sizeof SIGNAL[0])

/* trkStat */
#define PR_VALID          0x01u
#define CP_VALID          0x02u
#define HALF_CYC_RESOLVED 0x04u

#define CP_STDEV_INVALID 15u /* cpStdev, units of 0.004 cycles: this one says the phase means nothing */

static const ubx_signal_t *find_by_id(uint8_t gnss_id, uint8_t sig_id)
{
    for (size_t i = 0; i < N_SIGNAL; i++) {
        if (SIGNAL[i].gnss_id == gnss_id && SIGNAL[i].sig_id == sig_id) { return &SIGNAL[i]; }
    }
    return NULL;
}

static const ubx_signal_t *find_by_code(const pel_obs_t *o)
{
    const ubx_signal_t *best = NULL;
    for (size_t i = 0; i < N_SIGNAL; i++) {
        if (SIGNAL[i].sys != o->sys || SIGNAL[i].carrier != o->carrier) { continue; }
        if (SIGNAL[i].code == o->code) {
            best = &SIGNAL[i];
            break;
        }
        if (best == NULL) { best = &SIGNAL[i]; }
    }
    /* B1I, B2I, B3I of geostationary satellites carry D2 and have their own row, the next of the same carrier */
    if (best != NULL && o->sys == PEL_SYS_BDS && best->code == 'I' && pel_bds_is_geo(o->prn)) { best++; }
    return best;
}

/* svId of the message <-> prn here; 0 if there is none. */
static uint8_t prn_from_sv(uint8_t sys, uint8_t sv)
{
    const int prn = (sys == PEL_SYS_SBS) ? (int)sv - 119 : (int)sv;
    return (prn >= 1 && prn <= pel_sys_max_prn((pel_sys_t)sys)) ? (uint8_t)prn : 0;
}

static bool decode_signal(const uint8_t *m, pel_obs_t *o)
{
    const uint8_t trk = m[30];
    const ubx_signal_t *const s = find_by_id(m[20], m[22]);

    memset(o, 0, sizeof *o);
    if (s == NULL) { return false; }
    o->sys = s->sys;
    o->carrier = s->carrier;
    o->code = s->code;
    o->prn = prn_from_sv(s->sys, m[21]);
    o->glo_k = (s->sys == PEL_SYS_GLO) ? (int8_t)((int)m[23] - 7) : (int8_t)0;
    o->D_hz = pel_le_f32(m + 16);
    o->lock_ms = (uint32_t)pel_le_u(m + 24, 2);
    o->cn0_dbhz = (float)m[26];
    /* The message has no flag for a missing Doppler; exactly zero (of either sign, and not NaN, which is refused later) is
     * what encoders of files without Doppler write. */
    o->flags = ((pel_le_u(m + 16, 4) & 0x7FFFFFFFu) != 0u) ? PEL_OBS_DOPPLER : 0u;
    if ((trk & PR_VALID) != 0u) {
        o->P_m = pel_le_f64(m);
        o->flags |= PEL_OBS_CODE;
    }
    if ((trk & CP_VALID) != 0u && (m[28] & 0x0Fu) != CP_STDEV_INVALID) {
        o->L_cyc = pel_le_f64(m + 8);
        o->flags |= PEL_OBS_PHASE;
        if ((trk & HALF_CYC_RESOLVED) == 0u) { o->flags |= PEL_OBS_HALF_CYCLE; }
    }
    return o->prn != 0u;
}

/* After this long without an MSM of GPS, RAWX counts again. */
#define MSM_GONE_NS (60 * PEL_NS_PER_S)

pel_rx_event_t pel_ubx_rawx(pel_receiver_t *rx, const uint8_t *payload, size_t n, bool *hold)
{
    const double tow_s = pel_le_f64(payload);
    const int32_t week = (int32_t)pel_le_u(payload + 8, 2);
    const unsigned n_meas = payload[11];

    if (n != 16u + 32u * n_meas) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    if (!pel_week_possible(week, tow_s)) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    const pel_time_t t = pel_time_from_week(week, tow_s);
    if (rx->t_gps_msm_ns != 0 && t - rx->t_gps_msm_ns < MSM_GONE_NS && t > rx->t_gps_msm_ns - MSM_GONE_NS) {
        /* A base that sends both: its phases have other integers in each, and a stream must not change between them. The
         * shorter RTCM messages survive a bad line better. */
        rx->counters.duplicate++;
        return PEL_RX_NONE;
    }
    if (rx->collecting && t <= rx->epoch.t_ns + PEL_SAME_EPOCH_NS && t >= rx->epoch.t_ns - PEL_SAME_EPOCH_NS) {
        /* the same epoch is arriving through RTCM as well: this one is complete, take it instead */
        rx->collecting = false;
        rx->counters.duplicate++;
    }
    pel_rx_event_t event;
    if (!pel_rx_collect(rx, t, hold, &event)) { return event; }

    rx->epoch.clock_reset = (payload[12] & 0x02u) != 0u;
    for (unsigned i = 0; i < n_meas; i++) {
        pel_obs_t o;
        if (!decode_signal(payload + 16u + 32u * i, &o)) {
            rx->counters.bad_value++;
        } else if ((o.flags & (PEL_OBS_CODE | PEL_OBS_PHASE)) != 0u) {
            pel_rx_add(rx, &o);
        }
    }
    return pel_rx_deliver(rx);
}

static bool encode_signal(const pel_obs_t *o, uint8_t *m)
{
    const ubx_signal_t *const s = find_by_code(o);
    if (s == NULL || !pel_obs_plausible(o)) { return false; }

    memset(m, 0, 32);
    pel_le_put_f64(m, ((o->flags & PEL_OBS_CODE) != 0u) ? o->P_m : 0.0);
    pel_le_put_f64(m + 8, ((o->flags & PEL_OBS_PHASE) != 0u) ? o->L_cyc : 0.0);
    pel_le_put_f32(m + 16, ((o->flags & PEL_OBS_DOPPLER) != 0u) ? o->D_hz : 0.0f);
    m[20] = s->gnss_id;
    m[21] = (uint8_t)(o->prn + ((o->sys == PEL_SYS_SBS) ? 119 : 0));
    m[22] = s->sig_id;
    m[23] = (o->sys == PEL_SYS_GLO) ? (uint8_t)(o->glo_k + 7) : 0;
    pel_le_put(m + 24, 2, (o->lock_ms < 65535u) ? o->lock_ms : 65535u);
    m[26] = (uint8_t)pel_round_i64((double)o->cn0_dbhz);
    m[27] = 5; /* prStdev 0.01 * 2^5 = 0.32 m */
    m[28] = 1; /* cpStdev 0.004 cycles */
    m[29] = 6; /* doStdev 0.002 * 2^6 = 0.128 Hz */
    if ((o->flags & PEL_OBS_CODE) != 0u) { m[30] |= PR_VALID; }
    if ((o->flags & PEL_OBS_PHASE) != 0u) {
        m[30] |= CP_VALID;
        if ((o->flags & PEL_OBS_HALF_CYCLE) == 0u) { m[30] |= HALF_CYC_RESOLVED; }
    }
    return true;
}

size_t pel_ubx_encode_rawx(const pel_epoch_t *e, int leap_s, uint8_t *out, size_t cap)
{
    uint8_t *const payload = out + 6;
    size_t n = 0;

    if (cap < 24u || e->n > PEL_MAX_OBS || e->t_ns < 0) { return 0; }
    memset(payload, 0, 16);
    pel_le_put_f64(payload, pel_time_tow_s(e->t_ns));
    pel_le_put(payload + 8, 2, (uint64_t)pel_time_week(e->t_ns));
    payload[10] = (uint8_t)(int8_t)leap_s;
    payload[12] = (uint8_t)(0x01u | (e->clock_reset ? 0x02u : 0u));
    payload[13] = 1; /* version */
    for (size_t i = 0; i < e->n; i++) {
        if (cap < 8u + 16u + 32u * (n + 1u)) { return 0; }
        if (encode_signal(&e->obs[i], payload + 16u + 32u * n)) { n++; }
    }
    payload[11] = (uint8_t)n;
    return pel_ubx_seal(0x02, 0x15, 16u + 32u * n, out, cap);
}

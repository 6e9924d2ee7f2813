#include "framing.h"

#include <string.h>

void pel_receiver_init(pel_receiver_t *rx)
{
    memset(rx, 0, sizeof *rx);
}

void pel_receiver_set_time(pel_receiver_t *rx, pel_time_t t)
{
    rx->t_approx_ns = t;
}

pel_time_t pel_rx_reference(const pel_receiver_t *rx)
{
    return (rx->t_approx_ns != 0) ? rx->t_approx_ns : pel_time_from_week(2048 + 512, 0.0);
}

static pel_probe_t probe(const uint8_t *p, size_t n, size_t *length)
{
    switch (p[0]) {
    case 0xB5: return pel_ubx_probe(p, n, length);
    case 0xD3: return pel_rtcm3_probe(p, n, length);
    case '$': return pel_nmea_probe(p, n, length);
    default: return PEL_PROBE_NOISE;
    }
}

/* Takes at most one frame out of the buffer. */
static pel_rx_event_t take_frame(pel_receiver_t *rx, bool final, bool *found)
{
    size_t length = 0;
    bool hold = false;
    pel_rx_event_t event = PEL_RX_NONE;

    *found = pel_frame_next(rx->buf, &rx->fill, &rx->counters, probe, final, &length);
    if (!*found) { return PEL_RX_NONE; }
    if (rx->buf[0] == 0xB5) {
        event = pel_ubx_handle(rx, rx->buf, length, &hold);
    } else if (rx->buf[0] == 0xD3) {
        event = pel_rtcm3_handle(rx, rx->buf, length, &hold);
    } else {
        rx->counters.unknown++;
    }
    if (!hold) { pel_frame_drop(rx->buf, &rx->fill, length); }
    return event;
}

pel_rx_event_t pel_receiver_push(pel_receiver_t *rx, uint8_t byte)
{
    bool found;
    if (rx->epoch.n > PEL_MAX_OBS) { rx->epoch.n = 0; } /* memory has changed by itself */
    pel_frame_append(rx->buf, sizeof rx->buf, &rx->fill, &rx->counters, byte);
    return take_frame(rx, false, &found);
}

pel_rx_event_t pel_receiver_flush(pel_receiver_t *rx)
{
    bool found = true;
    while (found) { /* each turn shortens the buffer, or holds a frame once and then gives an event */
        const pel_rx_event_t event = take_frame(rx, true, &found);
        if (event != PEL_RX_NONE) { return event; }
    }
    return rx->collecting ? pel_rx_deliver(rx) : PEL_RX_NONE;
}

bool pel_rx_collect(pel_receiver_t *rx, pel_time_t t, bool *hold, pel_rx_event_t *event)
{
    *event = PEL_RX_NONE;
    if (rx->collecting && t > rx->epoch.t_ns + PEL_SAME_EPOCH_NS) {
        /* the last message of the epoch before was lost */
        *event = pel_rx_deliver(rx);
        *hold = (*event != PEL_RX_NONE);
        if (*hold) { return false; }
    }
    if (rx->collecting) {
        if (t >= rx->epoch.t_ns - PEL_SAME_EPOCH_NS) { return true; }
        rx->counters.time_back++;
        return false;
    }
    if (pel_time_order(t, PEL_SAME_EPOCH_NS, rx->t_given_ns, &rx->t_back_ns, &rx->n_back, &rx->counters) !=
        PEL_ORDER_NEW) {
        return false;
    }
    rx->collecting = true;
    rx->epoch.t_ns = t;
    rx->epoch.n = 0;
    rx->epoch.dropped = 0;
    rx->epoch.clock_reset = false;
    return true;
}

pel_rx_event_t pel_rx_deliver(pel_receiver_t *rx)
{
    rx->collecting = false;
    if (rx->epoch.n == 0u) { return PEL_RX_NONE; }
    rx->t_given_ns = rx->epoch.t_ns;
    rx->t_approx_ns = rx->epoch.t_ns;
    return PEL_RX_EPOCH;
}

void pel_rx_learn_channel(pel_receiver_t *rx, unsigned slot, int k)
{
    if (slot >= 1u && slot < sizeof rx->glo_channel && k >= -7 && k <= 6) { rx->glo_channel[slot] = (uint8_t)(k + 8); }
}

bool pel_rx_channel(const pel_receiver_t *rx, unsigned slot, int8_t *k)
{
    if (slot >= sizeof rx->glo_channel || rx->glo_channel[slot] == 0u) { return false; }
    *k = (int8_t)(rx->glo_channel[slot] - 8);
    return true;
}

bool pel_obs_plausible(const pel_obs_t *o)
{
    const bool code_ok = o->P_m >= 1e6 && o->P_m <= 1e8; /* false for NaN */
    const bool phase_ok = o->L_cyc >= -1e10 && o->L_cyc <= 1e10;
    const bool doppler_ok = o->D_hz >= -1e5f && o->D_hz <= 1e5f;
    if (o->prn < 1 || o->prn > pel_sys_max_prn((pel_sys_t)o->sys)) { return false; } /* 0 of a system that is none */
    if (pel_carrier_hz((pel_sys_t)o->sys, (pel_carrier_t)o->carrier, o->glo_k) == 0.0) { return false; }
    if ((o->flags & PEL_OBS_CODE) != 0u && !code_ok) { return false; }
    if ((o->flags & PEL_OBS_PHASE) != 0u && !phase_ok) { return false; }
    if ((o->flags & PEL_OBS_DOPPLER) != 0u && !doppler_ok) { return false; }
    return o->cn0_dbhz >= 0.0f && o->cn0_dbhz <= 100.0f;
}

/* Of two codes on one carrier the earlier in this list is kept: civil data and pilot codes before the codes that many
 * receivers do not track (GPS P, W), so that rover and base agree more often. */
static int code_rank(char code)
{
    static const char ORDER[] = "CLQIXPSWDBZAYMN";
    int i = 0;
    while (ORDER[i] != '\0' && ORDER[i] != code) { i++; }
    return i;
}

void pel_rx_add(pel_receiver_t *rx, const pel_obs_t *o)
{
    pel_epoch_t *const e = &rx->epoch;
    if (!pel_obs_plausible(o)) {
        rx->counters.bad_value++;
        return;
    }
    for (int i = 0; i < (int)e->n; i++) {
        pel_obs_t *const old = &e->obs[i];
        if (old->sys == o->sys && old->prn == o->prn && old->carrier == o->carrier) {
            rx->counters.duplicate++;
            if (code_rank(o->code) < code_rank(old->code)) { *old = *o; }
            return;
        }
    }
    if (e->n >= PEL_MAX_OBS) {
        e->dropped++;
        rx->counters.overflow++;
        return;
    }
    e->obs[e->n] = *o;
    e->n++;
}

#include "support_wire.h"

#include <string.h>

#include "../../../firmware/src/wire/framing.h"

static const struct {
    uint8_t carrier[2];
    char code[2];
} PAIR[PEL_N_SYS] = {
    [PEL_SYS_GPS] = {{PEL_CARRIER_L1, PEL_CARRIER_L2}, {'C', 'L'}},
    [PEL_SYS_GLO] = {{PEL_CARRIER_L1, PEL_CARRIER_L2}, {'C', 'C'}},
    [PEL_SYS_GAL] = {{PEL_CARRIER_L1, PEL_CARRIER_E5B}, {'C', 'Q'}},
    [PEL_SYS_BDS] = {{PEL_CARRIER_B1I, PEL_CARRIER_B3I}, {'I', 'I'}},
    [PEL_SYS_QZS] = {{PEL_CARRIER_L1, PEL_CARRIER_L5}, {'C', 'Q'}},
    [PEL_SYS_SBS] = {{PEL_CARRIER_L1, PEL_CARRIER_L5}, {'C', 'I'}},
};

void support_append(pel_epoch_t *e, pel_sys_t sys, int n)
{
    for (int i = 0; i < 2 * n && e->n < PEL_MAX_OBS; i++) {
        pel_obs_t *o = &e->obs[e->n++];
        memset(o, 0, sizeof *o);
        o->sys = (uint8_t)sys;
        o->prn = (uint8_t)(i / 2 + 1);
        o->carrier = PAIR[sys].carrier[i % 2];
        o->code = PAIR[sys].code[i % 2];
        o->glo_k = (int8_t)((sys == PEL_SYS_GLO) ? (i / 2) % 14 - 7 : 0);
        o->P_m = 20.2e6 + 123456.789 * (i / 2) + 3.21 * (i % 2) + 1e5 * (double)sys;
        const double lambda = PEL_SPEED_OF_LIGHT / pel_carrier_hz(sys, (pel_carrier_t)o->carrier, o->glo_k);
        o->L_cyc = (o->P_m + 0.123 * i) / lambda;
        o->D_hz = (float)(-(480.0 - 31.25 * (i / 2) + 0.3 * (i % 2)) / lambda);
        o->cn0_dbhz = (float)(35 + i % 16);
        o->lock_ms = (uint32_t)(1000 * i);
        o->flags = PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER;
    }
}

void support_epoch(pel_epoch_t *e, pel_time_t t, pel_sys_t sys, int n)
{
    memset(e, 0, sizeof *e);
    e->t_ns = t;
    support_append(e, sys, n);
}

void support_ephemeris(pel_ephemeris_t *e, pel_sys_t sys, int prn)
{
    const double s = 0.001 * prn;
    const pel_ephemeris_t base = {
        .sys = (uint8_t)sys,
        .prn = (uint8_t)prn,
        .iode = 17,
        .iodc = 17,
        .sd_ura_m = 2.8f,
        .toe_ns = T0 + 7200 * PEL_NS_PER_S,
        .toc_ns = T0 + 7200 * PEL_NS_PER_S,
        .af0 = 1.5e-4 + s * 1e-5,
        .af1 = -2.2e-12,
        .af2 = 0.0,
        .sqrt_a = (sys == PEL_SYS_GAL) ? 5440.6 : 5153.7 + s,
        .e = 0.0123 + s,
        .i0 = 0.96,
        .Omega0 = -2.9 + s,
        .omega = 2.1,
        .M0 = -1.234567 + s,
        .dn = 4.5e-9,
        .Omega_dot = -8.1e-9,
        .idot = -3.3e-10,
        .cuc = 1.1e-6,
        .cus = 7.7e-6,
        .crc = 231.5,
        .crs = -45.25,
        .cic = -9e-8,
        .cis = 5.5e-8,
        .tgd_s = {-4.6566128730773926e-9, 0.0},
    };
    *e = base;
    if (sys == PEL_SYS_BDS) {
        e->toe_ns += 14 * PEL_NS_PER_S;
        e->toc_ns += 14 * PEL_NS_PER_S;
        e->tgd_s[0] = 1.3e-8;
        e->tgd_s[1] = -2.1e-9;
    }
    if (sys == PEL_SYS_GAL) { e->tgd_s[1] = -4.6566128730773926e-9; }
}

int support_push(pel_receiver_t *rx, const uint8_t *p, size_t n, pel_rx_event_t kind)
{
    int count = 0;
    for (size_t i = 0; i < n; i++) { count += (pel_receiver_push(rx, p[i]) == kind) ? 1 : 0; }
    return count;
}

int support_push_all(pel_receiver_t *rx, const uint8_t *p, size_t n, pel_rx_event_t kind)
{
    int count = support_push(rx, p, n, kind);
    for (;;) {
        const pel_rx_event_t event = pel_receiver_flush(rx);
        if (event == PEL_RX_NONE) { return count; }
        count += (event == kind) ? 1 : 0;
    }
}

static uint32_t seed = 2463534242u;
uint32_t support_random(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 17;
    seed ^= seed << 5;
    return seed;
}

int support_push_rtcm3(pel_receiver_t *rx, uint8_t *frame, size_t n_bits, pel_rx_event_t kind)
{
    return support_push(rx, frame, pel_rtcm3_seal(n_bits, frame, PEL_MAX_FRAME_BYTES), kind);
}

void support_push_msm7(pel_receiver_t *rx, pel_time_t t, pel_sys_t sys, bool more)
{
    static pel_epoch_t epoch;
    static uint8_t frame[PEL_MAX_FRAME_BYTES];
    support_epoch(&epoch, t, sys, 2);
    (void)support_push(rx, frame, pel_rtcm3_encode_msm(&epoch, sys, 7, 1, more, frame, sizeof frame), PEL_RX_EPOCH);
}

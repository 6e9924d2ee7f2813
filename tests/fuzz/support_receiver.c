/* support_receiver.c - receiver streams: framing of payloads, and what must hold of everything a decoder gives. */
#include <math.h>
#include <string.h>

#include "fuzz.h"
#include "pelorus/bits.h"
#include "pelorus/gnss.h"
#include "pelorus/math.h"

static pel_receiver_t receiver;
static pel_orbits_t orbits;
static uint8_t frame[PEL_MAX_FRAME_BYTES + 64];

/* ---- what comes out ----------------------------------------------------------------------------------------------- */

/* Encoders take what decoders give: nothing that was accepted may break them, and no frame exceeds its buffer. */
static void check_encoders(const pel_epoch_t *e)
{
    FUZZ_CHECK(pel_ubx_encode_rawx(e, 18, frame, sizeof frame) <= sizeof frame);
    FUZZ_CHECK(pel_rtcm3_encode_1004(e, 1, false, frame, sizeof frame) <= 1029);
    for (int sys = 0; sys < PEL_N_SYS; sys++) {
        for (int msm = 4; msm <= 7; msm++) {
            FUZZ_CHECK(pel_rtcm3_encode_msm(e, (pel_sys_t)sys, msm, 1, false, frame, sizeof frame) <= 1029);
        }
    }
}

static void check_epoch(const pel_epoch_t *e)
{
    FUZZ_CHECK(e->n >= 1 && e->n <= PEL_MAX_OBS);
    for (int i = 0; i < e->n; i++) {
        const pel_obs_t *o = &e->obs[i];
        FUZZ_CHECK(o->sys < PEL_N_SYS && o->carrier < PEL_N_CARRIER);
        FUZZ_CHECK(o->prn >= 1 && o->prn <= pel_sys_max_prn((pel_sys_t)o->sys));
        FUZZ_CHECK(pel_obs_lambda_m(o) > 0.1 && pel_obs_lambda_m(o) < 0.3);
        FUZZ_CHECK((o->flags & PEL_OBS_CODE) == 0 || (o->P_m >= 1e6 && o->P_m <= 1e8));
        FUZZ_CHECK((o->flags & PEL_OBS_PHASE) == 0 || fabs(o->L_cyc) <= 1e10);
        FUZZ_CHECK((o->flags & PEL_OBS_DOPPLER) == 0 || fabsf(o->D_hz) <= 1e5f);
        for (int j = 0; j < i; j++) {
            FUZZ_CHECK(o->sys != e->obs[j].sys || o->prn != e->obs[j].prn || o->carrier != e->obs[j].carrier);
        }
    }
    check_encoders(e);
}

/* An orbit that was accepted gives a position, or says that it does not; what it gives is finite. */
static void check_ephemeris(const pel_ephemeris_t *eph)
{
    pel_sat_state_t s;
    FUZZ_CHECK(eph->sys < PEL_N_SYS && eph->prn >= 1 && eph->prn <= pel_sys_max_prn((pel_sys_t)eph->sys));
    FUZZ_CHECK(eph->toe_ns > -PEL_NS_PER_WEEK && eph->toc_ns > -PEL_NS_PER_WEEK);
    (void)pel_orbits_add(&orbits, eph);
    FUZZ_CHECK(orbits.n <= PEL_MAX_EPH);
    const pel_ephemeris_t *kept = pel_orbits_find(&orbits, eph->sys, eph->prn, eph->toe_ns);
    if (kept != NULL && pel_sat_state(kept, kept->toe_ns, 600.0, &s) == PEL_OK) {
        for (int k = 0; k < 3; k++) { FUZZ_CHECK(isfinite(s.r_e[k]) && isfinite(s.v_e[k])); }
        FUZZ_CHECK(isfinite(s.clk_s) && isfinite(s.clk_rate));
    }
    for (int part = 0; part <= 11; part++) {
        FUZZ_CHECK(pel_ubx_encode_sfrbx_eph(eph, part, eph->toe_ns, frame, sizeof frame) <= sizeof frame);
    }
    FUZZ_CHECK(pel_rtcm3_encode_ephemeris(eph, frame, sizeof frame) <= 1029);
}

static void check_event(const pel_receiver_t *rx, pel_rx_event_t event)
{
    const pel_pvt_t *p = &rx->pvt;
    switch (event) {
    case PEL_RX_NONE: break;
    case PEL_RX_EPOCH: check_epoch(&rx->epoch); break;
    case PEL_RX_EPHEMERIS: check_ephemeris(&rx->ephemeris); break;
    case PEL_RX_KLOBUCHAR:
        for (int i = 0; i < 4; i++) { FUZZ_CHECK(isfinite(rx->klobuchar.alpha[i]) && isfinite(rx->klobuchar.beta[i])); }
        break;
    case PEL_RX_STATION: FUZZ_CHECK(pel_norm3(rx->station.r_ea_e) < 7.1e6); break;
    case PEL_RX_PVT:
        FUZZ_CHECK(fabs(p->lat_rad) < 1.6 && fabs(p->lon_rad) < 3.2 && isfinite(p->height_m));
        FUZZ_CHECK(p->t_ns > 0);
        FUZZ_CHECK(pel_ubx_encode_pvt(p, frame, sizeof frame) <= sizeof frame);
        break;
    }
}

void fuzz_receiver_bytes(pel_receiver_t *rx, const uint8_t *p, size_t n, bool flush)
{
    for (size_t i = 0; i < n; i++) {
        const pel_wire_counters_t before = rx->counters;
        check_event(rx, pel_receiver_push(rx, p[i]));
        FUZZ_CHECK(fuzz_counters_grew(&before, &rx->counters, sizeof before));
    }
    if (!flush) { return; }
    pel_rx_event_t event = pel_receiver_flush(rx);
    for (size_t i = 0; event != PEL_RX_NONE; i++) {
        FUZZ_CHECK(i <= sizeof rx->buf);
        check_event(rx, event);
        event = pel_receiver_flush(rx);
    }
}

/* ---- payloads ------------------------------------------------------------------------------------------------------ */

/* The first byte of the input may tell the time; then records of a length and that many bytes. */
static void begin(fuzz_input_t *in)
{
    pel_receiver_init(&receiver);
    pel_orbits_init(&orbits);
    if ((fuzz_u8(in) & 1u) != 0u) { pel_receiver_set_time(&receiver, INT64_C(2300) * PEL_NS_PER_WEEK); }
}

/* Lengths are in units of four bytes, so that an epoch of 30 signals fits a length byte. */
static size_t take_payload(fuzz_input_t *in, uint8_t *out)
{
    size_t n = 4u * (size_t)fuzz_u8(in);
    if (n > in->left) { n = in->left; }
    if (n > 0) { memcpy(out, in->at, n); }
    in->at += n;
    in->left -= n;
    return n;
}

void fuzz_ubx_payloads(fuzz_input_t in, uint8_t cls, uint8_t id)
{
    begin(&in);
    while (in.left > 0) {
        const size_t n = take_payload(&in, frame + 6);
        const uint8_t head[4] = {0xB5, 0x62, cls, id};
        memcpy(frame, head, sizeof head);
        pel_le_put(frame + 4, 2, n);
        fuzz_repair_frames(frame, n + 8u);
        uint8_t copy[1100];
        memcpy(copy, frame, n + 8u);
        fuzz_receiver_bytes(&receiver, copy, n + 8u, in.left == 0);
    }
}

void fuzz_rtcm3_payloads(fuzz_input_t in, const uint16_t *numbers, unsigned n_numbers)
{
    begin(&in);
    while (in.left > 0) {
        size_t n = take_payload(&in, frame + 3);
        if (n < 4u) { continue; }
        if (n > 1020u) { n = 1020u; }
        const unsigned number = numbers[pel_bits_u(frame + 3, 0, 12) % n_numbers];
        pel_bits_put(frame + 3, 0, 12, number);
        frame[0] = 0xD3;
        frame[1] = (uint8_t)(n >> 8);
        frame[2] = (uint8_t)n;
        fuzz_repair_frames(frame, n + 6u);
        uint8_t copy[1100];
        memcpy(copy, frame, n + 6u);
        fuzz_receiver_bytes(&receiver, copy, n + 6u, in.left == 0);
    }
}

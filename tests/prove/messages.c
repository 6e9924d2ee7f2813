/* Proofs of the message decoders of wire/: payloads of any bytes, receivers in any state. */
#include "msm.h"
#include "navmsg.h"

#include "prove.h"

/* Any receiver that could have come about, with what its own functions keep true of it. */
static void any_receiver(pel_receiver_t *rx)
{
    assume(rx->epoch.n <= PEL_MAX_OBS && rx->fill <= sizeof rx->buf && rx->n_back < PEL_WIRE_RESTART);
    assume(rx->t_approx_ns >= 0 && rx->t_approx_ns < PEL_TIME_LAST && rx->epoch.t_ns >= 0 &&
           rx->epoch.t_ns < PEL_TIME_LAST);
    assume(rx->t_given_ns >= 0 && rx->t_given_ns < PEL_TIME_LAST && rx->t_back_ns >= 0 &&
           rx->t_back_ns < PEL_TIME_LAST);
    assume(rx->t_gps_msm_ns >= 0 && rx->t_gps_msm_ns < PEL_TIME_LAST);
    assume(rx->t_glo_msm_ns >= 0 && rx->t_glo_msm_ns < PEL_TIME_LAST);
}

#define HOLDS(rx) ((rx).epoch.n <= PEL_MAX_OBS && (rx).fill <= sizeof(rx).buf)

/* PROVE rx_add: an observation of any numbers enters an epoch of any filling, and never beyond its end
 * sources wire/receiver.c base/signals.c
 * flags --any-floats --unwind 18 -DPEL_MAX_OBS=8 -DPEL_NAV_SLOTS=4
 * plant wire/receiver.c: if (e->n >= PEL_MAX_OBS) { => if (e->n > PEL_MAX_OBS) { */
void rx_add(void)
{
    pel_receiver_t rx;
    pel_obs_t o;
    any_receiver(&rx);
    pel_rx_add(&rx, &o);
    claim(HOLDS(rx));
}

/* PROVE rx_channel: GLONASS slots of any number
 * sources wire/receiver.c base/signals.c
 * flags --unwind 35 -DPEL_MAX_OBS=8 -DPEL_NAV_SLOTS=4
 * quick
 * plant wire/receiver.c: slot >= 1u && slot < sizeof rx->glo_channel => slot >= 1u && slot <= sizeof rx->glo_channel */
void rx_channel(void)
{
    pel_receiver_t rx;
    int8_t k = 0;
    any_receiver(&rx);
    for (int i = 0; i < 33; i++) { rx.glo_channel[i] = 0; }
    pel_rx_learn_channel(&rx, any_u32(), any_int());
    claim(!pel_rx_channel(&rx, any_u32(), &k) || (k >= -7 && k <= 6));
}

/* PROVE ubx_pvt: a receiver's own solution of any bytes; what is given has possible numbers
 * sources wire/ubx_pvt.c wire/framing.c base/bits.c base/time.c
 * flags --any-floats --unwind 93 -DPEL_MAX_OBS=8 -DPEL_NAV_SLOTS=4
 * plant wire/ubx_pvt.c: pel_le_u(m + 68, 4) => pel_le_u(m + 81, 4) */
void ubx_pvt(void)
{
    pel_receiver_t rx;
    uint8_t m[84];
    any_bytes(m, sizeof m);
    any_receiver(&rx);
    (void)pel_ubx_pvt(&rx, m, sizeof m);
}

/* PROVE rtcm3_dispatch: any number and any length: what the observations that are skipped still tell is read inside them
 * sources wire/rtcm3.c wire/bitio.c base/bits.c
 * flags --any-floats --unwind 40 -DPEL_MAX_OBS=8 -DPEL_NAV_SLOTS=4
 * plant wire/rtcm3.c: if (8u * n <= at) { return PEL_RX_NONE; } => (void)n; */
void rtcm3_dispatch(void)
{
    pel_receiver_t rx;
    bool hold = false;
    const size_t n = any_size();
    assume(n >= 6 && n <= 27);
    uint8_t frame[n];
    any_bytes(frame, n);
    any_receiver(&rx);
    (void)pel_rtcm3_handle(&rx, frame, n, &hold);
}

/* PROVE msm_tables: kinds, signals and codes of any number
 * sources wire/msm_tables.c
 * flags --unwind 70 -DPEL_MAX_OBS=8 -DPEL_NAV_SLOTS=4
 * plant wire/msm_tables.c: (msm >= 4 && msm <= 7) => (msm >= 4 && msm <= 8) */
void msm_tables(void)
{
    uint8_t carrier = 0;
    char code = 0;
    const pel_msm_kind_t *k = pel_msm_kind(any_int());
    if (k != NULL) { claim(k->code_bits <= 20 && k->phase_bits <= 24); }
    if (pel_msm_signal((pel_sys_t)any_u32(), any_int(), &carrier, &code)) { claim(carrier < PEL_N_CARRIER); }
    const int id = pel_msm_id((pel_sys_t)any_u32(), any_u8(), (char)any_u8());
    claim(id >= 0 && id <= 32);
}

/* PROVE msm_lock: lock indicators of any value, and the indicator of any time promises no more than it
 * sources wire/msm_tables.c
 * flags --unwind 12 -DPEL_MAX_OBS=8 -DPEL_NAV_SLOTS=4
 * quick
 * plant wire/msm_tables.c: if (indicator > 704u) { return 0; } => (void)bits; */
void msm_lock(void)
{
    const uint32_t indicator = any_u32(), ms = any_u32();
    assume(indicator <= 1023);
    claim(indicator <= 704 || pel_msm_lock_ms(10, indicator) == 0);
    claim(pel_msm_lock_ms(4, indicator & 15u) <= UINT32_C(1) << 19);
    claim(pel_msm_lock_ms(10, pel_msm_lock_indicator(10, ms)) <= ms);
    claim(pel_msm_lock_ms(4, pel_msm_lock_indicator(4, ms)) <= ms);
}

/* PROVE glo_parity: a string of any bits against its Hamming code
 * sources wire/glonass.c base/bits.c
 * flags --unwind 90 -DPEL_MAX_OBS=8 -DPEL_NAV_SLOTS=4
 * plant base/bits.c: p[i >> 3] >> (left - take) => p[(i >> 3) + 1] >> (left - take) */
void glo_parity(void)
{
    uint8_t string[PEL_GLO_BYTES];
    any_bytes(string, sizeof string);
    (void)pel_glo_string_good(string);
}

/* INSTEAD pel_rtcm3_msm: up to 64 cells of fields at positions that depend on three masks: the formula outgrows the solver | rtcm3_msm */
/* INSTEAD pel_ubx_rawx, pel_ubx_sfrbx: records and slots at positions of the message's own choosing, into the receiver's whole state | ubx_rawx, ubx_sfrbx */
/* INSTEAD pel_rtcm3_ephemeris, pel_rtcm3_1004, pel_rtcm3_1012: their reads go through the cursor that is proved; what makes the formula long is the scaling of every field to double | rtcm3_ephemeris, rtcm3_legacy */

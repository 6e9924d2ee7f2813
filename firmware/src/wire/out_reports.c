/* out_reports.c - layouts of the counters and of "asked and used"; docs/FORMATS.md numbers every byte. */
#include "framing.h"

#define N_NAV_COUNTERS  36u
#define N_WIRE_COUNTERS 10u
_Static_assert(sizeof(pel_nav_counters_t) == 4u * N_NAV_COUNTERS, "a counter is missing below and in docs/FORMATS.md");
_Static_assert(sizeof(pel_wire_counters_t) == 4u * N_WIRE_COUNTERS,
               "a counter is missing below and in docs/FORMATS.md");

static const pel_member_t NAV_COUNTERS[] = {
    PEL_MEMBER(pel_nav_counters_t, epochs_used),        PEL_MEMBER(pel_nav_counters_t, epochs_late),
    PEL_MEMBER(pel_nav_counters_t, epochs_no_eph),      PEL_MEMBER(pel_nav_counters_t, epochs_few_sats),
    PEL_MEMBER(pel_nav_counters_t, epochs_unpaired),    PEL_MEMBER(pel_nav_counters_t, epochs_spp_failed),
    PEL_MEMBER(pel_nav_counters_t, imu_used),           PEL_MEMBER(pel_nav_counters_t, imu_gap),
    PEL_MEMBER(pel_nav_counters_t, imu_out_of_order),   PEL_MEMBER(pel_nav_counters_t, imu_bad_value),
    PEL_MEMBER(pel_nav_counters_t, rows_used),          PEL_MEMBER(pel_nav_counters_t, rows_gated),
    PEL_MEMBER(pel_nav_counters_t, sats_no_eph),        PEL_MEMBER(pel_nav_counters_t, sats_unhealthy),
    PEL_MEMBER(pel_nav_counters_t, sats_low),           PEL_MEMBER(pel_nav_counters_t, sats_excluded),
    PEL_MEMBER(pel_nav_counters_t, slip_lock),          PEL_MEMBER(pel_nav_counters_t, slip_half_cycle),
    PEL_MEMBER(pel_nav_counters_t, slip_geometry_free), PEL_MEMBER(pel_nav_counters_t, slip_doppler),
    PEL_MEMBER(pel_nav_counters_t, slip_ins),           PEL_MEMBER(pel_nav_counters_t, clock_jumps),
    PEL_MEMBER(pel_nav_counters_t, fix_tried),          PEL_MEMBER(pel_nav_counters_t, fix_ok),
    PEL_MEMBER(pel_nav_counters_t, fix_ratio),          PEL_MEMBER(pel_nav_counters_t, fix_chi2),
    PEL_MEMBER(pel_nav_counters_t, fix_band),           PEL_MEMBER(pel_nav_counters_t, fix_prior),
    PEL_MEMBER(pel_nav_counters_t, fix_success),        PEL_MEMBER(pel_nav_counters_t, fix_budget),
    PEL_MEMBER(pel_nav_counters_t, restarts),           PEL_MEMBER(pel_nav_counters_t, numeric_faults),
    PEL_MEMBER(pel_nav_counters_t, coast_epochs),       PEL_MEMBER(pel_nav_counters_t, events),
    PEL_MEMBER(pel_nav_counters_t, events_refused),     PEL_MEMBER(pel_nav_counters_t, fix_released),
};

static const pel_member_t WIRE_COUNTERS[] = {
    PEL_MEMBER(pel_wire_counters_t, frames),       PEL_MEMBER(pel_wire_counters_t, noise_bytes),
    PEL_MEMBER(pel_wire_counters_t, bad_checksum), PEL_MEMBER(pel_wire_counters_t, bad_length),
    PEL_MEMBER(pel_wire_counters_t, bad_value),    PEL_MEMBER(pel_wire_counters_t, unknown),
    PEL_MEMBER(pel_wire_counters_t, duplicate),    PEL_MEMBER(pel_wire_counters_t, time_back),
    PEL_MEMBER(pel_wire_counters_t, gap),          PEL_MEMBER(pel_wire_counters_t, overflow),
};

#define COUNTERS_PAYLOAD (8u + 4u * N_NAV_COUNTERS + 3u * 4u * N_WIRE_COUNTERS)

size_t pel_out_encode_counters(const pel_nav_counters_t *nav, const pel_wire_counters_t *imu,
                               const pel_wire_counters_t *rover, const pel_wire_counters_t *base, pel_time_t t,
                               uint8_t *out, size_t cap)
{
    const pel_wire_counters_t *const wire[3] = {imu, rover, base};
    if (cap < COUNTERS_PAYLOAD + PEL_OUT_OVERHEAD) { return 0; }
    pel_le_put(out + 6, 8, (uint64_t)t);
    uint8_t *at = out + 14 + pel_members_put(NAV_COUNTERS, PEL_COUNT(NAV_COUNTERS), nav, out + 14);
    for (int i = 0; i < 3; i++) { at += pel_members_put(WIRE_COUNTERS, PEL_COUNT(WIRE_COUNTERS), wire[i], at); }
    return pel_out_seal(PEL_OUT_COUNTERS, COUNTERS_PAYLOAD, out, cap);
}

pel_status_t pel_out_decode_counters(const uint8_t *payload, size_t n, pel_nav_counters_t *nav,
                                     pel_wire_counters_t *imu, pel_wire_counters_t *rover, pel_wire_counters_t *base,
                                     pel_time_t *t)
{
    pel_wire_counters_t *const wire[3] = {imu, rover, base};
    if (n != COUNTERS_PAYLOAD) { return PEL_E_FORMAT; }
    *t = pel_le_s(payload, 8);
    const uint8_t *at = payload + 8 + pel_members_get(NAV_COUNTERS, PEL_COUNT(NAV_COUNTERS), payload + 8, nav);
    for (int i = 0; i < 3; i++) { at += pel_members_get(WIRE_COUNTERS, PEL_COUNT(WIRE_COUNTERS), at, wire[i]); }
    return PEL_OK;
}

static const pel_member_t USED[] = {
    PEL_MEMBER(pel_used_t, t_ns),        PEL_MEMBER(pel_used_t, preset_asked), PEL_MEMBER(pel_used_t, preset_used),
    PEL_MEMBER(pel_used_t, preset_why),  PEL_MEMBER(pel_used_t, imu_seen),     PEL_MEMBER(pel_used_t, imu_used),
    PEL_MEMBER(pel_used_t, imu_why),     PEL_MEMBER(pel_used_t, base_seen),    PEL_MEMBER(pel_used_t, base_used),
    PEL_MEMBER(pel_used_t, base_why),    PEL_MEMBER(pel_used_t, imu_rate_hz),  PEL_MEMBER(pel_used_t, base_age_s),
    PEL_ARRAY(pel_used_t, rover_seen),   PEL_ARRAY(pel_used_t, base_carriers), PEL_ARRAY(pel_used_t, carriers_used),
    PEL_ARRAY(pel_used_t, sys_why),      PEL_MEMBER(pel_used_t, arw_rad_rts),  PEL_MEMBER(pel_used_t, vrw_mps_rts),
    PEL_MEMBER(pel_used_t, sd_bg_radps), PEL_MEMBER(pel_used_t, sd_ba_mps2),   PEL_ARRAY(pel_used_t, r_station_e),
};

size_t pel_out_encode_used(const pel_used_t *u, uint8_t *out, size_t cap)
{
    return pel_out_encode(PEL_OUT_USED, USED, PEL_COUNT(USED), u, out, cap);
}

pel_status_t pel_out_decode_used(const uint8_t *payload, size_t n, pel_used_t *u)
{
    return pel_out_decode(USED, PEL_COUNT(USED), payload, n, u);
}

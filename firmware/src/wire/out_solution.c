/* out_solution.c - layouts of solution, event, warm start and satellite frames; docs/FORMATS.md numbers every byte. */
#include "framing.h"

#define SATS_HEAD 10u /* time and count */

static const pel_member_t SOLUTION[] = {
    PEL_MEMBER(pel_solution_t, t_ns),         PEL_MEMBER(pel_solution_t, fix),
    PEL_MEMBER(pel_solution_t, int_reason),   PEL_MEMBER(pel_solution_t, flags),
    PEL_ARRAY(pel_solution_t, r_eb_e),        PEL_MEMBER(pel_solution_t, lat_rad),
    PEL_MEMBER(pel_solution_t, lon_rad),      PEL_MEMBER(pel_solution_t, height_m),
    PEL_ARRAY(pel_solution_t, v_ned),         PEL_MEMBER(pel_solution_t, roll_rad),
    PEL_MEMBER(pel_solution_t, pitch_rad),    PEL_MEMBER(pel_solution_t, heading_rad),
    PEL_ARRAY(pel_solution_t, cov_r_ned),     PEL_ARRAY(pel_solution_t, cov_v_ned),
    PEL_ARRAY(pel_solution_t, cov_att),       PEL_MEMBER(pel_solution_t, sd_roll_rad),
    PEL_MEMBER(pel_solution_t, sd_pitch_rad), PEL_MEMBER(pel_solution_t, sd_heading_rad),
    PEL_MEMBER(pel_solution_t, hpl_m),        PEL_MEMBER(pel_solution_t, vpl_m),
    PEL_MEMBER(pel_solution_t, base_age_s),   PEL_MEMBER(pel_solution_t, ratio),
    PEL_MEMBER(pel_solution_t, success_rate), PEL_MEMBER(pel_solution_t, nis),
    PEL_MEMBER(pel_solution_t, nis_dof),      PEL_MEMBER(pel_solution_t, search_nodes),
    PEL_MEMBER(pel_solution_t, n_sat),        PEL_MEMBER(pel_solution_t, n_fixed),
    PEL_MEMBER(pel_solution_t, n_amb),        PEL_MEMBER(pel_solution_t, reserved),
    PEL_MEMBER(pel_solution_t, state_hash),   PEL_ARRAY(pel_solution_t, b_g),
    PEL_ARRAY(pel_solution_t, sd_b_g),        PEL_ARRAY(pel_solution_t, b_a),
    PEL_ARRAY(pel_solution_t, sd_b_a),
};

size_t pel_out_encode_solution(const pel_solution_t *s, uint8_t *out, size_t cap)
{
    return pel_out_encode(PEL_OUT_SOLUTION, SOLUTION, PEL_COUNT(SOLUTION), s, out, cap);
}

pel_status_t pel_out_decode_solution(const uint8_t *payload, size_t n, pel_solution_t *s)
{
    return pel_out_decode(SOLUTION, PEL_COUNT(SOLUTION), payload, n, s);
}

static const pel_member_t EVENT[] = {
    PEL_MEMBER(pel_event_t, t_ns),      PEL_MEMBER(pel_event_t, id),        PEL_MEMBER(pel_event_t, fix),
    PEL_ARRAY(pel_event_t, r_ec_e),     PEL_MEMBER(pel_event_t, lat_rad),   PEL_MEMBER(pel_event_t, lon_rad),
    PEL_MEMBER(pel_event_t, height_m),  PEL_MEMBER(pel_event_t, omega_rad), PEL_MEMBER(pel_event_t, phi_rad),
    PEL_MEMBER(pel_event_t, kappa_rad), PEL_ARRAY(pel_event_t, sd_r_m),     PEL_ARRAY(pel_event_t, sd_att_rad),
};

size_t pel_out_encode_event(const pel_event_t *e, uint8_t *out, size_t cap)
{
    return pel_out_encode(PEL_OUT_EVENT, EVENT, PEL_COUNT(EVENT), e, out, cap);
}

pel_status_t pel_out_decode_event(const uint8_t *payload, size_t n, pel_event_t *e)
{
    return pel_out_decode(EVENT, PEL_COUNT(EVENT), payload, n, e);
}

static const pel_member_t WARM[] = {
    PEL_MEMBER(pel_warm_report_t, t_ns),
    PEL_MEMBER(pel_warm_report_t, verdict),
    PEL_MEMBER(pel_warm_report_t, age_s),
    PEL_ARRAY(pel_warm_report_t, count),
};

size_t pel_out_encode_warm(const pel_warm_report_t *w, uint8_t *out, size_t cap)
{
    return pel_out_encode(PEL_OUT_WARM, WARM, PEL_COUNT(WARM), w, out, cap);
}

pel_status_t pel_out_decode_warm(const uint8_t *payload, size_t n, pel_warm_report_t *w)
{
    return pel_out_decode(WARM, PEL_COUNT(WARM), payload, n, w);
}

static const pel_member_t SAT[] = {
    PEL_MEMBER(pel_sat_report_t, sys),
    PEL_MEMBER(pel_sat_report_t, prn),
    PEL_MEMBER(pel_sat_report_t, carrier),
    PEL_MEMBER(pel_sat_report_t, flags),
    PEL_MEMBER(pel_sat_report_t, az_rad),
    PEL_MEMBER(pel_sat_report_t, el_rad),
    PEL_MEMBER(pel_sat_report_t, cn0_dbhz),
    PEL_MEMBER(pel_sat_report_t, innov_code_m),
    PEL_MEMBER(pel_sat_report_t, innov_phase_m),
    PEL_MEMBER(pel_sat_report_t, innov_doppler_mps),
    PEL_MEMBER(pel_sat_report_t, sd_code_m),
    PEL_MEMBER(pel_sat_report_t, sd_phase_m),
    PEL_MEMBER(pel_sat_report_t, sd_doppler_mps),
    PEL_MEMBER(pel_sat_report_t, n_fixed),
};

size_t pel_out_encode_sats(pel_time_t t, const pel_sat_report_t *s, int n, uint8_t *out, size_t cap)
{
    if (n < 0 || n > PEL_MAX_OBS || cap < SATS_HEAD + (size_t)PEL_OUT_SAT_BYTES * (size_t)n + PEL_OUT_OVERHEAD) {
        return 0;
    }
    pel_le_put(out + 6, 8, (uint64_t)t);
    pel_le_put(out + 14, 2, (uint64_t)n);
    size_t at = 6u + SATS_HEAD;
    for (int i = 0; i < n; i++) { at += pel_members_put(SAT, PEL_COUNT(SAT), &s[i], out + at); }
    return pel_out_seal(PEL_OUT_SATS, at - 6u, out, cap);
}

pel_status_t pel_out_decode_sats(const uint8_t *payload, size_t n, pel_time_t *t, pel_sat_report_t s[PEL_MAX_OBS],
                                 int *n_sats)
{
    if (n < SATS_HEAD) { return PEL_E_FORMAT; }
    const size_t count = (size_t)pel_le_u(payload + 8, 2);
    if (count > PEL_MAX_OBS || n != SATS_HEAD + PEL_OUT_SAT_BYTES * count) { return PEL_E_FORMAT; }
    size_t at = SATS_HEAD;
    for (size_t i = 0; i < count; i++) { at += pel_members_get(SAT, PEL_COUNT(SAT), payload + at, &s[i]); }
    *t = pel_le_s(payload, 8);
    *n_sats = (int)count;
    return PEL_OK;
}

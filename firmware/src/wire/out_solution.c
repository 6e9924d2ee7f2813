#include "framing.h"

/* Layouts of solution, event and satellite frames; docs/FORMATS.md numbers every byte. Each is one function for both
 * directions. */

static void solution_fields(pel_leio_t *io, pel_solution_t *s)
{
    pel_le_io_i64(io, &s->t_ns);
    pel_le_io_u8(io, &s->fix);
    pel_le_io_u8(io, &s->int_reason);
    pel_le_io_u16(io, &s->flags);
    pel_le_io_f64(io, s->r_eb_e, 3);
    pel_le_io_f64(io, &s->lat_rad, 1);
    pel_le_io_f64(io, &s->lon_rad, 1);
    pel_le_io_f64(io, &s->height_m, 1);
    pel_le_io_f32(io, s->v_ned, 3);
    pel_le_io_f32(io, &s->roll_rad, 1);
    pel_le_io_f32(io, &s->pitch_rad, 1);
    pel_le_io_f32(io, &s->heading_rad, 1);
    pel_le_io_f32(io, s->cov_r_ned, 6);
    pel_le_io_f32(io, s->cov_v_ned, 6);
    pel_le_io_f32(io, s->cov_att, 6);
    pel_le_io_f32(io, &s->sd_roll_rad, 1);
    pel_le_io_f32(io, &s->sd_pitch_rad, 1);
    pel_le_io_f32(io, &s->sd_heading_rad, 1);
    pel_le_io_f32(io, &s->hpl_m, 1);
    pel_le_io_f32(io, &s->vpl_m, 1);
    pel_le_io_f32(io, &s->base_age_s, 1);
    pel_le_io_f32(io, &s->ratio, 1);
    pel_le_io_f32(io, &s->success_rate, 1);
    pel_le_io_f32(io, &s->nis, 1);
    pel_le_io_u16(io, &s->nis_dof);
    pel_le_io_u16(io, &s->search_nodes);
    pel_le_io_u8(io, &s->n_sat);
    pel_le_io_u8(io, &s->n_fixed);
    pel_le_io_u8(io, &s->n_amb);
    pel_le_io_u8(io, &s->reserved);
    pel_le_io_u32(io, &s->state_hash);
    pel_le_io_f32(io, s->b_g, 3);
    pel_le_io_f32(io, s->sd_b_g, 3);
    pel_le_io_f32(io, s->b_a, 3);
    pel_le_io_f32(io, s->sd_b_a, 3);
}

size_t pel_out_encode_solution(const pel_solution_t *s, uint8_t *out, size_t cap)
{
    pel_solution_t copy = *s; /* the layout serves both directions and takes it writable */
    pel_leio_t io;
    if (cap < PEL_OUT_OVERHEAD) { return 0; }
    pel_leio_write(&io, out + 6, cap - PEL_OUT_OVERHEAD);
    solution_fields(&io, &copy);
    return io.failed ? 0u : pel_out_seal(PEL_OUT_SOLUTION, io.n, out, cap);
}

pel_status_t pel_out_decode_solution(const uint8_t *payload, size_t n, pel_solution_t *s)
{
    pel_solution_t copy = {0};
    pel_leio_t io;
    pel_leio_read(&io, payload, n);
    solution_fields(&io, &copy);
    if (io.failed || io.n != n) { return PEL_E_FORMAT; }
    *s = copy;
    return PEL_OK;
}

static void event_fields(pel_leio_t *io, pel_event_t *e)
{
    pel_le_io_i64(io, &e->t_ns);
    pel_le_io_u32(io, &e->id);
    pel_le_io_u8(io, &e->fix);
    pel_le_io_f64(io, e->r_ec_e, 3);
    pel_le_io_f64(io, &e->lat_rad, 1);
    pel_le_io_f64(io, &e->lon_rad, 1);
    pel_le_io_f64(io, &e->height_m, 1);
    pel_le_io_f32(io, &e->omega_rad, 1);
    pel_le_io_f32(io, &e->phi_rad, 1);
    pel_le_io_f32(io, &e->kappa_rad, 1);
    pel_le_io_f32(io, e->sd_r_m, 3);
    pel_le_io_f32(io, e->sd_att_rad, 3);
}

size_t pel_out_encode_event(const pel_event_t *e, uint8_t *out, size_t cap)
{
    pel_event_t copy = *e;
    pel_leio_t io;
    if (cap < PEL_OUT_OVERHEAD) { return 0; }
    pel_leio_write(&io, out + 6, cap - PEL_OUT_OVERHEAD);
    event_fields(&io, &copy);
    return io.failed ? 0u : pel_out_seal(PEL_OUT_EVENT, io.n, out, cap);
}

pel_status_t pel_out_decode_event(const uint8_t *payload, size_t n, pel_event_t *e)
{
    pel_event_t copy = {0};
    pel_leio_t io;
    pel_leio_read(&io, payload, n);
    event_fields(&io, &copy);
    if (io.failed || io.n != n) { return PEL_E_FORMAT; }
    *e = copy;
    return PEL_OK;
}

static void warm_fields(pel_leio_t *io, pel_warm_report_t *w)
{
    pel_le_io_i64(io, &w->t_ns);
    pel_le_io_u8(io, &w->verdict);
    pel_le_io_f32(io, &w->age_s, 1);
    for (int i = 0; i < PEL_N_SNAP; i++) { pel_le_io_u32(io, &w->count[i]); }
}

size_t pel_out_encode_warm(const pel_warm_report_t *w, uint8_t *out, size_t cap)
{
    pel_warm_report_t copy = *w;
    pel_leio_t io;
    if (cap < PEL_OUT_OVERHEAD) { return 0; }
    pel_leio_write(&io, out + 6, cap - PEL_OUT_OVERHEAD);
    warm_fields(&io, &copy);
    return io.failed ? 0u : pel_out_seal(PEL_OUT_WARM, io.n, out, cap);
}

pel_status_t pel_out_decode_warm(const uint8_t *payload, size_t n, pel_warm_report_t *w)
{
    pel_warm_report_t copy = {0};
    pel_leio_t io;
    pel_leio_read(&io, payload, n);
    warm_fields(&io, &copy);
    if (io.failed || io.n != n) { return PEL_E_FORMAT; }
    *w = copy;
    return PEL_OK;
}

static void sat_fields(pel_leio_t *io, pel_sat_report_t *s)
{
    pel_le_io_u8(io, &s->sys);
    pel_le_io_u8(io, &s->prn);
    pel_le_io_u8(io, &s->carrier);
    pel_le_io_u8(io, &s->flags);
    pel_le_io_f32(io, &s->az_rad, 1);
    pel_le_io_f32(io, &s->el_rad, 1);
    pel_le_io_f32(io, &s->cn0_dbhz, 1);
    pel_le_io_f32(io, &s->innov_code_m, 1);
    pel_le_io_f32(io, &s->innov_phase_m, 1);
    pel_le_io_f32(io, &s->innov_doppler_mps, 1);
    pel_le_io_f32(io, &s->sd_code_m, 1);
    pel_le_io_f32(io, &s->sd_phase_m, 1);
    pel_le_io_f32(io, &s->sd_doppler_mps, 1);
    pel_le_io_i32(io, &s->n_fixed);
}

size_t pel_out_encode_sats(pel_time_t t, const pel_sat_report_t *s, int n, uint8_t *out, size_t cap)
{
    pel_leio_t io;
    uint16_t count = (uint16_t)n;
    if (cap < PEL_OUT_OVERHEAD || n < 0 || n > PEL_MAX_OBS) { return 0; }
    pel_leio_write(&io, out + 6, cap - PEL_OUT_OVERHEAD);
    pel_le_io_i64(&io, &t);
    pel_le_io_u16(&io, &count);
    for (int i = 0; i < n; i++) {
        pel_sat_report_t copy = s[i];
        sat_fields(&io, &copy);
    }
    return io.failed ? 0u : pel_out_seal(PEL_OUT_SATS, io.n, out, cap);
}

pel_status_t pel_out_decode_sats(const uint8_t *payload, size_t n, pel_time_t *t, pel_sat_report_t s[PEL_MAX_OBS],
                                 int *n_sats)
{
    pel_leio_t io;
    uint16_t count = 0;
    pel_time_t t_ns = 0;
    pel_leio_read(&io, payload, n);
    pel_le_io_i64(&io, &t_ns);
    pel_le_io_u16(&io, &count);
    if (count > PEL_MAX_OBS || n != 10u + (size_t)PEL_OUT_SAT_BYTES * count) { return PEL_E_FORMAT; }
    for (int i = 0; i < (int)count; i++) { sat_fields(&io, &s[i]); }
    *t = t_ns;
    *n_sats = count;
    return PEL_OK;
}

#include "framing.h"

/* Layouts of the counters and of "asked and used"; docs/FORMATS.md numbers every byte. */

#define N_NAV_COUNTERS  36u
#define N_WIRE_COUNTERS 10u
_Static_assert(sizeof(pel_nav_counters_t) == 4u * N_NAV_COUNTERS, "a counter is missing below and in docs/FORMATS.md");
_Static_assert(sizeof(pel_wire_counters_t) == 4u * N_WIRE_COUNTERS,
               "a counter is missing below and in docs/FORMATS.md");

static void nav_counter_fields(pel_leio_t *io, pel_nav_counters_t *c)
{
    pel_le_io_u32(io, &c->epochs_used);
    pel_le_io_u32(io, &c->epochs_late);
    pel_le_io_u32(io, &c->epochs_no_eph);
    pel_le_io_u32(io, &c->epochs_few_sats);
    pel_le_io_u32(io, &c->epochs_unpaired);
    pel_le_io_u32(io, &c->epochs_spp_failed);
    pel_le_io_u32(io, &c->imu_used);
    pel_le_io_u32(io, &c->imu_gap);
    pel_le_io_u32(io, &c->imu_out_of_order);
    pel_le_io_u32(io, &c->imu_bad_value);
    pel_le_io_u32(io, &c->rows_used);
    pel_le_io_u32(io, &c->rows_gated);
    pel_le_io_u32(io, &c->sats_no_eph);
    pel_le_io_u32(io, &c->sats_unhealthy);
    pel_le_io_u32(io, &c->sats_low);
    pel_le_io_u32(io, &c->sats_excluded);
    pel_le_io_u32(io, &c->slip_lock);
    pel_le_io_u32(io, &c->slip_half_cycle);
    pel_le_io_u32(io, &c->slip_geometry_free);
    pel_le_io_u32(io, &c->slip_doppler);
    pel_le_io_u32(io, &c->slip_ins);
    pel_le_io_u32(io, &c->clock_jumps);
    pel_le_io_u32(io, &c->fix_tried);
    pel_le_io_u32(io, &c->fix_ok);
    pel_le_io_u32(io, &c->fix_ratio);
    pel_le_io_u32(io, &c->fix_chi2);
    pel_le_io_u32(io, &c->fix_band);
    pel_le_io_u32(io, &c->fix_prior);
    pel_le_io_u32(io, &c->fix_success);
    pel_le_io_u32(io, &c->fix_budget);
    pel_le_io_u32(io, &c->restarts);
    pel_le_io_u32(io, &c->numeric_faults);
    pel_le_io_u32(io, &c->coast_epochs);
    pel_le_io_u32(io, &c->events);
    pel_le_io_u32(io, &c->events_refused);
    pel_le_io_u32(io, &c->fix_released);
}

static void wire_counter_fields(pel_leio_t *io, pel_wire_counters_t *c)
{
    pel_le_io_u32(io, &c->frames);
    pel_le_io_u32(io, &c->noise_bytes);
    pel_le_io_u32(io, &c->bad_checksum);
    pel_le_io_u32(io, &c->bad_length);
    pel_le_io_u32(io, &c->bad_value);
    pel_le_io_u32(io, &c->unknown);
    pel_le_io_u32(io, &c->duplicate);
    pel_le_io_u32(io, &c->time_back);
    pel_le_io_u32(io, &c->gap);
    pel_le_io_u32(io, &c->overflow);
}

size_t pel_out_encode_counters(const pel_nav_counters_t *nav, const pel_wire_counters_t *imu,
                               const pel_wire_counters_t *rover, const pel_wire_counters_t *base, pel_time_t t,
                               uint8_t *out, size_t cap)
{
    pel_nav_counters_t nav_copy = *nav;
    pel_wire_counters_t wire_copy[3] = {*imu, *rover, *base};
    pel_leio_t io;
    if (cap < PEL_OUT_OVERHEAD) { return 0; }
    pel_leio_write(&io, out + 6, cap - PEL_OUT_OVERHEAD);
    pel_le_io_i64(&io, &t);
    nav_counter_fields(&io, &nav_copy);
    for (int i = 0; i < 3; i++) { wire_counter_fields(&io, &wire_copy[i]); }
    return io.failed ? 0u : pel_out_seal(PEL_OUT_COUNTERS, io.n, out, cap);
}

pel_status_t pel_out_decode_counters(const uint8_t *payload, size_t n, pel_nav_counters_t *nav,
                                     pel_wire_counters_t *imu, pel_wire_counters_t *rover, pel_wire_counters_t *base,
                                     pel_time_t *t)
{
    pel_nav_counters_t nav_copy = {0};
    pel_wire_counters_t wire_copy[3] = {{0}, {0}, {0}};
    pel_time_t t_ns = 0;
    pel_leio_t io;
    pel_leio_read(&io, payload, n);
    pel_le_io_i64(&io, &t_ns);
    nav_counter_fields(&io, &nav_copy);
    for (int i = 0; i < 3; i++) { wire_counter_fields(&io, &wire_copy[i]); }
    if (io.failed || io.n != n) { return PEL_E_FORMAT; }
    *nav = nav_copy;
    *imu = wire_copy[0];
    *rover = wire_copy[1];
    *base = wire_copy[2];
    *t = t_ns;
    return PEL_OK;
}

static void u8s(pel_leio_t *io, uint8_t *v, int n)
{
    for (int i = 0; i < n; i++) { pel_le_io_u8(io, &v[i]); }
}

static void used_fields(pel_leio_t *io, pel_used_t *u)
{
    pel_le_io_i64(io, &u->t_ns);
    pel_le_io_u8(io, &u->preset_asked);
    pel_le_io_u8(io, &u->preset_used);
    pel_le_io_u8(io, &u->preset_why);
    pel_le_io_u8(io, &u->imu_seen);
    pel_le_io_u8(io, &u->imu_used);
    pel_le_io_u8(io, &u->imu_why);
    pel_le_io_u8(io, &u->base_seen);
    pel_le_io_u8(io, &u->base_used);
    pel_le_io_u8(io, &u->base_why);
    pel_le_io_f32(io, &u->imu_rate_hz, 1);
    pel_le_io_f32(io, &u->base_age_s, 1);
    u8s(io, u->rover_seen, PEL_N_SYS);
    u8s(io, u->base_carriers, PEL_N_SYS);
    u8s(io, u->carriers_used, PEL_N_SYS);
    u8s(io, u->sys_why, PEL_N_SYS);
    pel_le_io_f32(io, &u->arw_rad_rts, 1);
    pel_le_io_f32(io, &u->vrw_mps_rts, 1);
    pel_le_io_f32(io, &u->sd_bg_radps, 1);
    pel_le_io_f32(io, &u->sd_ba_mps2, 1);
    pel_le_io_f64(io, u->r_station_e, 3);
}

size_t pel_out_encode_used(const pel_used_t *u, uint8_t *out, size_t cap)
{
    pel_used_t copy = *u;
    pel_leio_t io;
    if (cap < PEL_OUT_OVERHEAD) { return 0; }
    pel_leio_write(&io, out + 6, cap - PEL_OUT_OVERHEAD);
    used_fields(&io, &copy);
    return io.failed ? 0u : pel_out_seal(PEL_OUT_USED, io.n, out, cap);
}

pel_status_t pel_out_decode_used(const uint8_t *payload, size_t n, pel_used_t *u)
{
    pel_used_t copy = {0};
    pel_leio_t io;
    pel_leio_read(&io, payload, n);
    used_fields(&io, &copy);
    if (io.failed || io.n != n) { return PEL_E_FORMAT; }
    *u = copy;
    return PEL_OK;
}

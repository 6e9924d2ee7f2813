/* Proofs of the IMU stream and of output frames. */
#include "imu_stream.h"

#include "prove.h"

/* PROVE imu_decode: increments of any bytes; what is given lies in its bounds
 * sources wire/imu_frame.c base/bits.c
 * flags --any-floats --unwind 42 -DPEL_MAX_OBS=8
 * plant wire/imu_frame.c: imu->t_ns > 0 && imu->t_ns => imu->t_ns */
void imu_decode(void)
{
    uint8_t payload[PEL_IMU_PAYLOAD];
    pel_imu_t imu;
    any_bytes(payload, sizeof payload);
    if (pel_imu_decode(payload, &imu)) { claim(imu.t_ns > 0 && imu.dt_s > 0.0); }
}

/* PROVE rawimusx_decode: a NovAtel frame of any bytes, whatever units were given
 * sources wire/novatel_imu.c wire/imu_frame.c base/bits.c
 * flags --any-floats --unwind 62 -DPEL_MAX_OBS=8
 * plant wire/novatel_imu.c: if (n != PEL_RAWIMUSX_BYTES || => if ( */
void rawimusx_decode(void)
{
    pel_imu_stream_t s;
    const size_t n = any_size();
    assume(n >= 16 && n <= 60);
    uint8_t f[n];
    pel_imu_t imu;
    bool usable = false;
    any_bytes(f, n);
    (void)pel_rawimusx_decode(&s, f, n, &imu, &usable);
}

/* PROVE out_used: a payload of any length; wrong ones change nothing
 * sources wire/out_reports.c wire/pelorus_frame.c base/bits.c
 * flags --any-floats --unwind 100 -DPEL_MAX_OBS=8
 * plant wire/pelorus_frame.c: if (n != pel_members_bytes(m, n_members)) { return PEL_E_FORMAT; } => (void)n; */
void out_used(void)
{
    const size_t n = any_size();
    assume(n >= 1 && n <= 92);
    uint8_t payload[n];
    pel_used_t u;
    u.imu_seen = 77;
    any_bytes(payload, n);
    const pel_status_t status = pel_out_decode_used(payload, n, &u);
    claim(status == PEL_OK || (status == PEL_E_FORMAT && u.imu_seen == 77));
    claim(status != PEL_OK || n == 89);
}

/* PROVE out_used_encode: into a buffer of any size
 * sources wire/out_reports.c wire/pelorus_frame.c base/bits.c
 * flags --any-floats --unwind 100 -DPEL_MAX_OBS=8
 * plant wire/pelorus_frame.c: if (cap < n + PEL_OUT_OVERHEAD) { return 0; } => (void)cap; */
void out_used_encode(void)
{
    const size_t cap = any_size();
    assume(cap >= 1 && cap <= 100);
    uint8_t out[cap];
    pel_used_t u;
    claim(pel_out_encode_used(&u, out, cap) <= cap);
}

/* PROVE out_counters: a payload of any length
 * sources wire/out_reports.c wire/pelorus_frame.c base/bits.c
 * flags --unwind 12 -DPEL_MAX_OBS=8
 * plant wire/out_reports.c: if (n != COUNTERS_PAYLOAD) { return PEL_E_FORMAT; } => (void)n; */
void out_counters(void)
{
    pel_nav_counters_t nav;
    pel_wire_counters_t w[3];
    pel_time_t t;
    const size_t n = any_size();
    assume(n >= 1 && n <= 268);
    uint8_t payload[n];
    claim(pel_out_decode_counters(payload, n, &nav, &w[0], &w[1], &w[2], &t) != PEL_OK || n == 268);
}

/* PROVE out_event: a payload of any length
 * sources wire/out_solution.c wire/pelorus_frame.c base/bits.c
 * flags --any-floats --unwind 40 -DPEL_MAX_OBS=8
 * plant wire/pelorus_frame.c: if (n != pel_members_bytes(m, n_members)) { return PEL_E_FORMAT; } => (void)n; */
void out_event(void)
{
    pel_event_t e;
    const size_t n = any_size();
    assume(n >= 1 && n <= 97);
    uint8_t payload[n];
    claim(pel_out_decode_event(payload, n, &e) != PEL_OK || n == 97);
}

/* PROVE out_solution: a payload of any length
 * sources wire/out_solution.c wire/pelorus_frame.c base/bits.c
 * flags --any-floats --unwind 40 -DPEL_MAX_OBS=8
 * plant wire/pelorus_frame.c: if (n != pel_members_bytes(m, n_members)) { return PEL_E_FORMAT; } => (void)n; */
void out_solution(void)
{
    pel_solution_t s;
    const size_t n = any_size();
    assume(n >= 1 && n <= 252);
    uint8_t payload[n];
    claim(pel_out_decode_solution(payload, n, &s) != PEL_OK || n == 252);
}

/* INSTEAD pel_out_decode_sats: up to 128 records of eleven floats each | out */

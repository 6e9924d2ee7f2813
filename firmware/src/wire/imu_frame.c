#include "imu_stream.h"

/* Units of increments: 2^-31 rad (0.1 mas) and 2^-27 m/s (7.5 nm/s), so that 32 bits hold 1 rad and 16 m/s. Rounding is far
 * below the noise of any gyro over one interval, and integers are what integrating sensors deliver. */
#define ALPHA_POW2   (-31)
#define UPSILON_POW2 (-27)

bool pel_imu_plausible(const pel_imu_t *imu)
{
    for (int i = 0; i < 3; i++) {
        const double alpha = imu->alpha_ib_b[i];
        const double upsilon = imu->upsilon_ib_b[i];
        if (!(alpha > -1.0 && alpha < 1.0 && upsilon > -16.0 && upsilon < 16.0)) { return false; } /* also NaN */
    }
    return imu->dt_s > 0.0 && imu->dt_s < 4.29 && imu->t_ns > 0 && imu->t_ns < PEL_TIME_LAST;
}

static void fields(pel_leio_t *io, pel_imu_t *imu)
{
    uint32_t dt_ns = (uint32_t)pel_round_i64(imu->dt_s * 1e9);
    pel_le_io_i64(io, &imu->t_ns);
    pel_le_io_u32(io, &dt_ns);
    pel_le_io_u16(io, &imu->seq);
    pel_le_io_u16(io, &imu->flags);
    imu->dt_s = (double)dt_ns * 1e-9;
    for (int i = 0; i < 6; i++) {
        double *const v = (i < 3) ? &imu->alpha_ib_b[i] : &imu->upsilon_ib_b[i - 3];
        const int pow2 = (i < 3) ? ALPHA_POW2 : UPSILON_POW2;
        int64_t raw = pel_round_i64(*v * pel_pow2(-pow2));
        /* a value just inside the bound rounds to it */
        if (raw > INT32_MAX) { raw = INT32_MAX; }
        if (raw < -INT32_MAX) { raw = -INT32_MAX; }
        int32_t count = (int32_t)raw;
        pel_le_io_i32(io, &count);
        *v = (double)count * pel_pow2(pow2);
    }
}

size_t pel_imu_encode(const pel_imu_t *imu, uint8_t *out, size_t cap)
{
    pel_imu_t copy = *imu;
    pel_leio_t io;
    if (!pel_imu_plausible(imu) || cap < PEL_IMU_PAYLOAD + PEL_OUT_OVERHEAD) { return 0; }
    pel_leio_write(&io, out + 6, PEL_IMU_PAYLOAD);
    fields(&io, &copy);
    return pel_out_seal(PEL_OUT_IMU, io.n, out, cap);
}

bool pel_imu_decode(const uint8_t *payload, pel_imu_t *imu)
{
    pel_leio_t io;
    *imu = (pel_imu_t){0};
    pel_leio_read(&io, payload, PEL_IMU_PAYLOAD);
    fields(&io, imu);
    return pel_imu_plausible(imu);
}

size_t pel_event_mark_encode(pel_time_t t, uint32_t id, uint8_t *out, size_t cap)
{
    if (cap < PEL_MARK_PAYLOAD + PEL_OUT_OVERHEAD || t <= 0 || t >= PEL_TIME_LAST) { return 0; }
    pel_le_put(out + 6, 8, (uint64_t)t);
    pel_le_put(out + 14, 4, id);
    return pel_out_seal(PEL_OUT_EVENT_MARK, PEL_MARK_PAYLOAD, out, cap);
}

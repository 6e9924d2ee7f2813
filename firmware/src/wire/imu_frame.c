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

/* Increment i of six: three angles, three velocities. */
static double unit_pow2(int i)
{
    return pel_pow2((i < 3) ? ALPHA_POW2 : UPSILON_POW2);
}

size_t pel_imu_encode(const pel_imu_t *imu, uint8_t *out, size_t cap)
{
    if (!pel_imu_plausible(imu) || cap < PEL_IMU_PAYLOAD + PEL_OUT_OVERHEAD) { return 0; }
    pel_le_put(out + 6, 8, (uint64_t)imu->t_ns);
    pel_le_put(out + 14, 4, (uint64_t)pel_round_i64(imu->dt_s * 1e9));
    pel_le_put(out + 18, 2, imu->seq);
    pel_le_put(out + 20, 2, imu->flags);
    for (int i = 0; i < 6; i++) {
        int64_t count = pel_round_i64(((i < 3) ? imu->alpha_ib_b[i] : imu->upsilon_ib_b[i - 3]) / unit_pow2(i));
        /* a value just inside the bound rounds to it */
        if (count > INT32_MAX) { count = INT32_MAX; }
        if (count < -INT32_MAX) { count = -INT32_MAX; }
        pel_le_put(out + 22 + 4 * i, 4, (uint64_t)count);
    }
    return pel_out_seal(PEL_OUT_IMU, PEL_IMU_PAYLOAD, out, cap);
}

bool pel_imu_decode(const uint8_t *payload, pel_imu_t *imu)
{
    *imu = (pel_imu_t){0};
    imu->t_ns = pel_le_s(payload, 8);
    imu->dt_s = (double)(uint32_t)pel_le_u(payload + 8, 4) * 1e-9;
    imu->seq = (uint16_t)pel_le_u(payload + 12, 2);
    imu->flags = (uint16_t)pel_le_u(payload + 14, 2);
    for (int i = 0; i < 6; i++) {
        double *const v = (i < 3) ? &imu->alpha_ib_b[i] : &imu->upsilon_ib_b[i - 3];
        *v = (double)(int32_t)pel_le_s(payload + 16 + 4 * i, 4) * unit_pow2(i);
    }
    return pel_imu_plausible(imu);
}

size_t pel_event_mark_encode(pel_time_t t, uint32_t id, uint8_t *out, size_t cap)
{
    if (cap < PEL_MARK_PAYLOAD + PEL_OUT_OVERHEAD || t <= 0 || t >= PEL_TIME_LAST) { return 0; }
    pel_le_put(out + 6, 8, (uint64_t)t);
    pel_le_put(out + 14, 4, id);
    return pel_out_seal(PEL_OUT_EVENT_MARK, PEL_MARK_PAYLOAD, out, cap);
}

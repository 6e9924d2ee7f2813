#include "imu_stream.h"

#include <string.h>

/* NovAtel OEM7 Commands and Logs Reference: short header, RAWIMUSX (1462), table "Raw IMU Scale Factors". */

#define SYNC_3       0x13u
#define RAWIMUSX_ID  1462u
#define BODY_BYTES   40u
#define HEADER_BYTES 12u

#define DEG     (3.14159265358979323846 / 180.0)
#define FOOT    0.3048
#define POW2_14 (1.0 / 16384.0)
#define POW2_15 (1.0 / 32768.0)
#define POW2_19 (1.0 / 524288.0)
#define POW2_21 (1.0 / 2097152.0)
#define POW2_22 (1.0 / 4194304.0)
#define POW2_26 (1.0 / 67108864.0)
#define POW2_27 (1.0 / 134217728.0)
#define POW2_29 (1.0 / 536870912.0)
#define POW2_31 (1.0 / 2147483648.0)
#define POW2_33 (1.0 / 8589934592.0)

/* Units and rate of the IMU types whose counts are increments independent of a configured rate. */
typedef struct {
    uint8_t type;
    double gyro_rad, accel_mps, dt_s;
} imu_model_t;

static const imu_model_t MODEL[] = {
    {1, POW2_33, POW2_27 *FOOT, 0.01},                       /* HG1700-AG11 */
    {4, POW2_33, POW2_26 *FOOT, 0.01},                       /* HG1700-AG17 */
    {5, POW2_33, POW2_27 *FOOT, 0.01},                       /* HG1900-CA29 */
    {8, POW2_19, POW2_14, 0.005},                            /* LN-200 */
    {11, POW2_33, POW2_27 *FOOT, 0.01},                      /* HG1700-AG58 */
    {12, POW2_33, POW2_26 *FOOT, 0.01},                      /* HG1700-AG62 */
    {13, 0.1 / 256.0 / 3600.0 * DEG, 0.05 * POW2_15, 0.005}, /* iMAR-FSAS */
    {20, POW2_33, POW2_27 *FOOT, 0.01},                      /* HG1930-AA99 */
    {26, 1e-9, 2e-8, 0.005},                                 /* ISA-100C */
    {27, POW2_33, POW2_27 *FOOT, 0.01},                      /* HG1900-CA50 */
    {28, POW2_33, POW2_27 *FOOT, 0.01},                      /* HG1930-CA50 */
    {31, 720.0 * POW2_31 *DEG, 200.0 * POW2_31, 0.005},      /* ADIS16488 */
    {32, POW2_21 *DEG, POW2_22, 0.008},                      /* STIM300 */
    {52, 1e-9, 2e-8, 0.005},                                 /* LITEF microIMU */
    {56, POW2_21 *DEG, POW2_22, 0.008},                      /* STIM300D */
    {58, POW2_33, POW2_29, 0.01},                            /* HG4930-AN01 */
};

pel_probe_t pel_novatel_probe(const uint8_t *p, size_t n, size_t *length)
{
    if (n < 2u) { return PEL_PROBE_MORE; }
    if (p[1] != 0x44u) { return PEL_PROBE_NOISE; }
    if (n < 3u) { return PEL_PROBE_MORE; }
    if (p[2] != SYNC_3) { return PEL_PROBE_NOISE; } /* the long header 0x12 belongs to logs not read here */
    if (n < 4u) { return PEL_PROBE_MORE; }
    *length = HEADER_BYTES + p[3] + 4u;
    if (*length > PEL_IMU_FRAME_MAX) { return PEL_PROBE_BAD_LENGTH; }
    if (n < *length) { return PEL_PROBE_MORE; }
    return (pel_crc32_novatel(p, *length - 4u) == (uint32_t)pel_le_u(p + *length - 4u, 4)) ? PEL_PROBE_FRAME
                                                                                           : PEL_PROBE_BAD_CHECKSUM;
}

static const imu_model_t *find_model(uint8_t type)
{
    for (size_t i = 0; i < sizeof MODEL / sizeof MODEL[0]; i++) {
        if (MODEL[i].type == type) { return &MODEL[i]; }
    }
    return NULL;
}

bool pel_rawimusx_decode(const pel_imu_stream_t *s, const uint8_t *f, size_t n, pel_imu_t *imu, bool *usable)
{
    if (n != PEL_RAWIMUSX_BYTES || pel_le_u(f + 4, 2) != RAWIMUSX_ID) { return false; }
    const uint8_t *const b = f + HEADER_BYTES;
    const imu_model_t *const model = find_model(b[1]);
    double gyro = s->gyro_scale_rad;
    double accel = s->accel_scale_mps;
    double dt_s = s->raw_dt_s;
    const int32_t week = (int32_t)pel_le_u(b + 2, 2);
    const double tow_s = pel_le_f64(b + 4);

    *usable = false;
    if (!(gyro > 0.0) && model != NULL) {
        gyro = model->gyro_rad;
        accel = model->accel_mps;
        dt_s = model->dt_s;
    }
    if (!(gyro > 0.0) || !pel_week_possible(week, tow_s)) { return true; }

    *imu = (pel_imu_t){0};
    imu->t_ns = pel_time_from_week(week, tow_s);
    imu->dt_s = dt_s;
    /* sent as z, -y, x; bit 0 of the first byte: the IMU itself reports an error */
    imu->upsilon_ib_b[2] = accel * (double)pel_le_s(b + 16, 4);
    imu->upsilon_ib_b[1] = -accel * (double)pel_le_s(b + 20, 4);
    imu->upsilon_ib_b[0] = accel * (double)pel_le_s(b + 24, 4);
    imu->alpha_ib_b[2] = gyro * (double)pel_le_s(b + 28, 4);
    imu->alpha_ib_b[1] = -gyro * (double)pel_le_s(b + 32, 4);
    imu->alpha_ib_b[0] = gyro * (double)pel_le_s(b + 36, 4);
    *usable = (b[0] & 0x01u) == 0u && pel_imu_plausible(imu);
    return true;
}

size_t pel_rawimusx_encode(const pel_imu_t *imu, uint8_t imu_type, double gyro_scale_rad, double accel_scale_mps,
                           uint8_t *out, size_t cap)
{
    if (!pel_imu_plausible(imu) || cap < PEL_RAWIMUSX_BYTES || !(gyro_scale_rad > 0.0) || !(accel_scale_mps > 0.0)) {
        return 0;
    }
    const double sign[3] = {1.0, -1.0, 1.0};
    memset(out, 0, PEL_RAWIMUSX_BYTES);
    out[0] = 0xAA;
    out[1] = 0x44;
    out[2] = SYNC_3;
    out[3] = BODY_BYTES;
    pel_le_put(out + 4, 2, RAWIMUSX_ID);
    pel_le_put(out + 6, 2, (uint64_t)pel_time_week(imu->t_ns));
    pel_le_put(out + 8, 4, (uint64_t)(imu->t_ns % PEL_NS_PER_WEEK / PEL_NS_PER_MS));
    uint8_t *const b = out + HEADER_BYTES;
    b[1] = imu_type;
    pel_le_put(b + 2, 2, (uint64_t)pel_time_week(imu->t_ns));
    pel_le_put_f64(b + 4, pel_time_tow_s(imu->t_ns));
    for (int i = 0; i < 3; i++) {
        const int axis = 2 - i;
        const int64_t a = pel_round_i64(sign[i] * imu->upsilon_ib_b[axis] / accel_scale_mps);
        const int64_t g = pel_round_i64(sign[i] * imu->alpha_ib_b[axis] / gyro_scale_rad);
        if (a < INT32_MIN || a > INT32_MAX || g < INT32_MIN || g > INT32_MAX) { return 0; }
        pel_le_put(b + 16 + 4 * i, 4, (uint64_t)a);
        pel_le_put(b + 28 + 4 * i, 4, (uint64_t)g);
    }
    pel_le_put(out + HEADER_BYTES + BODY_BYTES, 4, pel_crc32_novatel(out, HEADER_BYTES + BODY_BYTES));
    return PEL_RAWIMUSX_BYTES;
}

/* baro_frame.c - barometer samples: Pelorus frame 0x03. */
#include "imu_stream.h"

#define MOST_MM 100000000 /* 100 km */

size_t pel_baro_encode(const pel_baro_t *b, uint8_t *out, size_t cap)
{
    const double height_mm = b->height_m * 1e3;
    const double sd_mm = (double)b->sd_m * 1e3;
    if (cap < PEL_BARO_PAYLOAD + PEL_OUT_OVERHEAD || b->t_ns <= 0 || b->t_ns >= PEL_TIME_LAST) { return 0; }
    if (!(height_mm > -MOST_MM && height_mm < MOST_MM && sd_mm >= 1.0 && sd_mm < 65535.0)) { return 0; } /* also NaN */
    pel_le_put(out + 6, 8, (uint64_t)b->t_ns);
    pel_le_put(out + 14, 4, (uint32_t)(int32_t)pel_round_i64(height_mm));
    pel_le_put(out + 18, 2, (uint64_t)pel_round_i64(sd_mm));
    pel_le_put(out + 20, 2, b->seq);
    return pel_out_seal(PEL_OUT_BARO, PEL_BARO_PAYLOAD, out, cap);
}

bool pel_baro_decode(const uint8_t *payload, pel_baro_t *b)
{
    const int64_t height_mm = pel_le_s(payload + 8, 4);
    const uint64_t sd_mm = pel_le_u(payload + 12, 2);
    b->t_ns = pel_le_s(payload, 8);
    b->height_m = (double)height_mm * 1e-3;
    b->sd_m = (float)sd_mm * 1e-3f;
    b->seq = (uint16_t)pel_le_u(payload + 14, 2);
    return b->t_ns > 0 && b->t_ns < PEL_TIME_LAST && height_mm > -MOST_MM && height_mm < MOST_MM && sd_mm > 0;
}

#include "imu_stream.h"

#include <string.h>

void pel_imu_stream_init(pel_imu_stream_t *s)
{
    memset(s, 0, sizeof *s);
}

void pel_imu_stream_set_rawimu(pel_imu_stream_t *s, double gyro_scale_rad, double accel_scale_mps, double dt_s)
{
    s->gyro_scale_rad = gyro_scale_rad;
    s->accel_scale_mps = accel_scale_mps;
    s->raw_dt_s = dt_s;
}

static pel_probe_t probe(const uint8_t *p, size_t n, size_t *length)
{
    if (p[0] == 'P') { return pel_pelorus_probe(p, n, PEL_IMU_FRAME_MAX - PEL_OUT_OVERHEAD, length); }
    if (p[0] == 0xAAu) { return pel_novatel_probe(p, n, length); }
    return PEL_PROBE_NOISE;
}

/* Gives a decoded sample if it is newer than the last. A gap is told by the sequence number where there is one, else by
 * the time; half an interval is more than any clock's jitter. */
static pel_imu_event_t give(pel_imu_stream_t *s, const pel_imu_t *imu, bool has_seq)
{
    const pel_time_t tol = (pel_time_t)(imu->dt_s * 0.25e9);
    if (pel_time_order(imu->t_ns, tol, s->t_given_ns, &s->t_back_ns, &s->n_back, &s->counters) != PEL_ORDER_NEW) {
        return PEL_IMU_NONE;
    }
    const bool missed_seq = has_seq && s->have_seq && imu->seq != (uint16_t)(s->seq + 1u);
    const bool missed_time =
        !has_seq && s->t_given_ns != 0 && pel_time_diff_s(imu->t_ns, s->t_given_ns) > 1.5 * imu->dt_s;
    if (missed_seq || missed_time) { s->counters.gap++; }
    s->have_seq = has_seq;
    s->seq = imu->seq;
    s->t_given_ns = imu->t_ns;
    s->imu = *imu;
    return PEL_IMU_SAMPLE;
}

/* Payload length of an input frame; 0: no such frame. */
static size_t payload_of(uint8_t id)
{
    switch (id) {
    case PEL_OUT_IMU: return PEL_IMU_PAYLOAD;
    case PEL_OUT_EVENT_MARK: return PEL_MARK_PAYLOAD;
    case PEL_OUT_BARO: return PEL_BARO_PAYLOAD;
    default: return 0;
    }
}

static bool decode_mark(const uint8_t *payload, pel_imu_stream_t *s)
{
    const pel_time_t t_ns = pel_le_s(payload, 8);
    if (t_ns <= 0 || t_ns >= PEL_TIME_LAST) { return false; }
    s->mark_t_ns = t_ns;
    s->mark_id = (uint32_t)pel_le_u(payload + 8, 4);
    return true;
}

static pel_imu_event_t pelorus_frame(pel_imu_stream_t *s, const uint8_t *f, size_t n)
{
    const size_t n_payload = n - PEL_OUT_OVERHEAD;
    const uint8_t id = f[2];
    pel_imu_t imu = {0};
    pel_baro_t baro = {0};
    if (payload_of(id) == 0) {
        s->counters.unknown++;
        return PEL_IMU_NONE;
    }
    if (f[3] != PEL_OUT_VERSION || n_payload != payload_of(id)) {
        s->counters.bad_length++;
        return PEL_IMU_NONE;
    }
    const bool good = (id == PEL_OUT_IMU)    ? pel_imu_decode(f + 6, &imu)
                      : (id == PEL_OUT_BARO) ? pel_baro_decode(f + 6, &baro)
                                             : decode_mark(f + 6, s);
    if (!good) {
        s->counters.bad_value++;
        return PEL_IMU_NONE;
    }
    s->counters.frames++;
    if (id == PEL_OUT_IMU) { return give(s, &imu, true); }
    if (id == PEL_OUT_EVENT_MARK) { return PEL_IMU_EVENT_MARK; }
    s->baro = baro;
    return PEL_IMU_BARO;
}

static pel_imu_event_t novatel_frame(pel_imu_stream_t *s, const uint8_t *f, size_t n)
{
    pel_imu_t imu;
    bool usable;
    if (!pel_rawimusx_decode(s, f, n, &imu, &usable)) {
        s->counters.unknown++;
        return PEL_IMU_NONE;
    }
    if (!usable) {
        s->counters.bad_value++;
        return PEL_IMU_NONE;
    }
    s->counters.frames++;
    return give(s, &imu, false);
}

pel_imu_event_t pel_imu_stream_push(pel_imu_stream_t *s, uint8_t byte)
{
    size_t length = 0;
    pel_frame_append(s->buf, sizeof s->buf, &s->fill, &s->counters, byte);
    if (!pel_frame_next(s->buf, &s->fill, &s->counters, probe, false, &length)) { return PEL_IMU_NONE; }
    const pel_imu_event_t event =
        (s->buf[0] == 'P') ? pelorus_frame(s, s->buf, length) : novatel_frame(s, s->buf, length);
    pel_frame_drop(s->buf, &s->fill, length);
    return event;
}

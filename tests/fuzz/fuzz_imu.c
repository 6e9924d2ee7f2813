/* An IMU's line: Pelorus increments and event marks, NovAtel RAWIMUSX. */
#include <math.h>

#include "fuzz.h"

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t n, size_t max, unsigned seed)
{
    return fuzz_mutate_frames(data, n, max, seed);
}

static void check_sample(const pel_imu_t *imu)
{
    uint8_t out[64];
    FUZZ_CHECK(imu->t_ns > 0 && imu->dt_s > 0.0 && imu->dt_s < 10.0);
    for (int k = 0; k < 3; k++) { FUZZ_CHECK(fabs(imu->alpha_ib_b[k]) < 1e3 && fabs(imu->upsilon_ib_b[k]) < 1e6); }
    FUZZ_CHECK(pel_imu_encode(imu, out, sizeof out) <= sizeof out);
    FUZZ_CHECK(pel_rawimusx_encode(imu, 58, 1e-9, 1e-9, out, sizeof out) <= sizeof out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static pel_imu_stream_t s;
    pel_imu_stream_init(&s);
    if (n > 0 && (data[n - 1] & 1u) != 0u) { pel_imu_stream_set_rawimu(&s, 1e-7, 1e-6, 0.01); }
    for (size_t i = 0; i < n; i++) {
        const pel_wire_counters_t before = s.counters;
        const pel_imu_event_t event = pel_imu_stream_push(&s, data[i]);
        if (event == PEL_IMU_SAMPLE) { check_sample(&s.imu); }
        if (event == PEL_IMU_EVENT_MARK) { FUZZ_CHECK(s.mark_t_ns > 0); }
        if (event == PEL_IMU_BARO) { FUZZ_CHECK(s.baro.t_ns > 0 && s.baro.sd_m > 0.0f); }
        FUZZ_CHECK(fuzz_counters_grew(&before, &s.counters, sizeof before));
    }
    return 0;
}

/* pelorus-capture: IMU samples as text. The first line chooses options, the rest is the file. */
#include <string.h>

#include "fuzz.h"
#include "imu_csv.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    const char *why = NULL;
    imu_samples_t samples = {0};
    tally_t tally = {0};
    fuzz_input_t in = {data, n};
    imu_csv_options_t o = {.week = -1, .ref_ns = INT64_C(2300) * PEL_NS_PER_WEEK};
    char units[16] = {0};
    if (n < 9) { return 0; }
    const uint8_t choice = fuzz_u8(&in);
    memcpy(units, in.at, 8);
    in.at += 8;
    in.left -= 8;
    (void)imu_csv_units(units, &o.accel_unit, &o.gyro_unit);
    if ((choice & 1u) != 0u) { o.week = 2300; }
    if ((choice & 2u) != 0u) { o.has_offset = true; }
    input_t file = {.bytes = malloc(in.left + 1u), .n = in.left};
    if (file.bytes == NULL) { return 0; }
    memcpy(file.bytes, in.at, in.left);
    if (imu_csv_read(&file, &o, &samples, &tally, &why)) {
        for (size_t i = 1; i < samples.n; i++) { FUZZ_CHECK(samples.imu[i].t_ns > samples.imu[i - 1].t_ns); }
        for (size_t i = 0; i < samples.n; i++) { FUZZ_CHECK(samples.imu[i].dt_s > 0.0); }
    } else {
        FUZZ_CHECK(why != NULL);
    }
    free(samples.imu);
    free(file.bytes);
    return 0;
}

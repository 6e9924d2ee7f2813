/* RTCM 3 ephemerides. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const uint16_t NUMBERS[] = {1019, 1020, 1042, 1044, 1045, 1046};
    fuzz_rtcm3_payloads((fuzz_input_t){data, n}, NUMBERS, sizeof NUMBERS / sizeof NUMBERS[0]);
    return 0;
}

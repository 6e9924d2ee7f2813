/* RTCM 3 observations and stations of the older kind, and what is skipped. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const uint16_t NUMBERS[] = {1001, 1002, 1003, 1004, 1005, 1006, 1009, 1010,
                                       1011, 1012, 1013, 1029, 1033, 1230, 4072};
    fuzz_rtcm3_payloads((fuzz_input_t){data, n}, NUMBERS, sizeof NUMBERS / sizeof NUMBERS[0]);
    return 0;
}

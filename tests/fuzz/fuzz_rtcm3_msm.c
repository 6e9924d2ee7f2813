/* RTCM 3 Multiple Signal Messages of all systems. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const uint16_t NUMBERS[] = {1074, 1075, 1076, 1077, 1084, 1085, 1086, 1087, 1094, 1095, 1096, 1097, 1104,
                                       1105, 1106, 1107, 1114, 1115, 1116, 1117, 1124, 1125, 1126, 1127, 1071, 1137};
    fuzz_rtcm3_payloads((fuzz_input_t){data, n}, NUMBERS, sizeof NUMBERS / sizeof NUMBERS[0]);
    return 0;
}

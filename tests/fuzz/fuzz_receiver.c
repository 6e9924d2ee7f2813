/* A receiver's line: UBX, RTCM 3 and NMEA mixed, framing included. */
#include "fuzz.h"

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t n, size_t max, unsigned seed)
{
    return fuzz_mutate_frames(data, n, max, seed);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static pel_receiver_t rx;
    pel_receiver_init(&rx);
    fuzz_receiver_bytes(&rx, data, n, true);
    return 0;
}

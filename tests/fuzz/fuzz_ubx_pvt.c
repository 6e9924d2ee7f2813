/* UBX NAV-PVT: the receiver's own solution. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    fuzz_ubx_payloads((fuzz_input_t){data, n}, 0x01, 0x07);
    return 0;
}

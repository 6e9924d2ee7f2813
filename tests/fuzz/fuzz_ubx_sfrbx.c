/* UBX RXM-SFRBX: broadcast navigation messages. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    fuzz_ubx_payloads((fuzz_input_t){data, n}, 0x02, 0x13);
    return 0;
}

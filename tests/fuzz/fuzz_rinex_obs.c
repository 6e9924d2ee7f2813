/* pelorus-capture: RINEX observation files. */
#include <string.h>

#include "fuzz.h"
#include "rinex_obs.h"
#include "rinex_signals.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static rinex_obs_t r;
    static pel_epoch_t e;
    static uint8_t frame[PEL_RAWX_FRAME_BYTES];
    const char *why = NULL;
    char text[512];
    tally_t tally = {0};
    input_t in = {.bytes = malloc(n + 1u), .n = n};
    if (in.bytes == NULL) { return 0; }
    if (n > 0) { memcpy(in.bytes, data, n); }
    if (rinex_obs_open(&r, &in, &tally, &why)) {
        rinex_signals_describe(&r, text, sizeof text);
        while (rinex_obs_next(&r, &e)) {
            FUZZ_CHECK(e.n >= 1 && e.n <= PEL_MAX_OBS);
            FUZZ_CHECK(pel_ubx_encode_rawx(&e, 18, frame, sizeof frame) <= sizeof frame);
        }
    } else {
        FUZZ_CHECK(why != NULL);
    }
    rinex_obs_close(&r);
    free(in.bytes);
    return 0;
}

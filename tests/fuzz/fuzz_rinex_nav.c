/* pelorus-capture: RINEX navigation files, and the schedule of what is sent from them. */
#include <string.h>

#include "fuzz.h"
#include "rinex_nav.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    const char *why = NULL;
    uint8_t frame[128];
    nav_set_t set;
    tally_t tally = {0};
    input_t in = {.bytes = malloc(n + 1u), .n = n};
    if (in.bytes == NULL) { return 0; }
    if (n > 0) { memcpy(in.bytes, data, n); }
    nav_set_init(&set);
    if (rinex_nav_read(&set, &in, &tally, &why)) {
        for (size_t i = 0; i < set.n; i++) {
            const pel_ephemeris_t *eph = &set.record[i].eph;
            FUZZ_CHECK(eph->sys < PEL_N_SYS && eph->prn >= 1 && eph->prn <= pel_sys_max_prn((pel_sys_t)eph->sys));
            FUZZ_CHECK(pel_rtcm3_encode_ephemeris(eph, frame, sizeof frame) <= sizeof frame);
        }
        const pel_time_t start = (set.n > 0) ? set.record[0].eph.toe_ns : 0;
        nav_sent_t *sent = NULL;
        FUZZ_CHECK(nav_set_schedule(&set, start, start + 3600 * PEL_NS_PER_S, &tally, &sent) <= 2u * set.n);
        free(sent);
    } else {
        FUZZ_CHECK(why != NULL);
    }
    nav_set_free(&set);
    free(in.bytes);
    return 0;
}

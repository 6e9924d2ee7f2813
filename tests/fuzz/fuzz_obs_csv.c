/* pelorus-capture: rows of code and Doppler as text, and putting back what was removed with orbits it has not got. */
#include <string.h>

#include "fuzz.h"
#include "obs_csv.h"
#include "obs_restore.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static pel_epoch_t e;
    static obs_restore_t restore;
    const char *why = NULL;
    obs_csv_t rows;
    nav_set_t nav;
    tally_t tally = {0};
    const obs_removed_t removed = {true, true, true};
    input_t in = {.bytes = malloc(n + 1u), .n = n};
    if (in.bytes == NULL) { return 0; }
    if (n > 0) { memcpy(in.bytes, data, n); }
    nav_set_init(&nav);
    if (obs_csv_open(&rows, &in, INT64_C(2300) * PEL_NS_PER_WEEK, &tally, &why)) {
        pel_time_t before = 0;
        obs_restore_open(&restore, &removed, &nav, 0, &tally);
        while (obs_csv_next(&rows, &e)) {
            FUZZ_CHECK(e.t_ns > before && e.n > 0 && e.n <= PEL_MAX_OBS);
            before = e.t_ns;
            FUZZ_CHECK(!obs_restore_epoch(&restore, &e));
        }
        obs_restore_close(&restore);
    } else {
        FUZZ_CHECK(why != NULL);
    }
    nav_set_free(&nav);
    free(in.bytes);
    return 0;
}

/* pelorus-capture: recorded serial bytes of receivers and IMUs, with a time tag file beside them. */
#include <string.h>

#include "fuzz.h"
#include "raw.h"
#include "tagfile.h"

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t n, size_t max, unsigned seed)
{
    return fuzz_mutate_frames(data, n, max, seed);
}

static input_t copy_of(const uint8_t *p, size_t n)
{
    input_t in = {.bytes = malloc(n + 1u), .n = n};
    if (in.bytes != NULL && n > 0) { memcpy(in.bytes, p, n); }
    return in;
}

/* A length byte, a tag file of so many times eight bytes, then the log. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1) { return 0; }
    const size_t n_tags = (8u * data[0] < n - 1u) ? 8u * data[0] : n - 1u;
    input_t tag_in = copy_of(data + 1, n_tags), log = copy_of(data + 1 + n_tags, n - 1u - n_tags);
    const char *why = NULL;
    raw_times_t times = {0};
    tally_t tally = {0};
    timeline_t line = {0};
    tagfile_t tags = {0};
    const bool tagged = tagfile_parse(&tag_in, &tags);
    if (tagged) { tagfile_fit_text(&tags, &log); }

    const pel_time_t date = raw_receiver_date(&log, INT64_C(2400) * PEL_NS_PER_WEEK);
    if (!raw_receiver(&log, date, 50 * PEL_NS_PER_MS, tagged ? &tags : NULL, &tally, &line, &times, &why)) {
        FUZZ_CHECK(why != NULL);
    }
    timeline_free(&line);
    line = (timeline_t){0};
    if (!raw_imu(&log, PEL_NS_PER_MS, &tally, &line, &times, &why)) { FUZZ_CHECK(why != NULL); }
    timeline_free(&line);
    tagfile_free(&tags);
    free(tag_in.bytes);
    free(log.bytes);
    return 0;
}

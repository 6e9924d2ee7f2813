/* Output frames: the reader of desktop tools, the decoders of payloads, and the encoders on whatever was decoded. */
#include "fuzz.h"

#include <string.h>

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t n, size_t max, unsigned seed)
{
    return fuzz_mutate_frames(data, n, max, seed);
}

static uint8_t out[PEL_OUT_MAX_PAYLOAD + PEL_OUT_OVERHEAD];

/* What was read is written again: the same payload. */
static void check_again(const pel_out_reader_t *r, size_t written)
{
    FUZZ_CHECK(written == (size_t)r->n + PEL_OUT_OVERHEAD);
    FUZZ_CHECK(memcmp(out + 6, r->payload, r->n) == 0);
}

static void decode(const pel_out_reader_t *r)
{
    static pel_sat_report_t sats[PEL_MAX_OBS];
    pel_solution_t s;
    pel_used_t u;
    pel_nav_counters_t nav;
    pel_wire_counters_t wire[3];
    pel_event_t e;
    pel_warm_report_t w;
    pel_time_t t;
    char text[128];
    int n_sats;
    switch (r->id) {
    case PEL_OUT_SOLUTION:
        if (pel_out_decode_solution(r->payload, r->n, &s) != PEL_OK) { return; }
        check_again(r, pel_out_encode_solution(&s, out, sizeof out));
        FUZZ_CHECK(pel_nmea_gga(&s, text, sizeof text) < sizeof text);
        FUZZ_CHECK(pel_nmea_rmc(&s, text, sizeof text) < sizeof text);
        FUZZ_CHECK(pel_nmea_hdt(&s, text, sizeof text) < sizeof text);
        break;
    case PEL_OUT_USED:
        if (pel_out_decode_used(r->payload, r->n, &u) != PEL_OK) { return; }
        check_again(r, pel_out_encode_used(&u, out, sizeof out));
        break;
    case PEL_OUT_COUNTERS:
        if (pel_out_decode_counters(r->payload, r->n, &nav, &wire[0], &wire[1], &wire[2], &t) != PEL_OK) { return; }
        check_again(r, pel_out_encode_counters(&nav, &wire[0], &wire[1], &wire[2], t, out, sizeof out));
        break;
    case PEL_OUT_SATS:
        if (pel_out_decode_sats(r->payload, r->n, &t, sats, &n_sats) != PEL_OK) { return; }
        FUZZ_CHECK(n_sats >= 0 && n_sats <= PEL_MAX_OBS);
        check_again(r, pel_out_encode_sats(t, sats, n_sats, out, sizeof out));
        break;
    case PEL_OUT_EVENT:
        if (pel_out_decode_event(r->payload, r->n, &e) != PEL_OK) { return; }
        check_again(r, pel_out_encode_event(&e, out, sizeof out));
        break;
    case PEL_OUT_WARM:
        if (pel_out_decode_warm(r->payload, r->n, &w) != PEL_OK) { return; }
        check_again(r, pel_out_encode_warm(&w, out, sizeof out));
        break;
    default: break;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static pel_out_reader_t r;
    pel_out_reader_init(&r);
    for (size_t i = 0; i < n; i++) {
        if (pel_out_reader_push(&r, data[i])) { decode(&r); }
    }
    return 0;
}

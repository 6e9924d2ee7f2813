#include "framing.h"

#define NMEA_LONGEST 128u /* the standard says 82; receivers send more */

static int hex_digit(uint8_t c)
{
    if (c >= '0' && c <= '9') { return c - '0'; }
    if (c >= 'A' && c <= 'F') { return c - 'A' + 10; }
    if (c >= 'a' && c <= 'f') { return c - 'a' + 10; }
    return -1;
}

/* "$...*hh\r\n". Text that is no sentence is noise, not an error: it may be a log's own comment. */
pel_probe_t pel_nmea_probe(const uint8_t *p, size_t n, size_t *length)
{
    unsigned sum = 0;
    for (size_t i = 1; i < n; i++) {
        if (i >= NMEA_LONGEST) { return PEL_PROBE_NOISE; }
        if (p[i] == '*') {
            if (n < i + 5u) { return PEL_PROBE_MORE; }
            const int hi = hex_digit(p[i + 1u]);
            const int lo = hex_digit(p[i + 2u]);
            if (hi < 0 || lo < 0 || p[i + 3u] != '\r' || p[i + 4u] != '\n') { return PEL_PROBE_NOISE; }
            *length = i + 5u;
            return ((unsigned)(16 * hi + lo) == sum) ? PEL_PROBE_FRAME : PEL_PROBE_BAD_CHECKSUM;
        }
        if (p[i] < 0x20 || p[i] > 0x7E) { return PEL_PROBE_NOISE; }
        sum ^= p[i];
    }
    return PEL_PROBE_MORE;
}

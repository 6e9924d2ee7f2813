/* rinex_nav.h - RINEX 2 and 3 navigation files to broadcast ephemerides and the Klobuchar ionosphere.
 *
 * Taken: GPS, GLONASS (which also tells its frequency channels), Galileo, BeiDou and QZSS. SBAS and IRNSS are counted and
 * left out. Several files may be read into one set; a record that is there already is a duplicate. */
#ifndef PELORUS_TOOLS_CAPTURE_RINEX_NAV_H
#define PELORUS_TOOLS_CAPTURE_RINEX_NAV_H

#include "input.h"
#include "pelorus/base.h"
#include "tally.h"

typedef struct {
    pel_ephemeris_t eph;
    pel_time_t t_tx_ns; /* transmission time of the message as the file tells it, else a guess from toe */
} nav_record_t;

typedef struct {
    nav_record_t *record; /* owned */
    size_t n, cap;
    pel_klobuchar_t klobuchar;
    int8_t glo_k[33]; /* by slot, GLO_K_UNKNOWN where not told */
} nav_set_t;

void nav_set_init(nav_set_t *set);
void nav_set_free(nav_set_t *set);

/* Add a file's records. False: not a RINEX navigation file (*why is a literal) and *set as it was. */
bool rinex_nav_read(nav_set_t *set, const input_t *in, tally_t *tally, const char **why);

/* When a record is sent: as a receiver that was running would have had it.
 *
 * A record is known from its transmission time, or earlier, from toe - fit, where nothing else of its satellite is valid:
 * so a recording whose navigation file was logged later does not wait. */
typedef struct {
    pel_time_t t_ns;
    const pel_ephemeris_t *eph;
} nav_sent_t;

/* Records worth sending to a stream that lasts from start to end, in order of sending; none earlier than start. Galileo
 * F/NAV is sent only for satellites without I/NAV. *out is allocated (NULL if there are none); returns how many. */
size_t nav_set_schedule(nav_set_t *set, pel_time_t start, pel_time_t end, tally_t *tally, nav_sent_t **out);

#endif

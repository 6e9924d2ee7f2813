/* obs_restore.h - puts back what a maker of text rows has taken out of them, so that they are a receiver's own again.
 *
 * A receiver's code is range + its clock - the satellite's clock + group delay + atmosphere, tagged by its own clock. Programs that write
 * rows for others often correct some of it first. The firmware corrects it again, so it has to be there: the satellite's clock and group
 * delay come from the broadcast orbits that are sent with the rows, as the firmware will have them at that epoch. */
#ifndef PELORUS_TOOLS_CAPTURE_OBS_RESTORE_H
#define PELORUS_TOOLS_CAPTURE_OBS_RESTORE_H

#include "pelorus/base.h"
#include "pelorus/gnss.h"
#include "rinex_nav.h"
#include "tally.h"

typedef struct {
    bool receiver_clock;  /* from the times, which are true, but not from the codes */
    bool satellite_clock; /* broadcast clock with relativity, from the codes (it was added) */
    bool group_delay;     /* broadcast TGD or BGD, from the codes (it was subtracted) */
} obs_removed_t;

/* "receiver-clock,satellite-clock,group-delay" or some of them. False if not understood. */
bool obs_removed_parse(const char *text, obs_removed_t *out);
bool obs_removed_any(const obs_removed_t *r);

typedef struct {
    obs_removed_t removed;
    nav_sent_t *sent; /* owned: orbits in order of time, `next` the first not yet in `orbits` */
    size_t n_sent, next;
    pel_orbits_t orbits;
    pel_view_t view;
    pel_spp_t fix; /* last one, for the receiver's clock */
    bool have_fix;
    tally_t *tally;
} obs_restore_t;

/* Orbits are taken from nav (sorted in place), which must outlive *r; start: when the first are there. obs_restore_close() is due. */
void obs_restore_open(obs_restore_t *r, const obs_removed_t *removed, nav_set_t *nav, pel_time_t start, tally_t *tally);

/* In order of time. False: nothing of the epoch can be used. Satellites without an orbit are dropped and counted.
 * The receiver's clock is that of a single-point solution: its error of metres is 10 ns of the tag, in which no satellite moves by more
 * than 40 um. Where there is none it is carried on from the last one. */
bool obs_restore_epoch(obs_restore_t *r, pel_epoch_t *e);

void obs_restore_close(obs_restore_t *r);

#endif

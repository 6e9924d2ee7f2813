/* rinex_obs.h - RINEX 2 and 3 observation files to receiver epochs, one observation per satellite and carrier.
 *
 * The file is walked twice: once to count, for each satellite and carrier, in how many epochs each tracking code has code,
 * phase and Doppler; then epoch by epoch with the one code chosen for the whole file. Chosen is the first of a stated
 * order (ORDER in rinex_obs.c) that is nearly as complete as the most complete one, so that a satellite keeps its code.
 * In RINEX 2, where all codes of a carrier share one phase, another code stands in at epochs where the chosen one is missing.
 *
 * Time tags are the receiver's own, exact to the digits of the file. Lock time counts from the first epoch, from LLI bit 0,
 * from an epoch after a power failure (flag 1), or from a gap of the phase, and is 0 there. */
#ifndef PELORUS_TOOLS_CAPTURE_RINEX_OBS_H
#define PELORUS_TOOLS_CAPTURE_RINEX_OBS_H

#include "rinex_header.h"

#define RINEX_MAX_SIGNALS 512 /* of one epoch, before the choice of PEL_MAX_OBS */

typedef struct {
    pel_time_t since_ns; /* phase continuous from here */
    uint64_t epoch;      /* number of the epoch in which the phase was last seen; 0 never */
} rinex_lock_t;

typedef struct {
    rinex_header_t header;
    lines_t lines;
    tally_t *tally;
    pel_time_t t_last_ns;
    uint64_t n_epochs;
    pel_time_t *times; /* of all epochs, from the first walk; owned */
    uint64_t n_times, cap_times, i_time;
    bool power_failure; /* at the current epoch */
    bool counting;      /* first walk */
    uint32_t score[PEL_N_SYS][RINEX_MAX_PRN][PEL_N_CARRIER][26];
    char chosen[PEL_N_SYS][RINEX_MAX_PRN][PEL_N_CARRIER];
    rinex_lock_t lock[PEL_N_SYS][RINEX_MAX_PRN][PEL_N_CARRIER];
} rinex_obs_t;

/* Read the header and choose codes. The input must outlive *r; counts go into *tally. False: *why says it (a literal);
 * rinex_obs_close() is due in either case. */
bool rinex_obs_open(rinex_obs_t *r, const input_t *in, tally_t *tally, const char **why);

/* Next epoch with at least one satellite. False at the end. Damaged lines are counted and skipped. */
bool rinex_obs_next(rinex_obs_t *r, pel_epoch_t *e);

void rinex_obs_close(rinex_obs_t *r);

/* GLONASS channels learnt elsewhere (a navigation file), for slots the header does not tell. */
void rinex_obs_set_glo_k(rinex_obs_t *r, const int8_t glo_k[33]);

#endif

/* trial.h - one life of the firmware's static state with one bit flipped, and what became of it. */
#ifndef PELORUS_FLIPS_TRIAL_H
#define PELORUS_FLIPS_TRIAL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pelorus/navigator.h"
#include "pelorus/wire.h"

/* All that hal/main.c keeps between two bytes. */
typedef struct {
    pel_navigator_t nav;
    pel_imu_stream_t imu;
    pel_receiver_t rover, base;
} state_t;

typedef enum { MASKED, RECOVERED, STOPPED, SILENT, N_VERDICTS } verdict_t;

/* Reads the capture (bytes, truth, configuration), warms the state up and lives the undisturbed life. False: it cannot be
 * read or its own errors are beyond their bounds (said on standard error). */
bool trial_prepare(const char *capture);

/* Moments at which a bit may flip. */
int trial_n_moments(void);

/* The life from a moment on with a bit of the state flipped. what: a word on how it went wrong, for SILENT. */
verdict_t trial_run(int moment, size_t bit, const char **what);

/* Largest error of the undisturbed life over its bound. */
double trial_undisturbed_share(void);

/* Name of the member that holds a byte of state_t, such as "nav.ud". Its size in bytes. */
const char *member_of(size_t byte, size_t *size);
int member_count(void);
const char *member_name(int i, size_t *size);
int member_index(size_t byte);

#endif

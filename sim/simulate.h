/* simulate.h - run a scenario from start to end: truth, sensors, frames, lines. */
#ifndef PELORUS_SIM_SIMULATE_H
#define PELORUS_SIM_SIMULATE_H

#include "scenario.h"
#include "streams.h"

typedef struct {
    uint64_t imu_samples, rover_epochs, base_epochs, ephemerides, marks;
    uint64_t lost, damaged;
} simulate_counts_t;

/* Told how far the run is, 0..1, often. */
typedef void (*progress_t)(void *context, double fraction);

/* Attitude (roll, pitch, heading, rad) the navigator starts from: the truth at the start turned by a drawn error.
 * False: out of memory. */
bool simulate_start_attitude(const scenario_t *s, double attitude[3]);

/* Run it. False: the sink refused, or out of memory. */
bool simulate_run(const scenario_t *s, sink_t sink, void *sink_context, progress_t progress, void *progress_context,
                  simulate_counts_t *counts);

#endif

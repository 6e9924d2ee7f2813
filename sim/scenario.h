/* scenario.h - everything a scenario file says. Keys and defaults: docs/SIMULATOR.md. */
#ifndef PELORUS_SIM_SCENARIO_H
#define PELORUS_SIM_SCENARIO_H

#include <stdbool.h>
#include <stdint.h>

#include "common/config_file.h"
#include "imu.h"
#include "motion.h"
#include "receiver.h"
#include "sky.h"

/* One serial line: frames arrive late, at random later, or not at all. */
typedef struct {
    double latency_s, jitter_s; /* jitter: uniform, added to the latency */
    double lost_frames;         /* probability */
    double bit_errors;          /* probability of a flipped bit, per bit */
} line_config_t;

typedef struct {
    bool present;
    int64_t interval_ns;
    double noise_m;                /* white, 1 sigma, also what its frames say */
    double markov_m, markov_tau_s; /* weather, 1 sigma */
} barometer_config_t;

typedef enum { FORMAT_UBX, FORMAT_RTCM3 } format_t;

typedef struct {
    char name[64];
    char path[512];
    uint64_t seed;
    pel_time_t start_ns;
    double duration_s;

    motion_config_t motion;
    segment_t *segments;
    int n_segments;

    imu_config_t imu;
    line_config_t imu_line;
    double lever_b[3]; /* IMU to antenna */
    barometer_config_t barometer;

    sky_config_t sky;
    double ephemeris_interval_s;
    atmosphere_t air;

    receiver_config_t rover, base;
    line_config_t rover_line, base_line;
    format_t base_format;
    bool base_ephemerides;
    double base_r_e[3];
    uint16_t station_id;

    double event_first_s, event_interval_s, event_sd_s;
    int64_t n_events;

    double truth_interval_s;

    bool draw_start; /* the navigator is given an attitude with an error drawn here */
    double sd_tilt, sd_heading;
} scenario_t;

/* Read a scenario from an open file. False: why[cap] says in one line what is wrong (exit code 2). scenario_free() afterwards. */
bool scenario_read(config_file_t *file, const char *path, scenario_t *s, char *why, size_t cap);
void scenario_free(scenario_t *s);

#endif

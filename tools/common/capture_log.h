/* capture_log.h - captures: LCM event logs of raw serial bytes with their arrival times.
 *
 * Written by pelorus-sim and pelorus-capture, read and written by pelorus-sil. Thin over liblcm's lcm_eventlog_*.
 * Arrival times are microseconds of Unix time; pel_time_t conversions are here. Not for firmware/: allocates. */
#ifndef PELORUS_TOOLS_CAPTURE_LOG_H
#define PELORUS_TOOLS_CAPTURE_LOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pelorus/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Channels of a capture. */
#define CAPTURE_UART_IMU   "UART_IMU"
#define CAPTURE_UART_ROVER "UART_ROVER"
#define CAPTURE_UART_BASE  "UART_BASE"
#define CAPTURE_UART_AUX1  "UART_AUX1" /* event marks */
#define CAPTURE_UART_OUT   "UART_OUT"  /* what the firmware sent */
#define CAPTURE_TRUTH      "TRUTH"     /* LCM type pelorus truth_t */
#define CAPTURE_SETUP      "SETUP"     /* TOML text: the board's stored configuration, first event of a capture */

/* Unix microseconds of a GPS time (rounded down) and back. */
int64_t capture_unix_us(pel_time_t t_ns);
pel_time_t capture_gps_ns(int64_t unix_us);

typedef struct {
    void *event;      /* lcm_eventlog_event_t, the one last read */
    void *log;        /* lcm_eventlog_t */
    int64_t n_events; /* written or read so far */
    int64_t bytes;    /* size of the file read; 0 if unknown (a pipe) */
} capture_log_t;

/* One event as read; channel and data are valid until the next read or close. */
typedef struct {
    int64_t t_us;
    const char *channel;
    const uint8_t *data;
    size_t n;
} capture_event_t;

/* Open for writing or reading; "-" is standard output or input. False: could not be opened (errno says why). */
bool capture_log_create(capture_log_t *c, const char *path);
bool capture_log_open(capture_log_t *c, const char *path);

/* Append one event. False: the disk is full or the like. Events are to be given in order of arrival. */
bool capture_log_write(capture_log_t *c, int64_t t_us, const char *channel, const void *data, size_t n);

/* Next event. False at the end of the log, or where it stops being one. */
bool capture_log_read(capture_log_t *c, capture_event_t *e);

/* How much of the file has been read, 0..1; 0 if unknown. */
double capture_log_fraction(const capture_log_t *c);

/* Close. False: the last bytes could not be written. */
bool capture_log_close(capture_log_t *c);

#ifdef __cplusplus
}
#endif
#endif

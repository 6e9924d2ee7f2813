/* desktop.h - what the programs behind the desktop HAL share: the run's input, output and options. */
#ifndef HAL_DESKTOP_H
#define HAL_DESKTOP_H

#include "capture_log.h"
#include "cli.h"
#include "hal.h"

#define DESKTOP_MAX_OUTAGES 8

typedef struct {
    double start_s, duration_s; /* after the first GNSS event */
} desktop_outage_t;

typedef struct {
    const char *input;   /* capture file, "-", or an LCM URL */
    const char *output;  /* OUT file, "-", or an LCM URL */
    const char *config;  /* TOML file or NULL */
    const char *store;   /* FILE: slots are FILE.0 and FILE.1; NULL: no store */
    const char *command; /* the command line, for the record */
    bool realtime;
    const cli_t *cli; /* progress */
    desktop_outage_t outage[DESKTOP_MAX_OUTAGES];
    int n_outages;
} desktop_options_t;

/* Open input and output. Returns an exit code, 0 when ready; prints one line otherwise. */
int desktop_open(const desktop_options_t *options);

/* Finish the output. Returns the exit code of the run. */
int desktop_close(void);

/* The SETUP text seen at the start of the input, or NULL. */
const char *desktop_setup_text(void);

/* Read the [navigator] table of a TOML text or file into a configuration. On failure one line goes to why. Returns an exit
 * code: 0, 2 (wrong keys or values), 3 (unreadable). */
int desktop_config_from_file(const char *path, pel_nav_config_t *cfg, char *why, size_t cap);
int desktop_config_from_text(const char *text, const char *name, pel_nav_config_t *cfg, char *why, size_t cap);

/* Live LCM. next: false when nothing came for timeout_ms; the event is valid until the next call. */
typedef struct desktop_live_t desktop_live_t;
desktop_live_t *desktop_live_open(const char *url);
bool desktop_live_next(desktop_live_t *live, capture_event_t *event, int timeout_ms);
bool desktop_live_publish(desktop_live_t *live, const char *channel, const void *data, size_t n);
void desktop_live_close(desktop_live_t *live);

#endif

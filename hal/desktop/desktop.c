/* desktop.c - the HAL on a desktop: ports are channels of a capture (or of a live LCM), the OUT port is a log. */
#include "desktop.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#define LIVE_TIMEOUT_MS 3000 /* a live input silent for this long has ended, once it has begun */

static const char *const CHANNEL[HAL_N_PORTS] = {CAPTURE_UART_IMU, CAPTURE_UART_ROVER, CAPTURE_UART_BASE,
                                                 CAPTURE_UART_AUX1, CAPTURE_UART_OUT};

static struct {
    desktop_options_t options;
    capture_log_t in, out;
    desktop_live_t *live_in, *live_out;
    capture_event_t event; /* the event being served */
    hal_port_t port;       /* its port, HAL_N_PORTS if none is waiting */
    size_t taken;
    bool running;
    bool write_failed;
    char *setup;
    int64_t first_gnss_us;
    int64_t first_us, started_ns;
} desktop;

static int64_t monotonic_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (int64_t)t.tv_sec * PEL_NS_PER_S + t.tv_nsec;
}

static bool is_url(const char *name)
{
    return strstr(name, "://") != NULL;
}

static bool is_same_file(const char *a, const char *b)
{
    struct stat sa, sb;
    return stat(a, &sa) == 0 && stat(b, &sb) == 0 && S_ISREG(sa.st_mode) && sa.st_dev == sb.st_dev &&
           sa.st_ino == sb.st_ino;
}

static bool next_event(void)
{
    if (desktop.live_in == NULL) { return capture_log_read(&desktop.in, &desktop.event); }
    const int timeout_ms = (desktop.first_us == 0) ? 60000 : LIVE_TIMEOUT_MS;
    return desktop_live_next(desktop.live_in, &desktop.event, timeout_ms);
}

static void put_out(const char *channel, const void *data, size_t n)
{
    bool ok;
    if (desktop.live_out != NULL) {
        ok = desktop_live_publish(desktop.live_out, channel, data, n);
    } else {
        ok = capture_log_write(&desktop.out, desktop.event.t_us, channel, data, n);
    }
    if (!ok) { desktop.write_failed = true; }
}

static bool in_outage(int64_t t_us)
{
    const double t_s = (double)(t_us - desktop.first_gnss_us) * 1e-6;
    for (int i = 0; i < desktop.options.n_outages; i++) {
        const desktop_outage_t *o = &desktop.options.outage[i];
        if (t_s >= o->start_s && t_s < o->start_s + o->duration_s) { return true; }
    }
    return false;
}

/* A GNSS event inside an outage given on the command line is never seen by the firmware. */
static bool is_removed(hal_port_t port)
{
    if (port != HAL_PORT_ROVER && port != HAL_PORT_BASE) { return false; }
    if (desktop.first_gnss_us == 0) { desktop.first_gnss_us = desktop.event.t_us; }
    return in_outage(desktop.event.t_us);
}

static void keep_pace(void)
{
    if (!desktop.options.realtime || desktop.live_in != NULL) { return; }
    const int64_t due_ns = desktop.started_ns + (desktop.event.t_us - desktop.first_us) * 1000;
    const int64_t wait_ns = due_ns - monotonic_ns();
    if (wait_ns <= 0) { return; }
    const struct timespec t = {wait_ns / PEL_NS_PER_S, wait_ns % PEL_NS_PER_S};
    nanosleep(&t, NULL);
}

/* Take the next event of the input. TRUTH and SETUP go through to the output; serial bytes wait in their port. */
static void take_event(void)
{
    desktop.port = HAL_N_PORTS;
    if (!next_event()) {
        desktop.running = false;
        return;
    }
    if (desktop.first_us == 0) { desktop.first_us = desktop.event.t_us; }
    keep_pace();
    if (desktop.live_in == NULL) { cli_progress(desktop.options.cli, capture_log_fraction(&desktop.in)); }
    if (strcmp(desktop.event.channel, CAPTURE_TRUTH) == 0 || strcmp(desktop.event.channel, CAPTURE_SETUP) == 0) {
        put_out(desktop.event.channel, desktop.event.data, desktop.event.n);
        return;
    }
    for (int i = HAL_PORT_IMU; i <= HAL_PORT_AUX1; i++) {
        if (strcmp(desktop.event.channel, CHANNEL[i]) != 0) { continue; }
        if (!is_removed((hal_port_t)i)) {
            desktop.port = (hal_port_t)i;
            desktop.taken = 0;
        }
    }
}

static void keep_setup(const capture_event_t *e)
{
    free(desktop.setup);
    desktop.setup = malloc(e->n + 1);
    if (desktop.setup == NULL) { return; }
    memcpy(desktop.setup, e->data, e->n);
    desktop.setup[e->n] = '\0';
}

/* The stored configuration is the capture's first event, if it is there: read ahead to it, and serve that event later. */
static void look_for_setup(void)
{
    take_event();
    if (desktop.running && strcmp(desktop.event.channel, CAPTURE_SETUP) == 0) { keep_setup(&desktop.event); }
}

int desktop_open(const desktop_options_t *options)
{
    memset(&desktop, 0, sizeof desktop);
    desktop.options = *options;
    desktop.port = HAL_N_PORTS;
    desktop.running = true;
    desktop.started_ns = monotonic_ns();
    if (is_url(options->input)) {
        desktop.live_in = desktop_live_open(options->input);
        if (desktop.live_in == NULL) {
            fprintf(stderr, "pelorus-sil: cannot listen on %s\n", options->input);
            return 3;
        }
    } else if (!capture_log_open(&desktop.in, options->input)) {
        fprintf(stderr, "pelorus-sil: cannot read %s: %s\n", options->input, strerror(errno));
        return 3;
    }
    if (is_same_file(options->input, options->output)) { /* creating it would destroy the capture */
        fprintf(stderr, "pelorus-sil: input and output are the same file, %s\n", options->input);
        return EXIT_USAGE;
    }
    if (is_url(options->output)) { desktop.live_out = desktop_live_open(options->output); }
    if (is_url(options->output) ? desktop.live_out == NULL : !capture_log_create(&desktop.out, options->output)) {
        fprintf(stderr, "pelorus-sil: cannot write %s: %s\n", options->output, strerror(errno));
        return 3;
    }
    look_for_setup();
    if (desktop.first_us == 0) {
        fprintf(stderr, "pelorus-sil: %s holds no events of a capture\n", options->input);
        return 3;
    }
    put_out("RUN", options->command, strlen(options->command));
    return 0;
}

int desktop_close(void)
{
    bool ok = !desktop.write_failed;
    if (desktop.live_out != NULL) {
        desktop_live_close(desktop.live_out);
    } else {
        ok = capture_log_close(&desktop.out) && ok;
    }
    if (desktop.live_in != NULL) {
        desktop_live_close(desktop.live_in);
    } else {
        (void)capture_log_close(&desktop.in);
    }
    cli_progress(desktop.options.cli, 1.0);
    free(desktop.setup);
    if (!ok) {
        fprintf(stderr, "pelorus-sil: could not write all of %s\n", desktop.options.output);
        return 3;
    }
    return 0;
}

const char *desktop_setup_text(void)
{
    return desktop.setup;
}

bool hal_init(void)
{
    return true;
}

bool hal_running(void)
{
    return desktop.running;
}

size_t hal_read(hal_port_t port, uint8_t *buf, size_t cap)
{
    if (port != desktop.port) { return 0; }
    size_t n = desktop.event.n - desktop.taken;
    if (n > cap) { n = cap; }
    memcpy(buf, desktop.event.data + desktop.taken, n);
    desktop.taken += n;
    return n;
}

uint32_t hal_overruns(hal_port_t port)
{
    (void)port;
    return 0;
}

size_t hal_write(hal_port_t port, const uint8_t *buf, size_t n)
{
    put_out(CHANNEL[port], buf, n);
    return n;
}

int64_t hal_clock_ns(void)
{
    return monotonic_ns();
}

pel_time_t hal_gps_time(void)
{
    return capture_gps_ns(desktop.first_us);
}

bool hal_pps(int64_t *clock_ns)
{
    (void)clock_ns;
    return false;
}

bool hal_event(int64_t *clock_ns, uint32_t *id)
{
    (void)clock_ns;
    (void)id;
    return false;
}

bool hal_load_config(pel_nav_config_t *cfg)
{
    char why[256];
    if (desktop.options.config != NULL) {
        return desktop_config_from_file(desktop.options.config, cfg, why, sizeof why) == 0;
    }
    if (desktop.setup == NULL) { return false; }
    const int code = desktop_config_from_text(desktop.setup, "SETUP", cfg, why, sizeof why);
    if (code != 0) { fprintf(stderr, "pelorus-sil: stored configuration refused: %s\n", why); }
    return code == 0;
}

static bool store_path(int slot, char *path, size_t cap)
{
    if (desktop.options.store == NULL) { return false; }
    const int n = snprintf(path, cap, "%s.%d", desktop.options.store, slot);
    return n > 0 && (size_t)n < cap;
}

size_t hal_store_read(int slot, uint8_t *buf, size_t cap)
{
    char path[4096];
    if (!store_path(slot, path, sizeof path)) { return 0; }
    FILE *f = fopen(path, "rb");
    if (f == NULL) { return 0; }
    const size_t n = fread(buf, 1, cap, f);
    (void)fclose(f);
    return n;
}

size_t hal_store_write(int slot, const uint8_t *buf, size_t n)
{
    char path[4096];
    if (!store_path(slot, path, sizeof path)) { return 0; }
    FILE *f = fopen(path, "wb");
    if (f == NULL) { return 0; }
    size_t written = fwrite(buf, 1, n, f);
    if (fclose(f) != 0) { written = 0; }
    return written;
}

bool hal_store_void(int slot)
{
    char path[4096];
    return !store_path(slot, path, sizeof path) || remove(path) == 0 || errno == ENOENT;
}

void hal_watchdog_kick(void) {}

void hal_idle(void)
{
    take_event();
}

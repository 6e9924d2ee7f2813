/* main.c - pelorus-sim SCENARIO.toml -o CAPTURE: truth and sensors into the serial bytes a board would see. */
#define _POSIX_C_SOURCE 200809L
#include <errno.h>
#include <lcm/lcm.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "common/capture_log.h"
#include "common/cli.h"
#include "scenario.h"
#include "simulate.h"
#include "world.h"

#define SETUP_BYTES 16384

enum { OPT_OUTPUT, OPT_SEED, OPT_LIVE, OPT_DURATION, N_OPTIONS };
static const cli_option_t options[N_OPTIONS] = {
    {"output", 'o', "CAPTURE", "LCM event log to write (- is standard output)"},
    {"seed", 's', "N", "seed of all random numbers (default: the scenario's)"},
    {"live", 0, "URL", "publish on LCM in real time, for example udpm://239.255.76.67:7667?ttl=0"},
    {"duration", 0, "SECONDS", "stop after so many seconds of the scenario"}};
static const cli_program_t program = {
    "pelorus-sim",
    "SCENARIO.toml -o CAPTURE [--seed N] [--live URL]",
    "Simulate a motion, its sensors and receivers, and write the serial bytes a board would get.",
    options,
    N_OPTIONS,
    "channels: UART_IMU UART_ROVER UART_BASE UART_AUX1 (event marks) TRUTH SETUP; scenario keys: docs/SIMULATOR.md"};

typedef struct {
    capture_log_t *log; /* NULL: not recorded */
    lcm_t *lcm;         /* NULL: not published */
    int64_t first_us;   /* arrival of the first event, and when that was on this machine's clock */
    double first_s;
} outlet_t;

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void wait_until(double t_s)
{
    const double left = t_s - now_s();
    if (left <= 0.0) { return; }
    struct timespec t = {.tv_sec = (time_t)left};
    t.tv_nsec = (long)(1e9 * (left - floor(left)));
    (void)nanosleep(&t, NULL);
}

static bool deliver(void *context, int64_t t_us, const char *channel, const uint8_t *data, size_t n)
{
    outlet_t *o = context;
    if (o->lcm != NULL) {
        if (o->first_us == 0) {
            o->first_us = t_us;
            o->first_s = now_s();
        }
        wait_until(o->first_s + 1e-6 * (double)(t_us - o->first_us));
        if (lcm_publish(o->lcm, channel, data, (unsigned)n) != 0) { return false; }
    }
    return o->log == NULL || capture_log_write(o->log, t_us, channel, data, n);
}

static void show_progress(void *context, double fraction)
{
    cli_progress(context, fraction);
}

/* The board's stored configuration: the scenario's [navigator] table, the drawn start attitude, and how to repeat the run. */
static size_t setup_text(const config_file_t *file, const scenario_t *s, double duration_s, char *out, size_t cap)
{
    char why[CONFIG_FILE_WHY];
    char command[768];
    (void)config_file_text(file, "navigator", out, cap);
    config_file_t *setup = config_file_parse(out, "setup", why, sizeof why);
    if (setup == NULL) { return 0; }
    if (s->draw_start) {
        double attitude[3];
        if (!simulate_start_attitude(s, attitude)) { return 0; }
        for (int i = 0; i < 3; i++) { attitude[i] /= WORLD_DEG; }
        config_file_set_numbers(setup, "navigator.start.attitude_deg", attitude, 3);
    }
    int n = snprintf(command, sizeof command, "pelorus-sim %s --seed %llu -o CAPTURE", s->path,
                     (unsigned long long)s->seed);
    if (duration_s > 0.0 && n > 0 && (size_t)n < sizeof command) {
        (void)snprintf(command + n, sizeof command - (size_t)n, " --duration %g", duration_s);
    }
    config_file_set_string(setup, "scenario.name", s->name);
    config_file_set_integer(setup, "scenario.seed", (int64_t)s->seed);
    config_file_set_string(setup, "scenario.command", command);
    const size_t length = config_file_text(setup, "", out, cap);
    config_file_close(setup);
    return length;
}

static int run(const cli_t *cli, const scenario_t *s, const char *setup, size_t n_setup, outlet_t *outlet)
{
    simulate_counts_t c;
    const double start = now_s();
    const bool ok = deliver(outlet, capture_unix_us(s->start_ns), CAPTURE_SETUP, (const uint8_t *)setup, n_setup) &&
                    simulate_run(s, deliver, outlet, show_progress, (void *)cli, &c);
    cli_progress(cli, 1.0);
    if (!ok) {
        fprintf(stderr, "pelorus-sim: output cannot be written: %s\n", strerror(errno));
        return EXIT_UNREADABLE;
    }
    if (cli->verbosity >= 0) {
        fprintf(stderr, "%s, seed %llu: %.0f s in %.1f s; %llu IMU samples, %llu rover and %llu base epochs\n", s->name,
                (unsigned long long)s->seed, s->duration_s, now_s() - start, (unsigned long long)c.imu_samples,
                (unsigned long long)c.rover_epochs, (unsigned long long)c.base_epochs);
    }
    if (cli->verbosity > 0) {
        fprintf(stderr, "%llu ephemerides, %llu event marks; on purpose %llu frames lost, %llu damaged\n",
                (unsigned long long)c.ephemerides, (unsigned long long)c.marks, (unsigned long long)c.lost,
                (unsigned long long)c.damaged);
    }
    return EXIT_DONE;
}

/* Open what was asked for, run, close. */
static int deliver_scenario(const cli_t *cli, const scenario_t *s, const char *setup, size_t n_setup,
                            const char *output, const char *url)
{
    capture_log_t log;
    outlet_t outlet = {0};
    if (output != NULL) {
        if (!capture_log_create(&log, output)) {
            fprintf(stderr, "pelorus-sim: %s: %s\n", output, strerror(errno));
            return EXIT_UNREADABLE;
        }
        outlet.log = &log;
    }
    if (url != NULL) {
        outlet.lcm = lcm_create(url);
        if (outlet.lcm == NULL) {
            fprintf(stderr, "pelorus-sim: %s: no such LCM provider, or no network for it\n", url);
            return EXIT_UNREADABLE;
        }
    }
    int result = run(cli, s, setup, n_setup, &outlet);
    if (outlet.log != NULL && !capture_log_close(&log) && result == EXIT_DONE) {
        fprintf(stderr, "pelorus-sim: %s: %s\n", output, strerror(errno));
        result = EXIT_UNREADABLE;
    }
    if (outlet.lcm != NULL) { lcm_destroy(outlet.lcm); }
    return result;
}

int main(int argc, char **argv)
{
    const char *output = NULL;
    const char *url = NULL;
    int64_t seed = -1;
    double duration_s = 0.0;
    cli_t cli = cli_start(&program, argc, argv);
    for (int o = cli_next(&cli); o != CLI_END; o = cli_next(&cli)) {
        switch (o) {
        case OPT_OUTPUT: output = cli.value; break;
        case OPT_SEED: seed = cli_integer(&cli, 0, INT64_C(1) << 53); break;
        case OPT_LIVE: url = cli.value; break;
        case OPT_DURATION: duration_s = cli_number(&cli, 0.01, 1e6); break;
        }
    }
    cli_positional(&cli, 1, 1, "SCENARIO.toml");
    if (output == NULL && url == NULL) { cli_fail(&cli, "needs -o CAPTURE, or --live URL, or both"); }

    static char setup[SETUP_BYTES];
    char why[CONFIG_FILE_WHY];
    bool unreadable = false;
    scenario_t scenario;
    config_file_t *file = config_file_open(cli.rest[0], &unreadable, why, sizeof why);
    if (file == NULL || !scenario_read(file, cli.rest[0], &scenario, why, sizeof why)) {
        fprintf(stderr, "pelorus-sim: %s\n", why);
        if (file != NULL) { config_file_close(file); }
        return unreadable ? EXIT_UNREADABLE : EXIT_USAGE;
    }
    if (seed >= 0) { scenario.seed = (uint64_t)seed; }
    if (duration_s > 0.0) { scenario.duration_s = fmin(duration_s, scenario.duration_s); }
    const size_t n_setup = setup_text(file, &scenario, duration_s, setup, sizeof setup);
    const int result = deliver_scenario(&cli, &scenario, setup, n_setup, output, url);
    scenario_free(&scenario);
    config_file_close(file);
    return result;
}

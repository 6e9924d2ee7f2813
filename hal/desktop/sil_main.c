/* sil_main.c - pelorus-sil: the firmware on the desktop HAL. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "desktop.h"
#include "version.h"

enum { OPT_OUT, OPT_CONFIG, OPT_REALTIME, OPT_OUTAGE, OPT_STORE };

static const cli_option_t OPTIONS[] = {
    {"output", 'o', "OUT", "where the output goes: a log file, '-', or an LCM URL (required)"},
    {"config", 'c', "FILE.toml", "the [navigator] table of this file instead of the capture's stored setup"},
    {"realtime", 0, NULL, "feed the firmware at the pace of the capture instead of as fast as it goes"},
    {"outage", 0, "START,LENGTH", "remove all GNSS for LENGTH s, START s after the first GNSS bytes (may be repeated)"},
    {"store", 0, "FILE",
     "the firmware's non-volatile store, FILE.0 and FILE.1: start warm from it, keep it up to date"},
};

static const cli_program_t PROGRAM = {
    "pelorus-sil",
    "[options] CAPTURE -o OUT",
    "Run the firmware over a capture: serial bytes in, navigation frames out.",
    OPTIONS,
    (int)(sizeof OPTIONS / sizeof OPTIONS[0]),
    "CAPTURE is an LCM event log, '-' for standard input, or an LCM URL such as udpm://239.255.76.67:7667?ttl=0\n"
    "(then lcm-logplayer or pelorus-sim --live feeds it). Without --config the capture's SETUP is used, else "
    "everything\n"
    "the capture offers: the IMU if there is one, relative positioning if there is a base."};

static void add_outage(const cli_t *cli, desktop_options_t *o)
{
    char rest;
    if (o->n_outages == DESKTOP_MAX_OUTAGES) { cli_fail(cli, "at most %d outages", DESKTOP_MAX_OUTAGES); }
    desktop_outage_t *outage = &o->outage[o->n_outages++];
    if (sscanf(cli->value, "%lf,%lf%c", &outage->start_s, &outage->duration_s, &rest) != 2 ||
        !(outage->start_s >= 0.0 && outage->duration_s > 0.0)) {
        cli_fail(cli, "--outage takes START,LENGTH in seconds, not '%s'", cli->value);
    }
}

/* What was run, as JSON, for the head of the report. */
static char *describe_run(int argc, char **argv)
{
    size_t cap = 256;
    for (int i = 0; i < argc; i++) { cap += 2 * strlen(argv[i]) + 1; }
    char *text = malloc(cap);
    if (text == NULL) { return NULL; }
    size_t n =
        (size_t)snprintf(text, cap, "{\"program\":\"pelorus-sil\",\"version\":\"%s\",\"real\":\"%s\",\"command\":\"",
                         PELORUS_VERSION, PEL_REAL_DOUBLE ? "double" : "float");
    for (int i = 0; i < argc; i++) {
        if (i > 0) { text[n++] = ' '; }
        for (const char *c = (i == 0) ? "pelorus-sil" : argv[i]; *c != '\0'; c++) {
            if (*c == '"' || *c == '\\') { text[n++] = '\\'; }
            text[n++] = (*c < ' ' && *c >= 0) ? ' ' : *c;
        }
    }
    memcpy(text + n, "\"}", 3);
    return text;
}

/* A configuration that cannot be read stops the program before anything runs. */
static int check_config(const char *path)
{
    pel_nav_config_t cfg;
    char why[256];
    int code = 0;
    pel_nav_config_default(&cfg);
    if (path != NULL) {
        code = desktop_config_from_file(path, &cfg, why, sizeof why);
    } else if (desktop_setup_text() != NULL) {
        code = desktop_config_from_text(desktop_setup_text(), "SETUP", &cfg, why, sizeof why);
    }
    if (code != 0) { fprintf(stderr, "pelorus-sil: %s\n", why); }
    return code;
}

/* Bytes that were refused, by port and cause, on standard error. Returns true if there were any. */
static bool tell_refused(const cli_t *cli)
{
    static const struct {
        const char *name;
        hal_port_t port;
    } PORTS[] = {{"imu", HAL_PORT_IMU}, {"rover", HAL_PORT_ROVER}, {"base", HAL_PORT_BASE}, {"aux1", HAL_PORT_AUX1}};
    bool any = false;
    for (size_t i = 0; i < sizeof PORTS / sizeof PORTS[0]; i++) {
        const pel_wire_counters_t *c = firmware_counters(PORTS[i].port);
        if (c->bad_checksum + c->bad_length + c->bad_value == 0) { continue; }
        any = true;
        if (cli->verbosity < 0) { continue; }
        fprintf(stderr, "pelorus-sil: %s: refused %u bad checksum, %u bad length, %u bad value; %u frames accepted\n",
                PORTS[i].name, c->bad_checksum, c->bad_length, c->bad_value, c->frames);
    }
    return any;
}

int main(int argc, char **argv)
{
    char *command = describe_run(argc, argv);
    desktop_options_t options = {.command = command};
    cli_t cli = cli_start(&PROGRAM, argc, argv);
    for (int o = cli_next(&cli); o != CLI_END; o = cli_next(&cli)) {
        switch (o) {
        case OPT_OUT: options.output = cli.value; break;
        case OPT_CONFIG: options.config = cli.value; break;
        case OPT_REALTIME: options.realtime = true; break;
        case OPT_STORE: options.store = cli.value; break;
        case OPT_OUTAGE: add_outage(&cli, &options); break;
        default: break;
        }
    }
    cli_positional(&cli, 1, 1, "CAPTURE");
    if (options.output == NULL) { cli_fail(&cli, "no output: -o OUT"); }
    options.input = cli.rest[0];
    options.cli = &cli;

    int code = (options.config != NULL) ? check_config(options.config) : 0; /* before an earlier OUT is overwritten */
    if (code == 0) { code = desktop_open(&options); }
    if (code == 0 && options.config == NULL) { code = check_config(NULL); }
    if (code == 0) {
        firmware_main();
        code = desktop_close();
        if (code == 0 && tell_refused(&cli)) { code = EXIT_REFUSED; }
    }
    free(command);
    return code;
}

/* tape_main.c - pelorus-tape: a capture becomes the flat file that a board in an emulator reads (tape.h). */
#include "tape.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "cli.h"
#include "desktop.h"

enum { OPT_OUT };

static const cli_option_t OPTIONS[] = {{"output", 'o', "TAPE", "the file to write (required)"}};

static const cli_program_t PROGRAM = {
    "pelorus-tape",
    "CAPTURE -o TAPE",
    "Turn a capture into the flat file that firmware on an emulated board reads.",
    OPTIONS,
    (int)(sizeof OPTIONS / sizeof OPTIONS[0]),
    "The configuration comes from the capture's SETUP, as for pelorus-sil; without one the firmware has its default.",
};

static const char *const CHANNEL[] = {CAPTURE_UART_IMU, CAPTURE_UART_ROVER, CAPTURE_UART_BASE, CAPTURE_UART_AUX1};

/* pelorus-sil keeps the SETUP only if it is the first event. */
static int write_header(FILE *out, const capture_event_t *first)
{
    tape_header_t header = {TAPE_MAGIC, capture_gps_ns(first->t_us), 0, tape_layout()};
    pel_nav_config_t cfg;
    char text[1 << 16], why[256];
    memset(&cfg, 0, sizeof cfg);
    pel_nav_config_default(&cfg);
    if (strcmp(first->channel, CAPTURE_SETUP) == 0 && first->n < sizeof text) {
        memcpy(text, first->data, first->n);
        text[first->n] = '\0';
        const int code = desktop_config_from_text(text, "SETUP", &cfg, why, sizeof why);
        if (code != 0) {
            fprintf(stderr, "pelorus-tape: stored configuration refused: %s\n", why);
            return code;
        }
        header.config_bytes = sizeof cfg;
    }
    (void)fwrite(&header, sizeof header, 1, out);
    (void)fwrite(&cfg, header.config_bytes, 1, out);
    return 0;
}

static void write_record(FILE *out, const capture_event_t *e)
{
    for (uint32_t port = HAL_PORT_IMU; port <= HAL_PORT_AUX1; port++) {
        if (strcmp(e->channel, CHANNEL[port]) != 0 || e->n > TAPE_MAX_RUN) { continue; }
        const uint32_t word = port << 24 | (uint32_t)e->n;
        (void)fwrite(&word, sizeof word, 1, out);
        (void)fwrite(e->data, 1, e->n, out);
    }
}

static int convert(capture_log_t *in, FILE *out, const char *name)
{
    capture_event_t e;
    if (!capture_log_read(in, &e)) {
        fprintf(stderr, "pelorus-tape: %s holds no events of a capture\n", name);
        return EXIT_UNREADABLE;
    }
    const int code = write_header(out, &e);
    if (code != 0) { return code; }
    do {
        write_record(out, &e);
    } while (capture_log_read(in, &e));
    return (fflush(out) == 0 && ferror(out) == 0) ? EXIT_DONE : EXIT_UNREADABLE;
}

int main(int argc, char **argv)
{
    const char *output = NULL;
    capture_log_t in;
    cli_t cli = cli_start(&PROGRAM, argc, argv);
    for (int o = cli_next(&cli); o != CLI_END; o = cli_next(&cli)) {
        if (o == OPT_OUT) { output = cli.value; }
    }
    cli_positional(&cli, 1, 1, "CAPTURE");
    if (output == NULL) { cli_fail(&cli, "no output: -o TAPE"); }
    if (!capture_log_open(&in, cli.rest[0])) {
        fprintf(stderr, "pelorus-tape: cannot read %s: %s\n", cli.rest[0], strerror(errno));
        return EXIT_UNREADABLE;
    }
    FILE *out = fopen(output, "wb");
    int code = EXIT_UNREADABLE;
    if (out != NULL) { code = convert(&in, out, cli.rest[0]); }
    if (out == NULL || fclose(out) != 0) {
        fprintf(stderr, "pelorus-tape: cannot write %s: %s\n", output, strerror(errno));
        code = EXIT_UNREADABLE;
    }
    (void)capture_log_close(&in);
    return code;
}

/* cli.c - command lines: getopt_long, generated help, nearest names, progress bar. */
#define _POSIX_C_SOURCE 200809L

#include "cli.h"

#include <ctype.h>
#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "version.h"

#define MAX_OPTIONS 64
#define MAX_WORD    64

/* What every program knows, shown after its own options. Values are returned by getopt_long, above any index. */
enum { BUILT_IN = 1000, OPT_HELP = BUILT_IN, OPT_VERSION, OPT_VERBOSE, OPT_QUIET, N_BUILT_IN = 4 };
static const cli_option_t built_in[N_BUILT_IN] = {{"help", 'h', NULL, "show this and leave"},
                                                  {"version", 0, NULL, "show the version and leave"},
                                                  {"verbose", 'v', NULL, "say more (may be repeated)"},
                                                  {"quiet", 'q', NULL, "say only what went wrong"}};

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double start_s;

cli_t cli_start(const cli_program_t *program, int argc, char **argv)
{
    cli_t cli = {.program = program, .argc = argc, .argv = argv, .option = CLI_END};
    if (program->n_options > MAX_OPTIONS) { abort(); }
    start_s = seconds();
    opterr = 0;
    return cli;
}

static void print_option(const cli_option_t *o)
{
    char left[80];
    const char *sep = (o->arg != NULL) ? " " : "";
    const char *arg = (o->arg != NULL) ? o->arg : "";
    if (o->letter != 0) {
        snprintf(left, sizeof left, "-%c, --%s%s%s", o->letter, o->name, sep, arg);
    } else {
        snprintf(left, sizeof left, "    --%s%s%s", o->name, sep, arg);
    }
    printf("  %-28s %s\n", left, o->help);
}

static void print_help(const cli_program_t *p)
{
    printf("usage: %s %s\n%s\n\noptions:\n", p->program, p->usage, p->summary);
    for (int i = 0; i < p->n_options; i++) { print_option(&p->options[i]); }
    for (int i = 0; i < N_BUILT_IN; i++) { print_option(&built_in[i]); }
    if (p->notes != NULL) { printf("\n%s\n", p->notes); }
    printf("\nexit codes: 0 done, 1 a given limit was missed, 2 wrong usage, 3 input unreadable, 4 input partly "
           "refused\n");
}

void cli_fail(const cli_t *cli, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    fprintf(stderr, "%s: ", cli->program->program);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    exit(EXIT_USAGE);
}

/* Damerau-Levenshtein distance with neighbour swaps, case ignored; words are cut to MAX_WORD letters. */
static int distance(const char *a, const char *b)
{
    int d[3][MAX_WORD + 1]; /* rows i-2, i-1, i, taken in turn */
    const int na = (int)strnlen(a, MAX_WORD);
    const int nb = (int)strnlen(b, MAX_WORD);
    for (int j = 0; j <= nb; j++) { d[0][j] = j; }
    for (int i = 1; i <= na; i++) {
        int *row = d[i % 3];
        const int *up = d[(i + 2) % 3];
        const int *up2 = d[(i + 1) % 3];
        row[0] = i;
        for (int j = 1; j <= nb; j++) {
            const int ca = tolower((unsigned char)a[i - 1]);
            const int cb = tolower((unsigned char)b[j - 1]);
            int best = up[j - 1] + (ca != cb);
            if (up[j] + 1 < best) { best = up[j] + 1; }
            if (row[j - 1] + 1 < best) { best = row[j - 1] + 1; }
            if (i > 1 && j > 1 && ca == tolower((unsigned char)b[j - 2]) && tolower((unsigned char)a[i - 2]) == cb &&
                up2[j - 2] + 1 < best) {
                best = up2[j - 2] + 1;
            }
            row[j] = best;
        }
    }
    return d[na % 3][nb];
}

int cli_nearest(const char *word, const char *const *words, int n)
{
    int best = -1;
    int best_d = MAX_WORD;
    for (int i = 0; i < n; i++) {
        const size_t longer = (strlen(words[i]) > strlen(word)) ? strlen(words[i]) : strlen(word);
        const int d = distance(word, words[i]);
        if (d < best_d && 3 * (size_t)d <= longer + 1) {
            best_d = d;
            best = i;
        }
    }
    return best;
}

static void unknown_option(const cli_t *cli, const char *given)
{
    const cli_program_t *p = cli->program;
    const char *names[MAX_OPTIONS + N_BUILT_IN];
    char word[MAX_WORD + 1];
    int n = 0;
    for (int i = 0; i < p->n_options; i++) { names[n++] = p->options[i].name; }
    for (int i = 0; i < N_BUILT_IN; i++) { names[n++] = built_in[i].name; }
    if (strncmp(given, "--", 2) != 0) { cli_fail(cli, "unknown option '-%c' (see --help)", optopt); }
    snprintf(word, sizeof word, "%.*s", (int)strcspn(given + 2, "="), given + 2);
    const int near = cli_nearest(word, names, n);
    if (near < 0) { cli_fail(cli, "unknown option '--%s' (see --help)", word); }
    if (strcmp(word, names[near]) == 0) { cli_fail(cli, "option '--%s' takes no argument", word); }
    cli_fail(cli, "unknown option '--%s' (did you mean '--%s'?)", word, names[near]);
}

/* Tables for getopt_long from the program's own and the built-in options. */
static void make_tables(const cli_program_t *p, struct option *table, char *letters)
{
    int k = 0;
    letters[k++] = ':'; /* a missing argument is told apart from an unknown option */
    for (int i = 0; i < p->n_options + N_BUILT_IN; i++) {
        const bool own = i < p->n_options;
        const cli_option_t *o = own ? &p->options[i] : &built_in[i - p->n_options];
        const int code = own ? i : BUILT_IN + i - p->n_options;
        table[i] = (struct option){o->name, (o->arg != NULL) ? required_argument : no_argument, NULL, code};
        if (o->letter != 0) {
            letters[k++] = o->letter;
            if (o->arg != NULL) { letters[k++] = ':'; }
        }
    }
    table[p->n_options + N_BUILT_IN] = (struct option){0};
    letters[k] = '\0';
}

/* Code of a short option's letter: getopt_long returns the letter itself. */
static int code_of_letter(const cli_program_t *p, int letter)
{
    for (int i = 0; i < p->n_options; i++) {
        if (p->options[i].letter == letter) { return i; }
    }
    for (int i = 0; i < N_BUILT_IN; i++) {
        if (built_in[i].letter == letter) { return BUILT_IN + i; }
    }
    return -1;
}

int cli_next(cli_t *cli)
{
    const cli_program_t *p = cli->program;
    struct option table[MAX_OPTIONS + N_BUILT_IN + 1];
    char letters[2 * (MAX_OPTIONS + N_BUILT_IN) + 2];
    make_tables(p, table, letters);
    for (;;) {
        int index = -1;
        const int before = optind;
        int c = getopt_long(cli->argc, cli->argv, letters, table, &index);
        if (c == -1) {
            cli->rest = cli->argv + optind;
            cli->n_rest = cli->argc - optind;
            return CLI_END;
        }
        const char *given = cli->argv[(optind > before) ? optind - 1 : optind];
        if (c == ':') { cli_fail(cli, "option '%s' needs an argument (see --help)", given); }
        if (c == '?' && index < 0) { unknown_option(cli, given); }
        if (index < 0) { c = code_of_letter(p, c); }
        switch (c) {
        case OPT_HELP: print_help(p); exit(EXIT_DONE);
        case OPT_VERSION: printf("%s %s\n", p->program, PELORUS_VERSION); exit(EXIT_DONE);
        case OPT_VERBOSE: cli->verbosity++; continue;
        case OPT_QUIET: cli->verbosity--; continue;
        default: break;
        }
        cli->option = c;
        cli->value = optarg;
        return c;
    }
}

int64_t cli_integer(const cli_t *cli, int64_t low, int64_t high)
{
    char *end = NULL;
    errno = 0;
    const long long x = strtoll(cli->value, &end, 10);
    if (end == cli->value || *end != '\0' || errno != 0 || x < low || x > high) {
        cli_fail(cli, "option '--%s': '%s' is not a whole number from %lld to %lld",
                 cli->program->options[cli->option].name, cli->value, (long long)low, (long long)high);
    }
    return (int64_t)x;
}

double cli_number(const cli_t *cli, double low, double high)
{
    char *end = NULL;
    const double x = strtod(cli->value, &end);
    if (end == cli->value || *end != '\0' || !(x >= low && x <= high)) {
        cli_fail(cli, "option '--%s': '%s' is not a number from %g to %g", cli->program->options[cli->option].name,
                 cli->value, low, high);
    }
    return x;
}

int cli_word(const cli_t *cli, const char *const *words, int n)
{
    const char *name = cli->program->options[cli->option].name;
    for (int i = 0; i < n; i++) {
        if (strcmp(cli->value, words[i]) == 0) { return i; }
    }
    const int near = cli_nearest(cli->value, words, n);
    if (near >= 0) { cli_fail(cli, "option '--%s': unknown '%s' (did you mean '%s'?)", name, cli->value, words[near]); }
    cli_fail(cli, "option '--%s': unknown '%s' (see --help)", name, cli->value);
}

void cli_positional(const cli_t *cli, int min, int max, const char *what)
{
    if (cli->n_rest < min) { cli_fail(cli, "%s is missing (see --help)", what); }
    if (max >= 0 && cli->n_rest > max) { cli_fail(cli, "'%s' is one argument too many (see --help)", cli->rest[max]); }
}

void cli_progress(const cli_t *cli, double fraction)
{
    static double shown_s;
    enum { WIDTH = 40 };
    const double now = seconds();
    if (cli->verbosity < 0 || now - start_s < 2.0 || isatty(STDERR_FILENO) == 0) { return; }
    if (fraction >= 1.0) {
        fprintf(stderr, "\r\033[K");
        return;
    }
    if (now - shown_s < 0.2) { return; }
    shown_s = now;
    const int done = (int)(fraction * (double)WIDTH);
    fprintf(stderr, "\r[");
    for (int i = 0; i < WIDTH; i++) { fputc((i < done) ? '=' : ' ', stderr); }
    fprintf(stderr, "] %3.0f %%", 100.0 * fraction);
    fflush(stderr);
}

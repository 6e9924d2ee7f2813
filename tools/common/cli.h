/* cli.h - command lines that all programs read and explain the same way. Desktop only.
 *
 *   static const cli_option_t options[] = {{"json", 0, NULL, "one JSON object a problem"},
 *                                          {"nodes", 'n', "N", "node budget (default 20000)"}};
 *   static const cli_program_t program = {"pelorus-solve", "[options] FILE", "Solve integer ambiguity problems.",
 *                                         options, 2, NULL};
 *   cli_t cli = cli_start(&program, argc, argv);
 *   for (int o = cli_next(&cli); o != CLI_END; o = cli_next(&cli)) {
 *       switch (o) {                                        the index in options[]; cli.value is its argument
 *       case 0: json = true; break;
 *       case 1: nodes = cli_integer(&cli, 1, INT32_MAX); break;
 *       }
 *   }
 *   cli_positional(&cli, 1, 1, "FILE");                     cli.rest[0 .. cli.n_rest-1]
 *
 * --help, --version, -v, --verbose, -q, --quiet are known to every program and handled here. */
#ifndef PELORUS_TOOLS_CLI_H
#define PELORUS_TOOLS_CLI_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Exit codes of every program. */
enum {
    EXIT_DONE = 0,
    EXIT_LIMIT = 1,      /* ran, but a limit given to it was missed */
    EXIT_USAGE = 2,      /* wrong usage: one clear line */
    EXIT_UNREADABLE = 3, /* an input cannot be read (or an output not written) */
    EXIT_REFUSED = 4     /* input readable but partly refused, counts by cause */
};

typedef struct {
    const char *name; /* long name without dashes */
    char letter;      /* short name, 0: none */
    const char *arg;  /* name of its argument in the help, NULL: a flag */
    const char *help; /* one line */
} cli_option_t;

typedef struct {
    const char *program;
    const char *usage;   /* after the program's name: "[options] FILE" */
    const char *summary; /* one line */
    const cli_option_t *options;
    int n_options;
    const char *notes; /* more lines after the options, or NULL */
} cli_program_t;

typedef struct {
    const cli_program_t *program;
    int argc;
    char **argv;
    int verbosity;     /* 0; +1 for each -v, -1 for each -q */
    int option;        /* the one last returned */
    const char *value; /* its argument, NULL for a flag */
    char **rest;       /* positional arguments, once cli_next() has returned CLI_END */
    int n_rest;
} cli_t;

#define CLI_END (-1)

/* Begin. One command line a process (getopt_long underneath). */
cli_t cli_start(const cli_program_t *program, int argc, char **argv);

/* Index in options[] of the next option given, or CLI_END. Does not return on --help, --version (EXIT_DONE) or on an unknown
 * option or missing argument (EXIT_USAGE, with the nearest name). */
int cli_next(cli_t *cli);

/* The argument of the option last returned, as a number within [low, high]; else EXIT_USAGE. */
int64_t cli_integer(const cli_t *cli, int64_t low, int64_t high);
double cli_number(const cli_t *cli, double low, double high);

/* Exactly min..max positional arguments (max < 0: any number), else EXIT_USAGE; what names them: "CAPTURE". */
void cli_positional(const cli_t *cli, int min, int max, const char *what);

/* The argument of the option last returned as one of n words: its index; else EXIT_USAGE with the nearest word. */
int cli_word(const cli_t *cli, const char *const *words, int n);

/* Say one line "program: ..." on standard error and leave with EXIT_USAGE. */
#if defined(__GNUC__)
__attribute__((noreturn, format(printf, 2, 3)))
#endif
void cli_fail(const cli_t *cli, const char *format, ...);

/* Index of the word nearest to a misspelt one (fewest insertions, deletions, substitutions, neighbour swaps), -1 if none is
 * near enough to be meant: more than a third of its letters away. */
int cli_nearest(const char *word, const char *const *words, int n);

/* Progress bar on standard error, if that is a terminal, -q is not given and two seconds have passed since cli_start().
 * fraction 0..1; at 1 the line is wiped. Cheap enough to call often. */
void cli_progress(const cli_t *cli, double fraction);

#ifdef __cplusplus
}
#endif
#endif

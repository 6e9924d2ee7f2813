/* pelorus-solve - integer ambiguity problems in text -> best integer vectors, squared norms, ratio, nodes. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "common/cli.h"
#include "pelorus/ambiguity.h"
#include "problem_text.h"

#define NODES_DEFAULT 1000000

enum { OPT_JSON, OPT_NODES, OPT_BEST, OPT_METHOD };
static const cli_option_t options[] = {
    {"json", 'j', NULL, "one JSON object a problem"},
    {"nodes", 'n', "N", "node budget of a problem (default 1000000)"},
    {"best", 'b', "K", "candidates wanted, 1 to 4 (default 2)"},
    {"method", 'm', "NAME", "lambda (default), cholesky or fasf"},
};
static const cli_program_t program = {
    .program = "pelorus-solve",
    .usage = "[options] FILE",
    .summary =
        "Solve integer ambiguity problems: min over integers N of (a - N)' Q^-1 (a - N). FILE - is standard input.",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
    .notes = "A problem is a line n, n float ambiguities (cycles), n lines of the covariance (cycles^2; full or lower "
             "triangle).\n"
             "# begins a comment; several problems may follow one another. A problem that spends its budget makes the "
             "exit code 1,\n"
             "a refused one 4."};

typedef struct {
    bool json;
    int32_t nodes;
    int best;
    pel_ils_method_t method;
} settings_t;

static const char *const methods[] = {"lambda", "cholesky", "fasf"}; /* as pel_ils_method_t */

typedef struct {
    int optimal, budget, rejected;
} counts_t;

static pel_ils_t ils;

static const char *status_name(pel_status_t status)
{
    if (status == PEL_OK) { return "optimal"; }
    return (status == PEL_W_BUDGET) ? "budget" : "rejected";
}

static void print_vector(const int64_t *N, int n, const char *separator)
{
    for (int i = 0; i < n; i++) { printf("%s%" PRId64, (i > 0) ? separator : "", N[i]); }
}

/* "best":[...],"best_sq":x, with [] and null for a candidate that is not there. */
static void json_candidate(const char *name, int k)
{
    int64_t N[PEL_MAX_AMB];
    double sq;
    if (pel_ils_get(&ils, k, N, &sq) != PEL_OK) {
        printf("\"%s\":[],\"%s_sq\":null,", name, name);
        return;
    }
    printf("\"%s\":[", name);
    print_vector(N, ils.n, ",");
    printf("],\"%s_sq\":%.12g,", name, sq);
}

static void print_json(int n, pel_status_t status)
{
    printf("{\"n\":%d,\"status\":\"%s\",", n, status_name(status));
    json_candidate("best", 0);
    json_candidate("second", 1);
    if (ils.n_found >= 2 && ils.stage != PEL_ILS_EMPTY) {
        printf("\"ratio\":%.9g,", pel_ils_ratio(&ils));
    } else {
        printf("\"ratio\":null,");
    }
    printf("\"nodes\":%" PRId32 "}\n", (ils.stage != PEL_ILS_EMPTY) ? ils.nodes : 0);
}

static void print_text(int number, int n, pel_status_t status)
{
    static const char *const names[PEL_ILS_BEST] = {"best", "second", "third", "fourth"};
    printf("problem %d: n = %d, %s, %" PRId32 " nodes, ratio %.6f, success %.6f, ADOP %.4f cycles\n", number, n,
           status_name(status), ils.nodes, pel_ils_ratio(&ils), pel_ils_success(&ils), pel_ils_adop(&ils));
    for (int k = 0; k < ils.n_found; k++) {
        int64_t N[PEL_MAX_AMB];
        double sq;
        (void)pel_ils_get(&ils, k, N, &sq);
        printf("  %-6s %16.9f  ", names[k], sq);
        print_vector(N, n, " ");
        printf("\n");
    }
    if (status == PEL_W_BUDGET) {
        printf("  budget spent: no vector that was not visited has a squared norm below %.9f\n",
               pel_ils_lower_bound(&ils));
    }
}

static const char *refusal(pel_status_t status)
{
    if (status == PEL_E_NOT_POSDEF) { return "covariance is not positive definite"; }
    return "a value is not finite or out of range";
}

static void solve(const problem_text_t *p, int number, const settings_t *set, int verbosity, counts_t *count)
{
    pel_status_t status = PEL_E_FORMAT;
    const char *why = p->why;
    char too_large[64];
    ils.n = 0;
    ils.n_found = 0;
    ils.stage = PEL_ILS_EMPTY;
    if (why[0] == '\0' && p->n > PEL_MAX_AMB) {
        snprintf(too_large, sizeof too_large, "n = %d is more than %d", p->n, PEL_MAX_AMB);
        why = too_large;
    }
    if (why[0] == '\0') {
        status = pel_ils_init_as(&ils, set->method, p->n, p->a, p->Q, set->best, set->nodes);
        if (status == PEL_OK) { status = pel_ils_run(&ils, INT32_MAX); }
        if (status < 0) { why = refusal(status); }
    }
    count->optimal += status == PEL_OK;
    count->budget += status == PEL_W_BUDGET;
    count->rejected += status < 0;
    if (status < 0) { fprintf(stderr, "pelorus-solve: problem %d (line %d): %s\n", number, p->line, why); }
    if (set->json) {
        print_json(p->n, status);
    } else if (status >= 0) {
        print_text(number, p->n, status);
    } else {
        printf("problem %d: n = %d, rejected\n", number, p->n);
    }
    if (verbosity > 0 && status >= 0) {
        fprintf(stderr, "problem %d: %" PRId32 " exchanges%s, success %.9f, ADOP %.6f cycles\n", number, ils.swaps,
                ils.decorrelated ? "" : " (cap met)", pel_ils_success(&ils), pel_ils_adop(&ils));
    }
}

static settings_t read_options(cli_t *cli)
{
    settings_t set = {.nodes = NODES_DEFAULT, .best = 2};
    for (int o = cli_next(cli); o != CLI_END; o = cli_next(cli)) {
        switch (o) {
        case OPT_JSON: set.json = true; break;
        case OPT_NODES: set.nodes = (int32_t)cli_integer(cli, 1, INT32_MAX); break;
        case OPT_METHOD: set.method = (pel_ils_method_t)cli_word(cli, methods, 3); break;
        case OPT_BEST: set.best = (int)cli_integer(cli, 1, PEL_ILS_BEST); break;
        default: break;
        }
    }
    cli_positional(cli, 1, 1, "FILE");
    return set;
}

int main(int argc, char **argv)
{
    cli_t cli = cli_start(&program, argc, argv);
    const settings_t set = read_options(&cli);
    const char *path = cli.rest[0];
    FILE *f = (strcmp(path, "-") == 0) ? stdin : fopen(path, "r");
    if (f == NULL) {
        fprintf(stderr, "pelorus-solve: %s: %s\n", path, strerror(errno));
        return EXIT_UNREADABLE;
    }

    counts_t count = {0};
    problem_reader_t reader;
    problem_reader_open(&reader, f);
    int number = 0;
    for (const problem_text_t *p = problem_reader_next(&reader); p != NULL; p = problem_reader_next(&reader)) {
        solve(p, ++number, &set, cli.verbosity, &count);
    }
    const bool broken = ferror(f) != 0;
    const int stray = reader.stray;
    problem_reader_close(&reader);
    if (f != stdin) { fclose(f); }

    if (broken || number == 0) {
        fprintf(stderr, "pelorus-solve: %s: %s\n", path, broken ? "cannot be read" : "no problem in it");
        return EXIT_UNREADABLE;
    }
    if (stray > 0) { fprintf(stderr, "pelorus-solve: %s: %d lines between problems belong to none\n", path, stray); }
    if (cli.verbosity > 0) {
        fprintf(stderr, "%d problems: %d optimal, %d budget spent, %d rejected\n", number, count.optimal, count.budget,
                count.rejected);
    }
    if (count.rejected > 0 || stray > 0) { return EXIT_REFUSED; }
    return (count.budget > 0) ? EXIT_LIMIT : EXIT_DONE;
}

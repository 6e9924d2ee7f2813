/* pelorus-bench - instructions of the pieces of work in cases.c: on the desktop with callgrind, on Cortex-M4F and M7 in QEMU, beside
 * the budgets of the design and a filter with a full covariance.
 *
 * The program runs itself under callgrind, which writes one dump per measured call. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/bench.h"
#include "common/cli.h"

#define MAX_CASES 64

enum { OPT_HOST, OPT_MEASURE, OPT_CSV };
static const cli_option_t options[] = {
    {"host-only", 0, NULL, "do not count on emulated boards"},
    {"measure", 0, NULL, "run every case once and print nothing (what callgrind watches)"},
    {"csv", 0, NULL, "comma-separated values instead of a table"},
};
static const cli_program_t program = {
    .program = "pelorus-bench",
    .usage = "[options]",
    .summary = "Count instructions of the filter's and the strapdown's pieces of work.",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
    .notes = "Desktop counts need valgrind; Cortex-M counts need arm-none-eabi-gcc and qemu-system-arm. What is "
             "missing is left out.\n"
             "Budgets are for Cortex-M4F (the strapdown step: M7).",
};

/* Counts by case, per unit of work; -1: not counted. */
typedef struct {
    long host[MAX_CASES], m4f[MAX_CASES], m7[MAX_CASES];
} counts_t;

__attribute__((noinline)) void bench_measured(void (*body)(void));

__attribute__((noinline)) void bench_measured(void (*body)(void))
{
    body();
    __asm__ volatile("" ::: "memory");
}

static void measure(void)
{
    for (int i = 0; i < bench_n_cases; i++) {
        bench_cases[i].prepare();
        bench_measured(bench_cases[i].body);
    }
}

/* The number after "summary:" or "totals:" of a callgrind dump, -1 if there is none. */
static long dump_total(const char *path)
{
    FILE *f = fopen(path, "r");
    char line[512];
    long total = -1;
    while (f != NULL && fgets(line, sizeof line, f) != NULL) {
        if (sscanf(line, "summary: %ld", &total) == 1 || sscanf(line, "totals: %ld", &total) == 1) { break; }
    }
    if (f != NULL) { (void)fclose(f); }
    return total;
}

static void remove_folder(const char *folder)
{
    DIR *d = opendir(folder);
    for (struct dirent *e = (d != NULL) ? readdir(d) : NULL; e != NULL; e = readdir(d)) {
        char path[512];
        (void)snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
        (void)unlink(path);
    }
    if (d != NULL) { (void)closedir(d); }
    (void)rmdir(folder);
}

static void count_host(const char *self, long out[MAX_CASES])
{
    char folder[] = "/tmp/pelorus-bench-XXXXXX";
    char command[1024];
    if (mkdtemp(folder) == NULL) { return; }
    (void)snprintf(
        command, sizeof command,
        "valgrind --tool=callgrind --collect-atstart=no --toggle-collect=bench_measured --dump-after=bench_measured "
        "--callgrind-out-file=%s/out '%s' --measure >/dev/null 2>&1",
        folder, self);
    if (system(command) == 0) {
        for (int i = 0; i < bench_n_cases; i++) {
            char path[512];
            (void)snprintf(path, sizeof path, "%s/out.%d", folder, i + 1);
            const long total = dump_total(path);
            out[i] = (total >= 0) ? total / bench_cases[i].per : -1;
        }
    }
    remove_folder(folder);
}

static void count_board(const char *core, long out[MAX_CASES])
{
    char line[512];
    (void)snprintf(line, sizeof line, "bash '%s/tools/bench/target.sh' %s '%s' 2>/dev/null", PEL_SOURCE_DIR, core,
                   PEL_BENCH_DIR);
    FILE *pipe = popen(line, "r");
    while (pipe != NULL && fgets(line, sizeof line, pipe) != NULL) {
        char *tab = strchr(line, '\t');
        if (tab == NULL) { continue; }
        *tab = '\0';
        for (int i = 0; i < bench_n_cases; i++) {
            if (strcmp(line, bench_cases[i].name) == 0) { out[i] = strtol(tab + 1, NULL, 10); }
        }
    }
    if (pipe != NULL) { (void)pclose(pipe); }
}

static int find(const char *name)
{
    for (int i = 0; i < bench_n_cases; i++) {
        if (strcmp(bench_cases[i].name, name) == 0) { return i; }
    }
    return -1;
}

static const char *number(long n, char text[24])
{
    if (n < 0) { return "-"; }
    (void)snprintf(text, 24, "%ld", n);
    return text;
}

static void print_case(const counts_t *c, int i, bool csv)
{
    char text[6][24];
    const bench_case_t *b = &bench_cases[i];
    const int twin = find(b->against);
    const bool m7 = strstr(b->name, "M7") != NULL;
    const long board = m7 ? c->m7[i] : c->m4f[i];
    const char *verdict = (b->budget == 0 || board < 0) ? "" : ((board <= b->budget) ? "within" : "over");
    char ratio[16] = "";
    if (twin >= 0 && c->m4f[twin] > 0 && c->m4f[i] > 0) {
        (void)snprintf(ratio, sizeof ratio, "%.1f", (double)c->m4f[twin] / (double)c->m4f[i]);
    } else if (twin >= 0 && c->host[twin] > 0 && c->host[i] > 0) {
        (void)snprintf(ratio, sizeof ratio, "%.1f", (double)c->host[twin] / (double)c->host[i]);
    }
    printf(csv ? "%s,%s,%s,%s,%s,%s,%s,%s\n" : "%-48s %9s %9s %9s %9s %-7s %9s %6s\n", b->name,
           number(c->host[i], text[0]), number(c->m4f[i], text[1]), number(c->m7[i], text[2]),
           (b->budget > 0) ? number(b->budget, text[3]) : "", verdict,
           (twin >= 0) ? number((c->m4f[twin] > 0) ? c->m4f[twin] : c->host[twin], text[4]) : "", ratio);
}

int main(int argc, char **argv)
{
    bool host_only = false;
    bool csv = false;
    cli_t cli = cli_start(&program, argc, argv);
    for (int o = cli_next(&cli); o != CLI_END; o = cli_next(&cli)) {
        switch (o) {
        case OPT_HOST: host_only = true; break;
        case OPT_MEASURE: measure(); return EXIT_DONE;
        case OPT_CSV: csv = true; break;
        default: break;
        }
    }
    cli_positional(&cli, 0, 0, "");

    char self[512];
    const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    self[(length > 0) ? length : 0] = '\0';
    static counts_t c;
    for (int i = 0; i < MAX_CASES; i++) { c.host[i] = c.m4f[i] = c.m7[i] = -1; }
    count_host(self, c.host);
    if (!host_only) {
        count_board("m4f", c.m4f);
        count_board("m7", c.m7);
    }
    printf(csv ? "%s,%s,%s,%s,%s,%s,%s,%s\n" : "%-48s %9s %9s %9s %9s %-7s %9s %6s\n", "instructions", "desktop", "M4F",
           "M7", "budget", "", "dense", "ratio");
    for (int i = 0; i < bench_n_cases; i++) { print_case(&c, i, csv); }
    if (c.host[0] < 0) { printf("desktop counts: valgrind is missing or failed (Debian: apt-get install valgrind)\n"); }
    if (!host_only && c.m4f[0] < 0) {
        printf("M4F and M7 counts: arm-none-eabi-gcc or qemu-system-arm is missing (Debian: gcc-arm-none-eabi "
               "libnewlib-arm-none-eabi qemu-system-arm)\n");
    }
    return EXIT_DONE;
}

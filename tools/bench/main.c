/* pelorus-bench - instructions of the pieces of work in cases.c: on the desktop with callgrind, on Cortex-M4F and M7 in QEMU, beside
 * the budgets of the design and a filter with a full covariance.
 *
 * The program runs itself under callgrind, which writes one dump per measured call. */
#include <dirent.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/bench.h"
#include "bench/integers.h"
#include "common/cli.h"
#include "pelorus/ambiguity.h"

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
    .summary = "Count instructions of the filter's, the strapdown's and the integers' pieces of work.",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
    .notes = "Desktop counts need valgrind; Cortex-M counts need arm-none-eabi-gcc and qemu-system-arm. What is "
             "missing is left out.\n"
             "Budgets are for Cortex-M4F (the strapdown step: M7).",
};

/* Counts by case, per unit of work; -1: not counted. */
typedef struct {
    long host[MAX_CASES], m4f[MAX_CASES], m7[MAX_CASES];
    long integers_host[BENCH_SIZES], integers_m4f[BENCH_SIZES], integers_m7[BENCH_SIZES];
    long rtklib_host[BENCH_SIZES];
} counts_t;

typedef int (*lambda_t)(int n, int m, const double *a, const double *Q, double *F, double *s);

/* lambda() of librtklib, NULL if it is not installed. */
static lambda_t rtklib_lambda(void)
{
    lambda_t f = NULL;
    void *lib = dlopen("libRTKLib.so.1", RTLD_LAZY | RTLD_GLOBAL);
    void *symbol = (lib != NULL) ? dlsym(lib, "lambda") : NULL;
    memcpy(&f, &symbol, sizeof f);
    return f;
}

static void rtklib_integers(void)
{
    static lambda_t lambda;
    if (lambda == NULL) { lambda = rtklib_lambda(); }
    const double *a, *Q;
    double F[2 * 64], sq[2];
    const int n = bench_integers_problem(&a, &Q);
    if (lambda != NULL) { (void)lambda(n, 2, a, Q, F, sq); }
}

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
    bench_integers_prepare(0, 0);
    rtklib_integers(); /* finds its functions */
    for (int i = 0; i < BENCH_SIZES * BENCH_PROBLEMS; i++) {
        bench_integers_prepare(i / BENCH_PROBLEMS, i % BENCH_PROBLEMS);
        bench_measured(bench_integers);
        bench_measured(rtklib_integers);
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

static long dump_of_call(const char *folder, int call)
{
    char path[512];
    (void)snprintf(path, sizeof path, "%s/out.%d", folder, call + 1);
    return dump_total(path);
}

/* Dumps in the order of measure(). */
static void read_dumps(const char *folder, counts_t *c)
{
    for (int i = 0; i < bench_n_cases; i++) {
        const long total = dump_of_call(folder, i);
        c->host[i] = (total >= 0) ? total / bench_cases[i].per : -1;
    }
    for (int size = 0; size < BENCH_SIZES; size++) {
        long ours[BENCH_PROBLEMS], theirs[BENCH_PROBLEMS];
        for (int k = 0; k < BENCH_PROBLEMS; k++) {
            const int call = bench_n_cases + 2 * (size * BENCH_PROBLEMS + k);
            ours[k] = dump_of_call(folder, call);
            theirs[k] = dump_of_call(folder, call + 1);
        }
        c->integers_host[size] = bench_median(ours, BENCH_PROBLEMS);
        if (rtklib_lambda() != NULL) { c->rtklib_host[size] = bench_median(theirs, BENCH_PROBLEMS); }
    }
}

static void count_host(const char *self, counts_t *c)
{
    char folder[] = "/tmp/pelorus-bench-XXXXXX";
    char command[1024];
    if (mkdtemp(folder) == NULL) { return; }
    (void)snprintf(
        command, sizeof command,
        "valgrind --tool=callgrind --collect-atstart=no --toggle-collect=bench_measured --dump-after=bench_measured "
        "--callgrind-out-file=%s/out '%s' --measure >/dev/null 2>&1",
        folder, self);
    if (system(command) == 0) { read_dumps(folder, c); }
    remove_folder(folder);
}

static void count_board(const char *core, long out[MAX_CASES], long integers[BENCH_SIZES])
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
        for (int i = 0, n; i < BENCH_SIZES; i++) {
            if (sscanf(line, "integers %d", &n) == 1 && n == bench_sizes[i]) {
                integers[i] = strtol(tab + 1, NULL, 10);
            }
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

static const char *share(long ours, long theirs, char text[16])
{
    if (ours < 0 || theirs <= 0) { return "-"; }
    (void)snprintf(text, 16, "%.2f", (double)ours / (double)theirs);
    return text;
}

/* Bytes beside instructions; silent without a cross compiler. */
static void print_engine_bytes(void)
{
    char line[1024];
    long code, frame;
    (void)snprintf(line, sizeof line, "bash '%s/tools/bench/engine_bytes.sh' '%s' 2>/dev/null", PEL_SOURCE_DIR,
                   PEL_BENCH_DIR);
    FILE *pipe = popen(line, "r");
    if (pipe == NULL) { return; }
    if (fscanf(pipe, "%ld %ld", &code, &frame) == 2) {
        printf("on M4F: %ld bytes of code, %zu of state at n = %d, %ld in the largest stack frame (RTKLIB: 53 KB of "
               "heap at n = 40)\n",
               code, sizeof(pel_ils_t), PEL_MAX_AMB, frame);
    }
    (void)pclose(pipe);
}

static void print_integers(const counts_t *c, bool csv)
{
    /* lambda() of RTKLIB 2.4.3 recompiled to float for Cortex-M4F on the problems of the design; not run here. */
    static const long rtklib_float[BENCH_SIZES] = {22600, -1, -1, 482000, -1, 3060000};
    printf(csv ? "%s,%s,%s,%s,%s,%s,%s,%s\n" : "\n%-28s %9s %9s %6s %9s %9s %9s %6s\n", "integers, best two, median",
           "desktop", "RTKLIB", "share", "M7", "M4F", "RTKLIB f", "share");
    for (int i = 0; i < BENCH_SIZES; i++) {
        char name[16], text[5][24], shares[2][16];
        (void)snprintf(name, sizeof name, "n = %d", bench_sizes[i]);
        printf(csv ? "%s,%s,%s,%s,%s,%s,%s,%s\n" : "%-28s %9s %9s %6s %9s %9s %9s %6s\n", name,
               number(c->integers_host[i], text[0]), number(c->rtklib_host[i], text[1]),
               share(c->integers_host[i], c->rtklib_host[i], shares[0]), number(c->integers_m7[i], text[2]),
               number(c->integers_m4f[i], text[3]), number(rtklib_float[i], text[4]),
               share(c->integers_m4f[i], rtklib_float[i], shares[1]));
    }
    if (!csv) { print_engine_bytes(); }
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
    for (int i = 0; i < BENCH_SIZES; i++) {
        c.integers_host[i] = c.rtklib_host[i] = c.integers_m4f[i] = c.integers_m7[i] = -1;
    }
    count_host(self, &c);
    if (!host_only) {
        count_board("m4f", c.m4f, c.integers_m4f);
        count_board("m7", c.m7, c.integers_m7);
    }
    printf(csv ? "%s,%s,%s,%s,%s,%s,%s,%s\n" : "%-48s %9s %9s %9s %9s %-7s %9s %6s\n", "instructions", "desktop", "M4F",
           "M7", "budget", "", "dense", "ratio");
    for (int i = 0; i < bench_n_cases; i++) { print_case(&c, i, csv); }
    print_integers(&c, csv);
    if (c.host[0] < 0) { printf("desktop counts: valgrind is missing or failed (Debian: apt-get install valgrind)\n"); }
    if (!host_only && c.m4f[0] < 0) {
        printf("M4F and M7 counts: arm-none-eabi-gcc or qemu-system-arm is missing (Debian: gcc-arm-none-eabi "
               "libnewlib-arm-none-eabi qemu-system-arm)\n");
    }
    return EXIT_DONE;
}

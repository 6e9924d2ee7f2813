/* main.c - pelorus-flips: thousands of lives with one flipped bit each, in processes that may die of it. */
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli.h"
#include "trial.h"

#define MAX_WORKERS 16
#define MAX_MEMBERS 64
#define HANG_S      5

enum { OPT_FLIPS, OPT_SEED, OPT_WORKERS, OPT_BIT };

static const cli_option_t OPTIONS[] = {
    {"flips", 'n', "N", "how many (20000)"},
    {"seed", 0, "N", "of the dice (1)"},
    {"workers", 'j', "N", "processes (2)"},
    {"bit", 0, "MOMENT,BIT", "one flip alone, as a silent one is told with --verbose"},
};

static const cli_program_t PROGRAM = {"pelorus-flips",
                                      "[options] CAPTURE",
                                      "Flip one random bit of the firmware's whole static state at a random moment, "
                                      "live on, and class what became of it.",
                                      OPTIONS,
                                      (int)(sizeof OPTIONS / sizeof OPTIONS[0]),
                                      "Prints a table of members. Exit code 1 if a life crashed or hung."};

/* Shared with the workers. */
typedef struct {
    struct {
        int next, moment; /* the trial that runs */
        size_t bit;
    } worker[MAX_WORKERS];
    uint32_t count[MAX_MEMBERS][N_VERDICTS];
    uint32_t dead[MAX_MEMBERS];
} shared_t;

static shared_t *shared;

static uint64_t splitmix(uint64_t *s)
{
    uint64_t z = (*s += UINT64_C(0x9E3779B97F4A7C15));
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return z ^ (z >> 31);
}

static void draw(uint64_t seed, int trial, int *moment, size_t *bit)
{
    uint64_t s = seed * UINT64_C(1000003) + (uint64_t)trial;
    *bit = (size_t)(splitmix(&s) % (8u * sizeof(state_t)));
    *moment = (int)(splitmix(&s) % (uint64_t)trial_n_moments());
}

static void work(int w, int workers, int flips, uint64_t seed, bool verbose)
{
    const struct itimerval patience = {{0, 0}, {HANG_S, 0}};
    for (int i = shared->worker[w].next; i < flips; i += workers) {
        size_t bit, size;
        int moment;
        const char *what = "";
        draw(seed, i, &moment, &bit);
        shared->worker[w].bit = bit;
        shared->worker[w].moment = moment;
        shared->worker[w].next = i + workers;
        (void)setitimer(ITIMER_REAL, &patience, NULL);
        const verdict_t v = trial_run(moment, bit, &what);
        (void)__atomic_fetch_add(&shared->count[member_index(bit / 8)][v], 1, __ATOMIC_RELAXED);
        if (verbose && v == SILENT) {
            fprintf(stderr, "silent: %s error after moment %d, bit %zu (%s)\n", what, moment, bit,
                    member_of(bit / 8, &size));
        }
    }
    _exit(0);
}

static pid_t start(int w, int workers, int flips, uint64_t seed, bool verbose)
{
    (void)fflush(NULL);
    const pid_t pid = fork();
    if (pid == 0) { work(w, workers, flips, seed, verbose); }
    return pid;
}

/* Returns how many lives ended their process. A worker that died goes on with its next trial. */
static int run_all(int workers, int flips, uint64_t seed, bool verbose)
{
    pid_t pid[MAX_WORKERS];
    int running = workers, deaths = 0;
    for (int w = 0; w < workers; w++) {
        shared->worker[w].next = w;
        pid[w] = start(w, workers, flips, seed, verbose);
    }
    while (running > 0) {
        int status = 0, w = 0;
        const pid_t ended = wait(&status);
        while (w < workers && pid[w] != ended) { w++; }
        if (w == workers || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) {
            running--;
            continue;
        }
        size_t size;
        const size_t bit = shared->worker[w].bit;
        fprintf(stderr, "pelorus-flips: %s: moment %d, bit %zu (%s)\n",
                (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) ? "hung" : "died", shared->worker[w].moment, bit,
                member_of(bit / 8, &size));
        shared->dead[member_index(bit / 8)]++;
        deaths++;
        pid[w] = start(w, workers, flips, seed, verbose);
    }
    return deaths;
}

static void print_row(const char *name, size_t size, const uint32_t count[N_VERDICTS], uint32_t dead)
{
    printf("| %s | %zu | %u | %u | %u | %u | %u |\n", name, size, count[MASKED], count[RECOVERED], count[STOPPED],
           count[SILENT], dead);
}

static void print_table(void)
{
    uint32_t all[N_VERDICTS] = {0}, dead = 0, flips = 0;
    printf(
        "| member | bytes | masked | recovered | safe-stopped | silent | crashed |\n|---|---|---|---|---|---|---|\n");
    for (int i = 0; i < member_count(); i++) {
        size_t size;
        const char *name = member_name(i, &size);
        print_row(name, size, shared->count[i], shared->dead[i]);
        for (int v = 0; v < N_VERDICTS; v++) { all[v] += shared->count[i][v]; }
        dead += shared->dead[i];
    }
    print_row("**all**", sizeof(state_t), all, dead);
    for (int v = 0; v < N_VERDICTS; v++) { flips += all[v]; }
    flips += dead;
    printf("\n%u flips: %.2f %% masked, %.2f %% recovered, %.2f %% safe-stopped, %.3f %% silent beyond a bound, %u "
           "crashed.\n",
           flips, 100.0 * all[MASKED] / flips, 100.0 * all[RECOVERED] / flips, 100.0 * all[STOPPED] / flips,
           100.0 * all[SILENT] / flips, dead);
}

static int one_flip(const char *text)
{
    static const char *const WORD[N_VERDICTS] = {"masked", "recovered", "safe-stopped", "silent"};
    int moment;
    size_t bit, size;
    const char *what = "";
    if (sscanf(text, "%d,%zu", &moment, &bit) != 2 || moment < 0 || moment >= trial_n_moments() ||
        bit >= 8 * sizeof(state_t)) {
        return EXIT_USAGE;
    }
    const verdict_t v = trial_run(moment, bit, &what);
    printf("%s %s (%s, byte %zu)\n", WORD[v], what, member_of(bit / 8, &size), bit / 8);
    return 0;
}

int main(int argc, char **argv)
{
    int flips = 20000, workers = 2;
    uint64_t seed = 1;
    const char *bit = NULL;
    cli_t cli = cli_start(&PROGRAM, argc, argv);
    for (int o = cli_next(&cli); o != CLI_END; o = cli_next(&cli)) {
        switch (o) {
        case OPT_FLIPS: flips = atoi(cli.value); break;
        case OPT_SEED: seed = strtoull(cli.value, NULL, 10); break;
        case OPT_WORKERS: workers = atoi(cli.value); break;
        case OPT_BIT: bit = cli.value; break;
        default: break;
        }
    }
    cli_positional(&cli, 1, 1, "CAPTURE");
    if (flips < 1 || workers < 1 || workers > MAX_WORKERS || member_count() > MAX_MEMBERS) {
        cli_fail(&cli, "--flips is at least 1, --workers 1 to %d", MAX_WORKERS);
    }
    if (!trial_prepare(cli.rest[0])) { return EXIT_UNREADABLE; }
    if (bit != NULL) { return one_flip(bit); }
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) { return 3; }
    const int deaths = run_all(workers, flips, seed, cli.verbosity > 0);
    print_table();
    return (deaths > 0) ? 1 : 0;
}

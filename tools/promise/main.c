/* pelorus-promise - how often wrong integers are accepted, beside how often that was promised, on simulated epochs. */
#include <stdio.h>
#include <string.h>

#include "common/cli.h"
#include "promise/epochs.h"

#define NODES 20000

enum { OPT_EPOCHS, OPT_SEED, OPT_NOISE, OPT_CSV };
static const cli_option_t options[] = {
    {"epochs", 'n', "N", "epochs to simulate (default 100000)"},
    {"seed", 's', "S", "of the random numbers (default 1)"},
    {"noise", 0, "FACTOR", "errors are this many times what the model says (default 1)"},
    {"csv", 0, NULL, "comma-separated values instead of a table"},
};
static const cli_program_t program = {
    .program = "pelorus-promise",
    .usage = "[options]",
    .summary = "Simulate epochs, resolve their integers, count wrong ones that are accepted beside the promised rate.",
    .options = options,
    .n_options = sizeof options / sizeof options[0],
    .notes = "Epochs are sorted into classes by the number of integers, and by the bootstrapped failure rate P of the\n"
             "model. `wrong` counts what the ratio alone accepts; `believed` what all verdicts accept. `proved` is\n"
             "pel_ils_ratio_bound(), `promise` pel_ils_ratio_needed().\n"};

/* What decides: a promised failure rate, the proved bound of one alone, or a fixed ratio. */
typedef struct {
    const char *name;
    double failure_max, bound_of, ratio_min;
} rule_t;

static const rule_t rules[] = {
    {"promise", 0.1, 0.0, 1.0},  {"promise", 0.01, 0.0, 1.0}, {"promise", 0.001, 0.0, 1.0},
    {"promise", 1e-4, 0.0, 1.0}, {"proved", 0.0, 0.01, 1.0},  {"proved", 0.0, 0.001, 1.0},
    {"ratio", 0.0, 0.0, 1.5},    {"ratio", 0.0, 0.0, 2.0},    {"ratio", 0.0, 0.0, 3.0},
};
#define RULES ((int)(sizeof rules / sizeof rules[0]))

typedef struct {
    const char *name; /* what is within [low, high) */
    double low, high;
} class_t;

static const class_t classes[] = {
    {"all", 0, 1e9}, {"n", 4, 7},      {"n", 7, 11},      {"n", 11, 16},     {"n", 16, 25},      {"n", 25, 41},
    {"P", 0.5, 1.1}, {"P", 0.15, 0.5}, {"P", 0.05, 0.15}, {"P", 0.01, 0.05}, {"P", 0.001, 0.01}, {"P", -1.0, 0.001},
};
#define CLASSES ((int)(sizeof classes / sizeof classes[0]))

typedef struct {
    int epochs, unsolved, wrong; /* wrong: the best vector, accepted or not */
    int fixed[RULES], fixed_wrong[RULES], believed[RULES], believed_wrong[RULES];
} tally_t;

/* What became of one epoch. */
typedef struct {
    int n;
    double failure; /* 1 - bootstrapped success */
    bool solved, wrong;
    bool fixed[RULES], believed[RULES];
} outcome_t;

static outcome_t resolve(const promise_epoch_t *e, pel_ils_t *ils)
{
    outcome_t o = {.n = e->problem.n_rows, .failure = 1.0};
    int64_t N[PEL_MAX_AMB];
    if (pel_amb_float(&e->problem, ils, 2, NODES) != PEL_OK) { return o; }
    o.failure = 1.0 - pel_ils_success(ils);
    o.solved = pel_ils_run(ils, NODES) == PEL_OK;
    if (!o.solved) { return o; }
    (void)pel_ils_get(ils, 0, N, NULL);
    o.wrong = memcmp(N, e->truth, sizeof N[0] * (size_t)o.n) != 0;
    for (int k = 0; k < RULES; k++) {
        pel_int_limits_t limits;
        pel_int_verdict_t v;
        pel_int_limits_default(&limits);
        limits.ratio_min = (rules[k].bound_of > 0.0) ? pel_ils_ratio_bound(ils, rules[k].bound_of) : rules[k].ratio_min;
        limits.failure_max = rules[k].failure_max;
        (void)pel_int_validate(&e->problem, ils, &limits, &v);
        o.fixed[k] = (v.failed & (1u << PEL_INT_RATIO)) == 0;
        o.believed[k] = v.reason == PEL_INT_OK;
    }
    return o;
}

static void count(const outcome_t *o, tally_t *t)
{
    t->epochs++;
    t->unsolved += !o->solved;
    t->wrong += o->wrong;
    for (int k = 0; k < RULES; k++) {
        t->fixed[k] += o->fixed[k];
        t->fixed_wrong[k] += o->fixed[k] && o->wrong;
        t->believed[k] += o->believed[k];
        t->believed_wrong[k] += o->believed[k] && o->wrong;
    }
}

static bool belongs(const class_t *c, const outcome_t *o)
{
    const double value = (c->name[0] == 'P') ? o->failure : o->n;
    return value >= c->low && value < c->high;
}

static void print(const tally_t *t, const class_t *c, bool csv)
{
    char name[32];
    if (c->name[0] == 'P') {
        (void)snprintf(name, sizeof name, "P %g..%g", (c->low < 0.0) ? 0.0 : c->low, (c->high > 1.0) ? 1.0 : c->high);
    } else {
        (void)snprintf(name, sizeof name, (c->name[0] == 'n') ? "n %g..%g" : "all", c->low, c->high - 1.0);
    }
    for (int k = 0; k < RULES; k++) {
        const double rate = rules[k].failure_max + rules[k].bound_of;
        const double limit = (rate > 0.0) ? rate : rules[k].ratio_min;
        printf(csv ? "%s,%s,%g,%d,%d,%d,%d,%d,%d,%d\n" : "%-16s %-8s %7g %8d %6d %8d %8d %7d %8d %7d\n", name,
               rules[k].name, limit, t->epochs, t->unsolved, t->wrong, t->fixed[k], t->fixed_wrong[k], t->believed[k],
               t->believed_wrong[k]);
    }
}

int main(int argc, char **argv)
{
    int epochs = 100000;
    rng_t r = {1};
    double noise = 1.0;
    bool csv = false;
    cli_t cli = cli_start(&program, argc, argv);
    for (int o = cli_next(&cli); o != CLI_END; o = cli_next(&cli)) {
        switch (o) {
        case OPT_EPOCHS: epochs = (int)cli_integer(&cli, 1, 100000000); break;
        case OPT_SEED: r.s = (uint64_t)cli_integer(&cli, 0, INT64_MAX); break;
        case OPT_NOISE: noise = cli_number(&cli, 0.01, 100.0); break;
        case OPT_CSV: csv = true; break;
        default: break;
        }
    }
    cli_positional(&cli, 0, 0, "");

    static tally_t tally[CLASSES];
    static promise_epoch_t e;
    static pel_ils_t ils;
    for (int i = 0; i < epochs; i++) {
        promise_epoch(&r, noise, &e);
        const outcome_t o = resolve(&e, &ils);
        for (int c = 0; c < CLASSES; c++) {
            if (belongs(&classes[c], &o)) { count(&o, &tally[c]); }
        }
    }
    printf(csv ? "%s,%s,%s,%s,%s,%s,%s,%s,%s,%s\n" : "%-16s %-8s %7s %8s %6s %8s %8s %7s %8s %7s\n", "class", "rule",
           "limit", "epochs", "budget", "wrong_ml", "fixed", "wrong", "believed", "wrong");
    for (int c = 0; c < CLASSES; c++) { print(&tally[c], &classes[c], csv); }
    return EXIT_DONE;
}

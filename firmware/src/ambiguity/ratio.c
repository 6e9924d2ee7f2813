/* ratio.c - the ratio that keeps wrong integers below a promised probability. Derivation and measurement: docs/INTEGERS.md. */
#include "ambiguity_internal.h"
#include "pelorus/math.h"

#define LOG_RATIO_MAX 20.7 /* 1e9 */
#define HALVINGS      20

/* The measured law's range, and its exponent times n. */
#define LAW_FAILURE_MIN 1e-4
#define LAW_FAILURE_MAX 0.1
#define LAW_SLOPE       2.8
#define LAW_SLOPE_N     0.01

/* Sum over all integers k but 0 of exp(-x k^2): directly, or by Poisson's formula where that has the fewer terms. */
static double theta_less_one(double x)
{
    if (x >= PEL_PI) { return 2.0 * (pel_exp(-x) + pel_exp(-4.0 * x)); }
    const double y = PEL_PI * PEL_PI / x;
    return pel_sqrt(PEL_PI / x) * (1.0 + 2.0 * (pel_exp(-y) + pel_exp(-4.0 * y))) - 1.0;
}

/* Bound of the probability that some wrong vector is `ratio` times better than the true one, with Chernoff's parameter u in (1, ratio). */
static double wrong_with(const pel_ils_t *s, double ratio, double u)
{
    const double m = ratio / (ratio - 1.0);
    const double kappa = 0.5 * m * m * (1.0 - 1.0 / u) * (1.0 - u / ratio);
    double sum = 0.0; /* over all vectors but 0: product of (1 + t), less one */
    for (int p = 0; p < s->n; p++) {
        const double t = theta_less_one(kappa / pel_ils_variance(s, p));
        sum += t + sum * t;
    }
    return sum * pel_exp(-0.5 * s->n * pel_log(u));
}

static bool keeps_promise(const pel_ils_t *s, double ratio, double failure_max)
{
    /* the best u for one vector alone (there half of the bound is enough), and for very many: every u gives a bound */
    return 0.5 * wrong_with(s, ratio, pel_sqrt(ratio)) <= failure_max ||
           wrong_with(s, ratio, 0.5 * (1.0 + ratio)) <= failure_max;
}

double pel_ils_ratio_bound(const pel_ils_t *s, double failure_max)
{
    if (s->stage == PEL_ILS_EMPTY) { return 0.0; }
    if (1.0 - pel_ils_success(s) <= failure_max) { return 1.0; }
    double low = 1e-4; /* logarithm of the ratio */
    double high = LOG_RATIO_MAX;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        if (keeps_promise(s, pel_exp(middle), failure_max)) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return pel_exp(high);
}

double pel_ils_ratio_needed(const pel_ils_t *s, double failure_max)
{
    const double bound = pel_ils_ratio_bound(s, failure_max);
    if (bound <= 1.0 || !(failure_max >= LAW_FAILURE_MIN && failure_max <= LAW_FAILURE_MAX)) { return bound; }
    const double excess = (1.0 - pel_ils_success(s)) / failure_max;
    return pel_min(bound, pel_exp((LAW_SLOPE / s->n + LAW_SLOPE_N) * pel_log(excess)));
}

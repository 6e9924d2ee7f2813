/* distributions.c - normal and chi-square probabilities and their inverses. */
#include "float_bits.h"
#include "pelorus/math.h"

static const double SQRT_HALF = 0.70710678118654752440;
static const double SQRT_PI = 1.77245385090551602730;
static const double SQRT_2PI = 2.50662827463100050242;

/* erfc(z), z >= 0. Below 2: 1 - erf by its all-positive series (Abramowitz and Stegun 7.1.6), terms below 1e-17 after 40.
 * Above: continued fraction (7.1.14), 60 levels, relative error below 1e-13 at z = 2. */
static double erfc_positive(double z)
{
    const double zz = z * z;
    if (z < 2.0) {
        double term = z;
        double sum = z;
        for (int n = 1; n < 40; n++) {
            term *= 2.0 * zz / (double)(2 * n + 1);
            sum += term;
        }
        return 1.0 - 2.0 / SQRT_PI * pel_exp(-zz) * sum;
    }
    double f = z;
    for (int n = 60; n >= 1; n--) { f = z + 0.5 * (double)n / f; }
    return pel_exp(-zz) / (SQRT_PI * f);
}

double pel_normal_cdf(double x)
{
    const double tail = 0.5 * erfc_positive(pel_fabs(x) * SQRT_HALF);
    return (x > 0.0) ? 1.0 - tail : tail;
}

/* Lower half only, by symmetry: start from Abramowitz and Stegun 26.2.23 (error 4.5e-4), then Halley steps. */
double pel_normal_quantile(double p)
{
    if (!(p > 1e-300 && p < 1.0)) { return not_a_number(); }
    const double tail = (p > 0.5) ? 1.0 - p : p;
    const double t = pel_sqrt(-2.0 * pel_log(tail));
    double x = -t + (2.515517 + t * (0.802853 + t * 0.010328)) / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
    for (int i = 0; i < 2; i++) {
        const double u = (pel_normal_cdf(x) - tail) * SQRT_2PI * pel_exp(0.5 * x * x);
        x -= u / (1.0 + 0.5 * x * u);
    }
    return (p > 0.5) ? -x : x;
}

/* Q(a + 1, y) = Q(a, y) + y^a e^-y / Gamma(a + 1), a = dof/2, y = x/2 (Abramowitz and Stegun 26.4.8), upwards from
 * Q(1/2) = erfc(sqrt y) or Q(1) = e^-y. *density receives the probability density at x. */
static double chi2_tail_density(int dof, double x, double *density)
{
    const double y = 0.5 * x;
    const double e = pel_exp(-y);
    const double root = pel_sqrt(y);
    const bool odd = (dof & 1) != 0;
    double a = odd ? 0.5 : 1.0;
    double q = odd ? erfc_positive(root) : e;
    double term = odd ? e * root * 2.0 / SQRT_PI : e * y; /* y^a e^-y / Gamma(a + 1) */
    for (int k = odd ? 1 : 2; k < dof; k += 2) {
        q += term;
        a += 1.0;
        term *= y / a;
    }
    *density = (y > 0.0) ? 0.5 * term * a / y : 0.0;
    return q;
}

double pel_chi2_tail(int dof, double x)
{
    double density;
    if (dof < 1 || dof > 400 || !(x >= 0.0)) { return not_a_number(); }
    return (x > 1400.0) ? 0.0 : chi2_tail_density(dof, x, &density);
}

/* Start from Wilson and Hilferty (1931), then Newton steps on the logarithm of the tail, which is nearly straight. */
double pel_chi2_threshold(int dof, double p)
{
    if (dof < 1 || dof > 400 || !(p > 0.5) || !(p <= 1.0 - 1e-9)) { return not_a_number(); }
    const double tail = 1.0 - p;
    const double k = 2.0 / (9.0 * (double)dof);
    const double c = 1.0 - k + pel_normal_quantile(p) * pel_sqrt(k);
    double x = (double)dof * c * c * c;
    for (int i = 0; i < 4; i++) {
        double density;
        const double q = chi2_tail_density(dof, x, &density);
        x += pel_log(q / tail) * q / density;
    }
    return x;
}

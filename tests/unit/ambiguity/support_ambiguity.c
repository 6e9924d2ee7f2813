#include "support_ambiguity.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

double rng_uniform(rng_t *r) /* splitmix64 (Steele, Lea, Flood 2014) */
{
    r->s += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = r->s;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    z ^= z >> 31;
    return (double)(z >> 11) * 0x1p-53;
}

double rng_gauss(rng_t *r)
{
    const double u = 1.0 - rng_uniform(r);
    return sqrt(-2.0 * log(u)) * cos(2.0 * PI * rng_uniform(r));
}

int rng_int(rng_t *r, int low, int high)
{
    return low + (int)(rng_uniform(r) * (high - low + 1));
}

/* Satellite k of 6 planes: argument of latitude at t = 0, degrees. */
static double argument_24(int p, int s)
{
    return 90.0 * s + 30.0 * p + 7.0 * s * p;
}

static double argument_30(int p, int s)
{
    return 72.0 * s + 12.0 * p;
}

static sky_t look(int slots, double (*argument_deg)(int, int), double lat_deg, double lon_deg, double h_m, double t_s,
                  double mask_deg)
{
    const double a = 6378137.0;
    const double e2 = 6.69437999014e-3;
    const double w_ie = 7.292115e-5;
    const double orbit = 26560e3;
    const double rate = sqrt(3.986004418e14 / (orbit * orbit * orbit));
    const double inc = 55.0 * PI / 180.0;
    const double lat = lat_deg * PI / 180.0;
    const double lon = lon_deg * PI / 180.0;
    const double N = a / sqrt(1.0 - e2 * sin(lat) * sin(lat));
    const double r[3] = {(N + h_m) * cos(lat) * cos(lon), (N + h_m) * cos(lat) * sin(lon),
                         (N * (1.0 - e2) + h_m) * sin(lat)};
    const double up[3] = {cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
    sky_t sky = {0};
    for (int k = 0; k < 6 * slots; k++) {
        const int p = k / slots;
        const int s = k % slots;
        const double node = 60.0 * p * PI / 180.0 - w_ie * t_s;
        const double u = argument_deg(p, s) * PI / 180.0 + rate * t_s;
        const double x = orbit * cos(u);
        const double y = orbit * sin(u);
        const double sat[3] = {x * cos(node) - y * cos(inc) * sin(node), x * sin(node) + y * cos(inc) * cos(node),
                               y * sin(inc)};
        double los[3];
        double d = 0.0;
        for (int i = 0; i < 3; i++) {
            los[i] = sat[i] - r[i];
            d += los[i] * los[i];
        }
        d = sqrt(d);
        const double el = asin((los[0] * up[0] + los[1] * up[1] + los[2] * up[2]) / d);
        if (el < mask_deg * PI / 180.0) { continue; }
        int at = sky.n++;
        for (; at > 0 && sky.el[at - 1] < el; at--) {
            sky.el[at] = sky.el[at - 1];
            sky.id[at] = sky.id[at - 1];
            memcpy(sky.u[at], sky.u[at - 1], sizeof sky.u[at]);
        }
        sky.el[at] = el;
        sky.id[at] = k;
        for (int i = 0; i < 3; i++) { sky.u[at][i] = los[i] / d; }
    }
    return sky;
}

sky_t sky_of(double lat_deg, double lon_deg, double h_m, double t_s, double mask_deg)
{
    return look(4, argument_24, lat_deg, lon_deg, h_m, t_s, mask_deg);
}

sky_t sky_of_30(double lat_deg, double lon_deg, double h_m, double t_s, double mask_deg)
{
    return look(5, argument_30, lat_deg, lon_deg, h_m, t_s, mask_deg);
}

static double binomial_log(int k, int n, double p)
{
    return lgamma(n + 1.0) - lgamma(k + 1.0) - lgamma(n - k + 1.0) + k * log(p) + (n - k) * log1p(-p);
}

bool binomial_agrees(int k, int n, double p)
{
    if (p <= 0.0) { return k == 0; }
    if (p >= 1.0) { return k == n; }
    double below = 0.0;
    double above = 0.0;
    for (int i = 0; i <= n; i++) {
        const double w = exp(binomial_log(i, n, p));
        if (i <= k) { below += w; }
        if (i >= k) { above += w; }
    }
    return below > 0.005 && above > 0.005;
}

bool proportions_agree(int k, int n, double p_ref, int n_ref)
{
    /* The reference count is known to half a unit at best: 100 % of 500 is compatible with 99.1 %. */
    const double p = (double)k / n;
    const double pooled = (k + p_ref * n_ref + 0.5) / (n + n_ref + 1.0);
    const double sd = sqrt(pooled * (1.0 - pooled) * (1.0 / n + 1.0 / n_ref));
    return fabs(p - p_ref) <= 2.576 * sd + 0.5 / n + 0.5 / n_ref;
}

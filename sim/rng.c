/* rng.c - see rng.h. */
#include "rng.h"

#include <math.h>

static uint64_t splitmix(uint64_t *x)
{
    uint64_t z = (*x += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static uint64_t rotate(uint64_t x, int k)
{
    return (x << k) | (x >> (64 - k));
}

void rng_init(rng_t *r, uint64_t seed, uint64_t cause)
{
    uint64_t x = seed;
    uint64_t y = splitmix(&x) ^ (cause * UINT64_C(0xd1342543de82ef95));
    for (int i = 0; i < 4; i++) { r->s[i] = splitmix(&y); }
    r->have_spare = false;
    r->spare = 0.0;
}

uint64_t rng_bits(rng_t *r)
{
    uint64_t *s = r->s;
    const uint64_t result = rotate(s[1] * 5u, 7) * 9u;
    const uint64_t t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotate(s[3], 45);
    return result;
}

double rng_uniform(rng_t *r)
{
    return (double)(rng_bits(r) >> 11) * 0x1p-53;
}

double rng_normal(rng_t *r)
{
    if (r->have_spare) {
        r->have_spare = false;
        return r->spare;
    }
    double u;
    double v;
    double s;
    do {
        u = 2.0 * rng_uniform(r) - 1.0;
        v = 2.0 * rng_uniform(r) - 1.0;
        s = u * u + v * v;
    } while (s >= 1.0 || s == 0.0);
    const double f = sqrt(-2.0 * log(s) / s);
    r->spare = v * f;
    r->have_spare = true;
    return u * f;
}

int64_t rng_integer(rng_t *r, int64_t n)
{
    return (int64_t)floor(rng_uniform(r) * (2.0 * (double)n + 1.0)) - n;
}

double rng_markov(rng_t *r, double x, double sd, double tau_s, double dt_s)
{
    if (!(tau_s > 0.0)) { return x; }
    const double phi = exp(-dt_s / tau_s);
    return phi * x + sd * sqrt(1.0 - phi * phi) * rng_normal(r);
}

/* exponential.c - exponential and natural logarithm. Polynomials as in trigonometry.c. */
#include "float_bits.h"
#include "pelorus/math.h"

static const double LN2_HI = 0x1.62e42fefa3800p-1; /* first 42 bits of ln 2: k LN2_HI is exact for |k| < 2048 */
static const double LN2_LO = 0x1.ef35793c76730p-45;
static const double ONE_OVER_LN2 = 0x1.71547652b82fep+0;

static double infinity(void)
{
    return pel_f64_from_bits(UINT64_C(0x7FF0000000000000));
}

/* e^x = 2^k e^r, |r| <= ln(2)/2; e^r = 1 + r + r^2 E(r), polynomial error 1.4e-17. */
double pel_exp(double x)
{
    if (x > 709.8) { return infinity(); }
    if (x < -745.2) { return 0.0; }
    if (!(x == x)) { return x; }

    const double k = pel_round(x * ONE_OVER_LN2);
    const double hi = x - k * LN2_HI;
    const double lo = k * LN2_LO;
    const double r = hi - lo;
    const double p = 0x1.0000000000001p-1 +
                     r * (0x1.5555555555556p-3 +
                          r * (0x1.5555555553d37p-5 +
                               r * (0x1.11111111109a6p-7 +
                                    r * (0x1.6c16c1789d1d7p-10 +
                                         r * (0x1.a01a01a7cebcdp-13 +
                                              r * (0x1.a019b8ca26fcfp-16 +
                                                   r * (0x1.71de0d85293b8p-19 +
                                                        r * (0x1.2891d4ffbb0f9p-22 + r * 0x1.af390ba7e6f47p-26))))))));
    const double y = 1.0 + (hi + (r * r * p - lo));
    const int half = (int)k / 2; /* two factors: 2^k itself may be out of range where the result is not */
    return y * pel_pow2(half) * pel_pow2((int)k - half);
}

/* x = 2^k (1 + f), sqrt(1/2) < 1 + f < sqrt(2); with s = f / (2 + f),
 * ln(1 + f) = 2 s + s^3 L(s^2) = f - (f^2/2 - s (f^2/2 + s^2 L)): f is exact, the bracket is small. Error of L 1e-17. */
double pel_log(double x)
{
    if (x == 0.0) { return -infinity(); }
    if (!(x > 0.0)) { return not_a_number(); }
    if (!pel_isfinite(x)) { return x; }

    int k = 0;
    if (x < 0x1p-1022) {
        x *= 0x1p54;
        k = -54;
    }
    uint64_t b = pel_f64_bits(x);
    k += (int)(b >> 52) - 1023;
    b = (b & UINT64_C(0xFFFFFFFFFFFFF)) | UINT64_C(0x3FF0000000000000);
    double m = pel_f64_from_bits(b);
    if (m > 0x1.6a09e667f3bcdp+0) {
        m *= 0.5;
        k += 1;
    }
    const double f = m - 1.0;
    const double s = f / (2.0 + f);
    const double z = s * s;
    const double p =
        z * (0x1.5555555555558p-1 +
             z * (0x1.9999999995204p-2 +
                  z * (0x1.2492492e09d4dp-2 +
                       z * (0x1.c71c62c639fddp-3 +
                            z * (0x1.7462bd8f779a8p-3 + z * (0x1.39fd392179472p-3 + z * 0x1.2b6688a38be0fp-3))))));
    const double half = 0.5 * f * f;
    return (double)k * LN2_HI + (f - (half - (s * (half + p) + (double)k * LN2_LO)));
}

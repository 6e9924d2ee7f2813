/* trigonometry.c - sine, cosine, arc tangent.
 *
 * Reduction by multiples of pi/2 in three parts (Cody and Waite 1980), polynomials of Chebyshev interpolation computed
 * with 200 bits for the intervals named beside them. */
#include "float_bits.h"
#include "pelorus/math.h"

#define MAX_ANGLE 1.0e6 /* n below 2^20, so that n times a 33-bit part of pi/2 is exact */

static const double TWO_OVER_PI = 0x1.45f306dc9c883p-1;
static const double PIO2_1 = 0x1.921fb54400000p+0;  /* first 33 bits of pi/2 */
static const double PIO2_2 = 0x1.0b4611a600000p-34; /* next 33 bits */
static const double PIO2_3 = 0x1.3198a2e037073p-69; /* the rest */

/* sin(x + tail), |x| <= 0.793: x + x^3 S(x^2), polynomial error 2.3e-17 relative. */
static double sin_kernel(double x, double tail)
{
    const double z = x * x;
    const double s = 0x1.1111111110b23p-7 +
                     z * (-0x1.a01a019e623afp-13 +
                          z * (0x1.71de376b9c575p-19 + z * (-0x1.ae5fdeb852565p-26 + z * 0x1.5dfb4dfaf1553p-33)));
    const double cube = z * x;
    return x - ((z * (0.5 * tail - cube * s) - tail) - cube * -0x1.5555555555555p-3);
}

/* cos(x + tail), |x| <= 0.793: 1 - x^2/2 + x^4 C(x^2), polynomial error 1e-18. */
static double cos_kernel(double x, double tail)
{
    const double z = x * x;
    const double c =
        z * (0x1.5555555555555p-5 +
             z * (-0x1.6c16c16c1691fp-10 +
                  z * (0x1.a01a019f3df42p-16 +
                       z * (-0x1.27e4fa025e03dp-22 + z * (0x1.1eeb52bea9071p-29 + z * -0x1.906dd38cb6648p-37)))));
    const double half = 0.5 * z;
    const double w = 1.0 - half;
    return w + (((1.0 - w) - half) + (z * c - x * tail)); /* (1 - w) - half is what the first rounding lost */
}

void pel_sincos(double x, double *sin_x, double *cos_x)
{
    if (!(pel_fabs(x) <= MAX_ANGLE)) {
        *sin_x = not_a_number();
        *cos_x = not_a_number();
        return;
    }
    const double n = pel_round(x * TWO_OVER_PI);
    /* n PIO2_1 and its difference from x are exact; what the second difference loses is put into the tail */
    const double a = x - n * PIO2_1;
    const double p = n * PIO2_2;
    const double b = a - p;
    const double lost = (a - b) - p;
    const double q = n * PIO2_3 - lost;
    const double r = b - q;
    const double tail = (b - r) - q;

    const double s = sin_kernel(r, tail);
    const double c = cos_kernel(r, tail);
    switch ((int)n & 3) {
    case 0:
        *sin_x = s;
        *cos_x = c;
        break;
    case 1:
        *sin_x = c;
        *cos_x = -s;
        break;
    case 2:
        *sin_x = -s;
        *cos_x = -c;
        break;
    default:
        *sin_x = -c;
        *cos_x = s;
        break;
    }
}

double pel_sin(double x)
{
    double s;
    double c;
    pel_sincos(x, &s, &c);
    return s;
}

double pel_cos(double x)
{
    double s;
    double c;
    pel_sincos(x, &s, &c);
    return c;
}

/* atan(k / 4), k = 0..4, and what rounding it to double lost */
static const double ATAN_HI[5] = {0.0, 0x1.f5b75f92c80ddp-3, 0x1.dac670561bb4fp-2, 0x1.4978fa3269ee1p-1,
                                  0x1.921fb54442d18p-1};
static const double ATAN_LO[5] = {0.0, 0x1.8ab6e3cf7afbdp-57, 0x1.a2b7f222f65e2p-56, 0x1.2419a87f2a458p-56,
                                  0x1.1a62633145c07p-55};
static const double PI_LO = 0x1.1a62633145c07p-53; /* pi - PEL_PI */

/* atan(y / x) for 0 <= y <= x, x > 0, as the sum of the result and *lo:
 * atan(y/x) = atan(k/4) + atan(u), u = (y - k/4 x) / (x + k/4 y), |u| <= 1/8; polynomial error 3e-19. */
static double atan_octant(double y, double x, double *lo)
{
    int k = 0;
    while (k < 4 && 8.0 * y > (double)(2 * k + 1) * x) { k++; }
    const double c = 0.25 * (double)k;
    const double u = (y - c * x) / (x + c * y);
    const double z = u * u;
    const double p =
        z * (-0x1.5555555555555p-2 +
             z * (0x1.999999999980ep-3 +
                  z * (-0x1.24924924313f6p-3 +
                       z * (0x1.c71c70a94f194p-4 +
                            z * (-0x1.745c4ea08b923p-4 + z * (0x1.3acb3ad4f9ec5p-4 + z * -0x1.0405e673209ccp-4))))));
    *lo = u + (ATAN_LO[k] + u * p);
    return ATAN_HI[k];
}

double pel_atan2(double y, double x)
{
    const double ax = pel_fabs(x);
    const double ay = pel_fabs(y);
    if (!pel_isfinite(x) || !pel_isfinite(y)) { return not_a_number(); }
    if (ax == 0.0 && ay == 0.0) { return 0.0; }

    double big = (ax > ay) ? ax : ay;
    double small = (ax > ay) ? ay : ax;
    if (big > 0x1p1000 || big < 0x1p-900) { /* keep 8 y and the quotient away from the ends of the range */
        const double scale = (big > 1.0) ? 0x1p-60 : 0x1p120;
        big *= scale;
        small *= scale;
    }
    double lo;
    double hi = atan_octant(small, big, &lo);
    if (ay > ax) { /* pi/2 - atan(x/y) */
        hi = 0.5 * PEL_PI - hi;
        lo = 0.5 * PI_LO - lo;
    }
    if (x < 0.0) {
        hi = PEL_PI - hi;
        lo = PI_LO - lo;
    }
    const double angle = hi + lo;
    return (y < 0.0) ? -angle : angle;
}

double pel_asin(double x)
{
    const double s = (x > 1.0) ? 1.0 : ((x < -1.0) ? -1.0 : x);
    return pel_atan2(s, pel_sqrt((1.0 - s) * (1.0 + s)));
}

double pel_acos(double x)
{
    const double c = (x > 1.0) ? 1.0 : ((x < -1.0) ? -1.0 : x);
    return pel_atan2(pel_sqrt((1.0 - c) * (1.0 + c)), c);
}

double pel_wrap_pi(double x)
{
    const double y = x - 2.0 * PEL_PI * pel_round(x / (2.0 * PEL_PI));
    return (y <= -PEL_PI) ? y + 2.0 * PEL_PI : y;
}

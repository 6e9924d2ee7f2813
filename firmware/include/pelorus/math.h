/* math.h - elementary functions, 3-vectors, 3x3 matrices, distributions. Room: math/.
 *
 * Nothing here calls the C library. Every function uses + - * / and a correctly rounded square root alone, in a fixed
 * order, so that results are the same bits on every IEEE-754 machine (compile with -ffp-contract=off).
 * All functions are pure and re-entrant. A NaN in gives a NaN out unless said otherwise.
 * Accuracy figures are the largest errors seen by tests/unit/math against the C library, in units of the last place. */
#ifndef PELORUS_MATH_H
#define PELORUS_MATH_H

#include <string.h>

#include "pelorus/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#define PEL_PI  3.14159265358979323846
#define PEL_DEG (PEL_PI / 180.0) /* radians in a degree: x * PEL_DEG, x / PEL_DEG */

/* A literal of type pel_real: PEL_R(0.5). */
#if PEL_REAL_DOUBLE
#define PEL_R(x) (x)
#else
#define PEL_R(x) (x##f)
#endif

/* Short functions are inlined where code is built for speed and called where it is built for size (-Os): without a processor for doubles
 * y = A x is 240 bytes. Their bodies are at the end. */
#if defined(__OPTIMIZE_SIZE__) && !defined(PEL_MATH_BODIES)
#define PEL_SHORT
#else
#define PEL_SHORT inline
#endif

/* ---- elementary functions ------------------------------------------------------------------------------------- */

/* Square root, correctly rounded: by the processor where it can, else bit by bit in integers (about 600 instructions
 * on a Cortex-M4F for double). Negative: NaN. The twin works in pel_real. */
double pel_sqrt(double x);
pel_real pel_sqrtr(pel_real x);

/* Sine and cosine, x in rad, |x| <= 1e6: below 1 ulp away from their zeros, absolute error below 1.2e-16 everywhere. Beyond 1e6, or
 * not finite: NaN. */
double pel_sin(double x);
double pel_cos(double x);
void pel_sincos(double x, double *sin_x, double *cos_x);

/* Angle of the point (x, y) in (-pi, pi], below 1.5 ulp; pel_atan2(0, 0) is 0. Infinite arguments give NaN. */
double pel_atan2(double y, double x);

/* Arguments beyond [-1, 1] are taken as -1 or 1: what they come from is a unit vector with rounding. Below 2 ulp. */
double pel_asin(double x);
double pel_acos(double x);

/* e^x below 1 ulp; 0 below -745.2, infinity above 709.8. Results below 2.2e-308 are rounded twice. */
double pel_exp(double x);

/* Natural logarithm below 1 ulp; 0: -infinity; negative: NaN. */
double pel_log(double x);

/* Largest integer not above x; nearest integer, halves away from zero. Exact for every double. */
double pel_floor(double x);
double pel_round(double x);

bool pel_isfinite(double x);

/* The same for pel_real, in its own arithmetic. */
#if PEL_REAL_DOUBLE
#define PEL_REAL_MAX 1.7976931348623157e308
#else
#define PEL_REAL_MAX 3.4028234663852886e38f
#endif
static inline bool pel_isfiniter(pel_real x)
{
    return (x <= PEL_REAL_MAX) && (x >= -PEL_REAL_MAX);
}

static inline double pel_fabs(double x)
{
    return __builtin_fabs(x); /* one bit, no library */
}
PEL_SHORT double pel_min(double a, double b);
PEL_SHORT double pel_max(double a, double b);

/* Angle brought into (-pi, pi], |x| <= 1e6 rad. */
double pel_wrap_pi(double x);

/* ---- 3-vectors and 3x3 matrices (row-major, A[row][column]); outputs must not alias inputs unless said ---------- */

PEL_SHORT double pel_dot3(const double a[3], const double b[3]);

/* out = a x b */
PEL_SHORT void pel_cross3(const double a[3], const double b[3], double out[3]);

/* A = [a x] */
void pel_cross_matrix(const double a[3], double A[3][3]);

double pel_norm3(const double a[3]);

/* out = a / |a|; out may be a. A zero vector stays zero. Returns |a|. */
double pel_unit3(const double a[3], double out[3]);

/* y = A x */
PEL_SHORT void pel_mat3_vec(const double A[3][3], const double x[3], double y[3]);

/* y = A' x */
PEL_SHORT void pel_mat3_tvec(const double A[3][3], const double x[3], double y[3]);

/* to = from */
static inline void pel_mat3_copy(const double from[3][3], double to[3][3])
{
    memcpy(to, from, 9 * sizeof to[0][0]);
}

void pel_mat3_mul(const double A[3][3], const double B[3][3], double C[3][3]);  /* C = A B */
void pel_mat3_mult(const double A[3][3], const double B[3][3], double C[3][3]); /* C = A B' */
void pel_mat3_tmul(const double A[3][3], const double B[3][3], double C[3][3]); /* C = A' B */
void pel_mat3_transpose(const double A[3][3], double At[3][3]);
void pel_mat3_congruence(const double A[3][3], const double P[3][3], double out[3][3]); /* out = A P A' */

/* Ainv = A^-1. PEL_E_GEOMETRY and Ainv unchanged if |det A| <= 1e-30 times the product of its row norms. */
pel_status_t pel_mat3_inverse(const double A[3][3], double Ainv[3][3]);

/* C = exp([v x]): the rotation by |v| rad about v. Orthogonal to 2e-15. About 60 flops below 0.03 rad, a sine more above. */
void pel_rotvec_to_dcm(const double v[3], double C[3][3]);

/* Turn by the rotation vector v, |v| in rad: C = C exp([v x]), v in the axes C takes from; C = exp([v x]) C, in those it takes to. In place. */
void pel_dcm_turn_from(double C[3][3], const double v[3]);
void pel_dcm_turn_to(double C[3][3], const double v[3]);

/* v with exp([v x]) = C, |v| in [0, pi]; C orthogonal. Absolute error below 1e-15 up to |v| = 3, growing to 1e-8 at pi. */
void pel_dcm_to_rotvec(const double C[3][3], double v[3]);

/* Nearest rotation to C, for C'C = I + E with |E| << 1: one step C (I - E/2), which leaves an error of order E^2. In place. */
void pel_dcm_orthonormalise(double C[3][3]);

/* ---- distributions --------------------------------------------------------------------------------------------- */

/* Probability of a standard normal variable below x; relative error below 1e-12 down to x = -37 (tails included). */
double pel_normal_cdf(double x);

/* x with pel_normal_cdf(x) = p, 1e-300 < p < 1; relative error below 1e-9. NaN outside. */
double pel_normal_quantile(double p);

/* Probability that a chi-square variable with dof (1..400) degrees of freedom exceeds x >= 0. dof/2 multiplications. */
double pel_chi2_tail(int dof, double x);

/* The value a chi-square variable with dof (1..400) degrees of freedom stays below with probability p in (0.5, 1 - 1e-9].
 * Relative error below 1e-6. About 5 dof multiplications: for gates that do not change, call it once. NaN outside. */
double pel_chi2_threshold(int dof, double p);

/* ---- bodies of short functions ---------------------------------------------------------------------------------- */

#if !defined(__OPTIMIZE_SIZE__) || defined(PEL_MATH_BODIES)
inline double pel_min(double a, double b)
{
    return (a < b) ? a : b;
}

inline double pel_max(double a, double b)
{
    return (a > b) ? a : b;
}

inline double pel_dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline void pel_cross3(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

inline void pel_mat3_vec(const double A[3][3], const double x[3], double y[3])
{
    y[0] = A[0][0] * x[0] + A[0][1] * x[1] + A[0][2] * x[2];
    y[1] = A[1][0] * x[0] + A[1][1] * x[1] + A[1][2] * x[2];
    y[2] = A[2][0] * x[0] + A[2][1] * x[1] + A[2][2] * x[2];
}

inline void pel_mat3_tvec(const double A[3][3], const double x[3], double y[3])
{
    y[0] = A[0][0] * x[0] + A[1][0] * x[1] + A[2][0] * x[2];
    y[1] = A[0][1] * x[0] + A[1][1] * x[1] + A[2][1] * x[2];
    y[2] = A[0][2] * x[0] + A[1][2] * x[1] + A[2][2] * x[2];
}
#endif

#ifdef __cplusplus
}
#endif
#endif

/* linear.c - 3-vectors, 3x3 matrices, rotations. */
#define PEL_MATH_BODIES
#include "pelorus/math.h"

/* For callers that do not inline them. */
extern double pel_min(double a, double b);
extern double pel_max(double a, double b);
extern double pel_dot3(const double a[3], const double b[3]);
extern void pel_cross3(const double a[3], const double b[3], double out[3]);
extern void pel_mat3_vec(const double A[3][3], const double x[3], double y[3]);
extern void pel_mat3_tvec(const double A[3][3], const double x[3], double y[3]);

double pel_norm3(const double a[3])
{
    return pel_sqrt(pel_dot3(a, a));
}

double pel_unit3(const double a[3], double out[3])
{
    const double n = pel_norm3(a);
    const double s = (n > 0.0) ? 1.0 / n : 0.0;
    for (int i = 0; i < 3; i++) { out[i] = s * a[i]; }
    return n;
}

void pel_cross_matrix(const double a[3], double A[3][3])
{
    for (int i = 0; i < 3; i++) { A[i][i] = 0.0; }
    A[0][1] = -a[2];
    A[0][2] = a[1];
    A[1][0] = a[2];
    A[1][2] = -a[0];
    A[2][0] = -a[1];
    A[2][1] = a[0];
}

void pel_mat3_mul(const double A[3][3], const double B[3][3], double C[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { C[i][j] = A[i][0] * B[0][j] + A[i][1] * B[1][j] + A[i][2] * B[2][j]; }
    }
}

void pel_mat3_mult(const double A[3][3], const double B[3][3], double C[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { C[i][j] = A[i][0] * B[j][0] + A[i][1] * B[j][1] + A[i][2] * B[j][2]; }
    }
}

void pel_mat3_tmul(const double A[3][3], const double B[3][3], double C[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { C[i][j] = A[0][i] * B[0][j] + A[1][i] * B[1][j] + A[2][i] * B[2][j]; }
    }
}

void pel_mat3_transpose(const double A[3][3], double At[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { At[j][i] = A[i][j]; }
    }
}

void pel_mat3_congruence(const double A[3][3], const double P[3][3], double out[3][3])
{
    double AP[3][3];
    pel_mat3_mul(A, P, AP);
    pel_mat3_mult(AP, A, out);
}

pel_status_t pel_mat3_inverse(const double A[3][3], double Ainv[3][3])
{
    double adj[3][3]; /* columns of the adjugate are cross products of rows */
    pel_cross3(A[1], A[2], adj[0]);
    pel_cross3(A[2], A[0], adj[1]);
    pel_cross3(A[0], A[1], adj[2]);
    const double det = pel_dot3(A[0], adj[0]);
    const double scale = pel_norm3(A[0]) * pel_norm3(A[1]) * pel_norm3(A[2]);
    if (!(pel_fabs(det) > 1e-30 * scale)) { return PEL_E_GEOMETRY; }
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { Ainv[i][j] = adj[j][i] / det; }
    }
    return PEL_OK;
}

/* exp([v x]) = I + a [v x] + b [v x]^2, a = sin(x)/x, b = (1 - cos x)/x^2, x = |v| (Rodrigues). */
void pel_rotvec_to_dcm(const double v[3], double C[3][3])
{
    const double z = pel_dot3(v, v);
    double a;
    double b;
    if (z < 1e-3) { /* next terms of the series: 3e-18 and 3e-19 */
        a = 1.0 - z * (1.0 / 6.0) * (1.0 - z * (1.0 / 20.0) * (1.0 - z * (1.0 / 42.0)));
        b = 0.5 * (1.0 - z * (1.0 / 12.0) * (1.0 - z * (1.0 / 30.0) * (1.0 - z * (1.0 / 56.0))));
    } else {
        const double x = pel_sqrt(z);
        double s;
        double c;
        pel_sincos(0.5 * x, &s, &c); /* 1 - cos x = 2 sin^2(x/2): no cancellation */
        a = 2.0 * s * c / x;
        b = 2.0 * s * s / z;
    }
    const double bx = b * v[0];
    const double by = b * v[1];
    const double bz = b * v[2];
    const double xx = bx * v[0];
    const double yy = by * v[1];
    const double zz = bz * v[2];
    C[0][0] = 1.0 - (yy + zz);
    C[1][1] = 1.0 - (xx + zz);
    C[2][2] = 1.0 - (xx + yy);
    C[0][1] = bx * v[1] - a * v[2];
    C[1][0] = bx * v[1] + a * v[2];
    C[0][2] = bx * v[2] + a * v[1];
    C[2][0] = bx * v[2] - a * v[1];
    C[1][2] = by * v[2] - a * v[0];
    C[2][1] = by * v[2] + a * v[0];
}

void pel_dcm_turn_from(double C[3][3], const double v[3])
{
    double R[3][3], turned[3][3];
    pel_rotvec_to_dcm(v, R);
    pel_mat3_mul(C, R, turned);
    pel_mat3_copy(turned, C);
}

void pel_dcm_turn_to(double C[3][3], const double v[3])
{
    double R[3][3], turned[3][3];
    pel_rotvec_to_dcm(v, R);
    pel_mat3_mul(R, C, turned);
    pel_mat3_copy(turned, C);
}

void pel_dcm_to_rotvec(const double C[3][3], double v[3])
{
    const double w[3] = {C[2][1] - C[1][2], C[0][2] - C[2][0], C[1][0] - C[0][1]}; /* 2 sin(x) axis */
    const double trace = C[0][0] + C[1][1] + C[2][2];                              /* 1 + 2 cos(x) */
    const double sin2 = pel_norm3(w);
    const double angle = pel_atan2(sin2, trace - 1.0);
    if (trace > -0.98) { /* up to 3 rad: the sine is large enough to divide by, or the angle small */
        const double k = (sin2 > 1e-8) ? angle / sin2 : 0.5;
        for (int i = 0; i < 3; i++) { v[i] = k * w[i]; }
        return;
    }
    /* near pi: the axis from the symmetric part, (C + C')/2 = cos x I + (1 - cos x) u u'; its largest component first */
    int m = 0;
    if (C[1][1] > C[m][m]) { m = 1; }
    if (C[2][2] > C[m][m]) { m = 2; }
    double u[3];
    for (int i = 0; i < 3; i++) { u[i] = 0.5 * (C[m][i] + C[i][m]); }
    u[m] -= 0.5 * (trace - 1.0);
    (void)pel_unit3(u, u);
    const double sign = (pel_dot3(u, w) < 0.0) ? -angle : angle;
    for (int i = 0; i < 3; i++) { v[i] = sign * u[i]; }
}

void pel_dcm_orthonormalise(double C[3][3])
{
    double E[3][3];
    pel_mat3_tmul(C, C, E);
    double out[3][3];
    for (int i = 0; i < 3; i++) { E[i][i] -= 1.0; }
    pel_mat3_mul(C, E, out);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { C[i][j] -= 0.5 * out[i][j]; }
    }
}

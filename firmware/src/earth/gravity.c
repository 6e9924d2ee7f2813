/* gravity.c - gravity of a rotating Earth with J2, and its gradient. */
#include "pelorus/earth.h"
#include "pelorus/math.h"

void pel_earth_gravity_e(const double r_e[3], double g_e[3])
{
    const double rr = pel_dot3(r_e, r_e);
    const double inv2 = 1.0 / rr;
    const double k = -PEL_MU * inv2 / pel_sqrt(rr);                   /* -mu / r^3 */
    const double j = 1.5 * PEL_J2 * PEL_WGS84_A * PEL_WGS84_A * inv2; /* 3/2 J2 (a/r)^2 */
    const double t = 5.0 * r_e[2] * r_e[2] * inv2;
    const double equatorial = k * (1.0 + j * (1.0 - t)) + PEL_OMEGA_IE * PEL_OMEGA_IE;
    g_e[0] = equatorial * r_e[0];
    g_e[1] = equatorial * r_e[1];
    g_e[2] = k * (1.0 + j * (3.0 - t)) * r_e[2];
}

void pel_earth_gravity_gradient_e(const double r_e[3], double G[3][3])
{
    const double rr = pel_dot3(r_e, r_e);
    const double k = PEL_MU / (rr * pel_sqrt(rr));
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { G[i][j] = 3.0 * k * r_e[i] * r_e[j] / rr; }
        G[i][i] -= k;
    }
    G[0][0] += PEL_OMEGA_IE * PEL_OMEGA_IE;
    G[1][1] += PEL_OMEGA_IE * PEL_OMEGA_IE;
}

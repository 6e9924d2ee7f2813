/* ellipsoid.c - WGS-84 coordinates and local frames. */
#include "pelorus/earth.h"
#include "pelorus/math.h"

void pel_earth_ecef_to_llh(const double r_e[3], double *lat, double *lon, double *h)
{
    const double e2 = PEL_WGS84_E2;
    const double z = r_e[2];
    const double p = pel_sqrt(r_e[0] * r_e[0] + r_e[1] * r_e[1]);

    /* (s, c): sine and cosine of the parametric latitude. Start on the sphere, three fixed steps: each gains a factor e^2
     * squared or more, and two already reach rounding below 30 km. */
    double s = (1.0 - PEL_WGS84_F) * z;
    double c = p;
    double num = z;
    double den = p;
    for (int i = 0; i < 3; i++) {
        const double n = pel_sqrt(s * s + c * c);
        if (!(n > 0.0)) { break; }
        s /= n;
        c /= n;
        num = z + e2 / (1.0 - e2) * PEL_WGS84_B * s * s * s;
        den = p - e2 * PEL_WGS84_A * c * c * c;
        s = (1.0 - PEL_WGS84_F) * num;
        c = den;
    }
    *lat = pel_atan2(num, den);
    *lon = pel_atan2(r_e[1], r_e[0]);

    const double n = pel_sqrt(num * num + den * den);
    const double sin_lat = (n > 0.0) ? num / n : 0.0;
    const double cos_lat = (n > 0.0) ? den / n : 1.0;
    /* well conditioned at every latitude, and insensitive to the error of latitude */
    *h = p * cos_lat + z * sin_lat - PEL_WGS84_A * pel_sqrt(1.0 - e2 * sin_lat * sin_lat);
}

void pel_earth_llh_to_ecef(double lat, double lon, double h, double r_e[3])
{
    double sin_lat;
    double cos_lat;
    double sin_lon;
    double cos_lon;
    pel_sincos(lat, &sin_lat, &cos_lat);
    pel_sincos(lon, &sin_lon, &cos_lon);
    double R_M;
    double R_N;
    pel_earth_radii_at(sin_lat, &R_M, &R_N);
    r_e[0] = (R_N + h) * cos_lat * cos_lon;
    r_e[1] = (R_N + h) * cos_lat * sin_lon;
    r_e[2] = (R_N * (1.0 - PEL_WGS84_E2) + h) * sin_lat;
}

void pel_earth_C_e_enu(double lat, double lon, double C_e_enu[3][3])
{
    double sin_lat;
    double cos_lat;
    double sin_lon;
    double cos_lon;
    pel_sincos(lat, &sin_lat, &cos_lat);
    pel_sincos(lon, &sin_lon, &cos_lon);
    C_e_enu[0][0] = -sin_lon;
    C_e_enu[0][1] = cos_lon;
    C_e_enu[0][2] = 0.0;
    C_e_enu[1][0] = -sin_lat * cos_lon;
    C_e_enu[1][1] = -sin_lat * sin_lon;
    C_e_enu[1][2] = cos_lat;
    C_e_enu[2][0] = cos_lat * cos_lon;
    C_e_enu[2][1] = cos_lat * sin_lon;
    C_e_enu[2][2] = sin_lat;
}

void pel_earth_C_e_n(double lat, double lon, double C_e_n[3][3])
{
    double C[3][3];
    pel_earth_C_e_enu(lat, lon, C);
    for (int j = 0; j < 3; j++) {
        C_e_n[0][j] = C[1][j];
        C_e_n[1][j] = C[0][j];
        C_e_n[2][j] = -C[2][j];
    }
}

void pel_earth_radii_at(double sin_lat, double *R_M, double *R_N)
{
    const double w2 = 1.0 - PEL_WGS84_E2 * sin_lat * sin_lat;
    *R_N = PEL_WGS84_A / pel_sqrt(w2);
    *R_M = *R_N * (1.0 - PEL_WGS84_E2) / w2;
}

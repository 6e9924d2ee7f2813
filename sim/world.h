/* world.h - the Earth of the simulator: ellipsoid, gravity, frames, atmosphere. Shares nothing with firmware/. */
#ifndef PELORUS_SIM_WORLD_H
#define PELORUS_SIM_WORLD_H

#define WORLD_A      6378137.0             /* WGS-84 equatorial radius, m */
#define WORLD_F      (1.0 / 298.257223563) /* WGS-84 flattening */
#define WORLD_E2     (WORLD_F * (2.0 - WORLD_F))
#define WORLD_OMEGA  7.292115e-5    /* Earth rate of the inertial sensors' world, rad/s */
#define WORLD_MU     3.986004418e14 /* m^3/s^2 */
#define WORLD_J2     1.082627e-3
#define WORLD_C      299792458.0          /* speed of light, m/s */
#define WORLD_DEG    0.017453292519943295 /* rad */
#define WORLD_TWO_PI 6.283185307179586

/* Geodetic latitude, longitude (rad), ellipsoidal height (m) to ECEF and back (to 1e-9 m). */
void world_llh_to_ecef(const double llh[3], double r_e[3]);
void world_ecef_to_llh(const double r_e[3], double llh[3]);

/* Rotation that takes a vector from local east-north-up to e; and from body (right, forward, up) to local for roll (right
 * side down), pitch (nose up) and heading (clockwise from north). */
void world_C_n_e(double lat, double lon, double C[3][3]);
void world_C_b_n(double roll, double pitch, double heading, double C[3][3]);

/* Inverse of world_C_b_n: out = roll, pitch, heading in (-pi, pi]. */
void world_attitude(const double C_b_n[3][3], double out[3]);

/* Gravity, e axes: point mass, J2 and centrifugal acceleration (Groves 2013, 2.133 with 2.142). */
void world_gravity(const double r_e[3], double g_e[3]);

/* Delay of a standard atmosphere (1013.25 hPa and 288.16 K at sea level, relative humidity 0..1), m: Saastamoinen (1972) at
 * the zenith, slant by Black and Eisner (1984). */
double world_troposphere(double lat, double height, double el, double humidity);
double world_troposphere_mapping(double el);

/* Klobuchar delay on L1 (IS-GPS-200, 20.3.3.5.2.5), m. Angles rad, alpha and beta in GPS units, GPS seconds of week. */
double world_klobuchar(const double alpha[4], const double beta[4], double tow_s, double lat, double lon, double az,
                       double el);

/* Pierce point of a single layer 450 km up: latitude, longitude, and the obliquity factor returned. */
double world_pierce(const double llh[3], double az, double el, double *lat, double *lon);

/* Azimuth (clockwise from north) and elevation of a unit vector in e. */
void world_azel(double lat, double lon, const double u_e[3], double *az, double *el);

/* ---- small vectors ------------------------------------------------------------------------------------------------- */

static inline double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* y = C x and y = C' x; y is not x. */
static inline void rotate(const double C[3][3], const double x[3], double y[3])
{
    for (int i = 0; i < 3; i++) { y[i] = dot(C[i], x); }
}

static inline void rotate_back(const double C[3][3], const double x[3], double y[3])
{
    for (int i = 0; i < 3; i++) { y[i] = C[0][i] * x[0] + C[1][i] * x[1] + C[2][i] * x[2]; }
}

/* Z = X Y; Z is neither. */
static inline void multiply(const double X[3][3], const double Y[3][3], double Z[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { Z[i][j] = X[i][0] * Y[0][j] + X[i][1] * Y[1][j] + X[i][2] * Y[2][j]; }
    }
}

#endif

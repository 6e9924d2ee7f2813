/* earth.h - WGS-84 ellipsoid, gravity, local frames, attitude angles. Room: earth/.
 *
 * Frames: e ECEF; n local north-east-down; enu local east-north-up; b body x right, y forward, z up.
 * C_a_b takes a vector from a to b: x_b = C_a_b x_a. All double, pure, re-entrant; outputs must not alias inputs. */
#ifndef PELORUS_EARTH_H
#define PELORUS_EARTH_H

#include "pelorus/base.h"

#ifdef __cplusplus
extern "C" {
#endif

#define PEL_WGS84_A  6378137.0                           /* semi-major axis, m */
#define PEL_WGS84_F  (1.0 / 298.257223563)               /* flattening */
#define PEL_WGS84_E2 (PEL_WGS84_F * (2.0 - PEL_WGS84_F)) /* first eccentricity squared */
#define PEL_WGS84_B  (PEL_WGS84_A * (1.0 - PEL_WGS84_F)) /* semi-minor axis, m */
#define PEL_OMEGA_IE 7.292115e-5                         /* Earth rotation, rad/s */
#define PEL_MU       3.986004418e14                      /* gravitational constant of the Earth, m^3/s^2 */
#define PEL_J2       1.082627e-3                         /* second zonal coefficient (Groves 2013, section 2.4.7) */

/* Geodetic latitude, longitude (rad, lon in (-pi, pi]) and ellipsoidal height (m) of a point.
 * Height and latitude are exact to 1e-8 m from 10 km below the ellipsoid to 30 000 km above it, poles included (three
 * Bowring steps, no loop that depends on data). On the polar axis lon is 0; at the centre of the Earth lat and lon are 0.
 * Source: Bowring (1976), Survey Review 23. */
void pel_earth_ecef_to_llh(const double r_e[3], double *lat, double *lon, double *h);
void pel_earth_llh_to_ecef(double lat, double lon, double h, double r_e[3]);

/* Rotation from e to the local frame at (lat, lon): north-east-down, and east-north-up. */
void pel_earth_C_e_n(double lat, double lon, double C_e_n[3][3]);
void pel_earth_C_e_enu(double lat, double lon, double C_e_enu[3][3]);

/* Radii of curvature of the meridian and of the prime vertical, m, at the latitude with this sine. */
void pel_earth_radii_at(double sin_lat, double *R_M, double *R_N);

/* Gravity (gravitation and centrifugal acceleration) in e, m/s^2: J2 field, Groves (2013) 2.142. Differs from the normal
 * gravity of WGS-84 by at most 1.3e-4 m/s^2 (13 ug; the real field departs from either by up to 5e-4). |r_e| > 1000 km.
 * About 25 flops, a division and a square root. */
void pel_earth_gravity_e(const double r_e[3], double g_e[3]);

/* dg/dr in e, 1/s^2: point mass and centrifugal term, -mu/r^3 (I - 3 u u') + diag(w^2, w^2, 0). Symmetric. What J2 adds is
 * below 2.1e-8 of 3.1e-6. */
void pel_earth_gravity_gradient_e(const double r_e[3], double G[3][3]);

/* Attitude angles from C_b_e at a place: C_b_enu = Rz(-heading) Rx(pitch) Ry(roll).
 * roll in (-pi, pi] right side down, pitch in [-pi/2, pi/2] nose up, heading in [0, 2 pi) clockwise from north.
 * With the nose straight up or down roll and heading are one angle, returned as heading, with roll 0. */
void pel_attitude_from_C_b_e(const double C_b_e[3][3], double lat, double lon, double *roll, double *pitch,
                             double *heading);
void pel_attitude_to_C_b_e(double roll, double pitch, double heading, double lat, double lon, double C_b_e[3][3]);

/* The same between angles and C_b_enu. */
void pel_attitude_from_C_b_enu(const double C_b_enu[3][3], double *roll, double *pitch, double *heading);
void pel_attitude_to_C_b_enu(double roll, double pitch, double heading, double C_b_enu[3][3]);

#ifdef __cplusplus
}
#endif
#endif

/* attitude_angles.c - roll, pitch, heading from and to rotation matrices. */
#include "pelorus/earth.h"
#include "pelorus/math.h"

void pel_attitude_to_C_b_enu(double roll, double pitch, double heading, double C_b_enu[3][3])
{
    double sr;
    double cr;
    double sp;
    double cp;
    double sh;
    double ch;
    pel_sincos(roll, &sr, &cr);
    pel_sincos(pitch, &sp, &cp);
    pel_sincos(heading, &sh, &ch);
    C_b_enu[0][0] = ch * cr + sh * sp * sr;
    C_b_enu[0][1] = sh * cp;
    C_b_enu[0][2] = ch * sr - sh * sp * cr;
    C_b_enu[1][0] = -sh * cr + ch * sp * sr;
    C_b_enu[1][1] = ch * cp;
    C_b_enu[1][2] = -sh * sr - ch * sp * cr;
    C_b_enu[2][0] = -cp * sr;
    C_b_enu[2][1] = sp;
    C_b_enu[2][2] = cp * cr;
}

void pel_attitude_from_C_b_enu(const double C_b_enu[3][3], double *roll, double *pitch, double *heading)
{
    const double cos_pitch = pel_sqrt(C_b_enu[0][1] * C_b_enu[0][1] + C_b_enu[1][1] * C_b_enu[1][1]);
    double psi;
    *pitch = pel_atan2(C_b_enu[2][1], cos_pitch); /* full accuracy also near +-90 degrees, unlike asin */
    if (cos_pitch > 1e-12) {
        psi = pel_atan2(C_b_enu[0][1], C_b_enu[1][1]);
        *roll = pel_atan2(-C_b_enu[2][0], C_b_enu[2][2]);
    } else {
        psi = pel_atan2(-C_b_enu[1][0], C_b_enu[0][0]);
        *roll = 0.0;
    }
    *heading = (psi < 0.0) ? psi + 2.0 * PEL_PI : psi;
}

void pel_attitude_to_C_b_e(double roll, double pitch, double heading, double lat, double lon, double C_b_e[3][3])
{
    double C_b_enu[3][3];
    double C_e_enu[3][3];
    pel_attitude_to_C_b_enu(roll, pitch, heading, C_b_enu);
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    pel_mat3_tmul(C_e_enu, C_b_enu, C_b_e);
}

void pel_attitude_from_C_b_e(const double C_b_e[3][3], double lat, double lon, double *roll, double *pitch,
                             double *heading)
{
    double C_b_enu[3][3];
    double C_e_enu[3][3];
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    pel_mat3_mul(C_e_enu, C_b_e, C_b_enu);
    pel_attitude_from_C_b_enu(C_b_enu, roll, pitch, heading);
}

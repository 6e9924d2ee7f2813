/* world.c - see world.h. */
#include "world.h"

#include <math.h>

void world_llh_to_ecef(const double llh[3], double r_e[3])
{
    const double s = sin(llh[0]);
    const double c = cos(llh[0]);
    const double rn = WORLD_A / sqrt(1.0 - WORLD_E2 * s * s);
    r_e[0] = (rn + llh[2]) * c * cos(llh[1]);
    r_e[1] = (rn + llh[2]) * c * sin(llh[1]);
    r_e[2] = (rn * (1.0 - WORLD_E2) + llh[2]) * s;
}

/* Fixed-point iteration on z + e2 N sin(lat): contracts by e2 each time, so ten rounds reach double precision. */
void world_ecef_to_llh(const double r_e[3], double llh[3])
{
    const double p = hypot(r_e[0], r_e[1]);
    double z = r_e[2];
    double rn = WORLD_A;
    for (int i = 0; i < 10; i++) {
        const double s = z / hypot(p, z);
        rn = WORLD_A / sqrt(1.0 - WORLD_E2 * s * s);
        z = r_e[2] + WORLD_E2 * rn * s;
    }
    llh[0] = atan2(z, p);
    llh[1] = atan2(r_e[1], r_e[0]);
    llh[2] = hypot(p, z) - rn;
}

void world_C_n_e(double lat, double lon, double C[3][3])
{
    const double sl = sin(lat);
    const double cl = cos(lat);
    const double so = sin(lon);
    const double co = cos(lon);
    const double enu[3][3] = {{-so, co, 0.0}, {-sl * co, -sl * so, cl}, {cl * co, cl * so, sl}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { C[i][j] = enu[j][i]; }
    }
}

void world_C_b_n(double roll, double pitch, double heading, double C[3][3])
{
    const double sr = sin(roll);
    const double cr = cos(roll);
    const double sp = sin(pitch);
    const double cp = cos(pitch);
    const double sh = sin(heading);
    const double ch = cos(heading);
    C[0][0] = cr * ch + sr * sp * sh;
    C[1][0] = -cr * sh + sr * sp * ch;
    C[2][0] = -sr * cp;
    C[0][1] = cp * sh;
    C[1][1] = cp * ch;
    C[2][1] = sp;
    C[0][2] = sr * ch - cr * sp * sh;
    C[1][2] = -sr * sh - cr * sp * ch;
    C[2][2] = cr * cp;
}

void world_attitude(const double C_b_n[3][3], double out[3])
{
    out[0] = atan2(-C_b_n[2][0], C_b_n[2][2]);
    out[1] = atan2(C_b_n[2][1], hypot(C_b_n[0][1], C_b_n[1][1]));
    out[2] = atan2(C_b_n[0][1], C_b_n[1][1]);
}

void world_gravity(const double r_e[3], double g_e[3])
{
    const double r2 = dot(r_e, r_e);
    const double r = sqrt(r2);
    const double z2 = 5.0 * r_e[2] * r_e[2] / r2;
    const double k = -WORLD_MU / (r2 * r);
    const double j = 1.5 * WORLD_J2 * WORLD_A * WORLD_A / r2;
    const double w2 = WORLD_OMEGA * WORLD_OMEGA;
    g_e[0] = k * r_e[0] * (1.0 + j * (1.0 - z2)) + w2 * r_e[0];
    g_e[1] = k * r_e[1] * (1.0 + j * (1.0 - z2)) + w2 * r_e[1];
    g_e[2] = k * r_e[2] * (1.0 + j * (3.0 - z2));
}

double world_troposphere(double lat, double height, double el, double humidity)
{
    const double h = fmax(-500.0, fmin(20000.0, height));
    const double pressure = 1013.25 * pow(1.0 - 2.2557e-5 * h, 5.2568);
    const double temperature = 288.16 - 6.5e-3 * h;
    const double vapour = 6.108 * humidity * exp((17.15 * temperature - 4684.0) / (temperature - 38.45));
    const double dry = 0.0022768 * pressure / (1.0 - 0.00266 * cos(2.0 * lat) - 0.00028 * h / 1e3);
    const double wet = 0.002277 * (1255.0 / temperature + 0.05) * vapour;
    return (dry + wet) * world_troposphere_mapping(el);
}

double world_troposphere_mapping(double el)
{
    const double s = sin(fmax(el, 3.0 * WORLD_DEG));
    return 1.001 / sqrt(0.002001 + s * s);
}

double world_klobuchar(const double alpha[4], const double beta[4], double tow_s, double lat, double lon, double az,
                       double el)
{
    const double semi = 0.5 * WORLD_TWO_PI; /* one semicircle, rad */
    const double e = el / semi;
    const double psi = 0.0137 / (e + 0.11) - 0.022;
    double phi = lat / semi + psi * cos(az);
    phi = fmax(-0.416, fmin(0.416, phi));
    const double lambda = lon / semi + psi * sin(az) / cos(phi * semi);
    const double phi_m = phi + 0.064 * cos((lambda - 1.617) * semi);
    const double t = fmod(fmod(43200.0 * lambda + tow_s, 86400.0) + 86400.0, 86400.0);
    double amplitude = alpha[0] + phi_m * (alpha[1] + phi_m * (alpha[2] + phi_m * alpha[3]));
    double period = beta[0] + phi_m * (beta[1] + phi_m * (beta[2] + phi_m * beta[3]));
    amplitude = fmax(amplitude, 0.0);
    period = fmax(period, 72000.0);
    const double x = WORLD_TWO_PI * (t - 50400.0) / period;
    const double f = 1.0 + 16.0 * pow(0.53 - e, 3.0);
    const double hump = (fabs(x) < 1.57) ? amplitude * (1.0 - x * x / 2.0 + x * x * x * x / 24.0) : 0.0;
    return WORLD_C * f * (5e-9 + hump);
}

double world_pierce(const double llh[3], double az, double el, double *lat, double *lon)
{
    const double k = 6371000.0 / (6371000.0 + 450000.0);
    const double s = k * cos(el); /* sine of the zenith angle at the layer */
    const double psi = 0.25 * WORLD_TWO_PI - el - asin(s);
    *lat = asin(sin(llh[0]) * cos(psi) + cos(llh[0]) * sin(psi) * cos(az));
    *lon = llh[1] + asin(sin(psi) * sin(az) / cos(*lat));
    return 1.0 / sqrt(1.0 - s * s);
}

void world_azel(double lat, double lon, const double u_e[3], double *az, double *el)
{
    double C[3][3];
    double u[3];
    world_C_n_e(lat, lon, C);
    rotate_back(C, u_e, u);
    *az = atan2(u[0], u[1]);
    *el = asin(fmax(-1.0, fmin(1.0, u[2])));
}

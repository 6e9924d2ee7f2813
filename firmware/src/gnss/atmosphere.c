#include "pelorus/gnss.h"
#include "pelorus/math.h"

double pel_tropo_saastamoinen_m(double lat, double h, double el)
{
    const double humidity = 0.7;
    const double min_sin_el = 0.0523; /* 3 degrees */

    if (!pel_isfinite(lat) || !pel_isfinite(h) || !pel_isfinite(el) || h > 20000.0) { return 0.0; }
    if (h < -500.0) { h = -500.0; }

    /* Standard atmosphere: pressure and vapour pressure in hPa, temperature in K. */
    const double pressure = 1013.25 * pel_exp(5.2568 * pel_log(1.0 - 2.2557e-5 * h));
    const double temperature = 288.16 - 6.5e-3 * h;
    const double vapour = 6.108 * humidity * pel_exp((17.15 * temperature - 4684.0) / (temperature - 38.45));

    const double dry = 0.0022768 * pressure / (1.0 - 0.00266 * pel_cos(2.0 * lat) - 0.00028e-3 * h);
    const double wet = 0.002277 * (1255.0 / temperature + 0.05) * vapour;
    double sin_el = pel_sin(el);
    if (!(sin_el > min_sin_el)) { sin_el = min_sin_el; }
    return (dry + wet) * 1.001 / pel_sqrt(0.002001 + sin_el * sin_el);
}

static const pel_klobuchar_t NOMINAL = {
    .valid = true,
    .alpha = {1.118e-08f, 1.49e-08f, -5.96e-08f, -5.96e-08f},
    .beta = {88060.0f, 16380.0f, -196600.0f, -131100.0f},
};

/* Polynomial of degree 3 in the geomagnetic latitude. */
static double cubic(const float c[4], double x)
{
    return (double)c[0] + x * ((double)c[1] + x * ((double)c[2] + x * (double)c[3]));
}

double pel_iono_klobuchar_m(const pel_klobuchar_t *k, pel_time_t t_ns, double lat, double lon, double az, double el)
{
    if (!pel_isfinite(lat) || !pel_isfinite(lon) || !pel_isfinite(az) || !pel_isfinite(el)) { return 0.0; }
    if (el < 0.0) { el = 0.0; }
    if (!k->valid) { k = &NOMINAL; }

    /* Angles in semicircles as in IS-GPS-200. */
    const double el_sc = el / PEL_PI;
    const double psi = 0.0137 / (el_sc + 0.11) - 0.022; /* Earth-centred angle to the pierce point */
    double lat_i = lat / PEL_PI + psi * pel_cos(az);
    if (lat_i > 0.416) { lat_i = 0.416; }
    if (lat_i < -0.416) { lat_i = -0.416; }
    const double lon_i = lon / PEL_PI + psi * pel_sin(az) / pel_cos(lat_i * PEL_PI);
    const double lat_m = lat_i + 0.064 * pel_cos((lon_i - 1.617) * PEL_PI);

    double local_s = 43200.0 * lon_i + pel_time_tow_s(t_ns);
    local_s -= pel_floor(local_s / 86400.0) * 86400.0;
    const double away = 0.53 - el_sc;
    const double slant = 1.0 + 16.0 * away * away * away;

    double amplitude = cubic(k->alpha, lat_m);
    double period = cubic(k->beta, lat_m);
    if (!(amplitude > 0.0)) { amplitude = 0.0; }
    if (!(period > 72000.0)) { period = 72000.0; }
    const double x = 2.0 * PEL_PI * (local_s - 50400.0) / period;
    const double day = (pel_fabs(x) < 1.57) ? amplitude * (1.0 - x * x / 2.0 + x * x * x * x / 24.0) : 0.0;
    return PEL_SPEED_OF_LIGHT * slant * (5e-9 + day);
}

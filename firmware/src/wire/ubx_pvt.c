#include "framing.h"

#include <string.h>

#define DEG (3.14159265358979323846 / 180.0)

/* Days from 1980-01-06 to a date of the proleptic Gregorian calendar (years counted from March, so that a leap day ends one). */
static int32_t days_since_1980(int32_t year, int32_t month, int32_t day)
{
    const int32_t y = (month > 2) ? year : year - 1;
    const int32_t m = (month > 2) ? month - 3 : month + 9;
    return 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 1 - 723125;
}

static bool plausible(const pel_pvt_t *p)
{
    const double pi = 180.0 * DEG;
    if (!(p->lat_rad >= -pi / 2.0 && p->lat_rad <= pi / 2.0 && p->lon_rad >= -pi && p->lon_rad <= pi)) { return false; }
    for (int i = 0; i < 3; i++) {
        if (!(p->v_ned[i] > -1e4 && p->v_ned[i] < 1e4)) { return false; }
    }
    return p->height_m > -2e4 && p->height_m < 1e7;
}

/* The fields of UTC. A day beyond its month would move the week, and the week goes into every time that carries none. */
static bool date_possible(const uint8_t *m)
{
    const uint32_t year = (uint32_t)pel_le_u(m + 4, 2);
    return year >= 1999u && year <= 2094u && m[6] >= 1u && m[6] <= 12u && m[7] >= 1u && m[7] <= 31u && m[8] <= 23u &&
           m[9] <= 59u && m[10] <= 60u;
}

pel_rx_event_t pel_ubx_pvt(pel_receiver_t *rx, const uint8_t *m, size_t n)
{
    const uint32_t itow_ms = (uint32_t)pel_le_u(m, 4);
    const int32_t year = (int32_t)pel_le_u(m + 4, 2);
    const bool date_valid = (m[11] & 0x01u) != 0u;
    pel_pvt_t p;

    (void)n; /* 84 or 92, asked for by the probe */
    memset(&p, 0, sizeof p);
    p.fix = m[20];
    p.carrier_soln = (uint8_t)(m[21] >> 6);
    p.n_sat = m[23];
    p.lon_rad = (double)pel_le_s(m + 24, 4) * 1e-7 * DEG;
    p.lat_rad = (double)pel_le_s(m + 28, 4) * 1e-7 * DEG;
    p.height_m = (double)pel_le_s(m + 32, 4) * 1e-3;
    p.sd_h_m = (float)pel_le_u(m + 40, 4) * 1e-3f;
    p.sd_v_m = (float)pel_le_u(m + 44, 4) * 1e-3f;
    for (int i = 0; i < 3; i++) { p.v_ned[i] = (double)pel_le_s(m + 48 + 4 * i, 4) * 1e-3; }
    p.sd_speed_mps = (float)pel_le_u(m + 68, 4) * 1e-3f;

    if (itow_ms >= 604800000u || !plausible(&p) || (date_valid && !date_possible(m))) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    if (!date_valid && rx->t_approx_ns == 0) {
        rx->counters.unknown++; /* nothing tells the week */
        return PEL_RX_NONE;
    }
    pel_time_t near = rx->t_approx_ns;
    if (date_valid) {
        near = (pel_time_t)days_since_1980(year, m[6], m[7]) * 86400 * PEL_NS_PER_S + 43200 * PEL_NS_PER_S;
    }
    p.t_ns = pel_tow_ms_near(itow_ms, near);
    if (rx->t_approx_ns == 0) { rx->t_approx_ns = p.t_ns; }
    rx->pvt = p;
    return PEL_RX_PVT;
}

/* Year, month, day of a count of days since 1980-01-06: the inverse of days_since_1980, by estimate and correction. */
static void date_of(int32_t days, int32_t *year, int32_t *month, int32_t *day)
{
    int32_t y = 1980 + days / 366;
    while (days_since_1980(y + 1, 1, 1) <= days) { y++; } /* at most one turn per 366 years */
    int32_t m = 1;
    while (m < 12 && days_since_1980(y, m + 1, 1) <= days) { m++; }
    *year = y;
    *month = m;
    *day = days - days_since_1980(y, m, 1) + 1;
}

size_t pel_ubx_encode_pvt(const pel_pvt_t *p, uint8_t *out, size_t cap)
{
    if (cap < 100u || !plausible(p) || p->t_ns < 0) { return 0; }
    uint8_t *const m = out + 6;
    const int64_t utc_s = p->t_ns / PEL_NS_PER_S - pel_time_leap_s(p->t_ns);
    const int32_t of_day = (int32_t)(utc_s % 86400);
    int32_t year;
    int32_t month;
    int32_t day;

    memset(m, 0, 92);
    date_of((int32_t)(utc_s / 86400), &year, &month, &day);
    pel_le_put(m, 4, (uint64_t)((p->t_ns % PEL_NS_PER_WEEK) / PEL_NS_PER_MS));
    pel_le_put(m + 4, 2, (uint64_t)year);
    m[6] = (uint8_t)month;
    m[7] = (uint8_t)day;
    m[8] = (uint8_t)(of_day / 3600);
    m[9] = (uint8_t)(of_day / 60 % 60);
    m[10] = (uint8_t)(of_day % 60);
    m[11] = 0x07; /* date, time, fully resolved */
    pel_le_put(m + 16, 4, (uint64_t)(p->t_ns % PEL_NS_PER_S));
    m[20] = p->fix;
    m[21] = (uint8_t)(((p->fix >= 2) ? 0x01u : 0u) | ((unsigned)p->carrier_soln << 6));
    m[23] = p->n_sat;
    pel_le_put(m + 24, 4, (uint64_t)pel_round_i64(p->lon_rad / DEG * 1e7));
    pel_le_put(m + 28, 4, (uint64_t)pel_round_i64(p->lat_rad / DEG * 1e7));
    pel_le_put(m + 32, 4, (uint64_t)pel_round_i64(p->height_m * 1e3));
    pel_le_put(m + 36, 4, (uint64_t)pel_round_i64(p->height_m * 1e3));
    pel_le_put(m + 40, 4, (uint64_t)pel_round_i64((double)p->sd_h_m * 1e3));
    pel_le_put(m + 44, 4, (uint64_t)pel_round_i64((double)p->sd_v_m * 1e3));
    for (int i = 0; i < 3; i++) { pel_le_put(m + 48 + 4 * i, 4, (uint64_t)pel_round_i64(p->v_ned[i] * 1e3)); }
    pel_le_put(m + 68, 4, (uint64_t)pel_round_i64((double)p->sd_speed_mps * 1e3));
    return pel_ubx_seal(0x01, 0x07, 92, out, cap);
}

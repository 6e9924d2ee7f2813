#include "framing.h"

#include <string.h>

#define RAD_TO_DEG  (180.0 / 3.14159265358979323846)
#define MPS_TO_KNOT (3600.0 / 1852.0)

/* ---- text without printf: a cursor that remembers when it did not fit ------------------------------------------------ */

typedef struct {
    char *p;
    size_t cap, n;
    bool failed;
} text_t;

static void put_char(text_t *t, char c)
{
    if (t->failed || t->n + 1u >= t->cap) { /* one is kept for the NUL */
        t->failed = true;
        return;
    }
    t->p[t->n] = c;
    t->n++;
}

static void put_text(text_t *t, const char *s)
{
    while (*s != '\0') {
        put_char(t, *s);
        s++;
    }
}

/* At least `width` digits. */
static void put_uint(text_t *t, uint64_t v, int width)
{
    char digit[20];
    int n = 0;
    while (n < width || v > 0u) {
        digit[n] = (char)('0' + (int)(v % 10u));
        v /= 10u;
        n++;
    }
    while (n > 0) {
        n--;
        put_char(t, digit[n]);
    }
}

static uint64_t power_of_10(int n)
{
    uint64_t v = 1;
    for (int i = 0; i < n; i++) { v *= 10u; }
    return v;
}

/* Fixed point with this many decimals, rounded once; integer part at least `width` digits. */
static void put_fixed(text_t *t, double x, int width, int decimals)
{
    const uint64_t scale = power_of_10(decimals);
    const int64_t raw = pel_round_i64(x * (double)scale);
    if (raw == INT64_MIN) {
        t->failed = true;
        return;
    }
    if (raw < 0) { put_char(t, '-'); }
    const uint64_t magnitude = (uint64_t)((raw < 0) ? -raw : raw);
    put_uint(t, magnitude / scale, width);
    put_char(t, '.');
    put_uint(t, magnitude % scale, decimals);
}

static void begin(text_t *t, char *out, size_t cap, const char *address)
{
    t->p = out;
    t->cap = cap;
    t->n = 0;
    t->failed = false;
    put_char(t, '$');
    put_text(t, address);
}

static size_t finish(text_t *t)
{
    static const char HEX[] = "0123456789ABCDEF";
    unsigned sum = 0;
    for (size_t i = 1; i < t->n; i++) { sum ^= (unsigned)(uint8_t)t->p[i]; }
    put_char(t, '*');
    put_char(t, HEX[sum >> 4]);
    put_char(t, HEX[sum & 15u]);
    put_text(t, "\r\n");
    if (t->failed) { return 0; }
    t->p[t->n] = '\0';
    return t->n;
}

/* ---- fields -------------------------------------------------------------------------------------------------------------- */

/* UTC in hundredths of a second since 1980-01-06, rounded down: a time of validity is never in the future. */
static int64_t utc_cs(pel_time_t t_ns)
{
    return t_ns / (PEL_NS_PER_S / 100) - 100 * (int64_t)pel_time_leap_s(t_ns);
}

static void put_time(text_t *t, pel_time_t t_ns)
{
    const int64_t cs = utc_cs(t_ns) % (86400 * 100);
    put_uint(t, (uint64_t)(cs / 360000), 2);
    put_uint(t, (uint64_t)(cs / 6000 % 60), 2);
    put_uint(t, (uint64_t)(cs / 100 % 60), 2);
    put_char(t, '.');
    put_uint(t, (uint64_t)(cs % 100), 2);
}

static bool is_leap(int32_t y)
{
    return (y % 4 == 0 && y % 100 != 0) || y % 400 == 0;
}

static void put_date(text_t *t, pel_time_t t_ns)
{
    static const uint8_t DAYS[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    int32_t day = (int32_t)(utc_cs(t_ns) / (86400 * 100)) + 5; /* days since 1980-01-01 */
    int32_t year = 1980;
    int32_t month = 0;
    while (day >= (is_leap(year) ? 366 : 365)) { /* one turn a year since 1980; int64 ns end in 2272 */
        day -= is_leap(year) ? 366 : 365;
        year++;
    }
    while (day >= DAYS[month] + ((month == 1 && is_leap(year)) ? 1 : 0)) {
        day -= DAYS[month] + ((month == 1 && is_leap(year)) ? 1 : 0);
        month++;
    }
    put_uint(t, (uint64_t)day + 1u, 2);
    put_uint(t, (uint64_t)month + 1u, 2);
    put_uint(t, (uint64_t)(year % 100), 2);
}

/* ddmm.mmmmmmm,H: seven decimals of a minute are 0.2 mm. */
static void put_angle(text_t *t, double rad, int degree_digits, char positive, char negative)
{
    const double scale = 60.0 * 1e7;
    const int64_t raw = pel_round_i64(((rad < 0.0) ? -rad : rad) * RAD_TO_DEG * scale);
    const uint64_t units = (uint64_t)raw;
    if (raw == INT64_MIN) {
        t->failed = true;
        return;
    }
    put_uint(t, units / 600000000u, degree_digits);
    put_uint(t, units % 600000000u / 10000000u, 2);
    put_char(t, '.');
    put_uint(t, units % 10000000u, 7);
    put_char(t, ',');
    put_char(t, (rad < 0.0) ? negative : positive);
}

static void put_position(text_t *t, const pel_solution_t *s)
{
    if (s->fix == PEL_FIX_NONE) {
        put_text(t, ",,,");
        return;
    }
    put_angle(t, s->lat_rad, 2, 'N', 'S');
    put_char(t, ',');
    put_angle(t, s->lon_rad, 3, 'E', 'W');
}

/* [0, 360) after rounding to two decimals. */
static void put_bearing(text_t *t, double rad)
{
    int64_t cdeg = pel_round_i64(rad * RAD_TO_DEG * 100.0);
    if (cdeg == INT64_MIN) {
        t->failed = true;
        return;
    }
    cdeg = (cdeg % 36000 + 36000) % 36000;
    put_uint(t, (uint64_t)(cdeg / 100), 1);
    put_char(t, '.');
    put_uint(t, (uint64_t)(cdeg % 100), 2);
}

static int gga_quality(uint8_t fix)
{
    switch (fix) {
    case PEL_FIX_SPP: return 1;
    case PEL_FIX_FLOAT: return 5;
    case PEL_FIX_FIXED: return 4;
    case PEL_FIX_COAST: return 6;
    default: return 0;
    }
}

/* FAA mode of RMC and of GGA's kin. */
static char mode_of(uint8_t fix)
{
    switch (fix) {
    case PEL_FIX_SPP: return 'A';
    case PEL_FIX_FLOAT: return 'F';
    case PEL_FIX_FIXED: return 'R';
    case PEL_FIX_COAST: return 'E';
    default: return 'N';
    }
}

/* Direction of a horizontal velocity in rad from north, (-pi, pi]. wire/ knows base/ alone, and for the hundredth of a
 * degree that is printed the octant and a polynomial do: error below 2e-8 rad. */
static double course(double north, double east)
{
    const double half_pi = 1.57079632679489661923;
    const double n = (north < 0.0) ? -north : north;
    const double e = (east < 0.0) ? -east : east;
    const double big = (n > e) ? n : e;
    if (!(big > 0.0)) { return 0.0; }
    const double x = ((n > e) ? e : n) / big;
    const double y = x * x;
    /* Abramowitz and Stegun (1964), 4.4.49 */
    double a = 0.0028662257;
    a = a * y - 0.0161657367;
    a = a * y + 0.0429096138;
    a = a * y - 0.0752896400;
    a = a * y + 0.1065626393;
    a = a * y - 0.1420889944;
    a = a * y + 0.1999355085;
    a = a * y - 0.3333314528;
    a = (a * y + 1.0) * x;
    if (e > n) { a = half_pi - a; }
    if (north < 0.0) { a = 2.0 * half_pi - a; }
    return (east < 0.0) ? -a : a;
}

/* Newton from above: five steps give a speed below 1 km/s to better than the millimetre that is printed. */
static double speed(double north, double east)
{
    const double square = north * north + east * east;
    double v = (north < 0.0 ? -north : north) + (east < 0.0 ? -east : east); /* >= the root, <= 1.42 of it */
    if (!(v > 0.0)) { return 0.0; }
    for (int i = 0; i < 5; i++) { v = 0.5 * (v + square / v); }
    return v;
}

/* ---- sentences ------------------------------------------------------------------------------------------------------------ */

size_t pel_nmea_gga(const pel_solution_t *s, char *out, size_t cap)
{
    text_t t;
    begin(&t, out, cap, "GNGGA,");
    put_time(&t, s->t_ns);
    put_char(&t, ',');
    put_position(&t, s);
    put_char(&t, ',');
    put_uint(&t, (uint64_t)gga_quality(s->fix), 1);
    put_char(&t, ',');
    put_uint(&t, s->n_sat, 2);
    put_text(&t, ",,"); /* no dilution of precision: the covariance is in the solution frame */
    if (s->fix != PEL_FIX_NONE) {
        put_fixed(&t, s->height_m, 1, 4);
        put_text(&t, ",M,0.0,M,");
    } else {
        put_text(&t, ",,,,");
    }
    if (s->base_age_s >= 0.0f && (s->fix == PEL_FIX_FLOAT || s->fix == PEL_FIX_FIXED)) {
        put_fixed(&t, (double)s->base_age_s, 1, 1);
        put_text(&t, ",0000");
    } else {
        put_char(&t, ',');
    }
    return finish(&t);
}

size_t pel_nmea_rmc(const pel_solution_t *s, char *out, size_t cap)
{
    const double north = (double)s->v_ned[0];
    const double east = (double)s->v_ned[1];
    text_t t;
    begin(&t, out, cap, "GNRMC,");
    put_time(&t, s->t_ns);
    put_text(&t, (s->fix == PEL_FIX_NONE) ? ",V," : ",A,");
    put_position(&t, s);
    put_char(&t, ',');
    if (s->fix != PEL_FIX_NONE) {
        put_fixed(&t, speed(north, east) * MPS_TO_KNOT, 1, 3);
        put_char(&t, ',');
        put_bearing(&t, course(north, east));
    } else {
        put_char(&t, ',');
    }
    put_char(&t, ',');
    put_date(&t, s->t_ns);
    put_text(&t, ",,,");
    put_char(&t, mode_of(s->fix));
    put_text(&t, ",V"); /* not a certified integrity statement */
    return finish(&t);
}

size_t pel_nmea_hdt(const pel_solution_t *s, char *out, size_t cap)
{
    text_t t;
    begin(&t, out, cap, "GNHDT,");
    if ((s->flags & PEL_SOL_HEADING) != 0u) { put_bearing(&t, (double)s->heading_rad); }
    put_text(&t, ",T");
    return finish(&t);
}

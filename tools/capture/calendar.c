#include "calendar.h"

#include <stdio.h>
#include <string.h>

#define NS_PER_DAY (86400 * PEL_NS_PER_S)

static bool leap_year(int y)
{
    return (y % 4 == 0 && y % 100 != 0) || y % 400 == 0;
}

static int days_in_month(int y, int m)
{
    static const int DAYS[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    return DAYS[m - 1] + ((m == 2 && leap_year(y)) ? 1 : 0);
}

/* Days from 1980-01-06 to a date: whole years, then whole months. */
static int64_t days_since_gps(int y, int m, int d)
{
    int64_t days = -6;
    for (int i = 1980; i < y; i++) { days += leap_year(i) ? 366 : 365; }
    for (int i = 1; i < m; i++) { days += days_in_month(y, i); }
    return days + d;
}

bool calendar_to_gps(int year, int month, int day, int hour, int minute, int64_t ns, time_system_t sys, pel_time_t *t)
{
    if (year < 1980 || year > 2199 || month < 1 || month > 12) { return false; }
    if (day < 1 || day > days_in_month(year, month)) { return false; }
    /* 60 s and more appear in leap seconds and in files that carry a rounded second. */
    if (hour < 0 || hour > 24 || minute < 0 || minute > 60 || ns < 0 || ns > 61 * PEL_NS_PER_S) { return false; }
    pel_time_t x = days_since_gps(year, month, day) * NS_PER_DAY;
    x += (int64_t)(hour * 3600 + minute * 60) * PEL_NS_PER_S + ns;
    if (sys == CLOCK_BDT) { x += 14 * PEL_NS_PER_S; }
    if (sys == CLOCK_UTC) { x += pel_time_leap_s(x + (int64_t)pel_time_leap_s(x) * PEL_NS_PER_S) * PEL_NS_PER_S; }
    *t = x;
    return true;
}

bool calendar_parse_date(const char *text, pel_time_t *t)
{
    int y = 0, m = 0, d = 0, used = 0;
    if (sscanf(text, "%4d-%2d-%2d%n", &y, &m, &d, &used) != 3 || text[used] != '\0') { return false; }
    return calendar_to_gps(y, m, d, 12, 0, 0, CLOCK_GPS, t);
}

void calendar_print(pel_time_t t, char out[64])
{
    int64_t days = t / NS_PER_DAY;
    const int64_t ms = (t - days * NS_PER_DAY) / PEL_NS_PER_MS;
    int y = 1980, m = 1;
    days += 5; /* since 1980-01-01 */
    while (days >= (leap_year(y) ? 366 : 365)) { days -= leap_year(y++) ? 366 : 365; }
    while (days >= days_in_month(y, m)) { days -= days_in_month(y, m++); }
    snprintf(out, 64, "%04d-%02d-%02d %02d:%02d:%02d.%03d", y % 10000, m, (int)days + 1, (int)(ms / 3600000),
             (int)(ms / 60000 % 60), (int)(ms / 1000 % 60), (int)(ms % 1000));
}

/* calendar.h - civil dates and the time systems of RINEX to GPS time. */
#ifndef PELORUS_TOOLS_CAPTURE_CALENDAR_H
#define PELORUS_TOOLS_CAPTURE_CALENDAR_H

#include <stdbool.h>
#include <stdint.h>

#include "pelorus/base.h"

typedef enum { CLOCK_GPS, CLOCK_UTC, CLOCK_BDT } time_system_t; /* Galileo and QZSS time are GPS time to a few ns */

/* Date and time of day -> GPS time; ns counts from the minute. False if there is no such time (1980..2199). */
bool calendar_to_gps(int year, int month, int day, int hour, int minute, int64_t ns, time_system_t sys, pel_time_t *t);

/* "YYYY-MM-DD" -> noon of that day. False if it is not a date. */
bool calendar_parse_date(const char *text, pel_time_t *t);

/* "2021-09-22 06:30:00.000", GPS time. */
void calendar_print(pel_time_t t, char out[64]);

#endif

/* rinex_header.h - what the header of a RINEX 2 or 3 observation file says, as far as measurements depend on it.
 *
 * Header records may come again inside the file (epoch flags 2 to 5): they go through the same function. */
#ifndef PELORUS_TOOLS_CAPTURE_RINEX_HEADER_H
#define PELORUS_TOOLS_CAPTURE_RINEX_HEADER_H

#include "calendar.h"
#include "input.h"
#include "pelorus/base.h"
#include "tally.h"

#define RINEX_MAX_COLUMNS 99 /* what the format can say */
#define RINEX_MAX_PRN     64

/* One column of observations, as it is used here. */
typedef struct {
    char type;       /* 'C' code, 'L' phase, 'D' Doppler, 'S' strength; 0: not used */
    char attr;       /* tracking code; '*' in RINEX 2 for what belongs to any code of the carrier */
    uint8_t carrier; /* pel_carrier_t */
    double scale;    /* the file's number divided by this is the measurement */
} rinex_column_t;

typedef struct {
    int version_100; /* 210, 211, 304, ... */
    bool is_obs;
    char file_sys; /* 'G', 'R', 'M', ... of the first line */
    time_system_t time_system;
    int n_columns[PEL_N_SYS];
    rinex_column_t column[PEL_N_SYS][RINEX_MAX_COLUMNS];
    bool strength_dbhz;                /* S columns are dB-Hz (RINEX 3 by default) */
    bool half_cycle[RINEX_MAX_PRN][2]; /* RINEX 2 wavelength factor 2 of GPS L1, L2 */
    bool has_position;
    double r_marker_e[3]; /* APPROX POSITION XYZ */
    double delta_hen[3];  /* antenna height, east, north, m */
    int8_t glo_k[33];     /* GLONASS channel by slot; GLO_K_UNKNOWN where not told */
    int types_left;       /* of a continued list of observation types */
    int types_sys;        /* pel_sys_t it belongs to, -1: one not used here */
} rinex_header_t;

#define GLO_K_UNKNOWN 127

/* Read the header; *lines is left at the first line after it. False: not a RINEX observation file (*why is a literal). */
bool rinex_header_read(rinex_header_t *h, lines_t *lines, tally_t *tally, const char **why);

/* One header record, from the header or from inside the file. True: it was END OF HEADER. */
bool rinex_header_record(rinex_header_t *h, line_t l, tally_t *tally);

/* System of a RINEX satellite letter (blank is GPS), -1 if not one of ours. */
int rinex_system(char letter);

/* Satellite "G05", " 5", "J 1", "S20" at a column. False if there is none of ours. */
bool rinex_satellite(line_t l, size_t col, uint8_t *sys, uint8_t *prn);

/* Antenna reference point in ECEF: marker plus antenna delta. False without a position. */
bool rinex_header_station(const rinex_header_t *h, double r_ea_e[3]);

#endif

/* motion.h - the truth: one motion, continuous in time, from a list of segments.
 *
 * Course, speed and height are given in closed form: within a segment each goes from its old to its new value along the
 * quintic 10 u^3 - 15 u^4 + 6 u^5, whose rate and acceleration vanish at both ends. Horizontal place is the integral of
 * speed along course, by Gauss quadrature to the last digit. It lives on a plate carree map whose scale is true at the
 * start, which makes latitude, longitude and all their derivatives exact functions of the map's.
 * Attitude follows the path (heading along course, coordinated bank, pitch along the climb), plus sinusoids.
 * Everything that sensors feel, rates and specific force, is the exact derivative of that.
 *
 * Times here are seconds since the start of the scenario. */
#ifndef PELORUS_SIM_MOTION_H
#define PELORUS_SIM_MOTION_H

#include <stdbool.h>

#define MOTION_MAX_WAVES 16

typedef enum { WAVE_ROLL, WAVE_PITCH, WAVE_YAW, WAVE_EAST, WAVE_NORTH, WAVE_UP } wave_axis_t;

/* amplitude sin(2 pi rate t + phase) on one axis; rad or m. */
typedef struct {
    wave_axis_t axis;
    double amplitude;
    double rate_hz;
    double phase;
} wave_t;

/* One segment as asked for: changes over its duration. */
typedef struct {
    double duration_s;
    double speed_change; /* m/s */
    double turn;         /* rad, clockwise */
    double climb;        /* m */
} segment_t;

typedef struct {
    double llh[3];         /* start: rad, rad, m */
    double heading;        /* rad */
    double roll, pitch;    /* how the body sits in the vehicle, added to the path's, rad */
    double speed;          /* at the start, m/s */
    bool bank;             /* coordinated turns */
    bool pitch_along_path; /* nose up when climbing */
    double wave_speed;     /* waves reach half their power at this speed and vanish at rest; 0: always on, m/s */
    double wave_delay_s;   /* waves fade in over 5 s from here on */
    int n_waves;
    wave_t waves[MOTION_MAX_WAVES];
} motion_config_t;

/* Start values of one segment and where its nodes of integrated place begin. */
typedef struct {
    segment_t to;
    double t0, speed, course, height;
    int first_node, n_nodes;
} piece_t;

typedef struct {
    motion_config_t cfg;
    int n_pieces;
    piece_t *pieces;
    double (*node)[2]; /* east, north of the map at the nodes, m */
    int n_nodes;
    double scale_east, scale_north; /* m of map per rad of longitude, latitude */
    double end_s;
} motion_t;

/* Everything there is to know at one time. */
typedef struct {
    double r_eb_e[3], v_eb_e[3], a_eb_e[3]; /* m, m/s, m/s^2, seen from the rotating Earth */
    double C_b_e[3][3];
    double omega_ib_b[3], omega_eb_b[3]; /* rad/s */
    double f_ib_b[3];                    /* m/s^2 */
    double llh[3];
    double v_enu[3];
    double roll, pitch, heading;
} state_t;

/* Build from n segments (copied). False: out of memory. A motion holds its last state's speed and course beyond its end. */
bool motion_init(motion_t *m, const motion_config_t *cfg, const segment_t *segments, int n);
void motion_free(motion_t *m);

/* The truth at t. About 0.7 us. */
void motion_at(const motion_t *m, double t, state_t *out);

/* A point fixed to the body, lever b axes: place and velocity. */
void motion_point(const state_t *s, const double lever_b[3], double r_e[3], double v_e[3]);

/* True increments of an ideal sensor in b over [t0, t1]: integrals of omega_ib_b and f_ib_b (4-point Gauss). */
void motion_increment(const motion_t *m, double t0, double t1, double alpha[3], double upsilon[3]);

#endif

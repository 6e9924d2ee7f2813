/* inertial.h - strapdown integration in ECEF and in local axes, the ring of IMU increments, alignment. Room: inertial/.
 *
 * Frames: e ECEF, i inertial, enu local east-north-up, b body (x right, y forward, z up). Increments are those of a pel_imu_t, turned to b and
 * corrected for sensor errors beforehand. State in double, owned by the caller; all functions are re-entrant. */
#ifndef PELORUS_INERTIAL_H
#define PELORUS_INERTIAL_H

#include "pelorus/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- strapdown ------------------------------------------------------------------------------------------------- */

/* Navigation state of the IMU's reference point. 128 bytes. Callers may read and write every field. */
typedef struct {
    pel_time_t t_ns;
    double C_b_e[3][3];
    double v_eb_e[3]; /* m/s */
    double r_eb_e[3]; /* m */
} pel_strapdown_t;

/* What one step leaves to the next, and to the error model. */
typedef struct {
    double alpha[3];   /* previous angle increment, rad */
    double upsilon[3]; /* previous velocity increment, m/s */
    double dt_s;       /* its length; 0: there is none, no coning or sculling correction in the next step */
    double dv_f_e
        [3]; /* output: integral of specific force over the last step, resolved in e, m/s (enu after pel_strapdown_enu_step) */
} pel_coning_t;

/* Forget the previous increment: at start and after a gap. */
void pel_coning_init(pel_coning_t *c);

/* Advance the state over one increment.
 *
 *  s         in/out  state at the start -> at the end of the increment
 *  c         in/out  previous increment -> this one
 *  alpha     in      integral of omega_ib_b, rad, below 0.5
 *  upsilon   in      integral of f_ib_b, m/s
 *  dt_s      in      length, > 0, s
 *  t_end     in      becomes s->t_ns
 *
 * Attitude: rotation vector with coning from this and the previous increment (error of order dt^4 in rate, exact for motion
 * linear in time); the turn of the Earth is applied exactly. Velocity: sculling likewise, Coriolis and gravity at mid
 * step; position by the trapezoid of velocity. Previous increments of another length are scaled to this one's.
 * Never fails: the caller keeps NaN and absurd increments out. About 260 flops, one square root, no trigonometry.
 * Sources: Savage (1998), J. Guidance 21(1) and 21(2), two-sample forms; Groves (2013) 5.4.1. */
void pel_strapdown_step(pel_strapdown_t *s, pel_coning_t *c, const double alpha[3], const double upsilon[3],
                        double dt_s, pel_time_t t_end);

/* Subtract constant sensor errors from an increment: alpha - b_g dt, upsilon - b_a dt (rad/s, m/s^2). */
void pel_imu_correct(const pel_imu_t *imu, const double b_g[3], const double b_a[3], double alpha[3],
                     double upsilon[3]);

/* ---- strapdown in local axes ------------------------------------------------------------------------------------ */

/* Navigation state in east-north-up axes at the IMU's own place. 128 bytes. Callers may read and write every field. */
typedef struct {
    pel_time_t t_ns;
    double C_b_enu[3][3];
    double v_eb_enu[3]; /* m/s */
    double lat, lon, h; /* rad, lon in (-pi, pi]; m */
} pel_strapdown_enu_t;

/* Local axes end 1 degree from a pole: beyond, tan(lat) and 1/cos(lat) make heading and longitude meaningless. */
#define PEL_ENU_MAX_LAT 1.5533430342749532 /* 89 degrees */

/* Advance the state over one increment; arguments, coning and sculling as pel_strapdown_step().
 *
 * Rates of the local axes, Coriolis and gravity at mid step, position by the trapezoid of velocity with the radii at mid step:
 * second order in dt_s. Gravity is pel_earth_gravity_e(), as in ECEF, so that both give the same path.
 * PEL_E_RANGE, s and c unchanged: the step would end beyond PEL_ENU_MAX_LAT, or a number is not finite. Go on in ECEF
 * (pel_strapdown_from_enu). Longitude goes on at -pi after pi. About 450 flops, two square roots, one sine and cosine.
 * Sources: Groves (2013) 5.4; S2 section 5. */
pel_status_t pel_strapdown_enu_step(pel_strapdown_enu_t *s, pel_coning_t *c, const double alpha[3],
                                    const double upsilon[3], double dt_s, pel_time_t t_end);

/* The same state in the other frame. To enu: PEL_E_RANGE and out unchanged beyond PEL_ENU_MAX_LAT. */
pel_status_t pel_strapdown_to_enu(const pel_strapdown_t *s, pel_strapdown_enu_t *out);
void pel_strapdown_from_enu(const pel_strapdown_enu_t *s, pel_strapdown_t *out);

/* ---- ring of increments ----------------------------------------------------------------------------------------- */

/* The last PEL_IMU_RING increments in order of time; 76 bytes each, with a check of each: it waits for half a
 * second, in which memory may change by itself. Callers read through the functions below. */
typedef struct {
    pel_imu_t imu[PEL_IMU_RING];
    uint16_t head; /* where the next one goes */
    uint16_t n;
} pel_imu_ring_t;

void pel_imu_ring_init(pel_imu_ring_t *ring);

/* Append an increment; the oldest is overwritten when full. PEL_E_STALE (ring unchanged) unless it is newer than the
 * newest; PEL_E_RANGE unless 0 < dt_s <= 10. */
pel_status_t pel_imu_ring_push(pel_imu_ring_t *ring, const pel_imu_t *imu);

/* The i-th from the oldest (0), or NULL beyond the ring's content. Valid until the next push. */
const pel_imu_t *pel_imu_ring_at(const pel_imu_ring_t *ring, int i);
const pel_imu_t *pel_imu_ring_oldest(const pel_imu_ring_t *ring);
const pel_imu_t *pel_imu_ring_newest(const pel_imu_ring_t *ring);

/* Is the i-th what was pushed? False beyond the ring's content. */
bool pel_imu_ring_is_whole(const pel_imu_ring_t *ring, int i);

/* Index of the first increment that ends after t (the one that contains or follows t); ring->n if there is none.
 * Binary search. */
int pel_imu_ring_after(const pel_imu_ring_t *ring, pel_time_t t_ns);

/* Are there at least `count` increments that end after t? Without a search. */
bool pel_imu_ring_has_after(const pel_imu_ring_t *ring, pel_time_t t_ns, int count);

/* Cut an increment at a time inside it: rate and specific force are taken as constant over it. Both halves keep seq and
 * flags. PEL_E_RANGE (outputs unchanged) unless start < t < end. Outputs may alias the input. */
pel_status_t pel_imu_split(const pel_imu_t *whole, pel_time_t t_ns, pel_imu_t *first, pel_imu_t *second);

/* ---- alignment --------------------------------------------------------------------------------------------------- */

/* Attitude and its uncertainty after alignment. */
typedef struct {
    double C_b_e[3][3];
    double sd_level_rad;    /* of each of the two tilts */
    double sd_heading_rad;  /* PI if heading is unknown (C_b_e then holds heading 0) */
    double cov_psi_e[3][3]; /* rad^2, of the attitude error resolved in e, from the two above and their coupling */
    bool leans_on_sensors;  /* and most of it is what sensor errors make of it: pel_align_sensor_part() */
} pel_alignment_t;

typedef struct {
    double arw_rad_rts;    /* gyro white noise, rad/sqrt(s) */
    double vrw_mps_rts;    /* accelerometer white noise, m/s/sqrt(s) */
    double sd_bg_radps;    /* gyro error, 1 sigma per axis, before calibration */
    double sd_ba_mps2;     /* accelerometer error likewise */
    double block_s;        /* motion is judged on blocks of this length; 0.25 s is usual */
    double gyro_tol_radps; /* static: mean rate of a block differs from the mean so far by less than this, per axis */
    double accel_tol_mps2; /* static: the same for specific force */
} pel_align_config_t;

/* Averages while static. Private but for the first three. */
typedef struct {
    double t_static_s; /* time averaged since the last motion */
    uint32_t restarts; /* how often motion restarted it */
    bool still;        /* the last finished block was static */
    pel_align_config_t cfg;
    double sum_alpha[3], sum_upsilon[3]; /* static so far */
    double block_alpha[3], block_upsilon[3], block_s;
} pel_align_t;

/* cfg is copied. */
void pel_align_init(pel_align_t *a, const pel_align_config_t *cfg);

/* Take in one increment. Returns PEL_OK: static so far (t_static_s grows), PEL_W_RUNNING: block not finished,
 * PEL_W_REJECTED: motion seen, averages restarted. */
pel_status_t pel_align_push(pel_align_t *a, const pel_imu_t *imu);

/* Means of the static time; PEL_E_MISSING and outputs unchanged if there is none. A coarse gyro's mean is its bias. */
pel_status_t pel_align_mean(const pel_align_t *a, double f_ib_b[3], double omega_ib_b[3]);

/* Mean rate and specific force of the static time, with gravity and the Earth rate, give attitude (TRIAD) with gravity exact.
 * The IMU must stand still with respect to the Earth; lat not within 1 degree of a pole.
 * PEL_W_REJECTED: heading's sd would exceed sd_heading_max_rad: only roll and pitch are set, sd_heading_rad = PI.
 * PEL_E_MISSING: nothing averaged. PEL_E_GEOMETRY: specific force or Earth rate do not fit the place (25 % off in magnitude). */
pel_status_t pel_align_gyrocompass(const pel_align_t *a, double lat, double lon, double h, double sd_heading_max_rad,
                                   pel_alignment_t *out);

/* What sensor errors (measured - true, b) make of the attitude that pel_align_gyrocompass() gives: psi_e = A_f Delta_b + A_w eps_b
 * (Groves 2013, 5.83 to 5.90). Tilt hides the accelerometers' errors, heading that of the gyro that lies east. */
void pel_align_sensor_part(const double C_b_e[3][3], double lat, double lon, double h, double A_f[3][3],
                           double A_w[3][3]);

/* Roll and pitch from specific force and known acceleration, heading given (a velocity's course, a compass, two antennas).
 *
 *  f_ib_b      in  mean specific force, m/s^2
 *  a_eb_enu    in  acceleration over the same time, resolved east-north-up, from GNSS velocities; NULL: none
 *  heading, sd_heading, sd_level  in  rad; sd_heading = PI when unknown
 *
 * PEL_E_GEOMETRY: |f| does not fit gravity and acceleration within 25 %, or the body stands on its side. */
pel_status_t pel_align_level(const double f_ib_b[3], const double a_eb_enu[3], double heading, double sd_heading,
                             double sd_level, double lat, double lon, double h, pel_alignment_t *out);

/* Attitude given with its uncertainty (rad). */
void pel_align_from_attitude(double roll, double pitch, double heading, double sd_level, double sd_heading, double lat,
                             double lon, pel_alignment_t *out);

#ifdef __cplusplus
}
#endif
#endif

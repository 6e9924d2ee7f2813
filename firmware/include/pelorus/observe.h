/* observe.h - measurements become rows (innovation, h, variance) for the filter. Room: observe/.
 *
 * A row says z = h'x + noise, with z = computed - measured and x the error state (computed - true), so that the filter's x
 * is what the closed loop subtracts. Rows of one group (one system, one carrier) share the noise of their pivot and pass
 * through pel_whiten_row() of gnss.h before the filter sees them. */
#ifndef PELORUS_OBSERVE_H
#define PELORUS_OBSERVE_H

#include "pelorus/base.h"
#include "pelorus/gnss.h"
#include "pelorus/model.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One scalar row. h below `first` is zero and need not be set. */
typedef struct {
    pel_real z;   /* computed - measured, m or m/s */
    pel_real var; /* > 0, the same unit squared */
    int first;    /* index of the first state the row touches */
    int n;        /* states in use */
    pel_real h[PEL_MAX_STATES];
} pel_row_t;

/* Where the antenna stands on the body, and where its states are: all a row needs to know of the navigator. */
typedef struct {
    double lever_e[3];      /* C_b_e l_ba_b: IMU to antenna, resolved in e, m */
    double lever_rate_e[3]; /* C_b_e (omega_eb_b x l_ba_b), m/s */
    int n_states;
    int i_psi; /* first of three attitude states, -1 if there are none */
    int i_v;
    int i_r;
} pel_antenna_t;

/* DD range row of a satellite against its pivot: code, or phase once its integer is known.
 *
 *  ant   in   antenna and state indices; with attitude states i_psi < i_v < i_r
 *  sat   in   the satellite's single difference (only u_e is read)
 *  pivot in   the group's pivot
 *  dd_m  in   (observed - predicted) of the satellite minus that of the pivot, m; phase: minus lambda N
 *  row   out  z and h; var is left to pel_whiten_row()
 *
 * h = [g x on r | (C l) x g on psi], g = -(u_sat - u_pivot): S5 section 5, H = [G, 0, -G [R l x]]. About 40 flops. */
void pel_observe_range(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double dd_m,
                       pel_row_t *row);

/* DD range-rate (Doppler) row; arguments as above with dd_mps in m/s.
 *
 * h = [g on v | (C (omega x l)) x g on psi]: S5 section 5. The partials on the gyro states (gyro error x lever: below
 * 1 mm/s for 500 deg/h on 3 m... 3 mm/s on a MEMS gyro not yet calibrated, against 30 mm/s noise) are left out on purpose,
 * because they would make every Doppler row dense. */
void pel_observe_rate(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double dd_mps,
                      pel_row_t *row);

/* ---- phases whose integer is a state, phases against the previous epoch ------------------------------------------- */

/* DD phase (or code) row with one more state: a float ambiguity in cycles (scale = lambda), an offset in metres (scale = 1).
 *
 *  dd_m     in  (observed - predicted) of the satellite minus that of the pivot, m, minus scale * (the state's estimate)
 *  i_state  in  the state's index, behind r
 *
 * h = pel_observe_range()'s and `scale` on the state. Of S3's two exact forms of time differences this is the one to use: with its offset free
 * beforehand it equals all time differences of the pass with their correlation, the shared satellite by pel_whiten_*(), the shared epoch by
 * not differencing at all (S3 6.2b). In local axes (S2) u_e and lever_e are resolved in those. */
void pel_observe_float(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double dd_m, int i_state,
                       double scale, pel_row_t *row);

/* Time difference of a DD phase against a cloned antenna error c (S3 6.2a), three states of PEL_BLOCK_CLONE.
 *
 *  change_m  in  dd_m of now minus dd_m of the previous epoch, each observed minus predicted from its own antenna position
 *  i_clone   in  first of the three states of c, in front of psi
 *
 * h = [-g on c | (C l) x g on psi | g on r]. Exact for process noise, but calls noise white that is shared with the next epoch: sigma comes out
 * four times too large (S3 6.3). Afterwards, for each axis, pel_ud_assign(ud, i_clone + axis, a, var) with a of pel_observe_clone_map(): c is
 * then the antenna's error now. */
void pel_observe_clone(const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot, double change_m,
                       int i_clone, pel_row_t *row);
void pel_observe_clone_map(const pel_antenna_t *ant, int axis, pel_real a[PEL_MAX_STATES]);

/* Reference mode only: the delayed-state row of S3's paper on its 12 states (pel_model_tdcp_paper), in closed form with the sign of the gyro term
 * corrected: S3 (5) over T = dt_s with g = -(u_sat - u_pivot):
 *   v: g'(T I + T^2 W)   psi: T^2/2 g'[f x] - g'[dL x] + T g'[L x] W   gyro: -T^3/6 g'[f x] C - T g'[L x] C   accelerometer: -T^2/2 g' C */
typedef struct {
    double dt_s;           /* between the two epochs; made for 0.1 s, good to 1e-3 of its largest term at 0.35 rad/s */
    double C_before[3][3]; /* C_b_e at the previous epoch and at this one */
    double C_now[3][3];
    double f_ib_b[3];  /* mean specific force, b, m/s^2 */
    double lever_b[3]; /* IMU to antenna, m */
} pel_delay_t;

void pel_observe_delayed(const pel_model_t *m, const pel_delay_t *d, const pel_sd_t *sat, const pel_sd_t *pivot,
                         double change_m, pel_row_t *row);

/* ---- height, standing still, not sliding --------------------------------------------------------------------------- */

/* Height of the antenna (lever_e = 0: of the IMU): map, constant reference, or barometer.
 *
 *  up_e      in  unit vector up
 *  dh_m      in  computed height minus (reference + estimated deviation of the reference), m
 *  i_height  in  PEL_BLOCK_HEIGHT; -1: the reference is exact but for the row's variance
 *
 * h = [(C l) x up on psi | up on r | -1 on the deviation]. */
void pel_observe_height(const pel_antenna_t *ant, const double up_e[3], double dh_m, int i_height, pel_row_t *row);

/* Velocity along a direction. dv_mps: computed minus known. Three of them with 0 known are a zero-velocity update; along up it is the paper's
 * height constraint (S3 section 8). */
void pel_observe_velocity(const pel_antenna_t *ant, const double along_e[3], double dv_mps, pel_row_t *row);

/* Velocity along one body axis (0 right, 1 forward, 2 up) of a point of the vehicle: 0 right and up is a wheeled vehicle that does not slide,
 * a measured value forward is an odometer.
 *
 *  rate_b  in  omega_eb_b x (IMU to that point, b), m/s
 *
 * h = [c x v on psi | c on v], c the axis in e. Gyro errors times the arm (1 mm/s for 100 deg/h on 2 m) are left out on purpose. */
void pel_observe_body_velocity(const pel_antenna_t *ant, const double C_b_e[3][3], const double v_eb_e[3],
                               const double rate_b[3], int axis, double measured_mps, pel_row_t *row);

/* ---- history of time differences ------------------------------------------------------------------------------------ */

/* What time differences remember of one phase. It belongs to them alone: the slip detectors of gnss.h keep their own, so that a slip one of the
 * two has digested is still news to the other. */
typedef struct {
    uint8_t sys, prn, carrier;
    char code;
    bool half;
    uint32_t lock_ms;
    pel_time_t t_ns;
    double residual_m; /* observed - predicted */
    double u_e[3];
} pel_tdcp_entry_t;

/* 56 bytes a signal of PEL_MAX_OBS. Callers may read every field and write none. */
typedef struct {
    int n;
    uint32_t slips;    /* found by this history, since pel_tdcp_init() */
    uint32_t restarts; /* signals that began anew: first seen, gap, lock or half cycle lost, receiver's own warning */
    pel_tdcp_entry_t entry[PEL_MAX_OBS];
} pel_tdcp_t;

typedef enum {
    PEL_TDCP_NONE = 0, /* no usable phase in this row */
    PEL_TDCP_NEW = 1,  /* nothing to difference with: its offset starts anew */
    PEL_TDCP_CONTINUOUS = 2,
    PEL_TDCP_SLIPPED = 3 /* its change contradicts the others: its offset starts anew */
} pel_tdcp_kind_t;

typedef struct {
    double
        change_m; /* of observed - predicted since the previous epoch, receiver clock included, m; 0 unless continuous or slipped */
    uint8_t kind; /* pel_tdcp_kind_t */
} pel_tdcp_change_t;

/* Longest gap that is differenced over; longer only if the receiver's lock time spans it. */
#define PEL_TDCP_MAX_GAP_S 1.0

void pel_tdcp_init(pel_tdcp_t *h);

/* Difference this epoch's phases against the previous ones and remember them.
 *
 *  e       in   the epoch (its lock times and flags)
 *  set     in   its rows: pel_sd_undifferenced(); phase_m of usable rows is observed - predicted from the antenna as computed now
 *  sd_m    in   1 sigma of a computed change of range between the two epochs (inertial), m
 *  change  out  one for each of set->sd
 *
 * A change that differs from the median of its epoch (the receiver's clock) by more than max(lambda / 2, 6 sigma) is a slip, sigma^2 = sd_m^2 +
 * 2 var_phase. Of two phases that disagree both are slips; one alone cannot be judged and is new.
 * PEL_E_STALE (nothing changed, change[] not set): not newer than the last epoch. Cost: PEL_MAX_OBS^2 comparisons at worst. */
pel_status_t pel_tdcp_step(pel_tdcp_t *h, const pel_epoch_t *e, const pel_sd_set_t *set, double sd_m,
                           pel_tdcp_change_t change[PEL_MAX_OBS]);

/* The computed antenna position of the last epoch was corrected by da_e (new - old, m) after pel_tdcp_step(). */
void pel_tdcp_move(pel_tdcp_t *h, const double da_e[3]);

/* ---- satellite clock and path from a static segment ------------------------------------------------------------------- */

/* Sums of a least-squares polynomial of at most second order. 104 bytes; private but for n. */
typedef struct {
    int n;
    double t0_s, s0_m;   /* first sample */
    double last_s;       /* time of the newest, since the first */
    double st[5], ss[3]; /* sums of t^k and s t^k, t in units of 100 s since the first */
    double s2;
} pel_path_fit_t;

typedef struct {
    int order;          /* 1 or 2 */
    double t0_s, p[3];  /* p0 + p1 (t - t0) + p2 (t - t0)^2, m, m/s, m/s^2 */
    double sd_rate_mps; /* of the rate at the end of the segment, >= PEL_PATH_SD_RATE */
    double rms_m;       /* of the residuals */
} pel_path_t;

#define PEL_PATH_MIN_S      60.0 /* shortest segment that is fitted */
#define PEL_PATH_SD_RATE    1e-4 /* prior of an offset's rate, m/s */
#define PEL_PATH_SD_REFUSED 1e-3 /* the same where no fit was possible */

void pel_path_fit_init(pel_path_fit_t *f);

/* A static residual of one pair of satellites: (observed - predicted) of the satellite minus that of the reference, m, at t_s. */
void pel_path_fit_add(pel_path_fit_t *f, double t_s, double s_m);

/* The polynomial to subtract. Second order only if the segment lasts 600 s or its coefficient exceeds three of its sigmas, in which the path's
 * random walk counts (S3 section 7: with 300 s a second order doubles the error of the north position).
 *  path_m_rts  in  random walk of one satellite's path, m/sqrt(s)
 * PEL_E_GEOMETRY (out unchanged): shorter than PEL_PATH_MIN_S, fewer than 30 samples, or ill-conditioned: use PEL_PATH_SD_REFUSED. */
pel_status_t pel_path_fit_solve(const pel_path_fit_t *f, double path_m_rts, pel_path_t *out);

/* Value of the polynomial. */
double pel_path_at(const pel_path_t *p, double t_s);

#ifdef __cplusplus
}
#endif
#endif

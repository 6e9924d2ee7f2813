/* navigator.h - the one object a product owns: measurements in, solutions out.
 *
 * Life: pel_nav_config_default(), overwrite what is known, pel_navigator_init(); then push whatever arrives, in any
 * order, and after each push take what is ready with pel_navigator_poll(). Everything lives in the caller's
 * pel_navigator_t; two navigators run side by side. No call blocks; the longest is the push that completes an epoch
 * (satellites, integers, rows, re-propagation of the IMU ring).
 *
 * Measurements arrive late. IMU increments are kept in a ring; the filter stands at the time of the last applied
 * epoch (the horizon), and the output is the horizon's state carried to now through the ring. */
#ifndef PELORUS_NAVIGATOR_H
#define PELORUS_NAVIGATOR_H

#include "pelorus/ambiguity.h"
#include "pelorus/base.h"
#include "pelorus/filter.h"
#include "pelorus/gnss.h"
#include "pelorus/inertial.h"
#include "pelorus/model.h"
#include "pelorus/observe.h"
#include "pelorus/snapshot.h"
#include "pelorus/solution.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What takes part. AUTO uses everything that the stream offers. */
typedef enum {
    PEL_PRESET_AUTO = 0,
    PEL_PRESET_SINGLE = 1,     /* GNSS alone, one receiver: code and Doppler */
    PEL_PRESET_RTK = 2,        /* GNSS alone, rover against base: DD code, phase, Doppler */
    PEL_PRESET_INS_SINGLE = 3, /* 18-state INS with one receiver's code and Doppler */
    PEL_PRESET_INS_RTK = 4,    /* 18-state INS with DD code, phase, Doppler: S5 */
    PEL_PRESET_INS_FLOAT = 5,  /* 18-state INS in local axes with DD phase, integers from its float ambiguities: S2 */
    PEL_PRESET_INS_TDCP = 6,   /* INS_SINGLE and the receiver's own phases, as floats: S3 */
    PEL_N_PRESETS = 7
} pel_preset_t;

/* Where the height comes from beside satellites. */
typedef enum {
    PEL_HEIGHT_NONE = 0,
    PEL_HEIGHT_CONSTANT = 1, /* that of the start, or a map's if it is pushed as a barometer's */
    PEL_HEIGHT_BARO = 2
} pel_height_source_t;

/* What is known of the vehicle without a satellite. */
typedef struct {
    bool place_known; /* the IMU begins here, at rest: needs no single-point solution */
    double lat_rad, lon_rad, height_m, sd_place_m;
    double standing_s;                /* it stands still for so long from the first IMU sample on */
    uint8_t height;                   /* pel_height_source_t, in a byte on every machine */
    double sd_height_m, tau_height_s; /* what the source is off by: first-order Markov */
} pel_vehicle_config_t;

typedef struct {
    pel_preset_t preset;
    pel_time_t output_period_ns; /* predicted solutions at whole multiples of this; 0: only at epochs */
    double mask_rad;             /* elevation mask */
    double integer_mask_rad;     /* mask for integers to be searched */
    uint8_t systems;             /* bit 1 << pel_sys_t: allowed */
    uint8_t carriers;            /* bit 1 << pel_carrier_t: allowed */
    float coast_after_s;         /* status COAST when the last applied epoch is older */

    pel_imu_model_t imu;
    bool mount_known;     /* the body's y axis points forward: heading may be taken from the course */
    double C_s_b[3][3];   /* mounting: sensor axes to body axes */
    bool wheels;          /* the vehicle goes where it points; where the gyros are quiet it stands */
    double lever_ba_b[3]; /* IMU to antenna, m: right, forward, up */
    bool have_attitude;   /* attitude below is valid at the first IMU sample */
    double roll_rad, pitch_rad, heading_rad;
    double sd_tilt_rad, sd_heading_rad;
    double align_speed_mps; /* above this speed heading may be taken from the velocity's course */
    double warm_max_age_s;  /* a stored snapshot older than this is refused; 0: none is taken */

    pel_vehicle_config_t vehicle;

    uint8_t observe;                 /* PEL_OBS_CODE, _PHASE, _DOPPLER: what is used of an observation */
    pel_noise_config_t noise;        /* undifferenced observations; relative positioning */
    pel_noise_config_t noise_single; /* the same for a receiver alone: orbit, clock and atmosphere errors are in it */
    double rdss_hz;     /* what arrives as BeiDou B1I is of this carrier (RDSS: 2491.75 MHz); 0: it is B1I. A float */
    bool no_ionosphere; /* apply no ionosphere model: simulations without one */
    double single_code_tau_s;       /* correlation time of a single receiver's code errors */
    double single_lasting_tau_s;    /* and of those that last as long as phases carry the position */
    double single_path_m_rts;       /* orbit, clock, atmosphere in its phases: random walk, m/sqrt(s) */
    double single_rate_mps;         /* and a rate of its own, 1 sigma at the start; 0: none */
    double single_phase_tau_s;      /* correlation time of its multipath; 0: white */
    double code_tau_s, phase_tau_s; /* the same against a base: multipath. 0: white */
    bool float_code;                /* PEL_PRESET_INS_FLOAT: codes are used beside phases */
    bool learn_noise;               /* fit the variances of codes and phases to what they leave over */
    float base_max_age_s;
    float base_wait_s;   /* hold a rover epoch up to this long for its base epoch */
    float apply_delay_s; /* hold an epoch this long, so that one that arrives out of order still counts */

    float ratio_min;     /* second best over best, at least */
    float failure_max;   /* and as large as keeps wrong integers below this probability (pel_ils_ratio_needed()) */
    float success_min;   /* bootstrapped success rate of the search problem */
    int32_t node_budget; /* search nodes an epoch */
    int32_t slice_nodes; /* and of these in one push of an IMU sample; 0: all at once */
    bool integers;       /* resolve integers at all */

    double lever_bc_b[3]; /* IMU to camera, m */
    double C_c_b[3][3];   /* camera (boresight) axes to body axes */
} pel_nav_config_t;

/* Sane values for every field: AUTO, 10 Hz, 10 degrees, all systems, MEMS IMU, aligned by itself. */
void pel_nav_config_default(pel_nav_config_t *cfg);

/* What pel_navigator_poll() hands out; the named member of the navigator is valid until the next call of any push. */
typedef enum {
    PEL_NAV_NONE = 0,
    PEL_NAV_SOLUTION, /* nav->solution: predicted to now, every output period */
    PEL_NAV_EPOCH,    /* nav->epoch_solution with PEL_SOL_AT_EPOCH, and nav->sats[0..n_sats-1] */
    PEL_NAV_USED,     /* nav->used: at the start and when it changes */
    PEL_NAV_EVENT,    /* nav->event */
    PEL_NAV_WARM      /* nav->warm.report: once, when a snapshot was used or refused */
} pel_nav_output_t;

/* Poses kept for event marks, at most one each 10 ms: 2.5 s. */
#ifndef PEL_POSE_RING
#define PEL_POSE_RING 256
#endif

typedef struct {
    pel_time_t t_ns;
    double r_eb_e[3];
    double theta_b_e[3]; /* rotation vector of C_b_e */
    float v_eb_e[3];
    float alpha_ib_b[3]; /* turn since the pose before, rad */
} pel_pose_t;

typedef struct {
    pel_pose_t pose[PEL_POSE_RING];
    uint16_t head, n;
    double alpha[3]; /* turn since the newest pose, rad */
} pel_pose_ring_t;

/* Heading from velocity changes while an IMU of unknown mounting waits to be aligned (navigator/yaw.c). Private. */
typedef struct {
    bool calm; /* no lasting horizontal acceleration in the last GNSS interval: gravity shows the vertical */
    bool levelled;
    double C_b_l[3][3];   /* levelled frame of arbitrary heading, carried by the gyros */
    double dv[3], span_s; /* velocity change since levelling, in l */
    double leaning_s;     /* since the last calm interval */
    pel_time_t since_ns;  /* start of the interval */
    double dv_since[3], v_since_e[3];
    double n, a[2], b[2], aa, bb, dot, cross; /* weighted sums of the mean accelerations of both series */
} pel_yaw_t;

/* What a vehicle on wheels is known to do (navigator/wheels.c). Private. */
typedef struct {
    float d_b[3];                                         /* direction of travel on the body */
    float direction_s;                                    /* straight driving that it is the mean of */
    float sum[3], sum_sq[3], sum_f[3], n_samples, span_s; /* angular rates and specific force of the window under way */
    float f_b[3];                                         /* mean of the last window */
    float rest_var; /* variance of angular rates at rest, of three axes together, */
    float rests;    /* and of how many windows it is the mean */
    bool quiet;
    pel_time_t quiet_since_ns, judged_ns, updated_ns;
} pel_wheels_t;

/* Phases followed from epoch to epoch (navigator/track.c). Private. */
#ifndef PEL_MAX_TRACKED
#define PEL_MAX_TRACKED 64
#endif

typedef struct {
    uint8_t sys, prn, carrier;
    bool held : 1;    /* N is an integer that was validated */
    bool half : 1;    /* half a cycle is not resolved: good as a float, no integer */
    bool slipped : 1; /* of_rover: begins anew where it is, its rate goes on */
    uint8_t agreed;   /* searches in a row that gave the same integer */
    int16_t state;    /* index of its filter state; -1: held, or the datum of its group */
    int16_t rate;     /* of_rover: index of its rate's, -1: none */
    uint16_t epochs;
    uint32_t candidate; /* that integer modulo 2^32 */
    pel_time_t agreed_since_ns;
    double N; /* on the group's datum: cycles, rover minus base; of_rover: m */
    double rate_mps;
    float u_e[3];        /* of_rover: line of sight when it began */
    pel_time_t since_ns; /* when a float one began */
} pel_tracked_t;

/* What a GLONASS phase is off by for each channel, rover minus base (navigator/channels.c). Private. */
typedef struct {
    int16_t state;  /* index of its filter state, -1: none */
    double slope_m; /* m a channel */
    double var_m2;  /* of slope_m when its state was last seen */
} pel_channels_t;

#define PEL_GLO_CARRIERS 2 /* G1, G2 */
#define PEL_NAV_PRNS     64

typedef struct {
    int n;
    bool of_rover;              /* phases of the rover alone, not against the base */
    pel_time_t carried_from_ns; /* since then enough of them have carried the position from epoch to epoch */
    uint8_t misfits;            /* epochs in a row whose held phases did not fit */
    uint8_t contradictions;     /* epochs whose own integers were others than those held, none in between that agreed */
    pel_time_t contradicted_ns; /* the first of them */
    uint8_t misfit_floats;      /* searches in a row that no integers fitted */
    pel_time_t wandered_ns;
    pel_tracked_t entry[PEL_MAX_TRACKED];
    pel_channels_t channels[PEL_GLO_CARRIERS];
    uint16_t codes_told[PEL_N_SYS][PEL_NAV_PRNS]; /* of_rover: codes of a satellite used while phases carry */
} pel_track_t;

/* What the variances of codes and phases are multiplied by, as learnt from their rows (navigator/noise_level.c). Private. */
#define PEL_NAV_LEVEL_CODE  0
#define PEL_NAV_LEVEL_PHASE 1
#define PEL_NAV_LEVEL_ROVER 2 /* phases of the rover alone */
#define PEL_NAV_LEVELS      3

typedef struct {
    float factor, rows;
} pel_noise_factor_t;

typedef struct {
    bool learning;          /* in this epoch */
    float share;            /* of a row: errors of epochs close together are the same errors */
    float code_inflated_by; /* what the epoch's code variances were multiplied by for that */
    pel_time_t learnt_ns;
    pel_noise_factor_t of[PEL_NAV_LEVELS][PEL_N_SYS][PEL_N_CARRIER];
} pel_noise_level_t;

/* What the codes leave over at the position of held integers (navigator/hold_watch.c). Private. */
typedef struct {
    double s[3], M[3][3]; /* sums of h z / var and h h' / var */
} pel_hold_watch_t;

/* Outcome of the integers of one epoch. */
typedef struct {
    double ratio, success;
    int n, n_fixed, nodes;
    int32_t N[PEL_MAX_OBS];  /* by index into nav->sd.sd[]: DD integer against the group's pivot */
    bool fixed[PEL_MAX_OBS]; /* it has one */
    pel_int_reason_t reason;
} pel_nav_integers_t;

/* What is known of each phase of nav->sd. */
typedef struct {
    bool known[PEL_MAX_OBS];    /* has an N */
    bool held[PEL_MAX_OBS];     /* and it is a validated integer */
    int16_t state[PEL_MAX_OBS]; /* its filter state, -1: none */
    double N[PEL_MAX_OBS];      /* cycles, on the group's datum */
} pel_nav_phases_t;

/* Float ambiguities that are searched together, and how often one may still be left out. Private. */
typedef struct {
    int n, tries;
    bool beside_held;
    uint8_t entry[PEL_MAX_AMB]; /* index into track.entry[] */
} pel_nav_chosen_t;

/* Knowledge beside satellites (navigator/vehicle.c). Private. */
typedef struct {
    bool at_place;        /* still where the configuration says */
    int16_t height_state; /* deviation of the height's source, -1: none */
    double deviation_m;   /* its estimate: truth less source, m */
    double start_height_m;
    pel_time_t updated_ns;
    bool baro_waits;
    pel_baro_t baro;
} pel_vehicle_t;

/* What an epoch waits for. Private. */
typedef enum {
    PEL_NAV_SEARCH_NONE = 0,
    PEL_NAV_SEARCH_EPOCH, /* the integers of the epoch alone; its rows have not been used yet */
    PEL_NAV_SEARCH_FLOATS /* those of the float states; its rows have been used */
} pel_nav_search_t;

/* Workspace of one epoch's update, kept off the stack. Private. */
typedef struct {
    pel_antenna_t ant;
    bool phased;                 /* phases take part, against the base or of the rover alone */
    double P_r[3][3], P_v[3][3]; /* antenna, before the update */
    pel_nav_integers_t ints;     /* of this epoch alone */
    pel_nav_integers_t later;    /* of the float states after the update */
    pel_nav_chosen_t chosen;     /* which of them are searched */
    double code_inflated_by;     /* variances of a single receiver's codes, for the length of their errors; 0: not */
    float base_age_s, nis;
    uint16_t nis_dof, flags;
    pel_nav_phases_t phases;     /* every N, held or float */
    bool misfit[PEL_MAX_OBS];    /* phase rows that were refused */
    uint8_t row_of[PEL_MAX_AMB]; /* which of nav->sd each row of nav->problem is */
    int code_used, code_refused, phase_used, used;
    int held_used, held_refused; /* phase rows with validated integers */
} pel_nav_update_t;

#define PEL_ROVER_QUEUE 3
#define PEL_BASE_QUEUE  3

/* Sensor errors as the closed loop knows them (measured - true), body axes. */
typedef struct {
    double gyro_constant[3], gyro_markov[3], accel_markov[3];
} pel_sensor_errors_t;

/* The last IMU sample and what is usual of the next one (navigator/admit.c). Private. */
typedef struct {
    pel_imu_t last;
    double ms_dw, ms_df; /* mean squares of the change of rate and specific force */
    uint8_t spikes;      /* refused in a row */
    bool stuck;
    uint16_t learnt;     /* samples seen, up to LEARN_SAMPLES */
    uint16_t run[6];     /* samples since each number changed */
    uint16_t longest[6]; /* while learning */
} pel_admit_t;

/* Whether the IMU's clock is believed (navigator/timing.c). Private. */
typedef struct {
    uint16_t seq;
    bool have_lead, doubted;
    double lead_s;    /* newest sample before the rover's newest epoch, as epochs arrive */
    double doubted_s; /* for how long, by epochs */
    pel_time_t epoch_ns;
} pel_timing_t;

typedef struct pel_navigator_t {
    pel_nav_config_t cfg;                           /* as given; never written after init */
    uint32_t cfg_check, state_check, station_check; /* navigator/sound.c */
    bool attitude_given;                            /* the configured attitude has not been used up */
    bool have_station;
    bool ins;        /* the 18-state filter runs; else GNSS alone */
    bool local;      /* and its attitude, velocity and position states are in local axes */
    bool have_state; /* position and velocity are known */
    pel_orbits_t orbits;
    pel_station_t station;

    int n_rover, n_base;
    pel_epoch_t rover[PEL_ROVER_QUEUE]; /* waiting, oldest first */
    pel_epoch_t base[PEL_BASE_QUEUE];   /* newest last */
    pel_slip_t slip_rover, slip_base;

    pel_imu_ring_t ring;
    pel_strapdown_t at_horizon; /* r_eb_e is the antenna's without INS */
    pel_strapdown_t now;
    pel_coning_t coning_horizon, coning_now;
    pel_sensor_errors_t errors;
    pel_model_t model;
    pel_ud_t ud;
    pel_propagator_t propagator;
    double omega_ib_b[3]; /* at the horizon, smoothed over 20 ms, for lever-arm rates */
    pel_align_t align;
    pel_yaw_t yaw;
    pel_wheels_t wheels;
    double C_rel[3][3]; /* body at the newest increment to body at the first, before the INS runs */
    pel_time_t first_imu_ns;
    bool have_spp;
    pel_spp_t spp;         /* last single-point solution: receiver clock, start values */
    double v_before_e[3];  /* velocity of the epoch before, for the acceleration while levelling */
    double corrected_e[3]; /* position corrections since the last slip check, m */
    pel_time_t last_tag_ns, last_epoch_ns, epoch_before_ns, last_imu_ns;
    pel_fix_t last_fix;
    uint8_t late_rover, late_base, late_imu; /* refused in a row for their time: many mean that time began anew */
    bool relative;                           /* rows are differenced against the base */
    uint8_t doubts;                          /* epochs in a row that refused most of their code */
    uint8_t restless;                        /* and those whose Doppler contradicts the INS */
    pel_admit_t admit;
    pel_timing_t timing;

    pel_sd_set_t sd;
    pel_nav_search_t search;   /* the oldest rover epoch is under way */
    pel_amb_problem_t problem; /* workspace of the epoch's search */
    pel_amb_resolver_t resolver;
    union {
        struct {
            pel_view_t view_rover, view_base; /* until the differences and the problem are formed */
        };
        pel_ils_t ils; /* from then on */
    };
    pel_track_t track;
    pel_noise_level_t noise_level;
    pel_hold_watch_t hold_watch;
    pel_nav_update_t update;

    pel_vehicle_t vehicle;

    pel_warm_t warm; /* the snapshot of the life before */

    pel_pose_ring_t poses;
    pel_time_t event_t_ns;
    uint32_t event_id;
    bool event_waiting;

    pel_nav_counters_t counters;
    pel_solution_t solution, epoch_solution;
    uint8_t rover_seen[PEL_N_SYS], base_seen[PEL_N_SYS]; /* bit 1 << carrier, since the start */
    pel_used_t used;
    pel_event_t event;
    pel_sat_report_t sats[PEL_MAX_OBS];
    int n_sats;
    uint32_t ready; /* bit 1 << pel_nav_output_t */
} pel_navigator_t;

/* Start afresh; copies the configuration. */
void pel_navigator_init(pel_navigator_t *nav, const pel_nav_config_t *cfg);

/* One IMU interval, sensor axes. Advances the output; may apply epochs that were waiting for it. */
void pel_navigator_push_imu(pel_navigator_t *nav, const pel_imu_t *imu);

/* One epoch of the rover or base receiver. Bad or stale ones are counted and change nothing. */
void pel_navigator_push_rover(pel_navigator_t *nav, const pel_epoch_t *epoch);
void pel_navigator_push_base(pel_navigator_t *nav, const pel_epoch_t *epoch);

void pel_navigator_push_ephemeris(pel_navigator_t *nav, const pel_ephemeris_t *eph);
void pel_navigator_push_klobuchar(pel_navigator_t *nav, const pel_klobuchar_t *k);
void pel_navigator_push_station(pel_navigator_t *nav, const pel_station_t *s);

/* A height (map or barometer), used once at the next epoch if the configuration says so. Bad values are refused and counted (imu_bad_value). */
void pel_navigator_push_baro(pel_navigator_t *nav, const pel_baro_t *baro);

/* An event mark at GPS time t; its exterior orientation comes out when the trajectory has passed it. */
void pel_navigator_push_event(pel_navigator_t *nav, pel_time_t t_ns, uint32_t id);

/* The input has ended: apply one epoch of those still waiting. False when there is none left. */
bool pel_navigator_flush(pel_navigator_t *nav);

/* The configuration is no longer what was given: memory has changed by itself. Epochs, ephemerides and stations are refused
 * and the IMU alone carries on; begin again with pel_navigator_init() and a configuration from elsewhere. */
bool pel_navigator_is_broken(const pel_navigator_t *nav);

/* What is ready, one a call, in order of time; PEL_NAV_NONE when there is no more. */
pel_nav_output_t pel_navigator_poll(pel_navigator_t *nav);

#ifdef __cplusplus
}
#endif
#endif

/* solution.h - what the navigator says: solution, counters, what was asked and what was used. Room: base/.
 *
 * These types are what wire/ puts into output frames and what a product reads after each step. */
#ifndef PELORUS_SOLUTION_H
#define PELORUS_SOLUTION_H

#include "pelorus/base.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    PEL_FIX_NONE = 0,  /* no position */
    PEL_FIX_SPP = 1,   /* single receiver code */
    PEL_FIX_FLOAT = 2, /* relative to a base, integers not fixed */
    PEL_FIX_FIXED = 3, /* relative to a base, integers fixed: validated in this epoch, or held without a slip since */
    PEL_FIX_COAST = 4  /* propagated, no GNSS in the last coast_after_s */
} pel_fix_t;

/* Why the epoch's integers are not fixed, or PEL_INT_OK. One verdict a test; the first that failed is told. */
typedef enum {
    PEL_INT_OK = 0,
    PEL_INT_NOT_TRIED = 1, /* no base, or switched off */
    PEL_INT_FEW = 2,       /* too few ambiguities */
    PEL_INT_BUDGET = 3,    /* search ended without proof */
    PEL_INT_RATIO = 4,     /* second best too near */
    PEL_INT_CHI2 = 5,      /* fixed residuals too large */
    PEL_INT_BAND = 6,      /* an L1/L2 pair outside the error band */
    PEL_INT_PRIOR = 7,     /* contradicts the INS prediction */
    PEL_INT_SUCCESS = 8,   /* bootstrapped success rate too low */
    PEL_INT_BASE_AGE = 9   /* base epoch too old */
} pel_int_reason_t;

#define PEL_SOL_INS       0x0001u /* an IMU takes part */
#define PEL_SOL_ATTITUDE  0x0002u /* roll and pitch are meaningful */
#define PEL_SOL_HEADING   0x0004u /* heading is meaningful (aligned) */
#define PEL_SOL_AT_EPOCH  0x0008u /* the estimate at a GNSS epoch, after its update (else: predicted to now) */
#define PEL_SOL_RESTARTED 0x0010u /* the filter restarted itself since the last solution */

/* One navigation solution, at the IMU's (or antenna's, without IMU) reference point. */
typedef struct {
    pel_time_t t_ns;    /* time of validity */
    uint8_t fix;        /* pel_fix_t */
    uint8_t int_reason; /* pel_int_reason_t */
    uint16_t flags;     /* PEL_SOL_* */
    double r_eb_e[3];   /* m */
    double lat_rad, lon_rad, height_m;
    float v_ned[3];                         /* m/s */
    float roll_rad, pitch_rad, heading_rad; /* NaN-free: 0 where flags say not meaningful */
    float cov_r_ned[6];                     /* m^2: nn ne nd ee ed dd */
    float cov_v_ned[6];                     /* (m/s)^2, same order */
    float cov_att[6];                       /* rad^2, small rotation about n, e, d axes, same order */
    float sd_roll_rad, sd_pitch_rad, sd_heading_rad;
    float hpl_m, vpl_m; /* protection levels */
    float base_age_s;   /* rover minus base epoch; negative if no base */
    float ratio;        /* second best over best squared norm; 0 if no search */
    float success_rate; /* bootstrapped success of the search problem; 0 if none */
    float nis;          /* normalised innovation squared of the epoch, summed over accepted rows */
    uint16_t nis_dof;
    uint16_t search_nodes;
    uint8_t n_sat;   /* satellites used in the last epoch */
    uint8_t n_fixed; /* integers fixed in the last epoch */
    uint8_t n_amb;   /* integers searched */
    uint8_t reserved;
    uint32_t state_hash;     /* hash of the filter's state and factors: two machines agree or differ here */
    float b_g[3], sd_b_g[3]; /* gyro error estimate (constant + Markov), rad/s, sensor axes turned to b */
    float b_a[3], sd_b_a[3]; /* accelerometer error estimate, m/s^2 */
} pel_solution_t;

/* Everything that was refused or went wrong, by cause, since start. Rover, base and IMU decoders fill their own. */
typedef struct {
    uint32_t frames;      /* accepted frames */
    uint32_t noise_bytes; /* bytes outside any frame */
    uint32_t bad_checksum;
    uint32_t bad_length; /* impossible or too long for its destination */
    uint32_t bad_value;  /* not finite, out of range, unknown satellite or signal */
    uint32_t unknown;    /* well-formed, not of interest */
    uint32_t duplicate;  /* same epoch, IMU sample or sequence number again */
    uint32_t time_back;  /* epoch or sample older than one already given */
    uint32_t gap;        /* sequence or time gap */
    uint32_t overflow;   /* measurements that did not fit */
} pel_wire_counters_t;

typedef struct {
    uint32_t epochs_used, epochs_late, epochs_no_eph, epochs_few_sats, epochs_unpaired, epochs_spp_failed;
    uint32_t imu_used, imu_gap, imu_out_of_order, imu_bad_value;
    uint32_t rows_used, rows_gated;
    uint32_t sats_no_eph, sats_unhealthy, sats_low, sats_excluded;
    uint32_t slip_lock, slip_half_cycle, slip_geometry_free, slip_doppler, slip_ins; /* each detector apart */
    uint32_t clock_jumps;
    uint32_t fix_tried, fix_ok, fix_ratio, fix_chi2, fix_band, fix_prior, fix_success, fix_budget;
    uint32_t restarts, numeric_faults, coast_epochs;
    uint32_t events, events_refused;
    uint32_t fix_released; /* times held integers were given up because they did not fit any more */
} pel_nav_counters_t;

/* What was asked for and what takes part, with the reason for each difference. */
typedef enum {
    PEL_WHY_NONE = 0,        /* no difference */
    PEL_WHY_NO_DATA = 1,     /* never seen in the stream */
    PEL_WHY_CONFIG = 2,      /* switched off by configuration */
    PEL_WHY_NO_ORBIT = 3,    /* observed, but no ephemeris yet */
    PEL_WHY_NO_STATION = 4,  /* base observed, its position unknown */
    PEL_WHY_NOT_ALIGNED = 5, /* IMU present, alignment not reached */
    PEL_WHY_UNSUPPORTED = 6  /* decoded, not used by this build */
} pel_why_t;

typedef struct {
    pel_time_t t_ns;
    uint8_t preset_asked, preset_used; /* pel_preset_t of navigator.h */
    uint8_t preset_why;                /* pel_why_t */
    uint8_t imu_seen, imu_used, imu_why;
    uint8_t base_seen, base_used, base_why;
    float imu_rate_hz;
    float base_age_s;
    /* one bit a carrier (1 << pel_carrier_t), by system */
    uint8_t rover_seen[PEL_N_SYS];
    uint8_t base_carriers[PEL_N_SYS];
    uint8_t carriers_used[PEL_N_SYS];
    uint8_t sys_why[PEL_N_SYS];
    /* IMU model in use: white and in-run bias, per axis */
    float arw_rad_rts, vrw_mps_rts, sd_bg_radps, sd_ba_mps2;
    double r_station_e[3];
} pel_used_t;

/* What became of a stored snapshot (snapshot.h): one reason each. */
typedef enum {
    PEL_SNAP_NONE = 0,       /* there is none */
    PEL_SNAP_WAITING = 1,    /* whole; the first epoch with an IMU will tell */
    PEL_SNAP_USED = 2,       /* attitude and sensor errors were taken from it */
    PEL_SNAP_DAMAGED = 3,    /* length or checksum: torn by a power cut, or worn */
    PEL_SNAP_NEWER = 4,      /* of a version this firmware does not know */
    PEL_SNAP_BAD_VALUE = 5,  /* a number that cannot be */
    PEL_SNAP_FOREIGN = 6,    /* made with another IMU model or preset */
    PEL_SNAP_REMOUNTED = 7,  /* made with another mounting or lever arm */
    PEL_SNAP_STALE = 8,      /* too old, or of the future */
    PEL_SNAP_UNDER_WAY = 9,  /* taken in motion: nothing says how it went on */
    PEL_SNAP_NOT_STILL = 10, /* in motion now */
    PEL_SNAP_MOVED = 11,     /* GNSS says another place */
    PEL_SNAP_TURNED = 12,    /* gravity or the Earth's rate is felt from another side */
    PEL_N_SNAP = 13
} pel_snap_t;

/* The verdict on a snapshot, told once, and how often each came since start. */
typedef struct {
    pel_time_t t_ns;
    uint8_t verdict; /* pel_snap_t */
    float age_s;     /* of the snapshot; 0 if it was refused before its age was known */
    uint32_t count[PEL_N_SNAP];
} pel_warm_report_t;

/* One satellite's carrier of the last epoch, for sky plots and innovations. */
typedef struct {
    uint8_t sys, prn, carrier;
    uint8_t flags; /* PEL_SAT_* */
    float az_rad, el_rad, cn0_dbhz;
    float innov_code_m, innov_phase_m, innov_doppler_mps; /* before the update, relative to the pivot; 0 if unused */
    float sd_code_m, sd_phase_m, sd_doppler_mps;          /* predicted 1 sigma of each innovation */
    int32_t n_fixed;                                      /* DD integer, cycles */
} pel_sat_report_t;

#define PEL_SAT_PIVOT        0x01u
#define PEL_SAT_CODE_USED    0x02u
#define PEL_SAT_PHASE_USED   0x04u
#define PEL_SAT_DOPPLER_USED 0x08u
#define PEL_SAT_FIXED        0x10u
#define PEL_SAT_SLIP         0x20u
#define PEL_SAT_EXCLUDED     0x40u

/* Exterior orientation at an event mark (shutter, scan line). */
typedef struct {
    pel_time_t t_ns;
    uint32_t id;
    uint8_t fix;
    double r_ec_e[3]; /* camera (or body) centre */
    double lat_rad, lon_rad, height_m;
    float omega_rad, phi_rad, kappa_rad; /* C_c^m = Rx(omega) Ry(phi) Rz(kappa), m = local ENU */
    float sd_r_m[3], sd_att_rad[3];      /* north, east, down */
} pel_event_t;

#ifdef __cplusplus
}
#endif
#endif

/* base.h - time, status, and the measurement types that pass between rooms.
 *
 * Time is int64_t nanoseconds of GPS time since 1980-01-06 00:00:00, everywhere. Other units only in names. */
#ifndef PELORUS_BASE_H
#define PELORUS_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "pelorus/config.h"

#ifdef __cplusplus
extern "C" {
#endif

#if PEL_REAL_DOUBLE
typedef double pel_real;
#else
typedef float pel_real;
#endif

/* 0 done; > 0 done with a caveat; < 0 not done and outputs unchanged. */
typedef enum {
    PEL_OK = 0,
    PEL_W_REJECTED = 1,    /* the measurement was understood and refused by a test */
    PEL_W_RUNNING = 2,     /* a resumable computation used its slice and wants another */
    PEL_W_BUDGET = 3,      /* a bounded computation used its whole budget: best so far, no proof */
    PEL_E_RANGE = -1,      /* an input is not finite or outside its documented range */
    PEL_E_NOT_POSDEF = -2, /* a variance or factor is not positive */
    PEL_E_FULL = -3,       /* no room left in a fixed-size container */
    PEL_E_MISSING = -4,    /* something needed is not there (no ephemeris, no base, empty ring) */
    PEL_E_GEOMETRY = -5,   /* too few satellites, or their geometry is singular */
    PEL_E_STALE = -6,      /* older than what is still accepted, or out of order */
    PEL_E_NO_CONVERGENCE = -7,
    PEL_E_FORMAT = -8 /* bytes do not form what they should */
} pel_status_t;

/* ---- time -------------------------------------------------------------------------------------------------- */

#define PEL_NS_PER_S    INT64_C(1000000000)
#define PEL_NS_PER_MS   INT64_C(1000000)
#define PEL_S_PER_WEEK  INT64_C(604800)
#define PEL_NS_PER_WEEK (PEL_S_PER_WEEK * PEL_NS_PER_S)

typedef int64_t pel_time_t; /* ns of GPS time */

/* Whole GPS week (no roll-over) and seconds of it -> time. tow_s may be negative or beyond a week. */
pel_time_t pel_time_from_week(int32_t week, double tow_s);

/* The week of a time and the seconds into it, [0, 604800). */
int32_t pel_time_week(pel_time_t t_ns);
double pel_time_tow_s(pel_time_t t_ns);

/* a - b in seconds; exact to a nanosecond for spans below 100 days. */
double pel_time_diff_s(pel_time_t a_ns, pel_time_t b_ns);

/* The time with this second of week that lies nearest to a reference time (resolves week roll-over). */
pel_time_t pel_time_from_tow_near(double tow_s, pel_time_t ref_ns);

/* Full week number nearest to ref from a truncated one (modulo = 1024 for GPS 10 bit, 4096 for Galileo, ...). */
int32_t pel_time_full_week(int32_t week_truncated, int32_t modulo, pel_time_t ref_ns);

/* GPS - UTC in seconds at a GPS time (leap seconds since 1980, table in base/time.c; 18 since 2017). */
int32_t pel_time_leap_s(pel_time_t t_ns);

/* ---- satellites, carriers, signals ---------------------------------------------------------------------------- */

typedef enum {
    PEL_SYS_GPS = 0,
    PEL_SYS_GLO = 1,
    PEL_SYS_GAL = 2,
    PEL_SYS_BDS = 3,
    PEL_SYS_QZS = 4,
    PEL_SYS_SBS = 5,
    PEL_N_SYS = 6
} pel_sys_t;

/* A carrier frequency. Two receivers are differenced by satellite and carrier; which code was tracked on it (`code`
 * of pel_obs_t, the RINEX attribute letter) is carried along for the record. */
typedef enum {
    PEL_CARRIER_L1 = 0,  /* 1575.42 MHz: L1, E1, B1C; GLONASS G1 */
    PEL_CARRIER_L2 = 1,  /* 1227.60 MHz: L2; GLONASS G2 */
    PEL_CARRIER_L5 = 2,  /* 1176.45 MHz: L5, E5a, B2a */
    PEL_CARRIER_E5B = 3, /* 1207.14 MHz: E5b, B2I, B2b */
    PEL_CARRIER_E6 = 4,  /* 1278.75 MHz: E6 (QZSS L6) */
    PEL_CARRIER_B1I = 5, /* 1561.098 MHz */
    PEL_CARRIER_B3I = 6, /* 1268.52 MHz */
    PEL_N_CARRIER = 7
} pel_carrier_t;

#define PEL_SPEED_OF_LIGHT 299792458.0 /* m/s, exact */

/* Carrier frequency in Hz; glo_k is the GLONASS channel (-7..6), ignored otherwise. 0.0 for a pair that does not exist. */
double pel_carrier_hz(pel_sys_t sys, pel_carrier_t carrier, int glo_k);

/* Its wavelength in m: PEL_SPEED_OF_LIGHT over pel_carrier_hz(), without a division outside GLONASS. 0.0 likewise. */
double pel_carrier_wavelength_m(pel_sys_t sys, pel_carrier_t carrier, int glo_k);

/* Highest prn of a system as numbered here: GPS 32, GLO 32, GAL 36, BDS 63, QZS 10 (1 = J01 = PRN 193), SBS 39 (1 = S20 = PRN 120). */
int pel_sys_max_prn(pel_sys_t sys);

/* RINEX letter of a system: G R E C J S; '?' if unknown. */
char pel_sys_letter(pel_sys_t sys);

/* ---- what sensors say ------------------------------------------------------------------------------------------ */

/* One interval of integrating gyros and accelerometers, as delivered (sensor axes until the navigator turns them). */
typedef struct {
    pel_time_t t_ns;        /* end of the interval: time of validity */
    double dt_s;            /* length of the interval, > 0 */
    double alpha_ib_b[3];   /* integral of angular rate, rad */
    double upsilon_ib_b[3]; /* integral of specific force, m/s */
    uint16_t seq;           /* counter of the sender, modulo 65536 */
    uint16_t flags;         /* PEL_IMU_* */
    uint32_t check;         /* of the members above, by pel_imu_ring_push() and for it alone */
} pel_imu_t;

#define PEL_IMU_GYRO_SATURATED  0x0001u
#define PEL_IMU_ACCEL_SATURATED 0x0002u
#define PEL_IMU_TIME_UNSYNCED   0x0004u /* time tag not disciplined to GPS */

/* A barometer's height: standard atmosphere's height for the pressure, above the ellipsoid after calibration. Its error
 * drifts with the weather by metres in minutes; sd_m is the noise of one sample. */
typedef struct {
    pel_time_t t_ns;
    double height_m;
    float sd_m;   /* > 0 */
    uint16_t seq; /* counter of the sender, modulo 65536 */
} pel_baro_t;

/* One satellite's one carrier. Signs as RINEX: phase grows with range, Doppler is positive when approaching. */
typedef struct {
    double P_m;       /* pseudorange, m */
    double L_cyc;     /* carrier phase, cycles */
    float D_hz;       /* Doppler, Hz */
    float cn0_dbhz;   /* 0 if unknown */
    uint32_t lock_ms; /* how long the phase has been tracked without a slip, at least (saturates) */
    uint8_t sys;      /* pel_sys_t */
    uint8_t prn;      /* 1.. */
    uint8_t carrier;  /* pel_carrier_t */
    char code;        /* RINEX attribute letter: 'C', 'W', 'L', 'X', 'I', 'Q', ... */
    int8_t glo_k;     /* GLONASS channel, else 0 */
    uint8_t flags;    /* PEL_OBS_* */
} pel_obs_t;

#define PEL_OBS_CODE       0x01u /* P_m is valid */
#define PEL_OBS_PHASE      0x02u /* L_cyc is valid */
#define PEL_OBS_DOPPLER    0x04u /* D_hz is valid */
#define PEL_OBS_HALF_CYCLE 0x08u /* half-cycle ambiguity not yet resolved */
#define PEL_OBS_SLIP       0x10u /* slip since the previous epoch: told by the receiver, or found by pel_slip_check() */

/* All signals of one receiver at one of its epochs. */
typedef struct {
    pel_time_t t_ns; /* the receiver's own time tag (its clock, not true time) */
    uint16_t n;
    uint16_t dropped; /* signals that did not fit into obs[] */
    bool clock_reset; /* receiver reported a clock jump */
    pel_obs_t obs[PEL_MAX_OBS];
} pel_epoch_t;

/* Broadcast orbit and clock: Kepler elements (GPS, QZSS, Galileo, BeiDou) or a state vector (GLONASS). Times are GPS time
 * for all of them. */
typedef struct {
    uint8_t sys;
    uint8_t prn;
    uint8_t health; /* 0 = usable */
    uint8_t source; /* Galileo: 0 I/NAV, 1 F/NAV; else 0 */
    uint16_t iode;  /* IODE / IODnav / AODE; GLONASS: t_b in quarters of an hour */
    uint16_t iodc;
    float sd_ura_m; /* user range accuracy, 1 sigma */
    float fit_s;    /* usable for |t - toe| up to this, s */
    pel_time_t toe_ns;
    pel_time_t toc_ns;
    double af0, af1, af2; /* clock, s, s/s, s/s^2; GLONASS: -tau_n, gamma_n, 0 */
    double tgd_s[2];      /* GPS/QZSS TGD; Galileo BGD E5a/E1, E5b/E1; BeiDou TGD1, TGD2; GLONASS G2 - G1, 0 */
    union {
        struct {
            double sqrt_a, e, i0, Omega0, omega, M0; /* m^0.5, -, rad */
            double dn, Omega_dot, idot;              /* rad/s */
            double cuc, cus, crc, crs, cic, cis;     /* rad, m */
        };
        struct {
            double r_e[3], v_e[3]; /* PZ-90 at toe, m, m/s */
            double a_e[3];         /* by Sun and Moon, m/s^2 */
            int8_t k;              /* frequency channel, -7..6 */
        } glo;                     /* of PEL_SYS_GLO */
    };
} pel_ephemeris_t;

/* Klobuchar ionosphere, GPS units (s, s/semicircle, ...). */
typedef struct {
    bool valid;
    float alpha[4];
    float beta[4];
} pel_klobuchar_t;

/* Reference station. */
typedef struct {
    uint16_t id;
    double r_ea_e[3]; /* antenna reference point + height of antenna, ECEF, m */
} pel_station_t;

/* A receiver's own navigation solution (start-up aid and comparison, never a filter input). */
typedef struct {
    pel_time_t t_ns;
    uint8_t fix;          /* 0 none, 2 2-D, 3 3-D, 4 GNSS + dead reckoning */
    uint8_t carrier_soln; /* 0 none, 1 float, 2 fixed */
    uint8_t n_sat;
    double lat_rad, lon_rad, height_m;
    double v_ned[3];
    float sd_h_m, sd_v_m, sd_speed_mps;
} pel_pvt_t;

#ifdef __cplusplus
}
#endif
#endif

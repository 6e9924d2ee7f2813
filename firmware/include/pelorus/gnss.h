/* gnss.h - from broadcast ephemerides and receiver epochs to predicted ranges, positions, differences and slips.
 *
 * Order of use, one receiver epoch:
 *   pel_orbits_add() for every ephemeris that arrives
 *   pel_spp_solve()           code and Doppler position; gives the true time of the epoch (receiver clock removed)
 *   pel_view_compute()        every satellite as seen from where the antenna is now believed to be
 *   pel_slip_check()          marks phases that lost their integer
 *   pel_pair_epochs(), pel_sd_form()   rover minus base (or pel_sd_undifferenced() for a single receiver)
 *   pel_whiten_*()            double differences to independent scalar rows
 *
 * Base and rover need not sample at the same instant. Each observation is reduced with the satellite computed at the
 * transmission time of that very signal (tag - P/c - satellite clock), so what remains of base and rover (integer,
 * receiver clock, noise) can be subtracted although their tags differ by milliseconds or seconds: the modelled range
 * carries the propagation, and no Doppler noise enters. What is left of an age of seconds is the satellite's clock
 * noise, put into the variance (pel_noise_config_t.sat_clock_mps).
 *
 * Signs: L = rho + lambda N; single difference = rover - base; unit vectors point from antenna to satellite.
 * All state is the caller's; all functions are re-entrant. Sources: IS-GPS-200 (20.3.3), Galileo OS SIS ICD,
 * BDS-SIS-ICD-B1I, ICD GLONASS 5.1, Saastamoinen (1972), Klobuchar (1987), Groves (2013) ch. 8-9, Teunissen & Montenbruck (2017). */
#ifndef PELORUS_GNSS_H
#define PELORUS_GNSS_H

#include "pelorus/base.h"
#include "pelorus/solution.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- orbits --------------------------------------------------------------------------------------------------- */

/* Ephemerides received, two generations a satellite while there is room. 192 bytes each, PEL_MAX_EPH of them. */
typedef struct {
    pel_ephemeris_t eph[PEL_MAX_EPH];
    int n;
    pel_klobuchar_t klobuchar;
    bool no_ionosphere; /* apply no model at all: for simulations without one. Set after pel_orbits_init(). */
} pel_orbits_t;

void pel_orbits_init(pel_orbits_t *o);

/* Keep an ephemeris. One of the same satellite and toe replaces its predecessor; of Galileo's two messages I/NAV is kept
 * where both are there. In a full store the oldest that a newer one of its satellite stands in for makes room, else the
 * oldest: give PEL_MAX_EPH room for what the streams carry, twice if possible.
 * Returns PEL_OK; PEL_E_RANGE if a number is not finite or no orbit of a GPS, GLONASS, QZSS, Galileo or BeiDou satellite
 * has such a value (nothing is kept). Cost: one pass over the store, PEL_MAX_EPH passes when it is full. */
pel_status_t pel_orbits_add(pel_orbits_t *o, const pel_ephemeris_t *eph);

/* The ephemeris whose toe lies nearest to t, within its fit interval (fit_s; 0 means 2 h GPS and BeiDou, 4 h Galileo,
 * 2 h QZSS, 20 min GLONASS) plus ten minutes of grace; Galileo I/NAV before F/NAV. NULL if none. Unhealthy ones are returned: the
 * caller looks at health. The pointer is good until the next pel_orbits_add(). */
const pel_ephemeris_t *pel_orbits_find(const pel_orbits_t *o, uint8_t sys, uint8_t prn, pel_time_t t_ns);

/* Satellite at one instant: ECEF of that same instant; clock with relativity, without group delay. */
typedef struct {
    double r_e[3];   /* antenna phase centre, m */
    double v_e[3];   /* m/s */
    double clk_s;    /* satellite clock minus system time, s */
    double clk_rate; /* s/s */
} pel_sat_state_t;

/* State at GPS time t_ns + dt_s. Position and velocity in closed form from the Kepler elements (velocity is the
 * derivative of the position formula), BeiDou GEO (prn 1-5, 59-63) through its inclined frame. GLONASS: Runge-Kutta 4 from
 * the broadcast state in steps of a minute, at most 60 (ICD GLONASS 5.1, A.3.1.2).
 * Returns PEL_OK; PEL_E_RANGE (unusable elements, GLONASS farther than an hour from toe); PEL_E_NO_CONVERGENCE (Kepler, at most 10 Newton steps; never seen
 * for e < 0.3). Output unchanged on failure. Cost: about 9 sin/cos pairs; GLONASS 250 multiply-adds, 4 divisions and 4
 * square roots a step. */
pel_status_t pel_sat_state(const pel_ephemeris_t *eph, pel_time_t t_ns, double dt_s, pel_sat_state_t *out);

/* What a code on this carrier arrives late by, relative to the broadcast clock, m: subtract it from the pseudorange.
 * GPS, QZSS: TGD on L1, times (f1/f2)^2 on L2, 0 on L5. Galileo: BGD by the clock's own pair (source). BeiDou: TGD1 on B1I
 * and B1C, TGD2 on B2I (BeiDou-2), 0 on B3I. GLONASS: delta tau on G2, 0 on G1. Carriers for which nothing is broadcast: 0. */
double pel_sat_group_delay_m(const pel_ephemeris_t *eph, pel_carrier_t carrier);

/* ---- atmosphere ------------------------------------------------------------------------------------------------- */

/* Slant delay of the troposphere, m. Zenith: Saastamoinen with the standard atmosphere at height h (m, clamped to
 * -500..20000; 0 above 20 km) and 70 % humidity; mapping: Black and Eisner (1984), 1.001/sqrt(0.002001 + sin^2 el),
 * el clamped to >= 3 degrees. */
double pel_tropo_saastamoinen_m(double lat, double h, double el);

/* Slant delay of the ionosphere on 1575.42 MHz, m (IS-GPS-200 20.3.3.5.2.5); other carriers: times (f1/f)^2. With
 * klobuchar->valid false: the same with nominal coefficients, those broadcast on 2005-04-02 (moderate solar activity),
 * which remove about half of the delay. t in GPS time; angles in rad. 0 if an argument is not finite. */
double pel_iono_klobuchar_m(const pel_klobuchar_t *k, pel_time_t t_ns, double lat, double lon, double az, double el);

/* ---- what an antenna sees --------------------------------------------------------------------------------------- */

/* One satellite from one antenna. Ranges in m, rates in m/s. */
typedef struct {
    uint8_t sys, prn;
    bool excluded;  /* refused by the residual test of pel_spp_solve() */
    uint8_t source; /* of the ephemeris: which Galileo clock */
    uint16_t iode;  /* with toe_gps_s: which ephemeris this is */
    uint32_t toe_gps_s;
    float az_rad, el_rad;
    float sd_eph_m;             /* orbit and clock, 1 sigma: half of the broadcast URA */
    float tgd_m[2];             /* c * tgd_s[] */
    double r_s_e[3];            /* satellite at transmission, ECEF of that instant */
    double v_s_e[3];            /* its velocity, likewise */
    double u_e[3];              /* unit vector antenna -> satellite */
    double rho_m;               /* geometric range */
    double rho_rate_mps;        /* its derivative by receive time */
    double clk_m, clk_rate_mps; /* c * satellite clock with relativity, without group delay */
    float sd_iono_m;            /* of iono_L1_m, what is not common to all satellites, 1 sigma */
    double tropo_m, iono_L1_m;  /* slant delays, >= 0 */
} pel_sight_t;

/* PEL_MAX_SATS * 160 bytes. */
typedef struct {
    pel_time_t t_ns; /* tag of the epoch it was computed for */
    int n;
    pel_sight_t sight[PEL_MAX_SATS];
} pel_view_t;

/* All satellites of an epoch with a pseudorange and a healthy orbit, above the elevation mask, as seen from antenna
 * position r_ea_e moving with v_ea_e (both at the true instant of the epoch; NULL v is rest). The transmission time comes
 * from the pseudorange, so the receiver's clock need not be known.
 *  t_orbit_ns  chooses the ephemeris: give base and rover views that shall be differenced the same value
 *  mask_rad    satellites below are left out and counted; counters (may be NULL): sats_no_eph, sats_unhealthy, sats_low,
 *              and sats_excluded for those beyond PEL_MAX_SATS
 * Returns PEL_OK; PEL_E_MISSING (no satellite left); PEL_E_RANGE (r or v not finite, or |r| not within 6300 to 7400 km).
 * On failure view->n = 0. Cost per satellite: pel_sat_state() + about 200 flops + two atmosphere models. */
pel_status_t pel_view_compute(const pel_epoch_t *e, const pel_orbits_t *o, pel_time_t t_orbit_ns,
                              const double r_ea_e[3], const double v_ea_e[3], double mask_rad,
                              pel_nav_counters_t *count, pel_view_t *view);

/* Geometry again, for the same epoch from another position or velocity: orbits and atmosphere are kept. For steps of up
 * to kilometres. Cost per satellite: about 60 flops and one square root. */
void pel_view_move(pel_view_t *view, const double r_ea_e[3], const double v_ea_e[3]);

/* NULL if the satellite is not in view. */
const pel_sight_t *pel_view_find(const pel_view_t *view, uint8_t sys, uint8_t prn);

/* Predicted observation without the receiver's clock, m and m/s: rho - clk + tropo + iono + group delay (code),
 * rho - clk + tropo - iono (phase), rho_rate - clk_rate. Subtract from P_m, lambda * L_cyc, -lambda * D_hz. */
double pel_sight_code_m(const pel_sight_t *s, const pel_obs_t *obs);
double pel_sight_phase_m(const pel_sight_t *s, const pel_obs_t *obs);
double pel_sight_rate_mps(const pel_sight_t *s);

/* Wavelength of an observation's carrier, m; 0 for a pair of system and carrier that does not exist. */
double pel_obs_lambda_m(const pel_obs_t *obs);

/* Is this part of the observation present, finite and of a possible size? part: PEL_OBS_CODE, _PHASE or _DOPPLER. */
bool pel_obs_usable(const pel_obs_t *obs, unsigned part);

/* All of them at once, as bits. */
unsigned pel_obs_usable_parts(const pel_obs_t *obs);

/* ---- noise ------------------------------------------------------------------------------------------------------ */

/* Standard deviations of ONE receiver's observation: sd^2 = factor^2 (a^2 + (b / sin el)^2), and with cn0_ref_dbhz > 0
 * variances grow by 10^((ref - C/N0) / 10) below the reference. pel_noise_default() gives a = b each 1/sqrt(2) of
 * code 0.3 m, phase 3 mm at the zenith; Doppler 0.03 m/s. */
typedef struct {
    double code_a_m, code_b_m;
    double phase_a_m, phase_b_m;
    double doppler_a_mps, doppler_b_mps;
    double rover_factor, base_factor; /* of the standard deviations, by quality of the receiver */
    double cn0_ref_dbhz;              /* 0: C/N0 not used */
    double sat_clock_mps;             /* satellite clock noise per second of base age, 1 sigma */
    double iono_mm_per_km;            /* differential ionosphere, for the integer problem; not in the variances here */
} pel_noise_config_t;

void pel_noise_default(pel_noise_config_t *noise);

/* Variance of one receiver's observation (m^2, (m/s)^2), without its factor. part as in pel_obs_usable(). sin_el: of the
 * elevation, whose sine the three parts share; below 0.05 it counts as that. */
double pel_noise_var(const pel_noise_config_t *noise, unsigned part, double sin_el, double cn0_dbhz);

/* ---- single-point solution -------------------------------------------------------------------------------------- */

typedef struct {
    double mask_rad;       /* elevation mask */
    double code_sd_m;      /* single-receiver code with unmodelled multipath, at the zenith, 1 sigma */
    double doppler_sd_mps; /* at the zenith */
    double p_false;        /* risk of a false alarm of the residual test: 0.01 or 0.001 */
    uint8_t max_exclude;   /* satellites the test may remove, 0..3 */
    uint8_t sys_mask;      /* systems to use, one bit (1 << pel_sys_t) */
} pel_spp_config_t;

void pel_spp_default(pel_spp_config_t *cfg);

typedef struct {
    pel_time_t t_ns; /* true instant: tag minus receiver clock */
    double r_ea_e[3], v_ea_e[3];
    double clk_m; /* receiver clock (tag - true time) times c, by the first system used */
    double clk_rate_mps;
    double isb_m[PEL_N_SYS]; /* clock of each other system minus the first one's; 0 where unused, and for QZSS */
    double cov_r_e[3][3];    /* m^2; scaled up by the residuals' variance where that exceeds one */
    double cov_v_e[3][3];    /* (m/s)^2, likewise */
    double rms_m;            /* weighted residuals, code: sqrt(v'Wv / dof) in units of 1 sigma (0 if dof = 0) */
    int n_used;              /* satellites in the position */
    int n_excluded;
    bool has_velocity;
} pel_spp_t;

/* Position, receiver clock, velocity and clock rate of one epoch from code and Doppler, weighted least squares.
 *
 *  prior  in      a position to start from (NULL: from the Earth's centre, which always works)
 *  count  in/out  may be NULL; as in pel_view_compute(), excluded satellites in sats_excluded
 *  view   out     workspace, and afterwards the view from the solution with the refused satellites marked
 *
 * One code a satellite, on its first carrier in the order L1, B1I, then as numbered. Ionosphere: Klobuchar scaled to the
 * carrier, nominal where nothing is broadcast; a second carrier is not used for it, because the difference of two codes
 * would treble their noise. One clock a system, QZSS on GPS's. If the residuals fail their chi-square test, the satellite with the largest normalised
 * residual is excluded, max_exclude times at most (Baarda 1968); never below one redundant satellite.
 *
 * Returns PEL_OK; PEL_W_REJECTED (delivered, but the residuals still fail: covariance scaled, treat as doubtful);
 * PEL_E_GEOMETRY (too few satellites or singular); PEL_E_MISSING (no orbits); PEL_E_NO_CONVERGENCE (12 iterations);
 * out unchanged on error. Stack 1.3 KB. Cost: orbits once, then 3 to 8 iterations of 60 multiply-adds a satellite. */
pel_status_t pel_spp_solve(const pel_epoch_t *e, const pel_orbits_t *o, const pel_spp_config_t *cfg,
                           const pel_spp_t *prior, pel_nav_counters_t *count, pel_view_t *view, pel_spp_t *out);

/* ---- rover against base ------------------------------------------------------------------------------------------ */

/* Of n base epochs (those with n = 0 observations are empty slots), the one nearest to time t_ns.
 *  index, age_s  out  its place; t_ns minus its tag, s. Unchanged on failure.
 * Returns PEL_OK; PEL_E_MISSING (all empty); PEL_E_STALE (the nearest is farther than max_age_s). */
pel_status_t pel_pair_epochs(const pel_epoch_t base[], int n, pel_time_t t_ns, double max_age_s, int *index,
                             double *age_s);

/* Rover minus base of (observed - predicted), one satellite, one carrier. The pivot is not yet subtracted: it contains
 * the receivers' clocks, which a difference within the group removes. */
typedef struct {
    uint8_t sys, prn, carrier;
    int8_t glo_k;
    bool pivot : 1;
    bool has_code : 1, has_phase : 1, has_rate : 1;
    bool half : 1; /* either phase has an unresolved half cycle */
    bool slip : 1; /* either phase slipped since its previous epoch */
    uint8_t group; /* 0..n_groups-1 = one (system, carrier) */
    float el_rad;
    float cn0_dbhz; /* of the rover */
    double lambda_m;
    double code_m, phase_m, rate_mps; /* phase_m = lambda (integer of rover - base) + clocks + noise; 0 where absent */
    double var_code, var_phase, var_rate; /* of this single difference; 0 where absent */
    double u_e[3];                        /* rover antenna -> satellite: d(predicted)/d(rover position) = -u */
} pel_sd_t;

/* Sorted by system, then carrier (but for systems added later); in each group the pivot first, then by prn. PEL_MAX_OBS * 96
 * bytes. */
typedef struct {
    pel_time_t t_ns; /* tag of the rover's epoch */
    int n;
    int n_groups;
    pel_sd_t sd[PEL_MAX_OBS];
} pel_sd_set_t;

/* Single differences of all carriers both receivers observe. The two views must stem from the same orbits and t_orbit_ns;
 * a satellite whose ephemeris differs between them is left out. Where a receiver has several codes on one carrier, the
 * letter that both have is taken. Pivot: the highest satellite of the group that has everything the group offers and
 * neither slip nor unresolved half cycle.
 *  base_age_s  rover minus base true time; adds (sat_clock_mps * age)^2 to code and phase variances
 * Returns PEL_OK; PEL_E_MISSING (nothing in common; out->n = 0). Cost: PEL_MAX_OBS^2 byte comparisons at worst. */
pel_status_t pel_sd_form(const pel_epoch_t *rover, const pel_view_t *rover_view, const pel_epoch_t *base,
                         const pel_view_t *base_view, const pel_noise_config_t *noise, double base_age_s,
                         pel_sd_set_t *out);

/* Rows of those systems that `out` has none of, from another epoch of the base: one whose message for a system was lost on the line
 * leaves that system to the epoch before. Groups do not mix epochs, so the base's clock still cancels. Arguments as pel_sd_form();
 * the rows follow those that are there. PEL_E_MISSING: nothing came of it. */
pel_status_t pel_sd_add_missing(const pel_epoch_t *rover, const pel_view_t *rover_view, const pel_epoch_t *base,
                                const pel_view_t *base_view, const pel_noise_config_t *noise, double base_age_s,
                                pel_sd_set_t *out);

/* The same rows for a receiver alone: observed minus predicted. GPS and QZSS share a group: their clocks agree to 2 m and their signals are
 * the same. Differences within a group remove the receiver's clock as before; what is not common to satellites (orbit, clock, atmosphere) is in the variance of the code, and of the rate by
 * what it changes per second. Phases are delivered with has_phase only for use by time differences: their integers are
 * not those of a double difference. */
pel_status_t pel_sd_undifferenced(const pel_epoch_t *rover, const pel_view_t *view, const pel_noise_config_t *noise,
                                  pel_sd_set_t *out);

/* ---- whitening --------------------------------------------------------------------------------------------------- */

/* The double differences of one group share their pivot: R = diag(r_i) + r_0 1 1'. Its factor R = L diag(d) L' has all
 * entries of a column equal (l_ij = l_j for i > j), so L^-1 is applied row by row with one running sum: O(n) a row.
 * (Closed form: q = r_0; d_j = r_j + q; l_j = q / d_j; q <- q r_j / d_j.)
 *
 * Use: begin; for each satellite but the pivot: form the DD row, pel_whiten_row(), offer it to the filter, and if it was
 * accepted pel_whiten_accept(). A row not accepted leaves no trace: the rest is whitened as if that satellite had not been
 * there. Callers may read every field and write none. */
typedef struct {
    int n;                        /* entries of a row */
    pel_real q;                   /* what is left of the pivot's variance */
    pel_real s_z;                 /* sum over accepted rows j of l_j z_j, z_j whitened */
    pel_real s_h[PEL_MAX_STATES]; /* the same of their h */
} pel_whiten_t;

/* n: entries of each row, 0..PEL_MAX_STATES. r_0 >= 0: the pivot's single-difference variance. PEL_E_RANGE otherwise. */
pel_status_t pel_whiten_begin(pel_whiten_t *w, int n, pel_real r_0);

/* Turn (z, h), a double difference with single-difference variance r_i, into a row independent of those accepted before.
 *  z, h  in/out   innovation and row[n], whitened in place
 *  var   out      variance of the whitened row, same unit as r_i
 * Returns PEL_OK, PEL_E_NOT_POSDEF (r_i not > 0; nothing changed). Cost: n additions. */
pel_status_t pel_whiten_row(const pel_whiten_t *w, pel_real r_i, pel_real *z, pel_real h[], pel_real *var);

/* Tell that the whitened row (z, h) with single-difference variance r_i was used. Cost: n multiply-adds, one division. */
void pel_whiten_accept(pel_whiten_t *w, pel_real r_i, pel_real z, const pel_real h[]);

/* ---- cycle slips ------------------------------------------------------------------------------------------------- */

/* What the detectors remember of one phase. It belongs to them alone: time differences keep their own history. */
typedef struct {
    uint8_t sys, prn, carrier;
    char code;
    bool half;
    bool has_rate;
    bool predicted; /* range_m is there */
    float rate_mps; /* -lambda D */
    uint32_t lock_ms;
    pel_time_t t_ns;
    double y_m;     /* lambda L */
    double code_m;  /* P - lambda L; 0 if no code */
    double range_m; /* pel_sight_phase_m() then */
} pel_slip_entry_t;

typedef struct {
    int n;
    double phase_sd_m;     /* of one strong phase at the zenith; pel_slip_init() says 3 mm, the caller may change it */
    pel_time_t checked_ns; /* the epoch before */
    pel_slip_entry_t entry[PEL_MAX_OBS];
} pel_slip_t;

void pel_slip_init(pel_slip_t *s);

/* What an inertial prediction knows about the antenna's motion since the previous check of the same pel_slip_t. */
typedef struct {
    double dr_e[3]; /* corrections that updates made to the position since the previous check (the view's position
                          * now is the previous view's + dr_e + predicted motion), m */
    double sd_m;    /* 1 sigma of the predicted motion along any direction, m, > 0 */
} pel_slip_aid_t;

/* Compare an epoch with the one before, set PEL_OBS_SLIP on phases whose integer may have changed, and remember the epoch.
 *
 *  e      in/out  flags of its observations; all its Dopplers change sign if they contradict the phases by it
 *  view   in      satellites of this epoch; NULL: no predicted ranges (Doppler is then the only model of motion)
 *  aid    in      NULL: no inertial prediction
 *  count  in/out  may be NULL: slip_lock (told by the receiver, lock time fell or shorter than the gap), slip_half_cycle
 *                 (its flag changed), slip_geometry_free (jump of the difference of two carriers, both marked),
 *                 slip_doppler (phase change against mean Doppler), slip_ins (against predicted range change),
 *                 clock_jumps. Each detector counts what it alone sees of the epoch, a phase may appear in several.
 *
 * Thresholds: 5 sigma of 3 mm phases and 0.05 m/s Dopplers, both growing by elevation and below 42 dBHz, 2 mm/s of
 * ionosphere between carriers (no more than half a cycle together), aid->sd_m, 2 m/s^3 of unknown jerk over Doppler; never
 * below half a cycle for the last two. The common part of all satellites (median) is the receiver's clock and no slip; if
 * it amounts to whole milliseconds a clock jump is counted. A signal seen for the first time, or after more than
 * PEL_SLIP_MAX_GAP_S, is marked as slipped (nothing is known about its integer) without a count. One that was missing in between
 * (a line that loses messages) goes on where its lock time says that it was tracked all along.
 * Cost: about 100 flops a phase. Stack: 20 bytes a signal of PEL_MAX_OBS, 2.8 KB at 128. */
#define PEL_SLIP_MAX_GAP_S 60.0
void pel_slip_check(pel_slip_t *s, pel_epoch_t *e, const pel_view_t *view, const pel_slip_aid_t *aid,
                    pel_nav_counters_t *count);

#ifdef __cplusplus
}
#endif
#endif

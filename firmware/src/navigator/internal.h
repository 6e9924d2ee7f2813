/* internal.h - what the files of navigator/ share. Not public. */
#ifndef PELORUS_NAVIGATOR_INTERNAL_H
#define PELORUS_NAVIGATOR_INTERNAL_H

#include "pelorus/math.h"
#include "pelorus/navigator.h"

/* g' P g */
static inline double pel_nav_along(const double P[3][3], const double g[3])
{
    double Pg[3];
    pel_mat3_vec(P, g, Pg);
    return pel_dot3(g, Pg);
}

#define PEL_NAV_BIT(output) (UINT32_C(1) << (unsigned)(output))

/* Longest stretch without IMU that the INS survives, s. */
#define PEL_NAV_LONGEST_GAP_S 0.3

/* ---- preset.c ---- */

typedef struct {
    void (*model)(pel_model_t *m,
                  const pel_imu_model_t *imu); /* of the INS; its blocks are those of pel_model_ins_ecef() */
    bool imu;                                  /* the INS runs where there is an IMU */
    bool base;                                 /* double differences where there is a base */
    bool rover_phase;                          /* phases of the rover alone where there is no base */
    bool local;                                /* mechanization and filter in local axes */
    bool rates;                                /* Doppler is used */
    bool each_epoch; /* integers are searched in each epoch alone; else only in the filter's own floats */
} pel_nav_preset_t;

/* By what was asked for: what may run. By what is in use: how epochs are used. */
const pel_nav_preset_t *pel_nav_preset(pel_preset_t preset);
pel_preset_t pel_nav_preset_in_use(const pel_navigator_t *nav);

/* ---- axes.c: the axes of the filter's states ---- */

/* At the horizon, for a while. C_e_enu is set where local. */
typedef struct {
    bool local;
    double C_e_enu[3][3];
} pel_nav_axes_t;

void pel_nav_axes(const pel_navigator_t *nav, pel_nav_axes_t *axes);

/* Covariance of two vector states that begin at i and j, in e. */
void pel_nav_block_e(const pel_navigator_t *nav, const pel_nav_axes_t *axes, int i, int j, double P[3][3]);

/* Block A of Phi at (row, col). */
void pel_nav_add_block(pel_transition_t *t, int row, int col, const double A[3][3]);

/* A row made in e becomes one on the filter's states. */
void pel_nav_turn_row(const pel_nav_axes_t *axes, const pel_antenna_t *ant, pel_row_t *row);

/* Before an advance: local axes where the preset asks for them, e within a degree of the poles. The covariance changes with them. */
pel_status_t pel_nav_choose_axes(pel_navigator_t *nav);

/* The next substep of the time update begins here, with this attitude in the filter's axes. */
void pel_nav_restart_substep(pel_navigator_t *nav, const double C[3][3]);

/* ---- horizon.c: the filter's nominal state through time ---- */

/* Carry state and covariance to t. With INS the ring must reach t (else PEL_E_MISSING, nothing changed). */
pel_status_t pel_nav_advance(pel_navigator_t *nav, pel_time_t t_ns);

/* Subtract the filter's x from the nominal state and clear it. */
void pel_nav_close_loop(pel_navigator_t *nav);

/* One increment in body axes: into the ring, the alignment, the output. */
void pel_nav_take_increment(pel_navigator_t *nav, const pel_imu_t *body);

/* now = the horizon's state carried through the ring to its newest increment. */
void pel_nav_predict_now(pel_navigator_t *nav);

/* Antenna position and velocity at the horizon, and what rows need to know of it. */
void pel_nav_antenna(const pel_navigator_t *nav, pel_antenna_t *ant, double r_ea_e[3], double v_ea_e[3]);

/* Covariance of antenna position (rate = false) or velocity (true): A P A'. */
void pel_nav_antenna_cov(const pel_navigator_t *nav, const pel_antenna_t *ant, bool rate, double P[3][3]);

/* ---- start.c: from nothing to a state ---- */

/* Begin (again) with GNSS alone from a single-point solution. */
void pel_nav_start_gnss(pel_navigator_t *nav, const pel_spp_t *spp);

void pel_nav_reset_alignment(pel_navigator_t *nav);

/* One increment while the INS does not run. */
void pel_nav_align_increment(pel_navigator_t *nav, const pel_imu_t *body);

/* Mean specific force and angular rate over at most the last longest_s before t. Returns what the ring holds of it, s. */
double pel_nav_ring_mean(const pel_navigator_t *nav, pel_time_t t_ns, double longest_s, double f_ib_b[3],
                         double omega_ib_b[3]);

/* Begin the INS at the horizon if an IMU is there and an attitude can be had. */
void pel_nav_try_start_ins(pel_navigator_t *nav);

/* Fall back to GNSS alone, keeping position and velocity. */
void pel_nav_drop_ins(pel_navigator_t *nav);

/* ---- yaw.c: heading without knowing the mounting ---- */

void pel_nav_yaw_increment(pel_yaw_t *y, const pel_imu_t *body);

/* After each epoch with a velocity. */
void pel_nav_yaw_epoch(pel_navigator_t *nav);

/* Attitude at the horizon and its heading's 1 sigma; false while it is not known to SD_MAX_RAD. */
bool pel_nav_yaw_solve(const pel_navigator_t *nav, double C_b_enu[3][3], double *sd_rad);

/* ---- instant.c ---- */

/* Bring the state to the true instant of a rover epoch, starting it if there is none. False: it cannot be used. */
bool pel_nav_reach_epoch(pel_navigator_t *nav, const pel_epoch_t *rover);

/* ---- epoch.c, integers.c ---- */

/* No state until the next single-point solution. */
void pel_nav_stop(pel_navigator_t *nav);

/* Use one rover epoch with its base epoch (or NULL). Unless nav->search says so, it is done: used or refused. */
void pel_nav_begin_epoch(pel_navigator_t *nav, pel_epoch_t *rover, pel_epoch_t *base);

/* Go on with its search by at most this many nodes, or one bounded step between searches; done when nav->search is NONE. The horizon
 * stands at the epoch meanwhile. */
void pel_nav_go_on(pel_navigator_t *nav, int32_t max_nodes);

/* Ionosphere of a single difference on L1, 1 sigma, by the baseline's length. */
#define PEL_L1_HZ 1575.42e6
double pel_nav_iono_sd_m(const pel_navigator_t *nav);

/* Begin to resolve the integers of nav->sd with the horizon's position as prior. P_a: covariance of the antenna position, m^2. False: too
 * few, out says so. A step returns true when out is there. */
bool pel_nav_resolve_begin(pel_navigator_t *nav, const double P_a[3][3], pel_nav_integers_t *out);
bool pel_nav_resolve_step(pel_navigator_t *nav, int32_t max_nodes, pel_nav_integers_t *out);
void pel_nav_count_verdict(pel_nav_counters_t *c, pel_int_reason_t reason);

/* ---- rows.c ---- */

/* One report a single difference, still without rows. */
void pel_nav_start_reports(pel_navigator_t *nav);

/* All rows of nav->sd through screening, whitening and gate into the filter; counts and reports them. */
void pel_nav_update_rows(pel_navigator_t *nav, pel_nav_update_t *u);

/* Satellites with any row in the last update. */
int pel_nav_satellites_used(const pel_navigator_t *nav);

/* ---- noise_level.c: how noisy codes and phases really are ---- */

void pel_nav_noise_level_init(pel_navigator_t *nav);

/* Multiply the variances of nav->sd by what was learnt. */
void pel_nav_noise_level_apply(pel_navigator_t *nav);

/* Has a phase of nav->sd reached the limit? It then begins anew at one. */
bool pel_nav_noise_level_phase_is_lost(pel_navigator_t *nav);

/* Before the rows of an epoch whose code variances were inflated for their correlation. */
void pel_nav_noise_level_begin(pel_navigator_t *nav, double code_inflated_by);

/* One row of a code or a phase: its innovation squared over its variance, which was var_state by
 * the state and var_row by the measurement. kind: PEL_NAV_LEVEL_. While noise_level.learning. */
void pel_nav_noise_level_learn(pel_navigator_t *nav, const pel_sd_t *sd, int kind, double nis, double var_state,
                               double var_row);

/* ---- hold_watch.c: do the codes agree with the held integers? ---- */

void pel_nav_hold_watch_reset(pel_navigator_t *nav);
void pel_nav_hold_watch_age(pel_navigator_t *nav, double dt_s);

/* One whitened code row of an epoch whose phases hold the position, before its update; i_r: first position state. */
void pel_nav_hold_watch_row(pel_navigator_t *nav, const pel_row_t *row, int i_r);
bool pel_nav_hold_watch_contradicts(const pel_navigator_t *nav);

/* ---- channels.c: GLONASS phases, each on its own wavelength ---- */

#define PEL_NAV_DATUM_CODE_M 3.0 /* a GLONASS datum comes from one code, rover minus base: 1 sigma */

void pel_nav_channels_init(pel_navigator_t *nav);

/* The filter was started afresh: its states are gone, what they had learnt is not. */
void pel_nav_channels_forget(pel_navigator_t *nav);

/* May phases of this satellite be used: a wavelength common to its group, or a slope state to make up for it? */
bool pel_nav_channels_ready(const pel_navigator_t *nav, const pel_sd_t *sd);

/* A group has a new datum, known from code alone. Begins the slope's state at the first one. */
void pel_nav_channels_new_datum(pel_navigator_t *nav, const pel_sd_t *sd);

/* What the slope makes of phase sd against phase ref, m, and its 1 sigma. 0 for other systems. */
double pel_nav_channels_offset_m(const pel_navigator_t *nav, const pel_sd_t *sd, const pel_sd_t *ref);
double pel_nav_channels_sd_m(const pel_navigator_t *nav, uint8_t carrier);

/* The slope's part of a phase row. */
void pel_nav_channels_put(const pel_navigator_t *nav, const pel_sd_t *sd, const pel_sd_t *ref, pel_row_t *row);

/* Number of a phase from its code, cycles. */
double pel_nav_channels_number(const pel_sd_t *sd);

void pel_nav_channels_close_loop(pel_navigator_t *nav);

/* State `removed` of the filter is gone: those behind it have moved up. */
void pel_nav_channels_shift(pel_navigator_t *nav, int removed);

/* ---- track.c: ambiguities from epoch to epoch ---- */

/* The datum of a group, NULL if there is none. */
pel_tracked_t *pel_nav_track_datum(pel_navigator_t *nav, uint8_t sys, uint8_t carrier);

/* The entry of a phase: NULL if there is none; made if there is room. */
pel_tracked_t *pel_nav_track_find(pel_navigator_t *nav, uint8_t sys, uint8_t prn, uint8_t carrier);
pel_tracked_t *pel_nav_track_get_or_add(pel_navigator_t *nav, const pel_sd_t *sd);

/* Satellites that have set keep their place until it is needed. */
void pel_nav_track_make_room(pel_navigator_t *nav);

/* Its number becomes a state of this 1 sigma. False: no room. */
bool pel_nav_track_add_state(pel_navigator_t *nav, pel_tracked_t *t, double sd_cyc);

/* One entry's state goes, or all of it; indices of others move up. */
void pel_nav_track_remove_state(pel_navigator_t *nav, pel_tracked_t *t);
void pel_nav_track_drop_entry(pel_navigator_t *nav, int i);

/* The number of a phase on its group's datum, if it is not a filter state. */
bool pel_nav_track_number(const pel_navigator_t *nav, const pel_sd_t *sd, double *N);

/* Forget everything and its states (clear), or after the filter itself was started afresh (forget). */
void pel_nav_track_clear(pel_navigator_t *nav);
void pel_nav_track_forget(pel_navigator_t *nav);

/* One phase begins anew. */
void pel_nav_track_drop(pel_navigator_t *nav, const pel_sd_t *sd);

/* Float ambiguities wander by what the errors of their phases do in the time since. After nav->sd was formed. */
void pel_nav_track_wander(pel_navigator_t *nav);

/* Phases that slipped in this epoch of rover or base start anew. */
void pel_nav_track_drop_slipped(pel_navigator_t *nav, const pel_epoch_t *e);

/* Hold the integers that a search of this epoch validated. False: they contradict those held, and one epoch is not enough for that. */
bool pel_nav_track_hold(pel_navigator_t *nav, const pel_nav_integers_t *ints);

/* Phases without an N get a float one, as filter states. */
void pel_nav_track_begin(pel_navigator_t *nav);

void pel_nav_track_lookup(pel_navigator_t *nav, pel_nav_phases_t *out);
void pel_nav_track_close_loop(pel_navigator_t *nav);

/* ---- rover_phase.c: phases without a base ---- */

/* Does this epoch use phases? Those of the other kind, against a base or of the rover alone, are then forgotten. After nav->sd was formed. */
bool pel_nav_track_claim(pel_navigator_t *nav, bool relative);

/* Phases without an N get one, as a state beside the datum's. */
void pel_nav_rover_phase_begin(pel_navigator_t *nav);

/* Without a datum the last offset's phase becomes it. */
void pel_nav_rover_phase_hand_over(pel_navigator_t *nav);

/* A phase that slipped. With a rate it stays: a slip says nothing of it. */
void pel_nav_rover_phase_slip(pel_navigator_t *nav, pel_tracked_t *t);

/* What satellite clocks, orbits and atmosphere did to the offsets in the time since. */
void pel_nav_rover_phase_walk(pel_navigator_t *nav);

/* The row of a double difference without its states. */
void pel_nav_rover_phase_row(pel_navigator_t *nav, const pel_antenna_t *ant, const pel_sd_t *sat, const pel_sd_t *pivot,
                             double dd_m, pel_row_t *row);

/* After the rows: have phases carried the position on? */
void pel_nav_rover_phase_note(pel_navigator_t *nav);

/* A single receiver's code errors are not independent from epoch to epoch: variances by their correlation times. */
void pel_nav_rover_weigh_codes(pel_navigator_t *nav, double gap_s, bool phased);

/* ---- vehicle.c: what is known without a satellite ---- */

void pel_nav_vehicle_init(pel_navigator_t *nav);

/* Where the IMU is before it has moved. False: not known. */
bool pel_nav_vehicle_place(const pel_navigator_t *nav, double r_eb_e[3]);

/* The INS begins: place and rest if they are known, the height's state behind the model's own. */
pel_status_t pel_nav_vehicle_begin(pel_navigator_t *nav);

void pel_nav_vehicle_baro(pel_navigator_t *nav, const pel_baro_t *baro);

/* A row about the vehicle into the filter, with this 1 sigma, and counted; three that say it does not move. */
void pel_nav_known_row(pel_navigator_t *nav, const pel_nav_axes_t *axes, const pel_antenna_t *ant, pel_row_t *row,
                       double sd, pel_real gate);
void pel_nav_rest_rows(pel_navigator_t *nav, const pel_nav_axes_t *axes, const pel_antenna_t *ant, double sd_mps,
                       pel_real gate);

/* Rows of each epoch, after the satellites'. */
void pel_nav_vehicle_rows(pel_navigator_t *nav);
void pel_nav_vehicle_close_loop(pel_navigator_t *nav);

/* ---- float_search.c ---- */

/* After the update: integers of the float states, if they can be told; the filter is then conditioned on them. held: validated
 * phases hold the position already. False: nothing to search. A step returns true when all is done: nav->update.later. */
bool pel_nav_track_search_begin(pel_navigator_t *nav, bool held);
bool pel_nav_track_search_step(pel_navigator_t *nav, int32_t max_nodes);

/* ---- wheels.c: a vehicle that goes where it points ---- */

/* Each increment: is it as quiet as at rest? */
void pel_nav_wheels_increment(pel_navigator_t *nav, const pel_imu_t *body);

/* Twice a second of the horizon: rows of standing or rolling into the filter, closed loop. True: the state has changed. */
bool pel_nav_wheels_update(pel_navigator_t *nav);

/* The same after an epoch, which also tells where the vehicle points. */
void pel_nav_wheels_epoch(pel_navigator_t *nav);

/* ---- warm.c: the snapshot of the life before ---- */

/* Attitude from a stored snapshot, if one waits and nothing speaks against it. Gives its verdict. */
bool pel_nav_warm_attitude(pel_navigator_t *nav, pel_alignment_t *out);

/* When the INS begins with that attitude: its sensor errors, and their sigmas into sd. */
void pel_nav_warm_errors(pel_navigator_t *nav, pel_real sd[PEL_MAX_STATES]);

/* After each epoch: does it stand still? */
void pel_nav_warm_epoch(pel_navigator_t *nav);

/* ---- admit.c ---- */

/* Numbers that a sensor can give, at a time that can be. */
bool pel_nav_imu_is_sane(const pel_imu_t *imu);

/* Private flags of increments in the ring: unlikely, and spanning lost ones. */
#define PEL_NAV_IMU_JOLT   0x4000u
#define PEL_NAV_IMU_BRIDGE 0x8000u

/* After the last one, in order of time: refuses spikes and stuck sensors, tells a jolt. */
bool pel_nav_admit_imu(pel_navigator_t *nav, const pel_imu_t *imu, bool *jolt);

/* Variance of attitude and velocity that the part of the ring's i-th increment with this length brings. False: none. */
bool pel_nav_doubt_of(const pel_navigator_t *nav, int i, double part_s, double *turn, double *push);

/* Noise on attitude and velocity, variance of an axis: rad^2, (m/s)^2. Nothing without INS. */
void pel_nav_doubt_motion(pel_navigator_t *nav, double turn, double push);

/* ---- timing.c ---- */

/* No INS until the IMU is as far ahead of the rover as it was, or a minute has passed. */
void pel_nav_doubt_imu_clock(pel_navigator_t *nav);

/* Do tag and sequence number contradict each other? gap_s: time missing before this sample by its tag. */
bool pel_nav_imu_clock_jumped(pel_navigator_t *nav, const pel_imu_t *imu, double gap_s);

/* A rover epoch arrives in order: how far is the IMU ahead of it? Ends the doubt of the IMU's clock when that is as before. */
void pel_nav_note_lead(pel_navigator_t *nav, pel_time_t epoch_ns);

/* ---- plausible.c ---- */

bool pel_nav_spp_is_plausible(const pel_spp_t *spp);

/* After nav->view_base: do the base's codes agree with its place, all but a clock? */
bool pel_nav_base_is_plausible(const pel_navigator_t *nav, const pel_epoch_t *base);

/* After the rows: has the Doppler of several epochs in a row contradicted the INS? */
bool pel_nav_ins_is_contradicted(pel_navigator_t *nav);

/* ---- sound.c ---- */

void pel_nav_seal_config(pel_navigator_t *nav);

/* Position, velocity and attitude between one push and the next: sealed at the end of each, no state any more if they have changed. */
void pel_nav_seal_state(pel_navigator_t *nav);
void pel_nav_check_state(pel_navigator_t *nav);

/* The base's place: unknown until it is told again if it has changed. */
void pel_nav_seal_station(pel_navigator_t *nav);
void pel_nav_check_station(pel_navigator_t *nav);

/* Every count and index within its bounds: the counts alone, for each increment, and all of it, for each epoch. */
bool pel_nav_counts_are_sound(const pel_navigator_t *nav);
bool pel_nav_is_sound(const pel_navigator_t *nav);

/* As after init, but for the counters, which tell it. */
void pel_nav_begin_anew(pel_navigator_t *nav);

/* ---- predict.c ---- */

/* Covariance in e of position, velocity and (with INS) attitude. */
typedef struct {
    double r[3][3], v[3][3], psi[3][3];
} pel_nav_cov_t;

/* That of a state predicted from the horizon, or of the horizon itself. */
void pel_nav_predicted_cov(const pel_navigator_t *nav, const pel_strapdown_t *at, pel_nav_cov_t *P);

/* ---- output.c ---- */

/* Upper triangle by rows. */
void pel_nav_pack_symmetric(const double P[3][3], float out[6]);

void pel_nav_fill_solution(const pel_navigator_t *nav, const pel_strapdown_t *at, pel_solution_t *out);
void pel_nav_note_seen(pel_navigator_t *nav, const pel_epoch_t *rover, const pel_epoch_t *base);
void pel_nav_note_used(pel_navigator_t *nav);

/* ---- event.c ---- */

/* Remember nav->now, reached by a turn of alpha since the last call. */
void pel_nav_keep_pose(pel_navigator_t *nav, const double alpha[3]);
void pel_nav_serve_event(pel_navigator_t *nav);

#endif

/* simulate.c - see simulate.h. Works in slices of 10 ms: what is made in one goes out as one event a line. */
#include "simulate.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/capture_log.h"
#include "pelorus/wire.h"
#include "pelorus_truth_t.h"
#include "world.h"

#define SLICE_NS     (10 * PEL_NS_PER_MS)
#define STATION_S    10.0               /* reference station message */
#define RISING       (-2.0 * WORLD_DEG) /* ephemerides are sent from this elevation on, so that they are there in time */
#define BUFFER_BYTES (1u << 16)

enum { ROVER = 1, BASE = 2, CAUSE_START = 51, CAUSE_MARKS = 52, CAUSE_BAROMETER = 53 };
enum { LINE_IMU, LINE_ROVER, LINE_BASE, LINE_MARKS, LINE_TRUTH, N_LINES };

typedef struct {
    const scenario_t *s;
    motion_t motion;
    sky_t sky;
    imu_sim_t imu;
    receiver_t rover, base;
    line_t line[N_LINES];
    streams_t out;
    simulate_counts_t counts;
    pel_epoch_t epoch;
    rng_t marks, weather;
    double weather_m;
    int64_t imu_k, truth_k; /* next ones */
    int64_t baro_k;
    int64_t mark_k;
    double ephemerides_s, station_s; /* when they are due */
    uint8_t buffer[BUFFER_BYTES];
} run_t;

static pel_time_t gps_time(const run_t *r, double t_s)
{
    return r->s->start_ns + (pel_time_t)llround(1e9 * t_s);
}

static bool send(run_t *r, int line, double t_s, size_t n)
{
    return streams_send(&r->out, &r->line[line], gps_time(r, t_s), r->buffer, n);
}

static void rover_antenna(void *context, double t_s, double r_e[3], double v_e[3])
{
    const run_t *r = context;
    state_t state;
    motion_at(&r->motion, t_s, &state);
    motion_point(&state, r->s->lever_b, r_e, v_e);
}

static void base_antenna(void *context, double t_s, double r_e[3], double v_e[3])
{
    const run_t *r = context;
    (void)t_s;
    memcpy(r_e, r->s->base_r_e, sizeof r->s->base_r_e);
    memset(v_e, 0, 3 * sizeof *v_e);
}

/* ---- what each source sends ------------------------------------------------------------------------------------------ */

static bool send_truth(run_t *r, double t_s)
{
    state_t state;
    pelorus_truth_t truth = {.t_ns = gps_time(r, t_s)};
    motion_at(&r->motion, t_s, &state);
    memcpy(truth.r_eb_e, state.r_eb_e, sizeof truth.r_eb_e);
    memcpy(truth.v_eb_e, state.v_eb_e, sizeof truth.v_eb_e);
    memcpy(truth.C_b_e, state.C_b_e, sizeof truth.C_b_e);
    memcpy(truth.omega_ib_b, state.omega_ib_b, sizeof truth.omega_ib_b);
    memcpy(truth.f_ib_b, state.f_ib_b, sizeof truth.f_ib_b);
    if (r->s->imu.present) { imu_sim_errors(&r->imu, truth.b_g, truth.b_a); }
    const int n = pelorus_truth_t_encode(r->buffer, 0, (int)sizeof r->buffer, &truth);
    return n > 0 && send(r, LINE_TRUTH, t_s, (size_t)n);
}

/* All samples that end by t_end, in one event. */
static bool send_imu(run_t *r, double t_end_s)
{
    const int64_t interval = r->s->imu.interval_ns;
    const pel_time_t end = gps_time(r, t_end_s);
    size_t used = 0;
    while (r->s->start_ns + (r->imu_k + 1) * interval <= end) {
        double alpha[3];
        double upsilon[3];
        pel_imu_t sample;
        const double t0 = 1e-9 * (double)(r->imu_k * interval);
        const double t1 = 1e-9 * (double)((r->imu_k + 1) * interval);
        motion_increment(&r->motion, t0, t1, alpha, upsilon);
        r->imu_k++;
        imu_sim_step(&r->imu, r->s->start_ns + r->imu_k * interval, alpha, upsilon, &sample);
        const size_t n = pel_imu_encode(&sample, r->buffer + used, sizeof r->buffer - used);
        if (n == 0) { return false; }
        used += n;
        r->counts.imu_samples++;
    }
    return send(r, LINE_IMU, t_end_s, used);
}

/* The epoch as the receiver's own format; 0 bytes where nothing is tracked. */
static size_t encode_epoch(const pel_epoch_t *e, format_t format, uint16_t station, uint8_t *out, size_t cap)
{
    if (e->n == 0) { return 0; }
    if (format == FORMAT_UBX) { return pel_ubx_encode_rawx(e, pel_time_leap_s(e->t_ns), out, cap); }
    int left[PEL_N_SYS] = {0};
    int systems = 0;
    for (int i = 0; i < e->n; i++) {
        if (left[e->obs[i].sys]++ == 0) { systems++; }
    }
    size_t used = 0;
    for (int sys = 0; sys < PEL_N_SYS; sys++) {
        if (left[sys] == 0) { continue; }
        systems--;
        used += pel_rtcm3_encode_msm(e, (pel_sys_t)sys, 7, station, systems > 0, out + used, cap - used);
    }
    return used;
}

static bool send_epoch(run_t *r, receiver_t *receiver, int line, format_t format)
{
    const double t_s = receiver_next_s(receiver);
    receiver_epoch(receiver, &r->epoch);
    const size_t n = encode_epoch(&r->epoch, format, r->s->station_id, r->buffer, sizeof r->buffer);
    return send(r, line, t_s, n);
}

static double elevation(run_t *r, const sat_t *sat, antenna_t antenna, double t_s)
{
    double r_a[3];
    double v_a[3];
    double llh[3];
    double u[3];
    double az;
    double el;
    sat_state_t state;
    antenna(r, t_s, r_a, v_a);
    world_ecef_to_llh(r_a, llh);
    sky_state(sat, gps_time(r, t_s), 0.0, &state);
    for (int i = 0; i < 3; i++) { u[i] = state.r_e[i] - r_a[i]; }
    const double range = sqrt(dot(u, u));
    for (int i = 0; i < 3; i++) { u[i] /= range; }
    world_azel(llh[0], llh[1], u, &az, &el);
    return el;
}

/* One satellite's ephemeris: subframes as a receiver passes them on, or an RTCM message. */
static size_t encode_ephemeris(const pel_ephemeris_t *e, format_t format, pel_time_t t, uint8_t *out, size_t cap)
{
    const int parts = (format == FORMAT_UBX) ? pel_ubx_sfrbx_parts(e) : 0;
    if (parts == 0) { return pel_rtcm3_encode_ephemeris(e, out, cap); }
    size_t used = 0;
    for (int p = 1; p <= parts; p++) { used += pel_ubx_encode_sfrbx_eph(e, p, t, out + used, cap - used); }
    return used;
}

static bool send_ephemerides(run_t *r, antenna_t antenna, int line, format_t format, double t_s)
{
    const pel_time_t t = gps_time(r, t_s);
    const atmosphere_t *air = &r->s->air;
    bool klobuchar = !air->klobuchar.valid || format != FORMAT_UBX; /* sent, or not to be sent */
    for (int i = 0; i < r->sky.n; i++) {
        const sat_t *sat = &r->sky.sats[i];
        if (elevation(r, sat, antenna, t_s) < RISING) { continue; }
        pel_ephemeris_t e;
        sky_ephemeris(sat, t, &e);
        size_t n = encode_ephemeris(&e, format, t, r->buffer, sizeof r->buffer);
        if (!klobuchar && e.sys == PEL_SYS_GPS) {
            n += pel_ubx_encode_sfrbx_klobuchar(&air->klobuchar, e.prn, t, r->buffer + n, sizeof r->buffer - n);
            klobuchar = true;
        }
        if (!send(r, line, t_s, n)) { return false; }
        r->counts.ephemerides++;
    }
    return true;
}

static bool send_station(run_t *r, double t_s)
{
    pel_station_t station = {.id = r->s->station_id};
    memcpy(station.r_ea_e, r->s->base_r_e, sizeof station.r_ea_e);
    return send(r, LINE_BASE, t_s, pel_rtcm3_encode_station(&station, 1006, r->buffer, sizeof r->buffer));
}

static bool send_marks(run_t *r, double t_end_s)
{
    while (r->mark_k < r->s->n_events) {
        const double t_s = r->s->event_first_s + (double)r->mark_k * r->s->event_interval_s;
        if (t_s > t_end_s) { break; }
        const pel_time_t tag = gps_time(r, t_s + r->s->event_sd_s * rng_normal(&r->marks));
        const size_t n = pel_event_mark_encode(tag, (uint32_t)r->mark_k, r->buffer, sizeof r->buffer);
        if (!send(r, LINE_MARKS, t_s, n)) { return false; }
        r->mark_k++;
        r->counts.marks++;
    }
    return true;
}

/* Heights at whole multiples of the interval since the start, on the IMU's line. */
static bool send_heights(run_t *r, double t_end_s)
{
    const barometer_config_t *b = &r->s->barometer;
    const double interval_s = 1e-9 * (double)b->interval_ns;
    for (; b->present && (double)r->baro_k * interval_s <= t_end_s; r->baro_k++) {
        const double t_s = (double)r->baro_k * interval_s;
        state_t state;
        motion_at(&r->motion, t_s, &state);
        r->weather_m = (r->baro_k == 0)
                           ? b->markov_m * rng_normal(&r->weather)
                           : rng_markov(&r->weather, r->weather_m, b->markov_m, b->markov_tau_s, interval_s);
        const pel_baro_t sample = {.t_ns = gps_time(r, t_s),
                                   .height_m = state.llh[2] + r->weather_m + b->noise_m * rng_normal(&r->weather),
                                   .sd_m = (float)b->noise_m,
                                   .seq = (uint16_t)r->baro_k};
        if (!send(r, LINE_IMU, t_s, pel_baro_encode(&sample, r->buffer, sizeof r->buffer))) { return false; }
    }
    return true;
}

/* Truth at whole multiples of its interval in GPS time. */
static bool send_truths(run_t *r, double t_end_s)
{
    const int64_t interval = (int64_t)llround(1e9 * r->s->truth_interval_s);
    for (;;) {
        const double t_s = 1e-9 * (double)(r->truth_k * interval - r->s->start_ns);
        if (t_s > t_end_s) { return true; }
        if (!send_truth(r, t_s)) { return false; }
        r->truth_k++;
    }
}

/* ---- the run ------------------------------------------------------------------------------------------------------------- */

static bool slice(run_t *r, double t_end_s)
{
    const scenario_t *s = r->s;
    bool ok = true;
    if (t_end_s > r->ephemerides_s) {
        const double t_s = r->ephemerides_s;
        if (s->rover.present) { ok = send_ephemerides(r, rover_antenna, LINE_ROVER, FORMAT_UBX, t_s); }
        if (ok && s->base.present && s->base_ephemerides) {
            ok = send_ephemerides(r, base_antenna, LINE_BASE, s->base_format, t_s);
        }
        r->ephemerides_s += s->ephemeris_interval_s;
    }
    if (ok && s->base.present && t_end_s > r->station_s) {
        ok = send_station(r, r->station_s);
        r->station_s += STATION_S;
    }
    if (ok && s->imu.present) { ok = send_imu(r, t_end_s); }
    ok = ok && send_heights(r, t_end_s);
    while (ok && s->rover.present && receiver_next_s(&r->rover) <= t_end_s) {
        ok = send_truths(r, receiver_next_s(&r->rover)) && send_truth(r, receiver_next_s(&r->rover)) &&
             send_epoch(r, &r->rover, LINE_ROVER, FORMAT_UBX);
        r->counts.rover_epochs++;
    }
    while (ok && s->base.present && receiver_next_s(&r->base) <= t_end_s) {
        ok = send_epoch(r, &r->base, LINE_BASE, s->base_format);
        r->counts.base_epochs++;
    }
    return ok && send_marks(r, t_end_s) && send_truths(r, t_end_s) && streams_until(&r->out, gps_time(r, t_end_s));
}

static bool prepare(run_t *r, const scenario_t *s, sink_t sink, void *context)
{
    static const line_config_t ideal = {0.0, 0.0, 0.0, 0.0};
    const line_config_t mark_line = {.latency_s = 0.002};
    r->s = s;
    streams_init(&r->out, sink, context);
    if (!motion_init(&r->motion, &s->motion, s->segments, s->n_segments)) { return false; }
    sky_init(&r->sky, &s->sky, s->start_ns, s->seed);
    if (s->imu.present) { imu_sim_init(&r->imu, &s->imu, s->seed); }
    if (s->rover.present) {
        receiver_init(&r->rover, &s->rover, &r->sky, &s->air, rover_antenna, r, s->start_ns, s->seed, ROVER);
    }
    if (s->base.present) {
        receiver_init(&r->base, &s->base, &r->sky, &s->air, base_antenna, r, s->start_ns, s->seed, BASE);
    }
    line_init(&r->line[LINE_IMU], CAPTURE_UART_IMU, &s->imu_line, s->seed, LINE_IMU);
    line_init(&r->line[LINE_ROVER], CAPTURE_UART_ROVER, &s->rover_line, s->seed, LINE_ROVER);
    line_init(&r->line[LINE_BASE], CAPTURE_UART_BASE, &s->base_line, s->seed, LINE_BASE);
    line_init(&r->line[LINE_MARKS], CAPTURE_UART_AUX1, &mark_line, s->seed, LINE_MARKS);
    line_init(&r->line[LINE_TRUTH], CAPTURE_TRUTH, &ideal, s->seed, LINE_TRUTH);
    rng_init(&r->marks, s->seed, CAUSE_MARKS);
    rng_init(&r->weather, s->seed, CAUSE_BAROMETER);
    const int64_t truth_interval = (int64_t)llround(1e9 * s->truth_interval_s);
    r->truth_k = (s->start_ns + truth_interval - 1) / truth_interval;
    return true;
}

bool simulate_run(const scenario_t *s, sink_t sink, void *sink_context, progress_t progress, void *progress_context,
                  simulate_counts_t *counts)
{
    run_t *r = calloc(1, sizeof *r);
    if (r == NULL) { return false; }
    bool ok = prepare(r, s, sink, sink_context);
    const int64_t slices = (int64_t)ceil(s->duration_s * 1e9 / SLICE_NS);
    for (int64_t i = 1; ok && i <= slices; i++) {
        ok = slice(r, fmin(1e-9 * (double)(i * SLICE_NS), s->duration_s));
        if (i % 100 == 0) { progress(progress_context, (double)i / (double)slices); }
    }
    ok = ok && streams_until(&r->out, INT64_MAX); /* what is still on its way */
    r->counts.lost = r->out.lost;
    r->counts.damaged = r->out.damaged;
    *counts = r->counts;
    streams_free(&r->out);
    motion_free(&r->motion);
    free(r);
    return ok;
}

bool simulate_start_attitude(const scenario_t *s, double attitude[3])
{
    rng_t rng;
    double C[3][3];
    double turned[3][3];
    motion_t motion;
    state_t start;
    if (!motion_init(&motion, &s->motion, s->segments, s->n_segments)) { return false; }
    motion_at(&motion, 0.0, &start);
    motion_free(&motion);
    rng_init(&rng, s->seed, CAUSE_START);
    const double psi[3] = {s->sd_tilt * rng_normal(&rng), s->sd_tilt * rng_normal(&rng),
                           s->sd_heading * rng_normal(&rng)};
    world_C_b_n(start.roll, start.pitch, start.heading, C);
    for (int j = 0; j < 3; j++) { /* C~ = (I + [psi x]) C; its Euler angles need no normalisation */
        const double column[3] = {C[0][j], C[1][j], C[2][j]};
        double moved[3];
        cross(psi, column, moved);
        for (int i = 0; i < 3; i++) { turned[i][j] = column[i] + moved[i]; }
    }
    world_attitude(turned, attitude);
    return true;
}

/* trial.c - the firmware's loop over a capture in memory, its outputs held against truth and against the undisturbed life. */
#include "trial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "capture_log.h"
#include "desktop.h"
#include "pelorus/bits.h"
#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "pelorus_truth_t.h"

#define WARM_S        12.0 /* the state is what it is in operation */
#define MOMENTS_S     3.0  /* flips happen within so many seconds after that */
#define N_MOMENTS     48
#define LIFE_S        8.0 /* and are watched for so long after the last of them */
#define MAX_EVENTS    20000
#define MAX_TRUTH     1000
#define MAX_OUTPUTS   1000
#define BOUND_SIGMAS  5.33
#define TRUTH_NEAR_NS (2 * PEL_NS_PER_MS)

typedef struct {
    char line; /* I, R, B */
    int64_t t_us;
    uint8_t *data;
    size_t n;
} event_t;

typedef struct {
    uint32_t hash;
    int rank;
} output_t;

static event_t events[MAX_EVENTS];
static pelorus_truth_t truth[MAX_TRUTH];
static int n_events, n_truth;
static state_t state, checkpoint[N_MOMENTS];
static int moment_event[N_MOMENTS], last_event;
static output_t outputs[MAX_OUTPUTS]; /* of the undisturbed life, from the first moment on */
static int n_outputs, outputs_before[N_MOMENTS];
static double undisturbed_share;

/* ---- the capture ------------------------------------------------------------------------------------------------------- */

static void keep_event(char line, const capture_event_t *e)
{
    if (n_events == MAX_EVENTS) { return; }
    event_t *to = &events[n_events++];
    to->line = line;
    to->t_us = e->t_us;
    to->n = e->n;
    to->data = malloc(e->n);
    if (to->data == NULL) { exit(3); }
    memcpy(to->data, e->data, e->n);
}

static bool read_capture(const char *path, pel_nav_config_t *cfg)
{
    capture_log_t log;
    capture_event_t e;
    char why[256];
    if (!capture_log_open(&log, path)) { return false; }
    while (capture_log_read(&log, &e)) {
        if (strcmp(e.channel, CAPTURE_SETUP) == 0) {
            char *text = calloc(1, e.n + 1);
            if (text == NULL) { return false; }
            memcpy(text, e.data, e.n);
            const int code = desktop_config_from_text(text, "SETUP", cfg, why, sizeof why);
            free(text);
            if (code != 0) { return false; }
        } else if (strcmp(e.channel, CAPTURE_TRUTH) == 0 && n_truth < MAX_TRUTH) {
            if (pelorus_truth_t_decode(e.data, 0, (int)e.n, &truth[n_truth]) > 0) { n_truth++; }
        } else if (strncmp(e.channel, "UART_", 5) == 0) {
            keep_event(e.channel[5], &e);
        }
    }
    return capture_log_close(&log) && n_truth > 0 && n_events > 0;
}

/* ---- the firmware's loop, as in hal/main.c --------------------------------------------------------------------------------- */

static void push_receiver(state_t *s, pel_receiver_t *rx, bool is_base, pel_rx_event_t event)
{
    switch (event) {
    case PEL_RX_EPHEMERIS: pel_navigator_push_ephemeris(&s->nav, &rx->ephemeris); break;
    case PEL_RX_KLOBUCHAR: pel_navigator_push_klobuchar(&s->nav, &rx->klobuchar); break;
    case PEL_RX_STATION:
        if (is_base) { pel_navigator_push_station(&s->nav, &rx->station); }
        break;
    case PEL_RX_EPOCH:
        pel_receiver_set_time(is_base ? &s->rover : &s->base, rx->epoch.t_ns);
        if (is_base) {
            pel_navigator_push_base(&s->nav, &rx->epoch);
        } else {
            pel_navigator_push_rover(&s->nav, &rx->epoch);
        }
        break;
    case PEL_RX_NONE:
    case PEL_RX_PVT: break;
    }
}

static void push_byte(state_t *s, char line, uint8_t byte)
{
    if (line == 'I') {
        if (pel_imu_stream_push(&s->imu, byte) == PEL_IMU_SAMPLE) { pel_navigator_push_imu(&s->nav, &s->imu.imu); }
    } else if (line == 'R') {
        push_receiver(s, &s->rover, false, pel_receiver_push(&s->rover, byte));
    } else if (line == 'B') {
        push_receiver(s, &s->base, true, pel_receiver_push(&s->base, byte));
    }
}

/* ---- an output against truth ------------------------------------------------------------------------------------------------- */

static const pelorus_truth_t *truth_at(pel_time_t t_ns)
{
    for (int i = 0; i < n_truth; i++) {
        const int64_t off = t_ns - truth[i].t_ns;
        if (off > -TRUTH_NEAR_NS && off < TRUTH_NEAR_NS) { return &truth[i]; }
    }
    return NULL;
}

static double worse(double a, double b)
{
    return (a >= b) ? a : b; /* NaN in b wins, once there it stays: a >= b is false */
}

static double attitude_share(const pel_solution_t *s, const double C_true_e[3][3], const double C_e_n[3][3])
{
    double C_b_e[3][3], turn[3][3], psi_e[3], psi_n[3], share = 0.0;
    const int diagonal[3] = {0, 3, 5};
    pel_attitude_to_C_b_e((double)s->roll_rad, (double)s->pitch_rad, (double)s->heading_rad, s->lat_rad, s->lon_rad,
                          C_b_e);
    pel_mat3_mult(C_b_e, C_true_e, turn);
    pel_dcm_to_rotvec(turn, psi_e);
    pel_mat3_vec(C_e_n, psi_e, psi_n);
    for (int k = 0; k < 3; k++) {
        share = worse(share, fabs(psi_n[k]) / (BOUND_SIGMAS * sqrt((double)s->cov_att[diagonal[k]])));
    }
    return share;
}

/* Largest error over its bound. Solutions where there is no truth are of another time: beyond any bound. */
static double share_of_bound(const pel_solution_t *s, const char **what)
{
    if (s->fix == PEL_FIX_NONE) { return 0.0; }
    const pelorus_truth_t *t = truth_at(s->t_ns);
    if (t == NULL) {
        *what = "time";
        return INFINITY;
    }
    const double dt_s = (double)(s->t_ns - t->t_ns) * 1e-9;
    const int diagonal[3] = {0, 3, 5};
    double C_e_n[3][3], C[3][3], lever_e[3] = {0}, rate_e[3] = {0}, dr_e[3], d[3], v_n[3], v_e[3];
    for (int i = 0; i < 9; i++) { C[i / 3][i % 3] = t->C_b_e[i]; }
    if ((s->flags & PEL_SOL_INS) == 0) { /* then it is the antenna's */
        double omega_e[3];
        pel_mat3_vec(C, state.nav.cfg.lever_ba_b, lever_e);
        pel_mat3_vec(C, t->omega_ib_b, omega_e);
        omega_e[2] -= PEL_OMEGA_IE;
        pel_cross3(omega_e, lever_e, rate_e);
    }
    pel_earth_C_e_n(s->lat_rad, s->lon_rad, C_e_n);
    for (int k = 0; k < 3; k++) {
        v_e[k] = t->v_eb_e[k] + rate_e[k];
        dr_e[k] = s->r_eb_e[k] - t->r_eb_e[k] - lever_e[k] - v_e[k] * dt_s;
    }
    pel_mat3_vec(C_e_n, dr_e, d);
    pel_mat3_vec(C_e_n, v_e, v_n);
    const double shares[2] = {hypot(d[0], d[1]) / (double)s->hpl_m, fabs(d[2]) / (double)s->vpl_m};
    double share = worse(worse(0.0, shares[0]), shares[1]);
    *what = "position";
    if (!(share <= 1.0)) { return share; }
    for (int k = 0; k < 3; k++) {
        share =
            worse(share, fabs((double)s->v_ned[k] - v_n[k]) / (BOUND_SIGMAS * sqrt((double)s->cov_v_ned[diagonal[k]])));
    }
    *what = "velocity";
    if (!(share <= 1.0)) { return share; }
    *what = "attitude";
    return ((s->flags & PEL_SOL_HEADING) != 0) ? worse(share, attitude_share(s, C, C_e_n)) : share;
}

static int rank_of(const pel_solution_t *s)
{
    static const int RANK[5] = {0, 2, 3, 4, 1};
    return 2 * ((s->fix < 5) ? RANK[s->fix] : 0) + ((s->flags & PEL_SOL_INS) ? 1 : 0);
}

static output_t seen(const pel_solution_t *s)
{
    uint8_t frame[512];
    const size_t n = pel_out_encode_solution(s, frame, sizeof frame);
    return (output_t){pel_fnv1a(frame, n, PEL_FNV_START), rank_of(s)};
}

/* ---- lives --------------------------------------------------------------------------------------------------------------------- */

typedef struct {
    int n;        /* outputs told */
    bool same;    /* all equal to the undisturbed life's */
    double share; /* largest */
    const char *what;
    int rank; /* of the last */
    bool record;
} life_t;

static void take_outputs(state_t *s, life_t *life)
{
    for (int guard = 0; guard < 8; guard++) {
        const pel_nav_output_t out = pel_navigator_poll(&s->nav);
        if (out == PEL_NAV_NONE) { return; }
        if (out != PEL_NAV_SOLUTION && out != PEL_NAV_EPOCH) { continue; }
        const pel_solution_t *sol = (out == PEL_NAV_EPOCH) ? &s->nav.epoch_solution : &s->nav.solution;
        const char *what = "";
        const double share = share_of_bound(sol, &what);
        if (!(share <= life->share)) {
            life->share = share;
            life->what = what;
        }
        const output_t o = seen(sol);
        life->rank = o.rank;
        if (life->record && n_outputs < MAX_OUTPUTS) { outputs[n_outputs++] = o; }
        if (!life->record && (life->n >= n_outputs || outputs[life->n].hash != o.hash)) { life->same = false; }
        life->n++;
    }
}

static void live(state_t *s, int from, int to, life_t *life)
{
    for (int i = from; i < to; i++) {
        for (size_t k = 0; k < events[i].n; k++) { push_byte(s, events[i].line, events[i].data[k]); }
        take_outputs(s, life);
        if (!life->record && !(life->share <= 1.0)) { return; }
    }
}

static int event_at(double t_s)
{
    int i = 0;
    while (i < n_events && (double)(events[i].t_us - events[0].t_us) * 1e-6 < t_s) { i++; }
    return i;
}

bool trial_prepare(const char *capture)
{
    pel_nav_config_t cfg;
    pel_nav_config_default(&cfg);
    if (!read_capture(capture, &cfg)) {
        fprintf(stderr, "pelorus-flips: cannot read %s\n", capture);
        return false;
    }
    memset(&state, 0, sizeof state);
    pel_navigator_init(&state.nav, &cfg);
    pel_imu_stream_init(&state.imu);
    pel_receiver_init(&state.rover);
    pel_receiver_init(&state.base);
    pel_receiver_set_time(&state.base, truth[0].t_ns);
    life_t life = {.record = true, .what = ""};
    int at = 0;
    for (int m = 0; m < N_MOMENTS; m++) {
        const int next = event_at(WARM_S + MOMENTS_S * m / N_MOMENTS);
        live(&state, at, next, &life);
        if (m == 0) { n_outputs = 0; } /* what was told while warming up is not compared */
        outputs_before[m] = n_outputs;
        checkpoint[m] = state;
        moment_event[m] = at = next;
    }
    last_event = event_at(WARM_S + MOMENTS_S + LIFE_S);
    live(&state, at, last_event, &life);
    undisturbed_share = life.share;
    if (!(life.share <= 1.0) || life.rank != 9) {
        fprintf(stderr, "pelorus-flips: undisturbed, %s error is %.2f of its bound, last status %d\n", life.what,
                life.share, life.rank);
        return false;
    }
    return true;
}

double trial_undisturbed_share(void)
{
    return undisturbed_share;
}

int trial_n_moments(void)
{
    return N_MOMENTS;
}

verdict_t trial_run(int moment, size_t bit, const char **what)
{
    memcpy(&state, &checkpoint[moment], sizeof state);
    ((uint8_t *)&state)[bit / 8] ^= (uint8_t)(1u << (bit % 8));
    life_t life = {.n = outputs_before[moment], .same = true, .what = ""};
    live(&state, moment_event[moment], last_event, &life);
    *what = life.what;
    if (!(life.share <= 1.0)) { return SILENT; }
    if (life.same && life.n == n_outputs) { return MASKED; }
    return (life.n > outputs_before[moment] && life.rank >= 9 && n_outputs - life.n <= 2) ? RECOVERED : STOPPED;
}

/* motion.c - see motion.h. */
#include "motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "world.h"

#define NODE_S      0.1 /* spacing of integrated places */
#define WAVE_FADE_S 5.0
#define GRAVITY     9.80665 /* of the coordinated bank alone */

/* A quantity and its first two derivatives. */
typedef struct {
    double x, d, dd;
} jet_t;

/* Quintic step from 0 to 1 over [0, duration] at time t, times `height`. */
static jet_t quintic(double t, double duration, double height)
{
    jet_t s = {0.0, 0.0, 0.0};
    if (!(duration > 0.0) || t <= 0.0) { return s; }
    const double u = t / duration;
    if (u >= 1.0) {
        s.x = height;
        return s;
    }
    s.x = height * u * u * u * (10.0 + u * (6.0 * u - 15.0));
    s.d = height * 30.0 * u * u * (1.0 - u) * (1.0 - u) / duration;
    s.dd = height * 60.0 * u * (1.0 - u) * (1.0 - 2.0 * u) / (duration * duration);
    return s;
}

static const piece_t *piece_at(const motion_t *m, double t)
{
    int low = 0;
    int high = m->n_pieces - 1;
    while (low < high) {
        const int mid = (low + high + 1) / 2;
        if (m->pieces[mid].t0 <= t) {
            low = mid;
        } else {
            high = mid - 1;
        }
    }
    return &m->pieces[low];
}

static jet_t from(double start, jet_t step)
{
    step.x += start;
    return step;
}

static jet_t course_in(const piece_t *p, double t)
{
    return from(p->course, quintic(t - p->t0, p->to.duration_s, p->to.turn));
}

static jet_t speed_in(const piece_t *p, double t)
{
    return from(p->speed, quintic(t - p->t0, p->to.duration_s, p->to.speed_change));
}

static jet_t height_in(const piece_t *p, double t)
{
    return from(p->height, quintic(t - p->t0, p->to.duration_s, p->to.climb));
}

/* East and north travelled on the map over [t0, t1] within a piece: 3-point Gauss. Over 0.1 s of a car turning at 1 rad/s
 * the error is 1e-12 m. */
static void travel(const piece_t *p, double t0, double t1, double en[2])
{
    static const double x[3] = {-0.7745966692414834, 0.0, 0.7745966692414834};
    static const double w[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    const double h = t1 - t0;
    en[0] = 0.0;
    en[1] = 0.0;
    for (int i = 0; i < 3; i++) {
        const double t = t0 + 0.5 * h * (1.0 + x[i]);
        const double course = course_in(p, t).x;
        const double step = w[i] * h * speed_in(p, t).x;
        en[0] += step * sin(course);
        en[1] += step * cos(course);
    }
}

static int nodes_of(double duration_s)
{
    return (int)ceil(duration_s / NODE_S) + 1;
}

/* Start values of each piece from the end of the one before; then places at the nodes. */
bool motion_init(motion_t *m, const motion_config_t *cfg, const segment_t *segments, int n)
{
    memset(m, 0, sizeof *m);
    m->cfg = *cfg;
    m->pieces = calloc((size_t)n + 1u, sizeof *m->pieces);
    if (m->pieces == NULL) { return false; }
    piece_t at = {.speed = cfg->speed, .course = cfg->heading, .height = cfg->llh[2]};
    for (int i = 0; i < n; i++) {
        at.to = segments[i];
        at.n_nodes = nodes_of(at.to.duration_s);
        m->pieces[i] = at;
        at.t0 += at.to.duration_s;
        at.speed += at.to.speed_change;
        at.course += at.to.turn;
        at.height += at.to.climb;
        at.first_node += at.n_nodes;
    }
    m->end_s = at.t0;
    at.to =
        (segment_t){.duration_s = 1e9}; /* what happens beyond the end: straight on, integrated from its first node */
    at.n_nodes = 1;
    m->pieces[n] = at;
    m->n_pieces = n + 1;
    m->n_nodes = at.first_node + 1;
    m->node = calloc((size_t)m->n_nodes, sizeof *m->node);
    if (m->node == NULL) {
        motion_free(m);
        return false;
    }

    double place[2] = {0.0, 0.0};
    for (int i = 0; i < m->n_pieces; i++) {
        const piece_t *p = &m->pieces[i];
        for (int k = 0; k < p->n_nodes; k++) {
            memcpy(m->node[p->first_node + k], place, sizeof place);
            if (k + 1 < p->n_nodes) {
                const double step = p->to.duration_s / (p->n_nodes - 1);
                double en[2];
                travel(p, p->t0 + k * step, p->t0 + (k + 1) * step, en);
                place[0] += en[0];
                place[1] += en[1];
            }
        }
    }
    const double s = sin(cfg->llh[0]);
    const double rn = WORLD_A / sqrt(1.0 - WORLD_E2 * s * s);
    m->scale_north = rn * (1.0 - WORLD_E2) / (1.0 - WORLD_E2 * s * s) + cfg->llh[2];
    m->scale_east = (rn + cfg->llh[2]) * cos(cfg->llh[0]);
    return true;
}

void motion_free(motion_t *m)
{
    free(m->pieces);
    free(m->node);
    memset(m, 0, sizeof *m);
}

/* Place on the map: from the last node before t. */
static void place_at(const motion_t *m, const piece_t *p, double t, double en[2])
{
    int k = 0;
    double start = p->t0;
    if (p->n_nodes > 1) {
        const double step = p->to.duration_s / (p->n_nodes - 1);
        k = (int)((t - p->t0) / step);
        k = (k < 0) ? 0 : (k > p->n_nodes - 1) ? p->n_nodes - 1 : k;
        start += k * step;
    }
    travel(p, start, t, en);
    en[0] += m->node[p->first_node + k][0];
    en[1] += m->node[p->first_node + k][1];
}

/* How strong waves are: V^2 / (V^2 + V0^2), fading in after the delay. */
static jet_t wave_strength(const motion_t *m, double t, jet_t v)
{
    const double v0 = m->cfg.wave_speed;
    jet_t s = {1.0, 0.0, 0.0};
    if (v0 > 0.0) {
        const double q = v.x * v.x + v0 * v0;
        const double g = 2.0 * v0 * v0 * v.x / (q * q); /* ds/dV */
        const double gg = 2.0 * v0 * v0 * (q - 4.0 * v.x * v.x) / (q * q * q);
        s = (jet_t){v.x * v.x / q, g * v.d, gg * v.d * v.d + g * v.dd};
    }
    if (m->cfg.wave_delay_s > 0.0) {
        const jet_t f = quintic(t - m->cfg.wave_delay_s, WAVE_FADE_S, 1.0);
        s = (jet_t){s.x * f.x, s.d * f.x + s.x * f.d, s.dd * f.x + 2.0 * s.d * f.d + s.x * f.dd};
    }
    return s;
}

static void add_waves(const motion_t *m, double t, jet_t v, jet_t sum[6])
{
    if (m->cfg.n_waves == 0) { return; }
    const jet_t s = wave_strength(m, t, v);
    for (int i = 0; i < m->cfg.n_waves; i++) {
        const wave_t *w = &m->cfg.waves[i];
        const double omega = WORLD_TWO_PI * w->rate_hz;
        const double a = w->amplitude * sin(omega * t + w->phase);
        const double b = w->amplitude * cos(omega * t + w->phase) * omega;
        jet_t *to = &sum[w->axis];
        to->x += s.x * a;
        to->d += s.d * a + s.x * b;
        to->dd += s.dd * a + 2.0 * s.d * b - s.x * omega * omega * a;
    }
}

/* Geodetic rates on the ellipsoid: velocity and its derivative in local axes, transport rate (all east-north-up). */
static void local_motion(const double llh[3], const double rate[3], const double accel[3], double v[3], double dv[3],
                         double omega_en[3])
{
    const double s = sin(llh[0]);
    const double c = cos(llh[0]);
    const double q = 1.0 - WORLD_E2 * s * s;
    const double rn = WORLD_A / sqrt(q);
    const double rm = rn * (1.0 - WORLD_E2) / q;
    const double drn = rn * WORLD_E2 * s * c / q; /* per rad of latitude */
    const double drm = 3.0 * rm * WORLD_E2 * s * c / q;
    const double h = llh[2];
    v[0] = (rn + h) * c * rate[1];
    v[1] = (rm + h) * rate[0];
    v[2] = rate[2];
    dv[0] = ((drn * rate[0] + rate[2]) * c - (rn + h) * s * rate[0]) * rate[1] + (rn + h) * c * accel[1];
    dv[1] = (drm * rate[0] + rate[2]) * rate[0] + (rm + h) * accel[0];
    dv[2] = accel[2];
    omega_en[0] = -rate[0];
    omega_en[1] = rate[1] * c;
    omega_en[2] = rate[1] * s;
}

/* Attitude and the body's rate with respect to local axes. */
static void attitude(const motion_t *m, jet_t course, jet_t v, jet_t h, const jet_t wave[6], state_t *out,
                     double omega_nb_b[3])
{
    double roll = m->cfg.roll + wave[WAVE_ROLL].x;
    double pitch = m->cfg.pitch + wave[WAVE_PITCH].x;
    double d_roll = wave[WAVE_ROLL].d;
    double d_pitch = wave[WAVE_PITCH].d;
    const double d_heading = course.d + wave[WAVE_YAW].d;
    if (m->cfg.bank) {
        const double x = v.x * course.d / GRAVITY;
        roll += atan(x);
        d_roll += (v.d * course.d + v.x * course.dd) / GRAVITY / (1.0 + x * x);
    }
    if (m->cfg.pitch_along_path) { /* regularised below 1 m/s, where a path has no direction */
        const double w = sqrt(v.x * v.x + 1.0);
        pitch += atan2(h.d, w);
        d_pitch += (h.dd * w - h.d * v.x * v.d / w) / (w * w + h.d * h.d);
    }
    out->roll = roll;
    out->pitch = pitch;
    out->heading = course.x + wave[WAVE_YAW].x;
    omega_nb_b[0] = d_pitch * cos(roll) + d_heading * cos(pitch) * sin(roll);
    omega_nb_b[1] = d_roll - d_heading * sin(pitch);
    omega_nb_b[2] = d_pitch * sin(roll) - d_heading * cos(pitch) * cos(roll);
}

void motion_at(const motion_t *m, double t, state_t *out)
{
    const piece_t *p = piece_at(m, t);
    const jet_t course = course_in(p, t);
    const jet_t v = speed_in(p, t);
    const jet_t h = height_in(p, t);
    const double sc = sin(course.x);
    const double cc = cos(course.x);
    jet_t wave[6] = {{0.0, 0.0, 0.0}};
    add_waves(m, t, v, wave);

    double en[2];
    place_at(m, p, t, en);
    const double east_d = v.x * sc + wave[WAVE_EAST].d;
    const double north_d = v.x * cc + wave[WAVE_NORTH].d;
    const double east_dd = v.d * sc + v.x * cc * course.d + wave[WAVE_EAST].dd;
    const double north_dd = v.d * cc - v.x * sc * course.d + wave[WAVE_NORTH].dd;
    out->llh[0] = m->cfg.llh[0] + (en[1] + wave[WAVE_NORTH].x) / m->scale_north;
    out->llh[1] = m->cfg.llh[1] + (en[0] + wave[WAVE_EAST].x) / m->scale_east;
    out->llh[2] = h.x + wave[WAVE_UP].x;
    const double rate[3] = {north_d / m->scale_north, east_d / m->scale_east, h.d + wave[WAVE_UP].d};
    const double accel[3] = {north_dd / m->scale_north, east_dd / m->scale_east, h.dd + wave[WAVE_UP].dd};

    double dv[3];
    double omega_en[3];
    double turning[3];
    local_motion(out->llh, rate, accel, out->v_enu, dv, omega_en);
    cross(omega_en, out->v_enu, turning);
    for (int i = 0; i < 3; i++) { dv[i] += turning[i]; }

    double C_n_e[3][3];
    double C_b_n[3][3];
    double omega_nb_b[3];
    world_llh_to_ecef(out->llh, out->r_eb_e);
    world_C_n_e(out->llh[0], out->llh[1], C_n_e);
    rotate(C_n_e, out->v_enu, out->v_eb_e);
    rotate(C_n_e, dv, out->a_eb_e);
    attitude(m, course, v, h, wave, out, omega_nb_b);
    world_C_b_n(out->roll, out->pitch, out->heading, C_b_n);
    multiply(C_n_e, C_b_n, out->C_b_e);

    double omega_en_b[3];
    rotate_back(C_b_n, omega_en, omega_en_b);
    double g[3];
    world_gravity(out->r_eb_e, g);
    const double f_e[3] = {out->a_eb_e[0] - 2.0 * WORLD_OMEGA * out->v_eb_e[1] - g[0],
                           out->a_eb_e[1] + 2.0 * WORLD_OMEGA * out->v_eb_e[0] - g[1], out->a_eb_e[2] - g[2]};
    rotate_back(out->C_b_e, f_e, out->f_ib_b);
    for (int i = 0; i < 3; i++) {
        out->omega_eb_b[i] = omega_nb_b[i] + omega_en_b[i];
        out->omega_ib_b[i] = out->omega_eb_b[i] + WORLD_OMEGA * out->C_b_e[2][i];
    }
}

void motion_point(const state_t *s, const double lever_b[3], double r_e[3], double v_e[3])
{
    double arm[3];
    double swing_b[3];
    double swing[3];
    rotate(s->C_b_e, lever_b, arm);
    cross(s->omega_eb_b, lever_b, swing_b);
    rotate(s->C_b_e, swing_b, swing);
    for (int i = 0; i < 3; i++) {
        r_e[i] = s->r_eb_e[i] + arm[i];
        v_e[i] = s->v_eb_e[i] + swing[i];
    }
}

void motion_increment(const motion_t *m, double t0, double t1, double alpha[3], double upsilon[3])
{
    static const double x[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
    static const double w[4] = {0.1739274225687269, 0.3260725774312731, 0.3260725774312731, 0.1739274225687269};
    const double h = t1 - t0;
    for (int i = 0; i < 3; i++) {
        alpha[i] = 0.0;
        upsilon[i] = 0.0;
    }
    for (int k = 0; k < 4; k++) {
        state_t s;
        motion_at(m, t0 + 0.5 * h * (1.0 + x[k]), &s);
        for (int i = 0; i < 3; i++) {
            alpha[i] += w[k] * h * s.omega_ib_b[i];
            upsilon[i] += w[k] * h * s.f_ib_b[i];
        }
    }
}

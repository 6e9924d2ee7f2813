/* event.c - exterior orientation at event marks: Hermite interpolation between stored poses (S5 section 12). */
#include "internal.h"

#include "pelorus/earth.h"
#include "pelorus/math.h"

/* Poses are kept at most this often: Hermite at 100 Hz interpolates to 0.02 arc seconds. */
#define POSE_EVERY_NS (10 * PEL_NS_PER_MS)

static const pel_pose_t *pose_at(const pel_pose_ring_t *ring, int age)
{
    return &ring->pose[(ring->head + PEL_POSE_RING - 1 - age) % PEL_POSE_RING];
}

/* The rate at a node is the mean over the interval before and the one after: single gyro increments carry their quantization,
 * which is 0.15 deg/s on a 500 Hz tactical gyro. So a node is complete when the next one is stored. */
static void complete_rate(pel_pose_ring_t *ring, pel_pose_t *node, pel_time_t next_ns)
{
    const double span_s = pel_time_diff_s(next_ns, ring->previous_ns);
    for (int k = 0; k < 3; k++) {
        node->omega_ib_b[k] = (float)((ring->alpha_before[k] + ring->alpha_after[k]) / span_s);
        ring->alpha_before[k] = ring->alpha_after[k];
        ring->alpha_after[k] = 0.0;
    }
    ring->previous_ns = node->t_ns;
}

void pel_nav_keep_pose(pel_navigator_t *nav, const double alpha[3])
{
    pel_pose_ring_t *ring = &nav->poses;
    const pel_strapdown_t *s = &nav->now;
    for (int k = 0; k < 3; k++) { ring->alpha_after[k] += alpha[k]; }
    pel_pose_t *last = &ring->pose[(ring->head + PEL_POSE_RING - 1) % PEL_POSE_RING];
    if (ring->n > 0 && s->t_ns < last->t_ns + POSE_EVERY_NS) { return; }
    if (ring->n > 0) { complete_rate(ring, last, s->t_ns); }
    else {
        ring->previous_ns = s->t_ns;
        for (int k = 0; k < 3; k++) { ring->alpha_before[k] = ring->alpha_after[k] = 0.0; }
    }
    pel_pose_t *p = &ring->pose[ring->head];
    p->t_ns = s->t_ns;
    pel_dcm_to_rotvec(s->C_b_e, p->theta_b_e);
    for (int k = 0; k < 3; k++) {
        p->r_eb_e[k] = s->r_eb_e[k];
        p->v_eb_e[k] = (float)s->v_eb_e[k];
        p->omega_ib_b[k] = 0.0f;
    }
    ring->head = (uint16_t)((ring->head + 1) % PEL_POSE_RING);
    if (ring->n < PEL_POSE_RING) { ring->n++; }
}

/* Cubic with values 0 and y1, slopes m0 and m1 (per interval), at u in [0, 1]. */
static double hermite(double y1, double m0, double m1, double u)
{
    const double u2 = u * u;
    const double u3 = u2 * u;
    return y1 * (3.0 * u2 - 2.0 * u3) + m0 * (u3 - 2.0 * u2 + u) + m1 * (u3 - u2);
}

/* Rate of a rotation vector phi whose rotation turns at body rate omega: the inverse right Jacobian to second order (the
 * next term is |phi|^4 / 720, nothing at 10 ms). */
static void rotvec_rate(const double phi[3], const double omega[3], double rate[3])
{
    double c1[3], c2[3];
    pel_cross3(phi, omega, c1);
    pel_cross3(phi, c1, c2);
    for (int k = 0; k < 3; k++) { rate[k] = omega[k] + 0.5 * c1[k] + c2[k] / 12.0; }
}

/* Rate of b with respect to e. */
static void body_rate(const pel_pose_t *p, const double C_b_e[3][3], double omega_eb_b[3])
{
    const double omega_ie_e[3] = {0.0, 0.0, PEL_OMEGA_IE};
    double omega_ie_b[3];
    pel_mat3_tvec(C_b_e, omega_ie_e, omega_ie_b);
    for (int k = 0; k < 3; k++) { omega_eb_b[k] = (double)p->omega_ib_b[k] - omega_ie_b[k]; }
}

static void interpolate(const pel_pose_t *a, const pel_pose_t *b, pel_time_t t_ns, double r_e[3], double C_b_e[3][3])
{
    const double h = pel_time_diff_s(b->t_ns, a->t_ns);
    const double u = pel_time_diff_s(t_ns, a->t_ns) / h;
    double Ca[3][3], Cb[3][3], Crel[3][3], phi1[3], w0[3], w1[3], rate1[3], phi[3];
    pel_rotvec_to_dcm(a->theta_b_e, Ca);
    pel_rotvec_to_dcm(b->theta_b_e, Cb);
    pel_mat3_tmul(Ca, Cb, Crel);
    pel_dcm_to_rotvec(Crel, phi1);
    body_rate(a, Ca, w0);
    body_rate(b, Cb, w1);
    rotvec_rate(phi1, w1, rate1);
    for (int k = 0; k < 3; k++) {
        phi[k] = hermite(phi1[k], w0[k] * h, rate1[k] * h, u);
        r_e[k] = a->r_eb_e[k] +
                 hermite(b->r_eb_e[k] - a->r_eb_e[k], (double)a->v_eb_e[k] * h, (double)b->v_eb_e[k] * h, u);
    }
    pel_rotvec_to_dcm(phi, Crel);
    pel_mat3_mul(Ca, Crel, C_b_e);
}

/* omega, phi, kappa with C_c^m = Rx(omega) Ry(phi) Rz(kappa), m = local east-north-up. */
static void photogrammetric_angles(const double C_c_m[3][3], pel_event_t *out)
{
    out->omega_rad = (float)pel_atan2(-C_c_m[1][2], C_c_m[2][2]);
    out->phi_rad = (float)pel_asin(C_c_m[0][2]);
    out->kappa_rad = (float)pel_atan2(-C_c_m[0][1], C_c_m[0][0]);
}

static void fill_event(pel_navigator_t *nav, const pel_pose_t *a, const pel_pose_t *b)
{
    pel_event_t *out = &nav->event;
    double C_b_e[3][3], C_e_m[3][3], C_c_e[3][3], C_c_m[3][3], lever_e[3];
    interpolate(a, b, nav->event_t_ns, out->r_ec_e, C_b_e);
    pel_mat3_vec(C_b_e, nav->cfg.lever_bc_b, lever_e);
    for (int k = 0; k < 3; k++) { out->r_ec_e[k] += lever_e[k]; }
    pel_earth_ecef_to_llh(out->r_ec_e, &out->lat_rad, &out->lon_rad, &out->height_m);
    pel_earth_C_e_enu(out->lat_rad, out->lon_rad, C_e_m);
    pel_mat3_mul(C_b_e, nav->cfg.C_c_b, C_c_e);
    pel_mat3_mul(C_e_m, C_c_e, C_c_m);
    photogrammetric_angles(C_c_m, out);
    out->t_ns = nav->event_t_ns;
    out->id = nav->event_id;
    out->fix = nav->solution.fix;
    const int diagonal[3] = {0, 3, 5};
    for (int k = 0; k < 3; k++) {
        out->sd_r_m[k] = (float)pel_sqrtr((pel_real)nav->solution.cov_r_ned[diagonal[k]]);
        out->sd_att_rad[k] = (float)pel_sqrtr((pel_real)nav->solution.cov_att[diagonal[k]]);
    }
}

void pel_nav_serve_event(pel_navigator_t *nav)
{
    const pel_pose_ring_t *ring = &nav->poses;
    if (!nav->event_waiting || ring->n < 3 || pose_at(ring, 1)->t_ns < nav->event_t_ns) { return; }
    nav->event_waiting = false;
    for (int age = 2; age < ring->n; age++) {
        const pel_pose_t *a = pose_at(ring, age);
        if (a->t_ns > nav->event_t_ns) { continue; }
        fill_event(nav, a, pose_at(ring, age - 1));
        nav->counters.events++;
        nav->ready |= PEL_NAV_BIT(PEL_NAV_EVENT);
        return;
    }
    nav->counters.events_refused++;
}

void pel_navigator_push_event(pel_navigator_t *nav, pel_time_t t_ns, uint32_t id)
{
    if (nav->event_waiting) { nav->counters.events_refused++; }
    nav->event_waiting = true;
    nav->event_t_ns = t_ns;
    nav->event_id = id;
    pel_nav_serve_event(nav);
}

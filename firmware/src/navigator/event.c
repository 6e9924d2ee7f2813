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

void pel_nav_keep_pose(pel_navigator_t *nav, const double alpha[3])
{
    pel_pose_ring_t *ring = &nav->poses;
    const pel_strapdown_t *s = &nav->now;
    for (int k = 0; k < 3; k++) { ring->alpha[k] += alpha[k]; }
    if (ring->n > 0 && s->t_ns < pose_at(ring, 0)->t_ns + POSE_EVERY_NS) { return; }
    pel_pose_t *p = &ring->pose[ring->head];
    p->t_ns = s->t_ns;
    pel_dcm_to_rotvec(s->C_b_e, p->theta_b_e);
    for (int k = 0; k < 3; k++) {
        p->r_eb_e[k] = s->r_eb_e[k];
        p->v_eb_e[k] = (float)s->v_eb_e[k];
        p->alpha_ib_b[k] = (float)ring->alpha[k];
        ring->alpha[k] = 0.0;
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

/* Rate of b with respect to e at the node of an age, from the turns of the two intervals on each side: the fourth-order
 * difference of the angle. One gyro increment's own rate would carry its quantization, 0.15 deg/s at 500 Hz. */
static void body_rate(const pel_pose_ring_t *ring, int age, const double C_b_e[3][3], double omega_eb_b[3])
{
    const pel_pose_t *later = pose_at(ring, age - 2), *after = pose_at(ring, age - 1), *node = pose_at(ring, age);
    const pel_pose_t *before = pose_at(ring, age + 1);
    const double inner_s = pel_time_diff_s(after->t_ns, before->t_ns);
    const double omega_ie_e[3] = {0.0, 0.0, PEL_OMEGA_IE};
    double omega_ie_b[3];
    pel_mat3_tvec(C_b_e, omega_ie_e, omega_ie_b);
    for (int k = 0; k < 3; k++) {
        const double inner = (double)node->alpha_ib_b[k] + (double)after->alpha_ib_b[k];
        const double outer = (double)before->alpha_ib_b[k] + (double)later->alpha_ib_b[k];
        omega_eb_b[k] = (7.0 * inner - outer) / (6.0 * inner_s) - omega_ie_b[k];
    }
}

/* Between the node of an age and the next younger one. */
static void interpolate(const pel_pose_ring_t *ring, int age, pel_time_t t_ns, double r_e[3], double C_b_e[3][3])
{
    const pel_pose_t *a = pose_at(ring, age), *b = pose_at(ring, age - 1);
    const double h = pel_time_diff_s(b->t_ns, a->t_ns);
    const double u = pel_time_diff_s(t_ns, a->t_ns) / h;
    double Ca[3][3], Cb[3][3], Crel[3][3], phi1[3], w0[3], w1[3], rate1[3], phi[3];
    pel_rotvec_to_dcm(a->theta_b_e, Ca);
    pel_rotvec_to_dcm(b->theta_b_e, Cb);
    pel_mat3_tmul(Ca, Cb, Crel);
    pel_dcm_to_rotvec(Crel, phi1);
    body_rate(ring, age, Ca, w0);
    body_rate(ring, age - 1, Cb, w1);
    rotvec_rate(phi1, w1, rate1);
    for (int k = 0; k < 3; k++) {
        phi[k] = hermite(phi1[k], w0[k] * h, rate1[k] * h, u);
        r_e[k] =
            a->r_eb_e[k] + hermite(b->r_eb_e[k] - a->r_eb_e[k], (double)a->v_eb_e[k] * h, (double)b->v_eb_e[k] * h, u);
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

static void fill_event(pel_navigator_t *nav, int age)
{
    pel_event_t *out = &nav->event;
    double C_b_e[3][3], C_e_m[3][3], C_c_e[3][3], C_c_m[3][3], lever_e[3];
    interpolate(&nav->poses, age, nav->event_t_ns, out->r_ec_e, C_b_e);
    pel_mat3_vec(C_b_e, nav->cfg.lever_bc_b, lever_e);
    for (int k = 0; k < 3; k++) { out->r_ec_e[k] += lever_e[k]; }
    pel_earth_ecef_to_llh(out->r_ec_e, &out->lat_rad, &out->lon_rad, &out->height_m);
    pel_earth_C_e_enu(out->lat_rad, out->lon_rad, C_e_m);
    pel_mat3_mul(C_b_e, nav->cfg.C_c_b, C_c_e);
    pel_mat3_mul(C_e_m, C_c_e, C_c_m);
    photogrammetric_angles(C_c_m, out);
    out->t_ns = nav->event_t_ns;
    out->id = nav->event_id;
    const bool predicted = nav->solution.t_ns >= nav->epoch_solution.t_ns; /* there is none without an output rate */
    const pel_solution_t *s = predicted ? &nav->solution : &nav->epoch_solution;
    out->fix = s->fix;
    const int diagonal[3] = {0, 3, 5};
    for (int k = 0; k < 3; k++) {
        out->sd_r_m[k] = (float)pel_sqrtr((pel_real)s->cov_r_ned[diagonal[k]]);
        out->sd_att_rad[k] = (float)pel_sqrtr((pel_real)s->cov_att[diagonal[k]]);
    }
}

void pel_nav_serve_event(pel_navigator_t *nav)
{
    const pel_pose_ring_t *ring = &nav->poses;
    if (!nav->event_waiting || ring->n < 5 || pose_at(ring, 2)->t_ns < nav->event_t_ns) { return; }
    nav->event_waiting = false;
    for (int age = 3; age < ring->n - 1; age++) {
        if (pose_at(ring, age)->t_ns > nav->event_t_ns) { continue; }
        fill_event(nav, age);
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

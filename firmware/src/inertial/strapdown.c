/* strapdown.c - one increment of attitude, velocity and position in ECEF. */
#include "pelorus/earth.h"
#include "pelorus/inertial.h"
#include "pelorus/math.h"

void pel_coning_init(pel_coning_t *c)
{
    const pel_coning_t none = {0};
    *c = none;
}

/* Factor of (previous x this) for rates linear in time, intervals T1 (previous) and T2: T2^2 / (6 T1 (T1 + T2)); 1/12 when
 * they are equal. */
static double coning_factor(double T1, double T2)
{
    if (T1 == T2) { return 1.0 / 12.0; }
    return (T1 > 0.0) ? T2 * T2 / (6.0 * T1 * (T1 + T2)) : 0.0;
}

/* An increment much shorter than its predecessor (one cut at a GNSS epoch) would give a poor rate: it is joined to it. */
static void remember(pel_coning_t *c, const double alpha[3], const double upsilon[3], double dt_s)
{
    const bool join = dt_s < 0.5 * c->dt_s;
    for (int i = 0; i < 3; i++) {
        c->alpha[i] = join ? c->alpha[i] + alpha[i] : alpha[i];
        c->upsilon[i] = join ? c->upsilon[i] + upsilon[i] : upsilon[i];
    }
    c->dt_s = join ? c->dt_s + dt_s : dt_s;
}

void pel_strapdown_step(pel_strapdown_t *s, pel_coning_t *c, const double alpha[3], const double upsilon[3],
                        double dt_s, pel_time_t t_end)
{
    const double k = coning_factor(c->dt_s, dt_s);
    double cone[3];
    double scull_a[3];
    double scull_b[3];
    double rot1[3];
    double rot2[3];
    pel_cross3(c->alpha, alpha, cone);
    pel_cross3(c->alpha, upsilon, scull_a);
    pel_cross3(c->upsilon, alpha, scull_b);
    pel_cross3(alpha, upsilon, rot1);
    pel_cross3(alpha, rot1, rot2);

    double phi[3];  /* rotation vector of the body over the step */
    double dv_b[3]; /* specific-force increment, resolved in the body axes at the start */
    for (int i = 0; i < 3; i++) {
        phi[i] = alpha[i] + k * cone[i];
        dv_b[i] = upsilon[i] + 0.5 * rot1[i] + (1.0 / 6.0) * rot2[i] + k * (scull_a[i] + scull_b[i]);
    }
    remember(c, alpha, upsilon, dt_s);

    /* velocity: while the step lasts the e frame turns; half of that turn applies to the increment (Groves 5.84 ff.) */
    const double turn = PEL_OMEGA_IE * dt_s;
    double dv_e[3];
    pel_mat3_vec(s->C_b_e, dv_b, dv_e);
    c->dv_f_e[0] = dv_e[0] + 0.5 * turn * dv_e[1];
    c->dv_f_e[1] = dv_e[1] - 0.5 * turn * dv_e[0];
    c->dv_f_e[2] = dv_e[2];

    const double half = 0.5 * dt_s;
    double r_mid[3];
    double g[3];
    for (int i = 0; i < 3; i++) { r_mid[i] = s->r_eb_e[i] + half * s->v_eb_e[i]; }
    pel_earth_gravity_e(r_mid, g);
    const double v_mid[2] = {s->v_eb_e[0] + 0.5 * (c->dv_f_e[0] + g[0] * dt_s) + turn * s->v_eb_e[1],
                             s->v_eb_e[1] + 0.5 * (c->dv_f_e[1] + g[1] * dt_s) - turn * s->v_eb_e[0]};
    const double dv[3] = {c->dv_f_e[0] + g[0] * dt_s + 2.0 * turn * v_mid[1],
                          c->dv_f_e[1] + g[1] * dt_s - 2.0 * turn * v_mid[0], c->dv_f_e[2] + g[2] * dt_s};
    for (int i = 0; i < 3; i++) {
        s->r_eb_e[i] += dt_s * (s->v_eb_e[i] + 0.5 * dv[i]);
        s->v_eb_e[i] += dv[i];
    }

    /* attitude: C <- Rz(-turn) C exp([phi x]); the series of sine and cosine are exact up to dt = 10 s */
    double R[3][3];
    double C[3][3];
    pel_rotvec_to_dcm(phi, R);
    pel_mat3_mul(s->C_b_e, R, C);
    const double cos_t = 1.0 - 0.5 * turn * turn;
    const double sin_t = turn * (1.0 - (1.0 / 6.0) * turn * turn);
    for (int j = 0; j < 3; j++) {
        s->C_b_e[0][j] = cos_t * C[0][j] + sin_t * C[1][j];
        s->C_b_e[1][j] = cos_t * C[1][j] - sin_t * C[0][j];
        s->C_b_e[2][j] = C[2][j];
    }
    s->t_ns = t_end;
}

void pel_imu_correct(const pel_imu_t *imu, const double b_g[3], const double b_a[3], double alpha[3], double upsilon[3])
{
    for (int i = 0; i < 3; i++) {
        alpha[i] = imu->alpha_ib_b[i] - b_g[i] * imu->dt_s;
        upsilon[i] = imu->upsilon_ib_b[i] - b_a[i] * imu->dt_s;
    }
}

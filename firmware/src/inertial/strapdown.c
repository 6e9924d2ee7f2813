/* strapdown.c - one increment of attitude, velocity and position in ECEF. */
#include "increments.h"
#include "pelorus/earth.h"
#include "pelorus/math.h"

void pel_coning_init(pel_coning_t *c)
{
    const pel_coning_t none = {0};
    *c = none;
}

/* C <- Rz(-turn) C exp([phi x]); the series of sine and cosine of the turn are exact up to 10 s. */
static inline void turn_attitude(double C_b_e[3][3], const double phi[3], double turn)
{
    double R[3][3];
    double x[3];
    double y[3];
    pel_rotvec_to_dcm(phi, R);
    const double cos_t = 1.0 - 0.5 * turn * turn;
    const double sin_t = turn * (1.0 - (1.0 / 6.0) * turn * turn);
    pel_mat3_tvec(R, C_b_e[0], x); /* rows of C R */
    pel_mat3_tvec(R, C_b_e[1], y);
    C_b_e[0][0] = cos_t * x[0] + sin_t * y[0];
    C_b_e[0][1] = cos_t * x[1] + sin_t * y[1];
    C_b_e[0][2] = cos_t * x[2] + sin_t * y[2];
    C_b_e[1][0] = cos_t * y[0] - sin_t * x[0];
    C_b_e[1][1] = cos_t * y[1] - sin_t * x[1];
    C_b_e[1][2] = cos_t * y[2] - sin_t * x[2];
    pel_mat3_tvec(R, C_b_e[2], x);
    copy3(C_b_e[2], x);
}

void pel_strapdown_step(pel_strapdown_t *s, pel_coning_t *c, const double alpha[3], const double upsilon[3],
                        double dt_s, pel_time_t t_end)
{
    double phi[3];
    double dv_b[3];
    correct_increments(c, coning_factor(c->dt_s, dt_s), alpha, upsilon, phi, dv_b);
    remember(c, alpha, upsilon, dt_s);

    /* velocity: while the step lasts the e frame turns; half of that turn applies to the increment (Groves 5.84 ff.) */
    const double turn = PEL_OMEGA_IE * dt_s;
    const double half_turn = 0.5 * turn;
    double f[3];
    pel_mat3_vec(s->C_b_e, dv_b, f);
    c->dv_f_e[0] = f[0] + half_turn * f[1];
    c->dv_f_e[1] = f[1] - half_turn * f[0];
    c->dv_f_e[2] = f[2];

    double r_mid[3];
    double dv[3];
    copy3(r_mid, s->r_eb_e);
    add_scaled(r_mid, 0.5 * dt_s, s->v_eb_e);
    pel_earth_gravity_e(r_mid, dv);
    dv[0] = c->dv_f_e[0] + dv[0] * dt_s;
    dv[1] = c->dv_f_e[1] + dv[1] * dt_s;
    dv[2] = c->dv_f_e[2] + dv[2] * dt_s;
    /* Coriolis of the velocity at mid step, that velocity's own Coriolis share included: 2 w^2 v dt is seen after minutes */
    const double v_x = s->v_eb_e[0] + 0.5 * dv[0] + turn * s->v_eb_e[1];
    const double v_y = s->v_eb_e[1] + 0.5 * dv[1] - turn * s->v_eb_e[0];
    dv[0] += 2.0 * turn * v_y;
    dv[1] -= 2.0 * turn * v_x;

    /* the trapezoid in two halves, before and after v changes */
    copy3(s->r_eb_e, r_mid);
    add_scaled(s->v_eb_e, 1.0, dv);
    add_scaled(s->r_eb_e, 0.5 * dt_s, s->v_eb_e);
    turn_attitude(s->C_b_e, phi, turn);
    s->t_ns = t_end;
}

void pel_imu_correct(const pel_imu_t *imu, const double b_g[3], const double b_a[3], double alpha[3], double upsilon[3])
{
    copy3(alpha, imu->alpha_ib_b);
    copy3(upsilon, imu->upsilon_ib_b);
    add_scaled(alpha, -imu->dt_s, b_g);
    add_scaled(upsilon, -imu->dt_s, b_a);
}

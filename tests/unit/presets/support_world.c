#include "support_world.h"

#include <math.h>
#include <string.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"

void carried_imu_init(carried_imu_t *imu, const pel_imu_model_t *model, double step_s, uint64_t seed)
{
    memset(imu, 0, sizeof *imu);
    imu->model = *model;
    imu->step_s = step_s;
    rng_init(&imu->rng, seed, 901);
    for (int i = 0; i < 3; i++) {
        imu->constant_g[i] = model->sd_bg_radps * rng_normal(&imu->rng);
        imu->constant_a[i] = model->sd_ba_mps2 * rng_normal(&imu->rng);
        imu->markov_g[i] = model->sd_gm_radps * rng_normal(&imu->rng);
        imu->markov_a[i] = model->sd_am_mps2 * rng_normal(&imu->rng);
    }
}

void carried_imu_step(carried_imu_t *imu, const motion_t *m, double t0, const double b_g[3], const double b_a[3],
                      double alpha[3], double upsilon[3])
{
    const double dt = imu->step_s;
    const pel_imu_model_t *x = &imu->model;
    motion_increment(m, t0, t0 + dt, alpha, upsilon);
    for (int i = 0; i < 3; i++) {
        alpha[i] +=
            (imu->constant_g[i] + imu->markov_g[i] - b_g[i]) * dt + x->arw_rad_rts * sqrt(dt) * rng_normal(&imu->rng);
        upsilon[i] +=
            (imu->constant_a[i] + imu->markov_a[i] - b_a[i]) * dt + x->vrw_mps_rts * sqrt(dt) * rng_normal(&imu->rng);
        imu->markov_g[i] = rng_markov(&imu->rng, imu->markov_g[i], x->sd_gm_radps, x->tau_gm_s, dt);
        imu->markov_a[i] = rng_markov(&imu->rng, imu->markov_a[i], x->sd_am_mps2, x->tau_am_s, dt);
    }
}

void turn_back(double C[3][3], const double psi[3])
{
    const double back[3] = {-psi[0], -psi[1], -psi[2]};
    double R[3][3];
    double out[3][3];
    pel_rotvec_to_dcm(back, R);
    pel_mat3_mul(R, C, out);
    memcpy(C, out, sizeof out);
}

void local_error(const state_t *truth, const double r_e[3], const double v_e[3], double dr_enu[3], double dv_enu[3])
{
    double C[3][3], dr[3], dv[3];
    pel_earth_C_e_enu(truth->llh[0], truth->llh[1], C);
    for (int i = 0; i < 3; i++) {
        dr[i] = r_e[i] - truth->r_eb_e[i];
        dv[i] = v_e[i] - truth->v_eb_e[i];
    }
    pel_mat3_vec(C, dr, dr_enu);
    pel_mat3_vec(C, dv, dv_enu);
}

double range_to(const double sat[3], const double r_a[3], double u[3])
{
    double d[3];
    for (int k = 0; k < 3; k++) { d[k] = sat[k] - r_a[k]; }
    const double rho = pel_norm3(d);
    for (int k = 0; k < 3; k++) { u[k] = d[k] / rho; }
    return rho;
}

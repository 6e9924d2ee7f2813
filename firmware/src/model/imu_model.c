/* imu_model.c - what kinds of IMU there are. */
#include "pelorus/math.h"
#include "pelorus/model.h"

#define DEG_PER_H   (PEL_DEG / 3600.0) /* rad/s */
#define DEG_PER_RTH (PEL_DEG / 60.0)   /* rad/sqrt(s) */
#define MILLI_G     9.80665e-3         /* m/s^2 */

void pel_imu_model_preset(pel_imu_grade_t grade, pel_imu_model_t *imu)
{
    static const pel_imu_model_t tactical = {
        .arw_rad_rts = 0.001 * DEG_PER_RTH,
        .vrw_mps_rts = 1e-5,
        .sd_bg_radps = 0.01 * DEG_PER_H,
        .sd_gm_radps = 0.01 * DEG_PER_H,
        .tau_gm_s = 3600.0,
        .sd_am_mps2 = 0.01 * MILLI_G,
        .tau_am_s = 3600.0,
        .accel_psd_rts = 1.0,
    };
    static const pel_imu_model_t mems = {
        .arw_rad_rts = 0.3 * DEG_PER_RTH,
        .vrw_mps_rts = 2e-3,
        .sd_bg_radps = 0.3 * PEL_DEG,
        .sd_gm_radps = 30.0 * DEG_PER_H,
        .tau_gm_s = 300.0,
        .sd_am_mps2 = 30.0 * MILLI_G,
        .tau_am_s = 1000.0,
        .accel_psd_rts = 1.0,
    };
    switch (grade) {
    case PEL_IMU_GRADE_TACTICAL: *imu = tactical; break;
    case PEL_IMU_GRADE_MEMS: *imu = mems; break;
    }
}

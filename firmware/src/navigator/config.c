/* config.c - sane values for every setting. */
#include <string.h>

#include "internal.h"

#include "pelorus/math.h"

static void identity(double C[3][3])
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { C[i][j] = (i == j) ? 1.0 : 0.0; }
    }
}

void pel_nav_config_default(pel_nav_config_t *cfg)
{
    memset(cfg, 0, sizeof *cfg);
    cfg->preset = PEL_PRESET_AUTO;
    cfg->output_period_ns = 100 * PEL_NS_PER_MS;
    cfg->mask_rad = 10.0 * PEL_DEG;
    cfg->integer_mask_rad = 15.0 * PEL_DEG;
    cfg->systems =
        (1u << PEL_SYS_GPS) | (1u << PEL_SYS_GLO) | (1u << PEL_SYS_GAL) | (1u << PEL_SYS_BDS) | (1u << PEL_SYS_QZS);
    cfg->carriers = (1u << PEL_N_CARRIER) - 1u;
    cfg->coast_after_s = 1.5f;

    pel_imu_model_preset(PEL_IMU_GRADE_MEMS, &cfg->imu);
    cfg->imu.accel_psd_rts = 2.0;
    identity(cfg->C_s_b);
    identity(cfg->C_c_b);
    cfg->align_speed_mps = 1.0;
    cfg->warm_max_age_s = 86400.0;
    cfg->sd_tilt_rad = 1.0 * PEL_DEG;
    cfg->sd_heading_rad = 5.0 * PEL_DEG;

    /* A third of a metre of code at the zenith and less trust in weak signals: receivers differ by a factor of ten, and a code believed
     * too much makes wrong integers, one believed too little only makes them later. */
    pel_noise_default(&cfg->noise);
    cfg->noise.code_a_m = 0.25;
    cfg->noise.code_b_m = 0.25;
    cfg->noise.cn0_ref_dbhz = 45.0;
    cfg->noise.iono_mm_per_km = 1.0;
    /* A receiver alone carries orbit, clock and atmosphere errors of metres, mostly slow. */
    cfg->noise_single = cfg->noise;
    cfg->noise_single.code_a_m = 1.0;
    cfg->noise_single.code_b_m = 1.0;
    cfg->noise_single.doppler_a_mps = 0.05;
    cfg->noise_single.doppler_b_mps = 0.05;
    cfg->single_code_tau_s = 60.0;
    cfg->single_lasting_tau_s = 3600.0;
    cfg->single_path_m_rts = 0.002;
    cfg->single_phase_tau_s = 1.0; /* of an antenna that moves */
    cfg->observe = PEL_OBS_CODE | PEL_OBS_PHASE | PEL_OBS_DOPPLER;
    cfg->vehicle.sd_place_m = 0.01;
    cfg->vehicle.sd_height_m = 1.0;
    cfg->vehicle.tau_height_s = 60.0;
    cfg->code_tau_s = 5.0;
    cfg->phase_tau_s = 10.0;
    cfg->float_code = true;
    cfg->learn_noise = true;
    cfg->base_max_age_s = 10.0f;
    cfg->base_wait_s = 0.3f;
    cfg->apply_delay_s = 0.1f;

    cfg->ratio_min = 2.0f;
    cfg->failure_max = 1e-3f;
    cfg->success_min = 0.5f;
    cfg->node_budget = 10000;
    cfg->slice_nodes = 200;
    cfg->integers = true;
}

#include "pelorus/gnss.h"
#include "pelorus/math.h"

double pel_obs_lambda_m(const pel_obs_t *obs)
{
    return pel_carrier_wavelength_m((pel_sys_t)obs->sys, (pel_carrier_t)obs->carrier, obs->glo_k);
}

unsigned pel_obs_usable_parts(const pel_obs_t *obs)
{
    if (obs->prn < 1 || obs->prn > pel_sys_max_prn((pel_sys_t)obs->sys)) { return 0u; }
    if (!(pel_carrier_hz((pel_sys_t)obs->sys, (pel_carrier_t)obs->carrier, obs->glo_k) > 0.0)) { return 0u; }
    unsigned parts = 0u;
    /* From the nearest MEO to a GEO, and 30 ms of receiver clock. Comparisons are false for NaN. */
    if (obs->P_m > 1.0e7 && obs->P_m < 6.0e7) { parts |= PEL_OBS_CODE; }
    if (pel_fabs(obs->L_cyc) < 1.0e10 && obs->L_cyc != 0.0) { parts |= PEL_OBS_PHASE; }
    if (pel_fabs((double)obs->D_hz) < 1.0e5) { parts |= PEL_OBS_DOPPLER; }
    return parts & obs->flags;
}

bool pel_obs_usable(const pel_obs_t *obs, unsigned part)
{
    return (pel_obs_usable_parts(obs) & part) != 0u;
}

void pel_noise_default(pel_noise_config_t *noise)
{
    const double half = 0.70710678118654752; /* a and b make the zenith value together */
    *noise = (pel_noise_config_t){
        .code_a_m = 0.3 * half,
        .code_b_m = 0.3 * half,
        .phase_a_m = 0.003 * half,
        .phase_b_m = 0.003 * half,
        .doppler_a_mps = 0.03 * half,
        .doppler_b_mps = 0.03 * half,
        .rover_factor = 1.0,
        .base_factor = 1.0,
        .cn0_ref_dbhz = 0.0,
        .sat_clock_mps = 0.001,
        .iono_mm_per_km = 1.0,
    };
}

double pel_noise_var(const pel_noise_config_t *noise, unsigned part, double sin_el, double cn0_dbhz)
{
    double a = noise->doppler_a_mps;
    double b = noise->doppler_b_mps;
    if (part == PEL_OBS_CODE) {
        a = noise->code_a_m;
        b = noise->code_b_m;
    } else if (part == PEL_OBS_PHASE) {
        a = noise->phase_a_m;
        b = noise->phase_b_m;
    }
    const double at_el = b / ((sin_el > 0.05) ? sin_el : 0.05);
    double var = a * a + at_el * at_el;
    if (noise->cn0_ref_dbhz > 0.0 && cn0_dbhz > 0.0 && cn0_dbhz < noise->cn0_ref_dbhz) {
        var *= pel_exp((noise->cn0_ref_dbhz - cn0_dbhz) * 0.23025850929940457); /* ln(10) / 10 */
    }
    return var;
}

/* preset.c - the published systems and their relatives, as data of the one navigator. */
#include "internal.h"

static const pel_nav_preset_t PRESETS[PEL_N_PRESETS] = {
    [PEL_PRESET_AUTO] = {.model = pel_model_ins_ecef,
                         .imu = true,
                         .base = true,
                         .rover_phase = true,
                         .rates = true,
                         .each_epoch = true},
    [PEL_PRESET_SINGLE] = {.rates = true},
    [PEL_PRESET_RTK] = {.base = true, .rates = true, .each_epoch = true},
    [PEL_PRESET_INS_SINGLE] = {.model = pel_model_ins_ecef, .imu = true, .rates = true},
    [PEL_PRESET_INS_RTK] = {.model = pel_model_ins_ecef, .imu = true, .base = true, .rates = true, .each_epoch = true},
    [PEL_PRESET_INS_TDCP] = {.model = pel_model_ins_ecef, .imu = true, .rover_phase = true, .rates = true},
    [PEL_PRESET_INS_FLOAT] = {.model = pel_model_ins_enu, .imu = true, .base = true, .local = true},
};

const pel_nav_preset_t *pel_nav_preset(pel_preset_t preset)
{
    return &PRESETS[((unsigned)preset < PEL_N_PRESETS) ? preset : PEL_PRESET_AUTO];
}

pel_preset_t pel_nav_preset_in_use(const pel_navigator_t *nav)
{
    if (!nav->ins) { return nav->relative ? PEL_PRESET_RTK : PEL_PRESET_SINGLE; }
    if (!nav->relative) { return nav->update.phased ? PEL_PRESET_INS_TDCP : PEL_PRESET_INS_SINGLE; }
    return (nav->cfg.preset == PEL_PRESET_INS_FLOAT) ? PEL_PRESET_INS_FLOAT : PEL_PRESET_INS_RTK;
}

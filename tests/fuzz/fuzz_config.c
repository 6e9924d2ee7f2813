/* The configuration file: TOML text to settings, and a navigator that starts with them. */
#include <string.h>

#include "config_file.h"
#include "desktop.h"
#include "fuzz.h"
#include "pelorus/navigator.h"

/* A configuration that was accepted holds numbers that a navigator can work with. */
static void start(const pel_nav_config_t *cfg)
{
    static pel_navigator_t nav;
    FUZZ_CHECK(cfg->preset < PEL_N_PRESETS && cfg->output_period_ns >= 0);
    FUZZ_CHECK(fuzz_finite(cfg->mask_rad) && fuzz_finite(cfg->imu.arw_rad_rts) && fuzz_finite(cfg->imu.tau_gm_s));
    FUZZ_CHECK(cfg->node_budget >= 1);
    for (int i = 0; i < 3; i++) {
        FUZZ_CHECK(fuzz_finite(cfg->lever_ba_b[i]) && fuzz_finite(cfg->lever_bc_b[i]));
        for (int j = 0; j < 3; j++) { FUZZ_CHECK(fuzz_finite(cfg->C_s_b[i][j]) && fuzz_finite(cfg->C_c_b[i][j])); }
    }
    pel_navigator_init(&nav, cfg);
    for (int i = 1; i <= 20; i++) {
        const pel_imu_t imu = {.t_ns = (INT64_C(1300000000) * 100 + i) * 10 * PEL_NS_PER_MS,
                               .dt_s = 0.01,
                               .upsilon_ib_b = {0.0, 0.0, 0.098}};
        pel_navigator_push_imu(&nav, &imu);
        while (pel_navigator_poll(&nav) != PEL_NAV_NONE) {}
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    char why[CONFIG_FILE_WHY];
    char *text = malloc(n + 1u);
    pel_nav_config_t cfg;
    if (text == NULL) { return 0; }
    for (size_t i = 0; i < n; i++) { text[i] = (char)(data[i] & 0x7Fu); } /* toml++ 3.3 errs in its tables of Unicode */
    text[n] = '\0';
    pel_nav_config_default(&cfg);
    if (desktop_config_from_text(text, "fuzz.toml", &cfg, why, sizeof why) == 0) { start(&cfg); }
    free(text);
    return 0;
}

/* nav_config.c - the [navigator] table of a TOML text becomes the navigator's configuration. docs/CONFIG.md lists the keys. */
#include <stdio.h>
#include <string.h>

#include "config_file.h"
#include "desktop.h"
#include "pelorus/math.h"

#define DEG_PER_HOUR      (PEL_DEG / 3600.0)
#define DEG_PER_ROOT_HOUR (PEL_DEG / 60.0)
#define MICRO_G           9.80665e-6

static void read_words(config_file_t *c, const char *path, const char *const *words, int n, uint8_t *mask)
{
    const int given = config_file_array_size(c, path);
    if (given == 0) { return; }
    *mask = 0;
    for (int i = 0; i < given; i++) {
        const char *word = config_file_string_at(c, path, i, "");
        int k = 0;
        while (k < n && strcmp(word, words[k]) != 0) { k++; }
        if (k < n) {
            *mask |= (uint8_t)(1u << k);
        } else {
            config_file_complain(c, path, "names something unknown");
        }
    }
}

/* A number that the navigator can work with. */
static double within(config_file_t *c, const char *path, double fallback, double least, double most)
{
    char what[64];
    const double x = config_file_number(c, path, fallback);
    if (x >= least && x <= most) { return x; }
    (void)snprintf(what, sizeof what, "lies within %g and %g", least, most);
    config_file_complain(c, path, what);
    return fallback;
}

static void read_preset(config_file_t *c, pel_nav_config_t *cfg)
{
    static const struct {
        const char *name;
        pel_preset_t preset;
    } NAMES[] = {{"auto", PEL_PRESET_AUTO},
                 {"single", PEL_PRESET_SINGLE},
                 {"rtk", PEL_PRESET_RTK},
                 {"gnss", PEL_PRESET_RTK},
                 {"ins-single", PEL_PRESET_INS_SINGLE},
                 {"ins-rtk", PEL_PRESET_INS_RTK},
                 {"s5", PEL_PRESET_INS_RTK},
                 {"ins-float", PEL_PRESET_INS_FLOAT},
                 {"s2", PEL_PRESET_INS_FLOAT},
                 {"ins-tdcp", PEL_PRESET_INS_TDCP},
                 {"s3", PEL_PRESET_INS_TDCP}};
    const char *name = config_file_string(c, "navigator.preset", "auto");
    for (size_t i = 0; i < sizeof NAMES / sizeof NAMES[0]; i++) {
        if (strcmp(name, NAMES[i].name) == 0) {
            cfg->preset = NAMES[i].preset;
            return;
        }
    }
    config_file_complain(c, "navigator.preset",
                         "is one of auto, single, rtk, ins-single, ins-rtk, ins-float, ins-tdcp");
}

static void read_general(config_file_t *c, pel_nav_config_t *cfg)
{
    static const char *const SYSTEMS[] = {"gps", "glonass", "galileo", "beidou", "qzss", "sbas"};
    static const char *const CARRIERS[] = {"L1", "L2", "L5", "E5b", "E6", "B1I", "B3I"};
    read_preset(c, cfg);
    const double hz = config_file_number(c, "navigator.output_hz", 1e9 / (double)cfg->output_period_ns);
    if (hz < 0.0 || hz > 1000.0) {
        config_file_complain(c, "navigator.output_hz", "lies within 0 and 1000");
    } else {
        cfg->output_period_ns = (hz > 0.0) ? (int64_t)(1e9 / hz + 0.5) : 0;
    }
    cfg->mask_rad = config_file_number(c, "navigator.mask_deg", cfg->mask_rad / PEL_DEG) * PEL_DEG;
    if (!(cfg->mask_rad >= 0.0 && cfg->mask_rad < PEL_PI / 2.0)) {
        config_file_complain(c, "navigator.mask_deg", "lies within 0 and 90");
    }
    cfg->integer_mask_rad = pel_max(cfg->mask_rad, cfg->integer_mask_rad);
    cfg->integer_mask_rad =
        within(c, "navigator.integers.mask_deg", cfg->integer_mask_rad / PEL_DEG, 0.0, 90.0) * PEL_DEG;
    read_words(c, "navigator.systems", SYSTEMS, PEL_N_SYS, &cfg->systems);
    read_words(c, "navigator.carriers", CARRIERS, PEL_N_CARRIER, &cfg->carriers);
    cfg->coast_after_s = (float)within(c, "navigator.coast_after_s", (double)cfg->coast_after_s, 0.0, 3600.0);
    cfg->apply_delay_s = (float)within(c, "navigator.apply_delay_s", (double)cfg->apply_delay_s, 0.0, 10.0);
}

static void read_imu(config_file_t *c, pel_nav_config_t *cfg)
{
    pel_imu_model_t *imu = &cfg->imu;
    const double accel_psd = imu->accel_psd_rts;
    const char *model = config_file_string(c, "navigator.imu.model", "mems");
    if (strcmp(model, "tactical") == 0) {
        pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, imu);
    } else if (strcmp(model, "mems") == 0 || strcmp(model, "custom") == 0) {
        pel_imu_model_preset(PEL_IMU_GRADE_MEMS, imu);
    } else {
        config_file_complain(c, "navigator.imu.model", "is one of tactical, mems, custom");
    }
    imu->accel_psd_rts = within(c, "navigator.gnss.accel_mps2_rthz", accel_psd, 1e-4, 1e3);
    imu->arw_rad_rts =
        config_file_number(c, "navigator.imu.arw_deg_rth", imu->arw_rad_rts / DEG_PER_ROOT_HOUR) * DEG_PER_ROOT_HOUR;
    imu->vrw_mps_rts = config_file_number(c, "navigator.imu.vrw_mps_rth", imu->vrw_mps_rts * 60.0) / 60.0;
    imu->sd_bg_radps =
        config_file_number(c, "navigator.imu.gyro_bias_deg_h", imu->sd_bg_radps / DEG_PER_HOUR) * DEG_PER_HOUR;
    imu->sd_gm_radps =
        config_file_number(c, "navigator.imu.gyro_markov_deg_h", imu->sd_gm_radps / DEG_PER_HOUR) * DEG_PER_HOUR;
    imu->tau_gm_s = config_file_number(c, "navigator.imu.gyro_tau_s", imu->tau_gm_s);
    imu->sd_am_mps2 = config_file_number(c, "navigator.imu.accel_markov_ug", imu->sd_am_mps2 / MICRO_G) * MICRO_G;
    imu->tau_am_s = config_file_number(c, "navigator.imu.accel_tau_s", imu->tau_am_s);
    if (!(imu->arw_rad_rts > 0.0 && imu->vrw_mps_rts > 0.0 && imu->sd_bg_radps > 0.0 && imu->sd_gm_radps > 0.0 &&
          imu->sd_am_mps2 > 0.0 && imu->tau_gm_s >= 10.0 && imu->tau_am_s >= 10.0)) {
        config_file_complain(c, "navigator.imu", "holds a noise that is not positive or a time constant below 10 s");
    }
}

/* C from sensor (or camera) to body by roll, pitch, yaw of the sensor on the body: yaw about z, then pitch about x, then roll
 * about y, as for the body on the Earth. */
static void rotation_from_degrees(const double rpy_deg[3], double C[3][3])
{
    const double about_z[3] = {0.0, 0.0, -rpy_deg[2] * PEL_DEG}, about_x[3] = {rpy_deg[1] * PEL_DEG, 0.0, 0.0};
    const double about_y[3] = {0.0, rpy_deg[0] * PEL_DEG, 0.0};
    double Z[3][3], X[3][3], Y[3][3], ZX[3][3];
    pel_rotvec_to_dcm(about_z, Z);
    pel_rotvec_to_dcm(about_x, X);
    pel_rotvec_to_dcm(about_y, Y);
    pel_mat3_mul(Z, X, ZX);
    pel_mat3_mul(ZX, Y, C);
}

static void read_mount(config_file_t *c, pel_nav_config_t *cfg)
{
    double rpy_deg[3] = {0.0, 0.0, 0.0}, boresight_deg[3] = {0.0, 0.0, 0.0};
    (void)config_file_numbers(c, "navigator.mount.lever_arm_m", cfg->lever_ba_b, 3);
    cfg->mount_known = config_file_has(c, "navigator.mount.yaw_deg");
    cfg->wheels = config_file_bool(c, "navigator.mount.wheels", cfg->wheels);
    rpy_deg[0] = config_file_number(c, "navigator.mount.roll_deg", 0.0);
    rpy_deg[1] = config_file_number(c, "navigator.mount.pitch_deg", 0.0);
    rpy_deg[2] = config_file_number(c, "navigator.mount.yaw_deg", 0.0);
    rotation_from_degrees(rpy_deg, cfg->C_s_b);
    (void)config_file_numbers(c, "navigator.camera.lever_m", cfg->lever_bc_b, 3);
    (void)config_file_numbers(c, "navigator.camera.boresight_deg", boresight_deg, 3);
    rotation_from_degrees(boresight_deg, cfg->C_c_b);
}

static void read_start(config_file_t *c, pel_nav_config_t *cfg)
{
    double attitude_deg[3];
    cfg->have_attitude = config_file_numbers(c, "navigator.start.attitude_deg", attitude_deg, 3);
    if (cfg->have_attitude) {
        cfg->roll_rad = attitude_deg[0] * PEL_DEG;
        cfg->pitch_rad = attitude_deg[1] * PEL_DEG;
        cfg->heading_rad = attitude_deg[2] * PEL_DEG;
    }
    cfg->sd_tilt_rad = within(c, "navigator.start.sd_tilt_deg", cfg->sd_tilt_rad / PEL_DEG, 1e-5, 90.0) * PEL_DEG;
    cfg->sd_heading_rad =
        within(c, "navigator.start.sd_heading_deg", cfg->sd_heading_rad / PEL_DEG, 1e-5, 180.0) * PEL_DEG;
    cfg->warm_max_age_s = within(c, "navigator.start.warm_max_age_s", cfg->warm_max_age_s, 0.0, 1e9);
    cfg->align_speed_mps = within(c, "navigator.start.align_speed_mps", cfg->align_speed_mps, 0.0, 1e3);
}

/* One figure at the zenith; with the elevation law half of its variance grows as 1/sin^2. */
static void read_noise(config_file_t *c, const char *path, bool law, double *a, double *b)
{
    double zenith = pel_sqrt(*a * *a + *b * *b);
    const bool given = config_file_has(c, path);
    zenith = config_file_number(c, path, zenith);
    if (!(zenith > 0.0)) { config_file_complain(c, path, "is positive"); }
    if (!given && law) { return; }
    *a = law ? zenith * 0.70710678118654752 : zenith;
    *b = law ? *a : 0.0;
}

static int32_t nodes(config_file_t *c, const char *path, int64_t least, int32_t fallback)
{
    const int64_t n = config_file_integer(c, path, fallback);
    if (n >= least && n <= 1000000000) { return (int32_t)n; }
    config_file_complain(c, path, (least == 0) ? "lies within 0 and 1e9" : "lies within 1 and 1e9");
    return fallback;
}

static void read_gnss(config_file_t *c, pel_nav_config_t *cfg)
{
    const bool law = config_file_bool(c, "navigator.gnss.elevation_law", true);
    read_noise(c, "navigator.gnss.code_m", law, &cfg->noise.code_a_m, &cfg->noise.code_b_m);
    read_noise(c, "navigator.gnss.phase_m", law, &cfg->noise.phase_a_m, &cfg->noise.phase_b_m);
    read_noise(c, "navigator.gnss.doppler_mps", law, &cfg->noise.doppler_a_mps, &cfg->noise.doppler_b_mps);
    read_noise(c, "navigator.gnss.single_code_m", law, &cfg->noise_single.code_a_m, &cfg->noise_single.code_b_m);
    read_noise(c, "navigator.gnss.single_doppler_mps", law, &cfg->noise_single.doppler_a_mps,
               &cfg->noise_single.doppler_b_mps);
    cfg->noise_single.phase_a_m = cfg->noise.phase_a_m; /* a phase is a phase */
    cfg->noise_single.phase_b_m = cfg->noise.phase_b_m;
    const char *ionosphere = config_file_string(c, "navigator.gnss.ionosphere", "broadcast");
    cfg->no_ionosphere = strcmp(ionosphere, "none") == 0;
    if (!cfg->no_ionosphere && strcmp(ionosphere, "broadcast") != 0) {
        config_file_complain(c, "navigator.gnss.ionosphere", "is one of broadcast, none");
    }
    cfg->rdss_hz = 1e6 * within(c, "navigator.gnss.rdss_mhz", 1e-6 * cfg->rdss_hz, 0.0, 1e4);
    cfg->single_code_tau_s = within(c, "navigator.gnss.single_code_tau_s", cfg->single_code_tau_s, 0.0, 1e5);
    cfg->single_lasting_tau_s = within(c, "navigator.gnss.single_lasting_tau_s", cfg->single_lasting_tau_s, 0.0, 1e5);
    cfg->single_path_m_rts = within(c, "navigator.gnss.single_path_m_rts", cfg->single_path_m_rts, 0.0, 1.0);
    cfg->single_rate_mps = within(c, "navigator.gnss.single_rate_mps", cfg->single_rate_mps, 0.0, 1.0);
    cfg->single_phase_tau_s = within(c, "navigator.gnss.single_phase_tau_s", cfg->single_phase_tau_s, 0.0, 1e5);
    cfg->code_tau_s = within(c, "navigator.gnss.code_tau_s", cfg->code_tau_s, 0.0, 1e5);
    cfg->phase_tau_s = within(c, "navigator.gnss.phase_tau_s", cfg->phase_tau_s, 0.0, 1e5);
    cfg->float_code = config_file_bool(c, "navigator.gnss.float_code", cfg->float_code);
    cfg->learn_noise = config_file_bool(c, "navigator.gnss.learn_noise", cfg->learn_noise);
    cfg->noise.cn0_ref_dbhz = config_file_number(c, "navigator.gnss.cn0_ref_dbhz", cfg->noise.cn0_ref_dbhz);
    cfg->noise_single.cn0_ref_dbhz = cfg->noise.cn0_ref_dbhz;
    cfg->noise.iono_mm_per_km = within(c, "navigator.gnss.iono_mm_per_km", cfg->noise.iono_mm_per_km, 0.0, 1e3);
    cfg->base_max_age_s = (float)within(c, "navigator.gnss.base_max_age_s", (double)cfg->base_max_age_s, 0.0, 3600.0);
    cfg->base_wait_s = (float)within(c, "navigator.gnss.base_wait_s", (double)cfg->base_wait_s, 0.0, 60.0);
    cfg->integers = config_file_bool(c, "navigator.integers.enable", cfg->integers);
    cfg->ratio_min = (float)within(c, "navigator.integers.ratio_min", (double)cfg->ratio_min, 1.0, 1e6);
    cfg->failure_max = (float)within(c, "navigator.integers.failure_max", (double)cfg->failure_max, 0.0, 1.0);
    cfg->success_min = (float)within(c, "navigator.integers.success_min", (double)cfg->success_min, 0.0, 1.0);
    cfg->node_budget = nodes(c, "navigator.integers.node_budget", 1, cfg->node_budget);
    cfg->slice_nodes = nodes(c, "navigator.integers.slice_nodes", 0, cfg->slice_nodes);
}

static void read_vehicle(config_file_t *c, pel_nav_config_t *cfg)
{
    static const char *const OBSERVED[] = {"code", "phase", "doppler"}; /* bits of PEL_OBS_ in this order */
    static const char *const HEIGHTS[] = {"none", "constant", "barometer"};
    pel_vehicle_config_t *v = &cfg->vehicle;
    double place[3];
    read_words(c, "navigator.gnss.observe", OBSERVED, 3, &cfg->observe);
    v->place_known = config_file_numbers(c, "navigator.start.place", place, 3);
    if (v->place_known) {
        v->lat_rad = place[0] * PEL_DEG;
        v->lon_rad = place[1] * PEL_DEG;
        v->height_m = place[2];
        if (!(pel_fabs(place[0]) <= 90.0 && pel_fabs(place[1]) <= 360.0 && pel_fabs(place[2]) < 1e5)) {
            config_file_complain(c, "navigator.start.place",
                                 "is latitude and longitude in degrees and a height in metres");
        }
    }
    v->sd_place_m = within(c, "navigator.start.sd_place_m", v->sd_place_m, 1e-4, 1e3);
    v->standing_s = within(c, "navigator.vehicle.standing_s", v->standing_s, 0.0, 1e5);
    v->sd_height_m = within(c, "navigator.vehicle.height_sd_m", v->sd_height_m, 1e-3, 1e4);
    v->tau_height_s = within(c, "navigator.vehicle.height_tau_s", v->tau_height_s, 1.0, 1e6);
    const char *height = config_file_string(c, "navigator.vehicle.height", "none");
    int k = 0;
    while (k < 3 && strcmp(height, HEIGHTS[k]) != 0) { k++; }
    if (k == 3) { config_file_complain(c, "navigator.vehicle.height", "is one of none, constant, barometer"); }
    if (k < 3) { v->height = (uint8_t)k; }
}

static int read_all(config_file_t *c, pel_nav_config_t *cfg, char *why, size_t cap)
{
    read_general(c, cfg);
    read_imu(c, cfg);
    read_mount(c, cfg);
    read_start(c, cfg);
    read_gnss(c, cfg);
    read_vehicle(c, cfg);
    /* The rest of a scenario file is the simulator's. */
    static const char *const OTHERS[] = {
        "name", "seed",   "duration_s", "truth_interval_s", "time",    "start",      "motion",
        "wave", "leg",    "imu",        "antenna",          "sky",     "atmosphere", "rover",
        "base", "outage", "slip",       "events",           "scenario"};
    for (size_t i = 0; i < sizeof OTHERS / sizeof OTHERS[0]; i++) { config_file_allow(c, OTHERS[i]); }
    return (config_file_check(c, why, cap) == 0) ? 0 : EXIT_USAGE;
}

int desktop_config_from_file(const char *path, pel_nav_config_t *cfg, char *why, size_t cap)
{
    bool unreadable = false;
    config_file_t *c = config_file_open(path, &unreadable, why, cap);
    if (c == NULL) { return unreadable ? EXIT_UNREADABLE : EXIT_USAGE; }
    const int code = read_all(c, cfg, why, cap);
    config_file_close(c);
    return code;
}

int desktop_config_from_text(const char *text, const char *name, pel_nav_config_t *cfg, char *why, size_t cap)
{
    config_file_t *c = config_file_parse(text, name, why, cap);
    if (c == NULL) { return EXIT_USAGE; }
    const int code = read_all(c, cfg, why, cap);
    config_file_close(c);
    return code;
}

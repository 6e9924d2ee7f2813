/* scenario.c - see scenario.h. Units of the file end here. */
#include "scenario.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "world.h"

#define ROOT_HOUR 60.0 /* sqrt(3600 s) */
#define MICRO_G   9.80665e-6

/* A table of the file: keys are looked up as "<prefix>.<key>". */
typedef struct {
    config_file_t *file;
    char prefix[96];
} table_t;

static const char *path_of(const table_t *t, const char *key)
{
    static char path[192];
    (void)snprintf(path, sizeof path, "%s%s%s", t->prefix, (t->prefix[0] != '\0') ? "." : "", key);
    return path;
}

static table_t table(config_file_t *file, const char *prefix)
{
    table_t t = {.file = file};
    (void)snprintf(t.prefix, sizeof t.prefix, "%s", prefix);
    return t;
}

static table_t element(const table_t *in, const char *key, int i)
{
    char prefix[64];
    table_t t = {.file = in->file};
    (void)snprintf(prefix, sizeof prefix, "%.60s", path_of(in, key));
    (void)snprintf(t.prefix, sizeof t.prefix, "%s[%d]", prefix, i);
    return t;
}

static bool has(const table_t *t, const char *key)
{
    return config_file_has(t->file, path_of(t, key));
}

/* A number within [low, high], times a unit. */
static double number(const table_t *t, const char *key, double fallback, double low, double high, double unit)
{
    const double x = config_file_number(t->file, path_of(t, key), fallback);
    if (!(x >= low && x <= high)) {
        char what[96];
        (void)snprintf(what, sizeof what, "is %g, must be within %g to %g", x, low, high);
        config_file_complain(t->file, path_of(t, key), what);
        return fallback * unit;
    }
    return x * unit;
}

static double positive(const table_t *t, const char *key, double fallback, double unit)
{
    return number(t, key, fallback, 0.0, 1e12, unit);
}

static double any(const table_t *t, const char *key, double fallback, double unit)
{
    return number(t, key, fallback, -1e12, 1e12, unit);
}

static bool flag(const table_t *t, const char *key, bool fallback)
{
    return config_file_bool(t->file, path_of(t, key), fallback);
}

static const char *text(const table_t *t, const char *key, const char *fallback)
{
    return config_file_string(t->file, path_of(t, key), fallback);
}

static int size(const table_t *t, const char *key)
{
    return config_file_array_size(t->file, path_of(t, key));
}

/* Which of the words the text is; complains and gives the first where it is none. */
static int word(const table_t *t, const char *key, const char *fallback, const char *const *words, int n)
{
    const char *given = text(t, key, fallback);
    char what[160] = "must be one of";
    for (int i = 0; i < n; i++) {
        if (strcmp(given, words[i]) == 0) { return i; }
        const size_t used = strlen(what);
        (void)snprintf(what + used, sizeof what - used, " \"%s\"", words[i]);
    }
    config_file_complain(t->file, path_of(t, key), what);
    return 0;
}

/* ---- motion ------------------------------------------------------------------------------------------------------ */

static void place(const table_t *t, double llh[3])
{
    if (!has(t, "lat_deg") || !has(t, "lon_deg")) {
        config_file_complain(t->file, t->prefix, "needs lat_deg and lon_deg");
    }
    llh[0] = number(t, "lat_deg", 0.0, -89.0, 89.0, WORLD_DEG);
    llh[1] = number(t, "lon_deg", 0.0, -360.0, 360.0, WORLD_DEG);
    llh[2] = number(t, "height_m", 0.0, -1000.0, 20000.0, 1.0);
}

static void read_waves(const table_t *root, motion_config_t *m)
{
    static const char *const axes[6] = {"roll", "pitch", "yaw", "east", "north", "up"};
    const int n = size(root, "wave");
    if (n > MOTION_MAX_WAVES) { config_file_complain(root->file, "wave", "is more than 16 waves"); }
    for (int i = 0; i < n && i < MOTION_MAX_WAVES; i++) {
        const table_t t = element(root, "wave", i);
        wave_t *w = &m->waves[m->n_waves++];
        w->axis = (wave_axis_t)word(&t, "axis", "", axes, 6);
        w->amplitude =
            (w->axis <= WAVE_YAW) ? any(&t, "amplitude_deg", 0.0, WORLD_DEG) : any(&t, "amplitude_m", 0.0, 1.0);
        w->rate_hz = positive(&t, "rate_hz", 1.0, 1.0);
        w->phase = any(&t, "phase_deg", 0.0, WORLD_DEG);
    }
}

static void read_motion(const table_t *root, scenario_t *s)
{
    const table_t start = table(root->file, "start");
    const table_t motion = table(root->file, "motion");
    motion_config_t *m = &s->motion;
    place(&start, m->llh);
    m->heading = any(&start, "heading_deg", 0.0, WORLD_DEG);
    m->roll = number(&start, "roll_deg", 0.0, -60.0, 60.0, WORLD_DEG);
    m->pitch = number(&start, "pitch_deg", 0.0, -60.0, 60.0, WORLD_DEG);
    m->speed = number(&start, "speed_mps", 0.0, 0.0, 10000.0, 1.0);
    m->bank = flag(&motion, "bank", false);
    m->pitch_along_path = flag(&motion, "pitch_along_path", true);
    m->wave_speed = positive(&motion, "wave_speed_mps", 0.0, 1.0);
    m->wave_delay_s = positive(&motion, "wave_delay_s", 0.0, 1.0);
    read_waves(root, m);
}

/* Legs are written out into one list of segments; speeds become changes of speed. */
static bool read_legs(const table_t *root, scenario_t *s)
{
    double speed = s->motion.speed;
    const int n_legs = size(root, "leg");
    for (int l = 0; l < n_legs; l++) {
        const table_t leg = element(root, "leg", l);
        const int n = size(&leg, "segment");
        const int repeat = (int)number(&leg, "repeat", 1.0, 1.0, 10000.0, 1.0);
        (void)text(&leg, "name", "");
        segment_t *grown = realloc(s->segments, (size_t)(s->n_segments + n * repeat + 1) * sizeof *grown);
        if (grown == NULL) { return false; }
        s->segments = grown;
        for (int r = 0; r < repeat; r++) {
            for (int i = 0; i < n; i++) {
                const table_t t = element(&leg, "segment", i);
                segment_t *to = &s->segments[s->n_segments++];
                const double to_speed = number(&t, "to_speed_mps", speed, 0.0, 10000.0, 1.0);
                to->duration_s = number(&t, "duration_s", 1.0, 1e-3, 1e6, 1.0);
                to->speed_change = to_speed - speed;
                to->turn = any(&t, "turn_deg", 0.0, WORLD_DEG);
                to->climb = any(&t, "climb_m", 0.0, 1.0);
                speed = to_speed;
            }
        }
    }
    return true;
}

/* ---- sensors ------------------------------------------------------------------------------------------------------ */

static void read_line(const table_t *t, double latency_ms, line_config_t *line)
{
    line->latency_s = number(t, "latency_ms", latency_ms, 0.0, 10000.0, 1e-3);
    line->jitter_s = number(t, "jitter_ms", 0.0, 0.0, 10000.0, 1e-3);
    line->lost_frames = number(t, "lost_frames", 0.0, 0.0, 1.0, 1.0);
    line->bit_errors = number(t, "bit_errors", 0.0, 0.0, 1.0, 1.0);
}

static void read_imu(const table_t *root, scenario_t *s)
{
    imu_config_t *c = &s->imu;
    c->present = has(root, "imu");
    if (!c->present) { return; }
    const table_t t = table(root->file, "imu");
    c->interval_ns = (int64_t)llround(1e9 / number(&t, "rate_hz", 100.0, 1.0, 4000.0, 1.0));
    triad_config_t *g = &c->gyro;
    g->white = positive(&t, "arw_deg_rth", 0.0, WORLD_DEG / ROOT_HOUR);
    g->bias_sd = positive(&t, "gyro_bias_deg_h", 0.0, WORLD_DEG / 3600.0);
    g->markov_sd = positive(&t, "gyro_markov_deg_h", 0.0, WORLD_DEG / 3600.0);
    g->markov_tau_s = positive(&t, "gyro_tau_s", 3600.0, 1.0);
    g->scale_sd = positive(&t, "gyro_scale_ppm", 0.0, 1e-6);
    g->misalign_sd = positive(&t, "gyro_misalignment_arcsec", 0.0, WORLD_DEG / 3600.0);
    g->lsb = positive(&t, "gyro_lsb_deg", 0.0, WORLD_DEG);
    g->range = positive(&t, "gyro_range_deg_s", 0.0, WORLD_DEG);
    triad_config_t *a = &c->accel;
    a->white = positive(&t, "vrw_mps_rth", 0.0, 1.0 / ROOT_HOUR);
    a->bias_sd = positive(&t, "accel_bias_ug", 0.0, MICRO_G);
    a->markov_sd = positive(&t, "accel_markov_ug", 0.0, MICRO_G);
    a->markov_tau_s = positive(&t, "accel_tau_s", 3600.0, 1.0);
    a->scale_sd = positive(&t, "accel_scale_ppm", 0.0, 1e-6);
    a->misalign_sd = positive(&t, "accel_misalignment_arcsec", 0.0, WORLD_DEG / 3600.0);
    a->lsb = positive(&t, "accel_lsb_mps", 0.0, 1.0);
    a->range = positive(&t, "accel_range_mps2", 0.0, 1.0);
    if (config_file_numbers(t.file, path_of(&t, "mount_deg"), c->mount, 3)) {
        for (int i = 0; i < 3; i++) { c->mount[i] *= WORLD_DEG; }
    }
    c->time_offset_s = positive(&t, "time_offset_us", 0.0, 1e-6);
    read_line(&t, 1.0, &s->imu_line);
}

static void read_barometer(const table_t *root, scenario_t *s)
{
    barometer_config_t *b = &s->barometer;
    b->present = has(root, "barometer");
    if (!b->present) { return; }
    const table_t t = table(root->file, "barometer");
    b->interval_ns = (int64_t)llround(1e9 / number(&t, "rate_hz", 1.0, 0.01, 100.0, 1.0));
    b->noise_m = number(&t, "noise_m", 0.1, 1e-3, 60.0, 1.0);
    b->markov_m = positive(&t, "markov_m", 0.0, 1.0);
    b->markov_tau_s = number(&t, "tau_s", 300.0, 1.0, 1e6, 1.0);
}

static void read_signals(const table_t *t, receiver_config_t *c)
{
    const int n = size(t, "signals");
    if (n < 1 || n > RECEIVER_MAX_SIGNALS) {
        config_file_complain(t->file, path_of(t, "signals"), "must list 1 to 24 signals such as \"G1C\"");
        return;
    }
    for (int i = 0; i < n; i++) {
        if (!signal_parse(config_file_string_at(t->file, path_of(t, "signals"), i, ""), &c->signals[i])) {
            config_file_complain(t->file, path_of(t, "signals"), "holds something that is no signal such as \"G1C\"");
        }
    }
    c->n_signals = n;
}

static void read_receiver(const table_t *root, const char *name, double latency_ms, receiver_config_t *c,
                          line_config_t *line)
{
    c->present = has(root, name);
    if (!c->present) { return; }
    const table_t t = table(root->file, name);
    read_signals(&t, c);
    c->interval_ns = (int64_t)llround(1e9 / number(&t, "rate_hz", 1.0, 0.01, 100.0, 1.0));
    c->tag_offset_ns = (int64_t)llround(number(&t, "tag_offset_ms", 0.0, -500.0, 500.0, 1e6));
    c->mask = number(&t, "mask_deg", 5.0, 0.0, 60.0, WORLD_DEG);
    c->code_m = positive(&t, "code_m", 0.3, 1.0);
    c->phase_m = positive(&t, "phase_m", 0.003, 1.0);
    c->doppler_mps = positive(&t, "doppler_mps", 0.03, 1.0);
    c->elevation_law = flag(&t, "elevation_law", true);
    c->multipath_code_m = positive(&t, "multipath_code_m", 0.0, 1.0);
    c->multipath_phase_m = positive(&t, "multipath_phase_m", 0.0, 1.0);
    c->multipath_tau_s = positive(&t, "multipath_tau_s", 60.0, 1.0);
    c->rdss_hz = positive(&t, "rdss_mhz", 0.0, 1e6);
    c->path_walk_m = positive(&t, "path_walk_m", 0.0, 1.0);
    c->path_rate_mps = positive(&t, "path_rate_mps", 0.0, 1.0);
    c->path_accel_mps2 = positive(&t, "path_accel_mps2", 0.0, 1.0);
    c->zenith_delay_error_m = any(&t, "zenith_delay_error_m", 0.0, 1.0);
    c->clock_bias_s = number(&t, "clock_bias_us", 0.0, -1e5, 1e5, 1e-6);
    c->clock_drift = number(&t, "clock_drift_ppm", 0.0, -100.0, 100.0, 1e-6);
    c->clock_walk_m = positive(&t, "clock_walk_m", 0.0, 1.0);
    c->clock_drift_walk = positive(&t, "clock_drift_walk_mps", 0.0, 1.0);
    c->clock_steering = flag(&t, "clock_steering", true);
    c->slips_per_hour = positive(&t, "slips_per_hour", 0.0, 1.0);
    c->half_cycle_s = positive(&t, "half_cycle_s", 0.0, 1.0);
    c->lock_s = positive(&t, "lock_s", 0.0, 1.0);
    read_line(&t, latency_ms, line);
}

/* [[outage]] and [[slip]]: for one receiver or both. */
static void read_happenings(const table_t *root, const char *key, happening_kind_t kind, scenario_t *s)
{
    static const char *const receivers[3] = {"rover", "base", "both"};
    const int n = size(root, key);
    for (int i = 0; i < n; i++) {
        const table_t t = element(root, key, i);
        happening_t h = {.kind = kind};
        const int to = word(&t, "receiver", "rover", receivers, 3);
        if (!selector_parse(text(&t, "who", "all"), &h.who)) {
            config_file_complain(t.file, path_of(&t, "who"), "must be \"all\", \"G\", \"G05\" or \"G05:2\"");
        }
        if (kind == HAPPENS_OUTAGE) {
            h.from_s = positive(&t, "from_s", 0.0, 1.0);
            h.to_s = positive(&t, "to_s", 0.0, 1.0);
        } else {
            h.from_s = positive(&t, "at_s", 0.0, 1.0);
            h.cycles = any(&t, "cycles", 1.0, 1.0);
            h.silent = flag(&t, "silent", false);
        }
        receiver_config_t *const c[2] = {&s->rover, &s->base};
        for (int r = 0; r < 2; r++) {
            if (to != 2 && to != r) { continue; }
            if (c[r]->n_happenings >= RECEIVER_MAX_EVENTS) {
                config_file_complain(t.file, key, "is more than 64 for one receiver");
                return;
            }
            c[r]->happenings[c[r]->n_happenings++] = h;
        }
    }
}

/* ---- sky ----------------------------------------------------------------------------------------------------------- */

static void read_sky(const table_t *root, scenario_t *s)
{
    static const char *const kinds[3] = {"ideal24", "multi", "geo3"};
    const table_t t = table(root->file, "sky");
    s->sky.kind = (sky_kind_t)word(&t, "constellation", "multi", kinds, 3);
    s->sky.orbit_error_m = positive(&t, "orbit_error_m", 0.0, 1.0);
    s->sky.clock_error_m = positive(&t, "clock_error_m", 0.0, 1.0);
    s->sky.clocks = flag(&t, "clocks", true);
    s->ephemeris_interval_s = number(&t, "ephemeris_interval_s", 60.0, 1.0, 7200.0, 1.0);
    for (int i = 0; i < s->rover.n_signals; i++) { s->sky.systems[s->rover.signals[i].sys] = true; }
    for (int i = 0; i < s->base.n_signals; i++) { s->sky.systems[s->base.signals[i].sys] = true; }
}

static void read_air(const table_t *root, scenario_t *s)
{
    static const char *const kinds[3] = {"none", "shell", "klobuchar"};
    const table_t t = table(root->file, "atmosphere");
    atmosphere_t *a = &s->air;
    a->troposphere = flag(&t, "troposphere", true);
    a->humidity = number(&t, "humidity", 0.7, 0.0, 1.0, 1.0);
    a->iono = (iono_kind_t)word(&t, "ionosphere", "none", kinds, 3);
    a->origin[0] = s->motion.llh[0];
    a->origin[1] = s->motion.llh[1];
    if (a->iono == IONO_SHELL) {
        a->vertical_m = number(&t, "vertical_m", 2.0, 0.0, 100.0, 1.0);
        double gradient[2] = {0.0, 0.0};
        (void)config_file_numbers(t.file, path_of(&t, "gradient_mm_per_km"), gradient, 2);
        a->gradient[0] = 1e-3 * gradient[0];
        a->gradient[1] = 1e-3 * gradient[1];
    }
    if (a->iono == IONO_KLOBUCHAR) { /* a moderate day; powers of two, as the message carries them */
        static const float alpha[4] = {0x1p-26f, 0x1p-27f, -0x1p-24f, 0x0p0f};
        static const float beta[4] = {98304.0f, 65536.0f, -196608.0f, -65536.0f};
        memcpy(a->klobuchar.alpha, alpha, sizeof alpha);
        memcpy(a->klobuchar.beta, beta, sizeof beta);
        a->klobuchar.valid = true;
        a->klobuchar_scale = number(&t, "scale", 1.0, 0.0, 5.0, 1.0);
    }
}

static void read_base(const table_t *root, scenario_t *s)
{
    static const char *const formats[2] = {"ubx", "rtcm3"};
    read_receiver(root, "base", 200.0, &s->base, &s->base_line);
    if (!s->base.present) { return; }
    const table_t t = table(root->file, "base");
    double llh[3];
    place(&t, llh);
    world_llh_to_ecef(llh, s->base_r_e);
    s->base_format = (format_t)word(&t, "format", "rtcm3", formats, 2);
    s->base_ephemerides = flag(&t, "ephemerides", false);
    s->station_id = (uint16_t)number(&t, "station", 1.0, 0.0, 4095.0, 1.0);
}

/* Only what the simulator must know of the navigator's table; the rest is the navigator's to check. */
static void read_navigator(const table_t *root, scenario_t *s)
{
    const table_t t = table(root->file, "navigator.start");
    config_file_allow(root->file, "navigator");
    s->draw_start = has(&t, "sd_tilt_deg") && has(&t, "sd_heading_deg") && !has(&t, "attitude_deg");
    s->sd_tilt = positive(&t, "sd_tilt_deg", 0.0, WORLD_DEG);
    s->sd_heading = positive(&t, "sd_heading_deg", 0.0, WORLD_DEG);
}

bool scenario_read(config_file_t *file, const char *path, scenario_t *s, char *why, size_t cap)
{
    memset(s, 0, sizeof *s);
    const table_t root = table(file, "");
    const table_t time = table(file, "time");
    (void)snprintf(s->path, sizeof s->path, "%s", path);
    (void)snprintf(s->name, sizeof s->name, "%s", text(&root, "name", "unnamed"));
    s->seed = (uint64_t)config_file_integer(file, "seed", 1);
    const double week = number(&time, "week", 2300.0, 1024.0, 4000.0, 1.0);
    s->start_ns = pel_time_from_week((int32_t)week, number(&time, "tow_s", 0.0, 0.0, 604799.0, 1.0));

    read_motion(&root, s);
    const bool ok = read_legs(&root, s);
    double legs_s = 0.0;
    for (int i = 0; i < s->n_segments; i++) { legs_s += s->segments[i].duration_s; }
    s->duration_s = number(&root, "duration_s", (legs_s > 0.0) ? legs_s : 60.0, 1.0, 1e6, 1.0);

    read_imu(&root, s);
    read_barometer(&root, s);
    read_receiver(&root, "rover", 60.0, &s->rover, &s->rover_line);
    read_base(&root, s);
    if (!s->rover.present && !s->imu.present) { config_file_complain(file, "rover", "is missing, and so is imu"); }
    read_sky(&root, s);
    read_air(&root, s);
    read_happenings(&root, "outage", HAPPENS_OUTAGE, s);
    read_happenings(&root, "slip", HAPPENS_SLIP, s);
    (void)config_file_numbers(file, "antenna.lever_arm_m", s->lever_b, 3);

    const table_t events = table(file, "events");
    s->event_first_s = positive(&events, "first_s", 0.0, 1.0);
    s->event_interval_s = number(&events, "interval_s", 1.0, 1e-3, 1e6, 1.0);
    s->event_sd_s = positive(&events, "time_sd_us", 0.0, 1e-6);
    s->n_events = (int64_t)number(&events, "count", 0.0, 0.0, 1e6, 1.0);
    s->truth_interval_s = number(&root, "truth_interval_s", 0.1, 0.001, 1000.0, 1.0);
    read_navigator(&root, s);

    if (!ok) {
        (void)snprintf(why, cap, "%s: out of memory", path);
    } else if (config_file_check(file, why, cap) == 0) {
        return true;
    }
    scenario_free(s);
    return false;
}

void scenario_free(scenario_t *s)
{
    free(s->segments);
    s->segments = NULL;
    s->n_segments = 0;
}

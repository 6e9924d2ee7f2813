/* vehicle.c - what is known without a satellite: the place at the start, standing still there, the height (S3 sections 8 and 10).
 * What wheels do is in wheels.c.
 *
 * The height's reference is a map or the height of the start, or a barometer; its deviation from the truth (terrain, weather) is a
 * first-order Markov state behind the model's own. */
#include "internal.h"

#include "pelorus/earth.h"
#include "pelorus/math.h"

#define STANDS_SD_MPS 0.005 /* of a vehicle that stands: its engine shakes it */
#define HEIGHT_SD_M   0.01  /* of a row on a constant reference: what it is off by is the deviation's */
#define BARO_FRESH_S  0.5
#define GATE_SIGMA    PEL_R(5.0)
#define PLACED_SD_MPS 0.001

void pel_nav_vehicle_init(pel_navigator_t *nav)
{
    nav->vehicle.height_state = -1;
    nav->vehicle.at_place = nav->cfg.vehicle.place_known;
}

bool pel_nav_vehicle_place(const pel_navigator_t *nav, double r_eb_e[3])
{
    const pel_vehicle_config_t *v = &nav->cfg.vehicle;
    if (!nav->vehicle.at_place) { return false; }
    pel_earth_llh_to_ecef(v->lat_rad, v->lon_rad, v->height_m, r_eb_e);
    return true;
}

static bool is_told_to_stand(const pel_navigator_t *nav)
{
    const int64_t standing_ns = (int64_t)(nav->cfg.vehicle.standing_s * 1e9);
    return nav->first_imu_ns != 0 && nav->at_horizon.t_ns <= nav->first_imu_ns + standing_ns;
}

pel_status_t pel_nav_vehicle_begin(pel_navigator_t *nav)
{
    const pel_vehicle_config_t *v = &nav->cfg.vehicle;
    pel_status_t status = PEL_OK;
    if (nav->vehicle.at_place) {
        double P[3][3] = {{0}}, r[3];
        (void)pel_nav_vehicle_place(nav, r);
        for (int k = 0; k < 3; k++) {
            nav->at_horizon.r_eb_e[k] = r[k];
            nav->at_horizon.v_eb_e[k] = 0.0;
            P[k][k] = v->sd_place_m * v->sd_place_m;
        }
        status = pel_ud_set_block3(&nav->ud, pel_model_index(&nav->model, PEL_BLOCK_POSITION), P);
        for (int k = 0; k < 3; k++) { P[k][k] = PLACED_SD_MPS * PLACED_SD_MPS; }
        if (status == PEL_OK) {
            status = pel_ud_set_block3(&nav->ud, pel_model_index(&nav->model, PEL_BLOCK_VELOCITY), P);
        }
        nav->vehicle.at_place = false; /* good for one start */
    }
    double lat, lon;
    pel_earth_ecef_to_llh(nav->at_horizon.r_eb_e, &lat, &lon, &nav->vehicle.start_height_m);
    nav->vehicle.height_state = -1;
    nav->vehicle.deviation_m = 0.0;
    nav->vehicle.updated_ns = nav->at_horizon.t_ns;
    if (v->height == PEL_HEIGHT_NONE || status != PEL_OK) { return status; }
    status = pel_ud_insert(&nav->ud, nav->ud.n, (pel_real)(v->sd_height_m * v->sd_height_m));
    nav->vehicle.height_state = (int16_t)nav->model.n;
    nav->model.n = nav->ud.n;
    return status;
}

void pel_nav_vehicle_baro(pel_navigator_t *nav, const pel_baro_t *baro)
{
    nav->vehicle.baro = *baro;
    nav->vehicle.baro_waits = true;
}

void pel_nav_known_row(pel_navigator_t *nav, const pel_nav_axes_t *axes, const pel_antenna_t *ant, pel_row_t *row,
                       double sd, pel_real gate)
{
    pel_nav_turn_row(axes, ant, row);
    row->var = (pel_real)(sd * sd);
    const bool used = pel_ud_update(&nav->ud, row->h, row->first, row->z, row->var, gate, NULL) == PEL_OK;
    nav->counters.rows_used += used;
    nav->counters.rows_gated += !used;
}

void pel_nav_rest_rows(pel_navigator_t *nav, const pel_nav_axes_t *axes, const pel_antenna_t *ant, double sd_mps,
                       pel_real gate)
{
    for (int k = 0; k < 3; k++) {
        double along_e[3] = {0.0, 0.0, 0.0};
        pel_row_t row;
        along_e[k] = 1.0;
        pel_observe_velocity(ant, along_e, nav->at_horizon.v_eb_e[k], &row);
        pel_nav_known_row(nav, axes, ant, &row, sd_mps, gate);
    }
}

/* The reference at the horizon and how noisy it is; false: there is none now. */
static bool reference(pel_navigator_t *nav, double v_up_mps, double *height_m, double *sd_m)
{
    const pel_baro_t *baro = &nav->vehicle.baro;
    *height_m = nav->vehicle.start_height_m;
    *sd_m = HEIGHT_SD_M;
    if (nav->cfg.vehicle.height == PEL_HEIGHT_CONSTANT) { return true; }
    if (!nav->vehicle.baro_waits || baro->t_ns > nav->at_horizon.t_ns) { return false; }
    const double age_s = pel_time_diff_s(nav->at_horizon.t_ns, baro->t_ns);
    nav->vehicle.baro_waits = false; /* each sample counts once */
    *height_m = baro->height_m + age_s * v_up_mps;
    *sd_m = (double)baro->sd_m;
    return age_s < BARO_FRESH_S;
}

static void height_row(pel_navigator_t *nav, const pel_nav_axes_t *axes)
{
    const pel_strapdown_t *s = &nav->at_horizon;
    double lat, lon, h, C_e_enu[3][3], reference_m, sd_m;
    pel_antenna_t imu = nav->update.ant; /* the reference is that of the IMU's point */
    pel_row_t row;
    pel_earth_ecef_to_llh(s->r_eb_e, &lat, &lon, &h);
    pel_earth_C_e_enu(lat, lon, C_e_enu);
    if (!reference(nav, pel_dot3(C_e_enu[2], s->v_eb_e), &reference_m, &sd_m)) { return; }
    for (int k = 0; k < 3; k++) { imu.lever_e[k] = 0.0; }
    const double dh_m = h - reference_m - nav->vehicle.deviation_m;
    pel_observe_height(&imu, C_e_enu[2], dh_m, nav->vehicle.height_state, &row);
    pel_nav_known_row(nav, axes, &nav->update.ant, &row, sd_m, GATE_SIGMA);
}

/* The deviation of the height's reference since the epoch before. */
static void age_deviation(pel_navigator_t *nav)
{
    const pel_vehicle_config_t *v = &nav->cfg.vehicle;
    const double dt_s = pel_time_diff_s(nav->at_horizon.t_ns, nav->vehicle.updated_ns);
    pel_real decay[PEL_MAX_STATES] = {0}, q[PEL_MAX_STATES] = {0};
    nav->vehicle.updated_ns = nav->at_horizon.t_ns;
    if (!(dt_s > 0.0)) { return; }
    const double d = pel_exp(-dt_s / v->tau_height_s) - 1.0;
    decay[nav->vehicle.height_state] = (pel_real)d;
    q[nav->vehicle.height_state] = (pel_real)(-v->sd_height_m * v->sd_height_m * d * (2.0 + d));
    nav->vehicle.deviation_m += d * nav->vehicle.deviation_m;
    (void)pel_ud_decay(&nav->ud, decay, q);
}

void pel_nav_vehicle_rows(pel_navigator_t *nav)
{
    pel_nav_axes_t axes;
    if (!nav->ins) { return; }
    pel_nav_axes(nav, &axes);
    if (is_told_to_stand(nav)) { pel_nav_rest_rows(nav, &axes, &nav->update.ant, STANDS_SD_MPS, GATE_SIGMA); }
    if (nav->vehicle.height_state < 0) { return; }
    age_deviation(nav);
    height_row(nav, &axes);
}

void pel_nav_vehicle_close_loop(pel_navigator_t *nav)
{
    if (!nav->ins || nav->vehicle.height_state < 0) { return; }
    nav->vehicle.deviation_m -= (double)nav->ud.x[nav->vehicle.height_state];
}

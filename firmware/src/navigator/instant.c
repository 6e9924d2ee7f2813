/* instant.c - the true instant of a rover epoch, and the state brought to it. */
#include "internal.h"

#include "pelorus/math.h"

#define STALE_CLOCK_S 60.0
#define WEAK_VAR_M2   25.0
#define LOST_SD_M     20.0
#define AGREE_M       300.0 /* codes at a place that an INS knows after minutes; orbits of another hour are off by far more */

static double zenith_sd(double a, double b)
{
    return pel_sqrt(a * a + b * b);
}

static void insert_sorted(double *x, int n, double v)
{
    int j = n;
    for (; j > 0 && x[j - 1] > v; j--) { x[j] = x[j - 1]; }
    x[j] = v;
}

/* The receiver's clock from codes alone where the place is known: the median, for too few satellites for a single-point solution. The half
 * of them around it must agree, or the epoch is not of the time it says. */
static bool clock_at_place(pel_navigator_t *nav, const pel_epoch_t *rover, double *clk_m)
{
    double residual[PEL_MAX_SATS], place[3];
    const double *r = nav->now.r_eb_e;
    int n = 0;
    if (!nav->ins) {
        if (!pel_nav_vehicle_place(nav, place)) { return false; }
        r = place;
    }
    if (pel_view_compute(rover, &nav->orbits, rover->t_ns, r, NULL, nav->cfg.mask_rad, NULL, &nav->view_rover) !=
        PEL_OK) {
        return false;
    }
    for (int i = 0; i < rover->n && n < PEL_MAX_SATS; i++) {
        const pel_obs_t *o = &rover->obs[i];
        const pel_sight_t *s = pel_view_find(&nav->view_rover, o->sys, o->prn);
        if (s == NULL || !pel_obs_usable(o, PEL_OBS_CODE)) { continue; }
        insert_sorted(residual, n++, o->P_m - pel_sight_code_m(s, o));
    }
    if (n < 2 || residual[3 * n / 4] - residual[n / 4] > AGREE_M) { return false; }
    *clk_m = residual[n / 2];
    return true;
}

/* True receive time of the epoch. Single-point solution if there is one, else the receiver clock of the last one. */
static bool true_time(pel_navigator_t *nav, const pel_epoch_t *rover, bool *solved, pel_time_t *t_ns)
{
    pel_spp_config_t cfg;
    pel_spp_default(&cfg);
    cfg.mask_rad = nav->cfg.mask_rad;
    cfg.code_sd_m = zenith_sd(nav->cfg.noise_single.code_a_m, nav->cfg.noise_single.code_b_m);
    cfg.doppler_sd_mps = zenith_sd(nav->cfg.noise_single.doppler_a_mps, nav->cfg.noise_single.doppler_b_mps);
    pel_spp_t spp;
    const pel_status_t status =
        pel_spp_solve(rover, &nav->orbits, &cfg, nav->have_spp ? &nav->spp : NULL, NULL, &nav->view_rover, &spp);
    *solved = status >= 0;
    if (*solved && !pel_nav_spp_is_plausible(&spp)) {
        nav->counters.epochs_spp_failed++;
        return false;
    }
    if (*solved) {
        nav->spp = spp;
        nav->have_spp = true;
        *t_ns = spp.t_ns;
        return true;
    }
    nav->counters.epochs_spp_failed++;
    const double age_s = pel_time_diff_s(rover->t_ns, nav->spp.t_ns);
    double clk_m = nav->spp.clk_m + nav->spp.clk_rate_mps * age_s;
    const bool stale = !nav->have_spp || age_s > STALE_CLOCK_S;
    if (stale && !clock_at_place(nav, rover, &clk_m)) { return false; }
    *t_ns = rover->t_ns - (int64_t)pel_round(clk_m / PEL_SPEED_OF_LIGHT * 1e9);
    return true;
}

/* GNSS alone over a long silence knows its place worse than the epoch's own code does. Rows are linear and the troposphere right
 * only near the truth: the single-point solution comes first, as a measurement so weak that the code's rows still count. */
static void draw_lost_position(pel_navigator_t *nav)
{
    const int i_r = pel_model_index(&nav->model, PEL_BLOCK_POSITION);
    double P[3][3];
    if (nav->ins) { return; }
    pel_ud_block3(&nav->ud, i_r, i_r, P);
    if (P[0][0] + P[1][1] + P[2][2] < LOST_SD_M * LOST_SD_M) { return; }
    for (int k = 0; k < 3; k++) {
        pel_real h[PEL_MAX_STATES] = {0};
        h[i_r + k] = PEL_R(1.0);
        const double z = nav->at_horizon.r_eb_e[k] - nav->spp.r_ea_e[k];
        const double var = 4.0 * nav->spp.cov_r_e[k][k] + WEAK_VAR_M2;
        (void)pel_ud_update(&nav->ud, h, i_r + k, (pel_real)z, (pel_real)var, 0, NULL);
    }
    pel_nav_close_loop(nav);
}

/* From the single-point solution, else from the place where it is known to stand. */
static bool start(pel_navigator_t *nav, bool solved, pel_time_t t_ns)
{
    pel_spp_t at_rest = {.t_ns = t_ns, .has_velocity = true};
    if (!solved && !pel_nav_vehicle_place(nav, at_rest.r_ea_e)) { return false; }
    pel_nav_start_gnss(nav, solved ? &nav->spp : &at_rest);
    return nav->have_state;
}

/* Bring the state to the instant, starting it if there is none. */
static bool reach(pel_navigator_t *nav, bool solved, pel_time_t t_ns)
{
    if (nav->have_state) {
        pel_status_t status = pel_nav_advance(nav, t_ns);
        if (status == PEL_E_STALE && t_ns < nav->at_horizon.t_ns) {
            nav->counters.epochs_late++;
            return false;
        }
        if (status == PEL_E_MISSING) { /* the IMU has gone */
            pel_nav_drop_ins(nav);
            status = pel_nav_advance(nav, t_ns);
        }
        if (status == PEL_OK) {
            if (solved) { draw_lost_position(nav); }
            return true;
        }
        nav->counters.restarts++;
        pel_nav_stop(nav); /* also where no start follows: an INS without its factors must not go on telling */
    }
    return start(nav, solved, t_ns);
}

bool pel_nav_reach_epoch(pel_navigator_t *nav, const pel_epoch_t *rover)
{
    bool solved = false;
    pel_time_t t_ns = 0;
    return true_time(nav, rover, &solved, &t_ns) && reach(nav, solved, t_ns);
}

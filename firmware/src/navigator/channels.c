/* channels.c - GLONASS phases: every satellite has its own wavelength, and every receiver delays each channel a little differently.
 *
 * lambda_k = lambda_0 / (1 + EPSILON k). A number of the datum that is wrong by d cycles moves all phases by lambda_k d, that is,
 * by a common length (a clock) and by -EPSILON lambda_0 d a channel. The delays of a receiver's channels are linear in k too (Wanninger
 * 2012: up to 5 cm a channel between makes, none between two of one make). So one slope a carrier, in metres a channel, is all that
 * stands between GLONASS phases and integers, whatever the datum. It is a filter state with a wide prior, and stays known when the
 * satellites go: docs/NAVIGATOR.md. */
#include "internal.h"

#define EPSILON    (0.5625 / 1602.0) /* the same on both carriers */
#define SLOPE_SD_M 0.025             /* a channel, between receivers of any make */

static pel_channels_t *of_carrier(pel_navigator_t *nav, uint8_t carrier)
{
    return &nav->track.channels[carrier < PEL_GLO_CARRIERS ? carrier : 0];
}

static const pel_channels_t *of_carrier_const(const pel_navigator_t *nav, uint8_t carrier)
{
    return &nav->track.channels[carrier < PEL_GLO_CARRIERS ? carrier : 0];
}

static double channels_apart(const pel_sd_t *sd, const pel_sd_t *ref)
{
    return (sd->sys == PEL_SYS_GLO) ? (double)(sd->glo_k - ref->glo_k) : 0.0;
}

void pel_nav_channels_init(pel_navigator_t *nav)
{
    for (int i = 0; i < PEL_GLO_CARRIERS; i++) {
        nav->track.channels[i] = (pel_channels_t){.state = -1, .var_m2 = SLOPE_SD_M * SLOPE_SD_M};
    }
}

void pel_nav_channels_forget(pel_navigator_t *nav)
{
    for (int i = 0; i < PEL_GLO_CARRIERS; i++) { nav->track.channels[i].state = -1; }
}

bool pel_nav_channels_ready(const pel_navigator_t *nav, const pel_sd_t *sd)
{
    return sd->sys != PEL_SYS_GLO || of_carrier_const(nav, sd->carrier)->state >= 0;
}

void pel_nav_channels_new_datum(pel_navigator_t *nav, const pel_sd_t *sd)
{
    pel_channels_t *c = of_carrier(nav, sd->carrier);
    const double sd_datum_m = EPSILON * PEL_NAV_DATUM_CODE_M;
    if (sd->sys != PEL_SYS_GLO) { return; }
    if (c->state < 0) {
        c->var_m2 += sd_datum_m * sd_datum_m;
        if (pel_ud_insert(&nav->ud, nav->ud.n, (pel_real)c->var_m2) != PEL_OK) { return; }
        c->state = (int16_t)(nav->ud.n - 1);
        nav->model.n = nav->ud.n;
        return;
    }
    pel_real unit[PEL_MAX_STATES] = {0};
    unit[c->state] = PEL_R(1.0);
    pel_ud_rank_one(&nav->ud, c->state + 1, unit, (pel_real)(sd_datum_m * sd_datum_m));
}

double pel_nav_channels_offset_m(const pel_navigator_t *nav, const pel_sd_t *sd, const pel_sd_t *ref)
{
    return channels_apart(sd, ref) * of_carrier_const(nav, sd->carrier)->slope_m;
}

double pel_nav_channels_sd_m(const pel_navigator_t *nav, uint8_t carrier)
{
    const pel_channels_t *c = of_carrier_const(nav, carrier);
    return pel_sqrt((c->state >= 0) ? (double)pel_ud_cov(&nav->ud, c->state, c->state) : c->var_m2);
}

void pel_nav_channels_put(const pel_navigator_t *nav, const pel_sd_t *sd, const pel_sd_t *ref, pel_row_t *row)
{
    const pel_channels_t *c = of_carrier_const(nav, sd->carrier);
    if (sd->sys == PEL_SYS_GLO && c->state >= 0) { row->h[c->state] = (pel_real)channels_apart(sd, ref); }
}

double pel_nav_channels_number(const pel_sd_t *sd)
{
    return pel_round((sd->phase_m - sd->code_m) / sd->lambda_m);
}

void pel_nav_channels_close_loop(pel_navigator_t *nav)
{
    for (int i = 0; i < PEL_GLO_CARRIERS; i++) {
        pel_channels_t *c = &nav->track.channels[i];
        if (c->state < 0) { continue; }
        c->slope_m -= (double)nav->ud.x[c->state];
        c->var_m2 = (double)pel_ud_cov(&nav->ud, c->state, c->state);
    }
}

void pel_nav_channels_shift(pel_navigator_t *nav, int removed)
{
    for (int i = 0; i < PEL_GLO_CARRIERS; i++) {
        if (nav->track.channels[i].state > removed) { nav->track.channels[i].state--; }
    }
}

#include "glonass.h"

#include <string.h>

#include "pelorus/math.h"

/* PZ-90.11 (ICD GLONASS, general description of CDMA, 2016, table 5.1): what the control segment integrates with. */
#define MU       3.986004418e14
#define A_E      6378136.0
#define J2       1.08262575e-3
#define OMEGA    7.292115e-5
#define STEP_S   60.0
#define MAX_TK_S 3600.0 /* 60 steps; an ephemeris is meant for a quarter of an hour */

/* Position and velocity, and their derivative, in axes that turn with the Earth. */
typedef struct {
    double r[3], v[3];
} state_t;

/* ICD GLONASS 5.1, A.3.1.2, simplified: central force, flattening, rotation of the axes; Sun and Moon as broadcast. */
static state_t derivative(const state_t *x, const double a_sun_moon[3])
{
    const double r_sq = pel_dot3(x->r, x->r);
    const double g = MU / (r_sq * pel_sqrt(r_sq));
    const double f = 1.5 * J2 * g * A_E * A_E / r_sq;
    const double z_sq = 5.0 * x->r[2] * x->r[2] / r_sq;
    const double across = OMEGA * OMEGA - g - f * (1.0 - z_sq);
    state_t d;
    memcpy(d.r, x->v, sizeof d.r);
    d.v[0] = across * x->r[0] + 2.0 * OMEGA * x->v[1] + a_sun_moon[0];
    d.v[1] = across * x->r[1] - 2.0 * OMEGA * x->v[0] + a_sun_moon[1];
    d.v[2] = (-g - f * (3.0 - z_sq)) * x->r[2] + a_sun_moon[2];
    return d;
}

/* x + h d */
static state_t advanced(const state_t *x, double h, const state_t *d)
{
    state_t y;
    for (int i = 0; i < 3; i++) {
        y.r[i] = x->r[i] + h * d->r[i];
        y.v[i] = x->v[i] + h * d->v[i];
    }
    return y;
}

/* Classical Runge-Kutta of fourth order: at steps of a minute 0.3 mm in half an hour. */
static void step(state_t *x, double h, const double a[3])
{
    const state_t k1 = derivative(x, a);
    const state_t x2 = advanced(x, 0.5 * h, &k1);
    const state_t k2 = derivative(&x2, a);
    const state_t x3 = advanced(x, 0.5 * h, &k2);
    const state_t k3 = derivative(&x3, a);
    const state_t x4 = advanced(x, h, &k3);
    const state_t k4 = derivative(&x4, a);
    for (int i = 0; i < 3; i++) {
        x->r[i] += h / 6.0 * (k1.r[i] + 2.0 * (k2.r[i] + k3.r[i]) + k4.r[i]);
        x->v[i] += h / 6.0 * (k1.v[i] + 2.0 * (k2.v[i] + k3.v[i]) + k4.v[i]);
    }
}

pel_status_t pel_glo_state(const pel_ephemeris_t *eph, double tk, pel_sat_state_t *out)
{
    state_t x;
    if (!(pel_fabs(tk) <= MAX_TK_S)) { return PEL_E_RANGE; }
    memcpy(x.r, eph->glo.r_e, sizeof x.r);
    memcpy(x.v, eph->glo.v_e, sizeof x.v);

    const double h = (tk < 0.0) ? -STEP_S : STEP_S;
    double left = tk;
    while (pel_fabs(left) > STEP_S) {
        step(&x, h, eph->glo.a_e);
        left -= h;
    }
    step(&x, left, eph->glo.a_e); /* the remainder last: neighbouring instants share the steps before it */
    const double r = pel_norm3(x.r);
    if (!(r > 2.0e7 && r < 3.5e7)) { return PEL_E_RANGE; }

    memcpy(out->r_e, x.r, sizeof out->r_e);
    memcpy(out->v_e, x.v, sizeof out->v_e);
    out->clk_s = eph->af0 + eph->af1 * tk; /* relativity is in tau and gamma (ICD 3.3.3) */
    out->clk_rate = eph->af1;
    return PEL_OK;
}

/* increments.h - coning and sculling, shared by the mechanizations (docs/FILTER.md). Private to the room. */
#ifndef PELORUS_INCREMENTS_H
#define PELORUS_INCREMENTS_H

#include "pelorus/inertial.h"
#include "pelorus/math.h"

/* Factor of (previous x this) for rates linear in time, intervals T1 (previous) and T2: T2^2 / (6 T1 (T1 + T2)); 1/12 when
 * they are equal. */
static inline double coning_factor(double T1, double T2)
{
    if (T1 == T2) { return 1.0 / 12.0; }
    return (T1 > 0.0) ? T2 * T2 / (6.0 * T1 * (T1 + T2)) : 0.0;
}

/* y += a x. Written out, like all of this file's vector work: loops of three cost as much as their content. */
static inline void add_scaled(double y[3], double a, const double x[3])
{
    y[0] += a * x[0];
    y[1] += a * x[1];
    y[2] += a * x[2];
}

static inline void copy3(double to[3], const double from[3])
{
    to[0] = from[0];
    to[1] = from[1];
    to[2] = from[2];
}

/* An increment much shorter than its predecessor (one cut at a GNSS epoch) would give a poor rate: it is joined to it. */
static inline void remember(pel_coning_t *c, const double alpha[3], const double upsilon[3], double dt_s)
{
    if (dt_s < 0.5 * c->dt_s) {
        add_scaled(c->alpha, 1.0, alpha);
        add_scaled(c->upsilon, 1.0, upsilon);
        c->dt_s += dt_s;
    } else {
        copy3(c->alpha, alpha);
        copy3(c->upsilon, upsilon);
        c->dt_s = dt_s;
    }
}

/* Rotation vector of the body over the step, and its specific-force increment resolved in the body axes at the start:
 *     phi = alpha + k alpha' x alpha
 *     dv = upsilon + alpha x upsilon / 2 + alpha x (alpha x upsilon) / 6 + k (alpha' x upsilon + upsilon' x alpha)
 * with ' the previous increment. */
static inline void correct_increments(const pel_coning_t *c, double k, const double alpha[3], const double upsilon[3],
                                      double phi[3], double dv[3])
{
    double w[3];
    double x[3];
    copy3(phi, alpha);
    pel_cross3(c->alpha, alpha, x);
    add_scaled(phi, k, x);

    copy3(dv, upsilon);
    pel_cross3(alpha, upsilon, w);
    add_scaled(dv, 0.5, w);
    pel_cross3(alpha, w, x);
    add_scaled(dv, 1.0 / 6.0, x);
    pel_cross3(c->alpha, upsilon, w);
    pel_cross3(c->upsilon, alpha, x);
    dv[0] += k * (w[0] + x[0]);
    dv[1] += k * (w[1] + x[1]);
    dv[2] += k * (w[2] + x[2]);
}

#endif

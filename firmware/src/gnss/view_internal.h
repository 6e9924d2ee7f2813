/* view_internal.h - the two halves of pel_view_compute() that pel_spp_solve() uses on their own. Private to src/gnss/. */
#ifndef PELORUS_GNSS_VIEW_INTERNAL_H
#define PELORUS_GNSS_VIEW_INTERNAL_H

#include "pelorus/gnss.h"

/* A position on or near the Earth, where elevations and atmosphere mean something. */
bool pel_view_near_earth(const double r_e[3]);

/* Satellites of the epoch with a code and a healthy orbit, at their transmission times; geometry is left to
 * pel_view_move(), atmosphere is zero. sys_mask: one bit a system. */
void pel_view_orbits(const pel_epoch_t *e, const pel_orbits_t *o, pel_time_t t_orbit_ns, unsigned sys_mask,
                     pel_nav_counters_t *count, pel_view_t *view);

/* Azimuth, elevation, troposphere and ionosphere of every satellite, from a position near the Earth. */
void pel_view_atmosphere(const pel_orbits_t *o, const double r_ea_e[3], pel_view_t *view);

/* Remove satellites below the mask. */
void pel_view_apply_mask(double mask_rad, pel_nav_counters_t *count, pel_view_t *view);

#endif

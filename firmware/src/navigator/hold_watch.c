/* hold_watch.c - do the codes agree with the position that the held integers give?
 *
 * A wrong set of integers fits its own phases, and a filter conditioned on it believes it to millimetres. The codes know better, if
 * only to a decimetre after a minute: what they leave over, projected on the position, is a mean that should be zero. Their
 * variances are those of correlated errors already (allow_for_correlation), so the sums count honest information. */
#include <string.h>

#include "internal.h"

#define MEMORY_S 60.0
#define LIMIT_SQ 30.0 /* of a chi-square of three: once in 700 000 */

void pel_nav_hold_watch_reset(pel_navigator_t *nav)
{
    memset(&nav->hold_watch, 0, sizeof nav->hold_watch);
}

void pel_nav_hold_watch_age(pel_navigator_t *nav, double dt_s)
{
    pel_hold_watch_t *w = &nav->hold_watch;
    const double keep = pel_exp(-pel_max(dt_s, 0.0) / MEMORY_S);
    for (int i = 0; i < 3; i++) {
        w->s[i] *= keep;
        for (int j = 0; j < 3; j++) { w->M[i][j] *= keep; }
    }
}

void pel_nav_hold_watch_row(pel_navigator_t *nav, const pel_row_t *row, int i_r)
{
    pel_hold_watch_t *w = &nav->hold_watch;
    pel_real left = row->z;
    for (int i = row->first; i < nav->ud.n; i++) { left -= row->h[i] * nav->ud.x[i]; }
    for (int i = 0; i < 3; i++) {
        const double h_i = (double)row->h[i_r + i] / (double)row->var;
        w->s[i] += h_i * (double)left;
        for (int j = 0; j < 3; j++) { w->M[i][j] += h_i * (double)row->h[i_r + j]; }
    }
}

bool pel_nav_hold_watch_contradicts(const pel_navigator_t *nav)
{
    const pel_hold_watch_t *w = &nav->hold_watch;
    double inverse[3][3], mean[3];
    if (pel_mat3_inverse(w->M, inverse) != PEL_OK) { return false; }
    pel_mat3_vec(inverse, w->s, mean);
    return pel_dot3(w->s, mean) > LIMIT_SQ;
}

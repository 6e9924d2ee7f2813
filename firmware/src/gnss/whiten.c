#include "pelorus/gnss.h"
#include "pelorus/math.h"

pel_status_t pel_whiten_begin(pel_whiten_t *w, int n, pel_real r_0)
{
    if (n < 0 || n > PEL_MAX_STATES || !(r_0 >= PEL_R(0.0))) { return PEL_E_RANGE; }
    w->n = n;
    w->q = r_0;
    w->s_z = PEL_R(0.0);
    for (int i = 0; i < n; i++) { w->s_h[i] = PEL_R(0.0); }
    return PEL_OK;
}

pel_status_t pel_whiten_row(const pel_whiten_t *w, pel_real r_i, pel_real *z, pel_real h[], pel_real *var)
{
    if (!(r_i > PEL_R(0.0))) { return PEL_E_NOT_POSDEF; }
    *z -= w->s_z;
    for (int i = 0; i < w->n; i++) { h[i] -= w->s_h[i]; }
    *var = r_i + w->q;
    return PEL_OK;
}

void pel_whiten_accept(pel_whiten_t *w, pel_real r_i, pel_real z, const pel_real h[])
{
    const pel_real d = r_i + w->q;
    const pel_real l = w->q / d;
    w->s_z += l * z;
    for (int i = 0; i < w->n; i++) { w->s_h[i] += l * h[i]; }
    w->q *= r_i / d;
}

#include <string.h>

#include "pelorus/observe.h"

void pel_whitener_init(pel_whitener_t *w, double var_pivot, int n_states)
{
    w->q = var_pivot;
    w->z = 0;
    memset(w->h, 0, (size_t)n_states * sizeof w->h[0]);
}

void pel_whitener_apply(pel_whitener_t *w, double var_sat, pel_row_t *row)
{
    /* R = L diag(d) L' with d_j = r_j + q and l_ij = q / d_j for all i > j: the column of L is constant below its diagonal,
     * so one running sum serves every later row. */
    const double d = var_sat + w->q;
    const pel_real l = (pel_real)(w->q / d);
    row->z -= w->z;
    w->z += l * row->z;
    for (int i = row->first; i < row->n; i++) {
        row->h[i] -= w->h[i];
        w->h[i] += l * row->h[i];
    }
    row->var = (pel_real)d;
    w->q *= var_sat / d;
}

/* offsets.c - what happens to between-satellite offsets and to the height deviation between two epochs (S3 section 5). */
#include "pelorus/filter.h"
#include "pelorus/math.h"

/* Each satellite's path walks by itself, that of the reference moves all offsets together. */
static void walk(pel_ud_t *ud, int first, int n, pel_real q)
{
    pel_real common[PEL_MAX_STATES] = {PEL_R(0.0)};
    for (int i = first; i < first + n; i++) {
        pel_ud_add_noise(ud, i, q);
        common[i] = PEL_R(1.0);
    }
    pel_ud_rank_one(ud, first + n, common, q);
}

pel_status_t pel_propagate_offsets(const pel_model_t *m, const pel_drift_model_t *drift, double dt_s, pel_ud_t *ud)
{
    const int offset = pel_model_index(m, PEL_BLOCK_OFFSET);
    const int rate = pel_model_index(m, PEL_BLOCK_OFFSET_RATE);
    const int height = pel_model_index(m, PEL_BLOCK_HEIGHT);
    const int n = m->size[PEL_BLOCK_OFFSET];
    if (!(dt_s > 0.0) || ud->n != m->n) { return PEL_E_RANGE; }

    if (offset >= 0) {
        for (int k = 0; k < n && rate >= 0; k++) {
            (void)pel_ud_combine(ud, offset + k, rate + k, (pel_real)dt_s);
            pel_ud_add_noise(ud, rate + k, (pel_real)(drift->rate_walk_mps_rts * drift->rate_walk_mps_rts * dt_s));
        }
        walk(ud, offset, n, (pel_real)(drift->path_m_rts * drift->path_m_rts * dt_s));
    }
    if (height >= 0) {
        pel_real decay[PEL_MAX_STATES] = {PEL_R(0.0)};
        pel_real q[PEL_MAX_STATES] = {PEL_R(0.0)};
        pel_model_markov(drift->sd_height_m, drift->tau_height_s, dt_s, &decay[height], &q[height]);
        return pel_ud_decay(ud, decay, q);
    }
    return PEL_OK;
}

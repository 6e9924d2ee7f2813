/* blocks.c - models as lists of blocks. */
#include "pelorus/math.h"
#include "pelorus/model.h"

static void clear(pel_model_t *m, const pel_imu_model_t *imu)
{
    const pel_model_t none = {0};
    *m = none;
    m->imu = *imu;
}

pel_status_t pel_model_append(pel_model_t *m, pel_block_t block, int size)
{
    if (size < 1 || (int)block < 0 || block >= PEL_N_BLOCK || m->size[block] != 0) { return PEL_E_RANGE; }
    if (size > PEL_MAX_STATES - m->n) { return PEL_E_FULL; }
    m->first[block] = (uint8_t)m->n;
    m->size[block] = (uint8_t)size;
    m->n += size;
    return PEL_OK;
}

/* n blocks of three states in this order. */
static void list(pel_model_t *m, const pel_imu_model_t *imu, const pel_block_t order[], size_t n)
{
    clear(m, imu);
    for (size_t k = 0; k < n; k++) { (void)pel_model_append(m, order[k], 3); }
}

void pel_model_ins_ecef(pel_model_t *m, const pel_imu_model_t *imu)
{
    static const pel_block_t order[] = {PEL_BLOCK_GYRO_CONSTANT, PEL_BLOCK_GYRO_MARKOV, PEL_BLOCK_ACCEL_MARKOV,
                                        PEL_BLOCK_ATTITUDE,      PEL_BLOCK_VELOCITY,    PEL_BLOCK_POSITION};
    list(m, imu, order, sizeof order / sizeof order[0]);
}

void pel_model_ins_enu(pel_model_t *m, const pel_imu_model_t *imu)
{
    pel_model_ins_ecef(m, imu); /* the blocks are the same: the frame is that of the transition */
}

void pel_model_gnss(pel_model_t *m, const pel_imu_model_t *imu)
{
    clear(m, imu);
    (void)pel_model_append(m, PEL_BLOCK_VELOCITY, 3);
    (void)pel_model_append(m, PEL_BLOCK_POSITION, 3);
}

void pel_model_tdcp(pel_model_t *m, const pel_imu_model_t *imu, int n_offsets)
{
    static const pel_block_t order[] = {PEL_BLOCK_GYRO_CONSTANT, PEL_BLOCK_ACCEL_CONSTANT, PEL_BLOCK_ATTITUDE,
                                        PEL_BLOCK_VELOCITY, PEL_BLOCK_POSITION};
    const int most = (PEL_MAX_STATES - 16) / 2;
    const int n = (n_offsets < 1) ? 1 : ((n_offsets > most) ? most : n_offsets);
    list(m, imu, order, sizeof order / sizeof order[0]);
    (void)pel_model_append(m, PEL_BLOCK_OFFSET, n);
    (void)pel_model_append(m, PEL_BLOCK_OFFSET_RATE, n);
    (void)pel_model_append(m, PEL_BLOCK_HEIGHT, 1);
}

void pel_model_tdcp_paper(pel_model_t *m, const pel_imu_model_t *imu)
{
    static const pel_block_t order[] = {PEL_BLOCK_GYRO_CONSTANT, PEL_BLOCK_ACCEL_CONSTANT, PEL_BLOCK_ATTITUDE,
                                        PEL_BLOCK_VELOCITY};
    list(m, imu, order, sizeof order / sizeof order[0]);
}

int pel_model_index(const pel_model_t *m, pel_block_t block)
{
    return (m->size[block] != 0) ? (int)m->first[block] : -1;
}

void pel_model_sensor_sd(const pel_model_t *m, pel_real sd[PEL_MAX_STATES])
{
    for (int i = 0; i < 3; i++) {
        if (m->size[PEL_BLOCK_GYRO_CONSTANT] != 0) {
            sd[m->first[PEL_BLOCK_GYRO_CONSTANT] + i] = (pel_real)m->imu.sd_bg_radps;
        }
        if (m->size[PEL_BLOCK_GYRO_MARKOV] != 0) {
            sd[m->first[PEL_BLOCK_GYRO_MARKOV] + i] = (pel_real)m->imu.sd_gm_radps;
        }
        if (m->size[PEL_BLOCK_ACCEL_CONSTANT] != 0) {
            sd[m->first[PEL_BLOCK_ACCEL_CONSTANT] + i] = (pel_real)m->imu.sd_ba_mps2;
        }
        if (m->size[PEL_BLOCK_ACCEL_MARKOV] != 0) {
            sd[m->first[PEL_BLOCK_ACCEL_MARKOV] + i] = (pel_real)m->imu.sd_am_mps2;
        }
    }
}

void pel_model_markov(double sd, double tau_s, double dt_s, pel_real *decay, pel_real *q)
{
    const double x = -dt_s / tau_s;
    /* exp(x) - 1 by its series while small: the difference would lose digits */
    const double d = (x > -0.01) ? x * (1.0 + 0.5 * x * (1.0 + x * (1.0 / 3.0) * (1.0 + 0.25 * x))) : pel_exp(x) - 1.0;
    *decay = (pel_real)d;
    *q = (pel_real)(-sd * sd * d * (2.0 + d)); /* sd^2 (1 - (1 + d)^2) */
}

static void markov(const pel_model_t *m, pel_block_t block, double sd, double tau_s, double dt_s, pel_real decay[],
                   pel_real q[])
{
    const int first = pel_model_index(m, block);
    for (int i = 0; i < 3 && first >= 0; i++) { pel_model_markov(sd, tau_s, dt_s, &decay[first + i], &q[first + i]); }
}

void pel_model_slow(const pel_model_t *m, double dt_s, pel_real decay[PEL_MAX_STATES], pel_real q[PEL_MAX_STATES])
{
    for (int i = 0; i < m->n; i++) {
        decay[i] = PEL_R(0.0);
        q[i] = PEL_R(0.0);
    }
    markov(m, PEL_BLOCK_GYRO_MARKOV, m->imu.sd_gm_radps, m->imu.tau_gm_s, dt_s, decay, q);
    markov(m, PEL_BLOCK_ACCEL_MARKOV, m->imu.sd_am_mps2, m->imu.tau_am_s, dt_s, decay, q);
}

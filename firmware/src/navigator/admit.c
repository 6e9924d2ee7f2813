/* admit.c - which IMU samples come in. A sensor that fails says so by numbers that no motion makes: the impossible ones are refused, the
 * unlikely ones are doubted, which costs sigma instead of truth. */
#include "internal.h"

#include "pelorus/math.h"

#define LATEST_NS     (INT64_C(6000) * PEL_NS_PER_WEEK) /* of any clock: the year 2094 */
#define SPIKE_RADPS   10.0 /* change from one sample to the next: no vehicle turns or strikes like this */
#define SPIKE_MPS2    200.0
#define MOST_SPIKES   3   /* in a row: more is what happens */
#define JOLT_RADPS    0.2 /* change that a calm vehicle does not make ... */
#define JOLT_MPS2     3.0
#define JOLT_FACTOR   8.0   /* ... or this many times what it lately made, rms */
#define CALM_SAMPLES  100.0 /* lately */
#define BLINK_S       0.05  /* what a vehicle does within this is seen by the samples around it */
#define SWERVE_MPS2   1.0
#define SWERVE_RPS    0.1
#define LEARN_SAMPLES 150 /* of the runs of equal numbers that a sensor gives */
#define NOISY_RUN     8   /* longest run of one whose noise is above its resolution: only there a run tells anything */
#define STUCK_RUN     25  /* and three times the longest */
#define UNSEEN_RPS    0.5 /* what may have happened behind a stuck number */
#define UNSEEN_MPS2   5.0

bool pel_nav_imu_is_sane(const pel_imu_t *imu)
{
    if (!(imu->dt_s > 0.0 && imu->dt_s <= 1.0) || imu->t_ns <= 0 || imu->t_ns > LATEST_NS) { return false; }
    if ((imu->flags & (PEL_IMU_GYRO_SATURATED | PEL_IMU_ACCEL_SATURATED)) != 0) { return false; }
    double turn = 0.0, push = 0.0;
    for (int k = 0; k < 3; k++) {
        turn += imu->alpha_ib_b[k] * imu->alpha_ib_b[k];
        push += imu->upsilon_ib_b[k] * imu->upsilon_ib_b[k];
    }
    /* 100 rad/s and 2000 m/s^2 are beyond what any product of this kind measures; also false for NaN. */
    return turn <= 1e4 * imu->dt_s * imu->dt_s && push <= 4e6 * imu->dt_s * imu->dt_s;
}

/* White noise on attitude and velocity: turn, push are variances of an axis. */
void pel_nav_doubt_motion(pel_navigator_t *nav, double turn, double push)
{
    if (!nav->ins) { return; }
    const int i_psi = pel_model_index(&nav->model, PEL_BLOCK_ATTITUDE);
    const int i_v = pel_model_index(&nav->model, PEL_BLOCK_VELOCITY);
    for (int k = 0; k < 3; k++) {
        pel_ud_add_noise(&nav->ud, i_psi + k, (pel_real)turn);
        pel_ud_add_noise(&nav->ud, i_v + k, (pel_real)push);
    }
}

/* How long each number has not changed; returns the longest run that says that its sensor is stuck, 0 if none does. */
static int stuck_for(pel_admit_t *a, const pel_imu_t *imu)
{
    int stuck = 0;
    for (int i = 0; i < 6; i++) {
        const double now = (i < 3) ? imu->alpha_ib_b[i] : imu->upsilon_ib_b[i - 3];
        const double before = (i < 3) ? a->last.alpha_ib_b[i] : a->last.upsilon_ib_b[i - 3];
        a->run[i] = (uint16_t)((now != before) ? 0 : (a->run[i] < UINT16_MAX) ? a->run[i] + 1 : UINT16_MAX);
        if (a->learnt < LEARN_SAMPLES) {
            if (a->run[i] > a->longest[i]) { a->longest[i] = a->run[i]; }
        } else if (a->longest[i] <= NOISY_RUN && a->run[i] >= STUCK_RUN + 3 * a->longest[i] && a->run[i] > stuck) {
            stuck = a->run[i];
        }
    }
    if (a->learnt < LEARN_SAMPLES) { a->learnt++; }
    return stuck;
}

/* Squared changes of rate and specific force from one increment to the next. */
static void squared_changes(const pel_imu_t *from, const pel_imu_t *to, double *dw2, double *df2)
{
    *dw2 = *df2 = 0.0;
    for (int k = 0; k < 3; k++) {
        const double dw = to->alpha_ib_b[k] / to->dt_s - from->alpha_ib_b[k] / from->dt_s;
        const double df = to->upsilon_ib_b[k] / to->dt_s - from->upsilon_ib_b[k] / from->dt_s;
        *dw2 += dw * dw;
        *df2 += df * df;
    }
}

/* Is this change beyond what was lately usual? */
static bool is_jolt(pel_admit_t *a, double dw2, double df2)
{
    const double usual = JOLT_FACTOR * JOLT_FACTOR;
    const double most_w = usual * a->ms_dw + JOLT_RADPS * JOLT_RADPS;
    const double most_f = usual * a->ms_df + JOLT_MPS2 * JOLT_MPS2;
    /* A jolt counts little: one sample in ten that is false must not become usual. */
    a->ms_dw += (pel_min(dw2, 4.0 * a->ms_dw + JOLT_RADPS * JOLT_RADPS) - a->ms_dw) / CALM_SAMPLES;
    a->ms_df += (pel_min(df2, 4.0 * a->ms_df + JOLT_MPS2 * JOLT_MPS2) - a->ms_df) / CALM_SAMPLES;
    return dw2 > most_w || df2 > most_f;
}

/* What a doubtful increment may be wrong by: the change of rate and specific force at its start, held for its length; of a bridge for the
 * length that is missing, and where that is long also a swerve that began and ended in it. Only the horizon's passing counts: noise
 * added before would be used up by epochs that lie before it. */
bool pel_nav_doubt_of(const pel_navigator_t *nav, int i, double part_s, double *turn, double *push)
{
    const pel_imu_t *it = pel_imu_ring_at(&nav->ring, i), *before = pel_imu_ring_at(&nav->ring, i - 1);
    *turn = *push = 0.0;
    if (it == NULL || before == NULL || (it->flags & (PEL_NAV_IMU_JOLT | PEL_NAV_IMU_BRIDGE)) == 0) { return false; }
    const bool bridge = (it->flags & PEL_NAV_IMU_BRIDGE) != 0;
    const double span_s = bridge ? pel_max(it->dt_s - before->dt_s, 0.5 * it->dt_s) : it->dt_s;
    const double unseen_s = bridge ? pel_max(0.0, span_s - BLINK_S) : 0.0;
    double dw2, df2;
    squared_changes(before, it, &dw2, &df2);
    const double share = part_s / it->dt_s; /* an epoch may cut it */
    *turn = share * (dw2 * span_s * span_s + SWERVE_RPS * SWERVE_RPS * unseen_s * unseen_s);
    *push = share * (df2 * span_s * span_s + SWERVE_MPS2 * SWERVE_MPS2 * unseen_s * unseen_s);
    return true;
}

/* When a number is found stuck, what came in behind it is doubted; after that nothing comes in until it changes. */
static bool is_stuck(pel_navigator_t *nav, const pel_imu_t *imu)
{
    const int run = stuck_for(&nav->admit, imu);
    if (run == 0) { return false; }
    if (!nav->admit.stuck) {
        const double turn = UNSEEN_RPS * run * imu->dt_s, push = UNSEEN_MPS2 * run * imu->dt_s;
        pel_nav_doubt_motion(nav, turn * turn, push * push);
    }
    return true;
}

bool pel_nav_admit_imu(pel_navigator_t *nav, const pel_imu_t *imu, bool *jolt)
{
    *jolt = false;
    pel_admit_t *a = &nav->admit;
    const pel_imu_t *last = &a->last;
    if (last->dt_s > 0.0) {
        a->stuck = is_stuck(nav, imu);
        double dw2, df2;
        squared_changes(last, imu, &dw2, &df2);
        const bool spike = dw2 > SPIKE_RADPS * SPIKE_RADPS || df2 > SPIKE_MPS2 * SPIKE_MPS2;
        if (a->stuck || (spike && a->spikes < MOST_SPIKES)) {
            a->spikes = (uint8_t)(a->spikes + (spike ? 1 : 0));
            return false;
        }
        *jolt = is_jolt(a, dw2, df2);
    }
    a->spikes = 0;
    a->last = *imu;
    return true;
}

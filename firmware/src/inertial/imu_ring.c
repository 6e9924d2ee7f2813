/* imu_ring.c - the last increments, in order of time. */
#include "pelorus/bits.h"
#include "pelorus/inertial.h"

/* Over what is used of an increment. */
static uint32_t check_of(const pel_imu_t *imu)
{
    return pel_word_check(imu, offsetof(pel_imu_t, check), 1);
}

void pel_imu_ring_init(pel_imu_ring_t *ring)
{
    ring->head = 0;
    ring->n = 0;
}

const pel_imu_t *pel_imu_ring_at(const pel_imu_ring_t *ring, int i)
{
    if (i < 0 || i >= (int)ring->n) { return NULL; }
    return &ring->imu[((unsigned)ring->head + PEL_IMU_RING - ring->n + (unsigned)i) % PEL_IMU_RING];
}

bool pel_imu_ring_is_whole(const pel_imu_ring_t *ring, int i)
{
    const pel_imu_t *imu = pel_imu_ring_at(ring, i);
    return imu != NULL && imu->check == check_of(imu);
}

const pel_imu_t *pel_imu_ring_oldest(const pel_imu_ring_t *ring)
{
    return pel_imu_ring_at(ring, 0);
}

const pel_imu_t *pel_imu_ring_newest(const pel_imu_ring_t *ring)
{
    return pel_imu_ring_at(ring, (int)ring->n - 1);
}

pel_status_t pel_imu_ring_push(pel_imu_ring_t *ring, const pel_imu_t *imu)
{
    const pel_imu_t *newest = pel_imu_ring_newest(ring);
    if (!(imu->dt_s > 0.0 && imu->dt_s <= 10.0)) { return PEL_E_RANGE; }
    if (newest != NULL && imu->t_ns <= newest->t_ns) { return PEL_E_STALE; }
    ring->imu[ring->head] = *imu;
    ring->imu[ring->head].check = check_of(imu);
    ring->head = (uint16_t)((ring->head + 1u) % PEL_IMU_RING);
    if (ring->n < PEL_IMU_RING) { ring->n++; }
    return PEL_OK;
}

int pel_imu_ring_after(const pel_imu_ring_t *ring, pel_time_t t_ns)
{
    int low = 0;
    int high = (int)ring->n; /* the answer lies in [low, high] */
    while (low < high) {
        const int mid = (low + high) / 2;
        if (pel_imu_ring_at(ring, mid)->t_ns > t_ns) {
            high = mid;
        } else {
            low = mid + 1;
        }
    }
    return low;
}

bool pel_imu_ring_has_after(const pel_imu_ring_t *ring, pel_time_t t_ns, int count)
{
    const pel_imu_t *last_of_them = pel_imu_ring_at(ring, (int)ring->n - count);
    return count < 1 || (last_of_them != NULL && last_of_them->t_ns > t_ns);
}

pel_status_t pel_imu_split(const pel_imu_t *whole, pel_time_t t_ns, pel_imu_t *first, pel_imu_t *second)
{
    const double rest_s = pel_time_diff_s(whole->t_ns, t_ns);
    if (!(rest_s > 0.0 && rest_s < whole->dt_s)) { return PEL_E_RANGE; }
    const pel_imu_t w = *whole;           /* either part may be the whole's own place */
    const double share = rest_s / w.dt_s; /* of the second part */

    *first = w;
    *second = w;
    first->t_ns = t_ns;
    first->dt_s = w.dt_s - rest_s;
    second->dt_s = rest_s;
    for (int i = 0; i < 3; i++) {
        second->alpha_ib_b[i] = share * w.alpha_ib_b[i];
        second->upsilon_ib_b[i] = share * w.upsilon_ib_b[i];
        first->alpha_ib_b[i] = w.alpha_ib_b[i] - second->alpha_ib_b[i]; /* the parts add up exactly */
        first->upsilon_ib_b[i] = w.upsilon_ib_b[i] - second->upsilon_ib_b[i];
    }
    return PEL_OK;
}

/* Proofs of rings, stores and lists: any index, any filling. */
#include "pelorus/ambiguity.h"
#include "pelorus/gnss.h"
#include "pelorus/inertial.h"
#include "pelorus/model.h"

#include "prove.h"

static void any_ring(pel_imu_ring_t *ring)
{
    assume(ring->head < PEL_IMU_RING && ring->n <= PEL_IMU_RING);
}

/* PROVE ring_push: an increment of any numbers into a ring of any filling
 * sources inertial/imu_ring.c
 * flags --boolector --unwind 20 -DPEL_IMU_RING=17
 * quick
 * plant inertial/imu_ring.c: (ring->head + 1u) % PEL_IMU_RING => ring->head + 1u */
void ring_push(void)
{
    pel_imu_ring_t ring;
    pel_imu_t imu;
    any_ring(&ring);
    const pel_status_t status = pel_imu_ring_push(&ring, &imu);
    claim(ring.head < PEL_IMU_RING && ring.n <= PEL_IMU_RING);
    claim(status != PEL_OK || pel_imu_ring_newest(&ring)->t_ns == imu.t_ns);
}

/* PROVE ring_at: any index
 * sources inertial/imu_ring.c
 * flags --unwind 20 -DPEL_IMU_RING=17
 * quick
 * plant inertial/imu_ring.c: (unsigned)i) % PEL_IMU_RING] => (unsigned)i)] */
void ring_at(void)
{
    pel_imu_ring_t ring;
    any_ring(&ring);
    const pel_imu_t *imu = pel_imu_ring_at(&ring, any_int());
    if (imu != NULL) { claim(imu >= ring.imu && imu < ring.imu + PEL_IMU_RING); }
    (void)pel_imu_ring_oldest(&ring);
}

/* PROVE ring_after: a search for any time ends inside the ring, in order or not
 * sources inertial/imu_ring.c
 * flags --unwind 20 -DPEL_IMU_RING=17
 * plant inertial/imu_ring.c: low = mid + 1; => low = mid + 2; */
void ring_after(void)
{
    pel_imu_ring_t ring;
    any_ring(&ring);
    const int i = pel_imu_ring_after(&ring, any_i64());
    claim(i >= 0 && i <= ring.n);
}

/* PROVE imu_split: at any time of messages, whatever the increment holds
 * sources inertial/imu_ring.c base/time.c
 * flags --any-floats --unwind 5 -DPEL_IMU_RING=16
 * plant inertial/imu_ring.c: i < 3; i++) {\n        second->alpha_ib_b[i] => i < 4; i++) {\n        second->alpha_ib_b[i] */
void imu_split(void)
{
    pel_imu_t whole, first, second;
    const pel_time_t t = any_i64();
    assume(whole.t_ns > 0 && whole.t_ns < INT64_C(4000000000000000000) && t > 0 && t < INT64_C(4000000000000000000));
    (void)pel_imu_split(&whole, t, &first, &second);
}

/* PROVE view_find: a satellite of any number in a view of any filling
 * sources gnss/view.c
 * flags --unwind 10 -DPEL_MAX_SATS=8 -DPEL_MAX_OBS=8
 * quick
 * plant gnss/view.c: i < view->n; i++) {\n        if (view->sight[i].sys => i <= view->n; i++) {\n        if (view->sight[i].sys */
void view_find(void)
{
    pel_view_t view;
    assume(view.n >= 0 && view.n <= PEL_MAX_SATS);
    const pel_sight_t *s = pel_view_find(&view, any_u8(), any_u8());
    if (s != NULL) { claim(s >= view.sight && s < view.sight + PEL_MAX_SATS); }
}

/* PROVE model_append: any block, any size, a model of any filling
 * sources model/blocks.c
 * flags --unwind 12 -DPEL_MAX_STATES=18
 * quick
 * plant model/blocks.c: size > PEL_MAX_STATES - m->n => m->n + size > PEL_MAX_STATES */
void model_append(void)
{
    pel_model_t m;
    assume(m.n >= 0 && m.n <= PEL_MAX_STATES);
    const int size = any_int(), block = any_int();
    assume(block >= 0 && block < PEL_N_BLOCK);
    (void)pel_model_append(&m, (pel_block_t)block, size);
    claim(m.n >= 0 && m.n <= PEL_MAX_STATES);
    claim(pel_model_index(&m, (pel_block_t)block) >= -1);
}

/* PROVE amb_count: any number of rows
 * sources ambiguity/amb_float.c
 * flags --unwind 8 -DPEL_MAX_AMB=6
 * quick
 * plant ambiguity/amb_float.c: i < p->n_rows; i++) { n += => i <= p->n_rows; i++) { n += */
void amb_count(void)
{
    pel_amb_problem_t p;
    assume(p.n_rows >= 0 && p.n_rows <= PEL_MAX_AMB);
    const int n = pel_amb_count(&p);
    claim(n >= 0 && n <= p.n_rows);
}

/* PROVE ils_get: any candidate of an engine that holds any number of them
 * sources ambiguity/ils.c
 * flags --any-floats --unwind 10 -DPEL_MAX_AMB=6
 * plant ambiguity/ils.c: p < s->n; p++) { N[s->order[p]] => p <= s->n; p++) { N[s->order[p]] */
void ils_get(void)
{
    pel_ils_t s;
    int64_t N[PEL_MAX_AMB];
    assume(s.n_found >= 0 && s.n_found <= PEL_ILS_BEST && s.n >= 0 && s.n <= PEL_MAX_AMB);
    for (int i = 0; i < PEL_MAX_AMB; i++) {
        assume(s.order[i] < PEL_MAX_AMB && s.origin[i] > -(INT64_C(1) << 50) && s.origin[i] < (INT64_C(1) << 50));
    }
    (void)pel_ils_get(&s, any_int(), N, NULL);
}

/* INSTEAD pel_ils_init, pel_ils_run: decorrelation and tree search turn on comparisons of doubles; held by bounds of nodes, swaps and steps, and by 10 000 problems against an unlimited search | problem */
/* INSTEAD pel_orbits_add, pel_pair_epochs: which entry is taken turns on comparisons of doubles | navigator, rtcm3_ephemeris */
/* INSTEAD pel_sd_form, pel_slip_check, pel_spp_solve: whole epochs in floating point | navigator */

/* cases.c - what is counted: one call each, on filters that look like a flight's. */
#include "bench.h"
#include "dense.h"
#include "pelorus/bits.h"
#include "pelorus/earth.h"
#include "pelorus/filter.h"
#include "pelorus/inertial.h"
#include "pelorus/math.h"

#define BODY __attribute__((noinline)) static void

static struct {
    pel_strapdown_t nav;
    pel_coning_t coning;
    double f_e[3];
    pel_model_t model;
    pel_transition_t t;
    pel_ud_t ud;
    bench_dense_t dense;
    pel_real Phi[PEL_MAX_STATES][PEL_MAX_STATES];
    pel_real h[PEL_MAX_STATES];
    pel_real decay[PEL_MAX_STATES], q[PEL_MAX_STATES];
    pel_real sink;
} b;

static pel_real noise(void)
{
    static uint32_t s = 1;
    s = s * 1664525u + 1013904223u;
    return (pel_real)(int32_t)(s >> 8) / PEL_R(8388608.0) - PEL_R(1.0);
}

/* The S5 filter after some seconds of flight with rows, so that factors are full; with 6 ambiguities behind, or 6 constant states in front. */
typedef enum { PLAIN, BEHIND, IN_FRONT } extra_t;

static void prepare(extra_t extra)
{
    pel_imu_model_t imu;
    pel_real sd[PEL_MAX_STATES];
    pel_imu_model_preset(PEL_IMU_GRADE_TACTICAL, &imu);
    pel_model_ins_ecef(&b.model, &imu);
    if (extra == BEHIND) { (void)pel_model_append(&b.model, PEL_BLOCK_AMBIGUITY, 6); }
    if (extra == IN_FRONT) {
        static const pel_block_t order[] = {PEL_BLOCK_LEVER_ARM,   PEL_BLOCK_CLONE,        PEL_BLOCK_GYRO_CONSTANT,
                                            PEL_BLOCK_GYRO_MARKOV, PEL_BLOCK_ACCEL_MARKOV, PEL_BLOCK_ATTITUDE,
                                            PEL_BLOCK_VELOCITY,    PEL_BLOCK_POSITION};
        b.model = (pel_model_t){.imu = imu};
        for (int k = 0; k < 8; k++) { (void)pel_model_append(&b.model, order[k], 3); }
    }
    const int n = b.model.n;
    for (int i = 0; i < n; i++) { sd[i] = (i < 9) ? PEL_R(1e-5) : ((i < 12) ? PEL_R(3e-3) : PEL_R(1.0)); }
    (void)pel_ud_init(&b.ud, n, sd);
    pel_earth_llh_to_ecef(0.53, 1.99, 1500.0, b.nav.r_eb_e);
    pel_attitude_to_C_b_e(0.2, -0.1, 2.3, 0.53, 1.99, b.nav.C_b_e);
    for (int i = 0; i < 3; i++) {
        b.nav.v_eb_e[i] = 60.0 + (double)i;
        b.f_e[i] = 5.0 + (double)i;
    }
    for (int k = 0; k < 40; k++) {
        pel_model_transition(&b.model, b.f_e, b.nav.C_b_e, b.nav.r_eb_e, 0.05, &b.t);
        (void)pel_ud_time_update(&b.ud, &b.t);
        for (int i = 0; i < n; i++) { b.h[i] = noise(); }
        (void)pel_ud_update(&b.ud, b.h, (k & 1) * 9, noise(), PEL_R(0.01), PEL_R(0.0), NULL);
    }
    bench_dense_phi(&b.t, b.Phi);
    b.dense.n = n;
    for (int i = 0; i < n; i++) {
        b.dense.x[i] = PEL_R(0.0);
        for (int j = 0; j < n; j++) { b.dense.P[i][j] = pel_ud_cov(&b.ud, i, j); }
    }
    pel_model_slow(&b.model, 1.0, b.decay, b.q);
}

static void prepare_18(void)
{
    prepare(PLAIN);
}
static void prepare_behind(void)
{
    prepare(BEHIND);
}
static void prepare_front(void)
{
    prepare(IN_FRONT);
}

BODY strapdown(void)
{
    static const double alpha[3] = {1e-4, -2e-4, 3e-4};
    static const double upsilon[3] = {1e-3, 2e-3, 0.02};
    pel_strapdown_step(&b.nav, &b.coning, alpha, upsilon, 0.002, b.nav.t_ns + 2000000);
}

static void prepare_strapdown(void)
{
    prepare(PLAIN);
    strapdown();
}

BODY transition(void)
{
    pel_model_transition(&b.model, b.f_e, b.nav.C_b_e, b.nav.r_eb_e, 0.05, &b.t);
}
BODY time_update(void)
{
    (void)pel_ud_time_update(&b.ud, &b.t);
}
BODY substep(void)
{
    transition();
    time_update();
}
BODY slow_decay(void)
{
    (void)pel_ud_decay(&b.ud, b.decay, b.q);
}
BODY row_dense(void)
{
    (void)pel_ud_update(&b.ud, b.h, 0, PEL_R(0.1), PEL_R(0.01), PEL_R(5.0), &b.sink);
}
BODY row_lever(void)
{
    (void)pel_ud_update(&b.ud, b.h, 9, PEL_R(0.1), PEL_R(0.01), PEL_R(5.0), &b.sink);
}
BODY row_ambiguity(void)
{
    (void)pel_ud_update(&b.ud, b.h, 15, PEL_R(0.1), PEL_R(0.01), PEL_R(5.0), &b.sink);
}
BODY row_last(void)
{
    (void)pel_ud_update(&b.ud, b.h, b.ud.n - 3, PEL_R(0.1), PEL_R(0.01), PEL_R(5.0), &b.sink);
}
BODY hph(void)
{
    b.sink = pel_ud_hph(&b.ud, b.h, 9);
}
BODY hash(void)
{
    b.sink = (pel_real)pel_ud_hash(&b.ud, PEL_FNV_START);
}
BODY dense_time_update(void)
{
    bench_dense_time_update(&b.dense, b.Phi, b.t.q);
}
BODY dense_row(void)
{
    bench_dense_update(&b.dense, b.h, PEL_R(0.1), PEL_R(0.01));
}
BODY dense_joseph(void)
{
    bench_dense_update_joseph(&b.dense, b.h, PEL_R(0.1), PEL_R(0.01));
}

/* A second of inertial, filter and rows: 200 Hz IMU, 20 epochs of 24 rows with lever arm. */
BODY one_second(void)
{
    static const double alpha[3] = {1e-4, -2e-4, 3e-4};
    static const double upsilon[3] = {1e-3, 2e-3, 0.049};
    pel_propagator_t p;
    pel_propagator_init(&p, b.nav.C_b_e);
    for (int k = 1; k <= 200; k++) {
        pel_strapdown_step(&b.nav, &b.coning, alpha, upsilon, 0.005, b.nav.t_ns + 5000000);
        (void)pel_propagator_add(&p, &b.model, b.coning.dv_f_e, 0.005, b.nav.C_b_e, b.nav.r_eb_e, &b.ud);
        if (k % 10 != 0) { continue; }
        (void)pel_propagator_flush(&p, &b.model, b.nav.C_b_e, b.nav.r_eb_e, &b.ud);
        for (int row = 0; row < 24; row++) { row_lever(); }
    }
}

const bench_case_t bench_cases[] = {
    {"strapdown step (double: M7)", prepare_strapdown, strapdown, 1, 450, ""},
    {"transition matrix, 18 states", prepare_18, transition, 1, 0, ""},
    {"time update of a substep, 18 states", prepare_18, time_update, 1, 0, "dense Phi P Phi' + Q, 18 states"},
    {"  18 states + 6 ambiguities", prepare_behind, time_update, 1, 0, "dense Phi P Phi' + Q, 24 states"},
    {"  24 states, 6 more in front", prepare_front, time_update, 1, 0, "dense Phi P Phi' + Q, 24 states"},
    {"both, per IMU step at 200 Hz, 18 states", prepare_18, substep, 10, 5000, ""},
    {"  18 states + 6 ambiguities at 200 Hz", prepare_behind, substep, 10, 6500, ""},
    {"  24 states, 6 more in front at 200 Hz", prepare_front, substep, 10, 6500, ""},
    {"Markov decay (once a second), 18 states", prepare_18, slow_decay, 1, 0, ""},
    {"scalar update, dense row, 18 states", prepare_18, row_dense, 1, 2700, "dense P - K h P, 18 states"},
    {"scalar update, dense row, 24 states", prepare_front, row_dense, 1, 4400, "dense P - K h P, 24 states"},
    {"scalar update, position row, 18 states", prepare_18, row_last, 1, 1300, "dense P - K h P, 18 states"},
    {"scalar update, position row, 24 states", prepare_front, row_last, 1, 1600, "dense P - K h P, 24 states"},
    {"scalar update, position + lever row, 18", prepare_18, row_lever, 1, 0, "dense P - K h P, 18 states"},
    {"scalar update, position + ambiguities, 24", prepare_behind, row_ambiguity, 1, 0, "dense P - K h P, 24 states"},
    {"h P h', position + lever row, 18 states", prepare_18, hph, 1, 0, ""},
    {"hash of the factors, 18 states", prepare_18, hash, 1, 0, ""},
    {"a second: 200 Hz IMU, 20 Hz x 24 rows (M7)", prepare_18, one_second, 1, 3000000, ""},
    {"dense Phi P Phi' + Q, 18 states", prepare_18, dense_time_update, 1, 0, ""},
    {"dense Phi P Phi' + Q, 24 states", prepare_behind, dense_time_update, 1, 0, ""},
    {"dense P - K h P, 18 states", prepare_18, dense_row, 1, 0, ""},
    {"dense P - K h P, 24 states", prepare_behind, dense_row, 1, 0, ""},
    {"dense Joseph, 18 states", prepare_18, dense_joseph, 1, 0, ""},
};
const int bench_n_cases = (int)(sizeof bench_cases / sizeof bench_cases[0]);

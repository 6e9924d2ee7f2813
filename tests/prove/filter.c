/* Proofs of filter/ and of the whitening: indices of packed triangles, whatever the numbers are.
 *
 * The smallest build (18 states); where loops are nested, filters of a few states of it. The numbers are any floats, NaN and
 * infinity too. */
#include "pelorus/filter.h"
#include "pelorus/gnss.h"

#include "prove.h"

static void any_filter(pel_ud_t *ud)
{
    assume(ud->n >= 1 && ud->n <= PEL_MAX_STATES);
}

/* PROVE ud_init: any number of states
 * sources filter/states.c
 * flags --unwind 155 --any-floats -DPEL_MAX_STATES=18
 * quick
 * plant filter/states.c: n > PEL_MAX_STATES) { return PEL_E_RANGE; } => n > PEL_MAX_STATES + 1) { return PEL_E_RANGE; } */
void ud_init(void)
{
    pel_ud_t ud;
    pel_real sd[PEL_MAX_STATES];
    const int n = any_int();
    for (int i = 0; i < PEL_MAX_STATES; i++) { sd[i] = any_float(); }
    claim(pel_ud_init(&ud, n, sd) != PEL_OK || (ud.n >= 1 && ud.n <= PEL_MAX_STATES));
}

/* PROVE ud_ph: covariances along a row that begins anywhere in the filter
 * sources filter/update.c
 * flags --unwind 8 --any-floats -DPEL_MAX_STATES=18
 * plant filter/update.c: for (int i = 0; i < j; i++) { out[i] += u[i] * df; } => for (int i = 0; i <= j + 1; i++) { out[i] += u[i] * df; } */
void ud_ph(void)
{
    pel_ud_t ud;
    pel_real h[6], out[6];
    const int first = any_int();
    assume(ud.n >= 1 && ud.n <= 6 && first >= 0 && first < ud.n);
    (void)pel_ud_hph(&ud, h, first);
    pel_ud_ph(&ud, h, first, out);
}

/* PROVE ud_cov: any two states of a filter of any size
 * sources filter/update.c
 * flags --unwind 20 --any-floats -DPEL_MAX_STATES=18
 * quick
 * plant filter/update.c: k < ud->n; k++) {\n        u += k - 1;\n        sum += u[low] => k <= ud->n; k++) {\n        u += k - 1;\n        sum += u[low] */
void ud_cov(void)
{
    pel_ud_t ud;
    const int i = any_int(), j = any_int();
    any_filter(&ud);
    assume(i >= 0 && i < ud.n && j >= 0 && j < ud.n);
    for (int k = 0; k < PEL_UD_PACKED; k += 17) { ud.U[k] = 0.0f; }
    (void)pel_ud_cov(&ud, i, j);
}

/* PROVE ud_insert: at any index
 * sources filter/states.c
 * flags --unwind 6 --any-floats -DPEL_MAX_STATES=18
 * plant filter/states.c: if (i < 0 || i > ud->n) => if (i > ud->n) */
void ud_insert(void)
{
    pel_ud_t ud;
    assume(ud.n >= 1 && ud.n <= 4);
    const int n = ud.n;
    const pel_status_t status = pel_ud_insert(&ud, any_int(), any_float());
    claim((status == PEL_OK) ? (ud.n == n + 1 && ud.n <= PEL_MAX_STATES) : ud.n == n);
}

/* PROVE ud_remove: any index
 * sources filter/states.c
 * flags --unwind 6 --any-floats -DPEL_MAX_STATES=18
 * plant filter/states.c: if (i < 0 || i >= n || n == 1) => if (i >= n || n == 1) */
void ud_remove(void)
{
    pel_ud_t ud;
    assume(ud.n >= 1 && ud.n <= 4);
    const int n = ud.n;
    const pel_status_t status = pel_ud_remove(&ud, any_int());
    claim((status == PEL_OK) ? ud.n == n - 1 && ud.n >= 1 : ud.n == n);
}

/* PROVE ud_clone: any state to any place
 * sources filter/states.c
 * flags --unwind 6 --any-floats -DPEL_MAX_STATES=18
 * plant filter/states.c: i < 0 || i > j) => i > j) */
void ud_clone(void)
{
    pel_ud_t ud;
    assume(ud.n >= 1 && ud.n <= 4);
    (void)pel_ud_clone(&ud, any_int(), any_int(), any_float());
    claim(ud.n <= PEL_MAX_STATES);
}

/* PROVE ud_set_variance: any state
 * sources filter/states.c
 * flags --unwind 20 --any-floats -DPEL_MAX_STATES=18
 * quick
 * plant filter/states.c: if (i < 0 || i >= ud->n) => if (i >= ud->n) */
void ud_set_variance(void)
{
    pel_ud_t ud;
    any_filter(&ud);
    (void)pel_ud_set_variance(&ud, any_int(), any_float());
}

/* PROVE ud_set_block3: any three states that follow one another, any covariance
 * sources filter/states.c
 * flags --unwind 20 --any-floats -DPEL_MAX_STATES=18
 * plant filter/states.c: first > ud->n - 3) => first > ud->n - 2) */
void ud_set_block3(void)
{
    pel_ud_t ud;
    double P[3][3];
    any_filter(&ud);
    (void)pel_ud_set_block3(&ud, any_int(), P);
}

/* PROVE ud_check: reads only what is in use
 * sources filter/states.c
 * flags --unwind 155 --any-floats -DPEL_MAX_STATES=18
 * plant filter/states.c: &ud->U[column(ud->n)]; u != end => &ud->U[column(ud->n + 1)]; u != end */
void ud_check(void)
{
    pel_ud_t ud;
    any_filter(&ud);
    (void)pel_ud_check(&ud);
}

/* PROVE whiten: rows of any length and numbers through begin, row and accept
 * sources gnss/whiten.c
 * flags --unwind 20 --any-floats -DPEL_MAX_STATES=18
 * quick
 * plant gnss/whiten.c: n > PEL_MAX_STATES || => n > PEL_MAX_STATES + 1 || */
void whiten(void)
{
    pel_whiten_t w;
    pel_real h[PEL_MAX_STATES], z = any_float(), var;
    const int n = any_int();
    if (pel_whiten_begin(&w, n, any_float()) != PEL_OK) { return; }
    claim(w.n >= 0 && w.n <= PEL_MAX_STATES);
    const pel_real r = any_float();
    if (pel_whiten_row(&w, r, &z, h, &var) == PEL_OK) { pel_whiten_accept(&w, r, z, h); }
}

/* INSTEAD pel_ud_update, pel_ud_time_update, pel_ud_rank_one, pel_ud_decay: indices of the row are proved (ud_ph); the rest are recurrences of float products: too long for the solver beyond toy sizes | navigator */

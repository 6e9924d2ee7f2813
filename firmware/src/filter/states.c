/* states.c - start, states that come and go, health. */
#include "packed.h"
#include "pelorus/filter.h"
#include "pelorus/math.h"

/* What D may hold: squares of small and large numbers become 0 and infinity. */
static bool variance_ok(pel_real var)
{
    return var > PEL_R(0.0) && pel_isfiniter(var);
}

pel_status_t pel_ud_init(pel_ud_t *ud, int n, const pel_real sd[])
{
    if (n < 1 || n > PEL_MAX_STATES) { return PEL_E_RANGE; }
    for (int i = 0; i < n; i++) {
        if (!(sd[i] > PEL_R(0.0)) || !variance_ok(sd[i] * sd[i])) { return PEL_E_NOT_POSDEF; }
    }
    ud->n = n;
    for (int k = 0; k < PEL_UD_PACKED; k++) { ud->U[k] = PEL_R(0.0); }
    for (int i = 0; i < PEL_MAX_STATES; i++) {
        ud->D[i] = (i < n) ? sd[i] * sd[i] : PEL_R(0.0);
        ud->x[i] = PEL_R(0.0);
    }
    return PEL_OK;
}

/* Others keep their covariance when column i of U goes: P = U D U' contains D_i u_i u_i', which moves into the columns before. */
static void absorb_column(pel_ud_t *ud, int i)
{
    pel_real c[PEL_MAX_STATES];
    const pel_real *u = &ud->U[column(i)];
    for (int k = 0; k < i; k++) { c[k] = u[k]; }
    pel_ud_rank_one(ud, i, c, ud->D[i]);
}

pel_status_t pel_ud_set_variance(pel_ud_t *ud, int i, pel_real var)
{
    if (i < 0 || i >= ud->n) { return PEL_E_RANGE; }
    if (!variance_ok(var)) { return PEL_E_NOT_POSDEF; }
    absorb_column(ud, i);
    for (int k = 0; k < i; k++) { ud->U[column(i) + k] = PEL_R(0.0); }
    for (int j = i + 1; j < ud->n; j++) { ud->U[column(j) + i] = PEL_R(0.0); }
    ud->D[i] = var;
    ud->x[i] = PEL_R(0.0);
    return PEL_OK;
}

pel_status_t pel_ud_set_block3(pel_ud_t *ud, int first, const double P[3][3])
{
    if (first < 0 || first > ud->n - 3) { return PEL_E_RANGE; }
    if (!(P[2][2] > 0.0)) { return PEL_E_NOT_POSDEF; }
    const double u02 = P[0][2] / P[2][2];
    const double u12 = P[1][2] / P[2][2];
    const double d1 = P[1][1] - u12 * P[1][2];
    if (!(d1 > 0.0)) { return PEL_E_NOT_POSDEF; }
    const double u01 = (P[0][1] - u02 * P[1][2]) / d1;
    const double d0 = P[0][0] - u02 * P[0][2] - u01 * u01 * d1;
    if (!(d0 > 0.0)) { return PEL_E_NOT_POSDEF; }

    const double d[3] = {d0, d1, P[2][2]};
    for (int i = 0; i < 3; i++) {
        if (!variance_ok((pel_real)d[i])) { return PEL_E_NOT_POSDEF; }
    }
    for (int i = 0; i < 3; i++) { (void)pel_ud_set_variance(ud, first + i, (pel_real)d[i]); }
    ud->U[column(first + 1) + first] = (pel_real)u01;
    ud->U[column(first + 2) + first] = (pel_real)u02;
    ud->U[column(first + 2) + first + 1] = (pel_real)u12;
    return PEL_OK;
}

/* Make room at index i: states from there on move up by one, row and column i of U are zero. */
static void open_gap(pel_ud_t *ud, int i)
{
    const int n = ud->n;
    for (int j = n; j > i; j--) { /* column j - 1 becomes column j; from the back, because targets lie beyond sources */
        pel_real *to = &ud->U[column(j)];
        const pel_real *from = &ud->U[column(j - 1)];
        for (int k = j - 1; k > i; k--) { to[k] = from[k - 1]; }
        to[i] = PEL_R(0.0);
        for (int k = i - 1; k >= 0; k--) { to[k] = from[k]; }
        ud->D[j] = ud->D[j - 1];
        ud->x[j] = ud->x[j - 1];
    }
    for (int k = 0; k < i; k++) { ud->U[column(i) + k] = PEL_R(0.0); }
    ud->n = n + 1;
}

pel_status_t pel_ud_insert(pel_ud_t *ud, int i, pel_real var)
{
    if (ud->n >= PEL_MAX_STATES) { return PEL_E_FULL; }
    if (i < 0 || i > ud->n) { return PEL_E_RANGE; }
    if (!variance_ok(var)) { return PEL_E_NOT_POSDEF; }
    open_gap(ud, i);
    ud->D[i] = var;
    ud->x[i] = PEL_R(0.0);
    return PEL_OK;
}

pel_status_t pel_ud_remove(pel_ud_t *ud, int i)
{
    const int n = ud->n;
    if (i < 0 || i >= n || n == 1) { return PEL_E_RANGE; }
    absorb_column(ud, i);
    for (int j = i + 1; j < n; j++) { /* column j without its row i becomes column j - 1 */
        pel_real *to = &ud->U[column(j - 1)];
        const pel_real *from = &ud->U[column(j)];
        for (int k = 0; k < i; k++) { to[k] = from[k]; }
        for (int k = i + 1; k < j; k++) { to[k - 1] = from[k]; }
        ud->D[j - 1] = ud->D[j];
        ud->x[j - 1] = ud->x[j];
    }
    ud->n = n - 1;
    return PEL_OK;
}

/* With the copy before its original, x_i = x_j + w: row i of U repeats row j, and w is the new D. */
pel_status_t pel_ud_clone(pel_ud_t *ud, int j, int i, pel_real var)
{
    if (ud->n >= PEL_MAX_STATES) { return PEL_E_FULL; }
    if (j < 0 || j >= ud->n || i < 0 || i > j) { return PEL_E_RANGE; }
    if (!variance_ok(var)) { return PEL_E_NOT_POSDEF; }
    open_gap(ud, i);
    const int original = j + 1;
    ud->U[column(original) + i] = PEL_R(1.0);
    for (int k = original + 1; k < ud->n; k++) { ud->U[column(k) + i] = ud->U[column(k) + original]; }
    ud->D[i] = var;
    ud->x[i] = ud->x[original];
    return PEL_OK;
}

pel_status_t pel_ud_check(const pel_ud_t *ud)
{
    pel_real sum = PEL_R(0.0); /* stays 0 unless something is infinite or no number */
    for (const pel_real *u = ud->U, *end = &ud->U[column(ud->n)]; u != end; u++) { sum += *u * PEL_R(0.0); }
    if (!(sum == PEL_R(0.0))) { return PEL_E_RANGE; }
    for (int i = 0; i < ud->n; i++) {
        if (!pel_isfiniter(ud->D[i]) || !pel_isfiniter(ud->x[i])) { return PEL_E_RANGE; }
        if (!(ud->D[i] > PEL_R(0.0))) { return PEL_E_NOT_POSDEF; }
    }
    return PEL_OK;
}

/* combine.c - linear maps of states, done on the factors: U diag(D) U' = P stays exact (docs/FILTER.md). */
#include "packed.h"
#include "pelorus/filter.h"
#include "pelorus/math.h"

pel_status_t pel_ud_assign(pel_ud_t *ud, int i, const pel_real a[], pel_real var)
{
    pel_real mean = PEL_R(0.0);
    if (i < 0 || i >= ud->n) { return PEL_E_RANGE; }
    for (int k = i + 1; k < ud->n; k++) {
        if (!pel_isfiniter(a[k])) { return PEL_E_RANGE; }
        mean += a[k] * ud->x[k];
    }
    const pel_status_t status = pel_ud_set_variance(ud, i, var); /* row and column i are empty now */
    if (status != PEL_OK) { return status; }
    ud->x[i] = mean;
    for (int j = i + 1; j < ud->n; j++) { /* row i of U = a' U of the states behind */
        pel_real *u = &ud->U[column(j)];
        pel_real sum = a[j];
        for (int k = i + 1; k < j; k++) { sum += a[k] * u[k]; }
        u[i] = sum;
    }
    return PEL_OK;
}

pel_status_t pel_ud_combine(pel_ud_t *ud, int i, int k, pel_real a)
{
    if (i < 0 || k <= i || k >= ud->n || !pel_isfiniter(a)) { return PEL_E_RANGE; }
    ud->U[column(k) + i] += a;
    for (int j = k + 1; j < ud->n; j++) { ud->U[column(j) + i] += a * ud->U[column(j) + k]; }
    ud->x[i] += a * ud->x[k];
    return PEL_OK;
}

pel_status_t pel_ud_negate(pel_ud_t *ud, int i)
{
    if (i < 0 || i >= ud->n) { return PEL_E_RANGE; }
    for (int j = i + 1; j < ud->n; j++) { ud->U[column(j) + i] = -ud->U[column(j) + i]; } /* row i */
    for (int k = 0; k < i; k++) {
        ud->U[column(i) + k] = -ud->U[column(i) + k];
    } /* and its column: the diagonal stays 1 */
    ud->x[i] = -ud->x[i];
    return PEL_OK;
}

static void swap_reals(pel_real *a, pel_real *b)
{
    const pel_real t = *a;
    *a = *b;
    *b = t;
}

/* The rows change places; what that puts below the diagonal is turned away by one scaled rotation of the two columns. With u = U(i, i+1), columns a
 * (of i) and b (of i + 1): D1' = D0 + u^2 D1, g = u D1 / D1', and above: b' = a + g (b - u a), a' = b - u a, D0' = D0 D1 / D1'. */
pel_status_t pel_ud_swap(pel_ud_t *ud, int i)
{
    if (i < 0 || i + 1 >= ud->n) { return PEL_E_RANGE; }
    pel_real *a = &ud->U[column(i)];
    pel_real *b = &ud->U[column(i + 1)];
    const pel_real u = b[i];
    const pel_real D0 = ud->D[i];
    const pel_real D1 = ud->D[i + 1];
    const pel_real sum = D0 + u * u * D1;
    const pel_real g = u * D1 / sum;
    for (int k = 0; k < i; k++) {
        const pel_real rest = b[k] - u * a[k];
        b[k] = a[k] + g * rest;
        a[k] = rest;
    }
    b[i] = g;
    ud->D[i] = D1 * (D0 / sum);
    ud->D[i + 1] = sum;
    for (int j = i + 2; j < ud->n; j++) { swap_reals(&ud->U[column(j) + i], &ud->U[column(j) + i + 1]); }
    swap_reals(&ud->x[i], &ud->x[i + 1]);
    return PEL_OK;
}

pel_status_t pel_ud_change_reference(pel_ud_t *ud, int first, int n, int p)
{
    const int last = first + n - 1;
    if (first < 0 || p < first || p > last || last >= ud->n) { return PEL_E_RANGE; }
    for (int k = p; k < last; k++) { (void)pel_ud_swap(ud, k); }
    for (int k = first; k < last; k++) { (void)pel_ud_combine(ud, k, last, PEL_R(-1.0)); }
    return pel_ud_negate(ud, last);
}

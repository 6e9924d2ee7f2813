/* update.c - Bierman's scalar measurement update and what a row sees of P. */
#include "packed.h"
#include "pelorus/filter.h"
#include "pelorus/math.h"

/* f_j = (U' h)_j of columns first..n-1: all that a row with zeros before `first` can see. */
static void project(const pel_ud_t *ud, const pel_real h[], int first, pel_real f[])
{
    for (int j = first; j < ud->n; j++) {
        const pel_real *u = &ud->U[column(j)];
        pel_real sum = h[j];
        for (int i = first; i < j; i++) { sum += u[i] * h[i]; }
        f[j] = sum;
    }
}

/* Column j of U and the gain so far, rows 0..j-1: u' = u + lambda g, g' = g + g_j u. Four rows at a time because the
 * loop's own cost is a third of a single row's. */
static void fold_column(pel_real *u, pel_real *g, int j, pel_real lambda, pel_real gj)
{
    int i = 0;
    for (; i + 4 <= j; i += 4) {
        const pel_real u0 = u[i];
        const pel_real u1 = u[i + 1];
        const pel_real u2 = u[i + 2];
        const pel_real u3 = u[i + 3];
        const pel_real g0 = g[i];
        const pel_real g1 = g[i + 1];
        const pel_real g2 = g[i + 2];
        const pel_real g3 = g[i + 3];
        u[i] = u0 + lambda * g0;
        u[i + 1] = u1 + lambda * g1;
        u[i + 2] = u2 + lambda * g2;
        u[i + 3] = u3 + lambda * g3;
        g[i] = g0 + gj * u0;
        g[i + 1] = g1 + gj * u1;
        g[i + 2] = g2 + gj * u2;
        g[i + 3] = g3 + gj * u3;
    }
    for (; i < j; i++) {
        const pel_real old = u[i];
        u[i] = old + lambda * g[i];
        g[i] += gj * old;
    }
}

pel_status_t pel_ud_update(pel_ud_t *ud, const pel_real h[], int first, pel_real z, pel_real var, pel_real gate,
                           pel_real *nis)
{
    const int n = ud->n;
    pel_real f[PEL_MAX_STATES]; /* U' h */
    pel_real g[PEL_MAX_STATES]; /* D U' h, then the gain times the innovation variance */

    if (!(var > PEL_R(0.0))) { return PEL_E_NOT_POSDEF; } /* also for NaN */
    if (first < 0 || first >= n) { return PEL_E_RANGE; }

    project(ud, h, first, f);
    pel_real innov = z;
    pel_real alpha = var;
    for (int j = first; j < n; j++) {
        g[j] = ud->D[j] * f[j];
        alpha += f[j] * g[j];
        innov -= h[j] * ud->x[j];
    }
    if (!(alpha >= var) || !pel_isfiniter(alpha) || !pel_isfiniter(innov)) { return PEL_E_RANGE; }
    const pel_real value = innov * innov / alpha;
    if (nis != NULL) { *nis = value; }
    if (gate > PEL_R(0.0) && value > gate * gate) { return PEL_W_REJECTED; }

    /* columns before `first` stay as they are: their f is zero */
    for (int i = 0; i < first; i++) { g[i] = PEL_R(0.0); }
    pel_real a = var; /* alpha over the columns before j */
    for (int j = first; j < n; j++) {
        const pel_real a_next = a + f[j] * g[j];
        ud->D[j] *= a / a_next;
        fold_column(&ud->U[column(j)], g, j, -f[j] / a, g[j]);
        a = a_next;
    }
    const pel_real k = innov / a;
    for (int i = 0; i < n; i++) { ud->x[i] += g[i] * k; }
    return PEL_OK;
}

pel_real pel_ud_hph(const pel_ud_t *ud, const pel_real h[], int first)
{
    pel_real f[PEL_MAX_STATES];
    pel_real sum = PEL_R(0.0);
    project(ud, h, first, f);
    for (int j = first; j < ud->n; j++) { sum += f[j] * f[j] * ud->D[j]; }
    return sum;
}

void pel_ud_ph(const pel_ud_t *ud, const pel_real h[], int first, pel_real out[])
{
    pel_real f[PEL_MAX_STATES];
    project(ud, h, first, f);
    for (int i = 0; i < first; i++) { out[i] = PEL_R(0.0); }
    for (int j = first; j < ud->n; j++) { /* U (D f), column by column */
        const pel_real *u = &ud->U[column(j)];
        const pel_real df = ud->D[j] * f[j];
        for (int i = 0; i < j; i++) { out[i] += u[i] * df; }
        out[j] = df;
    }
}

pel_real pel_ud_cov(const pel_ud_t *ud, int i, int j)
{
    const int low = (i < j) ? i : j;
    const int high = (i < j) ? j : i;
    const pel_real u = (low == high) ? PEL_R(1.0) : ud->U[column(high) + low];
    pel_real sum = u * ud->D[high];
    for (int k = high + 1; k < ud->n; k++) { sum += ud->U[column(k) + low] * ud->U[column(k) + high] * ud->D[k]; }
    return sum;
}

void pel_ud_block3(const pel_ud_t *ud, int i, int j, double P[3][3])
{
    for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) { P[a][b] = (double)pel_ud_cov(ud, i + a, j + b); }
    }
}

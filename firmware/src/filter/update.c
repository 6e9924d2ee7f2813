/* update.c - Bierman's scalar measurement update and what a row sees of P. */
#include "packed.h"
#include "pelorus/filter.h"
#include "pelorus/math.h"

/* f_j = (U' h)_j for j = first..n-1, rows before `first` being zero. Two columns and two rows at a time: half of the loads of h, a
 * quarter of the loop's own cost. */
static void project(const pel_ud_t *ud, const pel_real h[], int first, pel_real f[])
{
    const int n = ud->n;
    const pel_real *u = &ud->U[column(first) + first]; /* rows from `first` of column j */
    int j = first;
    for (; j + 2 <= n; j += 2) {
        const pel_real *v = u + j; /* of column j + 1 */
        const pel_real *p = &h[first];
        pel_real a = PEL_R(0.0);
        pel_real b = PEL_R(0.0);
        for (const pel_real *end = &h[j]; p != end; p += 2) { /* j - first is even */
            a += u[0] * p[0] + u[1] * p[1];
            b += v[0] * p[0] + v[1] * p[1];
            u += 2;
            v += 2;
        }
        f[j] = p[0] + a;
        f[j + 1] = p[1] + (b + v[0] * p[0]);
        u = v + 1 + first;
    }
    if (j < n) {
        pel_real a = h[j];
        for (int i = first; i < j; i++) { a += u[i - first] * h[i]; }
        f[j] = a;
    }
}

/* Column j of U and the gain so far, rows 0..j-1: u' = u + lambda g, g' = g + g_j u (Bierman 1977, V.3). */
static void fold_one(pel_real *u, pel_real *g, int j, pel_real lambda)
{
    const pel_real gj = g[j];
    for (int i = 0; i < j; i++) {
        const pel_real old = u[i];
        u[i] = old + lambda * g[i];
        g[i] += gj * old;
    }
}

/* The same for columns j and j + 1 with j even, two rows at a time: the gain is loaded and stored once for both columns. Returns the
 * column after them. */
static pel_real *fold_two(pel_real *u, pel_real *g, int j, pel_real lambda_u, pel_real lambda_v)
{
    pel_real *v = u + j;
    const pel_real gu = g[j];
    const pel_real gv = g[j + 1];
    for (const pel_real *end = v; u != end; u += 2) {
        const pel_real u0 = u[0];
        const pel_real u1 = u[1];
        const pel_real v0 = v[0];
        const pel_real v1 = v[1];
        const pel_real a0 = g[0];
        const pel_real a1 = g[1];
        const pel_real b0 = a0 + gu * u0;
        const pel_real b1 = a1 + gu * u1;
        u[0] = u0 + lambda_u * a0;
        u[1] = u1 + lambda_u * a1;
        v[0] = v0 + lambda_v * b0;
        v[1] = v1 + lambda_v * b1;
        g[0] = b0 + gv * v0;
        g[1] = b1 + gv * v1;
        v += 2;
        g += 2;
    }
    const pel_real old = v[0]; /* row j, where the gain is still gu */
    v[0] = old + lambda_v * gu;
    g[0] = gu + gv * old;
    return v + 1;
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
    int j = first;
    pel_real *u = &ud->U[column(j)];
    if ((j & 1) != 0) {
        const pel_real next = a + f[j] * g[j];
        ud->D[j] *= a / next;
        fold_one(u, g, j, -f[j] / a);
        u += j;
        a = next;
        j++;
    }
    for (; j + 2 <= n; j += 2) {
        const pel_real middle = a + f[j] * g[j];
        const pel_real next = middle + f[j + 1] * g[j + 1];
        ud->D[j] *= a / middle;
        ud->D[j + 1] *= middle / next;
        u = fold_two(u, g, j, -f[j] / a, -f[j + 1] / middle);
        a = next;
    }
    if (j < n) {
        const pel_real next = a + f[j] * g[j];
        ud->D[j] *= a / next;
        fold_one(u, g, j, -f[j] / a);
        a = next;
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

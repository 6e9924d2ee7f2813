/* update.c - Bierman's scalar measurement update and what a row sees of P. */
#include "packed.h"
#include "pelorus/filter.h"
#include "pelorus/math.h"

/* Columns before the first group of four; few rows of them are there. */
static int lead_of(int first, int n)
{
    return first + (n - first) % 4;
}

/* f_j = (U' h)_j for j = first..n-1, rows before `first` being zero. Four columns at a time share each element of h. */
static void project(const pel_ud_t *ud, const pel_real h[], int first, pel_real f[])
{
    const pel_real *start = &h[first];
    const pel_real *u = &ud->U[column(first) + first]; /* rows from `first` of column j */
    int j = first;
    for (const int lead = lead_of(first, ud->n); j < lead; j++) {
        pel_real a = PEL_R(0.0);
        for (const pel_real *p = start; p != &h[j]; p++) { a += *u++ * *p; }
        f[j] = h[j] + a;
        u += first;
    }
    for (; j < ud->n; j += 4) {
        const pel_real *v = u + j;
        const pel_real *w = v + j + 1;
        const pel_real *x = w + j + 2;
        const pel_real *p = start;
        pel_real a = PEL_R(0.0);
        pel_real b = PEL_R(0.0);
        pel_real c = PEL_R(0.0);
        pel_real d = PEL_R(0.0);
        for (const pel_real *end = &h[j]; p != end; p++) {
            a += *u++ * *p;
            b += *v++ * *p;
            c += *w++ * *p;
            d += *x++ * *p;
        }
        f[j] = p[0] + a;
        f[j + 1] = p[1] + (b + v[0] * p[0]);
        f[j + 2] = p[2] + (c + w[0] * p[0] + w[1] * p[1]);
        f[j + 3] = p[3] + (d + x[0] * p[0] + x[1] * p[1] + x[2] * p[2]);
        u = x + 3 + first;
    }
}

/* The innovation variance over the columns so far takes in one more, whose D shrinks by its growth. Returns f over what it was. */
static pel_real grow(pel_real *alpha, pel_real f, pel_real g, pel_real *D)
{
    const pel_real before = *alpha;
    *alpha = before + f * g;
    *D *= before / *alpha;
    return f / before;
}

/* Column j of U and the gain so far, rows 0..j-1: u' = u - lambda g, g' = g + g_j u (Bierman 1977, V.3). Returns the next column. */
static pel_real *fold_one(pel_real *u, pel_real *g, int j, pel_real lambda)
{
    const pel_real gj = g[j];
    for (const pel_real *end = u + j; u != end; g++) {
        const pel_real old = *u;
        const pel_real gain = *g;
        *u++ = old - lambda * gain;
        *g = gain + gj * old;
    }
    return u;
}

/* The same for columns j..j+3: each row of the gain is loaded and stored once for the four. */
static pel_real *fold_four(pel_real *u, const pel_real *f, pel_real *g, pel_real *D, int j, pel_real *alpha)
{
    pel_real *v = u + j;
    pel_real *w = v + j + 1;
    pel_real *x = w + j + 2;
    const pel_real gu = g[j];
    const pel_real gv = g[j + 1];
    const pel_real gw = g[j + 2];
    const pel_real gx = g[j + 3];
    const pel_real lu = grow(alpha, f[j], gu, &D[j]);
    const pel_real lv = grow(alpha, f[j + 1], gv, &D[j + 1]);
    const pel_real lw = grow(alpha, f[j + 2], gw, &D[j + 2]);
    const pel_real lx = grow(alpha, f[j + 3], gx, &D[j + 3]);
    for (const pel_real *end = v; u != end; g++) {
        const pel_real u0 = *u;
        const pel_real v0 = *v;
        const pel_real w0 = *w;
        const pel_real x0 = *x;
        const pel_real a = *g;
        const pel_real b = a + gu * u0;
        const pel_real c = b + gv * v0;
        const pel_real d = c + gw * w0;
        *u++ = u0 - lu * a;
        *v++ = v0 - lv * b;
        *w++ = w0 - lw * c;
        *x++ = x0 - lx * d;
        *g = d + gx * x0;
    }
    /* the corner above the diagonal: v, w, x and g have come to row j */
    const pel_real b0 = gu + gv * v[0];
    const pel_real c0 = b0 + gw * w[0];
    const pel_real c1 = gv + gw * w[1];
    g[0] = c0 + gx * x[0];
    g[1] = c1 + gx * x[1];
    g[2] = gw + gx * x[2];
    v[0] -= lv * gu;
    w[0] -= lw * b0;
    w[1] -= lw * gv;
    x[0] -= lx * c0;
    x[1] -= lx * c1;
    x[2] -= lx * gw;
    return x + 3;
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
    for (const int lead = lead_of(first, n); j < lead; j++) { u = fold_one(u, g, j, grow(&a, f[j], g[j], &ud->D[j])); }
    for (; j < n; j += 4) { u = fold_four(u, f, g, ud->D, j, &a); }

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
    const pel_real *u = &ud->U[column(high)];
    pel_real sum = ((low == high) ? PEL_R(1.0) : u[low]) * ud->D[high];
    for (int k = high + 1; k < ud->n; k++) {
        u += k - 1;
        sum += u[low] * u[high] * ud->D[k];
    }
    return sum;
}

pel_real pel_ud_var_of_sum(const pel_ud_t *ud, int i, int j)
{
    const int low = (i < j) ? i : j;
    const int high = (i < j) ? j : i;
    pel_real sum = ud->D[low];
    const pel_real *u = &ud->U[column(low)];
    for (int k = low + 1; k < ud->n; k++) {
        u += k - 1;
        const pel_real both = u[low] + ((k > high) ? u[high] : ((k == high) ? PEL_R(1.0) : PEL_R(0.0)));
        sum += both * both * ud->D[k];
    }
    return sum;
}

/* Rows i..i+2 of column k, its diagonal and what is below it too. */
static void three_rows(const pel_real *u, int i, int k, pel_real a[3])
{
    for (int r = 0; r < 3; r++) { a[r] = (i + r < k) ? u[i + r] : ((i + r == k) ? PEL_R(1.0) : PEL_R(0.0)); }
}

/* Sums of a_r b_c D, written out: loops of three would keep them in memory. */
typedef struct {
    pel_real s00, s01, s02, s10, s11, s12, s20, s21, s22;
} block_sum_t;

static inline void add_products(const pel_real a[3], const pel_real b[3], pel_real d, block_sum_t *s)
{
    s->s00 += a[0] * b[0] * d;
    s->s01 += a[0] * b[1] * d;
    s->s02 += a[0] * b[2] * d;
    s->s10 += a[1] * b[0] * d;
    s->s11 += a[1] * b[1] * d;
    s->s12 += a[1] * b[2] * d;
    s->s20 += a[2] * b[0] * d;
    s->s21 += a[2] * b[1] * d;
    s->s22 += a[2] * b[2] * d;
}

/* A block on the diagonal: the six of its upper triangle. */
static inline void add_squares(const pel_real a[3], pel_real d, block_sum_t *s)
{
    s->s00 += a[0] * a[0] * d;
    s->s01 += a[0] * a[1] * d;
    s->s02 += a[0] * a[2] * d;
    s->s11 += a[1] * a[1] * d;
    s->s12 += a[1] * a[2] * d;
    s->s22 += a[2] * a[2] * d;
}

/* The columns that end in the block itself, where rows of one or both are cut off by the diagonal. */
static void begin_block(const pel_ud_t *ud, int i, int j, block_sum_t *s)
{
    const int first = (i > j) ? i : j;
    pel_real a[3];
    pel_real b[3];
    s->s00 = s->s01 = s->s02 = s->s10 = s->s11 = s->s12 = s->s20 = s->s21 = s->s22 = PEL_R(0.0);
    for (int k = first; k < first + 3; k++) {
        three_rows(&ud->U[column(k)], i, k, a);
        three_rows(&ud->U[column(k)], j, k, b);
        add_products(a, b, ud->D[k], s);
    }
}

static void begin_diagonal(const pel_ud_t *ud, int i, block_sum_t *s)
{
    const pel_real u01 = ud->U[column(i + 1) + i];
    const pel_real u02 = ud->U[column(i + 2) + i];
    const pel_real u12 = ud->U[column(i + 2) + i + 1];
    const pel_real d1 = ud->D[i + 1];
    const pel_real d2 = ud->D[i + 2];
    s->s00 = ud->D[i] + u01 * u01 * d1 + u02 * u02 * d2;
    s->s01 = u01 * d1 + u02 * u12 * d2;
    s->s02 = u02 * d2;
    s->s11 = d1 + u12 * u12 * d2;
    s->s12 = u12 * d2;
    s->s22 = d2;
}

void pel_ud_block3(const pel_ud_t *ud, int i, int j, double P[3][3])
{
    block_sum_t s;
    int k = ((i > j) ? i : j) + 3;
    const pel_real *u = &ud->U[column(k)];
    if (i == j) {
        begin_diagonal(ud, i, &s);
        for (; k < ud->n; k++) {
            add_squares(&u[i], ud->D[k], &s);
            u += k;
        }
        s.s10 = s.s01;
        s.s20 = s.s02;
        s.s21 = s.s12;
    } else {
        begin_block(ud, i, j, &s);
        for (; k < ud->n; k++) {
            add_products(&u[i], &u[j], ud->D[k], &s);
            u += k;
        }
    }
    P[0][0] = (double)s.s00;
    P[0][1] = (double)s.s01;
    P[0][2] = (double)s.s02;
    P[1][0] = (double)s.s10;
    P[1][1] = (double)s.s11;
    P[1][2] = (double)s.s12;
    P[2][0] = (double)s.s20;
    P[2][1] = (double)s.s21;
    P[2][2] = (double)s.s22;
}

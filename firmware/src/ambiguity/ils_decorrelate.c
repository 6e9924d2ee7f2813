/* ils_decorrelate.c - Q = L D L' with pivoting, then integer transforms that make L nearly the identity.
 *
 * Row p of L belongs to the p-th ambiguity to be searched: w_p = (zhat_p - z_p) - sum_{j<p} L_pj w_j, norm = sum w_p^2 / D_p.
 * This is Teunissen's Q = L' D L with the order of ambiguities reversed, which lets every inner loop run along a row. */
#include "ambiguity_internal.h"
#include "pelorus/math.h"

#define PIVOT_MIN 1e-13 /* of the variance: below, the factor is noise of double arithmetic */
#define SWAP_GAIN 1e-6  /* a conditional variance must fall by this share for an exchange to be worth it */

static void swap_double(double *a, double *b)
{
    const double t = *a;
    *a = *b;
    *b = t;
}

static void swap_back_rows(pel_ils_t *s, int p, int q)
{
    int32_t *a = &s->back[p * s->n];
    int32_t *b = &s->back[q * s->n];
    for (int i = 0; i < s->n; i++) {
        const int32_t t = a[i];
        a[i] = b[i];
        b[i] = t;
    }
}

/* Exchange ambiguities k < p in a triangle whose first k columns are already factored. */
static void exchange(pel_ils_t *s, int k, int p)
{
    double *row_k = tri_row(s->LD, k);
    double *row_p = tri_row(s->LD, p);
    for (int j = 0; j < k; j++) { swap_double(&row_k[j], &row_p[j]); }
    swap_double(&row_k[k], &row_p[p]);
    for (int j = k + 1; j < p; j++) { swap_double(&tri_row(s->LD, j)[k], &row_p[j]); }
    for (int i = p + 1; i < s->n; i++) { swap_double(&tri_row(s->LD, i)[k], &tri_row(s->LD, i)[p]); }
    swap_double(&s->zhat[k], &s->zhat[p]);
    swap_double(&s->mean[k], &s->mean[p]);
    swap_back_rows(s, k, p);
}

pel_status_t pel_ils_factor(pel_ils_t *s)
{
    const int n = s->n;
    for (int i = 0; i < n; i++) { s->mean[i] = tri_row(s->LD, i)[i]; } /* variances, for the pivot test */
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k + 1; i < n; i++) {
            if (tri_row(s->LD, i)[i] < tri_row(s->LD, p)[p]) { p = i; }
        }
        if (p != k) { exchange(s, k, p); }
        const double d = tri_row(s->LD, k)[k];
        if (!(d > PIVOT_MIN * s->mean[k])) { return PEL_E_NOT_POSDEF; }
        double *column = s->w; /* d L_.k, side by side: the loop below is where the time goes */
        for (int i = k + 1; i < n; i++) { column[i] = tri_row(s->LD, i)[k]; }
        for (int i = k + 1; i < n; i++) {
            double *row = tri_row(s->LD, i);
            const double l = column[i] / d;
            for (int j = k + 1; j <= i; j++) { row[j] -= l * column[j]; }
            row[k] = l;
        }
    }
    return PEL_OK;
}

/* Row k minus m times row j, j < k, everywhere it shows. */
static pel_status_t subtract_row(pel_ils_t *s, int k, int j, int32_t m)
{
    const double mu = (double)m;
    double *row_k = tri_row(s->LD, k);
    const double *row_j = tri_row_const(s->LD, j);
    for (int i = 0; i < j; i++) { row_k[i] -= mu * row_j[i]; }
    row_k[j] -= mu;
    s->zhat[k] -= mu * s->zhat[j];

    int32_t *back_j = &s->back[j * s->n];
    const int32_t *back_k = &s->back[k * s->n];
    int64_t beyond = 0; /* becomes nonzero with the first entry that does not fit */
    for (int i = 0; i < s->n; i++) {
        const int64_t entry = back_j[i] + (int64_t)m * back_k[i];
        back_j[i] = (int32_t)entry;
        beyond |= entry - back_j[i];
    }
    return (beyond == 0) ? PEL_OK : PEL_E_RANGE;
}

/* All entries of row k to at most one half. Never lazily: entries left large lose the digits of those they are mixed with. */
static pel_status_t reduce_row(pel_ils_t *s, int k)
{
    const double *row = tri_row_const(s->LD, k);
    for (int j = k - 1; j >= 0; j--) {
        const double x = row[j];
        if (pel_fabs(x) <= 0.5) { continue; }
        if (!(pel_fabs(x) < (double)INT32_MAX)) { return PEL_E_RANGE; }
        const pel_status_t status = subtract_row(s, k, j, (int32_t)((x < 0.0) ? x - 0.5 : x + 0.5));
        if (status != PEL_OK) { return status; }
    }
    return PEL_OK;
}

/* Exchange neighbours k-1 and k, the latter's variance given the levels before being d_new (Cohen 1993, algorithm 2.6.3, in L D L'). */
static void swap_neighbours(pel_ils_t *s, int k, double d_new)
{
    double *upper = tri_row(s->LD, k - 1);
    double *lower = tri_row(s->LD, k);
    const double mu = lower[k - 1];
    const double mu_new = mu * upper[k - 1] / d_new;
    lower[k] = upper[k - 1] * lower[k] / d_new;
    upper[k - 1] = d_new;
    lower[k - 1] = mu_new;
    for (int j = 0; j < k - 1; j++) { swap_double(&upper[j], &lower[j]); }
    for (int i = k + 1; i < s->n; i++) {
        double *row = tri_row(s->LD, i);
        const double t = row[k];
        row[k] = row[k - 1] - mu * t;
        row[k - 1] = t + mu_new * row[k];
    }
    swap_double(&s->zhat[k - 1], &s->zhat[k]);
    swap_back_rows(s, k - 1, k);
}

pel_status_t pel_ils_decorrelate(pel_ils_t *s)
{
    int k = 1;
    s->decorrelated = true;
    while (k < s->n) {
        const pel_status_t status = reduce_row(s, k);
        if (status != PEL_OK) { return status; }
        const double *row = tri_row(s->LD, k);
        const double d_before = tri_row(s->LD, k - 1)[k - 1];
        const double d_new = row[k] + row[k - 1] * row[k - 1] * d_before;
        if (d_new < (1.0 - SWAP_GAIN) * d_before) {
            if (s->swaps >= PEL_ILS_SWAPS(s->n)) {
                s->decorrelated = false;
                k++; /* the rows that remain are still reduced */
                continue;
            }
            swap_neighbours(s, k, d_new);
            s->swaps++;
            k = (k > 1) ? k - 1 : 1;
        } else {
            k++;
        }
    }
    return PEL_OK;
}

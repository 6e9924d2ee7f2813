/* ils_decorrelate.c - Q = L D L' with pivoting, then integer transforms that bring the small conditional variances forward.
 *
 * Row p of L belongs to the p-th ambiguity to be searched: w_p = (zhat_p - z_p) - sum_{j<p} L_pj w_j, norm = sum w_p^2 / D_p.
 * This is Teunissen's Q = L' D L with the order of ambiguities reversed, which lets every inner loop run along a row.
 *
 * What the search costs depends on D alone, and D changes in exchanges alone. So a row is size-reduced only as far as an exchange
 * needs it (Xie, Chang, Al Borno 2011), and completely where it would otherwise grow. What stays unreduced changes no node of the
 * search, only how its integers are called: docs/INTEGERS.md. */
#include "ambiguity_internal.h"
#include "pelorus/math.h"

#define PIVOT_MIN     1e-13 /* of the variance: below, the factor is noise of double arithmetic */
#define SWAP_GAIN     0.02  /* a conditional variance must fall by this share for an exchange to be worth it */
#define STEP_MAX      32767.0
#define LONE_MAX      1.5  /* above, not only the neighbour is taken out of a row: its other entries would grow */
#define WEAK_VARIANCE 0.05 /* cycles^2: if conditional variances have a larger mean, searches may be long */

static void swap_double(double *a, double *b)
{
    const double t = *a;
    *a = *b;
    *b = t;
}

/* Exchange ambiguities k < p; the first k columns are factored, the others still hold the covariance. */
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
    const uint8_t t = s->order[k];
    s->order[k] = s->order[p];
    s->order[p] = t;
}

pel_status_t pel_ils_factor(pel_ils_t *s, bool pivoting)
{
    const int n = s->n;
    for (int i = 0; i < n; i++) {
        s->order[i] = (uint8_t)i;
        s->mean[i] = tri_row(s->LD, i)[i]; /* variances, for the pivot test; the diagonal itself is kept conditional */
    }
    for (int k = 0; k < n; k++) {
        int p = k;
        for (int i = k + 1; pivoting && i < n; i++) {
            if (tri_row(s->LD, i)[i] < tri_row(s->LD, p)[p]) { p = i; }
        }
        if (p != k) { exchange(s, k, p); }
        const double *row_k = tri_row(s->LD, k);
        const double d = row_k[k];
        if (!(d > PIVOT_MIN * s->mean[k])) { return PEL_E_NOT_POSDEF; }
        for (int j = 0; j < k; j++) { s->w[j] = tri_row(s->LD, j)[j] * row_k[j]; }
        const double inverse = 1.0 / d;
        double *row = tri_row(s->LD, k);
        for (int i = k + 1; i < n; i++) {
            row += i;
            const double c = row[k] - dot(row, s->w, k);
            row[k] = c * inverse;
            row[i] -= c * row[k];
        }
    }
    return PEL_OK;
}

/* Note a step before it is done, so that what is noted is what was done. False: no room, do nothing. */
static bool note(pel_ils_t *s, int k, int j, int32_t m, int shift)
{
    if (s->n_steps >= PEL_ILS_STEPS) { return false; }
    s->step_made[s->n_steps++] =
        (pel_ils_step_t){.k = (uint8_t)k & 63u, .shift = (uint8_t)shift & 3u, .j = (uint8_t)j, .m = (int16_t)m};
    return true;
}

/* Row k less the integer nearest to its entry j times row j. Multipliers beyond 15 bits take several steps. */
static bool reduce_entry(pel_ils_t *s, int k, int j)
{
    double *row_k = tri_row(s->LD, k);
    const double *row_j = tri_row_const(s->LD, j);
    while (pel_fabs(row_k[j]) > 0.5) {
        double x = row_k[j];
        double unit = 1.0;
        int shift = 0;
        for (; pel_fabs(x) > STEP_MAX && shift < 3; shift++) {
            x *= 1.0 / 256.0;
            unit *= 256.0;
        }
        if (!(pel_fabs(x) <= STEP_MAX)) { return false; }
        const int32_t m = nearest_integer(x);
        if (!note(s, k, j, m, shift)) { return false; }
        const double mu = unit * (double)m;
        for (int i = 0; i < j; i++) { row_k[i] -= mu * row_j[i]; }
        row_k[j] -= mu;
        s->zhat[k] -= mu * s->zhat[j];
    }
    return true;
}

/* All entries of row k to at most one half. */
static bool reduce_row(pel_ils_t *s, int k)
{
    for (int j = k - 1; j >= 0; j--) {
        if (!reduce_entry(s, k, j)) { return false; }
    }
    return true;
}

/* Row k less m times row k-1, then these two exchanged; d_new is the variance of the former given the levels before k-1 (Cohen 1993,
 * algorithm 2.6.3, in L D L'). */
static bool swap_neighbours(pel_ils_t *s, int k, int32_t m, double d_new)
{
    if (s->swaps >= PEL_ILS_SWAPS(s->n) || !note(s, k, k, m, 0)) { return false; }
    s->swaps++;
    const double mu = (double)m;
    double *upper = tri_row(s->LD, k - 1);
    double *lower = tri_row(s->LD, k);
    for (int j = 0; j < k - 1; j++) {
        const double t = lower[j] - mu * upper[j];
        lower[j] = upper[j];
        upper[j] = t;
    }
    const double t_hat = s->zhat[k] - mu * s->zhat[k - 1];
    s->zhat[k] = s->zhat[k - 1];
    s->zhat[k - 1] = t_hat;

    const double l = lower[k - 1] - mu;
    const double shrink = upper[k - 1] / d_new;
    const double l_new = l * shrink;
    lower[k] *= shrink;
    upper[k - 1] = d_new;
    lower[k - 1] = l_new;
    double *pair = &lower[k - 1];
    for (int i = k + 1; i < s->n; i++) {
        pair += i;
        const double t = pair[1];
        pair[1] = pair[0] - l * t;
        pair[0] = t + l_new * pair[1];
    }
    return true;
}

/* Exchanges of neighbours until none gains. False: a cap was met. */
static bool exchange_neighbours(pel_ils_t *s)
{
    int k = 1;
    while (k < s->n) {
        const double *row = tri_row_const(s->LD, k);
        const double d_before = row[-1]; /* the diagonal of the row before */
        const double l = row[k - 1];
        const bool alone = pel_fabs(l) < LONE_MAX;
        const int32_t m = (alone && pel_fabs(l) > 0.5) ? nearest_integer(l) : 0;
        double rest = alone ? l - (double)m : l - pel_round(l);
        if (!(row[k] + rest * rest * d_before < (1.0 - SWAP_GAIN) * d_before)) {
            k++;
            continue;
        }
        if (!alone) {
            if (!reduce_row(s, k)) { return false; }
            rest = row[k - 1];
        }
        if (!swap_neighbours(s, k, m, row[k] + rest * rest * d_before)) { return false; }
        if (k > 1) { k--; }
    }
    return true;
}

/* Is the search likely to be long? Then deeper insertion pays. */
static bool weak(const pel_ils_t *s)
{
    double sum = 0.0;
    for (int p = 0; p < s->n; p++) { sum += tri_row_const(s->LD, p)[p]; }
    return sum > WEAK_VARIANCE * s->n;
}

/* The earliest level whose variance would fall by SWAP_GAIN if ambiguity k came there, -1 if there is none. */
static int insertion_level(const pel_ils_t *s, int k)
{
    const double *row = tri_row_const(s->LD, k);
    double d_new = row[k];
    int level = -1;
    for (int j = k - 1; j >= 0; j--) {
        const double d = tri_row_const(s->LD, j)[j];
        d_new += row[j] * row[j] * d;
        if (d_new < (1.0 - SWAP_GAIN) * d) { level = j; }
    }
    return level;
}

/* Deep insertion (Schnorr, Euchner 1994): a row completely reduced goes to the earliest level that gains. */
static bool insert_deep(pel_ils_t *s)
{
    for (int k = 1; k < s->n;) {
        if (!reduce_row(s, k)) { return false; }
        const int level = insertion_level(s, k);
        if (level < 0) {
            k++;
            continue;
        }
        for (int i = k; i > level; i--) {
            const double *row = tri_row_const(s->LD, i);
            if (!swap_neighbours(s, i, 0, row[i] + row[i - 1] * row[i - 1] * row[-1])) { return false; }
        }
        k = (level > 0) ? level : 1;
    }
    return true;
}

void pel_ils_decorrelate(pel_ils_t *s)
{
    s->decorrelated = exchange_neighbours(s);
    if (s->decorrelated && weak(s)) { s->decorrelated = insert_deep(s); }
}

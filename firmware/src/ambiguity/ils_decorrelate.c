/* ils_decorrelate.c - integer transforms that bring the small conditional variances forward.
 *
 * Row p of L belongs to the p-th ambiguity to be searched: w_p = (zhat_p - z_p) - sum_{j<p} L_pj w_j, norm = sum w_p^2 / D_p.
 * This is Teunissen's Q = L' D L with the order of ambiguities reversed, which lets every inner loop run along a row.
 *
 * What the search costs depends on D alone, and D changes in exchanges alone. So a row is size-reduced only as far as an exchange
 * needs it (Xie, Chang, Al Borno 2011), and completely where it would otherwise grow. What stays unreduced changes no node of the
 * search, only how its integers are called: docs/INTEGERS.md. */
#include "ambiguity_internal.h"
#include "pelorus/math.h"

#define GAIN_FIRST PEL_R(0.35) /* a conditional variance must fall by this share for an exchange to be worth it */
#define GAIN_MORE  PEL_R(0.02) /* the same once the search has turned out to be long */
#define PATIENCE   24          /* nodes an ambiguity after which more decorrelation is cheaper than more search */
#define WEAK_SUM   PEL_R(3.0)  /* cycles^2: with a larger sum of conditional variances the search is sure to be long */
#define LONE_MAX   PEL_R(5.5)  /* above, not only the neighbour is taken out of a row: its other entries would grow */
#define FACTOR_MAX PEL_R(2047.0) /* largest multiplier of a step, times 2^0..2^SHIFT_MAX */
#define SHIFT_MAX  11
#define A_Z_TOP    (1 << 27) /* a_z stays below 2^59, 2^23 cycles: eight times that does not overflow */

/* A step of the decorrelation is noted and done to the float ambiguities before it is done to L. False: there is no room for the note, or
 * a float ambiguity would leave its range; nothing is done then. */

/* Ambiguity k less m (-7..7) times j. With to = k instead of j, ambiguities k and k-1 change places afterwards. */
static inline bool small_step(pel_ils_t *s, int k, int j, int32_t m, int to)
{
    const uint64_t by = (uint64_t)(int64_t)m;
    const uint64_t x = (uint64_t)s->a_z[k] - by * (uint64_t)s->a_z[j];
    const uint32_t top = (uint32_t)(x >> 32) + (uint32_t)A_Z_TOP;
    if (s->n_notes >= PEL_ILS_NOTES || top > 2u * (uint32_t)A_Z_TOP) { return false; }
    s->a_z[k] = (int64_t)x;
    s->note[s->n_notes++] = (uint16_t)(k << 10 | to << 4 | (m + 8));
    return true;
}

/* Ambiguity k less m (12 bits) 2^shift times j. */
static bool large_step(pel_ils_t *s, int k, int j, int32_t m, int shift)
{
    const int64_t factor = (int64_t)m * (1 << shift);
    const int64_t top = (s->a_z[j] >> 32) * factor;
    if (s->n_notes + 2 > PEL_ILS_NOTES || top > A_Z_TOP || top < -A_Z_TOP) { return false; }
    const int64_t x = s->a_z[k] - factor * s->a_z[j];
    if ((x >> 32) > A_Z_TOP || (x >> 32) < -A_Z_TOP) { return false; }
    s->a_z[k] = x;
    s->note[s->n_notes++] = (uint16_t)((uint32_t)(m * 16 + shift) & 0xFFFFu);
    s->note[s->n_notes++] = (uint16_t)(k << 10 | j << 4);
    return true;
}

/* Row k less the integer nearest to its entry j times row j. Large multipliers take several steps. */
static bool reduce_entry(pel_ils_t *s, int k, int j)
{
    pel_real *row_k = real_row(s->LD, k);
    const pel_real *row_j = real_row_const(s->LD, j);
    while (absolute(row_k[j]) > PEL_R(0.5)) {
        pel_real mu = nearest(row_k[j]);
        if (absolute(mu) < PEL_R(8.0)) {
            if (!small_step(s, k, j, (int32_t)mu, j)) { return false; }
        } else {
            pel_real x = row_k[j];
            int shift = 0;
            for (; absolute(x) > FACTOR_MAX && shift < SHIFT_MAX; shift++) { x *= PEL_R(0.5); }
            if (!(absolute(x) <= FACTOR_MAX) || !large_step(s, k, j, (int32_t)nearest(x), shift)) { return false; }
            mu = nearest(x) * (pel_real)(1 << shift);
        }
        for (int i = 0; i < j; i++) { row_k[i] -= mu * row_j[i]; }
        row_k[j] -= mu;
    }
    return true;
}

/* All entries of row k to at most one half. */
static bool reduce_row(pel_ils_t *s, int k)
{
    const pel_real *row = real_row_const(s->LD, k);
    for (int j = k - 1; j >= 0; j--) {
        if (absolute(row[j]) > PEL_R(0.5) && !reduce_entry(s, k, j)) { return false; }
    }
    return true;
}

/* Row k less m times row k-1, then these two exchanged; d_new is the variance of the former given the levels before k-1 (Cohen 1993,
 * algorithm 2.6.3, in L D L'). */
static bool swap_neighbours(pel_ils_t *s, int k, int32_t m, pel_real d_new)
{
    if (s->swaps >= PEL_ILS_SWAPS(s->n) || !small_step(s, k, k - 1, m, k)) { return false; }
    s->swaps++;
    const pel_real mu = (pel_real)m;
    pel_real *upper = real_row(s->LD, k - 1);
    pel_real *lower = real_row(s->LD, k);
    for (int j = 0; j < k - 1; j++) {
        const pel_real t = lower[j] - mu * upper[j];
        lower[j] = upper[j];
        upper[j] = t;
    }
    const int64_t a_k = s->a_z[k];
    s->a_z[k] = s->a_z[k - 1];
    s->a_z[k - 1] = a_k;

    const pel_real l = lower[k - 1] - mu;
    const pel_real shrink = upper[k - 1] / d_new;
    const pel_real l_new = l * shrink;
    lower[k] *= shrink;
    upper[k - 1] = d_new;
    lower[k - 1] = l_new;
    pel_real *pair = &lower[k - 1];
    for (int i = k + 1; i < s->n; i++) {
        pair += i;
        const pel_real t = pair[1];
        pair[1] = pair[0] - l * t;
        pair[0] = t + l_new * pair[1];
    }
    return true;
}

/* Exchanges of neighbours until none gains. False: a cap was met. */
static bool exchange_neighbours(pel_ils_t *s, pel_real gain)
{
    const pel_real keep = PEL_R(1.0) - gain;
    int k = 1;
    const pel_real *row = real_row_const(s->LD, k); /* row k */
    while (k < s->n) {
        const pel_real d_before = row[-1]; /* the diagonal of the row before */
        const pel_real l = row[k - 1];
        const pel_real m = nearest(l);
        pel_real rest = l - m;
        if (!(row[k] + rest * rest * d_before < keep * d_before)) {
            k++;
            row += k;
            continue;
        }
        const bool alone = absolute(l) < LONE_MAX;
        if (!alone) {
            if (!reduce_row(s, k)) { return false; }
            rest = row[k - 1];
        }
        if (!swap_neighbours(s, k, alone ? (int32_t)m : 0, row[k] + rest * rest * d_before)) { return false; }
        if (k > 1) {
            row -= k;
            k--;
        }
    }
    return true;
}

/* The earliest level whose variance would fall by GAIN_MORE if ambiguity k came there, -1 if there is none. */
static int insertion_level(const pel_ils_t *s, int k)
{
    const pel_real *row = real_row_const(s->LD, k);
    pel_real d_new = row[k];
    int level = -1;
    for (int j = k - 1; j >= 0; j--) {
        const pel_real d = real_row_const(s->LD, j)[j];
        d_new += row[j] * row[j] * d;
        if (d_new < (PEL_R(1.0) - GAIN_MORE) * d) { level = j; }
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
            const pel_real *row = real_row_const(s->LD, i);
            if (!swap_neighbours(s, i, 0, row[i] + row[i - 1] * row[i - 1] * row[-1])) { return false; }
        }
        k = (level > 0) ? level : 1;
    }
    return true;
}

/* Is the search sure to be long? */
static bool weak(const pel_ils_t *s)
{
    if (s->unit < -8) { return false; } /* all variances are small */
    const pel_real unit = (pel_real)(1 << (s->unit + 8)) * PEL_R(0.00390625);
    pel_real sum = PEL_R(0.0);
    for (int p = 0; p < s->n; p++) { sum += real_row_const(s->LD, p)[p]; }
    return sum * (unit * unit) > WEAK_SUM;
}

void pel_ils_decorrelate_more(pel_ils_t *s)
{
    s->patience = INT32_MAX;
    s->decorrelated = exchange_neighbours(s, GAIN_MORE) && insert_deep(s);
}

void pel_ils_decorrelate(pel_ils_t *s)
{
    s->patience = PATIENCE * s->n;
    s->decorrelated = exchange_neighbours(s, GAIN_FIRST);
    if (s->decorrelated && weak(s)) { pel_ils_decorrelate_more(s); }
}

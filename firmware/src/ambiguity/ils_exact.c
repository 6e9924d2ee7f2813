/* ils_exact.c - squared norms from the exact factor: what the search finds is ranked by these. */
#include <string.h>

#include "ambiguity_internal.h"
#include "ils_fixed.h"

double pel_ils_scaled(double x, int k)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    const int e = (int)(bits >> 52) & 0x7FF;
    if (e == 0 || e + k <= 0) { return 0.0; }
    bits = (e + k < 0x7FF) ? bits + ((uint64_t)(int64_t)k << 52) : UINT64_C(0x7FEFFFFFFFFFFFFF);
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* N - N0 behind the decorrelated integers of two candidates, in place: the steps undone, last first. Modulo 2^32, which is exact for every
 * difference that fits, whatever the numbers on the way; one that does not fit shows in the exact norm. */
static void undo_two(const pel_ils_t *s, uint32_t *N, uint32_t *M)
{
    for (int p = 0; p < s->n; p++) {
        const uint32_t whole = (uint32_t)whole_of(s->a_z[p]);
        N[p] += whole;
        M[p] += whole;
    }
    for (const uint16_t *note = s->note + s->n_notes; note != s->note;) {
        const uint32_t step = *--note;
        const uint32_t k = step >> 10;
        const uint32_t j = (step >> 4) & 63u;
        uint32_t m = (step & 15u) - 8u;
        if ((step & 15u) == 0) { /* a multiplier of its own: 12 bits and a power of two */
            const int16_t own = (int16_t) * --note;
            m = (uint32_t)(own >> 4) << (own & 15);
        }
        if (k == j) {
            const uint32_t N_reduced = N[k - 1];
            const uint32_t M_reduced = M[k - 1];
            N[k - 1] = N[k];
            M[k - 1] = M[k];
            N[k] = N_reduced + m * N[k - 1];
            M[k] = M_reduced + m * M[k - 1];
        } else {
            N[k] += m * N[j];
            M[k] += m * M[j];
        }
    }
}

/* The same for `count` candidates, PEL_MAX_AMB apart. */
static void undo(const pel_ils_t *s, int32_t *z, int count)
{
    uint32_t *N = (uint32_t *)z;
    for (; count >= 2; count -= 2) {
        undo_two(s, N, N + PEL_MAX_AMB);
        N += 2 * PEL_MAX_AMB;
    }
    if (count > 0) {
        uint32_t spare[PEL_MAX_AMB] = {0};
        undo_two(s, N, spare);
    }
}

/* The same for those held from candidate k on that are still as the search found them. */
static void undo_from(pel_ils_t *s, int k)
{
    int i = k;
    for (; i < s->n_held && s->held_sq[i] == PEL_ILS_NOT_UNDONE; i++) { s->held_sq[i] = PEL_ILS_NOT_SUMMED; }
    undo(s, s->held[k], i - k);
}

static int64_t shifted(int64_t x, int left)
{
    if (left >= 0) { return scaled(x, left); }
    return (left > -62) ? x >> -left : 0;
}

/* offset() where N is large or the shift is. */
OWN_REGISTERS static int64_t far_offset(int64_t frac, int32_t N, int places)
{
    const int up = places - FRACTION;
    if (N > 1023 || N < -1023) { /* frac has too many places for these */
        const int64_t most = (places < PLACES - 30) ? INT64_C(1) << 31 : ONE >> places;
        if (places >= PLACES || N > most || N < -most) { return ONE; }
        return shifted(frac, up) - shifted(N, places);
    }
    const int64_t x = frac - scaled(N, FRACTION);
    const int64_t most = (up > 0) ? ONE >> up : INT64_MAX;
    return (x > most || x < -most) ? ONE : shifted(x, up);
}

/* (frac - N) 2^(places - FRACTION), or ONE if that is clearly more; places <= 60. */
static inline int64_t offset(int64_t frac, int32_t N, int places)
{
    const int up = places - FRACTION;
    if (N > 1023 || N < -1023 || up < 0 || up > PLACES - 32) { return far_offset(frac, N, places); }
    const int64_t x = frac - scaled(N, FRACTION);
    const int32_t top = (int32_t)(x >> 32);
    const int32_t most = (int32_t)(ONE >> 32) >> up;
    return (top > most || top < -most) ? ONE : (int64_t)((uint64_t)x * ((uint32_t)1 << up));
}

/* Sum of squares of y = G^-1 (a - N) in units of 4^unit; -1 if that is ONE or more. */
static int64_t sum_of_squares(const pel_ils_t *s, const int32_t *N, int unit)
{
    fixed_t y[PEL_MAX_AMB];
    int64_t sum = 0;
    const fixed_t *row = s->G;
    for (int p = 0; p < s->n; p++) {
        const int64_t d = offset(s->frac[p], N[p], PLACES - s->row_unit[p] - unit);
        const int64_t minus_c = fixed_dot(row, y, p) - d;
        const int32_t top = (int32_t)(minus_c >> 30);
        if (top >= row[p].hi || top < -row[p].hi) { return -1; }
        y[p] = times(minus_c, (reciprocal_t){s->minus_inverse[p], s->shift[p]});
        sum += square(y[p]);
        if (sum >= ONE) { return -1; }
        row += p + 1;
    }
    return sum;
}

/* A unit of y, 2^unit, that makes squared norms up to `near` less than ONE and leaves them their digits. Norms of the search are in units
 * of 4^-s->unit; *scale takes sums to those. */
static int unit_for(const pel_ils_t *s, pel_real near, pel_real *scale)
{
    int least = INT32_MAX;
    for (int p = 0; p < s->n; p++) { least = (s->row_unit[p] < least) ? s->row_unit[p] : least; }
    int unit = -s->unit;
    pel_real one = PEL_R(1.0);
    for (; unit < -1 - least || one * PEL_R(0.9) < near; unit++) { one *= PEL_R(4.0); }
    *scale = one * PEL_R(1.734723475976807e-18); /* 2^-59 */
    return unit;
}

void pel_ils_exact_norms(pel_ils_t *s)
{
    if (!(s->exact_scale > PEL_R(0.0))) {
        pel_real near = PEL_R(0.0);
        for (int k = 0; k < s->n_held; k++) { near = (s->held_near[k] > near) ? s->held_near[k] : near; }
        s->exact_unit = (int16_t)unit_for(s, near, &s->exact_scale);
    }
    for (int k = 0; k < s->n_held; k++) {
        if (s->held_sq[k] >= 0) { continue; }
        if (s->held_sq[k] == PEL_ILS_NOT_UNDONE) { undo_from(s, k); }
        s->held_sq[k] = sum_of_squares(s, s->held[k], s->exact_unit);
        if (s->held_sq[k] < 0) { /* farther off than the search believes: all again in a larger unit */
            for (int i = 0; i < s->n_held; i++) {
                if (i <= k || s->held_sq[i] >= 0) { s->held_sq[i] = PEL_ILS_NOT_SUMMED; }
            }
            s->exact_unit = (int16_t)(s->exact_unit + 2);
            s->exact_scale *= PEL_R(16.0);
            k = -1;
        }
    }
}

void pel_ils_apart(const pel_ils_t *s, int k, int32_t *N)
{
    memcpy(N, s->held[k], (size_t)s->n * sizeof N[0]);
    if (s->held_sq[k] == PEL_ILS_NOT_UNDONE) { undo(s, N, 1); }
}

double pel_ils_norm(const pel_ils_t *s, int k)
{
    int64_t sq = s->held_sq[k];
    int unit = s->exact_unit;
    if (sq < 0) { /* still searching */
        int32_t N[PEL_MAX_AMB];
        pel_real scale;
        pel_ils_apart(s, k, N);
        unit = unit_for(s, s->held_near[k], &scale);
        for (sq = sum_of_squares(s, N, unit); sq < 0; sq = sum_of_squares(s, N, unit)) { unit += 2; }
    }
    return pel_ils_scaled((double)sq, 2 * unit - PLACES);
}

double pel_ils_variance(const pel_ils_t *s, int p)
{
    return pel_ils_scaled((double)real_row_const(s->LD, p)[p], 2 * s->unit);
}

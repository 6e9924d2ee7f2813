/* ils_factor.c - a and Q from double to fixed point, and Q = G G' with symmetric pivoting.
 *
 * Each ambiguity is measured in its own power of two, which makes variances lie in [1/4, 1) and all entries of G below 1. Row p of G
 * belongs to the p-th ambiguity to be searched. */
#include <string.h>

#include "ambiguity_internal.h"
#include "ils_fixed.h"
#include "pelorus/bits.h"

#define FLOAT_MAX    UINT64_C(0x430C6BF526340000) /* 1e15: a double still resolves an eighth of a cycle */
#define VARIANCE_MAX UINT64_C(0x426D1A94A2000000) /* 1e12 */
#define PIVOT_BITS   43                           /* a pivot of 2^-43 of its variance is noise */
#define SPREAD_MAX   24                           /* most powers of two between the standard deviations */

/* What the factor knows of each row. */
typedef struct {
    int64_t left[PEL_MAX_AMB];     /* conditional variance in the row's own unit */
    int64_t variance[PEL_MAX_AMB]; /* at first */
    pel_real weight[PEL_MAX_AMB];  /* the row's unit over the largest, squared */
    int unit[PEL_MAX_AMB];         /* exponent of the row's unit, cycles */
    int unit_max;
} rows_t;

static int exponent_of(uint64_t bits)
{
    return (int)(bits >> 52) & 0x7FF;
}
static uint64_t significand_of(uint64_t bits)
{
    return (bits & UINT64_C(0xFFFFFFFFFFFFF)) | UINT64_C(0x10000000000000);
}

/* A double times 2^(PLACES - unit), right = 1022 + unit - its exponent in 0..62; what is below the last place is lost. Word by word, which
 * costs less than a shift of 64 bits by a variable. */
static inline int64_t fixed_of(uint64_t bits, int right)
{
    const uint64_t x = significand_of(bits) << (PLACES - 53);
    uint32_t hi = (uint32_t)(x >> 32);
    uint32_t lo = (uint32_t)x;
    if (right < 32) {
        lo = lo >> right | (hi << 1) << (31 - right);
        hi >>= right;
    } else {
        lo = hi >> (right - 32);
        hi = 0;
    }
    const uint64_t size = (uint64_t)hi << 32 | lo;
    return (bits >> 63 != 0) ? -(int64_t)size : (int64_t)size;
}

/* An entry of Q waits in the place of one of G. */
static fixed_t as_words(int64_t x)
{
    return (fixed_t){(int32_t)(x >> 32), (int32_t)(uint32_t)x};
}
static int64_t of_words(fixed_t x)
{
    return (int64_t)((uint64_t)(uint32_t)x.hi << 32 | (uint32_t)x.lo);
}

/* Take the integer part out of every float ambiguity: what is left is small, whatever the receiver counted before. */
static pel_status_t take_ambiguities(pel_ils_t *s, const double *a)
{
    for (int i = 0; i < s->n; i++) {
        const uint64_t bits = pel_f64_bits(a[i]);
        if ((bits & ~(UINT64_C(1) << 63)) > FLOAT_MAX) { return PEL_E_RANGE; }
        int64_t whole = 0;
        int64_t frac = 0;
        const int below = 1075 - exponent_of(bits); /* binary places of the significand, 3 at least */
        if (below > 53) {
            const int right = 1022 + PLACES - FRACTION - exponent_of(bits);
            frac = (right <= 62) ? fixed_of(bits, right) : 0;
        } else {
            const uint64_t x = significand_of(bits);
            /* places behind the point, 2^-64; negative from one half on */
            const int64_t rest = (int64_t)(x << (64 - below));
            whole = (int64_t)(x >> below) + (rest < 0 ? 1 : 0);
            frac = rest >> (64 - FRACTION);
            if (bits >> 63 != 0) {
                whole = -whole;
                frac = -frac;
            }
        }
        s->frac[i] = frac;
        s->origin[i] = whole;
        s->order[i] = (uint8_t)i;
    }
    return PEL_OK;
}

/* Units from the variances. */
static pel_status_t choose_units(const pel_ils_t *s, const double *Q, rows_t *r)
{
    r->unit_max = -1024;
    for (int i = 0; i < s->n; i++) {
        const uint64_t bits = pel_f64_bits(tri_row_const(Q, i)[i]);
        if ((bits & ~(UINT64_C(1) << 63)) > VARIANCE_MAX) { return PEL_E_RANGE; }
        const int e = exponent_of(bits);
        if (e == 0 || bits >> 63 != 0) { return PEL_E_NOT_POSDEF; }
        r->unit[i] = (e - 1021) >> 1; /* e - 1022 halved and rounded up */
        if (r->unit[i] > r->unit_max) { r->unit_max = r->unit[i]; }
    }
    return PEL_OK;
}

/* Q into G, which may be the same memory. */
static pel_status_t take_covariance(pel_ils_t *s, const double *Q, rows_t *r)
{
    fixed_t *g = s->G;
    for (int i = 0; i < s->n; i++) {
        const int apart = r->unit_max - r->unit[i];
        if (apart > SPREAD_MAX) { return PEL_E_RANGE; }
        for (const int *unit = r->unit, *end = unit + i + 1; unit != end; unit++) {
            const uint64_t bits = pel_f64_bits(*Q++);
            const int right = 1022 + r->unit[i] + *unit - exponent_of(bits);
            if (right < 0) { /* above both deviations */
                return (exponent_of(bits) == 0x7FF) ? PEL_E_RANGE : PEL_E_NOT_POSDEF;
            }
            *g++ = as_words((right <= 62) ? fixed_of(bits, right) : 0);
        }
        r->left[i] = of_words(g[-1]);
        const pel_real weight = PEL_R(1.0) / (pel_real)(int32_t)(1 << apart);
        r->weight[i] = weight * weight;
        r->variance[i] = r->left[i];
    }
    return PEL_OK;
}

/* Exchange ambiguities k < p; the first k columns are factored, the others still hold the covariance. */
OWN_REGISTERS static void exchange(pel_ils_t *s, rows_t *r, int k, int p)
{
    fixed_t *row_k = fixed_row(s->G, k);
    fixed_t *row_p = fixed_row(s->G, p);
    for (fixed_t *a = row_k, *b = row_p; a != row_k + k; a++, b++) { SWAP(fixed_t, *a, *b); }
    fixed_t *in_k = &row_k[k]; /* walks down column k */
    for (int j = k + 1; j < p; j++) {
        in_k += j;
        SWAP(fixed_t, *in_k, row_p[j]);
    }
    in_k += p;
    for (int i = p + 1; i < s->n; i++) {
        in_k += i;
        SWAP(fixed_t, in_k[0], in_k[p - k]);
    }
    SWAP(int64_t, r->left[k], r->left[p]);
    SWAP(int64_t, r->variance[k], r->variance[p]);
    SWAP(pel_real, r->weight[k], r->weight[p]);
    SWAP(int, r->unit[k], r->unit[p]);
    SWAP(int64_t, s->frac[k], s->frac[p]);
    SWAP(uint8_t, s->order[k], s->order[p]);
}

static inline pel_real conditional_variance(const rows_t *r, int i)
{
    return (pel_real)(int32_t)(r->left[i] >> 32) * r->weight[i];
}

/* The ambiguity of smallest variance. */
static int first_pivot(const rows_t *r, int n)
{
    int p = 0;
    for (int i = 1; i < n; i++) {
        if (conditional_variance(r, i) < conditional_variance(r, p)) { p = i; }
    }
    return p;
}

/* Column k of the factor; the ambiguity of smallest conditional variance of those behind. */
OWN_REGISTERS static int factor_column(pel_ils_t *s, rows_t *r, int k)
{
    const int n = s->n;
    const reciprocal_t inverse = pel_ils_inverse_root(r->left[k]);
    const reciprocal_t minus = {{-inverse.mantissa.hi, -inverse.mantissa.lo}, inverse.shift};
    const fixed_t *row_k = fixed_row(s->G, k);
    fixed_t *row = fixed_row(s->G, k);
    row[k] = times(r->left[k], inverse);
    s->minus_inverse[k] = minus.mantissa;
    s->shift[k] = (uint8_t)inverse.shift;
    int next = k + 1;
    pel_real least = PEL_REAL_MAX;
    for (int i = k + 1; i < n; i++) {
        row += i;
        const fixed_t g = times(fixed_dot(row, row_k, k) - of_words(row[k]), minus);
        row[k] = g;
        r->left[i] -= square(g);
        const pel_real variance = conditional_variance(r, i);
        if (variance < least) {
            least = variance;
            next = i;
        }
    }
    return next;
}

/* L, D and float ambiguities as the decorrelation wants them, in one unit. */
static void to_real(pel_ils_t *s, const rows_t *r)
{
    const fixed_t *g = s->G;
    pel_real *l = s->LD;
    s->unit = (int16_t)r->unit_max;
    for (int i = 0; i < s->n; i++) {
        const pel_real scale =
            PEL_R(1.734723475976807e-18) / (pel_real)(int32_t)(1 << (r->unit_max - r->unit[i])); /* 2^-59 */
        s->row_unit[i] = (int16_t)r->unit[i];
        for (int j = 0; j < i; j++) { *l++ = real_of(*g++) * (scale * s->inv_D[j]); }
        const pel_real sigma = real_of(*g++) * scale;
        s->inv_D[i] = PEL_R(1.0) / sigma; /* of the columns above, for now */
        *l++ = sigma * sigma;
        s->a_z[i] = s->frac[i] >> (FRACTION - A_Z_PLACES);
    }
}

pel_status_t pel_ils_take_in(pel_ils_t *s, const double *a, const double *Q, bool pivoting)
{
    rows_t r;
    pel_status_t status = choose_units(s, Q, &r);
    if (status == PEL_OK) { status = take_covariance(s, Q, &r); }
    if (status == PEL_OK) { status = take_ambiguities(s, a); }
    if (status != PEL_OK) { return status; }
    int p = first_pivot(&r, s->n);
    for (int k = 0; k < s->n; k++) {
        if (pivoting && p != k) { exchange(s, &r, k, p); }
        if (r.left[k] <= r.variance[k] >> PIVOT_BITS) { return PEL_E_NOT_POSDEF; }
        p = factor_column(s, &r, k);
    }
    to_real(s, &r);
    return PEL_OK;
}

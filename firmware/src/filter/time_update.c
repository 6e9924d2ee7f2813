/* time_update.c - P = Phi P Phi' + Q, knowing which blocks there are.
 *
 * W = [I | Phi U] has one column per driven state and one per state, with weights [q | D]: P = W diag(weights) W'. It is brought back to
 * unit upper triangular form row by row from the last: everything left of a row's diagonal is turned into the diagonal's column
 * by scaled rotations (Gentleman 1973), each of which is a step of Agee and Turner's (1972) rank-one update:
 *     D' = D + d w^2,  g = d w / D',  d' = d D / D';   for the rows above:  t' = t - w u,  u' = u + g t'
 * with u, t the elements in the diagonal's and in the other column. Weights only grow or shrink by factors, nothing is
 * subtracted from a variance. A column is done with its row, which makes this a third cheaper than Thornton's weighted Gram-Schmidt
 * (1976), where all columns stay to the end.
 *
 * Three structures save work: states after the last touched row keep their columns; noise columns are empty below their
 * own row, so the first rows to be treated meet none; a row starts at its first column that is not zero. */
#include "packed.h"
#include "pelorus/filter.h"
#include "pelorus/math.h"

#define WIDTH (PEL_UD_MAX_MOVING + PEL_UD_MAX_NOISE)

typedef struct {
    pel_real W[PEL_UD_MAX_MOVING][WIDTH]; /* columns: noise n_noise - 1 .. 0, then states */
    pel_real weight[WIDTH];
    uint8_t start[PEL_UD_MAX_MOVING]; /* first state column of a row that may not be zero */
    int rows;                         /* rows to be treated; states from here on are untouched */
    int noise_row
        [PEL_UD_MAX_NOISE]; /* driven states, descending; noise k has column n_noise - 1 - k, next to the states when k = 0 */
    int n_noise;
} work_t;

/* Which states change, and which are driven. */
static pel_status_t survey(const pel_ud_t *ud, const pel_transition_t *t, work_t *w)
{
    if (t->n != ud->n) { return PEL_E_RANGE; }
    w->rows = 0;
    w->n_noise = 0;
    for (int k = 0; k < t->n_blocks; k++) {
        const int end = (int)t->block[k].row + 3;
        if (end > ud->n || (int)t->block[k].col + 3 > ud->n) { return PEL_E_RANGE; }
        if (end > w->rows) { w->rows = end; }
    }
    for (int i = ud->n - 1; i >= 0; i--) {
        if (t->q[i] > PEL_R(0.0)) {
            if (w->n_noise == PEL_UD_MAX_NOISE) { return PEL_E_RANGE; }
            w->noise_row[w->n_noise++] = i;
            if (i + 1 > w->rows) { w->rows = i + 1; }
        }
    }
    return (w->rows <= PEL_UD_MAX_MOVING) ? PEL_OK : PEL_E_RANGE;
}

/* W = [I | U], rows 0..rows-1 */
static void fill(const pel_ud_t *ud, const pel_transition_t *t, work_t *w)
{
    const int nn = w->n_noise;
    for (int i = 0; i < w->rows; i++) {
        pel_real *row = w->W[i];
        for (int k = 0; k < nn + i; k++) { row[k] = PEL_R(0.0); }
        row[nn + i] = PEL_R(1.0);
        w->start[i] = (uint8_t)i;
    }
    for (int j = 1; j < w->rows; j++) {
        const pel_real *u = &ud->U[column(j)];
        for (int i = 0; i < j; i++) { w->W[i][nn + j] = u[i]; }
    }
    for (int k = 0; k < w->rows; k++) { w->weight[nn + k] = ud->D[k]; }
    for (int k = 0; k < nn; k++) {
        w->W[w->noise_row[k]][nn - 1 - k] = PEL_R(1.0);
        w->weight[nn - 1 - k] = t->q[w->noise_row[k]];
    }
}

/* W rows row..row+2 += m (U rows col..col+2), columns before w->rows. The corner of U has ones on its diagonal and zeros below. */
static void add_block(const pel_ud_t *ud, int row, int col, const pel_real m[3][3], work_t *w)
{
    const pel_real *u = ud->U;
    pel_real *w0 = &w->W[row][w->n_noise];
    pel_real *w1 = &w->W[row + 1][w->n_noise];
    pel_real *w2 = &w->W[row + 2][w->n_noise];
    const pel_real m00 = m[0][0];
    const pel_real m01 = m[0][1];
    const pel_real m02 = m[0][2];
    const pel_real m10 = m[1][0];
    const pel_real m11 = m[1][1];
    const pel_real m12 = m[1][2];
    const pel_real m20 = m[2][0];
    const pel_real m21 = m[2][1];
    const pel_real m22 = m[2][2];

    for (int j = col; j < col + 3 && j < w->rows; j++) {
        const pel_real *s = u + column(j) + col;
        const pel_real s0 = (j > col) ? s[0] : PEL_R(1.0);
        const pel_real s1 = (j > col + 1) ? s[1] : ((j == col + 1) ? PEL_R(1.0) : PEL_R(0.0));
        const pel_real s2 = (j == col + 2) ? PEL_R(1.0) : PEL_R(0.0);
        w0[j] += m00 * s0 + m01 * s1 + m02 * s2;
        w1[j] += m10 * s0 + m11 * s1 + m12 * s2;
        w2[j] += m20 * s0 + m21 * s1 + m22 * s2;
    }
    const pel_real *s = u + column(col + 2) + col; /* rows col.. of column j - 1; column j lies j - 1 further */
    for (int j = col + 3; j < w->rows; j++) {
        s += j - 1;
        const pel_real s0 = s[0];
        const pel_real s1 = s[1];
        const pel_real s2 = s[2];
        w0[j] += m00 * s0 + m01 * s1 + m02 * s2;
        w1[j] += m10 * s0 + m11 * s1 + m12 * s2;
        w2[j] += m20 * s0 + m21 * s1 + m22 * s2;
    }
    for (int i = row; i < row + 3; i++) {
        if (col < (int)w->start[i]) { w->start[i] = (uint8_t)col; }
    }
}

/* Columns of the untouched states become those of Phi U. Their rows are unit vectors: nothing else of P changes with them. */
static void trailing_columns(pel_ud_t *ud, const pel_transition_t *t, int rows)
{
    for (int j = rows; j < ud->n; j++) {
        pel_real *u = &ud->U[column(j)];
        pel_real old[PEL_MAX_STATES + 2]; /* the column with its diagonal, and zeros for blocks that reach beyond it */
        for (int i = 0; i < j; i++) { old[i] = u[i]; }
        old[j] = PEL_R(1.0);
        old[j + 1] = PEL_R(0.0);
        old[j + 2] = PEL_R(0.0);
        for (int k = 0; k < t->n_blocks; k++) {
            if ((int)t->block[k].col > j) { continue; }
            const pel_real *s = &old[t->block[k].col];
            pel_real *to = &u[t->block[k].row];
            for (int i = 0; i < 3; i++) {
                const pel_real *m = t->block[k].m[i];
                to[i] += m[0] * s[0] + m[1] * s[1] + m[2] * s[2];
            }
        }
    }
}

/* The rotations of one row applied to four rows above it: the coefficients are loaded once for all. u: their elements in the
 * diagonal's column. */
static void rotate_four(pel_real W[4][WIDTH], int from, const pel_real *c, const pel_real *g, int n, pel_real u[4])
{
    pel_real *w = &W[0][from];
    pel_real *x = &W[1][from];
    pel_real *y = &W[2][from];
    pel_real *z = &W[3][from];
    pel_real p = u[0];
    pel_real q = u[1];
    pel_real r = u[2];
    pel_real s = u[3];
    for (const pel_real *end = c + n; c != end; c++) {
        const pel_real ck = *c;
        const pel_real gk = *g++;
        const pel_real a = *w - ck * p;
        const pel_real b = *x - ck * q;
        const pel_real d = *y - ck * r;
        const pel_real e = *z - ck * s;
        *w++ = a;
        *x++ = b;
        *y++ = d;
        *z++ = e;
        p += gk * a;
        q += gk * b;
        r += gk * d;
        s += gk * e;
    }
    u[0] = p;
    u[1] = q;
    u[2] = r;
    u[3] = s;
}

static pel_real rotate_one(pel_real *a, const pel_real *c, const pel_real *g, int n, pel_real u)
{
    for (int k = 0; k < n; k++) {
        const pel_real s = a[k] - c[k] * u;
        a[k] = s;
        u += g[k] * s;
    }
    return u;
}

/* Back to triangular form, from the last row to the first. False if a D is not positive. */
static bool triangularise(pel_ud_t *ud, work_t *w)
{
    const int nn = w->n_noise;
    int active = 0; /* noise columns that are not zero from this row up */
    pel_real g[WIDTH];

    for (int j = w->rows - 1; j >= 0; j--) {
        if (active < nn && w->noise_row[active] == j) { active++; }
        const int from = (active > 0) ? nn - active : nn + (int)w->start[j];
        const int count = nn + j - from;
        const pel_real *c = &w->W[j][from];
        pel_real *d = &w->weight[from];

        /* the diagonal is 1 but for terms of second order; a transformation of states may put anything there */
        const pel_real pivot = w->W[j][nn + j];
        const pel_real scale = (pivot != PEL_R(0.0)) ? PEL_R(1.0) / pivot : PEL_R(0.0);
        pel_real D = w->weight[nn + j] * pivot * pivot;
        for (int k = 0; k < count; k++) {
            const pel_real dc = d[k] * c[k];
            const pel_real next = D + dc * c[k];
            if (!(next > PEL_R(0.0))) { /* D = 0 and c = 0 */
                g[k] = PEL_R(0.0);
                continue;
            }
            g[k] = dc / next;
            d[k] *=
                D /
                next; /* exactly 1 where nothing happens: D times a reciprocal would be off by a digit, every time the same way */
            D = next;
        }
        if (!(D > PEL_R(0.0)) || !pel_isfiniter(D)) { return false; }
        ud->D[j] = D;

        pel_real *u = &ud->U[column(j)];
        for (int i = 0; i < j; i++) { u[i] = w->W[i][nn + j] * scale; }
        int i = 0;
        for (; i + 4 <= j; i += 4) { rotate_four(&w->W[i], from, c, g, count, &u[i]); }
        for (; i < j; i++) { u[i] = rotate_one(&w->W[i][from], c, g, count, u[i]); }
        const int first = (from > nn) ? from - nn : 0;
        for (i = first + 1; i < j; i++) {
            if (first < (int)w->start[i]) { w->start[i] = (uint8_t)first; }
        }
    }
    return true;
}

/* x = Phi x */
static void advance_mean(const pel_transition_t *t, pel_real x[])
{
    pel_real dx[PEL_MAX_STATES] = {PEL_R(0.0)};
    for (int k = 0; k < t->n_blocks; k++) {
        const pel_real *from = &x[t->block[k].col];
        pel_real *to = &dx[t->block[k].row];
        for (int i = 0; i < 3; i++) {
            to[i] += t->block[k].m[i][0] * from[0] + t->block[k].m[i][1] * from[1] + t->block[k].m[i][2] * from[2];
        }
    }
    for (int i = 0; i < t->n; i++) { x[i] += dx[i]; }
}

pel_status_t pel_ud_time_update(pel_ud_t *ud, const pel_transition_t *t)
{
    work_t w;
    const pel_status_t status = survey(ud, t, &w);
    if (status != PEL_OK) { return status; }
    advance_mean(t, ud->x);
    fill(ud, t, &w);
    for (int k = 0; k < t->n_blocks; k++) { add_block(ud, t->block[k].row, t->block[k].col, t->block[k].m, &w); }
    trailing_columns(ud, t, w.rows);
    return triangularise(ud, &w) ? PEL_OK : PEL_E_NOT_POSDEF;
}

void pel_ud_rank_one(pel_ud_t *ud, int k, pel_real c[], pel_real q)
{
    for (int j = k - 1; j >= 0 && q > PEL_R(0.0); j--) {
        if (c[j] == PEL_R(0.0)) { continue; }
        const pel_real D = ud->D[j] + q * c[j] * c[j];
        const pel_real gain = q * c[j] / D;
        pel_real *u = &ud->U[column(j)];
        for (int i = 0; i < j; i++) {
            c[i] -= c[j] * u[i];
            u[i] += gain * c[i];
        }
        q *= ud->D[j] / D;
        ud->D[j] = D;
    }
}

void pel_ud_add_noise(pel_ud_t *ud, int i, pel_real q)
{
    pel_real unit[PEL_MAX_STATES] = {PEL_R(0.0)};
    unit[i] = PEL_R(1.0);
    pel_ud_rank_one(ud, i + 1, unit, q);
}

pel_status_t pel_ud_decay(pel_ud_t *ud, const pel_real decay[], const pel_real q[])
{
    const int n = ud->n;
    for (int i = 0; i < n; i++) {
        if (!(decay[i] > PEL_R(-1.0)) || !(q[i] >= PEL_R(0.0))) { return PEL_E_RANGE; }
    }
    for (int j = 0; j < n; j++) {
        pel_real *u = &ud->U[column(j)];
        const pel_real dj = decay[j];
        for (int i = 0; i < j; i++) { u[i] += u[i] * ((decay[i] - dj) / (PEL_R(1.0) + dj)); }
        ud->D[j] += ud->D[j] * (dj * (PEL_R(2.0) + dj)); /* changes, not factors near one: they keep their digits */
        ud->x[j] += ud->x[j] * dj;
    }
    for (int k = 0; k < n; k++) {
        if (q[k] > PEL_R(0.0)) { pel_ud_add_noise(ud, k, q[k]); }
    }
    return PEL_OK;
}

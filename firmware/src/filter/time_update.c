/* time_update.c - P = Phi P Phi' + Q by weighted Gram-Schmidt (Thornton 1976; Bierman 1977, VI.4), knowing which blocks there are.
 *
 * W = [Phi U | I] has one column per state and one per driven state, weights [D | q]; its rows are made orthogonal from the
 * last to the first. Three structures save work: states after the last touched row keep their columns; noise columns
 * are filled only from the rows below, so the early rows meet few; a row starts at its first column that is not zero. */
#include "packed.h"
#include "pelorus/filter.h"
#include "pelorus/math.h"

/* Columns in groups of four: inner loops need no remainder, the pad columns hold zeros. */
#define STRIDE ((PEL_MAX_STATES + PEL_UD_MAX_NOISE + 3) / 4 * 4)

typedef struct {
    pel_real W[PEL_MAX_STATES][STRIDE];
    pel_real weight[STRIDE];
    uint8_t start[PEL_MAX_STATES];   /* first column of a row that may not be zero, a multiple of 4 */
    int rows;                        /* rows to be made orthogonal; states from here on are untouched */
    int noise_row[PEL_UD_MAX_NOISE]; /* driven states, descending: noise k is column n + k */
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
    return PEL_OK;
}

/* W = [U | I], rows 0..rows-1 */
static void fill(const pel_ud_t *ud, const pel_transition_t *t, work_t *w)
{
    const int n = ud->n;
    const int width = (n + w->n_noise + 3) / 4 * 4;
    for (int i = 0; i < w->rows; i++) {
        pel_real *row = w->W[i];
        for (int k = 0; k < i; k++) { row[k] = PEL_R(0.0); }
        row[i] = PEL_R(1.0);
        for (int k = n; k < width; k++) { row[k] = PEL_R(0.0); }
        w->start[i] = (uint8_t)(i & ~3);
    }
    for (int j = 1; j < n; j++) {
        const pel_real *u = &ud->U[column(j)];
        const int end = (j < w->rows) ? j : w->rows;
        for (int i = 0; i < end; i++) { w->W[i][j] = u[i]; }
    }
    for (int k = 0; k < n; k++) { w->weight[k] = ud->D[k]; }
    for (int k = n; k < width; k++) { w->weight[k] = PEL_R(0.0); }
    for (int k = 0; k < w->n_noise; k++) {
        w->W[w->noise_row[k]][n + k] = PEL_R(1.0);
        w->weight[n + k] = t->q[w->noise_row[k]];
    }
}

/* W rows row..row+2 += m (U rows col..col+2). The corner of U has ones on its diagonal and zeros below. */
static void add_block(const pel_ud_t *ud, int row, int col, const pel_real m[3][3], work_t *w)
{
    const pel_real *u = ud->U;
    const pel_real u01 = u[column(col + 1) + col];
    const pel_real u02 = u[column(col + 2) + col];
    const pel_real u12 = u[column(col + 2) + col + 1];
    pel_real *w0 = w->W[row];
    pel_real *w1 = w->W[row + 1];
    pel_real *w2 = w->W[row + 2];
    const pel_real m00 = m[0][0];
    const pel_real m01 = m[0][1];
    const pel_real m02 = m[0][2];
    const pel_real m10 = m[1][0];
    const pel_real m11 = m[1][1];
    const pel_real m12 = m[1][2];
    const pel_real m20 = m[2][0];
    const pel_real m21 = m[2][1];
    const pel_real m22 = m[2][2];

    w0[col] += m00;
    w1[col] += m10;
    w2[col] += m20;
    w0[col + 1] += m00 * u01 + m01;
    w1[col + 1] += m10 * u01 + m11;
    w2[col + 1] += m20 * u01 + m21;
    w0[col + 2] += m00 * u02 + m01 * u12 + m02;
    w1[col + 2] += m10 * u02 + m11 * u12 + m12;
    w2[col + 2] += m20 * u02 + m21 * u12 + m22;

    const pel_real *s = u + column(col + 2) + col; /* rows col.. of column j - 1; column j lies j - 1 further */
    for (int j = col + 3; j < ud->n; j++) {
        s += j - 1;
        w0[j] += m00 * s[0] + m01 * s[1] + m02 * s[2];
        w1[j] += m10 * s[0] + m11 * s[1] + m12 * s[2];
        w2[j] += m20 * s[0] + m21 * s[1] + m22 * s[2];
    }
    for (int i = row; i < row + 3; i++) {
        if ((col & ~3) < (int)w->start[i]) { w->start[i] = (uint8_t)(col & ~3); }
    }
}

static pel_real dot(const pel_real *a, const pel_real *b, int n4)
{
    pel_real s0 = PEL_R(0.0);
    pel_real s1 = PEL_R(0.0);
    pel_real s2 = PEL_R(0.0);
    pel_real s3 = PEL_R(0.0);
    for (int k = 0; k < n4; k += 4) {
        s0 += a[k] * b[k];
        s1 += a[k + 1] * b[k + 1];
        s2 += a[k + 2] * b[k + 2];
        s3 += a[k + 3] * b[k + 3];
    }
    return (s0 + s1) + (s2 + s3);
}

/* a -= c b */
static void subtract(pel_real *a, pel_real c, const pel_real *b, int n4)
{
    for (int k = 0; k < n4; k += 4) {
        a[k] -= c * b[k];
        a[k + 1] -= c * b[k + 1];
        a[k + 2] -= c * b[k + 2];
        a[k + 3] -= c * b[k + 3];
    }
}

/* Columns of the untouched states: those of Phi U itself; their rows are unit vectors that take the column out of W. */
static void trailing_columns(pel_ud_t *ud, const work_t *w)
{
    for (int j = w->rows; j < ud->n; j++) {
        pel_real *u = &ud->U[column(j)];
        for (int i = 0; i < w->rows; i++) { u[i] = w->W[i][j]; }
    }
}

/* Gram-Schmidt from the last row to the first. False if a D is not positive. */
static bool orthogonalise(pel_ud_t *ud, work_t *w)
{
    const int n = ud->n;
    int active = 0; /* noise columns filled so far */
    pel_real weighted[STRIDE];

    for (int j = w->rows - 1; j >= 0; j--) {
        if (active < w->n_noise && w->noise_row[active] == j) { active++; }
        const pel_real *wj = w->W[j];
        const int from = w->start[j];
        const int n4 = (n + active + 3) / 4 * 4 - from;
        for (int k = from; k < from + n4; k++) { weighted[k] = w->weight[k] * wj[k]; }
        const pel_real D = dot(&wj[from], &weighted[from], n4);
        if (!(D > PEL_R(0.0)) || !pel_isfiniter(D)) { return false; }
        ud->D[j] = D;
        const pel_real inv = PEL_R(1.0) / D;
        pel_real *u = &ud->U[column(j)];
        for (int i = 0; i < j; i++) {
            pel_real *wi = w->W[i];
            const pel_real c = dot(&wi[from], &weighted[from], n4) * inv;
            u[i] = c;
            subtract(&wi[from], c, &wj[from], n4);
            if (from < (int)w->start[i]) { w->start[i] = (uint8_t)from; }
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
    /* the trailing columns carry nothing into the other rows: their weight is spent */
    for (int k = w.rows; k < ud->n; k++) { w.weight[k] = PEL_R(0.0); }
    trailing_columns(ud, &w);
    return orthogonalise(ud, &w) ? PEL_OK : PEL_E_NOT_POSDEF;
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
        if (q[k] > PEL_R(0.0)) {
            pel_real unit[PEL_MAX_STATES] = {PEL_R(0.0)};
            unit[k] = PEL_R(1.0);
            pel_ud_rank_one(ud, k + 1, unit, q[k]);
        }
    }
    return PEL_OK;
}

/* band.c - the error band: one epoch's integers by enumeration of L1/L2 pairs (S5 sections 6 and 7).
 *
 * L1 - lambda1 N1 and L2 - lambda2 N2 measure the same range, so N1 = g N2 + (phi1 - g phi2) + u with a small u. Of all N1 that the code
 * allows, only a share of 2 hw / g has a partner N2 inside |u| < hw; three satellites' partners then predict all others. */
#include "pelorus/ambiguity.h"
#include "pelorus/math.h"

#define GATE_POSITION 30.0 /* squared sigmas of a triple's position from code and prior */
#define GATE_CYCLES   0.8  /* of a further satellite's nearest list entry from the triple's prediction */
#define CHI2_P        0.999
#define WINDOW_MAX    16000 /* integers of a window: 3 km */
#define NO_COST       1e300

double pel_band_half_width(double lambda1_m, double sd1_m, double sd2_m, double dmu, double iono_max_m)
{
    const double sd_u = pel_sqrt(sd1_m * sd1_m + sd2_m * sd2_m) / lambda1_m;
    return pel_max(pel_max(0.15, 4.0 * sd_u), 3.0 * sd_u + iono_max_m * dmu / lambda1_m);
}

bool pel_band_test(int64_t N1, int64_t N2, double phi1_cyc, double phi2_cyc, double g, double half_width, double *u)
{
    const double x = ((double)N1 - phi1_cyc) - g * ((double)N2 - phi2_cyc);
    if (u != NULL) { *u = x; }
    return half_width < 0.5 && pel_fabs(x) < half_width;
}

/* What the enumeration needs, for the m double differences that take part. Positions are relative to b0. */
typedef struct {
    const pel_band_input_t *in;
    int m;
    int dd[PEL_BAND_DD];     /* their places in the input */
    double A[3][3];          /* information of code and prior about the position */
    double b0[3];            /* their estimate */
    double code_sq;          /* and its misfit */
    double M_inverse[3][3];  /* covariance once the integers are known */
    double rho[PEL_BAND_DD]; /* G b0 */
    double sd[PEL_BAND_DD];  /* of rho */
    int triple[3];           /* places in dd[] */
    double T_inverse[3][3];  /* of the triple's rows of G */
} solver_t;

/* M += G' W G and c += G' W y, W = (I - 1 1' / (m + 1)) / (2 sd^2): the inverse of 2 sd^2 (I + 1 1'). Returns y' W y. */
static double accumulate(const solver_t *f, const double *y, double sd, double M[3][3], double c[3])
{
    double sum_g[3] = {0.0};
    double sum_y = 0.0;
    double yy = 0.0;
    const double w = 0.5 / (sd * sd);
    for (int i = 0; i < f->m; i++) {
        const double *g = f->in->G[f->dd[i]];
        sum_y += y[i];
        yy += y[i] * y[i];
        for (int k = 0; k < 3; k++) {
            sum_g[k] += g[k];
            c[k] += w * g[k] * y[i];
            for (int l = 0; M != NULL && l < 3; l++) { M[k][l] += w * g[k] * g[l]; }
        }
    }
    for (int k = 0; k < 3; k++) {
        c[k] -= w * sum_g[k] * sum_y / (f->m + 1);
        for (int l = 0; M != NULL && l < 3; l++) { M[k][l] -= w * sum_g[k] * sum_g[l] / (f->m + 1); }
    }
    return w * (yy - sum_y * sum_y / (f->m + 1));
}

/* Step 1 and 2: position from code and prior, adjusted ranges. */
static pel_status_t position(solver_t *f)
{
    const pel_band_input_t *in = f->in;
    double c[3] = {0.0};
    double Q[3][3];
    double y[PEL_BAND_DD];
    for (int k = 0; k < 3; k++) {
        for (int l = 0; l < 3; l++) { f->A[k][l] = 0.0; }
    }
    if (in->have_prior && pel_mat3_inverse(in->P_r, f->A) != PEL_OK) { return PEL_E_NOT_POSDEF; }
    for (int i = 0; i < f->m; i++) { y[i] = in->P_m[f->dd[i]]; }
    const double yy = accumulate(f, y, in->sd_code_m, f->A, c);
    if (pel_mat3_inverse(f->A, Q) != PEL_OK) { return PEL_E_GEOMETRY; }
    pel_mat3_vec(Q, c, f->b0);
    f->code_sq = pel_max(yy - pel_dot3(c, f->b0), 0.0);
    for (int i = 0; i < f->m; i++) {
        const double *g = in->G[f->dd[i]];
        double Qg[3];
        pel_mat3_vec(Q, g, Qg);
        f->rho[i] = pel_dot3(g, f->b0);
        f->sd[i] = pel_sqrt(pel_dot3(g, Qg));
        y[i] = 0.0;
    }
    double M[3][3];
    for (int k = 0; k < 3; k++) {
        for (int l = 0; l < 3; l++) { M[k][l] = f->A[k][l]; }
    }
    (void)accumulate(f, y, in->sd_phase_m, M, c);
    (void)accumulate(f, y, in->sd_phase_m, M, c); /* two carriers */
    return pel_mat3_inverse(M, f->M_inverse);
}

/* The N2 that goes with an N1, and whether the pair lies in the band. */
static bool partner(const pel_band_input_t *in, int dd, double N1, int32_t *N2)
{
    const double g = in->lambda2_m / in->lambda1_m;
    const double phi1 = in->L1_m[dd] / in->lambda1_m;
    const double phi2 = in->L2_m[dd] / in->lambda2_m;
    const double n2 = pel_round(phi2 + (N1 - phi1) / g);
    *N2 = (int32_t)n2;
    return pel_band_test((int64_t)N1, (int64_t)n2, phi1, phi2, g, in->half_width_cyc, NULL);
}

/* Step 3: all N1 inside the code's window that have a partner. */
static pel_status_t make_list(const solver_t *f, int i, pel_band_t *b)
{
    const pel_band_input_t *in = f->in;
    const double centre = (in->L1_m[f->dd[i]] - f->rho[i]) / in->lambda1_m;
    const double half = in->window * f->sd[i] / in->lambda1_m;
    const double low = -pel_floor(half - centre); /* ceil(centre - half) */
    const double high = pel_floor(centre + half);
    if (!(high - low < WINDOW_MAX && pel_fabs(low) < 2e9)) { return PEL_E_FULL; }
    b->list_n[i] = 0;
    b->origin[i] = (int32_t)low;
    const int count = (int)(high - low) + 1;
    if (count > b->n_window) { b->n_window = count; }
    for (int k = 0; k < count; k++) {
        int32_t N2;
        if (!partner(in, f->dd[i], low + k, &N2)) { continue; }
        if (b->list_n[i] >= PEL_BAND_LIST) { return PEL_E_FULL; }
        b->list[i][b->list_n[i]++] = (int16_t)k;
    }
    if (b->list_n[i] > b->n_list) { b->n_list = b->list_n[i]; }
    return PEL_OK;
}

/* Lists of all; one empty list may be left out, for the rest to be solved without it. */
static pel_status_t make_lists(solver_t *f, pel_band_t *b)
{
    for (int attempt = 0; attempt < 2; attempt++) {
        pel_status_t status = position(f);
        if (status != PEL_OK) { return status; }
        int empty = -1;
        int n_empty = 0;
        for (int i = 0; i < f->m; i++) {
            status = make_list(f, i, b);
            if (status != PEL_OK) { return status; }
            if (b->list_n[i] == 0) {
                empty = i;
                n_empty++;
            }
        }
        if (n_empty == 0) { return PEL_OK; }
        if (n_empty > 1 || attempt > 0 || f->m < 4) { return PEL_E_GEOMETRY; }
        b->dropped = f->dd[empty];
        f->m--;
        for (int i = empty; i < f->m; i++) { f->dd[i] = f->dd[i + 1]; }
    }
    return PEL_E_GEOMETRY;
}

/* Step 4, first half: the three double differences that fix a position best. */
static pel_status_t choose_triple(solver_t *f)
{
    double best = 0.0;
    for (int i = 0; i < f->m; i++) {
        for (int j = i + 1; j < f->m; j++) {
            double cross[3];
            pel_cross3(f->in->G[f->dd[i]], f->in->G[f->dd[j]], cross);
            for (int k = j + 1; k < f->m; k++) {
                const double det = pel_fabs(pel_dot3(cross, f->in->G[f->dd[k]]));
                if (det > best) {
                    best = det;
                    f->triple[0] = i;
                    f->triple[1] = j;
                    f->triple[2] = k;
                }
            }
        }
    }
    if (!(best > 0.0)) { return PEL_E_GEOMETRY; }
    double T[3][3];
    for (int r = 0; r < 3; r++) {
        for (int k = 0; k < 3; k++) { T[r][k] = f->in->G[f->dd[f->triple[r]]][k]; }
    }
    return pel_mat3_inverse(T, f->T_inverse);
}

/* Entry of an ascending list nearest to x (in units of the list's offsets); lists are never empty. */
static int nearest_entry(const int16_t *list, int n, double x)
{
    int low = 0;
    int high = n - 1;
    while (high - low > 1) {
        const int mid = (low + high) / 2;
        if ((double)list[mid] <= x) {
            low = mid;
        } else {
            high = mid;
        }
    }
    return (x - (double)list[low] <= (double)list[high] - x) ? low : high;
}

/* L1 range of place i with the k-th entry of its list, relative to b0's. */
static double range1(const solver_t *f, const pel_band_t *b, int i, int k)
{
    return f->in->L1_m[f->dd[i]] - f->in->lambda1_m * (double)(b->origin[i] + b->list[i][k]) - f->rho[i];
}

/* Complete a triple's position d (relative to b0) to entries of all lists; false if one is too far. */
static bool complete(const solver_t *f, const pel_band_t *b, const double d[3], int *entry)
{
    for (int i = 0; i < f->m; i++) {
        if (i == f->triple[0] || i == f->triple[1] || i == f->triple[2]) { continue; }
        const int dd = f->dd[i];
        const double n =
            (f->in->L1_m[dd] - f->rho[i] - pel_dot3(f->in->G[dd], d)) / f->in->lambda1_m - (double)b->origin[i];
        entry[i] = nearest_entry(b->list[i], b->list_n[i], n);
        if (pel_fabs(n - (double)b->list[i][entry[i]]) > GATE_CYCLES) { return false; }
    }
    return true;
}

/* Least-squares cost of all phases, code and prior with these integers. */
static double cost(const solver_t *f, const pel_band_t *b, const int *entry)
{
    double y1[PEL_BAND_DD];
    double y2[PEL_BAND_DD];
    double c[3] = {0.0};
    double x[3];
    for (int i = 0; i < f->m; i++) {
        int32_t N2;
        (void)partner(f->in, f->dd[i], (double)(b->origin[i] + b->list[i][entry[i]]), &N2);
        y1[i] = range1(f, b, i, entry[i]);
        y2[i] = f->in->L2_m[f->dd[i]] - f->in->lambda2_m * (double)N2 - f->rho[i];
    }
    double sq = f->code_sq;
    sq += accumulate(f, y1, f->in->sd_phase_m, NULL, c);
    sq += accumulate(f, y2, f->in->sd_phase_m, NULL, c);
    pel_mat3_vec(f->M_inverse, c, x);
    return sq - pel_dot3(c, x);
}

/* Keep the best two costs and the best vector. */
static void keep(const solver_t *f, pel_band_t *b, const int *entry)
{
    const double J = cost(f, b, entry);
    b->evaluations++;
    if (J >= b->J1) {
        b->J2 = pel_min(b->J2, J);
        return;
    }
    b->J2 = b->J1;
    b->J1 = J;
    for (int i = 0; i < f->m; i++) {
        b->N1[f->dd[i]] = b->origin[i] + b->list[i][entry[i]];
        (void)partner(f->in, f->dd[i], (double)b->N1[f->dd[i]], &b->N2[f->dd[i]]);
    }
}

/* Step 4, second half: all combinations of the triple. */
static pel_status_t enumerate(const solver_t *f, pel_band_t *b)
{
    const int *t = f->triple;
    int entry[PEL_BAND_DD];
    double y[3];
    for (entry[t[0]] = 0; entry[t[0]] < b->list_n[t[0]]; entry[t[0]]++) {
        y[0] = range1(f, b, t[0], entry[t[0]]);
        for (entry[t[1]] = 0; entry[t[1]] < b->list_n[t[1]]; entry[t[1]]++) {
            y[1] = range1(f, b, t[1], entry[t[1]]);
            for (entry[t[2]] = 0; entry[t[2]] < b->list_n[t[2]]; entry[t[2]]++) {
                double d[3];
                double Ad[3];
                if (b->triples >= f->in->max_triples) { return PEL_W_BUDGET; }
                b->triples++;
                y[2] = range1(f, b, t[2], entry[t[2]]);
                pel_mat3_vec(f->T_inverse, y, d);
                pel_mat3_vec(f->A, d, Ad);
                if (pel_dot3(d, Ad) <= GATE_POSITION && complete(f, b, d, entry)) { keep(f, b, entry); }
            }
        }
    }
    return PEL_OK;
}

static pel_status_t check(const pel_band_input_t *in)
{
    if (in->m < 3 || in->m > PEL_BAND_DD || in->max_triples < 1) { return PEL_E_RANGE; }
    if (!(in->sd_code_m > 0.0 && in->sd_phase_m > 0.0 && in->window > 0.0 && in->ratio_min >= 1.0)) {
        return PEL_E_RANGE;
    }
    if (!(in->lambda1_m > 0.05 && in->lambda2_m > in->lambda1_m && in->lambda2_m < 1e3)) { return PEL_E_RANGE; }
    if (!(in->half_width_cyc > 0.0 && in->half_width_cyc < 0.5)) { return PEL_E_RANGE; }
    for (int i = 0; i < in->m; i++) {
        const double extent = pel_fabs(in->L1_m[i]) + pel_fabs(in->L2_m[i]) + pel_fabs(in->P_m[i]);
        if (!(extent < 1e8) || !pel_isfinite(in->G[i][0] + in->G[i][1] + in->G[i][2])) { return PEL_E_RANGE; }
    }
    return PEL_OK;
}

pel_status_t pel_band_solve(const pel_band_input_t *in, pel_band_t *b)
{
    b->accepted = false;
    b->reason = PEL_INT_NOT_TRIED;
    b->dropped = -1;
    b->J1 = b->J2 = NO_COST;
    b->J_max = 0.0;
    b->dof = 0;
    b->n_window = b->n_list = b->triples = b->evaluations = 0;
    pel_status_t status = check(in);
    if (status != PEL_OK) { return status; }

    solver_t f = {.in = in, .m = in->m};
    for (int i = 0; i < in->m; i++) {
        f.dd[i] = i;
        b->N1[i] = b->N2[i] = 0;
    }
    status = make_lists(&f, b);
    if (status == PEL_OK) { status = choose_triple(&f); }
    if (status == PEL_OK) { status = enumerate(&f, b); }
    if (status == PEL_W_BUDGET) { b->reason = PEL_INT_BUDGET; }
    if (status != PEL_OK) { return status; }

    b->dof = in->have_prior ? 3 * f.m : 3 * f.m - 3;
    b->J_max = pel_chi2_threshold(b->dof, CHI2_P);
    b->reason = PEL_INT_OK;
    if (b->evaluations == 0 || !(b->J1 < b->J_max)) {
        b->reason = PEL_INT_CHI2;
    } else if (!(b->J2 > in->ratio_min * b->J1)) {
        b->reason = PEL_INT_RATIO;
    }
    b->accepted = b->reason == PEL_INT_OK;
    return PEL_OK;
}

/* subset.c - which of the integers asked for are solved for when all together are refused.
 *
 * A problem that does not fit has a satellite that is wrong (half cycle, multipath), and then the integers of all are wrong and no residual
 * points at it surely: each satellite is left out in turn, those that fit worst first. A problem that is too weak is cut down to parts that
 * the model expects to be strong, and at last to what its best two vectors have in common. */
#include "ambiguity_internal.h"

_Static_assert(PEL_MAX_AMB <= 64, "rows are remembered by the bits of a word");

#define ROW(i)     (UINT64_C(1) << (i))
#define AGREEMENTS 3 /* each within the one before */

static bool in_group(const pel_amb_problem_t *p, uint8_t group, uint8_t sat)
{
    if (p->group[group].sat == sat) { return true; }
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].group == group && p->row[i].sat == sat) { return true; }
    }
    return false;
}

static bool share_a_satellite(const pel_amb_problem_t *p, uint8_t a, uint8_t b)
{
    if (in_group(p, b, p->group[a].sat)) { return true; }
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].group == a && in_group(p, b, p->row[i].sat)) { return true; }
    }
    return false;
}

/* Number the systems: carriers of one system are groups that share satellites. */
static int number_systems(const pel_amb_problem_t *p, uint8_t system[PEL_AMB_GROUPS])
{
    int n = 0;
    for (int g = 0; g < p->n_groups; g++) {
        int first = 0;
        while (first < g && !share_a_satellite(p, (uint8_t)g, (uint8_t)first)) { first++; }
        system[g] = (first < g) ? system[first] : (uint8_t)n++;
    }
    return n;
}

void pel_subset_remember(pel_amb_resolver_t *r, const pel_amb_problem_t *p)
{
    uint8_t system[PEL_AMB_GROUPS];
    r->n_systems = (uint8_t)number_systems(p, system);
    r->asked_integer = 0;
    r->asked_code = 0;
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].integer) { r->asked_integer |= ROW(i); }
        if (p->row[i].code) { r->asked_code |= ROW(i); }
    }
}

void pel_subset_restore(const pel_amb_resolver_t *r, pel_amb_problem_t *p)
{
    for (int i = 0; i < p->n_rows; i++) {
        p->row[i].integer = (r->asked_integer & ROW(i)) != 0;
        p->row[i].code = (r->asked_code & ROW(i)) != 0;
    }
}

/* The row that fits worst of the satellites not yet suspected; its satellite's rows are taken off the list. -1: none left. */
static int next_suspect(const pel_amb_problem_t *p, float misfit[PEL_MAX_AMB])
{
    int worst = -1;
    for (int i = 0; i < p->n_rows; i++) {
        if (misfit[i] > 0.0f && (worst < 0 || misfit[i] > misfit[worst])) { worst = i; }
    }
    for (int i = 0; worst >= 0 && i < p->n_rows; i++) {
        if (p->row[i].sat == p->row[worst].sat) { misfit[i] = 0.0f; }
    }
    return worst;
}

void pel_subset_list_suspects(pel_amb_resolver_t *r, const pel_amb_problem_t *p, const pel_ils_t *s)
{
    float misfit[PEL_MAX_AMB];
    int64_t N[PEL_MAX_AMB];
    double b[3];
    double P[3][3];
    double sq;
    int dof;
    if (pel_ils_get(s, 0, N, NULL) != PEL_OK || pel_amb_fixed(p, N, b, P, &sq, &dof) != PEL_OK) { return; }
    pel_amb_misfits(p, N, b, misfit);
    for (int row = next_suspect(p, misfit); row >= 0; row = next_suspect(p, misfit)) {
        r->suspect[r->n_suspects++] = p->row[row].sat;
    }
}

void pel_subset_note_agreement(pel_amb_resolver_t *r, const pel_amb_problem_t *p, const pel_ils_t *s)
{
    int64_t best[PEL_MAX_AMB];
    int64_t second[PEL_MAX_AMB];
    if (pel_ils_get(s, 0, best, NULL) != PEL_OK || pel_ils_get(s, 1, second, NULL) != PEL_OK) { return; }
    for (int i = 0, k = 0; i < p->n_rows; i++) {
        if (!p->row[i].integer) { continue; }
        if (best[k] == second[k]) { r->agreed |= ROW(i); }
        k++;
    }
}

/* One satellite out: its phases, and its codes too if it is suspected rather than weak. */
static void drop(pel_amb_problem_t *p, uint8_t sat, bool suspected)
{
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].sat != sat) { continue; }
        p->row[i].integer = false;
        if (suspected) { p->row[i].code = false; }
    }
}

static bool drop_noisiest(pel_amb_problem_t *p)
{
    int worst = -1;
    for (int i = 0; i < p->n_rows; i++) {
        if (p->row[i].integer && (worst < 0 || p->row[i].var_phase > p->row[worst].var_phase)) { worst = i; }
    }
    if (worst < 0) { return false; }
    drop(p, p->row[worst].sat, false);
    return true;
}

/* False: no such system, or the only one. */
static bool drop_system(pel_amb_problem_t *p, uint8_t index)
{
    uint8_t system[PEL_AMB_GROUPS];
    const int n = number_systems(p, system);
    if (index >= n || n < 2) { return false; }
    for (int i = 0; i < p->n_rows; i++) {
        if (system[p->row[i].group] == index) { p->row[i].integer = false; }
    }
    return true;
}

static void keep_two_carriers(const pel_amb_resolver_t *r, pel_amb_problem_t *p)
{
    for (int i = 0; i < p->n_rows; i++) {
        int carriers = 0;
        for (int j = 0; j < p->n_rows; j++) {
            carriers += (r->asked_integer & ROW(j)) != 0 && p->row[j].sat == p->row[i].sat;
        }
        if (carriers < 2) { p->row[i].integer = false; }
    }
}

/* Uses the agreement up: the next one is that of the problem which this becomes. */
static void keep_agreed(pel_amb_resolver_t *r, pel_amb_problem_t *p)
{
    for (int i = 0; i < p->n_rows; i++) {
        if ((r->agreed & ROW(i)) == 0) { p->row[i].integer = false; }
    }
    r->agreed = 0;
}

/* The index-th subset of a kind, from all rows. False: there are no more of this kind. */
static bool select_rows(pel_amb_resolver_t *r, pel_amb_problem_t *p)
{
    switch ((pel_amb_subset_t)r->subset) {
    case PEL_AMB_ALL: return false;
    case PEL_AMB_WITHOUT_SUSPECT:
        if (r->index >= r->n_suspects) { return false; }
        drop(p, r->suspect[r->index], true);
        return true;
    case PEL_AMB_AGREED: keep_agreed(r, p); return r->index < AGREEMENTS;
    case PEL_AMB_TWO_CARRIERS: keep_two_carriers(r, p); return r->index == 0;
    case PEL_AMB_WITHOUT_NOISIEST:
        for (int i = 0; i <= r->index; i++) {
            if (!drop_noisiest(p)) { return false; }
        }
        return true;
    case PEL_AMB_WITHOUT_SYSTEM: return drop_system(p, r->index);
    }
    return false;
}

/* Has this kind had its turn? */
static bool is_over(const pel_amb_resolver_t *r, bool weak)
{
    const bool of_satellites = r->subset == PEL_AMB_WITHOUT_SUSPECT || r->subset == PEL_AMB_WITHOUT_NOISIEST;
    if (of_satellites && r->n_systems > 1 && r->tries <= r->n_systems) { return true; }
    return !weak && r->subset >= PEL_AMB_AGREED && r->subset <= PEL_AMB_WITHOUT_NOISIEST;
}

bool pel_subset_next(pel_amb_resolver_t *r, pel_amb_problem_t *p, bool weak)
{
    pel_subset_restore(r, p);
    const int all = pel_amb_count(p);
    while (r->subset <= PEL_AMB_WITHOUT_SYSTEM) {
        if (is_over(r, weak) || !select_rows(r, p)) {
            r->subset++;
            r->index = 0;
        } else {
            const int n = pel_amb_count(p);
            r->index++;
            if (n < all && n >= r->limits.n_min) { return true; }
        }
        pel_subset_restore(r, p);
    }
    return false;
}

/* pelorus-solve: problems as text, and the search on what they hold. */
#define _POSIX_C_SOURCE 200809L
#include "fuzz.h"
#include "pelorus/ambiguity.h"
#include "problem_text.h"

/* A short search: what it finds is in order and not above what it proves. */
static void solve(const problem_text_t *p)
{
    static pel_ils_t ils;
    if (p->n > PEL_MAX_AMB || pel_ils_init(&ils, p->n, p->a, p->Q, 2, 2000) != PEL_OK) { return; }
    const pel_status_t status = pel_ils_run(&ils, 2000);
    FUZZ_CHECK(status == PEL_OK || status == PEL_W_BUDGET || status == PEL_W_RUNNING);
    double last = 0.0;
    for (int k = 0; k < ils.n_found; k++) {
        int64_t N[PEL_MAX_AMB];
        double sq = -1.0;
        FUZZ_CHECK(pel_ils_get(&ils, k, N, &sq) == PEL_OK);
        FUZZ_CHECK(sq >= last);
        last = sq;
    }
    FUZZ_CHECK(pel_ils_success(&ils) >= 0.0 && pel_ils_success(&ils) <= 1.0);
    FUZZ_CHECK(pel_ils_ratio(&ils) >= 0.0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    problem_reader_t r;
    FILE *f = (n > 0) ? fmemopen((void *)(uintptr_t)data, n, "r") : NULL;
    if (f == NULL) { return 0; }
    problem_reader_open(&r, f);
    for (const problem_text_t *p = problem_reader_next(&r); p != NULL; p = problem_reader_next(&r)) {
        if (p->why[0] == '\0') { solve(p); }
    }
    problem_reader_close(&r);
    (void)fclose(f);
    return 0;
}

/* bench.h - the pieces of work that are counted. Used by the desktop driver and by the one on an emulated board. */
#ifndef BENCH_BENCH_H
#define BENCH_BENCH_H

typedef struct {
    const char *name;
    void (*prepare)(void);
    void (*body)(void);
    int per;             /* the count is divided by this: substeps into IMU steps */
    int budget;          /* instructions on a Cortex-M4F (ARCHITECTURE, budgets); 0: none; M7 for the strapdown step */
    const char *against; /* name of the dense twin in this table, or "" */
} bench_case_t;

extern const bench_case_t bench_cases[];
extern const int bench_n_cases;

#endif

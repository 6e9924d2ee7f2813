/* prove.h - what the proofs share. A proof is one function below a comment that prove.py reads:
 *
 *   / * PROVE name: what is claimed
 *    * sources base/bits.c ...            of firmware/src; a function of no source given returns any value
 *    * flags --unwind 13 ...              more for ESBMC (bounds of loops, smaller sizes with -D)
 *                                       --any-floats: floats may become infinite, which ESBMC takes as overflow; that of
 *                                       integers is then left to the sanitizers of the fuzz targets
 *    * plant base/bits.c: old => new * /  the twin: with this change of the source the proof must fail
 *
 * Every value that is not assumed to be something is any value. Proved beside the assertions: every access lies in its
 * object, no signed arithmetic overflows, no shift is too wide, no division by zero, no loop runs longer than its bound. */
#ifndef PROVE_H
#define PROVE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

void __ESBMC_assume(_Bool);
void __ESBMC_assert(_Bool, const char *);

#define assume(condition) __ESBMC_assume(condition)
#define claim(condition)  __ESBMC_assert(condition, #condition)

_Bool any_bool(void);
uint8_t any_u8(void);
uint16_t any_u16(void);
uint32_t any_u32(void);
uint64_t any_u64(void);
int any_int(void);
int32_t any_i32(void);
int64_t any_i64(void);
size_t any_size(void);
float any_float(void);
double any_double(void);

/* Fills an object with any bytes. */
static inline void any_bytes(uint8_t *p, size_t n)
{
    for (size_t i = 0; i < n; i++) { p[i] = any_u8(); }
}

/* An index or length up to most. */
static inline size_t any_upto(size_t most)
{
    const size_t n = any_size();
    assume(n <= most);
    return n;
}

#endif

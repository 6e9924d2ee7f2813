/* support_sfrbx.h - a receiver stream and a frame of RXM-SFRBX to change and to push into it. */
#ifndef SUPPORT_SFRBX_H
#define SUPPORT_SFRBX_H

#include "support_wire.h"

typedef struct {
    pel_receiver_t rx;
    uint8_t frame[256];
    uint8_t *payload;
} sfrbx_bench_t;

void sfrbx_begin(sfrbx_bench_t *b); /* time known, nothing received */

pel_ephemeris_t sfrbx_ephemeris(pel_sys_t sys, int prn);
/* Puts part of that ephemeris into the frame; its length. */
size_t sfrbx_part(sfrbx_bench_t *b, pel_sys_t sys, int prn, int part);
/* n bits of word i (from 0) whose lowest is `shift` above the word's lowest. */
void sfrbx_put(sfrbx_bench_t *b, int i, unsigned shift, unsigned n, uint32_t value);
/* Seals the frame and pushes it; how many ephemerides came. */
int sfrbx_push(sfrbx_bench_t *b, size_t n);
int sfrbx_push_all_but(sfrbx_bench_t *b, pel_sys_t sys, int prn, int except);

void sfrbx_expect(const sfrbx_bench_t *b, uint32_t unknown, uint32_t bad_length, uint32_t bad_value, uint32_t overflow);

#endif

/* fuzz.h - what the fuzz targets share. A target is one fuzz_*.c with one LLVMFuzzerTestOneInput(): bytes in, no crash, no
 * sanitizer report, and every FUZZ_CHECK() holds. */
#ifndef FUZZ_H
#define FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include "pelorus/base.h"
#include "pelorus/solution.h"
#include "pelorus/wire.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t n, size_t max, unsigned seed);
size_t LLVMFuzzerMutate(uint8_t *data, size_t n, size_t max); /* libFuzzer's own */

#define FUZZ_CHECK(condition)                                                                                          \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            (void)fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition);                       \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

/* The bytes of an input, taken from its front; zeros behind its end. */
typedef struct {
    const uint8_t *at;
    size_t left;
} fuzz_input_t;

uint8_t fuzz_u8(fuzz_input_t *in);
uint32_t fuzz_u32(fuzz_input_t *in);
/* A number of any size: its bits as they come, or one of those that break code (NaN, infinities, zeros, denormal, huge). */
double fuzz_double(fuzz_input_t *in);

/* Writes good checksums into every whole UBX, RTCM 3, Pelorus and NovAtel frame of a stream, so that what is behind the
 * checksum is reached. */
void fuzz_repair_frames(uint8_t *data, size_t n);
/* LLVMFuzzerCustomMutator() of targets that read streams: libFuzzer's mutations, most of the time with checksums repaired. */
size_t fuzz_mutate_frames(uint8_t *data, size_t n, size_t max, unsigned seed);

/* One message a record of the input (length u8, payload), framed with good checksums and pushed: UBX of one class and id, or
 * RTCM 3 whose number becomes one of numbers[]. Everything the decoder then says is checked. */
void fuzz_ubx_payloads(fuzz_input_t in, uint8_t cls, uint8_t id);
void fuzz_rtcm3_payloads(fuzz_input_t in, const uint16_t *numbers, unsigned n_numbers);

/* Pushes bytes and checks what comes out; flush: the input ends. */
void fuzz_receiver_bytes(pel_receiver_t *rx, const uint8_t *p, size_t n, bool flush);

/* No counter has gone down. Both are structs of uint32_t. */
bool fuzz_counters_grew(const void *before, const void *after, size_t bytes);

bool fuzz_finite(double x);

#endif

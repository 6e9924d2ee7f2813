/* support_wire.h - what the tests of wire/ feed and compare. */
#ifndef SUPPORT_WIRE_H
#define SUPPORT_WIRE_H

#include "pelorus/wire.h"

#define T0 (INT64_C(2300) * PEL_NS_PER_WEEK + 345600 * PEL_NS_PER_S)

/* Two carriers of n satellites of a system, plausible and all different; phases near their codes. */
void support_epoch(pel_epoch_t *e, pel_time_t t, pel_sys_t sys, int n);
void support_append(pel_epoch_t *e, pel_sys_t sys, int n);
void support_ephemeris(pel_ephemeris_t *e, pel_sys_t sys, int prn);

/* Pushes bytes; returns how many events of this kind came, and leaves the last in *rx. */
int support_push(pel_receiver_t *rx, const uint8_t *p, size_t n, pel_rx_event_t kind);
/* The same and then the end of input. */
int support_push_all(pel_receiver_t *rx, const uint8_t *p, size_t n, pel_rx_event_t kind);

/* Seals a message of n_bits that begins at frame + 3, and pushes it; frame has PEL_MAX_FRAME_BYTES. */
int support_push_rtcm3(pel_receiver_t *rx, uint8_t *frame, size_t n_bits, pel_rx_event_t kind);
/* Two satellites of a system in one MSM7, the last of its epoch or not. */
void support_push_msm7(pel_receiver_t *rx, pel_time_t t, pel_sys_t sys, bool more);

uint32_t support_random(void);

#endif

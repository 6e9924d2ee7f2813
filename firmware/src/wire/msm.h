/* msm.h - what decoder and encoder of Multiple Signal Messages share. Private to wire/. */
#ifndef PELORUS_WIRE_MSM_H
#define PELORUS_WIRE_MSM_H

#include "framing.h"

/* Widths and resolutions of MSM 4..7 (RTCM 10403, tables 3.5-80 to 3.5-83). */
typedef struct {
    uint8_t code_bits;
    int8_t code_pow2; /* ms */
    uint8_t phase_bits;
    int8_t phase_pow2; /* ms */
    uint8_t lock_bits, cn0_bits;
    int8_t cn0_pow2; /* dB-Hz */
    bool has_rate;
} pel_msm_kind_t;

const pel_msm_kind_t *pel_msm_kind(int msm); /* 4..7 */

/* Signal number of the mask (2..32) <-> carrier and RINEX letter. False: not used here. */
bool pel_msm_signal(pel_sys_t sys, int id, uint8_t *carrier, char *code);
int pel_msm_id(pel_sys_t sys, uint8_t carrier, char code); /* the exact code, else another of that carrier; 0 none */

/* Lock time indicator <-> the least time it stands for. DF402 (4 bits), DF407 (10 bits). */
uint32_t pel_msm_lock_ms(unsigned bits, uint32_t indicator);
uint32_t pel_msm_lock_indicator(unsigned bits, uint32_t lock_ms);

#define PEL_RANGE_MS_M      (PEL_SPEED_OF_LIGHT * 1e-3) /* one light millisecond */
#define PEL_MSM_HEADER_BITS (12 + 12 + 30 + 1 + 3 + 7 + 2 + 2 + 1 + 3)

#endif

/* navmsg.h - broadcast navigation messages: their fields, and what becomes of them. Private to wire/. */
#ifndef PELORUS_WIRE_NAVMSG_H
#define PELORUS_WIRE_NAVMSG_H

#include "framing.h"

/* Fields of a message that are not yet (or no longer) in the units of pel_ephemeris_t. */
typedef struct {
    uint32_t week;     /* as sent: modulo 1024 GPS, 4096 Galileo, 8192 BeiDou */
    uint32_t tow_s;    /* second of week of the message, where it has one */
    uint32_t toe, toc; /* in units of 16 s (GPS), 60 s (Galileo), 8 s (BeiDou) */
    uint32_t ura;      /* index of URA or SISA */
    uint32_t health;   /* as sent */
    uint32_t iode, iodc;
    uint32_t fit; /* GPS fit interval flag */
    uint32_t prn;
    uint32_t part; /* subframe, word or page number found in the message */
} pel_nav_raw_t;

/* raw -> the rest of eph, with weeks resolved near t_ref; tow_known: raw->tow_s is the time of transmission.
 * False: a value is out of range, or the time of ephemeris does not fit its own week. */
bool pel_eph_from_raw(pel_ephemeris_t *eph, const pel_nav_raw_t *raw, bool tow_known, pel_time_t t_ref);
/* eph -> raw, as sent at t. False: a time or index has no representation. */
bool pel_eph_to_raw(const pel_ephemeris_t *eph, pel_time_t t, pel_nav_raw_t *raw);

/* Layouts, one function a part, for reading and writing. GPS: words 2..10 of subframe 1..3, 24 bits each, 27 bytes. */
#define PEL_LNAV_BYTES 27
void pel_lnav_fields(pel_bitio_t *io, int subframe, pel_ephemeris_t *eph, pel_nav_raw_t *raw);
void pel_lnav_klobuchar_fields(pel_bitio_t *io, pel_klobuchar_t *k, pel_nav_raw_t *raw); /* subframe 4 page 18 */
/* Galileo I/NAV word 1..5, 16 bytes. */
#define PEL_INAV_BYTES 16
void pel_inav_fields(pel_bitio_t *io, int word, pel_ephemeris_t *eph, pel_nav_raw_t *raw);
/* BeiDou D1 subframe 1..3: 26 + 9 * 22 data bits, 28 bytes. */
#define PEL_D1_BYTES 28
void pel_bds_d1_fields(pel_bitio_t *io, int subframe, pel_ephemeris_t *eph, pel_nav_raw_t *raw);
/* BeiDou D2 subframe 1: the pieces of its ten pages, joined; 493 bits. Page 2 holds no orbit. */
#define PEL_D2_BYTES 62
typedef struct {
    uint16_t from;  /* first data bit in the page (parity taken out) */
    uint16_t count; /* bits */
    uint16_t to;    /* where they go */
} pel_d2_cut_t;
extern const pel_d2_cut_t PEL_D2_CUT[10];
void pel_bds_d2_fields(pel_bitio_t *io, pel_ephemeris_t *eph, pel_nav_raw_t *raw);
/* What begins every BeiDou subframe: preamble, number, second of week; 38 bits. */
void pel_bds_head_fields(pel_bitio_t *io, pel_nav_raw_t *raw);

/* Moves n_bits between unaligned places. */
void pel_bits_copy(uint8_t *to, size_t to_pos, const uint8_t *from, size_t from_pos, size_t n_bits);

#endif

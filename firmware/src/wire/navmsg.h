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
    uint32_t part;     /* subframe, word or page number found in the message */
    uint32_t piece[4]; /* of a field that is sent in pieces */
} pel_nav_raw_t;

/* A part of a message is a table of its fields in order. */
typedef enum {
    PEL_FIELD_RAW,      /* unsigned, into pel_nav_raw_t */
    PEL_FIELD_FILL,     /* written as `at`, skipped when read */
    PEL_FIELD_UNSIGNED, /* into pel_ephemeris_t, unit 2^pow2 */
    PEL_FIELD_SIGNED,   /* two's complement */
    PEL_FIELD_SEMI,     /* semicircles on the wire, rad here; 32 bits wrap */
    PEL_FIELD_TGD       /* two's complement, unit 0.1 ns */
} pel_field_kind_t;

typedef struct {
    uint8_t kind, bits;
    int8_t pow2;
    uint8_t at; /* offset of the member */
} pel_field_t;

#define PEL_RAW(bits, member)                                                                                          \
    {                                                                                                                  \
        PEL_FIELD_RAW, bits, 0, offsetof(pel_nav_raw_t, member)                                                        \
    }
#define PEL_FILL(bits, value)                                                                                          \
    {                                                                                                                  \
        PEL_FIELD_FILL, bits, 0, value                                                                                 \
    }
#define PEL_UF(bits, pow2, member)                                                                                     \
    {                                                                                                                  \
        PEL_FIELD_UNSIGNED, bits, pow2, offsetof(pel_ephemeris_t, member)                                              \
    }
#define PEL_SF(bits, pow2, member)                                                                                     \
    {                                                                                                                  \
        PEL_FIELD_SIGNED, bits, pow2, offsetof(pel_ephemeris_t, member)                                                \
    }
#define PEL_SEMI(bits, pow2, member)                                                                                   \
    {                                                                                                                  \
        PEL_FIELD_SEMI, bits, pow2, offsetof(pel_ephemeris_t, member)                                                  \
    }
#define PEL_TGD(member)                                                                                                \
    {                                                                                                                  \
        PEL_FIELD_TGD, 10, 0, offsetof(pel_ephemeris_t, member)                                                        \
    }

void pel_io_fields(pel_bitio_t *io, const pel_field_t field[], size_t n, pel_ephemeris_t *eph, pel_nav_raw_t *raw);
#define PEL_IO_FIELDS(io, table, eph, raw) pel_io_fields(io, table, sizeof(table) / sizeof((table)[0]), eph, raw)

/* The elements that GPS, QZSS and Galileo send in the same order and units wherever they send them: crs to sqrt(a), cic to Omega dot. */
void pel_io_orbit_to_sqrt_a(pel_bitio_t *io, pel_ephemeris_t *eph);
void pel_io_orbit_from_cic(pel_bitio_t *io, pel_ephemeris_t *eph);

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
/* Galileo's health here: E1-B (F/NAV: E5a) data validity, its status (2 bits), E5b data validity, its status (2), from the lowest bit; these
 * are pieces 0 to 3 on the wire. */
void pel_gal_health_to_pieces(pel_nav_raw_t *raw);
void pel_gal_health_from_pieces(pel_nav_raw_t *raw);
/* Geostationary satellites send D2, the others D1. */
bool pel_bds_is_geo(int prn);
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

/* GLONASS. Its time is that of Moscow: int64 ns of UTC(SU) + 3 h, counted from 1980-01-06 like GPS time. */
typedef struct {
    uint32_t part; /* string number found in the message */
    uint32_t t_k;  /* when the frame began, s of the day, multiple of 30 */
    uint32_t t_b;  /* of the ephemeris, quarters of an hour of the day */
    uint32_t n_t;  /* day in its four years, 1..1461; 0 not told */
    uint32_t slot, unhealthy, l_n, f_t, m;
} pel_glo_raw_t;

pel_time_t pel_moscow_from_gps(pel_time_t t);
pel_time_t pel_gps_from_moscow(pel_time_t moscow);
/* GPS time of day of week 0..6 (7 unknown) and ms of the day (of Moscow), nearest to t_ref. */
pel_time_t pel_glo_epoch_near(unsigned day_of_week, uint32_t ms_of_day, pel_time_t t_ref);
/* As pel_eph_from_raw() and pel_eph_to_raw(); t_ref within 4 days; within half a day where n_t is not told, or
 * is further away than that. */
bool pel_glo_from_raw(pel_ephemeris_t *eph, const pel_glo_raw_t *raw, pel_time_t t_ref);
bool pel_glo_to_raw(const pel_ephemeris_t *eph, pel_time_t t, pel_glo_raw_t *raw);
/* String 1..4 from its idle bit on, 85 bits with the eight of its parity (not visited). */
#define PEL_GLO_BYTES 11
void pel_glo_string_fields(pel_bitio_t *io, int string, pel_ephemeris_t *eph, pel_glo_raw_t *raw);
bool pel_glo_string_good(const uint8_t *string);
void pel_glo_string_seal(uint8_t *string);
/* RTCM 1020 behind its number; channels that do not exist give k = 127. */
void pel_glo_1020_fields(pel_bitio_t *io, pel_ephemeris_t *e, pel_glo_raw_t *raw);

/* Moves n_bits between unaligned places. */
void pel_bits_copy(uint8_t *to, size_t to_pos, const uint8_t *from, size_t from_pos, size_t n_bits);

#endif

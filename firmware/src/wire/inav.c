#include "navmsg.h"

/* Galileo OS SIS ICD 4.3.5, word types 1 to 5. */

static const pel_field_t WORD_1[] = {
    PEL_RAW(10, iode),  PEL_RAW(14, toe),        PEL_SEMI(32, -31, M0),
    PEL_UF(32, -33, e), PEL_UF(32, -19, sqrt_a), PEL_FILL(2, 0),
};
static const pel_field_t WORD_2[] = {
    PEL_RAW(10, iode),        PEL_SEMI(32, -31, Omega0), PEL_SEMI(32, -31, i0),
    PEL_SEMI(32, -31, omega), PEL_SEMI(14, -43, idot),   PEL_FILL(2, 0),
};
static const pel_field_t WORD_3[] = {
    PEL_RAW(10, iode),    PEL_SEMI(24, -43, Omega_dot), PEL_SEMI(16, -43, dn), PEL_SF(16, -29, cuc),
    PEL_SF(16, -29, cus), PEL_SF(16, -5, crc),          PEL_SF(16, -5, crs),   PEL_RAW(8, ura),
};
static const pel_field_t WORD_4[] = {
    PEL_RAW(10, iode),    PEL_RAW(6, prn),      PEL_SF(16, -29, cic), PEL_SF(16, -29, cis), PEL_RAW(14, toc),
    PEL_SF(31, -34, af0), PEL_SF(21, -46, af1), PEL_SF(6, -59, af2),  PEL_FILL(2, 0),
};
static const pel_field_t WORD_5[] = {
    PEL_FILL(11 + 11 + 14 + 5, 0), /* ionosphere of NeQuick */
    PEL_SF(10, -32, tgd_s[0]),
    PEL_SF(10, -32, tgd_s[1]),
    PEL_RAW(2, piece[3]),
    PEL_RAW(2, piece[1]),
    PEL_RAW(1, piece[2]),
    PEL_RAW(1, piece[0]),
    PEL_RAW(12, week),
    PEL_RAW(20, tow_s),
    PEL_FILL(23, 0),
};

static const struct {
    const pel_field_t *field;
    size_t n;
} WORDS[5] = {
    {WORD_1, sizeof WORD_1 / sizeof WORD_1[0]}, {WORD_2, sizeof WORD_2 / sizeof WORD_2[0]},
    {WORD_3, sizeof WORD_3 / sizeof WORD_3[0]}, {WORD_4, sizeof WORD_4 / sizeof WORD_4[0]},
    {WORD_5, sizeof WORD_5 / sizeof WORD_5[0]},
};

void pel_gal_health_to_pieces(pel_nav_raw_t *raw)
{
    raw->piece[0] = raw->health & 1u;
    raw->piece[1] = (raw->health >> 1) & 3u;
    raw->piece[2] = (raw->health >> 3) & 1u;
    raw->piece[3] = (raw->health >> 4) & 3u;
}

void pel_gal_health_from_pieces(pel_nav_raw_t *raw)
{
    raw->health = raw->piece[0] | (raw->piece[1] << 1) | (raw->piece[2] << 3) | (raw->piece[3] << 4);
}

void pel_inav_fields(pel_bitio_t *io, int word, pel_ephemeris_t *eph, pel_nav_raw_t *raw)
{
    raw->part = (uint32_t)word;
    pel_io_u(io, 6, &raw->part);
    pel_gal_health_to_pieces(raw);
    pel_io_fields(io, WORDS[word - 1].field, WORDS[word - 1].n, eph, raw);
    pel_gal_health_from_pieces(raw);
}

#include "navmsg.h"

/* IS-GPS-200 figure 20-1 and table 20-III; QZSS LNAV has the same fields (IS-QZSS-PNT). */

/* Hand-over word: time of week of the next subframe in units of 6 s. */
static void how_fields(pel_bitio_t *io, pel_nav_raw_t *raw)
{
    uint32_t count = (raw->tow_s / 6u + 1u) % 100800u;
    pel_io_u(io, 17, &count);
    if (!io->writing) { raw->tow_s = (count + 100799u) % 100800u * 6u; }
    pel_io_fill(io, 2, 0); /* alert, anti-spoof */
    pel_io_u(io, 3, &raw->part);
    pel_io_fill(io, 2, 0);
}

static const pel_field_t SUBFRAME_1[] = {
    PEL_RAW(10, week),   PEL_FILL(2, 1), /* P code on L2 */
    PEL_RAW(4, ura),     PEL_RAW(6, health),   PEL_RAW(2, piece[0]),     PEL_FILL(1 + 23, 0),  PEL_FILL(24, 0),
    PEL_FILL(24, 0),     PEL_FILL(16, 0),      PEL_SF(8, -31, tgd_s[0]), PEL_RAW(8, piece[1]), PEL_RAW(16, toc),
    PEL_SF(8, -55, af2), PEL_SF(16, -43, af1), PEL_SF(22, -31, af0),     PEL_FILL(2, 0),
};
static const pel_field_t SUBFRAME_2_END[] = {PEL_RAW(16, toe), PEL_RAW(1, fit), PEL_FILL(5 + 2, 0)};
static const pel_field_t SUBFRAME_3_END[] = {PEL_RAW(8, iode), PEL_SEMI(14, -43, idot), PEL_FILL(2, 0)};

static void subframe_1(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    raw->piece[0] = raw->iodc >> 8;
    raw->piece[1] = raw->iodc & 0xFFu;
    PEL_IO_FIELDS(io, SUBFRAME_1, e, raw);
    raw->iodc = (raw->piece[0] << 8) | raw->piece[1];
}

void pel_lnav_fields(pel_bitio_t *io, int subframe, pel_ephemeris_t *eph, pel_nav_raw_t *raw)
{
    raw->part = (uint32_t)subframe;
    how_fields(io, raw);
    if (subframe == 1) {
        subframe_1(io, eph, raw);
    } else if (subframe == 2) {
        pel_io_u(io, 8, &raw->iode);
        pel_io_orbit_to_sqrt_a(io, eph);
        PEL_IO_FIELDS(io, SUBFRAME_2_END, eph, raw);
    } else {
        pel_io_orbit_from_cic(io, eph);
        PEL_IO_FIELDS(io, SUBFRAME_3_END, eph, raw);
    }
}

void pel_lnav_klobuchar_fields(pel_bitio_t *io, pel_klobuchar_t *k, pel_nav_raw_t *raw)
{
    static const int8_t ALPHA_POW2[4] = {-30, -27, -24, -24};
    static const int8_t BETA_POW2[4] = {11, 14, 16, 16};
    uint32_t page = 0x40u | 56u; /* data identification 1, page 18 */

    raw->part = 4;
    how_fields(io, raw);
    pel_io_u(io, 8, &page);
    for (int i = 0; i < 8; i++) {
        float *const f = (i < 4) ? &k->alpha[i] : &k->beta[i - 4];
        double v = (double)*f;
        pel_io_signed(io, 8, pel_pow2((i < 4) ? ALPHA_POW2[i] : BETA_POW2[i - 4]), &v);
        *f = (float)v;
    }
    pel_io_fill(io, 24 + 32, 0); /* UTC polynomial and its times, not used here */
    pel_io_fill(io, 6 * 8 + 14 + 2, 0);
    if (!io->writing) { raw->iode = page; /* the caller tells page 18 by it */ }
}

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

static void subframe_1(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    uint32_t iodc_msb = raw->iodc >> 8;
    uint32_t iodc_lsb = raw->iodc & 0xFFu;
    pel_io_u(io, 10, &raw->week);
    pel_io_fill(io, 2, 1); /* P code on L2 */
    pel_io_u(io, 4, &raw->ura);
    pel_io_u(io, 6, &raw->health);
    pel_io_u(io, 2, &iodc_msb);
    pel_io_fill(io, 1 + 23, 0);
    pel_io_fill(io, 24, 0);
    pel_io_fill(io, 24, 0);
    pel_io_fill(io, 16, 0);
    pel_io_sf(io, 8, -31, &e->tgd_s[0]);
    pel_io_u(io, 8, &iodc_lsb);
    pel_io_u(io, 16, &raw->toc);
    pel_io_sf(io, 8, -55, &e->af2);
    pel_io_sf(io, 16, -43, &e->af1);
    pel_io_sf(io, 22, -31, &e->af0);
    pel_io_fill(io, 2, 0);
    raw->iodc = (iodc_msb << 8) | iodc_lsb;
}

static void subframe_2(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_io_u(io, 8, &raw->iode);
    pel_io_sf(io, 16, -5, &e->crs);
    pel_io_semi(io, 16, -43, &e->dn);
    pel_io_semi(io, 32, -31, &e->M0);
    pel_io_sf(io, 16, -29, &e->cuc);
    pel_io_uf(io, 32, -33, &e->e);
    pel_io_sf(io, 16, -29, &e->cus);
    pel_io_uf(io, 32, -19, &e->sqrt_a);
    pel_io_u(io, 16, &raw->toe);
    pel_io_u(io, 1, &raw->fit);
    pel_io_fill(io, 5 + 2, 0);
}

static void subframe_3(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_io_sf(io, 16, -29, &e->cic);
    pel_io_semi(io, 32, -31, &e->Omega0);
    pel_io_sf(io, 16, -29, &e->cis);
    pel_io_semi(io, 32, -31, &e->i0);
    pel_io_sf(io, 16, -5, &e->crc);
    pel_io_semi(io, 32, -31, &e->omega);
    pel_io_semi(io, 24, -43, &e->Omega_dot);
    pel_io_u(io, 8, &raw->iode);
    pel_io_semi(io, 14, -43, &e->idot);
    pel_io_fill(io, 2, 0);
}

void pel_lnav_fields(pel_bitio_t *io, int subframe, pel_ephemeris_t *eph, pel_nav_raw_t *raw)
{
    raw->part = (uint32_t)subframe;
    how_fields(io, raw);
    if (subframe == 1) {
        subframe_1(io, eph, raw);
    } else if (subframe == 2) {
        subframe_2(io, eph, raw);
    } else {
        subframe_3(io, eph, raw);
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
        pel_io_sf(io, 8, (i < 4) ? ALPHA_POW2[i] : BETA_POW2[i - 4], &v);
        *f = (float)v;
    }
    pel_io_fill(io, 24 + 32, 0); /* UTC polynomial and its times, not used here */
    pel_io_fill(io, 6 * 8 + 14 + 2, 0);
    if (!io->writing) { raw->iode = page; /* the caller tells page 18 by it */ }
}

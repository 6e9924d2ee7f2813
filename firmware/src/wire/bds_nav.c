#include "navmsg.h"

/* BeiDou SIS ICD B1I v3.0, 5.2 (D1) and 5.3 (D2), parity taken out. */

#define PREAMBLE   0x712u
#define TGD_UNIT_S 1e-10

bool pel_bds_is_geo(int prn)
{
    return prn <= 5 || prn >= 59;
}

void pel_bds_head_fields(pel_bitio_t *io, pel_nav_raw_t *raw)
{
    pel_io_fill(io, 11, PREAMBLE);
    pel_io_fill(io, 4, 0);
    pel_io_u(io, 3, &raw->part);
    pel_io_u(io, 20, &raw->tow_s);
}

static void clock_head(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_io_u(io, 1, &raw->health);
    pel_io_u(io, 5, &raw->iodc);
    pel_io_u(io, 4, &raw->ura);
    pel_io_u(io, 13, &raw->week);
    pel_io_u(io, 17, &raw->toc);
    pel_io_unit(io, 10, TGD_UNIT_S, &e->tgd_s[0]);
    pel_io_unit(io, 10, TGD_UNIT_S, &e->tgd_s[1]);
}

static void d1_subframe_1(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    clock_head(io, e, raw);
    pel_io_fill(io, 64, 0); /* ionosphere of BeiDou's own model */
    pel_io_sf(io, 11, -66, &e->af2);
    pel_io_sf(io, 24, -33, &e->af0);
    pel_io_sf(io, 22, -50, &e->af1);
    pel_io_u(io, 5, &raw->iode);
}

/* toe lies across subframes 2 and 3: 2 and 15 bits. */
static void d1_subframe_2(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    uint32_t toe_msb = raw->toe >> 15;
    pel_io_semi(io, 16, -43, &e->dn);
    pel_io_sf(io, 18, -31, &e->cuc);
    pel_io_semi(io, 32, -31, &e->M0);
    pel_io_uf(io, 32, -33, &e->e);
    pel_io_sf(io, 18, -31, &e->cus);
    pel_io_sf(io, 18, -6, &e->crc);
    pel_io_sf(io, 18, -6, &e->crs);
    pel_io_uf(io, 32, -19, &e->sqrt_a);
    pel_io_u(io, 2, &toe_msb);
    raw->toe = (raw->toe & 0x7FFFu) | (toe_msb << 15);
}

static void d1_subframe_3(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    uint32_t toe_lsb = raw->toe & 0x7FFFu;
    pel_io_u(io, 15, &toe_lsb);
    pel_io_semi(io, 32, -31, &e->i0);
    pel_io_sf(io, 18, -31, &e->cic);
    pel_io_semi(io, 24, -43, &e->Omega_dot);
    pel_io_sf(io, 18, -31, &e->cis);
    pel_io_semi(io, 14, -43, &e->idot);
    pel_io_semi(io, 32, -31, &e->Omega0);
    pel_io_semi(io, 32, -31, &e->omega);
    pel_io_fill(io, 1, 0);
    raw->toe = (raw->toe & ~0x7FFFu) | toe_lsb;
}

void pel_bds_d1_fields(pel_bitio_t *io, int subframe, pel_ephemeris_t *eph, pel_nav_raw_t *raw)
{
    raw->part = (uint32_t)subframe;
    pel_bds_head_fields(io, raw);
    if (subframe == 1) {
        d1_subframe_1(io, eph, raw);
    } else if (subframe == 2) {
        d1_subframe_2(io, eph, raw);
    } else {
        d1_subframe_3(io, eph, raw);
    }
}

/* Page 3 begins with spare bits; pages 4 to 10 continue each other's fields. */
const pel_d2_cut_t PEL_D2_CUT[10] = {
    {42, 60, 0},   {0, 0, 0},     {80, 28, 60},  {42, 64, 88},  {42, 64, 152},
    {42, 64, 216}, {42, 64, 280}, {42, 66, 344}, {42, 64, 410}, {42, 19, 474},
};

void pel_bds_d2_fields(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    clock_head(io, e, raw);
    pel_io_sf(io, 24, -33, &e->af0);
    pel_io_sf(io, 22, -50, &e->af1);
    pel_io_sf(io, 11, -66, &e->af2);
    pel_io_u(io, 5, &raw->iode);
    pel_io_semi(io, 16, -43, &e->dn);
    pel_io_sf(io, 18, -31, &e->cuc);
    pel_io_semi(io, 32, -31, &e->M0);
    pel_io_sf(io, 18, -31, &e->cus);
    pel_io_uf(io, 32, -33, &e->e);
    pel_io_uf(io, 32, -19, &e->sqrt_a);
    pel_io_sf(io, 18, -31, &e->cic);
    pel_io_sf(io, 18, -31, &e->cis);
    pel_io_u(io, 17, &raw->toe);
    pel_io_semi(io, 32, -31, &e->i0);
    pel_io_sf(io, 18, -6, &e->crc);
    pel_io_sf(io, 18, -6, &e->crs);
    pel_io_semi(io, 24, -43, &e->Omega_dot);
    pel_io_semi(io, 32, -31, &e->Omega0);
    pel_io_semi(io, 32, -31, &e->omega);
    pel_io_semi(io, 14, -43, &e->idot);
}

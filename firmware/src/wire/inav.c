#include "navmsg.h"

/* Galileo OS SIS ICD 4.3.5, word types 1 to 5. */

static void word_5(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    /* health here: E1-B data validity, E1-B status (2), E5b data validity, E5b status (2), from the lowest bit */
    uint32_t e5b_hs = (raw->health >> 4) & 3u;
    uint32_t e1_hs = (raw->health >> 1) & 3u;
    uint32_t e5b_dvs = (raw->health >> 3) & 1u;
    uint32_t e1_dvs = raw->health & 1u;

    pel_io_fill(io, 11 + 11 + 14 + 5, 0); /* ionosphere of NeQuick */
    pel_io_sf(io, 10, -32, &e->tgd_s[0]);
    pel_io_sf(io, 10, -32, &e->tgd_s[1]);
    pel_io_u(io, 2, &e5b_hs);
    pel_io_u(io, 2, &e1_hs);
    pel_io_u(io, 1, &e5b_dvs);
    pel_io_u(io, 1, &e1_dvs);
    pel_io_u(io, 12, &raw->week);
    pel_io_u(io, 20, &raw->tow_s);
    pel_io_fill(io, 23, 0);
    raw->health = e1_dvs | (e1_hs << 1) | (e5b_dvs << 3) | (e5b_hs << 4);
}

static void words_1_to_4(pel_bitio_t *io, int word, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_io_u(io, 10, &raw->iode);
    switch (word) {
    case 1:
        pel_io_u(io, 14, &raw->toe);
        pel_io_semi(io, 32, -31, &e->M0);
        pel_io_uf(io, 32, -33, &e->e);
        pel_io_uf(io, 32, -19, &e->sqrt_a);
        pel_io_fill(io, 2, 0);
        break;
    case 2:
        pel_io_semi(io, 32, -31, &e->Omega0);
        pel_io_semi(io, 32, -31, &e->i0);
        pel_io_semi(io, 32, -31, &e->omega);
        pel_io_semi(io, 14, -43, &e->idot);
        pel_io_fill(io, 2, 0);
        break;
    case 3:
        pel_io_semi(io, 24, -43, &e->Omega_dot);
        pel_io_semi(io, 16, -43, &e->dn);
        pel_io_sf(io, 16, -29, &e->cuc);
        pel_io_sf(io, 16, -29, &e->cus);
        pel_io_sf(io, 16, -5, &e->crc);
        pel_io_sf(io, 16, -5, &e->crs);
        pel_io_u(io, 8, &raw->ura);
        break;
    default:
        pel_io_u(io, 6, &raw->prn);
        pel_io_sf(io, 16, -29, &e->cic);
        pel_io_sf(io, 16, -29, &e->cis);
        pel_io_u(io, 14, &raw->toc);
        pel_io_sf(io, 31, -34, &e->af0);
        pel_io_sf(io, 21, -46, &e->af1);
        pel_io_sf(io, 6, -59, &e->af2);
        pel_io_fill(io, 2, 0);
        break;
    }
}

void pel_inav_fields(pel_bitio_t *io, int word, pel_ephemeris_t *eph, pel_nav_raw_t *raw)
{
    raw->part = (uint32_t)word;
    pel_io_u(io, 6, &raw->part);
    if (word == 5) {
        word_5(io, eph, raw);
    } else {
        words_1_to_4(io, word, eph, raw);
    }
}

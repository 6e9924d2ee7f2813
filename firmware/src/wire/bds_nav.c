#include "navmsg.h"

/* BeiDou SIS ICD B1I v3.0, 5.2 (D1) and 5.3 (D2), parity taken out. */

#define PREAMBLE 0x712u

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

static const pel_field_t CLOCK_HEAD[] = {
    PEL_RAW(1, health), PEL_RAW(5, iodc),  PEL_RAW(4, ura),   PEL_RAW(13, week),
    PEL_RAW(17, toc),   PEL_TGD(tgd_s[0]), PEL_TGD(tgd_s[1]),
};
static const pel_field_t D1_CLOCK[] = {
    PEL_FILL(64, 0), /* ionosphere of BeiDou's own model */
    PEL_SF(11, -66, af2), PEL_SF(24, -33, af0), PEL_SF(22, -50, af1), PEL_RAW(5, iode),
};
/* toe lies across subframes 2 and 3: pieces of 2 and 15 bits. */
static const pel_field_t D1_SUBFRAME_2[] = {
    PEL_SEMI(16, -43, dn), PEL_SF(18, -31, cuc), PEL_SEMI(32, -31, M0),   PEL_UF(32, -33, e),   PEL_SF(18, -31, cus),
    PEL_SF(18, -6, crc),   PEL_SF(18, -6, crs),  PEL_UF(32, -19, sqrt_a), PEL_RAW(2, piece[0]),
};
static const pel_field_t D1_SUBFRAME_3[] = {
    PEL_RAW(15, piece[1]),        PEL_SEMI(32, -31, i0),    PEL_SF(18, -31, cic),
    PEL_SEMI(24, -43, Omega_dot), PEL_SF(18, -31, cis),     PEL_SEMI(14, -43, idot),
    PEL_SEMI(32, -31, Omega0),    PEL_SEMI(32, -31, omega), PEL_FILL(1, 0),
};

void pel_bds_d1_fields(pel_bitio_t *io, int subframe, pel_ephemeris_t *eph, pel_nav_raw_t *raw)
{
    raw->part = (uint32_t)subframe;
    pel_bds_head_fields(io, raw);
    raw->piece[0] = raw->toe >> 15;
    raw->piece[1] = raw->toe & 0x7FFFu;
    if (subframe == 1) {
        PEL_IO_FIELDS(io, CLOCK_HEAD, eph, raw);
        PEL_IO_FIELDS(io, D1_CLOCK, eph, raw);
    } else if (subframe == 2) {
        PEL_IO_FIELDS(io, D1_SUBFRAME_2, eph, raw);
    } else {
        PEL_IO_FIELDS(io, D1_SUBFRAME_3, eph, raw);
    }
    raw->toe = (raw->piece[0] << 15) | raw->piece[1];
}

/* Page 3 begins with spare bits; pages 4 to 10 continue each other's fields. */
const pel_d2_cut_t PEL_D2_CUT[10] = {
    {42, 60, 0},   {0, 0, 0},     {80, 28, 60},  {42, 64, 88},  {42, 64, 152},
    {42, 64, 216}, {42, 64, 280}, {42, 66, 344}, {42, 64, 410}, {42, 19, 474},
};

static const pel_field_t D2_ORBIT[] = {
    PEL_SF(24, -33, af0),     PEL_SF(22, -50, af1),         PEL_SF(11, -66, af2),
    PEL_RAW(5, iode),         PEL_SEMI(16, -43, dn),        PEL_SF(18, -31, cuc),
    PEL_SEMI(32, -31, M0),    PEL_SF(18, -31, cus),         PEL_UF(32, -33, e),
    PEL_UF(32, -19, sqrt_a),  PEL_SF(18, -31, cic),         PEL_SF(18, -31, cis),
    PEL_RAW(17, toe),         PEL_SEMI(32, -31, i0),        PEL_SF(18, -6, crc),
    PEL_SF(18, -6, crs),      PEL_SEMI(24, -43, Omega_dot), PEL_SEMI(32, -31, Omega0),
    PEL_SEMI(32, -31, omega), PEL_SEMI(14, -43, idot),
};

void pel_bds_d2_fields(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    PEL_IO_FIELDS(io, CLOCK_HEAD, e, raw);
    PEL_IO_FIELDS(io, D2_ORBIT, e, raw);
}

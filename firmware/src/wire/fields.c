/* fields.c - fields of navigation messages by their tables. */
#include "navmsg.h"

#define PI_ICD     3.1415926535898 /* IS-GPS-200 table 20-IV; Galileo and BeiDou use the same digits */
#define TGD_UNIT_S 1e-10

static void unsigned_field(pel_bitio_t *io, unsigned n_bits, int pow2, double *v)
{
    if (io->writing) {
        pel_write_u(&io->w, n_bits, (uint64_t)pel_round_i64(*v * pel_pow2(-pow2)));
    } else {
        *v = (double)pel_read_u(&io->r, n_bits) * pel_pow2(pow2);
    }
}

static void semicircles(pel_bitio_t *io, unsigned n_bits, int pow2, double *v)
{
    const double unit = PI_ICD * pel_pow2(pow2);
    if (io->writing && n_bits == 32u) {
        /* 2^32 units are a full turn: an angle of any turn keeps its low 32 bits */
        const int64_t raw = pel_round_i64(*v / unit);
        if (raw == INT64_MIN) { io->w.out_of_range = true; }
        pel_write_u(&io->w, 32, (uint64_t)raw & UINT64_C(0xFFFFFFFF));
        return;
    }
    pel_io_signed(io, n_bits, unit, v);
}

void pel_io_fields(pel_bitio_t *io, const pel_field_t field[], size_t n, pel_ephemeris_t *eph, pel_nav_raw_t *raw)
{
    for (const pel_field_t *f = field; f < field + n; f++) {
        double *const v = (double *)(void *)((uint8_t *)eph + f->at); /* used where it is one */
        switch ((pel_field_kind_t)f->kind) {
        case PEL_FIELD_RAW: pel_io_u(io, f->bits, (uint32_t *)(void *)((uint8_t *)raw + f->at)); break;
        case PEL_FIELD_FILL: pel_io_fill(io, f->bits, f->at); break;
        case PEL_FIELD_UNSIGNED: unsigned_field(io, f->bits, f->pow2, v); break;
        case PEL_FIELD_SIGNED: pel_io_signed(io, f->bits, pel_pow2(f->pow2), v); break;
        case PEL_FIELD_SEMI: semicircles(io, f->bits, f->pow2, v); break;
        case PEL_FIELD_TGD: pel_io_signed(io, f->bits, TGD_UNIT_S, v); break;
        }
    }
}

void pel_io_orbit_to_sqrt_a(pel_bitio_t *io, pel_ephemeris_t *eph)
{
    static const pel_field_t FIELDS[] = {
        PEL_SF(16, -5, crs), PEL_SEMI(16, -43, dn), PEL_SEMI(32, -31, M0),   PEL_SF(16, -29, cuc),
        PEL_UF(32, -33, e),  PEL_SF(16, -29, cus),  PEL_UF(32, -19, sqrt_a),
    };
    PEL_IO_FIELDS(io, FIELDS, eph, NULL);
}

void pel_io_orbit_from_cic(pel_bitio_t *io, pel_ephemeris_t *eph)
{
    static const pel_field_t FIELDS[] = {
        PEL_SF(16, -29, cic), PEL_SEMI(32, -31, Omega0), PEL_SF(16, -29, cis),         PEL_SEMI(32, -31, i0),
        PEL_SF(16, -5, crc),  PEL_SEMI(32, -31, omega),  PEL_SEMI(24, -43, Omega_dot),
    };
    PEL_IO_FIELDS(io, FIELDS, eph, NULL);
}

#include "navmsg.h"

/* RTCM 10403: 1019 GPS, 1020 GLONASS, 1042 BeiDou, 1044 QZSS, 1045 Galileo F/NAV, 1046 Galileo I/NAV. */

/* What stands before the orbit and behind it; toe is within it. */
static const pel_field_t HEAD_1019[] = {
    PEL_RAW(6, prn),         PEL_RAW(10, week),    PEL_RAW(4, ura),   PEL_FILL(2, 1), /* code on L2: P */
    PEL_SEMI(14, -43, idot), PEL_RAW(8, iode),     PEL_RAW(16, toc),  PEL_SF(8, -55, af2),
    PEL_SF(16, -43, af1),    PEL_SF(22, -31, af0), PEL_RAW(10, iodc),
};
static const pel_field_t TAIL_1019[] = {
    PEL_SF(8, -31, tgd_s[0]),
    PEL_RAW(6, health),
    PEL_FILL(1, 0),
    PEL_RAW(1, fit),
};
static const pel_field_t HEAD_1044[] = {
    PEL_RAW(4, prn),      PEL_RAW(16, toc),     PEL_SF(8, -55, af2),
    PEL_SF(16, -43, af1), PEL_SF(22, -31, af0), PEL_RAW(8, iode),
};
static const pel_field_t TAIL_1044[] = {
    PEL_SEMI(14, -43, idot),  PEL_FILL(2, 2), /* codes on L2: L2C */
    PEL_RAW(10, week),        PEL_RAW(4, ura),   PEL_RAW(6, health),
    PEL_SF(8, -31, tgd_s[0]), PEL_RAW(10, iodc), PEL_RAW(1, fit),
};
static const pel_field_t HEAD_GALILEO[] = {
    PEL_RAW(6, prn),  PEL_RAW(12, week),   PEL_RAW(10, iode),    PEL_RAW(8, ura),      PEL_SEMI(14, -43, idot),
    PEL_RAW(14, toc), PEL_SF(6, -59, af2), PEL_SF(21, -46, af1), PEL_SF(31, -34, af0),
};
/* F/NAV and I/NAV differ after BGD E5a/E1 only. Pieces of health: E1-B (or, F/NAV, E5a) validity and status, E5b likewise. */
static const pel_field_t TAIL_FNAV[] = {
    PEL_SF(10, -32, tgd_s[0]),
    PEL_RAW(2, piece[1]),
    PEL_RAW(1, piece[0]),
    PEL_FILL(7, 0),
};
static const pel_field_t TAIL_INAV[] = {
    PEL_SF(10, -32, tgd_s[0]), PEL_SF(10, -32, tgd_s[1]), PEL_RAW(2, piece[3]), PEL_RAW(1, piece[2]),
    PEL_RAW(2, piece[1]),      PEL_RAW(1, piece[0]),      PEL_FILL(2, 0),
};
static const pel_field_t FIELDS_1042[] = {
    PEL_RAW(6, prn),
    PEL_RAW(13, week),
    PEL_RAW(4, ura),
    PEL_SEMI(14, -43, idot),
    PEL_RAW(5, iode),
    PEL_RAW(17, toc),
    PEL_SF(11, -66, af2),
    PEL_SF(22, -50, af1),
    PEL_SF(24, -33, af0),
    PEL_RAW(5, iodc),
    PEL_SF(18, -6, crs),
    PEL_SEMI(16, -43, dn),
    PEL_SEMI(32, -31, M0),
    PEL_SF(18, -31, cuc),
    PEL_UF(32, -33, e),
    PEL_SF(18, -31, cus),
    PEL_UF(32, -19, sqrt_a),
    PEL_RAW(17, toe),
    PEL_SF(18, -31, cic),
    PEL_SEMI(32, -31, Omega0),
    PEL_SF(18, -31, cis),
    PEL_SEMI(32, -31, i0),
    PEL_SF(18, -6, crc),
    PEL_SEMI(32, -31, omega),
    PEL_SEMI(24, -43, Omega_dot),
    PEL_TGD(tgd_s[0]),
    PEL_TGD(tgd_s[1]),
    PEL_RAW(1, health),
};

static void orbit(pel_bitio_t *io, unsigned toe_bits, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_io_orbit_to_sqrt_a(io, e);
    pel_io_u(io, toe_bits, &raw->toe);
    pel_io_orbit_from_cic(io, e);
}

static void fields_galileo(pel_bitio_t *io, bool inav, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_gal_health_to_pieces(raw);
    PEL_IO_FIELDS(io, HEAD_GALILEO, e, raw);
    orbit(io, 14, e, raw);
    if (inav) {
        PEL_IO_FIELDS(io, TAIL_INAV, e, raw);
    } else {
        PEL_IO_FIELDS(io, TAIL_FNAV, e, raw);
    }
    pel_gal_health_from_pieces(raw);
}

static void fields(pel_bitio_t *io, uint32_t number, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_io_u(io, 12, &number);
    switch (number) {
    case 1019:
        PEL_IO_FIELDS(io, HEAD_1019, e, raw);
        orbit(io, 16, e, raw);
        PEL_IO_FIELDS(io, TAIL_1019, e, raw);
        break;
    case 1042: PEL_IO_FIELDS(io, FIELDS_1042, e, raw); break;
    case 1044:
        PEL_IO_FIELDS(io, HEAD_1044, e, raw);
        orbit(io, 16, e, raw);
        PEL_IO_FIELDS(io, TAIL_1044, e, raw);
        break;
    default: fields_galileo(io, number == 1046u, e, raw); break;
    }
}

static uint8_t system_of(uint32_t number)
{
    switch (number) {
    case 1019: return PEL_SYS_GPS;
    case 1042: return PEL_SYS_BDS;
    case 1044: return PEL_SYS_QZS;
    default: return PEL_SYS_GAL;
    }
}

static pel_rx_event_t glonass(pel_receiver_t *rx, const uint8_t *message, size_t n)
{
    pel_ephemeris_t eph = {0};
    pel_glo_raw_t raw = {0};
    pel_bitio_t io;

    pel_bitio_read(&io, message, n);
    pel_io_fill(&io, 12, 0);
    pel_glo_1020_fields(&io, &eph, &raw);
    if (pel_bitio_failed(&io)) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    if (rx->t_approx_ns == 0) {
        rx->counters.unknown++; /* nothing tells the date yet */
        return PEL_RX_NONE;
    }
    if (!pel_glo_from_raw(&eph, &raw, rx->t_approx_ns)) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    pel_rx_learn_channel(rx, eph.prn, eph.glo.k);
    rx->ephemeris = eph;
    return PEL_RX_EPHEMERIS;
}

pel_rx_event_t pel_rtcm3_ephemeris(pel_receiver_t *rx, const uint8_t *message, size_t n)
{
    const uint32_t number = (uint32_t)pel_bits_u(message, 0, 12);
    pel_ephemeris_t eph = {0};
    pel_nav_raw_t raw = {0};
    pel_bitio_t io;

    if (number == 1020u) { return glonass(rx, message, n); }
    pel_bitio_read(&io, message, n);
    fields(&io, number, &eph, &raw);
    eph.sys = system_of(number);
    eph.source = (number == 1045u) ? 1 : 0;
    if (pel_bitio_failed(&io)) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    if (!pel_eph_from_raw(&eph, &raw, false, pel_rx_reference(rx))) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    if (rx->t_approx_ns == 0) { rx->t_approx_ns = eph.toe_ns; }
    rx->ephemeris = eph;
    return PEL_RX_EPHEMERIS;
}

static size_t encode_glonass(const pel_ephemeris_t *eph, uint8_t *out, size_t cap)
{
    pel_ephemeris_t e = *eph;
    pel_glo_raw_t raw;
    pel_bitio_t io;
    if (cap < 70u || !pel_glo_to_raw(eph, eph->toe_ns, &raw)) { return 0; }
    pel_bitio_write(&io, out + 3, cap - 6u);
    pel_io_fill(&io, 12, 1020);
    pel_glo_1020_fields(&io, &e, &raw);
    return pel_bitio_failed(&io) ? 0u : pel_rtcm3_seal(io.w.pos, out, cap);
}

size_t pel_rtcm3_encode_ephemeris(const pel_ephemeris_t *eph, uint8_t *out, size_t cap)
{
    pel_ephemeris_t e = *eph; /* the layouts serve both directions and take it writable */
    pel_nav_raw_t raw;
    pel_bitio_t io;
    uint32_t number = 0;

    switch (eph->sys) {
    case PEL_SYS_GPS: number = 1019; break;
    case PEL_SYS_GLO: return encode_glonass(eph, out, cap);
    case PEL_SYS_BDS: number = 1042; break;
    case PEL_SYS_QZS: number = 1044; break;
    case PEL_SYS_GAL: number = (eph->source == 1u) ? 1045 : 1046; break;
    default: return 0;
    }
    if (cap < 70u || !pel_eph_to_raw(eph, eph->toe_ns, &raw)) { return 0; }
    pel_bitio_write(&io, out + 3, cap - 6u);
    fields(&io, number, &e, &raw);
    return pel_bitio_failed(&io) ? 0u : pel_rtcm3_seal(io.w.pos, out, cap);
}

#include "navmsg.h"

/* RTCM 10403: 1019 GPS, 1020 GLONASS, 1042 BeiDou, 1044 QZSS, 1045 Galileo F/NAV, 1046 Galileo I/NAV. */

static void fields_1019(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_io_u(io, 6, &raw->prn);
    pel_io_u(io, 10, &raw->week);
    pel_io_u(io, 4, &raw->ura);
    pel_io_fill(io, 2, 1); /* code on L2: P */
    pel_io_semi(io, 14, -43, &e->idot);
    pel_io_u(io, 8, &raw->iode);
    pel_io_u(io, 16, &raw->toc);
    pel_io_sf(io, 8, -55, &e->af2);
    pel_io_sf(io, 16, -43, &e->af1);
    pel_io_sf(io, 22, -31, &e->af0);
    pel_io_u(io, 10, &raw->iodc);
    pel_io_sf(io, 16, -5, &e->crs);
    pel_io_semi(io, 16, -43, &e->dn);
    pel_io_semi(io, 32, -31, &e->M0);
    pel_io_sf(io, 16, -29, &e->cuc);
    pel_io_uf(io, 32, -33, &e->e);
    pel_io_sf(io, 16, -29, &e->cus);
    pel_io_uf(io, 32, -19, &e->sqrt_a);
    pel_io_u(io, 16, &raw->toe);
    pel_io_sf(io, 16, -29, &e->cic);
    pel_io_semi(io, 32, -31, &e->Omega0);
    pel_io_sf(io, 16, -29, &e->cis);
    pel_io_semi(io, 32, -31, &e->i0);
    pel_io_sf(io, 16, -5, &e->crc);
    pel_io_semi(io, 32, -31, &e->omega);
    pel_io_semi(io, 24, -43, &e->Omega_dot);
    pel_io_sf(io, 8, -31, &e->tgd_s[0]);
    pel_io_u(io, 6, &raw->health);
    pel_io_fill(io, 1, 0);
    pel_io_u(io, 1, &raw->fit);
}

static void fields_1044(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_io_u(io, 4, &raw->prn);
    pel_io_u(io, 16, &raw->toc);
    pel_io_sf(io, 8, -55, &e->af2);
    pel_io_sf(io, 16, -43, &e->af1);
    pel_io_sf(io, 22, -31, &e->af0);
    pel_io_u(io, 8, &raw->iode);
    pel_io_sf(io, 16, -5, &e->crs);
    pel_io_semi(io, 16, -43, &e->dn);
    pel_io_semi(io, 32, -31, &e->M0);
    pel_io_sf(io, 16, -29, &e->cuc);
    pel_io_uf(io, 32, -33, &e->e);
    pel_io_sf(io, 16, -29, &e->cus);
    pel_io_uf(io, 32, -19, &e->sqrt_a);
    pel_io_u(io, 16, &raw->toe);
    pel_io_sf(io, 16, -29, &e->cic);
    pel_io_semi(io, 32, -31, &e->Omega0);
    pel_io_sf(io, 16, -29, &e->cis);
    pel_io_semi(io, 32, -31, &e->i0);
    pel_io_sf(io, 16, -5, &e->crc);
    pel_io_semi(io, 32, -31, &e->omega);
    pel_io_semi(io, 24, -43, &e->Omega_dot);
    pel_io_semi(io, 14, -43, &e->idot);
    pel_io_fill(io, 2, 2); /* codes on L2: L2C */
    pel_io_u(io, 10, &raw->week);
    pel_io_u(io, 4, &raw->ura);
    pel_io_u(io, 6, &raw->health);
    pel_io_sf(io, 8, -31, &e->tgd_s[0]);
    pel_io_u(io, 10, &raw->iodc);
    pel_io_u(io, 1, &raw->fit);
}

static void fields_1042(pel_bitio_t *io, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_io_u(io, 6, &raw->prn);
    pel_io_u(io, 13, &raw->week);
    pel_io_u(io, 4, &raw->ura);
    pel_io_semi(io, 14, -43, &e->idot);
    pel_io_u(io, 5, &raw->iode);
    pel_io_u(io, 17, &raw->toc);
    pel_io_sf(io, 11, -66, &e->af2);
    pel_io_sf(io, 22, -50, &e->af1);
    pel_io_sf(io, 24, -33, &e->af0);
    pel_io_u(io, 5, &raw->iodc);
    pel_io_sf(io, 18, -6, &e->crs);
    pel_io_semi(io, 16, -43, &e->dn);
    pel_io_semi(io, 32, -31, &e->M0);
    pel_io_sf(io, 18, -31, &e->cuc);
    pel_io_uf(io, 32, -33, &e->e);
    pel_io_sf(io, 18, -31, &e->cus);
    pel_io_uf(io, 32, -19, &e->sqrt_a);
    pel_io_u(io, 17, &raw->toe);
    pel_io_sf(io, 18, -31, &e->cic);
    pel_io_semi(io, 32, -31, &e->Omega0);
    pel_io_sf(io, 18, -31, &e->cis);
    pel_io_semi(io, 32, -31, &e->i0);
    pel_io_sf(io, 18, -6, &e->crc);
    pel_io_semi(io, 32, -31, &e->omega);
    pel_io_semi(io, 24, -43, &e->Omega_dot);
    pel_io_unit(io, 10, 1e-10, &e->tgd_s[0]);
    pel_io_unit(io, 10, 1e-10, &e->tgd_s[1]);
    pel_io_u(io, 1, &raw->health);
}

/* F/NAV and I/NAV differ after BGD E5a/E1 only. Health as in inav.c: E1-B (or, F/NAV, E5a) validity and status lowest. */
static void fields_galileo(pel_bitio_t *io, bool inav, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    uint32_t first_dvs = raw->health & 1u;
    uint32_t first_hs = (raw->health >> 1) & 3u;
    uint32_t e5b_dvs = (raw->health >> 3) & 1u;
    uint32_t e5b_hs = (raw->health >> 4) & 3u;

    pel_io_u(io, 6, &raw->prn);
    pel_io_u(io, 12, &raw->week);
    pel_io_u(io, 10, &raw->iode);
    pel_io_u(io, 8, &raw->ura);
    pel_io_semi(io, 14, -43, &e->idot);
    pel_io_u(io, 14, &raw->toc);
    pel_io_sf(io, 6, -59, &e->af2);
    pel_io_sf(io, 21, -46, &e->af1);
    pel_io_sf(io, 31, -34, &e->af0);
    pel_io_sf(io, 16, -5, &e->crs);
    pel_io_semi(io, 16, -43, &e->dn);
    pel_io_semi(io, 32, -31, &e->M0);
    pel_io_sf(io, 16, -29, &e->cuc);
    pel_io_uf(io, 32, -33, &e->e);
    pel_io_sf(io, 16, -29, &e->cus);
    pel_io_uf(io, 32, -19, &e->sqrt_a);
    pel_io_u(io, 14, &raw->toe);
    pel_io_sf(io, 16, -29, &e->cic);
    pel_io_semi(io, 32, -31, &e->Omega0);
    pel_io_sf(io, 16, -29, &e->cis);
    pel_io_semi(io, 32, -31, &e->i0);
    pel_io_sf(io, 16, -5, &e->crc);
    pel_io_semi(io, 32, -31, &e->omega);
    pel_io_semi(io, 24, -43, &e->Omega_dot);
    pel_io_sf(io, 10, -32, &e->tgd_s[0]);
    if (inav) {
        pel_io_sf(io, 10, -32, &e->tgd_s[1]);
        pel_io_u(io, 2, &e5b_hs);
        pel_io_u(io, 1, &e5b_dvs);
        pel_io_u(io, 2, &first_hs);
        pel_io_u(io, 1, &first_dvs);
        pel_io_fill(io, 2, 0);
    } else {
        pel_io_u(io, 2, &first_hs);
        pel_io_u(io, 1, &first_dvs);
        pel_io_fill(io, 7, 0);
    }
    raw->health = first_dvs | (first_hs << 1) | (e5b_dvs << 3) | (e5b_hs << 4);
}

static void fields(pel_bitio_t *io, uint32_t number, pel_ephemeris_t *e, pel_nav_raw_t *raw)
{
    pel_io_u(io, 12, &number);
    switch (number) {
    case 1019: fields_1019(io, e, raw); break;
    case 1042: fields_1042(io, e, raw); break;
    case 1044: fields_1044(io, e, raw); break;
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

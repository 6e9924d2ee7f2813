#include "navmsg.h"

#include <string.h>

/* Words as u-blox receivers give them. Parity bits of GPS and BeiDou words are left zero: receivers have checked them and
 * readers ignore them. The CRC of Galileo pages is real. */

int pel_ubx_sfrbx_parts(const pel_ephemeris_t *eph)
{
    switch (eph->sys) {
    case PEL_SYS_GPS:
    case PEL_SYS_QZS: return 3;
    case PEL_SYS_GAL: return 5;
    case PEL_SYS_GLO: return 4;
    case PEL_SYS_BDS: return pel_bds_is_geo(eph->prn) ? 10 : 3;
    default: return 0;
    }
}

static size_t seal(uint8_t gnss_id, uint8_t prn, uint8_t sig_id, uint8_t channel, uint8_t n_words, uint8_t *out,
                   size_t cap)
{
    uint8_t *const m = out + 6;
    m[0] = gnss_id;
    m[1] = prn;
    m[2] = sig_id;
    m[3] = channel;
    m[4] = n_words;
    m[5] = 0;
    m[6] = 2; /* version */
    m[7] = 0;
    return pel_ubx_seal(0x02, 0x13, 8u + 4u * n_words, out, cap);
}

static void lnav_words(const uint8_t part[PEL_LNAV_BYTES], uint8_t *words)
{
    pel_le_put(words, 4, (uint64_t)0x8B0000u << 6); /* telemetry word: preamble */
    for (unsigned i = 0; i < 9u; i++) { pel_le_put(words + 4u * (i + 1u), 4, pel_bits_u(part, 24u * i, 24) << 6); }
}

static void inav_words(const uint8_t word[PEL_INAV_BYTES], uint8_t *words)
{
    uint8_t page[32] = {0};
    uint8_t crc_input[25] = {0};
    pel_bits_copy(page, 2, word, 0, 112);
    pel_bits_put(page, 128, 2, 2); /* odd half */
    pel_bits_copy(page, 130, word, 112, 16);
    pel_bits_copy(crc_input, 4, page, 0, 114);
    pel_bits_copy(crc_input, 118, page, 128, 82);
    pel_bits_put(page, 128 + 82, 24, pel_crc24q(0, crc_input, sizeof crc_input));
    for (unsigned i = 0; i < 8u; i++) { pel_le_put(words + 4u * i, 4, pel_bits_u(page, 32u * i, 32)); }
}

static void bds_words(const uint8_t part[PEL_D1_BYTES], uint8_t *words)
{
    pel_le_put(words, 4, pel_bits_u(part, 0, 26) << 4);
    for (unsigned i = 1; i < 10u; i++) {
        pel_le_put(words + 4u * i, 4, pel_bits_u(part, 26u + 22u * (i - 1u), 22) << 8);
    }
}

/* One page of D2 subframe 1, cut out of the joined fields. */
static bool d2_part(pel_ephemeris_t *eph, pel_nav_raw_t *raw, int page, uint8_t part[PEL_D1_BYTES])
{
    uint8_t joined[PEL_D2_BYTES];
    pel_bitio_t io;
    pel_bitio_write(&io, joined, sizeof joined);
    pel_bds_d2_fields(&io, eph, raw);
    if (pel_bitio_failed(&io)) { return false; }
    pel_bitio_write(&io, part, PEL_D1_BYTES);
    raw->part = 1;
    pel_bds_head_fields(&io, raw);
    pel_bits_put(part, 38, 4, (uint64_t)page);
    pel_bits_copy(part, PEL_D2_CUT[page - 1].from, joined, PEL_D2_CUT[page - 1].to, PEL_D2_CUT[page - 1].count);
    return !pel_bitio_failed(&io);
}

/* The time at which part began, given the time its frame began: subframes of a frame carry successive times. */
static pel_time_t part_time(const pel_ephemeris_t *eph, int part, pel_time_t t)
{
    int64_t step_s = 6;
    if (eph->sys == PEL_SYS_GAL) {
        step_s = 0;
    } else if (eph->sys == PEL_SYS_BDS && pel_bds_is_geo(eph->prn)) {
        step_s = 3;
    }
    return t + step_s * (part - 1) * PEL_NS_PER_S;
}

/* The frame's number is the half minute of Moscow's day, five to a superframe. */
static size_t glonass(const pel_ephemeris_t *eph, int part, pel_time_t t, uint8_t *out, size_t cap)
{
    pel_ephemeris_t e = *eph;
    pel_glo_raw_t raw;
    pel_bitio_t io;
    uint8_t string[12];
    if (!pel_glo_to_raw(eph, t, &raw)) { return 0; }
    const uint32_t frame = raw.t_k / 30u;
    pel_bitio_write(&io, string, sizeof string);
    pel_glo_string_fields(&io, part, &e, &raw);
    if (pel_bitio_failed(&io)) { return 0; }
    pel_glo_string_seal(string);
    for (unsigned i = 0; i < 3u; i++) { pel_le_put(out + 6 + 8 + 4u * i, 4, pel_bits_u(string, 32u * i, 32)); }
    pel_le_put(out + 6 + 8 + 12, 4, (uint64_t)(frame / 5u + 1u) << 16 | (frame % 5u + 1u));
    return seal(6, eph->prn, 0, (uint8_t)(eph->glo.k + 7), 4, out, cap);
}

size_t pel_ubx_encode_sfrbx_eph(const pel_ephemeris_t *eph, int part, pel_time_t t, uint8_t *out, size_t cap)
{
    pel_ephemeris_t e = *eph; /* the layouts serve both directions and take it writable */
    pel_nav_raw_t raw;
    pel_bitio_t io;
    uint8_t buf[PEL_D1_BYTES];

    if (cap < 8u + 8u + 40u || part < 1 || part > pel_ubx_sfrbx_parts(eph)) { return 0; }
    if (eph->sys == PEL_SYS_GLO) { return glonass(eph, part, t, out, cap); }
    if (!pel_eph_to_raw(eph, part_time(eph, part, t), &raw)) { return 0; }
    uint8_t *const words = out + 6 + 8;
    switch (eph->sys) {
    case PEL_SYS_GAL:
        pel_bitio_write(&io, buf, PEL_INAV_BYTES);
        pel_inav_fields(&io, part, &e, &raw);
        if (pel_bitio_failed(&io)) { return 0; }
        inav_words(buf, words);
        return seal(2, eph->prn, 1, 0, 8, out, cap);
    case PEL_SYS_BDS:
        if (pel_bds_is_geo(eph->prn)) {
            if (!d2_part(&e, &raw, part, buf)) { return 0; }
        } else {
            pel_bitio_write(&io, buf, PEL_D1_BYTES);
            pel_bds_d1_fields(&io, part, &e, &raw);
            if (pel_bitio_failed(&io)) { return 0; }
        }
        bds_words(buf, words);
        return seal(3, eph->prn, pel_bds_is_geo(eph->prn) ? 1 : 0, 0, 10, out, cap);
    default:
        pel_bitio_write(&io, buf, PEL_LNAV_BYTES);
        pel_lnav_fields(&io, part, &e, &raw);
        if (pel_bitio_failed(&io)) { return 0; }
        lnav_words(buf, words);
        return seal((eph->sys == PEL_SYS_QZS) ? 5 : 0, eph->prn, 0, 0, 10, out, cap);
    }
}

size_t pel_ubx_encode_sfrbx_klobuchar(const pel_klobuchar_t *k, int prn, pel_time_t t, uint8_t *out, size_t cap)
{
    pel_klobuchar_t copy = *k;
    pel_nav_raw_t raw = {0};
    pel_bitio_t io;
    uint8_t buf[PEL_LNAV_BYTES];

    if (cap < 8u + 8u + 40u || prn < 1 || prn > 32 || t < 0 || !k->valid) { return 0; }
    raw.tow_s = (uint32_t)(t % PEL_NS_PER_WEEK / PEL_NS_PER_S);
    pel_bitio_write(&io, buf, sizeof buf);
    pel_lnav_klobuchar_fields(&io, &copy, &raw);
    if (pel_bitio_failed(&io)) { return 0; }
    lnav_words(buf, out + 6 + 8);
    return seal(0, (uint8_t)prn, 0, 0, 10, out, cap);
}

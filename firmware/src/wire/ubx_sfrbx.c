#include "navmsg.h"

#include <string.h>

/* Parts of each satellite's message are kept as received until all are there and belong together; then they are decoded at
 * once. So subframes may come in any order and a half-received new set never touches what was given before. */

#define LNAV_PREAMBLE 0x8Bu
#define BDS_PREAMBLE  0x712u
#define PAGE_18       0x78u /* data identification 1, satellite identification 56 */
#define SLOT_UNKNOWN  255u  /* GLONASS satellite whose number the receiver does not know yet */
#define SLOT_IDLE                                                                                                      \
    1000u /* frames of other satellites after which a slot may be taken: more than a minute of 45 satellites */

typedef enum { NAV_NONE, NAV_LNAV, NAV_INAV, NAV_D1, NAV_D2, NAV_GLO } nav_type_t;

/* gnssId, sigId of the message -> system and message type. Before version 2 the signal is not told: there is only one. */
static nav_type_t classify(uint8_t gnss_id, uint8_t sig_id, uint8_t sv, bool told, uint8_t *sys)
{
    switch (gnss_id) {
    case 0: *sys = PEL_SYS_GPS; return (!told || sig_id == 0) ? NAV_LNAV : NAV_NONE;
    case 2: *sys = PEL_SYS_GAL; return (!told || sig_id == 1 || sig_id == 5) ? NAV_INAV : NAV_NONE;
    case 3:
        *sys = PEL_SYS_BDS;
        if (!told) { return pel_bds_is_geo(sv) ? NAV_D2 : NAV_D1; }
        if (sig_id == 0 || sig_id == 2 || sig_id == 4) { return NAV_D1; }
        return (sig_id == 1 || sig_id == 3 || sig_id == 10) ? NAV_D2 : NAV_NONE;
    case 5: *sys = PEL_SYS_QZS; return (!told || sig_id == 0) ? NAV_LNAV : NAV_NONE;
    case 6: *sys = PEL_SYS_GLO; return (!told || sig_id == 0 || sig_id == 2) ? NAV_GLO : NAV_NONE;
    default: *sys = PEL_SYS_SBS; return NAV_NONE;
    }
}

static pel_nav_slot_t *slot_for(pel_receiver_t *rx, uint8_t sys, uint8_t prn)
{
    pel_nav_slot_t *oldest = &rx->nav[0]; /* a free one, else the one idle longest */
    for (int i = 0; i < PEL_NAV_SLOTS; i++) {
        pel_nav_slot_t *const s = &rx->nav[i];
        if (s->prn == prn && s->sys == sys) {
            if (rx->nav_clock - s->touched > SLOT_IDLE) { s->have = 0; } /* the satellite was away */
            s->touched = rx->nav_clock;
            return s;
        }
        if (oldest->prn != 0u && (s->prn == 0u || s->touched < oldest->touched)) { oldest = s; }
    }
    if (oldest->prn != 0u && rx->nav_clock - oldest->touched <= SLOT_IDLE) {
        rx->counters.overflow++;
        return NULL;
    }
    memset(oldest, 0, sizeof *oldest);
    oldest->sys = sys;
    oldest->prn = prn;
    oldest->touched = rx->nav_clock;
    return oldest;
}

/* A complete, consistent set: eph and raw hold it. Gives it if its values are possible. */
static pel_rx_event_t give(pel_receiver_t *rx, pel_nav_slot_t *s, pel_ephemeris_t *eph, pel_nav_raw_t *raw)
{
    raw->prn = s->prn;
    eph->sys = s->sys;
    s->prn = 0;
    s->have = 0;
    if (!pel_eph_from_raw(eph, raw, true, pel_rx_reference(rx))) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    rx->ephemeris = *eph;
    return PEL_RX_EPHEMERIS;
}

/* ---- GPS and QZSS LNAV ------------------------------------------------------------------------------------------------- */

static pel_rx_event_t klobuchar(pel_receiver_t *rx, const uint8_t *part)
{
    pel_bitio_t io;
    pel_nav_raw_t raw = {0};
    pel_klobuchar_t k = {.valid = true};

    pel_bitio_read(&io, part, PEL_LNAV_BYTES);
    pel_lnav_klobuchar_fields(&io, &k, &raw);
    if (raw.iode != PAGE_18) { return PEL_RX_NONE; }
    rx->klobuchar = k;
    return PEL_RX_KLOBUCHAR;
}

static pel_rx_event_t lnav_complete(pel_receiver_t *rx, pel_nav_slot_t *s)
{
    pel_ephemeris_t eph = {0};
    pel_nav_raw_t raw = {0};
    uint32_t iode_2 = 0;
    uint32_t tow_1 = 0;
    for (int sf = 1; sf <= 3; sf++) {
        pel_bitio_t io;
        pel_bitio_read(&io, s->data + PEL_LNAV_BYTES * (sf - 1), PEL_LNAV_BYTES);
        pel_lnav_fields(&io, sf, &eph, &raw);
        if (sf == 1) { tow_1 = raw.tow_s; } /* the week number's own time */
        if (sf == 2) { iode_2 = raw.iode; }
    }
    if (raw.iode != iode_2 || raw.iode != (raw.iodc & 0xFFu)) { return PEL_RX_NONE; } /* a new set is coming in */
    raw.tow_s = tow_1;
    return give(rx, s, &eph, &raw);
}

static pel_rx_event_t lnav(pel_receiver_t *rx, uint8_t sys, uint8_t prn, const uint8_t *words, unsigned n_words)
{
    uint8_t part[30] = {0}; /* ten words of 24 data bits; the receiver has checked and removed the parity's sense */
    if (n_words != 10u) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    for (unsigned i = 0; i < 10u; i++) { pel_bits_put(part, 24u * i, 24, pel_le_u(words + 4u * i, 4) >> 6); }
    const unsigned sf = (unsigned)pel_bits_u(part, 24 + 19, 3);
    if (part[0] != LNAV_PREAMBLE || sf < 1u || sf > 5u) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    if (sf == 4u && sys == PEL_SYS_GPS) { return klobuchar(rx, part + 3); }
    if (sf > 3u) { return PEL_RX_NONE; }

    pel_nav_slot_t *const s = slot_for(rx, sys, prn);
    if (s == NULL) { return PEL_RX_NONE; }
    memcpy(s->data + PEL_LNAV_BYTES * (sf - 1u), part + 3, PEL_LNAV_BYTES);
    s->have |= (uint16_t)(1u << sf);
    return (s->have == 0x0Eu) ? lnav_complete(rx, s) : PEL_RX_NONE;
}

/* ---- Galileo I/NAV ------------------------------------------------------------------------------------------------------ */

/* A page is an even and an odd half of 120 bits, each in four words. CRC-24Q covers 114 bits of the even half and the 82
 * before the CRC of the odd one, with four leading zero bits to fill bytes (OS SIS ICD 5.1.9.4). */
static bool inav_page(const uint8_t *words, uint8_t word[PEL_INAV_BYTES])
{
    uint8_t page[32] = {0};
    uint8_t crc_input[25] = {0};
    for (unsigned i = 0; i < 8u; i++) { pel_bits_put(page, 32u * i, 32, pel_le_u(words + 4u * i, 4)); }
    if (pel_bits_u(page, 0, 2) != 0u || pel_bits_u(page, 128, 2) != 2u) { return false; } /* even, odd, both nominal */
    pel_bits_copy(crc_input, 4, page, 0, 114);
    pel_bits_copy(crc_input, 118, page, 128, 82);
    if (pel_crc24q(0, crc_input, sizeof crc_input) != pel_bits_u(page, 128 + 82, 24)) { return false; }
    pel_bits_copy(word, 0, page, 2, 112);
    pel_bits_copy(word, 112, page, 130, 16);
    return true;
}

static pel_rx_event_t inav_complete(pel_receiver_t *rx, pel_nav_slot_t *s)
{
    pel_ephemeris_t eph = {0};
    pel_nav_raw_t raw = {0};
    uint32_t iod[5] = {0};
    for (int w = 1; w <= 5; w++) {
        pel_bitio_t io;
        pel_bitio_read(&io, s->data + PEL_INAV_BYTES * (w - 1), PEL_INAV_BYTES);
        pel_inav_fields(&io, w, &eph, &raw);
        iod[w - 1] = raw.iode;
    }
    if (iod[0] != iod[1] || iod[0] != iod[2] || iod[0] != iod[3]) { return PEL_RX_NONE; }
    if (raw.prn != s->prn) { /* word 4 names its satellite */
        s->have = 0;
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    return give(rx, s, &eph, &raw);
}

static pel_rx_event_t inav(pel_receiver_t *rx, uint8_t prn, const uint8_t *words, unsigned n_words)
{
    uint8_t word[PEL_INAV_BYTES];
    if (n_words < 8u) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    if ((pel_le_u(words, 4) >> 30) == 1u) { return PEL_RX_NONE; } /* alert page */
    if (!inav_page(words, word)) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    const unsigned type = word[0] >> 2;
    if (type < 1u || type > 5u) { return PEL_RX_NONE; }
    pel_nav_slot_t *const s = slot_for(rx, PEL_SYS_GAL, prn);
    if (s == NULL) { return PEL_RX_NONE; }
    memcpy(s->data + PEL_INAV_BYTES * (type - 1u), word, PEL_INAV_BYTES);
    s->have |= (uint16_t)(1u << type);
    return (s->have == 0x3Eu) ? inav_complete(rx, s) : PEL_RX_NONE;
}

/* ---- BeiDou D1, D2 -------------------------------------------------------------------------------------------------------- */

/* Ten words of 30 bits: 26 data bits in the first, 22 in the others, the rest is parity. */
static void bds_strip(const uint8_t *words, uint8_t part[PEL_D1_BYTES])
{
    memset(part, 0, PEL_D1_BYTES);
    pel_bits_put(part, 0, 26, pel_le_u(words, 4) >> 4);
    for (unsigned i = 1; i < 10u; i++) {
        pel_bits_put(part, 26u + 22u * (i - 1u), 22, pel_le_u(words + 4u * i, 4) >> 8);
    }
}

static uint32_t seconds_before(uint32_t tow_s, uint32_t s)
{
    return (tow_s + 604800u - s) % 604800u;
}

/* The slot, emptied if the part belongs to another frame than those in it. */
static pel_nav_slot_t *bds_slot(pel_receiver_t *rx, uint8_t prn, uint32_t start_s)
{
    pel_nav_slot_t *const s = slot_for(rx, PEL_SYS_BDS, prn);
    if (s != NULL && (s->have == 0u || s->start_s != start_s)) {
        s->have = 0;
        s->start_s = start_s;
    }
    return s;
}

static pel_rx_event_t bds_d1(pel_receiver_t *rx, uint8_t prn, const uint8_t *part, const pel_nav_raw_t *head)
{
    if (head->part > 3u) { return PEL_RX_NONE; }
    pel_nav_slot_t *const s = bds_slot(rx, prn, seconds_before(head->tow_s, 6u * (head->part - 1u)));
    if (s == NULL) { return PEL_RX_NONE; }
    memcpy(s->data + PEL_D1_BYTES * (head->part - 1u), part, PEL_D1_BYTES);
    s->have |= (uint16_t)(1u << head->part);
    if (s->have != 0x0Eu) { return PEL_RX_NONE; }

    pel_ephemeris_t eph = {0};
    pel_nav_raw_t raw = {0};
    for (int sf = 1; sf <= 3; sf++) {
        pel_bitio_t io;
        pel_bitio_read(&io, s->data + PEL_D1_BYTES * (sf - 1), PEL_D1_BYTES);
        pel_bds_d1_fields(&io, sf, &eph, &raw);
    }
    raw.tow_s = s->start_s;
    return give(rx, s, &eph, &raw);
}

static pel_rx_event_t bds_d2(pel_receiver_t *rx, uint8_t prn, const uint8_t *part, const pel_nav_raw_t *head)
{
    const unsigned page = (unsigned)pel_bits_u(part, 38, 4);
    if (head->part != 1u) { return PEL_RX_NONE; }
    if (page < 1u || page > 10u) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    pel_nav_slot_t *const s = bds_slot(rx, prn, seconds_before(head->tow_s, 3u * (page - 1u)));
    if (s == NULL) { return PEL_RX_NONE; }
    const pel_d2_cut_t *const cut = &PEL_D2_CUT[page - 1u];
    pel_bits_copy(s->data, cut->to, part, cut->from, cut->count);
    s->have |= (uint16_t)(1u << page);
    s->have |= (uint16_t)(1u << 2); /* page 2 has nothing for us */
    if (s->have != 0x7FEu) { return PEL_RX_NONE; }

    pel_ephemeris_t eph = {0};
    pel_nav_raw_t raw = {0};
    pel_bitio_t io;
    pel_bitio_read(&io, s->data, PEL_D2_BYTES);
    pel_bds_d2_fields(&io, &eph, &raw);
    raw.tow_s = s->start_s;
    return give(rx, s, &eph, &raw);
}

static pel_rx_event_t bds(pel_receiver_t *rx, nav_type_t type, uint8_t prn, const uint8_t *words, unsigned n_words)
{
    uint8_t part[PEL_D1_BYTES];
    pel_nav_raw_t head = {0};
    pel_bitio_t io;
    if (n_words != 10u) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    bds_strip(words, part);
    pel_bitio_read(&io, part, sizeof part);
    pel_bds_head_fields(&io, &head);
    if (pel_bits_u(part, 0, 11) != BDS_PREAMBLE || head.part < 1u || head.part > 5u || head.tow_s >= 604800u) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    return (type == NAV_D1) ? bds_d1(rx, prn, part, &head) : bds_d2(rx, prn, part, &head);
}

/* ---- GLONASS ---------------------------------------------------------------------------------------------------------------- */

static pel_rx_event_t glonass_complete(pel_receiver_t *rx, pel_nav_slot_t *s, uint8_t channel)
{
    pel_ephemeris_t eph = {0};
    pel_glo_raw_t raw = {0};
    for (int i = 1; i <= 4; i++) {
        pel_bitio_t io;
        pel_bitio_read(&io, s->data + PEL_GLO_BYTES * (i - 1), PEL_GLO_BYTES);
        pel_glo_string_fields(&io, i, &eph, &raw);
    }
    const bool same_slot = raw.slot == s->prn || raw.slot == 0u; /* early satellites do not tell it */
    raw.slot = s->prn;
    eph.glo.k = (int8_t)((channel <= 13u) ? (int)channel - 7 : 127);
    s->prn = 0;
    s->have = 0;
    if (!same_slot || !pel_glo_from_raw(&eph, &raw, rx->t_approx_ns)) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    rx->ephemeris = eph;
    return PEL_RX_EPHEMERIS;
}

/* Four words: a string of 85 bits, then the numbers of superframe and frame, which tell strings that belong together. */
static pel_rx_event_t glonass(pel_receiver_t *rx, uint8_t prn, uint8_t channel, const uint8_t *words, unsigned n_words)
{
    uint8_t string[12];
    if (n_words != 4u) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    for (unsigned i = 0; i < 3u; i++) { pel_bits_put(string, 32u * i, 32, pel_le_u(words + 4u * i, 4)); }
    const unsigned number = (unsigned)pel_bits_u(string, 1, 4);
    if (!pel_glo_string_good(string)) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    if (number < 1u || number > 4u || rx->t_approx_ns == 0) { return PEL_RX_NONE; } /* almanac; or no date known yet */
    pel_nav_slot_t *const s = slot_for(rx, PEL_SYS_GLO, prn);
    if (s == NULL) { return PEL_RX_NONE; }
    const uint32_t frame = (uint32_t)pel_le_u(words + 12, 4);
    if (s->have == 0u || s->start_s != frame) {
        s->have = 0;
        s->start_s = frame;
    }
    memcpy(s->data + PEL_GLO_BYTES * (number - 1u), string, PEL_GLO_BYTES);
    s->have |= (uint16_t)(1u << number);
    return (s->have == 0x1Eu) ? glonass_complete(rx, s, channel) : PEL_RX_NONE;
}

pel_rx_event_t pel_ubx_sfrbx(pel_receiver_t *rx, const uint8_t *m, size_t n)
{
    const unsigned n_words = m[4];
    uint8_t sys;
    if (n != 8u + 4u * n_words) {
        rx->counters.bad_length++;
        return PEL_RX_NONE;
    }
    const nav_type_t type = classify(m[0], m[2], m[1], m[6] >= 2u, &sys);
    if (type == NAV_NONE) {
        rx->counters.unknown++;
        return PEL_RX_NONE;
    }
    if (type == NAV_GLO && m[1] == SLOT_UNKNOWN) { return PEL_RX_NONE; }
    if (m[1] < 1u || m[1] > pel_sys_max_prn((pel_sys_t)sys)) {
        rx->counters.bad_value++;
        return PEL_RX_NONE;
    }
    rx->nav_clock++;
    switch (type) {
    case NAV_LNAV: return lnav(rx, sys, m[1], m + 8, n_words);
    case NAV_INAV: return inav(rx, m[1], m + 8, n_words);
    case NAV_GLO: return glonass(rx, m[1], m[3], m + 8, n_words);
    default: return bds(rx, type, m[1], m + 8, n_words);
    }
}

#include "navmsg.h"

#include <string.h>

#define BDT_GPS_WEEKS 1356
#define BDT_GPS_S     14
#define GST_GPS_WEEKS 1024
#define NO_ACCURACY_M 6144.0f /* index that stands for "no prediction": so large that no user weights it */

/* What differs between the systems in the same set of fields. */
typedef struct {
    int32_t week_modulo, week_offset; /* sent week + offset = GPS week */
    int32_t time_offset_s;            /* system time + offset = GPS time */
    int32_t toe_unit_s;
    float fit_s;
} nav_system_t;

static const nav_system_t *system_of(uint8_t sys)
{
    /* usable span: GPS fit interval 4 h (or 6), QZSS 2 h but refreshed hourly, Galileo 4 h, BeiDou hourly sets */
    static const nav_system_t GPS = {1024, 0, 0, 16, 7200.0f};
    static const nav_system_t GAL = {4096, GST_GPS_WEEKS, 0, 60, 14400.0f};
    static const nav_system_t BDS = {8192, BDT_GPS_WEEKS, BDT_GPS_S, 8, 14400.0f};
    switch (sys) {
    case PEL_SYS_GPS:
    case PEL_SYS_QZS: return &GPS;
    case PEL_SYS_GAL: return &GAL;
    case PEL_SYS_BDS: return &BDS;
    default: return NULL;
    }
}

/* Nominal values: IS-GPS-200 20.3.3.3.1.3 (BeiDou the same), Galileo OS SIS ICD table 89. */
static const float URA_M[16] = {2.0f,  2.8f,   4.0f,   5.7f,   8.0f,    11.3f,   16.0f,   32.0f,
                                64.0f, 128.0f, 256.0f, 512.0f, 1024.0f, 2048.0f, 4096.0f, NO_ACCURACY_M};

static float sisa_m(uint32_t index)
{
    const float i = (float)index;
    if (index <= 49u) { return 0.01f * i; }
    if (index <= 74u) { return 0.5f + 0.02f * (i - 50.0f); }
    if (index <= 99u) { return 1.0f + 0.04f * (i - 75.0f); }
    if (index <= 125u) { return 2.0f + 0.16f * (i - 100.0f); }
    return NO_ACCURACY_M;
}

static float accuracy_m(uint8_t sys, uint32_t index)
{
    if (sys == PEL_SYS_GAL) { return sisa_m(index); }
    return (index < 16u) ? URA_M[index] : NO_ACCURACY_M;
}

/* The smallest index whose value is not below sd_m: rounding never promises more than was known. */
static uint32_t accuracy_index(uint8_t sys, float sd_m)
{
    const uint32_t last = (sys == PEL_SYS_GAL) ? 125u : 14u;
    const float tiny = 1e-4f; /* the table's own decimals */
    for (uint32_t i = 0; i <= last; i++) {
        if (sd_m <= accuracy_m(sys, i) + tiny) { return i; }
    }
    return (sys == PEL_SYS_GAL) ? 255u : 15u;
}

static bool orbit_plausible(const pel_ephemeris_t *e)
{
    const bool round_orbit = e->e >= 0.0 && e->e < 0.5;
    const bool size = e->sqrt_a > 4500.0 && e->sqrt_a < 7500.0; /* 20 000 to 56 000 km */
    return round_orbit && size && e->prn >= 1 && e->prn <= pel_sys_max_prn((pel_sys_t)e->sys);
}

/* QZSS: the last two of six bits speak of L1C and L1C/B, which do not make a satellite unusable (IS-QZSS-PNT 4.1.2.7). */
static uint8_t health_of(uint8_t sys, uint32_t sent)
{
    return (uint8_t)((sys == PEL_SYS_QZS) ? (sent & 0x3Eu) : sent);
}

bool pel_eph_from_raw(pel_ephemeris_t *eph, const pel_nav_raw_t *raw, bool tow_known, pel_time_t t_ref)
{
    const nav_system_t *const s = system_of(eph->sys);
    if (s == NULL) { return false; }
    const int32_t toe_s = (int32_t)raw->toe * s->toe_unit_s;
    const int32_t toc_s = (int32_t)raw->toc * s->toe_unit_s;

    eph->prn = (uint8_t)raw->prn;
    if (!orbit_plausible(eph) || toe_s >= PEL_S_PER_WEEK || toc_s >= PEL_S_PER_WEEK) { return false; }

    const int32_t week =
        pel_time_full_week((int32_t)raw->week, s->week_modulo, t_ref - (pel_time_t)s->week_offset * PEL_NS_PER_WEEK) +
        s->week_offset;
    if (week < PEL_WEEK_FIRST || week > PEL_WEEK_LAST) { return false; }
    const pel_time_t offset = s->time_offset_s * PEL_NS_PER_S;
    eph->toe_ns = pel_time_from_week(week, (double)toe_s) + offset;
    if (tow_known) {
        /* the week counts the time of transmission, toe may lie across its edge */
        const pel_time_t sent = pel_time_from_week(week, (double)raw->tow_s);
        eph->toe_ns = pel_time_from_tow_near((double)toe_s, sent) + offset;
    } else {
        /* RTCM tells no time of transmission: a toe half a week from now is one across the edge */
        const pel_time_t near = pel_time_from_tow_near((double)toe_s, t_ref - offset) + offset;
        if (near - eph->toe_ns == PEL_NS_PER_WEEK || eph->toe_ns - near == PEL_NS_PER_WEEK) { eph->toe_ns = near; }
    }
    eph->toc_ns = pel_time_from_tow_near((double)toc_s, eph->toe_ns - offset) + offset;

    eph->iode = (uint16_t)raw->iode;
    eph->iodc = (uint16_t)raw->iodc;
    eph->health = health_of(eph->sys, raw->health);
    eph->sd_ura_m = accuracy_m(eph->sys, raw->ura);
    eph->fit_s = (eph->sys == PEL_SYS_GPS && raw->fit != 0u) ? 10800.0f : s->fit_s;
    return true;
}

bool pel_eph_to_raw(const pel_ephemeris_t *eph, pel_time_t t, pel_nav_raw_t *raw)
{
    const nav_system_t *const s = system_of(eph->sys);
    if (s == NULL || !orbit_plausible(eph)) { return false; }
    const pel_time_t offset = (pel_time_t)s->week_offset * PEL_NS_PER_WEEK + s->time_offset_s * PEL_NS_PER_S;
    const pel_time_t toe = eph->toe_ns - offset;
    const pel_time_t toc = eph->toc_ns - offset;
    const pel_time_t unit = s->toe_unit_s * PEL_NS_PER_S;

    if (toe < 0 || toc < 0 || t < offset || toe % unit != 0 || toc % unit != 0) { return false; }
    memset(raw, 0, sizeof *raw);
    raw->week = (uint32_t)(pel_time_week(t - offset) % s->week_modulo);
    raw->tow_s = (uint32_t)((t - offset) % PEL_NS_PER_WEEK / PEL_NS_PER_S);
    raw->toe = (uint32_t)(toe % PEL_NS_PER_WEEK / unit);
    raw->toc = (uint32_t)(toc % PEL_NS_PER_WEEK / unit);
    raw->ura = accuracy_index(eph->sys, eph->sd_ura_m);
    raw->health = eph->health;
    raw->iode = eph->iode;
    raw->iodc = eph->iodc;
    raw->fit = (eph->fit_s > 7200.0f) ? 1u : 0u;
    raw->prn = eph->prn;
    return true;
}

void pel_bits_copy(uint8_t *to, size_t to_pos, const uint8_t *from, size_t from_pos, size_t n_bits)
{
    for (size_t i = 0; i < n_bits; i += 32u) {
        const unsigned take = (n_bits - i < 32u) ? (unsigned)(n_bits - i) : 32u;
        pel_bits_put(to, to_pos + i, take, pel_bits_u(from, from_pos + i, take));
    }
}

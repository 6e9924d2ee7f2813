#include "navmsg.h"

#include <string.h>

/* ICD GLONASS 5.1, tables 4.5, 4.6 and 4.13; the same fields in RTCM 10403 message 1020. */

#define DAY_S        INT64_C(86400)
#define DAY_NS       (DAY_S * PEL_NS_PER_S)
#define MOSCOW_S     10800 /* GLONASS time is UTC(SU) + 3 h */
#define FOUR_YEARS_D 1461 /* N_T counts from 1 January of a leap year; 1980 is one, and GPS time began on its 6th day */
#define TB_S         900
#define FIT_S        1200.0f
#define MAX_AWAY_D   4

/* ---- time -------------------------------------------------------------------------------------------------------------- */

pel_time_t pel_moscow_from_gps(pel_time_t t)
{
    return t + (MOSCOW_S - pel_time_leap_s(t)) * PEL_NS_PER_S;
}

pel_time_t pel_gps_from_moscow(pel_time_t moscow)
{
    const pel_time_t utc = moscow - MOSCOW_S * PEL_NS_PER_S;
    return utc + pel_time_leap_s(utc + pel_time_leap_s(utc) * PEL_NS_PER_S) * PEL_NS_PER_S;
}

/* The time with this time of day nearest to ref, both of Moscow. */
static pel_time_t time_of_day_near(int64_t ns_of_day, pel_time_t ref)
{
    pel_time_t t = ref - ref % DAY_NS + ns_of_day;
    if (t - ref > DAY_NS / 2) { t -= DAY_NS; }
    if (ref - t > DAY_NS / 2) { t += DAY_NS; }
    return t;
}

pel_time_t pel_glo_epoch_near(unsigned day_of_week, uint32_t ms_of_day, pel_time_t t_ref)
{
    const pel_time_t ref = pel_moscow_from_gps(t_ref);
    if (day_of_week < 7u) { return pel_gps_from_moscow(pel_tow_ms_near(86400000u * day_of_week + ms_of_day, ref)); }
    return pel_gps_from_moscow(time_of_day_near((int64_t)ms_of_day * PEL_NS_PER_MS, ref));
}

/* ---- raw fields and ephemeris -------------------------------------------------------------------------------------------- */

/* F_T, ICD table 4.4; what does not tell it is taken as 4 m. */
static const float ACCURACY_M[16] = {1.0f,  2.0f,  2.5f,  4.0f,  5.0f,   7.0f,   10.0f,  12.0f,
                                     14.0f, 16.0f, 32.0f, 64.0f, 128.0f, 256.0f, 512.0f, 6144.0f};
#define ACCURACY_UNKNOWN 3u

/* The day (of Moscow, since 1980-01-06) with number n_t of its four years, nearest to the reference. */
static int64_t day_near(uint32_t n_t, int64_t ref_d)
{
    const int64_t there = (ref_d + 5) % FOUR_YEARS_D + 1;
    int64_t d = ((int64_t)n_t - there) % FOUR_YEARS_D;
    if (d > FOUR_YEARS_D / 2) { d -= FOUR_YEARS_D; }
    if (d < -FOUR_YEARS_D / 2) { d += FOUR_YEARS_D; }
    return ref_d + d;
}

static bool orbit_possible(const pel_ephemeris_t *e)
{
    double r_sq = 0.0;
    double v_sq = 0.0;
    for (int i = 0; i < 3; i++) {
        r_sq += e->glo.r_e[i] * e->glo.r_e[i];
        v_sq += e->glo.v_e[i] * e->glo.v_e[i];
    }
    return r_sq > 2.4e7 * 2.4e7 && r_sq < 2.7e7 * 2.7e7 && v_sq > 2e3 * 2e3 && v_sq < 5e3 * 5e3 && e->glo.k >= -7 &&
           e->glo.k <= 6 && e->prn >= 1 && e->prn <= pel_sys_max_prn(PEL_SYS_GLO);
}

bool pel_glo_from_raw(pel_ephemeris_t *eph, const pel_glo_raw_t *raw, pel_time_t t_ref)
{
    pel_time_t sent = pel_moscow_from_gps(t_ref);
    eph->sys = PEL_SYS_GLO;
    eph->prn = (uint8_t)raw->slot;
    if (!orbit_possible(eph) || raw->t_k >= DAY_S || raw->t_b * TB_S >= DAY_S || raw->n_t > FOUR_YEARS_D) {
        return false;
    }
    if (raw->n_t != 0u) {
        const int64_t ref_d = sent / DAY_NS;
        const int64_t away = day_near(raw->n_t, ref_d) - ref_d;
        if (away <= MAX_AWAY_D && away >= -MAX_AWAY_D) { /* there are senders with a number of another week */
            sent = ((ref_d + away) * DAY_S + (int64_t)raw->t_k) * PEL_NS_PER_S;
        }
    }
    eph->toe_ns = pel_gps_from_moscow(time_of_day_near((int64_t)raw->t_b * TB_S * PEL_NS_PER_S, sent));
    eph->toc_ns = eph->toe_ns;
    eph->iode = (uint16_t)raw->t_b;
    eph->iodc = eph->iode;
    eph->health = (raw->unhealthy != 0u || raw->l_n != 0u) ? 1 : 0;
    eph->sd_ura_m = ACCURACY_M[(raw->m != 0u) ? (raw->f_t & 15u) : ACCURACY_UNKNOWN];
    eph->fit_s = FIT_S;
    return true;
}

bool pel_glo_to_raw(const pel_ephemeris_t *eph, pel_time_t t, pel_glo_raw_t *raw)
{
    const pel_time_t toe = pel_moscow_from_gps(eph->toe_ns);
    const pel_time_t sent = pel_moscow_from_gps(t);
    if (!orbit_possible(eph) || toe < DAY_NS || sent < DAY_NS || toe % (TB_S * PEL_NS_PER_S) != 0) { return false; }
    memset(raw, 0, sizeof *raw);
    raw->slot = eph->prn;
    raw->t_b = (uint32_t)(toe % DAY_NS / (TB_S * PEL_NS_PER_S));
    raw->t_k = (uint32_t)(sent % DAY_NS / (30 * PEL_NS_PER_S) * 30);
    raw->n_t = (uint32_t)((sent / DAY_NS + 5) % FOUR_YEARS_D + 1);
    raw->unhealthy = (eph->health != 0u) ? 1u : 0u;
    raw->m = 1;
    while (raw->f_t < 15u && ACCURACY_M[raw->f_t] < eph->sd_ura_m) { raw->f_t++; }
    return true;
}

/* ---- layouts ---------------------------------------------------------------------------------------------------------------- */

/* Sign and magnitude, as every signed number of GLONASS. */
static void signed_field(pel_bitio_t *io, unsigned n_bits, double unit, double *v)
{
    if (!io->writing) {
        *v = (double)pel_read_sm(&io->r, n_bits) * unit;
        return;
    }
    const int64_t raw = pel_round_i64(*v / unit);
    pel_write_u(&io->w, 1, (raw < 0) ? 1u : 0u);
    pel_write_u(&io->w, n_bits - 1u, (uint64_t)((raw < 0) ? -raw : raw));
}

static void clock_field(pel_bitio_t *io, pel_ephemeris_t *e)
{
    double tau = -e->af0;
    signed_field(io, 22, pel_pow2(-30), &tau);
    e->af0 = -tau;
}

/* Hour, minute, half of it. */
static void frame_time(pel_bitio_t *io, pel_glo_raw_t *raw)
{
    uint32_t hour = raw->t_k / 3600u;
    uint32_t minute = raw->t_k / 60u % 60u;
    uint32_t half = raw->t_k / 30u % 2u;
    pel_io_u(io, 5, &hour);
    pel_io_u(io, 6, &minute);
    pel_io_u(io, 1, &half);
    raw->t_k = 3600u * hour + 60u * minute + 30u * half;
}

static void velocity(pel_bitio_t *io, pel_ephemeris_t *e, int axis)
{
    signed_field(io, 24, 1e3 * pel_pow2(-20), &e->glo.v_e[axis]);
}

static void position(pel_bitio_t *io, pel_ephemeris_t *e, int axis)
{
    signed_field(io, 27, 1e3 * pel_pow2(-11), &e->glo.r_e[axis]);
}

static void acceleration(pel_bitio_t *io, pel_ephemeris_t *e, int axis)
{
    signed_field(io, 5, 1e3 * pel_pow2(-30), &e->glo.a_e[axis]);
}

static void string_4(pel_bitio_t *io, pel_ephemeris_t *e, pel_glo_raw_t *raw)
{
    clock_field(io, e);
    signed_field(io, 5, pel_pow2(-30), &e->tgd_s[0]);
    pel_io_fill(io, 5 + 14 + 1, 0); /* E_n, reserved, P4 */
    pel_io_u(io, 4, &raw->f_t);
    pel_io_fill(io, 3, 0);
    pel_io_u(io, 11, &raw->n_t);
    pel_io_u(io, 5, &raw->slot);
    pel_io_u(io, 2, &raw->m);
}

void pel_glo_string_fields(pel_bitio_t *io, int string, pel_ephemeris_t *eph, pel_glo_raw_t *raw)
{
    pel_io_fill(io, 1, 0);
    raw->part = io->writing ? (uint32_t)string : 0u;
    pel_io_u(io, 4, &raw->part);
    if (string == 1) {
        pel_io_fill(io, 4, 1); /* reserved, P1: half-hourly */
        frame_time(io, raw);
    } else if (string == 2) {
        pel_io_u(io, 1, &raw->unhealthy); /* first bit of B_n; the others are the control segment's */
        pel_io_fill(io, 2 + 1, 0);
        pel_io_u(io, 7, &raw->t_b);
        pel_io_fill(io, 5, 0);
    } else if (string == 3) {
        pel_io_fill(io, 1, 0);
        signed_field(io, 11, pel_pow2(-40), &eph->af1);
        pel_io_fill(io, 1 + 2, 0);
        pel_io_u(io, 1, &raw->l_n);
    } else {
        string_4(io, eph, raw);
        return;
    }
    velocity(io, eph, string - 1);
    acceleration(io, eph, string - 1);
    position(io, eph, string - 1);
}

void pel_glo_1020_fields(pel_bitio_t *io, pel_ephemeris_t *e, pel_glo_raw_t *raw)
{
    uint32_t channel = (uint32_t)(e->glo.k + 7);
    pel_io_u(io, 6, &raw->slot);
    pel_io_u(io, 5, &channel);
    pel_io_fill(io, 2 + 2, 0); /* almanac health, P1 */
    frame_time(io, raw);
    pel_io_u(io, 1, &raw->unhealthy);
    pel_io_fill(io, 1, 0);
    pel_io_u(io, 7, &raw->t_b);
    for (int axis = 0; axis < 3; axis++) {
        velocity(io, e, axis);
        position(io, e, axis);
        acceleration(io, e, axis);
    }
    pel_io_fill(io, 1, 0);
    signed_field(io, 11, pel_pow2(-40), &e->af1);
    pel_io_fill(io, 2, 0);
    pel_io_u(io, 1, &raw->l_n);
    clock_field(io, e);
    signed_field(io, 5, pel_pow2(-30), &e->tgd_s[0]);
    pel_io_fill(io, 5 + 1, 0); /* E_n, P4 */
    pel_io_u(io, 4, &raw->f_t);
    pel_io_u(io, 11, &raw->n_t);
    pel_io_u(io, 2, &raw->m);
    pel_io_fill(io, 1 + 11 + 32 + 5 + 22 + 1 + 7, 0); /* no additional data */
    e->glo.k = (int8_t)((channel <= 20u) ? (int)channel - 7 : 127);
}

/* ---- parity ------------------------------------------------------------------------------------------------------------------ */

/* ICD table 4.13 is a Hamming code: data bits 9 to 85 have the places 3, 5, 6, 7, 9, ... that are no power of two, check
 * bit i is the parity of the places with bit i - 1 set, and check bit 8 makes the whole string even. Returns the check bits. */
static uint8_t check_bits(const uint8_t *string)
{
    unsigned places = 0;
    unsigned ones = 0;
    unsigned place = 2;
    for (unsigned b = 9; b <= 85u; b++) {
        place++;
        if ((place & (place - 1u)) == 0u) { place++; }
        if (pel_bits_u(string, 85u - b, 1) == 0u) { continue; }
        places ^= place;
        ones++;
    }
    for (unsigned i = 0; i < 7u; i++) { ones += (places >> i) & 1u; }
    return (uint8_t)(places | ((ones & 1u) << 7));
}

bool pel_glo_string_good(const uint8_t *string)
{
    return pel_bits_u(string, 77, 8) == check_bits(string);
}

void pel_glo_string_seal(uint8_t *string)
{
    pel_bits_put(string, 77, 8, check_bits(string));
}

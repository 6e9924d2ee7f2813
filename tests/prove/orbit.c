/* Proof of what becomes of an ephemeris's fields. Times are those base/time.c promises for the weeks it is asked. */
#include "navmsg.h"

#include "prove.h"

static pel_time_t any_time(void)
{
    const pel_time_t t = any_i64();
    assume(t >= 0 && t < PEL_TIME_LAST);
    return t;
}

pel_time_t pel_time_from_week(int32_t week, double tow_s)
{
    (void)tow_s;
    claim(week >= PEL_WEEK_FIRST && week <= PEL_WEEK_LAST);
    return any_time();
}

pel_time_t pel_time_from_tow_near(double tow_s, pel_time_t ref_ns)
{
    (void)tow_s;
    claim(ref_ns > -PEL_NS_PER_WEEK && ref_ns < PEL_TIME_LAST);
    return any_time();
}

int32_t pel_time_full_week(int32_t week_truncated, int32_t modulo, pel_time_t ref_ns)
{
    const int32_t week = any_i32();
    (void)ref_ns;
    assume(week >= -modulo && week <= 6001 + modulo && (week - week_truncated) % modulo == 0);
    return week;
}

/* PROVE eph_from_raw: message fields of any value become an orbit of a possible week, or are refused
 * sources wire/navmsg.c base/bits.c base/signals.c
 * flags --any-floats --unwind 12 -DPEL_MAX_OBS=8 -DPEL_NAV_SLOTS=4
 * plant wire/navmsg.c: if (week < PEL_WEEK_FIRST || week > PEL_WEEK_LAST) { return false; } => (void)week; */
void eph_from_raw(void)
{
    pel_ephemeris_t eph;
    pel_nav_raw_t raw;
    assume(raw.toe < 1u << 17 && raw.toc < 1u << 17 && raw.tow_s < 1u << 20 && raw.week < 1u << 13);
    if (pel_eph_from_raw(&eph, &raw, any_bool(), any_time())) { claim(eph.prn >= 1 && eph.sys < PEL_N_SYS); }
}

/* Proofs of base/time.c and base/signals.c. */
#include "pelorus/base.h"
#include "prove.h"

#define FAR (INT64_C(1) << 62) /* 146 years */

/* PROVE time_from_week: weeks to the year 2160 and seconds of ten years do not overflow
 * sources base/time.c
 * flags --unwind 20
 * plant base/time.c: (int64_t)week * PEL_NS_PER_WEEK + whole_s => week * (int32_t)604800 + whole_s */
void time_from_week(void)
{
    const int32_t week = any_i32();
    const double tow_s = any_double();
    assume(week >= -9400 && week <= 9400 && tow_s >= -3e8 && tow_s <= 3e8);
    (void)pel_time_from_week(week, tow_s);
}

/* PROVE time_diff: differences of any two numbers do not overflow
 * sources base/time.c
 * flags --unwind 20
 * plant base/time.c: (int64_t)((uint64_t)a_ns - (uint64_t)b_ns) => a_ns - b_ns */
void time_diff(void)
{
    (void)pel_time_diff_s(any_i64(), any_i64());
}

/* PROVE full_week: a truncated week becomes the nearest one with the same remainder
 * sources base/time.c
 * flags --unwind 20
 * plant base/time.c: if (d < -modulo / 2) { => if (d < -modulo) { */
void full_week(void)
{
    const pel_time_t ref = any_i64();
    const int32_t sent = any_i32();
    const int which = any_int();
    const int32_t modulo = (which == 0) ? 1024 : (which == 1) ? 4096 : 8192;
    assume(ref > -FAR && ref < FAR && sent >= 0 && sent < modulo);
    const int32_t week = pel_time_full_week(sent, modulo, ref);
    const int32_t off = week - pel_time_week(ref);
    claim(off >= -modulo / 2 && off <= modulo / 2);
    claim((week - sent) % modulo == 0);
}

/* PROVE leap_s: any time has between 0 and 18 leap seconds
 * sources base/time.c
 * flags --unwind 20
 * quick
 * plant base/time.c: i < sizeof LEAP_AT_S / sizeof LEAP_AT_S[0] => i <= sizeof LEAP_AT_S / sizeof LEAP_AT_S[0] */
void leap_s(void)
{
    const int32_t leap = pel_time_leap_s(any_i64());
    claim(leap >= 0 && leap <= 18);
}

/* PROVE carrier_hz: any numbers for system, carrier and channel give a frequency or 0
 * sources base/signals.c
 * flags --unwind 4
 * quick
 * plant base/signals.c: (unsigned)carrier >= PEL_N_CARRIER) { return 0.0; } => (unsigned)carrier > PEL_N_CARRIER) { return 0.0; } */
void carrier_hz(void)
{
    const double f = pel_carrier_hz((pel_sys_t)any_u32(), (pel_carrier_t)any_u32(), any_int());
    claim(f == 0.0 || (f > 1.1e9 && f < 1.7e9));
}

/* PROVE sys_tables: any number for a system is answered within the tables
 * sources base/signals.c
 * flags --unwind 4
 * quick
 * plant base/signals.c: ((unsigned)sys < PEL_N_SYS) ? MAX_PRN[sys] : 0 => MAX_PRN[sys] */
void sys_tables(void)
{
    const int most = pel_sys_max_prn((pel_sys_t)any_u32());
    claim(most >= 0 && most <= 63);
    (void)pel_sys_letter((pel_sys_t)any_u32());
}

/* INSTEAD pel_time_week, pel_time_tow_s, pel_time_from_tow_near: a 64-bit division by 604 800 000 000 000 is too hard for the solver | ubx_pvt, rtcm3_ephemeris */

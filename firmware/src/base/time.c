#include "pelorus/base.h"

/* GPS seconds at which GPS - UTC became i + 1 (IERS Bulletin C; 1981-07-01 .. 2017-01-01). */
static const int64_t LEAP_AT_S[] = {
    46828801,  78364802,  109900803, 173059204, 252028805, 315187206, 346723207,  393984008,  425520009,
    457056010, 504489611, 551750412, 599184013, 820108814, 914803215, 1025136016, 1119744017, 1167264018,
};

pel_time_t pel_time_from_week(int32_t week, double tow_s)
{
    /* Split first: a double second of week resolves 1.2e-10 s, the product with 1e9 would round again. */
    const int64_t whole_s = (int64_t)tow_s;
    const double ns = (tow_s - (double)whole_s) * 1e9;
    const int64_t frac_ns = (int64_t)((ns >= 0.0) ? (ns + 0.5) : (ns - 0.5));
    return (int64_t)week * PEL_NS_PER_WEEK + whole_s * PEL_NS_PER_S + frac_ns;
}

int32_t pel_time_week(pel_time_t t_ns)
{
    int64_t week = t_ns / PEL_NS_PER_WEEK;
    if (week * PEL_NS_PER_WEEK > t_ns) { week--; }
    return (int32_t)week;
}

double pel_time_tow_s(pel_time_t t_ns)
{
    const int64_t in_week = t_ns - (int64_t)pel_time_week(t_ns) * PEL_NS_PER_WEEK;
    const int64_t whole_s = in_week / PEL_NS_PER_S;
    return (double)whole_s + (double)(in_week - whole_s * PEL_NS_PER_S) * 1e-9;
}

double pel_time_diff_s(pel_time_t a_ns, pel_time_t b_ns)
{
    const int64_t d = (int64_t)((uint64_t)a_ns - (uint64_t)b_ns); /* of any two numbers: memory may change by itself */
    /* Most spans are short: the same number without a division of 64 bits. */
    if (d > -PEL_NS_PER_S && d < PEL_NS_PER_S) { return (double)(int32_t)d * 1e-9; }
    const int64_t whole_s = d / PEL_NS_PER_S;
    return (double)whole_s + (double)(d - whole_s * PEL_NS_PER_S) * 1e-9;
}

pel_time_t pel_time_from_tow_near(double tow_s, pel_time_t ref_ns)
{
    pel_time_t t = pel_time_from_week(pel_time_week(ref_ns), tow_s);
    if (t - ref_ns > PEL_NS_PER_WEEK / 2) {
        t -= PEL_NS_PER_WEEK;
    } else if (ref_ns - t > PEL_NS_PER_WEEK / 2) {
        t += PEL_NS_PER_WEEK;
    }
    return t;
}

int32_t pel_time_full_week(int32_t week_truncated, int32_t modulo, pel_time_t ref_ns)
{
    const int32_t ref = pel_time_week(ref_ns);
    int32_t d = (week_truncated - ref) % modulo;
    if (d < -modulo / 2) {
        d += modulo;
    } else if (d >= modulo / 2) {
        d -= modulo;
    }
    return ref + d;
}

int32_t pel_time_leap_s(pel_time_t t_ns)
{
    const int64_t t_s = t_ns / PEL_NS_PER_S;
    int32_t leap = 0;
    for (size_t i = 0; i < sizeof LEAP_AT_S / sizeof LEAP_AT_S[0]; i++) {
        if (t_s >= LEAP_AT_S[i]) { leap = (int32_t)i + 1; }
    }
    return leap;
}

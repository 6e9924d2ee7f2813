#include "support_sfrbx.h"

#include <string.h>

#include "../../../firmware/src/wire/framing.h"
#include "unity.h"

void sfrbx_begin(sfrbx_bench_t *b)
{
    pel_receiver_init(&b->rx);
    pel_receiver_set_time(&b->rx, T0);
    b->payload = b->frame + 6;
}

void sfrbx_expect(const sfrbx_bench_t *b, uint32_t unknown, uint32_t bad_length, uint32_t bad_value, uint32_t overflow)
{
    TEST_ASSERT_EQUAL_UINT32(unknown, b->rx.counters.unknown);
    TEST_ASSERT_EQUAL_UINT32(bad_length, b->rx.counters.bad_length);
    TEST_ASSERT_EQUAL_UINT32(bad_value, b->rx.counters.bad_value);
    TEST_ASSERT_EQUAL_UINT32(overflow, b->rx.counters.overflow);
}

pel_ephemeris_t sfrbx_ephemeris(pel_sys_t sys, int prn)
{
    pel_ephemeris_t e;
    support_ephemeris(&e, sys, prn);
    if (sys == PEL_SYS_GLO) {
        e.toe_ns = e.toc_ns = T0 + 18 * PEL_NS_PER_S; /* a quarter of an hour of UTC */
        e.af0 = e.af1 = e.tgd_s[0] = 0.0;
        memset(&e.glo, 0, sizeof e.glo);
        e.glo.r_e[0] = 2.55e7;
        e.glo.v_e[1] = 3.5e3;
    }
    return e;
}

size_t sfrbx_part(sfrbx_bench_t *b, pel_sys_t sys, int prn, int part)
{
    const pel_ephemeris_t e = sfrbx_ephemeris(sys, prn);
    const size_t n = pel_ubx_encode_sfrbx_eph(&e, part, T0, b->frame, sizeof b->frame);
    TEST_ASSERT_GREATER_THAN_size_t(0, n);
    return n;
}

void sfrbx_put(sfrbx_bench_t *b, int i, unsigned shift, unsigned n, uint32_t value)
{
    uint8_t *const p = b->payload + 8 + 4 * i;
    const uint32_t mask = ((UINT32_C(1) << n) - 1u) << shift;
    pel_le_put(p, 4, ((uint32_t)pel_le_u(p, 4) & ~mask) | (value << shift & mask));
}

int sfrbx_push(sfrbx_bench_t *b, size_t n)
{
    TEST_ASSERT_EQUAL_size_t(n, pel_ubx_seal(2, 0x13, n - 8u, b->frame, sizeof b->frame));
    return support_push(&b->rx, b->frame, n, PEL_RX_EPHEMERIS);
}

int sfrbx_push_all_but(sfrbx_bench_t *b, pel_sys_t sys, int prn, int except)
{
    const pel_ephemeris_t e = sfrbx_ephemeris(sys, prn);
    int events = 0;
    for (int part = 1; part <= pel_ubx_sfrbx_parts(&e); part++) {
        if (part != except) { events += sfrbx_push(b, sfrbx_part(b, sys, prn, part)); }
    }
    return events;
}

/* Checksums against their bitwise definitions and published check values; bit fields against one-bit-at-a-time code. */
#include <string.h>

#include "pelorus/bits.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static uint32_t seed = 12345;
static uint32_t random_u32(void)
{
    seed = seed * 1664525u + 1013904223u;
    return seed;
}

static void crc24q_of_the_check_string(void)
{
    TEST_ASSERT_EQUAL_HEX32(0xCDE703, pel_crc24q(0, (const uint8_t *)"123456789", 9));
}

static void crc24q_equals_its_polynomial(void)
{
    uint8_t p[64];
    for (size_t i = 0; i < sizeof p; i++) { p[i] = (uint8_t)(random_u32() >> 24); }
    uint32_t crc = 0;
    for (size_t i = 0; i < sizeof p; i++) {
        crc ^= (uint32_t)p[i] << 16;
        for (int k = 0; k < 8; k++) { crc = (crc & 0x800000u) ? (crc << 1) ^ 0x1864CFBu : crc << 1; }
    }
    TEST_ASSERT_EQUAL_HEX32(crc & 0xFFFFFFu, pel_crc24q(0, p, sizeof p));
    TEST_ASSERT_EQUAL_HEX32(crc & 0xFFFFFFu, pel_crc24q(pel_crc24q(0, p, 20), p + 20, sizeof p - 20));
}

static void fnv1a_of_a_published_vector(void)
{
    TEST_ASSERT_EQUAL_HEX32(0xbf9cf968u, pel_fnv1a("foobar", 6, PEL_FNV_START));
    TEST_ASSERT_EQUAL_HEX32(0xbf9cf968u, pel_fnv1a("bar", 3, pel_fnv1a("foo", 3, PEL_FNV_START)));
}

static void crc32_equals_its_polynomial(void)
{
    uint8_t p[64];
    for (size_t i = 0; i < sizeof p; i++) { p[i] = (uint8_t)(random_u32() >> 24); }
    uint32_t crc = 0;
    for (size_t i = 0; i < sizeof p; i++) {
        crc ^= p[i];
        for (int k = 0; k < 8; k++) { crc = (crc & 1u) ? (crc >> 1) ^ 0xEDB88320u : crc >> 1; }
    }
    TEST_ASSERT_EQUAL_HEX32(crc, pel_crc32_novatel(p, sizeof p));
}

/* UBX-ACK-ACK of CFG-MSG, as printed in u-blox application notes: B5 62 05 01 02 00 06 01 0F 38. */
static void fletcher_of_an_acknowledge(void)
{
    const uint8_t p[] = {0x05, 0x01, 0x02, 0x00, 0x06, 0x01};
    TEST_ASSERT_EQUAL_HEX16(0x0F38, pel_fletcher8(p, sizeof p));
}

static uint64_t slow_bits(const uint8_t *p, size_t pos, unsigned n)
{
    uint64_t v = 0;
    for (size_t i = pos; i < pos + n; i++) { v = (v << 1) | ((p[i / 8] >> (7 - i % 8)) & 1u); }
    return v;
}

static void fields_at_any_position_and_width(void)
{
    for (int round = 0; round < 20000; round++) {
        uint8_t p[24];
        for (size_t i = 0; i < sizeof p; i++) { p[i] = (uint8_t)(random_u32() >> 24); }
        uint8_t before[24];
        memcpy(before, p, sizeof p);
        const size_t pos = random_u32() % 100u;
        const unsigned n = 1u + (random_u32() >> 8) % 64u;
        TEST_ASSERT_EQUAL_HEX64(slow_bits(p, pos, n), pel_bits_u(p, pos, n));
        const uint64_t value = ((uint64_t)random_u32() << 32) | random_u32();
        pel_bits_put(p, pos, n, value);
        TEST_ASSERT_EQUAL_HEX64((n < 64u) ? value & ((UINT64_C(1) << n) - 1u) : value, slow_bits(p, pos, n));
        for (size_t i = 0; i < 8u * sizeof p; i++) { /* and nothing beside the field */
            if (i < pos || i >= pos + n) { TEST_ASSERT_EQUAL(slow_bits(before, i, 1), slow_bits(p, i, 1)); }
        }
    }
}

static void signs(void)
{
    const uint8_t p[] = {0xFF, 0x80, 0x01};
    pel_bit_reader_t r;
    TEST_ASSERT_EQUAL_INT64(-1, pel_bits_s(p, 0, 8));
    TEST_ASSERT_EQUAL_INT64(-128, pel_bits_s(p, 8, 8));
    TEST_ASSERT_EQUAL_INT64(1, pel_bits_s(p, 16, 8));
    pel_bit_reader_init(&r, p, sizeof p);
    TEST_ASSERT_EQUAL_INT64(-127, pel_read_sm(&r, 8));
    TEST_ASSERT_EQUAL_INT64(0, pel_read_sm(&r, 8)); /* minus zero */
    TEST_ASSERT_EQUAL_INT64(1, pel_read_sm(&r, 8));
    TEST_ASSERT_FALSE(r.overrun);
    TEST_ASSERT_EQUAL_INT64(0, pel_read_s(&r, 1));
    TEST_ASSERT_TRUE(r.overrun);
}

/* Whatever is asked of a reader past its end gives 0, and it stays there: what fits behind a refused field is not read either. */
static void a_reader_never_leaves_its_buffer(void)
{
    const uint8_t p[] = {0xA5, 0xFF};
    pel_bit_reader_t r;
    pel_bit_reader_init(&r, p, sizeof p);
    TEST_ASSERT_EQUAL_HEX64(0xA5, pel_read_u(&r, 8));
    TEST_ASSERT_EQUAL_INT64(-1, pel_read_s(&r, 8)); /* to the last bit is inside */
    TEST_ASSERT_FALSE(r.overrun);
    for (int kind = 0; kind < 4; kind++) {
        pel_bit_reader_init(&r, p, sizeof p);
        pel_skip_bits(&r, 8);
        switch (kind) {
        case 0: TEST_ASSERT_EQUAL_HEX64(0, pel_read_u(&r, 9)); break;
        case 1: TEST_ASSERT_EQUAL_INT64(0, pel_read_s(&r, 9)); break;
        case 2: TEST_ASSERT_EQUAL_INT64(0, pel_read_sm(&r, 9)); break;
        default: pel_skip_bits(&r, SIZE_MAX); break;
        }
        TEST_ASSERT_TRUE(r.overrun);
        TEST_ASSERT_EQUAL_size_t(8, r.pos);
        TEST_ASSERT_EQUAL_HEX64(0, pel_read_u(&r, 8)); /* would fit */
        TEST_ASSERT_EQUAL_INT64(0, pel_read_s(&r, 8));
        TEST_ASSERT_EQUAL_INT64(0, pel_read_sm(&r, 8));
        TEST_ASSERT_EQUAL_size_t(8, r.pos);
    }
}

static void a_writer_that_ran_over_writes_nothing_more(void)
{
    uint8_t p[3] = {0, 0, 0x5A};
    pel_bit_writer_t w;
    pel_bit_writer_init(&w, p, 2);
    pel_write_u(&w, 12, 0xABC);
    pel_write_u(&w, 5, 0x1F); /* one bit too many */
    pel_write_u(&w, 4, 0xD);  /* would fit */
    TEST_ASSERT_TRUE(w.overrun);
    TEST_ASSERT_FALSE(w.out_of_range);
    TEST_ASSERT_EQUAL_HEX8(0xAB, p[0]);
    TEST_ASSERT_EQUAL_HEX8(0xC0, p[1]);
    TEST_ASSERT_EQUAL_HEX8(0x5A, p[2]);
}

/* Largest and smallest value of each width, and their neighbours outside. */
static void a_writer_tells_values_that_do_not_fit(void)
{
    uint8_t p[8];
    pel_bit_writer_t w;
    for (unsigned n = 1; n <= 64u; n++) {
        const uint64_t most_u = (n < 64u) ? (UINT64_C(1) << n) - 1u : UINT64_MAX;
        const int64_t most_s = (int64_t)(most_u >> 1);
        pel_bit_writer_init(&w, p, sizeof p);
        pel_write_u(&w, n, most_u);
        TEST_ASSERT_FALSE(w.out_of_range);
        TEST_ASSERT_EQUAL_HEX64(most_u, pel_bits_u(p, 0, n));
        const int64_t ends[] = {most_s, -most_s - 1};
        for (int k = 0; k < 2; k++) {
            pel_bit_writer_init(&w, p, sizeof p);
            pel_write_s(&w, n, ends[k]);
            TEST_ASSERT_FALSE(w.out_of_range);
            TEST_ASSERT_EQUAL_INT64(ends[k], pel_bits_s(p, 0, n));
        }
        if (n == 64u) { continue; } /* everything fits */
        pel_bit_writer_init(&w, p, sizeof p);
        pel_write_u(&w, n, most_u + 1u);
        TEST_ASSERT_TRUE(w.out_of_range);
        const int64_t beyond[] = {most_s + 1, -most_s - 2};
        for (int k = 0; k < 2; k++) {
            pel_bit_writer_init(&w, p, sizeof p);
            pel_write_s(&w, n, beyond[k]);
            TEST_ASSERT_TRUE(w.out_of_range);
        }
    }
}

static void a_writer_tells_overflow_and_range(void)
{
    uint8_t p[2];
    pel_bit_writer_t w;
    pel_bit_writer_init(&w, p, sizeof p);
    pel_write_s(&w, 4, -8);
    TEST_ASSERT_FALSE(w.out_of_range);
    pel_write_s(&w, 4, 8);
    TEST_ASSERT_TRUE(w.out_of_range);
    pel_write_u(&w, 9, 1);
    TEST_ASSERT_TRUE(w.overrun);
    TEST_ASSERT_EQUAL_size_t(8, w.pos);
}

static void little_endian_numbers(void)
{
    uint8_t p[8] = {0, 0, 0, 0, 0x5A};
    const double values[] = {0.0, -0.0, 1.0, -2.5, 1e-310, 1.7976931348623157e308};
    pel_le_put(p, 4, 0x01020304u);
    TEST_ASSERT_EQUAL_HEX8(0x04, p[0]);
    TEST_ASSERT_EQUAL_HEX8(0x01, p[3]);
    TEST_ASSERT_EQUAL_HEX8(0x5A, p[4]);
    pel_le_put(p, 4, (uint64_t)INT64_C(-5));
    TEST_ASSERT_EQUAL_INT64(-5, pel_le_s(p, 4));
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        pel_le_put_f64(p, values[i]);
        const double back = pel_le_f64(p);
        TEST_ASSERT_EQUAL_MEMORY(&values[i], &back, sizeof back);
    }
    pel_le_put_f32(p, 1.0f);
    TEST_ASSERT_EQUAL_HEX32(0x3F800000u, (uint32_t)pel_le_u(p, 4));
    TEST_ASSERT_EQUAL_FLOAT(1.0f, pel_le_f32(p));
}

/* Members of each size go out in the table's order, lowest byte first, without the struct's padding; and come back into theirs alone. */
static void members_of_a_struct_go_out_and_come_back(void)
{
    typedef struct {
        uint8_t u8;
        uint64_t u64;
        uint16_t u16[2];
        uint32_t u32;
        uint32_t not_sent;
    } members_t;
    static const pel_member_t TABLE[] = {PEL_MEMBER(members_t, u32), PEL_ARRAY(members_t, u16),
                                         PEL_MEMBER(members_t, u64), PEL_MEMBER(members_t, u8)};
    static const uint8_t EXPECTED[18] = {4,    3,    2,    1,    0xBB, 0xAA, 0xDD, 0xCC, 0x18,
                                         0x17, 0x16, 0x15, 0x14, 0x13, 0x12, 0x11, 0xEE, 0x5A};
    const members_t from = {
        .u8 = 0xEE, .u64 = UINT64_C(0x1112131415161718), .u16 = {0xAABB, 0xCCDD}, .u32 = 0x01020304, .not_sent = 7};
    members_t to = {.not_sent = 9};
    uint8_t p[18] = {[17] = 0x5A};
    TEST_ASSERT_EQUAL_size_t(17, pel_members_bytes(TABLE, 4));
    TEST_ASSERT_EQUAL_size_t(0, pel_members_bytes(TABLE, 0));
    TEST_ASSERT_EQUAL_size_t(17, pel_members_put(TABLE, 4, &from, p));
    TEST_ASSERT_EQUAL_HEX8_ARRAY(EXPECTED, p, sizeof p);
    TEST_ASSERT_EQUAL_size_t(17, pel_members_get(TABLE, 4, p, &to));
    TEST_ASSERT_EQUAL_HEX8(from.u8, to.u8);
    TEST_ASSERT_EQUAL_HEX64(from.u64, to.u64);
    TEST_ASSERT_EQUAL_HEX16(from.u16[0], to.u16[0]);
    TEST_ASSERT_EQUAL_HEX16(from.u16[1], to.u16[1]);
    TEST_ASSERT_EQUAL_HEX32(from.u32, to.u32);
    TEST_ASSERT_EQUAL_UINT32(9, to.not_sent);
}

static void rounding_and_powers(void)
{
    TEST_ASSERT_EQUAL_INT64(3, pel_round_i64(2.5));
    TEST_ASSERT_EQUAL_INT64(-3, pel_round_i64(-2.5));
    TEST_ASSERT_EQUAL_INT64(0, pel_round_i64(0.49999999999999994)); /* x + 0.5 would round to 1 */
    TEST_ASSERT_EQUAL_INT64(INT64_C(9007199254740993) - 1, pel_round_i64(9007199254740992.0));
    TEST_ASSERT_EQUAL_INT64(INT64_MIN, pel_round_i64(1e300));
    TEST_ASSERT_EQUAL_INT64(INT64_MIN, pel_round_i64(-1e300));
    TEST_ASSERT_EQUAL_INT64(INT64_MIN, pel_round_i64(0x1p62));
    TEST_ASSERT_EQUAL_INT64(INT64_MIN, pel_round_i64(-0x1p62));
    TEST_ASSERT_EQUAL_INT64((INT64_C(1) << 62) - 512, pel_round_i64(0x1p62 - 512.0));
    TEST_ASSERT_EQUAL_INT64(-(INT64_C(1) << 62) + 512, pel_round_i64(512.0 - 0x1p62));
    TEST_ASSERT_EQUAL_INT64(INT64_MIN, pel_round_i64(0.0 / (pel_pow2(0) - 1.0)));
    TEST_ASSERT_EQUAL_DOUBLE(1.0 / 1024.0, pel_pow2(-10));
    TEST_ASSERT_EQUAL_DOUBLE(8589934592.0, pel_pow2(33));
}

/* Each word turned in by five bits, and no flipped bit of any word unseen. */
static void word_check_sees_every_bit(void)
{
    uint32_t w[11];
    for (unsigned i = 0; i < 11; i++) { w[i] = 0x9E3779B9u * (i + 1u); }
    for (size_t n = 0; n <= 11; n++) {
        uint32_t h = 7;
        for (size_t i = 0; i < n; i++) { h = ((h << 5) | (h >> 27)) ^ w[i]; }
        TEST_ASSERT_EQUAL_HEX32(h, pel_word_check(w, 4 * n, 7));
        for (size_t bit = 0; bit < 32 * n; bit++) {
            w[bit / 32] ^= 1u << (bit % 32);
            TEST_ASSERT_TRUE(h != pel_word_check(w, 4 * n, 7));
            w[bit / 32] ^= 1u << (bit % 32);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(crc24q_of_the_check_string);
    RUN_TEST(crc24q_equals_its_polynomial);
    RUN_TEST(fnv1a_of_a_published_vector);
    RUN_TEST(crc32_equals_its_polynomial);
    RUN_TEST(word_check_sees_every_bit);
    RUN_TEST(fletcher_of_an_acknowledge);
    RUN_TEST(fields_at_any_position_and_width);
    RUN_TEST(signs);
    RUN_TEST(a_reader_never_leaves_its_buffer);
    RUN_TEST(a_writer_that_ran_over_writes_nothing_more);
    RUN_TEST(a_writer_tells_values_that_do_not_fit);
    RUN_TEST(a_writer_tells_overflow_and_range);
    RUN_TEST(little_endian_numbers);
    RUN_TEST(members_of_a_struct_go_out_and_come_back);
    RUN_TEST(rounding_and_powers);
    return UNITY_END();
}

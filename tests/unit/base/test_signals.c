/* Satellites and carriers: published frequencies, and nothing for what does not exist. */
#include "pelorus/base.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void carriers_have_their_published_frequencies(void)
{
    static const struct {
        pel_sys_t sys;
        pel_carrier_t carrier;
        int k;
        double hz;
    } CASE[] = {
        {PEL_SYS_GPS, PEL_CARRIER_L1, 0, 1575.42e6},    {PEL_SYS_GPS, PEL_CARRIER_L2, 0, 1227.60e6},
        {PEL_SYS_GPS, PEL_CARRIER_L5, 99, 1176.45e6}, /* a channel that means nothing here */
        {PEL_SYS_GAL, PEL_CARRIER_E5B, 0, 1207.14e6},   {PEL_SYS_GAL, PEL_CARRIER_E6, 0, 1278.75e6},
        {PEL_SYS_BDS, PEL_CARRIER_B1I, 0, 1561.098e6},  {PEL_SYS_BDS, PEL_CARRIER_B3I, 0, 1268.52e6},
        {PEL_SYS_GLO, PEL_CARRIER_L1, 0, 1602.0e6},     {PEL_SYS_GLO, PEL_CARRIER_L2, 0, 1246.0e6},
        {PEL_SYS_GLO, PEL_CARRIER_L1, -7, 1598.0625e6}, {PEL_SYS_GLO, PEL_CARRIER_L1, 6, 1605.375e6},
        {PEL_SYS_GLO, PEL_CARRIER_L2, -7, 1242.9375e6}, {PEL_SYS_GLO, PEL_CARRIER_L2, 6, 1248.625e6},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(CASE[i].hz, pel_carrier_hz(CASE[i].sys, CASE[i].carrier, CASE[i].k));
        TEST_ASSERT_EQUAL_DOUBLE(PEL_SPEED_OF_LIGHT / CASE[i].hz,
                                 pel_carrier_wavelength_m(CASE[i].sys, CASE[i].carrier, CASE[i].k));
    }
}

static void what_does_not_exist_has_neither_frequency_nor_wavelength(void)
{
    static const struct {
        pel_sys_t sys;
        pel_carrier_t carrier;
        int k;
    } CASE[] = {
        {PEL_N_SYS, PEL_CARRIER_L1, 0},      {(pel_sys_t)-1, PEL_CARRIER_L1, 0}, {PEL_SYS_GPS, PEL_N_CARRIER, 0},
        {PEL_SYS_GPS, (pel_carrier_t)-1, 0}, {PEL_SYS_GLO, PEL_CARRIER_L1, -8},  {PEL_SYS_GLO, PEL_CARRIER_L1, 7},
        {PEL_SYS_GLO, PEL_CARRIER_L5, 0}, /* no frequency of its own there */
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        TEST_ASSERT_EQUAL_DOUBLE(0.0, pel_carrier_hz(CASE[i].sys, CASE[i].carrier, CASE[i].k));
        TEST_ASSERT_EQUAL_DOUBLE(0.0, pel_carrier_wavelength_m(CASE[i].sys, CASE[i].carrier, CASE[i].k));
    }
}

static void systems_have_letters_and_a_last_satellite(void)
{
    static const struct {
        pel_sys_t sys;
        char letter;
        int max_prn;
    } CASE[] = {
        {PEL_SYS_GPS, 'G', 32}, {PEL_SYS_GLO, 'R', 32}, {PEL_SYS_GAL, 'E', 36}, {PEL_SYS_BDS, 'C', 63},
        {PEL_SYS_QZS, 'J', 10}, {PEL_SYS_SBS, 'S', 39}, {PEL_N_SYS, '?', 0},    {(pel_sys_t)-1, '?', 0},
    };
    for (size_t i = 0; i < sizeof CASE / sizeof CASE[0]; i++) {
        TEST_ASSERT_EQUAL_CHAR(CASE[i].letter, pel_sys_letter(CASE[i].sys));
        TEST_ASSERT_EQUAL_INT(CASE[i].max_prn, pel_sys_max_prn(CASE[i].sys));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(carriers_have_their_published_frequencies);
    RUN_TEST(what_does_not_exist_has_neither_frequency_nor_wavelength);
    RUN_TEST(systems_have_letters_and_a_last_satellite);
    return UNITY_END();
}

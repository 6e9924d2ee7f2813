#include "msm.h"

const pel_msm_kind_t *pel_msm_kind(int msm)
{
    static const pel_msm_kind_t KIND[4] = {
        {15, -24, 22, -29, 4, 6, 0, false},
        {15, -24, 22, -29, 4, 6, 0, true},
        {20, -29, 24, -31, 10, 10, -4, false},
        {20, -29, 24, -31, 10, 10, -4, true},
    };
    return (msm >= 4 && msm <= 7) ? &KIND[msm - 4] : NULL;
}

/* RTCM 10403 tables 3.5-91 (GPS), 3.5-96 (GLONASS), 3.5-99 (Galileo), 3.5-102 (SBAS), 3.5-105 (QZSS), 3.5-108 (BeiDou). */
typedef struct {
    uint8_t sys, id, carrier;
    char code;
} msm_signal_t;

static const msm_signal_t SIGNAL[] = {
    {PEL_SYS_GPS, 2, PEL_CARRIER_L1, 'C'},   {PEL_SYS_GPS, 3, PEL_CARRIER_L1, 'P'},
    {PEL_SYS_GPS, 4, PEL_CARRIER_L1, 'W'},   {PEL_SYS_GPS, 30, PEL_CARRIER_L1, 'S'},
    {PEL_SYS_GPS, 31, PEL_CARRIER_L1, 'L'},  {PEL_SYS_GPS, 32, PEL_CARRIER_L1, 'X'},
    {PEL_SYS_GPS, 8, PEL_CARRIER_L2, 'C'},   {PEL_SYS_GPS, 9, PEL_CARRIER_L2, 'P'},
    {PEL_SYS_GPS, 10, PEL_CARRIER_L2, 'W'},  {PEL_SYS_GPS, 15, PEL_CARRIER_L2, 'S'},
    {PEL_SYS_GPS, 16, PEL_CARRIER_L2, 'L'},  {PEL_SYS_GPS, 17, PEL_CARRIER_L2, 'X'},
    {PEL_SYS_GPS, 22, PEL_CARRIER_L5, 'I'},  {PEL_SYS_GPS, 23, PEL_CARRIER_L5, 'Q'},
    {PEL_SYS_GPS, 24, PEL_CARRIER_L5, 'X'},  {PEL_SYS_GAL, 2, PEL_CARRIER_L1, 'C'},
    {PEL_SYS_GAL, 3, PEL_CARRIER_L1, 'A'},   {PEL_SYS_GAL, 4, PEL_CARRIER_L1, 'B'},
    {PEL_SYS_GAL, 5, PEL_CARRIER_L1, 'X'},   {PEL_SYS_GAL, 6, PEL_CARRIER_L1, 'Z'},
    {PEL_SYS_GAL, 8, PEL_CARRIER_E6, 'C'},   {PEL_SYS_GAL, 9, PEL_CARRIER_E6, 'A'},
    {PEL_SYS_GAL, 10, PEL_CARRIER_E6, 'B'},  {PEL_SYS_GAL, 11, PEL_CARRIER_E6, 'X'},
    {PEL_SYS_GAL, 12, PEL_CARRIER_E6, 'Z'},  {PEL_SYS_GAL, 14, PEL_CARRIER_E5B, 'I'},
    {PEL_SYS_GAL, 15, PEL_CARRIER_E5B, 'Q'}, {PEL_SYS_GAL, 16, PEL_CARRIER_E5B, 'X'},
    {PEL_SYS_GAL, 22, PEL_CARRIER_L5, 'I'},  {PEL_SYS_GAL, 23, PEL_CARRIER_L5, 'Q'},
    {PEL_SYS_GAL, 24, PEL_CARRIER_L5, 'X'},  {PEL_SYS_QZS, 2, PEL_CARRIER_L1, 'C'},
    {PEL_SYS_QZS, 30, PEL_CARRIER_L1, 'S'},  {PEL_SYS_QZS, 31, PEL_CARRIER_L1, 'L'},
    {PEL_SYS_QZS, 32, PEL_CARRIER_L1, 'X'},  {PEL_SYS_QZS, 9, PEL_CARRIER_E6, 'S'},
    {PEL_SYS_QZS, 10, PEL_CARRIER_E6, 'L'},  {PEL_SYS_QZS, 11, PEL_CARRIER_E6, 'X'},
    {PEL_SYS_QZS, 15, PEL_CARRIER_L2, 'S'},  {PEL_SYS_QZS, 16, PEL_CARRIER_L2, 'L'},
    {PEL_SYS_QZS, 17, PEL_CARRIER_L2, 'X'},  {PEL_SYS_QZS, 22, PEL_CARRIER_L5, 'I'},
    {PEL_SYS_QZS, 23, PEL_CARRIER_L5, 'Q'},  {PEL_SYS_QZS, 24, PEL_CARRIER_L5, 'X'},
    {PEL_SYS_GLO, 2, PEL_CARRIER_L1, 'C'},   {PEL_SYS_GLO, 3, PEL_CARRIER_L1, 'P'},
    {PEL_SYS_GLO, 8, PEL_CARRIER_L2, 'C'},   {PEL_SYS_GLO, 9, PEL_CARRIER_L2, 'P'},
    {PEL_SYS_SBS, 2, PEL_CARRIER_L1, 'C'},   {PEL_SYS_SBS, 22, PEL_CARRIER_L5, 'I'},
    {PEL_SYS_SBS, 23, PEL_CARRIER_L5, 'Q'},  {PEL_SYS_SBS, 24, PEL_CARRIER_L5, 'X'},
    {PEL_SYS_BDS, 2, PEL_CARRIER_B1I, 'I'},  {PEL_SYS_BDS, 3, PEL_CARRIER_B1I, 'Q'},
    {PEL_SYS_BDS, 4, PEL_CARRIER_B1I, 'X'},  {PEL_SYS_BDS, 8, PEL_CARRIER_B3I, 'I'},
    {PEL_SYS_BDS, 9, PEL_CARRIER_B3I, 'Q'},  {PEL_SYS_BDS, 10, PEL_CARRIER_B3I, 'X'},
    {PEL_SYS_BDS, 14, PEL_CARRIER_E5B, 'I'}, {PEL_SYS_BDS, 15, PEL_CARRIER_E5B, 'Q'},
    {PEL_SYS_BDS, 16, PEL_CARRIER_E5B, 'X'}, {PEL_SYS_BDS, 22, PEL_CARRIER_L5, 'D'},
    {PEL_SYS_BDS, 23, PEL_CARRIER_L5, 'P'},  {PEL_SYS_BDS, 24, PEL_CARRIER_L5, 'X'},
    {PEL_SYS_BDS, 25, PEL_CARRIER_E5B, 'D'}, {PEL_SYS_BDS, 30, PEL_CARRIER_L1, 'D'},
    {PEL_SYS_BDS, 31, PEL_CARRIER_L1, 'P'},  {PEL_SYS_BDS, 32, PEL_CARRIER_L1, 'X'},
};
#define N_SIGNAL (sizeof SIGNAL / sizeof SIGNAL[0])

bool pel_msm_signal(pel_sys_t sys, int id, uint8_t *carrier, char *code)
{
    for (size_t i = 0; i < N_SIGNAL; i++) {
        if (SIGNAL[i].sys == sys && SIGNAL[i].id == id) {
            *carrier = SIGNAL[i].carrier;
            *code = SIGNAL[i].code;
            return true;
        }
    }
    return false;
}

int pel_msm_id(pel_sys_t sys, uint8_t carrier, char code)
{
    int other = 0;
    for (size_t i = 0; i < N_SIGNAL; i++) {
        if (SIGNAL[i].sys != sys || SIGNAL[i].carrier != carrier) { continue; }
        if (SIGNAL[i].code == code) { return SIGNAL[i].id; }
        if (other == 0) { other = SIGNAL[i].id; }
    }
    return other;
}

/* DF402: 0, then 2^(4 + i) ms. DF407: linear to 64, then 32 steps for each doubling, up to 704 for 2^26 ms. */
uint32_t pel_msm_lock_ms(unsigned bits, uint32_t indicator)
{
    if (bits == 4u) { return (indicator == 0u) ? 0u : UINT32_C(1) << (4u + indicator); }
    if (indicator < 64u) { return indicator; }
    if (indicator > 704u) { return 0; } /* reserved */
    const uint32_t block = indicator / 32u - 1u;
    return (indicator - 32u * block) << block;
}

uint32_t pel_msm_lock_indicator(unsigned bits, uint32_t lock_ms)
{
    uint32_t low = 0;
    uint32_t high = (bits == 4u) ? 15u : 704u;
    while (low < high) { /* the largest indicator that does not promise more; ten halvings at most */
        const uint32_t middle = (low + high + 1u) / 2u;
        if (pel_msm_lock_ms(bits, middle) <= lock_ms) {
            low = middle;
        } else {
            high = middle - 1u;
        }
    }
    return low;
}

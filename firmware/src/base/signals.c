#include "pelorus/base.h"

#define L1_HZ  1575.42e6
#define L2_HZ  1227.60e6
#define L5_HZ  1176.45e6
#define E5B_HZ 1207.14e6
#define E6_HZ  1278.75e6
#define B1I_HZ 1561.098e6
#define B3I_HZ 1268.52e6

static const double CARRIER_HZ[PEL_N_CARRIER] = {L1_HZ, L2_HZ, L5_HZ, E5B_HZ, E6_HZ, B1I_HZ, B3I_HZ};

#define LAMBDA_M(hz) (PEL_SPEED_OF_LIGHT / (hz))
static const double WAVELENGTH_M[PEL_N_CARRIER] = {
    LAMBDA_M(L1_HZ), LAMBDA_M(L2_HZ),  LAMBDA_M(L5_HZ),  LAMBDA_M(E5B_HZ),
    LAMBDA_M(E6_HZ), LAMBDA_M(B1I_HZ), LAMBDA_M(B3I_HZ),
};

double pel_carrier_hz(pel_sys_t sys, pel_carrier_t carrier, int glo_k)
{
    if ((unsigned)sys >= PEL_N_SYS || (unsigned)carrier >= PEL_N_CARRIER) { return 0.0; }
    if (sys == PEL_SYS_GLO) {
        if (glo_k < -7 || glo_k > 6) { return 0.0; }
        if (carrier == PEL_CARRIER_L1) { return 1602.0e6 + 0.5625e6 * (double)glo_k; }
        if (carrier == PEL_CARRIER_L2) { return 1246.0e6 + 0.4375e6 * (double)glo_k; }
        return 0.0;
    }
    return CARRIER_HZ[carrier];
}

double pel_carrier_wavelength_m(pel_sys_t sys, pel_carrier_t carrier, int glo_k)
{
    if (sys != PEL_SYS_GLO && (unsigned)sys < PEL_N_SYS && (unsigned)carrier < PEL_N_CARRIER) {
        return WAVELENGTH_M[carrier];
    }
    const double f_hz = pel_carrier_hz(sys, carrier, glo_k);
    return (f_hz > 0.0) ? PEL_SPEED_OF_LIGHT / f_hz : 0.0;
}

int pel_sys_max_prn(pel_sys_t sys)
{
    static const uint8_t MAX_PRN[PEL_N_SYS] = {32, 32, 36, 63, 10, 39};
    return ((unsigned)sys < PEL_N_SYS) ? MAX_PRN[sys] : 0;
}

char pel_sys_letter(pel_sys_t sys)
{
    static const char LETTER[PEL_N_SYS] = {'G', 'R', 'E', 'C', 'J', 'S'};
    return ((unsigned)sys < PEL_N_SYS) ? LETTER[sys] : '?';
}

#include "pelorus/base.h"

static const double CARRIER_HZ[PEL_N_CARRIER] = {
    1575.42e6, 1227.60e6, 1176.45e6, 1207.14e6, 1278.75e6, 1561.098e6, 1268.52e6,
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

#include "group_delay.h"

static double carrier_ratio_sq(pel_carrier_t carrier)
{
    const double f1 = pel_carrier_hz(PEL_SYS_GPS, PEL_CARRIER_L1, 0);
    const double f = pel_carrier_hz(PEL_SYS_GPS, carrier, 0);
    return (f1 * f1) / (f * f);
}

/* Galileo OS SIS ICD 5.1.5: the clock of I/NAV refers to the ionosphere-free pair E1/E5b, that of F/NAV to E1/E5a. With
 * BGD_x = (tau_E1 - tau_x) / (1 - ratio_x) and tau_E1 - ratio_x tau_x = 0 for the clock's own pair, the delay of any
 * carrier follows. */
static double galileo_delay(uint8_t source, double bgd_e5a, double bgd_e5b, pel_carrier_t carrier)
{
    const double tau_e1 = (source == 0) ? bgd_e5b : bgd_e5a;
    if (carrier == PEL_CARRIER_L5) { return tau_e1 + (carrier_ratio_sq(PEL_CARRIER_L5) - 1.0) * bgd_e5a; }
    if (carrier == PEL_CARRIER_E5B) { return tau_e1 + (carrier_ratio_sq(PEL_CARRIER_E5B) - 1.0) * bgd_e5b; }
    return (carrier == PEL_CARRIER_L1) ? tau_e1 : 0.0;
}

double pel_group_delay(uint8_t sys, uint8_t source, double tgd0, double tgd1, pel_carrier_t carrier)
{
    if ((unsigned)carrier >= PEL_N_CARRIER) { return 0.0; }
    if (sys == PEL_SYS_GPS || sys == PEL_SYS_QZS) {
        const bool given = carrier == PEL_CARRIER_L1 || carrier == PEL_CARRIER_L2 || carrier == PEL_CARRIER_L5;
        return given ? tgd0 * carrier_ratio_sq(carrier) : 0.0;
    }
    if (sys == PEL_SYS_GAL) { return galileo_delay(source, tgd0, tgd1, carrier); }
    if (sys == PEL_SYS_BDS) {
        if (carrier == PEL_CARRIER_B1I) { return tgd0; }
        return (carrier == PEL_CARRIER_E5B) ? tgd1 : 0.0;
    }
    return 0.0;
}

double pel_sat_group_delay_m(const pel_ephemeris_t *eph, pel_carrier_t carrier)
{
    return pel_group_delay(eph->sys, eph->source, PEL_SPEED_OF_LIGHT * eph->tgd_s[0],
                           PEL_SPEED_OF_LIGHT * eph->tgd_s[1], carrier);
}

#include "group_delay.h"

static double carrier_ratio_sq(pel_carrier_t carrier)
{
    const double f1 = pel_carrier_hz(PEL_SYS_GPS, PEL_CARRIER_L1, 0);
    const double f = pel_carrier_hz(PEL_SYS_GPS, carrier, 0);
    return (f1 * f1) / (f * f);
}

/* IS-GPS-200 20.3.3.3.3.2: the clock refers to the ionosphere-free P(Y) pair. L5's part is in ISC terms that LNAV does not
 * carry; in real data its delay follows TGD less than any multiple of it, so none is applied. */
static double legacy_delay(double tgd, pel_carrier_t carrier)
{
    return (carrier == PEL_CARRIER_L1 || carrier == PEL_CARRIER_L2) ? tgd * carrier_ratio_sq(carrier) : 0.0;
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

/* BDS-SIS-ICD-B1I 5.2.4.10: the clock refers to B3I. D1 and D2 say nothing of BeiDou-3's new signals: B1C leaves the
 * satellite as late as its neighbour B1I within a metre, B2a and B2b (in place of BeiDou-2's B2I) nearly with B3I. */
static double beidou_delay(uint8_t prn, double tgd1, double tgd2, pel_carrier_t carrier)
{
    const bool second_generation = prn <= 18;
    if (carrier == PEL_CARRIER_B1I || carrier == PEL_CARRIER_L1) { return tgd1; }
    return (carrier == PEL_CARRIER_E5B && second_generation) ? tgd2 : 0.0;
}

double pel_group_delay(uint8_t sys, uint8_t prn, uint8_t source, double tgd0, double tgd1, pel_carrier_t carrier)
{
    if ((unsigned)carrier >= PEL_N_CARRIER) { return 0.0; }
    if (sys == PEL_SYS_GPS || sys == PEL_SYS_QZS) { return legacy_delay(tgd0, carrier); }
    if (sys == PEL_SYS_GAL) { return galileo_delay(source, tgd0, tgd1, carrier); }
    if (sys == PEL_SYS_GLO) { return (carrier == PEL_CARRIER_L2) ? tgd0 : 0.0; } /* the clock refers to G1 */
    return (sys == PEL_SYS_BDS) ? beidou_delay(prn, tgd0, tgd1, carrier) : 0.0;
}

double pel_sat_group_delay_m(const pel_ephemeris_t *eph, pel_carrier_t carrier)
{
    return pel_group_delay(eph->sys, eph->prn, eph->source, PEL_SPEED_OF_LIGHT * eph->tgd_s[0],
                           PEL_SPEED_OF_LIGHT * eph->tgd_s[1], carrier);
}

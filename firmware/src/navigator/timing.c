/* timing.c - do the IMU's time tags hold? Its sequence numbers say how many samples are missing; tags that say otherwise are those of a
 * clock that jumped. A jump by a second would not stop the INS, it would make it wrong by a second of motion. */
#include "internal.h"

#include "pelorus/math.h"

#define TAG_TOLERANCE_S  0.05 /* between tags and sequence numbers */
#define LEAD_TOLERANCE_S 0.3  /* of the IMU before the rover's epochs, against what it was before the jump */
#define BELIEVED_AFTER_S 60.0 /* a clock that stays where it jumped to, as one that was set at start */
#define LEAD_WEIGHT      0.2

void pel_nav_doubt_imu_clock(pel_navigator_t *nav)
{
    nav->timing.doubted = nav->timing.have_lead;
    nav->timing.doubted_s = 0.0;
}

bool pel_nav_imu_clock_jumped(pel_navigator_t *nav, const pel_imu_t *imu, double gap_s)
{
    pel_timing_t *t = &nav->timing;
    const uint16_t step = (uint16_t)(imu->seq - t->seq);
    t->seq = imu->seq;
    if (step == 0) { return false; } /* a sender without sequence numbers */
    const double missing_s = (double)(step - 1) * imu->dt_s;
    if (nav->last_imu_ns == 0 || pel_fabs(gap_s - missing_s) < TAG_TOLERANCE_S + 0.5 * imu->dt_s) { return false; }
    if (step > UINT16_MAX / 2) { return false; } /* it began to count anew */
    pel_nav_doubt_imu_clock(nav);
    return true;
}

void pel_nav_note_lead(pel_navigator_t *nav, pel_time_t epoch_ns)
{
    pel_timing_t *t = &nav->timing;
    if (nav->last_imu_ns == 0) { return; }
    const double lead_s = pel_time_diff_s(nav->last_imu_ns, epoch_ns);
    if (!t->doubted) {
        if (!t->have_lead) { t->lead_s = lead_s; }
        /* An IMU that is silent or refused falls behind: that is not how far ahead it was. */
        if (pel_fabs(lead_s - t->lead_s) < LEAD_TOLERANCE_S) { t->lead_s += LEAD_WEIGHT * (lead_s - t->lead_s); }
        t->have_lead = true;
        return;
    }
    t->doubted_s += pel_min(10.0, pel_max(0.0, pel_time_diff_s(epoch_ns, t->epoch_ns)));
    t->epoch_ns = epoch_ns;
    if (pel_fabs(lead_s - t->lead_s) < LEAD_TOLERANCE_S || t->doubted_s > BELIEVED_AFTER_S) {
        t->doubted = false;
        t->have_lead = false;
    }
}

/* members.c - which member of the state a byte belongs to. */
#include "trial.h"

#define NAV(m)                                                                                                         \
    {                                                                                                                  \
        "nav." #m, offsetof(state_t, nav.m), sizeof(((state_t *)0)->nav.m)                                             \
    }
#define TOP(m)                                                                                                         \
    {                                                                                                                  \
#m, offsetof(state_t, m), sizeof(((state_t *)0)->m)                                                            \
    }

static const struct {
    const char *name;
    size_t at, size;
} MEMBERS[] = {NAV(cfg),        NAV(orbits),     NAV(station),   NAV(rover),
               NAV(base),       NAV(slip_rover), NAV(slip_base), NAV(ring),
               NAV(at_horizon), NAV(now),        NAV(errors),    NAV(model),
               NAV(ud),         NAV(propagator), NAV(align),     NAV(yaw),
               NAV(spp),        NAV(admit),      NAV(timing),    NAV(sd),
               NAV(problem),    NAV(ils),        NAV(track),     NAV(update),
               NAV(warm),       NAV(poses),      NAV(counters),  NAV(solution),
               NAV(used),       NAV(event),      NAV(sats),      NAV(epoch_solution),
               TOP(imu),        TOP(rover),      TOP(base),      {"the rest of nav", 0, sizeof(pel_navigator_t)}};

#define N_MEMBERS ((int)(sizeof MEMBERS / sizeof MEMBERS[0]))

int member_count(void)
{
    return N_MEMBERS;
}

int member_index(size_t byte)
{
    int i = 0;
    while (i < N_MEMBERS - 1 && !(byte >= MEMBERS[i].at && byte < MEMBERS[i].at + MEMBERS[i].size)) { i++; }
    return i;
}

const char *member_name(int i, size_t *size)
{
    *size = MEMBERS[i].size;
    for (int k = 0; i == N_MEMBERS - 1 && k < i; k++) {
        if (MEMBERS[k].at < sizeof(pel_navigator_t)) { *size -= MEMBERS[k].size; }
    }
    return MEMBERS[i].name;
}

const char *member_of(size_t byte, size_t *size)
{
    return member_name(member_index(byte), size);
}

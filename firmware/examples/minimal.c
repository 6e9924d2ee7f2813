#include "pelorus/navigator.h"
#include "pelorus/wire.h"

static pel_navigator_t nav; /* all the memory there is: its size is known at link time */
static pel_receiver_t rover;
static pel_imu_stream_t imu;

void navigation_start(void)
{
    pel_nav_config_t cfg;
    pel_nav_config_default(&cfg);
    cfg.lever_ba_b[2] = 1.2; /* the antenna is 1.2 m above the IMU */
    pel_navigator_init(&nav, &cfg);
    pel_receiver_init(&rover);
    pel_imu_stream_init(&imu);
}

void navigation_imu_byte(uint8_t byte)
{
    if (pel_imu_stream_push(&imu, byte) == PEL_IMU_SAMPLE) { pel_navigator_push_imu(&nav, &imu.imu); }
}

void navigation_rover_byte(uint8_t byte)
{
    const pel_rx_event_t event = pel_receiver_push(&rover, byte);
    if (event == PEL_RX_EPOCH) { pel_navigator_push_rover(&nav, &rover.epoch); }
    if (event == PEL_RX_EPHEMERIS) { pel_navigator_push_ephemeris(&nav, &rover.ephemeris); }
}

const pel_solution_t *navigation_solution(void) /* the newest since the last call, or NULL */
{
    const pel_solution_t *newest = NULL;
    for (pel_nav_output_t out; (out = pel_navigator_poll(&nav)) != PEL_NAV_NONE;) {
        if (out == PEL_NAV_SOLUTION) { newest = &nav.solution; }
    }
    return newest;
}

/* hal.h - what a board must give to run Pelorus. The only calls hal/main.c makes outside the library.
 *
 * Order in which to implement on a new board: clock, OUT port, IMU port, ROVER port; then the rest, which may start as
 * the "none" answers stated below. No call blocks except hal_idle(). All are called from one context (the main loop);
 * interrupts fill the rings that hal_read() empties. */
#ifndef HAL_H
#define HAL_H

#include "pelorus/navigator.h"
#include "pelorus/solution.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    HAL_PORT_IMU = 0,   /* in: IMU frames, event marks */
    HAL_PORT_ROVER = 1, /* in: rover receiver, UBX and RTCM 3 */
    HAL_PORT_BASE = 2,  /* in: base corrections, RTCM 3 or UBX */
    HAL_PORT_AUX1 = 3,  /* in: event marks */
    HAL_PORT_OUT = 4,   /* out: navigation frames and NMEA */
    HAL_N_PORTS = 5
} hal_port_t;

/* Bring the board up. False: it cannot run (and has said why in whatever way it can). */
bool hal_init(void);

/* True while there may be more to do. A board always says true; the desktop ends with its input. */
bool hal_running(void);

/* Take up to cap received bytes of a port; 0 if there are none. Bytes the board lost (overrun) are counted by
 * hal_overruns(). */
size_t hal_read(hal_port_t port, uint8_t *buf, size_t cap);
uint32_t hal_overruns(hal_port_t port);

/* Queue bytes for sending. Returns how many were taken; the caller drops the rest and counts. */
size_t hal_write(hal_port_t port, const uint8_t *buf, size_t n);

/* Monotonic clock, ns since an arbitrary start. */
int64_t hal_clock_ns(void);

/* Approximate GPS time (within three days), 0 if unknown: gives RTCM 3 its week before a receiver has told it. */
pel_time_t hal_gps_time(void);

/* Clock reading at the last pulse per second, and at the last event input. False: none since the last call. */
bool hal_pps(int64_t *clock_ns);
bool hal_event(int64_t *clock_ns, uint32_t *id);

/* Overwrite parts of the default configuration with what the board stores. False: nothing stored. */
bool hal_load_config(pel_nav_config_t *cfg);

/* Non-volatile store of a few kilobytes in numbered slots. Return bytes moved, 0 on failure or if there is none. */
size_t hal_store_read(int slot, uint8_t *buf, size_t cap);
size_t hal_store_write(int slot, const uint8_t *buf, size_t n);

/* The slot reads as 0 bytes from now on. Called in motion: no erase, nothing that takes long. */
bool hal_store_void(int slot);

/* Tell the watchdog the loop is alive. */
void hal_watchdog_kick(void);

/* Nothing to do: sleep until an interrupt (board), or take the next event of the input (desktop). */
void hal_idle(void);

/* The firmware's main loop (hal/main.c): returns when hal_running() says false. Called by start-up code. */
void firmware_main(void);

/* What the decoder of an input port has counted. */
const pel_wire_counters_t *firmware_counters(hal_port_t port);

#ifdef __cplusplus
}
#endif
#endif

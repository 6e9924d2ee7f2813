/* main.c - the firmware's main loop: bytes from ports to the navigator, its outputs to the OUT port. The same file for
 * every board and for the desktop. */
#include <string.h>

#include "hal.h"
#include "pelorus/wire.h"
#include "store.h"

/* Seconds between counter frames. */
#define COUNTERS_EVERY_NS (10 * PEL_NS_PER_S)

/* All the memory the firmware uses: known at link time. */
static pel_navigator_t navigator;
static pel_imu_stream_t imu_stream, aux_stream; /* one a port: their bytes arrive interleaved */
static pel_receiver_t rover, base;
static pel_time_t counters_due_ns;
static uint8_t frame[PEL_OUT_MAX_PAYLOAD + PEL_OUT_OVERHEAD];

static void send(size_t n)
{
    if (n > 0) { (void)hal_write(HAL_PORT_OUT, frame, n); }
}

static void send_nmea(const pel_solution_t *s)
{
    send(pel_nmea_gga(s, (char *)frame, sizeof frame));
    send(pel_nmea_rmc(s, (char *)frame, sizeof frame));
    send(pel_nmea_hdt(s, (char *)frame, sizeof frame));
}

static void send_counters(pel_time_t t_ns)
{
    send(pel_out_encode_counters(&navigator.counters, &imu_stream.counters, &rover.counters, &base.counters, t_ns,
                                 frame, sizeof frame));
}

static void send_outputs(void)
{
    for (;;) {
        switch (pel_navigator_poll(&navigator)) {
        case PEL_NAV_NONE: return;
        case PEL_NAV_USED: send(pel_out_encode_used(&navigator.used, frame, sizeof frame)); break;
        case PEL_NAV_SOLUTION: send(pel_out_encode_solution(&navigator.solution, frame, sizeof frame)); break;
        case PEL_NAV_EVENT: send(pel_out_encode_event(&navigator.event, frame, sizeof frame)); break;
        case PEL_NAV_EPOCH:
            send(pel_out_encode_solution(&navigator.epoch_solution, frame, sizeof frame));
            send(pel_out_encode_sats(navigator.epoch_solution.t_ns, navigator.sats, navigator.n_sats, frame,
                                     sizeof frame));
            send_nmea(&navigator.epoch_solution);
            if (navigator.epoch_solution.t_ns >= counters_due_ns) {
                counters_due_ns = navigator.epoch_solution.t_ns + COUNTERS_EVERY_NS;
                send_counters(navigator.epoch_solution.t_ns);
            }
            store_keep(&navigator, frame, sizeof frame);
            break;
        case PEL_NAV_WARM: send(pel_out_encode_warm(&navigator.warm.report, frame, sizeof frame)); break;
        }
    }
}

static void start(void);

static void take_receiver_event(pel_receiver_t *rx, bool is_base, pel_rx_event_t event)
{
    switch (event) {
    case PEL_RX_NONE: break;
    case PEL_RX_PVT: break;
    case PEL_RX_EPHEMERIS: pel_navigator_push_ephemeris(&navigator, &rx->ephemeris); break;
    case PEL_RX_KLOBUCHAR: pel_navigator_push_klobuchar(&navigator, &rx->klobuchar); break;
    case PEL_RX_STATION:
        if (is_base) { pel_navigator_push_station(&navigator, &rx->station); }
        break;
    case PEL_RX_EPOCH:
        /* Whoever knows the week tells the other. */
        pel_receiver_set_time(is_base ? &rover : &base, rx->epoch.t_ns);
        if (is_base) {
            pel_navigator_push_base(&navigator, &rx->epoch);
        } else {
            pel_navigator_push_rover(&navigator, &rx->epoch);
            if (pel_navigator_is_broken(&navigator)) { start(); } /* its settings have changed by themselves */
        }
        break;
    }
    send_outputs();
}

static void take_imu_byte(pel_imu_stream_t *stream, uint8_t byte)
{
    switch (pel_imu_stream_push(stream, byte)) {
    case PEL_IMU_NONE: return;
    case PEL_IMU_SAMPLE: pel_navigator_push_imu(&navigator, &stream->imu); break;
    case PEL_IMU_EVENT_MARK: pel_navigator_push_event(&navigator, stream->mark_t_ns, stream->mark_id); break;
    case PEL_IMU_BARO: pel_navigator_push_baro(&navigator, &stream->baro); break;
    }
    send_outputs();
}

/* One port's waiting bytes. True if there were any. */
static bool serve(hal_port_t port)
{
    uint8_t buf[128];
    const size_t n = hal_read(port, buf, sizeof buf);
    for (size_t i = 0; i < n; i++) {
        switch (port) {
        case HAL_PORT_IMU: take_imu_byte(&imu_stream, buf[i]); break;
        case HAL_PORT_AUX1: take_imu_byte(&aux_stream, buf[i]); break;
        case HAL_PORT_ROVER: take_receiver_event(&rover, false, pel_receiver_push(&rover, buf[i])); break;
        case HAL_PORT_BASE: take_receiver_event(&base, true, pel_receiver_push(&base, buf[i])); break;
        case HAL_PORT_OUT:
        case HAL_N_PORTS: break;
        }
    }
    return n > 0;
}

static void drain_receiver(pel_receiver_t *rx, bool is_base)
{
    pel_rx_event_t event = pel_receiver_flush(rx);
    while (event != PEL_RX_NONE) {
        take_receiver_event(rx, is_base, event);
        event = pel_receiver_flush(rx);
    }
}

/* The input has ended: what the decoders and the navigator still hold. */
static void drain(void)
{
    drain_receiver(&base, true);
    drain_receiver(&rover, false);
    while (pel_navigator_flush(&navigator)) { send_outputs(); }
    send_outputs();
    send_counters(navigator.last_epoch_ns);
}

static void start(void)
{
    pel_nav_config_t cfg;
    pel_nav_config_default(&cfg);
    (void)hal_load_config(&cfg);
    pel_navigator_init(&navigator, &cfg);
    store_restore(&navigator, frame, sizeof frame);
    pel_imu_stream_init(&imu_stream);
    pel_imu_stream_init(&aux_stream);
    pel_receiver_init(&rover);
    pel_receiver_init(&base);
    counters_due_ns = 0;
    const pel_time_t t = hal_gps_time();
    if (t > 0) {
        pel_receiver_set_time(&rover, t);
        pel_receiver_set_time(&base, t);
    }
}

const pel_wire_counters_t *firmware_counters(hal_port_t port)
{
    switch (port) {
    case HAL_PORT_ROVER: return &rover.counters;
    case HAL_PORT_BASE: return &base.counters;
    case HAL_PORT_AUX1: return &aux_stream.counters;
    case HAL_PORT_IMU:
    case HAL_PORT_OUT:
    case HAL_N_PORTS: break;
    }
    return &imu_stream.counters;
}

void firmware_main(void)
{
    start();
    while (hal_running()) {
        hal_watchdog_kick();
        bool busy = false;
        for (int port = HAL_PORT_IMU; port <= HAL_PORT_AUX1; port++) { busy |= serve((hal_port_t)port); }
        if (!busy) { hal_idle(); }
    }
    drain();
}

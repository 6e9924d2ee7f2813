/* wire.h - bytes in, measurements out; solutions in, bytes out. Room: wire/ (knows base/ alone).
 *
 * Decoders are state machines that take one byte at a time, so any chunking of a stream gives the same result.
 * Nothing here allocates, blocks or keeps a pointer; a struct may be copied or moved between calls. Frames are found by
 * their sync bytes, checked, and only then decoded; what is refused is counted by cause and changes nothing else.
 * After a bad checksum the search resumes at the byte after the false sync, so a good frame inside a bad one is not lost.
 * Work of one push: at most one checksum, one decode and one move of the buffer, whatever the bytes.
 *
 * Every byte of Pelorus's own frames and the list of supported foreign messages: docs/FORMATS.md. */
#ifndef PELORUS_WIRE_H
#define PELORUS_WIRE_H

#include "pelorus/base.h"
#include "pelorus/solution.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- receiver stream: UBX, RTCM 3 and NMEA mixed ------------------------------------------------------------------- */

typedef enum {
    PEL_RX_NONE = 0,
    PEL_RX_EPOCH,     /* rx->epoch: RXM-RAWX, or all RTCM 3 observation messages of one time */
    PEL_RX_EPHEMERIS, /* rx->ephemeris: RXM-SFRBX (complete, consistent set) or 1019, 1020, 1042, 1044, 1045, 1046 */
    PEL_RX_KLOBUCHAR, /* rx->klobuchar: GPS subframe 4 page 18 */
    PEL_RX_STATION,   /* rx->station: 1005, 1006 */
    PEL_RX_PVT        /* rx->pvt: NAV-PVT */
} pel_rx_event_t;

/* Navigation messages being collected for one satellite. Private. */
typedef struct {
    uint8_t sys, prn; /* prn 0: free */
    uint16_t have;    /* bit i: part i is stored */
    uint32_t touched; /* rx->nav_clock when last written */
    uint32_t start_s; /* BeiDou: second of week where the frame began, GLONASS its number; frames do not mix */
    uint8_t data[PEL_NAV_BYTES];
} pel_nav_slot_t;

/* One receiver's stream. The members above the line are the results; the named one is valid until the next push. */
typedef struct pel_receiver_t {
    pel_epoch_t epoch;
    pel_ephemeris_t ephemeris;
    pel_klobuchar_t klobuchar;
    pel_station_t station;
    pel_pvt_t pvt;
    pel_wire_counters_t counters;
    /* private from here */
    pel_time_t t_approx_ns;  /* current time as far as known, 0 = unknown */
    pel_time_t t_given_ns;   /* last epoch delivered, 0 = none */
    pel_time_t t_back_ns;    /* newest epoch refused as older than that */
    pel_time_t t_gps_msm_ns; /* last MSM of GPS, 0 = none: 1004 beside it is not used */
    pel_time_t t_glo_msm_ns; /* of GLONASS: 1012 */
    uint8_t glo_channel[33]; /* by slot, k + 8; 0 = not told */
    uint8_t n_back;          /* how many in a row: a receiver that restarted is believed after PEL_WIRE_RESTART */
    bool collecting;         /* epoch holds RTCM observations not yet delivered */
    uint16_t fill;           /* bytes in buf */
    uint32_t nav_clock;      /* navigation message frames seen */
    pel_nav_slot_t nav[PEL_NAV_SLOTS];
    uint8_t buf[PEL_MAX_FRAME_BYTES + 8];
} pel_receiver_t;

/* A stream whose time went back is believed again after this many epochs (samples) that are in order among themselves. */
#define PEL_WIRE_RESTART 16

void pel_receiver_init(pel_receiver_t *rx);

/* Approximate GPS time (within 3 days) for formats that carry no week. Not needed where RAWX or 1019 tell it; 1019 has a
 * week modulo 1024, taken as 2019-04-07 or later unless a time was given. */
void pel_receiver_set_time(pel_receiver_t *rx, pel_time_t t);

/* One byte. At most one event; when one byte completes more, the rest follow with the next bytes. */
pel_rx_event_t pel_receiver_push(pel_receiver_t *rx, uint8_t byte);

/* End of input: gives what is still held (frames behind an unfinished one, an epoch whose last message was lost). Call until PEL_RX_NONE. */
pel_rx_event_t pel_receiver_flush(pel_receiver_t *rx);

/* ---- IMU stream: Pelorus IMU, event mark and barometer frames, NovAtel RAWIMUSX -------------------------------------------------- */

typedef enum {
    PEL_IMU_NONE = 0,
    PEL_IMU_SAMPLE,     /* s->imu */
    PEL_IMU_EVENT_MARK, /* s->mark_t_ns, s->mark_id */
    PEL_IMU_BARO        /* s->baro */
} pel_imu_event_t;

#define PEL_IMU_FRAME_MAX 96

typedef struct pel_imu_stream_t {
    pel_imu_t imu;
    pel_time_t mark_t_ns;
    uint32_t mark_id;
    pel_baro_t baro;
    pel_wire_counters_t counters;
    /* private from here */
    double gyro_scale_rad, accel_scale_mps, raw_dt_s; /* RAWIMUSX units; 0: by its IMU type byte */
    pel_time_t t_given_ns, t_back_ns;
    uint8_t n_back;
    bool have_seq;
    uint16_t seq;
    uint16_t fill;
    uint8_t buf[PEL_IMU_FRAME_MAX + 8];
} pel_imu_stream_t;

void pel_imu_stream_init(pel_imu_stream_t *s);

/* Units and interval of RAWIMUSX: rad and m/s per count (> 0), dt in s (> 0). Without it they follow from the frame's
 * IMU type byte where that is known (docs/FORMATS.md), else the samples are refused as bad_value. */
void pel_imu_stream_set_rawimu(pel_imu_stream_t *s, double gyro_scale_rad, double accel_scale_mps, double dt_s);

/* One byte. Samples out of order are counted and not given; a lost one (sequence, or more than 1.5 dt) is counted as gap. */
pel_imu_event_t pel_imu_stream_push(pel_imu_stream_t *s, uint8_t byte);

/* ---- encoders of inputs: for the simulator and the capture tool ---------------------------------------------------------
 * All return the bytes written, 0 if they do not fit into cap or an input is invalid (out then undefined). */

/* Pelorus IMU frame. |alpha| < 1 rad, |upsilon| < 16 m/s, 0 < dt < 4.29 s. 49 bytes. */
size_t pel_imu_encode(const pel_imu_t *imu, uint8_t *out, size_t cap);

/* Event mark at t. 21 bytes. */
size_t pel_event_mark_encode(pel_time_t t, uint32_t id, uint8_t *out, size_t cap);

/* Barometer sample. |height| < 100 km, 1 mm < sd < 65 m. 25 bytes. */
size_t pel_baro_encode(const pel_baro_t *b, uint8_t *out, size_t cap);

/* NovAtel RAWIMUSX: increments in counts of the given units; x right, y forward, z up. 56 bytes. */
size_t pel_rawimusx_encode(const pel_imu_t *imu, uint8_t imu_type, double gyro_scale_rad, double accel_scale_mps,
                           uint8_t *out, size_t cap);

/* RXM-RAWX, version 1. Signals without an identifier in UBX are left out. 24 + 32 n bytes. */
size_t pel_ubx_encode_rawx(const pel_epoch_t *e, int leap_s, uint8_t *out, size_t cap);

/* RXM-SFRBX with one part of an ephemeris as broadcast at t: GPS, QZSS LNAV subframe 1..3; Galileo I/NAV word 1..5;
 * BeiDou D1 subframe 1..3, D2 (prn 1..5, 59..63) subframe 1 page 1..10; GLONASS string 1..4. Field precision is the message's own. */
size_t pel_ubx_encode_sfrbx_eph(const pel_ephemeris_t *eph, int part, pel_time_t t, uint8_t *out, size_t cap);
int pel_ubx_sfrbx_parts(const pel_ephemeris_t *eph); /* how many parts; 0 for a system without encoder */

/* RXM-SFRBX with GPS subframe 4 page 18 from satellite prn. */
size_t pel_ubx_encode_sfrbx_klobuchar(const pel_klobuchar_t *k, int prn, pel_time_t t, uint8_t *out, size_t cap);

/* NAV-PVT. */
size_t pel_ubx_encode_pvt(const pel_pvt_t *p, uint8_t *out, size_t cap);

/* RTCM 3. Station type 1005 or 1006 (height 0: the position is the antenna's). Ephemeris 1019, 1020, 1042, 1044, 1045, 1046.
 * MSM 4..7 of one system, `more`: another message of the same epoch follows. An MSM holds at most 64 cells: the signals
 * that do not fit into one are left out. 1004: GPS L1 and L2. */
size_t pel_rtcm3_encode_station(const pel_station_t *s, int type, uint8_t *out, size_t cap);
size_t pel_rtcm3_encode_ephemeris(const pel_ephemeris_t *eph, uint8_t *out, size_t cap);
size_t pel_rtcm3_encode_msm(const pel_epoch_t *e, pel_sys_t sys, int msm, uint16_t station, bool more, uint8_t *out,
                            size_t cap);
size_t pel_rtcm3_encode_1004(const pel_epoch_t *e, uint16_t station, bool more, uint8_t *out, size_t cap);

/* ---- output frames ---------------------------------------------------------------------------------------------------------
 * 'P' 'L', id u8, version u8, payload length u16 LE, payload, CRC-24Q over id..payload (3 bytes, MSB first). */

typedef enum {
    PEL_OUT_IMU = 0x01,        /* input */
    PEL_OUT_EVENT_MARK = 0x02, /* input */
    PEL_OUT_BARO = 0x03,       /* input */
    PEL_OUT_SOLUTION = 0x10,
    PEL_OUT_USED = 0x11,
    PEL_OUT_COUNTERS = 0x12,
    PEL_OUT_SATS = 0x13,
    PEL_OUT_EVENT = 0x14,
    PEL_OUT_WARM = 0x15
} pel_out_id_t;

#define PEL_OUT_OVERHEAD  9 /* sync 2, id, version, length 2, CRC 3 */
#define PEL_OUT_SAT_BYTES 44
#define PEL_OUT_MAX_PAYLOAD                                                                                            \
    ((10 + PEL_OUT_SAT_BYTES * PEL_MAX_OBS > 512) ? (10 + PEL_OUT_SAT_BYTES * PEL_MAX_OBS) : 512)

size_t pel_out_encode_solution(const pel_solution_t *s, uint8_t *out, size_t cap);
size_t pel_out_encode_used(const pel_used_t *u, uint8_t *out, size_t cap);
size_t pel_out_encode_counters(const pel_nav_counters_t *nav, const pel_wire_counters_t *imu,
                               const pel_wire_counters_t *rover, const pel_wire_counters_t *base, pel_time_t t,
                               uint8_t *out, size_t cap);
size_t pel_out_encode_sats(pel_time_t t, const pel_sat_report_t *s, int n, uint8_t *out,
                           size_t cap); /* 0 <= n <= PEL_MAX_OBS */
size_t pel_out_encode_event(const pel_event_t *e, uint8_t *out, size_t cap);
size_t pel_out_encode_warm(const pel_warm_report_t *w, uint8_t *out, size_t cap);

/* Decoders of payloads. PEL_E_FORMAT (outputs unchanged) when n is not the payload's length. */
pel_status_t pel_out_decode_solution(const uint8_t *payload, size_t n, pel_solution_t *s);
pel_status_t pel_out_decode_used(const uint8_t *payload, size_t n, pel_used_t *u);
pel_status_t pel_out_decode_counters(const uint8_t *payload, size_t n, pel_nav_counters_t *nav,
                                     pel_wire_counters_t *imu, pel_wire_counters_t *rover, pel_wire_counters_t *base,
                                     pel_time_t *t);
pel_status_t pel_out_decode_sats(const uint8_t *payload, size_t n, pel_time_t *t, pel_sat_report_t s[PEL_MAX_OBS],
                                 int *n_sats);
pel_status_t pel_out_decode_event(const uint8_t *payload, size_t n, pel_event_t *e);
pel_status_t pel_out_decode_warm(const uint8_t *payload, size_t n, pel_warm_report_t *w);

/* Reads any Pelorus frames from a stream (NMEA between them is skipped as noise). For desktop tools. */
typedef struct {
    uint8_t id, version; /* of the frame just completed */
    uint16_t n;
    uint8_t payload[PEL_OUT_MAX_PAYLOAD]; /* valid until the next push */
    pel_wire_counters_t counters;
    /* private */
    uint16_t fill;
    uint8_t buf[PEL_OUT_MAX_PAYLOAD + PEL_OUT_OVERHEAD + 8];
} pel_out_reader_t;

void pel_out_reader_init(pel_out_reader_t *r);
bool pel_out_reader_push(pel_out_reader_t *r, uint8_t byte); /* true: id, version, n, payload hold a frame */

/* NMEA 0183 sentences with "\r\n" and a terminating NUL; the length without the NUL, 0 if it does not fit (cap >= 128 always
 * does). UTC from the leap second table. GGA quality 4 fixed, 5 float, 1 single point, 6 coasting, 0 none. Heights are
 * ellipsoidal: the separation field is 0.0. HDT has an empty field without a heading. */
size_t pel_nmea_gga(const pel_solution_t *s, char *out, size_t cap);
size_t pel_nmea_rmc(const pel_solution_t *s, char *out, size_t cap);
size_t pel_nmea_hdt(const pel_solution_t *s, char *out, size_t cap);

#ifdef __cplusplus
}
#endif
#endif

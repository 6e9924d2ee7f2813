/* framing.h - what all stream decoders share: finding frames, and fields written once for both directions. Private to wire/. */
#ifndef PELORUS_WIRE_FRAMING_H
#define PELORUS_WIRE_FRAMING_H

#include "pelorus/bits.h"
#include "pelorus/wire.h"

/* ---- frames in a buffer ------------------------------------------------------------------------------------------------ */

typedef enum {
    PEL_PROBE_NOISE,      /* byte 0 begins no frame */
    PEL_PROBE_MORE,       /* may begin one; more bytes are needed to tell */
    PEL_PROBE_BAD_LENGTH, /* begins like one, its length is impossible or too long */
    PEL_PROBE_BAD_CHECKSUM,
    PEL_PROBE_FRAME /* a whole good frame of *length bytes */
} pel_probe_t;

/* Looks at n > 0 bytes. Must not answer MORE once n has reached the longest frame it knows. */
typedef pel_probe_t (*pel_probe_fn)(const uint8_t *p, size_t n, size_t *length);

/* Drops noise from the front of buf and probes once. True: a good frame of *length bytes lies at buf[0] (not yet dropped).
 * A bad frame loses its first byte only, so that what it holds is searched again. With `final`, a frame that lacks bytes
 * counts as cut (bad_length) and the search goes on to the end of the buffer. */
bool pel_frame_next(uint8_t *buf, uint16_t *fill, pel_wire_counters_t *count, pel_probe_fn probe, bool final,
                    size_t *length);

void pel_frame_drop(uint8_t *buf, uint16_t *fill, size_t n);

/* Appends a byte; when the buffer is full (it never is while every probe is honest) the oldest byte goes as noise. */
void pel_frame_append(uint8_t *buf, size_t cap, uint16_t *fill, pel_wire_counters_t *count, uint8_t byte);

pel_probe_t pel_ubx_probe(const uint8_t *p, size_t n, size_t *length);
pel_probe_t pel_rtcm3_probe(const uint8_t *p, size_t n, size_t *length);
pel_probe_t pel_nmea_probe(const uint8_t *p, size_t n, size_t *length);
pel_probe_t pel_pelorus_probe(const uint8_t *p, size_t n, size_t max_payload, size_t *length);
pel_probe_t pel_novatel_probe(const uint8_t *p, size_t n, size_t *length);

/* ---- order in time ------------------------------------------------------------------------------------------------------- */

typedef enum { PEL_ORDER_NEW, PEL_ORDER_SAME, PEL_ORDER_BACK } pel_order_t;

/* Where t stands to the last time given; same within tol_ns. Counts SAME and BACK. PEL_WIRE_RESTART times BACK in order
 * among themselves are a sender that restarted: the last is NEW. */
pel_order_t pel_time_order(pel_time_t t, pel_time_t tol_ns, pel_time_t given, pel_time_t *back, uint8_t *n_back,
                           pel_wire_counters_t *count);

/* Whether a message may tell this week (PEL_WEEK_*) and this second of it, which may be a leap second; false for NaN. */
bool pel_week_possible(int32_t week, double tow_s);

/* The time with this millisecond of week (it may exceed a week) nearest to ref. */
pel_time_t pel_tow_ms_near(uint32_t tow_ms, pel_time_t ref);

/* ---- one layout, both directions -------------------------------------------------------------------------------------------
 * A message is described by one function that visits its fields in order; it reads them or writes them. */

typedef struct {
    bool writing;
    pel_bit_reader_t r;
    pel_bit_writer_t w;
} pel_bitio_t;

void pel_bitio_read(pel_bitio_t *io, const uint8_t *p, size_t n_bytes);
void pel_bitio_write(pel_bitio_t *io, uint8_t *p, size_t n_bytes);
bool pel_bitio_failed(const pel_bitio_t *io); /* ran past the end, or a value does not fit its field */
void pel_io_u(pel_bitio_t *io, unsigned n_bits, uint32_t *v);
void pel_io_fill(pel_bitio_t *io, unsigned n_bits, uint64_t v);               /* written as v, skipped when read */
void pel_io_signed(pel_bitio_t *io, unsigned n_bits, double unit, double *v); /* two's complement */

/* Pelorus frame around a payload already at out + 6. Returns its length, 0 if it does not fit. */
size_t pel_out_seal(uint8_t id, size_t n_payload, uint8_t *out, size_t cap);
/* Pelorus frame whose payload is these members. Decode: PEL_E_FORMAT and nothing changed unless n is their length. */
size_t pel_out_encode(uint8_t id, const pel_member_t m[], size_t n_members, const void *from, uint8_t *out, size_t cap);
pel_status_t pel_out_decode(const pel_member_t m[], size_t n_members, const uint8_t *payload, size_t n, void *to);
/* UBX frame around a payload already at out + 6. */
size_t pel_ubx_seal(uint8_t cls, uint8_t id, size_t n_payload, uint8_t *out, size_t cap);
/* RTCM 3 frame around n_bits already written at out + 3. */
size_t pel_rtcm3_seal(size_t n_bits, uint8_t *out, size_t cap);

#define PEL_OUT_VERSION 1

/* ---- receiver stream: what the formats tell it ------------------------------------------------------------------------------- */

/* Handles one good frame. *hold: the frame begins a new epoch and the one before must go out first; it is offered again. */
pel_rx_event_t pel_ubx_handle(pel_receiver_t *rx, const uint8_t *frame, size_t n, bool *hold);
pel_rx_event_t pel_rtcm3_handle(pel_receiver_t *rx, const uint8_t *frame, size_t n, bool *hold);

pel_rx_event_t pel_ubx_rawx(pel_receiver_t *rx, const uint8_t *payload, size_t n, bool *hold);
pel_rx_event_t pel_ubx_sfrbx(pel_receiver_t *rx, const uint8_t *payload, size_t n);
pel_rx_event_t pel_ubx_pvt(pel_receiver_t *rx, const uint8_t *payload, size_t n);
pel_rx_event_t pel_rtcm3_msm(pel_receiver_t *rx, const uint8_t *msg, size_t n, bool *hold);
pel_rx_event_t pel_rtcm3_1004(pel_receiver_t *rx, const uint8_t *msg, size_t n, bool *hold);
pel_rx_event_t pel_rtcm3_1012(pel_receiver_t *rx, const uint8_t *msg, size_t n, bool *hold);
pel_rx_event_t pel_rtcm3_ephemeris(pel_receiver_t *rx, const uint8_t *msg, size_t n);

/* The time to resolve truncated weeks with: the current one, or the middle of the span of 1024 weeks from 2019-04-07. */
pel_time_t pel_rx_reference(const pel_receiver_t *rx);

/* Opens (or continues) the epoch that RTCM messages of time t are collected in. False: this message is not to be decoded,
 * either because *event with *hold must go out first, or because it is a duplicate or late (counted). */
bool pel_rx_collect(pel_receiver_t *rx, pel_time_t t, bool *hold, pel_rx_event_t *event);
/* Closes it. PEL_RX_EPOCH if it holds anything. */
pel_rx_event_t pel_rx_deliver(pel_receiver_t *rx);

/* GLONASS frequency channels by slot, for messages that do not carry them. False: not told yet. */
void pel_rx_learn_channel(pel_receiver_t *rx, unsigned slot, int k);
bool pel_rx_channel(const pel_receiver_t *rx, unsigned slot, int8_t *k);

/* Adds a signal to the epoch: out of range is counted as bad_value, a second code on the same satellite and carrier as
 * duplicate (the preferred one stays), one too many as overflow. */
void pel_rx_add(pel_receiver_t *rx, const pel_obs_t *o);
/* Whether every number that the flags call valid is possible, and the satellite and carrier exist. */
bool pel_obs_plausible(const pel_obs_t *o);

/* GPS weeks that a message may tell, 1999 to 2094: before and after them it is damaged or a test signal. */
#define PEL_WEEK_FIRST 1000
#define PEL_WEEK_LAST  6000
#define PEL_TIME_LAST  ((PEL_WEEK_LAST + 1) * PEL_NS_PER_WEEK) /* so that sums of times never overflow */

/* Epochs closer than this are one epoch. */
#define PEL_SAME_EPOCH_NS (5 * PEL_NS_PER_MS)

#endif

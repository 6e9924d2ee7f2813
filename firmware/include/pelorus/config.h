/* config.h - every compile-time size of the library, in one place.
 *
 * Each may be overridden with -DNAME=VALUE. What it costs is said beside it; what depends on it follows from it. */
#ifndef PELORUS_CONFIG_H
#define PELORUS_CONFIG_H

/* Type of error states, covariance factors, gains and rows: float, or double with -DPEL_REAL_DOUBLE=1. */
#ifndef PEL_REAL_DOUBLE
#define PEL_REAL_DOUBLE 0
#endif

/* Signals (satellite x carrier) kept of one receiver epoch; 40 bytes each, three epochs in a navigator. */
#ifndef PEL_MAX_OBS
#define PEL_MAX_OBS 128
#endif

/* Satellites whose states are computed at one epoch; about 120 bytes each, in two views. */
#ifndef PEL_MAX_SATS
#define PEL_MAX_SATS 48
#endif

/* Broadcast ephemerides kept; about 240 bytes each. */
#ifndef PEL_MAX_EPH
#define PEL_MAX_EPH 64
#endif

/* Error states of the filter, float ambiguities included; 4 (or 8) * N * (N + 3) / 2 bytes. */
#ifndef PEL_MAX_STATES
#define PEL_MAX_STATES 48
#endif

/* Integer ambiguities resolved together. */
#ifndef PEL_MAX_AMB
#define PEL_MAX_AMB 40
#endif

/* IMU increments kept for epochs that arrive late; 76 bytes each. 256 at 500 Hz is 0.51 s. */
#ifndef PEL_IMU_RING
#define PEL_IMU_RING 256
#endif

/* Satellites whose navigation messages are collected at the same time, in each receiver decoder; 100 bytes each. */
#ifndef PEL_NAV_SLOTS
#define PEL_NAV_SLOTS 48
#endif
#define PEL_NAV_BYTES 84 /* one satellite's parts: the largest is BeiDou D1, three subframes of 28 bytes */

/* Longest frame a byte decoder accepts: a UBX RXM-RAWX with PEL_MAX_OBS signals, or an RTCM 3 frame (1029). */
#define PEL_RAWX_FRAME_BYTES (8 + 16 + 32 * PEL_MAX_OBS)
#define PEL_MAX_FRAME_BYTES  ((PEL_RAWX_FRAME_BYTES > 1100) ? PEL_RAWX_FRAME_BYTES : 1100)

#if defined(__cplusplus) && !defined(_Static_assert)
#define _Static_assert static_assert /* what C++ calls it */
#endif

_Static_assert(PEL_MAX_OBS >= 8 && PEL_MAX_OBS <= 255, "PEL_MAX_OBS: 8 to 255");
_Static_assert(PEL_MAX_SATS >= 8 && PEL_MAX_SATS <= 96, "PEL_MAX_SATS: 8 to 96");
_Static_assert(PEL_MAX_EPH >= 8 && PEL_MAX_EPH <= 200, "PEL_MAX_EPH: 8 to 200");
_Static_assert(PEL_MAX_STATES >= 18 && PEL_MAX_STATES <= 96, "PEL_MAX_STATES: 18 to 96");
_Static_assert(PEL_MAX_AMB >= 6 && PEL_MAX_AMB <= 64, "PEL_MAX_AMB: 6 to 64");
_Static_assert(PEL_NAV_SLOTS >= 4 && PEL_NAV_SLOTS <= 128, "PEL_NAV_SLOTS: 4 to 128");
_Static_assert(PEL_IMU_RING >= 16 && PEL_IMU_RING <= 32768, "PEL_IMU_RING: a ring that 16 bits count");

#endif

/* imu_stream.h - the formats of the IMU stream. Private to wire/. */
#ifndef PELORUS_WIRE_IMU_STREAM_H
#define PELORUS_WIRE_IMU_STREAM_H

#include "framing.h"

#define PEL_IMU_PAYLOAD    40
#define PEL_MARK_PAYLOAD   12
#define PEL_BARO_PAYLOAD   16
#define PEL_RAWIMUSX_BYTES 56 /* header 12, body 40, CRC 4 */

/* Each decodes one checked frame; false: a value is impossible, or the message is not this one. */
bool pel_imu_decode(const uint8_t *payload, pel_imu_t *imu);
bool pel_baro_decode(const uint8_t *payload, pel_baro_t *b);
/* True for RAWIMUSX; *usable false when units are unknown or a value is impossible. */
bool pel_rawimusx_decode(const pel_imu_stream_t *s, const uint8_t *frame, size_t n, pel_imu_t *imu, bool *usable);

/* Bounds of any increment: 0 < dt < 4.29 s, |alpha| < 1 rad, |upsilon| < 16 m/s; time not before 1980. */
bool pel_imu_plausible(const pel_imu_t *imu);

#endif

/* tape.h - a capture as a board in an emulator reads it: one flat file, bytes in order of arrival. All numbers little-endian.
 *
 *   header         tape_header_t
 *   configuration  header.config_bytes bytes: pel_nav_config_t as it lies in memory; none: the default one
 *   records        u32 port << 24 | n, then n bytes; to the end of the file
 *
 * Written by pelorus-tape on the desktop, read by hal/pil/pil.c. */
#ifndef HAL_PIL_TAPE_H
#define HAL_PIL_TAPE_H

#include "hal.h"

#define TAPE_MAGIC   UINT64_C(0x31455041544C4550) /* "PELTAPE1" */
#define TAPE_MAX_RUN 0xFFFFFFu                    /* bytes of one record */

typedef struct {
    uint64_t magic;
    int64_t gps_time_ns; /* of the first event, for hal_gps_time() */
    uint32_t config_bytes;
    uint32_t layout; /* tape_layout() of who wrote it */
} tape_header_t;

/* A configuration is copied as it lies in memory, so both machines must lay it out alike: compare places all over it. */
static inline uint32_t tape_layout(void)
{
    uint32_t h = (uint32_t)sizeof(pel_nav_config_t);
    h = h * 31 + (uint32_t)offsetof(pel_nav_config_t, imu);
    h = h * 31 + (uint32_t)offsetof(pel_nav_config_t, lever_ba_b);
    h = h * 31 + (uint32_t)offsetof(pel_nav_config_t, align_speed_mps);
    h = h * 31 + (uint32_t)offsetof(pel_nav_config_t, vehicle.height);
    h = h * 31 + (uint32_t)offsetof(pel_nav_config_t, noise_single);
    h = h * 31 + (uint32_t)offsetof(pel_nav_config_t, ratio_min);
    return h * 31 + (uint32_t)offsetof(pel_nav_config_t, C_c_b);
}

#endif

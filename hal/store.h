/* store.h - snapshots in the board's two store slots. */
#ifndef HAL_STORE_H
#define HAL_STORE_H

#include "hal.h"

/* At start, after pel_navigator_init(): the newer whole snapshot goes into the navigator. buf: room to read a slot into. */
void store_restore(pel_navigator_t *nav, uint8_t *buf, size_t cap);

/* After each epoch: voids what the first motion has outlived; stores a snapshot if one is due, never over the newest whole one. */
void store_keep(const pel_navigator_t *nav, uint8_t *buf, size_t cap);

#endif

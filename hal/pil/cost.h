/* cost.h - what the firmware's work costs on an emulated board, counted while a tape runs (cost.c). */
#ifndef HAL_PIL_COST_H
#define HAL_PIL_COST_H

#include "board.h"

/* Kinds of work; tools/pil/cost.py knows them by the same numbers. */
typedef enum {
    COST_IMU_STEP = 0, /* pel_navigator_push_imu() that applied no epoch */
    COST_EPOCH = 1,    /* a push that applied an epoch: everything in it */
    COST_ROW = 2,      /* pel_ud_update() */
    COST_SLICE = 3,    /* pel_ils_run() */
    COST_INTEGERS = 4, /* float ambiguities, searches and verdict, slices included */
    COST_ORBITS = 5,   /* single-point solution, satellite views */
    COST_RECEIVE = 6,  /* one byte into a receiver's decoder */
    COST_IMU_BYTE = 7, /* one byte into the IMU's */
    COST_REPORT = 8,   /* one output frame or sentence encoded */
    COST_OTHER = 9,    /* pushes of epochs that wait, of ephemerides, stations, events; polls */
    COST_KINDS = 10
} cost_kind_t;

/* The file they go to: bytes of stack used, kinds, then sums u64 and counts u64 by kind; before them, while the tape runs, samples
 * of the first four kinds: u64 kind << 56 | ns. */
bool cost_start(int32_t file);
void cost_finish(void);

#endif

/* support_capture.h - RINEX texts for tests, written with columns that can be counted. */
#ifndef SUPPORT_CAPTURE_H
#define SUPPORT_CAPTURE_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include "input.h"

typedef struct {
    char text[1 << 16];
    size_t n;
} text_t;

/* printf to the end of a text. */
void text_add(text_t *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* A header record: content in columns 0..59, label from 60. */
void text_header(text_t *t, const char *content, const char *label);

/* The text as an input that the caller must not free. */
input_t text_input(text_t *t);

/* A recording's path below $PELORUS_DATA or ../shared/data; false (or a failed test with PELORUS_REQUIRE_DATA=1) if absent. */
bool recording(const char *name, char *path, size_t cap);

#endif

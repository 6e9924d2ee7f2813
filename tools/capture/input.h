/* input.h - a recorded file in memory: plain or gzip, read whole, walked line by line or by fixed columns.
 *
 * Files are read whole because a RINEX file is walked twice (which code to take, then the epochs) and a raw stream
 * too (its date, then its epochs). Nothing here trusts the content: a line is a pointer with a length, zero bytes and
 * missing line ends included. */
#ifndef PELORUS_TOOLS_CAPTURE_INPUT_H
#define PELORUS_TOOLS_CAPTURE_INPUT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    uint8_t *bytes; /* owned; free with input_free */
    size_t n;
    bool truncated; /* a gzip stream ended early or was damaged: what came before is here */
} input_t;

/* Read a file, gzip or not ('-' is standard input). 0, or -1 with errno set and *in empty. */
int input_load(const char *path, input_t *in);
void input_free(input_t *in);

typedef struct {
    const char *s; /* not terminated */
    size_t n;      /* without CR and LF */
} line_t;

typedef struct {
    const char *at, *end;
} lines_t;

lines_t lines_of(const input_t *in);
bool lines_next(lines_t *l, line_t *out);

/* Fixed columns (0-based). Beyond the end of the line reads as blank. */
typedef enum { FIELD_OK, FIELD_BLANK, FIELD_BAD } field_t;

char line_char(line_t l, size_t col);
bool line_blank(line_t l, size_t col, size_t width);
/* Numbers as Fortran writes them: D or E exponents, blanks around. *v is set on FIELD_OK only. */
field_t line_real(line_t l, size_t col, size_t width, double *v);
field_t line_int(line_t l, size_t col, size_t width, int *v);
/* Unsigned decimal seconds "ss.fffffff" -> ns, without going through binary fractions. */
field_t line_seconds_ns(line_t l, size_t col, size_t width, int64_t *ns);
/* Does the RINEX header label (columns 60..) start with this text? */
bool line_label(line_t l, const char *label);

#endif

/* tagfile.h - RTKLIB time tag files: when each byte of a log had arrived, by the clock of the logging computer.
 *
 * 60 bytes "TIMETAG RTKLIB ...", tick u4 at the start, then the start in GPS time as seconds since 1970 u4 and fraction f8,
 * then pairs of (ms since the start u4, bytes of the log written by then u4), little endian. */
#ifndef PELORUS_TOOLS_CAPTURE_TAGFILE_H
#define PELORUS_TOOLS_CAPTURE_TAGFILE_H

#include "input.h"
#include "pelorus/base.h"

typedef struct {
    pel_time_t t_ns; /* by the logging computer */
    size_t end;      /* bytes that had arrived by then */
} tag_t;

typedef struct {
    tag_t *tag; /* owned; neither time nor end ever decreases */
    size_t n;
} tagfile_t;

/* Look for FILE.tag or FILE.tag.gz beside a log, FILE without its .gz. False if there is none or it is not one. */
bool tagfile_find(const char *log_path, tagfile_t *t);
bool tagfile_parse(const input_t *in, tagfile_t *t);
void tagfile_free(tagfile_t *t);

/* The tags count bytes of the log as it was written. Logs of text lose their CRs in some repositories: if the last tag is
 * past the end by one byte a line, put that right. */
void tagfile_fit_text(tagfile_t *t, const input_t *log);

/* Arrival of the byte before offset `end`; the last tag beyond it. */
pel_time_t tagfile_arrival(const tagfile_t *t, size_t end);

#endif

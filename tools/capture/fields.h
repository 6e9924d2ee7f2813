/* fields.h - a line of separated text (comma, semicolon, blank, tab) as fields, numbers and times. */
#ifndef PELORUS_TOOLS_CAPTURE_FIELDS_H
#define PELORUS_TOOLS_CAPTURE_FIELDS_H

#include "input.h"

#define FIELDS_MAX 32

/* Pointers into the line; what is beyond FIELDS_MAX is not there. */
typedef struct {
    line_t f[FIELDS_MAX];
    int n;
} fields_t;

void fields_split(line_t l, fields_t *out);

bool field_number(line_t f, double *v);

/* A decimal number of seconds or milliseconds in ns, to the last digit where it is written without exponent. */
bool field_time_ns(line_t f, bool milliseconds, int64_t *ns);

bool field_named(line_t f, const char *name);
bool field_ends(line_t f, const char *suffix);

/* Do these fields name columns rather than hold numbers? */
bool fields_are_names(const fields_t *f);

#endif

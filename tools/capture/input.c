#include "input.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

static gzFile open_any(const char *path)
{
    if (strcmp(path, "-") != 0) { return gzopen(path, "rb"); }
    const int fd = dup(STDIN_FILENO);
    return (fd < 0) ? NULL : gzdopen(fd, "rb");
}

int input_load(const char *path, input_t *in)
{
    *in = (input_t){0};
    errno = 0;
    gzFile gz = open_any(path);
    if (gz == NULL) {
        if (errno == 0) { errno = ENOMEM; }
        return -1;
    }
    size_t cap = 0;
    for (;;) {
        if (in->n == cap) {
            cap = (cap == 0) ? 1u << 20 : 2 * cap;
            uint8_t *grown = realloc(in->bytes, cap);
            if (grown == NULL) {
                input_free(in);
                (void)gzclose_r(gz);
                errno = ENOMEM;
                return -1;
            }
            in->bytes = grown;
        }
        const size_t room = cap - in->n;
        errno = 0;
        const int got = gzread(gz, in->bytes + in->n, (unsigned)((room > (1u << 30)) ? 1u << 30 : room));
        if (got > 0) { in->n += (size_t)got; }
        if (got <= 0) {
            if (got < 0) { in->truncated = true; }
            break;
        }
    }
    const int saved = errno;
    if (gzclose_r(gz) != Z_OK) { in->truncated = true; }
    if (in->truncated && in->n == 0) { /* a directory, or a gzip file of which nothing can be had */
        input_free(in);
        errno = (saved != 0) ? saved : EIO;
        return -1;
    }
    return 0;
}

void input_free(input_t *in)
{
    free(in->bytes);
    *in = (input_t){0};
}

lines_t lines_of(const input_t *in)
{
    const char *s = (const char *)in->bytes;
    return (lines_t){s, (s == NULL) ? s : s + in->n};
}

bool lines_next(lines_t *l, line_t *out)
{
    if (l->at == l->end) { return false; }
    const size_t left = (size_t)(l->end - l->at);
    const char *lf = memchr(l->at, '\n', left);
    size_t n = (lf == NULL) ? left : (size_t)(lf - l->at);
    out->s = l->at;
    l->at += (lf == NULL) ? n : n + 1;
    while (n > 0 && out->s[n - 1] == '\r') { n--; }
    out->n = n;
    return true;
}

char line_char(line_t l, size_t col)
{
    return (col < l.n) ? l.s[col] : ' ';
}

bool line_blank(line_t l, size_t col, size_t width)
{
    for (size_t i = col; i < col + width && i < l.n; i++) {
        if (l.s[i] != ' ') { return false; }
    }
    return true;
}

/* The columns without blanks around, terminated, exponent letter as C wants it. False if it does not fit or is empty. */
static bool trimmed(line_t l, size_t col, size_t width, char out[40])
{
    size_t end = (col + width < l.n) ? col + width : l.n;
    while (col < end && l.s[col] == ' ') { col++; }
    while (end > col && l.s[end - 1] == ' ') { end--; }
    if (col >= end || end - col >= 40) { return false; }
    for (size_t i = col; i < end; i++) {
        const char c = l.s[i];
        out[i - col] = (c == 'D' || c == 'd') ? 'E' : c;
    }
    out[end - col] = '\0';
    return true;
}

field_t line_real(line_t l, size_t col, size_t width, double *v)
{
    char text[40];
    if (line_blank(l, col, width)) { return FIELD_BLANK; }
    if (!trimmed(l, col, width, text)) { return FIELD_BAD; }
    /* strtod would also take "nan", "inf" and hexadecimal, which no file may say. */
    if (text[strspn(text, "+-0123456789.Ee")] != '\0') { return FIELD_BAD; }
    char *rest = NULL;
    const double x = strtod(text, &rest);
    if (rest == text || *rest != '\0' || !isfinite(x)) { return FIELD_BAD; }
    *v = x;
    return FIELD_OK;
}

field_t line_int(line_t l, size_t col, size_t width, int *v)
{
    char text[40];
    if (line_blank(l, col, width)) { return FIELD_BLANK; }
    if (!trimmed(l, col, width, text) || strlen(text) > 9) { return FIELD_BAD; }
    if (text[strspn(text, "+-0123456789")] != '\0') { return FIELD_BAD; }
    char *rest = NULL;
    const long x = strtol(text, &rest, 10);
    if (rest == text || *rest != '\0') { return FIELD_BAD; }
    *v = (int)x;
    return FIELD_OK;
}

field_t line_seconds_ns(line_t l, size_t col, size_t width, int64_t *ns)
{
    char text[40];
    if (line_blank(l, col, width)) { return FIELD_BLANK; }
    if (!trimmed(l, col, width, text)) { return FIELD_BAD; }
    int64_t whole = 0, frac = 0, unit = 1000000000;
    const char *p = text;
    int digits = 0;
    for (; *p >= '0' && *p <= '9' && digits < 12; p++, digits++) { whole = 10 * whole + (*p - '0'); }
    if (*p == '.') {
        for (p++; *p >= '0' && *p <= '9'; p++, digits++) {
            unit /= 10;
            if (unit > 0) { frac += unit * (*p - '0'); }
        }
    }
    if (*p != '\0' || digits == 0 || whole > 4000000000) { return FIELD_BAD; } /* with any offset it fits 64 bits */
    *ns = whole * 1000000000 + frac;
    return FIELD_OK;
}

bool line_label(line_t l, const char *label)
{
    const size_t n = strlen(label);
    return l.n >= 60 + n && memcmp(l.s + 60, label, n) == 0;
}

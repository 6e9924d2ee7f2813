#include "fields.h"

#include <math.h>
#include <string.h>

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

void fields_split(line_t l, fields_t *out)
{
    size_t i = 0;
    out->n = 0;
    while (i < l.n && is_blank(l.s[i])) { i++; }
    while (i <= l.n && out->n < FIELDS_MAX) {
        size_t from = i;
        while (i < l.n && l.s[i] != ',' && l.s[i] != ';' && !is_blank(l.s[i])) { i++; }
        out->f[out->n++] = (line_t){l.s + from, i - from};
        while (i < l.n && is_blank(l.s[i])) { i++; }
        if (i < l.n && (l.s[i] == ',' || l.s[i] == ';')) {
            for (i++; i < l.n && is_blank(l.s[i]);) { i++; }
            if (i == l.n) { break; } /* a comma at the end opens no field */
        } else if (i == l.n) {
            break;
        }
    }
}

bool field_number(line_t f, double *v)
{
    return line_real(f, 0, f.n, v) == FIELD_OK;
}

bool field_time_ns(line_t f, bool milliseconds, int64_t *ns)
{
    const bool negative = f.n > 0 && f.s[0] == '-';
    const line_t digits = negative ? (line_t){f.s + 1, f.n - 1} : f;
    double v = 0.0;
    if (!milliseconds && line_seconds_ns(digits, 0, digits.n, ns) == FIELD_OK) {
        if (negative) { *ns = -*ns; }
        return true;
    }
    if (!field_number(f, &v) || fabs(v) > 4e12) { return false; }
    if (!milliseconds && fabs(v) > 4e9) { return false; }
    const double whole = floor(v), unit = milliseconds ? 1e6 : 1e9;
    *ns = (int64_t)whole * (int64_t)unit + (int64_t)lround((v - whole) * unit);
    return true;
}

bool field_named(line_t f, const char *name)
{
    return f.n == strlen(name) && memcmp(f.s, name, f.n) == 0;
}

bool field_ends(line_t f, const char *suffix)
{
    const size_t n = strlen(suffix);
    return f.n > n && memcmp(f.s + f.n - n, suffix, n) == 0;
}

bool fields_are_names(const fields_t *f)
{
    double v = 0.0;
    return f->n > 1 && !field_number(f->f[0], &v) && !field_number(f->f[1], &v);
}

/* config_file.h - read a TOML file from C, so that a misspelt key is one clear line and never silently ignored.
 *
 * Values are named by dotted paths, arrays of tables by index: "imu.rate_hz", "segment[2].duration_s".
 *
 *   char why[CONFIG_FILE_WHY];
 *   config_file_t *c = config_file_open("flight.toml", why, sizeof why);        NULL: exit code 2 or 3, `why` says it
 *   double rate = config_file_number(c, "imu.rate_hz", 500.0);
 *   ... every key the program knows is asked for ...
 *   if (config_file_check(c, why, sizeof why) != 0) { fprintf(stderr, "%s\n", why); return 2; }
 *   config_file_close(c);
 *
 * A key is known because somebody asked for it: the keys of the file that nobody asked for are the unknown ones, and the
 * nearest key that was asked for in the same table is the suggestion. A value of the wrong type yields the default and is
 * reported by config_file_check() too. Not for firmware/: allocates. */
#ifndef PELORUS_TOOLS_CONFIG_FILE_H
#define PELORUS_TOOLS_CONFIG_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define CONFIG_FILE_WHY 256 /* bytes enough for any one-line explanation */

typedef struct config_file_t config_file_t;

/* Read and parse a file ("-" = standard input), or a text (`name` is used in messages).
 * Return NULL on failure and put one line into why[cap]; *unreadable (may be NULL) tells a file that could not be opened
 * (exit code 3) from one that is not TOML (exit code 2). */
config_file_t *config_file_open(const char *path, bool *unreadable, char *why, size_t cap);
config_file_t *config_file_parse(const char *text, const char *name, char *why, size_t cap);
void config_file_close(config_file_t *c);

/* Is there anything at this path? Marks the path as known. */
bool config_file_has(config_file_t *c, const char *path);

/* Value at a path, or the fallback if it is absent. Strings live until the file is closed. An integer is a number too. */
double config_file_number(config_file_t *c, const char *path, double fallback);
int64_t config_file_integer(config_file_t *c, const char *path, int64_t fallback);
bool config_file_bool(config_file_t *c, const char *path, bool fallback);
const char *config_file_string(config_file_t *c, const char *path, const char *fallback);

/* Arrays: the number of elements (0 if absent); numbers into out[n], exactly n of them wanted (false: absent or wrong, out
 * unchanged); the i-th element of an array of strings (fallback beyond its end). */
int config_file_array_size(config_file_t *c, const char *path);
bool config_file_numbers(config_file_t *c, const char *path, double *out, int n);
const char *config_file_string_at(config_file_t *c, const char *path, int i, const char *fallback);

/* Accept a whole table, whatever is in it (it belongs to another program). */
void config_file_allow(config_file_t *c, const char *path);

/* Report a value that is understood and makes no sense: joins the problems of config_file_check(). */
void config_file_complain(config_file_t *c, const char *path, const char *what);

/* Set values (tables on the way are created), then write one table, or with "" the whole file, as TOML text.
 * config_file_text() returns the length of the text, excluding its final 0; it is cut to cap - 1 bytes. */
void config_file_set_number(config_file_t *c, const char *path, double value);
void config_file_set_integer(config_file_t *c, const char *path, int64_t value);
void config_file_set_numbers(config_file_t *c, const char *path, const double *value, int n);
void config_file_set_string(config_file_t *c, const char *path, const char *value);
size_t config_file_text(const config_file_t *c, const char *path, char *out, size_t cap);

/* The number of problems: keys never asked for, values of a wrong type, complaints. The first goes into why[cap] as one
 * line: "flight.toml:12: unknown key 'imu.rate_hzz' (did you mean 'rate_hz'?)". */
int config_file_check(const config_file_t *c, char *why, size_t cap);

#ifdef __cplusplus
}
#endif
#endif

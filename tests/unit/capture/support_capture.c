#include "support_capture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "unity.h"

void text_add(text_t *t, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const int n = vsnprintf(t->text + t->n, sizeof t->text - t->n, format, args);
    va_end(args);
    TEST_ASSERT_TRUE(n >= 0 && t->n + (size_t)n < sizeof t->text);
    t->n += (size_t)n;
}

void text_header(text_t *t, const char *content, const char *label)
{
    text_add(t, "%-60.60s%s\n", content, label);
}

input_t text_input(text_t *t)
{
    return (input_t){(uint8_t *)t->text, t->n, false};
}

bool recording(const char *name, char *path, size_t cap)
{
    const char *dir = getenv("PELORUS_DATA"), *required = getenv("PELORUS_REQUIRE_DATA");
    snprintf(path, cap, "%s/%s", (dir != NULL && dir[0] != '\0') ? dir : "../shared/data", name);
    FILE *f = fopen(path, "rb");
    if (f != NULL) {
        fclose(f);
        return true;
    }
    if (required != NULL && strcmp(required, "1") == 0) {
        TEST_FAIL_MESSAGE("recording missing, PELORUS_REQUIRE_DATA=1");
    }
    return false;
}

/* TOML texts that are none: one line that says so, never an abort. */
#include <string.h>

#include "config_file.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void refused(const char *text)
{
    char why[CONFIG_FILE_WHY] = "";
    TEST_ASSERT_NULL_MESSAGE(config_file_parse(text, "t.toml", why, sizeof why), text);
    TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE("t.toml:", why, 7, text);
    TEST_ASSERT_NULL(strchr(why, '\n'));
}

/* Found by fuzz_config: the parser asserts there, and the program that read a capture's SETUP aborted. */
static void an_unfinished_table_header_is_one_line(void)
{
    refused("[");
    refused("[\n");
    refused("[[\n]]");
    refused("[ \n");
}

static void other_unfinished_texts_are_one_line(void)
{
    refused("a");
    refused("a =");
    refused("a = [1,");
    refused("a = {b");
    refused("a = \"b");
    refused("= 1");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(an_unfinished_table_header_is_one_line);
    RUN_TEST(other_unfinished_texts_are_one_line);
    return UNITY_END();
}

// JSON laid out for people: short things on one line, long ones broken, the same values.

#include "api/json/json_layout.h"

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static void assert_layout(const char *json, const char *expected)
{
    bf_buffer out = { 0 };

    assert_int_equal(json_layout(json, strlen(json), &out, NULL), BF_OK);
    assert_string_equal(out.bytes, expected);
    buffer_fini(&out);
}

static void what_fits_stands_on_one_line(void **unused)
{
    assert_layout("{}", "{}\n");
    assert_layout("[]", "[]\n");
    assert_layout("null", "null\n");
    assert_layout("{\"a\":1,\"b\":[2,-3e4,null,true]}",
                  "{\"a\": 1, \"b\": [2, -3e4, null, true]}\n");
}

static void blanks_between_tokens_are_our_own(void **unused)
{
    assert_layout(" {\n \"a\" :\t1 ,\r\n\"b\":[ ] }\n", "{\"a\": 1, \"b\": []}\n");
}

static void brackets_and_quotes_in_strings_are_text(void **unused)
{
    assert_layout("[\"]{, : \\\" \\\\\",\"}\"]", "[\"]{, : \\\" \\\\\", \"}\"]\n");
}

static void what_does_not_fit_is_broken(void **unused)
{
    char json[200] = "{\"a\":[";
    char expected[600] = "{\n  \"a\": [\n";

    for (int k = 0; k < 40; k++) {
        strcat(json, k == 0 ? "1" : ",1");
        strcat(expected, k == 39 ? "    1\n" : "    1,\n");
    }
    strcat(json, "]}");
    strcat(expected, "  ]\n}\n");
    assert_layout(json, expected);
}

// A line may have 100 columns, the comma that may follow among them.
static void a_line_has_room_for_the_comma_behind_it(void **unused)
{
    bf_buffer out = { 0 };
    char json[104];

    memset(json, 'x', sizeof json);
    memcpy(json, "[\"", 2);
    memcpy(json + 97, "\"]", 2); // 99 columns
    assert_int_equal(json_layout(json, 99, &out, NULL), BF_OK);
    assert_int_equal(out.n, 100);
    memcpy(json + 97, "x\"]", 3); // 100
    out.n = 0;
    assert_int_equal(json_layout(json, 100, &out, NULL), BF_OK);
    assert_memory_equal(out.bytes, "[\n  \"xxx", 8);
    buffer_fini(&out);
}

static void without_memory_nothing_is_written(void **unused)
{
    static const char json[] = "[[],[],{}]";
    bf_buffer out = { 0 };

    assert_int_equal(buffer_append(&out, "before", 6), BF_OK);
    out.capacity = out.n + 1; // so that the next byte needs more room
    memory_plan_fault(1, 0);
    assert_int_equal(json_layout(json, strlen(json), &out, NULL), BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_string_equal(out.bytes, "before");
    buffer_fini(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_fits_stands_on_one_line),
        cmocka_unit_test(blanks_between_tokens_are_our_own),
        cmocka_unit_test(brackets_and_quotes_in_strings_are_text),
        cmocka_unit_test(what_does_not_fit_is_broken),
        cmocka_unit_test(a_line_has_room_for_the_comma_behind_it),
        cmocka_unit_test(without_memory_nothing_is_written),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

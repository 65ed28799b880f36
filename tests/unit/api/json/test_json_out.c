// The JSON writer: what it writes is JSON, and reads back as what was meant.

#include "api/json/json_out.h"

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static void structure_has_its_commas(void **unused)
{
    bf_buffer b = { 0 };
    json_out w = json_out_to(&b);

    json_out_object(&w);
    json_out_key(&w, "empty");
    json_out_object(&w);
    json_out_object_end(&w);
    json_out_key(&w, "list");
    json_out_array(&w);
    json_out_array(&w);
    json_out_array_end(&w);
    json_out_number(&w, 0.5);
    json_out_integer(&w, INT64_MIN);
    json_out_bool(&w, true);
    json_out_null(&w);
    json_out_raw(&w, "{\"a\":1}", 7);
    json_out_array_end(&w);
    json_out_key_string(&w, "s", "x");
    json_out_key_number(&w, "n", 2.0);
    json_out_key_integer(&w, "i", -3);
    json_out_key_bool(&w, "b", false);
    json_out_key(&w, "p");
    json_out_numbers(&w, (const double[]){ 1.0, -0.5 }, 2, 1);
    json_out_object_end(&w);
    assert_int_equal(json_out_status(&w, NULL), BF_OK);
    assert_string_equal(b.bytes,
                        "{\"empty\":{},\"list\":[[],0.5,-9223372036854775808,true,null,{\"a\":1}],"
                        "\"s\":\"x\",\"n\":2,\"i\":-3,\"b\":false,\"p\":[1,-0.5]}");
    buffer_fini(&b);
}

static void what_is_not_finite_is_null(void **unused)
{
    bf_buffer b = { 0 };
    json_out w = json_out_to(&b);

    json_out_array(&w);
    json_out_number(&w, NAN);
    json_out_number(&w, -INFINITY);
    json_out_string(&w, NULL);
    json_out_array_end(&w);
    assert_string_equal(b.bytes, "[null,null,null]");
    buffer_fini(&b);
}

// Writes the text as a string and gives what a JSON reader makes of it.
static json_t *read_back(const char *text)
{
    bf_buffer b = { 0 };
    json_out w = json_out_to(&b);

    json_out_string(&w, text);
    assert_int_equal(json_out_status(&w, NULL), BF_OK);
    json_t *value = json_loadb(b.bytes, b.n, JSON_DECODE_ANY, NULL);
    buffer_fini(&b);
    assert_non_null(value);
    return value;
}

static void check_string(const char *text, const char *expected)
{
    json_t *value = read_back(text);

    assert_string_equal(json_string_value(value), expected);
    json_decref(value);
}

static void texts_read_back(void **unused)
{
    static const char *const texts[] = {
        "",
        "plain",
        "\"quoted\" \\ back/slash",
        "\b\f\n\r\t\x01\x1f\x7f",
        "\xc3\xa9\xe2\x82\xac",
        "\xf0\x9f\x93\xa6",
        "\xed\x9f\xbf\xee\x80\x80\xf4\x8f\xbf\xbf",
        "\xc2\x80",
    };

    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
        check_string(texts[k], texts[k]);
}

// Bytes that are no UTF-8: stray, overlong, surrogate, beyond U+10FFFF, torn at the end.
static void bytes_that_are_no_text_are_replaced(void **unused)
{
    check_string("a\x80z", "a\xef\xbf\xbdz");
    check_string("\xff", "\xef\xbf\xbd");
    check_string("\xc0\xaf", "\xef\xbf\xbd\xef\xbf\xbd");
    check_string("\xe0\x80\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");
    check_string("\xed\xa0\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");
    check_string("\xf4\x90\x80\x80", "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");
    check_string("\xe2\x82", "\xef\xbf\xbd\xef\xbf\xbd");
    check_string("\xe2\x82\xc3\xa9", "\xef\xbf\xbd\xef\xbf\xbd\xc3\xa9");
}

static void every_pair_of_bytes_gives_json(void **unused)
{
    for (int first = 1; first < 256; first++) {
        for (int second = 1; second < 256; second++) {
            char text[3] = { (char)first, (char)second, '\0' };
            json_decref(read_back(text));
        }
    }
}

static void keys_are_escaped(void **unused)
{
    bf_buffer b = { 0 };
    json_out w = json_out_to(&b);

    json_out_object(&w);
    json_out_key_integer(&w, "a\"b\n", 1);
    json_out_object_end(&w);
    assert_string_equal(b.bytes, "{\"a\\\"b\\n\":1}");
    buffer_fini(&b);
}

static void no_memory_is_remembered(void **unused)
{
    for (size_t n = 1;; n++) {
        bf_buffer b = { 0 };
        bf_error err = { 0 };
        json_out w = json_out_to(&b);
        memory_plan_fault(n, 0);
        json_out_array(&w);
        for (int k = 0; k < 40; k++)
            json_out_key_number(&w, "k", 0.1);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        bf_status status = json_out_status(&w, &err);
        assert_int_equal(status, n_faults == 0 ? BF_OK : BF_ENOMEM);
        assert_int_equal(err.code, status);
        buffer_fini(&b);
        if (n_faults == 0)
            break;
        assert_true(n < 100);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(structure_has_its_commas),
        cmocka_unit_test(what_is_not_finite_is_null),
        cmocka_unit_test(texts_read_back),
        cmocka_unit_test(bytes_that_are_no_text_are_replaced),
        cmocka_unit_test(every_pair_of_bytes_gives_json),
        cmocka_unit_test(keys_are_escaped),
        cmocka_unit_test(no_memory_is_remembered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

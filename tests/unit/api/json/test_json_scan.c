// The scan of JSON text before it is parsed: depth, invalid numbers, and places.

#include "api/json/json_scan.h"

#include "api/json/text.h"
#include "core/base/random.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static json_scan_end scan(const char *json, json_scan_place *ret_place, char pointer[100])
{
    return json_scan(json, strlen(json), ret_place, pointer, 100);
}

static void check_place(const char *json, json_scan_end end, const char *pointer, size_t line,
                        size_t column)
{
    json_scan_place place;
    char found[100];

    assert_int_equal(scan(json, &place, found), end);
    assert_string_equal(found, pointer);
    assert_int_equal(place.line, line);
    assert_int_equal(place.column, column);
}

static void the_end_of_a_text_has_its_pointer(void **unused)
{
    check_place("", JSON_SCAN_ALL, "", 1, 1);
    check_place("{\"a\"", JSON_SCAN_ALL, "/a", 1, 5);
    check_place("{\"a\": [1, {\"b\": 2}, [3,\n\n 4", JSON_SCAN_ALL, "/a/2/1", 3, 3);
    check_place("{\"a\": 1, \"b", JSON_SCAN_ALL, "/b", 1, 12);
    check_place("{\"x/y~z\": [", JSON_SCAN_ALL, "/x~1y~0z/0", 1, 12);
    check_place("{\"a\": {}}", JSON_SCAN_ALL, "", 1, 10);
    check_place("}}]],,::\"\\", JSON_SCAN_ALL, "", 1, 11);
}

static void brackets_in_strings_are_text(void **unused)
{
    check_place("{\"a\": \"[[{\\\"[[\\\\\", \"b\": [", JSON_SCAN_ALL, "/b/0", 1, 26);
}

static void nesting_ends_at_its_limit(void **unused)
{
    json_scan_place place;
    char pointer[100];
    char text[JSON_NESTING_MAX + 2];

    memset(text, '[', sizeof text);
    text[JSON_NESTING_MAX] = '\0';
    assert_int_equal(scan(text, &place, pointer), JSON_SCAN_ALL);
    text[JSON_NESTING_MAX] = '[';
    text[JSON_NESTING_MAX + 1] = '\0';
    assert_int_equal(scan(text, &place, pointer), JSON_SCAN_TOO_DEEP);
    assert_int_equal(place.at, JSON_NESTING_MAX);
}

static void what_is_no_number_is_seen(void **unused)
{
    check_place("{\"a\": NaN", JSON_SCAN_NO_NUMBER, "/a", 1, 7);
    check_place("[1, -Infinity]", JSON_SCAN_NO_NUMBER, "/1", 1, 6);
    check_place("[nan]", JSON_SCAN_NO_NUMBER, "/0", 1, 2);
    check_place("[-inf", JSON_SCAN_NO_NUMBER, "/0", 1, 3);
    check_place("[\"NaN\", true, 1e5, nano", JSON_SCAN_ALL, "/3", 1, 24);
}

// Whatever the bytes, the scan stays within them and within its levels (the sanitizers watch).
static void any_bytes_are_scanned(void **unused)
{
    static const char alphabet[] = "{}[]\",:\\aN1 \n";
    bf_random random;

    random_init(&random, 7);
    for (int k = 0; k < 20000; k++) {
        json_scan_place place;
        char pointer[12];
        char text[48];
        size_t n = random_bits(&random) % sizeof text;
        for (size_t i = 0; i < n; i++)
            text[i] = alphabet[random_bits(&random) % (sizeof alphabet - 1)];
        json_scan(text, n, &place, pointer, sizeof pointer);
        assert_true(place.at <= n);
        assert_true(strlen(pointer) < sizeof pointer);
    }
}

static void distances_count_edits(void **unused)
{
    char longer[TEXT_LENGTH_MAX + 2];

    memset(longer, 'a', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    assert_int_equal(text_distance("", ""), 0);
    assert_int_equal(text_distance("", "abc"), 3);
    assert_int_equal(text_distance("kitten", "sitting"), 3);
    assert_int_equal(text_distance("duration", "duration_s"), 2);
    assert_true(text_distance(longer, "a") == SIZE_MAX);
    assert_int_equal(text_distance(longer + 1, longer + 1), 0);
    assert_true(text_is_near("cell_m", 2));
    assert_false(text_is_near("x_m", 2));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_end_of_a_text_has_its_pointer),
        cmocka_unit_test(brackets_in_strings_are_text),
        cmocka_unit_test(nesting_ends_at_its_limit),
        cmocka_unit_test(what_is_no_number_is_seen),
        cmocka_unit_test(any_bytes_are_scanned),
        cmocka_unit_test(distances_count_edits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

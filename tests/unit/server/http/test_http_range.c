// Byte ranges by RFC 9110, section 14.

#include "server/http/representation.h"
#include "tests/unit/helper_cmocka.h"

static void one_range_is_first_byte_and_length(void **state)
{
    static const struct {
        const char *header;
        uint64_t first, n;
    } cases[] = {
        { "bytes=0-0", 0, 1 },
        { "bytes=0-499", 0, 500 },
        { "bytes=500-", 500, 500 },
        { "bytes=999-", 999, 1 },
        { "bytes=990-99999999999999999999999", 990, 10 },
        { "bytes=-1", 999, 1 },
        { "bytes=-1000", 0, 1000 },
        { "bytes=-5000", 0, 1000 },
        { "Bytes= 1-2 ", 1, 2 },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        uint64_t first = 77, n = 77;
        assert_int_equal(http_range_read(cases[i].header, 1000, &first, &n), HTTP_RANGE_PART);
        assert_int_equal(first, cases[i].first);
        assert_int_equal(n, cases[i].n);
    }
}

static void what_is_not_one_range_is_the_whole(void **state)
{
    static const char *const headers[] = {
        NULL,          "",           "bytes",      "bytes=",    "bytes=-",       "bytes=5",
        "bytes=5-4",   "bytes=a-b",  "bytes=1-2x", "items=0-1", "bytes=0-1,3-4", "bytes=0-,-1",
        "bytes=-1,2-", "bytes=1 -2", "bytes=--1",
    };
    uint64_t first = 77, n = 77;

    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
        assert_int_equal(http_range_read(headers[i], 1000, &first, &n), HTTP_RANGE_WHOLE);
    assert_int_equal(first, 77);
    assert_int_equal(n, 77);
}

static void a_range_behind_the_end_is_told_apart(void **state)
{
    uint64_t first = 77, n = 77;

    assert_int_equal(http_range_read("bytes=1000-", 1000, &first, &n), HTTP_RANGE_BEYOND);
    assert_int_equal(http_range_read("bytes=99999999999999999999999-", 1000, &first, &n),
                     HTTP_RANGE_BEYOND);
    assert_int_equal(http_range_read("bytes=-0", 1000, &first, &n), HTTP_RANGE_BEYOND);
    assert_int_equal(http_range_read("bytes=0-", 0, &first, &n), HTTP_RANGE_BEYOND);
    assert_int_equal(http_range_read("bytes=-5", 0, &first, &n), HTTP_RANGE_BEYOND);
    assert_int_equal(first, 77);
}

static void a_range_counts_for_the_state_that_the_client_has(void **state)
{
    assert_true(http_range_is_current(NULL, "\"a\""));
    assert_true(http_range_is_current("\"a\"", "\"a\""));
    assert_false(http_range_is_current("\"b\"", "\"a\""));
    assert_false(http_range_is_current("W/\"a\"", "\"a\""));
    assert_false(http_range_is_current("W/\"a\"", "W/\"a\""));
    assert_false(http_range_is_current("Wed, 21 Oct 2026 07:28:00 GMT", "\"a\""));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_range_is_first_byte_and_length),
        cmocka_unit_test(what_is_not_one_range_is_the_whole),
        cmocka_unit_test(a_range_behind_the_end_is_told_apart),
        cmocka_unit_test(a_range_counts_for_the_state_that_the_client_has),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

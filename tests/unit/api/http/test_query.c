// Query strings: decoding by RFC 3986 and the HTML form rules, and the limits.

#include "api/http/query.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static query parse(const char *text)
{
    query q = { 0 };
    bf_error err = { 0 };

    if (query_parse(text, &q, &err) != BF_OK)
        fail_msg("%s", err.text);
    return q;
}

static void names_and_values_are_decoded(void **state)
{
    query q = parse("a=1&b%5B0%5d=x%26y%3Dz&&c=%C3%A4+b&d&e=&f=p=q&");

    assert_int_equal(q.n, 6);
    assert_string_equal(query_value(&q, "a"), "1");
    assert_string_equal(query_value(&q, "b[0]"), "x&y=z");
    assert_string_equal(query_value(&q, "c"), "\xc3\xa4 b");
    assert_string_equal(query_value(&q, "d"), "");
    assert_string_equal(query_value(&q, "e"), "");
    assert_string_equal(query_value(&q, "f"), "p=q");
    assert_null(query_value(&q, "g"));
    assert_null(query_value(&q, ""));
}

static void no_query_has_no_parameters(void **state)
{
    assert_int_equal(parse("").n, 0);
    assert_int_equal(parse("&&&").n, 0);
}

static void broken_text_is_refused_and_nothing_returned(void **state)
{
    static const char *const texts[] = { "a=%",  "a=%4",  "a=%4g", "%zz=1", "a=%00",   "a=%0a",
                                         "a=\t", "a=%7f", "=1",    "=",     "a=1&a=2", "a&b&%61" };

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        query q = { .n = 99 };
        bf_error err = { 0 };
        assert_int_equal(query_parse(texts[i], &q, &err), BF_EINPUT);
        assert_int_equal(q.n, 99);
        assert_true(err.text[0] != '\0');
    }
}

static void a_parameter_given_twice_is_named(void **state)
{
    query q = { 0 };
    bf_error err = { 0 };

    assert_int_equal(query_parse("limit=1&limit=2", &q, &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "'limit'"));
}

static void limits_hold_to_the_byte_and_to_the_parameter(void **state)
{
    char text[QUERY_SIZE + 1];
    query q = { 0 };

    memset(text, 'a', sizeof text);
    text[QUERY_SIZE - 2] = '\0';
    assert_int_equal(query_parse(text, &q, NULL), BF_OK);
    assert_int_equal(strlen(q.text + q.params[0].name), QUERY_SIZE - 2);
    text[QUERY_SIZE - 2] = 'a';
    text[QUERY_SIZE - 1] = '\0';
    assert_int_equal(query_parse(text, &q, NULL), BF_ELIMIT);

    assert_int_equal(parse("a&b&c&d&e&f&g&h&i&j&k&l&m&n&o&p").n, QUERY_PARAMS_MAX);
    assert_int_equal(query_parse("a&b&c&d&e&f&g&h&i&j&k&l&m&n&o&p&q", &q, NULL), BF_ELIMIT);
}

// The most text that a query can decode to: pairs without anything between their separators.
static void the_densest_query_fits(void **state)
{
    char text[QUERY_SIZE];

    memset(text, 'v', sizeof text);
    for (size_t i = 0; i < 15; i++) {
        memcpy(text + 4 * i, "a=1&", 4);
        text[4 * i] = (char)('a' + i);
    }
    memcpy(text + 60, "x=", 2);
    text[QUERY_SIZE - 2] = '\0';
    query q = parse(text);
    assert_int_equal(q.n, 16);
    assert_int_equal(strlen(query_value(&q, "x")), QUERY_SIZE - 2 - 62);
}

static void only_known_parameters_are_allowed(void **state)
{
    static const param status = { .name = "status", .in = "query", .kind = &param_text };
    static const param model = { .name = "model", .in = "query", .kind = &param_text };
    static const param limit = { .name = "limit", .in = "query", .kind = &param_text };
    static const param id = { .name = "id", .in = "path", .kind = &param_text };
    const param *const all[] = { &id, &status, &model, &limit, NULL };
    const param *const few[] = { &id, &status, &model, NULL };
    const param *const none[] = { &id, NULL };
    query q = parse("status=queued&limit=1");
    bf_error err = { 0 };

    assert_int_equal(query_check(&q, all, &err), BF_OK);
    assert_int_equal(query_check(&q, few, &err), BF_EINPUT);
    assert_string_equal(err.text, "query parameter 'limit' is not known here; known: status model");
    assert_int_equal(query_check(&q, none, &err), BF_EINPUT);
    assert_string_equal(err.text, "query parameter 'status' is not known here; known: none");
    q = parse("id=1");
    assert_int_equal(query_check(&q, few, &err), BF_EINPUT);
    q = parse("status%20model=1");
    assert_int_equal(query_check(&q, few, &err), BF_EINPUT);
}

static void a_value_that_is_not_given_is_the_default(void **state)
{
    static const param given = { .name = "n", .in = "query", .kind = &param_whole, .most = 200 };
    static const param other = { .name = "m", .in = "query", .kind = &param_whole, .most = 9 };
    static const param usual = {
        .name = "k", .in = "query", .kind = &param_whole, .default_text = "50", .most = 200
    };
    const param *const rows[] = { &given, &other, &usual, NULL };
    param_value value = { .whole = 7 };
    query q = parse("n=200");

    assert_int_equal(query_check(&q, rows, NULL), BF_OK);
    assert_false(query_read(&q, rows, "m", &value));
    assert_int_equal(value.whole, 7);
    assert_true(query_read(&q, rows, "n", &value));
    assert_int_equal(value.whole, 200);
    assert_true(query_read(&q, rows, "k", &value));
    assert_int_equal(value.whole, 50);
}

static void what_is_required_must_be_given(void **state)
{
    static const param runs = { .name = "runs",
                                .in = "query",
                                .kind = &param_ids,
                                .least = 1,
                                .most = 4,
                                .is_required = true };
    const param *const rows[] = { &runs, NULL };
    query q = parse("");
    bf_error err = { 0 };

    assert_int_equal(query_check(&q, rows, &err), BF_EINPUT);
    assert_string_equal(err.text, "query parameter 'runs' is missing: ids with commas");
}

static void bytes_that_are_not_kept_are_escaped(void **state)
{
    char text[32];

    assert_int_equal(query_write_escaped("a b/\xc3\xa9~", "", text, sizeof text), 15);
    assert_string_equal(text, "a%20b%2F%C3%A9~");
    assert_int_equal(query_write_escaped("a b/c", "/", text, sizeof text), 7);
    assert_string_equal(text, "a%20b/c");
    assert_int_equal(query_write_escaped("ab   ", "", text, 9), 8);
    assert_string_equal(text, "ab%20%20");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_and_values_are_decoded),
        cmocka_unit_test(no_query_has_no_parameters),
        cmocka_unit_test(broken_text_is_refused_and_nothing_returned),
        cmocka_unit_test(a_parameter_given_twice_is_named),
        cmocka_unit_test(limits_hold_to_the_byte_and_to_the_parameter),
        cmocka_unit_test(the_densest_query_fits),
        cmocka_unit_test(only_known_parameters_are_allowed),
        cmocka_unit_test(a_value_that_is_not_given_is_the_default),
        cmocka_unit_test(what_is_required_must_be_given),
        cmocka_unit_test(bytes_that_are_not_kept_are_escaped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

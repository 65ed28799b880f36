// Accept negotiation: the rules and the example of RFC 9110, 12.5.1.

#include "api/http/accept.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const char *const offers[] = { "application/json", "text/csv" };

static int choose(const char *header)
{
    return accept_choose(header, offers, 2);
}

static void without_accept_the_first_offer_is_taken(void **state)
{
    (void)state;
    assert_int_equal(choose(NULL), 0);
    assert_int_equal(choose(""), 0);
    assert_int_equal(choose("  "), 0);
    assert_int_equal(choose("*/*"), 0);
}

static void a_named_type_is_taken(void **state)
{
    (void)state;
    assert_int_equal(choose("text/csv"), 1);
    assert_int_equal(choose("TEXT/CSV"), 1);
    assert_int_equal(choose("text/*"), 1);
    assert_int_equal(choose("text/csv; charset=utf-8"), 1);
    assert_int_equal(choose("text/html, text/csv, image/png"), 1);
}

static void the_larger_quality_wins(void **state)
{
    (void)state;
    assert_int_equal(choose("application/json;q=0.5, text/csv"), 1);
    assert_int_equal(choose("application/json; q=0.5 , text/csv ; q=0.4"), 0);
    assert_int_equal(choose("application/json;q=0.123,text/csv;Q=0.124"), 1);
    assert_int_equal(choose("text/csv;q=0.9,*/*;q=0.8"), 1);
}

static void among_equals_the_order_of_the_offers_decides(void **state)
{
    (void)state;
    assert_int_equal(choose("text/csv, application/json"), 0);
    assert_int_equal(choose("text/csv;q=0.3, application/json;q=0.3"), 0);
}

static void the_more_specific_range_counts(void **state)
{
    (void)state;
    assert_int_equal(choose("application/json;q=0.1, */*;q=0.9"), 1);
    assert_int_equal(choose("*/*;q=0.9, application/*;q=0.1"), 1);
    assert_int_equal(choose("application/json;q=0, */*"), 1);
    assert_int_equal(choose("application/*, application/json;q=0.2, text/csv;q=0.3"), 1);
}

static void what_is_not_asked_for_or_refused_is_not_given(void **state)
{
    (void)state;
    assert_int_equal(choose("text/html"), -1);
    assert_int_equal(choose("*/*;q=0"), -1);
    assert_int_equal(choose("text/csv;q=0, application/json;q=0.000"), -1);
    assert_int_equal(choose("application/jsonx"), -1);
    assert_int_equal(choose("application/jso"), -1);
    assert_int_equal(choose("*/json"), -1);
    assert_int_equal(accept_choose(NULL, offers, 0), -1);
}

static void members_that_cannot_be_read_accept_nothing(void **state)
{
    static const char *const headers[] = {
        "json",
        "/",
        "text/",
        "text/csv;q=2",
        "text/csv;q=1.001",
        "text/csv;q=x",
        "text/csv;q=",
        "text/csv;q=0.1234",
        "text/csv;q",
        "text/csv x",
        "text/csv;=1",
        ",,,",
        ";",
        "text/csv;a=\"x",
        "text/csv;q=.5",
    };

    (void)state;
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        if (choose(headers[i]) != -1)
            fail_msg("%s", headers[i]);
    }
    assert_int_equal(choose("text/csv;q=2, application/json;q=0.1"), 0);
    assert_int_equal(choose(", ,text/csv"), 1);
}

static void a_comma_in_a_quoted_parameter_does_not_end_the_member(void **state)
{
    (void)state;
    assert_int_equal(choose("text/csv;a=\"b,c;q=0\\\",d\";q=0.5, application/json;q=0.4"), 1);
}

static void a_browser_gets_json_for_a_page(void **state)
{
    (void)state;
    assert_int_equal(choose("text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"), 0);
}

// The table of RFC 9110 for its example header, as far as its parameters do not tell types apart.
static void the_example_of_the_rfc_holds(void **state)
{
    static const char header[] = "text/*;q=0.3, text/plain;q=0.7, */*;q=0.5";
    static const char *const pairs[][2] = { { "text/html", "text/plain" },
                                            { "text/html", "image/jpeg" },
                                            { "image/jpeg", "text/plain" } };

    (void)state;
    for (size_t i = 0; i < 3; i++)
        assert_int_equal(accept_choose(header, pairs[i], 2), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_accept_the_first_offer_is_taken),
        cmocka_unit_test(a_named_type_is_taken),
        cmocka_unit_test(the_larger_quality_wins),
        cmocka_unit_test(among_equals_the_order_of_the_offers_decides),
        cmocka_unit_test(the_more_specific_range_counts),
        cmocka_unit_test(what_is_not_asked_for_or_refused_is_not_given),
        cmocka_unit_test(members_that_cannot_be_read_accept_nothing),
        cmocka_unit_test(a_comma_in_a_quoted_parameter_does_not_end_the_member),
        cmocka_unit_test(a_browser_gets_json_for_a_page),
        cmocka_unit_test(the_example_of_the_rfc_holds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

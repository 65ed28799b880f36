// What clients ask for in headers: Accept by the rules and the example of RFC 9110, 12.5.1; Accept-Encoding,
// 12.5.3; entity tags by weak and strong comparison, 8.8.3.2; Prefer, RFC 7240; Idempotency-Key as a string
// of structured fields (RFC 8941) and bare.

#include "api/http/negotiation.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

#include <limits.h>

static const char *const offers[] = { "application/json", "text/csv" };

static int choose(const char *header)
{
    return negotiation_choose_type(header, offers, 2);
}

static void without_accept_the_first_offer_is_taken(void **state)
{
    assert_int_equal(choose(NULL), 0);
    assert_int_equal(choose(""), 0);
    assert_int_equal(choose("  "), 0);
    assert_int_equal(choose("*/*"), 0);
}

static void a_named_type_is_taken(void **state)
{
    assert_int_equal(choose("text/csv"), 1);
    assert_int_equal(choose("TEXT/CSV"), 1);
    assert_int_equal(choose("text/*"), 1);
    assert_int_equal(choose("text/csv; charset=utf-8"), 1);
    assert_int_equal(choose("text/html, text/csv, image/png"), 1);
}

static void the_larger_quality_wins(void **state)
{
    assert_int_equal(choose("application/json;q=0.5, text/csv"), 1);
    assert_int_equal(choose("application/json; q=0.5 , text/csv ; q=0.4"), 0);
    assert_int_equal(choose("application/json;q=0.123,text/csv;Q=0.124"), 1);
    assert_int_equal(choose("text/csv;q=0.9,*/*;q=0.8"), 1);
}

static void among_equals_the_order_of_the_offers_decides(void **state)
{
    assert_int_equal(choose("text/csv, application/json"), 0);
    assert_int_equal(choose("text/csv;q=0.3, application/json;q=0.3"), 0);
}

static void the_more_specific_range_counts(void **state)
{
    assert_int_equal(choose("application/json;q=0.1, */*;q=0.9"), 1);
    assert_int_equal(choose("*/*;q=0.9, application/*;q=0.1"), 1);
    assert_int_equal(choose("application/json;q=0, */*"), 1);
    assert_int_equal(choose("application/*, application/json;q=0.2, text/csv;q=0.3"), 1);
}

static void what_is_not_asked_for_or_refused_is_not_given(void **state)
{
    assert_int_equal(choose("text/html"), -1);
    assert_int_equal(choose("*/*;q=0"), -1);
    assert_int_equal(choose("text/csv;q=0, application/json;q=0.000"), -1);
    assert_int_equal(choose("application/jsonx"), -1);
    assert_int_equal(choose("application/jso"), -1);
    assert_int_equal(choose("*/json"), -1);
    assert_int_equal(negotiation_choose_type(NULL, offers, 0), -1);
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

    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        if (choose(headers[i]) != -1)
            fail_msg("%s", headers[i]);
    }
    assert_int_equal(choose("text/csv;q=2, application/json;q=0.1"), 0);
    assert_int_equal(choose(", ,text/csv"), 1);
}

static void a_comma_in_a_quoted_parameter_does_not_end_the_member(void **state)
{
    assert_int_equal(choose("text/csv;a=\"b,c;q=0\\\",d\";q=0.5, application/json;q=0.4"), 1);
}

static void a_browser_gets_json_for_a_page(void **state)
{
    assert_int_equal(choose("text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8"), 0);
}

// The table of RFC 9110 for its example header, as far as its parameters do not tell types apart.
static void the_example_of_the_rfc_holds(void **state)
{
    static const char header[] = "text/*;q=0.3, text/plain;q=0.7, */*;q=0.5";
    static const char *const pairs[][2] = { { "text/html", "text/plain" },
                                            { "text/html", "image/jpeg" },
                                            { "image/jpeg", "text/plain" } };

    for (size_t i = 0; i < 3; i++)
        assert_int_equal(negotiation_choose_type(header, pairs[i], 2), 1);
}

static void the_header_says_what_each_coding_is_worth(void **state)
{
    static const struct {
        const char *header;
        int zstd, gzip, identity;
    } cases[] = {
        { NULL, 0, 0, 1 },
        { "", 0, 0, 1 },
        { "gzip", 0, 1000, 1 },
        { "GZip;q=0.5, zstd ; q=0.25", 250, 500, 1 },
        { "x-gzip", 0, 1000, 1 },
        { "*", 1000, 1000, 1000 },
        { "*;q=0", 0, 0, 0 },
        { "*;q=0, gzip", 0, 1000, 0 },
        { "gzip, *;q=0.1", 100, 1000, 100 },
        { "gzip;q=0, *", 1000, 0, 1000 },
        { "identity;q=0, gzip;q=0.001", 0, 1, 0 },
        { "gzip;q=2, zstd;q=0.1", 100, 0, 1 },
        { "br, deflate", 0, 0, 1 },
        { "gzipped", 0, 0, 1 },
        { ",, gzip ,", 0, 1000, 1 },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(negotiation_coding_quality(cases[i].header, CODING_ZSTD), cases[i].zstd);
        assert_int_equal(negotiation_coding_quality(cases[i].header, CODING_GZIP), cases[i].gzip);
        assert_int_equal(negotiation_coding_quality(cases[i].header, CODING_IDENTITY),
                         cases[i].identity);
    }
}

static void the_best_liked_is_chosen_and_of_equals_the_first(void **state)
{
    static const coding codings[] = { CODING_ZSTD, CODING_GZIP, CODING_IDENTITY };
    static const struct {
        const char *header;
        int chosen;
    } cases[] = {
        { NULL, 2 },
        { "deflate, gzip, br, zstd", 0 },
        { "gzip", 1 },
        { "gzip, identity", 1 },
        { "gzip;q=0.5, identity", 2 },
        { "zstd;q=0.5, gzip;q=0.6", 1 },
        { "*;q=0", -1 },
        { "identity;q=0", -1 },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_int_equal(negotiation_choose_coding(cases[i].header, codings, 3), cases[i].chosen);
    assert_int_equal(negotiation_choose_coding("gzip", codings, 0), -1);
}

static void each_form_has_a_tag_of_its_own(void **state)
{
    char tag[CODING_TAG_SIZE];

    negotiation_coding_tag("r1", CODING_IDENTITY, tag);
    assert_string_equal(tag, "r1");
    negotiation_coding_tag("r1", CODING_GZIP, tag);
    assert_string_equal(tag, "r1-gzip");
    negotiation_coding_tag("r1", CODING_ZSTD, tag);
    assert_string_equal(tag, "r1-zstd");
}

static void a_client_knows_a_state_by_the_tag_of_any_form_that_it_takes(void **state)
{
    static const struct {
        const char *list, *accepted, *form; // form NULL: not known
    } cases[] = {
        { "\"a\"", NULL, "a" },
        { "W/\"a\"", NULL, "a" },
        { "\"b\", \"a\"", NULL, "a" },
        { " ,\"b\",,W/\"a\" ", NULL, "a" },
        { "*", NULL, "a" },
        { "\"a-gzip\"", "gzip", "a-gzip" },
        { "\"a-gzip\"", NULL, NULL },
        { "\"a-gzip\"", "zstd", NULL },
        { "\"a-zstd\", \"a\"", "gzip", "a" },
        { "\"a\"", "gzip, identity;q=0", NULL },
        { "\"ab\"", NULL, NULL },
        { "\"\"", NULL, NULL },
        { "a", NULL, NULL },
        { "\"a", NULL, NULL },
        { "", NULL, NULL },
        { "b, \"a\"", NULL, NULL },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char form[CODING_TAG_SIZE] = "as it was";
        bool is_known = negotiation_match_etag(cases[i].list, "a", cases[i].accepted, form);
        assert_int_equal(is_known, cases[i].form != NULL);
        assert_string_equal(form, is_known ? cases[i].form : "as it was");
    }
}

static void a_change_needs_the_strong_tag_of_any_form(void **state)
{
    assert_true(negotiation_allows_change("*", "a"));
    assert_true(negotiation_allows_change("\"a\"", "a"));
    assert_true(negotiation_allows_change("\"x\", \"a-zstd\"", "a"));
    assert_false(negotiation_allows_change("W/\"a\"", "a"));
    assert_false(negotiation_allows_change("\"b\"", "a"));
    assert_false(negotiation_allows_change("", "a"));
}

static void the_seconds_are_found_among_other_preferences(void **state)
{
    static const struct {
        const char *header;
        unsigned seconds;
    } cases[] = {
        { "wait=10", 10 },
        { "respond-async, wait=10", 10 },
        { "WAIT = 7 ; x=y, foo", 7 },
        { "return=minimal; note=\"a, wait=3\", wait=\"4\"", 4 },
        { "wait=5, wait=6", 5 },
        { "wait=0", 0 },
        { "wait=99999999999999999999", UINT_MAX },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        unsigned seconds = 12345;
        assert_true(negotiation_read_wait(cases[i].header, &seconds));
        assert_int_equal(seconds, cases[i].seconds);
    }
}

static void what_cannot_be_read_is_no_preference(void **state)
{
    static const char *const headers[] = { "",        "wait",      "wait=",     "wait=x",
                                           "wait=-1", "wait=1.5",  "wait=\"1",  "waiting=3",
                                           "await=3", "foo=wait=", "x; wait=3", "wait=3x" };
    unsigned seconds = 12345;

    assert_false(negotiation_read_wait(NULL, &seconds));
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++)
        assert_false(negotiation_read_wait(headers[i], &seconds));
    assert_int_equal(seconds, 12345);
}

static void both_forms_of_a_key_are_the_same_key(void **state)
{
    static const char *const forms[][2] = {
        { "\"8e03978e-40d5-43dd-bc93-6894a57f9324\"", "8e03978e-40d5-43dd-bc93-6894a57f9324" },
        { "8e03978e-40d5-43dd-bc93-6894a57f9324", "8e03978e-40d5-43dd-bc93-6894a57f9324" },
        { " a ", "a" },
        { "\"two words, one key; really\"", "two words, one key; really" },
        { "\"a\\\"b\\\\c\"", "a\"b\\c" },
        { "YWJj+/==", "YWJj+/==" },
    };

    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        char key[API_KEY_SIZE] = "?";
        assert_int_equal(negotiation_read_key(forms[i][0], key, NULL), BF_OK);
        assert_string_equal(key, forms[i][1]);
    }
}

static void no_header_is_no_key(void **state)
{
    char key[API_KEY_SIZE] = "?";

    assert_int_equal(negotiation_read_key(NULL, key, NULL), BF_OK);
    assert_string_equal(key, "");
}

static void what_is_no_key_is_refused_and_leaves_the_place_alone(void **state)
{
    static const char *const bad[] = {
        "",
        " ",
        "\"\"",
        "\"",
        "\"a",
        "a\"",
        "a b",
        "a, b",
        "\"a\", \"b\"",
        "\"a\";p",
        "a\\b",
        "\"a\\b\"",
        "\"a\x01\"",
        "\"a\xc3\xa4\"",
        "\xc3\xa4",
        "\"a\\",
        "a\tb",
    };

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char key[API_KEY_SIZE] = "?";
        bf_error err = { 0 };
        assert_int_equal(negotiation_read_key(bad[i], key, &err), BF_EINPUT);
        assert_non_null(strstr(err.text, "Idempotency-Key is no key"));
        assert_string_equal(key, "?");
    }
}

static void a_key_has_at_most_255_bytes(void **state)
{
    char header[600], key[API_KEY_SIZE] = "?";
    bf_error err = { 0 };

    memset(header, 'k', 255);
    header[255] = '\0';
    assert_int_equal(negotiation_read_key(header, key, NULL), BF_OK);
    assert_int_equal(strlen(key), 255);
    memset(header, 'k', 256);
    header[256] = '\0';
    assert_int_equal(negotiation_read_key(header, key, &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "more than 255 bytes"));
    // In quotes it is the key that counts, not what it takes to write it.
    header[0] = '"';
    for (int i = 0; i < 255; i++)
        memcpy(header + 1 + 2 * i, "\\\"", 2);
    memcpy(header + 511, "\"", 2);
    assert_int_equal(negotiation_read_key(header, key, NULL), BF_OK);
    assert_int_equal(strlen(key), 255);
    memcpy(header + 511, "k\"", 3);
    assert_int_equal(negotiation_read_key(header, key, &err), BF_EINPUT);
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
        cmocka_unit_test(the_header_says_what_each_coding_is_worth),
        cmocka_unit_test(the_best_liked_is_chosen_and_of_equals_the_first),
        cmocka_unit_test(each_form_has_a_tag_of_its_own),
        cmocka_unit_test(a_client_knows_a_state_by_the_tag_of_any_form_that_it_takes),
        cmocka_unit_test(a_change_needs_the_strong_tag_of_any_form),
        cmocka_unit_test(the_seconds_are_found_among_other_preferences),
        cmocka_unit_test(what_cannot_be_read_is_no_preference),
        cmocka_unit_test(both_forms_of_a_key_are_the_same_key),
        cmocka_unit_test(no_header_is_no_key),
        cmocka_unit_test(what_is_no_key_is_refused_and_leaves_the_place_alone),
        cmocka_unit_test(a_key_has_at_most_255_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Requests of pages from other origins, by the Fetch standard.

#include "server/http/cors.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

#define ONE  "https://plan.example:8443"
#define LIST "http://a.example, " ONE

static api_response response;

static const char *ask(const char *origins, const char *method, const char *origin,
                       const char *asked, const char *header)
{
    response = (api_response){ .status = 204 };
    api_response_header(&response, "Allow", "GET, HEAD, OPTIONS");
    http_cors_answer(origins, method, origin, asked, &response);
    assert_null(api_response_find(&response, "Access-Control-Allow-Credentials"));
    return api_response_find(&response, header);
}

static void nobody_is_allowed_unless_configured(void **state)
{
    assert_null(ask("", "GET", ONE, NULL, "Access-Control-Allow-Origin"));
    assert_int_equal(response.n_headers, 1);
}

static void a_listed_origin_is_named(void **state)
{
    assert_string_equal(ask(LIST, "GET", ONE, NULL, "Access-Control-Allow-Origin"), ONE);
    assert_string_equal(api_response_find(&response, "Vary"), "Origin");
    const char *exposed = api_response_find(&response, "Access-Control-Expose-Headers");
    assert_non_null(strstr(exposed, "ETag"));
    assert_non_null(strstr(exposed, "Location"));
    assert_null(api_response_find(&response, "Access-Control-Allow-Methods"));
}

// A cache must not give one page's answer to another, so all of them vary.
static void others_get_nothing_but_vary(void **state)
{
    static const char *const origins[] = {
        NULL, "https://plan.example",      "http://a.example.evil", "null",
        "",   "https://plan.example:84430"
    };

    for (size_t i = 0; i < sizeof origins / sizeof *origins; i++) {
        assert_null(ask(LIST, "GET", origins[i], NULL, "Access-Control-Allow-Origin"));
        assert_string_equal(api_response_find(&response, "Vary"), "Origin");
        assert_int_equal(response.n_headers, 2);
    }
}

static void anybody_is_answered_by_a_star(void **state)
{
    assert_string_equal(ask("*", "GET", "null", NULL, "Access-Control-Allow-Origin"), "*");
    assert_null(api_response_find(&response, "Vary"));
    assert_null(ask("*", "GET", NULL, NULL, "Access-Control-Allow-Origin"));
}

static void a_preflight_tells_methods_headers_and_for_how_long(void **state)
{
    assert_string_equal(ask(LIST, "OPTIONS", ONE, "DELETE", "Access-Control-Allow-Methods"),
                        "GET, HEAD, OPTIONS");
    assert_non_null(
        strstr(api_response_find(&response, "Access-Control-Allow-Headers"), "Content-Type"));
    assert_string_equal(api_response_find(&response, "Access-Control-Max-Age"), "7200");
    assert_null(ask(LIST, "OPTIONS", "http://b", "DELETE", "Access-Control-Allow-Methods"));
    assert_null(ask(LIST, "OPTIONS", ONE, NULL, "Access-Control-Allow-Methods"));
}

static void settings_are_origins_and_nothing_else(void **state)
{
    static const char *const good[] = {
        "", "*", ONE, LIST, "http://[::1]:5173 http://a", " , http://a ,"
    };
    static const char *const bad[] = { "plan.example", "https://plan.example/",
                                       "https://",     "* http://a",
                                       "http://A",     "ftp://a",
                                       "null",         "http://a;http://b" };
    bf_error err = { 0 };

    for (size_t i = 0; i < sizeof good / sizeof *good; i++)
        assert_int_equal(http_cors_check(good[i], &err), BF_OK);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(http_cors_check(bad[i], &err), BF_EINPUT);
}

// Fetch Metadata, and Origin where a browser has none: what a page of another origin may not make a browser do.
static void a_change_that_another_page_asks_for_is_forged(void **state)
{
    static const struct {
        const char *origins, *method, *origin, *site, *host;
        bool is_forged;
    } cases[] = {
        { "", "POST", ONE, "cross-site", "here", true },
        { "", "DELETE", ONE, "cross-site", "here", true },
        { "", "POST", NULL, "cross-site", "here", true },
        { "", "POST", "null", "cross-site", "here", true },
        { LIST, "POST", "https://evil.example", "cross-site", "here", true },
        { LIST, "POST", NULL, "cross-site", "here", true },
        { LIST, "POST", ONE, "cross-site", "here", false },
        { "*", "POST", ONE, "cross-site", "here", false },
        { "", "POST", ONE, "same-origin", "here", false },
        { "", "POST", ONE, "none", "here", false },
        { "", "GET", NULL, "cross-site", "here", false },
        { "", "HEAD", NULL, "cross-site", "here", false },
        { "", "OPTIONS", ONE, "cross-site", "here", false },
        // Another port of the same host, which a browser with Fetch Metadata calls the same site.
        { "", "POST", "http://here:9000", "same-site", "here:8080", true },
        { "", "POST", NULL, "same-site", "here:8080", true },
        { "http://here:9000", "POST", "http://here:9000", "same-site", "here:8080", false },
        // Browsers without Fetch Metadata; also those of today where there is no TLS.
        { "", "POST", ONE, NULL, "here", true },
        { "", "DELETE", "null", NULL, "here", true },
        { "", "POST", "http://here:9000", NULL, "here:8080", true },
        { "", "POST", "http://here.example", NULL, "here", true },
        { "", "POST", "http://here", NULL, NULL, true },
        { "", "POST", "http://here:8080", NULL, "here:8080", false },
        { "", "POST", "http://Here:8080", NULL, "here:8080", false },
        { "", "POST", "https://here", NULL, "here:443", false },
        { "", "POST", "http://here", NULL, "here", false },
        { "", "POST", "http://[::1]:8080", NULL, "[::1]:8080", false },
        { LIST, "POST", ONE, NULL, "here", false },
        { "", "GET", ONE, NULL, "here", false },
        { "", "POST", NULL, NULL, "here", false }, // no browser
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const http_cors_sender sender = { .method = cases[i].method,
                                          .origin = cases[i].origin,
                                          .fetch_site = cases[i].site,
                                          .host = cases[i].host };
        assert_int_equal(http_cors_is_forged(cases[i].origins, &sender), cases[i].is_forged);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nobody_is_allowed_unless_configured),
        cmocka_unit_test(a_listed_origin_is_named),
        cmocka_unit_test(others_get_nothing_but_vary),
        cmocka_unit_test(anybody_is_answered_by_a_star),
        cmocka_unit_test(a_preflight_tells_methods_headers_and_for_how_long),
        cmocka_unit_test(a_change_that_another_page_asks_for_is_forged),
        cmocka_unit_test(settings_are_origins_and_nothing_else),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

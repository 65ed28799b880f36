// Unit tests of the header guard: pure functions over the bytes of a request.

#include "server/http/guard.h"

#include "api/http/exchange.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

// Headers as they stand, "Name: value" each; what the guard says of them.
typedef struct guard_case {
    const char *method;
    const char *version;
    const char *headers[4];
    int status;
} guard_case;

static int judge(const guard_case *c, bf_error *err)
{
    http_guard guard = { 0 };

    for (size_t i = 0; i < 4 && c->headers[i] != NULL; i++) {
        const char *colon = strchr(c->headers[i], ':');
        assert_non_null(colon);
        http_guard_header(&guard, c->headers[i], (size_t)(colon - c->headers[i]), colon + 2,
                          strlen(colon + 2));
    }
    return http_guard_verdict(&guard, c->method, c->version, err);
}

static void every_row_of_the_table_is_judged_as_it_says(void **state)
{
    static const guard_case cases[] = {
        { "GET", "HTTP/1.1", { "Host: a" }, 0 },
        { "GET", "HTTP/1.0", { NULL }, 0 },
        { "GET", "HTTP/1.0", { "Host: a" }, 0 },
        { "POST", "HTTP/1.1", { "Host: a", "Content-Length: 3" }, 0 },
        { "POST", "HTTP/1.1", { "hOST: a", "transfer-encoding: CHUNKED" }, 0 },
        { "GET", "HTTP/1.1", { "Host: a", "X: tab\there" }, 0 },
        { "GET", "HTTP/1.1", { "Host: a", "X: \xc3\xa4" }, 0 },
        { "GET", "HTTP/1.1", { NULL }, 400 },
        { "GET", "HTTP/1.1", { "Host: a", "Host: a" }, 400 },
        { "GET", "HTTP/1.0", { "Host: a", "host: b" }, 400 },
        { "POST", "HTTP/1.1", { "Host: a", "Content-Length: 3", "content-length: 3" }, 400 },
        { "POST",
          "HTTP/1.1",
          { "Host: a", "Transfer-Encoding: chunked", "Transfer-Encoding: chunked" },
          400 },
        { "POST",
          "HTTP/1.1",
          { "Host: a", "Content-Length: 3", "Transfer-Encoding: chunked" },
          400 },
        { "POST", "HTTP/1.0", { "Host: a", "Transfer-Encoding: chunked" }, 400 },
        { "POST", "HTTP/1.1", { "Host: a", "Transfer-Encoding: gzip, chunked" }, 501 },
        { "POST", "HTTP/1.1", { "Host: a", "Transfer-Encoding: chunked;a=b" }, 501 },
        { "POST", "HTTP/1.1", { "Host: a", "Transfer-Encoding: identity" }, 501 },
        { "POST", "HTTP/1.1", { "Host: a", "Transfer-Encoding: " }, 501 },
        { "GET", "HTTP/1.1", { "Host: a", ": x" }, 400 },
        { "GET", "HTTP/1.1", { "Host: a", "X : x" }, 400 },
        { "GET", "HTTP/1.1", { "Host: a", "X\xc3\xa4: x" }, 400 },
        { "GET", "HTTP/1.1", { "Host: a", "X(y): x" }, 400 },
        { "GET", "HTTP/1.1", { "Host: a", "X: bell\a" }, 400 },
        { "GET", "HTTP/1.1", { "Host: a", "X: del\x7f" }, 400 },
        { "GET", "HTTP/1.1", { "Host: a", "X: return\rhere" }, 400 },
        { "G@T", "HTTP/1.1", { "Host: a" }, 400 },
        { "", "HTTP/1.1", { "Host: a" }, 400 },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bf_error err = { 0 };
        int status = judge(&cases[i], &err);
        if (status != cases[i].status)
            print_error("case %zu: %d instead of %d (%s)\n", i, status, cases[i].status, err.text);
        assert_int_equal(status, cases[i].status);
        assert_int_equal(err.text[0] != '\0', status != 0);
    }
}

static void a_zero_byte_in_a_value_is_refused(void **state)
{
    http_guard guard = { 0 };

    http_guard_header(&guard, "Host", 4, "a", 1);
    http_guard_header(&guard, "X", 1, "a\0b", 3);
    assert_int_equal(http_guard_verdict(&guard, "GET", "HTTP/1.1", NULL), 400);
}

// A request as MHD leaves it: names and values in place, their separators overwritten by zeros.
static void each_line_must_follow_the_one_before_it(void **state)
{
    static const char request[] = "GET\0/\0HTTP/1.1\0\0Host\0 a\0\0X\0 b\0\0\0\0";
    const char *host = request + 16, *x = host + 9;
    static const struct {
        size_t moved_host, moved_x, moved_end;
        int status;
    } cases[] = { { 0, 0, 0, 0 }, { 1, 0, 0, 400 }, { 0, 1, 0, 400 }, { 0, 0, 1, 400 } };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        http_guard guard = { .next = host - cases[i].moved_host };
        http_guard_header(&guard, host, 4, host + 6, 1);
        guard.next -= cases[i].moved_x;
        http_guard_header(&guard, x, 1, x + 3, 1);
        http_guard_end(&guard, x + 8 + cases[i].moved_end);
        assert_int_equal(http_guard_verdict(&guard, "GET", "HTTP/1.1", NULL), cases[i].status);
    }
}

static void a_target_is_split_and_its_path_decoded(void **state)
{
    static const struct {
        const char *target, *path, *query;
    } cases[] = {
        { "/", "/", "" },
        { "/v1/runs?limit=2&label=a%20b", "/v1/runs", "limit=2&label=a%20b" },
        { "/a%20b%C3%a4", "/a b\xc3\xa4", "" },
        { "/a?b?c", "/a", "b?c" },
        { "/a%2Fb", "/a/b", "" },
        { "/a%2", "", NULL },
        { "/a%", "", NULL },
        { "/a%g1", "", NULL },
        { "/a%00", "", NULL },
        { "/a%0d%0aSet-Cookie:x", "", NULL },
        { "/a\xc3\xa4", "", NULL },
        { "/a\x01", "", NULL },
        { "/a?b\x7f", "", NULL },
        { "", "", NULL },
        { "a", "", NULL },
        { "ftp://host/a", "", NULL },
        { "*", "*", "" },
        { "http://host:80/a?b", "/a", "b" },
        { "HTTPS://host/", "/", "" },
        { "http://host", "", NULL },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char path[API_PATH_MAX] = "untouched", query[API_PATH_MAX] = "untouched";
        int status = http_guard_target(cases[i].target, path, query, NULL);
        assert_int_equal(status, cases[i].query == NULL ? 400 : 0);
        assert_string_equal(path, status == 0 ? cases[i].path : "untouched");
        assert_string_equal(query, status == 0 ? cases[i].query : "untouched");
    }
}

static void a_target_may_be_as_long_as_its_limit(void **state)
{
    char target[2 * API_PATH_MAX + 2], path[API_PATH_MAX], query[API_PATH_MAX];

    memset(target, 'a', sizeof target);
    target[0] = '/';
    target[API_PATH_MAX - 1] = '?';
    target[2 * API_PATH_MAX - 1] = '\0';
    assert_int_equal(http_guard_target(target, path, query, NULL), 0);
    assert_int_equal(strlen(path), API_PATH_MAX - 1);
    assert_int_equal(strlen(query), API_PATH_MAX - 1);
    target[2 * API_PATH_MAX - 1] = 'a';
    target[2 * API_PATH_MAX] = '\0';
    assert_int_equal(http_guard_target(target, path, query, NULL), 414);
    target[API_PATH_MAX - 1] = 'a';
    target[API_PATH_MAX] = '\0';
    assert_int_equal(http_guard_target(target, path, query, NULL), 414);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_row_of_the_table_is_judged_as_it_says),
        cmocka_unit_test(a_zero_byte_in_a_value_is_refused),
        cmocka_unit_test(each_line_must_follow_the_one_before_it),
        cmocka_unit_test(a_target_is_split_and_its_path_decoded),
        cmocka_unit_test(a_target_may_be_as_long_as_its_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

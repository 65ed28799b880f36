// Every route of the table: HEAD, OPTIONS, and methods that it does not know.

#include "api/http/routes.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

// A path of the template with the first run, its snapshot 0, and a ready scenario.
static void fill(const char *template, char *path, size_t size)
{
    static const struct {
        const char *name, *value;
    } values[] = { { "{id}", ID_1 }, { "{n}", "0" }, { "{name}", "example-1" } };
    size_t n = 0;

    while (*template != '\0' && n + 1 < size) {
        const char *value = NULL;
        for (size_t i = 0; *template == '{' && i < sizeof values / sizeof *values; i++) {
            if (strncmp(template, values[i].name, strlen(values[i].name)) == 0)
                value = values[i].value;
        }
        if (value == NULL) {
            path[n++] = *template ++;
            continue;
        }
        n += (size_t)snprintf(path + n, size - n, "%s", value);
        template += strcspn(template, "}") + 1;
    }
    path[n] = '\0';
}

static bool has_word(const char *list, const char *word)
{
    size_t n = strlen(word);

    for (const char *p = list; (p = strstr(p, word)) != NULL; p += n) {
        if ((p == list || p[-1] == ' ') && (p[n] == '\0' || p[n] == ','))
            return true;
    }
    return false;
}

static void options_of_every_route_name_its_methods(void **state)
{
    size_t n;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++) {
        char path[256];
        fill(table[i].path, path, sizeof path);
        ask("OPTIONS", path, NULL, NULL, NULL, 204);
        const char *allow = helper_header(&ask_response, "Allow");
        assert_true(has_word(allow, table[i].method));
        assert_true(has_word(allow, "OPTIONS"));
        assert_int_equal(has_word(allow, "HEAD"), has_word(allow, "GET"));
    }
}

static void other_methods_are_refused_with_those_that_there_are(void **state)
{
    static const char *const methods[] = { "GET",   "HEAD",   "POST",    "PUT", "PATCH",
                                           "TRACE", "DELETE", "CONNECT", "get", "BREW" };
    size_t n;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++) {
        char path[256], allow[API_HEADER_SIZE];
        fill(table[i].path, path, sizeof path);
        ask("OPTIONS", path, NULL, NULL, NULL, 204);
        snprintf(allow, sizeof allow, "%s", helper_header(&ask_response, "Allow"));
        for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
            if (has_word(allow, methods[k]))
                continue;
            ask(methods[k], path, NULL, NULL, NULL, 405);
            ask_assert_header("Allow", allow);
        }
    }
}

// HEAD has the status and the headers of GET; the transport leaves out the body.
static void head_of_every_route_is_its_get(void **state)
{
    size_t n;
    const route *table = routes_list(&n);

    helper_run *item = ask_add_run(RUN_SUCCEEDED);
    item->summary = "{}";
    item->record.has_summary = true;
    for (size_t i = 0; i < n; i++) {
        char path[256], headers[API_HEADERS_MAX][API_HEADER_SIZE];
        if (strcmp(table[i].method, "GET") != 0)
            continue;
        fill(table[i].path, path, sizeof path);
        helper_request(&ask_daemon, "GET", path, NULL, NULL, NULL, &ask_response);
        int status = ask_response.status;
        size_t n_headers = ask_response.n_headers;
        for (size_t k = 0; k < n_headers; k++)
            memcpy(headers[k], ask_response.headers[k].value, API_HEADER_SIZE);
        api_response_fini(&ask_response);
        helper_request(&ask_daemon, "HEAD", path, NULL, NULL, NULL, &ask_response);
        assert_int_equal(ask_response.status, status);
        assert_int_equal(ask_response.n_headers, n_headers);
        for (size_t k = 0; k < n_headers; k++)
            assert_string_equal(ask_response.headers[k].value, headers[k]);
        api_response_fini(&ask_response);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ASK_TEST(options_of_every_route_name_its_methods),
        ASK_TEST(other_methods_are_refused_with_those_that_there_are),
        ASK_TEST(head_of_every_route_is_its_get),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// The table of routes, and how paths find their way through it.

#include "api/http/routes.h"

#include "api/http/exchange.h"
#include "api/http/negotiation.h"
#include "api/http/query.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static const char long_segment[] = "/v1/examples/0123456789abcdef0123456789abcdef"
                                   "0123456789abcdef0123456789abcdef";

static void a_template_gives_its_parameters(void **state)
{
    route_params params = { 0 };
    const route *found = routes_find("GET", "/v1/runs/abc/snapshots/7", &params);

    assert_non_null(found);
    assert_string_equal(found->path, "/v1/runs/{id}/snapshots/{n}");
    assert_int_equal(params.n, 2);
    assert_string_equal(params.values[0], "abc");
    assert_string_equal(params.values[1], "7");
}

static void method_and_path_choose_the_route(void **state)
{
    assert_string_equal(routes_find("POST", "/v1/runs", NULL)->method, "POST");
    assert_string_equal(routes_find("GET", "/v1/runs", NULL)->method, "GET");
    assert_ptr_equal(routes_find("HEAD", "/v1/runs", NULL), routes_find("GET", "/v1/runs", NULL));
    assert_null(routes_find("PUT", "/v1/runs", NULL));
    assert_null(routes_find("get", "/v1/runs", NULL));
    assert_null(routes_find("GET", "/v1/runs/x/cancel", NULL));
}

// Where there are several; {n} and {id} have no dots.
static void an_ending_says_the_format(void **state)
{
    static const char *const none[] = { "/v1/runs/abc/curve.", "/v1/runs/abc/curve.png",
                                        "/v1/runs/abc/curve.csv.csv", "/v1/runs/abc/summary.json",
                                        "/v1/runs/abc/.csv" };
    route_params params = { 0 };
    const route *found = routes_find("GET", "/v1/runs/abc/snapshots/7.png", &params);

    assert_ptr_equal(found, routes_find("GET", "/v1/runs/abc/snapshots/7", NULL));
    assert_string_equal(params.values[1], "7");
    assert_string_equal(routes_formats(found, &params), "png");
    found = routes_find("GET", "/v1/runs/abc/snapshots/7", &params);
    assert_string_equal(routes_formats(found, &params), "npy json csv png vti");
    // Of what takes several formats the ending is that of the body.
    found = routes_find("POST", "/v1/measurements.csv", &params);
    assert_non_null(found);
    assert_string_equal(params.format, "csv");
    assert_string_equal(routes_formats(found, &params), "json");
    assert_non_null(routes_find("GET", "/v1/measurements/abc.csv", &params));
    assert_string_equal(params.values[0], "abc");
    for (size_t i = 0; i < sizeof none / sizeof *none; i++) {
        if (routes_find("GET", none[i], NULL) != NULL)
            fail_msg("%s", none[i]);
    }
    assert_null(routes_find("DELETE", "/v1/measurements/abc.csv", NULL));
}

static void paths_that_are_not_in_the_table_find_nothing(void **state)
{
    static const char *const paths[] = {
        "",
        "/",
        "*",
        "/v1",
        "/v1/",
        "v1/runs",
        "/v1/runs/",
        "/v1//runs",
        "//v1/runs",
        "/v1/run",
        "/v1/runsx",
        "/V1/runs",
        "/v1/runs/a/",
        "/v1/runs/a/nothing",
        "/v1/runs//curve",
        "/v1/runs/a/curve/b",
        "/livez/",
    };
    route_params params = { .n = 99 };

    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        if (routes_find("GET", paths[i], &params) != NULL)
            fail_msg("%s", paths[i]);
    }
    assert_int_equal(params.n, 99);
}

static void a_parameter_has_a_limit(void **state)
{
    char path[sizeof long_segment + 1];

    assert_int_equal(strlen(long_segment) - strlen("/v1/examples/"), ROUTES_PARAM_SIZE - 1);
    assert_non_null(routes_find("GET", long_segment, NULL));
    memcpy(path, long_segment, sizeof long_segment);
    memcpy(path + sizeof long_segment - 1, "x", 2);
    assert_null(routes_find("GET", path, NULL));
}

static void allow_lists_the_methods_of_a_path(void **state)
{
    char allow[ROUTES_ALLOW_SIZE] = "as it was";

    assert_false(routes_allow("/nowhere", allow));
    assert_string_equal(allow, "as it was");
    assert_true(routes_allow("/v1/runs", allow));
    assert_string_equal(allow, "POST, GET, HEAD, OPTIONS");
    assert_true(routes_allow("/v1/runs/abc", allow));
    assert_string_equal(allow, "GET, HEAD, PATCH, DELETE, OPTIONS");
    assert_true(routes_allow("/v1/runs/abc/cancel", allow));
    assert_string_equal(allow, "POST, OPTIONS");
    assert_true(routes_allow("/v1/measurements/abc.csv", allow));
    assert_string_equal(allow, "GET, HEAD, OPTIONS");
}

static const char *give_accept(void *accept, const char *name)
{
    return strcmp(name, "Accept") == 0 ? accept : NULL;
}

static api_cost cost_of(const char *method, const char *path, const char *asked, char *accept)
{
    const api_request request = { .method = method,
                                  .path = path,
                                  .query = asked,
                                  .header = give_accept,
                                  .header_context = accept };

    return api_request_cost(&request);
}

static void the_cost_of_a_request_is_told_before(void **state)
{
    assert_int_equal(cost_of("POST", "/v1/runs", "", NULL), API_COST_CHECK);
    assert_int_equal(cost_of("POST", "/v1/validate", "", NULL), API_COST_CHECK);
    assert_int_equal(cost_of("POST", "/v1/runs/abc/cancel", "", NULL), API_COST_STORE);
    assert_int_equal(cost_of("HEAD", "/v1/runs/abc/curve", "", NULL), API_COST_STORE);
    assert_int_equal(cost_of("GET", "/v1/examples", "", NULL), API_COST_NONE);
    assert_int_equal(cost_of("GET", "/nowhere", "", NULL), API_COST_NONE);
    assert_int_equal(cost_of("OPTIONS", "/v1/runs", "", NULL), API_COST_NONE);
}

static void health_waits_behind_nothing(void **state)
{
    assert_int_equal(cost_of("GET", "/livez", "", NULL), API_COST_HEALTH);
    assert_int_equal(cost_of("GET", "/readyz", "", NULL), API_COST_HEALTH);
    assert_int_equal(cost_of("GET", "/metrics", "", NULL), API_COST_HEALTH);
}

// Comparisons, archives and tables of millions of numbers as text take seconds of a processor.
static void long_answers_are_work(void **state)
{
    static const char path[] = "/v1/runs/abc/snapshots/7", parts[] = "/v1/runs/abc/parts/7";
    char csv[] = "text/csv", png[] = "image/png";

    assert_int_equal(cost_of("GET", "/v1/compare", "", NULL), API_COST_WORK);
    assert_int_equal(cost_of("GET", "/v1/runs/abc/results.zip", "", NULL), API_COST_WORK);
    assert_int_equal(cost_of("GET", path, "", NULL), API_COST_STORE);
    assert_int_equal(cost_of("GET", path, "format=json", NULL), API_COST_WORK);
    assert_int_equal(cost_of("GET", path, "", csv), API_COST_WORK);
    assert_int_equal(cost_of("GET", path, "", png), API_COST_STORE);
    assert_int_equal(cost_of("GET", "/v1/runs/abc/snapshots/7.json", "", NULL), API_COST_WORK);
    assert_int_equal(cost_of("GET", "/v1/runs/abc/snapshots/7.png", "", NULL), API_COST_STORE);
    assert_int_equal(cost_of("GET", parts, "format=csv", NULL), API_COST_WORK);
    assert_int_equal(cost_of("GET", parts, "format=vtp", NULL), API_COST_STORE);
    assert_int_equal(cost_of("GET", parts, "format=pdf", NULL), API_COST_STORE);
}

static void no_two_routes_are_the_same(void **state)
{
    size_t n = 0;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++) {
        for (size_t k = i + 1; k < n; k++)
            assert_false(strcmp(table[i].method, table[k].method) == 0 &&
                         strcmp(table[i].path, table[k].path) == 0);
    }
}

static bool has_param(const route *row, const param_kind *kind)
{
    size_t k = 0;

    while (row->params[k] != NULL && row->params[k]->kind != kind)
        k++;
    return row->params[k] != NULL;
}

static size_t count_path_params(const route *row)
{
    size_t n = 0;

    for (size_t k = 0; row->params[k] != NULL; k++)
        n += strcmp(row->params[k]->in, "path") == 0;
    return n;
}

static size_t count_braces(const char *template)
{
    size_t n = 0;

    for (; *template != '\0'; template ++)
        n += *template == '{';
    return n;
}

// What changes something needs the right to write; what only reads does not, every token may have a ticket, and leases are
// for workers.
static void scopes_follow_from_methods(void **state)
{
    size_t n = 0;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++) {
        bool is_get = strcmp(table[i].method, "GET") == 0;
        bool is_validation = strcmp(table[i].path, "/v1/validate") == 0;
        bool is_ticket = strcmp(table[i].path, "/v1/tickets") == 0;
        bool is_lease = strncmp(table[i].path, "/v1/leases", 10) == 0;
        assert_int_equal(table[i].scope == API_SCOPE_SUBMIT,
                         !is_get && !is_validation && !is_ticket && !is_lease);
        assert_int_equal(table[i].scope == API_SCOPE_WORK, is_lease);
        assert_int_equal(table[i].scope == API_SCOPE_ANY, is_ticket);
        if (table[i].scope == API_SCOPE_NONE)
            assert_memory_not_equal(table[i].path, "/v1/", 4);
    }
}

// Formats that can be chosen by ?format= need the parameter, others must not have it.
static void every_row_of_the_table_is_complete(void **state)
{
    size_t n = 0;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++) {
        const media *chosen = NULL;
        bool has_choice = strchr(table[i].formats, ' ') != NULL;
        assert_non_null(table[i].handle);
        assert_true(strlen(table[i].summary) > 10);
        assert_int_equal(negotiation_choose_media(table[i].formats, NULL, NULL, &chosen, NULL),
                         BF_OK);
        assert_memory_equal(table[i].formats, chosen->word, strlen(chosen->word));
        assert_int_equal(has_param(&table[i], &param_format), has_choice);
        assert_int_equal(count_path_params(&table[i]), count_braces(table[i].path));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_template_gives_its_parameters),
        cmocka_unit_test(method_and_path_choose_the_route),
        cmocka_unit_test(an_ending_says_the_format),
        cmocka_unit_test(paths_that_are_not_in_the_table_find_nothing),
        cmocka_unit_test(a_parameter_has_a_limit),
        cmocka_unit_test(allow_lists_the_methods_of_a_path),
        cmocka_unit_test(the_cost_of_a_request_is_told_before),
        cmocka_unit_test(health_waits_behind_nothing),
        cmocka_unit_test(long_answers_are_work),
        cmocka_unit_test(no_two_routes_are_the_same),
        cmocka_unit_test(scopes_follow_from_methods),
        cmocka_unit_test(every_row_of_the_table_is_complete),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

helper_daemon ask_daemon;
api_response ask_response;

int ask_set_up(void **state)
{
    ask_daemon = (helper_daemon){ .n_runs = 0 };
    return 0;
}

int ask_tear_down(void **state)
{
    api_response_fini(&ask_response);
    return 0;
}

helper_run *ask_add_run(run_state where)
{
    return helper_add_run(&ask_daemon, where);
}

static void assert_problem(int status)
{
    json_t *root = helper_json(&ask_response);

    ask_assert_header("Content-Type", "application/problem+json");
    assert_int_equal(json_integer_value(json_object_get(root, "status")), status);
    assert_true(json_is_string(json_object_get(root, "type")));
    assert_true(json_is_string(json_object_get(root, "title")));
    assert_true(json_string_length(json_object_get(root, "detail")) > 0);
    assert_true(json_is_string(json_object_get(root, "instance")));
    json_decref(root);
}

void ask(const char *method, const char *path, const char *query, const char *headers,
         const char *body, int status)
{
    api_response_fini(&ask_response);
    helper_request(&ask_daemon, method, path, query, headers, body, &ask_response);
    if (ask_response.status != status)
        fail_msg("%s %s?%s: %d, %s", method, path, query == NULL ? "" : query, ask_response.status,
                 ask_response.body.bytes == NULL ? "" : ask_response.body.bytes);
    ask_assert_header("X-Content-Type-Options", "nosniff");
    if (status >= 400)
        assert_problem(status);
}

void ask_get(const char *path, const char *query, const char *headers, int status)
{
    ask("GET", path, query, headers, NULL, status);
}

bool ask_body_has(const char *text)
{
    return ask_response.body.bytes != NULL && strstr(ask_response.body.bytes, text) != NULL;
}

void ask_assert_header(const char *name, const char *value)
{
    const char *found = helper_header(&ask_response, name);

    assert_non_null(found);
    assert_string_equal(found, value);
}

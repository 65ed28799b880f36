// The dispatch of requests: routes, refusals, negotiation, conditional requests, the service itself.

#include "api/http/exchange.h"

#include "core/base/memory.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void what_a_client_has_is_not_sent_again(void **state)
{
    static const char *const same[] = { "If-None-Match: \"r42\"\n", "If-None-Match: W/\"r42\"\n",
                                        "If-None-Match: \"a\", \"r42\"\n", "If-None-Match: *\n" };
    static const char *const other[] = { "If-None-Match: \"r41\"\n", "If-None-Match: r42\n",
                                         "If-None-Match: \"r42\n", "If-None-Match: \n",
                                         "If-None-Match: \"r4\", \"r422\"\n" };

    ask_add_run(RUN_RUNNING)->record.revision = 42;
    for (size_t i = 0; i < sizeof same / sizeof *same; i++) {
        ask_get(RUN_1, NULL, same[i], 304);
        ask_assert_header("ETag", "\"r42\"");
    }
    for (size_t i = 0; i < sizeof other / sizeof *other; i++)
        ask_get(RUN_1, NULL, other[i], 200);
}

// What is dear to make is not made; what is cheap is left to the transport, for its length.
static void what_is_dear_is_not_made_for_a_client_that_has_it(void **state)
{
    ask_add_run(RUN_RUNNING)->record.revision = 42;
    ask_get(RUN_1 "/curve", NULL, "If-None-Match: \"r42-json\"\n", 304);
    assert_int_equal(ask_response.body.n, 0);
    assert_null(helper_header(&ask_response, "Content-Type"));
    ask_get(RUN_1, NULL, "If-None-Match: \"r42\"\n", 304);
    assert_true(ask_body_has("\"status\":\"running\""));
}

// An encoded form has a tag of its own, which counts where the client takes that form.
static void an_encoded_form_is_known_by_its_own_tag(void **state)
{
    static const char known[] = "If-None-Match: \"r42-json-gzip\"\n";
    char headers[128];

    ask_add_run(RUN_RUNNING)->record.revision = 42;
    snprintf(headers, sizeof headers, "%sAccept-Encoding: gzip\n", known);
    ask_get(RUN_1 "/curve", NULL, headers, 304);
    ask_assert_header("ETag", "\"r42-json-gzip\"");
    ask_get(RUN_1 "/curve", NULL, known, 200);
    ask_assert_header("ETag", "\"r42-json\"");
}

// Documents without a revision are named by their bytes: while these stay, the client has them.
static void documents_are_known_by_their_bytes(void **state)
{
    static const char *const paths[] = { "/v1/runs", "/v1/examples", "/v1/examples/example-1",
                                         "/version" };

    ask_add_run(RUN_RUNNING);
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        char headers[128];
        ask_get(paths[i], NULL, NULL, 200);
        ask_assert_header("Cache-Control", "private, no-cache");
        snprintf(headers, sizeof headers, "If-None-Match: %s\n",
                 helper_header(&ask_response, "ETag"));
        ask_get(paths[i], NULL, headers, 304);
        ask_add_run(RUN_QUEUED);
        ask_get(paths[i], NULL, headers, i == 0 ? 200 : 304);
    }
    ask_get("/livez", NULL, NULL, 200);
    assert_null(helper_header(&ask_response, "ETag"));
}

static void a_run_is_changed_only_in_the_state_that_the_client_means(void **state)
{
    static const char *const other[] = { "If-Match: \"r41\"\n", "If-Match: W/\"r42\"\n",
                                         "If-Match: r42\n" };

    ask_add_run(RUN_QUEUED)->record.revision = 42;
    for (size_t i = 0; i < sizeof other / sizeof *other; i++) {
        ask("POST", RUN_1 "/cancel", NULL, other[i], NULL, 412);
        assert_true(ask_body_has("\\\"r42\\\""));
        ask("DELETE", RUN_1, NULL, other[i], NULL, 412);
    }
    assert_int_equal(ask_daemon.runs[0].record.state, RUN_QUEUED);
    ask("POST", RUN_1 "/cancel", NULL, "If-Match: \"x\", \"r42-gzip\"\n", NULL, 200);
    ask("DELETE", RUN_1, NULL, "If-Match: *\n", NULL, 204);
}

// RFC 9110, 13.1.1 and 13.1.2: If-Match is for all methods; If-None-Match is a 412 for those that change.
static void conditions_hold_for_reading_and_removing(void **state)
{
    static const char *const paths[] = { RUN_1,      RUN_1 "/curve", RUN_1 "/snapshots",
                                         "/v1/runs", "/version",     "/v1/examples/example-1" };

    ask_add_run(RUN_QUEUED)->record.revision = 42;
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        char headers[128];
        ask_get(paths[i], NULL, "If-Match: \"other\"\n", 412);
        ask("HEAD", paths[i], NULL, "If-Match: \"other\"\n", NULL, 412);
        ask_get(paths[i], NULL, "If-Match: *\n", 200);
        snprintf(headers, sizeof headers, "If-Match: \"other\", %s\n",
                 helper_header(&ask_response, "ETag"));
        ask_get(paths[i], NULL, headers, 200);
        ask_get(paths[i], NULL, "If-Match: \"other\"\nIf-None-Match: *\n", 412);
    }
    ask_get(RUN_1, "wait=60", "If-Match: \"other\"\n", 412);
    assert_int_equal(ask_response.long_poll.seconds, 0);
    ask("DELETE", RUN_1, NULL, "If-None-Match: *\n", NULL, 412);
    ask("POST", RUN_1 "/cancel", NULL, "If-None-Match: W/\"r42\"\n", NULL, 412);
    assert_int_equal(ask_daemon.runs[0].record.state, RUN_QUEUED);
    ask("DELETE", RUN_1, NULL, "If-None-Match: \"r41\"\n", NULL, 204);
}

// RFC 9457, 3.1.1: the type of a problem should lead to its description.
static void the_type_of_a_problem_leads_to_what_it_means(void **state)
{
    char type[128];

    ask_get("/nowhere", NULL, NULL, 404);
    const char *from = strstr(ask_response.body.bytes, "/problems/");
    assert_non_null(from);
    snprintf(type, sizeof type, "%.*s", (int)strcspn(from, "\""), from);
    ask_get(type, NULL, NULL, 200);
    assert_true(
        ask_body_has("\"type\":\"/problems/not-found\",\"title\":\"Not Found\",\"status\":404"));
    ask_get("/problems/nothing", NULL, NULL, 404);
}

static void a_problem_can_be_given_the_id_of_its_request(void **state)
{
    ask_get("/nowhere", NULL, NULL, 404);
    api_problem_identify(&ask_response, "a\"b");
    assert_true(ask_body_has("\"instance\":\"/nowhere\",\"request_id\":\"a\\\"b\"}"));
    ask_get("/livez", NULL, NULL, 200);
    api_problem_identify(&ask_response, "a");
    assert_false(ask_body_has("request_id"));
    // Without memory it stays a whole document.
    ask_get("/nowhere", NULL, NULL, 404);
    char id[4097];
    memset(id, 'i', sizeof id - 1);
    id[sizeof id - 1] = '\0';
    memory_plan_fault(1, 1);
    api_problem_identify(&ask_response, id);
    memory_plan_fault(0, 0);
    assert_true(ask_body_has("\"instance\":\"/nowhere\"}"));
}

static void a_full_share_of_the_queue_is_a_429(void **state)
{
    ask_daemon.refusal = BF_ELIMIT;
    ask("POST", "/v1/runs", NULL, IS_JSON, BODY, 429);
    assert_non_null(helper_header(&ask_response, "Retry-After"));
}

static void what_depends_on_accept_says_so(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/curve", NULL, NULL, 200);
    ask_assert_header("Vary", "Accept");
    ask_get(RUN_1 "/curve", NULL, "Accept: image/png\n", 406);
    ask_assert_header("Vary", "Accept");
    ask_get(RUN_1, NULL, NULL, 200);
    assert_null(helper_header(&ask_response, "Vary"));
}

static void unknown_runs_are_not_found(void **state)
{
    static const char *const paths[] = { "",           "/scenario",    "/summary", "/curve",
                                         "/snapshots", "/snapshots/0", "/events" };
    char path[128];

    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        snprintf(path, sizeof path, NO_RUN "%s", paths[i]);
        ask_get(path, NULL, NULL, 404);
        snprintf(path, sizeof path, "/v1/runs/nonsense%s", paths[i]);
        ask_get(path, NULL, NULL, 404);
    }
    ask("POST", NO_RUN "/cancel", NULL, NULL, NULL, 404);
    ask("DELETE", NO_RUN, NULL, NULL, NULL, 404);
}

static void formats_that_do_not_exist_are_refused_with_those_that_do(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/curve", "format=xml", NULL, 400);
    assert_true(ask_body_has("json csv"));
    ask_get(RUN_1 "/curve", NULL, "Accept: image/png\n", 406);
    assert_true(ask_body_has("json csv"));
    ask_get(RUN_1 "/snapshots/0", "format=vtp", NULL, 400);
    assert_true(ask_body_has("npy json csv png vti"));
    ask_get("/v1/runs", NULL, "Accept: text/csv\n", 406);
    ask("POST", "/v1/runs", NULL, IS_JSON "Accept: text/html\n", BODY, 406);
    assert_int_equal(ask_daemon.n_submitted, 0);
}

static void the_service_tells_of_itself(void **state)
{
    ask_get("/livez", NULL, NULL, 200);
    ask_get("/readyz", NULL, NULL, 200);
    ask_get("/version", NULL, NULL, 200);
    assert_true(ask_body_has("\"name\":\"beltflow\",\"version\":\""));
    ask_get("/v1/quota", NULL, NULL, 200);
    assert_true(ask_body_has("{\"owner\":\"alice\",\"waiting_runs\":{\"used\":3},"
                             "\"cpu_s\":{\"used\":70,\"allowed\":60,"
                             "\"available_at\":\"2026-01-01T00:00:00.000Z\"},"
                             "\"result_bytes\":{\"used\":4096,\"allowed\":8192}}"));
    ask_daemon.refusal = BF_EBUSY;
    ask_get("/livez", NULL, NULL, 200);
    ask_get("/readyz", NULL, NULL, 503);
    ask_daemon.refusal = BF_ESYSTEM;
    ask_get("/readyz", NULL, NULL, 503);
}

static void every_example_can_be_fetched_and_submitted(void **state)
{
    ask_get("/v1/examples", NULL, NULL, 200);
    json_t *root = helper_json(&ask_response);
    json_t *items = json_object_get(root, "examples");
    assert_true(json_array_size(items) >= 3);
    for (size_t i = 0; i < json_array_size(items); i++) {
        json_t *item = json_array_get(items, i);
        assert_true(json_string_length(json_object_get(item, "title")) > 0);
        ask_get(json_string_value(json_object_get(item, "url")), NULL, NULL, 200);
        json_t *document = helper_json(&ask_response);
        json_t *body = json_pack("{s:o}", "scenario", document);
        char *text = json_dumps(body, 0);
        ask("POST", "/v1/validate", NULL, IS_JSON, text, 200);
        free(text);
        json_decref(body);
    }
    json_decref(root);
    ask_get("/v1/examples/nothing", NULL, NULL, 404);
}

static void options_and_405_list_the_methods(void **state)
{
    ask("OPTIONS", "/v1/runs", NULL, NULL, NULL, 204);
    ask_assert_header("Allow", "POST, GET, HEAD, OPTIONS");
    ask("OPTIONS", "*", NULL, NULL, NULL, 204);
    ask("OPTIONS", "/nowhere", NULL, NULL, NULL, 404);
    ask_get("*", NULL, NULL, 404);
    ask("PUT", "/v1/runs", NULL, NULL, NULL, 405);
    ask_assert_header("Allow", "POST, GET, HEAD, OPTIONS");
    ask("BREW", "/livez", NULL, NULL, NULL, 405);
    ask_assert_header("Allow", "GET, HEAD, OPTIONS");
    ask_get(RUN_1 "/cancel", NULL, NULL, 405);
    ask_get("/nowhere", NULL, NULL, 404);
}

static void head_is_answered_like_get(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask("HEAD", RUN_1, NULL, NULL, NULL, 200);
    ask_assert_header("ETag", "\"r1\"");
    ask("HEAD", NO_RUN, NULL, NULL, NULL, 404);
}

static void unknown_parameters_are_named(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1, "verbose=1", NULL, 400);
    assert_true(ask_body_has("'verbose'"));
    ask_get("/livez", "x", NULL, 400);
}

static void a_problem_names_the_path_as_a_reference(void **state)
{
    ask_get("/v1/runs/a \"b\xc3", NULL, NULL, 404);
    assert_true(ask_body_has("\"instance\":\"/v1/runs/a%20%22b%C3\""));
    assert_true(
        ask_body_has("\"type\":\"/problems/not-found\",\"title\":\"Not Found\",\"status\":404"));
}

static void too_long_a_path_or_query_is_refused(void **state)
{
    char text[API_PATH_MAX + 1] = "/";

    memset(text + 1, 'x', sizeof text - 2);
    text[API_PATH_MAX] = '\0';
    ask_get(text, NULL, NULL, 414);
    text[API_PATH_MAX - 1] = '\0';
    ask_get(text, NULL, NULL, 404);
    ask_get("/livez", text, NULL, 414);
    text[API_PATH_MAX - 2] = '\0';
    ask_get("/livez", text, NULL, 400);
}

static void the_transport_can_refuse_too(void **state)
{
    bf_error err = { .code = BF_ELIMIT, .text = "the body may have 1048576 bytes" };

    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1, NULL, NULL, 200);
    api_problem(&ask_response, 413, "/v1/runs", &err);
    assert_int_equal(ask_response.status, 413);
    assert_null(helper_header(&ask_response, "ETag"));
    assert_true(ask_body_has("1048576"));
    assert_false(ask_body_has("\"errors\""));
}

typedef struct request_line {
    const char *method, *path, *query, *body;
    int status;
} request_line;

// Every allocation of every kind of request fails in turn: a 503, perhaps without a body, and never
// a run that was accepted without being answered so.
static void out_of_memory_is_a_503(void **state)
{
    static const request_line lines[] = {
        { "POST", "/v1/runs", NULL, BODY, 201 },
        { "POST", "/v1/validate", NULL, BODY, 200 },
        { "POST", "/v1/runs", NULL, BAD_BODY, 422 },
        { "GET", "/v1/runs", "limit=1", NULL, 200 },
        { "GET", RUN_1, NULL, NULL, 200 },
        { "GET", RUN_1 "/curve", NULL, NULL, 200 },
        { "GET", RUN_1 "/curve", "format=csv", NULL, 200 },
        { "GET", RUN_1 "/snapshots", NULL, NULL, 200 },
        { "GET", RUN_1 "/snapshots/0", NULL, NULL, 200 },
        { "GET", RUN_1 "/snapshots/0", "format=json", NULL, 200 },
        { "GET", RUN_1 "/scenario", NULL, NULL, 200 },
        { "GET", "/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 200 },
        { "GET", "/v1/examples", NULL, NULL, 200 },
        { "GET", "/version", NULL, NULL, 200 },
    };

    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        const request_line *line = &lines[i];
        size_t n_faults = 1;
        for (size_t n = 1; n_faults > 0; n = HELPER_AMOUNT_NEXT_FAULT(n)) {
            ask_set_up(NULL);
            ask_add_run(RUN_RUNNING);
            ask_add_run(RUN_RUNNING);
            api_response_fini(&ask_response);
            memory_plan_fault(n, 1);
            helper_request(&ask_daemon, line->method, line->path, line->query, IS_JSON, line->body,
                           &ask_response);
            n_faults = memory_faults();
            memory_plan_fault(0, 0);
            // A refusal whose text finds no room keeps its status.
            bool is_bare = line->status == 422 && ask_response.status == 422;
            assert_int_equal(ask_response.status, n_faults > 0 && !is_bare ? 503 : line->status);
            assert_int_equal(ask_daemon.n_submitted, ask_response.status == 201);
        }
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(what_a_client_has_is_not_sent_again),
        ASK_TEST(what_is_dear_is_not_made_for_a_client_that_has_it),
        ASK_TEST(an_encoded_form_is_known_by_its_own_tag),
        ASK_TEST(documents_are_known_by_their_bytes),
        ASK_TEST(a_run_is_changed_only_in_the_state_that_the_client_means),
        ASK_TEST(conditions_hold_for_reading_and_removing),
        ASK_TEST(the_type_of_a_problem_leads_to_what_it_means),
        ASK_TEST(a_problem_can_be_given_the_id_of_its_request),
        ASK_TEST(a_full_share_of_the_queue_is_a_429),
        ASK_TEST(what_depends_on_accept_says_so),
        ASK_TEST(unknown_runs_are_not_found),
        ASK_TEST(formats_that_do_not_exist_are_refused_with_those_that_do),
        ASK_TEST(the_service_tells_of_itself),
        ASK_TEST(every_example_can_be_fetched_and_submitted),
        ASK_TEST(options_and_405_list_the_methods),
        ASK_TEST(head_is_answered_like_get),
        ASK_TEST(unknown_parameters_are_named),
        ASK_TEST(a_problem_names_the_path_as_a_reference),
        ASK_TEST(too_long_a_path_or_query_is_refused),
        ASK_TEST(the_transport_can_refuse_too),
        ASK_TEST(out_of_memory_is_a_503),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

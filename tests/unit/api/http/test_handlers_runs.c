// Runs over the API: submit, validate, list, show, cancel, remove.

#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

static void a_submitted_run_is_answered_with_its_place(void **state)
{
    ask("POST", "/v1/runs", NULL, IS_JSON, BODY, 201);
    ask_assert_header("Location", RUN_1);
    ask_assert_header("Content-Type", "application/json");
    ask_assert_header("ETag", "\"r1\"");
    assert_int_equal(ask_daemon.n_submitted, 1);
    assert_string_equal(ask_daemon.submitted.label, "night");
    assert_int_equal(ask_daemon.submitted.priority, 5);
    json_t *root = helper_json(&ask_response);
    assert_string_equal(json_string_value(json_object_get(root, "id")), ID_1);
    assert_string_equal(json_string_value(json_object_get(root, "status")), "queued");
    assert_string_equal(json_string_value(json_object_get(root, "name")), "one part");
    json_decref(root);
}

static void a_body_that_is_not_json_is_a_bad_request(void **state)
{
    static const char *const bodies[] = { "", "{", "nonsense", "{\"scenario\":}", "[]", "1e999" };

    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++)
        ask("POST", "/v1/runs", NULL, IS_JSON, bodies[i], 400);
    ask("POST", "/v1/runs", NULL, IS_JSON, NULL, 400);
    assert_int_equal(ask_daemon.n_submitted, 0);
}

static void a_bad_document_is_answered_with_pointers(void **state)
{
    ask("POST", "/v1/runs", NULL, IS_JSON, BAD_BODY, 422);
    json_t *root = helper_json(&ask_response);
    json_t *first = json_array_get(json_object_get(root, "errors"), 0);
    assert_string_equal(json_string_value(json_object_get(first, "pointer")),
                        "/scenario/duration_s");
    assert_true(json_string_length(json_object_get(first, "detail")) > 0);
    json_decref(root);
    assert_int_equal(ask_daemon.n_submitted, 0);
}

static void a_number_beyond_a_limit_is_told_with_both_and_their_unit(void **state)
{
    ask("POST", "/v1/runs", NULL, IS_JSON, BAD_BODY, 422);
    assert_true(ask_body_has(",\"value\":-1,\"limit\":0,\"unit\":\"s\"}"));
    ask("POST", "/v1/runs", NULL, IS_JSON, "{\"scenario\":" SCENARIO ",\"priority\":1000}", 422);
    assert_true(ask_body_has(",\"value\":1000,\"limit\":100}"));
}

static void several_faults_are_told_together(void **state)
{
    ask("POST", "/v1/runs", NULL, IS_JSON,
        "{\"scenario\":" SCENARIO ",\"labell\":\"\",\"priority\":1000}", 422);
    json_t *root = helper_json(&ask_response);
    assert_int_equal(json_array_size(json_object_get(root, "errors")), 2);
    assert_non_null(strstr(json_string_value(json_object_get(root, "detail")), "(and 1 more)"));
    json_decref(root);
}

static void only_json_is_taken(void **state)
{
    static const char *const headers[] = {
        NULL,
        "Content-Type: application/x-www-form-urlencoded\n",
        "Content-Type: text/json\n",
        "Content-Type: application/jsonx\n",
        IS_JSON "Content-Encoding: gzip\n",
    };

    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        ask("POST", "/v1/runs", NULL, headers[i], BODY, 415);
        ask_assert_header("Accept", "application/json");
    }
    assert_int_equal(ask_daemon.n_submitted, 0);
    ask("POST", "/v1/runs", NULL, "Content-Type: Application/JSON; charset=utf-8\n", BODY, 201);
    // A charset has no effect on JSON, which is UTF-8 (RFC 8259, 11).
    ask("POST", "/v1/runs", NULL, "Content-Type: application/json; charset=latin1\n", BODY, 201);
}

static void a_full_queue_asks_to_come_back(void **state)
{
    ask_daemon.refusal = BF_EBUSY;
    ask("POST", "/v1/runs", NULL, IS_JSON, BODY, 503);
    assert_non_null(helper_header(&ask_response, "Retry-After"));
    assert_true(ask_body_has("the queue is full"));
}

static void a_full_disk_asks_to_come_back(void **state)
{
    ask_daemon.refusal = BF_ENOSPACE;
    ask("POST", "/v1/runs", NULL, IS_JSON, BODY, 507);
    assert_non_null(helper_header(&ask_response, "Retry-After"));
    assert_true(ask_body_has("/problems/insufficient-storage"));
}

static void a_key_comes_to_the_daemon_with_the_body(void **state)
{
    ask("POST", "/v1/runs", NULL, IS_JSON "Idempotency-Key: \"one \\\"key\\\"\"\n", BODY, 201);
    assert_string_equal(ask_daemon.submitted.sender.key, "one \"key\"");
    assert_int_equal(ask_daemon.submitted.sender.n_body, strlen(BODY));
    assert_null(helper_header(&ask_response, "Idempotent-Replayed"));
    ask("POST", "/v1/runs", NULL, IS_JSON, BODY, 201);
    assert_string_equal(ask_daemon.submitted.sender.key, "");
}

static void an_answer_that_is_given_again_says_so(void **state)
{
    ask_daemon.is_replay = true;
    ask("POST", "/v1/runs", NULL, IS_JSON "Idempotency-Key: key\n", BODY, 201);
    ask_assert_header("Idempotent-Replayed", "true");
    ask_assert_header("Location", RUN_1);
    ask_assert_header("ETag", "\"r1\"");
}

static void a_key_that_is_none_is_a_bad_request(void **state)
{
    ask("POST", "/v1/runs", NULL, IS_JSON "Idempotency-Key: a, b\n", BODY, 400);
    assert_true(ask_body_has("Idempotency-Key is no key"));
    ask("POST", "/v1/runs", NULL, IS_JSON "Idempotency-Key: \n", BODY, 400);
    assert_true(ask_body_has("Idempotency-Key is no key"));
    assert_int_equal(ask_daemon.n_submitted, 0);
    // A fault of the document is reported first.
    ask("POST", "/v1/runs", NULL, IS_JSON "Idempotency-Key: a, b\n", BAD_BODY, 422);
}

static void a_key_with_another_body_and_one_in_use_are_told_apart(void **state)
{
    ask_daemon.refusal = BF_EINPUT;
    ask("POST", "/v1/runs", NULL, IS_JSON "Idempotency-Key: key\n", BODY, 422);
    ask_daemon.refusal = BF_ECONFLICT;
    ask("POST", "/v1/runs", NULL, IS_JSON "Idempotency-Key: key\n", BODY, 409);
}

static void a_run_tells_whether_its_results_were_known(void **state)
{
    ask_add_run(RUN_SUCCEEDED)->record.is_cached = true;
    ask_get(RUN_1, NULL, NULL, 200);
    assert_true(ask_body_has("\"cached\":true"));
    ask("POST", "/v1/runs", NULL, IS_JSON, BODY, 201);
    assert_true(ask_body_has("\"cached\":false"));
}

static void validate_says_the_same_and_stores_nothing(void **state)
{
    ask("POST", "/v1/validate", NULL, IS_JSON, BODY, 200);
    json_t *root = helper_json(&ask_response);
    assert_true(json_is_true(json_object_get(root, "valid")));
    json_t *resolved = json_object_get(root, "resolved");
    assert_true(json_is_object(json_object_get(resolved, "macro")));
    json_decref(root);
    ask("POST", "/v1/validate", NULL, IS_JSON, BAD_BODY, 422);
    ask("POST", "/v1/validate", NULL, IS_JSON, "{", 400);
    ask("POST", "/v1/validate", NULL, NULL, BODY, 415);
    assert_int_equal(ask_daemon.n_submitted, 0);
}

static void a_run_is_shown_with_a_tag_of_its_revision(void **state)
{
    ask_add_run(RUN_RUNNING)->record.revision = 42;
    ask_get(RUN_1, NULL, NULL, 200);
    ask_assert_header("ETag", "\"r42\"");
    ask_assert_header("Cache-Control", "private, no-cache");
    assert_true(ask_body_has("\"status\":\"running\""));
}

static void a_list_has_the_newest_first_and_a_link_to_the_next(void **state)
{
    for (int i = 0; i < 3; i++)
        ask_add_run(RUN_QUEUED);
    ask_get("/v1/runs", "limit=2", NULL, 200);
    ask_assert_header("Link", "</v1/runs?limit=2&cursor=" ID_2 ">; rel=\"next\"");
    assert_true(ask_body_has("\"has_more\":true,\"next_cursor\":\"" ID_2 "\""));
    json_t *root = helper_json(&ask_response);
    json_t *runs = json_object_get(root, "runs");
    assert_int_equal(json_array_size(runs), 2);
    assert_string_equal(json_string_value(json_object_get(json_array_get(runs, 0), "id")), ID_3);
    json_decref(root);
    ask_get("/v1/runs", "limit=2&cursor=" ID_2, NULL, 200);
    assert_null(helper_header(&ask_response, "Link"));
    assert_true(ask_body_has(ID_1) && !ask_body_has(ID_2));
}

static void lines_are_listed_with_a_link_to_the_next(void **state)
{
    memcpy(ask_add_run(RUN_QUEUED)->record.line, "hall 2", 7);
    memcpy(ask_add_run(RUN_QUEUED)->record.line, "hall 3", 7);
    ask_get("/v1/lines", "limit=1", NULL, 200);
    ask_assert_header("Link", "</v1/lines?limit=1&cursor=" ID_2 ">; rel=\"next\"");
    assert_true(ask_body_has("\"line\":\"hall 3\"") && !ask_body_has("hall 2"));
    ask_get("/v1/lines", "cursor=" ID_2, NULL, 200);
    assert_null(helper_header(&ask_response, "Link"));
    assert_true(ask_body_has("\"line\":\"hall 2\"") && ask_body_has("\"newest_run\":\"" ID_1 "\""));
}

static void filters_reach_the_store_and_the_next_link(void **state)
{
    for (int i = 0; i < 2; i++)
        memcpy(ask_add_run(RUN_SUCCEEDED)->record.label, "a&b", 4);
    ask_add_run(RUN_QUEUED);
    ask_get("/v1/runs", "status=succeeded&model=macro&label=a%26b&limit=1", NULL, 200);
    ask_assert_header("Link",
                      "</v1/runs?limit=1&status=succeeded&model=macro&label=a%26b&cursor=" ID_2
                      ">; rel=\"next\"");
    assert_int_equal(ask_daemon.last_query.state, RUN_SUCCEEDED);
    assert_int_equal(ask_daemon.last_query.model, RUN_MACRO);
    ask_get("/v1/runs", NULL, NULL, 200);
    assert_int_equal(ask_daemon.last_query.state, -1);
    assert_int_equal(ask_daemon.last_query.model, -1);
    assert_int_equal(ask_daemon.last_query.limit, 50);
}

static void search_order_and_count_reach_the_store(void **state)
{
    for (int i = 0; i < 2; i++)
        ask_add_run(RUN_SUCCEEDED);
    ask_daemon.last_key = "2.5";
    ask_get("/v1/runs", "search=At%2060&sort=-residence_s.p95&count=1&limit=1", NULL, 200);
    assert_string_equal(ask_daemon.last_query.search, "at 60");
    assert_int_equal(ask_daemon.last_query.sort.by, API_SORT_FIGURE);
    assert_false(ask_daemon.last_query.sort.is_rising);
    assert_string_equal(ask_daemon.last_query.sort.figure, "residence_s.p95");
    assert_true(ask_body_has("\"total\":2"));
    ask_assert_header("Link",
                      "</v1/runs?limit=1&search=At%2060&sort=-residence_s.p95&count=1&cursor=" ID_2
                      ".322e35>; rel=\"next\"");
    ask_get("/v1/runs", "sort=-residence_s.p95&cursor=" ID_2 ".322e35", NULL, 200);
    assert_string_equal(ask_daemon.last_query.before, ID_2);
    assert_string_equal(ask_daemon.last_query.before_key, "2.5");
    assert_false(ask_body_has("total"));
    ask_get("/v1/runs", NULL, NULL, 200);
    assert_int_equal(ask_daemon.last_query.sort.by, API_SORT_CREATED);
    assert_false(ask_daemon.last_query.sort.is_rising);
    assert_string_equal(ask_daemon.last_query.search, "");
}

static void conditions_reach_the_store_and_the_next_link(void **state)
{
    for (int i = 0; i < 2; i++)
        ask_add_run(RUN_SUCCEEDED);
    ask_get("/v1/runs", "where=angle_deg%3E50,mass_kg%3C%3D2&limit=1", NULL, 200);
    assert_int_equal(ask_daemon.last_query.conditions.n, 2);
    assert_string_equal(ask_daemon.last_query.conditions.items[1].name, "mass_kg");
    ask_assert_header("Link", "</v1/runs?limit=1&where=angle_deg%3E50%2Cmass_kg%3C%3D2&cursor=" ID_2
                              ">; rel=\"next\"");
    ask_get("/v1/runs", NULL, NULL, 200);
    assert_int_equal(ask_daemon.last_query.conditions.n, 0);
    ask_get("/v1/runs", "where=angle_deg", NULL, 400);
    assert_true(ask_body_has("query parameter 'where': condition 1 must be a name"));
    ask_daemon.refusal = BF_ELIMIT; // more than the store reads for them
    ask_get("/v1/runs", "where=angle_deg%3E50", NULL, 400);
    assert_true(ask_body_has("there is too much to read"));
}

static void times_of_acceptance_reach_the_store_and_the_next_page(void **state)
{
    for (int i = 0; i < 2; i++)
        ask_add_run(RUN_SUCCEEDED);
    ask_get("/v1/runs",
            "limit=1&created_from=1970-01-02T00:00:00Z&created_before=2026-11-24T09:00:00.5Z", NULL,
            200);
    assert_int_equal(ask_daemon.last_query.from_ms, 24 * 60 * 60 * 1000);
    assert_int_equal(ask_daemon.last_query.before_ms,
                     1795510800500); // date -ud 2026-11-24T09:00:00Z +%s
    ask_assert_header("Link",
                      "</v1/runs?limit=1&created_from=1970-01-02T00%3A00%3A00Z&"
                      "created_before=2026-11-24T09%3A00%3A00.5Z&cursor=" ID_2 ">; rel=\"next\"");
    ask_get("/v1/runs", NULL, NULL, 200);
    assert_int_equal(ask_daemon.last_query.from_ms, 0);
    assert_int_equal(ask_daemon.last_query.before_ms, 0);
    ask_get("/v1/runs", "created_from=2026-02-30T00:00:00Z", NULL, 400);
}

// A key that is no number, and one in the order of creation, which is that of the ids.
static void a_cursor_of_another_order_is_refused(void **state)
{
    static const char *const queries[] = {
        "sort=status&cursor=" ID_1 ".6162", "cursor=" ID_1 ".32",
        "sort=name&cursor=" ID_1 ".6",      "sort=name&cursor=" ID_1 ".6A",
        "sort=name&cursor=" ID_1 ".00",     "sort=name&cursor=" ID_1 ".",
    };

    ask_add_run(RUN_SUCCEEDED);
    ask_get("/v1/runs", "sort=name&cursor=" ID_1 ".6162", NULL, 200);
    assert_string_equal(ask_daemon.last_query.before_key, "ab");
    for (size_t i = 0; i < sizeof queries / sizeof *queries; i++)
        ask_get("/v1/runs", queries[i], NULL, 400);
}

// The longest label, line, search, order and key there are, of bytes that need three each, still fit into the header.
static void the_longest_link_fits(void **state)
{
    char query[API_PATH_MAX] = "limit=200&status=cancelled&model=macro&count=1&starred=00001&"
                               "created_from=2026-11-24T09:00:00.123456789Z&"
                               "created_before=2026-11-24T09:00:00.123456789Z&study=" ID_1 "&"
                               "sort=-throughput_error_per_h&search=";
    char key[API_SORT_KEY_SIZE] = "";

    for (int i = 0; i < 100; i++)
        strcat(query, "%ff");
    for (int k = 0; k < 2; k++) {
        strcat(query, k == 0 ? "&line=" : "&label=");
        for (int i = 0; i < 100; i++)
            strcat(query, "%ff");
    }
    memset(key, 0xff, sizeof key - 1);
    ask_daemon.last_key = key;
    for (int i = 0; i < 2; i++) {
        api_run *one = &ask_add_run(RUN_CANCELLED)->record;
        memset(one->label, 0xff, API_LABEL_SIZE - 1);
        memcpy(one->study, ID_1, sizeof ID_1);
    }
    ask_get("/v1/runs", query, NULL, 200);
    assert_null(helper_header(&ask_response, "Link"));
    memcpy(query, "limit=001", 9);
    ask_get("/v1/runs", query, NULL, 200);
    assert_non_null(helper_header(&ask_response, "Link"));
    strcat(query, "a");
    ask_get("/v1/runs", query, NULL, 400);
}

static void orders_that_there_are_not_name_those_that_there_are(void **state)
{
    static const char *const queries[] = { "sort=", "sort=colour", "sort=--name", "sort=offered",
                                           "sort=residence_s" };

    for (size_t i = 0; i < sizeof queries / sizeof *queries; i++) {
        ask_get("/v1/runs", queries[i], NULL, 400);
        assert_true(ask_body_has("created finished name label model status"));
    }
}

static void bad_list_queries_name_the_parameter(void **state)
{
    static const char *const queries[][2] = {
        { "status=done", "status" },    { "model=nano", "model" },  { "limit=0", "limit" },
        { "limit=201", "limit" },       { "cursor=abc", "cursor" }, { "colour=red", "colour" },
        { "limit=1&limit=2", "limit" }, { "label=%zz", "label" },   { "count=2", "count" },
    };

    for (size_t i = 0; i < sizeof queries / sizeof *queries; i++) {
        char name[32];
        ask_get("/v1/runs", queries[i][0], NULL, 400);
        snprintf(name, sizeof name, "'%s'", queries[i][1]);
        assert_true(ask_body_has(name));
    }
}

static void cancel_tells_whether_the_run_still_runs(void **state)
{
    ask_add_run(RUN_QUEUED);
    ask_add_run(RUN_RUNNING);
    ask_add_run(RUN_SUCCEEDED);
    ask("POST", RUN_1 "/cancel", NULL, NULL, NULL, 200);
    assert_true(ask_body_has("\"status\":\"cancelled\""));
    ask("POST", "/v1/runs/" ID_2 "/cancel", NULL, NULL, NULL, 202);
    ask("POST", "/v1/runs/" ID_3 "/cancel", NULL, NULL, NULL, 409);
}

// Between the look at the run and its change another client may change it.
static void if_match_holds_until_the_change(void **state)
{
    ask_add_run(RUN_QUEUED);
    ask_daemon.n_changes_between = 1;
    ask("POST", RUN_1 "/cancel", NULL, "If-Match: \"r1\"\n", NULL, 412);
    assert_true(ask_body_has("it is \\\"r2\\\""));
    assert_int_equal(ask_daemon.runs[0].record.state, RUN_QUEUED);
    ask_daemon.n_changes_between = 1;
    ask("DELETE", RUN_1, NULL, "If-Match: \"r2\"\n", NULL, 412);
    ask_get(RUN_1, NULL, NULL, 200);
    ask_daemon.n_changes_between = 1;
    ask("POST", RUN_1 "/cancel", NULL, "If-Match: \"r3\", \"r4\"\n", NULL, 200);
    ask_daemon.n_changes_between = 2;
    ask("DELETE", RUN_1, NULL, "If-Match: *\n", NULL, 204);
}

// Without If-Match a change goes through whatever the revision has become.
static void a_change_without_if_match_needs_no_revision(void **state)
{
    ask_add_run(RUN_QUEUED);
    ask_daemon.n_changes_between = 1;
    ask("POST", RUN_1 "/cancel", NULL, NULL, NULL, 200);
    ask_daemon.n_changes_between = 1;
    ask("DELETE", RUN_1, NULL, NULL, NULL, 204);
    assert_int_equal(ask_daemon.n_changes_between, 0);
}

#define JSON_TYPE "Content-Type: application/json\n"

// RFC 7396: what a patch does not name stays, and null empties.
static void a_patch_changes_what_it_names(void **state)
{
    const api_run *record = &ask_daemon.runs[0].record;

    ask_add_run(RUN_SUCCEEDED);
    ask("PATCH", RUN_1, NULL, "Content-Type: application/merge-patch+json\n",
        "{\"name\": \"Monday\", \"notes\": \"as built\", \"starred\": true, \"line\": "
        "\"hall 2\"}",
        200);
    assert_true(ask_body_has("\"line\":\"hall 2\""));
    assert_true(ask_body_has("\"name\":\"Monday\""));
    assert_true(ask_body_has("\"notes\":\"as built\""));
    assert_true(ask_body_has("\"starred\":true"));
    assert_string_equal(helper_header(&ask_response, "ETag"), "\"r2\"");
    // Another client changes the run between the look at it and the change.
    ask_daemon.n_changes_between = 1;
    ask("PATCH", RUN_1, NULL, JSON_TYPE, "{\"label\": \"new\", \"notes\": null}", 200);
    assert_string_equal(record->name, "Monday");
    assert_string_equal(record->label, "new");
    assert_string_equal(record->notes, "");
    assert_false(ask_body_has("\"notes\""));
    assert_true(record->is_starred);
    assert_string_equal(record->line, "hall 2");
    ask("PATCH", RUN_1, NULL, JSON_TYPE, "{\"line\": null}", 200);
    assert_false(ask_body_has("\"line"));
    ask("PATCH", RUN_1, NULL, JSON_TYPE, "{\"starred\": null}", 200);
    assert_false(ask_body_has("\"starred\""));
    ask("PATCH", RUN_1, NULL, JSON_TYPE "If-Match: \"r2\"\n", "{}", 412);
}

static void a_patch_at_fault_changes_nothing(void **state)
{
    ask_add_run(RUN_SUCCEEDED);
    ask("PATCH", RUN_1, NULL, JSON_TYPE, "{\"name\": 7, \"status\": \"failed\"}", 422);
    assert_true(ask_body_has("\"pointer\":\"/name\""));
    assert_true(ask_body_has("\"pointer\":\"/status\""));
    ask("PATCH", RUN_1, NULL, JSON_TYPE, "{\"name\": ", 400);
    ask("PATCH", RUN_1, NULL, "Content-Type: text/plain\n", "name=x", 415);
    ask("PATCH", "/v1/runs/" ID_2, NULL, JSON_TYPE, "{}", 404);
    assert_int_equal(ask_daemon.runs[0].record.revision, 1);
}

static void a_removed_run_is_gone(void **state)
{
    ask_add_run(RUN_SUCCEEDED);
    ask("DELETE", RUN_1, NULL, NULL, NULL, 204);
    assert_int_equal(ask_response.body.n, 0);
    assert_null(helper_header(&ask_response, "Content-Type"));
    ask_get(RUN_1, NULL, NULL, 404);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(a_submitted_run_is_answered_with_its_place),
        ASK_TEST(a_body_that_is_not_json_is_a_bad_request),
        ASK_TEST(a_bad_document_is_answered_with_pointers),
        ASK_TEST(a_number_beyond_a_limit_is_told_with_both_and_their_unit),
        ASK_TEST(several_faults_are_told_together),
        ASK_TEST(only_json_is_taken),
        ASK_TEST(a_full_queue_asks_to_come_back),
        ASK_TEST(a_full_disk_asks_to_come_back),
        ASK_TEST(a_key_comes_to_the_daemon_with_the_body),
        ASK_TEST(an_answer_that_is_given_again_says_so),
        ASK_TEST(a_key_that_is_none_is_a_bad_request),
        ASK_TEST(a_key_with_another_body_and_one_in_use_are_told_apart),
        ASK_TEST(a_run_tells_whether_its_results_were_known),
        ASK_TEST(validate_says_the_same_and_stores_nothing),
        ASK_TEST(a_run_is_shown_with_a_tag_of_its_revision),
        ASK_TEST(a_list_has_the_newest_first_and_a_link_to_the_next),
        ASK_TEST(lines_are_listed_with_a_link_to_the_next),
        ASK_TEST(filters_reach_the_store_and_the_next_link),
        ASK_TEST(search_order_and_count_reach_the_store),
        ASK_TEST(conditions_reach_the_store_and_the_next_link),
        ASK_TEST(times_of_acceptance_reach_the_store_and_the_next_page),
        ASK_TEST(a_cursor_of_another_order_is_refused),
        ASK_TEST(orders_that_there_are_not_name_those_that_there_are),
        ASK_TEST(the_longest_link_fits),
        ASK_TEST(bad_list_queries_name_the_parameter),
        ASK_TEST(cancel_tells_whether_the_run_still_runs),
        ASK_TEST(a_patch_changes_what_it_names),
        ASK_TEST(a_patch_at_fault_changes_nothing),
        ASK_TEST(if_match_holds_until_the_change),
        ASK_TEST(a_change_without_if_match_needs_no_revision),
        ASK_TEST(a_removed_run_is_gone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

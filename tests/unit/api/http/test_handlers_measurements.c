// Measured curves over the API: store, list, show, remove.

#include "core/base/memory.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MEASURED     "/v1/measurements/0190a0b0-0000-7000-9000-000000000001"
#define NOT_MEASURED "/v1/measurements/0190a0b0-0000-7000-9000-0000000000ff"
#define IS_CSV       "Content-Type: text/csv\n"
#define GOOD_JSON                                                                                  \
    "{\"label\":\"camera\",\"counter\":\"gate\",\"t_s\":[0,0.5,1],\"count\":[192,190.5,0]}"

static void a_measurement_is_stored_and_comes_back(void **state)
{
    ask("POST", "/v1/measurements", NULL, IS_JSON, GOOD_JSON, 201);
    ask_assert_header("Location", MEASURED);
    assert_true(ask_body_has("{\"id\":\"0190a0b0-0000-7000-9000-000000000001\","
                             "\"label\":\"camera\",\"counter\":\"gate\",\"created_at\":\"2026-"));
    assert_true(
        ask_body_has("\"n_samples\":3,\"t_start_s\":0,\"t_end_s\":1,\"links\":{\"self\":\"" MEASURED
                     "\"},\"t_s\":[0,0.5,1],\"count\":[192,190.5,0]}"));
    char *stored = strdup(ask_response.body.bytes);
    ask_get(MEASURED, NULL, NULL, 200);
    assert_string_equal(ask_response.body.bytes, stored);
    free(stored);
    ask_get(MEASURED, "format=csv", NULL, 200);
    ask_assert_header("Content-Type", "text/csv; charset=utf-8");
    assert_string_equal(ask_response.body.bytes, "t_s,gate\n0,192\n0.5,190.5\n1,0\n");
}

static void what_is_known_already_is_not_sent_again(void **state)
{
    char header[160];

    helper_add_measurement(&ask_daemon, "upstream");
    ask_get(MEASURED, NULL, "Accept: text/csv\n", 200);
    snprintf(header, sizeof header, "Accept: text/csv\nIf-None-Match: %s\n",
             helper_header(&ask_response, "ETag"));
    ask_get(MEASURED, NULL, header, 304);
    ask_get(MEASURED, NULL, header + strlen("Accept: text/csv\n"), 200);
}

static void csv_has_its_label_and_counter_in_the_query(void **state)
{
    ask("POST", "/v1/measurements", "label=belt%207&counter=gate",
        "Content-Type: Text/CSV; charset=utf-8\n", "t_s,count\n0,5\n1,4\n", 201);
    assert_true(ask_body_has("\"label\":\"belt 7\",\"counter\":\"gate\""));
    assert_true(ask_body_has("\"t_s\":[0,1],\"count\":[5,4]"));
    ask("POST", "/v1/measurements", "label=x", IS_JSON, GOOD_JSON, 400);
    ask("POST", "/v1/measurements", "counter=x", IS_JSON, GOOD_JSON, 400);
    ask("POST", "/v1/measurements", "counter=a%20b", IS_CSV, "t_s,count\n0,5\n1,4\n", 422);
    assert_true(ask_body_has("\"pointer\":\"/counter\""));
    assert_int_equal(ask_daemon.n_measurements, 1);
}

static void texts_for_feeds_are_kept_as_they_came(void **state)
{
    static const char profile[] = "t_s,rate_per_h\r\n0,3600\r\n60,7200\r\n";

    ask("POST", "/v1/measurements", "kind=profile&label=day", IS_CSV, profile, 201);
    assert_true(
        ask_body_has("-000000000001\",\"kind\":\"profile\",\"label\":\"day\",\"created_at\":"));
    assert_true(ask_body_has("\"n_samples\":2,\"t_start_s\":0,\"t_end_s\":60,"));
    assert_true(ask_body_has("\"csv\":\"t_s,rate_per_h\\r\\n0,3600\\r\\n60,7200\\r\\n\"}"));
    assert_false(ask_body_has("counter"));
    ask_get(MEASURED, "format=csv", NULL, 200);
    assert_string_equal(ask_response.body.bytes, profile);
    // Kinds and places are looked up where a scenario reads the list.
    ask("POST", "/v1/measurements", "kind=schedule", IS_CSV,
        "t_s,kind,y_m,heading_deg\n0,box,0.1,\n0,tin,,90\n5,box,,\n", 201);
    assert_true(ask_body_has("\"kind\":\"schedule\",\"label\":\"\",\"created_at\":"));
    assert_true(ask_body_has("\"n_samples\":3,\"t_start_s\":0,\"t_end_s\":5,"));
}

static void texts_for_feeds_are_checked(void **state)
{
    static const struct {
        const char *query, *text, *expected;
    } cases[] = {
        { "kind=profile", "t_s,rate_per_s\n0,1\n5,2\n5,3\n",
          "\"pointer\":\"/line/4\",\"detail\":\"5 s do not come after the 5 s before them\"" },
        { "kind=profile", "t_s,kind\n0,box\n", "\"pointer\":\"/line/1\"" },
        { "kind=profile", "", "\"pointer\":\"/line/1\"" },
        { "kind=schedule", "t_s,kind\n0,big box\n", "\"pointer\":\"/line/2\"" },
        { "kind=schedule", "t_s,y_m\n0,left\n", "\"pointer\":\"/line/2\"" },
        { "kind=schedule&counter=gate", "t_s\n0\n", "\"pointer\":\"/counter\"" },
    };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ask("POST", "/v1/measurements", cases[k].query, IS_CSV, cases[k].text, 422);
        assert_true(ask_body_has(cases[k].expected));
    }
    ask("POST", "/v1/measurements", "kind=profile", IS_JSON, GOOD_JSON, 415);
    ask("POST", "/v1/measurements", "kind=rates", IS_CSV, "t_s,count\n0,5\n1,4\n", 400);
    ask("POST", "/v1/measurements", "kind=curve", IS_CSV, "t_s,count\n0,5\n1,4\n", 201);
    assert_int_equal(ask_daemon.n_measurements, 1);
}

static void faults_come_with_their_places(void **state)
{
    ask("POST", "/v1/measurements", NULL, IS_CSV, "t_s,count\n0,5\n\n1,-4\n1,3\n", 422);
    assert_true(ask_body_has("{\"pointer\":\"/line/4\",\"detail\":\"must not be negative"));
    assert_true(ask_body_has("{\"pointer\":\"/line/5\",\"detail\":\"times must rise"));
    ask("POST", "/v1/measurements", NULL, IS_JSON, "{\"t_s\":[0,1],\"count\":[1,\"2\"]}", 422);
    assert_true(ask_body_has("\"pointer\":\"/count/1\""));
    ask("POST", "/v1/measurements", NULL, IS_JSON, "{", 400);
    ask("POST", "/v1/measurements", NULL, IS_JSON, NULL, 400);
    ask("POST", "/v1/measurements", NULL, IS_CSV, NULL, 422);
    assert_int_equal(ask_daemon.n_measurements, 0);
}

static void a_body_of_another_type_is_refused(void **state)
{
    ask("POST", "/v1/measurements", NULL, "Content-Type: text/plain\n", "t_s,count\n0,1\n1,0\n",
        415);
    ask_assert_header("Accept", "application/json, text/csv");
    ask("POST", "/v1/measurements", NULL, NULL, GOOD_JSON, 415);
    ask("POST", "/v1/measurements", NULL, IS_JSON "Content-Encoding: br\n", GOOD_JSON, 415);
}

static void too_many_measurements_are_a_conflict(void **state)
{
    ask_daemon.refusal = BF_ECONFLICT;
    ask("POST", "/v1/measurements", NULL, IS_JSON, GOOD_JSON, 409);
}

static void measurements_are_listed_newest_first_page_by_page(void **state)
{
    for (int i = 0; i < 3; i++)
        memcpy(helper_add_measurement(&ask_daemon, "upstream")->about.label, i == 1 ? "b" : "a", 2);
    ask_get("/v1/measurements", NULL, NULL, 200);
    json_t *root = helper_json(&ask_response);
    json_t *list = json_object_get(root, "measurements");
    assert_int_equal(json_array_size(list), 3);
    const json_t *first = json_array_get(list, 0);
    assert_string_equal(json_string_value(json_object_get(first, "id")),
                        "0190a0b0-0000-7000-9000-000000000003");
    assert_null(json_object_get(first, "t_s")); // samples are not listed
    json_decref(root);
    assert_null(helper_header(&ask_response, "Link"));
    ask_get("/v1/measurements", "limit=1&label=a", NULL, 200);
    ask_assert_header("Link", "</v1/measurements?limit=1&label=a&cursor="
                              "0190a0b0-0000-7000-9000-000000000003>; rel=\"next\"");
    assert_true(ask_body_has("\"next_cursor\":\"0190a0b0-0000-7000-9000-000000000003\""));
    ask_get("/v1/measurements", "limit=1&label=a&cursor=0190a0b0-0000-7000-9000-000000000003", NULL,
            200);
    assert_true(ask_body_has("\"id\":\"0190a0b0-0000-7000-9000-000000000001\""));
    assert_null(helper_header(&ask_response, "Link"));
    ask_get("/v1/measurements", "limit=201", NULL, 400);
    ask_get("/v1/measurements", "cursor=x", NULL, 400);
    ask_get("/v1/measurements", "status=queued", NULL, 400);
}

static void a_removed_measurement_is_gone(void **state)
{
    helper_add_measurement(&ask_daemon, "upstream");
    ask("DELETE", MEASURED, NULL, "If-Match: \"other\"\n", NULL, 412);
    ask("DELETE", MEASURED, NULL, "If-None-Match: *\n", NULL, 412);
    ask("DELETE", MEASURED, NULL, NULL, NULL, 204);
    ask("DELETE", MEASURED, NULL, NULL, NULL, 404);
    ask_get(MEASURED, NULL, NULL, 404);
    ask_get(NOT_MEASURED, NULL, NULL, 404);
    ask_get("/v1/measurements/x", NULL, NULL, 404);
    ask("PUT", MEASURED, NULL, NULL, NULL, 405);
    ask_assert_header("Allow", "GET, HEAD, DELETE, OPTIONS");
}

// What was stored is never answered with a failure.
static void without_memory_nothing_is_stored(void **state)
{
    static const char *const types[] = { IS_JSON, IS_CSV, IS_CSV };
    static const char *const queries[] = { NULL, NULL, "kind=profile" };
    static const char *const bodies[] = { GOOD_JSON, "t_s,count\n0,5\n1,4\n",
                                          "t_s,count\n0,5\n1,4\n" };

    for (size_t k = 0; k < 3; k++) {
        for (size_t n = 1; ask_response.status != 201; n++) {
            api_response_fini(&ask_response);
            memory_plan_fault(n, 0);
            helper_request(&ask_daemon, "POST", "/v1/measurements", queries[k], types[k], bodies[k],
                           &ask_response);
            memory_plan_fault(0, 0);
            assert_true(ask_response.status == 201 || ask_response.status == 503);
            assert_int_equal(ask_daemon.n_measurements, k + (ask_response.status == 201));
            assert_true(n < 1000);
        }
        api_response_fini(&ask_response);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(a_measurement_is_stored_and_comes_back),
        ASK_TEST(what_is_known_already_is_not_sent_again),
        ASK_TEST(csv_has_its_label_and_counter_in_the_query),
        ASK_TEST(texts_for_feeds_are_kept_as_they_came),
        ASK_TEST(texts_for_feeds_are_checked),
        ASK_TEST(faults_come_with_their_places),
        ASK_TEST(a_body_of_another_type_is_refused),
        ASK_TEST(too_many_measurements_are_a_conflict),
        ASK_TEST(measurements_are_listed_newest_first_page_by_page),
        ASK_TEST(a_removed_measurement_is_gone),
        ASK_TEST(without_memory_nothing_is_stored),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// How a request becomes a stream.

#include "api/http/stream.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

static const stream_cursor *cursor(void)
{
    return ask_response.source.state;
}

static void a_stream_is_handed_to_the_transport(void **state)
{
    helper_add_event(&ask_daemon, ask_add_run(RUN_RUNNING), API_EVENT_STATUS, "{}");
    ask_get(RUN_1 "/events", NULL, NULL, 200);
    assert_true(ask_response.source.is_stream);
    assert_int_equal(cursor()->format, STREAM_SSE);
    assert_int_equal(cursor()->n_open, 1);
    ask_assert_header("Content-Type", "text/event-stream");
    ask_assert_header("Cache-Control", "no-store");
    ask_assert_header("X-Accel-Buffering", "no");
    ask_get(RUN_1 "/events", "inline=1", "Accept: application/x-ndjson\n", 200);
    assert_int_equal(cursor()->format, STREAM_NDJSON);
    assert_true(cursor()->is_inline);
    ask("HEAD", RUN_1 "/events", NULL, NULL, NULL, 200);
    assert_true(ask_response.source.is_stream);
    ask_assert_header("Content-Type", "text/event-stream");
}

static void a_stream_goes_on_behind_the_last_event_of_the_client(void **state)
{
    helper_run *of = ask_add_run(RUN_RUNNING);

    for (int i = 0; i < 9; i++)
        helper_add_event(&ask_daemon, of, API_EVENT_STATUS, "{}");
    ask_get(RUN_1 "/events", "last_event_id=3", NULL, 200);
    assert_int_equal(cursor()->after, 3);
    ask_get(RUN_1 "/events", "last_event_id=3", "Last-Event-ID: 7\n", 200);
    assert_int_equal(cursor()->after, 7);
    ask_get(RUN_1 "/events", NULL, "Last-Event-ID: \n", 200);
    assert_int_equal(cursor()->after, 0);
    ask_get(RUN_1 "/events", NULL, "Last-Event-ID: seven\n", 400);
    ask_get(RUN_1 "/events", "last_event_id=-1", NULL, 400);
    ask_get(RUN_1 "/events", "inline=yes", NULL, 400);
}

static void a_client_that_saw_the_end_gets_no_content(void **state)
{
    helper_run *of = ask_add_run(RUN_SUCCEEDED);

    helper_add_event(&ask_daemon, of, API_EVENT_END, "{}");
    ask_get(RUN_1 "/events", NULL, NULL, 200);
    ask_get(RUN_1 "/events", NULL, "Last-Event-ID: 1\n", 204);
    assert_false(ask_response.source.is_stream);
    assert_null(helper_header(&ask_response, "Content-Type"));
}

static void several_runs_are_followed_by_their_ids(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_add_run(RUN_QUEUED);
    ask_get("/v1/events", "runs=" ID_2 "," ID_1 "&format=ndjson", NULL, 200);
    assert_int_equal(cursor()->n_runs, 2);
    assert_string_equal(cursor()->runs[0], ID_2);
    assert_string_equal(cursor()->runs[1], ID_1);
    ask_get("/v1/events", NULL, NULL, 400);
    ask_get("/v1/events", "runs=", NULL, 400);
    ask_get("/v1/events", "runs=" ID_1 "," ID_1, NULL, 400);
    ask_get("/v1/events", "runs=" ID_1 ",", NULL, 404);
    ask_get("/v1/events", "runs=" ID_1 "," ID_3, NULL, 404);
    ask_get("/v1/events", "runs=" ID_1 "0", NULL, 404);
}

static void a_stream_follows_up_to_32_runs(void **state)
{
    char query[API_PATH_MAX] = "runs=";
    size_t n = strlen(query);

    for (int i = 0; i <= API_STREAM_RUNS_MAX; i++)
        n += (size_t)snprintf(query + n, sizeof query - n, "%s0190a0b0-0000-7000-8000-%012d",
                              i == 0 ? "" : ",", i);
    ask_get("/v1/events", query, NULL, 400);
    assert_true(ask_body_has("more than 32"));
    query[n - API_ID_SIZE] = '\0';
    ask_get("/v1/events", query, NULL, 404); // read to the end: the first is unknown
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(a_stream_is_handed_to_the_transport),
        ASK_TEST(a_stream_goes_on_behind_the_last_event_of_the_client),
        ASK_TEST(a_client_that_saw_the_end_gets_no_content),
        ASK_TEST(several_runs_are_followed_by_their_ids),
        ASK_TEST(a_stream_follows_up_to_32_runs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Event streams of studies: their bytes, going on behind any event, the end.

#include "api/http/study_stream.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

#define ID     "0190a0b0-0000-7000-a000-000000000001"
#define EVENTS "/v1/studies/" ID "/events"
#define TRIAL(number, parameter)                                                                   \
    "{\"trial\":" number ",\"point\":" number ",\"model\":\"macro\",\"substream\":0,\"status\":"   \
    "\"succeeded\",\"parameters\":{\"/p\":" parameter "},\"values\":{\"v\":0.5}}"

// Begins a stream and reads until there is nothing at the moment. The buffer is the caller's.
static body_state follow(uint64_t after, bool is_sse, size_t limit, bf_buffer *out)
{
    api_services services = helper_services(&ask_daemon);
    body_state where = BODY_MORE;
    char header[100];

    snprintf(header, sizeof header, "Last-Event-ID: %llu\nAccept: %s\n", (unsigned long long)after,
             is_sse ? "text/event-stream" : "application/x-ndjson");
    ask_get(EVENTS, NULL, header, 200);
    assert_true(ask_response.source.is_stream);
    assert_string_equal(ask_response.source.runs[0], ID);
    for (int i = 0; i < 100 && where == BODY_MORE; i++)
        assert_int_equal(ask_response.source.next_chunk(ask_response.source.state, &services, limit,
                                                        out, &where, NULL),
                         BF_OK);
    return where;
}

static void both_forms_have_the_same_events(void **state)
{
    helper_study *of = helper_add_study(&ask_daemon, API_STUDY_RUNNING);
    bf_buffer text = { 0 };

    helper_add_trial(of, API_TRIAL_SUCCEEDED);
    assert_int_equal(follow(0, true, 65536, &text), BODY_WAIT);
    assert_non_null(strstr(text.bytes, "retry: 3000\n\nevent: status\ndata: {\"id\":\"" ID "\""));
    assert_non_null(strstr(text.bytes, "}\n\nid: 1\nevent: trial\ndata: " TRIAL("0", "0") "\n\n"));
    text.n = 0;
    assert_int_equal(follow(0, false, 65536, &text), BODY_WAIT);
    assert_memory_equal(text.bytes, "{\"study\":\"" ID "\",\"event\":\"status\",\"data\":{", 60);
    assert_non_null(strstr(text.bytes, "}}\n{\"id\":1,\"study\":\"" ID "\",\"event\":\"trial\","
                                       "\"data\":" TRIAL("0", "0") "}\n"));
    buffer_fini(&text);
}

// The events with ids, from the text of a stream.
static void take_ids(const char *text, char *ret_ids)
{
    size_t n = 0;

    ret_ids[0] = '\0';
    for (const char *at = text; (at = strstr(at, "{\"id\":")) != NULL; at++)
        if (at[6] != '"')
            n += (size_t)sprintf(ret_ids + n, "%c", at[6]);
}

// However small the batches and wherever the client breaks off, it gets every trial once, in the order of their ends.
static void a_client_that_returns_misses_nothing_and_gets_nothing_twice(void **state)
{
    helper_study *of = helper_add_study(&ask_daemon, API_STUDY_SUCCEEDED);

    for (int k = 0; k < 5; k++)
        helper_add_trial(of, API_TRIAL_SUCCEEDED);
    of->trials[1].ended = 5;
    of->trials[4].ended = 2;
    for (uint64_t after = 0; after <= 5; after++)
        for (size_t limit = 1; limit < 2000; limit += 500) {
            bf_buffer text = { 0 };
            char ids[16];
            assert_int_equal(follow(after, false, limit, &text), BODY_DONE);
            take_ids(text.bytes, ids);
            assert_string_equal(ids, &"123456"[after]);
            buffer_fini(&text);
        }
    bf_buffer text = { 0 };
    follow(1, false, 65536, &text);
    assert_non_null(strstr(text.bytes, "{\"id\":2,\"study\":\"" ID "\",\"event\":\"trial\","
                                       "\"data\":" TRIAL("4", "40")));
    assert_non_null(strstr(text.bytes, "{\"id\":6,\"study\":\"" ID "\",\"event\":\"end\","
                                       "\"data\":{\"id\":\"" ID "\",\"status\":\"succeeded\""));
    buffer_fini(&text);
}

static void what_changes_while_it_is_followed_is_told_once(void **state)
{
    helper_study *of = helper_add_study(&ask_daemon, API_STUDY_RUNNING);
    api_services services = helper_services(&ask_daemon);
    bf_buffer text = { 0 };
    body_state where = BODY_MORE;

    assert_int_equal(follow(0, false, 65536, &text), BODY_WAIT);
    body_source *source = &ask_response.source;
    text.n = 0;
    assert_int_equal(source->next_chunk(source->state, &services, 65536, &text, &where, NULL),
                     BF_OK);
    assert_true(where == BODY_WAIT && text.n == 0);
    helper_add_trial(of, API_TRIAL_SUCCEEDED);
    assert_int_equal(source->next_chunk(source->state, &services, 65536, &text, &where, NULL),
                     BF_OK);
    assert_int_equal(where, BODY_WAIT);
    assert_non_null(strstr(text.bytes, "\"event\":\"status\""));
    assert_non_null(strstr(text.bytes, "\"event\":\"trial\""));
    of->about.id[0] = '\0';
    text.n = 0;
    assert_int_equal(source->next_chunk(source->state, &services, 65536, &text, &where, NULL),
                     BF_OK);
    assert_true(where == BODY_DONE && text.n == 0);
    buffer_fini(&text);
}

static void who_saw_the_end_gets_no_content(void **state)
{
    helper_study *of = helper_add_study(&ask_daemon, API_STUDY_CANCELLED);

    helper_add_trial(of, API_TRIAL_CANCELLED);
    ask_get(EVENTS, NULL, "Last-Event-ID: 2\n", 204);
    ask_get(EVENTS, "last_event_id=99", NULL, 204);
    ask_get(EVENTS, NULL, "Last-Event-ID: 1\n", 200);
    of->about.state = API_STUDY_RUNNING;
    ask_get(EVENTS, NULL, "Last-Event-ID: 99\n", 200);
    assert_int_equal(((study_stream *)ask_response.source.state)->after, 1);
    ask_get(EVENTS, NULL, "Last-Event-ID: x\n", 400);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(both_forms_have_the_same_events),
        ASK_TEST(a_client_that_returns_misses_nothing_and_gets_nothing_twice),
        ASK_TEST(what_changes_while_it_is_followed_is_told_once),
        ASK_TEST(who_saw_the_end_gets_no_content),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

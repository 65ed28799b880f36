// Answers that wait for a run: what they wait for, when it is over, and what is answered then.

#include "api/http/exchange.h"

#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

#define WAIT_5 IS_JSON "Prefer: wait=5\n"

static const char *no_header(void *context, const char *name)
{
    return NULL;
}

static void answer_again(const char *method, const char *path,
                         const char *(*header)(void *, const char *))
{
    const api_services services = helper_services(&ask_daemon);
    const api_request request = { .method = method, .path = path, .query = "", .header = header };

    api_handle_again(&services, &request, &ask_response);
}

static bool is_over(void)
{
    const api_services services = helper_services(&ask_daemon);
    return api_long_poll_is_over(&services, &ask_response.long_poll);
}

static void a_submission_that_prefers_so_waits_for_the_end(void **state)
{
    ask("POST", "/v1/runs", NULL, WAIT_5, BODY, 201);
    ask_assert_header("Preference-Applied", "wait=5");
    assert_int_equal(ask_response.long_poll.seconds, 5);
    assert_string_equal(ask_response.long_poll.run, ID_1);
    assert_false(is_over());
    ask_daemon.runs[0].record.state = RUN_RUNNING;
    ask_daemon.runs[0].record.revision++;
    assert_false(is_over());
    ask_daemon.runs[0].record.state = RUN_SUCCEEDED;
    assert_true(is_over());

    answer_again("POST", "/v1/runs", no_header);
    assert_int_equal(ask_daemon.n_submitted, 1);
    assert_int_equal(ask_response.status, 201);
    assert_int_equal(ask_response.long_poll.seconds, 0);
    ask_assert_header("Location", RUN_1);
    ask_assert_header("ETag", "\"r2\"");
    assert_true(ask_body_has("\"status\":\"succeeded\""));
}

static void a_run_that_is_gone_was_accepted_all_the_same(void **state)
{
    ask("POST", "/v1/runs", NULL, WAIT_5, BODY, 201);
    ask_daemon.runs[0].record.id[0] = '\0';
    assert_true(is_over());
    answer_again("POST", "/v1/runs", no_header);
    assert_int_equal(ask_response.status, 201);
    ask_assert_header("Location", RUN_1);
    ask_assert_header("Preference-Applied", "wait=5");
    assert_true(ask_body_has("\"status\":\"queued\""));
}

static void nobody_waits_longer_than_the_limit(void **state)
{
    ask("POST", "/v1/runs", NULL, IS_JSON "Prefer: wait=3600\n", BODY, 201);
    ask_assert_header("Preference-Applied", "wait=60");
    assert_int_equal(ask_response.long_poll.seconds, API_WAIT_MAX_S);
    ask_get(RUN_1, "wait=61", NULL, 400);
    ask_get(RUN_1, "wait=60", NULL, 200);
    assert_int_equal(ask_response.long_poll.seconds, 60);
}

static void without_the_preference_nothing_waits(void **state)
{
    ask("POST", "/v1/runs", NULL, IS_JSON, BODY, 201);
    assert_int_equal(ask_response.long_poll.seconds, 0);
    assert_null(helper_header(&ask_response, "Preference-Applied"));
    ask_get(RUN_1, NULL, NULL, 200);
    assert_int_equal(ask_response.long_poll.seconds, 0);
    ask("POST", "/v1/runs", NULL, WAIT_5, BAD_BODY, 422);
    assert_int_equal(ask_response.long_poll.seconds, 0);
}

static void who_has_the_state_waits_for_another_one(void **state)
{
    helper_run *item = ask_add_run(RUN_RUNNING);
    ask_get(RUN_1, "wait=5", "If-None-Match: \"r1\"\n", 304);
    assert_int_equal(ask_response.long_poll.seconds, 5);
    assert_false(is_over());
    item->record.revision++;
    assert_true(is_over());
    ask_get(RUN_1, "wait=5", "If-None-Match: \"r1\"\n", 200);
    assert_int_equal(ask_response.long_poll.seconds, 0);
}

static void who_has_no_state_waits_for_the_end(void **state)
{
    helper_run *item = ask_add_run(RUN_RUNNING);
    ask_get(RUN_1, "wait=5", NULL, 200);
    item->record.revision++;
    assert_false(is_over());
    item->record.state = RUN_FAILED;
    assert_true(is_over());
    answer_again("GET", RUN_1, no_header);
    assert_true(ask_body_has("\"status\":\"failed\""));
    ask_get(RUN_1, "wait=5", NULL, 200);
    assert_int_equal(ask_response.long_poll.seconds, 0);
    item->record.id[0] = '\0';
    answer_again("GET", RUN_1, no_header);
    assert_int_equal(ask_response.status, 404);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ASK_TEST(a_submission_that_prefers_so_waits_for_the_end),
        ASK_TEST(a_run_that_is_gone_was_accepted_all_the_same),
        ASK_TEST(nobody_waits_longer_than_the_limit),
        ASK_TEST(without_the_preference_nothing_waits),
        ASK_TEST(who_has_the_state_waits_for_another_one),
        ASK_TEST(who_has_no_state_waits_for_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

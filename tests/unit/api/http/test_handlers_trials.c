// What a study has: document, trials, what was found; and trials that are solved again.

#include "api/scenario/scenario.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

#define STUDY "/v1/studies/0190a0b0-0000-7000-a000-000000000001"

static helper_study *add_study(void)
{
    return helper_add_study(&ask_daemon, API_STUDY_RUNNING);
}

static void the_document_does_not_change(void **state)
{
    add_study();
    ask_get(STUDY "/document", NULL, NULL, 200);
    ask_assert_header("ETag", "\"0190a0b0-0000-7000-a000-000000000001-document\"");
    assert_string_equal(ask_response.body.bytes, "{\"name\":\"\"}");
    ask_get(STUDY "/document", NULL, "If-None-Match: *\n", 304);
}

static void nothing_found_is_a_conflict(void **state)
{
    helper_study *of = add_study();

    ask_get(STUDY "/best", NULL, NULL, 409);
    of->best = "{\"best\":null}";
    ask_get(STUDY "/best", NULL, NULL, 200);
    assert_string_equal(ask_response.body.bytes, of->best);
    assert_non_null(helper_header(&ask_response, "ETag"));
}

static void trials_come_page_by_page(void **state)
{
    helper_study *of = add_study();

    helper_add_trial(of, API_TRIAL_SUCCEEDED);
    helper_add_trial(of, API_TRIAL_RUNNING);
    helper_add_trial(of, API_TRIAL_QUEUED);
    ask_get(STUDY "/trials", "limit=2", NULL, 200);
    ask_assert_header("Link", "<" STUDY "/trials?limit=2&from=2>; rel=\"next\"");
    assert_string_equal(ask_response.body.bytes,
                        "{\"trials\":["
                        "{\"trial\":0,\"point\":0,\"model\":\"macro\",\"substream\":0,\"status\":"
                        "\"succeeded\",\"parameters\":{\"/p\":0},\"values\":{\"v\":0.5}},"
                        "{\"trial\":1,\"point\":1,\"model\":\"macro\",\"substream\":0,\"status\":"
                        "\"running\",\"parameters\":{\"/p\":10},\"values\":{}}],"
                        "\"has_more\":true,\"next_from\":2}");
    ask_get(STUDY "/trials", "limit=2&from=2", NULL, 200);
    assert_null(helper_header(&ask_response, "Link"));
    assert_true(ask_body_has("\"trial\":2"));
    ask_get(STUDY "/trials", "limit=1001", NULL, 400);
    ask_get(STUDY "/trials", "from=-1", NULL, 400);
}

// The whole body of the answer; its chunks are small.
static bf_buffer drain(void)
{
    api_services services = helper_services(&ask_daemon);
    body_source *source = &ask_response.source;
    body_state where = BODY_MORE;
    bf_buffer out = { 0 };

    for (int i = 0; i < 100 && where == BODY_MORE; i++)
        assert_int_equal(source->next_chunk(source->state, &services, 1, &out, &where, NULL),
                         BF_OK);
    assert_int_equal(where, BODY_DONE);
    return out;
}

// A trial that ends while the lines are sent is of another state of the study.
static void as_csv_those_that_have_ended_come_in_pieces(void **state)
{
    helper_study *of = add_study();

    helper_add_trial(of, API_TRIAL_SUCCEEDED);
    api_trial *second = helper_add_trial(of, API_TRIAL_RUNNING);
    helper_add_trial(of, API_TRIAL_INFEASIBLE)->fault =
        (bf_error){ .code = BF_EINPUT, .pointer = "/a", .text = "b" };
    ask_get(STUDY "/trials", "format=csv", NULL, 200);
    ask_assert_header("ETag", "\"r4-csv\"");
    second->ended = 3;
    bf_buffer text = drain();
    assert_string_equal(text.bytes, "trial,point,model,substream,/p,state,v,fault\n"
                                    "0,0,macro,0,0,succeeded,0.5,\n"
                                    "2,2,macro,0,20,infeasible,0.5,/a: b\n");
    buffer_fini(&text);
    ask_get(STUDY "/trials", "format=csv", "If-None-Match: \"r4-csv\"\n", 304);
}

static bf_buffer resolved(void)
{
    bf_buffer text = { 0 };
    bf_faults faults = { 0 };
    scene s;

    assert_int_equal(scenario_read(SCENARIO, strlen(SCENARIO), &s, &faults, NULL), BF_OK);
    assert_int_equal(scenario_write(&s, &text, NULL), BF_OK);
    scene_fini(&s);
    return text;
}

// A trial of the microscopic model that was solved, and its run, whose scenario is that.
static helper_run *add_solved_trial(helper_study *of, const bf_buffer *scenario)
{
    helper_run *solved = ask_add_run(RUN_SUCCEEDED);
    api_trial *trial = helper_add_trial(of, API_TRIAL_SUCCEEDED);

    solved->scenario = scenario->bytes;
    trial->model = RUN_MICRO;
    memcpy(trial->run, solved->record.id, sizeof trial->run);
    return solved;
}

static void a_trial_is_solved_again_as_a_run(void **state)
{
    bf_buffer scenario = resolved();
    helper_study *of = add_study();
    helper_run *solved = add_solved_trial(of, &scenario);

    ask("POST", STUDY "/trials/0/run", NULL, NULL, NULL, 201);
    ask_assert_header("Location", "/v1/runs/" ID_2);
    assert_int_equal(ask_daemon.submitted.model, RUN_MICRO);
    assert_false(ask_daemon.submitted.is_fresh);
    assert_string_equal(ask_daemon.submitted.name, "one part");
    ask("POST", STUDY "/trials/1/run", NULL, NULL, NULL, 404);
    ask("POST", STUDY "/trials/x/run", NULL, NULL, NULL, 404);
    solved->record.id[0] = '\0';
    ask("POST", STUDY "/trials/0/run", NULL, NULL, NULL, 409);
    assert_true(ask_body_has("was removed"));
    helper_add_trial(of, API_TRIAL_INFEASIBLE);
    ask("POST", STUDY "/trials/1/run", NULL, NULL, NULL, 409);
    assert_true(ask_body_has("has no run: its scenario is not valid"));
    assert_int_equal(ask_daemon.n_submitted, 1);
    buffer_fini(&scenario);
}

static const char *no_header(void *context, const char *name)
{
    return NULL;
}

static void who_waits_for_a_run_gets_it_even_when_its_study_is_gone(void **state)
{
    const api_services services = helper_services(&ask_daemon);
    const api_request request = {
        .method = "POST", .path = STUDY "/trials/0/run", .query = "", .header = no_header
    };
    bf_buffer scenario = resolved();
    helper_study *of = add_study();

    add_solved_trial(of, &scenario);
    ask("POST", STUDY "/trials/0/run", NULL, "Prefer: wait=5\n", NULL, 201);
    assert_string_equal(ask_response.long_poll.run, ID_2);
    of->about.id[0] = '\0';
    ask_daemon.runs[1].record.state = RUN_SUCCEEDED;
    api_handle_again(&services, &request, &ask_response);
    assert_int_equal(ask_response.status, 201);
    ask_assert_header("Location", "/v1/runs/" ID_2);
    assert_true(ask_body_has("\"status\":\"succeeded\""));
    assert_int_equal(ask_daemon.n_submitted, 1);
    buffer_fini(&scenario);
}

static void runs_of_trials_are_listed_for_their_study_alone(void **state)
{
    ask_add_run(RUN_SUCCEEDED);
    strcpy(ask_add_run(RUN_SUCCEEDED)->record.study, "0190a0b0-0000-7000-a000-000000000001");
    ask_get("/v1/runs", NULL, NULL, 200);
    assert_true(ask_body_has(ID_1));
    assert_false(ask_body_has(ID_2));
    ask_get("/v1/runs", "study=0190a0b0-0000-7000-a000-000000000001", NULL, 200);
    assert_false(ask_body_has(ID_1));
    assert_true(ask_body_has("\"study\":\"0190a0b0-0000-7000-a000-000000000001\""));
    assert_true(ask_body_has("\"study\":\"" STUDY "\""));
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(the_document_does_not_change),
        ASK_TEST(nothing_found_is_a_conflict),
        ASK_TEST(trials_come_page_by_page),
        ASK_TEST(as_csv_those_that_have_ended_come_in_pieces),
        ASK_TEST(a_trial_is_solved_again_as_a_run),
        ASK_TEST(who_waits_for_a_run_gets_it_even_when_its_study_is_gone),
        ASK_TEST(runs_of_trials_are_listed_for_their_study_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

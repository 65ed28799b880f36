// Tests of the supervisor with trials of studies: runs by themselves do not wait for them.

#include "server/store/studies.h"
#include "tests/unit/server/helper_jobs.h"

#include <stdio.h>
#include <string.h>

// A study that is running, with n trials that wait.
static void begin_study(helper_jobs *f, size_t n, char (*ret_runs)[API_ID_SIZE])
{
    api_study_submission submission = { .trials_max = n };
    api_submission trial = { .model = RUN_MACRO };
    store_trial_begin begins[4] = { { .submission = NULL } };
    api_acceptance accepted = { 0 };
    api_study after;

    assert_in_range(n, 1, 4);
    assert_int_equal(buffer_printf(&submission.document, "{}"), BF_OK);
    assert_int_equal(buffer_printf(&submission.columns, "{}"), BF_OK);
    assert_int_equal(store_submit_study(f->world->store, &submission, &accepted, NULL), BF_OK);
    const store_study_step start = { .id = accepted.id, .state = API_STUDY_RUNNING };
    assert_int_equal(store_step_study(f->world->store, &start, &after, NULL), BF_OK);
    assert_int_equal(buffer_printf(&trial.scenario, "%s", helper_jobs_belt), BF_OK);
    assert_int_equal(buffer_printf(&trial.columns, "upstream,left_domain"), BF_OK);
    for (size_t k = 0; k < n; k++)
        begins[k] = (store_trial_begin){ .trial = { .number = k }, .submission = &trial };
    const store_study_step step = {
        .id = accepted.id, .n_begins = n, .begins = begins, .state = API_STUDY_STATES
    };
    assert_int_equal(store_step_study(f->world->store, &step, &after, NULL), BF_OK);
    supervisor_wake(f->world->supervisor);
    for (size_t k = 0; k < n; k++)
        memcpy(ret_runs[k], begins[k].trial.run, API_ID_SIZE);
    buffer_fini(&accepted.answer);
    buffer_fini(&submission.document);
    buffer_fini(&submission.columns);
    buffer_fini(&trial.scenario);
    buffer_fini(&trial.columns);
}

static void a_run_by_itself_begins_beside_trials(void **state)
{
    helper_jobs *f = *state;
    char runs[3][API_ID_SIZE];

    f->world->options.n_workers = 1;
    helper_supervise(f->world);
    begin_study(f, 3, runs);
    // One more than workers, so that no core idles between two of them.
    helper_await_state(f->world, runs[0], RUN_RUNNING);
    helper_await_state(f->world, runs[1], RUN_RUNNING);
    const api_run single = helper_world_submit(f->world, helper_jobs_belt);
    helper_await_state(f->world, single.id, RUN_RUNNING);
    api_run third;
    assert_int_equal(store_find(f->world->store, runs[2], &third, NULL), BF_OK);
    assert_int_equal(third.state, RUN_QUEUED);
}

static void trials_go_on_when_runs_by_themselves_have_ended(void **state)
{
    helper_jobs *f = *state;
    char runs[1][API_ID_SIZE];

    f->world->options.n_workers = 1;
    const api_run single = helper_jobs_start(f);
    begin_study(f, 1, runs);
    const api_run next = helper_world_submit(f->world, helper_jobs_belt);
    helper_executor_begin(f->executor, 0);
    helper_executor_finish(f->executor, 0, false);
    helper_executor_end(f->executor, 0, API_JOB_EXITED);
    helper_await_state(f->world, single.id, RUN_SUCCEEDED);
    helper_await_state(f->world, next.id, RUN_RUNNING);
    api_run trial;
    assert_int_equal(store_find(f->world->store, runs[0], &trial, NULL), BF_OK);
    assert_int_equal(trial.state, RUN_QUEUED);
    helper_executor_await(f->executor, 2);
    helper_executor_begin(f->executor, 1);
    helper_executor_finish(f->executor, 1, false);
    helper_executor_end(f->executor, 1, API_JOB_EXITED);
    helper_await_state(f->world, runs[0], RUN_RUNNING);
}

int main(void)
{
#define TEST(function)                                                                             \
    cmocka_unit_test_setup_teardown(function, helper_jobs_setup, helper_jobs_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_run_by_itself_begins_beside_trials),
        TEST(trials_go_on_when_runs_by_themselves_have_ended),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Tests of the times that the supervisor gives: how long a job may stand still, and how long a run may take.

#include "tests/unit/server/helper_jobs.h"

#include <string.h>
#include <unistd.h>

static void send_progress(helper_executor *e, uint64_t step)
{
    const frame f = { .type = FRAME_PROGRESS, .progress = { .step = step, .n_steps = 10 } };

    helper_executor_send(e, 0, &f);
    usleep(50000);
}

static api_run find_run(const helper_jobs *f, const char *id)
{
    api_run record = { .state = RUN_QUEUED };

    assert_int_equal(store_find(f->world->store, id, &record, NULL), BF_OK);
    return record;
}

// Reports of the same step again and again are no progress; what is stored stays.
static void a_job_that_stands_still_fails_its_run(void **state)
{
    helper_jobs *f = *state;

    f->world->options.stall_s = 1;
    api_run record = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 5, 0.0);
    while (find_run(f, record.id).state == RUN_RUNNING)
        send_progress(f->executor, 1);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ELIMIT);
    assert_non_null(strstr(record.error.text, "stood still"));
    assert_int_equal(helper_executor_job(f->executor, 0).n_now, 1);
    helper_jobs_assert_data(f->world, record.id, 5, 0);
}

static void a_job_that_sends_nothing_at_all_fails_its_run(void **state)
{
    helper_jobs *f = *state;

    f->world->options.stall_s = 1;
    api_run record = helper_await_state(f->world, helper_jobs_start(f).id, RUN_FAILED);
    assert_non_null(strstr(record.error.text, "stood still"));
}

// The store takes longer than a job may stand still.
static void a_job_that_waits_for_the_store_does_not_stand_still(void **state)
{
    helper_jobs *f = *state;

    f->world->options.stall_s = 1;
    api_run record = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    helper_executor_samples(f->executor, 0, 0, 1, 0.0);
    helper_await_samples(f->world, record.id, 1);
    helper_world_slow_commits(f->world, 2500);
    helper_executor_samples(f->executor, 0, 1, 1, 0.0);
    helper_await_samples(f->world, record.id, 2);
    helper_world_slow_commits(f->world, 0);
    helper_executor_finish(f->executor, 0, false);
    helper_await_state(f->world, record.id, RUN_SUCCEEDED);
}

static void a_run_that_takes_too_long_fails(void **state)
{
    helper_jobs *f = *state;
    uint64_t step = 0;

    f->world->options.wall_s = 1;
    api_run record = helper_jobs_start(f);
    helper_executor_begin(f->executor, 0);
    while (find_run(f, record.id).state == RUN_RUNNING)
        send_progress(f->executor, step < 9 ? ++step : step);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ELIMIT);
    assert_non_null(strstr(record.error.text, "limit of time"));
}

// The attempts before have used the time up.
static void all_attempts_together_must_not_take_too_long(void **state)
{
    helper_jobs *f = *state;
    store_job job = { .step = 0 };
    api_run record = helper_world_submit(f->world, helper_jobs_belt);
    store_batch batch = { .run_id = record.id, .wall_s = 3601 };
    store_ending ending = { .run_id = record.id, .state = RUN_QUEUED };

    assert_int_equal(store_claim(f->world->store, true, &job, NULL), BF_OK);
    store_job_fini(&job);
    assert_int_equal(helper_store_append(f->world->store, &batch, NULL), BF_OK);
    assert_int_equal(store_finish(f->world->store, &ending, &record, NULL), BF_OK);
    f->world->options.wall_s = 3600;
    helper_supervise(f->world);
    record = helper_await_state(f->world, record.id, RUN_FAILED);
    assert_non_null(strstr(record.error.text, "limit of time"));
}

int main(void)
{
#define TEST(function)                                                                             \
    cmocka_unit_test_setup_teardown(function, helper_jobs_setup, helper_jobs_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_job_that_stands_still_fails_its_run),
        TEST(a_job_that_sends_nothing_at_all_fails_its_run),
        TEST(a_job_that_waits_for_the_store_does_not_stand_still),
        TEST(a_run_that_takes_too_long_fails),
        TEST(all_attempts_together_must_not_take_too_long),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

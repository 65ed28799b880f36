// Tests of what operators need of the supervisor: other options while it works, figures, signs of life.

#include "server/base/metrics.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_supervisor.h"

#include <string.h>
#include <unistd.h>

// 80 steps of 12 x 24 cells.
static const char tiny[] = "{\"duration_s\":0.1,\"domain\":{\"x_m\":[0,0.24],\"y_m\":[0,0.12]},"
                           "\"cargo\":{},\"initial\":{\"positions_m\":[[0.06,0.06]]},"
                           "\"macro\":{\"cell_m\":0.01,\"step_s\":0.00125}}";

// A jam that does not end.
static const char endless[] =
    "{\"duration_s\":200000,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"
    "\"obstacles\":[{\"from_m\":[0.75,0],\"to_m\":[0.75,0.6]}],\"cargo\":{},"
    "\"initial\":{\"hexagonal\":{\"rows\":16,\"columns\":12,\"first_m\":[0.1,0.11],"
    "\"spacing_m\":0.02448}},\"output\":{\"curve_every_s\":1,\"snapshot_every_s\":1000},"
    "\"macro\":{\"cell_m\":0.01,\"step_s\":0.0025}}";

static void steps_frames_and_ends_are_counted(void **state)
{
    helper_world *w = *state;
    int64_t n_steps = metrics_value(METRICS_SOLVER_STEPS, RUN_MACRO);
    int64_t n_ok = metrics_value(METRICS_CHILD_EXITS, METRICS_EXIT_OK);

    helper_supervise(w);
    (void)helper_await_state(w, helper_world_submit(w, tiny).id, RUN_SUCCEEDED);
    assert_int_equal(metrics_value(METRICS_SOLVER_STEPS, RUN_MACRO), n_steps + 80);
    assert_int_equal(metrics_value(METRICS_CHILD_EXITS, METRICS_EXIT_OK), n_ok + 1);
}

static void what_is_being_solved_is_shown_while_it_is(void **state)
{
    helper_world *w = *state;

    helper_supervise(w);
    api_run created = helper_world_submit(w, endless);
    (void)helper_await_samples(w, created.id, 1);
    HELPER_AWAIT(metrics_value(METRICS_SOLVER_RATE, RUN_MACRO) > 0);
    assert_int_equal(metrics_value(METRICS_SOLVER_ITEMS, RUN_MACRO), 6000);
    helper_world_kill(w, created.id);
    HELPER_AWAIT(metrics_value(METRICS_SOLVER_RATE, RUN_MACRO) == 0);
    assert_int_equal(metrics_value(METRICS_SOLVER_ITEMS, RUN_MACRO), 0);
}

// The child's end, by a script that ends in this way.
static void assert_reason(helper_world *w, const char *script, metrics_reason reason)
{
    int64_t before = metrics_value(METRICS_CHILD_EXITS, reason);

    helper_world_fake(w, script);
    helper_supervise(w);
    (void)helper_await_state(w, helper_world_submit(w, tiny).id, RUN_FAILED);
    assert_int_equal(metrics_value(METRICS_CHILD_EXITS, reason), before + 1);
    helper_world_stop(w, 1000);
}

static void ends_are_told_apart_by_their_reason(void **state)
{
    helper_world *w = *state;

    assert_reason(w, "exit 1", METRICS_EXIT_ERROR);
    assert_reason(w, "kill -SEGV $$", METRICS_EXIT_SIGNAL);
    assert_reason(w, "kill -XCPU $$", METRICS_EXIT_TIMEOUT);
}

static void more_workers_take_what_waits_and_fewer_let_it_wait(void **state)
{
    helper_world *w = *state;
    char ids[4][API_ID_SIZE];

    w->options.n_workers = 1;
    helper_supervise(w);
    for (int i = 0; i < 3; i++)
        memcpy(ids[i], helper_world_submit(w, endless).id, API_ID_SIZE);
    (void)helper_await_state(w, ids[0], RUN_RUNNING);
    w->options.n_workers = 3;
    supervisor_reconfigure(w->supervisor, &w->options);
    (void)helper_await_state(w, ids[1], RUN_RUNNING);
    (void)helper_await_state(w, ids[2], RUN_RUNNING);
    // Those that run go on; the next one starts when fewer than one are left.
    w->options.n_workers = 1;
    supervisor_reconfigure(w->supervisor, &w->options);
    memcpy(ids[3], helper_world_submit(w, tiny).id, API_ID_SIZE);
    for (int i = 0; i < 2; i++) {
        helper_world_kill(w, ids[i]);
        assert_int_equal(usleep(100000), 0);
        (void)helper_await_state(w, ids[3], RUN_QUEUED);
    }
    helper_world_kill(w, ids[2]);
    (void)helper_await_state(w, ids[3], RUN_SUCCEEDED);
}

static void a_supervisor_that_works_gives_signs_of_life(void **state)
{
    helper_world *w = *state;

    helper_supervise(w);
    assert_true(supervisor_is_alive(w->supervisor)); // was never asked before
    for (int i = 0; i < 3; i++)
        HELPER_AWAIT(supervisor_is_alive(w->supervisor));
    api_run created = helper_world_submit(w, endless);
    (void)helper_await_state(w, created.id, RUN_RUNNING);
    for (int i = 0; i < 3; i++)
        HELPER_AWAIT(supervisor_is_alive(w->supervisor));
}

int main(void)
{
#define TEST(function)                                                                             \
    cmocka_unit_test_setup_teardown(function, helper_world_setup, helper_world_teardown)
    const struct CMUnitTest tests[] = {
        TEST(steps_frames_and_ends_are_counted),
        TEST(what_is_being_solved_is_shown_while_it_is),
        TEST(ends_are_told_apart_by_their_reason),
        TEST(more_workers_take_what_waits_and_fewer_let_it_wait),
        TEST(a_supervisor_that_works_gives_signs_of_life),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

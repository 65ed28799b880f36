// Unit tests of when a run reports, saves itself and stops.

#include "server/run/run_control.h"
#include "tests/unit/helper_cmocka.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

enum { NEVER_MS = 1000000 };

static void the_first_report_is_due_at_once_and_the_next_after_its_time(void **state)
{
    run_control p = run_control_init(NEVER_MS, 0);
    assert_int_equal(run_control_requested(&p), RUN_REPORT);
    assert_int_equal(run_control_requested(&p), RUN_GO_ON);
    // The clock is moved by moving what it is compared with.
    p.next_report_ns -= NEVER_MS * INT64_C(1000000);
    assert_int_equal(run_control_requested(&p), RUN_REPORT);
    assert_int_equal(run_control_requested(&p), RUN_GO_ON);
}

static void checkpoints_come_in_their_own_time(void **state)
{
    run_control p = run_control_init(NEVER_MS, NEVER_MS);
    assert_int_equal(run_control_requested(&p), RUN_REPORT);
    p.next_checkpoint_ns -= NEVER_MS * INT64_C(1000000);
    assert_int_equal(run_control_requested(&p), RUN_CHECKPOINT);
    assert_int_equal(run_control_requested(&p), RUN_GO_ON);
}

// Signals stay caught for the rest of the process: each case has its own.
static int in_process(int (*body)(void))
{
    int status = 0;
    pid_t pid = fork();

    if (pid == 0)
        _exit(body());
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return status;
}

static int stop_with_checkpoint(void)
{
    run_control p = run_control_init(NEVER_MS, NEVER_MS), q = run_control_init(NEVER_MS, 0);

    run_control_catch(SIGTERM, RUN_CONTROL_CATCH_ALL);
    if (run_control_is_stopped())
        return 1;
    raise(SIGTERM);
    raise(SIGTERM);
    bool ok = run_control_is_stopped() &&
              run_control_requested(&p) == (RUN_STOP | RUN_CHECKPOINT) &&
              run_control_requested(&q) == RUN_STOP;
    return ok ? 0 : 2;
}

static void a_signal_asks_for_a_stop_with_a_checkpoint_where_there_are_any(void **state)
{
    int status = in_process(stop_with_checkpoint);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

static int stop_twice(void)
{
    run_control_catch(SIGINT, RUN_CONTROL_CATCH_FIRST);
    raise(SIGINT);
    if (!run_control_is_stopped())
        return 1;
    raise(SIGINT);
    return 2;
}

static void a_second_signal_ends_a_process_that_catches_the_first(void **state)
{
    int status = in_process(stop_twice);
    assert_true(WIFSIGNALED(status));
    assert_int_equal(WTERMSIG(status), SIGINT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_report_is_due_at_once_and_the_next_after_its_time),
        cmocka_unit_test(checkpoints_come_in_their_own_time),
        cmocka_unit_test(a_signal_asks_for_a_stop_with_a_checkpoint_where_there_are_any),
        cmocka_unit_test(a_second_signal_ends_a_process_that_catches_the_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

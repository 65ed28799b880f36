// Unit tests of the local executor in a system that fails: the n-th call that starting a child needs, and the n-th
// allocation, for n = 1, 2, ... until a start needs no n-th. A start that fails leaves neither descriptor nor child.

#include "core/base/memory.h"
#include "server/run/local_executor.h"
#include "tests/unit/server/helper_fault.h"
#include "tests/unit/server/helper_supervisor.h"

#include <dirent.h>
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/pidfd.h>
#include <sys/types.h>
#include <unistd.h>

// ------------------------------------------------------------------------ what fails

static int n_spawned;      // children
static pid_t last_spawned; // the last of them

// The functions below take the place of the C library's.

int pipe2(int fds[2], int flags)
{
    int (*next)(int *, int);

    helper_fault_next("pipe2", &next);
    return helper_fault_is_due() ? -1 : next(fds, flags);
}

int pidfd_open(pid_t pid, unsigned flags)
{
    int (*next)(pid_t, unsigned);

    helper_fault_next("pidfd_open", &next);
    return helper_fault_is_due() ? -1 : next(pid, flags);
}

int epoll_create1(int flags)
{
    int (*next)(int);

    helper_fault_next("epoll_create1", &next);
    return helper_fault_is_due() ? -1 : next(flags);
}

int epoll_ctl(int epoll, int what, int fd, struct epoll_event *event)
{
    int (*next)(int, int, int, struct epoll_event *);

    helper_fault_next("epoll_ctl", &next);
    return helper_fault_is_due() ? -1 : next(epoll, what, fd, event);
}

int posix_spawnp(pid_t *pid, const char *path, const posix_spawn_file_actions_t *actions,
                 const posix_spawnattr_t *attributes, char *const *argv, char *const *environment)
{
    int (*next)(pid_t *, const char *, const posix_spawn_file_actions_t *,
                const posix_spawnattr_t *, char *const *, char *const *);

    helper_fault_next("posix_spawnp", &next);
    if (helper_fault_is_due())
        return errno;
    const int error = next(pid, path, actions, attributes, argv, environment);
    n_spawned++;
    last_spawned = *pid;
    return error;
}

// ------------------------------------------------------------------------ starts

static size_t count_descriptors(void)
{
    DIR *folder = opendir("/proc/self/fd");
    size_t n = 0;

    assert_non_null(folder);
    while (readdir(folder) != NULL)
        n++;
    closedir(folder);
    return n;
}

static void run_to_its_end(executor *e, executor_job *job)
{
    char bytes[4096];
    executor_end end;
    size_t n;

    for (;;) {
        struct pollfd wake = { .fd = e->wake_fd, .events = POLLIN };
        const executor_state state = e->functions->poll(e, job, bytes, sizeof bytes, &n, &end);
        if (state == EXECUTOR_ENDED)
            break;
        assert_int_equal(state, EXECUTOR_RUNNING);
        if (n == 0) {
            assert_true(poll(&wake, 1, 60000) == 1);
            e->functions->update(e);
        }
    }
    assert_int_equal(end.cause, API_JOB_EXITED);
}

// Solve a run to its end.
static bf_status solve_with(executor *e, int64_t checkpoint_ms, bf_error *err)
{
    bf_buffer scenario = { 0 }, checkpoint = { 0 };
    executor_job *job = NULL;

    scenario.bytes = (char *)(uintptr_t)helper_short_belt;
    scenario.n = strlen(helper_short_belt);
    const executor_work work = { .run_id = "a run",
                                 .model = RUN_MACRO,
                                 .n_threads = 1,
                                 .scenario = &scenario,
                                 .checkpoint = &checkpoint,
                                 .limits = { .checkpoint_ms = checkpoint_ms } };
    const bf_status status = e->functions->start(e, &work, &job, err);
    if (status == BF_OK) {
        run_to_its_end(e, job);
        e->functions->release(e, job);
    } else {
        assert_null(job);
    }
    return status;
}

// Create an executor, solve a run with it, and destroy it.
static bf_status solve(bf_error *err)
{
    executor *e = NULL;

    bf_status status = local_executor_create(PROGRAM_DIR "/beltflow-worker", &e, err);
    if (status != BF_OK)
        return status;
    status = solve_with(e, 0, err);
    (void)local_executor_destroy(e);
    return status;
}

static bool is_from_outside(bf_status status)
{
    return status == BF_EBUSY || status == BF_ESYSTEM || status == BF_ENOMEM;
}

static void check_start(bf_status status, const bf_error *err, bool has_failed, size_t n_before)
{
    assert_true(has_failed ? is_from_outside(status) : status == BF_OK);
    assert_true(status == BF_OK || err->text[0] != '\0');
    assert_int_equal(count_descriptors(), n_before);
    assert_true(helper_is_childless());
}

static size_t start_with(int error)
{
    const size_t n_before = count_descriptors();

    for (size_t n = 1;; n++) {
        bf_error err = { 0 };
        helper_fault_plan(n, error);
        const bf_status status = solve(&err);
        const bool has_failed = helper_fault_calls() >= n;
        helper_fault_plan(0, 0);
        check_start(status, &err, has_failed, n_before);
        if (!has_failed)
            return n - 1;
    }
}

// An executor, three pipes, a child, its descriptor, and four descriptors that are watched.
static void any_call_may_fail(void **state)
{
    assert_int_equal(start_with(EMFILE), 10);
    assert_int_equal(start_with(EAGAIN), 10);
    assert_int_equal(start_with(EPERM), 10);
}

static void any_allocation_may_fail(void **state)
{
    const size_t n_before = count_descriptors();
    size_t n_faults = 1, n_allocations = 0;

    for (size_t n = 1; n_faults > 0; n++) {
        bf_error err = { 0 };
        memory_plan_fault(n, 0);
        const bf_status status = solve(&err);
        n_faults = memory_faults();
        memory_plan_fault(0, 0);
        check_start(status, &err, n_faults > 0, n_before);
        n_allocations += n_faults;
    }
    assert_true(n_allocations > 0);
}

// A child that waits serves one job, with the limits that it was started with, and only if it still waits.
static void a_child_is_started_ahead(void **state)
{
    const executor_limits limits = { .checkpoint_ms = 1000 };
    const size_t n_before = count_descriptors();
    executor *e = NULL;
    int n = n_spawned;

    assert_int_equal(local_executor_create(PROGRAM_DIR "/beltflow-worker", &e, NULL), BF_OK);
    e->functions->prepare(e, &limits);
    e->functions->prepare(e, &limits);
    assert_int_equal(n_spawned, n + 1);
    assert_int_equal(solve_with(e, limits.checkpoint_ms, NULL), BF_OK);
    assert_int_equal(n_spawned, n + 1);
    assert_int_equal(solve_with(e, limits.checkpoint_ms, NULL), BF_OK);
    assert_int_equal(n_spawned, n + 2);
    e->functions->prepare(e, &limits);
    assert_int_equal(solve_with(e, limits.checkpoint_ms + 1, NULL), BF_OK);
    assert_int_equal(n_spawned, n + 4);
    e->functions->prepare(e, &limits);
    assert_int_equal(kill(last_spawned, SIGTERM), 0);
    struct pollfd wake = { .fd = e->wake_fd, .events = POLLIN };
    assert_int_equal(poll(&wake, 1, 60000), 1);
    assert_int_equal(solve_with(e, limits.checkpoint_ms, NULL), BF_OK);
    assert_int_equal(n_spawned, n + 6);
    e->functions->prepare(e, &limits);
    (void)local_executor_destroy(e);
    assert_true(helper_is_childless());
    assert_int_equal(count_descriptors(), n_before);
}

// Whatever fails ahead of a job, the job starts.
static void a_child_that_cannot_be_started_ahead_is_started_later(void **state)
{
    const executor_limits limits = { .checkpoint_ms = 1000 };
    const size_t n_before = count_descriptors();
    executor *e = NULL;

    assert_int_equal(local_executor_create(PROGRAM_DIR "/beltflow-worker", &e, NULL), BF_OK);
    for (size_t n = 1, n_calls = n; n_calls >= n; n++) {
        helper_fault_plan(n, EMFILE);
        e->functions->prepare(e, &limits);
        n_calls = helper_fault_calls();
        helper_fault_plan(0, 0);
        assert_true(n_calls < n || helper_is_childless());
        assert_int_equal(solve_with(e, limits.checkpoint_ms, NULL), BF_OK);
    }
    (void)local_executor_destroy(e);
    assert_int_equal(count_descriptors(), n_before);
}

// The supervisor puts off what cannot be started now.
static void a_run_is_solved_when_children_can_be_started_again(void **state)
{
    helper_world *w = *state;

    helper_supervise(w);
    helper_fault_plan(4, EAGAIN); // the child, behind the pipes
    const api_run record = helper_world_submit(w, helper_short_belt);
    (void)helper_await_state(w, record.id, RUN_SUCCEEDED);
    assert_true(helper_fault_calls() > 4);
    helper_fault_plan(0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_call_may_fail),
        cmocka_unit_test(any_allocation_may_fail),
        cmocka_unit_test(a_child_is_started_ahead),
        cmocka_unit_test(a_child_that_cannot_be_started_ahead_is_started_later),
        cmocka_unit_test_setup_teardown(a_run_is_solved_when_children_can_be_started_again,
                                        helper_world_setup, helper_world_teardown),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Tests of the supervisor with workers that fail or are at fault, and of what limits a run.

#include "api/scenario/scenario.h"
#include "core/observe/frame.h"
#include "core/run/run.h"
#include "server/base/log.h"
#include "server/base/metrics.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_executor.h"
#include "tests/unit/server/helper_store.h"
#include "tests/unit/server/helper_supervisor.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

// An address sanitizer needs more address space than any limit, so the worker sets none.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CAN_LIMIT_MEMORY 0
#else
#define CAN_LIMIT_MEMORY 1
#endif

// 6 million cells: one array of doubles alone has 49 MB.
static const char vast_belt[] = "{\"duration_s\":1,\"domain\":{\"x_m\":[0,16],\"y_m\":[0,9.6]},"
                                "\"cargo\":{},\"initial\":{\"positions_m\":[[0.5,0.3]]},"
                                "\"macro\":{\"cell_m\":0.005,\"step_s\":\"auto\"}}";

// ------------------------------------------------------------------------ failing workers

// The error of a run whose worker is this script.
static bf_error fail_with(helper_world *w, const char *lines)
{
    helper_world_fake(w, lines);
    if (w->supervisor == NULL)
        helper_supervise(w);
    api_run record = helper_world_submit(w, helper_short_belt);
    return helper_await_state(w, record.id, RUN_FAILED).error;
}

static void assert_says(const bf_error *err, bf_status code, const char *words)
{
    assert_int_equal(err->code, code);
    if (strstr(err->text, words) == NULL)
        fail_msg("'%s' does not say '%s'", err->text, words);
}

static void a_crash_costs_one_run_and_says_so(void **state)
{
    helper_world *w = *state;

    bf_error err = fail_with(w, "echo 'last words' >&2\nkill -SEGV $$");
    assert_says(&err, BF_ESYSTEM, "SIGSEGV");
    assert_says(&err, BF_ESYSTEM, "last words");
    err = fail_with(w, "exit 3");
    assert_says(&err, BF_ESYSTEM, "exit code 3");
    err = fail_with(w, "kill -KILL $$");
    // Who killed it is not known, and not guessed.
    assert_says(&err, BF_ESYSTEM, "killed from outside (SIGKILL)");
    assert_null(strstr(err.text, "out of memory"));
    // The service goes on.
    strcpy(w->program, PROGRAM_DIR "/beltflow-worker");
    api_run record = helper_world_submit(w, helper_short_belt);
    helper_await_state(w, record.id, RUN_SUCCEEDED);
}

static void what_is_no_frame_fails_the_run(void **state)
{
    helper_world *w = *state;

    bf_error err = fail_with(w, "echo 'this text is no frame at all'\nsleep 1000");
    assert_says(&err, BF_ECORRUPT, "not a frame");
    assert_true(helper_is_childless());
    err = fail_with(w, "printf BFF1");
    assert_says(&err, BF_ECORRUPT, "inside a frame");
}

static size_t encode_to_file(const helper_world *w, const frame *frames, size_t n, char *ret_path)
{
    bf_buffer bytes = { 0 };

    for (size_t i = 0; i < n; i++)
        helper_encode(&frames[i], &bytes);
    strcpy(ret_path, helper_world_file(w, "frames", bytes.bytes, bytes.n));
    size_t n_bytes = bytes.n;
    buffer_fini(&bytes);
    return n_bytes;
}

// Run a program that sends n frames and exits with 1; the run, which has failed.
static api_run fail_after(helper_world *w, const frame *frames, size_t n)
{
    char path[HELPER_PATH_SIZE], lines[1024];

    encode_to_file(w, frames, n, path);
    snprintf(lines, sizeof lines, "cat '%s'; exit 1", path);
    helper_world_fake(w, lines);
    helper_supervise(w);
    api_run record = helper_world_submit(w, helper_short_belt);
    return helper_await_state(w, record.id, RUN_FAILED);
}

static const frame begin_frame = {
    .type = FRAME_BEGIN,
    .begin = { .n_columns = 2, .n_steps = 10, .grid = { .n1 = 4, .n2 = 2, .d1 = 1, .d2 = 1 } },
};

// It sends a sample when it has begun to ignore signals.
static void a_worker_that_heeds_no_signal_is_killed(void **state)
{
    const double t = 0.0, values[] = { 1.0, 0.0 };
    const frame frames[] = {
        begin_frame,
        { .type = FRAME_CURVE, .curve = { .n = 1, .n_columns = 2, .t = &t, .values = values } },
    };
    helper_world *w = *state;
    char path[HELPER_PATH_SIZE], lines[1024];

    encode_to_file(w, frames, 2, path);
    snprintf(lines, sizeof lines, "trap '' TERM\ncat '%s'\nsleep 1000", path);
    helper_world_fake(w, lines);
    helper_supervise(w);
    api_run record = helper_world_submit(w, helper_short_belt);
    helper_await_samples(w, record.id, 1);
    helper_world_cancel(w, record.id);
    helper_await_state(w, record.id, RUN_CANCELLED);
    // The same when stopping, with the grace that is given; the run is not lost.
    record = helper_world_submit(w, helper_short_belt);
    helper_await_samples(w, record.id, 1);
    helper_world_stop(w, 50);
    assert_true(helper_is_childless());
    helper_await_state(w, record.id, RUN_QUEUED);
}

static void a_torn_or_damaged_frame_fails_the_run(void **state)
{
    helper_world *w = *state;
    char path[HELPER_PATH_SIZE], lines[1024];

    size_t n = encode_to_file(w, &begin_frame, 1, path);
    snprintf(lines, sizeof lines, "head -c %zu '%s'", n - 1, path);
    bf_error err = fail_with(w, lines);
    assert_says(&err, BF_ECORRUPT, "inside a frame");
    snprintf(lines, sizeof lines, "head -c %zu '%s'; printf Y; sleep 1000", n - 1, path);
    err = fail_with(w, lines);
    assert_says(&err, BF_ECORRUPT, "damaged");
}

static void frames_that_make_no_sense_fail_the_run(void **state)
{
    static const double numbers[6] = { 0 };
    static const float rho[8] = { 0 };
    static const frame wrong[][2] = {
        { { .type = FRAME_END }, { .type = FRAME_END } },
        { { .type = FRAME_RESUME }, { .type = FRAME_END } },
        { { .type = FRAME_BEGIN, .begin = { .n_columns = 3 } }, { .type = FRAME_END } },
        { { .type = FRAME_BEGIN, .begin = { .n_columns = 2 } },
          { .type = FRAME_BEGIN, .begin = { .n_columns = 2 } } },
        { { .type = FRAME_BEGIN, .begin = { .n_columns = 2 } },
          { .type = FRAME_CURVE,
            .curve = { .n = 1, .n_columns = 3, .t = numbers, .values = numbers } } },
        { { .type = FRAME_BEGIN, .begin = { .n_columns = 2, .grid = { .n1 = 2, .n2 = 4 } } },
          { .type = FRAME_SNAPSHOT, .snapshot = { .n1 = 4, .n2 = 2, .rho = rho } } },
        { { .type = FRAME_BEGIN, .begin = { .n_columns = 2, .n_steps = 10 } },
          { .type = FRAME_PROGRESS, .progress = { .step = 11, .n_steps = 10 } } },
        { { .type = FRAME_BEGIN, .begin = { .n_columns = 2, .n_parts = 1, .n_values = 6 } },
          { .type = FRAME_PARTS, .parts = { .n_parts = 1, .n_values = 6, .rows = numbers } } },
    };
    helper_world *w = *state;
    char path[HELPER_PATH_SIZE], lines[1024];

    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        encode_to_file(w, wrong[i], 2, path);
        snprintf(lines, sizeof lines, "cat '%s'", path);
        bf_error err = fail_with(w, lines);
        assert_says(&err, BF_ECORRUPT, "the solver ");
    }
}

// Parts of another snapshot, of another number, none at all, and of a model without any.
static void parts_that_do_not_follow_their_snapshot_fail_the_run(void **state)
{
    static const double rows[12] = { 0 };
    static const float rho[8] = { 0 };
    static const frame third[] = {
        { .type = FRAME_PARTS, .parts = { .index = 1, .n_parts = 2, .n_values = 6, .rows = rows } },
        { .type = FRAME_PARTS, .parts = { .n_parts = 1, .n_values = 6, .rows = rows } },
        { .type = FRAME_CHECKPOINT, .bytes = { .n = 0, .bytes = "" } },
        { .type = FRAME_PARTS, .parts = { .n_parts = 2, .n_values = 6, .rows = rows } },
    };
    helper_world *w = *state;
    char path[HELPER_PATH_SIZE], lines[1024];

    for (size_t i = 0; i < sizeof third / sizeof *third; i++) {
        frame frames[] = { begin_frame,
                           { .type = FRAME_SNAPSHOT, .snapshot = { .n1 = 4, .n2 = 2, .rho = rho } },
                           third[i] };
        frames[0].begin.n_parts = 2;
        frames[0].begin.n_values = i < 3 ? 6 : 0;
        encode_to_file(w, frames, 3, path);
        snprintf(lines, sizeof lines, "cat '%s'", path);
        bf_error err = fail_with(w, lines);
        assert_says(&err, BF_ECORRUPT, "the solver ");
    }
}

// A snapshot is published with its parts, so that a client that reads the event can fetch them.
static void a_snapshot_without_its_parts_is_not_kept(void **state)
{
    static const double rows[12] = { 0 };
    static const float rho[8] = { 0 };
    const frame frames[] = {
        { .type = FRAME_BEGIN,
          .begin = { .n_columns = 2,
                     .n_steps = 10,
                     .n_parts = 2,
                     .n_values = 6,
                     .grid = { .n1 = 4, .n2 = 2, .d1 = 1, .d2 = 1 } } },
        { .type = FRAME_SNAPSHOT, .snapshot = { .n1 = 4, .n2 = 2, .rho = rho } },
        { .type = FRAME_PARTS, .parts = { .n_parts = 2, .n_values = 6, .rows = rows } },
        { .type = FRAME_SNAPSHOT, .snapshot = { .index = 1, .n1 = 4, .n2 = 2, .rho = rho } },
        { .type = FRAME_ERROR, .error = { .code = BF_ENUMERIC, .text = "part 3 flew off" } },
    };

    const api_run record = fail_after(*state, frames, 5);
    assert_says(&record.error, BF_ENUMERIC, "part 3 flew off");
    assert_int_equal(record.n_snapshots, 1);
}

static void what_came_before_the_solver_failed_is_kept(void **state)
{
    const double t[] = { 0.0, 0.01 }, values[] = { 1.0, 0.0, 0.5, 0.5 };
    const frame frames[] = {
        begin_frame,
        { .type = FRAME_CURVE, .curve = { .n = 2, .n_columns = 2, .t = t, .values = values } },
        { .type = FRAME_ERROR, .error = { .code = BF_ENUMERIC, .text = "cell 3 is not finite" } },
    };

    const api_run record = fail_after(*state, frames, 3);
    assert_says(&record.error, BF_ENUMERIC, "cell 3 is not finite");
    assert_int_equal(record.n_samples, 2);
}

// Excessive output and a job that is not read must neither block the supervisor nor exhaust its memory.
static void a_worker_that_only_talks_costs_nothing(void **state)
{
    helper_world *w = *state;

    bf_error err = fail_with(w, "exec <&-\nyes 'a line that nobody wants to read' | head -n 200000 "
                                ">&2\nexit 1");
    assert_says(&err, BF_ESYSTEM, "a line that nobody");
}

// Wait for a few attempts.
static void outlast_backoff(void)
{
    usleep(3500000);
}

// Put a program that solves into the place that the supervisor has been told, complete and with its mode at once.
static void make_program(helper_world *w, mode_t mode)
{
    static const char text[] = "#!/bin/sh\nexec '" PROGRAM_DIR "/beltflow' \"$@\"\n";
    const char *path = helper_world_file(w, "made", text, strlen(text));

    assert_int_equal(chmod(path, mode), 0);
    assert_int_equal(rename(path, w->program), 0);
}

// A program that is missing, and then one that may not be executed: runs are not even claimed.
static void runs_wait_for_a_program_that_cannot_be_started(void **state)
{
    helper_world *w = *state;
    bf_error err = { 0 };
    api_run runs[2];

    snprintf(w->program, sizeof w->program, "%.200s/fake", w->directory);
    int64_t n_errors = metrics_value(METRICS_LOG_LINES, LOG_LEVEL_ERROR);
    helper_supervise(w);
    for (int i = 0; i < 2; i++)
        runs[i] = helper_world_submit(w, helper_short_belt);
    assert_int_equal(supervisor_ready(w->supervisor, &err), BF_ESYSTEM);
    assert_says(&err, BF_ESYSTEM, "fake cannot be started: No such file");
    outlast_backoff();
    make_program(w, 0600);
    assert_int_equal(supervisor_ready(w->supervisor, &err), BF_ESYSTEM);
    // Once a minute.
    assert_int_equal(metrics_value(METRICS_LOG_LINES, LOG_LEVEL_ERROR), n_errors + 1);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(store_find(w->store, runs[i].id, &runs[i], NULL), BF_OK);
        assert_int_equal(runs[i].state, RUN_QUEUED);
        assert_int_equal(runs[i].started_ms, 0);
    }
    assert_int_equal(chmod(w->program, 0700), 0);
    for (int i = 0; i < 2; i++)
        helper_await_state(w, runs[i].id, RUN_SUCCEEDED);
    assert_int_equal(supervisor_ready(w->supervisor, &err), BF_OK);
}

// It can be started, and then its loader or its interpreter finds no library or program: 127.
static void runs_wait_for_a_program_that_lacks_something(void **state)
{
    helper_world *w = *state;
    bf_error err = { 0 };

    helper_world_fake(w, "exec /nonexistent/beltflow");
    int64_t n_errors = metrics_value(METRICS_LOG_LINES, LOG_LEVEL_ERROR);
    helper_supervise(w);
    api_run record = helper_world_submit(w, helper_short_belt);
    outlast_backoff();
    assert_int_equal(supervisor_ready(w->supervisor, &err), BF_ESYSTEM);
    assert_says(&err, BF_ESYSTEM, "cannot be executed (exit code 127)");
    assert_int_equal(metrics_value(METRICS_LOG_LINES, LOG_LEVEL_ERROR), n_errors + 1);
    make_program(w, 0700);
    helper_await_state(w, record.id, RUN_SUCCEEDED);
    assert_int_equal(supervisor_ready(w->supervisor, &err), BF_OK);
}

// ------------------------------------------------------------------------ limits

static void a_run_beyond_its_memory_fails_alone(void **state)
{
    helper_world *w = *state;

    if (!CAN_LIMIT_MEMORY)
        skip();
    w->options.memory_bytes = 64 * 1024 * 1024;
    helper_supervise(w);
    api_run record = helper_world_submit(w, vast_belt);
    record = helper_await_state(w, record.id, RUN_FAILED);
    assert_int_equal(record.error.code, BF_ENOMEM);
}

static void a_run_beyond_its_processor_time_fails_alone(void **state)
{
    helper_world *w = *state;

    w->options.cpu_s = 1;
    helper_supervise(w);
    api_run record = helper_world_submit(w, helper_long_jam);
    record = helper_await_state(w, record.id, RUN_FAILED);
    assert_says(&record.error, BF_ELIMIT, "limit of 1 CPU seconds");
}

// A program that sends 2 samples, then more than 100 kB at once, and then waits.
static void make_talkative(helper_world *w)
{
    enum { MANY = 5000 };
    static const double t[MANY] = { 0.0, 0.01 }, values[2 * MANY] = { 0 };
    const frame frames[] = {
        begin_frame,
        { .type = FRAME_CURVE, .curve = { .n = 2, .n_columns = 2, .t = t, .values = values } },
        { .type = FRAME_CURVE,
          .curve = { .first = 2, .n = MANY, .n_columns = 2, .t = t, .values = values } },
    };
    char path[HELPER_PATH_SIZE], lines[1024];

    encode_to_file(w, frames, 3, path);
    snprintf(lines, sizeof lines, "cat '%s'; exec sleep 1000", path);
    helper_world_fake(w, lines);
}

// What came before the limit stays, as in runs that fail for other reasons. A program that solves would reach the limit
// only when it has computed for it.
static void a_run_beyond_its_output_fails_alone(void **state)
{
    helper_world *w = *state;

    const int64_t n_ends = metrics_value(METRICS_CHILD_EXITS, METRICS_EXIT_OUTPUT);

    w->options.output_bytes = 100 * 1024;
    make_talkative(w);
    helper_supervise(w);
    api_run record = helper_world_submit(w, helper_short_belt);
    record = helper_await_state(w, record.id, RUN_FAILED);
    assert_says(&record.error, BF_ELIMIT, "more than 102400 bytes, its limit (run_output_bytes)");
    assert_int_equal(record.n_samples, 2);
    assert_int_equal(metrics_value(METRICS_CHILD_EXITS, METRICS_EXIT_OUTPUT), n_ends + 1);
    assert_true(helper_is_childless());
    strcpy(w->program, PROGRAM_DIR "/beltflow-worker");
    record = helper_world_submit(w, helper_short_belt);
    helper_await_state(w, record.id, RUN_SUCCEEDED);
}

// Its first act is to look for its parent: one that was lost in between is noticed, too.
static void a_worker_without_its_parent_ends_at_once(void **state)
{
    char byte;

    if (getpid() == 1)
        skip();
    FILE *output = popen("exec '" PROGRAM_DIR "/beltflow' worker --parent 1 </dev/null", "re");
    assert_non_null(output);
    assert_int_equal(fread(&byte, 1, 1, output),
                     0); // not even an error frame: it would not be read
    assert_int_not_equal(pclose(output), 0);
}

// A limit on the size of files stands for a full disk: the run's first samples fit, the rest do not.
static void a_full_disk_hands_the_run_back_and_hangs_nothing(void **state)
{
    helper_world *w = *state;
    struct rlimit before, limit;

    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    limit = before;
    limit.rlim_cur = 600 * 1024;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    helper_supervise(w);
    api_run record = helper_world_submit(w, helper_long_jam);
    helper_await_samples(w, record.id, 1);
    HELPER_AWAIT(helper_is_childless());
    helper_world_stop(w, 1000);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    helper_world_reopen(w);
    assert_int_equal(store_find(w->store, record.id, &record, NULL), BF_OK);
    assert_int_equal(record.state, RUN_QUEUED);
}

// With room for nothing the store takes neither results nor the end of the run; with room again
// the run must not stay `running` without a child.
static void a_run_whose_end_could_not_be_stored_goes_on_later(void **state)
{
    helper_world *w = *state;
    struct rlimit before, limit;

    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    helper_supervise(w);
    api_run record = helper_world_submit(w, helper_long_jam);
    helper_await_samples(w, record.id, 1);
    limit = before;
    limit.rlim_cur = 1;
    int64_t n_errors = metrics_value(METRICS_LOG_LINES, LOG_LEVEL_ERROR);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    // The child is gone before the store has refused every way to end the run, which is logged.
    HELPER_AWAIT(metrics_value(METRICS_LOG_LINES, LOG_LEVEL_ERROR) > n_errors);
    assert_true(helper_is_childless());
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_int_equal(store_find(w->store, record.id, &record, NULL), BF_OK);
    assert_int_equal(record.state, RUN_RUNNING);
    helper_await_samples(w, record.id, record.n_samples + 1);
    assert_false(helper_is_childless());
}

int main(void)
{
#define TEST(function)                                                                             \
    cmocka_unit_test_setup_teardown(function, helper_world_setup, helper_world_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_crash_costs_one_run_and_says_so),
        TEST(what_is_no_frame_fails_the_run),
        TEST(a_worker_that_heeds_no_signal_is_killed),
        TEST(a_torn_or_damaged_frame_fails_the_run),
        TEST(frames_that_make_no_sense_fail_the_run),
        TEST(parts_that_do_not_follow_their_snapshot_fail_the_run),
        TEST(a_snapshot_without_its_parts_is_not_kept),
        TEST(what_came_before_the_solver_failed_is_kept),
        TEST(a_worker_that_only_talks_costs_nothing),
        TEST(runs_wait_for_a_program_that_cannot_be_started),
        TEST(runs_wait_for_a_program_that_lacks_something),
        TEST(a_run_beyond_its_memory_fails_alone),
        TEST(a_run_beyond_its_output_fails_alone),
        TEST(a_run_beyond_its_processor_time_fails_alone),
        TEST(a_worker_without_its_parent_ends_at_once),
        TEST(a_full_disk_hands_the_run_back_and_hangs_nothing),
        TEST(a_run_whose_end_could_not_be_stored_goes_on_later),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

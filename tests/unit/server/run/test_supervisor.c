// Tests of the supervisor with a real store and, where nothing else is said, the real program.

#include "api/scenario/scenario.h"
#include "core/run/frame.h"
#include "core/run/run.h"
#include "server/base/log.h"
#include "server/base/metrics.h"
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

// Ends soon: 101 samples, 11 snapshots.
static const char short_belt[] = "{\"duration_s\":1,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"
                                 "\"cargo\":{},\"initial\":{\"positions_m\":[[0.5,0.3]]},"
                                 "\"macro\":{\"cell_m\":0.02,\"step_s\":\"auto\"}}";

// A jam that does not end: cargo in front of a wall across the whole belt.
#define JAM(duration, cell, snapshots)                                                             \
    "{\"duration_s\":" duration ",\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"                     \
    "\"obstacles\":[{\"from_m\":[0.75,0],\"to_m\":[0.75,0.6]}],\"cargo\":{},"                      \
    "\"initial\":{\"hexagonal\":{\"rows\":16,\"columns\":12,\"first_m\":[0.1,0.11],"               \
    "\"spacing_m\":0.02448}},\"output\":{\"curve_every_s\":0.05,\"snapshot_every_s\":" snapshots   \
    "},\"macro\":{\"cell_m\":" cell ",\"step_s\":\"auto\"}}"

static const char long_jam[] = JAM("5000", "0.005", "100");
static const char medium_jam[] = JAM("60", "0.01", "1");

// 6 million cells: one array of doubles alone has 49 MB.
static const char vast_belt[] = "{\"duration_s\":1,\"domain\":{\"x_m\":[0,16],\"y_m\":[0,9.6]},"
                                "\"cargo\":{},\"initial\":{\"positions_m\":[[0.5,0.3]]},"
                                "\"macro\":{\"cell_m\":0.005,\"step_s\":\"auto\"}}";

// ------------------------------------------------------------------------ what comes out

// The samples and snapshots of a scenario, solved here.
typedef struct solution {
    bf_buffer t;
    bf_buffer values;
    bf_buffer last_rho;
    bf_buffer last_parts;
    uint64_t n_snapshots;
} solution;

static bf_status take_frame(void *context, const frame *f, bf_error *err)
{
    solution *s = context;
    (void)err;

    if (f->type == FRAME_CURVE) {
        size_t n = f->curve.n;
        assert_int_equal(buffer_append(&s->t, f->curve.t, n * sizeof(double)), BF_OK);
        assert_int_equal(
            buffer_append(&s->values, f->curve.values, n * f->curve.n_columns * sizeof(double)),
            BF_OK);
    }
    if (f->type == FRAME_SNAPSHOT) {
        s->last_rho.n = 0;
        assert_int_equal(buffer_append(&s->last_rho, f->snapshot.rho,
                                       (size_t)f->snapshot.n1 * f->snapshot.n2 * sizeof(float)),
                         BF_OK);
        s->n_snapshots = f->snapshot.index + 1;
    }
    if (f->type == FRAME_PARTS) {
        size_t n = (size_t)f->parts.n_parts * f->parts.n_values * sizeof(double);
        s->last_parts.n = 0;
        assert_int_equal(buffer_append(&s->last_parts, f->parts.rows, n), BF_OK);
    }
    return BF_OK;
}

static solution solve_here(const char *json, run_model model)
{
    solution s = { .n_snapshots = 0 };
    run_sink sink = { .context = &s, .take = take_frame };
    bf_faults faults = { 0 };
    run *r = NULL;
    scene resolved;

    assert_int_equal(scenario_read(json, strlen(json), &resolved, &faults, NULL), BF_OK);
    assert_int_equal(run_create(&resolved, model, 1, &r, NULL), BF_OK);
    assert_int_equal(run_execute(r, &sink, NULL), BF_OK);
    run_destroy(r);
    scene_fini(&resolved);
    return s;
}

static void assert_same_results(helper_world *w, const char *id, const char *json)
{
    solution s = solve_here(json, w->model);
    api_curve curve = { 0 };
    api_snapshot snapshot;
    bf_grid grid;
    bf_buffer rho = { 0 };

    assert_int_equal(store_read_curve(w->store, id, 0, &curve, NULL), BF_OK);
    assert_int_equal(curve.t.n, s.t.n);
    assert_memory_equal(curve.t.bytes, s.t.bytes, s.t.n);
    assert_int_equal(curve.values.n, s.values.n);
    assert_memory_equal(curve.values.bytes, s.values.bytes, s.values.n);
    assert_int_equal(
        store_read_snapshot(w->store, id, s.n_snapshots - 1, &snapshot, &grid, &rho, NULL), BF_OK);
    assert_int_equal(rho.n, s.last_rho.n);
    assert_memory_equal(rho.bytes, s.last_rho.bytes, rho.n);
    rho.n = 0;
    if (w->model == RUN_MICRO) {
        api_parts parts;
        assert_int_equal(
            store_read_parts(w->store, id, s.n_snapshots - 1, &snapshot, &parts, &rho, NULL),
            BF_OK);
        assert_int_equal(rho.n, s.last_parts.n);
        assert_memory_equal(rho.bytes, s.last_parts.bytes, rho.n);
    }
    api_curve_fini(&curve);
    buffer_fini(&rho);
    buffer_fini(&s.last_parts);
    buffer_fini(&s.t);
    buffer_fini(&s.values);
    buffer_fini(&s.last_rho);
}

static void a_queued_run_is_solved_and_stored(void **state)
{
    helper_world *w = *state;
    bf_buffer summary = { 0 };

    helper_supervise(w);
    api_run submitted = helper_world_submit(w, short_belt);
    api_run ended = helper_await_state(w, submitted.id, RUN_SUCCEEDED);
    assert_true(ended.progress == 1.0);
    assert_int_equal(ended.n_samples, 101); // every 0.01 s of 1 s, and at 0
    assert_int_equal(ended.n_snapshots, 11);
    assert_true(ended.has_summary);
    assert_int_equal(store_read_text(w->store, ended.id, API_TEXT_SUMMARY, &summary, NULL), BF_OK);
    assert_non_null(strstr(summary.bytes, "\"model\":\"macro\""));
    assert_non_null(strstr(summary.bytes, "\"key_figures\":{\"throughput_per_h\":"));
    assert_non_null(strstr(ended.figures, "{\"throughput_per_h\":"));
    summary.n = 0;
    assert_int_equal(store_read_text(w->store, ended.id, API_TEXT_FIGURES, &summary, NULL), BF_OK);
    assert_non_null(strstr(summary.bytes, "\"counters\":[{\"id\":\"upstream\",\"content\":"));
    buffer_fini(&summary);
    assert_same_results(w, ended.id, short_belt);
}

static void a_microscopic_run_is_stored_with_its_parts(void **state)
{
    helper_world *w = *state;
    api_snapshot_list list = { 0 };

    w->model = RUN_MICRO;
    helper_supervise(w);
    api_run submitted = helper_world_submit(w, short_belt);
    api_run ended = helper_await_state(w, submitted.id, RUN_SUCCEEDED);
    assert_int_equal(ended.n_snapshots, 11);
    assert_int_equal(store_list_snapshots(w->store, ended.id, &list, NULL), BF_OK);
    assert_int_equal(list.parts.n_parts, 1);
    assert_int_equal(list.parts.n_values, FRAME_VALUES_PLANAR);
    assert_same_results(w, ended.id, short_belt);
    buffer_fini(&list.items);
}

static void what_is_queued_before_the_start_is_solved_too(void **state)
{
    helper_world *w = *state;
    api_run runs[5];

    w->options.n_workers = 2;
    for (size_t i = 0; i < 5; i++)
        runs[i] = helper_world_submit(w, short_belt);
    helper_supervise(w);
    for (size_t i = 0; i < 5; i++)
        helper_await_state(w, runs[i].id, RUN_SUCCEEDED);
}

static bf_status count_progress(void *context, const api_event *event, bf_error *err)
{
    size_t *n = context;

    (void)err;
    *n += event->type == API_EVENT_PROGRESS;
    return BF_OK;
}

// After a million seconds the next pause is a thousand: only the first and the last progress
// are stored. (The worker reports every 50 ms of the second or so that this takes.)
static void a_long_run_tells_its_progress_seldom(void **state)
{
    helper_world *w = *state;
    store_job job = { .step = 0 };
    size_t n = 0;

    api_run record = helper_world_submit(w, medium_jam);
    assert_int_equal(store_claim(w->store, &job, NULL), BF_OK);
    store_job_fini(&job);
    store_batch batch = { .run_id = record.id, .wall_s = 1e6 };
    assert_int_equal(helper_store_append(w->store, &batch, NULL), BF_OK);
    store_ending ending = { .run_id = record.id, .state = RUN_QUEUED };
    assert_int_equal(store_finish(w->store, &ending, &record, NULL), BF_OK);
    helper_supervise(w);
    helper_await_state(w, record.id, RUN_SUCCEEDED);
    assert_int_equal(store_read_events(w->store, (const char(*)[API_ID_SIZE])record.id, 1, 0,
                                       SIZE_MAX, count_progress, &n, NULL),
                     BF_OK);
    assert_int_equal(n, 2);
}

// ------------------------------------------------------------------------ stopping

static void a_cancelled_run_keeps_what_it_has(void **state)
{
    helper_world *w = *state;

    helper_supervise(w);
    api_run record = helper_world_submit(w, long_jam);
    helper_await_samples(w, record.id, 2);
    helper_world_cancel(w, record.id);
    record = helper_await_state(w, record.id, RUN_CANCELLED);
    assert_true(record.n_samples >= 2);
    assert_true(record.has_summary);
    assert_true(record.progress > 0.0 && record.progress < 1.0);
}

static void a_run_that_is_not_running_cannot_be_cancelled(void **state)
{
    helper_world *w = *state;
    bf_error err = { 0 };

    helper_supervise(w);
    api_run record = helper_world_submit(w, short_belt);
    helper_await_state(w, record.id, RUN_SUCCEEDED);
    assert_int_equal(store_cancel(w->store, record.id, API_ANY_REVISION, &record, &err),
                     BF_ECONFLICT);
    assert_int_equal(err.code, BF_ECONFLICT);
}

static void a_killed_run_has_stopped_when_it_is_cancelled(void **state)
{
    helper_world *w = *state;
    api_run after;

    helper_supervise(w);
    api_run record = helper_world_submit(w, long_jam);
    helper_await_state(w, record.id, RUN_RUNNING);
    helper_world_kill(w, record.id);
    assert_int_equal(store_find(w->store, record.id, &after, NULL), BF_OK);
    assert_int_equal(after.state, RUN_CANCELLED);
    assert_true(helper_is_childless());
    assert_int_equal(store_remove(w->store, record.id, API_ANY_REVISION, NULL), BF_OK);
}

static void stopping_hands_back_and_a_resumed_run_gives_the_same_bytes(void **state)
{
    helper_world *w = *state;
    store_job job = { 0 };
    int n_stops = 0;

    api_run record = helper_world_submit(w, medium_jam);
    for (uint64_t n = 40; n <= 400; n += 180) {
        helper_supervise(w);
        helper_await_samples(w, record.id, n);
        helper_world_stop(w, 30000);
        assert_true(helper_is_childless());
        assert_int_equal(store_find(w->store, record.id, &record, NULL), BF_OK);
        n_stops += record.state == RUN_QUEUED;
        helper_world_reopen(w);
    }
    assert_true(n_stops > 0);
    assert_int_equal(record.state, RUN_QUEUED);
    // Its checkpoint, and its solving time so far.
    assert_int_equal(store_claim(w->store, &job, NULL), BF_OK);
    assert_true(job.checkpoint.n > 0 && job.step > 0 && job.wall_s > 0.0);
    store_job_fini(&job);
    helper_world_reopen(w);
    helper_supervise(w);
    record = helper_await_state(w, record.id, RUN_SUCCEEDED);
    assert_int_equal(record.n_samples, 1201);
    assert_same_results(w, record.id, medium_jam);
}

// A SIGTERM from another process, as a service manager sends it to all processes at once, loses no run. The
// fake does that to itself the first time and is the real program the second time.
static void a_run_stopped_by_others_goes_back_to_the_queue(void **state)
{
    helper_world *w = *state;
    char lines[1024];

    snprintf(lines, sizeof lines,
             "if mkdir '%s/first' 2>/dev/null; then kill -TERM $$; sleep 10; fi\nexec '%s' \"$@\"",
             w->directory, PROGRAM_DIR "/beltflow");
    helper_world_fake(w, lines);
    helper_supervise(w);
    api_run record = helper_world_submit(w, short_belt);
    helper_await_state(w, record.id, RUN_SUCCEEDED);
}

// ------------------------------------------------------------------------ failing workers

// The error of a run whose worker is this script.
static bf_error fail_with(helper_world *w, const char *lines)
{
    helper_world_fake(w, lines);
    if (w->supervisor == NULL)
        helper_supervise(w);
    api_run record = helper_world_submit(w, short_belt);
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
    strcpy(w->program, PROGRAM_DIR "/beltflow");
    api_run record = helper_world_submit(w, short_belt);
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
        assert_int_equal(frame_encode(&frames[i], &bytes, NULL), BF_OK);
    strcpy(ret_path, helper_world_file(w, "frames", bytes.bytes, bytes.n));
    size_t n_bytes = bytes.n;
    buffer_fini(&bytes);
    return n_bytes;
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
    api_run record = helper_world_submit(w, short_belt);
    helper_await_samples(w, record.id, 1);
    helper_world_cancel(w, record.id);
    helper_await_state(w, record.id, RUN_CANCELLED);
    // The same when stopping, with the grace that is given; the run is not lost.
    record = helper_world_submit(w, short_belt);
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
    snprintf(lines, sizeof lines, "head -c %zu '%s'; printf X; sleep 1000", n - 1, path);
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
        { .type = FRAME_ERROR,
          .error = { .error = { .code = BF_ENUMERIC, .text = "part 3 flew off" } } },
    };
    helper_world *w = *state;
    char path[HELPER_PATH_SIZE], lines[1024];

    encode_to_file(w, frames, 5, path);
    snprintf(lines, sizeof lines, "cat '%s'; exit 1", path);
    helper_world_fake(w, lines);
    helper_supervise(w);
    api_run record = helper_world_submit(w, short_belt);
    record = helper_await_state(w, record.id, RUN_FAILED);
    assert_says(&record.error, BF_ENUMERIC, "part 3 flew off");
    assert_int_equal(record.n_snapshots, 1);
}

static void what_came_before_the_solver_failed_is_kept(void **state)
{
    const double t[] = { 0.0, 0.01 }, values[] = { 1.0, 0.0, 0.5, 0.5 };
    const frame frames[] = {
        begin_frame,
        { .type = FRAME_CURVE, .curve = { .n = 2, .n_columns = 2, .t = t, .values = values } },
        { .type = FRAME_ERROR,
          .error = { .error = { .code = BF_ENUMERIC, .text = "cell 3 is not finite" } } },
    };
    helper_world *w = *state;
    char path[HELPER_PATH_SIZE], lines[1024];

    encode_to_file(w, frames, 3, path);
    snprintf(lines, sizeof lines, "cat '%s'; exit 1", path);
    helper_world_fake(w, lines);
    helper_supervise(w);
    api_run record = helper_world_submit(w, short_belt);
    record = helper_await_state(w, record.id, RUN_FAILED);
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

static void make_program(helper_world *w)
{
    helper_world_fake(w, "exec '" PROGRAM_DIR "/beltflow' \"$@\"");
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
        runs[i] = helper_world_submit(w, short_belt);
    assert_int_equal(supervisor_ready(w->supervisor, &err), BF_ESYSTEM);
    assert_says(&err, BF_ESYSTEM, "fake cannot be started: No such file");
    outlast_backoff();
    make_program(w);
    assert_int_equal(chmod(w->program, 0600), 0);
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
    api_run record = helper_world_submit(w, short_belt);
    outlast_backoff();
    assert_int_equal(supervisor_ready(w->supervisor, &err), BF_ESYSTEM);
    assert_says(&err, BF_ESYSTEM, "cannot be executed (exit code 127)");
    assert_int_equal(metrics_value(METRICS_LOG_LINES, LOG_LEVEL_ERROR), n_errors + 1);
    make_program(w);
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
    api_run record = helper_world_submit(w, long_jam);
    record = helper_await_state(w, record.id, RUN_FAILED);
    assert_says(&record.error, BF_ELIMIT, "limit of 1 CPU seconds");
}

// Its first act is to look for its parent: one that was lost in between is noticed, too.
static void a_worker_without_its_parent_ends_at_once(void **state)
{
    char byte;
    (void)state;

    if (getpid() == 1)
        skip();
    FILE *output = popen("exec '" PROGRAM_DIR "/beltflow' worker --parent 1 </dev/null", "re");
    assert_non_null(output);
    assert_int_equal(fread(&byte, 1, 1, output),
                     0); // not even an error frame: it would not be read
    assert_int_not_equal(pclose(output), 0);
}

// A limit on the size of files stands for a full disk: the run's first samples fit, the rest do not.
static void a_full_disk_ends_the_run_and_hangs_nothing(void **state)
{
    helper_world *w = *state;
    struct rlimit before, limit;

    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    limit = before;
    limit.rlim_cur = 600 * 1024;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    helper_supervise(w);
    api_run record = helper_world_submit(w, long_jam);
    helper_await_samples(w, record.id, 1);
    for (int i = 0; i < 6000 && !helper_is_childless(); i++)
        usleep(10000);
    assert_true(helper_is_childless());
    helper_world_stop(w, 1000);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    helper_world_reopen(w);
    assert_int_equal(store_find(w->store, record.id, &record, NULL), BF_OK);
    assert_true(record.state == RUN_FAILED || record.state == RUN_QUEUED);
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
    api_run record = helper_world_submit(w, long_jam);
    helper_await_samples(w, record.id, 1);
    limit = before;
    limit.rlim_cur = 1;
    int64_t n_errors = metrics_value(METRICS_LOG_LINES, LOG_LEVEL_ERROR);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    // The child is gone before the store has refused every way to end the run, which is logged.
    for (int i = 0; i < 6000 && metrics_value(METRICS_LOG_LINES, LOG_LEVEL_ERROR) == n_errors; i++)
        usleep(10000);
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
        TEST(a_queued_run_is_solved_and_stored),
        TEST(a_microscopic_run_is_stored_with_its_parts),
        TEST(what_is_queued_before_the_start_is_solved_too),
        TEST(a_long_run_tells_its_progress_seldom),
        TEST(a_cancelled_run_keeps_what_it_has),
        TEST(a_run_that_is_not_running_cannot_be_cancelled),
        TEST(a_killed_run_has_stopped_when_it_is_cancelled),
        TEST(stopping_hands_back_and_a_resumed_run_gives_the_same_bytes),
        TEST(a_worker_that_heeds_no_signal_is_killed),
        TEST(a_run_stopped_by_others_goes_back_to_the_queue),
        TEST(a_crash_costs_one_run_and_says_so),
        TEST(what_is_no_frame_fails_the_run),
        TEST(a_torn_or_damaged_frame_fails_the_run),
        TEST(frames_that_make_no_sense_fail_the_run),
        TEST(parts_that_do_not_follow_their_snapshot_fail_the_run),
        TEST(a_snapshot_without_its_parts_is_not_kept),
        TEST(what_came_before_the_solver_failed_is_kept),
        TEST(a_worker_that_only_talks_costs_nothing),
        TEST(runs_wait_for_a_program_that_cannot_be_started),
        TEST(runs_wait_for_a_program_that_lacks_something),
        TEST(a_run_beyond_its_memory_fails_alone),
        TEST(a_run_beyond_its_processor_time_fails_alone),
        TEST(a_worker_without_its_parent_ends_at_once),
        TEST(a_full_disk_ends_the_run_and_hangs_nothing),
        TEST(a_run_whose_end_could_not_be_stored_goes_on_later),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

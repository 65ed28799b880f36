// Tests of the supervisor with a real store and, where nothing else is said, the real program.

#include "api/scenario/scenario.h"
#include "core/observe/frame.h"
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

// ------------------------------------------------------------------------ what comes out

// The samples and snapshots of a scenario, solved here.
typedef struct solution {
    bf_buffer t;
    bf_buffer values;
    bf_buffer last_rho;
    bf_buffer last_parts;
    uint64_t n_snapshots;
} solution;

static bf_status on_frame(void *context, const frame *f, bf_error *err)
{
    solution *s = context;

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
    run_sink sink = { .context = &s, .on_frame = on_frame };
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
    api_array got;
    bf_buffer rho = { 0 };

    assert_int_equal(store_read_curve(w->store, id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    assert_int_equal(curve.t.n, s.t.n);
    assert_memory_equal(curve.t.bytes, s.t.bytes, s.t.n);
    assert_int_equal(curve.values.n, s.values.n);
    assert_memory_equal(curve.values.bytes, s.values.bytes, s.values.n);
    assert_int_equal(
        store_read_array(w->store, id, s.n_snapshots - 1, API_ARRAY_DENSITY, &got, &rho, NULL),
        BF_OK);
    assert_int_equal(rho.n, s.last_rho.n);
    assert_memory_equal(rho.bytes, s.last_rho.bytes, rho.n);
    rho.n = 0;
    if (w->model == RUN_MICRO) {
        assert_int_equal(
            store_read_array(w->store, id, s.n_snapshots - 1, API_ARRAY_PARTS, &got, &rho, NULL),
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
    api_run submitted = helper_world_submit(w, helper_short_belt);
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
    assert_same_results(w, ended.id, helper_short_belt);
}

static void a_microscopic_run_is_stored_with_its_parts(void **state)
{
    helper_world *w = *state;
    api_snapshot_list list = { 0 };

    w->model = RUN_MICRO;
    helper_supervise(w);
    api_run submitted = helper_world_submit(w, helper_short_belt);
    api_run ended = helper_await_state(w, submitted.id, RUN_SUCCEEDED);
    assert_int_equal(ended.n_snapshots, 11);
    assert_int_equal(store_list_snapshots(w->store, ended.id, &list, NULL), BF_OK);
    assert_int_equal(list.parts.n_parts, 1);
    assert_int_equal(list.parts.n_values, FRAME_VALUES_PLANAR);
    assert_same_results(w, ended.id, helper_short_belt);
    buffer_fini(&list.items);
}

static void what_is_queued_before_the_start_is_solved_too(void **state)
{
    helper_world *w = *state;
    api_run runs[5];

    w->options.n_workers = 2;
    for (size_t i = 0; i < 5; i++)
        runs[i] = helper_world_submit(w, helper_short_belt);
    helper_supervise(w);
    for (size_t i = 0; i < 5; i++)
        helper_await_state(w, runs[i].id, RUN_SUCCEEDED);
}

static bf_status count_progress(void *context, const api_event *event, bf_error *err)
{
    size_t *n = context;

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

    api_run record = helper_world_submit(w, helper_medium_jam);
    assert_int_equal(store_claim(w->store, true, &job, NULL), BF_OK);
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
    api_run record = helper_world_submit(w, helper_long_jam);
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
    api_run record = helper_world_submit(w, helper_short_belt);
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
    api_run record = helper_world_submit(w, helper_long_jam);
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

    api_run record = helper_world_submit(w, helper_medium_jam);
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
    assert_int_equal(store_claim(w->store, true, &job, NULL), BF_OK);
    assert_true(job.checkpoint.n > 0 && job.step > 0 && job.wall_s > 0.0);
    store_job_fini(&job);
    helper_world_reopen(w);
    helper_supervise(w);
    record = helper_await_state(w, record.id, RUN_SUCCEEDED);
    assert_int_equal(record.n_samples, 1201);
    assert_same_results(w, record.id, helper_medium_jam);
}

// A SIGTERM from another process, as a service manager sends it to all processes at once, loses no run. The
// fake does that to itself the first time and is the real program the second time.
static void a_run_stopped_by_others_goes_back_to_the_queue(void **state)
{
    helper_world *w = *state;
    char lines[1024];

    snprintf(lines, sizeof lines,
             "if mkdir '%s/first' 2>/dev/null; then kill -TERM $$; sleep 10; fi\nexec '%s' \"$@\"",
             w->directory, PROGRAM_DIR "/beltflow-worker");
    helper_world_fake(w, lines);
    helper_supervise(w);
    api_run record = helper_world_submit(w, helper_short_belt);
    helper_await_state(w, record.id, RUN_SUCCEEDED);
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
        TEST(a_run_stopped_by_others_goes_back_to_the_queue),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Studies at work, with a store and a solver that is this test: its figure is 100 - (duration - 3)^2.

#include "server/study/studies_priv.h"

#include "api/json/json_out.h"
#include "api/results/key_figures.h"
#include "api/scenario/scenario.h"
#include "api/study/study_document.h"
#include "api/study/study_trial.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_store.h"

#include <math.h>
#include <semaphore.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SCENARIO                                                                                   \
    "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, 'cargo': {}, 'initial': "       \
    "{'positions_m': [[0.5, 0.3]]}}"
#define STUDY(parameter, rest)                                                                     \
    "{'base': {'scenario': " SCENARIO "}, 'parameters': [{'pointer': '/duration_s', " parameter    \
    "}], 'objectives': [{'figure': 'throughput_per_h', 'goal': 'maximize'}], " rest "}"
#define GRID STUDY("'range': [1, 5], 'steps': 9", "'method': {'type': 'grid'}")

// A store with studies at work.
typedef struct world {
    helper_store *h;
    studies *studies;
} world;

static void note_queued(void *context)
{
}

static void (*when_queued)(void *context) = note_queued; // on the thread of the studies

static void start(world *w)
{
    const studies_options options = {
        .store = w->h->store, .n_workers = 1, .queued = when_queued, .context = w
    };

    assert_int_equal(studies_start(&options, &w->studies, NULL), BF_OK);
}

static int set_up(void **state)
{
    world *w = calloc(1, sizeof *w);

    assert_non_null(w);
    assert_int_equal(helper_store_setup((void **)&w->h), 0);
    start(w);
    *state = w;
    return 0;
}

static int tear_down(void **state)
{
    world *w = *state;

    studies_stop(w->studies);
    assert_int_equal(helper_store_teardown((void **)&w->h), 0);
    free(w);
    return 0;
}

// The text with every ' replaced by ".
static bf_buffer quote(const char *text)
{
    bf_buffer out = { 0 };

    assert_int_equal(buffer_append(&out, text, strlen(text)), BF_OK);
    for (char *at = out.bytes; (at = strchr(at, '\'')) != NULL;)
        *at = '"';
    return out;
}

static api_study submit_of(world *w, const char *owner, const char *text)
{
    api_study_submission submission = { .trials_max = 9 };
    bf_buffer document = quote(text);
    bf_faults *faults = memory_alloc(1, sizeof *faults);
    study_columns *columns = memory_alloc(1, sizeof *columns);
    api_acceptance accepted = { 0 };
    study_document d;
    api_study found;

    if (study_document_read(document.bytes, document.n, &d, faults, NULL) != BF_OK)
        fail_msg("%s: %s", faults->items[0].pointer, faults->items[0].text);
    study_columns_of(&d, columns);
    assert_int_equal(study_columns_write(columns, &submission.columns, NULL), BF_OK);
    submission.document = document;
    submission.method = d.method.type;
    snprintf(submission.sender.owner, sizeof submission.sender.owner, "%s", owner);
    assert_int_equal(store_submit_study(w->h->store, &submission, &accepted, NULL), BF_OK);
    studies_wake(w->studies);
    assert_int_equal(store_find_study(w->h->store, accepted.id, &found, NULL), BF_OK);
    study_document_fini(&d);
    buffer_fini(&accepted.answer);
    buffer_fini(&submission.columns);
    buffer_fini(&document);
    memory_free(columns);
    memory_free(faults);
    return found;
}

static api_study submit(world *w, const char *text)
{
    return submit_of(w, "", text);
}

static void store_figures(world *w, const store_job *job)
{
    store_item item = { .type = API_EVENT_FIGURES };
    json_out out = json_out_to(&item.figures);
    scene s;

    assert_int_equal(scenario_read_resolved(job->scenario.bytes, job->scenario.n, &s, NULL), BF_OK);
    double *values = calloc(figure_values(&s), sizeof *values);
    for (size_t k = 0; k < figure_values(&s); k++)
        values[k] = (double)NAN;
    values[FIGURE_THROUGHPUT] = 100.0 - (s.duration - 3.0) * (s.duration - 3.0);
    const key_figures figures = { .columns = job->columns.bytes,
                                  .n = figure_values(&s),
                                  .values = values };
    key_figures_write(&out, &figures);
    snprintf(item.run_figures, sizeof item.run_figures, "{\"throughput_per_h\":%.17g}",
             values[FIGURE_THROUGHPUT]);
    assert_int_equal(buffer_printf(&item.event, "{}"), BF_OK);
    assert_int_equal(helper_append(w->h->store, job->run.id, &item, NULL), BF_OK);
    scene_fini(&s);
    free(values);
}

// Solve the next trial, if one waits.
static bool solve_one(world *w, run_state to)
{
    store_job job = { 0 };
    api_run after;

    if (store_claim(w->h->store, true, &job, NULL) != BF_OK)
        return false;
    if (to == RUN_SUCCEEDED)
        store_figures(w, &job);
    const store_ending ending = { .run_id = job.run.id,
                                  .state = to,
                                  .error = { .code = BF_EINPUT, .text = "it broke" } };
    assert_int_equal(store_finish(w->h->store, &ending, &after, NULL), BF_OK);
    studies_notify(w->studies, job.run.id);
    store_job_fini(&job);
    return true;
}

static api_study find(world *w, const char *id)
{
    api_study found;

    assert_int_equal(store_find_study(w->h->store, id, &found, NULL), BF_OK);
    return found;
}

// Solve n trials, or as long as the study goes on.
static api_study solve(world *w, const char *id, size_t n, run_state to)
{
    const int64_t deadline_ms = clock_monotonic_ms() + HELPER_PATIENCE_MS;
    api_study now = find(w, id);

    for (size_t n_solved = 0; n_solved < n && !api_study_state_is_end(now.state);) {
        n_solved += solve_one(w, to);
        now = find(w, id);
        if (clock_monotonic_ms() > deadline_ms)
            fail_msg("after %zu trials the study is %s", n_solved, api_study_state_word(now.state));
        usleep(1000);
    }
    return now;
}

static void await(world *w, const char *sql, int64_t wanted)
{
    helper_await_sql(w->h, sql, wanted);
}

typedef struct reading {
    size_t n;
    api_trial trials[64];
} reading;

static bf_status take(void *context, const api_trial *trial, bf_error *err)
{
    reading *r = context;

    r->trials[r->n++] = *trial;
    return BF_OK;
}

static reading *read_trials(world *w, const char *id)
{
    const api_trial_query query = { .limit = 64 };
    reading *r = calloc(1, sizeof *r);

    assert_int_equal(store_read_trials(w->h->store, id, &query, take, r, NULL), BF_OK);
    return r;
}

static void expect_best(world *w, const char *id, const char *part)
{
    bf_buffer best = { 0 };

    assert_int_equal(store_read_study(w->h->store, id, API_STUDY_BEST, &best, NULL), BF_OK);
    if (strstr(best.bytes, part) == NULL)
        fail_msg("%s is not in %s", part, best.bytes);
    buffer_fini(&best);
}

static void a_grid_is_solved_and_its_best_point_told(void **state)
{
    world *w = *state;
    const api_study of = submit(w, GRID);
    const api_study after = solve(w, of.id, SIZE_MAX, RUN_SUCCEEDED);

    assert_int_equal(after.state, API_STUDY_SUCCEEDED);
    assert_int_equal(after.n_trials, 9);
    assert_int_equal(after.n_ended[API_TRIAL_SUCCEEDED], 9);
    reading *r = read_trials(w, of.id);
    for (size_t k = 0; k < 9; k++) {
        const double duration = 1.0 + 0.5 * (double)k;
        assert_true(r->trials[k].parameters[0] == duration);
        assert_true(r->trials[k].values[0] == 100.0 - (duration - 3.0) * (duration - 3.0));
    }
    free(r);
    expect_best(w, of.id, "\"/duration_s\":3}");
    expect_best(w, of.id, "\"is_ended\":true");
}

static void only_some_trials_wait_at_a_time(void **state)
{
    world *w = *state;

    submit(w, STUDY("'range': [1, 5], 'steps': 100", "'method': {'type': 'grid'}"));
    await(w, "SELECT count(*) FROM runs WHERE state = 0", 4);
    const api_study one = submit(w, STUDY("'range': [1, 5], 'steps': 100",
                                          "'method': {'type': 'grid'}, 'limits': {'workers': 1}"));
    char sql[160];
    snprintf(sql, sizeof sql, "SELECT count(*) FROM runs WHERE parent = '%s'", one.id);
    await(w, sql, 1);
    const api_study most =
        submit(w, STUDY("'range': [1, 5], 'steps': 300",
                        "'method': {'type': 'grid'}, 'limits': {'workers': 256}"));
    snprintf(sql, sizeof sql, "SELECT count(*) FROM runs WHERE parent = '%s'", most.id);
    await(w, sql, 256);
    // However many solvers there are: more than half of what may wait, and no more than all of it.
    studies_reconfigure(w->studies, 1000, 0);
    const api_study large =
        submit(w, STUDY("'range': [1, 5], 'steps': 300", "'method': {'type': 'grid'}"));
    snprintf(sql, sizeof sql, "SELECT count(*) > 128 FROM runs WHERE parent = '%s'", large.id);
    await(w, sql, 1);
    // When others that came later have begun, all have had their turn again.
    for (size_t k = 0; k < 4; k++) {
        const api_study later =
            submit(w, STUDY("'range': [1, 5], 'steps': 9",
                            "'method': {'type': 'grid'}, 'limits': {'workers': 1}"));
        snprintf(sql, sizeof sql, "SELECT count(*) FROM runs WHERE parent = '%s'", later.id);
        await(w, sql, 1);
    }
    assert_in_range(find(w, large.id).n_trials, 129, 256);
}

// 5,000 points that end at once: no run may have such a duration.
#define INFEASIBLE                                                                                 \
    STUDY("'range': [-5000, -1], 'steps': 5000", "'method': {'type': 'grid'}, 'limits': "          \
                                                 "{'trials': 5000}")

static sem_t was_queued;
static atomic_uint n_queued;
static atomic_bool was_alive;

// The daemon is to stop while the first trials of many that end at once are told.
static void wait_for_stop(void *context)
{
    studies *s = ((world *)context)->studies;
    bool is_stopping = false;

    if (atomic_fetch_add(&n_queued, 1) != 1) // the first time the study began
        return;
    assert_int_equal(sem_post(&was_queued), 0);
    while (!is_stopping) {
        lock_acquire(&s->lock);
        is_stopping = s->is_stopping;
        lock_release(&s->lock);
        usleep(1000);
    }
}

static void restart(world *w, void (*queued)(void *context))
{
    studies_stop(w->studies);
    when_queued = queued;
    atomic_store(&n_queued, 0);
    assert_int_equal(sem_init(&was_queued, 0, 0), 0);
    start(w);
    when_queued = note_queued;
}

static void points_without_end_do_not_hold_up_the_stop(void **state)
{
    world *w = *state;

    restart(w, wait_for_stop);
    const api_study of = submit(w, INFEASIBLE);
    assert_int_equal(sem_wait(&was_queued), 0);
    studies_stop(w->studies);
    const uint64_t n_trials = find(w, of.id).n_trials;
    start(w); // and goes on where it was
    assert_int_equal(atomic_load(&n_queued), 2);
    assert_in_range(n_trials, 1, 64);
    while (find(w, of.id).n_trials < 128)
        usleep(1000);
    reading *r = read_trials(w, of.id);
    for (size_t k = 0; k < r->n; k++)
        assert_int_equal(r->trials[k].state, API_TRIAL_INFEASIBLE);
    free(r);
}

// What is asked in one turn is answered until the next one.
static void ask_for_life(void *context)
{
    world *w = context;
    const bool is_alive = studies_is_alive(w->studies);

    if (atomic_fetch_add(&n_queued, 1) == 0)
        return;
    atomic_store(&was_alive, is_alive && atomic_load(&was_alive));
    (void)sem_post(&was_queued);
}

static void points_without_end_leave_signs_of_life(void **state)
{
    world *w = *state;

    atomic_store(&was_alive, true);
    restart(w, ask_for_life);
    submit(w, INFEASIBLE);
    for (int k = 0; k < 5; k++)
        assert_int_equal(sem_wait(&was_queued), 0);
    assert_true(atomic_load(&was_alive));
}

// One owner has all places, with studies that nobody solves: another has one of them all the same, and no more.
static void an_owner_without_a_place_is_given_one(void **state)
{
    world *w = *state;
    char sql[160];

    for (size_t k = 0; k < 8; k++)
        submit_of(w, "alice", GRID);
    await(w, "SELECT count(*) FROM runs", 32);
    const api_study first = submit_of(w, "bob", GRID);
    snprintf(sql, sizeof sql, "SELECT count(*) FROM runs WHERE parent = '%s'", first.id);
    await(w, sql, 4);
    submit_of(w, "bob", GRID); // waits, as its owner has a place
    const api_study third = submit_of(w, "carol", GRID);
    snprintf(sql, sizeof sql, "SELECT count(*) FROM runs WHERE parent = '%s'", third.id);
    await(w, sql, 4);
    assert_int_equal(helper_store_sql(w->h, "SELECT count(*) FROM runs"), 40);
    assert_int_equal(helper_store_sql(w->h, "SELECT count(*) FROM studies WHERE state = 0"), 1);
}

// Eight are removed and a ninth is cancelled: that is done before the first run is removed. The trigger counts the runs
// at that moment.
static void removals_do_not_hold_up_a_cancel(void **state)
{
    world *w = *state;
    api_study all[9], after;
    char sql[400];

    for (size_t k = 0; k < 9; k++)
        all[k] = submit(w, GRID);
    await(w, "SELECT count(*) FROM runs WHERE state = 0", 32); // 4 of each that is at work
    studies_stop(w->studies);
    for (size_t k = 0; k < 8; k++)
        assert_int_equal(store_remove_study(w->h->store, all[k].id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(store_change_study(w->h->store, all[8].id, API_ANY_REVISION, API_STUDY_CANCEL,
                                        &after, NULL),
                     BF_OK);
    helper_store_close(w->h);
    helper_store_sql(w->h, "CREATE TABLE noted (n INTEGER)");
    snprintf(sql, sizeof sql,
             "CREATE TRIGGER note AFTER UPDATE OF state ON studies WHEN new.id = '%s' AND "
             "new.finished_ms > 0 BEGIN INSERT INTO noted SELECT count(*) FROM runs; END",
             all[8].id);
    helper_store_sql(w->h, sql);
    helper_store_open(w->h);
    start(w);
    await(w, "SELECT count(*) FROM runs", 0);
    assert_int_equal(helper_store_sql(w->h, "SELECT n FROM noted"), 32);
}

// The interruption comes while a round of the search is under way.
static void a_study_that_is_interrupted_makes_the_same_trials(void **state)
{
#define SEARCH STUDY("'range': [1, 5]", "'method': {'type': 'cmaes'}, 'limits': {'trials': 20}")
    world *w = *state;
    const api_study whole = submit(w, SEARCH);
    assert_int_equal(solve(w, whole.id, SIZE_MAX, RUN_SUCCEEDED).state, API_STUDY_SUCCEEDED);
    // What the first one has solved is not to be known.
    studies_stop(w->studies);
    helper_store_close(w->h);
    helper_store_sql(w->h, "UPDATE results SET digest = x''");
    helper_store_open(w->h);
    start(w);
    const api_study cut = submit(w, SEARCH);
    solve(w, cut.id, 7, RUN_SUCCEEDED);
    studies_stop(w->studies);
    helper_store_close(w->h);
    helper_store_open(w->h);
    start(w);
    assert_int_equal(solve(w, cut.id, SIZE_MAX, RUN_SUCCEEDED).state, API_STUDY_SUCCEEDED);
    reading *a = read_trials(w, whole.id), *b = read_trials(w, cut.id);
    assert_int_equal(a->n, 20);
    assert_int_equal(b->n, 20);
    for (size_t k = 0; k < 20; k++) {
        assert_true(a->trials[k].parameters[0] == b->trials[k].parameters[0]);
        assert_true(a->trials[k].values[0] == b->trials[k].values[0]);
    }
    free(a);
    free(b);
}

static void what_ended_while_nobody_looked_is_taken_at_the_next_start(void **state)
{
    world *w = *state;
    const api_study of = submit(w, GRID);

    await(w, "SELECT count(*) FROM runs WHERE state = 0", 4);
    studies_stop(w->studies);
    w->studies = NULL;
    store_job job = { 0 };
    assert_int_equal(store_claim(w->h->store, true, &job, NULL), BF_OK);
    store_figures(w, &job);
    api_run after;
    const store_ending ending = { .run_id = job.run.id, .state = RUN_SUCCEEDED };
    assert_int_equal(store_finish(w->h->store, &ending, &after, NULL), BF_OK);
    store_job_fini(&job);
    start(w);
    await(w, "SELECT n_succeeded FROM studies", 1);
    assert_int_equal(solve(w, of.id, SIZE_MAX, RUN_SUCCEEDED).n_ended[API_TRIAL_SUCCEEDED], 9);
}

static void a_trial_whose_run_fails_has_no_value(void **state)
{
    world *w = *state;
    const api_study of = submit(w, STUDY("'values': [3, 4]", "'method': {'type': 'list'}"));

    solve(w, of.id, 1, RUN_FAILED);
    const api_study after = solve(w, of.id, SIZE_MAX, RUN_SUCCEEDED);
    assert_int_equal(after.state, API_STUDY_SUCCEEDED);
    reading *r = read_trials(w, of.id);
    assert_int_equal(r->trials[0].state, API_TRIAL_FAILED);
    assert_true(isnan(r->trials[0].values[0]));
    assert_string_equal(r->trials[0].fault.text, "it broke");
    free(r);
    expect_best(w, of.id, "\"/duration_s\":4}");
}

static void a_study_without_any_value_has_failed(void **state)
{
    world *w = *state;
    const api_study of = submit(w, STUDY("'values': [3, 4]", "'method': {'type': 'list'}"));
    const api_study after = solve(w, of.id, SIZE_MAX, RUN_FAILED);

    assert_int_equal(after.state, API_STUDY_FAILED);
    assert_int_equal(after.error.code, BF_EINPUT);
    assert_string_equal(after.error.pointer, "/objectives/0/figure");
    assert_non_null(strstr(after.error.text, "no trial has a value of "));
}

static void a_scenario_that_is_not_valid_is_infeasible_and_has_no_run(void **state)
{
    world *w = *state;
    const api_study of = submit(w, STUDY("'values': [-1, 3]", "'method': {'type': 'list'}"));

    assert_int_equal(solve(w, of.id, SIZE_MAX, RUN_SUCCEEDED).state, API_STUDY_SUCCEEDED);
    reading *r = read_trials(w, of.id);
    assert_int_equal(r->trials[0].state, API_TRIAL_INFEASIBLE);
    assert_string_equal(r->trials[0].fault.pointer, "/duration_s");
    assert_string_equal(r->trials[0].run, "");
    free(r);
}

static void making_and_removing_trials_is_charged_to_their_owner(void **state)
{
    world *w = *state;
    const api_study of = submit_of(w, "ada", GRID);

    await(w, "SELECT count(*) FROM runs WHERE state = 0", 4);
    await(w, "SELECT count(*) FROM cpu_sums WHERE owner = 'ada' AND cpu_s > 0", 1);
    const int64_t made_ns = helper_store_sql(w->h, "SELECT sum(1e9 * cpu_s) FROM cpu_sums");
    assert_int_equal(store_remove_study(w->h->store, of.id, API_ANY_REVISION, NULL), BF_OK);
    studies_wake(w->studies);
    await(w, "SELECT count(*) FROM studies", 0);
    assert_true(helper_store_sql(
                    w->h, "SELECT sum(1e9 * cpu_s) FROM cpu_sums WHERE owner = 'ada'") > made_ns);
}

static void an_owner_without_cpu_time_begins_no_trials(void **state)
{
    world *w = *state;
    const store_quotas quotas = { .cpu_s = 10 };
    char sql[160];

    studies_stop(w->studies);
    snprintf(sql, sizeof sql, "INSERT INTO cpu_sums (owner, hour, cpu_s) VALUES ('ada', %lld, 11)",
             (long long)(clock_unix_ms() / 3600000));
    helper_store_close(w->h);
    helper_store_sql(w->h, sql);
    helper_store_open(w->h);
    store_set_quotas(w->h->store, &quotas);
    start(w);
    submit_of(w, "ada", GRID);
    const api_study of = submit_of(w, "eve", GRID);
    assert_int_equal(solve(w, of.id, SIZE_MAX, RUN_SUCCEEDED).state, API_STUDY_SUCCEEDED);
    assert_int_equal(helper_store_sql(w->h, "SELECT n_trials FROM studies WHERE owner = 'ada'"), 0);
}

static void cancelling_a_study_cancels_its_trials(void **state)
{
    world *w = *state;
    const api_study of = submit(w, GRID);
    api_study after;

    solve(w, of.id, 2, RUN_SUCCEEDED);
    await(w, "SELECT n_succeeded FROM studies", 2);
    assert_int_equal(
        store_change_study(w->h->store, of.id, API_ANY_REVISION, API_STUDY_CANCEL, &after, NULL),
        BF_OK);
    studies_wake(w->studies);
    await(w, "SELECT state FROM studies", API_STUDY_CANCELLED);
    assert_int_equal(helper_store_sql(w->h, "SELECT count(*) FROM runs WHERE state < 2"), 0);
    assert_int_equal(helper_store_sql(w->h, "SELECT count(*) FROM trials WHERE ended = 0"), 0);
    assert_true(find(w, of.id).n_ended[API_TRIAL_CANCELLED] > 0);
}

static void a_paused_study_goes_on_where_it_was(void **state)
{
    world *w = *state;
    const api_study of = submit(w, GRID);
    api_study after;

    solve(w, of.id, 2, RUN_SUCCEEDED);
    assert_int_equal(
        store_change_study(w->h->store, of.id, API_ANY_REVISION, API_STUDY_PAUSE, &after, NULL),
        BF_OK);
    studies_wake(w->studies);
    assert_false(solve_one(w, RUN_SUCCEEDED));
    assert_int_equal(
        store_change_study(w->h->store, of.id, API_ANY_REVISION, API_STUDY_RESUME, &after, NULL),
        BF_OK);
    studies_wake(w->studies);
    assert_int_equal(solve(w, of.id, SIZE_MAX, RUN_SUCCEEDED).n_ended[API_TRIAL_SUCCEEDED], 9);
}

// One of its trials is being solved: it goes when that has ended.
static void a_removed_study_leaves_nothing_behind(void **state)
{
    world *w = *state;
    const api_study of = submit(w, GRID);

    await(w, "SELECT count(*) FROM runs WHERE state = 0", 4);
    const api_run running = helper_claim(w->h->store);
    assert_int_equal(store_remove_study(w->h->store, of.id, API_ANY_REVISION, NULL), BF_OK);
    studies_wake(w->studies);
    await(w, "SELECT stop_request FROM runs WHERE state = 1", STORE_STOP_KILL);
    helper_finish(w->h->store, running.id, RUN_CANCELLED);
    await(w,
          "SELECT (SELECT count(*) FROM runs) + (SELECT count(*) FROM studies) + (SELECT "
          "count(*) FROM trials) + (SELECT count(*) FROM study_texts)",
          0);
}

static void a_run_that_is_removed_cancels_its_trial(void **state)
{
    world *w = *state;
    const api_study of = submit(w, GRID);

    await(w, "SELECT count(*) FROM runs WHERE state = 0", 4);
    reading *r = read_trials(w, of.id);
    assert_int_equal(store_remove(w->h->store, r->trials[1].run, API_ANY_REVISION, NULL), BF_OK);
    studies_notify(w->studies, r->trials[1].run);
    free(r);
    const api_study after = solve(w, of.id, SIZE_MAX, RUN_SUCCEEDED);
    assert_int_equal(after.n_ended[API_TRIAL_SUCCEEDED], 8);
    assert_int_equal(after.n_ended[API_TRIAL_CANCELLED], 1);
}

static void studies_that_ended_long_ago_are_removed(void **state)
{
    world *w = *state;
    const api_study of = submit(w, STUDY("'values': [3]", "'method': {'type': 'list'}"));

    solve(w, of.id, SIZE_MAX, RUN_SUCCEEDED);
    usleep(2000);
    studies_reconfigure(w->studies, 1, 1);
    await(w, "SELECT (SELECT count(*) FROM studies) + (SELECT count(*) FROM runs)", 0);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        CASE(a_grid_is_solved_and_its_best_point_told),
        CASE(only_some_trials_wait_at_a_time),
        CASE(points_without_end_do_not_hold_up_the_stop),
        CASE(points_without_end_leave_signs_of_life),
        CASE(an_owner_without_a_place_is_given_one),
        CASE(removals_do_not_hold_up_a_cancel),
        CASE(a_study_that_is_interrupted_makes_the_same_trials),
        CASE(what_ended_while_nobody_looked_is_taken_at_the_next_start),
        CASE(a_trial_whose_run_fails_has_no_value),
        CASE(a_study_without_any_value_has_failed),
        CASE(a_scenario_that_is_not_valid_is_infeasible_and_has_no_run),
        CASE(making_and_removing_trials_is_charged_to_their_owner),
        CASE(an_owner_without_cpu_time_begins_no_trials),
        CASE(cancelling_a_study_cancels_its_trials),
        CASE(a_paused_study_goes_on_where_it_was),
        CASE(a_removed_study_leaves_nothing_behind),
        CASE(a_run_that_is_removed_cancels_its_trial),
        CASE(studies_that_ended_long_ago_are_removed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

#include "tests/unit/server/helper_supervisor.h"
#include "tests/unit/server/helper_await.h"

#include "tests/unit/helper_amount.h"
#include "tests/unit/server/helper_store.h"

#include "api/scenario/scenario.h"
#include "server/base/clock.h"
#include "server/base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

const char helper_short_belt[] = "{\"duration_s\":1,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"
                                 "\"cargo\":{},\"initial\":{\"positions_m\":[[0.5,0.3]]},"
                                 "\"macro\":{\"closure\":\"dispersive\",\"cell_m\":0.02,"
                                 "\"step_s\":\"auto\"}}";

#define JAM(duration, cell, snapshots)                                                             \
    "{\"duration_s\":" duration ",\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"                     \
    "\"obstacles\":[{\"from_m\":[0.75,0],\"to_m\":[0.75,0.6]}],\"cargo\":{},"                      \
    "\"initial\":{\"hexagonal\":{\"rows\":16,\"columns\":12,\"first_m\":[0.1,0.11],"               \
    "\"spacing_m\":0.02448}},\"output\":{\"curve_every_s\":0.05,\"snapshot_every_s\":" snapshots   \
    "},\"macro\":{\"closure\":\"dispersive\",\"cell_m\":" cell ",\"step_s\":\"auto\"}}"

const char helper_long_jam[] = JAM("5000", "0.005", "100");
#if HELPER_AMOUNT_IS_LESS
const char helper_medium_jam[] = JAM("60", "0.02", "1");
#else
const char helper_medium_jam[] = JAM("60", "0.01", "1");
#endif

static void note_commit(void *context, const char *run_id)
{
    helper_world *w = context;

    // On the store's thread, so this is as if the disk took so long.
    usleep(atomic_load(&w->commit_us));
    lock_acquire(&w->lock);
    if (w->supervisor != NULL)
        supervisor_notify(w->supervisor);
    w->n_commits++;
    lock_wake_all(&w->committed);
    lock_release(&w->lock);
}

static void open_store(helper_world *w)
{
    char directory[HELPER_PATH_SIZE + 8];
    store_options options = {
        .directory = directory,
        .queue_limit = 100,
        .listener = note_commit,
        .listener_context = w,
        .still_runs = w->options.executor == NULL ? NULL : supervisor_still_runs,
        .still_runs_context = w->options.executor,
        .attempts_max = w->attempts_max,
    };
    bf_error err = { 0 };

    snprintf(directory, sizeof directory, "%s/store", w->directory);
    if (store_open(&options, &w->store, &err) != BF_OK)
        fail_msg("%s", err.text);
}

static void set_supervisor(helper_world *w, supervisor *s)
{
    lock_acquire(&w->lock);
    w->supervisor = s;
    lock_release(&w->lock);
}

int helper_world_setup(void **state)
{
    helper_world *w = calloc(1, sizeof *w);

    assert_non_null(w);
    strcpy(w->directory, "/tmp/beltflow-world-XXXXXX");
    assert_non_null(mkdtemp(w->directory));
    strcpy(w->program, PROGRAM_DIR "/beltflow-worker");
    w->options =
        (supervisor_options){ .n_workers = 1, .n_threads = 1, .cpu_s = 600, .checkpoint_ms = 20 };
    lock_init(&w->lock);
    lock_condition_init(&w->committed);
    log_set_level(LOG_LEVEL_ERROR);
    open_store(w);
    *state = w;
    return 0;
}

int helper_world_teardown(void **state)
{
    helper_world *w = *state;
    char command[HELPER_PATH_SIZE + 16];

    helper_world_stop(w, 0);
    store_close(w->store);
    lock_condition_fini(&w->committed);
    lock_fini(&w->lock);
    snprintf(command, sizeof command, "rm -rf '%s'", w->directory);
    int code = system(command);
    free(w);
    return code;
}

void helper_world_reopen(helper_world *w)
{
    w->store = store_close(w->store);
    open_store(w);
}

const char *helper_world_file(const helper_world *w, const char *name, const void *bytes, size_t n)
{
    static char path[HELPER_PATH_SIZE];

    assert_true(snprintf(path, sizeof path, "%s/%s", w->directory, name) < (int)sizeof path);
    // Kept from children that are being started: a script open for writing cannot be executed.
    int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0700);
    assert_true(fd >= 0);
    assert_int_equal(write(fd, bytes, n), n);
    assert_int_equal(close(fd), 0);
    return path;
}

void helper_world_fake(helper_world *w, const char *lines)
{
    char text[4096];

    int n = snprintf(text, sizeof text, "#!/bin/sh\n%s\n", lines);
    assert_true(n > 0 && n < (int)sizeof text);
    snprintf(w->program, sizeof w->program, "%s", helper_world_file(w, "fake", text, (size_t)n));
}

void helper_supervise(helper_world *w)
{
    supervisor *s = NULL;
    bf_error err = { 0 };

    w->options.store = w->store;
    if (w->options.executor == NULL) {
        if (local_executor_create(w->program, &w->local, &err) != BF_OK)
            fail_msg("%s", err.text);
        w->options.executor = w->local;
    }
    if (supervisor_start(&w->options, &s, &err) != BF_OK)
        fail_msg("%s", err.text);
    set_supervisor(w, s);
}

void helper_world_stop(helper_world *w, int64_t grace_ms)
{
    supervisor *s = w->supervisor;

    set_supervisor(w, NULL);
    supervisor_stop(s, grace_ms);
    if (w->local == NULL)
        return;
    w->local = local_executor_destroy(w->local);
    w->options.executor = NULL;
}

api_run helper_world_submit(helper_world *w, const char *json)
{
    api_submission submission = { .model = w->model };
    bf_faults faults = { 0 };
    bf_error err = { 0 };
    scene s;

    if (scenario_read(json, strlen(json), &s, &faults, &err) != BF_OK)
        fail_msg("%s: %s", faults.items[0].pointer, faults.items[0].text);
    assert_int_equal(scenario_write(&s, &submission.scenario, NULL), BF_OK);
    assert_int_equal(scenario_columns(&s, &submission.columns, NULL), BF_OK);
    scene_fini(&s);
    api_run record = helper_accept(w->store, &submission);
    buffer_fini(&submission.scenario);
    buffer_fini(&submission.columns);
    if (w->supervisor != NULL)
        supervisor_wake(w->supervisor);
    return record;
}

static api_run await(helper_world *w, const char *id, run_state state, uint64_t n_samples)
{
    int64_t deadline_ms = clock_monotonic_ms() + HELPER_PATIENCE_MS;
    api_run record = { 0 };

    for (;;) {
        lock_acquire(&w->lock);
        uint64_t n_before = w->n_commits;
        lock_release(&w->lock);
        assert_int_equal(store_find(w->store, id, &record, NULL), BF_OK);
        if (state == RUN_STATE_COUNT ? record.n_samples >= n_samples : record.state == state)
            return record;
        if (run_state_is_end(record.state))
            fail_msg("the run is %s: %s", run_state_word(record.state), record.error.text);
        lock_acquire(&w->lock);
        while (w->n_commits == n_before && lock_wait(&w->committed, &w->lock, deadline_ms))
            ;
        bool is_late = w->n_commits == n_before;
        lock_release(&w->lock);
        if (is_late)
            fail_msg("the run is still %s", run_state_word(record.state));
    }
}

void helper_world_slow_commits(helper_world *w, unsigned ms)
{
    atomic_store(&w->commit_us, ms * 1000);
}

void helper_world_cancel(helper_world *w, const char *id)
{
    api_run record;

    assert_int_equal(store_cancel(w->store, id, API_ANY_REVISION, &record, NULL), BF_OK);
}

void helper_world_kill(helper_world *w, const char *id)
{
    assert_int_equal(store_remove(w->store, id, API_ANY_REVISION, NULL), BF_ECONFLICT);
    helper_await_state(w, id, RUN_CANCELLED);
}

api_run helper_await_state(helper_world *w, const char *id, run_state state)
{
    return await(w, id, state, 0);
}

api_run helper_await_samples(helper_world *w, const char *id, uint64_t n)
{
    return await(w, id, RUN_STATE_COUNT, n);
}

bool helper_is_childless(void)
{
    siginfo_t info;

    return waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) == -1 && errno == ECHILD;
}

// A store whose process is killed, or whose machine loses power, at any moment. I1 ... I15 are the invariants of
// server/store/store.h.
//
// A child submits, claims, appends and finishes in a loop and writes to a pipe what the store has
// acknowledged. It ends at a random moment; then everything that was acknowledged must be there.

#include "tests/unit/helper_amount.h"
#include "tests/unit/server/helper_store.h"
#include "tests/unit/server/helper_store_power.h"

#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    N_LIVES = HELPER_AMOUNT(25, 6),       // of the child
    N_POWER_CUTS = HELPER_AMOUNT(60, 12), // of the machine
    POWER_CHANGES_MAX = 40,               // of files, until one
    LIFE_MS_MAX = 60,                     // after its first acknowledgement
    N_RUNS_MAX = 20000,                   // that are tracked
    N_STEPS = 4,                          // batches of a run
    STEP_SAMPLES = 3,                     // samples of a batch
    SNAPSHOT_STEP = 1,                    // the batch with the snapshot
    HALF_BYTES = 2 * STORE_SLICE_BYTES,   // of it, in a batch before
    FIRST_PROMISE_MS = 10000              // until which a child must have come up
};

/// What the store has acknowledged of one run.
typedef struct promise {
    char id[API_ID_SIZE];
    run_state state;      ///< last acknowledged
    uint64_t n_samples;   ///< acknowledged
    uint64_t n_snapshots; ///< acknowledged
    uint64_t last_event;  ///< acknowledged
} promise;

// An acknowledgement is shorter than PIPE_BUF, so it is written whole or not at all.
static void tell(int out, const promise *p)
{
    if (write(out, p, sizeof *p) != (ssize_t)sizeof *p)
        _exit(1);
}

static void tell_run(int out, const api_run *record)
{
    promise p = {
        .state = record->state,
        .n_samples = record->n_samples,
        .n_snapshots = record->n_snapshots,
        .last_event = record->last_event,
    };

    memcpy(p.id, record->id, API_ID_SIZE);
    tell(out, &p);
}

// The first half of a snapshot, in a batch of its own.
static void append_half(store *s, const char *id)
{
    store_item item;

    helper_snapshot_item(id, 0, &item);
    item.is_open = true;
    buffer_truncate(&item.rho, HALF_BYTES);
    if (helper_append(s, id, &item, NULL) != BF_OK)
        _exit(1);
}

// A batch with samples, once the second half of a snapshot, and a checkpoint whose step is the number of samples so
// far.
static void append_step(store *s, const char *id, uint64_t first, bool with_snapshot)
{
    store_item items[2];
    bf_grid grid = helper_grid();
    uint64_t checkpoint = first + STEP_SAMPLES;
    store_batch batch = {
        .run_id = id,
        .n = with_snapshot ? 2 : 1,
        .items = items,
        .progress = 0.5,
        .eta_s = NAN,
        .cpu_s = (double)checkpoint,
        .grid = &grid,
        .step = checkpoint,
        .checkpoint = &checkpoint,
        .n_checkpoint = sizeof checkpoint,
    };

    helper_curve_item(id, first, STEP_SAMPLES, &items[0]);
    if (with_snapshot) {
        append_half(s, id);
        helper_snapshot_item(id, 0, &items[1]);
        items[1].rho_at = HALF_BYTES;
        buffer_drop(&items[1].rho, HALF_BYTES);
    }
    if (helper_store_append(s, &batch, NULL) != BF_OK)
        _exit(1);
    for (size_t i = 0; i < batch.n; i++)
        helper_item_fini(&items[i]);
}

// Continues from the checkpoint, as a solver would.
static void solve(store *s, int out, const store_job *job)
{
    store_ending ending = { .run_id = job->run.id, .state = RUN_SUCCEEDED };
    api_run record;

    for (uint64_t first = job->step; first < N_STEPS * STEP_SAMPLES; first += STEP_SAMPLES) {
        append_step(s, job->run.id, first, first / STEP_SAMPLES == SNAPSHOT_STEP);
        if (store_find(s, job->run.id, &record, NULL) != BF_OK)
            _exit(1);
        tell_run(out, &record);
    }
    if (store_finish(s, &ending, &record, NULL) != BF_OK)
        _exit(1);
    tell_run(out, &record);
}

static _Noreturn void live(helper_store *h, int out)
{
    helper_store_open(h);
    for (;;) {
        store_job job = { 0 };
        api_run record = helper_submit(h->store, "", 0);
        tell_run(out, &record);
        if (store_claim(h->store, true, &job, NULL) != BF_OK)
            _exit(1);
        tell_run(out, &job.run);
        solve(h->store, out, &job);
        store_job_fini(&job);
    }
}

static promise *find_promise(promise *all, size_t *n, const char *id)
{
    // Newest first: most acknowledgements are of the last run.
    for (size_t i = *n; i-- > 0;)
        if (strcmp(all[i].id, id) == 0)
            return &all[i];
    assert_true(*n < N_RUNS_MAX);
    return &all[(*n)++];
}

static void take_promises(int in, promise *all, size_t *n)
{
    promise p;

    while (read(in, &p, sizeof p) == (ssize_t)sizeof p)
        *find_promise(all, n, p.id) = p;
}

// Kill a child after a while.
static void kill_child(pid_t child, int in)
{
    struct pollfd ready = { .fd = in, .events = POLLIN };

    assert_int_equal(poll(&ready, 1, FIRST_PROMISE_MS), 1);
    usleep((useconds_t)(rand() % (LIFE_MS_MAX * 1000)));
    assert_int_equal(kill(child, SIGKILL), 0);
}

// Start a child, let it work until it is killed or (n_changes > 0) its machine loses power, and read its
// acknowledgements.
static void spend_life(helper_store *h, unsigned n_changes, promise *all, size_t *n)
{
    int ends[2];
    int status = 0;

    assert_int_equal(pipe2(ends, O_CLOEXEC), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        close(ends[0]);
        helper_store_power_fail_at(n_changes, n_changes);
        live(h, ends[1]);
    }
    close(ends[1]);
    if (n_changes == 0)
        kill_child(child, ends[0]);
    take_promises(ends[0], all, n);
    close(ends[0]);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(n_changes == 0 ? WIFSIGNALED(status) : WIFEXITED(status));
    assert_true(n_changes == 0 || WEXITSTATUS(status) == 0);
}

static void check_results(store *s, const api_run *record)
{
    api_curve curve = { 0 };
    api_snapshot_list list = { 0 };

    assert_int_equal(store_read_curve(s, record->id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    assert_true(helper_curve_is(&curve, 0, record->n_samples)); // I4
    assert_int_equal(store_list_snapshots(s, record->id, &list, NULL), BF_OK);
    assert_int_equal(list.n, record->n_snapshots);
    for (uint64_t i = 0; i < record->n_snapshots; i++) {
        api_array got;
        bf_buffer rho = { 0 };
        assert_int_equal(store_read_array(s, record->id, i, API_ARRAY_DENSITY, &got, &rho, NULL),
                         BF_OK);
        assert_true(helper_snapshot_is(&rho, i));
        buffer_fini(&rho);
    }
    api_curve_fini(&curve);
    buffer_fini(&list.items);
}

// Of two acknowledged states the later one; what was not acknowledged may have happened, too.
static bool may_have_become(run_state promised, run_state now)
{
    if (promised == RUN_SUCCEEDED)
        return now == RUN_SUCCEEDED;
    return now == RUN_QUEUED || now == RUN_SUCCEEDED; // I8: never running
}

static void check_promise(store *s, const promise *p)
{
    api_run record = helper_find(s, p->id); // I1

    assert_true(may_have_become(p->state, record.state)); // I3
    assert_true(record.n_samples >= p->n_samples);
    assert_true(record.n_snapshots >= p->n_snapshots);
    check_results(s, &record);
    helper_events events = helper_read_events(s, p->id, 0);
    assert_int_equal(events.id, record.last_event); // I7
    assert_true(events.id >= p->last_event);        // I6
    assert_true((events.type == API_EVENT_END) == run_state_is_end(record.state));
    buffer_fini(&events.data);
}

// I5: what waits is claimed with a checkpoint that the stored samples reach.
static void check_queue(helper_store *h)
{
    store_job job = { 0 };
    uint64_t step = 0;

    while (store_claim(h->store, true, &job, NULL) == BF_OK) {
        assert_true(job.step <= job.run.n_samples);
        assert_true((job.checkpoint.n == 0) == (job.step == 0));
        if (job.checkpoint.n == sizeof step)
            memcpy(&step, job.checkpoint.bytes, sizeof step);
        assert_int_equal(step, job.step);
        step = 0;
        store_job_fini(&job);
    }
}

// I16: what was charged is what runs have used, and the bytes are those that are stored. All are whole numbers.
static void check_use(const helper_store *h)
{
    assert_int_equal(helper_store_sql(h, "SELECT (SELECT total(cpu_s) FROM cpu_sums) = "
                                         "(SELECT total(cpu_s) FROM runs)"),
                     1);
    assert_int_equal(helper_store_sql(h,
                                      "SELECT (SELECT total(n_bytes) FROM owners) = "
                                      "(SELECT total(length(data)) FROM chunks WHERE kind <> 1) + "
                                      "(SELECT total(length(t) + length(parts)) FROM samples) + "
                                      "(SELECT total(length(data)) FROM events) + "
                                      "(SELECT total(length(data)) FROM texts WHERE kind = 0)"),
                     1);
}

// Everything that was acknowledged in the life before, and what it may have taken up, is there, and the file is sound.
static void check_store(helper_store *h, bool with_queue, const promise *all, size_t n_before,
                        size_t n)
{
    helper_store_open(h);
    // A child takes up at most the runs that its predecessors left, so these are checked again.
    for (size_t i = n_before > 30 ? n_before - 30 : 0; i < n; i++)
        check_promise(h->store, &all[i]);
    if (with_queue)
        check_queue(h);
    helper_store_close(h);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM pragma_integrity_check "
                                         "WHERE integrity_check <> 'ok'"),
                     0);
    check_use(h);
}

// n_changes_max > 0: each life ends by a loss of power after at most so many changes of files, else by a signal.
static void survive(helper_store *h, int n_lives, unsigned n_changes_max)
{
    promise *all = calloc(N_RUNS_MAX, sizeof *all);
    size_t n = 0;

    assert_non_null(all);
    srand(1);
    helper_store_close(h);
    for (int life = 0; life < n_lives; life++) {
        size_t n_before = n;
        unsigned n_changes = n_changes_max == 0 ? 0 : 1 + (unsigned)rand() % n_changes_max;
        spend_life(h, n_changes, all, &n);
        check_store(h, life % 5 == 0, all, n_before, n);
    }
    assert_true(n > (size_t)n_lives / 4);
    check_store(h, false, all, 0, n);
    helper_store_open(h);
    free(all);
}

static void what_was_acknowledged_survives_kill_9(void **state)
{
    survive(*state, N_LIVES, 0);
}

static void what_was_acknowledged_survives_a_loss_of_power(void **state)
{
    survive(*state, N_POWER_CUTS, POWER_CHANGES_MAX);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_was_acknowledged_survives_kill_9, helper_store_setup,
                                        helper_store_teardown),
        cmocka_unit_test_setup_teardown(what_was_acknowledged_survives_a_loss_of_power,
                                        helper_store_setup, helper_store_teardown),
    };
    helper_store_power_install();
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Unit tests of the store in an environment that fails: the n-th allocation of SQLite, or the n-th call of a kind to the
// operating system, for n = 1, 2, ... until nothing has been asked for an n-th time. Each time the life of a run is
// lived, and what was acknowledged of it must be there, now and after the store was opened again.

#include "tests/unit/helper_amount.h"
#include "tests/unit/server/helper_store.h"

#include "server/base/log.h"
#include "server/store/backup.h"
#include "tests/unit/helper_cmocka.h"

#include <errno.h>
#include <sqlite3.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

// ------------------------------------------------------------------------ what fails

// What can fail: SQLite's allocations and its calls, and syncs of this process.
typedef enum fault {
    FAULT_MEMORY,
    FAULT_WRITE,
    FAULT_SYNC,
    FAULT_OPEN,
    FAULT_SHORTEN,
    FAULT_COUNT,
} fault;

// The fault that is planned.
static struct plan {
    atomic_int which; // FAULT_COUNT: none
    atomic_bool persists;
    atomic_int error;      // errno of calls that fail
    atomic_size_t left;    // requests until it comes
    atomic_size_t n_times; // it came
} plan = { .which = FAULT_COUNT };

static void plan_fault(fault which, size_t n, bool persists, int error)
{
    atomic_store(&plan.which, FAULT_COUNT);
    atomic_store(&plan.persists, persists);
    atomic_store(&plan.error, error);
    atomic_store(&plan.left, n);
    atomic_store(&plan.n_times, 0);
    atomic_store(&plan.which, which);
}

static bool is_due(fault which)
{
    if (atomic_load(&plan.which) != (int)which)
        return false;
    const size_t left = atomic_load(&plan.left);
    if (left == 0 && !atomic_load(&plan.persists))
        return false;
    if (left > 0 && atomic_fetch_sub(&plan.left, 1) > 1)
        return false;
    (void)atomic_fetch_add(&plan.n_times, 1);
    errno = atomic_load(&plan.error);
    return true;
}

static sqlite3_mem_methods memory;
static struct calls {
    ssize_t (*pwrite)(int, const void *, size_t, off_t);
    ssize_t (*write)(int, const void *, size_t);
    int (*open)(const char *, int, int);
    int (*ftruncate)(int, off_t);
} calls;

static void *allocate(int n)
{
    return is_due(FAULT_MEMORY) ? NULL : memory.xMalloc(n);
}

static void *allocate_again(void *block, int n)
{
    return is_due(FAULT_MEMORY) ? NULL : memory.xRealloc(block, n);
}

static ssize_t write_at(int fd, const void *bytes, size_t n, off_t at)
{
    return is_due(FAULT_WRITE) ? -1 : calls.pwrite(fd, bytes, n, at);
}

static ssize_t write_here(int fd, const void *bytes, size_t n)
{
    return is_due(FAULT_WRITE) ? -1 : calls.write(fd, bytes, n);
}

// These take the place of the C library's. No power is lost here, so that nothing need wait for the disk.
int fsync(int fd);
int fdatasync(int fd);

int fsync(int fd)
{
    (void)fd;
    return is_due(FAULT_SYNC) ? -1 : 0;
}

int fdatasync(int fd)
{
    (void)fd;
    return is_due(FAULT_SYNC) ? -1 : 0;
}

static int shorten(int fd, off_t size)
{
    return is_due(FAULT_SHORTEN) ? -1 : calls.ftruncate(fd, size);
}

static int open_file(const char *path, int flags, int mode)
{
    return is_due(FAULT_OPEN) ? -1 : calls.open(path, flags, mode);
}

static sqlite3_syscall_ptr replace_call(sqlite3_vfs *vfs, const char *name, sqlite3_syscall_ptr by)
{
    const sqlite3_syscall_ptr before = vfs->xGetSystemCall(vfs, name);

    assert_non_null(before);
    assert_int_equal(vfs->xSetSystemCall(vfs, name, by), SQLITE_OK);
    return before;
}

// Before SQLite is used, and once: its VFS keeps what it is given.
static int take_over(void **state)
{
    sqlite3_mem_methods methods;

    assert_int_equal(sqlite3_config(SQLITE_CONFIG_GETMALLOC, &memory), SQLITE_OK);
    methods = memory;
    methods.xMalloc = allocate;
    methods.xRealloc = allocate_again;
    assert_int_equal(sqlite3_config(SQLITE_CONFIG_MALLOC, &methods), SQLITE_OK);
    assert_int_equal(sqlite3_initialize(), SQLITE_OK);
    sqlite3_vfs *vfs = sqlite3_vfs_find(NULL);
#define TAKE(member, name, ours)                                                                   \
    calls.member = (__typeof__(calls.member))replace_call(vfs, name, (sqlite3_syscall_ptr)(ours))
    TAKE(pwrite, "pwrite64", write_at);
    TAKE(write, "write", write_here);
    TAKE(open, "open", open_file);
    TAKE(ftruncate, "ftruncate", shorten);
#undef TAKE
    return 0;
}

// ------------------------------------------------------------------------ a run's life

// What was acknowledged of a run.
typedef struct life {
    bool is_accepted;
    api_run accepted;
    bool is_claimed;
    bool has_results;
    bool has_ended;
} life;

enum {
    SAMPLES = 5,
    SELDOM = 16, // faults between two stores that are opened to look at
};

static const char summary[] = "{}";

// The environment may be at fault, but never the run or who asks.
static void assert_is_answer(bf_status status, const bf_error *err)
{
    if (status == BF_OK)
        return;
    assert_int_equal(err->code, status);
    assert_string_not_equal(err->text, "");
    if (status != BF_ENOMEM && status != BF_ESYSTEM && status != BF_ENOSPACE && status != BF_EBUSY)
        fail_msg("status %d: %s", (int)status, err->text);
}

static bool submit(store *s, api_run *ret_run)
{
    api_submission submission = { .model = RUN_MACRO, .name = "a belt" };
    api_acceptance accepted = { 0 };
    bf_error err = { 0 };

    assert_int_equal(buffer_append(&submission.scenario, "{}", 2), BF_OK);
    assert_int_equal(buffer_append(&submission.columns, "upstream,left_domain", 20), BF_OK);
    const bf_status status = store_submit(s, &submission, &accepted, &err);
    assert_is_answer(status, &err);
    if (status == BF_OK)
        memcpy(ret_run->id, accepted.id, sizeof ret_run->id);
    buffer_fini(&accepted.answer);
    buffer_fini(&submission.scenario);
    buffer_fini(&submission.columns);
    return status == BF_OK;
}

static bool claim(store *s, const char *id)
{
    store_job job = { 0 };
    bf_error err = { 0 };

    const bf_status status = store_claim(s, true, &job, &err);
    assert_is_answer(status, &err);
    if (status != BF_OK)
        return false;
    assert_string_equal(job.run.id, id);
    store_job_fini(&job);
    return true;
}

static bool append(store *s, const char *id)
{
    store_item items[2];
    bf_error err = { 0 };

    helper_progress_item(id, 1, &items[0]);
    helper_curve_item(id, 0, SAMPLES, &items[1]);
    const store_batch batch = { .run_id = id,
                                .n = 2,
                                .items = items,
                                .checkpoint = "checkpoint",
                                .n_checkpoint = 10,
                                .step = 5 };
    const bf_status status = helper_store_append(s, &batch, &err);
    assert_is_answer(status, &err);
    helper_item_fini(&items[0]);
    helper_item_fini(&items[1]);
    return status == BF_OK;
}

static bool finish(store *s, const char *id)
{
    const store_ending ending = {
        .run_id = id, .state = RUN_SUCCEEDED, .summary = summary, .n_summary = sizeof summary - 1
    };
    api_run record;
    bf_error err = { 0 };

    const bf_status status = store_finish(s, &ending, &record, &err);
    assert_is_answer(status, &err);
    return status == BF_OK;
}

static bf_status skip_event(void *context, const api_event *event, bf_error *err)
{
    ++*(size_t *)context;
    return BF_OK;
}

// Each answer is right or a failure of the environment.
static void read_all(store *s, const life *l)
{
    char ids[1][API_ID_SIZE];
    api_run record;
    api_curve curve = { 0 };
    size_t n_events = 0;
    bf_error err = { 0 };

    bf_status status = store_find(s, l->accepted.id, &record, &err);
    assert_is_answer(status, &err);
    if (status == BF_OK)
        assert_int_equal(record.n_samples, l->has_results ? SAMPLES : 0);
    status = store_read_curve(s, l->accepted.id, 0, UINT64_MAX, &curve, &err);
    assert_is_answer(status, &err);
    if (status == BF_OK) {
        assert_int_equal(curve.n, l->has_results ? SAMPLES : 0);
        api_curve_fini(&curve);
    }
    memcpy(ids[0], l->accepted.id, API_ID_SIZE);
    status = store_read_events(s, (const char(*)[API_ID_SIZE])ids, 1, 0, SIZE_MAX, skip_event,
                               &n_events, &err);
    assert_is_answer(status, &err);
    if (status == BF_OK)
        assert_true(n_events >= 1);
}

static life live(store *s)
{
    life l = { .is_accepted = false };

    l.is_accepted = submit(s, &l.accepted);
    if (!l.is_accepted)
        return l;
    const char *id = l.accepted.id;
    l.is_claimed = claim(s, id);
    l.has_results = l.is_claimed && append(s, id);
    l.has_ended = l.is_claimed && finish(s, id);
    read_all(s, &l);
    return l;
}

static size_t count_runs(store *s)
{
    static api_run_list list;
    const api_list_query query = { .state = -1, .model = -1, .limit = 10 };
    bf_error err = { 0 };

    if (store_list(s, &query, &list, &err) != BF_OK)
        fail_msg("%s", err.text);
    return list.n;
}

static run_state state_of(const life *l)
{
    return l->has_ended ? RUN_SUCCEEDED : l->is_claimed ? RUN_RUNNING : RUN_QUEUED;
}

// What was acknowledged is there, and nothing else.
static void check_life(store *s, const life *l, bool is_reopened)
{
    assert_int_equal(count_runs(s), l->is_accepted);
    if (!l->is_accepted)
        return;
    const api_run record = helper_find(s, l->accepted.id);
    const bool is_back = is_reopened && state_of(l) == RUN_RUNNING;
    assert_int_equal(record.state, is_back ? RUN_QUEUED : state_of(l));
    assert_int_equal(record.n_samples, l->has_results ? SAMPLES : 0);
}

static void end_life(store *s, const life *l)
{
    bf_error err = { 0 };

    if (!l->is_accepted)
        return;
    if (helper_find(s, l->accepted.id).state == RUN_RUNNING)
        (void)helper_finish(s, l->accepted.id, RUN_CANCELLED);
    if (store_remove(s, l->accepted.id, API_ANY_REVISION, &err) != BF_OK)
        fail_msg("%s", err.text);
}

static void on_finding(void *context, const char *name, const char *claim, const char *finding)
{
    if (finding != NULL)
        fail_msg("%s, %s: %s", name, claim, finding);
}

static void assert_is_sound(const helper_store *h)
{
    char path[128];
    bool is_sound = false;
    bf_error err = { 0 };

    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    if (store_verify(path, on_finding, NULL, &is_sound, &err) != BF_OK)
        fail_msg("%s", err.text);
    assert_true(is_sound);
}

// Lives with the n-th request of a kind refused, n = 1, 2, ..., until one needs no n-th. Returns how many.
static size_t live_with(helper_store *h, fault which, bool persists, int error)
{
    for (size_t n = 1;; n += HELPER_AMOUNT(1, 3)) {
        plan_fault(which, n, persists, error);
        const life l = live(h->store);
        const size_t n_times = atomic_load(&plan.n_times);
        plan_fault(FAULT_COUNT, 0, false, 0);
        check_life(h->store, &l, false);
        if (n_times > 0 && n % SELDOM == 0) {
            helper_store_close(h);
            helper_store_open(h);
            check_life(h->store, &l, true);
        }
        end_life(h->store, &l);
        if (n_times > 0)
            continue;
        assert_true(l.has_results && l.has_ended);
        return n - 1;
    }
}

// The same for a store that opens with a run in it, which must then be there. An opening ends at its first fault, so what
// comes after that does not matter.
static size_t open_with(helper_store *h, fault which, int error)
{
    const store_options options = { .directory = h->directory, .queue_limit = 10 };
    const life l = live(h->store);

    assert_true(l.has_ended);
    helper_store_close(h);
    for (size_t n = 1;; n += HELPER_AMOUNT(1, 3)) {
        bf_error err = { 0 };
        plan_fault(which, n, false, error);
        const bf_status status = store_open(&options, &h->store, &err);
        assert_is_answer(status, &err);
        assert_true((status == BF_OK) == (h->store != NULL));
        helper_store_close(h);
        const size_t n_times = atomic_load(&plan.n_times);
        plan_fault(FAULT_COUNT, 0, false, 0);
        if (n_times > 0 && n % SELDOM != 0)
            continue;
        helper_store_open(h);
        check_life(h->store, &l, true);
        if (n_times == 0) {
            end_life(h->store, &l);
            return n - 1;
        }
        helper_store_close(h);
    }
}

static void walk(void **state, fault which, int error)
{
    helper_store *h = *state;

    const size_t n_once = live_with(h, which, false, error);
    const size_t n_persistent = live_with(h, which, true, error);
    const size_t n_openings = open_with(h, which, error);
    print_message("%zu and %zu lives, %zu openings\n", n_once, n_persistent, n_openings);
    assert_true(n_once + n_openings > 0);
    helper_store_close(h);
    assert_is_sound(h);
}

static void allocations_of_sqlite_fail(void **state)
{
    walk(state, FAULT_MEMORY, ENOMEM);
}

static void writes_fail(void **state)
{
    walk(state, FAULT_WRITE, EIO);
}

static void writes_find_no_room(void **state)
{
    walk(state, FAULT_WRITE, ENOSPC);
}

static void syncs_fail(void **state)
{
    walk(state, FAULT_SYNC, EIO);
}

static void files_do_not_open(void **state)
{
    walk(state, FAULT_OPEN, EMFILE);
}

static void files_do_not_shorten(void **state)
{
    walk(state, FAULT_SHORTEN, EIO);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(allocations_of_sqlite_fail), STORE_TEST(writes_fail),
        STORE_TEST(writes_find_no_room),        STORE_TEST(syncs_fail),
        STORE_TEST(files_do_not_open),          STORE_TEST(files_do_not_shorten),
    };
    log_set_level(LOG_LEVEL_ERROR);
    return cmocka_run_group_tests(tests, take_over, NULL);
}

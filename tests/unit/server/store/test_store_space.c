// Unit tests of the store on a small disk of its own: what is refused when it is nearly full, and how it gets empty
// again. I1 ... I15 are the invariants of server/store/store.h. Skipped where the system lets us have no such disk.

#include "tests/unit/helper_amount.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_store.h"

#include <fcntl.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

// Snapshots of 480 kB of noise, until one finds no room. Returns how many are stored.
static uint64_t fill_with_results(store *s, const char *id)
{
    bf_error err = { 0 };
    store_item item;
    uint64_t n = 0;

    do
        helper_snapshot_item(id, n++, &item);
    while (helper_append(s, id, &item, &err) == BF_OK);
    assert_int_equal(err.code, BF_ENOSPACE);
    assert_non_null(strstr(err.text, "disk is full"));
    return n - 1;
}

// What another program leaves free: nothing, down to the last block.
static void fill_with_file(const char *directory)
{
    static const char block[4096];
    char path[128];

    snprintf(path, sizeof path, "%s/filler", directory);
    int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    assert_true(file >= 0);
    while (write(file, block, sizeof block) > 0)
        ;
    assert_int_equal(close(file), 0);
}

static void remove_filler(const char *directory)
{
    char path[128];

    snprintf(path, sizeof path, "%s/filler", directory);
    assert_int_equal(unlink(path), 0);
}

static off_t size_of(const char *directory, const char *name)
{
    char path[128];
    struct stat info;

    snprintf(path, sizeof path, "%s/%s", directory, name);
    return stat(path, &info) == 0 ? info.st_size : 0;
}

// Until the last free page is back on the disk, the log grows now and then and takes room for a moment.
static void await_emptiness(const helper_store *h)
{
    HELPER_AWAIT(size_of(h->directory, "beltflow.db") <= 1000000);
    HELPER_AWAIT(size_of(h->directory, "beltflow.reserve") > 0);
    HELPER_AWAIT(store_ready(h->store, NULL) == BF_OK);
}

// Nothing that takes room is accepted, and all of it says why.
static void expect_no_room(store *s)
{
    const api_submission submission = { .model = RUN_MACRO };
    const api_measurement measurement = { .label = "camera" };
    const api_curve curve = { .n = 0 };
    api_acceptance accepted = { .revision = 0 };
    api_measurement added;
    store_job job = { .step = 0 };
    bf_error err = { 0 };

    assert_int_equal(store_submit(s, &submission, &accepted, &err), BF_ENOSPACE);
    assert_non_null(strstr(err.text, "MiB left"));
    assert_int_equal(
        store_add_measurement(s, &measurement, &curve, &(bf_buffer){ 0 }, &added, &err),
        BF_ENOSPACE);
    assert_int_equal(store_claim(s, true, &job, &err), BF_ENOSPACE);
    assert_int_equal(store_ready(s, &err), BF_ENOSPACE);
    assert_non_null(strstr(err.text, "MiB left"));
}

// The run that filled the disk is handed back, another one waits, an ended one is removed. I1, I3.
static void a_full_disk_takes_nothing_and_gives_room_again(void **state)
{
    helper_store *h = *state;
    const api_run ended = helper_start(h->store);

    helper_append_snapshot(h->store, ended.id, 0);
    helper_finish(h->store, ended.id, RUN_SUCCEEDED);
    const api_run big = helper_start(h->store), waits = helper_submit(h->store, "", 0);
    const uint64_t n = fill_with_results(h->store, big.id);
    fill_with_file(h->directory);
    expect_no_room(h->store);
    assert_int_equal(helper_finish(h->store, big.id, RUN_QUEUED).state, RUN_QUEUED);
    assert_int_equal(store_remove(h->store, ended.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(helper_find(h->store, big.id).n_snapshots, n);
    // As full as it was, it is opened again, and the next removal is done as well.
    helper_store_close(h);
    fill_with_file(h->directory);
    helper_store_open(h);
    expect_no_room(h->store);
    assert_int_equal(helper_find(h->store, big.id).n_snapshots, n);
    assert_int_equal(store_remove(h->store, big.id, API_ANY_REVISION, NULL), BF_OK);
    // The pages of the big one go back to the disk.
    await_emptiness(h);
    assert_string_equal(helper_claim(h->store).id, waits.id);
    helper_submit(h->store, "", 0);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM pragma_integrity_check "
                                         "WHERE integrity_check <> 'ok'"),
                     0);
}

// The reserve is there each time.
static void a_disk_is_filled_and_emptied_again_and_again(void **state)
{
    helper_store *h = *state;

    for (int i = 0; i < HELPER_AMOUNT(3, 2); i++) {
        const api_run big = helper_start(h->store);
        fill_with_results(h->store, big.id);
        fill_with_file(h->directory);
        helper_finish(h->store, big.id, RUN_CANCELLED);
        assert_int_equal(store_remove(h->store, big.id, API_ANY_REVISION, NULL), BF_OK);
        await_emptiness(h);
        remove_filler(h->directory);
    }
}

// I12
static void retention_empties_a_full_disk(void **state)
{
    const store_retention retention = { .n_bytes = 10000000 };
    helper_store *h = *state;
    const api_run big = helper_start(h->store);

    fill_with_results(h->store, big.id);
    fill_with_file(h->directory);
    helper_finish(h->store, big.id, RUN_CANCELLED);
    store_set_retention(h->store, &retention);
    await_emptiness(h);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), 0);
    helper_submit(h->store, "", 0);
}

// A stop that a client asks for and the end that follows it, so that a running run can be removed, too.
static void a_running_run_is_stopped_and_removed_on_a_full_disk(void **state)
{
    helper_store *h = *state;
    const api_run big = helper_start(h->store);

    fill_with_results(h->store, big.id);
    fill_with_file(h->directory);
    assert_int_equal(store_remove(h->store, big.id, API_ANY_REVISION, NULL), BF_ECONFLICT);
    // I14: it is cancelled instead.
    assert_int_equal(helper_finish(h->store, big.id, RUN_QUEUED).state, RUN_CANCELLED);
    assert_int_equal(store_remove(h->store, big.id, API_ANY_REVISION, NULL), BF_OK);
    HELPER_AWAIT(store_ready(h->store, NULL) == BF_OK);
}

static bool has_namespace; // mounts of ours are not seen by others

// Before the first thread is started.
static int enter_namespace(void **state)
{
    has_namespace = (unshare(CLONE_NEWNS) == 0 || unshare(CLONE_NEWUSER | CLONE_NEWNS) == 0) &&
                    mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) == 0;
    return 0;
}

static int setup(void **state)
{
    static helper_store h;

    h = (helper_store){ .store = NULL };
    strcpy(h.directory, "/tmp/beltflow-disk-XXXXXX");
    assert_non_null(mkdtemp(h.directory));
    *state = &h;
    if (!has_namespace || mount("none", h.directory, "tmpfs", 0, "size=96m") != 0) {
        has_namespace = false;
        return 0;
    }
    helper_store_open(&h);
    return 0;
}

static int teardown(void **state)
{
    helper_store *h = *state;

    helper_store_close(h);
    if (has_namespace)
        assert_int_equal(umount2(h->directory, MNT_DETACH), 0);
    return rmdir(h->directory);
}

#define ON_A_SMALL_DISK(story)                                                                     \
    static void test_##story(void **state)                                                         \
    {                                                                                              \
        if (!has_namespace)                                                                        \
            skip();                                                                                \
        story(state);                                                                              \
    }
ON_A_SMALL_DISK(a_full_disk_takes_nothing_and_gives_room_again)
ON_A_SMALL_DISK(a_disk_is_filled_and_emptied_again_and_again)
ON_A_SMALL_DISK(retention_empties_a_full_disk)
ON_A_SMALL_DISK(a_running_run_is_stopped_and_removed_on_a_full_disk)

int main(void)
{
#define TEST(story) cmocka_unit_test_setup_teardown(test_##story, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_full_disk_takes_nothing_and_gives_room_again),
        TEST(a_disk_is_filled_and_emptied_again_and_again),
        TEST(retention_empties_a_full_disk),
        TEST(a_running_run_is_stopped_and_removed_on_a_full_disk),
    };
    return cmocka_run_group_tests(tests, enter_namespace, NULL);
}

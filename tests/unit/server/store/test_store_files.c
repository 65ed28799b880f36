// Unit tests of what is written to files beside the store's own commits, where the disk fails: the n-th call that opens,
// writes, shortens, reserves, syncs, renames or closes, for n = 1, 2, ... until there is no n-th. What was acknowledged
// is there, what was not leaves nothing behind, and afterwards all goes on.

#include "tests/unit/server/helper_fault.h"
#include "tests/unit/server/helper_golden.h"

#include "server/base/file_io.h"
#include "server/base/log.h"
#include "server/cli/results_dir.h"
#include "server/store/backup.h"
#include "server/store/tokens.h"
#include "tests/unit/helper_cmocka.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// ------------------------------------------------------------------------ what fails

// These take the place of the C library's, which SQLite calls, too; it has some under the names of large files.
#define TAKE(ours, name, parameters, arguments)                                                    \
    int ours parameters __asm__(name);                                                             \
    int ours parameters                                                                            \
    {                                                                                              \
        int(*next) parameters;                                                                     \
        helper_fault_next(name, &next);                                                            \
        return helper_fault_is_due() ? -1 : next arguments;                                        \
    }
TAKE(open_here, "open", (const char *path, int flags, mode_t mode), (path, flags, mode))
TAKE(open_large, "open64", (const char *path, int flags, mode_t mode), (path, flags, mode))
TAKE(open_at, "openat", (int folder, const char *path, int flags, mode_t mode),
     (folder, path, flags, mode))
TAKE(make_temporary, "mkstemp", (char *name), (name))
TAKE(shorten, "ftruncate", (int fd, off_t n), (fd, n))
TAKE(shorten_large, "ftruncate64", (int fd, off_t n), (fd, n))
TAKE(move, "renameat", (int from, const char *a, int to, const char *b), (from, a, to, b))
TAKE(move_new, "renameat2", (int from, const char *a, int to, const char *b, unsigned flags),
     (from, a, to, b, flags))
#undef TAKE

// No power is lost here, so that nothing need wait for the disk.
int sync_file(int fd) __asm__("fsync");
int sync_file(int fd)
{
    (void)fd;
    return helper_fault_is_due() ? -1 : 0;
}

int sync_data(int fd) __asm__("fdatasync");
int sync_data(int fd)
{
    (void)fd;
    return helper_fault_is_due() ? -1 : 0;
}

int reserve(int fd, off_t at, off_t n) __asm__("posix_fallocate");
int reserve(int fd, off_t at, off_t n)
{
    int (*next)(int, off_t, off_t);

    helper_fault_next("posix_fallocate", &next);
    return helper_fault_is_due() ? errno : next(fd, at, n);
}

// Where closing fails the descriptor is gone all the same.
int close_here(int fd) __asm__("close");
int close_here(int fd)
{
    int (*next)(int);

    helper_fault_next("close", &next);
    const int result = next(fd);
    return helper_fault_is_due() ? -1 : result;
}

// What the test itself says does not fail.
ssize_t write_here(int fd, const void *bytes, size_t n) __asm__("write");
ssize_t write_here(int fd, const void *bytes, size_t n)
{
    ssize_t (*next)(int, const void *, size_t);

    helper_fault_next("write", &next);
    return fd > STDERR_FILENO && helper_fault_is_due() ? -1 : next(fd, bytes, n);
}

ssize_t write_at(int fd, const void *bytes, size_t n, off_t at) __asm__("pwrite64");
ssize_t write_at(int fd, const void *bytes, size_t n, off_t at)
{
    ssize_t (*next)(int, const void *, size_t, off_t);

    helper_fault_next("pwrite64", &next);
    return helper_fault_is_due() ? -1 : next(fd, bytes, n, at);
}

// ------------------------------------------------------------------------ the loop

/// Do something that writes, and check it with no fault. Not BF_OK: it said that it failed, with *err.
typedef bf_status act_fn(helper_store *h, bf_error *err);
typedef void check_fn(helper_store *h, bf_status status);

// With every step-th n. Returns how many calls there were without a fault, to a step.
static size_t fail_some(helper_store *h, size_t step, int error, act_fn *act, check_fn *check)
{
    bool is_reached = true;
    size_t n = 1;

    for (; is_reached; n += step) {
        bf_error err = { 0 };
        helper_fault_plan(n, error);
        const bf_status status = act(h, &err);
        is_reached = helper_fault_calls() >= n;
        helper_fault_plan(0, 0);
        if (status != BF_OK && status != BF_ESYSTEM && status != BF_ENOSPACE)
            fail_msg("call %zu, status %d: %s", n, (int)status, err.text);
        assert_true(status == BF_OK || (is_reached && err.text[0] != '\0'));
        check(h, status);
    }
    return n - 2 * step;
}

static size_t fail_each(helper_store *h, act_fn *act, check_fn *check)
{
    (void)fail_some(h, 1, ENOSPC, act, check);
    return fail_some(h, 1, EIO, act, check);
}

static size_t count_files(const char *directory, const char *prefix)
{
    DIR *folder = opendir(directory);
    size_t n = 0;

    assert_non_null(folder);
    for (struct dirent *entry; (entry = readdir(folder)) != NULL;)
        n += strncmp(entry->d_name, prefix, strlen(prefix)) == 0;
    closedir(folder);
    return n;
}

static const char *path_in(const helper_store *h, const char *name)
{
    static char path[128];

    (void)snprintf(path, sizeof path, "%s/%s", h->directory, name);
    return path;
}

// ------------------------------------------------------------------------ copies

static bf_status back_up(helper_store *h, bf_error *err)
{
    char copy[128];

    (void)snprintf(copy, sizeof copy, "%s/copy", h->directory);
    return store_backup(h->directory, copy, err);
}

static void check_copy(helper_store *h, bf_status status)
{
    assert_int_equal(count_files(h->directory, "copy"), status == BF_OK ? 1 : 0);
    if (status != BF_OK)
        return;
    helper_store_verify_file(path_in(h, "copy"));
    assert_int_equal(unlink(path_in(h, "copy")), 0);
}

static void a_backup_is_whole_or_is_not_there(void **state)
{
    helper_store *h = *state;

    helper_append_samples(h->store, helper_start(h->store).id, 0, 3);
    assert_true(fail_each(h, back_up, check_copy) > 10);
}

// ------------------------------------------------------------------------ tokens

static uint64_t n_tokens, n_revoked; // that were acknowledged

static void count_token(void *context, const tokens_record *token)
{
    uint64_t *counts = context;

    counts[0]++;
    counts[1] += token->revoked_ms > 0;
}

static bf_status add_token(helper_store *h, bf_error *err)
{
    tokens_record token = { .name = "press", .owner = "hall-3", .scopes = API_SCOPE_READ };
    char text[API_TOKEN_SIZE];

    const bf_status status = tokens_add(h->directory, &token, text, err);
    n_tokens += status == BF_OK;
    return status;
}

// The newest one, which each successful turn leaves and the next one revokes.
static bf_status revoke_token(helper_store *h, bf_error *err)
{
    const bf_status status = tokens_revoke(h->directory, n_revoked + 1, err);

    n_revoked += status == BF_OK;
    return status;
}

static void check_tokens(helper_store *h, bf_status status)
{
    uint64_t counts[2] = { 0 };

    (void)status;
    if (access(path_in(h, "access.db"), F_OK) == 0)
        assert_int_equal(tokens_list(h->directory, count_token, counts, NULL), BF_OK);
    assert_int_equal(counts[0], n_tokens);
    assert_int_equal(counts[1], n_revoked);
    assert_int_equal(count_files(h->directory, "access.db-"), 0);
}

static void tokens_are_those_that_were_acknowledged(void **state)
{
    helper_store *h = *state;

    n_tokens = n_revoked = 0;
    assert_true(fail_each(h, add_token, check_tokens) > 8);
    while (n_tokens < 100)
        assert_int_equal(add_token(h, NULL), BF_OK);
    assert_true(fail_each(h, revoke_token, check_tokens) > 8);
}

// ------------------------------------------------------------------------ files that are replaced

static bf_status replace(helper_store *h, bf_error *err)
{
    const int folder = open(h->directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);

    if (folder < 0)
        return bf_fail(err, BF_ESYSTEM, "", "no folder");
    const bf_status status = file_io_replace(folder, "file", "new", 3, FILE_IO_NOW, err);
    (void)close(folder);
    return status;
}

static void check_file(helper_store *h, bf_status status)
{
    bf_buffer text = { 0 };

    assert_int_equal(count_files(h->directory, "file"), 1);
    assert_int_equal(file_io_read(path_in(h, "file"), NULL, 100, &text, NULL), BF_OK);
    assert_true(strcmp(text.bytes, "new") == 0 ||
                (status != BF_OK && strcmp(text.bytes, "old") == 0));
    buffer_fini(&text);
    FILE *file = fopen(path_in(h, "file"), "we");
    assert_non_null(file);
    assert_true(fputs("old", file) >= 0 && fclose(file) == 0);
}

static void a_file_that_is_replaced_is_the_old_or_the_new_one(void **state)
{
    helper_store *h = *state;

    FILE *file = fopen(path_in(h, "file"), "we");
    assert_non_null(file);
    assert_true(fputs("old", file) >= 0 && fclose(file) == 0);
    assert_int_equal(fail_each(h, replace, check_file), 8);
}

// ------------------------------------------------------------------------ results

static bf_status fill_results(results_dir *d, bf_error *err)
{
    static const double t = 0.5, values[] = { 8.0, 1.0 };
    static const float rho[2] = { 0.25F, 1.0F };
    const frame frames[] = {
        { .type = FRAME_BEGIN, .begin = { .n_columns = 2, .grid = { .n1 = 2, .n2 = 1 } } },
        { .type = FRAME_CURVE, .curve = { .n = 1, .n_columns = 2, .t = &t, .values = values } },
        { .type = FRAME_SNAPSHOT, .snapshot = { .n1 = 2, .n2 = 1, .rho = rho } },
    };
    bf_status status = results_dir_scenario(d, "{}", 2, err);

    for (size_t i = 0; i < sizeof frames / sizeof *frames && status == BF_OK; i++)
        status = results_dir_take(d, &frames[i], err);
    return status == BF_OK ? results_dir_finish(d, "{}", 2, err) : status;
}

static bf_status write_results(helper_store *h, bf_error *err)
{
    results_dir *d = NULL;
    char path[128];

    (void)snprintf(path, sizeof path, "%s/results", h->directory);
    bf_status status = results_dir_open(path, "upstream,left_domain", &d, err);
    if (status == BF_OK)
        status = fill_results(d, err);
    (void)results_dir_close(d);
    return status;
}

static void check_results(helper_store *h, bf_status status)
{
    static const char *const names[] = { "scenario.json", "curve.csv", "snapshots.json",
                                         "snapshots/000000.npy" };
    struct stat info;
    char path[160];

    if (access(path_in(h, "results"), F_OK) != 0) {
        assert_int_not_equal(status, BF_OK);
        return;
    }
    (void)snprintf(path, sizeof path, "%s/results/summary.json", h->directory);
    const bool is_complete = stat(path, &info) == 0;
    assert_true(is_complete || status != BF_OK);
    for (size_t i = 0; is_complete && i < sizeof names / sizeof *names; i++) {
        (void)snprintf(path, sizeof path, "%s/results/%s", h->directory, names[i]);
        assert_int_equal(stat(path, &info), 0);
        assert_true(info.st_size > 0);
    }
    (void)snprintf(path, sizeof path, "rm -rf '%s/results'", h->directory);
    assert_int_equal(system(path), 0);
}

static void results_have_a_summary_only_where_they_are_complete(void **state)
{
    assert_true(fail_each(*state, write_results, check_results) > 15);
}

// ------------------------------------------------------------------------ the store's directory

static bf_status open_store(helper_store *h, bf_error *err)
{
    const store_options options = { .directory = h->directory, .queue_limit = 100 };

    const bf_status status = store_open(&options, &h->store, err);
    if (status == BF_OK)
        helper_store_close(h);
    return status;
}

// The reserve is there with all its bytes, or not at all; the store opens, and takes one.
static void check_reserve(helper_store *h, bf_status status)
{
    struct stat info;

    (void)status;
    if (stat(path_in(h, "beltflow.reserve"), &info) == 0) {
        assert_true(info.st_size == 8 << 20 && info.st_blocks * 512 >= info.st_size);
        assert_int_equal(unlink(path_in(h, "beltflow.reserve")), 0);
    }
    helper_store_open(h);
    (void)helper_submit(h->store, "", 0);
    helper_store_close(h);
    (void)unlink(path_in(h, "beltflow.reserve"));
}

static void a_store_opens_or_says_why_not(void **state)
{
    helper_store *h = *state;

    helper_store_close(h);
    (void)unlink(path_in(h, "beltflow.reserve"));
    assert_true(fail_each(h, open_store, check_reserve) > 10);
}

// One without checksums, which a start writes anew.
static void check_old_store(helper_store *h, bf_status status)
{
    (void)status;
    helper_store_open(h);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), 6);
    assert_int_equal(count_files(h->directory, "beltflow.db.new"), 0);
    helper_golden_put(h, 4);
}

static void an_old_store_is_converted_or_stays(void **state)
{
    helper_store *h = *state;

    helper_golden_put(h, 4);
    // Most calls write one page after the other.
    assert_true(fail_some(h, 9, EIO, open_store, check_old_store) > 100);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_backup_is_whole_or_is_not_there),
        STORE_TEST(tokens_are_those_that_were_acknowledged),
        STORE_TEST(a_file_that_is_replaced_is_the_old_or_the_new_one),
        STORE_TEST(results_have_a_summary_only_where_they_are_complete),
        STORE_TEST(a_store_opens_or_says_why_not),
        STORE_TEST(an_old_store_is_converted_or_stays),
    };
    log_set_level(LOG_LEVEL_ERROR);
    return cmocka_run_group_tests(tests, NULL, NULL);
}

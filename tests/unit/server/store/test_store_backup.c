// Unit tests of copies of a store and of checking one. I1 ... I15 are the invariants of
// server/store/store.h.

#include "server/store/backup.h"

#include "server/store/page_sums.h"
#include "server/store/restore.h"
#include "server/store/store_priv.h"
#include "server/store/tokens.h"
#include "tests/unit/server/helper_store.h"

#include <dirent.h>
#include <fcntl.h>
#include <pthread.h>
#include <sqlite3.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/// The report of a verification.
typedef struct outcome {
    size_t n;        ///< checks
    size_t n_failed; ///< of them, what found something
    char names[400]; ///< of these
} outcome;

static void note(void *context, const char *name, const char *claim, const char *finding)
{
    outcome *o = context;
    size_t n = strlen(o->names);

    assert_true(claim[0] != '\0');
    o->n++;
    if (finding == NULL)
        return;
    assert_true(finding[0] != '\0');
    o->n_failed++;
    snprintf(o->names + n, sizeof o->names - n, "%s ", name);
}

static outcome verify(const char *path)
{
    outcome o = { .n = 0 };
    bool is_sound = false;
    bf_error err = { 0 };

    if (store_verify(path, note, &o, &is_sound, &err) != BF_OK)
        fail_msg("%s", err.text);
    assert_true(is_sound == (o.n_failed == 0));
    assert_true(o.n > 10);
    return o;
}

static void assert_sound(const char *path)
{
    outcome o = verify(path);

    if (o.n_failed > 0)
        fail_msg("%s fails: %s", path, o.names);
}

static void path_in(const helper_store *h, const char *name, char *ret_path, size_t size)
{
    snprintf(ret_path, size, "%s/%s", h->directory, name);
}

// Two runs with all that runs have: one has ended, one is being solved and has a checkpoint.
static void fill(store *s, api_run *ret_ended, api_run *ret_running)
{
    store_batch checkpoint = { .step = 7, .checkpoint = "checkpoint", .n_checkpoint = 10 };

    *ret_ended = helper_start(s);
    helper_append_samples(s, ret_ended->id, 0, 9);
    helper_append_snapshot(s, ret_ended->id, 0);
    *ret_ended = helper_finish(s, ret_ended->id, RUN_SUCCEEDED);
    *ret_running = helper_start(s);
    helper_append_samples(s, ret_running->id, 0, 4);
    helper_append_snapshot(s, ret_running->id, 0);
    helper_append_snapshot(s, ret_running->id, 1);
    checkpoint.run_id = ret_running->id;
    assert_int_equal(helper_store_append(s, &checkpoint, NULL), BF_OK);
}

static size_t count_files(const char *directory)
{
    DIR *opened = opendir(directory);
    size_t n = 0;

    assert_non_null(opened);
    while (readdir(opened) != NULL)
        n++;
    closedir(opened);
    return n;
}

// Open a copy as the store of a new directory and compare what it gives with the original.
static void expect_the_same(store *original, const char *copy, const api_run *record)
{
    helper_store other = { .directory = "/tmp/beltflow-store-XXXXXX" };
    char path[128];
    api_curve curve = { 0 };
    api_array got;
    bf_buffer rho = { 0 };

    assert_non_null(mkdtemp(other.directory));
    path_in(&other, "beltflow.db", path, sizeof path);
    assert_int_equal(rename(copy, path), 0);
    helper_store_open(&other);
    api_run wanted = helper_find(original, record->id),
            found = helper_find(other.store, record->id);
    assert_int_equal(found.state, wanted.state);
    assert_int_equal(found.revision, wanted.revision);
    assert_int_equal(found.last_event, wanted.last_event);
    assert_int_equal(store_read_curve(other.store, record->id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    assert_true(helper_curve_is(&curve, 0, wanted.n_samples));
    api_curve_fini(&curve);
    assert_int_equal(
        store_read_array(other.store, record->id, 0, API_ARRAY_DENSITY, &got, &rho, NULL), BF_OK);
    assert_true(helper_snapshot_is(&rho, 0));
    buffer_fini(&rho);
    helper_store_close(&other);
    helper_store_remove_directory(other.directory);
}

static void a_copy_of_an_open_store_is_a_store(void **state)
{
    helper_store *h = *state;
    char copy[128];
    api_run ended, running;
    struct stat facts;

    fill(h->store, &ended, &running);
    path_in(h, "copy", copy, sizeof copy);
    assert_int_equal(store_backup(h->directory, copy, NULL), BF_OK);
    assert_int_equal(stat(copy, &facts), 0);
    assert_int_equal(facts.st_mode & 0777, 0600);
    assert_sound(copy);
    expect_the_same(h->store, copy, &ended);
    // The original is not affected.
    helper_append_snapshot(h->store, running.id, 2);
    helper_finish(h->store, running.id, RUN_SUCCEEDED);
}

static void a_closed_store_can_be_copied_and_checked(void **state)
{
    helper_store *h = *state;
    char copy[128], original[128];
    api_run ended, running;

    fill(h->store, &ended, &running);
    helper_store_close(h);
    path_in(h, "copy", copy, sizeof copy);
    path_in(h, "beltflow.db", original, sizeof original);
    assert_sound(original);
    assert_int_equal(store_backup(h->directory, copy, NULL), BF_OK);
    size_t n_files = count_files(h->directory);
    assert_sound(copy);
    // A copy is one plain file and needs none beside it.
    assert_int_equal(count_files(h->directory), n_files);
    assert_int_equal(unlink(copy), 0);
}

/// Data common to a writing thread and its test.
typedef struct shared {
    store *store;
    atomic_bool is_over;
    atomic_int n_written;
} shared;

static void *write_runs(void *context)
{
    shared *sh = context;

    while (!atomic_load(&sh->is_over)) {
        api_run record = helper_start(sh->store);
        helper_append_samples(sh->store, record.id, 0, 3);
        helper_append_snapshot(sh->store, record.id, 0);
        helper_finish(sh->store, record.id, RUN_SUCCEEDED);
        atomic_fetch_add(&sh->n_written, 1);
    }
    return NULL;
}

// Each copy is of one moment, in which every run that has ended is whole (the invariants say so).
static void copies_under_load_are_sound(void **state)
{
    helper_store *h = *state;
    shared sh = { .store = h->store };
    char copy[128];
    pthread_t thread;

    api_run first = helper_start(h->store);
    helper_append_samples(h->store, first.id, 0, 3);
    helper_append_snapshot(h->store, first.id, 0);
    first = helper_finish(h->store, first.id, RUN_SUCCEEDED);
    path_in(h, "copy", copy, sizeof copy);
    assert_int_equal(pthread_create(&thread, NULL, write_runs, &sh), 0);
    for (int i = 0; i < 5; i++) {
        int n_before = atomic_load(&sh.n_written);
        while (atomic_load(&sh.n_written) == n_before)
            usleep(1000);
        assert_int_equal(store_backup(h->directory, copy, NULL), BF_OK);
        assert_sound(copy);
        expect_the_same(h->store, copy, &first);
    }
    atomic_store(&sh.is_over, true);
    assert_int_equal(pthread_join(thread, NULL), 0);
}

static void a_file_that_is_there_is_left_alone(void **state)
{
    helper_store *h = *state;
    char copy[128];
    bf_error err = { 0 };
    struct stat facts;

    path_in(h, "copy", copy, sizeof copy);
    close(open(copy, O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
    size_t n_files = count_files(h->directory);
    assert_int_equal(store_backup(h->directory, copy, &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "there already"));
    assert_int_equal(stat(copy, &facts), 0);
    assert_int_equal(facts.st_size, 0);
    assert_int_equal(count_files(h->directory), n_files);
}

static void what_cannot_be_copied_leaves_nothing(void **state)
{
    helper_store *h = *state;
    char path[128];
    bf_error err = { 0 };

    assert_int_equal(store_backup("/nowhere", "/tmp/beltflow-copy", &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "/nowhere/beltflow.db"));
    path_in(h, "missing/copy", path, sizeof path);
    assert_int_equal(store_backup(h->directory, path, &err), BF_ESYSTEM);
    assert_non_null(strstr(err.text, "No such file"));
    // A database, but not ours.
    helper_store_close(h);
    helper_store_sql(h, "PRAGMA application_id = 1");
    path_in(h, "copy", path, sizeof path);
    assert_int_equal(store_backup(h->directory, path, &err), BF_ESYSTEM);
    assert_non_null(strstr(err.text, "is not a store of Beltflow"));
    assert_int_not_equal(access(path, F_OK), 0);
}

// Each of these violates what one check verifies. The store is closed.
static void what_is_broken_is_found(void **state)
{
    static const struct {
        const char *sql, *names;
    } damages[] = {
        { "UPDATE runs SET finished_ms = 0 WHERE state = 2", "I3 " },
        { "DELETE FROM samples WHERE results = 1", "I4 I7 " },
        { "UPDATE snapshots SET item = 5 WHERE results = 2 AND item = 1", "I4 I4 I4 content " },
        { "INSERT INTO chunks (results, kind, item, part, data) VALUES (1, 0, 7, 0, x'')", "I4 " },
        { "DELETE FROM chunks WHERE results = 1", "I4 content " },
        { "DELETE FROM chunks WHERE kind = 1", "I5 " },
        { "UPDATE sqlite_sequence SET seq = 1", "I6 " },
        { "UPDATE runs SET last_event = 1 WHERE state = 2", "I7 " },
        { "DELETE FROM events WHERE type = 4", "I7 I7 " },
        { "INSERT INTO results (number) VALUES (9)", "I9 " },
        { "UPDATE results SET state = 2 WHERE number = 1", "I9 " },
        { "UPDATE runs SET results = 9 WHERE state = 1", "references I4 I4 I5 I7 I9 I10 I16 " },
        { "UPDATE results SET state = 1", "I10 " },
        { "INSERT INTO answers (route, key, digest, id, revision, at_ms, data) "
          "VALUES ('', '', x'00', 'a', 1, 1, 'b')",
          "I11 " },
        { "UPDATE owners SET n_bytes = n_bytes + 1", "I16 " },
        { "UPDATE chunks SET data = zeroblob(length(data)) WHERE results = 1", "content " },
        { "DELETE FROM runs WHERE state = 1", "references I9 " },
    };
    helper_store *h = *state;
    char path[128], copy[128];
    api_run ended, running;

    fill(h->store, &ended, &running);
    path_in(h, "beltflow.db", path, sizeof path);
    path_in(h, "copy", copy, sizeof copy);
    assert_int_equal(store_backup(h->directory, copy, NULL), BF_OK);
    helper_store_close(h);
    for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
        // The intact copy replaces what was damaged before, and is copied again.
        assert_int_equal(rename(copy, path), 0);
        assert_int_equal(store_backup(h->directory, copy, NULL), BF_OK);
        helper_store_sql(h, damages[i].sql);
        outcome o = verify(path);
        if (strcmp(o.names, damages[i].names) != 0)
            fail_msg("%s: found by %s", damages[i].sql, o.names);
    }
    assert_int_equal(unlink(copy), 0);
}

// As a crash leaves it that comes between two steps of a removal.
static void what_is_being_deleted_is_no_fault(void **state)
{
    static const char *const steps[] = {
        "DELETE FROM events WHERE run = 1",
        "DELETE FROM texts WHERE run = 1",
        "DELETE FROM runs WHERE number = 1",
        "UPDATE results SET state = 2 WHERE number = 1",
        "DELETE FROM chunks WHERE results = 1 AND part < 2",
    };
    helper_store *h = *state;
    char path[128];
    api_run ended, running;

    fill(h->store, &ended, &running);
    helper_store_close(h);
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++)
        helper_store_sql(h, steps[i]);
    path_in(h, "beltflow.db", path, sizeof path);
    assert_string_equal(verify(path).names, "");
}

static void a_damaged_page_is_found(void **state)
{
    helper_store *h = *state;
    char path[128];
    api_run ended, running;
    unsigned char noise[4096];

    fill(h->store, &ended, &running);
    helper_store_close(h);
    path_in(h, "beltflow.db", path, sizeof path);
    memset(noise, 0x55, sizeof noise);
    int file = open(path, O_WRONLY | O_CLOEXEC);
    assert_true(file >= 0);
    assert_int_equal(pwrite(file, noise, sizeof noise, 2 * 4096), (ssize_t)sizeof noise);
    close(file);
    outcome o = verify(path);
    assert_non_null(strstr(o.names, "file "));
}

static void only_stores_of_this_version_are_checked(void **state)
{
    helper_store *h = *state;
    char path[128];
    bool is_sound = true;
    bf_error err = { 0 };
    outcome o = { .n = 0 };

    helper_store_close(h);
    helper_store_sql(h, "PRAGMA user_version = 2");
    path_in(h, "beltflow.db", path, sizeof path);
    assert_int_equal(store_verify(path, note, &o, &is_sound, &err), BF_ESYSTEM);
    assert_non_null(strstr(err.text, "version 2"));
    path_in(h, "missing", path, sizeof path);
    assert_int_equal(store_verify(path, note, &o, &is_sound, &err), BF_EINPUT);
    assert_int_equal(o.n, 0);
    assert_true(is_sound);
}

static void count_token(void *context, const tokens_record *token)
{
    (*(size_t *)context)++;
}

static void restore(const char *directory, const char *copy, store_restored *ret_restored)
{
    bf_error err = { 0 };

    if (store_restore(directory, copy, ret_restored, &err) != BF_OK)
        fail_msg("%s", err.text);
}

// Over a store with a log, and into a directory that is not there.
static void a_copy_is_restored_with_its_tokens(void **state)
{
    helper_store *h = *state;
    tokens_record token = { .name = "ada", .owner = "ada", .scopes = API_SCOPE_READ };
    char copy[128], text[API_TOKEN_SIZE], other[160], path[1200];
    store_restored restored;
    api_run ended, running;
    struct stat facts;
    size_t n_tokens = 0;

    fill(h->store, &ended, &running);
    assert_int_equal(tokens_add(h->directory, &token, text, NULL), BF_OK);
    path_in(h, "copy", copy, sizeof copy);
    assert_int_equal(store_backup(h->directory, copy, NULL), BF_OK);
    helper_submit(h->store, "later", 0);
    assert_int_equal(store_restore(h->directory, copy, &restored, NULL), BF_ECONFLICT); // in use
    helper_store_close(h);
    restore(h->directory, copy, &restored);
    assert_true(restored.has_tokens);
    snprintf(path, sizeof path, "%s/beltflow.db", restored.replaced);
    assert_int_equal(access(path, F_OK), 0);
    path_in(h, "beltflow.db", path, sizeof path);
    assert_int_equal(stat(path, &facts), 0);
    assert_int_equal(facts.st_mode & 0777, 0600);
    helper_store_open(h);
    assert_int_equal(helper_find(h->store, ended.id).n_samples, 9);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), 2);
    assert_int_equal(tokens_list(h->directory, count_token, &n_tokens, NULL), BF_OK);
    assert_int_equal(n_tokens, 1);

    snprintf(other, sizeof other, "%s/new/data", h->directory);
    restore(other, copy, &restored);
    assert_string_equal(restored.replaced, "");
    snprintf(path, sizeof path, "%s/beltflow.db", other);
    assert_sound(path);
    snprintf(path, sizeof path, "rm -rf %s/new %s/replaced-*", h->directory, h->directory);
    assert_int_equal(system(path), 0);
}

static void assert_refused(helper_store *h, const char *copy, const char *part)
{
    store_restored restored;
    bf_error err = { 0 };

    assert_int_equal(store_restore(h->directory, copy, &restored, &err), BF_EINPUT);
    if (strstr(err.text, part) == NULL)
        fail_msg("%s", err.text);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), 2);
}

static void what_is_no_sound_copy_is_not_restored(void **state)
{
    helper_store *h = *state;
    char copy[128], log[132];
    api_run ended, running;
    sqlite3 *db = NULL;

    fill(h->store, &ended, &running);
    path_in(h, "copy", copy, sizeof copy);
    assert_int_equal(store_backup(h->directory, copy, NULL), BF_OK);
    helper_store_close(h);
    assert_refused(h, "/nonexistent", "there is no file");
    snprintf(log, sizeof log, "%s-wal", copy);
    FILE *file = fopen(log, "w");
    assert_non_null(file);
    assert_true(fputs("x", file) >= 0 && fclose(file) == 0);
    assert_refused(h, copy, "in use");
    assert_int_equal(unlink(log), 0);
    assert_int_equal(
        sqlite3_open_v2(copy, &db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, STORE__PAGE_SUMS),
        SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, "UPDATE runs SET n_samples = 1", NULL, NULL, NULL),
                     SQLITE_OK);
    assert_refused(h, copy, "damaged: I4");
    assert_int_equal(sqlite3_exec(db, "PRAGMA user_version = 999", NULL, NULL, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    assert_refused(h, copy, "newer Beltflow");
    helper_store_open(h);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_copy_of_an_open_store_is_a_store),
        STORE_TEST(a_closed_store_can_be_copied_and_checked),
        STORE_TEST(copies_under_load_are_sound),
        STORE_TEST(a_file_that_is_there_is_left_alone),
        STORE_TEST(what_cannot_be_copied_leaves_nothing),
        STORE_TEST(what_is_broken_is_found),
        STORE_TEST(what_is_being_deleted_is_no_fault),
        STORE_TEST(a_damaged_page_is_found),
        STORE_TEST(only_stores_of_this_version_are_checked),
        STORE_TEST(a_copy_is_restored_with_its_tokens),
        STORE_TEST(what_is_no_sound_copy_is_not_restored),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

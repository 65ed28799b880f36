// Unit tests of the store: opening, and what is refused. I1 ... I15 are the invariants of
// server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include "server/store/store_priv.h"

#include <dirent.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

// The store that a refused opening leaves alone.
static int poison;

static void expect_refusal(const char *directory, const char *reason)
{
    store_options options = { .directory = directory, .queue_limit = 1 };
    store *s = (store *)(void *)&poison;
    bf_error err = { 0 };

    assert_int_equal(store_open(&options, &s, &err), BF_ESYSTEM);
    assert_ptr_equal(s, &poison);
    assert_int_equal(err.code, BF_ESYSTEM);
    if (strstr(err.text, reason) == NULL)
        fail_msg("\"%s\" does not say \"%s\"", err.text, reason);
}

static void patch(const helper_store *h, off_t at, const void *bytes, size_t n)
{
    char path[128];

    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    int file = open(path, O_RDWR | O_CLOEXEC);
    assert_true(file >= 0);
    assert_int_equal(pwrite(file, bytes, n, at), (ssize_t)n);
    close(file);
}

static mode_t mode_of(const char *directory, const char *name)
{
    char path[192];
    struct stat info;

    snprintf(path, sizeof path, "%s/%s", directory, name);
    assert_int_equal(stat(path, &info), 0);
    return info.st_mode & 0777;
}

static void remove_file(const char *directory, const char *name)
{
    char path[192];

    snprintf(path, sizeof path, "%s/%s", directory, name);
    assert_int_equal(unlink(path), 0);
}

static void what_the_store_creates_is_private(void **state)
{
    helper_store *h = *state;
    char inner[96];
    store *s = NULL;
    store_options options = { .directory = inner, .queue_limit = 1 };

    helper_submit(h->store, "", 0);
    assert_int_equal(mode_of(h->directory, "beltflow.db"), 0600);
    assert_int_equal(mode_of(h->directory, "beltflow.db-wal"), 0600);
    assert_int_equal(mode_of(h->directory, "beltflow.lock"), 0600);
    snprintf(inner, sizeof inner, "%s-inner", h->directory);
    assert_int_equal(store_open(&options, &s, NULL), BF_OK);
    assert_int_equal(mode_of(inner, "."), 0700);
    store_close(s);
    remove_file(inner, "beltflow.db");
    remove_file(inner, "beltflow.lock");
    assert_int_equal(mode_of(inner, "beltflow.reserve"), 0600);
    remove_file(inner, "beltflow.reserve");
    assert_int_equal(rmdir(inner), 0);
}

static void a_second_daemon_is_refused(void **state)
{
    helper_store *h = *state;
    char pid[32];

    snprintf(pid, sizeof pid, "process %ld", (long)getpid());
    expect_refusal(h->directory, "in use by another daemon");
    expect_refusal(h->directory, pid);
    helper_submit(h->store, "", 0);
    // Accepted when the first one has closed.
    helper_store_close(h);
    helper_store_open(h);
}

static void a_newer_store_is_refused_and_left_alone(void **state)
{
    helper_store *h = *state;
    char ours[64];
    api_run record = helper_submit(h->store, "", 0);

    helper_store_close(h);
    helper_store_sql(h, "PRAGMA user_version = 99");
    expect_refusal(h->directory, "newer Beltflow");
    snprintf(ours, sizeof ours, "PRAGMA user_version = %d", store__version);
    helper_store_sql(h, ours);
    helper_store_open(h);
    assert_int_equal(helper_find(h->store, record.id).revision, record.revision);
}

static void a_database_of_another_program_is_refused(void **state)
{
    helper_store *h = *state;

    helper_store_close(h);
    helper_store_sql(h, "PRAGMA application_id = 16909060");
    expect_refusal(h->directory, "is not a store of Beltflow");
}

static void a_damaged_file_is_refused(void **state)
{
    helper_store *h = *state;
    static const char text[] = "This is a letter, not a database.";

    helper_store_close(h);
    patch(h, 0, text, sizeof text);
    expect_refusal(h->directory, "damaged");
}

// The page that holds the table of tables, with a type of page that does not exist.
static void a_damaged_page_is_refused(void **state)
{
    helper_store *h = *state;
    static const unsigned char wrong = 0x77;

    helper_store_close(h);
    patch(h, 100, &wrong, 1);
    expect_refusal(h->directory, "damaged");
}

typedef struct content {
    char bytes[1 << 20];
    size_t n;
} content;

static void read_whole(const char *path, content *ret)
{
    FILE *file = fopen(path, "rbe");

    assert_non_null(file);
    ret->n = fread(ret->bytes, 1, sizeof ret->bytes, file);
    assert_true(ret->n < sizeof ret->bytes);
    assert_int_equal(fclose(file), 0);
}

static void write_whole(const char *path, const content *c)
{
    FILE *file = fopen(path, "wbe");

    assert_non_null(file);
    assert_int_equal(fwrite(c->bytes, 1, c->n, file), c->n);
    assert_int_equal(fclose(file), 0);
}

// As after a kill: what is in the log is not in the database yet. I1.
static void a_log_without_its_database_is_left_alone(void **state)
{
    static content database, log, now;
    helper_store *h = *state;
    char path[128], path_of_log[128];

    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    snprintf(path_of_log, sizeof path_of_log, "%s/beltflow.db-wal", h->directory);
    api_run record = helper_submit(h->store, "", 0);
    read_whole(path, &database);
    read_whole(path_of_log, &log);
    helper_store_close(h);
    write_whole(path_of_log, &log);
    assert_int_equal(truncate(path, 0), 0);
    expect_refusal(h->directory, "beltflow.db is missing or empty");
    assert_int_equal(unlink(path), 0);
    expect_refusal(h->directory, "beltflow.db is missing or empty");
    assert_int_not_equal(access(path, F_OK), 0);
    read_whole(path_of_log, &now);
    assert_int_equal(now.n, log.n);
    assert_memory_equal(now.bytes, log.bytes, log.n);
    // With the database back everything is there.
    write_whole(path, &database);
    helper_store_open(h);
    assert_int_equal(helper_find(h->store, record.id).revision, record.revision);
}

static void a_directory_is_made_with_those_above_it(void **state)
{
    helper_store *h = *state;
    char path[128];
    store_options options = { .directory = path, .queue_limit = 1 };
    store *s = NULL;
    struct stat facts;

    snprintf(path, sizeof path, "%s/missing/inner", h->directory);
    assert_int_equal(store_open(&options, &s, NULL), BF_OK);
    store_close(s);
    helper_store_remove_directory(path);
    snprintf(path, sizeof path, "%s/missing", h->directory);
    assert_int_equal(stat(path, &facts), 0);
    assert_int_equal(facts.st_mode & 0777, 0700);
    helper_store_remove_directory(path);
}

static void a_directory_that_cannot_be_made_is_refused(void **state)
{
    helper_store *h = *state;
    char path[2000];

    snprintf(path, sizeof path, "%s/beltflow.db/inner", h->directory);
    expect_refusal(path, "cannot make the data directory");
    snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    expect_refusal(path, "Not a directory");
    memset(path, 'x', sizeof path - 1);
    path[sizeof path - 1] = '\0';
    expect_refusal(path, "too long");
}

// Flags of an open file of this process, from /proc (octal, O_CLOEXEC among them).
static unsigned long flags_of(const char *descriptor)
{
    char path[300], line[128];
    unsigned long flags = 0;

    snprintf(path, sizeof path, "/proc/self/fdinfo/%s", descriptor);
    FILE *file = fopen(path, "re");
    assert_non_null(file);
    while (fgets(line, sizeof line, file) != NULL)
        if (strncmp(line, "flags:", 6) == 0)
            flags = strtoul(line + 6, NULL, 8);
    fclose(file);
    return flags;
}

static bool is_file_of(const char *descriptor, const char *end)
{
    char path[300], target[300];

    snprintf(path, sizeof path, "/proc/self/fd/%s", descriptor);
    ssize_t n = readlink(path, target, sizeof target - 1);
    if (n < 0)
        return false;
    target[n] = '\0';
    size_t length = strlen(end);
    return (size_t)n >= length && strcmp(target + n - length, end) == 0;
}

// I2: one descriptor of the database can write, the others only read; children get none of them.
static void one_connection_can_write(void **state)
{
    helper_store *h = *state;
    int n_writers = 0, n_readers = 0;

    helper_submit(h->store, "", 0);
    helper_find(h->store, helper_submit(h->store, "", 0).id);
    DIR *directory = opendir("/proc/self/fd");
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory)) != NULL;) {
        bool is_database = is_file_of(entry->d_name, "/beltflow.db");
        bool is_ours = is_database || is_file_of(entry->d_name, "/beltflow.lock") ||
                       is_file_of(entry->d_name, "/beltflow.db-wal");
        unsigned long flags = is_ours ? flags_of(entry->d_name) : O_CLOEXEC;
        assert_true((flags & O_CLOEXEC) != 0);
        n_writers += is_database && (flags & O_ACCMODE) == O_RDWR;
        n_readers += is_database && (flags & O_ACCMODE) == O_RDONLY;
    }
    closedir(directory);
    assert_int_equal(n_writers, 1);
    assert_int_equal(n_readers, 1);
}

static int setting_of(store__connection *c, const char *pragma)
{
    sqlite3_stmt *statement = NULL;

    assert_int_equal(sqlite3_prepare_v2(c->db, pragma, -1, &statement, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(statement), SQLITE_ROW);
    int value = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
    return value;
}

// I1: FULL (2) syncs the log at each commit. I2: a reader neither writes nor copies the log.
static void commits_are_synced_and_readers_only_read(void **state)
{
    store *s = ((helper_store *)*state)->store;
    store__connection *reader = store__acquire_reader(&s->pool);

    assert_int_equal(setting_of(&s->writer, "PRAGMA synchronous"), 2);
    assert_int_equal(setting_of(&s->writer, "PRAGMA foreign_keys"), 1);
    assert_true(setting_of(&s->writer, "PRAGMA journal_size_limit") > 0);
    assert_int_equal(setting_of(reader, "PRAGMA wal_autocheckpoint"), 0);
    assert_int_equal(sqlite3_db_readonly(reader->db, "main"), 1);
    store__release_reader(&s->pool, reader);
}

static void closing_leaves_one_file_and_no_log(void **state)
{
    helper_store *h = *state;
    char path[128];

    helper_submit(h->store, "", 0);
    helper_store_close(h);
    snprintf(path, sizeof path, "%s/beltflow.db-wal", h->directory);
    assert_int_not_equal(access(path, F_OK), 0);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), 1);
    assert_null(store_close(NULL));
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(what_the_store_creates_is_private),
        STORE_TEST(a_second_daemon_is_refused),
        STORE_TEST(a_newer_store_is_refused_and_left_alone),
        STORE_TEST(a_database_of_another_program_is_refused),
        STORE_TEST(a_damaged_file_is_refused),
        STORE_TEST(a_damaged_page_is_refused),
        STORE_TEST(a_log_without_its_database_is_left_alone),
        STORE_TEST(a_directory_is_made_with_those_above_it),
        STORE_TEST(a_directory_that_cannot_be_made_is_refused),
        STORE_TEST(one_connection_can_write),
        STORE_TEST(commits_are_synced_and_readers_only_read),
        STORE_TEST(closing_leaves_one_file_and_no_log),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Unit tests of stores whose pages have no checksums: the one that a daemon of version 4 wrote.

#include "tests/unit/server/helper_golden.h"

#include "server/base/metrics.h"
#include "server/store/backup.h"
#include "tests/unit/helper_cmocka.h"

#include <sqlite3.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    RUNS = 6,
    SUM_BYTES = 8,
    RESERVED_AT = 20,
    INCREMENTAL = 2
}; // of the golden store; of SQLite's header

static const char *path_in(const helper_store *h, const char *name)
{
    static char path[128];

    (void)snprintf(path, sizeof path, "%s/%s", h->directory, name);
    return path;
}

// How many bytes at the end of each page a database reserves, as its file says (sqlite.org/fileformat.html, 1.3.4).
static int count_reserved(const char *path)
{
    unsigned char header[100];
    FILE *file = fopen(path, "re");

    assert_non_null(file);
    assert_int_equal(fread(header, 1, sizeof header, file), sizeof header);
    assert_int_equal(fclose(file), 0);
    return header[RESERVED_AT];
}

static void assert_checked(const char *path)
{
    assert_int_equal(count_reserved(path), SUM_BYTES);
    helper_store_verify_file(path);
}

static void write_file(const char *path, const char *text)
{
    FILE *file = fopen(path, "we");

    assert_non_null(file);
    assert_true(fputs(text, file) >= 0 && fclose(file) == 0);
}

// What is left of a process that was killed meanwhile is in nobody's way.
static void a_start_gives_checksums_to_a_store_without(void **state)
{
    helper_store *h = *state;
    struct stat info;

    helper_golden_put(h, 4);
    assert_int_equal(count_reserved(path_in(h, "beltflow.db")), 0);
    write_file(path_in(h, "beltflow.db.new"), "half a database");
    helper_store_open(h);
    assert_int_equal(metrics_value(METRICS_STORE_SUMS, 0), 1);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), RUNS);
    assert_int_equal(helper_store_sql(h, "PRAGMA auto_vacuum"), INCREMENTAL);
    assert_int_not_equal(access(path_in(h, "beltflow.db.new"), F_OK), 0);
    helper_store_close(h);
    assert_checked(path_in(h, "beltflow.db"));
    assert_int_equal(stat(path_in(h, "beltflow.db"), &info), 0);
    assert_int_equal(info.st_mode & 0777, 0600);
}

// The log that the reader holds must not meet a new database.
static void a_store_that_another_program_reads_stays_as_it_is(void **state)
{
    helper_store *h = *state;
    sqlite3 *db = NULL;

    helper_golden_put(h, 4);
    assert_int_equal(helper_store_sql(h, "PRAGMA journal_mode = WAL"), 0);
    assert_int_equal(sqlite3_open(path_in(h, "beltflow.db"), &db), SQLITE_OK);
    assert_int_equal(sqlite3_exec(db, "BEGIN; SELECT count(*) FROM runs", NULL, NULL, NULL),
                     SQLITE_OK);
    helper_store_open(h);
    assert_int_equal(metrics_value(METRICS_STORE_SUMS, 0), 0);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM runs"), RUNS);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    // Its copy has them all the same.
    assert_int_equal(store_backup(h->directory, path_in(h, "copy"), NULL), BF_OK);
    assert_checked(path_in(h, "copy"));
    helper_store_close(h);
    assert_int_equal(count_reserved(path_in(h, "beltflow.db")), 0);
    helper_store_open(h);
    helper_store_close(h);
    assert_checked(path_in(h, "beltflow.db"));
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(a_start_gives_checksums_to_a_store_without),
        STORE_TEST(a_store_that_another_program_reads_stays_as_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

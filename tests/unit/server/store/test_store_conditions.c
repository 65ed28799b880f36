// The SQL function by which lists are searched: how much one statement may read.

#include "api/run_list.h"
#include "api/scenario/condition.h"
#include "server/store/conditions.h"
#include "server/store/connection.h"
#include "tests/unit/helper_cmocka.h"

#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

// What comes of a statement that reads n documents of a length, which are no JSON and so read fast.
static int read_documents(sqlite3 *db, int n, size_t length)
{
    static const char sql[] =
        "WITH RECURSIVE number (i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM number WHERE i < ?3) "
        "SELECT count(*) FROM number WHERE conditions_hold(?1, substr(?2, i * 0), '')";
    api_conditions conditions;
    sqlite3_stmt *statement;
    char *text = malloc(length);

    assert_non_null(text);
    memset(text, 'x', length);
    assert_int_equal(condition_list_read("duration_s=60", &conditions, NULL), BF_OK);
    assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &statement, NULL), SQLITE_OK);
    sqlite3_bind_blob(statement, 1, &conditions, sizeof conditions, SQLITE_STATIC);
    sqlite3_bind_text(statement, 2, text, (int)length, SQLITE_STATIC);
    sqlite3_bind_int(statement, 3, n);
    const int code = sqlite3_step(statement);
    sqlite3_finalize(statement);
    free(text);
    return code;
}

// The last of four quarters is still read, one byte more is not; the next statement begins anew.
static void a_statement_reads_documents_up_to_a_limit(void **state)
{
    const size_t quarter = API_LIST_DOCUMENT_BYTES / 4;
    sqlite3 *db;
    bf_error err;

    assert_int_equal(sqlite3_open(":memory:", &db), SQLITE_OK);
    assert_int_equal(store__add_conditions(db), SQLITE_OK);
    assert_int_equal(read_documents(db, 4, quarter), SQLITE_ROW);
    assert_int_equal(read_documents(db, 4, quarter + 1), SQLITE_TOOBIG);
    assert_int_equal(store__fail(db, SQLITE_TOOBIG, &err), BF_ELIMIT);
    assert_non_null(strstr(err.text, "more than 64 MiB"));
    assert_int_equal(read_documents(db, 4, quarter), SQLITE_ROW);
    sqlite3_close(db);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_statement_reads_documents_up_to_a_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

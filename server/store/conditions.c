#include "server/store/conditions.h"

#include "api/scenario/condition.h"
#include "core/base/check.h"

#include <sqlite3.h>
#include <string.h>

enum { DOCUMENTS_MAX = 2 }; // a run's scenario and its key figures

static void conditions_hold_sql(sqlite3_context *context, int n, sqlite3_value **values)
{
    const char *documents[DOCUMENTS_MAX];
    size_t lengths[DOCUMENTS_MAX];
    const size_t n_documents = (size_t)n - 1;
    api_conditions conditions;
    bool holds = false;

    BF_CHECK(n_documents <= DOCUMENTS_MAX &&
             (size_t)sqlite3_value_bytes(values[0]) == sizeof conditions);
    memcpy(&conditions, sqlite3_value_blob(values[0]), sizeof conditions); // may be unaligned there
    for (size_t d = 0; d < n_documents; d++) {
        const void *text = sqlite3_value_text(values[d + 1]);
        documents[d] = text == NULL ? "" : text;
        lengths[d] = (size_t)sqlite3_value_bytes(values[d + 1]);
    }
    if (condition_list_hold(&conditions, documents, lengths, n_documents, &holds, NULL) == BF_OK)
        sqlite3_result_int(context, holds);
    else
        sqlite3_result_error_nomem(context);
}

int store__add_conditions(struct sqlite3 *db)
{
    return sqlite3_create_function_v2(db, "conditions_hold", DOCUMENTS_MAX + 1,
                                      SQLITE_UTF8 | SQLITE_DETERMINISTIC, NULL, conditions_hold_sql,
                                      NULL, NULL, NULL);
}

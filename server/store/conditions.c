#include "server/store/conditions.h"

#include "api/scenario/condition.h"
#include "core/base/check.h"

#include <sqlite3.h>
#include <string.h>

enum { N_DOCUMENTS = 2 }; // a run's scenario and its key figures

static const char too_much[] =
    "the scenarios of the runs that are searched by conditions have more "
    "than 64 MiB: narrow the list by its other filters";
_Static_assert(API_LIST_DOCUMENT_BYTES == 64 << 20, "the text says it");

// What a statement searches by, and how many bytes of documents it may still read.
typedef struct search {
    api_conditions conditions;
    size_t n_left;
} search;

// That of the statement, which SQLite keeps beside the first argument until it ends. NULL: there is no memory.
static search *search_of(sqlite3_context *context, sqlite3_value *conditions)
{
    search *s = sqlite3_get_auxdata(context, 0);

    if (s != NULL)
        return s;
    BF_CHECK((size_t)sqlite3_value_bytes(conditions) == sizeof s->conditions);
    s = sqlite3_malloc64(sizeof *s);
    if (s == NULL)
        return NULL;
    memcpy(&s->conditions, sqlite3_value_blob(conditions), sizeof s->conditions);
    s->n_left = API_LIST_DOCUMENT_BYTES;
    sqlite3_set_auxdata(context, 0, s, sqlite3_free);
    return sqlite3_get_auxdata(context, 0);
}

static void conditions_hold_sql(sqlite3_context *context, int n, sqlite3_value **values)
{
    const char *documents[N_DOCUMENTS];
    size_t lengths[N_DOCUMENTS], n_bytes = 0;
    bool holds = false;

    (void)n;
    search *s = search_of(context, values[0]);
    for (size_t d = 0; d < N_DOCUMENTS; d++) {
        const void *text = sqlite3_value_text(values[d + 1]);
        documents[d] = text == NULL ? "" : text;
        lengths[d] = text == NULL ? 0 : (size_t)sqlite3_value_bytes(values[d + 1]);
        n_bytes += lengths[d];
    }
    if (s != NULL && n_bytes > s->n_left) {
        sqlite3_result_error(context, too_much, -1);
        sqlite3_result_error_code(context, SQLITE_TOOBIG);
    } else if (s != NULL && condition_list_hold(&s->conditions, documents, lengths, N_DOCUMENTS,
                                                &holds, NULL) == BF_OK) {
        s->n_left -= n_bytes;
        sqlite3_result_int(context, holds);
    } else {
        sqlite3_result_error_nomem(context);
    }
}

int store__add_conditions(struct sqlite3 *db)
{
    return sqlite3_create_function_v2(db, "conditions_hold", N_DOCUMENTS + 1,
                                      SQLITE_UTF8 | SQLITE_DETERMINISTIC | SQLITE_DIRECTONLY, NULL,
                                      conditions_hold_sql, NULL, NULL, NULL);
}

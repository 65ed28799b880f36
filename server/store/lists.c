// Lists of runs: a page in an order, narrowed by filters, and how many there are.

#include "server/store/store_priv.h"

#include "core/base/memory.h"

#include <inttypes.h>
#include <math.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_sorted(const api_list_query *query)
{
    return query->sort.by != API_SORT_CREATED || query->sort.is_rising;
}

/// What a page is read by: its rows, and where they end if it is narrowed by what its index does not have.
typedef struct list_way {
    store__sql page;
    store__sql oldest;
    bool is_narrowed;
} list_way;

static list_way choose_list(const api_list_query *query)
{
    const bool has_owner = query->owner[0] != '\0', has_label = query->label[0] != '\0';
    const bool has_state = query->state >= 0, has_model = query->model >= 0;

    if (is_sorted(query))
        return (list_way){ query->sort.is_rising ? STORE__SQL_LIST_RISING : STORE__SQL_LIST_FALLING,
                           STORE__SQL_COUNT, false };
    if (query->search[0] != '\0' || query->line[0] != '\0' || query->is_starred ||
        query->conditions.n > 0)
        return (list_way){ STORE__SQL_LIST_FOUND, STORE__SQL_COUNT, false };
    if (has_state && query->state < RUN_SUCCEEDED) // these are few
        return (list_way){ STORE__SQL_LIST_OPEN, STORE__SQL_COUNT, false };
    if (has_label)
        return (list_way){ STORE__SQL_LIST_LABEL, STORE__SQL_LAST_LABEL,
                           has_owner || has_state || has_model };
    if (has_owner)
        return (list_way){ STORE__SQL_LIST_OWNER, STORE__SQL_LAST_OWNER, has_state || has_model };
    if (has_state)
        return (list_way){ STORE__SQL_LIST_ENDED, STORE__SQL_LAST_ENDED, has_model };
    return (list_way){ STORE__SQL_LIST_ALL, STORE__SQL_LAST_ALL, has_model };
}

// What ids of the times asked for lie between; used until the statement ends.
typedef struct id_bounds {
    char from[API_ID_SIZE];
    char before[API_ID_SIZE];
} id_bounds;

// An id begins with its time (run_id.h); the time alone is less than all of its ids, and "~" is greater than any id.
static id_bounds bounds_of(const api_list_query *query)
{
    const uint64_t from = (uint64_t)query->from_ms, before = (uint64_t)query->before_ms;
    id_bounds bounds = { .before = "~" };

    (void)snprintf(bounds.from, API_ID_SIZE, "%08" PRIx64 "-%04" PRIx64, from >> 16, from & 0xffff);
    if (before > 0)
        (void)snprintf(bounds.before, API_ID_SIZE, "%08" PRIx64 "-%04" PRIx64, before >> 16,
                       before & 0xffff);
    return bounds;
}

// How many parameters a statement has, of those of sql_lists.h; and places of two of them.
enum { N_OLDEST = 7, N_WHOLE = 9, N_PAGE = 10, N_FOUND = 14, N_SORTED = 17 };
enum { HOW_MANY = 1, FROM = 9 };

// The parameters, and the path of a key in the figures; used until the statement ends.
typedef struct list_values {
    store__value all[N_SORTED];
    char path[API_SORT_FIGURE_SIZE + 2];
} list_values;

// The key behind which a page of another order begins; not finite: the run there has none.
static store__value key_of(const api_list_query *query)
{
    const char *key = query->before_key;

    if (query->sort.by == API_SORT_CREATED)
        return (store__value)TEXT(query->before);
    if (query->sort.by == API_SORT_NAME || query->sort.by == API_SORT_LABEL)
        if (*key != '\0')
            return (store__value)BLOB(key, strlen(key));
    return (store__value)REAL(*key == '\0' ? (double)NAN : strtod(key, NULL));
}

static void fill_values(const api_list_query *query, const id_bounds *bounds, list_values *v)
{
    const bool has_conditions = query->conditions.n > 0;
    const char *before = store__before(query->before);

    // The cursor of another order says nothing of ids.
    if (!is_sorted(query) && strcmp(bounds->before, before) < 0)
        before = bounds->before;
    (void)snprintf(v->path, sizeof v->path, "$.%s", query->sort.figure);
    const store__value all[N_SORTED] = {
        TEXT(before),
        INTEGER(query->limit + 1),
        INTEGER(query->model),
        INTEGER(query->state),
        TEXT(query->label),
        TEXT(query->owner),
        TEXT(query->study),
        TEXT(query->search),
        INTEGER((has_conditions ? API_LIST_DOCUMENTS : API_LIST_NEWEST) - 1),
        TEXT(bounds->from),
        TEXT(bounds->before),
        INTEGER(query->is_starred),
        TEXT(query->line),
        BLOB(&query->conditions, has_conditions ? sizeof query->conditions : 0),
        INTEGER(query->sort.by),
        TEXT(v->path),
        key_of(query),
    };
    memcpy(v->all, all, sizeof all);
}

// The key of the present row, as text.
static void take_key(const store__query *q, const api_list_query *query, api_run_list *list)
{
    const int column = sqlite3_column_count(q->statement) - 1;
    const size_t size = sizeof list->last_key;

    list->last_key[0] = '\0';
    if (!is_sorted(query) || query->sort.by == API_SORT_CREATED)
        return;
    switch (sqlite3_column_type(q->statement, column)) {
    case SQLITE_INTEGER:
        (void)snprintf(list->last_key, size, "%lld", sqlite3_column_int64(q->statement, column));
        break;
    case SQLITE_FLOAT:
        (void)snprintf(list->last_key, size, "%.17g", sqlite3_column_double(q->statement, column));
        break;
    default:
        store__column_text(q, column, list->last_key, size);
    }
}

static bf_status read_page(store__connection *reader, const api_list_query *query,
                           api_run_list *list, bf_error *err)
{
    const list_way way = choose_list(query);
    const id_bounds bounds = bounds_of(query);
    const size_t n = is_sorted(query)                    ? N_SORTED
                     : way.page == STORE__SQL_LIST_FOUND ? N_FOUND
                                                         : N_PAGE;
    char oldest[API_ID_SIZE] = "";
    bool has_row = false;
    list_values v;
    bf_status status = BF_OK;

    fill_values(query, &bounds, &v);
    if (way.is_narrowed) {
        // Where the page ends, so that it takes a bounded time.
        const store__value how_many = v.all[HOW_MANY];
        v.all[HOW_MANY] = (store__value)INTEGER(API_LIST_LOOKS - 1);
        status = store__find_with(reader, way.oldest, &store__id_record, oldest, &has_row, err,
                                  v.all, N_OLDEST);
        v.all[HOW_MANY] = how_many;
    }
    if (strcmp(oldest, bounds.from) > 0)
        v.all[FROM] = (store__value)TEXT(oldest);
    store__query q = store__start_with(reader, way.page, v.all, n);
    while (!list->has_more && store__next(&q, &status, err)) {
        store__row row;
        // One row more than the page holds is asked for: if it comes, there are more.
        list->has_more = list->n == query->limit;
        status = store__read(&q, &store__run_record, &row, err);
        if (status != BF_OK || list->has_more)
            break;
        list->runs[list->n++] = row.run;
        memcpy(list->last_id, row.run.id, sizeof list->last_id);
        take_key(&q, query, list);
    }
    store__end(&q);
    if (status == BF_OK && !list->has_more && strcmp(oldest, bounds.from) > 0) {
        list->has_more = true;
        memcpy(list->last_id, oldest, sizeof list->last_id);
    }
    return status;
}

static bf_status count_list(store__connection *reader, const api_list_query *query,
                            api_run_list *list, bf_error *err)
{
    const bool is_whole = query->state < 0 && query->model < 0 && query->label[0] == '\0' &&
                          query->owner[0] == '\0' && query->search[0] == '\0' &&
                          query->line[0] == '\0' && query->from_ms == 0 && query->before_ms == 0 &&
                          !query->is_starred && query->conditions.n == 0;
    const id_bounds bounds = bounds_of(query);
    list_values v;
    int64_t n = 0;

    fill_values(query, &bounds, &v);
    const bf_status status =
        store__find_number_with(reader, is_whole ? STORE__SQL_COUNT_LISTED : STORE__SQL_COUNT_FOUND,
                                &n, err, v.all, is_whole ? N_WHOLE : N_FOUND);
    list->has_total = status == BF_OK;
    list->total = (uint64_t)n;
    return status;
}

bf_status store_list(store *s, const api_list_query *query, api_run_list *ret_list, bf_error *err)
{
    BF_TRY(store__check_page(query->limit, "runs", err));
    api_run_list *list = memory_alloc(1, sizeof *list);
    if (list == NULL)
        return bf_fail_memory(err);
    store__connection *reader = store__acquire_reader(&s->pool);
    bf_status status = read_page(reader, query, list, err);
    if (status == BF_OK && query->counts)
        status = count_list(reader, query, list, err);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        *ret_list = *list;
    memory_free(list);
    return status;
}

// Lists of runs: a page in an order, narrowed by filters, and how many there are.

#include "server/store/store_priv.h"

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

static void bind_filters(store__query *q, const api_list_query *query, const id_bounds *bounds,
                         int64_t n)
{
    const char *before = query->before[0] == '\0' ? "~" : query->before;

    // The cursor of another order says nothing of ids.
    if (!is_sorted(query) && strcmp(bounds->before, before) < 0)
        before = bounds->before;
    store__bind(q, TEXT(before));
    store__bind(q, INTEGER(n));
    store__bind(q, INTEGER(query->model));
    store__bind(q, INTEGER(query->state));
    store__bind(q, TEXT(query->label));
    store__bind(q, TEXT(query->owner));
    store__bind(q, TEXT(query->study));
}

static void bind_search(store__query *q, const api_list_query *query, const id_bounds *bounds)
{
    const bool has_conditions = query->conditions.n > 0;

    store__bind(q, TEXT(query->search));
    store__bind(q, INTEGER((has_conditions ? API_LIST_DOCUMENTS : API_LIST_NEWEST) - 1));
    store__bind(q, TEXT(bounds->from));
    store__bind(q, TEXT(bounds->before));
    store__bind(q, INTEGER(query->is_starred));
    store__bind(q, TEXT(query->line));
    store__bind(q, BLOB(&query->conditions, has_conditions ? sizeof query->conditions : 0));
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

// One row more than the page holds is asked for: if it comes, there are more.
static bf_status take_rows(store__query *q, const api_list_query *query, api_run_list *list,
                           bf_error *err)
{
    bf_status status = BF_OK;
    store__row row;

    while (!list->has_more && store__next(q, &status, err)) {
        status = store__read_row(q, &row, err);
        if (status != BF_OK)
            break;
        list->has_more = list->n == query->limit;
        if (list->has_more)
            break;
        list->runs[list->n++] = row.run;
        memcpy(list->last_id, row.run.id, sizeof list->last_id);
        take_key(q, query, list);
    }
    return status;
}

// Where a page that is narrowed ends, so that it takes a bounded time; "": with the list.
static bf_status find_oldest(store__connection *reader, const api_list_query *query,
                             const id_bounds *bounds, store__sql sql, char ret_oldest[API_ID_SIZE],
                             bf_error *err)
{
    store__query q = store__begin(reader, sql);
    bind_filters(&q, query, bounds, API_LIST_LOOKS - 1);
    bf_status status = BF_OK;
    if (store__next(&q, &status, err))
        store__column_text(&q, 0, ret_oldest, API_ID_SIZE);
    store__end(&q);
    return status;
}

static bf_status read_page(store__connection *reader, const api_list_query *query,
                           api_run_list *list, bf_error *err)
{
    const list_way way = choose_list(query);
    const id_bounds bounds = bounds_of(query);
    const bool is_found = is_sorted(query) || way.page == STORE__SQL_LIST_FOUND;
    char path[API_SORT_FIGURE_SIZE + 2], oldest[API_ID_SIZE] = "";
    bf_status status = BF_OK;

    if (way.is_narrowed)
        status = find_oldest(reader, query, &bounds, way.oldest, oldest, err);
    if (status != BF_OK)
        return status;
    store__query q = store__begin(reader, way.page);
    bind_filters(&q, query, &bounds, (int64_t)query->limit + 1);
    if (is_found)
        bind_search(&q, query, &bounds);
    else
        store__bind(&q, TEXT(strcmp(oldest, bounds.from) > 0 ? oldest : bounds.from));
    if (is_sorted(query)) {
        // The path of the key in the figures, and the key behind which the page begins. path is used until the statement ends.
        const char *key = query->before_key;
        (void)snprintf(path, API_SORT_FIGURE_SIZE + 2, "$.%s", query->sort.figure);
        store__bind(&q, INTEGER(query->sort.by));
        store__bind(&q, TEXT(path));
        if (query->sort.by == API_SORT_CREATED)
            store__bind(&q, TEXT(query->before));
        else if (*key == '\0')
            store__bind(&q, REAL((double)NAN));
        else if (query->sort.by == API_SORT_NAME || query->sort.by == API_SORT_LABEL)
            store__bind(&q, BLOB(key, strlen(key)));
        else
            store__bind(&q, REAL(strtod(key, NULL)));
    }
    status = take_rows(&q, query, list, err);
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

    store__query q =
        store__begin(reader, is_whole ? STORE__SQL_COUNT_LISTED : STORE__SQL_COUNT_FOUND);
    if (is_whole) {
        store__bind(&q, TEXT(query->study));
        store__bind(&q, INTEGER(API_LIST_NEWEST));
    } else {
        bind_filters(&q, query, &bounds, 0);
        bind_search(&q, query, &bounds);
    }
    bf_status status = BF_OK;
    const bool has_row = store__next(&q, &status, err);
    list->has_total = has_row;
    list->total = has_row ? (uint64_t)sqlite3_column_int64(q.statement, 0) : 0;
    store__end(&q);
    return status;
}

static bf_status read_list(store__connection *reader, const void *of, void *to, bf_error *err)
{
    const api_list_query *query = of;
    api_run_list *list = to;
    const bf_status status = read_page(reader, query, list, err);

    return status == BF_OK && query->counts ? count_list(reader, query, list, err) : status;
}

bf_status store_list(store *s, const api_list_query *query, api_run_list *ret_list, bf_error *err)
{
    return store__read_page(&s->pool, query->limit, "runs", read_list, query, ret_list,
                            sizeof *ret_list, err);
}

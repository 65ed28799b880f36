#include "server/store/columns.h"

#include "core/base/check.h"
#include "core/base/memory.h"

static bf_status check_id(const store__query *q, void *of, bool is_whole, bf_error *err)
{
    const char *id = of;

    (void)q;
    return is_whole ? BF_OK : bf_fail(err, BF_ECORRUPT, "", "the stored id %.40s is damaged", id);
}

static const store__column id_column[] = { { STORE__COLUMN_ID, 0, API_ID_SIZE } };
const store__record store__id_record = RECORD(id_column, char[API_ID_SIZE], check_id);

const char *store__code_word(bf_status code)
{
    return code == BF_OK ? "" : bf_status_word(code);
}

static bf_status find_code(const char *word)
{
    for (int code = BF_OK + 1; code < BF_STATUS_COUNT; code++)
        if (strcmp(word, bf_status_word((bf_status)code)) == 0)
            return (bf_status)code;
    return BF_OK;
}

static void read_integer(int64_t value, size_t size, void *to)
{
    const uint32_t low = (uint32_t)value;

    BF_CHECK(size == sizeof(bool) || size == sizeof low || size == sizeof value);
    if (size == sizeof(bool))
        *(bool *)to = value != 0;
    else if (size == sizeof low)
        memcpy(to, &low, sizeof low);
    else
        memcpy(to, &value, sizeof value);
}

bf_status store__read(const store__query *q, const store__record *record, void *row, bf_error *err)
{
    bool is_whole = true;
    char word[32];

    memset(row, 0, record->size);
    for (size_t k = 0; k < record->n; k++) {
        const store__column *column = &record->columns[k];
        const int at = (int)k;
        void *to = (char *)row + column->offset;
        switch (column->kind) {
        case STORE__COLUMN_INTEGER:
            read_integer(sqlite3_column_int64(q->statement, at), column->size, to);
            break;
        case STORE__COLUMN_REAL:
            *(double *)to = store__column_real(q, at);
            break;
        case STORE__COLUMN_ID:
        case STORE__COLUMN_TEXT:
            store__column_text(q, at, to, column->size);
            if (column->kind == STORE__COLUMN_ID)
                is_whole = is_whole && strlen(to) == API_ID_SIZE - 1 &&
                           sqlite3_column_bytes(q->statement, at) == API_ID_SIZE - 1;
            break;
        case STORE__COLUMN_CODE:
            store__column_text(q, at, word, sizeof word);
            *(bf_status *)to = find_code(word);
            break;
        }
    }
    return record->check == NULL ? BF_OK : record->check(q, row, is_whole, err);
}

bf_status store__find_with(store__connection *c, store__sql sql, const store__record *record,
                           void *row, bool *ret_has_row, bf_error *err, const store__value *values,
                           size_t n)
{
    store__query q = store__start_with(c, sql, values, n);
    bf_status status = BF_OK;

    *ret_has_row = store__next(&q, &status, err);
    if (*ret_has_row)
        status = store__read(&q, record, row, err);
    store__end(&q);
    return status;
}

bf_status store__list_with(store__connection *c, store__sql sql, const store__record *record,
                           void *rows, size_t n_most, size_t *ret_n, bool *ret_has_more,
                           bf_error *err, const store__value *values, size_t n)
{
    store__query q = store__start_with(c, sql, values, n);
    bf_status status = BF_OK;
    size_t n_rows = 0;
    bool has_row = false;

    while ((has_row = store__next(&q, &status, err)) && n_rows < n_most) {
        status = store__read(&q, record, (char *)rows + n_rows * record->size, err);
        n_rows += status == BF_OK;
    }
    store__end(&q);
    if (status == BF_OK)
        *ret_n = n_rows;
    if (status == BF_OK && ret_has_more != NULL)
        *ret_has_more = has_row;
    return status;
}

bf_status store__check_page(size_t limit, const char *what, bf_error *err)
{
    if (limit >= 1 && limit <= API_LIST_MAX)
        return BF_OK;
    return bf_fail(err, BF_ELIMIT, "", "a page holds 1 to %d %s, not %zu", API_LIST_MAX, what,
                   limit);
}

const char *store__before(const char *before)
{
    return before[0] == '\0' ? "~" : before;
}

bf_status store__list_page(store__pool *pool, store__sql sql, const store__listing *listing,
                           const api_page_query *query, api_page *ret_page, bf_error *err)
{
    // One row more than the page holds is asked for: if it comes, there are more.
    const store__value values[] = {
        TEXT(store__before(query->before)),
        INTEGER(query->limit + 1),
        TEXT(query->owner),
        TEXT(query->label),
        TEXT(query->line),
        INTEGER(query->state),
    };
    const size_t row_size = listing->record->size;
    size_t n = 0;
    bool has_more = false;

    BF_TRY(store__check_page(query->limit, listing->what, err));
    char *rows = memory_alloc(query->limit, row_size);
    if (rows == NULL)
        return bf_fail_memory(err);
    store__connection *reader = store__acquire_reader(pool);
    const bf_status status = store__list_with(reader, sql, listing->record, rows, query->limit, &n,
                                              &has_more, err, values, listing->n_values);
    store__release_reader(pool, reader);
    if (status == BF_OK) {
        ret_page->n = n;
        ret_page->has_more = has_more;
        for (size_t k = 0; k < n; k++)
            memcpy((char *)ret_page->studies + k * listing->size,
                   rows + k * row_size + listing->offset, listing->size);
    }
    memory_free(rows);
    return status;
}

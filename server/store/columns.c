#include "server/store/columns.h"

#include "core/base/check.h"

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

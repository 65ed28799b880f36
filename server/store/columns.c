#include "server/store/columns.h"

bf_status store__column_code(const store__query *q, int column)
{
    char word[32];

    store__column_text(q, column, word, sizeof word);
    for (int code = BF_OK + 1; code < BF_STATUS_COUNT; code++)
        if (strcmp(word, bf_status_word((bf_status)code)) == 0)
            return (bf_status)code;
    return BF_OK;
}

const char *store__code_word(bf_status code)
{
    return code == BF_OK ? "" : bf_status_word(code);
}

bool store__column_id(const store__query *q, int column, char ret_id[API_ID_SIZE])
{
    store__column_text(q, column, ret_id, API_ID_SIZE);
    return strlen(ret_id) == API_ID_SIZE - 1 &&
           sqlite3_column_bytes(q->statement, column) == API_ID_SIZE - 1;
}

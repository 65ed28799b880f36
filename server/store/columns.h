/// Inside the store: how the columns of a row are read into the members of a struct, and bound, from lists of
/// X(kind, column, member) as in sql.h. The row is that of `q`, a store__query pointer, and `i` the column's index.

#pragma once

#include "server/store/connection.h"

#include "api/services.h"

#include <sqlite3.h>
#include <string.h>

#define READ_INTEGER(member) member = (__typeof__(member))sqlite3_column_int64(q->statement, i)
#define READ_REAL(member)    member = store__column_real(q, i)
#define READ_TEXT(member)    store__column_text(q, i, member, sizeof member)
#define READ_ID(member)      is_whole = store__column_id(q, i, member)
#define READ_CODE(member)    member = store__column_code(q, i)
#define ID(text)             TEXT(text)
#define CODE(code)           TEXT(store__code_word(code))

/// A code; codes are stored by their words, so that the list of codes may grow anywhere. An unknown word is BF_OK.
bf_status store__column_code(const store__query *q, int column);
const char *store__code_word(bf_status code);

/// Read an id. False: it is longer or shorter than one.
bool store__column_id(const store__query *q, int column, char ret_id[API_ID_SIZE]);

/// Inside the store: rows, read by tables of their columns, and what columns are bound from.

#pragma once

#include "server/store/connection.h"

#include "api/services.h"

#include <sqlite3.h>
#include <string.h>

/// What a column holds, and what its member is.
typedef enum store__column_kind {
    STORE__COLUMN_INTEGER, ///< bool, or a whole number or enum of 4 or 8 bytes
    STORE__COLUMN_REAL,    ///< double; a NULL is NAN
    STORE__COLUMN_TEXT,    ///< characters with their terminator; too long a text is cut
    STORE__COLUMN_ID,      ///< the same of API_ID_SIZE; another length is damage
    STORE__COLUMN_CODE,    ///< bf_status
} store__column_kind;

/// A column, and where it is read to.
typedef struct store__column {
    store__column_kind kind; ///< of both
    size_t offset;           ///< of the member
    size_t size;             ///< of the member
} store__column;

/// A row of such a table: COLUMN(INTEGER, api_line, n_runs).
#define COLUMN(kind, type, member)                                                                 \
    {                                                                                              \
        STORE__COLUMN_##kind, offsetof(type, member), sizeof((type *)0)->member                    \
    }

/// Rows that are read into a struct.
typedef struct store__record {
    const store__column *columns; ///< the first ones that a statement selects
    size_t n;                     ///< columns
    size_t size;                  ///< of the struct, of which the rest is zero
    /// Check the struct, and read what follows these columns; NULL: any row can be. is_whole: so are its ids.
    bf_status (*check)(const store__query *q, void *row, bool is_whole, bf_error *err);
} store__record;

/// A record of the columns in an array; check as above.
#define RECORD(columns_, type, check_)                                                             \
    {                                                                                              \
        .columns = (columns_), .n = sizeof(columns_) / sizeof *(columns_), .size = sizeof(type),   \
        .check = (check_)                                                                          \
    }

/// An id alone. BF_ECORRUPT: it has another length.
extern const store__record store__id_record;

/// Read the present row. With an error what is in *row is not defined.
BF_MUST_CHECK bf_status store__read(const store__query *q, const store__record *record, void *row,
                                    bf_error *err);

/// Read the first row of a statement, if there is one: store__find(c, sql, &record, &row, &has_row, err, TEXT(id)). Without one
/// *row is as before, with an error it is not defined. A value may lie in *row, as that is written after the search.
#define store__find(c, sql, record, row, ret_has_row, err, ...)                                    \
    store__find_with(c, sql, record, row, ret_has_row, err, STORE__VALUES(__VA_ARGS__))
BF_MUST_CHECK bf_status store__find_with(store__connection *c, store__sql sql,
                                         const store__record *record, void *row, bool *ret_has_row,
                                         bf_error *err, const store__value *values, size_t n);

/// Read the rows of a statement into an array, n_most at most. ret_has_more: there are more (NULL: no matter). With an error what is
/// in *rows is not defined.
#define store__list(c, sql, record, rows, n_most, ret_n, ret_has_more, err, ...)                   \
    store__list_with(c, sql, record, rows, n_most, ret_n, ret_has_more, err,                       \
                     STORE__VALUES(__VA_ARGS__))
BF_MUST_CHECK bf_status store__list_with(store__connection *c, store__sql sql,
                                         const store__record *record, void *rows, size_t n_most,
                                         size_t *ret_n, bool *ret_has_more, bf_error *err,
                                         const store__value *values, size_t n);

/// What pages of a kind of items are read from.
typedef struct store__listing {
    const char *what;            ///< items, for errors
    const store__record *record; ///< its rows
    size_t offset;               ///< of the item in a row
    size_t size;                 ///< of the item
    size_t n_values;             ///< parameters that its statements have
} store__listing;

/// Read a page by a statement whose parameters are ?1 older than, ?2 how many, ?3 owner or '', ?4 label or '', ?5 line or '',
/// ?6 state or -1. BF_ELIMIT: no page has query->limit items. With an error *ret_page is as before.
BF_MUST_CHECK bf_status store__list_page(store__pool *pool, store__sql sql,
                                         const store__listing *listing, const api_page_query *query,
                                         api_page *ret_page, bf_error *err);

/// BF_ELIMIT: no page has so many items; `what` they are.
BF_MUST_CHECK bf_status store__check_page(size_t limit, const char *what, bf_error *err);

/// The id that a page's ids must be less than: `before`, or for "" one that is greater than any id.
const char *store__before(const char *before);

/// Codes are stored by their words, so that the list of codes may grow anywhere. An unknown word is BF_OK.
#define CODE(code) TEXT(store__code_word(code))
#define ID(text)   TEXT(text)
const char *store__code_word(bf_status code);

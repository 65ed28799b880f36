/// Orders of a list of runs as requests name them, and cursors into such a list.
///
///     sort=-throughput_per_h     a word, or a key figure of the run; `-`: falling
///     cursor=<id>.<key>          the last run of the page before and its key in this order, hexadecimal

#pragma once

#include "api/http/param.h"
#include "api/run_list.h"

#include <stdbool.h>

/// Read an order. False: there is no such one, and *ret_sort is untouched.
bool run_sort_read(const char *text, api_sort *ret_sort);

/// True if it can be read.
bool run_sort_is_word(const char *text);

/// The words without signs, with blanks between.
const char *run_sort_words(void);

/// Write the cursor behind the run with this id and key.
void run_sort_write_cursor(const char *id, const char *key, char ret_cursor[API_CURSOR_SIZE]);

/// Read a cursor that was written for this order into the query's `before` and `before_key`. False: it was not.
bool run_sort_read_cursor(const char *cursor, api_list_query *query);

/// A cursor of a list of runs: whether it can be one.
extern const param_kind run_sort_cursor_kind;

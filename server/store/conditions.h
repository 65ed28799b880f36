/// Inside the store: the SQL function by which lists are searched for numbers of scenarios and key figures.
///
///     conditions_hold(an api_conditions as a blob, scenario, key figures)   0 or 1
///
/// SQLITE_TOOBIG: the statement would read more than API_LIST_DOCUMENT_BYTES of them.

#pragma once

struct sqlite3;

/// Add the function to a connection. Returns SQLite's code.
int store__add_conditions(struct sqlite3 *db);

/// Inside the store: the SQL function by which lists are searched for numbers of scenarios and key figures.
///
///     conditions_hold(an api_conditions as a blob, document, document, ...)   0 or 1

#pragma once

struct sqlite3;

/// Add the function to a connection. Returns SQLite's code.
int store__add_conditions(struct sqlite3 *db);

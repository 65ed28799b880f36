/// What the terminal at hand can show.

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// Columns of standard output: COLUMNS, else what the terminal says, else 80.
size_t terminal_columns(void);

/// True if the locale's character set (LC_ALL, LC_CTYPE, LANG) is UTF-8.
bool terminal_is_utf8(void);

/// True if standard output is a terminal that shows colours and NO_COLOR is not set.
bool terminal_has_colors(void);

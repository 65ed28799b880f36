/// Private parts of the log, shared by log.c and log_journal.c.

#pragma once

#include "server/base/log.h"

#include <stdbool.h>

/// True if descriptor fd is the stream that JOURNAL_STREAM ("device:inode"; NULL: none) names.
bool log__is_journal(int fd, const char *stream);

/// Send an event to the journal: text is its line from `event=` on. False: the journal does not take
/// it.
bool log__send(log_level level, const char *text);

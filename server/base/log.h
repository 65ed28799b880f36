/// The daemon's log: one logfmt line per event, `level=info event=run_started run=...`, on stderr or,
/// where a service manager connected that with the journal, in the journal with fields.
///
/// Every line that concerns a run has a pair `run=ID`, and one that concerns a request `request_id=ID`
/// ("-": none): they become the fields RUN_ID and REQUEST_ID.

#pragma once

/// What a line means to an operator, X(level, word, priority of syslog): someone must act, and there
/// is none of these in normal operation; recovered; a change of state of interest to operators; for
/// developers.
#define LOG_LEVEL_LIST(X)                                                                          \
    X(LOG_LEVEL_ERROR, "error", 3)                                                                 \
    X(LOG_LEVEL_WARN, "warn", 4)                                                                   \
    X(LOG_LEVEL_INFO, "info", 6)                                                                   \
    X(LOG_LEVEL_DEBUG, "debug", 7)

/// The levels.
typedef enum log_level {
#define X(level, word, priority) level,
    LOG_LEVEL_LIST(X)
#undef X
        LOG_LEVEL_COUNT
} log_level;

/// The word of a level. Never NULL.
const char *log_level_word(log_level level);

/// The level of a word, or LOG_LEVEL_COUNT.
log_level log_level_find(const char *word);

/// Write to the journal instead of stderr if stderr is connected to it (JOURNAL_STREAM). For the start
/// of a daemon, before other threads log.
void log_open(void);

/// Show lines up to this level (default LOG_LEVEL_INFO).
void log_set_level(log_level level);

/// Write a line: event is a fixed word, format gives further `key=value` pairs. Text from outside
/// goes through log_quote(). Thread-safe; a line is one write.
void log_event(log_level level, const char *event, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

enum { LOG_QUOTED_SIZE = 256 };

/// text as a quoted logfmt value in storage (LOG_QUOTED_SIZE bytes), control bytes replaced, cut if
/// long. Returns storage.
const char *log_quote(const char *text, char *storage);

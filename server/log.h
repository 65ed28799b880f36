/// The daemon's log: one logfmt line per event on stderr, `level=info event=run_started run=...`.

#pragma once

/// What a line means to an operator.
typedef enum log_level {
    LOG_LEVEL_ERROR, ///< someone must act; none of these in a clean day
    LOG_LEVEL_WARN,  ///< we coped
    LOG_LEVEL_INFO,  ///< a change of state that an operator wants to see
    LOG_LEVEL_DEBUG, ///< for developers
    LOG_LEVEL_COUNT
} log_level;

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

#include "server/base/log.h"

#include "api/json/text.h"
#include "server/base/base_priv.h"
#include "server/base/clock.h"
#include "server/base/metrics.h"

#include <errno.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

// A write of at most PIPE_BUF bytes is not torn when several processes share a pipe.
enum { LINE_SIZE = 4096, HEAD_SIZE = 64 };

static const char *const level_words[LOG_LEVEL_COUNT] = {
#define X(level, word, priority) word,
    LOG_LEVEL_LIST(X)
#undef X
};

static atomic_int shown_level = LOG_LEVEL_INFO;
static atomic_bool has_journal;

const char *log_level_word(log_level level)
{
    return level_words[level];
}

log_level log_level_find(const char *word)
{
    return (log_level)text_find_word(level_words, LOG_LEVEL_COUNT, word);
}

void log_open(void)
{
    atomic_store(&has_journal, log__is_journal(STDERR_FILENO, getenv("JOURNAL_STREAM")));
}

void log_set_level(log_level level)
{
    atomic_store_explicit(&shown_level, (int)level, memory_order_relaxed);
}

static size_t clip_length(int n, size_t size)
{
    if (n < 0)
        return 0;
    return (size_t)n < size ? (size_t)n : size - 1;
}

static size_t write_pairs(char *line, size_t size, const char *format, va_list args)
{
    if (size < 2 || format == NULL || *format == '\0')
        return 0;
    line[0] = ' ';
    return 1 + clip_length(vsnprintf(line + 1, size - 1, format, args), size - 1);
}

static int is_control(char byte)
{
    return (unsigned char)byte < 0x20 || byte == 0x7f;
}

// The whole line but its end, in LINE_SIZE bytes; the part behind time and level begins at *ret_n_head.
static size_t write_event(char *line, log_level level, const char *event, const char *format,
                          va_list args, size_t *ret_n_head)
{
    enum { ROOM = LINE_SIZE - 1 };
    char head[HEAD_SIZE];

    int64_t now_ms = clock_unix_ms();
    time_t now_s = (time_t)(now_ms / 1000);
    struct tm utc;
    char stamp[32];
    gmtime_r(&now_s, &utc);
    strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%S", &utc);
    (void)snprintf(head, HEAD_SIZE, "ts=%s.%03dZ level=%s ", stamp, (int)(now_ms % 1000),
                   level_words[level]);
    *ret_n_head = strlen(head);
    size_t n = clip_length(snprintf(line, ROOM, "%sevent=%s", head, event), ROOM);
    n += write_pairs(line + n, ROOM - n, format, args);
    for (size_t i = 0; i < n; i++)
        if (is_control(line[i]))
            line[i] = '?';
    line[n] = '\0';
    return n;
}

void log_event(log_level level, const char *event, const char *format, ...)
{
    char line[LINE_SIZE];
    size_t n_head = 0;
    va_list args;

    if ((int)level > atomic_load_explicit(&shown_level, memory_order_relaxed))
        return;
    int saved = errno;
    metrics_add(METRICS_LOG_LINES, level, 1);
    va_start(args, format);
    size_t n = write_event(line, level, event, format, args, &n_head);
    va_end(args);
    if (!atomic_load_explicit(&has_journal, memory_order_relaxed) ||
        !log__send(level, line + n_head)) {
        line[n++] = '\n';
        // Nothing can be done about a log that cannot be written; it must not stop the daemon.
        ssize_t written = 0;
        do
            written = write(STDERR_FILENO, line, n);
        while (written < 0 && errno == EINTR);
    }
    errno = saved;
}

const char *log_quote(const char *text, char *storage)
{
    size_t n = 0;
    size_t start = 0; // of the last UTF-8 character

    storage[n++] = '"';
    for (; *text != '\0'; text++) {
        if (((unsigned char)*text & 0xc0) != 0x80)
            start = n;
        if (n + 4 > LOG_QUOTED_SIZE) {
            // A character is shown whole or not at all.
            n = start;
            break;
        }
        if (*text == '"' || *text == '\\')
            storage[n++] = '\\';
        storage[n++] = is_control(*text) ? '?' : *text;
    }
    storage[n++] = '"';
    storage[n] = '\0';
    return storage;
}

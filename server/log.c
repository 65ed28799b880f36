#include "server/log.h"

#include "server/clock.h"

#include <errno.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

// A write of at most PIPE_BUF bytes is not torn when several processes share a pipe.
enum { LINE_SIZE = 4096 };

static const char *const level_words[LOG_LEVEL_COUNT] = { "error", "warn", "info", "debug" };

static atomic_int shown_level = LOG_LEVEL_INFO;

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

static size_t write_head(char *line, size_t size, log_level level, const char *event)
{
    int64_t now_ms = clock_unix_ms();
    time_t now_s = (time_t)(now_ms / 1000);
    struct tm utc;
    char stamp[32];

    gmtime_r(&now_s, &utc);
    strftime(stamp, sizeof stamp, "%Y-%m-%dT%H:%M:%S", &utc);
    int n = snprintf(line, size, "ts=%s.%03dZ level=%s event=%s", stamp, (int)(now_ms % 1000),
                     level_words[level], event);
    return clip_length(n, size);
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

// Nothing can be done about a log that cannot be written; it must not stop the daemon.
static void write_line(const char *line, size_t n)
{
    ssize_t written = 0;

    do
        written = write(STDERR_FILENO, line, n);
    while (written < 0 && errno == EINTR);
}

void log_event(log_level level, const char *event, const char *format, ...)
{
    char line[LINE_SIZE];
    va_list args;

    if ((int)level > atomic_load_explicit(&shown_level, memory_order_relaxed))
        return;
    int saved = errno;
    size_t n = write_head(line, sizeof line - 1, level, event);
    va_start(args, format);
    n += write_pairs(line + n, sizeof line - 1 - n, format, args);
    va_end(args);
    for (size_t i = 0; i < n; i++)
        if (is_control(line[i]))
            line[i] = '?';
    line[n++] = '\n';
    write_line(line, n);
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

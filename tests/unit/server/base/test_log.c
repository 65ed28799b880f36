// Unit tests of the log: what a line looks like, on stderr and in the journal.

#include "server/base/log.h"

#include "server/base/base_priv.h"
#include "server/base/metrics.h"
#include "tests/unit/helper_cmocka.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#define SD_JOURNAL_SUPPRESS_LOCATION
#include <systemd/sd-journal.h>

enum { STAMP_LENGTH = 24 }; // of 2026-01-31T12:00:00.000Z

static int pipe_ends[2];
static int true_stderr;

// The journal of these tests takes libsystemd's place.
static bool journal_is_away;
static int n_sent;
static char sent[2048];

int sd_journal_sendv(const struct iovec *items, int n)
{
    size_t length = 0;

    if (journal_is_away)
        return -ENOENT;
    for (int i = 0; i < n; i++)
        length += (size_t)snprintf(sent + length, sizeof sent - length, "%.*s\n",
                                   (int)items[i].iov_len, (const char *)items[i].iov_base);
    n_sent++;
    return 0;
}

static int redirect(void **state)
{
    true_stderr = dup(STDERR_FILENO);
    if (true_stderr < 0 || pipe(pipe_ends) != 0 || dup2(pipe_ends[1], STDERR_FILENO) < 0)
        return -1;
    return 0;
}

static int restore(void **state)
{
    dup2(true_stderr, STDERR_FILENO);
    close(true_stderr);
    close(pipe_ends[0]);
    close(pipe_ends[1]);
    log_set_level(LOG_LEVEL_INFO);
    (void)unsetenv("JOURNAL_STREAM");
    log_open();
    return 0;
}

// What one read finds in the pipe: what was written by one write.
static size_t read_line(char *line, size_t size)
{
    ssize_t n = read(pipe_ends[0], line, size - 1);

    assert_true(n > 0);
    line[n] = '\0';
    return (size_t)n;
}

static void a_line_has_time_level_event_and_pairs(void **state)
{
    char line[512];
    int year, month, day, hour, minute, second, ms, end = 0;

    log_event(LOG_LEVEL_WARN, "run_failed", "run=%s step=%d", "abc", 7);
    read_line(line, sizeof line);
    assert_int_equal(sscanf(line, "ts=%4d-%2d-%2dT%2d:%2d:%2d.%3dZ%n", &year, &month, &day, &hour,
                            &minute, &second, &ms, &end),
                     7);
    assert_int_equal(end, 3 + STAMP_LENGTH);
    assert_string_equal(line + end, " level=warn event=run_failed run=abc step=7\n");
}

static void an_event_needs_no_pairs(void **state)
{
    char line[512];

    log_event(LOG_LEVEL_INFO, "ready", "%s", "");
    read_line(line, sizeof line);
    assert_string_equal(line + 3 + STAMP_LENGTH, " level=info event=ready \n");
    log_event(LOG_LEVEL_INFO, "ready", NULL);
    read_line(line, sizeof line);
    assert_string_equal(line + 3 + STAMP_LENGTH, " level=info event=ready\n");
}

static void lines_beyond_the_level_are_not_written(void **state)
{
    char line[512];

    log_event(LOG_LEVEL_DEBUG, "hidden", NULL);
    log_set_level(LOG_LEVEL_DEBUG);
    log_event(LOG_LEVEL_DEBUG, "shown", NULL);
    read_line(line, sizeof line);
    assert_string_equal(line + 3 + STAMP_LENGTH, " level=debug event=shown\n");
    log_set_level(LOG_LEVEL_ERROR);
    log_event(LOG_LEVEL_WARN, "hidden", NULL);
    log_event(LOG_LEVEL_ERROR, "shown", NULL);
    read_line(line, sizeof line);
    assert_string_equal(line + 3 + STAMP_LENGTH, " level=error event=shown\n");
}

static void a_line_stays_one_line(void **state)
{
    char line[512];

    log_event(LOG_LEVEL_INFO, "odd", "text=a\nb\x1b[0mc");
    read_line(line, sizeof line);
    assert_string_equal(line + 3 + STAMP_LENGTH, " level=info event=odd text=a?b?[0mc\n");
}

static void a_long_line_is_cut_but_ends(void **state)
{
    static char text[10000], line[20000];

    memset(text, 'x', sizeof text - 1);
    log_event(LOG_LEVEL_INFO, "long", "text=%s", text);
    size_t n = read_line(line, sizeof line);
    // A write of at most 4096 bytes (PIPE_BUF) is not torn.
    assert_true(n > 4000 && n <= 4096);
    assert_int_equal(line[n - 1], '\n');
}

static void text_from_outside_is_quoted(void **state)
{
    char storage[LOG_QUOTED_SIZE];

    assert_string_equal(log_quote("plain text", storage), "\"plain text\"");
    assert_string_equal(log_quote("", storage), "\"\"");
    assert_string_equal(log_quote("say \"hi\" \\ \n\x7f", storage), "\"say \\\"hi\\\" \\\\ ??\"");
    assert_ptr_equal(log_quote("x", storage), storage);
}

// Characters are 1, 2 or 3 bytes long, so each cut falls once on each place within a character.
static void long_text_is_cut_between_characters(void **state)
{
    static const char *const characters[] = { "a", "\u00fc", "\u20ac", "\"" };
    char storage[LOG_QUOTED_SIZE], text[1000];

    for (size_t i = 0; i < sizeof characters / sizeof *characters; i++) {
        size_t length = strlen(characters[i]);
        text[0] = '\0';
        for (int j = 0; j < 300; j++)
            strcat(text, characters[i]);
        log_quote(text, storage);
        size_t n = strlen(storage);
        size_t n_shown = strcmp(characters[i], "\"") == 0 ? 2 : length;
        assert_true(n < LOG_QUOTED_SIZE && n > LOG_QUOTED_SIZE - 8);
        assert_int_equal((n - 2) % n_shown, 0);
        assert_int_equal(storage[n - 1], '"');
    }
}

static void levels_have_words(void **state)
{
    for (int level = 0; level < LOG_LEVEL_COUNT; level++)
        assert_int_equal(log_level_find(log_level_word((log_level)level)), level);
    assert_int_equal(log_level_find("loud"), LOG_LEVEL_COUNT);
}

static void lines_are_counted_by_their_level(void **state)
{
    char line[512];
    int64_t n_warn = metrics_value(METRICS_LOG_LINES, LOG_LEVEL_WARN);
    int64_t n_debug = metrics_value(METRICS_LOG_LINES, LOG_LEVEL_DEBUG);

    log_event(LOG_LEVEL_WARN, "seen", NULL);
    log_event(LOG_LEVEL_DEBUG, "hidden", NULL);
    read_line(line, sizeof line);
    assert_int_equal(metrics_value(METRICS_LOG_LINES, LOG_LEVEL_WARN), n_warn + 1);
    assert_int_equal(metrics_value(METRICS_LOG_LINES, LOG_LEVEL_DEBUG), n_debug);
}

static void only_the_stream_that_is_named_is_the_journal(void **state)
{
    struct stat found;
    char name[64];

    assert_int_equal(fstat(pipe_ends[1], &found), 0);
    (void)snprintf(name, sizeof name, "%llu:%llu", (unsigned long long)found.st_dev,
                   (unsigned long long)found.st_ino);
    assert_true(log__is_journal(pipe_ends[1], name));
    assert_false(log__is_journal(pipe_ends[1], NULL));
    assert_false(log__is_journal(pipe_ends[1], ""));
    assert_false(log__is_journal(pipe_ends[1], "none"));
    assert_false(log__is_journal(-1, name));
    (void)snprintf(name, sizeof name, "%llu:%llu", (unsigned long long)found.st_dev,
                   (unsigned long long)found.st_ino + 1);
    assert_false(log__is_journal(pipe_ends[1], name));
}

// From here on the pipe stands for the journal's stream.
static void connect_journal(void)
{
    struct stat found;
    char name[64];

    assert_int_equal(fstat(STDERR_FILENO, &found), 0);
    (void)snprintf(name, sizeof name, "%llu:%llu", (unsigned long long)found.st_dev,
                   (unsigned long long)found.st_ino);
    assert_int_equal(setenv("JOURNAL_STREAM", name, 1), 0);
    log_open();
    journal_is_away = false;
    n_sent = 0;
}

static void the_journal_gets_ids_and_priority_as_fields(void **state)
{
    connect_journal();
    log_event(LOG_LEVEL_WARN, "run_failed", "path=\"a run=x \\\" b\" run=01-2 request_id=r7 n=3");
    assert_int_equal(n_sent, 1);
    assert_string_equal(sent,
                        "MESSAGE=event=run_failed path=\"a run=x \\\" b\" run=01-2 request_id=r7 "
                        "n=3\nPRIORITY=4\nBELTFLOW_EVENT=run_failed\nRUN_ID=01-2\n"
                        "REQUEST_ID=r7\n");
}

static void a_line_without_ids_has_no_fields_for_them(void **state)
{
    static const char *const pairs[] = { "run=- request_id=", "rerun=1 arequest_id=2", "run",
                                         NULL };

    connect_journal();
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        log_event(LOG_LEVEL_INFO, "started", pairs[i] == NULL ? NULL : "%s", pairs[i]);
        assert_null(strstr(sent, "RUN_ID"));
        assert_null(strstr(sent, "REQUEST_ID"));
        assert_non_null(strstr(sent, "\nPRIORITY=6\nBELTFLOW_EVENT=started\n"));
    }
}

static void what_the_journal_does_not_take_goes_to_stderr(void **state)
{
    char line[512];

    connect_journal();
    journal_is_away = true;
    log_event(LOG_LEVEL_ERROR, "lost", "run=7");
    read_line(line, sizeof line);
    assert_string_equal(line + 3 + STAMP_LENGTH, " level=error event=lost run=7\n");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_line_has_time_level_event_and_pairs, redirect, restore),
        cmocka_unit_test_setup_teardown(an_event_needs_no_pairs, redirect, restore),
        cmocka_unit_test_setup_teardown(lines_beyond_the_level_are_not_written, redirect, restore),
        cmocka_unit_test_setup_teardown(a_line_stays_one_line, redirect, restore),
        cmocka_unit_test_setup_teardown(a_long_line_is_cut_but_ends, redirect, restore),
        cmocka_unit_test_setup_teardown(lines_are_counted_by_their_level, redirect, restore),
        cmocka_unit_test_setup_teardown(only_the_stream_that_is_named_is_the_journal, redirect,
                                        restore),
        cmocka_unit_test_setup_teardown(the_journal_gets_ids_and_priority_as_fields, redirect,
                                        restore),
        cmocka_unit_test_setup_teardown(a_line_without_ids_has_no_fields_for_them, redirect,
                                        restore),
        cmocka_unit_test_setup_teardown(what_the_journal_does_not_take_goes_to_stderr, redirect,
                                        restore),
        cmocka_unit_test(levels_have_words),
        cmocka_unit_test(text_from_outside_is_quoted),
        cmocka_unit_test(long_text_is_cut_between_characters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

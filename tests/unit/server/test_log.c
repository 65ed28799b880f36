// Unit tests of the log: what a line looks like.

#include "server/log.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { STAMP_LENGTH = 24 }; // of 2026-01-31T12:00:00.000Z

static int pipe_ends[2];
static int true_stderr;

static int redirect(void **state)
{
    (void)state;
    true_stderr = dup(STDERR_FILENO);
    if (true_stderr < 0 || pipe(pipe_ends) != 0 || dup2(pipe_ends[1], STDERR_FILENO) < 0)
        return -1;
    return 0;
}

static int restore(void **state)
{
    (void)state;
    dup2(true_stderr, STDERR_FILENO);
    close(true_stderr);
    close(pipe_ends[0]);
    close(pipe_ends[1]);
    log_set_level(LOG_LEVEL_INFO);
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
    (void)state;

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
    (void)state;

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
    (void)state;

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
    (void)state;

    log_event(LOG_LEVEL_INFO, "odd", "text=a\nb\x1b[0mc");
    read_line(line, sizeof line);
    assert_string_equal(line + 3 + STAMP_LENGTH, " level=info event=odd text=a?b?[0mc\n");
}

static void a_long_line_is_cut_but_ends(void **state)
{
    static char text[10000], line[20000];
    (void)state;

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
    (void)state;

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
    (void)state;

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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_line_has_time_level_event_and_pairs, redirect, restore),
        cmocka_unit_test_setup_teardown(an_event_needs_no_pairs, redirect, restore),
        cmocka_unit_test_setup_teardown(lines_beyond_the_level_are_not_written, redirect, restore),
        cmocka_unit_test_setup_teardown(a_line_stays_one_line, redirect, restore),
        cmocka_unit_test_setup_teardown(a_long_line_is_cut_but_ends, redirect, restore),
        cmocka_unit_test(text_from_outside_is_quoted),
        cmocka_unit_test(long_text_is_cut_between_characters),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
